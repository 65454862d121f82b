// What `operate` does first once it runs again: of the frames that came meanwhile so many go before what time
// asks for, that what they say counts, and that a storm of them does not hold time up.
#include <csignal>
#include <cstddef>
#include <string>
#include <string_view>
#include <unistd.h>
#include <utility>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "ocm/protocol/identifier.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/operate/runner.hpp"
#include "tests/tool/captured.hpp"
#include "tests/tool/clock/played_bus.hpp"

namespace tool_clock_operate_waiting_test {

using namespace ocm;
using namespace ocm::test;
namespace operate = cli::operate;

constexpr std::string_view file_text = R"({
  "name": "waiting", "initial": "watching", "fall_back": "halted", "settle": "60ms", "reaction": "5ms", "handling": "1ms",
  "configurations": [
    {"name": "watching", "streams": [{"topic": "floor", "period": "50ms"}]},
    {"name": "halted", "streams": [{"topic": "floor", "period": "50ms"}]}
  ],
  "monitors": [{"name": "silent", "when": {"age": "floor", "above": "120ms"}}],
  "transitions": [
    {"from": "watching", "to": "halted", "when": "silent"},
    {"from": "halted", "to": "watching", "on_request": true}
  ]
})";

/// A whole sample of the floor.
can::Frame sample() {
  const auto& topic = *amiro::catalogue.find("floor_proximity");
  REQUIRE(topic.frames.size() == 1);
  const auto& layout = topic.frames[0];
  return {protocol::Identifier{protocol::Direction::sensor, protocol::Priority::medium, layout.id}.encode(),
          layout.dlc(),
          {}};
}

/// All that it prints in a second. It waits for the age of the sample of 420 ms when it is stopped from 520
/// to 700 ms; meanwhile so many frames of others come, and then a sample.
std::string printed(std::size_t others) {
  const auto loaded = operate::parse(file_text, "waiting.operator.json", amiro::catalogue, 500'000);
  for (const auto& problem : loaded.problems) UNSCOPED_INFO(problem.place << ": " << problem.what);
  REQUIRE(loaded.file);
  World world{1};
  world.stop(World::start + 520ms, 180ms);
  world.interrupt(World::start + 1s, SIGINT);
  PlayedBus::Conditions conditions;
  for (Duration at = 20ms; at <= 420ms; at += 50ms)
    conditions.incoming.push_back({World::start + at, sample()});
  for (std::size_t i = 0; i < others; ++i)
    conditions.incoming.push_back({World::start + 600ms, can::Frame{.id = 0x7F0, .dlc = 8}});
  for (Duration at = 690ms; at < 1s; at += 50ms) conditions.incoming.push_back({World::start + at, sample()});
  PlayedBus bus{world, std::move(conditions), fmt::format("waiting-{}", ::getpid())};
  const auto control = operate::Control::open(bus.name());
  REQUIRE(control);
  world.inputs[(*control)->descriptor()] = [] { return Moment::max(); };
  const operate::RunOptions options{false, 500'000, {}};
  Captured out{STDOUT_FILENO}, err{STDERR_FILENO};
  {
    operate::Runner runner{bus, **control, amiro::catalogue, *loaded.file, options};
    CHECK(runner.run() == cli::Over::signal);
    runner.rest();
    runner.sum_up();
  }
  static_cast<void>(err.text());
  return out.text();
}

TEST_CASE("operate: what came while it was stopped is taken before it looks at the time, up to 64 frames") {
  for (const std::size_t others : {0U, 1U, 63U}) {
    CAPTURE(others);
    CHECK_THAT(printed(others),
               Catch::Contains("operator waiting is in watching") && !Catch::Contains(" -> "));
  }
  CHECK_THAT(printed(64), Catch::Contains("watching -> halted: silent (age of floor above 120ms)"));
}

}  // namespace tool_clock_operate_waiting_test
