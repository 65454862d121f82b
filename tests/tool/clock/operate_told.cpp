// What `operate` answers, prints and sums up where a run is less smooth than others: a socket
// that is lost more than once, more changes than it remembers, a request that is dropped, frames that are
// lost or replaced, a refusal without a reason, values that are no number, set points that the bus does not
// take.
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <unistd.h>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "ocm/can/error_frame.hpp"
#include "ocm/can/text.hpp"
#include "ocm/protocol/codec.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/operate/runner.hpp"
#include "cli/shared/operator_link.hpp"
#include "generator/spec/spec.hpp"
#include "tests/tool/captured.hpp"
#include "tests/tool/clock/played_bus.hpp"
#include "tests/tool/local_client.hpp"

namespace tool_clock_operate_told_test {

using namespace ocm;
using namespace ocm::test;
namespace operate = cli::operate;
namespace fs = std::filesystem;
using Texts = std::vector<std::string>;

constexpr std::string_view file_text = R"({
  "name": "told", "initial": "here", "fall_back": "halted", "settle": "60ms", "reaction": "5ms", "handling": "1ms",
  "configurations": [
    {"name": "here", "streams": [{"topic": "odometry", "period": "50ms"}]},
    {"name": "there"},
    {"name": "halted"}
  ],
  "monitors": [{"name": "ill", "when": {"bus_state": "off"}}],
  "transitions": [
    {"to": "halted", "when": "ill"},
    {"from": ["here", "halted"], "to": "there", "on_request": true, "precedence": 1},
    {"from": "there", "to": "here", "on_request": true, "precedence": 1}
  ]
})";

/// It repeats its own set point, and asks for nothing.
constexpr std::string_view repeating_text = R"({
  "name": "told", "initial": "halted", "fall_back": "halted", "settle": "60ms", "reaction": "5ms", "handling": "1ms",
  "configurations": [{"name": "halted", "entry": [{"topic": "motors", "priority": "urgent", "repeat": "100ms"}]}]
})";

/// It asks for nothing, and what programs command may change slowly.
constexpr std::string_view slow_text = R"({
  "name": "told", "initial": "slow", "fall_back": "slow", "settle": "60ms", "reaction": "5ms", "handling": "1ms",
  "configurations": [{"name": "slow", "limits": [{"field": "motors.x", "min": "-0.5m/s", "max": "0.5m/s", "per_second": "0.1m/s"}]}]
})";

std::string bus_name() {
  return fmt::format("told-{}", ::getpid());
}

/// What happens beside it: a program asks something, or something is done.
struct Step {
  Duration at;
  std::string asks;
  std::function<void()> does{};
};
struct Told {
  std::string printed;
  std::string said;
  Texts answers;
};

Told run(std::string_view text, Duration lasting, const std::vector<Step>& steps,
         PlayedBus::Conditions conditions = {}, const protocol::Catalogue& catalogue = amiro::catalogue) {
  const auto loaded = operate::parse(text, "told.operator.json", catalogue, 500'000);
  for (const auto& problem : loaded.problems) UNSCOPED_INFO(problem.place << ": " << problem.what);
  REQUIRE(loaded.file);
  Told told;
  std::unique_ptr<LocalClient> client;
  std::size_t next = 0;
  bool greets = false, waits = false;
  World world{1};
  world.interrupt(World::start + lasting, SIGINT);
  PlayedBus bus{world, std::move(conditions), bus_name()};
  const auto control = operate::Control::open(bus.name());
  REQUIRE(control);
  world.inputs[(*control)->descriptor()] = [&]() -> Moment {
    if (waits) return World::start;
    return next < steps.size() ? World::start + steps[next].at : Moment::max();
  };
  world.beside = [&] {
    if (waits) {
      const auto answer = client->heard();
      if (answer.empty()) return;
      if (!std::exchange(greets, false)) told.answers.push_back(answer);
      waits = false;
    }
    if (next == steps.size() || world.now() < World::start + steps[next].at) return;
    if (steps[next].does) return steps[next++].does();
    if (!client) {
      client = std::make_unique<LocalClient>(SOCK_SEQPACKET, cli::operator_path(bus_name()));
      client->say("hello 1 operator");
      greets = true;
    } else {
      client->say(steps[next++].asks);
    }
    waits = true;
  };
  const operate::RunOptions options{false, 500'000, {}};
  Captured out{STDOUT_FILENO}, err{STDERR_FILENO};
  {
    operate::Runner runner{bus, **control, catalogue, *loaded.file, options};
    CHECK(runner.run() == cli::Over::signal);
    runner.rest();
    runner.sum_up();
  }
  told.printed = out.text();
  told.said = err.text();
  CHECK(next == steps.size());
  return told;
}

Texts lines_with(const std::string& text, std::string_view begin) {
  Texts found;
  std::istringstream lines{text};
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(begin)) found.push_back(line);
  return found;
}
std::size_t count_of(const std::string& text, std::string_view what) {
  std::size_t count = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) ++count;
  return count;
}

