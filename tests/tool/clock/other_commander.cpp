// Another program that commands the motors, or a board that drives by itself.
#include "cli/command/other_commander.hpp"

#include "ocm/can/text.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/shared/messages.hpp"
#include "tests/tool/captured.hpp"
#include "tests/tool/clock/world.hpp"

namespace tool_clock_other_commander_test {

using namespace ocm;
using namespace ocm::test;
using cli::OtherCommander;

constexpr const char* moves = "201#50C3000000000000";
constexpr const char* rests = "201#0000000000000000";

can::Received received(std::string_view text) {
  const auto parsed = can::parse_frame(text);
  REQUIRE(parsed.ok());
  return {{}, *parsed};
}

/// What is said meanwhile.
template <class Act>
std::string said(Act&& act) {
  Captured said{STDERR_FILENO};
  act();
  return said.text();
}

/// What it says as it refuses; empty: it does not.
std::string refusal(OtherCommander& other) {
  const Leaving left = leaving([&] { other.refuse_if_heard(); });
  CHECK(left.code.value_or(cli::exit_failure) == cli::exit_failure);
  return left.text;
}

TEST_CASE("another commander: set points of the last 150 ms are heard, and counted") {
  World world{1};
  OtherCommander other{amiro::catalogue, "drive"};
  const std::string remedy =
      "          end that program first; --force drives all the same, and the robot follows the set point "
      "that "
      "came last\n";
  for (const char* const text : {"205#01", "23C#010203", "601#0000000000000000", "201#01"})
    other.take(received(text), false);
  CHECK(refusal(other).empty());
  CHECK(other.motors().empty());
  other.take(received(moves), false);
  CHECK(other.motors() == "motors");
  world.pass(100ms);
  other.take(received(rests), false);
  CHECK(
      refusal(other) ==
      "amiroctl: drive: another program commands motors: 201#0000000000000000, 2 set points within 150ms\n" +
          remedy);
  world.pass(49ms);
  CHECK_THAT(refusal(other), Catch::Contains("2 set points within 150ms"));
  world.pass(2ms);
  CHECK_THAT(refusal(other), Catch::Contains("1 set point within 150ms"));
  world.pass(97ms);
  CHECK(other.is_heard());
  world.pass(3ms);
  CHECK_FALSE(other.is_heard());
  CHECK(refusal(other).empty());
  CHECK_FALSE(other.has_stopped());  // it was none of this program's that ended
}

TEST_CASE("another commander: while this program drives it is said once, counted, and a stop is one") {
  const World world{1};
  OtherCommander other{amiro::catalogue, "run"};
  const auto takes = [&](const char* frame, bool holding) {
    return said([&] { other.take(received(frame), holding); });
  };
  const auto sums_up = [&] { return said([&] { other.sum_up(); }); };
  CHECK(sums_up().empty());
  CHECK(
      takes(moves, true) ==
      "run: another program commands motors, too: 201#50C3000000000000; the robot follows the set point that "
      "came last\n");
  CHECK_FALSE(other.has_stopped());
  CHECK(sums_up() == "run: 1 set point of another program came meanwhile\n");
  CHECK(takes(moves, true).empty());
  CHECK(takes(rests, true).empty());
  CHECK(other.has_stopped());
  CHECK(takes(moves, false).empty());  // none of this program's moves any more
  CHECK(sums_up() == "run: 3 set points of another program came meanwhile\n");
  // A stop needs no warning.
  other = OtherCommander{amiro::catalogue, "run"};
  CHECK(takes(rests, true).empty());
  CHECK(other.has_stopped());
}

TEST_CASE("another commander: one that begins within 150 ms of this program could not hear it") {
  World world{1};
  const auto begun_too = [&](base::Duration after, const char* const frame, bool holding) {
    OtherCommander other{amiro::catalogue, "drive"};
    other.hold_begins(world.now());
    world.pass(after);
    const std::string text = said([&] { other.take(received(frame), holding); });
    CHECK(text.empty() == (other.has_begun_too() || other.has_stopped() || !holding));
    return other.has_begun_too();
  };
  CHECK(begun_too(0ms, moves, true));
  CHECK(begun_too(149ms, moves, true));
  CHECK_FALSE(begun_too(150ms, moves, true));
  CHECK_FALSE(begun_too(0ms, rests, true));
  CHECK_FALSE(begun_too(0ms, moves, false));
}

TEST_CASE("another commander: a board that drives by itself is one, unless this program has asked it to") {
  const World world{1};
  OtherCommander other{amiro::catalogue, "drive"};
  REQUIRE(other.unheard_sensor() != nullptr);
  CHECK(said([&] { other.tell_unanswered(); }) ==
        "drive: di_wheel_drive has not answered, so it may be off; `amiroctl doctor` says which boards are "
        "there\n");
  other.take(received("60D#0100000000000000"), false);
  CHECK(other.unheard_sensor() == nullptr);
  CHECK(said([&] { other.tell_unanswered(); }).empty());
  CHECK(
      refusal(other) ==
      "amiroctl: drive: di_wheel_drive drives the wheels by itself, as another program has asked it to: "
      "travel\n          wait for its end, or `amiroctl behave none`; --force begins all the same, and ends "
      "it\n");
  // A request is no command of the wheels; what commands a behaviour is, as a set point is.
  OtherCommander commanding = other;
  other.send(received("208#01").frame);
  CHECK(other.is_heard());
  other.send(received(moves).frame);
  CHECK_FALSE(other.is_heard());
  commanding.send(received("20C#E803").frame);
  CHECK_FALSE(commanding.is_heard());
  // At rest it is no reason.
  OtherCommander resting{amiro::catalogue, "drive"};
  resting.take(received("60D#0002000000000000"), false);
  CHECK(resting.unheard_sensor() == nullptr);
  CHECK_FALSE(resting.is_heard());
}

}  // namespace tool_clock_other_commander_test
