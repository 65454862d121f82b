// What is said of mistakes in an operator file, word for word: each row is wide.operator.json with one
// change.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

#include "cli/operate/operator_file.hpp"
#include "generator/spec/spec.hpp"
#include "tests/tool/golden.hpp"

namespace operate_mistakes_test {

using namespace ocm;
using namespace ocm::test;
namespace operate = cli::operate;

struct Row {
  const char* from;
  const char* to;
};

constexpr Row rows[] = {
    // members of the whole
    {R"("name": "wide")", R"("name": "Wide")"},
    {R"("name": "wide",)", ""},
    {R"("each thing that a file can say, once")", R"("two\nlines")"},
    {R"("initial": "slow",)", ""},
    {R"("initial": "slow")", R"("initial": "slwo")"},
    {R"("initial": "slow")", R"("initial": "somewhere_else")"},
    {R"("fall_back": "halted",)", ""},
    {R"("fall_back": "halted")", R"("fall_back": 3)"},
    {R"("settle": "80ms",)", ""},
    {R"("settle": "80ms")", R"("settle": "0ms")"},
    {R"("settle": "80ms")", R"("settle": "60s")"},
    {R"("settle": "80ms")", R"("settle": "60001ms")"},
    {R"("retry": "700ms")", R"("retry": "86401s")"},
    {R"("retry": "700ms")", R"("retry": "soon")"},
    {R"("reaction": "5ms",)", ""},
    {R"("handling": "1500us",)", ""},
    {R"("handling": "1500us",)", R"("handling": "1500us", "handlings": 1,)"},
    // others
    {R"({"topic": "led_3", "period": "250ms"})", R"({"topic": "led_3"})"},
    {R"({"topic": "led_3", "period": "250ms"})", R"({"topic": "led_3", "period": "0ms"})"},
    {R"({"topic": "led_3", "period": "250ms"})", R"({"period": "250ms"})"},
    {R"({"topic": "led_3", "period": "250ms"})", R"("led_3")"},
    {R"({"topic": "led_3", "period": "250ms"})", R"({"topic": "led_9", "period": "250ms"})"},
    {R"({"topic": "led_3", "period": "250ms"})", R"({"topic": "led_3", "period": "250ms", "adapt": {}})"},
    {R"({"topic": "gyro", "period": "20ms", "priority": "high"})",
     R"({"topic": "gyro", "priority": "highest"})"},
    {R"({"topic": "gyro", "period": "20ms", "priority": "high"})", R"({"topic": "gyro", "period": "70s"})"},
    // streams, and periods that follow a value
    {R"({"topic": "accelerometer"})", R"({"topic": "motors", "period": "50ms"})"},
    {R"({"topic": "accelerometer"})", R"({"topic": "odometry"})"},
    {R"({"topic": "accelerometer"})", R"({"topic": "accelerometer", "period": "17us"})"},
    {R"({"topic": "accelerometer"})", R"([])"},
    {R"("from": "0m/s", "to": "0.2m/s")", R"("from": "0.2m/s", "to": "0m/s")"},
    {R"("from": "0m/s", "to": "0.2m/s")", R"("from": "0m/s", "to": "0.2V")"},
    {R"("from": "0m/s", "to": "0.2m/s")", R"("from": "0m/s")"},
    {R"("magnitude": true)", R"("magnitude": 1)"},
    {R"("grain": "20ms")", R"("grain": "7ms")"},
    {R"("every": "400ms")", R"("every": "10ms")"},
    {R"("at_from": "100ms")", R"("at_from": "80ms")"},
    {R"("at_to": "40ms")", R"("at_to": "120ms")"},
    {R"("field": "odometry.velocity.x", "magnitude")", R"("field": "ring.sensor_1.distance", "magnitude")"},
    {R"("field": "odometry.velocity.x", "magnitude")", R"("field": "floor", "magnitude")"},
    // limits
    {R"({"field": "motors.z"})", R"({"field": "odometry.velocity.x"})"},
    {R"({"field": "motors.z"})", R"({"field": "motors"})"},
    {R"({"field": "motors.z"})", R"({"min": "0m/s"})"},
    {R"({"field": "motors.z"})", R"({"field": "motors.z", "min": "1rad/s", "max": "0rad/s"})"},
    {R"({"field": "motors.z"})", R"({"field": "motors.z", "max": "1000rad/s"})"},
    {R"({"field": "motors.z"})", R"({"field": "motors.z", "max": "soon"})"},
    {R"("per_second": "0.5m/s")", R"("per_second": "0m/s")"},
    {R"("per_second": "0.5m/s")", R"("per_second": "-1m/s")"},
    {R"("per_second": "0.5m/s")", R"("per_second": "half")"},
    {R"("per_second": "0.5m/s")", R"("per_second": 5)"},
    // who may command
    {R"(["led", "behave", "travel"])", R"("led")"},
    {R"(["led", "behave", "travel"])", R"([7])"},
    {R"(["led", "behave", "travel"])", R"(["stop"])"},
    {R"("commanders": [],)", R"("commanders": ["drive", "led"],)"},
    {R"("led_2", "values": {"blue": "255"})", R"("led_2", "repeat": "1s")"},
    {R"("commanders": [],
      "streams")",
     R"("commanders": 5,
      "streams")"},
    // set points
    {R"({"topic": "led_2", "values": {"blue": "255"}})", R"({"topic": "ring"})"},
    {R"({"topic": "led_2", "values": {"blue": "255"}})", R"({"topic": "led2"})"},
    {R"({"topic": "led_2", "values": {"blue": "255"}})", R"({"topic": "led_2", "values": {"blue": "256"}})"},
    {R"({"topic": "led_2", "values": {"blue": "255"}})", R"({"topic": "led_2", "values": {"blu": "255"}})"},
    {R"({"topic": "led_2", "values": {"blue": "255"}})", R"({"topic": "led_2", "values": ["255"]})"},
    {R"({"topic": "led_2", "values": {"blue": "255"}})", R"({"values": {}})"},
    {R"({"topic": "led_2", "values": {"blue": "255"}})", R"("led_2")"},
    {R"("values": {"speed": "0.05m/s"}, "priority": "urgent")",
     R"("values": {"speed": "0.05"}, "priority": "fast")"},
    {R"({"field": "home.speed", "min": "0m/s", "max": "0m/s"})",
     R"({"field": "follow.speed", "min": "0m/s", "max": "0.04m/s"})"},
    // configurations
    {R"("name": "watching_only")", R"("name": "line")"},
    {R"("name": "watching_only",)", ""},
    {R"("streams": [{"topic": "power", "period": "2s"}])", R"("streams": {"topic": "power"})"},
    {R"("streams": [{"topic": "power", "period": "2s"}])", R"("stream": [])"},
    // conditions
    {R"("ring.sensor_3>2000", "ring.sensor_5)", R"("ring.sensor_3", "ring.sensor_5)"},
    {R"("ring.sensor_3>2000", "ring.sensor_5)", R"("ring.sensor_3>70000", "ring.sensor_5)"},
    {R"("ring.sensor_3>2000", "ring.sensor_5)", R"("ring.sensor_9>2", "ring.sensor_5)"},
    {R"("ring.sensor_3>2000", "ring.sensor_5)", R"("motors.x>0m/s", "ring.sensor_5)"},
    {R"("ring.sensor_3>2000", "ring.sensor_5)", R"("floor.sensor_1>2000", "ring.sensor_5)"},
    {R"({"where": "ring.sensor_4>3000", "hysteresis": "200"})",
     R"({"where": "ring.sensor_4=3000", "hysteresis": "200"})"},
    {R"({"where": "ring.sensor_4>3000", "hysteresis": "200"})",
     R"({"where": "ring.sensor_4.distance<0.1m", "hysteresis": "0.01m"})"},
    {R"({"where": "ring.sensor_4>3000", "hysteresis": "200"})",
     R"({"where": "ring.sensor_4>3000", "hysteresis": "0"})"},
    {R"({"where": "ring.sensor_4>3000", "hysteresis": "200"})",
     R"({"where": "ring.sensor_4>3000", "above": 3})"},
    {R"({"where": "ring.sensor_4>3000", "hysteresis": "200"})", R"({"where": 3})"},
    {R"({"where": "ring.sensor_4>3000", "hysteresis": "200"})", R"({"hysteresis": "200"})"},
    {R"({"where": "ring.sensor_4>3000", "hysteresis": "200"})", R"(7)"},
    {R"({"age": "ring", "above": "300ms"})", R"({"age": "ring"})"},
    {R"({"age": "ring", "above": "300ms"})", R"({"age": "ring", "gap": "ring", "above": "300ms"})"},
    {R"({"age": "ring", "above": "300ms"})", R"({"age": "ring", "above": "0ms"})"},
    {R"({"age": "ring", "above": "300ms"})", R"({"age": "ring", "above": "86400s"})"},
    {R"({"age": "ring", "above": "300ms"})", R"({"age": "rin", "above": "86401s"})"},
    {R"({"age": "ring", "above": "300ms"})", R"({"age": "motors", "above": "1s"})"},
    {R"({"age": "ring", "above": "300ms"})", R"({"all": []})"},
    {R"({"age": "ring", "above": "300ms"})", R"({"any": "ring.sensor_4>3000"})"},
    {R"({"age": "ring", "above": "300ms"})", R"({"not": "ring.sensor_4>3000", "above": "1s"})"},
    {R"({"rate": "odometry", "below": 5, "window": "1s"})", R"({"rate": "odometry", "window": "1s"})"},
    {R"({"rate": "odometry", "below": 5, "window": "1s"})", R"({"rate": "odometry", "below": 5})"},
    {R"({"rate": "odometry", "below": 5, "window": "1s"})",
     R"({"rate": "odometry", "below": 5, "above": 4, "window": "1s"})"},
    {R"({"rate": "odometry", "below": 5, "window": "1s"})",
     R"({"rate": "odometry", "below": -1, "window": "1s"})"},
    {R"({"rate": "odometry", "below": 5, "window": "1s"})",
     R"({"rate": "odometry", "below": 1000000000, "window": "60s"})"},
    {R"({"rate": "odometry", "below": 5, "window": "1s"})",
     R"({"rate": "odometry", "below": 1000000001, "window": "61s"})"},
    {R"("above": "72.5%")", R"("above": "100%")"},
    {R"("above": "72.5%")", R"("above": "99.96%")"},
    {R"("above": "72.5%")", R"("above": "99.9%")"},
    {R"("above": "72.5%")", R"("below": "100%")"},
    {R"("above": "72.5%")", R"("below": "0.1%")"},
    {R"("above": "72.5%")", R"("below": "0%")"},
    {R"("above": "72.5%")", R"("above": "100.1%")"},
    {R"("above": "72.5%")", R"("above": "0%")"},
    {R"("above": "72.5%")", R"("above": "-0.1%")"},
    {R"("above": "72.5%")", R"("above": "full")"},
    {R"("above": "72.5%")", R"("above": 72)"},
    {R"("above": "72.5%", "window": "500ms"})", R"("above": "72.5%", "window": "600ms"})"},
    {R"({"bus_load": true, "above")", R"({"bus_load": false, "above")"},
    {R"({"refusals": true, "above": 3})", R"({"refusals": 1})"},
    {R"({"refusals": true, "above": 3})", R"({"refusals": true, "above": 1000000})"},
    {R"({"refusals": true, "above": 3})", R"({"refusals": true, "above": 1000001})"},
    {R"({"bus_state": "off"})", R"({"bus_state": "on"})"},
    {R"({"bus_state": "off"})", R"({"bus_state": "off", "above": 3})"},
    // monitors
    {R"("name": "refused", "when")", R"("name": "near", "when")"},
    {R"("name": "refused", "when")", R"("when")"},
    {R"({"name": "refused", "when": {"refusals": true, "above": 3}})", R"({"name": "refused"})"},
    {R"({"name": "refused", "when": {"refusals": true, "above": 3}})", R"("refused")"},
    {R"("for": "1500ms")", R"("for": "-1ms")"},
    // transitions
    {R"({"from": "slow", "to": "line", "on_request": true})", R"({"from": "slow", "to": "line"})"},
    {R"({"from": "slow", "to": "line", "on_request": true})",
     R"({"from": "slow", "to": "line", "on_request": false})"},
    {R"({"from": "slow", "to": "line", "on_request": true})",
     R"({"from": "slow", "to": "line", "on_request": true, "when": "near"})"},
    {R"({"from": "slow", "to": "line", "on_request": true})",
     R"({"from": "slow", "to": "slow", "on_request": true})"},
    {R"({"from": "slow", "to": "line", "on_request": true})",
     R"({"from": [], "to": "line", "on_request": true})"},
    {R"({"from": "slow", "to": "line", "on_request": true})",
     R"({"from": ["slow", "lien"], "to": "line", "on_request": true})"},
    {R"({"from": "slow", "to": "line", "on_request": true})", R"({"from": "slow", "on_request": true})"},
    {R"({"from": "slow", "to": "line", "on_request": true},)", ""},
    {R"({"from": "slow", "to": "line", "on_request": true})", R"("line")"},
    {R"("to": "halted", "when": "refused", "precedence": 3)",
     R"("to": "halted", "when": "refuse", "precedence": 3)"},
    {R"("to": "halted", "when": "refused", "precedence": 3)",
     R"("to": "halted", "when": "refused", "precedence": 255)"},
    {R"("to": "halted", "when": "refused", "precedence": 3)",
     R"("to": "halted", "when": "refused", "precedence": 256)"},
    {R"("to": "halted", "when": "refused", "precedence": 3)",
     R"("to": "slow", "when": "refused", "precedence": 1)"},
    {R"("to": "halted", "when": "refused", "precedence": 3)",
     R"("to": "halted", "when": "ended", "precedence": 3)"},
    {R"("to": "halted", "when": "refused", "precedence": 3)",
     R"("from": "halted", "to": "watching_only", "when": "flooded", "precedence": 200)"},
};

