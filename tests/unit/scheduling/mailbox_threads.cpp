// The mailbox between two threads of the host: no item is torn, and each is taken or counted.
#include <atomic>
#include <mutex>
#include <thread>

#include <catch2/catch.hpp>

#include "ocm/scheduling/mailbox.hpp"

namespace scheduling_mailbox_threads_test {

using ocm::scheduling::Mailbox;

/// Two numbers that belong together.
struct Pair {
  long number = 0;
  long minus = 0;
};
struct ThreadPort {
  std::unique_lock<std::mutex> lock() { return std::unique_lock{mutex}; }
  std::mutex mutex;
};

TEST_CASE("mailbox: two threads: whole items, in order, each taken or counted", "[mailbox]") {
  constexpr long items = 200'000;
  ThreadPort port;
  Mailbox<Pair, ThreadPort> box{port};
  std::atomic<bool> ended = false;
  std::thread writer{[&] {
    for (long i = 1; i <= items; ++i) box.put({i, -i});
    ended = true;
  }};
  long taken = 0;
  long last = 0;
  bool whole = true;
  bool ordered = true;
  for (bool more = true; more;) {
    more = !ended;
    while (const auto item = box.take()) {
      whole = whole && item->minus == -item->number;
      ordered = ordered && item->number > last;
      last = item->number;
      ++taken;
    }
  }
  writer.join();
  CHECK(whole);
  CHECK(ordered);
  CHECK(last == items);
  CHECK(taken + box.lost() == items);
}

}  // namespace scheduling_mailbox_threads_test
