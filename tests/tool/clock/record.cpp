// The recorder, on buses, a disk and a clock that are made of a seed: stops of the program, a wall clock that
// is set, adapters that come and go, a slow disk, a full one. What was on a bus is in the files or is
// counted.
#include <cerrno>
#include <csignal>
#include <cstring>
#include <deque>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <sys/file.h>
#include <sys/resource.h>
#include <unistd.h>

#include "ocm/topics/amiro.hpp"

#include "cli/logs/opened_log.hpp"
#include "cli/record/recorder.hpp"
#include "cli/shared/messages.hpp"
#include "tests/tool/captured.hpp"
#include "tests/tool/clock/world.hpp"
#include "tests/unit/base/explore.hpp"

namespace tool_clock_record_test {

using namespace ocm;
using namespace ocm::test;
namespace record = cli::record;
using transport::BusState;

constexpr Duration year = std::chrono::hours{24 * 365};

/// All that is on one bus, and what of it has reached a program.
struct Line {
  struct Away {
    Moment from, until;
  };
  std::string name;
  int descriptor = 0;
  std::vector<Moment> arrivals;  ///< a frame each, whose data are its number
  std::vector<Away> away;        ///< an adapter that is pulled out
  std::size_t room = 0;          ///< frames that wait for the program
  Duration ahead{};              ///< of the wall clock: an adapter has a clock of its own
  bool comes_back = true;
  std::size_t next = 0;                 ///< of `arrivals`
  std::uint64_t offered = 0;            ///< came while the program had it open
  std::deque<std::uint32_t> waiting{};  ///< numbers
};

class PlayedCapture final : public record::Capture {
 public:
  PlayedCapture(const World& world, Line& line) : world_(&world), line_(&line) {
    line.waiting.clear();
    for (const auto& away : line.away)
      if (away.until > world.now()) closes_ = std::min(closes_, away.from);
    while (line.next < line.arrivals.size() && line.arrivals[line.next] < world.now()) ++line.next;
  }

  std::size_t read(std::span<log::Entry> into, std::uint16_t interface) override {
    catch_up();
    std::size_t count = 0;
    while (count < std::min(into.size(), batch) && !line_->waiting.empty()) {
      const std::uint32_t number = line_->waiting.front();
      line_->waiting.pop_front();
      can::Frame frame{0x601, 4, {}};
      std::memcpy(frame.data.data(), &number, sizeof number);
      into[count++] = {world_->wall_at(line_->arrivals[number]) + line_->ahead, frame, interface};
    }
    if (count == 0) look();
    return count;
  }
  void look() override {
    catch_up();
    closed_ = line_->waiting.empty() && world_->now() >= closes_;
    if (closed_) failure_ = {line_->name + " is gone", "plug it in"};
  }
  std::string_view name() const override { return line_->name; }
  int descriptor() const override { return line_->descriptor; }
  BusState state() const override { return closed_ ? BusState::closed : BusState::up; }
  const transport::Failure& failure() const override { return failure_; }
  std::uint64_t lost() const override { return lost_; }
  std::uint32_t bit_rate() const override { return 0; }
  bool keeps_times() const override { return true; }
  bool may_return() const override { return line_->comes_back; }

  [[nodiscard]] Moment readable() const {
    if (!line_->waiting.empty()) return World::start;
    const bool more = line_->next < line_->arrivals.size();
    return std::min(more ? line_->arrivals[line_->next] : Moment::max(), closes_);
  }

 private:
  void catch_up() {
    const Moment now = world_->now();
    while (line_->next < line_->arrivals.size() && line_->arrivals[line_->next] <= now &&
           line_->arrivals[line_->next] < closes_) {
      ++line_->offered;
      if (line_->waiting.size() < line_->room)
        line_->waiting.push_back(static_cast<std::uint32_t>(line_->next));
      else
        ++lost_;
      ++line_->next;
    }
  }

