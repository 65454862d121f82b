#include "ocm/mapper/app/robot.hpp"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/mapper/app/app_testing.hpp"
#include "unit/motion/near.hpp"

namespace mapper_app_robot_test {

using namespace app_testing;
using ocm::test::near;

// [T2 §6.3]
TEST_CASE("mapper: advertising: motors off, tower at 0, a green flash every two seconds", "[mapper]") {
  Bench bench;
  int flashes = 0;
  bool lit = false;
  bench.each_step = [&] {
    CHECK(bench.parts.efforts == motion::Efforts{});
    CHECK_FALSE(bench.parts.lights.yellow);
    flashes += bench.parts.lights.green && !lit ? 1 : 0;
    lit = bench.parts.lights.green;
  };
  bench.run_for(10s - 1ms);
  CHECK(flashes == 5);
  CHECK(bench.parts.servo_deg == 0);
  CHECK(bench.parts.sent.empty());
  CHECK(bench.is(State::advertising));
}

TEST_CASE("mapper: confirmed, it tells where it is five times a second", "[mapper]") {
  Bench bench;
  bench.confirm();
  bench.run_for(10s);
  const auto told = updates(bench.heard());
  CHECK(told.size() == 50);
  for (const mapper::link::Update& update : told) {
    CHECK(update.x == 0);
    CHECK(update.heading == 0);
    CHECK(update.s1 == 0);
  }
  CHECK(bench.robot.counters().updates == 50);
}

// [T2 table 6.1]
TEST_CASE("mapper: the tower: small steps waiting, large ones driving, still while it rotates", "[mapper]") {
  Bench bench;
  bench.confirm();
  bench.run_for(2s);
  auto told = updates(bench.heard());
  for (std::size_t i = 1; i < told.size(); ++i) CHECK(std::abs(told[i].servo - told[i - 1].servo) == 2);

  bench.say("{U,180,0}\n");
  bench.run_for(300ms);
  bench.heard();
  bench.run_for(2s);
  told = updates(bench.heard());
  CHECK(told.size() == 10);
  CHECK(told.front().heading + 40 < told.back().heading);
  for (const auto& update : told) CHECK(update.servo == told.front().servo);
  CHECK(bench.run_until([&] { return !bench.robot.busy(); }));

  bench.say("{U,0,80}\n");
  bench.run_for(300ms);
  bench.heard();
  bench.run_for(4s);
  told = updates(bench.heard());
  int large = 0;
  for (std::size_t i = 1; i < told.size(); ++i)
    large += std::abs(told[i].servo - told[i - 1].servo) == 10 ? 1 : 0;
  CHECK(large >= 17);  // of 19: at an end it may be less
}

TEST_CASE("mapper: what the update says of a sensor is where the tower was when it looked", "[mapper]") {
  Bench bench;
  // A wall all round, whose distance tells the direction: 20 cm ahead to 65 cm behind.
  bench.parts.distance = [](float angle) { return 20.0F + 45.0F * std::fabs(angle) / motion::pi; };
  bench.confirm();
  bench.run_for(5s);
  for (const mapper::link::Update& update : updates(bench.heard())) {
    const auto expected = [&](int sensor) {
      const float angle = motion::wrap(motion::radians(static_cast<float>(update.servo + 90 * sensor)));
      return static_cast<int>(20.0F + 45.0F * std::fabs(angle) / motion::pi + 0.5F);
    };
    CHECK(std::abs(update.s1 - expected(0)) <= 1);
    CHECK(std::abs(update.s2 - expected(1)) <= 1);
    CHECK(std::abs(update.s3 - expected(2)) <= 1);
    CHECK(std::abs(update.s4 - expected(3)) <= 1);
  }
}

// [T2 §6.3]
TEST_CASE("mapper: yellow while the compass corrects at rest, where it was calibrated", "[mapper]") {
  for (const bool calibrated : {true, false}) {
    Bench bench{calibrated ? mapper::app::calibrated(mapper::app::avr_robot, {}) : mapper::app::avr_robot};
    bench.confirm();
    bench.run_for(1s);
    CHECK(bench.parts.lights == green);  // it has not driven yet: nothing is known of the place
    bench.say("{U,0,30}\n");
    bench.run_for(2s);
    CHECK(bench.parts.lights == green);  // it drives
    REQUIRE(bench.run_until([&] { return !bench.robot.busy(); }));
    bench.run_for(1s);
    CHECK(bench.parts.lights == (calibrated ? both : green));
  }
}

// [T2 §6.2, "Pause"; table 4.4]
TEST_CASE("mapper: paused: idle at once, no update, and set points are still obeyed", "[mapper]") {
  Bench bench;
  bench.confirm();
  bench.run_for(1s);
  bench.heard();
  bench.say("{S,PAU}\n");
  bench.run_for(25ms);
  CHECK(bench.is(State::paused));
  CHECK(bench.heard("{S,IDL}\n") == 1);
  bench.heard();
  const auto servo = bench.parts.servo_deg;
  bench.run_for(200ms);
  CHECK(bench.parts.lights == both);
  REQUIRE(bench.drive("{U,90,30}\n"));
  CHECK(near(bench.parts.pose, {0, 0.3F, motion::pi / 2}, 0.03F, motion::radians(4.0F)));
  bench.run_for(50ms);
  CHECK(bench.heard("{S,IDL}\n") == 1);
  bench.run_for(3s);
  CHECK(bench.heard("{U") == 0);
  CHECK(bench.parts.servo_deg == servo);
  bench.heard();
  bench.say("{S,UNP}\n");
  bench.run_for(1s);
  CHECK(bench.is(State::confirmed));
  CHECK(bench.heard("{U") >= 4);
  CHECK(bench.parts.servo_deg != servo);
}

// [T2 §8.5, listing 8.2]
TEST_CASE("mapper: stops in front of a wall, says idle, and can be sent elsewhere", "[mapper]") {
  for (const int way : {1, -1}) {
    for (const RobotModel* model : {&mapper::app::avr_robot, &mapper::app::arduino_robot}) {
      Bench bench{*model};
      bench.confirm();
      // A wall 60 cm from the start, across; seen from the middle of the robot.
      bench.parts.distance = [&bench, way](float angle) {
        const float towards = static_cast<float>(way) * std::cos(angle);
        return towards > 0.1F ? (0.6F - static_cast<float>(way) * bench.parts.pose.x_m) * 100.0F / towards
                              : 200.0F;
      };
      REQUIRE(bench.drive(way > 0 ? "{U,0,100}\n" : "{U,0,-100}\n"));
      CAPTURE(way, bench.parts.pose.x_m);
      CHECK(std::fabs(bench.parts.pose.x_m) > 0.40F);
      CHECK(std::fabs(bench.parts.pose.x_m) < 0.52F);
      bench.run_for(50ms);
      CHECK(bench.heard("{S,IDL}\n") == 1);
      CHECK(bench.robot.counters().collisions >= 1);
      CHECK(bench.robot.counters().arrived == 0);
      bench.run_for(300ms);
      CHECK(bench.parts.still());
      const std::uint32_t before = bench.robot.counters().collisions;
      REQUIRE(bench.drive("{U,90,0}\n"));  // turning is allowed
      REQUIRE(bench.drive("{U,0,20}\n"));
      CHECK(bench.robot.counters().collisions == before);
      CHECK(near(std::fabs(bench.parts.pose.y_m), 0.2F, 0.03F));
    }
  }
}

TEST_CASE("mapper: paused, it still stops in front of things", "[mapper]") {
  Bench bench;
  bench.confirm();
  bench.say("{S,PAU}\n");
  bench.parts.distance = [&bench](float angle) {
    return std::cos(angle) > 0.1F ? (0.6F - bench.parts.pose.x_m) * 100.0F / std::cos(angle) : 200.0F;
  };
  REQUIRE(bench.drive("{U,0,100}\n"));
  CHECK(bench.parts.pose.x_m < 0.55F);
  CHECK(bench.robot.counters().collisions >= 1);
  CHECK(bench.heard("{U") == 0);
}

/// Runs `f` once, in the middle of the tower's next look.
template <class F>
void within_a_look(Bench& bench, F f) {
  bool done = false;
  bench.parts.on_infrared = [&] {
    if (!std::exchange(done, true)) f();
  };
  REQUIRE(bench.run_until([&] { return done; }, 1s));
  bench.parts.on_infrared = nullptr;
}

TEST_CASE("mapper: paused while the tower looks, it keeps what it saw to itself", "[mapper]") {
  Bench bench;
  bench.confirm();
  bench.run_for(1s);
  within_a_look(bench, [&] {
    bench.preempt("{S,PAU}\n");
    bench.heard();
  });
  CHECK(bench.is(State::paused));
  bench.run_for(1s);
  CHECK(bench.heard("{U") == 0);
  CHECK(bench.robot.counters().unsent == 1);
}

TEST_CASE("mapper: a set point that comes while the tower sees a wall is not taken for the old one",
          "[mapper]") {
  using scheduling::Level;
  // Communication has heard it; then the pose controller drives to it already.
  for (const auto& [order, least] : {std::pair{"{U,90,0}\n", Level::high},
                                     {"{U,0,0}{U,90,0}\n", Level::high},
                                     {"{U,90,0}\n", Level::medium}}) {
    Bench bench;
    bench.confirm();
    bench.say("{U,0,100}\n");
    bench.run_for(3s);
    bench.run_until([&] { return bench.parts.servo_deg == 0; }, 10s);
    bench.run_for(150ms);
    bench.parts.distance = [](float) { return 12.0F; };  // of a sudden, all round
    within_a_look(bench, [&, order = order, least = least] { bench.preempt(order, least); });
    bench.parts.distance = [](float) { return 200.0F; };
    REQUIRE(bench.run_until([&] { return !bench.robot.busy(); }, 20s));
    CHECK(bench.robot.counters().collisions == 1);
    CHECK(bench.robot.counters().orders_lost == 0);
    CHECK(near(bench.parts.pose.heading_rad, motion::pi / 2, motion::radians(4.0F)));
  }
}

// [T2 §6.3, "Initialiseringsfeil"]
TEST_CASE("mapper: gyro or compass missing from the start: a fault, until it answers", "[mapper]") {
  for (const bool gyro : {true, false}) {
    Bench bench;
    bool& missing = gyro ? bench.parts.gyro_missing : bench.parts.compass_missing;
    missing = true;
    bench.run_for(500ms);
    CHECK(bench.is(State::initialisation_fault));
    CHECK(bench.parts.lights == yellow);
    bench.link(true);
    bench.run_for(3s);
    bench.say("{S,CON}\n{U,0,100}\n");
    bench.run_for(1s);
    CHECK(bench.parts.sent.empty());
    CHECK(bench.parts.efforts == motion::Efforts{});
    CHECK(bench.is(State::initialisation_fault));
    CHECK((gyro ? bench.robot.counters().gyro : bench.robot.counters().compass) > 100);
    missing = false;
    bench.run_for(2200ms);
    CHECK(bench.is(State::connected));
    CHECK(bench.heard(handshake) == 1);
  }
}

TEST_CASE("mapper: parts that fail later are counted, and it drives on", "[mapper]") {
  Bench bench;
  bench.confirm();
  bench.parts.gyro_missing = bench.parts.compass_missing = true;
  bench.parts.infrared_missing = {true, true, true, true};
  REQUIRE(bench.drive("{U,90,30}\n"));
  CHECK(near(bench.parts.pose, {0, 0.3F, motion::pi / 2}, 0.04F, motion::radians(4.0F)));
  const auto counters = bench.robot.counters();
  CHECK(counters.gyro > 100);
  CHECK(counters.compass > 100);
  CHECK(counters.infrared > 20);
  CHECK(counters.estimator.gyro > 10);
  CHECK(bench.is(State::confirmed));
  for (const mapper::link::Update& update : updates(bench.heard()))
    CHECK(update.s1 + update.s2 + update.s3 + update.s4 == 0);
}

TEST_CASE("mapper: nothing of a robot at rest is left out; ticks that no wheel makes are, and counted",
          "[mapper]") {
  Bench bench;
  bench.confirm();
  CHECK(bench.robot.counters().estimator == motion::EstimatorCounters{});
  CHECK(bench.robot.counters().ticks_rejected == 0);
  bench.parts.left_ticks += 500;
  bench.run_for(100ms);
  CHECK(bench.robot.counters().ticks_rejected == 1);
  CHECK(bench.robot.pose() == motion::Pose{});
}

TEST_CASE("mapper: where no sentence holds its place it says none, and counts that", "[mapper]") {
  RobotModel model = mapper::app::avr_robot;
  model.estimator.drive.wheel_radius_m = 33.0F;  // a tick is a metre
  Bench bench{model};
  bench.confirm();
  for (int i = 0; i < 6; ++i) {
    bench.parts.left_ticks += 60;
    bench.parts.right_ticks += 60;
    bench.run_for(30ms);
  }
  CHECK(bench.robot.pose().x_m > 327.0F);
  bench.heard();
  const std::uint32_t before = bench.robot.counters().out_of_range;
  bench.run_for(1s);
  CHECK(bench.heard("{U") == 0);
  CHECK(bench.robot.counters().out_of_range == before + 5);
}

TEST_CASE("mapper: commands that movement does not come to take are counted", "[mapper]") {
  Bench bench;
  bench.confirm();
  const std::uint32_t before = bench.robot.counters().commands_lost;
  for (int ms = 0; ms < 100; ++ms) {
    bench.port.advance(bench.now += 1ms);
    if (bench.port.armed() <= bench.now) bench.robot.expire();
    for (scheduling::Level level; bench.port.take_pended(level);)
      if (level != scheduling::Level::high) bench.robot.run(level);
  }
  CHECK(bench.robot.counters().commands_lost - before >= 2);  // of three steps of the pose controller
}

TEST_CASE("mapper: motors without commands are switched off", "[mapper]") {
  Bench bench;
  bench.confirm();
  bench.say("{U,0,200}\n");
  bench.run_for(2s);
  CHECK(bench.parts.efforts != motion::Efforts{});
  // The medium level hangs: the pose controller is never run again.
  const auto without_medium = [&](base::Duration time) {
    for (const base::Time end = bench.now + time; bench.now < end;) {
      bench.now += 1ms;
      bench.parts.step();
      bench.port.advance(bench.now);
      if (bench.port.armed() <= bench.now) bench.robot.expire();
      for (scheduling::Level level; bench.port.take_pended(level);)
        if (level != scheduling::Level::medium) bench.robot.run(level);
    }
  };
  // Movement took the last command 10 ms ago; 200 ms later that still counts, and with its next job no more.
  bench.run_until([&] { return bench.now.time_since_epoch() % 60ms == 50ms; });
  without_medium(209ms);
  CHECK(bench.parts.efforts != motion::Efforts{});
  without_medium(1ms);
  CHECK(bench.parts.efforts == motion::Efforts{});
  without_medium(60ms);
  CHECK(bench.robot.counters().motors_starved == 1);
  CHECK(bench.robot.counters().control_skipped >= 6);
}

TEST_CASE("mapper: idle time, where the port has none: all that no job took", "[mapper]") {
  Bench bench;
  bench.run_for(2s);
  CHECK(bench.robot.uptime() == 2s);
  CHECK(bench.robot.idle() == 2s);  // in this port jobs take no time
}

TEST_CASE("mapper: idle time, where jobs take some: without it", "[mapper]") {
  Bench bench;
  int looks = 0;
  bench.parts.on_ticks = [&] {  // by estimator and movement, once a job
    ++looks;
    bench.port.advance(bench.now += 1ms);
  };
  bench.run_for(2s);
  CHECK(looks > 100);
  CHECK(bench.robot.idle() == bench.robot.uptime() - looks * 1ms);
}

/// A port that measures its idle time itself.
struct MeasuringPort : scheduling::Cooperative {
  [[nodiscard]] base::Duration idle() const { return idle_time; }
  base::Duration idle_time{5s};
};

TEST_CASE("mapper: idle time and uptime count from its start, not from the clock's", "[mapper]") {
  IdealParts parts{mapper::app::avr_robot};
  scheduling::Cooperative port{base::Time{5s}};
  mapper::app::Robot<IdealParts, scheduling::Cooperative> robot{parts, port, mapper::app::avr_robot};
  parts.efforts = {1.0F, 1.0F};
  parts.lights = both;
  robot.start();
  CHECK(parts.efforts == motion::Efforts{});  // at once
  CHECK(parts.lights == green);
  CHECK(parts.servo_deg == 0);
  port.advance(base::Time{7s});
  CHECK(robot.uptime() == 2s);
  CHECK(robot.idle() == 2s);
  MeasuringPort measuring;
  mapper::app::Robot<IdealParts, MeasuringPort> measured{parts, measuring, mapper::app::avr_robot};
  measured.start();
  measuring.idle_time = 7s;
  CHECK(measured.idle() == 2s);
}

}  // namespace mapper_app_robot_test
