// The player of logs, on logs, buses and a clock that are made of a seed: times that go back, pauses, stops
// of the program, a bus that is full, stuck, down or away, signals. Frames go out in the order of the log,
// none before it is due, and each that was read is counted.
#include <csignal>
#include <cstring>

#include "ocm/client/command.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/replay/player.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/outgoing.hpp"
#include "cli/shared/set_points.hpp"
#include "cli/shared/unhurried_messages.hpp"
#include "tests/tool/captured.hpp"
#include "tests/tool/clock/played_bus.hpp"
#include "tests/tool/piped_stderr.hpp"
#include "tests/unit/base/explore.hpp"

namespace tool_clock_replay_test {

using namespace ocm;
using namespace ocm::test;
namespace replay = cli::replay;

/// Set points of the motors.
constexpr std::uint32_t motors = protocol::Identifier{
    protocol::Direction::command, protocol::Priority::medium,
    protocol::TopicId{0x01}}.encode();

/// A log that is there already, read in pieces of any size.
class PlayedLog final : public log::Reader {
 public:
  PlayedLog(World& world, log::Input& input, std::vector<log::Entry> entries, std::size_t buses)
      : Reader(input), world_(&world), entries_(std::move(entries)) {
    for (std::size_t i = 0; i < buses; ++i) static_cast<void>(interfaces_.add("can" + std::to_string(i)));
  }
  std::size_t read(std::span<log::Entry> into) override {
    const std::size_t left = entries_.size() - next_;
    const std::size_t count = std::min({left, into.size(), world_->between<std::size_t>(1, 300)});
    for (std::size_t i = 0; i < count; ++i) into[i] = entries_[next_++];
    return count;
  }

 private:
  World* world_;
  std::vector<log::Entry> entries_;
  std::size_t next_ = 0;
};

/// When frames are due by the rules of ocm/log/playback.hpp, a step at a time, in seconds from the first.
class Due {
 public:
  Due(double speed, Duration longest) : speed_(speed), longest_(longest) {}
  [[nodiscard]] double of(base::Time time) {
    if (!newest_) newest_ = time;
    const Duration step = time - *newest_;
    if (step < 0s && step > -1s) return due_;
    newest_ = time;
    if (step > 0s) due_ += std::chrono::duration<double>(std::min(step, longest_)).count() / speed_;
    return due_;
  }

 private:
  double speed_;
  Duration longest_;
  std::optional<base::Time> newest_;
  double due_ = 0;
};

class Run {
 public:
  explicit Run(std::uint64_t seed) : world_(seed), buses_(world_.between<std::size_t>(1, 2)) {
    make_log();
    options_.playback.speed = world_.chance(0.5) ? 1 : world_.between(1, 40) / 4.0;
    if (world_.chance(0.5)) options_.playback.longest_gap = world_.between(1ms, 3s);
    options_.at_once = world_.chance(0.1);
    if (world_.chance(0.2)) options_.span.until = world_.between(0s, 5s);
    for (std::size_t i = 0; i < buses_; ++i)
      if (buses_ > 1) options_.routes.emplace_back("can" + std::to_string(i), i);
    if (buses_ > 1 && world_.chance(0.3)) options_.routes.pop_back();
    const auto sometime = [this] { return World::start + world_.between(0s, 8s); };
    while (world_.chance(0.3)) {
      calm_ = false;
      world_.stop(sometime(), world_.between(1ms, 5s));
    }
    while (world_.chance(0.3)) world_.set_wall_clock(sometime(), world_.between(-3s, 3s));
    if (world_.chance(0.3)) world_.interrupt(sometime(), SIGINT);
  }

  void go() {
    std::vector<replay::Outlet> outlets;
    std::vector<PlayedBus*> buses;
    for (std::size_t i = 0; i < buses_; ++i) {
      auto bus = std::make_unique<PlayedBus>(world_, conditions(), "can" + std::to_string(i),
                                             500 + static_cast<int>(i));
      buses.push_back(bus.get());
      outlets.emplace_back(std::move(bus), amiro::catalogue);
    }
    log::MemorySource nothing{""};
    log::Input input{nothing};
    PlayedLog log{world_, input, entries_, buses_};
    replay::Player player{options_, replay::Selection{amiro::catalogue, {}, replay::Only::all},
                          std::move(outlets), nullptr};
    bool left = false;
    begun_ = world_.now();
    try {
      player.play(log);
      ended_ = world_.now();
      if (player.cut_short()) static_cast<void>(player.rest());
      player.expect_all_left();
    } catch (const cli::Exit&) {
      left = true;
    }
    judge(player, buses, left);
  }

