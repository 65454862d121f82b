#include "ocm/cognitive/fleet.hpp"

#include <chrono>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/mapper/link/packed.hpp"

#include "unit/base/random.hpp"
#include "unit/mapper/link/link_testing.hpp"

namespace cognitive_fleet_test {

using namespace std::chrono_literals;
using namespace ocm::cognitive;
using ocm::base::Time;
using ocm::mapper::link::Kind;
using ocm::mapper::link::Update;
using ocm::test::Random;

constexpr Time second{1s};
const std::string handshake = "[0]:AVR:{H,15,20,-4,6,0,90,180,270,2000,0}\n";
const std::string packing = "[0]:AVR:{H,15,20,-4,6,0,90,180,270,2000,20225}\n";

std::string sayings(Fleet& fleet) {
  std::string all;
  while (const auto saying = fleet.take()) all += std::to_string(saying->robot) + ":" + saying->words;
  return all;
}

TEST_CASE(
    "fleet: a handshake is answered, each time that it is said, and packed updates asked of who offers "
    "them") {
  Fleet fleet;
  fleet.linked(0, "AVR", second);
  CHECK_FALSE(fleet.robot(0).confirmed);
  fleet.feed(handshake, second);
  CHECK(sayings(fleet) == "0:{S,CON}\n");
  fleet.feed(packing, second);
  CHECK(sayings(fleet) == "0:{S,BIN}\n{S,CON}\n");
  CHECK(fleet.robot(0).confirmed);
  CHECK(fleet.robot(0).handshake->width == 15);
  CHECK(fleet.robot(0).shape().tower.ahead_of_axle_m == Approx(0.10F));
  CHECK(fleet.deadline_of(fleet.robot(0)) == 2s);
  CHECK(fleet.counters().handshakes == 2);
  FleetOptions text;
  text.packed = false;
  Fleet plain{text};
  plain.feed(packing, second);
  CHECK(sayings(plain) == "0:{S,CON}\n");
}

TEST_CASE("fleet: poses, in the robot's frame and in the world's") {
  Fleet fleet;
  fleet.set_origin(0, {1.0F, 2.0F, ocm::motion::pi / 2});
  CHECK(fleet.robot(0).pose().x_m == 1.0F);
  fleet.feed("[0]:AVR:{U,50,20,-30,10,0,40,0,0}\n", second);
  REQUIRE(fleet.robot(0).update);
  CHECK(fleet.robot(0).update->s2 == 40);
  CHECK(fleet.robot(0).updated == second);
  CHECK(fleet.robot(0).pose().x_m == Approx(0.8F));
  CHECK(fleet.robot(0).pose().y_m == Approx(2.5F));
  CHECK(fleet.robot(0).pose().heading_rad == Approx(ocm::motion::radians(60.0F)));
}

TEST_CASE("fleet: packed updates are updates") {
  Fleet fleet;
  const auto packet = ocm::mapper::link::pack({0, {10, -20, 90, 4, 0, 30, 0, 0}});
  std::string bytes = "[3]:AVR:";
  for (const std::uint8_t byte : packet->bytes()) bytes += static_cast<char>(byte);
  fleet.feed(bytes, second);
  REQUIRE(fleet.robot(3).update);
  CHECK(*fleet.robot(3).update == Update{10, -20, 90, 4, 0, 30, 0, 0});
}

TEST_CASE("fleet: idle, until it is sent; an idle right behind the set point meant the one before") {
  Fleet fleet;
  const std::string at_start = "[0]:AVR:{U,0,0,0,0,0,0,0,0}\n";
  fleet.feed("[0]:AVR:{S,IDL}\n", second);
  CHECK(fleet.robot(0).idle);
  CHECK_FALSE(fleet.robot(0).located);
  fleet.feed(at_start, second);
  CHECK(fleet.robot(0).located);
  REQUIRE(fleet.go(0, {90, 50}, second));
  CHECK_FALSE(fleet.robot(0).idle);
  CHECK(sayings(fleet) == "0:{U,90,50}\n");
  fleet.feed("[0]:AVR:{S,IDL}\n", second + 50ms);  // it has not even gone out
  fleet.out(0, second + 50ms);
  fleet.feed("[0]:AVR:{S,IDL}\n", second + 100ms);
  CHECK_FALSE(fleet.robot(0).idle);
  CHECK(fleet.counters().early_idles == 2);
  fleet.feed("[0]:AVR:{U,0,50,90,0,0,0,0,0}\n", second + 9s);
  fleet.feed("[0]:AVR:{S,IDL}\n", second + 9s);
  CHECK_FALSE(fleet.robot(0).idle);  // where it stands, the next update says
  fleet.feed("[0]:AVR:{U,0,50,90,0,0,0,0,0}\n", second + 9s);
  CHECK(fleet.robot(0).idle);
  CHECK(fleet.robot(0).located);
  CHECK(fleet.sender(0).progress() == ocm::mapper::server::Progress::reached);
  CHECK_FALSE(fleet.go(0, {361, 0}, second));
  CHECK_FALSE(fleet.go(Fleet::most_robots, {0, 0}, second));
  CHECK(sayings(fleet).empty());
}

TEST_CASE("fleet: the answer to a handshake is repeated until an update or an idle shows that it was heard") {
  Fleet fleet;
  fleet.linked(0, "AVR", second);
  fleet.feed(handshake, second);
  CHECK(sayings(fleet) == "0:{S,CON}\n");
  fleet.expire(second + 400ms);
  CHECK(sayings(fleet).empty());
  fleet.expire(second + 600ms);
  CHECK(sayings(fleet) == "0:{S,CON}\n");
  fleet.feed("[0]:AVR:{S,IDL}\n", second + 700ms);
  fleet.expire(second + 2s);
  CHECK(sayings(fleet).empty());
}

TEST_CASE("fleet: a calibration is said until it is heard, and its end is known") {
  using Phase = ocm::mapper::server::Calibrator::Phase;
  Fleet fleet;
  fleet.linked(0, "AVR", second);
  fleet.feed("[0]:AVR:{U,0,0,0,0,0,0,0,0}\n{S,IDL}\n", second);
  CHECK(fleet.robot(0).idle);
  REQUIRE(fleet.calibrate(0, second));
  CHECK(sayings(fleet) == "0:{C,0}\n");
  fleet.feed("[0]:AVR:{C,3,0,0,0,0,0,0}\n", second + 100ms);
  CHECK(sayings(fleet) == "0:{C,4}\n");
  CHECK_FALSE(fleet.robot(0).idle);  // it may turn
  fleet.expire(second + 1s);
  CHECK(sayings(fleet) == "0:{C,4}\n");
  for (Time now = second + 1s; now < second + 9s; now += 1s) {
    fleet.feed("[0]:AVR:{C,4,1,0,0,0,0,0}\n", now);
    fleet.expire(now + 900ms);
  }
  CHECK(sayings(fleet).empty());
  CHECK_FALSE(fleet.robot(0).lost);
  CHECK(fleet.calibrator(0).phase() == Phase::turning);
  fleet.feed("[0]:AVR:{C,4,2,41,-57,152,1,2}\n{S,IDL}\n", second + 10s);
  CHECK(fleet.calibrator(0).phase() == Phase::done);
  CHECK(fleet.calibrator(0).result().x == 41);
  CHECK(fleet.robot(0).idle);
  CHECK(fleet.counters().calibrations == 10);
  CHECK_FALSE(fleet.calibrate(Fleet::most_robots, second));
}

TEST_CASE("fleet: a stop, a set point, a handshake and the end of the link end a calibration") {
  using Phase = ocm::mapper::server::Calibrator::Phase;
  for (int end = 0; end < 4; ++end) {
    Fleet fleet;
    fleet.linked(0, "AVR", second);
    REQUIRE(fleet.calibrate(0, second));
    fleet.feed("[0]:AVR:{C,3,0,0,0,0,0,0}\n", second + 100ms);
    CHECK(fleet.calibrator(0).phase() == Phase::ordering);
    if (end == 0) fleet.stop(0, second + 1s);
    if (end == 1) fleet.go(0, {0, 20}, second + 1s);
    if (end == 2) fleet.feed(handshake, second + 1s);
    if (end == 3) fleet.unlinked(0);
    CHECK(fleet.calibrator(0).phase() == Phase::none);
    (void)sayings(fleet);
    fleet.expire(second + 1900ms);
    CHECK(sayings(fleet).find("{C,") == std::string::npos);
  }
}

TEST_CASE("fleet: a robot of another program's link says who it is when it is asked, and its place stays") {
  Fleet fleet;
  fleet.linked(0, "AVR", second);
  fleet.set_origin(0, {1.0F, 2.0F, 0.0F});
  fleet.feed("[0]:AVR:{U,50,0,0,0,0,0,0,0}\n", second);
  CHECK_FALSE(fleet.robot(0).handshake);
  REQUIRE(fleet.ask_who(0, second));
  CHECK(sayings(fleet) == "0:{S,WHO}\n");
  for (const auto late : {100ms, 600ms}) {  // it was asked twice
    fleet.feed(handshake, second + late);
    REQUIRE(fleet.robot(0).handshake);
    CHECK(fleet.robot(0).handshake->width == 15);
    CHECK(fleet.robot(0).pose().x_m == Approx(1.5F));
    CHECK(sayings(fleet).empty());
  }
  // Unasked it has begun again: its frame begins where it was.
  fleet.feed(handshake, second + 3s);
  CHECK(sayings(fleet) == "0:{S,CON}\n");
  CHECK_FALSE(fleet.robot(0).update);
  CHECK(fleet.robot(0).origin.x_m == Approx(1.5F));
  CHECK_FALSE(fleet.ask_who(Fleet::most_robots, second));
}

TEST_CASE("fleet: a robot that was not confirmed is confirmed, asked or not") {
  Fleet fleet;
  fleet.linked(0, "AVR", second);
  REQUIRE(fleet.ask_who(0, second));
  (void)sayings(fleet);
  fleet.feed(handshake, second + 100ms);
  CHECK(sayings(fleet) == "0:{S,CON}\n");
}

TEST_CASE("fleet: what confirms a handshake is said again, by each robot at a time of its own") {
  Fleet fleet;
  for (const std::size_t index : {0U, 3U}) {
    fleet.linked(static_cast<std::uint8_t>(index), "AVR", second);
    fleet.feed("[" + std::to_string(index) + "]" + handshake.substr(3), second);
  }
  CHECK(sayings(fleet) == "0:{S,CON}\n3:{S,CON}\n");
  // 500 ms, and 20 ms more for each robot before it.
  fleet.expire(second + 499ms);
  CHECK(sayings(fleet).empty());
  fleet.expire(second + 500ms);
  CHECK(sayings(fleet) == "0:{S,CON}\n");
  fleet.expire(second + 559ms);
  CHECK(sayings(fleet).empty());
  fleet.expire(second + 560ms);
  CHECK(sayings(fleet) == "3:{S,CON}\n");
}

TEST_CASE("fleet: what was not heard is said again; a stop before all else, until the robot stands") {
  Fleet fleet;
  const auto hear = [&fleet](std::string_view words, Time now) {
    fleet.feed("[0]:AVR:" + std::string{words}, now);
  };
  const auto said = [&fleet](Time now) {
    std::string all = sayings(fleet);
    for (std::size_t i = 0; i < 4; ++i) fleet.out(0, now);  // more than there are: they do not count
    return all;
  };
  fleet.linked(0, "AVR", second);
  hear("{S,IDL}\n{U,0,0,0,0,0,0,0,0}\n", second);
  REQUIRE(fleet.go(0, {90, 50}, second));
  CHECK(said(second) == "0:{U,90,50}\n");
  fleet.expire(second + 900ms);
  CHECK(said(second + 900ms).empty());  // it may drive: nothing is known
  hear("{S,IDL}\n", second + 1s);
  hear("{U,0,0,0,0,0,0,0,0}\n", second + 1s);
  CHECK(said(second + 1s) == "0:{U,90,50}\n");
  CHECK(fleet.counters().words == 2);
  REQUIRE(fleet.stop(0, second + 1100ms));
  CHECK(said(second + 1100ms) == "0:{U,0,0}\n");
  unsigned stops = 0;
  for (Time now = second + 1100ms; now < second + 2100ms; now += 50ms) {
    fleet.expire(now);
    stops += said(now).empty() ? 0 : 1;
  }
  CHECK(stops >= 2);
  CHECK(stops <= 3);
  hear("{S,IDL}\n", second + 2200ms);
  CHECK(fleet.robot(0).idle);
  fleet.expire(second + 9s);
  CHECK(said(second + 9s).empty());
}

TEST_CASE("fleet: paused as requested, unless updates go on") {
  Fleet fleet;
  fleet.feed("[0]:AVR:{U,0,0,0,0,0,0,0,0}\n", second);
  REQUIRE(fleet.pause(0, second));
  CHECK(sayings(fleet) == "0:{S,PAU}\n");
  fleet.feed("[0]:AVR:{U,0,0,0,0,0,0,0,0}\n", second + 200ms);  // was on its way
  CHECK(fleet.robot(0).paused);
  fleet.feed("[0]:AVR:{S,IDL}\n", second + 3s);
  CHECK(fleet.robot(0).paused);
  fleet.feed("[0]:AVR:{U,0,0,0,0,0,0,0,0}\n", second + 4s);
  CHECK_FALSE(fleet.robot(0).paused);
  REQUIRE(fleet.unpause(0, second));
  CHECK(sayings(fleet) == "0:{S,UNP}\n");
  REQUIRE(fleet.ping(0));
  CHECK(sayings(fleet) == "0:{}\n");
  fleet.feed("[0]:AVR:\t!\n", second);
  CHECK(fleet.robot(0).last == Kind::pong);
  CHECK(fleet.counters().pongs == 1);
}

TEST_CASE("fleet: silent for its own deadline is lost; a word brings it back") {
  Fleet fleet;
  fleet.linked(0, "AVR", second);
  fleet.feed(handshake, second);
  fleet.expire(second + 2s);
  CHECK_FALSE(fleet.robot(0).lost);
  fleet.expire(second + 2001ms);
  CHECK(fleet.robot(0).lost);
  CHECK(fleet.counters().lost == 1);
  fleet.expire(second + 9s);
  CHECK(fleet.counters().lost == 1);
  fleet.feed("[0]:AVR:{S,IDL}\n", second + 10s);
  CHECK_FALSE(fleet.robot(0).lost);
  fleet.unlinked(0);
  CHECK(fleet.robot(0).lost);
  CHECK_FALSE(fleet.robot(0).linked);
  CHECK(fleet.counters().lost == 2);
  // Without a handshake: the fleet's own.
  fleet.linked(1, "Arduino", second);
  fleet.expire(second + 5s);
  CHECK_FALSE(fleet.robot(1).lost);
  fleet.expire(second + 5001ms);
  CHECK(fleet.robot(1).lost);
}

TEST_CASE("fleet: a link that is new begins a new frame where the robot stands") {
  Fleet fleet;
  fleet.linked(0, "AVR", second);
  fleet.feed(handshake + "[0]:AVR:{U,100,0,90,0,0,0,0,0}\n", second);
  fleet.unlinked(0);
  fleet.linked(0, "AVR", second + 5s);
  CHECK(fleet.quality_per_mille(0) == 1000);
  fleet.feed(handshake, second + 6s);
  CHECK(fleet.robot(0).pose().x_m == Approx(1.0F));
  fleet.feed(handshake, second + 7s);
  fleet.feed("[0]:AVR:{U,50,0,0,0,0,0,0,0}\n", second + 8s);
  CHECK(fleet.robot(0).pose().x_m == Approx(1.0F));
  CHECK(fleet.robot(0).pose().y_m == Approx(0.5F));
  // Another robot at the same index is another robot.
  fleet.linked(0, "Arduino", second + 9s);
  CHECK_FALSE(fleet.robot(0).handshake);
  CHECK_FALSE(fleet.robot(0).update);
}

TEST_CASE("fleet: a new link is trusted, and ends no sentence of the one before") {
  Fleet fleet;
  fleet.linked(0, "AVR", second);
  fleet.feed(ocm::test::listing_15_1, second);
  REQUIRE(fleet.quality_per_mille(0) < 700);
  fleet.unlinked(0);
  fleet.linked(0, "AVR", second + 1s);
  CHECK(fleet.quality_per_mille(0) == 1000);
  Fleet other;
  other.linked(0, "AVR", second);
  other.feed("[0]:AVR:{U,1,2,3", second);
  other.unlinked(0);
  other.linked(0, "AVR", second + 1s);
  other.feed("[0]:AVR:,0,0,0,0,0}\n", second + 1s);
  CHECK_FALSE(other.robot(0).update);
}

TEST_CASE("fleet: how soon an idle is believed is as it was asked for") {
  for (const auto& [settle, early] : {std::pair<ocm::base::Duration, unsigned>{300ms, 1}, {50ms, 0}}) {
    FleetOptions options;
    options.sender.settle = settle;
    Fleet fleet{options};
    fleet.feed("[0]:AVR:{S,IDL}\n{U,0,0,0,0,0,0,0,0}\n", second);
    REQUIRE(fleet.go(0, {90, 50}, second));
    CHECK(sayings(fleet) == "0:{U,90,50}\n");
    fleet.out(0, second);
    fleet.feed("[0]:AVR:{S,IDL}\n", second + 100ms);
    CHECK(fleet.counters().early_idles == early);
  }
}

TEST_CASE("fleet: what was said to two robots at once is not said again at once") {
  Fleet fleet;
  for (const std::size_t index : {0U, 1U}) {
    fleet.linked(index, "R", second);
    REQUIRE(fleet.stop(index, second));
  }
  CHECK(sayings(fleet) == "0:{U,0,0}\n1:{U,0,0}\n");
  for (const std::size_t index : {0U, 1U}) fleet.out(index, second);
  std::string again;
  for (Time now = second; again.empty() && now < second + 1s; now += 1ms) {
    fleet.expire(now);
    again = sayings(fleet);
  }
  CHECK(again == "0:{U,0,0}\n");
}

TEST_CASE("fleet: the log of listing 15.1 calls the robot back") {
  Fleet fleet;
  fleet.linked(0, "AVR", second);
  std::vector<Kind> heard;
  fleet.feed(ocm::test::listing_15_1, second, [&](std::size_t robot, Kind kind) {
    CHECK(robot == 0);
    heard.push_back(kind);
  });
  CHECK(heard == std::vector<Kind>{Kind::update, Kind::idle, Kind::idle, Kind::update});
  CHECK(fleet.call_back(0) == Advice::bad_link);
  fleet.linked(0, "AVR", second);  // another program asks for the link that is there
  CHECK(fleet.call_back(0) == Advice::bad_link);
  CHECK(fleet.counters().calls == 1);
  // It is well again only when it is better than what called it.
  while (fleet.quality_per_mille(0) < 700) fleet.feed("[0]:AVR:{S,IDL}\n", second);
  CHECK(fleet.call_back(0) == Advice::bad_link);
  for (int i = 0; i < 40; ++i) fleet.feed("[0]:AVR:{S,IDL}\n", second);
  CHECK(fleet.call_back(0) == Advice::stay);
}

TEST_CASE("fleet: a bad link is called that, however near the range it was called for") {
  FleetOptions options;
  options.range_m = 8.0F;
  options.central = {1.0F, 0.0F};
  Fleet fleet{options};
  fleet.linked(0, "AVR", second);
  fleet.feed(ocm::test::listing_15_1, second, [](std::size_t, Kind) {});
  REQUIRE(fleet.call_back(0) == Advice::bad_link);
  for (int i = 0; i < 3; ++i) {  // 6.8 m away: within 7.2, and not within 6.48
    fleet.feed("[0]:AVR:{U,780,0,0,0,0,0,0,0}\n", second);
    CHECK(fleet.call_back(0) == Advice::bad_link);
  }
}

TEST_CASE("fleet: a pose near the range calls back, until it is well inside") {
  FleetOptions options;
  options.central = {1.0F, 0.0F};
  options.range_m = 8.0F;
  Fleet fleet{options};
  const auto at = [&](int cm) {
    fleet.feed("[0]:AVR:{U," + std::to_string(cm) + ",0,0,0,0,0,0,0}\n", second);
    return fleet.call_back(0);
  };
  CHECK(at(800) == Advice::stay);      // 7 m away; the bound is 7.2
  CHECK(at(830) == Advice::far_away);  // 7.3
  CHECK(at(800) == Advice::far_away);  // and back below 6.48
  CHECK(at(740) == Advice::stay);
}

TEST_CASE("fleet: a robot behind the last is none, and changes nothing of the others") {
  const auto day = [](bool with_others) {
    Fleet fleet;
    std::string said;
    const auto pass = [&](Time now) {
      if (with_others) {
        constexpr std::size_t none = Fleet::most_robots;
        fleet.linked(none, "X", now);
        fleet.set_origin(none, {1.0F, 2.0F, 3.0F});
        CHECK_FALSE(fleet.go(none, {0, 10}, now));
        CHECK_FALSE(fleet.stop(none, now));
        CHECK_FALSE(fleet.calibrate(none, now));
        CHECK_FALSE(fleet.pause(none, now));
        CHECK_FALSE(fleet.unpause(none, now));
        CHECK_FALSE(fleet.ping(none));
        CHECK_FALSE(fleet.ask_who(none, now));
        fleet.feed("[" + std::to_string(none) + "]:X:{S,IDL}\n", now);
        fleet.out(none, now);
        fleet.unlinked(none);
      }
      fleet.expire(now);
      said += sayings(fleet);
      fleet.out(0, now);
    };
    fleet.linked(0, "AVR", second);
    pass(second);
    fleet.feed("[0]:AVR:{S,IDL}\n{U,0,0,0,0,0,0,0,0}\n", second);
    (void)fleet.go(0, {0, 20}, second);
    pass(second);
    fleet.feed("[0]:AVR:{S,IDL}\n{U,0,0,0,0,0,0,0,0}\n", second + 1s);
    pass(second + 1s);
    (void)fleet.stop(0, second + 2s);
    pass(second + 2s);
    pass(second + 3s);
    return said;
  };
  CHECK(day(false).starts_with("0:{U,0,20}\n0:{U,0,20}\n0:{U,0,0}\n"));
  CHECK(day(true) == day(false));
}

TEST_CASE("fleet: the deadline that a robot says is its own, if it can be one") {
  for (const auto& [said, deadline] :
       {std::pair<const char*, ocm::base::Duration>{"1", 1ms}, {"2000", 2s}, {"0", 5s}, {"-1", 5s}}) {
    Fleet fleet;
    fleet.feed("[0]:AVR:{H,15,20,-4,6,0,90,180,270," + std::string{said} + ",0}\n", second);
    CAPTURE(said);
    REQUIRE(fleet.robot(0).handshake);
    CHECK(fleet.deadline_of(fleet.robot(0)) == deadline);
    fleet.expire(second + deadline);
    CHECK_FALSE(fleet.robot(0).lost);
    fleet.expire(second + deadline + 1ns);
    CHECK(fleet.robot(0).lost);
  }
}

TEST_CASE("fleet: for a second an update may have been under way when a robot was paused") {
  for (const auto& [after, paused] : {std::pair<ocm::base::Duration, bool>{1s, true}, {1s + 1ns, false}}) {
    Fleet fleet;
    REQUIRE(fleet.pause(0, second));
    fleet.feed("[0]:AVR:{U,0,0,0,0,0,0,0,0}\n", second + after);
    CHECK(fleet.robot(0).paused == paused);
  }
}

TEST_CASE("fleet: of a robot that has said nothing, nothing is known") {
  const Fleet fleet;
  const Robot& robot = fleet.robot(0);
  CHECK(robot.name.empty());
  CHECK_FALSE(robot.linked);
  CHECK_FALSE(robot.confirmed);
  CHECK_FALSE(robot.idle);
  CHECK_FALSE(robot.located);
  CHECK_FALSE(robot.paused);
  CHECK_FALSE(robot.lost);
  CHECK_FALSE(robot.origin_known);
  CHECK(robot.last == Kind::none);
  CHECK(fleet.call_back(0) == Advice::stay);
  CHECK(fleet.counters().updates + fleet.counters().idles + fleet.counters().words == 0);
  CHECK(Saying{}.robot == 0);
}

TEST_CASE("fleet: an origin that was said is known, and stays when another robot is linked there") {
  Fleet fleet;
  fleet.linked(0, "AVR", second);
  CHECK_FALSE(fleet.robot(0).origin_known);
  fleet.set_origin(0, {1.0F, 2.0F, 0.5F});
  CHECK(fleet.robot(0).origin_known);
  fleet.linked(0, "Arduino", second);
  CHECK(fleet.robot(0).name == "Arduino");
  CHECK(fleet.robot(0).origin_known);
  CHECK(fleet.robot(0).origin == ocm::motion::Pose{1.0F, 2.0F, 0.5F});
}

TEST_CASE("fleet: what was heard is counted by its kind, and when something was sent is known") {
  Fleet fleet;
  fleet.feed("[3]:R:{U,0,0,0,0,0,0,0,0}\n[0]:AVR:{S,IDL}\n{U,0,0,0,0,0,0,0,0}\n", second);
  CHECK(fleet.counters().updates == 2);
  CHECK(fleet.counters().idles == 1);
  CHECK(fleet.counters().early_idles == 0);
  CHECK(fleet.counters().handshakes == 0);
  CHECK(fleet.robot(3).heard == second);
  CHECK(fleet.robot(0).last == Kind::update);
  REQUIRE(fleet.go(0, {0, 20}, second + 1ms));
  CHECK(fleet.robot(0).told == second + 1ms);
  REQUIRE(fleet.pause(0, second + 2ms));
  CHECK(fleet.robot(0).told == second + 2ms);
  // A robot that has begun again stands, and is not paused.
  fleet.feed(handshake, second + 3ms);
  CHECK(fleet.robot(0).told == Time{});
  CHECK_FALSE(fleet.robot(0).paused);
  CHECK(fleet.robot(0).idle);
  CHECK_FALSE(fleet.robot(0).located);
}

TEST_CASE("fleet: with a new link a robot is neither lost nor called back, and its deadline begins") {
  FleetOptions options;
  options.central = {1.0F, 0.0F};
  options.range_m = 8.0F;
  Fleet fleet{options};
  fleet.linked(0, "AVR", second);
  fleet.feed("[0]:AVR:{U,830,0,0,0,0,0,0,0}\n{S,IDL}\n", second);
  REQUIRE(fleet.call_back(0) == Advice::far_away);
  CHECK(fleet.robot(0).idle);
  fleet.unlinked(0);
  CHECK(fleet.robot(0).lost);
  CHECK_FALSE(fleet.robot(0).idle);
  fleet.linked(0, "AVR", second + 5s);
  CHECK_FALSE(fleet.robot(0).lost);
  CHECK(fleet.call_back(0) == Advice::stay);
  fleet.expire(second + 10s);
  CHECK_FALSE(fleet.robot(0).lost);
  fleet.expire(second + 10001ms);
  CHECK(fleet.robot(0).lost);
}

TEST_CASE("fleet: with its link ends what was to be said again, and what would have been an answer") {
  Fleet fleet;
  fleet.linked(0, "AVR", second);
  fleet.feed(handshake, second);
  CHECK(sayings(fleet) == "0:{S,CON}\n");
  fleet.unlinked(0);
  fleet.linked(0, "AVR", second + 100ms);
  fleet.expire(second + 600ms);
  CHECK(sayings(fleet).empty());
  REQUIRE(fleet.ask_who(0, second + 600ms));
  CHECK(sayings(fleet) == "0:{S,WHO}\n");
  fleet.unlinked(0);
  fleet.linked(0, "AVR", second + 700ms);
  fleet.feed(handshake, second + 800ms);
  CHECK(sayings(fleet) == "0:{S,CON}\n");
}

TEST_CASE("fleet: for two seconds a handshake is an answer") {
  for (const auto& [after, answers] : {std::pair<ocm::base::Duration, bool>{2s - 1ns, true}, {2s, false}}) {
    Fleet fleet;
    fleet.feed("[0]:AVR:{U,50,0,0,0,0,0,0,0}\n", second);
    REQUIRE(fleet.ask_who(0, second));
    CHECK(sayings(fleet) == "0:{S,WHO}\n");
    fleet.feed(handshake, second + after);
    CHECK(fleet.robot(0).update.has_value() == answers);
    CHECK(sayings(fleet).empty() == answers);
  }
}

TEST_CASE("fleet: each eighth robot is confirmed again at the same time") {
  Fleet fleet;
  for (const std::size_t index : {7U, 8U})
    fleet.feed("[" + std::to_string(index) + "]" + handshake.substr(3), second);
  CHECK(sayings(fleet) == "7:{S,CON}\n8:{S,CON}\n");
  fleet.expire(second + 500ms);
  CHECK(sayings(fleet) == "8:{S,CON}\n");
  fleet.expire(second + 639ms);
  CHECK(sayings(fleet).empty());
  fleet.expire(second + 640ms);
  CHECK(sayings(fleet) == "7:{S,CON}\n");
}

TEST_CASE("fleet: any bytes: nothing but counters") {
  Random random{7};
  Fleet fleet;
  for (int run = 0; run < 300; ++run) {
    std::string bytes;
    for (int i = 0; i < 200; ++i)
      bytes += random.below(2) == 0 ? "{}[]:,0123456789UHSIDL\n\t!"[random.below(25)]
                                    : static_cast<char>(random());
    fleet.feed(bytes, second);
    (void)sayings(fleet);
  }
  for (std::size_t i = 0; i < Fleet::most_robots; ++i) REQUIRE(ocm::motion::is_finite(fleet.robot(i).pose()));
  CHECK(fleet.of_no_robot() > 0);
}

}  // namespace cognitive_fleet_test
