// Where what is shown of a bus comes from: a log that is wound, and a bus.
#include "cli/bus_model/feed.hpp"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>

#include "ocm/topics/amiro.hpp"

#include "cli/logs/packing.hpp"
#include "cli/shared/messages.hpp"
#include "tests/tool/captured.hpp"
#include "tests/tool/clock/played_bus.hpp"

namespace tool_clock_feed_test {

using namespace ocm;
using namespace ocm::test;
using cli::bus_model::LogFeed;

class Folder {
 public:
  Folder() : path_(std::filesystem::temp_directory_path() / fmt::format("ocm-feed-{}", ::getpid())) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string put(const std::string& name, const std::string& text) const {
    std::ofstream{path_ / name} << text;
    return (path_ / name).string();
  }

 private:
  std::filesystem::path path_;
};

std::string lines(int count) {
  std::string text;
  for (int i = 0; i < count; ++i)
    text += fmt::format("(100.{:06}) {} {:03X}#00\n", i * 1000, i % 3 == 2 ? "b" : "a", i);
  return text;
}

TEST_CASE("log feed: frames come at their times, once each, forwards and again from the beginning") {
  const World world{1};
  const Folder folder;
  LogFeed feed{folder.put("a.log", lines(600)), {}, amiro::catalogue};
  CHECK(feed.playing().length == 599ms);
  CHECK(feed.playing().at == 0ms);
  CHECK_FALSE(feed.playing().ended);
  CHECK(feed.interfaces() == std::vector<std::string>{"a", "b"});
  CHECK(feed.is_whole());
  std::vector<std::uint32_t> got;
  std::string on;
  const auto take = [&](const log::Entry& entry, const log::Interfaces& interfaces) {
    got.push_back(entry.id);
    on = interfaces.name(entry.interface);
  };
  const auto went = [&](std::size_t count) {
    REQUIRE(got.size() == count);
    for (std::size_t i = 0; i < count; ++i) CHECK(got[i] == i);
  };
  feed.go_to(0ms, take);
  went(1);
  feed.go_to(2ms, take);
  went(3);
  CHECK(on == "b");
  CHECK(feed.now() == base::Time{100s + 2ms});
  feed.faster(4);
  feed.play(10ms, take);
  went(43);
  CHECK(feed.playing().at == 42ms);
  CHECK(feed.is_behind(41ms));
  CHECK_FALSE(feed.is_behind(42ms));
  feed.go_to(598ms, take);
  CHECK_FALSE(feed.playing().ended);
  went(599);
  feed.go_to(1h, take);
  went(600);
  CHECK(feed.playing().ended);
  CHECK(feed.playing().at == 599ms);
  feed.go_to(-1s, take);
  CHECK(feed.playing().at == 0ms);
  got.clear();
  feed.rewind();
  CHECK_FALSE(feed.playing().ended);
  feed.go_to(5ms, take);
  went(6);
}

TEST_CASE("log feed: a log out of order is as long as its last time, and one that was cut says so once") {
  const World world{1};
  const Folder folder;
  const std::string path =
      folder.put("a.log", "(100.5) a 001#\n" + lines(3) + "(103.000000) a 002#\n(101.000000) a 003#\n");
  {
    const Captured err{STDERR_FILENO};
    LogFeed feed{path, "candump", amiro::catalogue};
    CHECK(feed.playing().length == 2500ms);
  }
  const std::string cut = folder.put("b.log", lines(100));
  LogFeed feed{cut, {}, amiro::catalogue};
  const auto none = [](const log::Entry&, const log::Interfaces&) {};
  feed.go_to(29ms, none);  // what was played before is not counted with what is played again
  static_cast<void>(folder.put("b.log", lines(40)));
  feed.rewind();
  Captured err{STDERR_FILENO};
  feed.go_to(10ms, none);
  CHECK(feed.is_whole());
  feed.go_to(99ms, none);
  feed.rewind();
  feed.go_to(99ms, none);
  CHECK(err.text() ==
        fmt::format("{}: 60 of 100 frames are not there any more: was it cut, or replaced?\n", cut));
  CHECK(feed.playing().ended);
  CHECK_FALSE(feed.is_whole());
}

TEST_CASE("log feed: of a log that is damaged what comes before is played, and it is not whole") {
  const auto packer = cli::logs::make_packer(cli::logs::Packing::gzip);
  if (!packer) {
    WARN("built without zlib");
    return;
  }
  std::string packed;
  packer.value->pack(lines(100), packed, cli::logs::Packer::Until::ended);
  packed.resize(packed.size() - 4);  // of its checksum and length
  const World world{1};
  const Folder folder;
  const std::string path = folder.put("a.log.gz", packed);
  Captured err{STDERR_FILENO};
  LogFeed feed{path, {}, amiro::catalogue};
  int frames = 0;
  feed.go_to(1h, [&](const log::Entry&, const log::Interfaces&) { ++frames; });
  const std::string said = err.text();
  CAPTURE(said);
  CHECK(feed.playing().length == 99ms);
  CHECK(frames == 100);
  CHECK_FALSE(feed.is_whole());
  CHECK(said.starts_with(path + ": cannot be read beyond byte "));
  CHECK(said.ends_with(": the gzip data ends in the middle\n"));
}

TEST_CASE("log feed: a log of one frame is at its end with that") {
  const World world{1};
  const Folder folder;
  LogFeed feed{folder.put("a.log", lines(1)), {}, amiro::catalogue};
  CHECK(feed.playing().length == 0ms);
  CHECK_FALSE(feed.playing().ended);
  int frames = 0;
  for (const auto at : {0ms, 5ms, 0ms}) {
    feed.go_to(at, [&](const log::Entry&, const log::Interfaces&) { ++frames; });
    CHECK(frames == 1);
    CHECK(feed.playing().at == 0ms);
    CHECK(feed.playing().ended);
  }
}

TEST_CASE("log feed: what cannot be wound is refused") {
  const World world{1};
  const Folder folder;
  const std::string pipe = folder.put("x", "") + ".fifo";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  for (const auto& [path, words, code] :
       {std::tuple{std::string{"-"}, "a log that comes through a pipe cannot be wound", 2},
        std::tuple{pipe, "a log that comes through a pipe cannot be wound", 2},
        std::tuple{folder.put("comment.csv", "timestamp,arbitration_id,extended,remote,error,dlc,data\n"),
                   "comment.csv: no frame in it", 1}}) {
    Captured err{STDERR_FILENO};
    int left = 0;
    try {
      const LogFeed feed{path, {}, amiro::catalogue};
    } catch (const cli::Exit& exit) {
      left = exit.code;
    }
    const std::string said = err.text();
    CAPTURE(path, said);
    CHECK(left == code);
    CHECK(said.find(words) != std::string::npos);
  }
}

TEST_CASE("live feed: all that waits, what was lost, and that a bus is gone") {
  World world{1};
  PlayedBus::Conditions conditions;
  for (int i = 0; i < 10; ++i)
    conditions.incoming.push_back({World::start + i * 10ms, can::Frame{.id = 0x7F0, .dlc = 1}});
  conditions.listens_to = 3;
  conditions.gone = World::start + 1s;
  cli::bus_model::LiveFeed feed{std::make_unique<PlayedBus>(world, conditions, "no-such-bus")};
  CHECK(feed.name() == "no-such-bus");
  CHECK(feed.bus().name() == "no-such-bus");
  cli::bus_model::Models models{amiro::catalogue, 500'000};
  world.pass(15ms);
  CHECK(feed.pump(models) == cli::Over::time);
  REQUIRE(models.buses().size() == 1);
  const auto sum = [&] { return models.of("no-such-bus").summary(world.wall_at(world.now())); };
  CHECK(sum().frames == 2);
  CHECK(sum().lost == 0);
  world.pass(100ms);
  CHECK(feed.pump(models) == cli::Over::time);
  CHECK(sum().frames == 5);
  CHECK(sum().lost == 5);
  CHECK(feed.pump(models) == cli::Over::time);
  CHECK(sum().lost == 5);
  CHECK_FALSE(sum().controller);  // no interface of the kernel's
  world.pass(1s);
  CHECK(feed.pump(models) == cli::Over::gone);
}

/// To read a clock takes a little time.
bool is_about(base::Time time, base::Time expected) {
  return time >= expected && time < expected + 1ms;
}

TEST_CASE("frame clock: the wall clock, unless it was set and the frames do not follow") {
  World world{1};
  world.set_wall_clock(World::start + 1s, 1h);
  world.set_wall_clock(World::start + 3s, -2h);
  const base::Time begin = world.wall_at(World::start);
  cli::FrameClock clock;
  CHECK(is_about(clock.now(), begin));
  world.pass(500ms);
  clock.take(begin + 100ms);  // it has waited
  CHECK(is_about(clock.now(), begin + 500ms));
  world.pass(700ms);
  CHECK(is_about(cli::unix_time(), begin + 1h + 1200ms));
  clock.take(begin + 1200ms);
  world.pass(300ms);
  CHECK(is_about(clock.now(), begin + 1500ms));
  clock.take(begin + 1h + 1500ms);  // another bus follows
  CHECK(is_about(clock.now(), begin + 1h + 1500ms));
  clock.take(begin + 1500ms);
  world.pass(2s);
  CHECK(is_about(cli::unix_time(), begin - 1h + 3500ms));
  CHECK(is_about(clock.now(), begin + 3500ms));  // also without any frame since
  clock.take(begin - 1h + 3400ms);
  CHECK(is_about(clock.now(), begin - 1h + 3500ms));
}

TEST_CASE("frame clock: a frame waits less than a second, or its clock is another one") {
  World world{1};
  cli::FrameClock clock;
  const Moment begin = world.now();
  static_cast<void>(cli::Clock::now());
  const Duration a_look = world.now() - begin;
  // How late the wall clock is by that of a frame that has such a time when it is taken.
  const auto apart = [&](Duration behind) {
    clock.take(world.wall_at(world.now() + a_look) - behind);
    const base::Time now = clock.now();
    return Duration{cli::unix_time() - now};
  };
  CHECK(apart(1s - 1ns) == 0ns);
  CHECK(apart(1s) == 1s);
  CHECK(apart(-1s + 1ns) == 0ns);
  CHECK(apart(-1s) == -1s);
}

TEST_CASE("live feed: its time is that of its frames, where they do not follow the wall clock") {
  World world{1};
  world.set_wall_clock(World::start + 5ms, 1h);
  world.set_wall_clock(World::start + 50ms, -1h);
  const base::Time begin = world.wall_at(World::start);
  PlayedBus::Conditions conditions;
  conditions.incoming.push_back({World::start + 10ms, can::Frame{.id = 0x7F0, .dlc = 1}});
  cli::bus_model::LiveFeed feed{std::make_unique<PlayedBus>(world, conditions, "no-such-bus")};
  cli::bus_model::Models models{amiro::catalogue, 500'000};
  CHECK(is_about(feed.now(), begin));
  world.pass(12ms);
  CHECK(feed.pump(models) == cli::Over::time);
  CHECK(models.of("no-such-bus").summary(feed.now()).frames == 1);
  world.pass(100ms);  // the wall clock is set back meanwhile, and the bus has said nothing of that
  CHECK(is_about(cli::unix_time(), begin + 112ms));
  CHECK(is_about(feed.now(), begin + 1h + 110ms));
}

}  // namespace tool_clock_feed_test