 private:
  void make_log() {
    base::Time time{std::chrono::hours{500'000}};
    const auto count = world_.between<std::uint32_t>(1, 400);
    for (std::uint32_t number = 0; number < count; ++number) {
      const double kind = world_.between(0, 999) / 1000.0;
      if (kind < 0.01)
        time += world_.between(1s, 60s);
      else if (kind < 0.03)
        time -= world_.between(0s, 999ms);
      else if (kind < 0.04)
        time -= world_.between(1s, std::chrono::hours{24 * 365 * 20});
      else
        time += world_.between(0us, 30ms);
      can::Frame frame{0x601, 4, {}};
      if (world_.chance(0.1)) frame = {motors, 8, {}};
      std::memcpy(frame.data.data(), &number, sizeof number);
      if (world_.chance(0.02)) frame.data = {};
      log::Entry entry{time, frame, world_.between<std::uint16_t>(0, static_cast<std::uint16_t>(buses_ - 1))};
      if (world_.chance(0.02)) entry.flags = log::flag::fd;
      if (world_.chance(0.02)) entry.format = can::Format::error;
      entries_.push_back(entry);
    }
  }

  PlayedBus::Conditions conditions() {
    PlayedBus::Conditions bus;
    bus.room = world_.between<std::size_t>(1, 50);
    bus.frame_time = world_.between(20us, 300us);
    const auto sometime = [this] { return World::start + world_.between(0s, 6s); };
    const auto times = [&](std::vector<PlayedBus::Time>& list) {
      const Moment from = sometime();
      list.push_back({from, from + world_.between(1ms, world_.chance(0.3) ? 60s : 500ms)});
      calm_ = false;
      troubled_ = true;
    };
    if (world_.chance(0.1)) times(bus.stuck);
    if (world_.chance(0.1)) times(bus.down);
    if (world_.chance(0.1)) {
      bus.gone = sometime();
      calm_ = false;
      troubled_ = true;
    }
    return bus;
  }

  void judge(const replay::Player& player, const std::vector<PlayedBus*>& buses, bool left) {
    if (left) CHECK(troubled_);
    const auto& played = player.played();
    const std::uint64_t counted =
        played.sent + played.not_chosen + played.no_route + played.error_frames + played.fd_frames;
    CHECK(counted <= entries_.size());
    if (!left && !player.cut_short() && world_.signal() == 0) CHECK(counted == entries_.size());
    judge_frames(buses, played.sent, left, player.cut_short());
    for (auto* const bus : buses) judge_age(*bus);
    if (!left && player.cut_short())
      for (auto* const bus : buses) judge_rest(*bus);
    // A signal is seen soon, unless a bus takes nothing for a second.
    if (!left && calm_ && world_.signal_at() < ended_) CHECK(ended_ - world_.signal_at() < 250ms);
  }

  void judge_frames(const std::vector<PlayedBus*>& buses, std::uint64_t counted, bool left, bool rested) {
    std::vector<std::size_t> next(buses.size());
    Due due{options_.playback.speed, options_.playback.longest_gap};
    std::uint64_t sent = 0;
    const base::Time first = entries_.front().time;
    static_cast<void>(due.of(first));  // counts from it, even if it goes nowhere
    for (const auto& entry : entries_) {
      if (options_.span.is_behind(entry.time - first)) break;
      const bool routed = options_.routes.empty() || entry.interface < options_.routes.size();
      if (!routed) continue;
      const std::size_t outlet = options_.routes.empty() ? 0 : entry.interface;
      const double at = due.of(entry.time);
      const auto frame = entry.classic();
      if (!frame || entry.format == can::Format::error) continue;
      auto& bus = *buses[outlet];
      if (next[outlet] >= bus.sent().size() || sent == counted) break;
      const auto& each = bus.sent()[next[outlet]++];
      ++sent;
      if (each.frame != *frame) {
        FAIL_CHECK("frame " << sent << " of the log is not the next one on " << bus.name());
        return;
      }
      if (options_.at_once) continue;
      const double taken = std::chrono::duration<double>(each.taken - begun_).count();
      if (taken < at - 1e-5) FAIL_CHECK("frame " << sent << " was sent at " << taken << ", due at " << at);
      // A bus that is full takes its time.
      if (calm_ && taken > at + 0.02 + 400 * 300e-6)
        FAIL_CHECK("frame " << sent << " was sent at " << taken << ", due at " << at);
    }
    CHECK(sent == counted);
    std::size_t on_buses = 0;
    for (auto* const bus : buses) on_buses += bus->sent().size();
    CHECK(on_buses >= counted);
    CHECK(on_buses <= counted + (rested ? buses.size() : left ? 1 : 0));
  }

  /// A set point that moves is given to a bus when all before it has left: of those that wait one is such.
  static void judge_age(PlayedBus& bus) {
    const client::FrameIndex index{amiro::catalogue};
    const auto& sent = bus.sent();
    for (std::size_t i = 1; i < sent.size(); ++i)
      if (cli::commanded_motors(index, sent[i].frame) != nullptr && !cli::is_rest(sent[i].frame))
        CHECK(sent[i - 1].left <= sent[i].taken);
  }

  static void judge_rest(PlayedBus& bus) {
    const client::FrameIndex index{amiro::catalogue};
    const can::Frame* last = nullptr;
    for (const auto& each : bus.sent())
      if (cli::commanded_motors(index, each.frame) != nullptr) last = &each.frame;
    if (last != nullptr) CHECK(cli::is_rest(*last));
  }

  World world_;
  std::size_t buses_;
  std::vector<log::Entry> entries_;
  replay::PlayerOptions options_;
  bool calm_ = true;
  bool troubled_ = false;  ///< a bus may end the replay
  Moment begun_{};
  Moment ended_{};
};

TEST_CASE(
    "replay: whatever happens to program and bus, frames keep their order, wait until due and are counted") {
  const auto runs = static_cast<std::uint64_t>(explored(1500));
  const Silence silence;
  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    INFO("seed " << seed);
    Run{seed}.go();
  }
}

/// A player of all frames of a log, on one bus.
template <class Log>
class OnOneBus {
 public:
  template <class... Arguments>
  OnOneBus(World& world, PlayedBus::Conditions conditions, Arguments&&... log)
      : log_(world, input_, std::forward<Arguments>(log)...) {
    auto made = std::make_unique<PlayedBus>(world, std::move(conditions));
    bus_ = made.get();
    std::vector<replay::Outlet> outlets;
    outlets.emplace_back(std::move(made), amiro::catalogue);
    player.emplace(replay::PlayerOptions{}, replay::Selection{amiro::catalogue, {}, replay::Only::all},
                   std::move(outlets), nullptr);
  }
  void play() { player->play(log_); }
  [[nodiscard]] const std::vector<PlayedBus::Sent>& sent() { return bus_->sent(); }