  const World* world_;
  Line* line_;
  Moment closes_ = Moment::max();
  bool closed_ = false;
  std::uint64_t lost_ = 0;
  transport::Failure failure_;
};

/// A folder for one program's runs, which is emptied before each.
class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "ocm-clock-XXXXXX").string();
    REQUIRE(::mkdtemp(pattern.data()) != nullptr);
    path_ = pattern;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  void empty() const {
    for (const auto& file : std::filesystem::directory_iterator{path_}) std::filesystem::remove(file);
  }
  [[nodiscard]] std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& file : std::filesystem::directory_iterator{path_}) names.insert(file.path().string());
    return names;
  }
  [[nodiscard]] std::string operator/(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

/// What one file holds.
struct Read {
  std::vector<log::Entry> entries;
  std::vector<log::Recorded> recorded;
  std::vector<std::string> names;
};

Read read_file(const std::string& path, std::string_view format) {
  Read read;
  if (std::filesystem::file_size(path) == 0) return read;
  const World later{0};  // the signal of the run ends no reading here
  cli::logs::OpenedLog log{path, format, amiro::catalogue};
  std::array<log::Entry, log::batch> entries;
  while (const std::size_t count = log.reader().read(entries))
    read.entries.insert(read.entries.end(), entries.begin(),
                        entries.begin() + static_cast<std::ptrdiff_t>(count));
  CHECK(log.reader().complaints().total() == 0);
  read.recorded = log.reader().recorded();
  const auto& interfaces = log.reader().interfaces();
  for (std::uint16_t i = 0; i < interfaces.size(); ++i) read.names.emplace_back(interfaces.name(i));
  return read;
}

std::uint32_t number_of(const log::Entry& entry) {
  std::uint32_t number = 0;
  std::memcpy(&number, entry.data.data(), sizeof number);
  return number;
}

class Run {
 public:
  Run(std::uint64_t seed, const Folder& folder) : world_(seed), folder_(&folder) {
    make_lines();
    make_troubles();
    make_options();
  }

  void go() {
    folder_->empty();
    record::Files files{options_, amiro::catalogue};
    REQUIRE(files.open().ok());
    std::vector<record::Port> ports;
    for (Line& line : lines_) {
      record::Port port;
      port.name = line.name;
      port.capture = open(line);
      ports.push_back(std::move(port));
    }
    const auto reopen =
        [this](std::string_view name) -> transport::Outcome<std::unique_ptr<record::Capture>> {
      for (Line& line : lines_)
        if (line.name == name && !is_away(line)) return std::unique_ptr<record::Capture>{open(line)};
      return transport::Failure{"away", ""};
    };
    world_.disk = [this](int, std::string_view text) { return take(text); };
    record::Recorder recorder{std::move(ports), reopen, files, limits_, false};
    world_.beside = [&] {
      for (int i = 0; i < 4 && world_.now() >= disk_free_; ++i)
        static_cast<void>(recorder.writing().step(0ms));
      if (options_.ring != 0 && world_.chance(0.001)) CHECK(folder_->files().size() <= options_.ring + 1);
    };
    recorder.receive();
    ended_ = world_.now();
    world_.beside = nullptr;
    while (recorder.writing().step(0ms)) world_.wait_until(std::max(disk_free_, world_.now() + 1ms));
    REQUIRE(recorder.writing().failure() == nullptr);
    judge(recorder, files);
  }

 private:
  void make_lines() {
    const int buses = world_.chance(0.5) ? 1 : world_.between(2, 3);
    for (int i = 0; i < buses; ++i) {
      Line line;
      line.name = "can" + std::to_string(i);
      line.descriptor = 1000 + i;
      line.room = world_.between<std::size_t>(50, 5000);
      line.ahead = world_.chance(0.1) ? world_.between(-1s, 1s) : 0s;
      line.comes_back = world_.chance(0.8);
      Moment at = World::start;
      const auto frames = world_.between(0, 3000);
      const Duration usual = world_.between(100us, 3ms);
      for (int k = 0; k < frames; ++k) {
        at += world_.chance(0.002) ? world_.between(0s, 3s) : world_.between(50us, 2 * usual);
        line.arrivals.push_back(at);
      }
      for (Moment away = World::start; world_.chance(0.3);) {
        away += world_.between(1ms, 3s);
        line.away.push_back({away, away + world_.between(1ms, 2s)});
        away = line.away.back().until;
      }
      std::erase_if(line.arrivals, [&](Moment when) {
        return std::any_of(line.away.begin(), line.away.end(),
                           [when](const Line::Away& away) { return when >= away.from && when < away.until; });
      });
      lines_.push_back(std::move(line));
    }
  }

  void make_troubles() {
    const auto sometime = [this] { return World::start + world_.between(0s, 8s); };
    const bool is_interrupted = world_.chance(0.4);
    const Moment interrupt = sometime();
    if (is_interrupted) world_.interrupt(interrupt, SIGTERM);
    if (is_interrupted && world_.chance(0.4)) world_.stop(interrupt - world_.between(0s, 4s), 4s);
    while (world_.chance(0.4)) world_.stop(sometime(), world_.between(1ms, world_.chance(0.2) ? 20s : 2s));
    while (world_.chance(0.3)) {
      steps_of_the_clock_ = true;
      const Duration by =
          world_.chance(0.3) ? world_.between(-50 * year, 50 * year) : world_.between(-3s, 3s);
      world_.set_wall_clock(sometime(), by);
    }
    slow_disk_ = world_.chance(0.4);
    if (world_.chance(0.25)) disk_left_ = world_.between<std::uint64_t>(0, 100'000);
  }

  void make_options() {
    options_.format = cli::logs::find_format(world_.chance(0.5) ? "candump-ns" : "pcapng");
    REQUIRE(options_.format != nullptr);
    options_.path = *folder_ / ("run" + std::string{options_.format->ending});
    options_.sync = false;
    if (world_.chance(0.6)) {
      if (world_.chance(0.5))
        options_.split.size = world_.between<std::uint64_t>(2'000, 100'000);
      else
        options_.split.time = world_.between(50ms, 2s);
      if (world_.chance(0.5)) options_.ring = world_.between<std::uint64_t>(1, 5);
    }
    if (world_.chance(0.3)) limits_.count = world_.between<std::uint64_t>(1, 4000);
    limits_.duration = world_.between(1ms, 8s);
    if (world_.chance(0.6)) limits_.blocks = world_.between<std::size_t>(1, 6);
  }

  std::unique_ptr<PlayedCapture> open(Line& line) {
    auto capture = std::make_unique<PlayedCapture>(world_, line);
    world_.inputs[line.descriptor] = [raw = capture.get()] { return raw->readable(); };
    return capture;
  }
  bool is_away(const Line& line) const {
    return std::any_of(line.away.begin(), line.away.end(), [this](const Line::Away& away) {
      return world_.now() >= away.from && world_.now() < away.until;
    });
  }

  cli::Written take(std::string_view text) {
    disk_free_ = world_.now() + Duration{static_cast<std::int64_t>(10 * text.size())};
    if (slow_disk_ && world_.chance(0.3)) disk_free_ += world_.between(0s, 3s);
    if (text.size() <= disk_left_) {
      disk_left_ -= text.size();
      return {text.size(), 0};
    }
    disk_was_full_ = true;
    return {std::exchange(disk_left_, 0), ENOSPC};
  }

  void judge(const record::Recorder& recorder, const record::Files& files) {
    CHECK(files.failure().what.empty() != disk_was_full_);
    const auto left = folder_->files();
    if (options_.ring != 0) CHECK(left.size() <= options_.ring);
    const std::uint64_t all_files = left.size() + files.deleted() + (files.keeps_none() ? 1 : 0);
    CHECK(all_files == files.count() + (disk_was_full_ ? all_files - files.count() : 0));
    std::map<std::string, std::uint64_t> found;
    std::map<std::string, std::uint64_t> dropped;
    std::map<std::string, std::uint32_t> last;
    base::Time newest = base::Time::min();
    std::uint64_t all = 0;
    for (const auto& path : left) {  // numbered: in order
      const Read read = read_file(path, options_.format->name == "pcapng" ? "pcapng" : "candump");
      Moment first{}, until{};
      for (const auto& entry : read.entries) {
        const std::string& name = read.names[entry.interface];
        const std::uint32_t number = number_of(entry);
        const Line& line = lines_[static_cast<std::size_t>(name.back() - '0')];
        const auto before = last.find(name);
        if (before != last.end() && number <= before->second) {
          FAIL_CHECK(name << ": frame " << number << " comes behind " << before->second);
          return;
        }
        last[name] = number;
        ++found[name];
        ++all;
        if (!steps_of_the_clock_ && before_each_other() && entry.time < newest) {
          FAIL_CHECK("frame " << number << " of " << name << " is older than the one before");
          return;
        }
        newest = entry.time;
        const Moment came = line.arrivals[number];
        if (&entry == &read.entries.front()) first = until = came;
        first = std::min(first, came), until = std::max(until, came);
      }
      for (std::size_t i = 0; i < read.recorded.size(); ++i)
        dropped[read.names[i]] += read.recorded[i].dropped;
      if (left.size() > 1 && !disk_was_full_) CHECK_FALSE(read.entries.empty());
      // A bunch of frames that were fetched together may come into a file that is full by its size.
      if (options_.split.size != 0)
        CHECK(std::filesystem::file_size(path) < options_.split.size + 256 * 120 + 1000);
    }
    if (disk_was_full_) {
      CHECK(all <= recorder.received());
      if (options_.ring == 0) CHECK(files.readable() == all);
      return;
    }
    if (limits_.count != 0) CHECK(recorder.received() <= limits_.count);
    if (options_.ring == 0) CHECK(all == recorder.received());
    std::uint64_t here = 0;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      const Line& line = lines_[i];
      const record::Port& port = recorder.ports()[i];
      INFO(line.name << ": offered " << line.offered << ", wait " << line.waiting.size() << ", read "
                     << port.received << ", lost " << port.lost() << ", of them here " << port.lost_here
                     << ", in files " << found[line.name]);
      here += port.lost_here;
      CHECK(port.received + port.lost() - port.lost_here == line.offered - line.waiting.size());
      if (options_.ring == 0 && limits_.count == 0)
        CHECK(found[line.name] + port.lost() == line.offered - line.waiting.size());
      if (options_.ring == 0 && options_.format->name == "pcapng") CHECK(dropped[line.name] == port.lost());
      // What came before the end is not left behind.
      if (limits_.count == 0 && !line.waiting.empty() && recorder.ended().what.empty()) {
        const Moment end = std::min(World::start + limits_.duration, world_.signal_at());
        CHECK(line.arrivals[line.waiting.front()] >= end);
      }
    }
    if (limits_.blocks > 16) CHECK(here == 0);
  }
  /// Whether the times of all buses are of one clock.
  bool before_each_other() const {
    return std::all_of(lines_.begin(), lines_.end(), [](const Line& line) { return line.ahead == 0s; });
  }

  World world_;
  const Folder* folder_;
  std::vector<Line> lines_;
  record::FilesOptions options_;
  record::Limits limits_;
  Moment disk_free_ = World::start;
  std::uint64_t disk_left_ = UINT64_MAX;
  bool slow_disk_ = false;
  bool disk_was_full_ = false;
  bool steps_of_the_clock_ = false;
  Moment ended_{};
};

TEST_CASE("recorder: whatever happens to program, clock, buses and disk, no frame is lost without a count") {
  const Folder folder;
  const auto runs = static_cast<std::uint64_t>(explored(1200));
  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    INFO("seed " << seed);
    const Silence silence;
    Run{seed, folder}.go();
  }
}

