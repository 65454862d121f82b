// What is proved of operator files, word for word: as a table, as JSON and as a picture, on a bus that is
// fast enough and on one that is not.
#include "cli/operate/study.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

#include "generator/spec/spec.hpp"
#include "tests/tool/golden.hpp"

namespace operate_study_test {

using namespace ocm;
using namespace ocm::test;
namespace operate = cli::operate;

std::string of(const std::vector<spec::Problem>& problems) {
  std::string text;
  for (const auto& problem : problems)
    text += problem.place + ": " + problem.what + "\n  " + problem.remedy + "\n";
  return text;
}

/// Each thing that a file can say, once: tests/tool/operate/wide.operator.json.
const operate::OperatorFile& wide() {
  static const auto loaded =
      operate::parse(text_of("tests/tool/operate/wide.operator.json"), "wide", amiro::catalogue, 500'000);
  INFO(of(loaded.problems));
  REQUIRE(loaded.file);
  return *loaded.file;
}

TEST_CASE("operate: what is proved of a file is shown as it was") {
  const auto study = operate::study(wide(), 500'000);
  CHECK(study.passes());
  is_as_in("tests/tool/operate/golden/wide.txt", operate::to_table(study));
  is_as_in("tests/tool/operate/golden/wide.jsonl", operate::to_json(study));
  is_as_in("tests/tool/operate/golden/wide.dot", operate::to_dot(study));
}

TEST_CASE("operate: why a file is not in time on a slow bus is said as it was") {
  for (const auto& [rate, name] : {std::pair{125'000, "125k"}, std::pair{30'000, "30k"}}) {
    const auto loaded = operate::parse(text_of("tests/tool/operate/wide.operator.json"), "wide",
                                       amiro::catalogue, static_cast<std::uint32_t>(rate));
    REQUIRE(loaded.file);
    const auto study = operate::study(*loaded.file, static_cast<std::uint32_t>(rate));
    CHECK_FALSE(study.passes());
    is_as_in(std::string{"tests/tool/operate/golden/wide_"} + name + ".txt",
             operate::to_table(study) + "---\n" + of(study.doubts));
  }
}

TEST_CASE("operate: the example is shown as it was") {
  const auto loaded =
      operate::load(std::string{OCM_SOURCE_DIR} + "/examples/guard.operator.json", amiro::catalogue, 500'000);
  REQUIRE(loaded.file);
  is_as_in("tests/tool/operate/golden/guard.txt", operate::to_table(operate::study(*loaded.file, 500'000)));
}

TEST_CASE("operate: a file of one configuration, and of messages that come by themselves") {
  const auto alone = operate::parse(
      R"({"name": "alone", "initial": "all", "fall_back": "all", "settle": "40ms", "retry": "1s", "reaction": "4ms", "handling": "2ms",
          "configurations": [{"name": "all", "streams": [{"topic": "ring", "period": "9ms"},
            {"topic": "magnetometer", "period": "30ms"}]}], "monitors": [{"name": "one", "when": {"bus_state": "off"}}]})",
      "alone", amiro::catalogue, 1'000'000);
  INFO(of(alone.problems));
  REQUIRE(alone.file);
  const auto study = operate::study(*alone.file, 1'000'000);
  const auto slow = operate::study(*alone.file, 10'000);  // nothing has a bound
  const auto car = spec::load(std::string{OCM_SOURCE_DIR} + "/examples/small_car.dbc");
  REQUIRE(car.spec);
  const auto messages = operate::parse(
      R"({"name": "car", "initial": "watching", "fall_back": "alarm", "settle": "60ms", "reaction": "20ms", "handling": "1ms",
          "configurations": [{"name": "watching", "streams": [{"topic": "Driving"}, {"topic": "Engine"}]},
                             {"name": "alarm", "streams": [{"topic": "Engine", "period": "20ms", "priority": "low"}]}],
          "monitors": [{"name": "fast", "when": {"all": ["Driving.Speed>50km/h", {"not": {"not": {"gap": "Engine", "above": "2s"}}}]}},
                       {"name": "slow", "when": {"not": {"any": ["Engine.Speed>=800rpm", "Engine.Torque!=0Nm"]}}}],
          "transitions": [{"from": "watching", "to": "alarm", "when": "fast"}, {"from": "alarm", "to": "watching", "when": "slow"}]})",
      "car", car.spec->catalogue(), 500'000);
  INFO(of(messages.problems));
  REQUIRE(messages.file);
  const auto of_car = operate::study(*messages.file, 500'000);
  is_as_in("tests/tool/operate/golden/alone.txt",
           operate::to_table(study) + "---\n" + of(study.doubts) + "---\n" + operate::to_dot(study));
  is_as_in("tests/tool/operate/golden/alone_slow.txt",
           operate::to_table(slow) + "---\n" + of(slow.doubts) + "---\n" + operate::to_json(slow));
  is_as_in("tests/tool/operate/golden/car.txt", operate::to_table(of_car) + "---\n" + of(of_car.doubts) +
                                                    "---\n" + operate::to_json(of_car) +
                                                    operate::to_dot(of_car));
}

TEST_CASE("operate: what a board alone cannot serve in time is one reason, and the bus is none besides") {
  // A sample of the ring takes its board 26.572 ms.
  const auto doubts = [](const std::string& period) {
    const auto loaded = operate::parse(
        R"({"name": "late", "initial": "all", "fall_back": "all", "settle": "200ms", "reaction": "4ms", "handling": "2ms",
            "configurations": [{"name": "all", "streams": [{"topic": "ring", "priority": "high", "period": ")" +
            period + R"("}]}]})",
        "late", amiro::catalogue, 1'000'000);
    INFO(of(loaded.problems));
    REQUIRE(loaded.file);
    return operate::study(*loaded.file, 1'000'000).doubts;
  };
  const auto too_long = doubts("26ms");
  INFO(of(too_long));
  REQUIRE(too_long.size() == 1);
  CHECK(too_long[0].what ==
        "in \"all\" the processor of power_management takes up to 26.572 ms for a sample of proximity_ring, "
        "its "
        "deadline is 26 ms");
  // Just in time on its board, and on the bus no more.
  const auto on_the_bus = doubts("26572us");
  INFO(of(on_the_bus));
  REQUIRE(on_the_bus.size() == 1);
  CHECK_THAT(on_the_bus[0].what, Catch::StartsWith("in \"all\" proximity_ring takes up to ") &&
                                     Catch::EndsWith(" ms (26.572 ms of it on its board), its deadline is "
                                                     "26.572 ms"));
  CHECK(doubts("40ms").empty());
}

TEST_CASE("operate: of what others send the frame that takes longest is named, of two the more urgent one") {
  // Three frames of one length: the second waits for the first and for one that is on its way, and the third
  // for both, which is as long.
  const auto oven = spec::parse(
      R"({"robot": "Oven", "namespace": "oven", "bus": {"bit_rate": 10000, "source": "decided"},
          "boards": [{"name": "main_board", "mcu": "STM32F103", "source": "decided"}],
          "topics": [
            {"name": "heat", "id": "0x11", "board": "main_board", "deadline": "4ms", "source": "decided",
             "frames": [{"fields": [{"name": "value", "byte": 0, "type": "u8"}]}]},
            {"name": "smoke", "id": "0x12", "board": "main_board", "deadline": "5ms", "source": "decided",
             "frames": [{"fields": [{"name": "value", "byte": 0, "type": "u8"}]}]},
            {"name": "door", "id": "0x13", "board": "main_board", "deadline": "6ms", "source": "decided",
             "frames": [{"fields": [{"name": "value", "byte": 0, "type": "u8"}]}]}]})",
      "oven.json");
  INFO(of(oven.problems));
  REQUIRE(oven.spec);
  const auto loaded = operate::parse(
      R"({"name": "warm", "initial": "all", "fall_back": "all", "settle": "60ms", "reaction": "20ms", "handling": "1ms",
          "others": [{"topic": "heat", "period": "1s"}, {"topic": "smoke", "period": "1s"}, {"topic": "door", "period": "1s"}],
          "configurations": [{"name": "all"}]})",
      "warm", oven.spec->catalogue(), 10'000);
  INFO(of(loaded.problems));
  REQUIRE(loaded.file);
  const auto study = operate::study(*loaded.file, 10'000);
  INFO(of(study.doubts));
  REQUIRE(study.doubts.size() == 1);
  CHECK_THAT(study.doubts[0].what, Catch::StartsWith("in \"all\" what others send takes up to ") &&
                                       Catch::EndsWith(", its deadline is 5 ms"));
}

TEST_CASE("operate: the least of whole milliseconds that is enough is offered, and no more") {
  // At 1 kbit/s all that takes part is of whole milliseconds.
  constexpr std::uint32_t bit_rate = 1'000;
  constexpr std::int64_t ms = 1'000'000;
  const auto oven = spec::parse(
      R"({"robot": "Oven", "namespace": "oven", "bus": {"bit_rate": 10000, "source": "decided"},
          "boards": [{"name": "main_board", "mcu": "STM32F103", "source": "decided"}],
          "topics": [{"name": "heat", "id": "0x11", "board": "main_board", "deadline": "5s", "source": "decided",
                      "frames": [{"fields": [{"name": "value", "byte": 0, "type": "u8"}]}]}]})",
      "oven.json");
  INFO(of(oven.problems));
  REQUIRE(oven.spec);
  struct Found {
    std::int64_t over_after;
    std::vector<std::string> remedies;
  };
  const auto found = [&](std::int64_t settle, std::int64_t above) {
    const auto loaded = operate::parse(
        R"({"name": "warm", "initial": "all", "fall_back": "all", "reaction": "4ms", "handling": "2ms", "settle": ")" +
            std::to_string(settle) +
            R"(ms", "configurations": [{"name": "all", "streams": [{"topic": "heat", "period": "5s"}]}],
            "monitors": [{"name": "silent", "when": {"age": "heat", "above": ")" +
            std::to_string(above) + R"(ms"}}]})",
        "warm", oven.spec->catalogue(), bit_rate);
    INFO(of(loaded.problems));
    REQUIRE(loaded.file);
    const auto study = operate::study(*loaded.file, bit_rate);
    REQUIRE(study.changes.size() == 1);
    Found what{study.changes[0].over_after, {}};
    for (const auto& doubt : study.doubts) what.remedies.push_back(doubt.remedy);
    return what;
  };
  const auto calm = found(5'000, 60'000);
  CHECK(calm.remedies.empty());
  REQUIRE(calm.over_after % ms == 0);
  const std::int64_t settle = calm.over_after / ms;
  const auto too_soon = found(settle - 1, 60'000);
  CHECK(too_soon.over_after == calm.over_after);
  CHECK(too_soon.remedies ==
        std::vector<std::string>{"\"settle\": \"" + std::to_string(settle) + "ms\" or longer"});
  CHECK(found(settle, 60'000).remedies.empty());
  // An age must be above what samples are apart.
  const auto restless = found(5'000, 1'000).remedies;
  REQUIRE(restless.size() == 1);
  constexpr std::string_view begins = "\"above\": \"";
  REQUIRE(restless[0].starts_with(begins));
  const std::int64_t above = std::stoll(restless[0].substr(begins.size()));
  CHECK(restless[0] == std::string{begins} + std::to_string(above) + "ms\" or longer");
  CHECK(found(5'000, above - 1).remedies == restless);
  CHECK(found(5'000, above).remedies.empty());
}

}  // namespace operate_study_test
