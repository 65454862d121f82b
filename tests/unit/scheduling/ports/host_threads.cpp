#include "ocm/scheduling/ports/host_threads.hpp"

#include <array>
#include <atomic>
#include <chrono>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/controller/controller.hpp"
#include "ocm/controller/level.hpp"
#include "ocm/protocol/message.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/scheduling/resource.hpp"
#include "ocm/topics/amiro.hpp"

#include "unit/scheduling/conformance.hpp"

namespace scheduling_ports_host_threads_test {

using namespace ocm;
using namespace std::chrono_literals;
using scheduling::Level;
using scheduling::ports::HostMutex;
using scheduling::ports::HostThreads;
using scheduling::ports::HostThreadsOptions;

template <bool RealTime>
struct Threads {
  using Port = HostThreads;
  Port& port() { return threads; }
  void attach(std::function<void()> expire, std::function<void(Level)> run) {
    REQUIRE(threads.start(std::move(expire), std::move(run)).ok());
  }
  void let_pass(base::Duration time) { std::this_thread::sleep_for(time); }  // virtual for other ports
  void stop() { threads.stop(); }
  static constexpr base::Duration slack{5s};  // of a machine that has other things to do

  HostThreads threads{HostThreadsOptions{RealTime, 10}};
};

/// Takes two frames of three: every sample of several frames has to wait now and then.
struct Bus {
  base::Result<bool> send(const can::Frame& frame) {
    if (++offered % 3 == 0) return false;
    frames.push_back(frame);
    return true;
  }
  int offered = 0;  // under the port's lock, all of it
  std::vector<can::Frame> frames;
};

void spend(base::Duration time) {
  const auto end = std::chrono::steady_clock::now() + time;
  while (std::chrono::steady_clock::now() < end) {
  }
}

TEST_CASE("host threads are a port, with real-time priorities where they are permitted") {
  conformance::check<Threads<true>>();
}
TEST_CASE("host threads are a port without real-time priorities") {
  conformance::check<Threads<false>>();
}

TEST_CASE("who gets no real-time priorities gets the reason, and what to do") {
  HostThreads asked;
  REQUIRE(asked.start([] {}, [](Level) {}).ok());
  sched_param parameter{};
  parameter.sched_priority = 10;
  std::atomic<int> permitted{-1};
  std::thread{[&] { permitted = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameter); }}.join();
  CHECK(asked.shortfall().has_value() == (permitted != 0));
  if (asked.shortfall()) {
    CHECK(asked.shortfall()->what ==
          "no real-time priorities for the levels: " + std::generic_category().message(permitted.load()));
    CHECK(asked.shortfall()->remedy ==
          "run it with CAP_SYS_NICE, or permit them (ulimit -r 14); until then an urgent level does not stop "
          "one that runs");
  }
  HostThreads not_asked{HostThreadsOptions{false, 10}};
  const auto started = not_asked.start([] {}, [](Level) {});
  REQUIRE(started.ok());
  CHECK(*started);
  REQUIRE(not_asked.shortfall().has_value());
  CHECK(not_asked.shortfall()->what == "real-time priorities were not asked for");
  CHECK(not_asked.shortfall()->remedy.empty());
}

TEST_CASE("each level has a real-time priority above the next, the timer the highest, or none has any") {
  Threads<true> setup;
  std::array<std::atomic<int>, 5> priorities{};  // of the levels and the timer; 0: not a real-time one
  for (auto& priority : priorities) priority = -1;
  const auto own = [] {
    int policy = 0;
    sched_param parameter{};
    pthread_getschedparam(pthread_self(), &policy, &parameter);
    return policy == SCHED_FIFO ? parameter.sched_priority : 0;
  };
  setup.attach([&] { priorities[4] = own(); },
               [&](Level level) { priorities[static_cast<std::size_t>(level)] = own(); });
  for (const Level level : conformance::levels) conformance::pend(setup, level);
  conformance::arm(setup, setup.port().now());
  for (auto& priority : priorities) conformance::wait_for(setup, [&] { return priority >= 0; });
  setup.stop();
  const bool strict = !setup.threads.shortfall().has_value();
  for (int level = 0; level < 4; ++level)
    CHECK(priorities[static_cast<std::size_t>(level)] == (strict ? 13 - level : 0));
  CHECK(priorities[4] == (strict ? 14 : 0));
}

TEST_CASE("the time of host threads is the system's monotonic one") {
  const HostThreads threads;
  const auto before = std::chrono::steady_clock::now();
  const base::Time now = threads.now();
  const auto after = std::chrono::steady_clock::now();
  CHECK(now.time_since_epoch() >= before.time_since_epoch());
  CHECK(now.time_since_epoch() <= after.time_since_epoch());
}

TEST_CASE("threads that were never started, started and stopped at once, or stopped twice") {
  { HostThreads never; }
  for (int i = 0; i < 50; ++i) {
    HostThreads threads;
    std::atomic<int> runs{0};
    {
      const auto guard = threads.lock();
      threads.pend(Level::low);  // is kept until the start
      threads.arm(threads.now());
    }
    REQUIRE(threads.start([] {}, [&](Level) { ++runs; }).ok());
    if (i % 2 == 0) threads.stop();
    threads.stop();
    CHECK(runs <= 1);
  }
}

