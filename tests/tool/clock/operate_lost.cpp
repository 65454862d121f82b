// What `operate` says and counts of what it could not print or keep: standard output or a disk that is full,
// a reader that takes nothing for a while, the last seconds of a run that was killed.
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <future>
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

namespace tool_clock_operate_lost_test {

using namespace ocm;
using namespace ocm::test;
namespace operate = cli::operate;
namespace fs = std::filesystem;

/// Nothing is asked for, nor commanded.
constexpr std::string_view file_text = R"({
  "name": "lost", "initial": "watching", "fall_back": "halted", "settle": "60ms", "reaction": "5ms", "handling": "1ms",
  "configurations": [{"name": "watching"}, {"name": "halted"}],
  "monitors": [{"name": "ill", "when": {"bus_state": "off"}}],
  "transitions": [
    {"from": "watching", "to": "halted", "when": "ill"},
    {"from": "halted", "to": "watching", "on_request": true}
  ]
})";

/// What there is in a run.
struct Run {
  Duration lasting = 200ms;
  PlayedBus::Conditions conditions{};
  std::string folder{};                  ///< of its black box; empty: it has none
  std::function<void(Moment)> beside{};  ///< as time passes
  std::function<void()> at_its_end{};    ///< before it is summed up
};
using Disk = std::function<cli::Written(int descriptor, std::string_view text)>;
struct Told {
  std::string printed;
  std::string said;
};

