// Which files the black box of an operator keeps its last minutes in: two, of which the older is replaced.
#include "cli/operate/spool.hpp"

#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/topics/amiro.hpp"

#include "tests/tool/clock/world.hpp"

namespace tool_clock_spool_test {

using namespace ocm;
using namespace ocm::test;
namespace operate = cli::operate;

/// A spool in a folder that goes with it, for frames of some time behind the first.
struct Spooled {
  World world{1};
  std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("ocm-spool-" + std::to_string(world.random()));
  operate::Spool spool{folder.string(), "test", 10s, amiro::catalogue};
  log::Interfaces interfaces;

  Spooled() {
    std::filesystem::create_directories(folder);
    interfaces.number("can0");
  }
  ~Spooled() { std::filesystem::remove_all(folder); }
  Spooled(const Spooled&) = delete;
  Spooled& operator=(const Spooled&) = delete;

  transport::Outcome<void> append(Duration after) {
    const std::array entries{log::Entry{base::Time{1'000'000'000s} + after, can::Frame{0x608, 1, {}}}};
    return spool.append(entries, interfaces);
  }
  std::string holds(int number) const {
    const auto file = folder / ("test.running-" + std::to_string(number) + ".log");
    if (!std::filesystem::exists(file)) return "none";
    std::string times;
    std::ifstream in{file};
    for (std::string line; std::getline(in, line);) times += line.substr(0, line.find(' '));
    return times;
  }
};

TEST_CASE(
    "spool: a file takes frames of less than its time, and the next one begins with that which is as old") {
  Spooled spooled;
  for (const Duration after : {Duration{0s}, Duration{10s - 1us}}) CHECK(spooled.append(after));
  CHECK(spooled.holds(0) == "(1000000000.000000)(1000000009.999999)");
  CHECK(spooled.holds(1) == "none");
  CHECK(spooled.append(10s));
  CHECK(spooled.holds(1) == "(1000000010.000000)");
  CHECK(spooled.append(20s));
  CHECK(spooled.holds(0) == "(1000000020.000000)");
  CHECK(spooled.holds(1) == "(1000000010.000000)");
  CHECK(spooled.append(20s - 1us));  // a clock that was set back
  CHECK(spooled.holds(0) == "(1000000020.000000)");
  CHECK(spooled.holds(1) == "(1000000019.999999)");
  spooled.spool.end();
  CHECK(std::filesystem::is_empty(spooled.folder));
}

TEST_CASE("spool: what begins at the same time is in the same file, and what begins before it is not") {
  Spooled spooled;
  for (const Duration after : {5s, 5s}) CHECK(spooled.append(after));
  CHECK(spooled.holds(0) == "(1000000005.000000)(1000000005.000000)");
  CHECK(spooled.holds(1) == "none");
  CHECK(spooled.append(5s - 1us));
  CHECK(spooled.holds(1) == "(1000000004.999999)");
}

TEST_CASE("spool: what the disk does not take is said, and what comes next is in another file") {
  bool full = false;  // the spool writes as long as it is there
  Spooled spooled;
  spooled.world.disk = [&full](int, std::string_view text) {
    return full ? cli::Written{0, ENOSPC} : cli::Written{text.size(), 0};
  };
  CHECK(spooled.append(0s));
  full = true;
  const auto refused = spooled.append(1s);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error.what, Catch::Contains("running-0.log: No space left on device"));
  full = false;
  CHECK(spooled.append(2s));
  CHECK(spooled.holds(0) == "(1000000000.000000)");
  CHECK(spooled.holds(1) == "(1000000002.000000)");
}

TEST_CASE(
    "spool: where the other file cannot be opened the one that was written last stays, and it is tried "
    "again") {
  Spooled spooled;
  CHECK(spooled.append(0s));
  const auto other = spooled.folder / "test.running-1.log";
  std::filesystem::create_directory(other);
  for (const Duration after : {Duration{10s}, Duration{10s + 500ms}}) {
    const auto refused = spooled.append(after);
    REQUIRE_FALSE(refused);
    CHECK_THAT(refused.error.what, Catch::Contains("running-1.log"));
    CHECK(spooled.holds(0) == "(1000000000.000000)");
  }
  std::filesystem::remove(other);
  CHECK(spooled.append(11s));
  CHECK(spooled.holds(0) == "(1000000000.000000)");
  CHECK(spooled.holds(1) == "(1000000011.000000)");
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

TEST_CASE("spool: what was begun last becomes part of the one file, however short it is") {
  const auto now = std::filesystem::file_time_type::clock::now();
  for (const std::string last : {"", "1", "one\n"}) {
    CAPTURE(last);
    const Spooled spooled;
    const auto put = [&](const char* name, const std::string& text, auto time) {
      std::ofstream{spooled.folder / name} << text;
      std::filesystem::last_write_time(spooled.folder / name, time);
    };
    put("test.running-0.log", "zero\n", now - 1s);
    put("test.running-1.log", last, now);
    operate::Spool spool{spooled.folder.string(), "test", 10s, amiro::catalogue};
    const auto left =
        spool.recover((spooled.folder / "killed.log").string(), (spooled.folder / "killed-2.log").string());
    REQUIRE(left);
    CHECK(left->files == std::vector<std::string>{(spooled.folder / "killed.log").string()});
    CHECK_FALSE(left->lost.has_value());
    std::ostringstream text;
    text << std::ifstream{spooled.folder / "killed.log"}.rdbuf();
    CHECK(text.str() == "zero\n" + last);
    CHECK_FALSE(std::filesystem::exists(spooled.folder / "test.running-1.log"));
  }
}

TEST_CASE("spool: what cannot be kept under another name stays where it is, and that is said") {
  const Spooled spooled;
  const std::string left = (spooled.folder / "test.running-1.log").string();
  std::ofstream{left} << "one\n";
  operate::Spool spool{spooled.folder.string(), "test", 10s, amiro::catalogue};
  const std::string kept = (spooled.folder / "none" / "killed.log").string();
  const auto recovered = spool.recover(kept, (spooled.folder / "killed-2.log").string());
  REQUIRE(recovered);
  CHECK(recovered->files.empty());
  REQUIRE(recovered->lost.has_value());
  CHECK(recovered->lost->what == left + " cannot become " + kept + ": No such file or directory");
  CHECK(recovered->lost->remedy == "a folder in which files can be renamed");
  CHECK(std::filesystem::exists(left));
}

TEST_CASE("spool: where none has left anything there is nothing to keep, and nothing is lost") {
  Spooled spooled;
  const auto recovered = spooled.spool.recover((spooled.folder / "killed.log").string(),
                                               (spooled.folder / "killed-2.log").string());
  REQUIRE(recovered);
  CHECK(recovered->files.empty());
  CHECK_FALSE(recovered->lost.has_value());
  CHECK(std::filesystem::is_empty(spooled.folder));
}

}  // namespace tool_clock_spool_test