/// A bus that is up and loses nothing; what comes is for each to say.
class Up : public record::Capture {
 public:
  explicit Up(bool keeps_times) : keeps_times_(keeps_times) {}
  std::string_view name() const override { return "can0"; }
  int descriptor() const override { return 1000; }
  BusState state() const override { return BusState::up; }
  const transport::Failure& failure() const override { return failure_; }
  std::uint64_t lost() const override { return 0; }
  std::uint32_t bit_rate() const override { return 0; }
  bool keeps_times() const override { return keeps_times_; }
  bool may_return() const override { return false; }

 private:
  bool keeps_times_;
  transport::Failure failure_;
};

/// Frames at their times, and how late each was fetched at most.
class Fetched final : public Up {
 public:
  Fetched(World& world, bool keeps_times, int frames = 20) : Up(keeps_times), world_(&world) {
    for (int i = 0; i < frames; ++i) arrivals_.push_back(World::start + 15ms + i * 10ms);
    world.inputs[descriptor()] = [this] {
      return next_ < arrivals_.size() ? arrivals_[next_] : Moment::max();
    };
  }
  std::size_t read(std::span<log::Entry> into, std::uint16_t interface) override {
    std::size_t count = 0;
    for (; count < into.size() && next_ < arrivals_.size() && arrivals_[next_] <= world_->now(); ++next_) {
      latest = std::max(latest, world_->now() - arrivals_[next_]);
      into[count++] = {world_->wall_at(arrivals_[next_]), can::Frame{0x601, 4, {}}, interface};
    }
    return count;
  }

