// When limits of a drive hold for what a board does by itself: a caution says where they do not.
#include "cli/operate/cautions.hpp"

#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

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

}  // namespace operate_cautions_test
