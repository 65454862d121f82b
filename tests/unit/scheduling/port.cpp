#include "ocm/scheduling/port.hpp"

#include <catch2/catch.hpp>

#include "ocm/scheduling/cooperative.hpp"

#include "examples/port/freertos.hpp"
#include "unit/scheduling/conformance.hpp"

namespace scheduling_port_test {

using namespace ocm;
using namespace std::chrono_literals;
using scheduling::Level;
using scheduling::Port;

struct Guard {
  ~Guard() {}
};
struct Whole {
  base::Time now();
  void arm(base::Time);
  void pend(Level);
  Guard lock();
};
struct WithoutTimer {
  base::Time now();
  void pend(Level);
  Guard lock();
};
struct WithoutLevels {
  base::Time now();
  void arm(base::Time);
  Guard lock();
};
struct InTicks {  // of a clock of its own: what is armed would mean something else
  std::uint64_t now();
  void arm(base::Time);
  void pend(Level);
  Guard lock();
};
struct WithoutGuard {
  base::Time now();
  void arm(base::Time);
  void pend(Level);
  void lock();
};

static_assert(Port<Whole>);
static_assert(Port<scheduling::Cooperative>);
static_assert(!Port<WithoutTimer>);
static_assert(!Port<WithoutLevels>);
static_assert(!Port<InTicks>);
static_assert(!Port<WithoutGuard>);

struct Watching : Whole {
  void ran(Level);
};
struct WatchingAlone {
  void ran(Level);
};
static_assert(scheduling::LevelWatcher<Watching>);
static_assert(!scheduling::LevelWatcher<Whole> && !scheduling::LevelWatcher<WatchingAlone>);

/// The example of docs/porting.md, on the functions of an RTOS that it calls.
struct FreeRtos {
  FreeRtos() { fake::kernel = std::make_unique<fake::Kernel>(); }
  ~FreeRtos() {
    stop();
    fake::kernel.reset();
  }
  FreeRtos(const FreeRtos&) = delete;
  FreeRtos& operator=(const FreeRtos&) = delete;

  using Port = example::FreeRtosPort;
  Port& port() { return freertos; }
  void attach(std::function<void()> on_timer, std::function<void(Level)> on_level) {
    expire = std::move(on_timer);
    run = std::move(on_level);
    freertos.start(
        this, [](void* self) { static_cast<FreeRtos*>(self)->expire(); },
        [](void* self, Level level) { static_cast<FreeRtos*>(self)->run(level); });
  }
  void let_pass(base::Duration time) { std::this_thread::sleep_for(time); }  // virtual for other ports
  void stop() { fake::kernel->end(); }
  static constexpr base::Duration slack{5s};  // of a machine that has other things to do

  std::function<void()> expire;
  std::function<void(Level)> run;
  example::FreeRtosPort freertos;
};

TEST_CASE("the port that the documentation shows is one") {
  conformance::check<FreeRtos>();
}

TEST_CASE("what is asked of it before its tasks exist is done when they do") {
  FreeRtos setup;
  std::atomic<int> expired{0}, ran{0};
  {
    const auto guard = setup.freertos.lock();
    setup.freertos.pend(Level::medium);
    setup.freertos.arm(setup.freertos.now());
  }
  setup.attach([&] { ++expired; }, [&](Level level) { ran += level == Level::medium ? 1 : 100; });
  conformance::wait_for(setup, [&] { return expired == 1 && ran == 1; });
  setup.stop();
  CHECK(expired == 1);
  CHECK(ran == 1);
}

}  // namespace scheduling_port_test