  Duration latest{};

 private:
  World* world_;
  std::vector<Moment> arrivals_;
  std::size_t next_ = 0;
};

TEST_CASE(
    "recorder: frames come in bunches where they have their times already, and no reader waits for each") {
  const Silence silence;
  const Folder folder;
  const auto latest = [&](bool keeps_times, bool live) {
    folder.empty();
    World world{1};
    record::FilesOptions options;
    options.format = cli::logs::find_format("candump-ns");
    options.path = folder / ("run" + std::string{options.format->ending});
    options.sync = false;
    record::Files files{options, amiro::catalogue};
    REQUIRE(files.open().ok());
    std::vector<record::Port> ports(1);
    ports[0].name = "can0";
    auto capture = std::make_unique<Fetched>(world, keeps_times);
    const auto& fetched = *capture;
    ports[0].capture = std::move(capture);
    record::Limits limits;
    limits.duration = 200ms;
    const auto reopen = [](std::string_view) -> transport::Outcome<std::unique_ptr<record::Capture>> {
      return transport::Failure{"away", ""};
    };
    record::Recorder recorder{std::move(ports), reopen, files, limits, live};
    recorder.receive();
    while (recorder.writing().step(0ms)) world.pass(1ms);
    CHECK(recorder.received() == 19);  // one comes behind the end
    return fetched.latest;
  };
  CHECK(latest(true, false) >= 4ms);
  CHECK(latest(true, false) < 10ms);
  CHECK(latest(false, false) < 1ms);
  CHECK(latest(true, true) < 1ms);
  CHECK(latest(false, true) < 1ms);
}

/// The files of a recording to `folder`, which are open.
record::FilesOptions to_one_file(const Folder& folder) {
  record::FilesOptions options;
  options.format = cli::logs::find_format("candump-ns");
  options.path = folder / ("run" + std::string{options.format->ending});
  options.sync = false;
  return options;
}

TEST_CASE("recorder: frames are written once a second, and at once where they are read live") {
  const Silence silence;
  const Folder folder;
  const auto writes = [&](bool live) {
    folder.empty();
    World world{1};
    int count = 0;
    world.disk = [&count](int, std::string_view text) {
      if (!text.empty()) ++count;
      return cli::Written{text.size(), 0};
    };
    record::Files files{to_one_file(folder), amiro::catalogue};
    REQUIRE(files.open().ok());
    std::vector<record::Port> ports(1);
    ports[0].name = "can0";
    ports[0].capture = std::make_unique<Fetched>(world, true, 500);
    record::Limits limits;
    limits.duration = 4900ms;
    const auto reopen = [](std::string_view) -> transport::Outcome<std::unique_ptr<record::Capture>> {
      return transport::Failure{"away", ""};
    };
    record::Recorder recorder{std::move(ports), reopen, files, limits, live};
    world.beside = [&recorder] { static_cast<void>(recorder.writing().step(0ms)); };
    recorder.receive();
    world.beside = nullptr;
    while (recorder.writing().step(0ms)) world.pass(1ms);
    CHECK(recorder.received() == 489);
    CHECK(recorder.lasted() >= 4900ms);
    CHECK(recorder.lasted() < 5s);
    return count;
  };
  const int once_a_second = writes(false);
  CHECK(once_a_second >= 4);
  CHECK(once_a_second <= 6);
  CHECK(writes(true) > 100);
}