  std::optional<replay::Player> player;

 private:
  log::MemorySource nothing_{""};
  log::Input input_{nothing_};
  Log log_;
  PlayedBus* bus_ = nullptr;
};

/// Set points that move, so many of them, each 100 ms behind the last.
std::vector<log::Entry> drive_of(int count) {
  std::vector<log::Entry> drive;
  for (int i = 0; i < count; ++i) {
    can::Frame frame{motors, 8, {}};
    frame.data[0] = 100;
    drive.emplace_back(base::Time{i * 100ms}, frame, std::uint16_t{0});
  }
  return drive;
}

TEST_CASE("replay: on a bus from which nothing leaves, zero comes behind the one set point that waits") {
  const Silence silence;
  const auto drive = drive_of(100);
  for (const Duration stuck : {400ms, 5000ms}) {
    INFO("stuck for " << stuck.count() << " ns");
    World world{1};
    PlayedBus::Conditions conditions;
    const Moment begin = World::start + 2s;
    conditions.stuck = {{begin, begin + stuck}};
    OnOneBus<PlayedLog> replayed{world, conditions, drive, std::size_t{1}};
    auto& player = *replayed.player;
    bool left = false;
    try {
      replayed.play();
      player.expect_all_left();
    } catch (const cli::Exit& exit) {
      left = true;
      CHECK(exit.code == 1);
    }
    CHECK(left == (stuck > client::longest_without_set_point));
    if (!left) {
      CHECK(replayed.sent().size() == drive.size());
      continue;
    }
    CHECK(world.now() < begin + client::longest_without_set_point + 200ms);
    const auto& sent = replayed.sent();
    CHECK(std::count_if(sent.begin(), sent.end(), [&](const auto& each) {
            return each.taken > begin && !cli::is_rest(each.frame);
          }) == 1);
    CHECK(cli::is_rest(sent.back().frame));
  }
}

/// A set point of motion at each of these times, sent with a frame of a sensor just before it.
std::vector<log::Entry> drive_at(const std::vector<Duration>& times, bool rest_last) {
  std::vector<log::Entry> entries;
  for (const Duration time : times) {
    entries.emplace_back(base::Time{time}, can::Frame{0x601, 4, {1}}, std::uint16_t{0});
    can::Frame frame{motors, 8, {}};
    if (!rest_last || time != times.back()) frame.data[0] = 100;
    entries.emplace_back(base::Time{time}, frame, std::uint16_t{0});
  }
  return entries;
}

TEST_CASE("replay: a set point that waits is not left to wait until the next one is due") {
  const Silence silence;
  World world{1};
  PlayedBus::Conditions conditions;
  const Moment begin = World::start + 900ms;
  conditions.stuck = {{begin, begin + 3s}};
  auto entries = drive_at({0s, 1s, 6s}, true);
  std::erase_if(entries, [](const log::Entry& entry) { return entry.id != motors; });
  OnOneBus<PlayedLog> replayed{world, conditions, entries, std::size_t{1}};
  try {
    replayed.play();
    FAIL_CHECK("it went on");
  } catch (const cli::Exit& exit) {
    CHECK(exit.code == 1);
  }
  CHECK(world.now() < World::start + 1s + client::longest_without_set_point + 250ms);
  REQUIRE(replayed.sent().size() == 3);
  CHECK(!cli::is_rest(replayed.sent()[1].frame));
  CHECK(cli::is_rest(replayed.sent()[2].frame));
}

TEST_CASE("replay: a set point that has left may be older than the next one") {
  const Silence silence;
  World world{1};
  PlayedBus::Conditions conditions;
  const Moment begin = World::start + 1200ms;  // the one of 1 s has left, what comes behind it waits
  conditions.stuck = {{begin, begin + 2s}};
  auto entries = drive_at({0s, 1s, 6s}, true);
  entries.emplace(entries.end() - 2, base::Time{1500ms}, can::Frame{0x601, 4, {2}}, std::uint16_t{0});
  OnOneBus<PlayedLog> replayed{world, conditions, entries, std::size_t{1}};
  replayed.play();
  CHECK(replayed.sent().size() == entries.size());
}

TEST_CASE("replay: the motors may still move only where their zero is among the frames that wait") {
  for (const bool zero_waits : {false, true}) {
    CAPTURE(zero_waits);
    World world{1};
    PlayedBus::Conditions conditions;
    conditions.stuck = {{World::start + (zero_waits ? 400ms : 800ms), World::start + 60s}};
    auto entries = drive_at({0s, 500ms}, true);
    std::erase_if(entries, [](const log::Entry& entry) { return entry.id != motors; });
    for (std::uint8_t i = 0; i < 3; ++i)
      entries.emplace_back(base::Time{1s}, can::Frame{0x601, 4, {i}}, std::uint16_t{0});
    OnOneBus<PlayedLog> replayed{world, conditions, entries, std::size_t{1}};
    const auto left = leaving([&] {
      replayed.play();
      replayed.player->expect_all_left();
    });
    CHECK(left.code == cli::exit_failure);
    CHECK(replayed.sent().size() == entries.size());
    CHECK((left.text.find(cli::still_moving) != std::string::npos) == zero_waits);
  }
}

TEST_CASE("replay: a stop of the program while the motors run ends it, whenever that was") {
  const Silence silence;
  std::vector<Duration> times;
  for (int i = 0; i < 40; ++i) times.push_back(i * 100ms);
  const auto entries = drive_at(times, false);
  const Duration finest = sanitized ? 7001ns : 700ns;
  for (const Duration lasting : {300ms, 700ms, 5000ms})
    for (Duration at = 2s; at < 2s + 110ms; at += at < 2s + 1ms ? finest : Duration{3ms}) {
      INFO("stopped at " << at.count() << " for " << lasting.count() << " ns");
      World world{1};
      world.stop(World::start + at, lasting);
      OnOneBus<PlayedLog> replayed{world, PlayedBus::Conditions{}, entries, std::size_t{1}};
      auto& player = *replayed.player;
      replayed.play();
      const bool long_stop = lasting > client::longest_without_set_point;
      CHECK(player.held_up().has_value() == long_stop);
      CHECK(player.cut_short() == long_stop);
      if (!long_stop) {
        CHECK(player.played().sent == entries.size());
        continue;
      }
      CHECK(*player.held_up() > lasting - 110ms);
      CHECK(*player.held_up() <= lasting + 2ms);
      CHECK(player.rest());
      const auto& sent = replayed.sent();
      CHECK(std::count_if(sent.begin(), sent.end(), [&](const auto& each) {
              return each.taken > World::start + at + lasting && each.frame.id == motors &&
                     !cli::is_rest(each.frame);
            }) <= 1);
      CHECK(cli::is_rest(sent.back().frame));
    }
}

TEST_CASE(
    "replay: a stop of the program while nothing is in motion makes all later, and none follow at once") {
  const Silence silence;
  const std::vector<Duration> times{0s, 3s, 3s + 100ms, 4s, 6s};
  auto entries = drive_at(times, true);
  for (std::size_t i = 1; i < 4; i += 2) entries[i].data[0] = 0;  // the motors run from 3.1 s on
  World world{1};
  world.stop(World::start + 1s, 10s);
  OnOneBus<PlayedLog> replayed{world, PlayedBus::Conditions{}, entries, std::size_t{1}};
  auto& player = *replayed.player;
  replayed.play();
  CHECK_FALSE(player.held_up());
  CHECK_FALSE(player.cut_short());
  REQUIRE(replayed.sent().size() == entries.size());
  const Moment resumed = World::start + 11s;
  for (std::size_t i = 2; i < entries.size(); ++i) {
    const Duration apart = replayed.sent()[i].taken - resumed - (times[i / 2] - times[1]);
    CHECK(apart >= 0s);
    CHECK(apart < 5ms);
  }
  CHECK(player.playback().late() == 1);
  CHECK(player.playback().worst() > 7s);
}

TEST_CASE("replay: a bus that is too slow for the log is followed, and nothing is made up for") {
  const Silence silence;
  std::vector<Duration> times;
  for (int i = 0; i < 100; ++i) times.push_back(i * 10ms);
  const auto entries = drive_at(times, true);
  World world{1};
  PlayedBus::Conditions slow;
  slow.frame_time = 20ms;
  OnOneBus<PlayedLog> replayed{world, slow, entries, std::size_t{1}};
  auto& player = *replayed.player;
  replayed.play();
  player.expect_all_left();
  CHECK_FALSE(player.held_up());
  CHECK(replayed.sent().size() == entries.size());
  CHECK(replayed.sent().back().taken - World::start > 3900ms);  // 200 frames of 20 ms
  CHECK(player.playback().worst() < client::longest_without_set_point + 50ms);
}

/// Each of the first frames comes so long after the one before; the others are there with the last of them.
class SlowLog final : public log::Reader {
 public:
  SlowLog(World& world, log::Input& input, std::vector<log::Entry> entries, std::size_t slow)
      : Reader(input), world_(&world), entries_(std::move(entries)), slow_(slow) {
    static_cast<void>(interfaces_.add("can0"));
  }
  std::size_t read(std::span<log::Entry> into) override {
    if (next_ < slow_) world_->pass(250ms);
    const std::size_t count = next_ < slow_ ? 1 : std::min(entries_.size() - next_, into.size());
    for (std::size_t i = 0; i < count; ++i) into[i] = entries_[next_++];
    return count;
  }