TEST_CASE("operate: each time that its socket is lost it says so, once, and when it is there again") {
  const std::string path = cli::operator_path(bus_name());
  const auto loses_it = [&path] {
    fs::remove(path);
    fs::create_directory(path);
  };
  const auto frees_it = [&path] { fs::remove(path); };
  // It looks at it five times a second.
  const auto told =
      run(file_text, 2200ms,
          {{100ms, "", loses_it}, {650ms, "", frees_it}, {1100ms, "", loses_it}, {1650ms, "", frees_it}});
  const std::string lost = "its socket was removed, so that what programs command goes past it: '" + path +
                           "' exists and is not a socket";
  const std::string found =
      "its socket was removed, and is there again: what programs commanded meanwhile went past it";
  CHECK(lines_with(told.printed, "its socket") == Texts{lost, found, lost, found});
}

TEST_CASE("operate: it remembers the last twenty changes, its start among them") {
  std::vector<Step> steps;
  Duration at = 0s;
  bool is_here = true;
  const auto switches = [&](int count) {
    for (int i = 0; i < count; ++i) {
      at += 100ms;
      steps.push_back({at, is_here ? "switch there" : "switch here"});
      is_here = !is_here;
    }
    at += 30ms;
    steps.push_back({at, "why"});
  };
  switches(19);
  switches(1);
  switches(1);
  const auto told = run(file_text, at + 100ms, steps);
  REQUIRE(told.answers.size() == 24);
  CHECK(told.answers[0] == "ok\nhere -> there\n");
  CHECK(told.answers[1] == "ok\nthere -> here\n");
  CHECK(count_of(told.answers[19], "  started in here\n") == 1);
  CHECK(count_of(told.answers[19], " -> ") == 19);
  CHECK(count_of(told.answers[21], "  started in here\n") == 0);
  CHECK(count_of(told.answers[21], " -> ") == 20);
  // The oldest goes.
  const auto first_of = [](const std::string& answer) {
    return answer.substr(answer.find("  ") + 2, answer.find(": ") - answer.find("  ") - 2);
  };
  CHECK(first_of(told.answers[21]) == "here -> there");
  CHECK(count_of(told.answers[23], " -> ") == 20);
  CHECK(first_of(told.answers[23]) == "there -> here");
  CHECK_THAT(told.said, Catch::Contains("operate: 21 changes, "));
}

TEST_CASE("operate: a request that waits is dropped where another transition comes first, and that is said") {
  PlayedBus::Conditions conditions;
  conditions.incoming.push_back(
      {World::start + 120ms, can::Frame{can::error_class::bus_off, can::max_dlc, {}, can::Format::error}});
  const auto told =
      run(file_text, 400ms, {{100ms, "switch there"}, {110ms, "switch here"}, {300ms, "switch halted"}},
          conditions);
  CHECK(told.answers ==
        Texts{"ok\nhere -> there\n",
              "ok\nhere follows when the last change is over, unless another transition comes first\n",
              "ok\noperator told is in halted already\n"});
  CHECK(lines_with(told.printed, "the request ") ==
        Texts{"the request for here is dropped: another transition came first"});
  // One that is met is not dropped.
  const auto met = run(file_text, 400ms, {{100ms, "switch there"}, {110ms, "switch here"}});
  CHECK_THAT(met.printed, Catch::Contains("\nthere -> here: ") && !Catch::Contains("dropped"));
}

