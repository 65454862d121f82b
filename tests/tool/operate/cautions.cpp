// When limits of a drive hold for what a board does by itself: a caution says where they do not.
#include "cli/operate/cautions.hpp"

#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

#include "generator/spec/spec.hpp"

namespace operate_cautions_test {

using namespace ocm;
namespace operate = cli::operate;

constexpr const char* still =
    R"({"field": "avoid.speed", "max": "0m/s"}, {"field": "follow.speed", "max": "0m/s"},)"
    R"({"field": "home.speed", "max": "0m/s"})";
constexpr const char* slow_travel = R"({"field": "travel.speed", "max": "0.1m/s"})";

/// What is said of an operator that begins in "free" and goes to "slow" when it is asked. "slow" limits the
/// motors, the behaviours that end with their program, and `limits`; what else a file says of each comes
/// behind that.
std::vector<std::string> said_of(const std::string& limits, const std::string& slow, const std::string& free,
                                 const std::string& transitions =
                                     R"({"from": ["free", "halted"], "to": "slow", "on_request": true},)"
                                     R"({"to": "halted", "on_request": true})") {
  const auto loaded = operate::parse(
      R"({"name": "c", "initial": "free", "fall_back": "halted", "settle": "80ms", "reaction": "5ms", "handling": "1ms",
          "configurations": [
            {"name": "free")" +
          free + R"(},
            {"name": "slow", "limits": [{"field": "motors.x", "max": "0.1m/s"}, )" +
          std::string{still} + (limits.empty() ? "" : ", ") + limits + "]" + slow + R"(},
            {"name": "halted", "commanders": [], "entry": [{"topic": "motors", "repeat": "100ms"}, {"topic": "travel"}]}],
          "transitions": [)" +
          transitions + "]}",
      "c", amiro::catalogue, 500'000);
  for (const auto& problem : loaded.problems) UNSCOPED_INFO(problem.place << ": " << problem.what);
  REQUIRE(loaded.file);
  std::vector<std::string> said;
  for (const auto& each : operate::cautions(*loaded.file)) {
    CHECK(each.place.ends_with("/limits/0"));
    said.push_back(each.what);
  }
  return said;
}

using Said = std::vector<std::string>;

TEST_CASE("cautions: a travel that goes on is limited where both configurations limit it, and not by one") {
  const Said goes_on{
      R"(a travel that was begun in "free" goes on in "slow", where the limits of motors do not hold for it)"};
  const std::string limits_it = R"(, "limits": [)" + std::string{slow_travel} + "]";
  const std::string drives_only = R"(, "commanders": ["drive"])";
  CHECK(said_of(slow_travel, "", limits_it).empty());
  CHECK(said_of(slow_travel, "", "") == goes_on);
  CHECK(said_of("", drives_only, limits_it) == goes_on);
  CHECK(said_of("", drives_only, "") == goes_on);
}

TEST_CASE("cautions: a travel that is ended on entry, or that none may have begun, does not go on") {
  CHECK(said_of(slow_travel, R"(, "entry": [{"topic": "travel"}])", "").empty());
  CHECK(
      said_of(slow_travel, R"(, "entry": [{"topic": "travel", "values": {"speed": "0.1m/s"}}])", "") ==
      Said{
          R"(a travel that was begun in "free" goes on in "slow", where the limits of motors do not hold for it)"});
  CHECK(said_of(slow_travel, "", R"(, "commanders": ["drive", "led"])").empty());
  CHECK(said_of(slow_travel, "", R"(, "commanders": ["drive", "travel"])").size() == 1);
  CHECK(said_of(slow_travel, "", R"(, "commanders": ["drive", "behave"])").empty());
  // What it repeats itself no program may begin; a speed of its own begins it all the same.
  CHECK(said_of(slow_travel, "", R"(, "entry": [{"topic": "travel", "repeat": "1s"}])").empty());
  CHECK(said_of(slow_travel, "",
                R"(, "commanders": [], "entry": [{"topic": "travel", "values": {"speed": "0.1m/s"}}])")
            .size() == 1);
}

TEST_CASE("cautions: a travel goes on where something leads, and that is said once") {
  // From "free" nothing leads to "slow", but by way of "halted", which ends it.
  CHECK(said_of(slow_travel, "", "",
                R"({"from": ["free", "slow"], "to": "halted", "on_request": true},)"
                R"({"from": "halted", "to": "slow", "on_request": true})")
            .empty());
  const std::string one_more = R"(}, {"name": "free_too")";
  CHECK(
      said_of(slow_travel, "", one_more,
              R"({"to": "halted", "on_request": true}, {"to": "slow", "on_request": true},)"
              R"({"from": "free", "to": "free_too", "on_request": true})") ==
      Said{
          R"(a travel that was begun in "free" goes on in "slow", where the limits of motors do not hold for it)"});
}

TEST_CASE("cautions: what may be begun where the motors are limited, and by which verbs") {
  const auto begun = [](const char* by) {
    return Said{
        std::string{
            R"(in "slow" the limits of motors do not hold for what boards do by themselves: travel )"} +
        by};
  };
  const std::string none_before = R"(, "commanders": [])";
  CHECK(said_of("", "", none_before) == begun("(by travel, replay, run, set)"));
  CHECK(said_of("", R"(, "commanders": ["set", "travel"])", none_before) == begun("(by travel, set)"));
  CHECK(said_of("", R"(, "commanders": ["drive"])", none_before).empty());
  CHECK(said_of(slow_travel, "", none_before).empty());
  CHECK(said_of("", R"(, "entry": [{"topic": "travel", "repeat": "1s"}])", none_before).empty());
  CHECK(said_of("", R"(, "entry": [{"topic": "travel", "values": {"speed": "0.1m/s"}}])", none_before) ==
        begun("(by \"entry\", travel, replay, run, set)"));
}

TEST_CASE("cautions: what it repeats each nanosecond no program may begin, either") {
  CHECK(said_of(slow_travel, "", R"(, "entry": [{"topic": "travel", "repeat": "1ns"}])").empty());
  CHECK(said_of(slow_travel, "", R"(, "entry": [{"topic": "travel", "repeat": "0ns"}])").size() == 1);
}

TEST_CASE("cautions: the first topic of a spec may be a behaviour, and what has no time-out is none") {
  const auto cart = spec::parse(
      R"({"robot": "Cart", "namespace": "cart", "bus": {"bit_rate": 500000, "source": "decided"},
          "boards": [{"name": "main_board", "mcu": "STM32F103", "source": "decided"}],
          "topics": [
            {"name": "circle", "kind": "actuator", "id": "0x02", "board": "main_board", "timeout": "10s", "source": "decided",
             "frames": [{"fields": [{"name": "rounds", "byte": 0, "type": "u8"}]}]},
            {"name": "horn", "kind": "actuator", "id": "0x03", "board": "main_board", "source": "decided",
             "frames": [{"fields": [{"name": "tone", "byte": 0, "type": "u8"}]}]},
            {"name": "wheels", "kind": "actuator", "role": "drive", "id": "0x01", "board": "main_board", "timeout": "500ms", "source": "decided",
             "frames": [{"fields": [{"name": "x", "byte": 0, "type": "i16", "scale": 0.001, "unit": "m/s", "range": [-2, 2]},
                                    {"name": "z", "byte": 2, "type": "i16", "scale": 0.001, "unit": "rad/s", "range": [-6.5, 6.5]}]}]}]})",
      "cart.json");
  for (const auto& problem : cart.problems) UNSCOPED_INFO(problem.place << ": " << problem.what);
  REQUIRE(cart.spec);
  const auto loaded = operate::parse(
      R"({"name": "cart", "initial": "all", "fall_back": "all", "settle": "60ms", "reaction": "20ms", "handling": "1ms",
          "configurations": [{"name": "all", "limits": [{"field": "wheels.x", "max": "0.1m/s"}]}]})",
      "cart", cart.spec->catalogue(), 500'000);
  for (const auto& problem : loaded.problems) UNSCOPED_INFO(problem.place << ": " << problem.what);
  REQUIRE(loaded.file);
  const auto found = operate::cautions(*loaded.file);
  REQUIRE(found.size() == 1);
  CHECK(
      found[0].what ==
      R"(in "all" the limits of wheels do not hold for what boards do by themselves: circle (by behave, replay, run, set))");
  CHECK(
      found[0].remedy ==
      R"(limit it too, such as {"field": "circle.rounds", "min": "0m/s", "max": "0m/s"}, or leave those verbs out of "commanders")");
}