TEST_CASE("an urgent level preempts a less urgent one where priorities are real") {
  HostThreads threads;
  std::atomic<bool> urgent_ran{false};
  std::atomic<bool> low_saw_it{false};
  std::atomic<bool> on_one{false};  // on two processors it would run beside the urgent one
  const auto pend = [&](Level level) {
    const auto guard = threads.lock();
    threads.pend(level);
  };
  REQUIRE(threads
              .start([] {},
                     [&](Level level) {
                       if (level == Level::urgent) {
                         urgent_ran = true;
                         return;
                       }
                       pend(Level::urgent);
                       cpu_set_t processors;
                       on_one = sched_getaffinity(0, sizeof processors, &processors) == 0 &&
                                CPU_COUNT(&processors) == 1;
                       for (int i = 0; i < 5000 && !urgent_ran; ++i) spend(1ms);
                       low_saw_it = urgent_ran.load();
                     })
              .ok());
  pend(Level::low);
  for (int i = 0; i < 5000 && !low_saw_it; ++i) std::this_thread::sleep_for(1ms);
  threads.stop();
  CHECK(low_saw_it);
  CHECK(on_one == !threads.shortfall());
}

TEST_CASE("a whole board on threads: requests from two sides of it, a bus that is full now and then") {
  Bus bus;
  HostThreads threads;
  controller::Controller<amiro::DiWheelDrive, Bus, HostThreads, 2> board{bus, threads};
  scheduling::Resource<HostMutex, HostThreads> i2c{threads};
  std::array<std::atomic<int>, 3> inside{};
  std::atomic<int> twice{0};
  const auto alone = [&](std::size_t what, base::Duration time) {
    if (++inside[what] != 1) ++twice;
    spend(time);
    --inside[what];
  };
  board.serve<amiro::Gyroscope>([&] {
    alone(0, 20us);
    return base::Result<amiro::Gyroscope>{amiro::Gyroscope{1, 2, 3}};
  });
  board.serve<amiro::Magnetometer>([&] {
    const auto claim = i2c.claim();
    alone(1, 100us);
    return base::Result<amiro::Magnetometer>{amiro::Magnetometer{{1}, {2}, {3}}};
  });
  board.serve<amiro::FloorProximity>([&] {
    const auto claim = i2c.claim();
    alone(1, 200us);
    return base::Result<amiro::FloorProximity>{amiro::FloorProximity{1, 2, 3, 4}};
  });
  std::atomic<std::int32_t> speed{0};
  board.accept<amiro::Motors>([&](const amiro::Motors& motors) {
    alone(2, 5us);
    speed = motors.x;
  });
  std::atomic<int> ticks{0};
  board.every<0>(1ms, Level::urgent, [&] { ++ticks; });
  board.every<1>(3ms, Level::high, [&](const scheduling::Release&) {
    const auto claim = i2c.claim();
    alone(1, 20us);
  });
  REQUIRE(threads.start([&] { board.expire(); }, [&](Level level) { board.run(level); }).ok());

  constexpr Level levels[] = {Level::urgent, Level::high, Level::medium, Level::low};
  std::uint32_t asked = 0;
  for (int i = 0; i < 300; ++i) {
    const Level level = levels[i % 4];
    const auto say = [&](const can::Frame& frame) {
      board.receive(frame, threads.now());
      ++asked;
    };
    say(*protocol::publish_every(amiro::Magnetometer::id, 2ms, controller::priority_of(level)));
    say(*protocol::publish_every(amiro::FloorProximity::id, 3ms,
                                 controller::priority_of(levels[(i + 1) % 4])));
    if (i % 3 == 0) say(protocol::once(amiro::Gyroscope::id, controller::priority_of(level)));
    if (i % 5 == 0) say(protocol::command(amiro::Motors{i + 1, 0}));
    if (i % 50 == 49) {
      board.bus_lost();
      for (int wait = 0; wait < 5000 && speed != 0; ++wait) std::this_thread::sleep_for(1ms);
      CHECK(speed == 0);
    }
    board.writable();
    std::this_thread::sleep_for(1ms);
    if (i % 7 == 0) board.writable();
    CHECK(board.counters().received == asked);
  }
  for (const auto id : {amiro::Magnetometer::id, amiro::FloorProximity::id, amiro::Gyroscope::id}) {
    board.receive(protocol::stop(id), threads.now());
    ++asked;
  }
  // What was running when the stop came may find the bus full, too, and again.
  for (int quiet = 0; quiet < 100; quiet = board.waiting() ? 0 : quiet + 1) {
    board.writable();
    std::this_thread::sleep_for(1ms);
  }
  threads.stop();

  const auto counters = board.counters();
  CHECK(counters.received == asked);
  CHECK(counters.requests + counters.set_points == asked);
  CHECK(counters.sent == bus.frames.size());
  CHECK(counters.bus_lost == 6);
  CHECK(counters.samples > 100);
  CHECK(twice == 0);
  CHECK(ticks + static_cast<int>(board.task_overload(0).missed) > 250);
  CHECK(i2c.contention().claims > 100);
  // Every magnetometer sample is whole, in order, and of one priority.
  unsigned next = 0;
  std::uint32_t priority = 0;
  for (const auto& frame : bus.frames) {
    const unsigned place = frame.id % 256U - amiro::Magnetometer::frames[0].id.value;
    if (place > 2) continue;
    REQUIRE(place == next);
    if (place == 0) priority = frame.id / 256U;
    REQUIRE(frame.id / 256U == priority);
    next = (next + 1) % 3;
  }
  CHECK(next == 0);
}

}  // namespace scheduling_ports_host_threads_test