TEST_CASE("operate: frames that it could not take, or that newer ones replaced, are summed up") {
  const auto lost = [](std::size_t count) {
    PlayedBus::Conditions conditions;
    conditions.listens_to = 10;
    for (std::size_t i = 0; i < 10 + count; ++i)
      conditions.incoming.push_back({World::start + 100ms, can::Frame{.id = 0x7F0, .dlc = 8}});
    return run(file_text, 300ms, {}, conditions).said;
  };
  CHECK_THAT(lost(0), !Catch::Contains("lost"));
  CHECK_THAT(lost(1), Catch::Contains(", 1 frame lost"));
  CHECK_THAT(lost(2), Catch::Contains(", 2 frames lost"));
  // Of the set points the bus takes one more, and one waits.
  const auto replaced = [](Duration until) {
    PlayedBus::Conditions conditions;
    conditions.room = 1;
    conditions.stuck = {{World::start + 150ms, World::start + until}};
    return run(repeating_text, 800ms, {}, conditions).said;
  };
  CHECK_THAT(replaced(350ms), !Catch::Contains("replaced"));
  CHECK_THAT(replaced(450ms), Catch::Contains(", 1 frame replaced by newer ones before the bus took them"));
  CHECK_THAT(replaced(650ms), Catch::Contains(", 3 frames replaced by newer ones before the bus took them"));
}

TEST_CASE("operate: a board that refuses for a reason without a name does not say why") {
  PlayedBus::Conditions conditions;
  conditions.incoming.push_back({World::start + 100ms, can::Frame{0x71D, 8, {3, 200, 1}}});
  CHECK(lines_with(run(file_text, 300ms, {}, conditions).printed, "di_wheel_drive ") ==
        Texts{"di_wheel_drive refuses odometry: it does not say why"});
}

TEST_CASE("operate: values that are no number are summed up") {
  const auto shop = spec::parse(
      R"({"robot": "Shop", "namespace": "shop", "bus": {"bit_rate": 500000, "source": "decided"},
          "boards": [{"name": "main_board", "mcu": "STM32F103", "source": "decided"}],
          "topics": [{"name": "scale", "id": "0x11", "board": "main_board", "deadline": "50ms", "source": "decided",
                      "frames": [{"fields": [{"name": "weight", "byte": 0, "type": "f32"}]}]}]})",
      "shop.json");
  for (const auto& problem : shop.problems) UNSCOPED_INFO(problem.place << ": " << problem.what);
  REQUIRE(shop.spec);
  constexpr std::string_view weighing_text = R"({
    "name": "told", "initial": "here", "fall_back": "halted", "settle": "60ms", "reaction": "5ms", "handling": "1ms",
    "configurations": [{"name": "here", "streams": [{"topic": "scale", "period": "50ms"}]},
                       {"name": "halted", "streams": [{"topic": "scale", "period": "50ms"}]}],
    "monitors": [{"name": "heavy", "when": "scale.weight>5"}],
    "transitions": [{"from": "here", "to": "halted", "when": "heavy"}, {"from": "halted", "to": "here", "on_request": true}]
  })";
  const auto said_of = [&](const std::vector<std::int64_t>& weights) {
    const auto& layout = shop.spec->catalogue().find("scale")->frames[0];
    PlayedBus::Conditions conditions;
    Moment at = World::start + 100ms;
    for (const std::int64_t raw : weights) {
      can::Frame frame{
          protocol::Identifier{protocol::Direction::sensor, protocol::Priority::medium, layout.id}.encode(),
          layout.dlc(),
          {}};
      protocol::put(frame.data, layout.fields[0].position, raw);
      conditions.incoming.push_back({at, frame});
      at += 50ms;
    }
    return run(weighing_text, 400ms, {}, conditions, shop.spec->catalogue()).said;
  };
  constexpr std::int64_t one = 0x3F80'0000, infinite = 0x7F80'0000, none = 0x7FC0'0000;
  CHECK_THAT(said_of({one, one}), Catch::Contains("operate: 0 changes, ") && !Catch::Contains("number"));
  CHECK_THAT(said_of({one, none, none}),
             Catch::Contains("operate: 0 changes, ") && Catch::Contains(", 2 values that are no number"));
  CHECK_THAT(said_of({one, none}), Catch::Contains(", 1 value that is no number"));
  // What is beyond all numbers is above the limit.
  CHECK_THAT(said_of({infinite}), Catch::Contains("operate: 1 change, ") && !Catch::Contains("number"));
}