TEST_CASE("recorder: what can be read of a file is said, whose end the disk does not take") {
  const Silence silence;
  const Folder folder;
  for (const std::size_t frames : {std::size_t{1}, std::size_t{2}}) {
    folder.empty();
    World world{1};
    bool full = false;
    world.disk = [&full](int, std::string_view text) {
      return full ? cli::Written{0, ENOSPC} : cli::Written{text.size(), 0};
    };
    record::FilesOptions options;
    options.format = cli::logs::find_format("pcapng");  // which ends with what came over each interface
    options.path = folder / "run.pcapng";
    options.sync = false;
    record::Files files{options, amiro::catalogue};
    REQUIRE(files.open().ok());
    log::Interfaces interfaces;
    interfaces.number("can0");
    const std::vector<log::Entry> entries(frames, log::Entry{base::Time{1s}, can::Frame{0x601, 4, {}}});
    REQUIRE(files.write(entries, interfaces, 0s));
    REQUIRE(files.flush());
    full = true;
    CHECK_FALSE(files.finish());
    CHECK_THAT(files.failure().what, Catch::Contains("No space left on device"));
    CHECK(files.readable() == frames);
  }
}

/// As long as one lives no file may grow.
class NoFileGrows {
 public:
  NoFileGrows() {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit none{0, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &none);
  }
  ~NoFileGrows() { ::setrlimit(RLIMIT_FSIZE, &before_); }
  NoFileGrows(const NoFileGrows&) = delete;
  NoFileGrows& operator=(const NoFileGrows&) = delete;

 private:
  rlimit before_{};
};

TEST_CASE("recorder: what an older recording left is not counted as what can be read of this one") {
  const Silence silence;
  const Folder folder;
  const World world{1};
  record::FilesOptions options = to_one_file(folder);
  options.overwrite = true;
  std::ofstream{options.path} << "(1.000000000) can0 601#\n(2.000000000) can0 601#\n";
  record::Files files{options, amiro::catalogue};
  REQUIRE(files.open().ok());
  log::Interfaces interfaces;
  interfaces.number("can0");
  const std::vector<log::Entry> entries(1, log::Entry{base::Time{3s}, can::Frame{0x601, 4, {}}});
  REQUIRE(files.write(entries, interfaces, 0s));
  bool flushed = true;
  {
    const NoFileGrows full;
    flushed = files.flush();
  }
  CHECK_FALSE(flushed);
  CHECK_FALSE(files.finish());
  CHECK_THAT(files.failure().what, Catch::Contains("File too large"));
  CHECK(files.readable() == 0);
  CHECK(read_file(options.path, "candump").entries.size() == 2);
}

TEST_CASE(
    "recorder: where no next file can be made, what is in those before can be read, and is counted once") {
  const Silence silence;
  const Folder folder;
  const World world{1};
  record::FilesOptions options = to_one_file(folder);
  options.overwrite = true;
  options.split.size = 1;
  const std::string next = record::numbered({folder / "run", std::string{options.format->ending}}, 2);
  std::filesystem::create_directory(next);
  record::Files files{options, amiro::catalogue};
  REQUIRE(files.open().ok());
  log::Interfaces interfaces;
  interfaces.number("can0");
  const std::vector<log::Entry> entries(3, log::Entry{base::Time{1s}, can::Frame{0x601, 4, {}}});
  REQUIRE(files.write(entries, interfaces, 0s));
  CHECK_FALSE(files.write(entries, interfaces, 0s));
  CHECK_FALSE(files.finish());
  CHECK_THAT(files.failure().what, Catch::Contains(next + ": Is a directory"));
  CHECK(files.count() == 1);
  CHECK(files.readable() == entries.size());
}