/// What is said of topics that fall silent, where "free" leads to "halted" by `when`, and to `to` by `other`.
Said silent(const std::string& when, const std::string& other, const std::string& to = "halted",
            const std::string& from = R"("from": "free", )") {
  const auto loaded = operate::parse(
      R"({"name": "c", "initial": "free", "fall_back": "halted", "settle": "80ms", "reaction": "5ms", "handling": "1ms",
          "configurations": [{"name": "free", "streams": [{"topic": "ring"}, {"topic": "odometry"}]},
                             {"name": "aside"}, {"name": "halted"}],
          "monitors": [{"name": "first", "when": )" +
          when + R"(}, {"name": "second", "when": )" + other + R"(}],
          "transitions": [{)" +
          from + R"("to": "halted", "when": "first"},
                          {"from": "free", "to": ")" +
          to + R"(", "when": "second", "precedence": 1},
                          {"from": "free", "to": "aside", "on_request": true},
                          {"from": "aside", "to": "halted", "on_request": true}]})",
      "c", amiro::catalogue, 500'000);
  for (const auto& problem : loaded.problems) UNSCOPED_INFO(problem.place << ": " << problem.what);
  REQUIRE(loaded.file);
  Said said;
  for (const auto& each : operate::cautions(*loaded.file)) {
    CHECK(each.place.ends_with(": /configurations/0"));
    CHECK(each.remedy.ends_with(R"(", "above": ...}, some periods, beside the other conditions with "any")"));
    said.push_back(each.what + " / " + each.remedy.substr(0, each.remedy.find(',')));
  }
  return said;
}

