// What the black box of an operator keeps is in the order of time, whatever order it came in.
#include "cli/operate/black_box.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "ocm/topics/amiro.hpp"

#include "tests/tool/clock/world.hpp"

namespace tool_clock_black_box_test {

using namespace ocm;
using namespace ocm::test;
namespace operate = cli::operate;

bool in_order(const auto& entries) {
  return std::is_sorted(entries.begin(), entries.end(),
                        [](const log::Entry& a, const log::Entry& b) { return a.time < b.time; });
}

TEST_CASE("black box: what was received late finds its place, on the disk and in a recording") {
  World world{1};
  const std::string folder =
      std::filesystem::temp_directory_path() / ("ocm-black-box-" + std::to_string(world.random()));
  const operate::BlackBoxOptions options{folder, 10s, 20};
  operate::BlackBox box{options, "test", "can0", amiro::catalogue};
  std::vector<log::Entry> spooled;
  const auto take = [&] {
    const auto fresh = box.take_fresh(cli::unix_time());
    CHECK(in_order(fresh));
    for (const auto& entry : fresh) CHECK(cli::unix_time() - entry.time > operate::BlackBox::settling);
    spooled.insert(spooled.end(), fresh.begin(), fresh.end());
  };
  for (int i = 0; i < 2000; ++i) {
    world.pass(world.between(0ms, 4ms));
    // Stamped before it is read.
    const Duration late = world.chance(0.2) ? world.between(0ms, 99ms) : 0ms;
    box.add(log::Entry{cli::unix_time() - late, can::Frame{0x608, 6, {}}}, cli::Clock::now());
    if (i % 100 == 99) take();
  }
  CHECK(spooled.size() < 2000);
  world.pass(operate::BlackBox::settling + 1ms);
  take();
  CHECK(spooled.size() == 2000);
  CHECK(in_order(spooled));
  CHECK(box.take_fresh(cli::unix_time()).empty());
  const auto recording = box.take(cli::Clock::now(), cli::unix_time());
  CHECK(recording.entries.size() == 2000);
  CHECK(in_order(recording.entries));
  std::filesystem::remove_all(folder);
}

TEST_CASE("black box: a clock that is set back holds nothing back") {
  World world{1};
  const std::string folder =
      std::filesystem::temp_directory_path() / ("ocm-black-box-" + std::to_string(world.random()));
  world.set_wall_clock(World::start + 1s, -1h);
  operate::BlackBox box{{folder, 10s, 20}, "test", "can0", amiro::catalogue};
  for (int i = 0; i < 20; ++i) {
    world.pass(100ms);
    box.add(log::Entry{cli::unix_time(), can::Frame{0x608, 6, {}}}, cli::Clock::now());
  }
  world.pass(200ms);
  CHECK(box.take_fresh(cli::unix_time()).size() == 20);
  std::filesystem::remove_all(folder);
}

TEST_CASE("black box: by a clock that is behind, the files of runs before are the oldest all the same") {
  World world{1};
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("ocm-black-box-" + std::to_string(world.random()));
  std::filesystem::create_directories(folder);
  const auto put = [&](const std::string& name) {
    std::ofstream{folder / name} << "(1.000000) can0 123#00\n";
  };
  put("test-20260131T101504.212.black-box.log");
  put("test-20260131T101504.500.black-box.log");
  put("test.running-0.log");
  const auto kept = [&] {
    std::vector<std::string> names;
    for (const auto& each : std::filesystem::directory_iterator{folder})
      names.push_back(each.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  };
  // A machine whose clock has no battery begins in 1970.
  const auto in_1970 = [](Duration after) { return base::Time{24h} + after; };
  operate::BlackBox box{{folder.string(), 10s, 2}, "test", "can0", amiro::catalogue};
  CHECK(box.recover(in_1970(0s)).files.size() == 1);
  CHECK(kept() == std::vector<std::string>{"test-19700102T000000.000-killed.black-box.log",
                                           "test-20260131T101504.500.black-box.log"});
  const auto record = [&](Duration after) {
    box.add(log::Entry{in_1970(after), can::Frame{0x608, 6, {}}}, cli::Clock::now());
    CHECK(box.write(box.take(cli::Clock::now(), in_1970(after))));
  };
  record(2s);
  CHECK(kept() == std::vector<std::string>{"test-19700102T000000.000-killed.black-box.log",
                                           "test-19700102T000002.000.black-box.log"});
  record(1s);  // set back
  CHECK(kept() == std::vector<std::string>{"test-19700102T000001.000.black-box.log",
                                           "test-19700102T000002.000.black-box.log"});
  record(3s);
  CHECK(kept() == std::vector<std::string>{"test-19700102T000001.000.black-box.log",
                                           "test-19700102T000003.000.black-box.log"});
  std::filesystem::remove_all(folder);
}

TEST_CASE("black box: of the files in its folder only recordings of its operator are counted, and deleted") {
  World world{1};
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("ocm-black-box-" + std::to_string(world.random()));
  std::filesystem::create_directories(folder);
  const std::vector<std::string> others{"other-20260131T101504.212.black-box.log", "test-notes.txt",
                                        "test-20260131T101504.212.black-box.log.txt",
                                        "tests-20260131T101504.212.black-box.log", "test.black-box.log"};
  for (const auto& name : others) std::ofstream{folder / name} << "of others\n";
  for (const char* const name :
       {"test-20260131T101504.212.black-box.log", "test-20260131T101504.500.black-box.log"})
    std::ofstream{folder / name} << "(1.000000) can0 123#00\n";
  operate::BlackBox box{{folder.string(), 10s, 1}, "test", "can0", amiro::catalogue};
  const base::Time now{24h * 365 * 57};
  box.add(log::Entry{now, can::Frame{0x608, 6, {}}}, cli::Clock::now());
  const auto recording = box.take(cli::Clock::now(), now);
  CHECK(box.write(recording));
  std::vector<std::string> expected = others, found;
  expected.push_back(std::filesystem::path{recording.path}.filename().string());
  for (const auto& each : std::filesystem::directory_iterator{folder})
    found.push_back(each.path().filename().string());
  std::sort(expected.begin(), expected.end());
  std::sort(found.begin(), found.end());
  CHECK(found == expected);
  std::filesystem::remove_all(folder);
}

/// A black box in a folder that goes with it.
struct Boxed {
  std::string folder = std::filesystem::temp_directory_path() /
                       ("ocm-black-box-" + std::to_string(World::now_running().random()));
  operate::BlackBox box{{folder, 10s, 20}, "test", "can0", amiro::catalogue};
  Boxed() = default;
  ~Boxed() { std::filesystem::remove_all(folder); }
  Boxed(const Boxed&) = delete;
  Boxed& operator=(const Boxed&) = delete;
};
constexpr base::Time wall{1'000'000'000s};
log::Entry at(Duration after) {
  return {wall + after, can::Frame{0x608, 1, {}}};
}

TEST_CASE("black box: frames of one time stay in the order in which they came") {
  const World world{1};
  Boxed boxed;
  for (std::uint32_t id = 0x601; id <= 0x603; ++id)
    for (const Duration after : {1ms, 0ms})
      boxed.box.add({wall + after, can::Frame{id, 1, {}}}, World::start);
  const auto in_turn = [](const auto& entries) {
    REQUIRE(entries.size() == 6);
    for (std::uint32_t i = 0; i < 6; ++i) {
      CHECK(entries[i].id == 0x601 + i % 3);
      CHECK(entries[i].time == wall + (i < 3 ? 0ms : 1ms));
    }
  };
  in_turn(boxed.box.take_fresh(wall + 1s));
  in_turn(boxed.box.take(World::start, wall).entries);
}

TEST_CASE("black box: each of its times is the last, or the first, of its kind") {
  const World world{1};
  constexpr Duration settling = 100ms;
  {
    Boxed boxed;  // so late it still finds its place, and later not
    for (const Duration after : {0ns, Duration{-settling}}) boxed.box.add(at(after), World::start);
    const auto found = boxed.box.take(World::start, wall).entries;
    REQUIRE(found.size() == 2);
    CHECK(found[0].time == wall - settling);
    for (const Duration after : {0ns, Duration{-settling - 1ns}}) boxed.box.add(at(after), World::start);
    const auto left = boxed.box.take(World::start, wall).entries;
    REQUIRE(left.size() == 2);
    CHECK(left[0].time == wall);
  }
  {
    Boxed boxed;
    boxed.box.add(at(0ns), World::start);
    CHECK(boxed.box.take_fresh(wall).empty());
    CHECK(boxed.box.take_fresh(wall + settling).empty());
    CHECK(boxed.box.take_fresh(wall + settling + 1ns).size() == 1);
    boxed.box.add(at(0ns), World::start);
    CHECK(boxed.box.take_fresh(wall - 1ns).size() == 1);  // of a clock that was set back
  }
  {
    Boxed boxed;
    boxed.box.add(at(0ns), World::start);
    CHECK(boxed.box.take(World::start + 10s, wall).entries.size() == 1);
    boxed.box.add(at(0ns), World::start);
    CHECK(boxed.box.take(World::start + 10s + 1ns, wall).entries.empty());
  }
}

TEST_CASE("black box: of more frames than it has room for the oldest go, and are counted") {
  const World world{1};
  Boxed boxed;
  constexpr std::size_t most = operate::BlackBox::most_entries;
  CHECK(most >= 10 * 1'000'000 / 47);  // the shortest frames at 1 Mbit/s, in 10 s
  for (std::size_t i = 0; i < most + 3; ++i)
    boxed.box.add(at(Duration{static_cast<std::int64_t>(i)}), World::start);
  CHECK(boxed.box.dropped() == 3);
  const auto kept = boxed.box.take(World::start, wall).entries;
  CHECK(kept.size() == most);
  CHECK(kept.front().time == wall + 3ns);
}

}  // namespace tool_clock_black_box_test