 private:
  World* world_;
  std::vector<log::Entry> entries_;
  std::size_t next_ = 0;
  std::size_t slow_;
};

TEST_CASE("replay: what has come late by a slow pipe is not sent at once when the pipe is fast again") {
  const Silence silence;
  const auto drive = drive_of(80);
  World world{1};
  OnOneBus<SlowLog> replayed{world, PlayedBus::Conditions{}, drive, std::size_t{40}};
  auto& player = *replayed.player;
  replayed.play();
  CHECK_FALSE(player.held_up());
  const auto& sent = replayed.sent();
  REQUIRE(sent.size() == drive.size());
  std::size_t at_once = 0;
  for (std::size_t i = 1; i < sent.size(); ++i)
    if (sent[i].taken - sent[i - 1].taken < 90ms) ++at_once;
  CHECK(at_once <= 5);  // as late as motors wait for a set point
}

TEST_CASE("replay: a set point of a log that is late may wait for the bus as long as any other") {
  const Silence silence;
  const can::Frame moves{motors, 8, {100}};
  const std::vector<log::Entry> entries{{base::Time{0ms}, moves, 0},
                                        {base::Time{100ms}, moves, 0},
                                        {base::Time{200ms}, can::Frame{0x601, 4, {1}}, 0},
                                        {base::Time{200ms}, moves, 0},
                                        {base::Time{300ms}, moves, 0},
                                        {base::Time{400ms}, can::Frame{motors, 8, {}}, 0}};
  // The first three come 250 ms apart: the third is 300 ms late, and the bus holds it for 250 ms more.
  World world{1};
  PlayedBus::Conditions conditions;
  conditions.stuck = {{World::start + 700ms, World::start + 1s}};
  OnOneBus<SlowLog> replayed{world, conditions, entries, std::size_t{3}};
  auto& player = *replayed.player;
  replayed.play();
  CHECK_FALSE(player.held_up());
  CHECK_FALSE(player.cut_short());
  const auto& sent = replayed.sent();
  REQUIRE(sent.size() == entries.size());
  CHECK(sent[2].taken < World::start + 760ms);
  CHECK(sent[3].taken >= World::start + 1s);
  CHECK(sent[3].taken < World::start + 1010ms);
  // Less than half a second late, nothing is put off: what is due follows at once.
  for (std::size_t i = 4; i < sent.size(); ++i) CHECK(sent[i].taken - sent[i - 1].taken < 10ms);
}

constexpr can::Frame travels{0x20B, 8, {0x50, 0xC3, 0, 0, 0, 0, 0xE8, 3}};

/// Two buses: motors that move on the first, which is gone after a second; a travel and motors on the second,
/// which `conditions` are of. What is said of each, and what the second was given.
struct OneFailed {
  std::vector<std::string> told;
  std::vector<PlayedBus::Sent> sent;
};
OneFailed one_failed(const PlayedBus::Conditions& second) {
  World world{1};
  replay::PlayerOptions options;
  std::vector<replay::Outlet> outlets;
  std::vector<PlayedBus*> buses;
  for (std::size_t i = 0; i < 2; ++i) {
    const std::string name = "can" + std::to_string(i);
    PlayedBus::Conditions conditions = second;
    if (i == 0) conditions = {.gone = World::start + 1s};
    auto made = std::make_unique<PlayedBus>(world, conditions, name, 500 + static_cast<int>(i));
    buses.push_back(made.get());
    outlets.emplace_back(std::move(made), amiro::catalogue);
    options.routes.emplace_back(name, i);
  }
  can::Frame moves{motors, 8, {}};
  moves.data[0] = 100;
  std::vector<log::Entry> entries{{base::Time{0s}, travels, 1}, {base::Time{100ms}, moves, 1}};
  for (int i = 2; i < 40; ++i) entries.emplace_back(base::Time{i * 100ms}, moves, std::uint16_t{0});
  log::MemorySource nothing{""};
  log::Input input{nothing};
  PlayedLog log{world, input, entries, 2};
  replay::Player player{options, replay::Selection{amiro::catalogue, {}, replay::Only::all},
                        std::move(outlets), nullptr};
  CHECK_THROWS_AS(player.play(log), cli::Exit);
  OneFailed result{player.end_after_all(), buses[1]->sent()};
  CHECK(player.end_after_all().empty());
  return result;
}

TEST_CASE("replay: where one bus fails, what runs on the others is ended") {
  const Silence silence;
  const std::string first = std::string{"can0: "} + cli::still_moving;
  const std::string second = std::string{"can1: "} + cli::still_travelling;
  {
    // The first robot may move: its bus is gone. The second has heard zero, for both.
    const auto [told, sent] = one_failed({});
    CHECK(told == std::vector{first});
    REQUIRE(sent.size() == 4);
    CHECK((sent[2].frame.id == motors && cli::is_rest(sent[2].frame)));
    CHECK((sent[3].frame.id == travels.id && cli::is_rest(sent[3].frame)));
  }
  {
    // A bus that takes its time is waited for.
    const auto [told, sent] = one_failed({.frame_time = 20ms});
    CHECK(told == std::vector{first});
    CHECK(sent.size() == 4);
  }
  {
    // Full for longer than the first zero waits: the second is given all the same.
    const auto [told, sent] = one_failed({.down = {{World::start + 900ms, World::start + 1300ms}}});
    CHECK(told == std::vector{first, second});
    REQUIRE(sent.size() == 3);
    CHECK((sent[2].frame.id == travels.id && cli::is_rest(sent[2].frame)));
  }
  {
    // It takes both, and neither leaves.
    const auto [told, sent] = one_failed({.stuck = {{World::start + 900ms, World::start + 60s}}});
    CHECK(told == std::vector{first, second});
    CHECK(sent.size() == 4);
  }
}

TEST_CASE("replay: on a bus from which nothing leaves, one travel waits, and its end comes behind it") {
  const Silence silence;
  World world{1};
  PlayedBus::Conditions conditions;
  const Moment begin = World::start + 350ms;
  conditions.stuck = {{begin, begin + 60s}};
  std::vector<log::Entry> entries;
  for (int i = 0; i < 20; ++i) entries.emplace_back(base::Time{i * 100ms}, travels, std::uint16_t{0});
  OnOneBus<PlayedLog> replayed{world, conditions, entries, std::size_t{1}};
  CHECK_THROWS_AS(replayed.play(), cli::Exit);
  CHECK(world.now() < begin + 150ms + client::longest_without_set_point + 100ms);
  CHECK(replayed.player->end_after_all() == std::vector{std::string{"can0: "} + cli::still_travelling});
  const auto& sent = replayed.sent();
  REQUIRE(sent.size() == 6);  // four that have left, one that waits, and its end
  CHECK(!cli::is_rest(sent[4].frame));
  CHECK((sent[5].frame.id == travels.id && cli::is_rest(sent[5].frame)));
}

TEST_CASE("replay: one travel does not wait longer than a set point of motors may") {
  const Silence silence;
  World world{1};
  PlayedBus::Conditions conditions;
  conditions.stuck = {{World::start, World::start + 60s}};
  std::vector<log::Entry> entries{{base::Time{0s}, travels, std::uint16_t{0}}};
  for (int i = 1; i < 4; ++i)
    entries.emplace_back(base::Time{i * 100ms}, can::Frame{0x601, 4, {1}}, std::uint16_t{0});
  entries.emplace_back(base::Time{30s}, can::Frame{0x601, 4, {1}}, std::uint16_t{0});
  OnOneBus<PlayedLog> replayed{world, conditions, entries, std::size_t{1}};
  CHECK_THROWS_AS(replayed.play(), cli::Exit);
  CHECK(world.now() < World::start + client::longest_without_set_point + 250ms);
  CHECK(replayed.player->end_after_all() == std::vector{std::string{"can0: "} + cli::still_travelling});
  CHECK(replayed.sent().size() == 5);
}

TEST_CASE("replay: behind a travel that the bus has kept back, the log goes on by so much later") {
  const Silence silence;
  World world{1};
  PlayedBus::Conditions conditions;
  conditions.frame_time = 200ms;
  std::vector<log::Entry> entries;
  for (int i = 0; i < 5; ++i)
    entries.emplace_back(base::Time{0s}, can::Frame{0x601, 4, {1}}, std::uint16_t{0});
  entries.emplace_back(base::Time{10ms}, travels, std::uint16_t{0});
  entries.emplace_back(base::Time{510ms}, travels, std::uint16_t{0});
  OnOneBus<PlayedLog> replayed{world, conditions, entries, std::size_t{1}};
  replayed.play();
  const auto& sent = replayed.sent();
  REQUIRE(sent.size() == entries.size());
  CHECK(sent[5].taken >= World::start + 1s);  // all before it have left
  CHECK(sent[6].taken - sent[5].taken >= 490ms);
}

/// A frame of a sensor at each of these times.
std::vector<log::Entry> sensors_at(const std::vector<Duration>& times) {
  std::vector<log::Entry> entries;
  for (const Duration time : times)
    entries.emplace_back(base::Time{time}, can::Frame{0x601, 4, {1}}, std::uint16_t{0});
  return entries;
}

TEST_CASE("replay: a bus is looked at until two milliseconds before a frame is due, then only time passes") {
  const Silence silence;
  for (const Duration before : {2500us, 1500us}) {
    CAPTURE(before.count());
    World world{1};
    PlayedBus::Conditions conditions;
    conditions.gone = World::start + 1s - before;
    OnOneBus<PlayedLog> replayed{world, conditions, sensors_at({0s, 1s}), std::size_t{1}};
    CHECK_THROWS_AS(replayed.play(), cli::Exit);
    CHECK(replayed.sent().size() == 1);
    if (before > 2ms)
      CHECK(world.now() < World::start + 998ms);
    else
      CHECK(world.now() >= World::start + 1s);
  }
}

TEST_CASE("replay: in a pause of the log the bus is looked at five times a second") {
  const Silence silence;
  World world{1};
  std::size_t steps = 0;  // of the time; some of them are of one look
  world.beside = [&steps] { ++steps; };
  OnOneBus<PlayedLog> replayed{world, PlayedBus::Conditions{}, sensors_at({0s, 10s}), std::size_t{1}};
  replayed.play();
  CHECK(replayed.sent().size() == 2);
  CHECK(steps >= 50);
  CHECK(steps < 1000);
}

TEST_CASE("replay: a travel that a log has begun is named and ended, once") {
  const Silence silence;
  World world{1};
  const std::vector<log::Entry> entries{{base::Time{0s}, travels, std::uint16_t{0}},
                                        {base::Time{10ms}, can::Frame{0x601, 4, {1}}, std::uint16_t{0}}};
  OnOneBus<PlayedLog> replayed{world, PlayedBus::Conditions{}, entries, std::size_t{1}};
  replayed.play();
  auto& player = *replayed.player;
  CHECK(player.end_behaviours() == std::vector<std::string>{"travel was"});
  REQUIRE(replayed.sent().size() == 3);
  CHECK(replayed.sent()[2].frame.id == travels.id);
  CHECK(cli::is_rest(replayed.sent()[2].frame));
  CHECK(player.end_behaviours().empty());
  CHECK(player.end_after_all().empty());
  CHECK_FALSE(player.rest());
  CHECK(replayed.sent().size() == 3);
}

TEST_CASE("replay: what stderr did not take is written in a pause of the log") {
  World world{1};
  const PipedStderr pipe;
  const cli::UnhurriedMessages unhurried;
  pipe.fill();
  cli::remark("for later");
  CHECK(pipe.read().empty());
  OnOneBus<PlayedLog> replayed{world, PlayedBus::Conditions{}, sensors_at({0s, 1s}), std::size_t{1}};
  replayed.play();
  CHECK(pipe.read() == "for later\n");
}

TEST_CASE("replay: a set point waits no longer where the frames behind it leave no pause") {
  const Silence silence;
  World world{1};
  PlayedBus::Conditions conditions;
  conditions.room = 5000;
  conditions.stuck = {{World::start, World::start + 60s}};
  std::vector<log::Entry> entries = drive_of(1);
  for (int i = 1; i < 2000; ++i)
    entries.emplace_back(base::Time{i * 1ms}, can::Frame{0x601, 4, {1}}, std::uint16_t{0});
  OnOneBus<PlayedLog> replayed{world, conditions, entries, std::size_t{1}};
  CHECK_THROWS_AS(replayed.play(), cli::Exit);
  CHECK(world.now() >= World::start + client::longest_without_set_point);
  CHECK(world.now() < World::start + client::longest_without_set_point + 50ms);
  REQUIRE(replayed.sent().size() > 2);
  const can::Frame& last = replayed.sent().back().frame;
  CHECK(last.id == motors);
  CHECK(cli::is_rest(last));
}

TEST_CASE("replay: error frames, and those of CAN FD for a bus without it, are left out and counted") {
  const Silence silence;
  World world{1};
  auto entries = sensors_at({0s, 1ms, 2ms, 3ms, 4ms, 5ms});
  entries[1].format = can::Format::error;
  entries[3].flags = entries[4].flags = log::flag::fd;
  OnOneBus<PlayedLog> replayed{world, PlayedBus::Conditions{}, entries, std::size_t{1}};
  replayed.play();
  const replay::Played& played = replayed.player->played();
  CHECK(played.sent == 3);
  CHECK(played.error_frames == 1);
  CHECK(played.fd_frames == 2);
  CHECK(played.no_route == 0);
  CHECK(played.not_chosen == 0);
  CHECK(replayed.sent().size() == 3);
}

TEST_CASE("replay: a pass begins when the last frame of the one before was due") {
  const Silence silence;
  World world{1};
  const auto entries = sensors_at({0s, 300ms});
  OnOneBus<PlayedLog> replayed{world, PlayedBus::Conditions{}, entries, std::size_t{1}};
  auto& player = *replayed.player;
  CHECK(player.lasted() == 0s);
  replayed.play();
  log::MemorySource nothing{""};
  log::Input input{nothing};
  PlayedLog again{world, input, entries, 1};
  player.play(again);
  CHECK(player.lasted() >= 600ms);
  CHECK(player.lasted() < 601ms);
  CHECK(player.playback().backward() == 0);
  CHECK_FALSE(player.cut_short());
  const auto& sent = replayed.sent();
  REQUIRE(sent.size() == 4);
  CHECK(sent[1].taken - sent[0].taken >= 299ms);
  CHECK(sent[2].taken - sent[1].taken < 1ms);
  CHECK(sent[3].taken - sent[1].taken >= 299ms);
}

}  // namespace tool_clock_replay_test
