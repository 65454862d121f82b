// What the tasks share, in the moment that matters most: the link dies, at any time, and what was said,
// ordered or decided before is void.
#include "ocm/mapper/app/shared.hpp"

#include <cmath>
#include <string>
#include <utility>

#include <catch2/catch.hpp>

#include "ocm/mapper/app/robot.hpp"

#include "unit/base/explore.hpp"
#include "unit/mapper/app/app_testing.hpp"
#include "unit/motion/near.hpp"

namespace mapper_app_shared_test {

using namespace app_testing;
using ocm::test::coarser;
using ocm::test::near;

void never_drives(Bench& bench, base::Duration time) {
  bench.each_step = [&] { REQUIRE(bench.parts.efforts == motion::Efforts{}); };
  bench.run_for(time);
  bench.each_step = nullptr;
}

TEST_CASE("mapper: the link dies in any millisecond of a drive: motors off before the interrupt ends",
          "[mapper][link]") {
  for (const RobotModel* model : {&mapper::app::avr_robot, &mapper::app::arduino_robot}) {
    for (int ms = 0; ms < 300; ms += coarser(13)) {
      Bench bench{*model};
      bench.confirm();
      bench.say("{U,10,100}\n");
      bench.run_for(2s + std::chrono::milliseconds{ms});
      const int drives = bench.parts.drives;
      bench.parts.link = false;
      CAPTURE(ms);
      bench.robot.link_changed();
      REQUIRE(bench.parts.drives > drives);
      REQUIRE(bench.parts.efforts == motion::Efforts{});
      REQUIRE(bench.is(State::advertising));
      never_drives(bench, 300ms);
    }
  }
}

TEST_CASE("mapper: the link dies in the middle of a job: what the job was about to do does not happen",
          "[mapper][link]") {
  // `ticks` is what movement and estimator ask for first; the interrupt comes there, the nth time.
  int fell_in_movement = 0;
  for (int nth = 1; nth <= 60; ++nth) {
    Bench bench;
    bench.confirm();
    bench.say("{U,0,100}\n");
    bench.run_for(1s);
    REQUIRE(bench.parts.efforts != motion::Efforts{});
    int count = 0;
    bench.parts.on_ticks = [&] {
      if (++count != nth) return;
      bench.parts.link = false;
      bench.robot.link_changed();
      REQUIRE(bench.parts.efforts == motion::Efforts{});
    };
    bench.each_step = [&] { REQUIRE((count < nth || bench.parts.efforts == motion::Efforts{})); };
    bench.run_for(2s);
    CHECK(count > nth);
    fell_in_movement += bench.robot.counters().commands_stale > 0 ? 1 : 0;
  }
  CHECK(fell_in_movement > 10);
}

TEST_CASE("mapper: the link dies while the tower looks: what it saw is not said", "[mapper][link]") {
  for (const bool again : {false, true}) {  // there is a new link already, not confirmed
    Bench bench;
    bench.confirm();
    bench.run_for(1s);
    bench.heard();
    bool done = false;
    bench.parts.on_infrared = [&] {
      if (std::exchange(done, true)) return;
      bench.link(false);
      if (again) bench.link(true);
    };
    REQUIRE(bench.run_until([&] { return done; }, 1s));
    CHECK(bench.heard("{U") == 0);
    CHECK(bench.robot.counters().unsent == 1);
  }
}

TEST_CASE("mapper: a dead link without a report is found by supervision", "[mapper][link]") {
  Bench bench;
  bench.confirm();
  bench.say("{U,0,100}\n");
  bench.run_for(1s);
  bench.parts.link = false;  // no interrupt
  bench.run_for(101ms);
  CHECK(bench.is(State::advertising));
  CHECK(bench.parts.efforts == motion::Efforts{});
}

TEST_CASE("mapper: without a link it says nothing, parks its tower and advertises", "[mapper][link]") {
  Bench bench;
  bench.confirm();
  bench.run_for(2s);
  CHECK(bench.parts.servo_deg > 0);
  bench.link(false);
  bench.heard();
  bench.run_for(5s);
  CHECK(bench.parts.sent.empty());
  CHECK(bench.parts.servo_deg == 0);
  CHECK(bench.robot.counters().links_lost == 1);
  CHECK_FALSE(bench.parts.lights.yellow);
}

TEST_CASE("mapper: what came from the dead link is never obeyed", "[mapper][link]") {
  SECTION("a sentence that was received and not yet looked at") {
    Bench bench;
    bench.confirm();
    bench.say("{U,0,100}\n");
    bench.link(false);
    bench.link(true);
    bench.say("{S,CON}\n");
    bench.run_for(50ms);
    CHECK(bench.is(State::confirmed));
    never_drives(bench, 1s);
    CHECK(bench.robot.counters().input_dropped == 10);
    CHECK(bench.robot.counters().set_points == 0);
  }
  SECTION("a set point that was heard and not yet begun") {
    Bench bench;
    bench.confirm();
    bench.run_until([&] { return bench.now.time_since_epoch() % 30ms == 1ms; });  // just after a control step
    bench.run_for(1ms);
    bench.say("{U,0,100}\n");
    bench.run_for(20ms);
    const bool begun = bench.robot.counters().set_points != 0;
    bench.link(false);
    bench.link(true);
    bench.say("{S,CON}\n");
    bench.run_for(50ms);
    never_drives(bench, 1s);
    CHECK((begun || bench.robot.counters().orders_lost == 1));
  }
  SECTION("an arrival, whose idle was not said yet") {
    // Communication has just run when the robot arrives: idle has to wait for its next job.
    Bench bench;
    bench.confirm();
    bench.say("{U,20,0}\n");
    bench.run_for(50ms);
    bool pending = false;
    while (!pending) {
      if (bench.now.time_since_epoch() % 7ms == 0ms) bench.say("{}\n");
      bench.heard();
      bench.step();
      if (bench.robot.busy()) continue;
      pending = bench.heard("IDL") == 0;
      REQUIRE(pending);
    }
    bench.link(false);
    bench.heard();
    bench.link(true);
    bench.say("{S,CON}\n");
    bench.run_for(500ms);
    CHECK(bench.is(State::confirmed));
    CHECK(bench.heard("IDL") == 0);
  }
  SECTION("the beginning of a sentence, of which the next link brings an end") {
    Bench bench;
    bench.confirm();
    bench.say("{U,0,1");
    bench.run_for(150ms);  // supervision has fetched it
    bench.link(false);
    bench.link(true);
    bench.say("00}\n{S,CON}\n");
    bench.run_for(50ms);
    CHECK(bench.is(State::confirmed));
    never_drives(bench, 1s);
    CHECK(bench.robot.counters().damaged.headless == 1);
  }
}

TEST_CASE("mapper: nothing that was meant for the dead link is said to the next", "[mapper][link]") {
  // At each phase of the tasks: after the new link is up, handshakes alone until it is confirmed.
  for (int ms = 0; ms < 200; ms += 3) {
    Bench bench;
    bench.confirm();
    bench.say("{S,BIN}\n{U,30,0}\n");
    bench.run_for(500ms + std::chrono::milliseconds{ms});
    bench.link(false);
    bench.heard();
    bench.link(true);
    bench.run_for(1500ms);
    CAPTURE(ms);
    const std::string said = bench.heard();
    CHECK(said == "{H,20,20,1,3,0,90,180,270,5000,20225,3}\n{H,20,20,1,3,0,90,180,270,5000,20225,3}\n");
    bench.say("{S,CON}\n");
    bench.run_for(1s);
    CHECK(bench.heard("{U,0,0,0,") > 3);  // from 0, and as text
  }
}

TEST_CASE("mapper: the pose lives on until the next operator confirms", "[mapper][link]") {
  Bench bench{mapper::app::arduino_robot};
  bench.confirm();
  REQUIRE(bench.drive("{U,90,40}\n"));
  bench.link(false);
  bench.run_for(5s);
  CHECK(near(bench.robot.pose(), {0, 0.4F, motion::pi / 2}, 0.03F, motion::radians(3.0F)));
  bench.link(true);
  bench.run_for(500ms);
  CHECK(near(bench.robot.pose(), {0, 0.4F, motion::pi / 2}, 0.03F, motion::radians(3.0F)));
  bench.say("{S,CON}\n");
  bench.run_for(25ms);
  CHECK(near(bench.robot.pose(), {}, 0.001F, 0.01F));
  // And what it drives is relative to there.
  REQUIRE(bench.drive("{U,-90,30}\n"));
  CHECK(near(bench.robot.pose(), {0, -0.3F, -motion::pi / 2}, 0.03F, motion::radians(3.0F)));
  CHECK(near(bench.parts.pose, {0.3F, 0.4F, 0}, 0.04F, motion::radians(4.0F)));
}

RobotModel returning() {
  RobotModel model = mapper::app::arduino_robot;
  model.times.return_after = 3s;
  return model;
}

TEST_CASE("mapper: comes home the way it came, where that is enabled", "[mapper][link]") {
  Bench bench{returning()};
  bench.confirm();
  REQUIRE(bench.drive("{U,0,60}\n"));
  bench.say("{U,90,60}\n");
  bench.run_for(8s);  // and in the middle of a leg
  CHECK(bench.parts.pose.y_m > 0.15F);
  bench.link(false);
  never_drives(bench, 2900ms);
  CHECK(bench.is(State::advertising));
  bench.run_for(300ms);
  CHECK(bench.is(State::returning));
  float corner = 1e9F;
  bench.each_step = [&] {
    corner = std::min(corner, std::hypot(bench.parts.pose.x_m - 0.6F, bench.parts.pose.y_m));
  };
  REQUIRE(bench.run_until([&] { return bench.is(State::advertising); }, 120s));
  CHECK(corner < 0.05F);
  CHECK(std::hypot(bench.parts.pose.x_m, bench.parts.pose.y_m) < 0.06F);
  CHECK(bench.robot.counters().returns == 1);
  CHECK(bench.robot.counters().returns_blocked == 0);
  CHECK(bench.parts.sent.find("IDL", bench.parts.sent.size() - 1) == std::string::npos);
  never_drives(bench, 20s);  // once
}

TEST_CASE("mapper: the way home begins when the link has been gone for so long, to the millisecond",
          "[mapper][link]") {
  Bench bench{returning()};
  bench.confirm();
  bench.run_for(50ms);  // to a moment at which supervision looks
  bench.link(false);
  bench.run_for(3s - 1ms);
  CHECK(bench.robot.counters().returns == 0);
  bench.run_for(1ms);
  CHECK(bench.robot.counters().returns == 1);
}

TEST_CASE("mapper: stays where it is, where that is not enabled", "[mapper][link]") {
  Bench bench{mapper::app::arduino_robot};
  bench.confirm();
  REQUIRE(bench.drive("{U,0,30}\n"));
  bench.link(false);
  never_drives(bench, 60s);
  CHECK(bench.robot.counters().returns == 0);
}

TEST_CASE("mapper: on the way home it stops in front of things, and stays there", "[mapper][link]") {
  Bench bench{returning()};
  bench.confirm();
  REQUIRE(bench.drive("{U,0,90}\n"));
  // A wall appears across the way, 30 cm from home.
  bench.parts.distance = [&bench](float angle) {
    return -std::cos(angle) > 0.1F ? (bench.parts.pose.x_m - 0.3F) * 100.0F / -std::cos(angle) : 200.0F;
  };
  bench.link(false);
  bench.run_for(3200ms);
  CHECK(bench.is(State::returning));
  REQUIRE(bench.run_until([&] { return bench.is(State::advertising); }, 60s));
  CHECK(bench.parts.pose.x_m > 0.35F);
  CHECK(bench.parts.pose.x_m < 0.50F);
  CHECK(bench.robot.counters().returns_blocked == 1);
  never_drives(bench, 10s);
}

TEST_CASE("mapper: an operator who finds it on its way home stops it", "[mapper][link]") {
  Bench bench{returning()};
  bench.confirm();
  REQUIRE(bench.drive("{U,0,60}\n"));
  REQUIRE(bench.drive("{U,90,30}\n"));
  REQUIRE(bench.drive("{U,90,50}\n"));
  bench.link(false);
  bench.run_for(6s);
  CHECK(bench.is(State::returning));
  CHECK(bench.parts.efforts != motion::Efforts{});
  bench.link(true);
  CHECK(bench.parts.efforts == motion::Efforts{});
  CHECK(bench.is(State::connected));
  SECTION("and confirms it: the way home is forgotten") {
    bench.run_for(500ms);
    bench.say("{S,CON}\n");
    bench.run_for(100ms);
    bench.link(false);
    bench.run_for(3200ms);
    CHECK(bench.robot.counters().returns == 2);
    never_drives(bench, 10s);
  }
  SECTION("and is lost again before that: it goes on") {
    bench.run_for(500ms);
    bench.link(false);
    bench.run_for(3200ms);
    CHECK(bench.is(State::returning));
    REQUIRE(bench.run_until([&] { return bench.is(State::advertising); }, 60s));
    CHECK(std::hypot(bench.parts.pose.x_m, bench.parts.pose.y_m) < 0.08F);
  }
}

TEST_CASE("mapper: a hundred links, each as good as the first", "[mapper][link]") {
  Bench bench;
  bench.run_for(3s);
  for (int i = 0; i < 100; ++i) {
    bench.link(true);
    bench.run_for(150ms);
    bench.say("{S,CON}\n");
    bench.run_for(350ms);
    CAPTURE(i);
    CHECK(bench.is(State::confirmed));
    CHECK(bench.heard("{H,") == 1);
    CHECK(bench.heard("{U,0,0,0,") >= 1);
    bench.say("{U,20,10}\n");
    bench.run_for(std::chrono::milliseconds{13 * i});
    bench.link(false);
    bench.heard();
    bench.run_for(200ms);
  }
  CHECK(bench.robot.counters().links == 100);
  CHECK(bench.robot.counters().links_lost == 100);
}

}  // namespace mapper_app_shared_test