TEST_CASE("recorder: a file that a ring cannot delete is said, and one that is gone already is not") {
  const Folder folder;
  const World world{1};
  record::FilesOptions options = to_one_file(folder);
  options.split.size = 1;
  options.ring = 2;
  const auto numbered = [&](std::uint64_t number) {
    return record::numbered({folder / "run", std::string{options.format->ending}}, number);
  };
  record::Files files{options, amiro::catalogue};
  log::Interfaces interfaces;
  interfaces.number("can0");
  const std::vector<log::Entry> entries(1, log::Entry{base::Time{1s}, can::Frame{0x601, 4, {}}});
  REQUIRE(files.open().ok());
  const auto write_one = [&] { REQUIRE(files.write(entries, interfaces, 0s)); };
  Captured said{STDERR_FILENO};
  write_one();
  write_one();
  CHECK(std::filesystem::remove(numbered(1)));
  write_one();
  CHECK(files.deleted() == 0);
  CHECK(std::filesystem::remove(numbered(2)));
  std::filesystem::create_directory(numbered(2));
  write_one();
  CHECK(files.deleted() == 0);
  write_one();
  CHECK(files.deleted() == 1);
  CHECK(files.finish());
  CHECK(said.text() == "cannot delete " + numbered(2) + ": Is a directory\n");
  CHECK(files.count() == 5);
  CHECK(folder.files() == std::set<std::string>{numbered(2), numbered(4), numbered(5)});
}

/// There is always one more batch of frames, each of which takes a millisecond to fetch.
class Flood final : public Up {
 public:
  explicit Flood(World& world) : Up(true), world_(&world) {
    world.inputs[descriptor()] = [] { return World::start; };
  }
  std::size_t read(std::span<log::Entry> into, std::uint16_t interface) override {
    world_->pass(1ms);
    const std::size_t count = std::min(into.size(), batch);
    for (log::Entry& entry : into.first(count))
      entry = {world_->wall_at(world_->now()), can::Frame{0x601, 4, {}}, interface};
    return count;
  }

 private:
  World* world_;
};

TEST_CASE("recorder: of a flood without end, what came before the end is fetched for a second at most") {
  const Silence silence;
  const Folder folder;
  World world{1};
  record::Files files{to_one_file(folder), amiro::catalogue};
  REQUIRE(files.open().ok());
  std::vector<record::Port> ports(1);
  ports[0].name = "can0";
  ports[0].capture = std::make_unique<Flood>(world);
  record::Limits limits;
  limits.duration = 1s;
  const auto reopen = [](std::string_view) -> transport::Outcome<std::unique_ptr<record::Capture>> {
    return transport::Failure{"away", ""};
  };
  record::Recorder recorder{std::move(ports), reopen, files, limits, false};
  world.beside = [&recorder] { static_cast<void>(recorder.writing().step(0ms)); };
  recorder.receive();
  world.beside = nullptr;
  while (recorder.writing().step(0ms)) world.pass(1ms);
  CHECK(recorder.lasted() >= 2s);
  CHECK(recorder.lasted() < 2100ms);
  CHECK(recorder.ports()[0].received > 2000 * 50);
  CHECK(recorder.ports()[0].received == recorder.received() + recorder.ports()[0].lost_here);
}

/// No frame comes. It is down for a second, then up, and closed from then on.
class Changing final : public record::Capture {
 public:
  Changing(World& world, Moment down, Moment up, Moment closed)
      : world_(&world), down_(down), up_(up), closed_(closed) {}
  std::size_t read(std::span<log::Entry>, std::uint16_t) override { return 0; }
  std::string_view name() const override { return "can0"; }
  int descriptor() const override { return 1000; }
  BusState state() const override {
    if (world_->now() >= closed_) return BusState::closed;
    return world_->now() >= down_ && world_->now() < up_ ? BusState::down : BusState::up;
  }
  const transport::Failure& failure() const override { return failure_; }
  std::uint64_t lost() const override { return 0; }
  std::uint32_t bit_rate() const override { return 0; }
  bool keeps_times() const override { return true; }
  bool may_return() const override { return true; }

 private:
  World* world_;
  Moment down_, up_, closed_;
  transport::Failure failure_{"can0 is gone", "plug it in"};
};

TEST_CASE("recorder: what becomes of an interface is said once, when it changes") {
  Captured said{STDERR_FILENO};
  const Folder folder;
  World world{1};
  world.inputs[1000] = [] { return Moment::max(); };
  record::Files files{to_one_file(folder), amiro::catalogue};
  REQUIRE(files.open().ok());
  std::vector<record::Port> ports(1);
  ports[0].name = "can0";
  ports[0].capture =
      std::make_unique<Changing>(world, World::start + 1s, World::start + 2s, World::start + 3s);
  const auto reopen = [&world](std::string_view) -> transport::Outcome<std::unique_ptr<record::Capture>> {
    if (world.now() < World::start + 4s) return transport::Failure{"away", ""};
    return std::unique_ptr<record::Capture>{
        std::make_unique<Changing>(world, Moment::max(), Moment::max(), Moment::max())};
  };
  record::Limits limits;
  limits.duration = 5s;
  record::Recorder recorder{std::move(ports), reopen, files, limits, false};
  recorder.receive();
  while (recorder.writing().step(0ms)) world.pass(1ms);
  CHECK(said.text() ==
        "can0 went down; waiting for it to come back\ncan0 is up again\n"
        "can0 is gone; waiting for it to come back\ncan0 is back\n");
}

