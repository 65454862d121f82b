// How often `operate` puts its black box on the disk: half a second is what a run that is killed may lose,
// and a disk of flash is not to be worn out.
#include <csignal>
#include <filesystem>
#include <mutex>
#include <string>
#include <string_view>
#include <unistd.h>
#include <utility>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "ocm/topics/amiro.hpp"

#include "cli/operate/runner.hpp"
#include "tests/tool/captured.hpp"
#include "tests/tool/clock/played_bus.hpp"

namespace tool_clock_operate_box_test {

using namespace ocm;
using namespace ocm::test;
namespace operate = cli::operate;

constexpr std::string_view file_text = R"({
  "name": "box", "initial": "watching", "fall_back": "halted", "settle": "60ms", "reaction": "5ms", "handling": "1ms",
  "configurations": [
    {"name": "watching", "streams": [{"topic": "odometry", "period": "50ms"}]},
    {"name": "halted", "streams": [{"topic": "odometry", "period": "50ms"}]}
  ],
  "monitors": [{"name": "full", "when": {"bus_load": true, "above": "90%", "window": "100ms"}}],
  "transitions": [
    {"from": "watching", "to": "halted", "when": "full"},
    {"from": "halted", "to": "watching", "on_request": true}
  ]
})";

TEST_CASE("operate: its black box is written twice a second") {
  const auto loaded = operate::parse(file_text, "box.operator.json", amiro::catalogue, 500'000);
  for (const auto& problem : loaded.problems) UNSCOPED_INFO(problem.place << ": " << problem.what);
  REQUIRE(loaded.file);
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("ocm-operate-box-{}", ::getpid());
  World world{1};
  world.interrupt(World::start + 5s, SIGINT);
  std::mutex mutex;  // it is written from another thread
  int writes = 0;
  world.disk = [&](int descriptor, std::string_view text) {
    const std::lock_guard lock{mutex};
    if (descriptor != STDOUT_FILENO) ++writes;
    return cli::Written{text.size(), 0};
  };
  PlayedBus::Conditions conditions;
  for (Duration at = 0s; at < 5s; at += 50ms)
    conditions.incoming.push_back({World::start + at, can::Frame{.id = 0x7F0, .dlc = 8}});
  PlayedBus bus{world, std::move(conditions), fmt::format("box-{}", ::getpid())};
  const auto control = operate::Control::open(bus.name());
  REQUIRE(control);
  world.inputs[(*control)->descriptor()] = [] { return Moment::max(); };
  const operate::RunOptions options{false, 500'000, {folder.string(), 10s, 3}};
  Captured out{STDOUT_FILENO}, err{STDERR_FILENO};
  {
    operate::Runner runner{bus, **control, amiro::catalogue, *loaded.file, options};
    CHECK(runner.run() == cli::Over::signal);
    runner.rest();
    runner.sum_up();
  }
  CHECK_THAT(out.text(), !Catch::Contains(" -> "));
  CHECK_THAT(err.text(), !Catch::Contains("black box"));  // nothing that a kill would have lost
  CHECK(writes >= 8);
  CHECK(writes <= 11);
  CHECK(std::filesystem::is_empty(folder));
  std::filesystem::remove_all(folder);
}

}  // namespace tool_clock_operate_box_test
