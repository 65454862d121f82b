#include "ocm/scheduling/resource.hpp"

#include <utility>

#include <catch2/catch.hpp>

namespace scheduling_resource_test {

using namespace ocm;
using namespace std::chrono_literals;
using scheduling::Contention;
using scheduling::Resource;

struct Clock {
  base::Time time{};
  base::Time now() const { return time; }
};

/// A mutex that another level holds for so long.
struct Mutex {
  explicit Mutex(Clock& c) : clock(&c) {}
  void lock() {
    clock->time += std::exchange(taken_for, 0ns);
    ++locked;
  }
  bool try_lock() {
    if (taken_for > 0ns) return false;
    ++locked;
    return true;
  }
  void unlock() { --locked; }
  Clock* clock;
  base::Duration taken_for{};
  int locked = 0;
};
/// The same without a way to look first.
struct Plain : private Mutex {
  using Mutex::lock;
  using Mutex::Mutex;
  using Mutex::taken_for;
  using Mutex::unlock;
};
static_assert(scheduling::Lockable<Mutex> && scheduling::Lockable<Plain>);
struct OnlyLocked {
  void lock() {}
};
struct OnlyUnlocked {
  void unlock() {}
};
static_assert(!scheduling::Lockable<OnlyLocked> && !scheduling::Lockable<OnlyUnlocked>);
static_assert(scheduling::Lockable<scheduling::NoMutex>);

template <class M>
struct Reference {  // so that the test keeps the mutex in its hands
  explicit Reference(M& m) : mutex(&m) {}
  void lock() { mutex->lock(); }
  void unlock() { mutex->unlock(); }
  bool try_lock() requires requires(M& m) { m.try_lock(); }
  { return mutex->try_lock(); }
  M* mutex;
};

template <class M>
Contention three_claims() {
  Clock clock;
  M mutex{clock};
  Resource<Reference<M>, Clock> resource{clock, mutex};
  {
    const auto claim = resource.claim();
    clock.time += 3ms;
  }
  mutex.taken_for = 7ms;
  {
    const auto claim = resource.claim();
    clock.time += 2ms;
  }
  mutex.taken_for = 5ms;
  { const auto claim = resource.claim(); }
  return resource.contention();
}

TEST_CASE("the longest wait and the longest hold are kept, and who had to wait is counted") {
  CHECK(three_claims<Mutex>() == Contention{3, 2, 7ms, 3ms});
  CHECK(three_claims<Plain>() == Contention{3, 2, 7ms, 3ms});
}

TEST_CASE("a claim holds the mutex exactly as long as it lives") {
  Clock clock;
  Mutex mutex{clock};
  Resource<Reference<Mutex>, Clock> resource{clock, mutex};
  {
    const auto claim = resource.claim();
    CHECK(mutex.locked == 1);
  }
  CHECK(mutex.locked == 0);
  CHECK(resource.contention().claims == 1);
  CHECK(mutex.locked == 0);
}

}  // namespace scheduling_resource_test