/// A bus beside others. Each frame can be read at a time of its own, which is not before it came.
class Beside final : public Up {
 public:
  struct Frame {
    Moment came, readable;
  };
  Beside(World& world, int number, std::vector<Frame> frames)
      : Up(true),
        world_(&world),
        name_("can" + std::to_string(number)),
        descriptor_(1000 + number),
        frames_(std::move(frames)) {
    world.inputs[descriptor_] = [this] {
      return next_ < frames_.size() ? frames_[next_].readable : Moment::max();
    };
  }
  std::size_t read(std::span<log::Entry> into, std::uint16_t interface) override {
    std::size_t count = 0;
    for (; count < std::min(into.size(), batch) && next_ < frames_.size() &&
           frames_[next_].readable <= world_->now();
         ++next_)
      into[count++] = {world_->wall_at(frames_[next_].came), can::Frame{0x601, 4, {}}, interface};
    return count;
  }
  std::string_view name() const override { return name_; }
  int descriptor() const override { return descriptor_; }

 private:
  World* world_;
  std::string name_;
  int descriptor_;
  std::vector<Frame> frames_;
  std::size_t next_ = 0;
};

/// Of buses with these frames, each on its own.
std::vector<record::Port> ports_beside(World& world, const std::vector<std::vector<Beside::Frame>>& buses) {
  std::vector<record::Port> ports;
  for (std::size_t i = 0; i < buses.size(); ++i) {
    record::Port port;
    port.capture = std::make_unique<Beside>(world, static_cast<int>(i), buses[i]);
    port.name = port.capture->name();
    ports.push_back(std::move(port));
  }
  return ports;
}

transport::Outcome<std::unique_ptr<record::Capture>> never_back(std::string_view) {
  return transport::Failure{"away", ""};
}

TEST_CASE("recorder: of several buses a frame that comes alone is written with the next look") {
  const Silence silence;
  const Folder folder;
  World world{1};
  std::optional<Moment> written;
  world.disk = [&](int, std::string_view text) {
    if (!text.empty() && !written) written = world.now();
    return cli::Written{text.size(), 0};
  };
  record::Files files{to_one_file(folder), amiro::catalogue};
  REQUIRE(files.open().ok());
  const Moment came = World::start + 1s;
  std::vector<std::vector<Beside::Frame>> buses(2);
  buses[0].push_back({came, came});
  record::Limits limits;
  limits.duration = 10s;
  record::Recorder recorder{ports_beside(world, buses), never_back, files, limits, true};
  world.beside = [&recorder] { static_cast<void>(recorder.writing().step(0ms)); };
  recorder.receive();
  world.beside = nullptr;
  while (recorder.writing().step(0ms)) world.pass(1ms);
  CHECK(recorder.received() == 1);
  REQUIRE(written.has_value());
  CHECK(*written - came < 300ms);
}

TEST_CASE("recorder: a frame that comes alone is on its way to the disk a tenth of a second later") {
  const Silence silence;
  const Folder folder;
  World world{1};
  std::optional<Moment> written;
  world.disk = [&](int, std::string_view text) {
    if (!text.empty() && !written) written = world.now();
    return cli::Written{text.size(), 0};
  };
  record::Files files{to_one_file(folder), amiro::catalogue};
  REQUIRE(files.open().ok());
  // The disk is written to when the first second is over: it is to have been handed over by then.
  const Moment came = World::start + 850ms;
  std::vector<std::vector<Beside::Frame>> buses(1);
  buses[0].push_back({came, came});
  record::Limits limits;
  limits.duration = 5s;
  record::Recorder recorder{ports_beside(world, buses), never_back, files, limits, false};
  world.beside = [&recorder] { static_cast<void>(recorder.writing().step(0ms)); };
  recorder.receive();
  world.beside = nullptr;
  while (recorder.writing().step(0ms)) world.pass(1ms);
  CHECK(recorder.received() == 1);
  REQUIRE(written.has_value());
  CHECK(*written - came < 500ms);
}

TEST_CASE("recorder: all that waits at the end is fetched, with as many looks as that takes") {
  const Silence silence;
  const Folder folder;
  for (const std::size_t count : {std::size_t{1}, std::size_t{2}}) {
    CAPTURE(count);
    folder.empty();
    World world{1};
    std::vector<std::vector<Beside::Frame>> buses(count);
    const Moment readable = World::start + 999ms;
    for (auto& bus : buses)
      for (int i = 5000; i > 0; --i) bus.push_back({readable - i * 10us, readable});
    record::Files files{to_one_file(folder), amiro::catalogue};
    REQUIRE(files.open().ok());
    record::Limits limits;
    limits.duration = 1s;
    record::Recorder recorder{ports_beside(world, buses), never_back, files, limits, false};
    recorder.receive();
    while (recorder.writing().step(0ms)) world.pass(1ms);
    CHECK(recorder.received() == count * 5000);
  }
}

