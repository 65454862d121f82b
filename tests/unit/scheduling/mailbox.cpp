#include "ocm/scheduling/mailbox.hpp"

#include <catch2/catch.hpp>

namespace scheduling_mailbox_test {

using namespace ocm;
using scheduling::Mailbox;

/// A lock that says when it is taken twice.
struct Port {
  struct Guard {
    explicit Guard(Port& p) : port(&p) {
      CHECK_FALSE(port->locked);
      port->locked = true;
    }
    ~Guard() {
      port->locked = false;
      ++port->sections;
    }
    Guard(const Guard&) = delete;
    Guard& operator=(const Guard&) = delete;
    Port* port;
  };
  Guard lock() { return Guard{*this}; }
  bool locked = false;
  int sections = 0;
};

template <class T, class P>
concept Boxed = requires {
  typename Mailbox<T, P>;
};
struct Owner {  // more than bytes to copy
  ~Owner() {}
};
struct Lockless {};
struct Guardless {
  void lock();
};
static_assert(Boxed<int, Port>);
static_assert(!Boxed<Owner, Port>);
static_assert(!Boxed<int, Lockless>);
static_assert(!Boxed<int, Guardless>);

TEST_CASE("mailbox: what was put last is taken once", "[mailbox]") {
  Port port;
  Mailbox<int, Port> box{port};
  CHECK(box.take().error == base::Error::no_answer);
  box.put(3);
  CHECK(*box.take() == 3);
  CHECK(box.take().error == base::Error::no_answer);
  CHECK(box.lost() == 0);
}

TEST_CASE("mailbox: a newer one replaces what was not taken, which is counted", "[mailbox]") {
  Port port;
  Mailbox<int, Port> box{port};
  for (int i = 1; i <= 5; ++i) box.put(i);
  CHECK(*box.take() == 5);
  CHECK(box.lost() == 4);
  box.put(6);
  CHECK(box.lost() == 4);
}

TEST_CASE("mailbox: what is cleared is lost, and nothing is lost of an empty one", "[mailbox]") {
  Port port;
  Mailbox<int, Port> box{port};
  box.clear();
  CHECK(box.lost() == 0);
  box.put(1);
  box.clear();
  CHECK(box.lost() == 1);
  CHECK(box.take().error == base::Error::no_answer);
  box.put(2);
  const int before = port.sections;
  CHECK_FALSE(box.empty_locked());
  box.clear_locked();
  CHECK(box.empty_locked());
  CHECK(port.sections == before);  // whose lock the caller holds
  CHECK(box.lost() == 2);
}

TEST_CASE("mailbox: every access is one section under the port's lock", "[mailbox]") {
  Port port;
  Mailbox<int, Port> box{port};
  box.put(1);
  (void)box.take();
  box.clear();
  (void)box.lost();
  CHECK(port.sections == 4);
}

}  // namespace scheduling_mailbox_test