TEST_CASE("operate: what is said of each mistake in a file is as it was") {
  const std::string whole = text_of("tests/tool/operate/wide.operator.json");
  std::string text;
  for (const Row& row : rows) {
    const auto at = whole.find(row.from);
    INFO(row.from);
    REQUIRE(at != std::string::npos);
    std::string changed = whole;
    changed.replace(at, std::string{row.from}.size(), row.to);
    const auto loaded = operate::parse(changed, "a", amiro::catalogue, 500'000);
    CHECK((loaded.file == nullptr) == !loaded.problems.empty());
    text += std::string{"--- "} + row.from + "\n +- " + row.to + "\n";
    for (const auto& problem : loaded.problems)
      text += problem.place + ": " + problem.what + "\n    " + problem.remedy + "\n";
  }
  is_as_in("tests/tool/operate/golden/mistakes.txt", text);
}

/// wide.operator.json with one change.
operate::Loaded with_change(std::string_view from, std::string_view to) {
  std::string text = text_of("tests/tool/operate/wide.operator.json");
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return operate::parse(text.replace(at, from.size(), to), "a", amiro::catalogue, 500'000);
}

TEST_CASE("operate: a distance of two values is rounded up to whole steps, and is one at least") {
  struct Typed {
    const char* typed;
    std::int64_t raw;
  };
  // The field has steps of 1 um/s.
  for (const auto& [typed, raw] :
       {Typed{"0.5m/s", 500'000}, Typed{"0.0000014m/s", 2}, Typed{"0.0000016m/s", 2}, Typed{"0.000001m/s", 1},
        Typed{"0.0000001m/s", 1}, Typed{"20mm/s", 20'000}}) {
    CAPTURE(typed);
    const auto loaded = with_change(R"("0.5m/s")", '"' + std::string{typed} + '"');
    REQUIRE(loaded.file);
    CHECK(loaded.file->parts[0].limits[0].per_second == raw);
  }
}

TEST_CASE("operate: a distance is the same where raw numbers fall while values rise") {
  const auto fan =
      spec::parse("BU_: N\nBO_ 256 Fan: 8 N\n SG_ Volts : 0|8@1+ (-0.5,0) [0|0] \"V\" N\n", "fan.dbc");
  REQUIRE(fan.spec);
  struct Typed {
    const char* typed;
    std::int64_t raw;
  };
  for (const auto& [typed, raw] : {Typed{"1V", 2}, Typed{"0.6V", 2}, Typed{"0.1V", 1}}) {
    CAPTURE(typed);
    const auto loaded = operate::parse(
        R"({"name": "fan", "initial": "all", "fall_back": "all", "settle": "60ms", "reaction": "20ms", "handling": "1ms",
            "configurations": [{"name": "all", "streams": [{"topic": "Fan", "period": "100ms"}]}],
            "monitors": [{"name": "low", "when": {"where": "Fan.Volts<-10V", "hysteresis": ")" +
            std::string{typed} + R"("}}]})",
        "fan", fan.spec->catalogue(), 500'000);
    for (const auto& problem : loaded.problems) UNSCOPED_INFO(problem.place << ": " << problem.what);
    REQUIRE(loaded.file);
    REQUIRE(loaded.file->conditions.size() == 1);
    CHECK(loaded.file->conditions[0].is == reflective::Is::above);
    CHECK(loaded.file->conditions[0].limit == 20);
    CHECK(loaded.file->conditions[0].hysteresis == raw);
  }
}

TEST_CASE("operate: of the topics that a monitor looks at the one is named that is not asked for") {
  const auto loaded = operate::parse(
      R"({"name": "blind", "initial": "all", "fall_back": "halted", "settle": "60ms", "reaction": "20ms", "handling": "1ms",
          "configurations": [{"name": "all", "streams": [{"topic": "ring"}]}, {"name": "halted"}],
          "monitors": [{"name": "empty", "when": "power.state_of_charge<20%"},
                       {"name": "near", "when": {"all": [{"any": ["ring.sensor_1>5", "ring.sensor_2>5"]},
                                                         {"bus_state": "off"}, "odometry.velocity.x>0.1m/s"]}}],
          "transitions": [{"from": "all", "to": "halted", "when": "near"}]})",
      "blind", amiro::catalogue, 500'000);
  REQUIRE(loaded.problems.size() == 1);
  CHECK(loaded.problems[0].what == R"(its monitor looks at "odometry", which "all" does not ask for)");
}

TEST_CASE(
    "operate: of a transition from any configuration a topic is named that none asks for, if there is one") {
  const auto problems = [](const std::string& of_second, const std::string& of_halted = "") {
    const auto loaded = operate::parse(
        R"({"name": "blind", "initial": "all", "fall_back": "halted", "settle": "60ms", "reaction": "20ms", "handling": "1ms",
            "configurations": [{"name": "all", "streams": [{"topic": "ring"}]}, {"name": "halted", "streams": [)" +
            of_halted + R"(]},
                               {"name": "second", "streams": [)" +
            of_second + R"(]}],
            "monitors": [{"name": "near", "when": {"all": ["ring.sensor_1>5", "odometry.velocity.x>0.1m/s"]}}],
            "transitions": [{"to": "halted", "when": "near"}, {"from": "all", "to": "second", "on_request": true},
                            {"from": "second", "to": "halted", "on_request": true}]})",
        "blind", amiro::catalogue, 500'000);
    std::vector<std::string> said;
    for (const auto& problem : loaded.problems) said.push_back(problem.what);
    return said;
  };
  CHECK(problems("") ==
        std::vector<std::string>{
            R"(its monitor looks at "odometry", which no configuration that it leads from asks for)"});
  CHECK(problems(R"({"topic": "odometry"})") ==
        std::vector<std::string>{"its monitor looks at topics that no one configuration asks for together"});
  // What it leads to is not asked.
  CHECK(problems("", R"({"topic": "odometry"})") == problems(""));
}

TEST_CASE("operate: of a set point that is outside the spec the field is named that is") {
  const auto oven = spec::parse(
      R"({"robot": "Oven", "namespace": "oven", "bus": {"bit_rate": 500000, "source": "decided"},
          "boards": [{"name": "main_board", "mcu": "STM32F103", "source": "decided"}],
          "topics": [{"name": "heater", "kind": "actuator", "id": "0x01", "board": "main_board", "source": "decided",
            "frames": [{"fields": [
              {"name": "fan", "byte": 0, "type": "u8", "range": [0, 10]},
              {"name": "watts", "byte": 1, "type": "u8", "range": [5, 20]},
              {"name": "minutes", "byte": 2, "type": "u8", "range": [1, 30]}]}]}]})",
      "oven.json");
  for (const auto& problem : oven.problems) UNSCOPED_INFO(problem.place << ": " << problem.what);
  REQUIRE(oven.spec);
  const auto remedy = [&](const std::string& values) {
    const auto loaded = operate::parse(
        R"({"name": "warm", "initial": "all", "fall_back": "all", "settle": "60ms", "reaction": "20ms", "handling": "1ms",
            "configurations": [{"name": "all", "entry": [{"topic": "heater", "values": {)" +
            values + "}}]}]}",
        "warm", oven.spec->catalogue(), 500'000);
    REQUIRE(loaded.problems.size() == 1);
    CHECK(loaded.problems[0].place.ends_with("/configurations/0/entry/0"));
    return loaded.problems[0].remedy;
  };
  // What is not stated is 0.
  CHECK(remedy("") == "watts takes 5 to 20");
  CHECK(remedy(R"("fan": "10")") == "watts takes 5 to 20");
  CHECK(remedy(R"("watts": "5")") == "minutes takes 1 to 30");
  CHECK(remedy(R"("fan": "10", "watts": "20")") == "minutes takes 1 to 30");
}

TEST_CASE("operate: what is wrong is said in the order of the file, whatever is read first") {
  // Where it begins is looked at when all configurations are known, and transitions behind those.
  const auto loaded = operate::parse(
      R"({"name": "order", "initial": "al",
          "transitions": [{"from": "all", "to": "halted", "when": "near"}],
          "fall_back": "haltde", "settle": "60ms", "reaction": "20ms", "handling": "1ms",
          "configurations": [{"name": "all", "streams": [{"topic": "rnig"}]}, {"name": "halted"}]})",
      "order", amiro::catalogue, 500'000);
  std::vector<std::string> places;
  for (const auto& problem : loaded.problems) places.push_back(problem.place);
  CHECK(places == std::vector<std::string>{"order:1: /initial", "order:2: /transitions/0/when",
                                           "order:3: /fall_back",
                                           "order:4: /configurations/0/streams/0/topic"});
}

TEST_CASE("operate: where a file has no monitor at all one is to be added") {
  const auto loaded = operate::parse(
      R"({"name": "blind", "initial": "all", "fall_back": "halted", "settle": "60ms", "reaction": "20ms", "handling": "1ms",
          "configurations": [{"name": "all"}, {"name": "halted"}],
          "transitions": [{"from": "all", "to": "halted", "when": "near"}]})",
      "blind", amiro::catalogue, 500'000);
  REQUIRE(loaded.problems.size() == 1);
  CHECK(loaded.problems[0].place.ends_with(": /transitions/0/when"));
  CHECK(loaded.problems[0].what == R"(there is no monitor "near")");
  CHECK(loaded.problems[0].remedy == "add it to monitors");
}

TEST_CASE("operate: a load of the bus is rounded to per mille, with and without its sign") {
  struct Typed {
    const char* typed;
    std::int64_t per_mille;
  };
  for (const auto& [typed, per_mille] : {Typed{"72.5%", 725}, Typed{"72.5", 725}, Typed{"7.04%", 70},
                                         Typed{"7.06%", 71}, Typed{"99.9%", 999}, Typed{"1", 10}}) {
    CAPTURE(typed);
    const auto loaded = with_change(R"("72.5%")", '"' + std::string{typed} + '"');
    REQUIRE(loaded.file);
    const auto& conditions = loaded.file->conditions;
    const auto found = std::find_if(conditions.begin(), conditions.end(), [](const auto& each) {
      return each.watched == reflective::Watched::bus_load && each.is == reflective::Is::above;
    });
    REQUIRE(found != conditions.end());
    CHECK(found->limit == per_mille);
    CHECK(found->window == std::chrono::milliseconds{500});
  }
}

TEST_CASE("operate: a file is as large as there is room for, and no larger") {
  // Two conditions each, and `more` in the last one.
  const auto read = [](std::size_t monitors, std::size_t more) {
    std::string text =
        R"({"name": "large", "initial": "all", "fall_back": "all", "settle": "40ms", "reaction": "4ms", "handling": "2ms",
          "configurations": [{"name": "all", "streams": [{"topic": "ring"}]}], "monitors": [)";
    for (std::size_t m = 0; m < monitors; ++m) {
      const std::string n = std::to_string(m);
      text += (m == 0 ? "" : ", ") + (R"({"name": "m)" + n) + R"(", "when": {"any": ["ring.sensor_1>)" + n +
              "\", \"ring.sensor_2>" + n + "\"";
      if (m + 1 == monitors)
        for (std::size_t i = 0; i < more; ++i) text += ", \"ring.sensor_3>" + std::to_string(i) + "\"";
      text += "]}}";
    }
    return operate::parse(text + "]}", "large", amiro::catalogue, 500'000);
  };
  CHECK(read(operate::room.monitors, operate::room.conditions - 2 * operate::room.monitors).file);
  CHECK(read(3, operate::room.conditions - 6).file);
  for (const auto& beyond :
       {read(operate::room.monitors + 1, 0), read(3, operate::room.conditions - 6 + 1)}) {
    REQUIRE(beyond.problems.size() == 1);
    CHECK(beyond.problems[0].place == "large:1: /");
    CHECK(beyond.problems[0].what == "it is too large");
    CHECK(beyond.problems[0].remedy ==
          "at most 64 conditions, 32 monitors, and in a configuration 32 streams, 16 set points, 16 limits "
          "and 8 "
          "adaptations");
  }
}

}  // namespace operate_mistakes_test