/// `disk` is called from another thread.
Told told_by(const Run& run, const Disk& disk) {
  const auto loaded = operate::parse(file_text, "lost.operator.json", amiro::catalogue, 500'000);
  for (const auto& problem : loaded.problems) UNSCOPED_INFO(problem.place << ": " << problem.what);
  REQUIRE(loaded.file);
  World world{1};
  world.interrupt(World::start + run.lasting, SIGINT);
  world.disk = disk;
  if (run.beside) world.beside = [&] { run.beside(world.now()); };
  PlayedBus bus{world, run.conditions, fmt::format("lost-{}", ::getpid())};
  const auto control = operate::Control::open(bus.name());
  REQUIRE(control);
  world.inputs[(*control)->descriptor()] = [] { return Moment::max(); };
  const operate::RunOptions options{false, 500'000, {run.folder, 10s, 3}};
  Captured out{STDOUT_FILENO}, err{STDERR_FILENO};
  {
    operate::Runner runner{bus, **control, amiro::catalogue, *loaded.file, options};
    CHECK(runner.run() == cli::Over::signal);
    runner.rest();
    if (run.at_its_end) run.at_its_end();
    runner.sum_up();
  }
  Told told;
  told.printed = out.text();
  told.said = err.text();
  return told;
}

cli::Written all_of(std::string_view text) {
  return {text.size(), 0};
}
std::size_t count_of(const std::string& text, std::string_view what) {
  std::size_t count = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) ++count;
  return count;
}
/// A folder that goes with it.
struct Folder {
  fs::path path = fs::temp_directory_path() / fmt::format("ocm-operate-lost-{}", ::getpid());
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
};

TEST_CASE("operate: why a line is not printed is said with the first one, and all of them are counted") {
  // It prints that it begins, and that it has ended.
  const auto without = [](int lines, int error) {
    return told_by({}, [&lines, error](int descriptor, std::string_view text) {
      if (descriptor != STDOUT_FILENO || lines == 0) return all_of(text);
      --lines;
      return cli::Written{0, error};
    });
  };
  constexpr const char* why = "operate: standard output: No space left on device";
  constexpr const char* remedy = "the robot is guarded all the same; lines that are not printed are counted";
  const auto none = without(0, ENOSPC);
  CHECK(count_of(none.printed, "\n") == 2);
  CHECK_THAT(none.said, !Catch::Contains("standard output") && !Catch::Contains("not printed"));
  const auto first = without(1, ENOSPC);
  CHECK(first.printed == "operator lost has ended, everything that it commands is at rest\n");
  CHECK(count_of(first.said, why) == 1);
  CHECK_THAT(first.said, Catch::Contains(remedy) && Catch::Contains(", 1 event line not printed"));
  const auto both = without(2, ENOSPC);
  CHECK(both.printed.empty());
  CHECK(count_of(both.said, why) == 1);
  CHECK_THAT(both.said, Catch::Contains(remedy) && Catch::Contains(", 2 event lines not printed"));
  // After a signal none may read any more, and that is no news.
  const auto ended = without(2, EINTR);
  CHECK_THAT(ended.said,
             !Catch::Contains("standard output") && Catch::Contains(", 2 event lines not printed"));
}

TEST_CASE("operate: while its reader takes nothing a thousand lines wait, and what is more is counted") {
  const Folder folder;
  Run run{.lasting = 700ms, .folder = folder.path.string()};
  const auto error = [&run](Duration at, std::uint32_t what, std::uint8_t bits) {
    can::Frame frame{what, can::max_dlc, {}, can::Format::error};
    frame.data[1] = bits;
    run.conditions.incoming.push_back({World::start + at, frame});
  };
  for (int i = 0; i < 1100; ++i)
    error(100ms + i * 100us, can::error_class::controller,
          i % 2 == 0 ? can::controller_error::tx_warning : can::controller_error::tx_passive);
  error(300ms, can::error_class::bus_off, 0);
  // The first line does not leave until all has happened.
  std::promise<void> begun, goes_on;
  const auto has_begun = begun.get_future();
  const auto may_go_on = goes_on.get_future();
  bool is_first = true;
  run.beside = [&has_begun](Moment now) {
    if (now >= World::start + 50ms) has_begun.wait();
  };
  run.at_its_end = [&goes_on] { goes_on.set_value(); };
  const auto told = told_by(run, [&](int descriptor, std::string_view text) {
    if (descriptor == STDOUT_FILENO && std::exchange(is_first, false)) {
      begun.set_value();
      may_go_on.wait();
    }
    return all_of(text);
  });
  CHECK(count_of(told.printed, "operator lost is in watching\n") == 1);
  CHECK(count_of(told.printed, "the bus is warning\n") == 500);
  CHECK(count_of(told.printed, "the bus is passive\n") == 500);
  CHECK(count_of(told.printed, "\n") == 1001);
  // The other hundred, that the bus is off, that it is in halted, and that it has ended.
  CHECK_THAT(told.said, Catch::Contains("operate: 1 change, ") && Catch::Contains(", 1 recording lost") &&
                            Catch::Contains(", 103 event lines not printed"));
  CHECK_THAT(told.said, Catch::Contains(", 1101 frames that a kill would have lost from the black box"));
  CHECK(fs::is_empty(folder.path));
}

TEST_CASE("operate: why its black box is not on the disk is said once, and each frame is counted") {
  const Folder folder;
  Run run{.lasting = 1200ms, .folder = folder.path.string()};
  // Each half second what has come is written.
  for (const Duration at : {100ms, 700ms})
    for (int i = 0; i < 10; ++i)
      run.conditions.incoming.push_back({World::start + at, can::Frame{.id = 0x7F0, .dlc = 8}});
  const auto told = told_by(run, [](int descriptor, std::string_view text) {
    return descriptor == STDOUT_FILENO ? all_of(text) : cli::Written{0, ENOSPC};
  });
  CHECK(count_of(told.printed, "\n") == 2);
  CHECK(count_of(told.said, "operate: --black-box: ") == 1);
  CHECK_THAT(told.said, Catch::Contains("lost.running-0.log: No space left on device") &&
                            Catch::Contains(", 20 frames that a kill would have lost from the black box"));
  CHECK(fs::is_empty(folder.path));
}

TEST_CASE("operate: that the last seconds of a run that was killed cannot be kept is said, and it goes on") {
  const Folder folder;
  const std::string left = (folder.path / "lost.running-0.log").string();
  std::ofstream{left} << "(1.000000) can0 123#00\n";
  // Where it would be kept there is a folder.
  const std::string kept = (folder.path / "lost-20261218T050000.000-killed.black-box.log").string();
  fs::create_directories(kept);
  const Run run{.folder = folder.path.string()};
  const auto told = told_by(run, [](int, std::string_view text) { return all_of(text); });
  CHECK(told.printed ==
        "operator lost is in watching\n"
        "operator lost has ended, everything that it commands is at rest\n");
  CHECK_THAT(
      told.said,
      Catch::Contains("operate: --black-box: " + left + " cannot become " + kept + ": Is a directory") &&
          Catch::Contains("a folder in which files can be renamed") && Catch::Contains(", 1 recording lost"));
}

}  // namespace tool_clock_operate_lost_test