TEST_CASE("cautions: a configuration that values end is to end when they stay away, too") {
  const auto of = [](const std::string& topic) {
    return Said{R"(nothing leads from "free" to "halted" when )" + topic +
                R"( falls silent: what is not known fires no monitor / {"age": ")" + topic + '"'};
  };
  const std::string near = R"("ring.sensor_1>3000")", off = R"({"bus_state": "off"})";
  for (const char* const no_silence :
       {R"({"bus_state": "off"})", R"({"refusals": true})",
        R"({"bus_load": true, "above": "90%", "window": "1s"})", R"("ring.sensor_2>3000")"}) {
    CAPTURE(no_silence);
    CHECK(silent(near, no_silence) == of("proximity_ring"));
    CHECK(silent(R"({"all": [)" + near + ", " + no_silence + "]}", off) == of("proximity_ring"));
  }
  CHECK(silent(R"({"any": ["odometry.velocity.x>1m/s", )" + near + "]}", off) == of("odometry"));
  CHECK(silent(off, R"({"refusals": true})").empty());
  CHECK(silent(off, near) == of("proximity_ring"));
  CHECK(silent(off, near, "aside").empty());
  CHECK(silent(near, off, "halted", "") ==
        of("proximity_ring"));  // from "aside", too, which does not ask for it
  for (const char* const silence :
       {R"({"age": "ring", "above": "250ms"})", R"({"gap": "ring", "above": "250ms"})",
        R"({"rate": "ring", "below": 15, "window": "1s"})"}) {
    CAPTURE(silence);
    CHECK(silent(near, silence).empty());
    CHECK(silent(R"({"any": [)" + near + ", " + silence + "]}", off).empty());
    CHECK(silent(near, silence, "aside") == of("proximity_ring"));  // it leads elsewhere
    CHECK(silent(silence, off).empty());
  }
}

}  // namespace operate_cautions_test
