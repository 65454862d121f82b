// Frames from lines of text: which lines are one, and how their reading ends.
#include "cli/watch/frame_lines.hpp"

#include <csignal>
#include <fstream>
#include <string>
#include <string_view>
#include <unistd.h>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "ocm/log/complaints.hpp"
#include "ocm/topics/amiro.hpp"

#include "tests/tool/captured.hpp"
#include "tests/tool/clock/world.hpp"
#include "unit/host/host_testing.hpp"

namespace tool_clock_frame_lines_test {

using namespace ocm;
using namespace ocm::test;
using cli::FrameLines;

/// A file that goes with it.
class File {
 public:
  explicit File(std::string_view text) { std::ofstream{path_, std::ios::binary} << text; }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  TemporaryDirectory folder_;
  std::string path_ = folder_.file("lines");
};

/// It can be opened, and no byte of it can be read.
constexpr const char* unreadable = "/proc/self/mem";

struct Read {
  std::vector<std::string> frames{};  ///< "BUS@MS:ID", the time only where it has one
  bool failed = false;
  std::uint64_t bad = 0;
  std::string said{};
};

Read read_all(const std::string& path, bool keep_going) {
  Read read;
  Captured err{STDERR_FILENO};
  FrameLines lines{path, amiro::catalogue, keep_going};
  log::Entry entry;
  std::string_view bus;
  while (lines.next(entry, bus)) {
    const std::string time =
        lines.has_time() ? fmt::format("@{}", entry.time.time_since_epoch() / 1ms) : std::string{};
    read.frames.push_back(fmt::format("{}{}:{:X}", bus, time, entry.id));
  }
  read.failed = lines.failed();
  read.bad = lines.bad_lines();
  read.said = err.text();
  return read;
}

using Frames = std::vector<std::string>;

TEST_CASE("frame lines: blanks around a frame and lines of blanks are passed over") {
  const World world{1};
  const File file{"123#11 \n \t124#22\t \n\n \t\n125#33\t\n126#44"};
  const Read all = read_all(file.path(), false);
  CHECK(all.said.empty());
  CHECK(all.frames == Frames{":123", ":124", ":125", ":126"});
  CHECK_FALSE(all.failed);
  CHECK(all.bad == 0);
}

TEST_CASE("frame lines: a frame without a time has that of the line before, and no bus") {
  const World world{1};
  const File file{"123#11\n(1.500000) can3 124#22\n125#33\n(0.250000) can4 126#44\n"};
  const Read all = read_all(file.path(), false);
  CHECK(all.said.empty());
  CHECK(all.frames == Frames{":123", "can3@1500:124", "@1500:125", "can4@250:126"});
}

TEST_CASE("frame lines: input that cannot be read to its end is a failure, and said") {
  const World world{1};
  for (const bool keep_going : {false, true}) {
    const Read none = read_all(unreadable, keep_going);
    CHECK(none.frames.empty());
    CHECK(none.failed);
    CHECK(none.bad == 0);
    CHECK(none.said == fmt::format("{}: Input/output error\n", unreadable));
  }
}

TEST_CASE("frame lines: a signal ends the reading, which is no failure of the input") {
  World world{1};
  world.interrupt(world.now(), SIGINT);
  const File file{"123#11\n"};
  for (const std::string& path : {file.path(), std::string{unreadable}}) {
    CAPTURE(path);
    const Read none = read_all(path, true);
    CHECK(none.frames.empty());
    CHECK_FALSE(none.failed);
    CHECK(none.bad == 0);
    CHECK(none.said.empty());
  }
}

TEST_CASE("frame lines: the first bad line ends it, or each is counted, and the first of them are named") {
  const World world{1};
  std::string text = "123#11\n";
  const auto told = static_cast<std::size_t>(log::Complaints::kept);
  for (std::size_t i = 0; i < told + 2; ++i) text += "no frame\n";
  const File file{text + "124#22\n"};
  const auto count = [](const Read& read) {
    std::size_t found = 0;
    for (std::size_t at = read.said.find("amiroctl: "); at != std::string::npos;
         at = read.said.find("amiroctl: ", at + 1))
      ++found;
    return found;
  };
  const Read first = read_all(file.path(), false);
  CHECK(first.frames == Frames{":123"});
  CHECK(first.failed);
  CHECK(first.bad == 1);
  CHECK(count(first) == 1);
  CHECK_THAT(first.said, Catch::StartsWith("amiroctl: " + file.path() + ":2: \"no frame\": "));
  const Read all = read_all(file.path(), true);
  CHECK(all.frames == Frames{":123", ":124"});
  CHECK(all.failed);
  CHECK(all.bad == told + 2);
  CHECK(count(all) == told);
}

}  // namespace tool_clock_frame_lines_test
