// What `operate` makes of a bus on which there is more than it has room for: a load of 100 %, and no more.
#include <csignal>
#include <string>
#include <string_view>
#include <unistd.h>
#include <utility>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "ocm/measure/bus_load.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/operate/runner.hpp"
#include "tests/tool/captured.hpp"
#include "tests/tool/clock/played_bus.hpp"

namespace tool_clock_operate_load_test {

using namespace ocm;
using namespace ocm::test;
namespace operate = cli::operate;

constexpr std::string_view file_text = R"({
  "name": "load", "initial": "watching", "fall_back": "halted", "settle": "60ms", "reaction": "5ms", "handling": "1ms",
  "configurations": [
    {"name": "watching", "streams": [{"topic": "odometry", "period": "50ms"}]},
    {"name": "halted", "streams": [{"topic": "odometry", "period": "50ms"}]}
  ],
  "monitors": [{"name": "full", "when": {"bus_load": true, "above": "99.9%", "window": "100ms"}}],
  "transitions": [
    {"from": "watching", "to": "halted", "when": "full"},
    {"from": "halted", "to": "watching", "on_request": true}
  ]
})";

/// A thousand of them come in a second.
constexpr can::Frame frame{.id = 0x7F0, .dlc = 8};

/// Nothing is asked for, nor commanded.
constexpr std::string_view quiet_text = R"({
  "name": "quiet", "initial": "watching", "fall_back": "halted", "settle": "60ms", "reaction": "5ms", "handling": "1ms",
  "configurations": [{"name": "watching"}, {"name": "halted"}],
  "monitors": [{"name": "used", "when": {"bus_load": true, "above": "0%", "window": "100ms"}}],
  "transitions": [
    {"from": "watching", "to": "halted", "when": "used"},
    {"from": "halted", "to": "watching", "on_request": true}
  ]
})";

/// All that an operator prints in a second.
std::string printed_by(const operate::OperatorFile& file, PlayedBus::Conditions conditions,
                       std::uint32_t bit_rate) {
  World world{1};
  world.interrupt(World::start + 1s, SIGINT);
  PlayedBus bus{world, std::move(conditions), fmt::format("load-{}", ::getpid())};
  const auto control = operate::Control::open(bus.name());
  REQUIRE(control);
  world.inputs[(*control)->descriptor()] = [] { return Moment::max(); };
  const operate::RunOptions options{false, bit_rate, {}};
  Captured out{STDOUT_FILENO}, err{STDERR_FILENO};
  {
    operate::Runner runner{bus, **control, amiro::catalogue, file, options};
    CHECK(runner.run() == cli::Over::signal);
    runner.rest();
    runner.sum_up();
  }
  static_cast<void>(err.text());
  return out.text();
}

/// On a bus of 10 kbit/s ten times as many bits come as that has room for. A file cannot have the limit 1000,
/// which no load is above.
std::string printed(std::int64_t per_mille, std::uint32_t bit_rate = 10'000) {
  auto loaded = operate::parse(file_text, "load.operator.json", amiro::catalogue, 500'000);
  for (const auto& problem : loaded.problems) UNSCOPED_INFO(problem.place << ": " << problem.what);
  REQUIRE(loaded.file);
  REQUIRE(loaded.file->conditions.size() == 1);
  CHECK(std::exchange(loaded.file->conditions[0].limit, per_mille) == 999);
  PlayedBus::Conditions conditions;
  for (int i = 0; i < 1000; ++i) conditions.incoming.push_back({World::start + i * 1ms, frame});
  return printed_by(*loaded.file, std::move(conditions), bit_rate);
}

TEST_CASE("operate: a bus on which more comes than it has room for is full, and not more than that") {
  CHECK_THAT(printed(999), Catch::Contains("watching -> halted: "));
  CHECK_THAT(printed(1000), Catch::Contains("operator load is in watching") && !Catch::Contains(" -> "));
}

TEST_CASE("operate: the load of the bus is what comes in a window, of what it has room for then") {
  // Of a hundred frames in a window one more or less may be counted, and at first a request is sent.
  for (const unsigned percent : {10U, 50U, 80U}) {
    CAPTURE(percent);
    const auto bit_rate = measure::bits_on_bus(frame) * 1000 * 100 / percent;
    CHECK_THAT(printed(percent * 10 - percent / 2, bit_rate), Catch::Contains("watching -> halted: "));
    CHECK_THAT(printed(percent * 10 + percent / 2, bit_rate), !Catch::Contains(" -> "));
  }
}

TEST_CASE("operate: a bus on which nothing comes has no load, from the first window on") {
  // In a window of 100 ms a bit is a thousandth of what the bus has room for.
  constexpr std::uint32_t bit_rate = 10'000;
  const auto loaded = operate::parse(quiet_text, "quiet.operator.json", amiro::catalogue, bit_rate);
  for (const auto& problem : loaded.problems) UNSCOPED_INFO(problem.place << ": " << problem.what);
  REQUIRE(loaded.file);
  PlayedBus::Conditions conditions;
  CHECK_THAT(printed_by(*loaded.file, conditions, bit_rate),
             Catch::Contains("operator quiet is in watching") && !Catch::Contains(" -> "));
  conditions.incoming.push_back({World::start + 950ms, frame});  // in none that ends
  CHECK_THAT(printed_by(*loaded.file, conditions, bit_rate), !Catch::Contains(" -> "));
  conditions.incoming[0].at = World::start + 50ms;
  CHECK_THAT(printed_by(*loaded.file, conditions, bit_rate),
             Catch::Contains("watching -> halted: used (bus load above 0%)"));
}

}  // namespace tool_clock_operate_load_test
