// Which files the black box of an operator keeps its last minutes in: two, of which the older is replaced.
#include "cli/operate/spool.hpp"

#include <array>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "ocm/topics/amiro.hpp"

#include "tests/tool/clock/world.hpp"

namespace tool_clock_spool_test {

using namespace ocm;
using namespace ocm::test;
namespace operate = cli::operate;

TEST_CASE(
    "spool: a file takes frames of less than its time, and the next one begins with that which is as old") {
  World world{1};
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("ocm-spool-" + std::to_string(world.random()));
  std::filesystem::create_directories(folder);
  operate::Spool spool{folder.string(), "test", 10s, amiro::catalogue};
  log::Interfaces interfaces;
  interfaces.number("can0");
  const auto append = [&](Duration after) {
    const std::array entries{log::Entry{base::Time{1'000'000'000s} + after, can::Frame{0x608, 1, {}}}};
    CHECK(spool.append(entries, interfaces));
  };
  const auto holds = [&](int number) {
    const auto file = folder / ("test.running-" + std::to_string(number) + ".log");
    if (!std::filesystem::exists(file)) return std::string{"none"};
    std::string times;
    std::ifstream in{file};
    for (std::string line; std::getline(in, line);) times += line.substr(0, line.find(' '));
    return times;
  };
  append(0s);
  append(10s - 1us);
  CHECK(holds(0) == "(1000000000.000000)(1000000009.999999)");
  CHECK(holds(1) == "none");
  append(10s);
  CHECK(holds(1) == "(1000000010.000000)");
  append(20s);
  CHECK(holds(0) == "(1000000020.000000)");
  CHECK(holds(1) == "(1000000010.000000)");
  append(20s - 1us);  // a clock that was set back
  CHECK(holds(0) == "(1000000020.000000)");
  CHECK(holds(1) == "(1000000019.999999)");
  spool.end();
  CHECK(std::filesystem::is_empty(folder));
  std::filesystem::remove_all(folder);
}

TEST_CASE(
    "spool: what a run that was killed has left becomes one file, in the order in which it was written") {
  World world{1};
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("ocm-spool-" + std::to_string(world.random()));
  const auto now = std::filesystem::file_time_type::clock::now();
  for (const auto& second : {now, now - 1s, now + 1s}) {
    std::filesystem::create_directories(folder);
    const auto put = [&](const char* name, const char* text, auto time) {
      std::ofstream{folder / name} << text;
      std::filesystem::last_write_time(folder / name, time);
    };
    put("test.running-0.log", "zero\n", now);
    put("test.running-1.log", "one\n", second);
    operate::Spool spool{folder.string(), "test", 10s, amiro::catalogue};
    const auto left = spool.recover((folder / "killed.log").string(), (folder / "killed-2.log").string());
    REQUIRE(left);
    CHECK(left->files == std::vector<std::string>{(folder / "killed.log").string()});
    std::ostringstream text;
    text << std::ifstream{folder / "killed.log"}.rdbuf();
    CHECK(text.str() == (second < now ? "one\nzero\n" : "zero\none\n"));
    CHECK_FALSE(std::filesystem::exists(folder / "test.running-0.log"));
    CHECK_FALSE(std::filesystem::exists(folder / "test.running-1.log"));
    std::filesystem::remove_all(folder);
  }
}

}  // namespace tool_clock_spool_test
