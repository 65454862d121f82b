#include "ocm/mapper/app/control.hpp"

#include <cmath>
#include <random>
#include <string>

#include <catch2/catch.hpp>

#include "unit/mapper/app/app_testing.hpp"
#include "unit/motion/near.hpp"

namespace mapper_app_control_test {

using namespace app_testing;
using ocm::test::near;

// [T2 table 13.1, the commands]
TEST_CASE("mapper: a square of set points ends where it should", "[mapper]") {
  for (const RobotModel* model : {&mapper::app::avr_robot, &mapper::app::arduino_robot}) {
    Bench bench{*model};
    bench.parts.left_strength = model == &mapper::app::avr_robot ? 0.95F : 0.85F;
    bench.confirm();
    CAPTURE(model->motors.most_ticks_s);
    motion::Pose ideal;
    struct Leg {
      int degrees, cm;
    };
    for (const Leg leg : {Leg{0, 60}, {90, 130}, {90, 120}, {90, 130}, {85, 52}}) {
      const std::string sentence = "{U," + std::to_string(leg.degrees) + "," + std::to_string(leg.cm) + "}\n";
      REQUIRE(bench.drive(sentence));
      ideal.heading_rad = motion::wrap(ideal.heading_rad + motion::radians(static_cast<float>(leg.degrees)));
      ideal.x_m += static_cast<float>(leg.cm) / 100.0F * std::cos(ideal.heading_rad);
      ideal.y_m += static_cast<float>(leg.cm) / 100.0F * std::sin(ideal.heading_rad);
      const motion::Pose& is = bench.parts.pose;
      CAPTURE(sentence, is.x_m, is.y_m, motion::degrees(is.heading_rad));
      CHECK(near(is, ideal, 0.08F, motion::radians(5.0F)));
      // And the robot knows where it is, better than that.
      CHECK(near(bench.robot.pose(), is, 0.03F, motion::radians(2.0F)));
    }
    CHECK(bench.robot.counters().arrived == 5);
    CHECK(bench.robot.counters().set_points == 5);
  }
}

TEST_CASE("mapper: idle: once at the set point, then each second, never on the way", "[mapper]") {
  Bench bench;
  bench.confirm();
  bench.say("{U,45,20}\n");
  bench.run_for(60ms);
  bench.heard();
  bool spoke = false;
  bench.each_step = [&] { spoke = spoke || (bench.robot.busy() && bench.heard("IDL") > 0); };
  CHECK(bench.run_until([&] { return !bench.robot.busy(); }));
  CHECK_FALSE(spoke);
  bench.each_step = nullptr;
  bench.run_for(50ms);
  CHECK(bench.heard("{S,IDL}\n") == 1);
  bench.run_for(5200ms);
  CHECK(bench.heard("{S,IDL}\n") == 6);
}

TEST_CASE("mapper: a set point that comes with the idle takes it back", "[mapper]") {
  // Whatever the phase, no idle is said between a set point and its end.
  for (int offset = 0; offset < 60; ++offset) {
    Bench bench;
    bench.confirm();
    bench.run_for(900ms + std::chrono::milliseconds{offset * 3});
    bench.say("{U,90,0}\n");
    bench.run_for(21ms);  // heard
    bench.heard();
    bench.run_for(1s);
    CAPTURE(offset);
    CHECK(bench.robot.busy());
    CHECK(bench.heard("IDL") == 0);
  }
}

TEST_CASE("mapper: {U,0,0} stops at once, and says idle", "[mapper]") {
  for (const std::string_view drives : {"{U,0,200}\n", "{U,180,0}\n"}) {
    Bench bench;
    bench.confirm();
    bench.say(drives);
    bench.run_for(700ms);
    CHECK(bench.parts.efforts != motion::Efforts{});
    bench.heard();
    bench.say("{U,0,0}\n");
    bench.run_for(21ms);
    CHECK(bench.parts.efforts == motion::Efforts{});
    CHECK_FALSE(bench.robot.busy());
    bench.run_for(21ms);
    CHECK(bench.heard("{S,IDL}\n") == 1);
    bench.each_step = [&] { CHECK(bench.parts.efforts == motion::Efforts{}); };
    bench.run_for(1s);
  }
}

TEST_CASE("mapper: a new set point on the way is driven from where the robot is", "[mapper]") {
  Bench bench{mapper::app::arduino_robot};
  bench.confirm();
  bench.say("{U,0,200}\n");
  bench.run_for(4s);
  const motion::Pose from = bench.robot.pose();
  CHECK(from.x_m > 0.1F);
  REQUIRE(bench.drive("{U,90,20}\n"));
  CHECK(near(bench.robot.pose().y_m - from.y_m, 0.2F, 0.03F));
  CHECK(near(bench.robot.pose().x_m, from.x_m, 0.04F));
  CHECK(bench.robot.counters().arrived == 1);
  CHECK(bench.robot.counters().set_points == 2);
}

TEST_CASE("mapper: of the way home it keeps 32 places, and counts those before them", "[mapper]") {
  Bench bench{mapper::app::arduino_robot};
  bench.confirm();
  for (int i = 0; i < 32; ++i) REQUIRE(bench.drive("{U,90,10}\n"));
  CHECK(bench.robot.counters().places_forgotten == 0);
  for (int i = 0; i < 2; ++i) REQUIRE(bench.drive("{U,90,10}\n"));
  CHECK(bench.robot.counters().places_forgotten == 2);
}

TEST_CASE("mapper: a control step in which no time has passed is rejected, and counted", "[mapper]") {
  Bench bench;
  bench.confirm();
  bench.say("{U,0,100}\n");
  bench.run_for(1s);
  REQUIRE(bench.robot.busy());
  const scheduling::Release again{.stream = mapper::app::stream(mapper::app::Task::pose_controller)};
  bench.robot.finish(again);  // if it was not its time
  const std::uint32_t before = bench.robot.counters().control_rejected;
  bench.robot.finish(again);
  CHECK(bench.robot.counters().control_rejected == before + 1);
}

TEST_CASE("mapper: of two set points in one packet the second counts, and the first is counted", "[mapper]") {
  Bench bench;
  bench.confirm();
  REQUIRE(bench.drive("{U,0,90}{U,0,20}\n"));
  CHECK(near(bench.parts.pose.x_m, 0.20F, 0.03F));
  CHECK(bench.robot.counters().orders_lost == 1);
}

// [T2 §8.1; docs/decisions/0029]
TEST_CASE("mapper: turns around once for its compass, says how good that is, and keeps what it found",
          "[mapper]") {
  Bench bench;
  bench.parts.own_field = {0.04F, -0.06F};
  bench.confirm();
  bench.say("{C,0}\n");
  bench.run_for(25ms);
  CHECK(bench.heard("{C,0,0,0,0,0,0,0}\n") == 1);
  bench.say("{C,7}\n");
  bench.run_for(25ms);
  CHECK(bench.is(State::calibrating));
  CHECK(bench.heard("{C,7,1,0,0,0,0,0}\n") == 1);
  bench.heard();
  bench.say("{U,0,50}\n{S,PAU}\n{C,8}\n");  // not now
  bench.run_for(3s);
  CHECK(bench.heard("{C,7,1,0,0,0,0,0}\n") == 3);
  bench.heard();
  REQUIRE(bench.run_until([&] { return bench.is(State::confirmed); }, 20s));
  CHECK(bench.robot.counters().refused == 3);
  CHECK(bench.heard("{U") == 0);
  bench.run_for(50ms);
  CHECK(bench.heard("{S,IDL}\n") == 1);
  CHECK(bench.heard("{C,7,2,40,-60,199,0,2}\n") == 1);
  const auto found = bench.robot.compass();
  CHECK(found.verdict == mapper::link::Calibration::good);
  CHECK(near(found.fit.offset.x, 0.04F, 0.003F));
  CHECK(near(found.fit.offset.y, -0.06F, 0.003F));
  REQUIRE(bench.parts.memory.ok());
  CHECK(*bench.parts.memory == found.fit);
  CHECK(bench.robot.locator().calibrated());
  bench.run_for(500ms);
  CHECK(bench.parts.still());
  CHECK(near(bench.parts.pose, {0, 0, bench.parts.pose.heading_rad}, 0.01F, 1));

  // A copy of the word that comes late begins nothing: it says the result again.
  bench.heard();
  bench.say("{C,7}\n{C,7}\n");
  bench.run_for(25ms);
  CHECK(bench.is(State::confirmed));
  CHECK(bench.heard("{C,7,2,40,-60,199,0,2}\n") == 2);
  CHECK(bench.robot.counters().calibrations == 1);
  CHECK(bench.parts.stores == 1);
}

TEST_CASE("mapper: a calibration outlives being switched off, and is used from the first confirmation on",
          "[mapper]") {
  Bench bench;
  bench.parts.own_field = {0.04F, -0.06F};
  bench.parts.memory = sensing::CompassFit{{0.04F, -0.06F}, 0.2F, motion::radians(1.0F)};
  bench.run_for(3s);
  CHECK_FALSE(bench.robot.locator().calibrated());
  bench.link(true);
  bench.run_for(200ms);
  bench.say("{S,CON}\n");
  bench.run_for(50ms);
  CHECK(bench.robot.locator().calibrated());
  bench.heard();
  bench.say("{C,0}\n");
  bench.run_for(25ms);
  CHECK(bench.heard("{C,0,2,40,-60,200,1,2}\n") == 1);
  // It corrects: yellow while the robot rests where the compass is trusted.
  REQUIRE(bench.drive("{U,0,20}\n"));
  bench.run_for(1s);
  CHECK(bench.parts.lights.yellow);
}

TEST_CASE("mapper: without a calibration the compass corrects nothing", "[mapper]") {
  Bench bench;
  bench.parts.own_field = {0.04F, -0.06F};
  bench.confirm();
  REQUIRE(bench.drive("{U,0,20}\n"));
  bench.each_step = [&] { CHECK_FALSE(bench.parts.lights.yellow); };
  bench.run_for(1s);
}

TEST_CASE("mapper: a memory that does not answer: the calibration is used, and said to be until off",
          "[mapper]") {
  Bench bench;
  bench.parts.memory_missing = true;
  bench.confirm();
  bench.say("{C,1}\n");
  REQUIRE(bench.run_until([&] { return bench.heard("{S,IDL}\n") != 0; }, 30s));
  CHECK(bench.heard("{C,1,2,0,0,199,0,1}\n") == 1);
  bench.parts.memory = bench.robot.compass().fit;  // it was busy
  bench.heard();
  bench.say("{C,1}\n");
  bench.run_for(25ms);
  CHECK(bench.heard("{C,1,2,0,0,199,0,2}\n") == 1);
}

TEST_CASE("mapper: how a calibration ends badly is said, with the reason", "[mapper]") {
  RobotModel model = mapper::app::avr_robot;
  model.times.calibration_limit = 20s;
  Bench bench{model};
  bench.confirm();
  const auto verdict = [&](std::string_view expected) {
    bench.say("{C,5}\n");
    bench.run_for(25ms);
    REQUIRE(bench.is(State::calibrating));
    REQUIRE(bench.run_until([&] { return bench.is(State::confirmed); }, 30s));
    bench.run_for(50ms);
    CAPTURE(bench.parts.sent);
    CHECK(bench.heard(expected) == 1);
    CHECK(bench.parts.efforts == motion::Efforts{});
  };
  SECTION("an ellipse: poor, but better than none") {
    bench.parts.soft_iron = 0.2F;
    verdict("{C,5,3,");
    CHECK(bench.robot.locator().calibrated());
    CHECK(bench.parts.stores == 1);
    CHECK(bench.robot.counters().calibrations_failed == 0);
  }
  SECTION("more than that: disturbed, and useless") {
    bench.parts.soft_iron = 0.6F;
    verdict("{C,5,6,");
    CHECK_FALSE(bench.robot.locator().calibrated());
    CHECK(bench.parts.stores == 0);
    CHECK(bench.robot.counters().calibrations_failed == 1);
  }
  SECTION("a field without strength") {
    bench.parts.earth = 0.02F;
    verdict("{C,5,7,0,0,20,0,0}\n");
  }
  SECTION("a compass that says nothing") {
    bench.parts.compass_missing = true;
    verdict("{C,5,8,0,0,0,0,0}\n");
  }
  SECTION("a gyro that says nothing: it does not see itself turn") {
    bench.parts.gyro_missing = true;
    verdict("{C,5,5,0,0,0,0,0}\n");
  }
  SECTION("a good one is not replaced by a poor one") {
    bench.parts.own_field = {0.04F, -0.06F};
    verdict("{C,5,2,40,-60,199,0,2}\n");
    bench.parts.soft_iron = 0.2F;
    bench.say("{C,6}\n");
    REQUIRE(bench.run_until([&] { return bench.heard("{C,6,3,") != 0; }, 30s));
    CHECK(bench.robot.locator().offset() == bench.parts.memory->offset);
    CHECK(near(bench.robot.locator().offset().x, 0.04F, 0.003F));
    CHECK(bench.parts.stores == 1);
  }
}

TEST_CASE("mapper: a calibration that does not end is given up with the first step behind its limit",
          "[mapper]") {
  RobotModel model = mapper::app::avr_robot;
  model.times.calibration_limit = 600ms;  // 20 steps
  Bench bench{model};
  bench.confirm();
  bench.parts.compass_missing = true;
  bench.say("{C,5}\n");
  REQUIRE(bench.run_until([&] { return bench.is(State::calibrating); }, 1s));
  const base::Duration past = bench.now.time_since_epoch() % 30ms;
  const base::Time first = bench.now + (past == 0ms ? base::Duration{} : base::Duration{30ms} - past);
  REQUIRE(bench.run_until([&] { return bench.is(State::confirmed); }, 2s));
  CHECK(bench.now - first == 630ms);
}

TEST_CASE("mapper: a calibration can be stopped, and that is reported", "[mapper]") {
  Bench bench;
  bench.confirm();
  bench.say("{C,1}\n");
  bench.run_for(1s);
  CHECK(bench.parts.efforts != motion::Efforts{});
  SECTION("{U,0,0}") {
    bench.say("{U,0,0}\n");
    bench.run_for(25ms);
    CHECK(bench.is(State::confirmed));
    bench.say("{C,1}\n");
    bench.run_for(25ms);
    CHECK(bench.heard("{C,1,4,0,0,0,0,0}\n") == 1);
  }
  SECTION("a lost link") {
    bench.link(false);
    CHECK(bench.is(State::advertising));
    CHECK(bench.robot.compass().verdict == mapper::link::Calibration::stopped);
  }
  CHECK(bench.parts.efforts == motion::Efforts{});
  bench.each_step = [&] { CHECK(bench.parts.efforts == motion::Efforts{}); };
  bench.run_for(500ms);
  CHECK_FALSE(bench.robot.locator().calibrated());
}

TEST_CASE("mapper: stopped and begun again at once, it turns around all of the way", "[mapper]") {
  Bench bench;
  bench.parts.own_field = {0.04F, -0.06F};
  bench.confirm();
  bench.say("{C,1}\n");
  bench.run_for(5s);
  bench.preempt("{U,0,0}{C,2}\n");  // between two steps of the pose controller
  REQUIRE(bench.is(State::calibrating));
  const base::Time begun = bench.now;
  REQUIRE(bench.run_until([&] { return bench.is(State::confirmed); }, 30s));
  CHECK(bench.now - begun > 6s);
  bench.run_for(50ms);
  CHECK(bench.heard("{C,2,2,40,-60,199,0,2}\n") == 1);
}

TEST_CASE("mapper: time is measured: a robot whose tasks come late ends at the same place", "[mapper]") {
  RobotModel model = mapper::app::arduino_robot;
  Bench bench{model};
  bench.confirm();
  // Between steps the processor is taken away for up to 40 ms, as often as not.
  std::mt19937 random{9};
  bench.say("{U,90,60}\n");
  bench.run_for(30ms);
  for (int i = 0; i < 5000 && bench.robot.busy(); ++i) {
    const auto away = std::chrono::milliseconds{random() % 2 == 0 ? random() % 40 : 0};
    for (const base::Time end = bench.now + away; bench.now < end; bench.now += 1ms) bench.parts.step();
    bench.step();
  }
  CHECK_FALSE(bench.robot.busy());
  CHECK(bench.robot.counters().overload.missed > 10);
  CHECK(bench.robot.counters().overload.late > 0);
  CHECK(near(bench.parts.pose, {0, 0.6F, motion::pi / 2}, 0.04F, motion::radians(5.0F)));
  CHECK(near(bench.robot.pose(), bench.parts.pose, 0.02F, motion::radians(2.0F)));
}

}  // namespace mapper_app_control_test
