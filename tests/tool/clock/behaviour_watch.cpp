// What becomes of a behaviour that was commanded, by the samples of its board and what others command.
#include "cli/command/behaviour_watch.hpp"

#include "ocm/can/text.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/shared/messages.hpp"
#include "tests/tool/clock/said.hpp"
#include "tests/tool/clock/world.hpp"
#include "tests/unit/protocol/example_topics.hpp"

namespace tool_clock_behaviour_watch_test {

using namespace ocm;
using namespace ocm::test;
using cli::BehaviourWatch;

/// The samples of the sensor: what is active, how the last one ended, and what is left. [spec/topics.json]
constexpr const char* nothing = "60D#0000000000000000";
constexpr const char* travels = "60D#0100000000000000";
constexpr const char* follows = "60D#02000A0000F6FFFF";
constexpr const char* arrived = "60D#0001000000000000";
constexpr const char* line_lost = "60D#0005000000000000";

void take(BehaviourWatch& watch, std::string_view text) {
  const auto parsed = can::parse_frame(text);
  REQUIRE(parsed.ok());
  watch.take({{}, *parsed});
}

TEST_CASE(
    "behaviour watch: it is over when it was active and is no longer, and the board says how it ended") {
  World world{1};
  BehaviourWatch watch{amiro::catalogue, "behave", "follow"};
  CHECK(watch.sensor().name == "behaviour");
  watch.begin();
  CHECK_FALSE(watch.heard());
  CHECK(watch.last() == cli::Clock::time_point{});
  take(watch, "60D#02");  // of another length
  CHECK_FALSE(watch.heard());
  take(watch, follows);
  CHECK(watch.heard());
  CHECK(watch.was_active());
  CHECK_FALSE(watch.over());
  CHECK(watch.left() == "0.0001 m, -0.0001 rad");
  const auto before = watch.last();
  CHECK(before >= World::start);
  world.pass(20ms);
  take(watch, line_lost);
  CHECK(watch.over());
  CHECK(watch.ended() == "line_lost");
  CHECK(watch.left() == "0 m, 0 rad");
  CHECK(watch.last() >= before + 20ms);
  take(watch, arrived);
  CHECK(watch.ended() == "arrived");
  take(watch, "60D#0063000000000000");
  CHECK(watch.ended() == "99");  // has no name in this spec
  take(watch, travels);
  CHECK(watch.ended() == "travel");  // which took its place
  watch.begin();
  CHECK_FALSE(watch.over());
  CHECK_FALSE(watch.heard());
  CHECK_FALSE(watch.was_active());
}

TEST_CASE("behaviour watch: two samples may have been on their way when it was commanded, a third was not") {
  const World world{1};
  BehaviourWatch watch{amiro::catalogue, "travel", "travel"};
  watch.begin();
  take(watch, nothing);
  take(watch, follows);
  CHECK_FALSE(watch.over());
  take(watch, nothing);
  CHECK(watch.over());
  CHECK_FALSE(watch.was_active());
  watch.begin();
  take(watch, nothing);
  take(watch, nothing);
  take(watch, travels);
  CHECK_FALSE(watch.over());
  take(watch, arrived);
  CHECK(watch.over());
}

TEST_CASE("behaviour watch: another program replaces it by another behaviour, and ends it otherwise") {
  const World world{1};
  const auto commanded = [](const char* frame, bool replaces) {
    CAPTURE(frame);
    BehaviourWatch watch{amiro::catalogue, "behave", "follow"};
    watch.begin();
    take(watch, follows);
    take(watch, frame);
    CHECK(watch.is_replaced() == replaces);
    CHECK(watch.over() == replaces);
    take(watch, line_lost);  // said of what took its place
    CHECK(watch.ended() == (replaces ? "nothing" : "line_lost"));
    return watch.commanded();
  };
  CHECK(commanded("20B#A08601000000E803", true) == "travel 20B#A08601000000E803");
  CHECK(commanded("20C#E803", true) == "follow 20C#E803");
  CHECK(commanded("20C#0000", false) == "follow 20C#0000");
  CHECK(commanded("20B#0000000000000000", false).empty());  // a rest of another one ends nothing
  CHECK(commanded("201#0000000000000000", false) == "motors 201#0000000000000000");
  CHECK(commanded("23C#010203", false).empty());
  // The first that could have ended it is named.
  BehaviourWatch watch{amiro::catalogue, "behave", "follow"};
  watch.begin();
  take(watch, "201#0000000000000000");
  take(watch, "20B#A08601000000E803");
  CHECK(watch.commanded() == "motors 201#0000000000000000");
  watch.begin();
  CHECK(watch.commanded().empty());
  CHECK_FALSE(watch.is_replaced());
}

TEST_CASE("behaviour watch: a spec that has no such behaviour, or does not say what becomes of it") {
  const World world{1};
  const auto refusal = [](auto&& act) {
    Said said;
    int code = 0;
    try {
      act();
    } catch (const cli::Exit& exit) {
      code = exit.code;
    }
    CHECK(code == cli::exit_usage);
    return said.text();
  };
  CHECK(cli::behaviour_topic(amiro::catalogue, "behave", "home").name == "home");
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
