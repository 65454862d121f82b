// What the tables have of a file: tests/tool/operate/wide.operator.json, each thing that a file can say.
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "ocm/topics/amiro.hpp"

#include "cli/operate/operator_file.hpp"
#include "tests/tool/golden.hpp"

namespace operate_tables_test {

using namespace std::chrono_literals;
using namespace ocm;
using namespace ocm::test;
namespace operate = cli::operate;
using protocol::Priority;
using reflective::Watched;

operate::Loaded parsed(const std::string& text) {
  auto loaded = operate::parse(text, "wide", amiro::catalogue, 500'000);
  for (const auto& problem : loaded.problems) UNSCOPED_INFO(problem.place << ": " << problem.what);
  REQUIRE(loaded.file);
  return loaded;
}

/// The file with one change.
operate::Loaded with_change(std::string_view from, std::string_view to) {
  std::string text = text_of("tests/tool/operate/wide.operator.json");
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return parsed(text.replace(at, from.size(), to));
}

std::uint16_t topic(std::string_view name) {
  return reflective::topic_index(amiro::catalogue, name);
}
std::vector<std::int64_t> raw(const reflective::SetPoint& set_point) {
  return {set_point.raw.begin(), set_point.raw.end()};
}

TEST_CASE("operate: the tables have the times of a file, and where it begins and falls back to") {
  const auto loaded = parsed(text_of("tests/tool/operate/wide.operator.json"));
  const auto& tables = loaded.file->tables;
  CHECK(tables.name == "wide");
  CHECK(tables.settle == 80ms);
  CHECK(tables.retry == 700ms);
  CHECK(tables.reaction == 5ms);
  CHECK(tables.handling == 1500us);
  CHECK(tables.initial == 0);
  CHECK(tables.fall_back == 3);
  CHECK(loaded.file->description == "each thing that a file can say, once");
  CHECK(with_change(R"("retry": "700ms",)", "").file->tables.retry == 0ms);
}

TEST_CASE("operate: the tables have how a period follows a value") {
  const auto loaded = parsed(text_of("tests/tool/operate/wide.operator.json"));
  REQUIRE(loaded.file->parts[0].adaptations.size() == 1);
  const auto& adaptation = loaded.file->parts[0].adaptations[0];
  CHECK(adaptation.stream == 0);
  CHECK(adaptation.topic == topic("odometry"));
  CHECK(adaptation.magnitude);
  CHECK(adaptation.from == 0);
  CHECK(adaptation.to == 200'000);  // um/s
  CHECK(adaptation.at_from == 100ms);
  CHECK(adaptation.at_to == 40ms);
  CHECK(adaptation.grain == 20ms);
  CHECK(adaptation.every == 400ms);
  CHECK_FALSE(
      with_change(R"("magnitude": true)", R"("magnitude": false)").file->parts[0].adaptations[0].magnitude);
  CHECK_FALSE(with_change(R"( "magnitude": true,)", "").file->parts[0].adaptations[0].magnitude);
  CHECK(with_change(R"(, "every": "400ms")", "").file->parts[0].adaptations[0].every == 1s);
  CHECK(with_change(R"("from": "0m/s", "to")", R"("from": "-0.05m/s", "to")")
            .file->parts[0]
            .adaptations[0]
            .from == -50'000);
}

TEST_CASE("operate: the tables have streams, limits and set points of each configuration") {
  const auto loaded = parsed(text_of("tests/tool/operate/wide.operator.json"));
  const auto& slow = loaded.file->parts[0];
  const auto& line = loaded.file->parts[1];
  const auto& halted = loaded.file->parts[3];
  REQUIRE(slow.streams.size() == 4);
  CHECK(slow.streams[0] == reflective::Stream{topic("odometry"), 100ms, Priority::medium});
  CHECK(slow.streams[1] == reflective::Stream{topic("ring"), 60ms, Priority::high});
  CHECK(slow.streams[3] == reflective::Stream{topic("di_wheel_drive_status"), 1s, Priority::low});
  REQUIRE(slow.limits.size() == 3);
  CHECK(slow.limits[0].topic == topic("motors"));
  CHECK(slow.limits[0].field == 0);
  CHECK(slow.limits[0].min == -100'000);
  CHECK(slow.limits[0].max == 100'000);
  CHECK(slow.limits[0].per_second == 500'000);
  // What is not stated is as the spec has it.
  const auto& turn = amiro::catalogue.topics[topic("motors")].frames[0].fields[1];
  CHECK(slow.limits[1].field == 1);
  CHECK(slow.limits[1].min == turn.raw_min);
  CHECK(slow.limits[1].max == turn.raw_max);
  CHECK(slow.limits[1].per_second == 0);
  CHECK(slow.limits[2].topic == topic("travel"));
  CHECK(slow.limits[2].max == 1000);  // 0.1 mm/s
  CHECK_FALSE(slow.commanders.has_value());
  REQUIRE(line.entry.size() == 2);
  CHECK(line.entry[0].topic == topic("led_1"));
  CHECK(raw(line.entry[0]) == std::vector<std::int64_t>{16, 255, 0});
  CHECK(line.entry[0].priority == Priority::low);
  CHECK(line.entry[0].repeat == 0ms);
  CHECK(line.entry[1].topic == topic("follow"));
  CHECK(raw(line.entry[1]) == std::vector<std::int64_t>{500});
  CHECK(line.entry[1].priority == Priority::urgent);
  CHECK(line.entry[1].repeat == 400ms);
  REQUIRE(line.commanders.has_value());
  CHECK(*line.commanders == std::vector<std::string>{"led", "behave", "travel"});
  REQUIRE(halted.entry.size() == 3);
  CHECK(halted.entry[0].repeat == 150ms);
  CHECK(raw(halted.entry[2]) == std::vector<std::int64_t>{0, 0, 255});
  REQUIRE(halted.commanders.has_value());
  CHECK(halted.commanders->empty());
  const auto& others = loaded.file->stated_others;
  REQUIRE(others.size() == 3);
  CHECK(others[0] == reflective::Stream{topic("gyro"), 20ms, Priority::high});
  CHECK(others[1].topic == topic("led_3"));
  CHECK(others[1].period == 250ms);
}

TEST_CASE("operate: the tables have each condition, and how long a monitor is to hold") {
  const auto loaded = parsed(text_of("tests/tool/operate/wide.operator.json"));
  const auto& file = *loaded.file;
  std::vector<std::string> conditions;
  for (const auto& each : file.conditions)
    if (each.watched != Watched::field)
      conditions.push_back(fmt::format("{}: {} {} {} in {}", each.name, name(each.watched),
                                       each.is == reflective::Is::above ? ">" : "<", each.limit,
                                       each.window.count()));
  CHECK(conditions == std::vector<std::string>{
                          "age of ring above 300ms: age > 300000000 in 0",
                          "age of odometry above 350ms: age > 350000000 in 0",
                          "rate of odometry below 5 in 1s: rate < 5 in 1000000000",
                          "gap of odometry above 450ms: gap > 450000000 in 0",
                          "bus load above 72.5%: bus_load > 725 in 500000000",
                          "bus load below 30: bus_load < 300 in 500000000",
                          "bus state warning: bus_state > 0 in 0",
                          "refusals above 3: refusals > 3 in 0",
                          "rate of odometry above 30 in 1s: rate > 30 in 1000000000",
                          "bus state off: bus_state > 2 in 0",
                          "bus state down: bus_state > 3 in 0",
                          "bus state passive: bus_state > 1 in 0",
                      });
  CHECK(file.conditions[0].name == "ring.sensor_4>3000");
  CHECK(file.conditions[0].limit == 3000);
  CHECK(file.conditions[0].hysteresis == 200);
  CHECK(file.conditions[1].hysteresis == 0);
  std::vector<base::Duration> lasting;
  for (const auto& monitor : file.monitors) lasting.push_back(monitor.lasting);
  CHECK(lasting == std::vector<base::Duration>{0s, 0s, 1500ms, 2s, 0s, 0s, 0s, 0s});
}

TEST_CASE("operate: what two monitors look at alike is one condition, and what differs in one thing is two") {
  const auto conditions = [](const std::string& first, const std::string& second) {
    const auto loaded = parsed(
        R"({"name": "pair", "initial": "all", "fall_back": "all", "settle": "60ms", "reaction": "20ms", "handling": "1ms",
            "configurations": [{"name": "all", "streams": [{"topic": "ring"}]}],
            "monitors": [{"name": "one", "when": )" +
        first + R"(}, {"name": "two", "when": )" + second + "}]}");
    REQUIRE(loaded.file->terms.size() == 2);
    // Each monitor has its own, or both the first.
    CHECK(loaded.file->terms[0][0].condition == 0);
    CHECK(loaded.file->terms[1][0].condition == loaded.file->conditions.size() - 1);
    return loaded.file->conditions.size();
  };
  struct Pair {
    const char* first;
    const char* second;
  };
  constexpr const char* wide_band = R"({"where": "ring.sensor_1>3000", "hysteresis": "200"})";
  for (const auto& [first, second] : {
           Pair{R"("ring.sensor_1>5")", R"("ring.sensor_1>5")"},
           Pair{R"("ring.sensor_1>5")", R"("ring.sensor_1>=6")"},
           Pair{R"("ring.sensor_1>5")", R"({"not": "ring.sensor_1>5"})"},
           Pair{wide_band, wide_band},
           Pair{R"({"age": "ring", "above": "300ms"})", R"({"age": "proximity_ring", "above": "300000us"})"},
           Pair{R"({"rate": "ring", "above": 5, "window": "1s"})",
                R"({"rate": "ring", "above": 5, "window": "1000ms"})"},
           Pair{R"({"bus_load": true, "above": "7%", "window": "1s"})",
                R"({"bus_load": true, "above": "7.0", "window": "1s"})"},
           Pair{R"({"bus_state": "off"})", R"({"bus_state": "off"})"},
           Pair{R"({"refusals": true})", R"({"refusals": true, "above": 0})"},
       }) {
    CAPTURE(first, second);
    CHECK(conditions(first, second) == 1);
  }
  for (const auto& [first, second] : {
           Pair{R"({"age": "ring", "above": "300ms"})", R"({"gap": "ring", "above": "300ms"})"},  // what
           Pair{R"("ring.sensor_1>5")", R"("ring.sensor_1<5")"},                                  // how
           Pair{R"({"age": "ring", "above": "300ms"})",
                R"({"age": "odometry", "above": "300ms"})"},        // of what
           Pair{R"("ring.sensor_1>5")", R"("ring.sensor_2>5")"},    // frame
           Pair{R"("floor.sensor_1>5")", R"("floor.sensor_2>5")"},  // field
           Pair{R"("ring.sensor_1>5")", R"("ring.sensor_1>6")"},    // limit
           Pair{R"({"rate": "ring", "above": 5, "window": "1s"})",
                R"({"rate": "ring", "above": 5, "window": "2s"})"},
       }) {
    CAPTURE(first, second);
    CHECK(conditions(first, second) == 2);
  }
}

TEST_CASE("operate: what is repeated each nanosecond, or comes so often, is no less than what comes seldom") {
  CHECK(with_change(R"("period": "250ms")", R"("period": "1ns")").file->stated_others[1] ==
        reflective::Stream{topic("led_3"), 1ns, Priority::medium});
  const auto of = [](const std::string& repeat, const std::string& commanders = "") {
    return operate::parse(
        R"({"name": "often", "initial": "all", "fall_back": "all", "settle": "60ms", "reaction": "20ms", "handling": "1ms",
            "configurations": [{"name": "all", )" +
            commanders + R"("entry": [{"topic": "motors")" + repeat + "}]}]}",
        "often", amiro::catalogue, 500'000);
  };
  // What it repeats itself no other may command.
  for (const auto& [repeat, expected] :
       {std::pair{"", 1U}, std::pair{R"(, "repeat": "0ns")", 1U}, std::pair{R"(, "repeat": "1ns")", 0U}}) {
    CAPTURE(repeat);
    const auto loaded = of(repeat);
    REQUIRE(loaded.file);
    CHECK(loaded.file->parts[0].expected.size() == expected);
    const auto driven = of(repeat, R"("commanders": ["drive"], )");
    CHECK(driven.problems.size() == 1 - expected);
    if (!driven.problems.empty())
      CHECK(driven.problems[0].what ==
            R"("drive" may command "motors", of which "entry" repeats a set point)");
  }
}

TEST_CASE("operate: refusals are said from the first one on, where a file says no number") {
  const auto loaded = with_change(R"({"refusals": true, "above": 3})", R"({"refusals": true})");
  std::string found;
  for (const auto& each : loaded.file->conditions)
    if (each.watched == Watched::refusals) found += fmt::format("{}: {}\n", each.name, each.limit);
  CHECK(found == "refusals above 0: 0\n");
}

TEST_CASE("operate: the tables have each transition, one for each configuration that it leads from") {
  const auto loaded = parsed(text_of("tests/tool/operate/wide.operator.json"));
  const auto& tables = loaded.file->tables;
  std::vector<std::string> found;
  for (const auto& each : tables.transitions)
    found.push_back(fmt::format("{} -> {}: {} {} ({})",
                                each.from == reflective::any_configuration
                                    ? std::string_view{"any"}
                                    : tables.configurations[each.from].name,
                                tables.configurations[each.to].name,
                                each.monitor == reflective::by_request ? std::string_view{"request"}
                                                                       : tables.monitors[each.monitor].name,
                                each.precedence, each.cause));
  CHECK(found == std::vector<std::string>{
                     R"(slow -> halted: near 0 (say "stop"))",
                     "any -> halted: gone 1 (gone)",
                     "slow -> halted: busy 2 (busy)",
                     "line -> halted: busy 2 (busy)",
                     "halted -> slow: calm 200 (calm)",
                     "any -> halted: refused 3 (refused)",
                     "line -> halted: flooded 4 (flooded)",
                     "line -> halted: near 0 (near)",
                     "any -> halted: ill 0 (ill)",
                     "line -> halted: ended 5 (ended)",
                     "slow -> line: request 0 (on request)",
                     "line -> watching_only: request 0 (looking after it)",
                     "slow -> watching_only: request 0 (looking after it)",
                     "any -> halted: request 0 (on request)",
                     "watching_only -> slow: request 0 (on request)",
                 });
}

TEST_CASE("operate: what programs command counts where one of them may, each verb with its own actuators") {
  const auto counted = [](const std::string& commanders) {
    const auto loaded = with_change(R"("commanders": ["set"])", R"("commanders": [)" + commanders + "]");
    std::string text;
    for (const auto& each : loaded.file->parts[2].expected)
      text += fmt::format("{} in {} ms", loaded.file->tables.topic(each.topic).name, each.period / 1ms);
    text += ";";
    for (const auto each : loaded.file->parts[2].uncounted)
      text += fmt::format(" {}", loaded.file->tables.topic(each).name);
    return text;
  };
  // The file itself says how often led_3 is commanded.
  const std::string lights = " led_1 led_2 led_4 led_5 led_6 led_7 led_8";
  CHECK(counted("") == ";");
  CHECK(counted(R"("drive")") == "motors in 100 ms;");
  CHECK(counted(R"("led")") == ";" + lights);
  CHECK(counted(R"("led", "drive")") == "motors in 100 ms;" + lights);
  for (const char* const any : {R"("behave")", R"("replay")", R"("run")", R"("set")", R"("travel")"})
    CHECK(counted(any) ==
          "motors in 100 ms;" + lights + " floor_calibration ring_calibration travel follow avoid home");
}

}  // namespace operate_tables_test
