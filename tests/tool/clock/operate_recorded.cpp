// What `operate` says of a recording of its black box: how many frames are in it, and where it is.
#include <csignal>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <unistd.h>
#include <utility>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "ocm/can/error_frame.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/operate/runner.hpp"
#include "tests/tool/captured.hpp"
#include "tests/tool/clock/played_bus.hpp"

namespace tool_clock_operate_recorded_test {

using namespace ocm;
using namespace ocm::test;
namespace operate = cli::operate;

constexpr std::string_view file_text = R"({
  "name": "kept", "initial": "watching", "fall_back": "halted", "settle": "60ms", "reaction": "5ms", "handling": "1ms",
  "configurations": [
    {"name": "watching", "streams": [{"topic": "odometry", "period": "50ms"}]},
    {"name": "halted", "streams": [{"topic": "odometry", "period": "50ms"}]}
  ],
  "monitors": [{"name": "ill", "when": {"bus_state": "off"}}],
  "transitions": [
    {"from": "watching", "to": "halted", "when": "ill"},
    {"from": "halted", "to": "watching", "on_request": true}
  ]
})";

/// All that it prints in a second, while so many frames come before the controller is off the bus.
std::string printed(const std::string& folder, std::size_t before) {
  const auto loaded = operate::parse(file_text, "kept.operator.json", amiro::catalogue, 500'000);
  for (const auto& problem : loaded.problems) UNSCOPED_INFO(problem.place << ": " << problem.what);
  REQUIRE(loaded.file);
  World world{1};
  world.interrupt(World::start + 1s, SIGINT);
  PlayedBus::Conditions conditions;
  for (std::size_t i = 0; i < before; ++i)
    conditions.incoming.push_back({World::start + 425ms, can::Frame{.id = 0x7F0, .dlc = 8}});
  conditions.incoming.push_back(
      {World::start + 430ms, can::Frame{can::error_class::bus_off, can::max_dlc, {}, can::Format::error}});
  PlayedBus bus{world, std::move(conditions), fmt::format("kept-{}", ::getpid())};
  const auto control = operate::Control::open(bus.name());
  REQUIRE(control);
  world.inputs[(*control)->descriptor()] = [] { return Moment::max(); };
  const operate::RunOptions options{false, 500'000, {folder, 20ms, 3}};
  Captured out{STDOUT_FILENO}, err{STDERR_FILENO};
  {
    operate::Runner runner{bus, **control, amiro::catalogue, *loaded.file, options};
    CHECK(runner.run() == cli::Over::signal);
    runner.rest();
    runner.sum_up();
  }
  static_cast<void>(err.text());
  std::filesystem::remove_all(folder);
  return out.text();
}

TEST_CASE("operate: a recording has one frame, or several") {
  const std::string folder =
      (std::filesystem::temp_directory_path() / fmt::format("ocm-kept-{}", ::getpid())).string();
  CHECK_THAT(printed(folder, 0), Catch::Contains("\n1 frame before it is in " + folder + "/kept-"));
  CHECK_THAT(printed(folder, 1), Catch::Contains("\n2 frames before it are in " + folder + "/kept-"));
}

}  // namespace tool_clock_operate_recorded_test
