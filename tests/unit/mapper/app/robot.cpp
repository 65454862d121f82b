#include "ocm/mapper/app/robot.hpp"

#include <cmath>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/mapper/link/packed.hpp"

#include "unit/mapper/app/app_testing.hpp"
#include "unit/motion/near.hpp"

namespace mapper_app_robot_test {

using namespace app_testing;
using ocm::test::near;

const std::string handshake = "{H,20,20,1,3,0,90,180,270,5000,20225,3}\n";
constexpr mapper::app::Lights green{.green = true};
constexpr mapper::app::Lights yellow{.yellow = true};
constexpr mapper::app::Lights both{.green = true, .yellow = true};

/// What the robot said that is an update, in text.
std::vector<mapper::link::Update> updates(std::string_view said) {
  mapper::link::Reader reader{mapper::link::Direction::from_robot};
  std::vector<mapper::link::Update> result;
  for (const char c : said)
    if (reader.feed(c) == mapper::link::Kind::update)
      result.push_back(*reader.sentence().as<mapper::link::Update>());
  CHECK(reader.faults().total() == 0);
  return result;
}

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

TEST_CASE("mapper: says who it is each second until it is confirmed, with a yellow flash", "[mapper]") {
  Bench bench;
  bench.run_for(3s);
  bench.link(true);
  CHECK(bench.is(State::connected));
  int flashes = 0;
  bool lit = false;
  bench.each_step = [&] {
    flashes += bench.parts.lights.yellow && !lit ? 1 : 0;
    lit = bench.parts.lights.yellow;
    CHECK(bench.parts.efforts == motion::Efforts{});
  };
  bench.run_for(100ms);
  CHECK(bench.heard() == handshake);
  CHECK(bench.parts.lights == both);
  bench.run_for(4s);
  CHECK(bench.parts.lights.green);
  CHECK(bench.heard(handshake) == 4);
  CHECK(bench.heard() == handshake + handshake + handshake + handshake);
  CHECK(flashes == 5);
  CHECK(bench.parts.servo_deg == 0);
  bench.say("{S,CON}\n");
  bench.run_for(2s);
  CHECK(bench.is(State::confirmed));
  CHECK(bench.heard("{H") == 0);
  CHECK(bench.parts.lights == green);
  CHECK(bench.robot.counters().handshakes == 5);
}

TEST_CASE("mapper: an operator who comes early waits until gyro and compass are measured", "[mapper]") {
  Bench bench;
  bench.link(true);
  bench.run_for(1800ms);
  bench.say("{S,CON}\n{U,0,100}\n");
  bench.run_for(50ms);
  CHECK(bench.is(State::advertising));
  CHECK(bench.parts.sent.empty());
  CHECK(bench.robot.counters().input_unlinked == 18);
  bench.run_for(300ms);
  CHECK(bench.is(State::connected));
  CHECK(bench.heard() == handshake);
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

TEST_CASE("mapper: of two set points in one packet the second counts, and the first is counted", "[mapper]") {
  Bench bench;
  bench.confirm();
  REQUIRE(bench.drive("{U,0,90}{U,0,20}\n"));
  CHECK(near(bench.parts.pose.x_m, 0.20F, 0.03F));
  CHECK(bench.robot.counters().orders_lost == 1);
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

TEST_CASE("mapper: a ping is answered, with a link, in any state", "[mapper]") {
  Bench bench;
  bench.run_for(3s);
  bench.link(true);
  bench.run_for(200ms);
  bench.heard();
  bench.say("{}\n");
  bench.run_for(25ms);
  CHECK(bench.heard() == "\t!\n");
  bench.say("{S,CON}\n{S,PAU}\n{ }\n");
  bench.run_for(25ms);
  CHECK(bench.heard("\t!\n") == 1);
}

TEST_CASE("mapper: asked who it is it says its handshake again, and goes on as before", "[mapper]") {
  Bench bench;
  bench.confirm();
  bench.say("{U,0,100}\n");
  bench.run_for(2s);
  const motion::Pose pose = bench.robot.pose();
  bench.heard();
  bench.say("{S,WHO}\n");
  bench.run_for(25ms);
  CHECK(bench.heard("{H,20,20,1,3,0,90,180,270,5000,20225,3}\n") == 1);
  CHECK(bench.is(State::confirmed));
  CHECK(bench.robot.busy());
  CHECK(bench.robot.pose().x_m >= pose.x_m);
  bench.say("{S,PAU}\n{S,WHO}\n");
  bench.run_for(25ms);
  CHECK(bench.heard("{H,") == 2);
  CHECK(bench.is(State::paused));
}

TEST_CASE("mapper: packed updates, where the operator asks for them", "[mapper]") {
  Bench bench;
  bench.run_for(3s);
  bench.link(true);
  bench.run_for(200ms);
  bench.say("{S,BIN}\n{S,CON}\n");
  bench.run_for(25ms);
  bench.heard();
  bench.run_for(990ms);
  mapper::link::PackedReader reader;
  int packed = 0;
  for (const char c : bench.heard())
    if (mapper::link::is_packed(static_cast<std::uint8_t>(c)) && reader.feed(static_cast<std::uint8_t>(c)))
      ++packed;
  CHECK(packed >= 4);
  CHECK(bench.robot.counters().updates >= 4);
  bench.say("{S,TXT}\n");
  bench.run_for(25ms);
  bench.heard();
  bench.run_for(1s);
  CHECK(updates(bench.heard()).size() == 5);
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
  for (const std::string_view order : {"{U,90,0}\n", "{U,0,0}{U,90,0}\n"}) {
    Bench bench;
    bench.confirm();
    bench.say("{U,0,100}\n");
    bench.run_for(3s);
    bench.run_until([&] { return bench.parts.servo_deg == 0; }, 10s);
    bench.run_for(150ms);
    bench.parts.distance = [](float) { return 12.0F; };  // of a sudden, all round
    within_a_look(bench, [&] { bench.preempt(order); });
    bench.parts.distance = [](float) { return 200.0F; };
    REQUIRE(bench.run_until([&] { return !bench.robot.busy(); }, 20s));
    CHECK(bench.robot.counters().collisions == 1);
    CHECK(bench.robot.counters().orders_lost == 0);
    CHECK(near(bench.parts.pose.heading_rad, motion::pi / 2, motion::radians(4.0F)));
  }
}

TEST_CASE("mapper: what the state does not allow is refused and counted", "[mapper]") {
  Bench bench;
  bench.run_for(3s);
  bench.link(true);
  bench.run_for(150ms);
  bench.heard();
  bench.say("{U,0,100}\n{S,PAU}\n{S,UNP}\n{U,0,0}\n");
  bench.run_for(500ms);
  CHECK(bench.is(State::connected));
  CHECK(bench.robot.counters().refused == 4);
  CHECK(bench.robot.counters().heard == 4);
  CHECK(bench.parts.efforts == motion::Efforts{});
  bench.say("{C,1}\n");
  bench.run_for(25ms);
  CHECK(bench.is(State::connected));
  CHECK(bench.robot.counters().refused == 5);
}

TEST_CASE("mapper: a second confirmation changes nothing", "[mapper]") {
  Bench bench;
  bench.confirm();
  REQUIRE(bench.drive("{U,90,20}\n"));
  bench.run_for(500ms);
  const motion::Pose before = bench.robot.pose();
  bench.say("{S,CON}\n");
  bench.run_for(100ms);
  CHECK(near(bench.robot.pose(), before, 0.01F, 0.01F));
}

TEST_CASE("mapper: garbage is counted, and the next sentence is heard", "[mapper]") {
  Bench bench;
  bench.confirm();
  std::mt19937 random{5};
  std::string_view letters = "{},SUHCON0123456789-\n\r\t! :[]";
  for (int i = 0; i < 20'000; ++i) {
    const auto any = static_cast<std::uint8_t>(random());
    bench.robot.receive(i % 3 == 0 ? any : static_cast<std::uint8_t>(letters[random() % letters.size()]));
    if (i % 10 == 0) bench.step();
  }
  bench.run_for(100ms);
  const auto garbage = bench.robot.counters();
  CHECK(garbage.damaged.total() > 100);
  CHECK(garbage.stray_bytes > 100);
  bench.say("\n{U,0,0}\n{S,UNP}\n");
  bench.run_for(50ms);
  bench.heard();
  bench.say("{}\n");
  bench.run_for(25ms);
  CHECK(bench.heard("\t!\n") == 1);
}

TEST_CASE("mapper: a full ring loses bytes, counts them, and recovers", "[mapper]") {
  Bench bench;
  bench.confirm();
  bench.say(std::string(500, 'x'));
  CHECK(bench.robot.counters().input_full == 500 - 128);
  bench.run_for(50ms);
  bench.heard();
  bench.say("{}\n");
  bench.run_for(25ms);
  CHECK(bench.heard("\t!\n") == 1);
  CHECK(bench.robot.counters().input_full == 500 - 128);
}

TEST_CASE("mapper: a ring that fills without a sentence is emptied before it is full", "[mapper]") {
  Bench bench;
  bench.confirm();
  for (int i = 0; i < 50; ++i) {
    bench.say(std::string(60, 'x'));
    bench.run_for(21ms);
  }
  CHECK(bench.robot.counters().input_full == 0);
  CHECK(bench.robot.counters().stray_bytes > 2800);
}

TEST_CASE("mapper: an operator who floods the line gets communication every 20 ms, and no more", "[mapper]") {
  Bench bench;
  bench.confirm();
  bench.say("{}");
  bench.step();
  bench.heard();
  int answers = 0;
  for (int ms = 0; ms < 1000; ++ms) {
    bench.say("{}");
    bench.step();
    answers += bench.heard("\t!") > 0 ? 1 : 0;
    bench.heard();
  }
  CHECK(answers <= 51);
  CHECK(answers >= 45);
}

TEST_CASE("mapper: without room in the UART bytes are lost and counted, and it goes on", "[mapper]") {
  Bench bench;
  bench.confirm();
  bench.parts.room = 5;
  bench.run_for(1s);
  CHECK(bench.robot.counters().output_full > 50);
  const auto before = bench.robot.counters().updates;
  bench.parts.room = 1000;
  bench.run_for(1s);
  CHECK(bench.robot.counters().updates == before + 5);
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
  CHECK(bench.is(State::confirmed));
  for (const mapper::link::Update& update : updates(bench.heard()))
    CHECK(update.s1 + update.s2 + update.s3 + update.s4 == 0);
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

TEST_CASE("mapper: a calibration can be stopped, and one that was is told", "[mapper]") {
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
  without_medium(150ms);
  CHECK(bench.parts.efforts != motion::Efforts{});
  without_medium(120ms);
  CHECK(bench.parts.efforts == motion::Efforts{});
  CHECK(bench.robot.counters().motors_starved == 1);
  CHECK(bench.robot.counters().control_skipped >= 6);
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
  CHECK(near(bench.parts.pose, {0, 0.6F, motion::pi / 2}, 0.04F, motion::radians(5.0F)));
  CHECK(near(bench.robot.pose(), bench.parts.pose, 0.02F, motion::radians(2.0F)));
}

TEST_CASE("mapper: idle time, where the port has none: all that no job took", "[mapper]") {
  Bench bench;
  bench.run_for(2s);
  CHECK(bench.robot.uptime() == 2s);
  CHECK(bench.robot.idle() == 2s);  // in this port jobs take no time
}

}  // namespace mapper_app_robot_test
