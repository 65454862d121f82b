// The mapper's application in real time: a thread a level, mutexes with priority inheritance, interrupts
// from threads that know nothing of either. Nothing is said of how fast it is.
#include <atomic>
#include <chrono>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include <catch2/catch.hpp>

#include "ocm/mapper/app/robot.hpp"
#include "ocm/scheduling/ports/host_threads.hpp"

#include "unit/mapper/app/app_testing.hpp"

namespace scheduling_ports_host_threads_mapper_test {

using namespace app_testing;
using scheduling::ports::HostMutex;
using scheduling::ports::HostThreads;

/// Ideal parts that several threads may ask.
class SharedParts {
 public:
  explicit SharedParts(const RobotModel& model) : parts_(model) {}

  template <class F>
  auto locked(F f) {
    const std::lock_guard guard{mutex_};
    return f(parts_);
  }

  auto ticks() {
    return locked([](IdealParts& parts) { return parts.ticks(); });
  }
  auto gyro() {
    return locked([](IdealParts& parts) { return parts.gyro(); });
  }
  auto field() {
    return locked([](IdealParts& parts) { return parts.field(); });
  }
  auto infrared(std::size_t sensor) {
    return locked([=](IdealParts& parts) { return parts.infrared(sensor); });
  }
  void drive(motion::Efforts efforts) {
    locked([=](IdealParts& parts) { parts.drive(efforts); });
  }
  void turn_tower(std::int32_t degrees) {
    locked([=](IdealParts& parts) { parts.turn_tower(degrees); });
  }
  void show(mapper::app::Lights lights) {
    locked([=](IdealParts& parts) { parts.show(lights); });
  }
  auto linked() {
    return locked([](IdealParts& parts) { return parts.linked(); });
  }
  auto send(std::span<const std::uint8_t> bytes) {
    return locked([=](IdealParts& parts) { return parts.send(bytes); });
  }
  void store(const sensing::CompassFit& fit) {
    locked([&](IdealParts& parts) { parts.store(fit); });
  }
  auto stored() {
    return locked([](IdealParts& parts) { return parts.stored(); });
  }

 private:
  std::mutex mutex_;
  IdealParts parts_;
};
static_assert(mapper::app::RobotParts<SharedParts>);

/// The robot, its threads, and one that moves the world.
struct Running {
  explicit Running(const RobotModel& given) : model(given), parts(model), robot(parts, threads, model) {
    robot.start();
    REQUIRE(threads.start([this] { robot.expire(); }, [this](scheduling::Level level) { robot.run(level); })
                .ok());
    world = std::thread{[this] {
      auto next = std::chrono::steady_clock::now();
      while (!ended) {
        parts.locked([](IdealParts& ideal) { ideal.step(); });
        std::this_thread::sleep_until(next += 1ms);
      }
    }};
  }
  ~Running() {
    threads.stop();
    ended = true;
    world.join();
  }

  /// Within a minute: a machine may have other things to do.
  template <class F>
  bool wait_until(F so) {
    for (int i = 0; i < 12'000 && !so(); ++i) std::this_thread::sleep_for(5ms);
    return so();
  }
  bool wait_for(State state) {
    return wait_until([&] { return robot.state() == state; });
  }
  bool wait_for(std::string_view said) {
    return wait_until([&] {
      return parts.locked([&](IdealParts& ideal) { return ideal.sent.find(said) != std::string::npos; });
    });
  }
  void say(std::string_view text) {
    for (const char c : text) robot.receive(static_cast<std::uint8_t>(c));
  }
  void link(bool up) {
    parts.locked([up](IdealParts& ideal) { ideal.link = up; });
    robot.link_changed();
  }
  void forget() {
    parts.locked([](IdealParts& ideal) { ideal.sent.clear(); });
  }

  RobotModel model;
  HostThreads threads{{.real_time = false}};
  SharedParts parts;
  mapper::app::Robot<SharedParts, HostThreads, HostMutex> robot;
  std::atomic<bool> ended = false;
  std::thread world;
};

RobotModel quick() {
  RobotModel model = mapper::app::arduino_robot;
  model.measuring.samples = 8;
  model.times.idle = 200ms;
  return model;
}

TEST_CASE("host threads: a mapper shakes hands, drives, arrives and idles in real time", "[host_threads]") {
  Running running{quick()};
  CHECK(running.robot.state() == State::advertising);
  running.link(true);
  REQUIRE(running.wait_for("{H,"));
  running.say("{S,CON}\n");
  REQUIRE(running.wait_for(State::confirmed));
  REQUIRE(running.wait_for("{U,0,0,0,"));
  running.say("{U,30,4}\n");
  REQUIRE(running.wait_until([&] { return running.robot.counters().set_points == 1; }));
  running.forget();
  REQUIRE(running.wait_until([&] { return running.robot.counters().arrived == 1; }));
  REQUIRE(running.wait_for("{S,IDL}"));
  const motion::Pose pose = running.parts.locked([](IdealParts& ideal) { return ideal.pose; });
  CHECK(pose.heading_rad > motion::radians(20.0F));
  CHECK(pose.heading_rad < motion::radians(40.0F));
  CHECK(pose.x_m > 0.01F);
  CHECK(running.robot.contention().claims > 100);
  CHECK(running.robot.idle() > base::Duration{0});
  CHECK(running.robot.idle() < running.robot.uptime());
}

TEST_CASE("host threads: links that come and go while it drives: motors off when the interrupt returns",
          "[host_threads]") {
  Running running{quick()};
  for (int i = 0; i < 20; ++i) {
    running.link(true);
    REQUIRE(running.wait_for("{H,"));
    running.say("{S,CON}\n{U,90,50}\n");
    REQUIRE(running.wait_until([&] {
      return running.parts.locked([](IdealParts& ideal) { return ideal.efforts != motion::Efforts{}; });
    }));
    std::this_thread::sleep_for(std::chrono::milliseconds{i * 3});  // at any point of the drive
    running.link(false);
    for (int look = 0; look < 40; ++look) {  // and they stay off, whatever was under way
      CHECK(running.parts.locked([](IdealParts& ideal) { return ideal.efforts == motion::Efforts{}; }));
      std::this_thread::sleep_for(1ms);
    }
    running.forget();
  }
  CHECK(running.robot.counters().links_lost == 20);
  CHECK(running.robot.counters().refused == 0);
}

}  // namespace scheduling_ports_host_threads_mapper_test
