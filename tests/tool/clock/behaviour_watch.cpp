// What is said where a spec has no behaviour, and what of a sample or a command is none. The course of one is
// in admission.cpp.
#include "cli/command/behaviour_watch.hpp"

#include "ocm/can/text.hpp"
#include "ocm/topics/amiro.hpp"

#include "tests/tool/captured.hpp"
#include "tests/tool/clock/world.hpp"
#include "tests/unit/protocol/example_topics.hpp"

namespace tool_clock_behaviour_watch_test {

using namespace ocm;
using namespace ocm::test;
using cli::BehaviourWatch;

void take(BehaviourWatch& watch, std::string_view text) {
  const auto parsed = can::parse_frame(text);
  REQUIRE(parsed.ok());
  watch.take({{}, *parsed});
}

TEST_CASE("behaviour watch: a sample has its length, a number without a name is shown as it is") {
  const World world{1};
  BehaviourWatch watch{amiro::catalogue, "behave", "follow"};
  watch.begin();
  take(watch, "60D#02");
  CHECK_FALSE(watch.heard());
  take(watch, "60D#02000A0000F6FFFF");
  CHECK(watch.was_active());
  CHECK(watch.left() == "0.0001 m, -0.0001 rad");
  take(watch, "60D#0063000000000000");
  CHECK(watch.over());
  CHECK(watch.ended() == "99");
}

TEST_CASE(
    "behaviour watch: the first command that could have ended it is named, and a rest replaces nothing") {
  const World world{1};
  const auto commanded = [](std::initializer_list<const char*> frames, bool replaces) {
    BehaviourWatch watch{amiro::catalogue, "behave", "follow"};
    watch.begin();
    for (const char* const frame : frames) take(watch, frame);
    CHECK(watch.is_replaced() == replaces);
    return watch.commanded();
  };
  CHECK(commanded({"20C#0000"}, false) == "follow 20C#0000");
  CHECK(commanded({"20B#0000000000000000"}, false).empty());
  CHECK(commanded({"20C#E803"}, true) == "follow 20C#E803");
  CHECK(commanded({"201#0000000000000000", "20B#A08601000000E803"}, true) == "motors 201#0000000000000000");
  CHECK(commanded({"23C#010203", "229#E803", "208#01"}, false).empty());  // not of the wheels' board
  // None is in another format, of another length, a remote frame, or what a board says.
  CHECK(commanded({"0000020C#E803", "20C#E8", "20C#", "20C#R", "60C#E803"}, false).empty());
  CHECK(commanded({"00000201#0100000000000000", "201#01", "601#0100000000000000"}, false).empty());
}

TEST_CASE("behaviour watch: what came before it began does not count") {
  const World world{1};
  BehaviourWatch watch{amiro::catalogue, "behave", "follow"};
  watch.begin();
  take(watch, "60D#02000A0000F6FFFF");
  take(watch, "60D#0000000000000000");
  take(watch, "20C#E803");
  CHECK(watch.heard());
  CHECK(watch.over());
  CHECK(watch.is_replaced());
  CHECK_FALSE(watch.commanded().empty());
  watch.begin();
  CHECK_FALSE(watch.heard());
  CHECK_FALSE(watch.was_active());
  CHECK_FALSE(watch.over());
  CHECK_FALSE(watch.is_replaced());
  CHECK(watch.commanded().empty());
}

TEST_CASE("behaviour watch: a spec that has no such behaviour, or does not say what becomes of it") {
  const World world{1};
  const auto refusal = [](auto&& act) {
    const Leaving left = leaving(act);
    CHECK(left.code == cli::exit_usage);
    return left.text;
  };
  for (const char* const name : {"fly", "gyroscope"})
    CHECK(refusal([&] { static_cast<void>(cli::behaviour_topic(amiro::catalogue, "behave", name)); }) ==
          "amiroctl: behave: robot 'AMiRo' has no behaviour " + std::string{name} +
              "\n          its spec has no actuator " + name + "; see `amiroctl list`\n");
  for (const auto* const catalogue : {&test::catalogue, &amiro::catalogue})
    CHECK(refusal([&] {
            const BehaviourWatch watch{*catalogue, "behave", "home"};
          }) == "amiroctl: behave: robot '" + std::string{catalogue->robot} +
                    "' does not say what becomes of home\n          its spec has no sensor behaviour whose "
                    "field active has the value home; use set\n");
}

}  // namespace tool_clock_behaviour_watch_test