TEST_CASE(
    "recorder: what waits on several buses is in the order of its times, however often much of it waits") {
  const Silence silence;
  const Folder folder;
  World world{1};
  // Ten times 25 ms of which one bus has more frames than are fetched with two looks, and the other less.
  std::vector<std::vector<Beside::Frame>> buses(2);
  for (int burst = 1; burst <= 10; ++burst) {
    const Moment readable = World::start + burst * 100ms;
    for (int i = 2500; i > 0; --i) buses[0].push_back({readable - i * 10us, readable});
    for (int i = 1100; i > 0; --i) buses[1].push_back({readable - i * 22us, readable});
  }
  const record::FilesOptions options = to_one_file(folder);
  record::Files files{options, amiro::catalogue};
  REQUIRE(files.open().ok());
  record::Limits limits;
  limits.duration = 2s;
  record::Recorder recorder{ports_beside(world, buses), never_back, files, limits, false};
  world.beside = [&recorder] { static_cast<void>(recorder.writing().step(0ms)); };
  recorder.receive();
  world.beside = nullptr;
  while (recorder.writing().step(0ms)) world.pass(1ms);
  CHECK(recorder.received() == 36'000);
  const Read read = read_file(options.path, "candump");
  REQUIRE(read.entries.size() == 36'000);
  CHECK(std::is_sorted(read.entries.begin(), read.entries.end(),
                       [](const log::Entry& a, const log::Entry& b) { return a.time < b.time; }));
}

TEST_CASE("recorder: of a flood on two buses sixteen looks of sixteen batches are gathered at a time") {
  const Silence silence;
  const Folder folder;
  World world{1};
  record::Files files{to_one_file(folder), amiro::catalogue};
  REQUIRE(files.open().ok());
  std::vector<record::Port> ports(2);
  for (record::Port& port : ports) {
    port.name = "can0";
    port.capture = std::make_unique<Flood>(world);
  }
  record::Limits limits;
  limits.count = 1;
  limits.duration = 5s;
  record::Recorder recorder{std::move(ports), never_back, files, limits, false};
  recorder.receive();
  while (recorder.writing().step(0ms)) world.pass(1ms);
  CHECK(recorder.received() == 1);
  // The first frame leaves when it was there a round before: see Merge.
  for (const record::Port& port : recorder.ports())
    CHECK(port.received == 2 * 16 * 16 * record::Capture::batch);
}

TEST_CASE("recorder: of more buses than it waits for at once all are recorded") {
  const Silence silence;
  const Folder folder;
  World world{1};
  std::vector<std::vector<Beside::Frame>> buses(70);
  for (int i = 0; i < 70; ++i) {
    const Moment came = World::start + i * 10ms;
    buses[static_cast<std::size_t>(i)].push_back({came, came});
  }
  const record::FilesOptions options = to_one_file(folder);
  record::Files files{options, amiro::catalogue};
  REQUIRE(files.open().ok());
  record::Limits limits;
  limits.duration = 1s;
  record::Recorder recorder{ports_beside(world, buses), never_back, files, limits, false};
  recorder.receive();
  while (recorder.writing().step(0ms)) world.pass(1ms);
  CHECK(recorder.received() == 70);
  CHECK(read_file(options.path, "candump").names.size() == 70);
}

TEST_CASE("recorder: what was dropped is in a file that no frame has come into, too") {
  const Silence silence;
  const Folder folder;
  const World world{1};
  record::FilesOptions options;
  options.format = cli::logs::find_format("pcapng");
  options.path = folder / "run.pcapng";
  options.sync = false;
  record::Files files{options, amiro::catalogue};
  REQUIRE(files.open().ok());
  log::Interfaces interfaces;
  interfaces.add("can0");
  interfaces.add("can1");
  const std::vector<std::uint64_t> dropped{0, 3};
  files.set_dropped(dropped, interfaces);
  CHECK(files.finish());
  const Read read = read_file(options.path, "pcapng");
  CHECK(read.entries.empty());
  CHECK(read.names == std::vector<std::string>{"can0", "can1"});
  REQUIRE(read.recorded.size() == 2);
  CHECK(read.recorded[0].dropped == 0);
  CHECK(read.recorded[1].dropped == 3);
}

TEST_CASE("recorder: a ring waits two seconds for another program that begins one in the folder") {
  const Silence silence;
  const Folder folder;
  record::FilesOptions options = to_one_file(folder);
  options.split.time = 1h;
  options.ring = 2;
  int turn = ::open((folder / ".").c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  REQUIRE(::flock(turn, LOCK_EX) == 0);
  {
    const World world{1};
    const Moment begin = world.now();
    record::Files files{options, amiro::catalogue};
    const auto opened = files.open();
    CHECK_FALSE(opened.ok());
    CHECK_THAT(opened.error.what, Catch::Contains("another program begins a recording in"));
    CHECK(world.now() - begin == 2s);
  }
  World world{1};
  const Moment begin = world.now();
  world.beside = [&] {
    if (turn >= 0 && world.now() - begin >= 1s) ::close(std::exchange(turn, -1));
  };
  record::Files files{options, amiro::catalogue};
  CHECK(files.open().ok());
  CHECK(world.now() - begin >= 1s);
  CHECK(world.now() - begin < 1010ms);
  CHECK(files.finish());
}

}  // namespace tool_clock_record_test