constexpr const char* fast = "send 201#20A1070000000000";  // 0.5 m/s
constexpr const char* rest = "send 201#0000000000000000";

/// The velocity of the motors that was passed on, in um/s, as the answer has it.
std::int64_t passed_on(const std::string& answer) {
  CAPTURE(answer);
  REQUIRE(answer.starts_with("ok\n201#"));
  const auto frame = can::parse_frame(answer.substr(3, answer.find('\n', 3) - 3));
  REQUIRE(frame);
  return amiro::catalogue.find("motors")->frames[0].fields[0].raw(frame->data);
}
/// Within what changes in a millisecond.
void check_velocity(const std::string& answer, std::int64_t expected) {
  const std::int64_t found = passed_on(answer);
  CHECK(found > expected - 100);
  CHECK(found < expected + 100);
}

TEST_CASE("operate: behind a rest that a program has commanded a velocity comes up from rest again") {
  const auto told = run(slow_text, 400ms, {{100ms, fast}, {200ms, fast}, {210ms, rest}, {260ms, fast}});
  REQUIRE(told.answers.size() == 4);
  check_velocity(told.answers[0], 0);
  check_velocity(told.answers[1], 10'000);
  CHECK(told.answers[2] == "ok\n201#0000000000000000\n");
  check_velocity(told.answers[3], 5'000);
}

TEST_CASE("operate: a set point that the bus did not take is not where the next one starts from") {
  PlayedBus::Conditions conditions;
  conditions.room = 1;
  conditions.stuck = {{World::start + 150ms, World::start + 650ms}};
  const auto told = run(slow_text, 800ms,
                        {{100ms, fast},
                         {200ms, fast},
                         {300ms, fast},
                         {400ms, fast},
                         {500ms, fast},
                         {600ms, fast},
                         {700ms, fast}},
                        conditions);
  REQUIRE(told.answers.size() == 7);
  check_velocity(told.answers[0], 0);
  check_velocity(told.answers[1], 10'000);
  for (std::size_t i = 2; i < 6; ++i) CHECK(told.answers[i].starts_with("wait"));
  // Of a longer time without a set point 100 ms count.
  check_velocity(told.answers[6], 20'000);
  CHECK_THAT(told.said, Catch::Contains(", 3 set points passed on, 3 set points limited"));
}

TEST_CASE("operate: what waits behind the last set point of a program is none that it waits for") {
  constexpr std::string_view lit_text = R"({
    "name": "told", "initial": "here", "fall_back": "here", "settle": "60ms", "reaction": "5ms", "handling": "1ms",
    "configurations": [{"name": "here", "entry": [{"topic": "led_2", "values": {"green": "9"}, "repeat": "100ms"}]}]
  })";
  PlayedBus::Conditions conditions;
  conditions.stuck = {{World::start + 150ms, World::start + 450ms}};
  // Of its own set points that of 200 ms goes first, and those of 300 and of 400 ms behind.
  const auto told =
      run(lit_text, 600ms,
          {{210ms, rest}, {220ms, "delivery"}, {330ms, "delivery"}, {430ms, "delivery"}, {480ms, "delivery"}},
          conditions);
  CHECK(told.answers == Texts{"ok\n201#0000000000000000\n", "ok\n2", "ok\n2", "ok\n2", "ok\n0"});
}

}  // namespace tool_clock_operate_told_test
