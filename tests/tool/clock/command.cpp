// Drives and their set points, on a bus and a clock that are made of a seed: stops of the program, a bus that
// is full, stuck, down or away, signals, other programs. The robot does only what is commanded now, and rests
// at the end.
#include <algorithm>
#include <csignal>
#include <cstdint>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/protocol/codec.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/command/timeline.hpp"
#include "cli/shared/behaviour_sensor.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/set_points.hpp"
#include "tests/tool/captured.hpp"
#include "tests/tool/clock/played_bus.hpp"
#include "tests/tool/clock/question.hpp"
#include "tests/unit/base/explore.hpp"

namespace tool_clock_command_test {

using namespace ocm;
using namespace ocm::test;
using cli::Timeline;

constexpr Duration watchdog = client::longest_without_set_point;

/// `drive 0.1m/s 0 --for lasting`
client::Command drive(Duration lasting) {
  const cli::words::CommandParser parser{amiro::catalogue};
  const std::vector<std::string_view> words{"drive", "0.1m/s", "0"};
  auto command = parser.parse_line(words);
  REQUIRE(command.ok());
  command->hold->lasting = lasting;
  return *command;
}

class Run {
 public:
  explicit Run(std::uint64_t seed)
      : world_(seed), lasting_(world_.chance(0.2) ? 0s : world_.between(1ms, 5s)) {
    PlayedBus::Conditions bus;
    bus.room = world_.between<std::size_t>(1, 20);
    bus.frame_time = world_.between(100us, world_.chance(0.1) ? 80ms : 1ms);
    bus.knows_delivery = world_.chance(0.7);
    const auto sometime = [this] { return World::start + world_.between(0s, 6s); };
    const auto times = [&](std::vector<PlayedBus::Time>& list) {
      const Moment from = sometime();
      list.push_back({from, from + world_.between(1ms, world_.chance(0.3) ? 60s : 1s)});
      calm_ = false;
    };
    if (world_.chance(0.3)) times(bus.stuck);
    if (world_.chance(0.2)) times(bus.down);
    if (world_.chance(0.1)) bus.gone = sometime(), calm_ = false;
    while (world_.chance(0.4)) {
      world_.stop(sometime(), world_.between(1ms, world_.chance(0.2) ? 60s : 2s));
      calm_ = false;
    }
    while (world_.chance(0.3)) world_.set_wall_clock(sometime(), world_.between(-3s, 3s));
    if (world_.chance(0.3) || lasting_ == 0s) world_.interrupt(sometime(), SIGINT);
    if (world_.chance(0.1)) {  // another program, which drives or stops
      can::Frame theirs = drive(0s).frames.front();
      if (world_.chance(0.5)) theirs.data = {};
      bus.incoming.push_back({sometime(), theirs});
      others_ = true;
    }
    bus_.emplace(world_, std::move(bus));
  }

  void go() {
    const auto command = drive(lasting_);
    set_point_ = command.frames.front();
    confirm_ = world_.chance(0.5) ? cli::Confirm::yes : cli::Confirm::no;
    bool left = false;
    try {
      Timeline timeline{*bus_, amiro::catalogue, "drive", Timeline::Others::refused, confirm_, {}};
      if (timeline.listen_first()) {
        begun_ = world_.now();
        timeline.carry_out(command);
        whole_ = timeline.wait_for_end();
      }
      static_cast<void>(timeline.finish());
    } catch (const cli::Exit& exit) {
      left = true;
      CHECK(exit.code != 0);
    }
    ended_ = world_.now();
    refuses_ = !bus_->takes();
    // What lies in the queue leaves once it can.
    world_.wait_until(world_.now() + 200s);
    world_.wait_until(world_.now() + 200s);
    judge(left);
  }

 private:
  void judge(bool left) {
    auto sent = after_question(bus_->sent());
    // Behind all of it, whether the board is there; a drive that a signal ends does not ask.
    if (!sent.empty() && sent.back().frame == status_question()) {
      CHECK((confirm_ == cli::Confirm::yes && whole_ && !left));
      sent.pop_back();
    }
    for (const auto& each : sent) CHECK((each.frame == set_point_ || cli::is_rest(each.frame)));
    const bool gone = ended_ >= bus_->conditions().gone;
    judge_end(sent, gone, left);
    judge_age(sent);
    if (calm_ && !others_) judge_calm(sent, left);
  }

  /// A drive that has begun ends with rest, wherever the bus takes it.
  void judge_end(const std::vector<PlayedBus::Sent>& sent, bool gone, bool left) {
    if (sent.empty() || gone) return;
    const bool rests = cli::is_rest(sent.back().frame);
    CHECK(std::count_if(sent.begin(), sent.end(),
                        [](const auto& each) { return cli::is_rest(each.frame); }) <= 1);
    if (!left) {
      CHECK(rests);
      if (bus_->conditions().knows_delivery) CHECK(sent.back().left <= ended_);
    }
    if (!refuses_) CHECK(rests);
  }

  /// No set point comes to the robot that is older than its watchdog waits: but one, where the program was
  /// stopped between its look at the clock and its send, or the bus was stuck with one in the queue.
  void judge_age(const std::vector<PlayedBus::Sent>& sent) {
    std::size_t old = 0;
    for (std::size_t i = 0; i < sent.size(); ++i) {
      const auto& each = sent[i];
      if (cli::is_rest(each.frame) || each.left == Moment::max()) continue;
      if (bus_->conditions().knows_delivery && each.left - each.taken >= watchdog) ++old;
      // After a stop, at most one more.
      if (i + 1 < sent.size() && !cli::is_rest(sent[i + 1].frame) &&
          sent[i + 1].taken - each.taken >= watchdog + client::hold_period) {
        INFO("set points at " << (each.taken - World::start).count() << " and "
                              << (sent[i + 1].taken - World::start).count());
        if (world_.was_stopped(each.taken, sent[i + 1].taken, watchdog))
          ++old;
        else
          CHECK(bus_->conditions().knows_delivery);
      }
    }
    CHECK(old <= 1);
    // Of those that wait at once only one is a set point that moves; it does not wait behind the question,
    // either.
    if (!bus_->conditions().knows_delivery) return;
    const auto& all = bus_->sent();
    for (std::size_t i = 1; i < all.size(); ++i)
      if (!cli::is_rest(all[i].frame)) CHECK(all[i - 1].left <= all[i].taken);
  }

  /// Nothing went wrong: each set point at its time, for as long as was asked.
  void judge_calm(const std::vector<PlayedBus::Sent>& sent, bool left) {
    CHECK(!left);
    if (sent.empty()) return;
    const bool asks = bus_->sent().back().frame == status_question();
    if (confirm_ == cli::Confirm::yes && whole_ && world_.signal_at() > ended_) CHECK(asks);
    CHECK(bus_->sent().front().frame == question());
    const Moment end = std::min(lasting_ > 0s ? begun_ + lasting_ : Moment::max(), world_.signal_at());
    CHECK(whole_ == (world_.signal_at() > begun_ + lasting_ && lasting_ > 0s));
    CHECK(cli::is_rest(sent.back().frame));
    CHECK(sent.back().taken >= end);
    CHECK(sent.back().taken < end + 5ms + 2 * bus_->conditions().frame_time);
    const auto periods = (end - begun_) / client::hold_period;
    const auto set_points = static_cast<std::int64_t>(sent.size()) - 1;
    CHECK(std::abs(set_points - 1 - periods) <= 1);
    for (std::size_t i = 1; i + 1 < sent.size(); ++i) {
      const Duration apart =
          sent[i].taken - sent[0].taken - static_cast<std::int64_t>(i) * client::hold_period;
      CHECK(std::chrono::abs(apart) < 2ms);
    }
  }

  World world_;
  Duration lasting_;
  std::optional<PlayedBus> bus_;
  can::Frame set_point_;
  cli::Confirm confirm_{};
  bool calm_ = true;
  bool others_ = false;
  bool whole_ = false;
  bool refuses_ = false;  ///< the bus takes no frame at the end
  Moment begun_ = World::start;
  Moment ended_{};
};

TEST_CASE("drive: whatever happens to program and bus, at most one set point is old, and rest comes last") {
  const auto runs = static_cast<std::uint64_t>(explored(3000));
  const Silence silence;
  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    INFO("seed " << seed);
    Run{seed}.go();
  }
}

/// When set points were taken in a drive of two seconds; the program is stopped at a moment, long enough.
std::vector<Moment> driven(std::optional<Moment> stopped, bool& left) {
  World world{1};
  PlayedBus bus{world, {}};
  const auto command = drive(2s);
  if (stopped) world.stop(*stopped, 2 * watchdog);
  left = false;
  try {
    Timeline timeline{bus, amiro::catalogue, "drive", Timeline::Others::refused, cli::Confirm::no, {}};
    if (timeline.listen_first()) {
      timeline.carry_out(command);
      static_cast<void>(timeline.wait_for_end());
    }
    static_cast<void>(timeline.finish());
  } catch (const cli::Exit&) {
    left = true;
  }
  std::vector<Moment> moving;
  for (const auto& each : after_question(bus.sent()))
    if (!cli::is_rest(each.frame)) moving.push_back(each.taken);
  CHECK((moving.empty() || cli::is_rest(bus.sent().back().frame)));
  return moving;
}

TEST_CASE("drive: a stop of the program just as the first set point leaves ends it, too") {
  const Silence silence;
  bool left = false;
  const Moment first = driven({}, left).front();
  CHECK_FALSE(left);
  for (Duration late = -5us; late < 50us; late += 100ns) {
    INFO("stopped " << late.count() << " ns after it");
    const Moment stopped = first + late;
    const auto moving = driven(stopped, left);
    CHECK(left);
    CHECK(std::count_if(moving.begin(), moving.end(), [&](Moment time) { return time > stopped; }) <= 1);
  }
}

/// A drive that listens first, to its end.
void drive_to_its_end(PlayedBus& bus, Duration lasting) {
  Timeline timeline{bus, amiro::catalogue, "drive", Timeline::Others::refused, cli::Confirm::no, {}};
  const bool begins = timeline.listen_first();
  REQUIRE(begins);
  timeline.carry_out(drive(lasting));
  static_cast<void>(timeline.wait_for_end());
  static_cast<void>(timeline.finish());
}

/// A drive of a second on such a bus, and whether it left.
bool drive_a_second(World& world, PlayedBus& bus) {
  try {
    drive_to_its_end(bus, 1s);
  } catch (const cli::Exit& exit) {
    CHECK(exit.code == 1);
    world.wait_until(world.now() + 100s);
    return true;
  }
  return false;
}

TEST_CASE("drive: a stop beyond the end of its time is one, too") {
  // It ends between two turns: what counts is the time since the last one.
  for (const Duration lasting : {300ms, 550ms, 600ms, 700ms, 5000ms}) {
    World world{1};
    PlayedBus bus{world, {}};
    world.stop(World::start + 700ms, lasting);  // 550 ms behind the first set point
    const Leaving left = leaving([&] { drive_to_its_end(bus, 700ms); });
    CAPTURE(lasting.count(), left.text);
    CHECK(left.code.has_value() == (lasting > watchdog));
    CHECK(cli::is_rest(bus.sent().back().frame));
    if (left.code) CHECK_THAT(left.text, Catch::Contains("drive: this program did not run for"));
  }
}

TEST_CASE("drive: a stop within it counts from the last turn before") {
  for (const Duration lasting : {430ms, 470ms}) {
    World world{1};
    PlayedBus bus{world, {}};
    world.stop(World::start + 700ms, lasting);  // some 50 ms behind a turn
    const Leaving left = leaving([&] { drive_to_its_end(bus, 2s); });
    CAPTURE(lasting.count(), left.text);
    CHECK(left.code.has_value() == (lasting > 450ms));
    CHECK(cli::is_rest(bus.sent().back().frame));
    if (left.code)
      CHECK_THAT(left.text, Catch::Contains(", so the drive has ended; the motors were set to zero\n"));
  }
}

TEST_CASE(
    "drive: set points for which the program was stopped are dropped, and the next keep their distance") {
  const Silence silence;
  World world{1};
  PlayedBus bus{world, {}};
  world.stop(World::start + 500ms, 250ms);
  drive_to_its_end(bus, 1500ms);
  const auto sent = after_question(bus.sent());
  REQUIRE(sent.size() > 10);
  std::size_t behind = 0;
  for (std::size_t i = 1; i + 1 < sent.size(); ++i) {
    const Duration distance = sent[i].taken - sent[i - 1].taken;
    REQUIRE(distance > client::hold_period - 2ms);
    if (distance > client::hold_period + 2ms) ++behind;
  }
  CHECK(behind == 1);
  CHECK(cli::is_rest(sent.back().frame));
}

TEST_CASE("drive: another program is heard, too, where its set points have come and were not looked at yet") {
  for (const auto others : {Timeline::Others::refused, Timeline::Others::allowed}) {
    World world{1};
    PlayedBus::Conditions conditions;
    conditions.incoming = {{World::start + 10ms, drive(1s).frames.front()}};
    PlayedBus bus{world, conditions};
    const Leaving left = leaving([&] {
      Timeline timeline{bus, amiro::catalogue, "drive", others, cli::Confirm::no, {}};
      world.wait_until(World::start + 100ms);  // it does not run
      timeline.carry_out(drive(1s));
    });
    const bool refused = others == Timeline::Others::refused;
    CHECK(left.code.has_value() == refused);
    CHECK(bus.sent().empty() == refused);
    if (refused) CHECK_THAT(left.text, Catch::Contains("1 set point within 150ms"));
  }
}

TEST_CASE("drive: of two that begin within the time in which neither hears the other both end") {
  const client::Command ours = drive(1s);
  can::Frame theirs = ours.frames.front();
  theirs.data[0] ^= 1;
  const Moment begin = World::start + client::listen_before_hold;
  for (const auto& [at, ends] :
       {std::pair{begin + 1ms, true}, std::pair{begin + 149ms, true}, std::pair{begin + 160ms, false}}) {
    for (const auto others : {Timeline::Others::refused, Timeline::Others::allowed}) {
      World world{1};
      PlayedBus::Conditions conditions;
      conditions.incoming = {{at, theirs}};
      PlayedBus bus{world, conditions};
      const Leaving left = leaving([&] {
        Timeline timeline{bus, amiro::catalogue, "drive", others, cli::Confirm::no, {}};
        world.wait_until(begin);
        timeline.carry_out(ours);
        const bool whole = timeline.wait_for_end();
        const bool taken = timeline.finish();
        CHECK((whole && taken));
      });
      INFO((at - begin).count() << " ns: " << left.text);
      CHECK(cli::is_rest(bus.sent().back().frame));
      if (ends && others == Timeline::Others::refused) {
        CHECK(left.code == cli::exit_failure);
        CHECK_THAT(left.text,
                   Catch::Contains("amiroctl: drive: another program began to command motors in the same "
                                   "moment: 201#"));
        CHECK_THAT(left.text, Catch::Contains("; the motors were set to zero\n"));
        CHECK(world.now() - at < 50ms);
      } else {
        CHECK_FALSE(left.code);
        CHECK_THAT(left.text, Catch::Contains("drive: another program commands motors, too: 201#"));
      }
    }
  }
}

TEST_CASE("drive: no set point follows a stop that came before it was due, whatever came before the stop") {
  const auto stop_at = World::start + 1s;
  World world{1};
  world.stop(stop_at, 120ms);
  PlayedBus::Conditions conditions;
  for (int each = 1; each <= 30; ++each)
    conditions.incoming.push_back({stop_at + each * 1ms, {.id = 0x123, .dlc = 8}});
  can::Frame zero = drive(0s).frames.front();
  zero.data = {};
  conditions.incoming.push_back({stop_at + 40ms, zero});
  PlayedBus bus{world, conditions};
  const Leaving left = leaving([&] {
    Timeline timeline{bus, amiro::catalogue, "drive", Timeline::Others::refused, cli::Confirm::no, {}};
    timeline.carry_out(drive(0s));
    static_cast<void>(timeline.wait_for_end());
  });
  CHECK(left.code == cli::exit_failure);
  CHECK_THAT(left.text, Catch::Contains("drive: another program has set the motors to zero"));
  REQUIRE(bus.sent().size() > 10);
  for (const auto& each : bus.sent()) CHECK((each.taken < stop_at || cli::is_rest(each.frame)));
  CHECK(cli::is_rest(bus.sent().back().frame));
}

TEST_CASE("drive: no set point follows a refusal of the motors that came before it was due") {
  const auto stop_at = World::start + 450ms;
  World world{1};
  world.stop(stop_at, 100ms);
  PlayedBus::Conditions conditions;
  conditions.incoming = {{stop_at + 1ms, {.id = 0x123, .dlc = 8}},
                         {stop_at + 2ms, {.id = 0x71D, .dlc = 8, .data = {0x01, 0x08, 0x01}}}};
  PlayedBus bus{world, conditions};
  const Leaving left = leaving([&] {
    Timeline timeline{bus, amiro::catalogue, "drive", Timeline::Others::refused, cli::Confirm::yes, {}};
    timeline.carry_out(drive(0s));
    static_cast<void>(timeline.wait_for_end());
  });
  CHECK(left.code == cli::exit_failure);
  CHECK_THAT(left.text, Catch::Contains("drive: di_wheel_drive refuses motors: not_served"));
  REQUIRE(bus.sent().size() > 4);
  for (const auto& each : bus.sent()) CHECK((each.taken < stop_at || cli::is_rest(each.frame)));
  CHECK(cli::is_rest(bus.sent().back().frame));
}

TEST_CASE("drive: where there is always a frame a set point goes after 10 ms all the same") {
  const Silence silence;
  const auto stop_at = World::start + 1050ms;
  const auto goes_on = stop_at + 100ms;
  World world{1};
  world.stop(stop_at, goes_on - stop_at);
  PlayedBus::Conditions conditions;
  conditions.incoming.assign(10'000, {stop_at + 1ms, {.id = 0x123, .dlc = 8}});  // 2 us and more each
  PlayedBus bus{world, conditions};
  Timeline timeline{bus, amiro::catalogue, "drive", Timeline::Others::refused, cli::Confirm::no, {}};
  timeline.carry_out(drive(0s));
  CHECK(timeline.wait(goes_on + 40ms));
  const auto& sent = bus.sent();
  const auto next =
      std::find_if(sent.begin(), sent.end(), [&](const auto& each) { return each.taken >= goes_on; });
  REQUIRE(next != sent.end());
  CHECK_FALSE(cli::is_rest(next->frame));
  CHECK(next->taken - goes_on >= 10ms);  // it looked at what had come
  CHECK(next->taken - goes_on < 10500us);
}

/// A bus from which no frame leaves for so long, from the beginning.
PlayedBus::Conditions stuck_for(Duration lasting) {
  PlayedBus::Conditions conditions;
  conditions.stuck = {{World::start, World::start + lasting}};
  return conditions;
}

TEST_CASE("drive: no set point waits behind the question what the boards do by themselves") {
  const Silence silence;
  for (const Duration lasting : {0ms, 150ms, 400ms, 600ms, 700ms, 2000ms}) {
    INFO("stuck for " << lasting.count() << " ns");
    World world{1};
    PlayedBus bus{world, stuck_for(lasting)};
    const bool left = drive_a_second(world, bus);
    const auto& sent = bus.sent();
    REQUIRE_FALSE(sent.empty());
    CHECK(sent.front().frame == question());
    // It asks 40 ms before it has listened for long enough, and gives up as a drive does.
    const bool too_long = lasting > client::listen_before_hold - 40ms + watchdog;
    CHECK(left == too_long);
    if (too_long) {
      CHECK(sent.size() == 1);
      continue;
    }
    REQUIRE(sent.size() > 2);
    CHECK(sent[1].frame == drive(1s).frames.front());
    CHECK(sent[1].taken >= sent[0].left + 40ms);  // in which a board answers
    CHECK(cli::is_rest(sent.back().frame));
  }
}

TEST_CASE("drive: it begins 40 ms after a question that was held up has left, or hardly later") {
  const Silence silence;
  for (Duration lasting = 300ms; lasting < 304ms; lasting += 200us) {
    INFO("stuck for " << lasting.count() << " ns");
    World world{1};
    PlayedBus bus{world, stuck_for(lasting)};
    CHECK_FALSE(drive_a_second(world, bus));
    const auto& sent = bus.sent();
    REQUIRE(sent.size() > 2);
    CHECK(sent[0].frame == question());
    CHECK(sent[1].taken - sent[0].left < 41ms + 200us);
  }
}

TEST_CASE("drive: while a question is held up it waits between two looks") {
  const Silence silence;
  int looks = 0;
  World world{1};
  world.beside = [&looks] { ++looks; };
  PlayedBus bus{world, stuck_for(400ms)};
  Timeline timeline{bus, amiro::catalogue, "drive", Timeline::Others::refused, cli::Confirm::no, {}};
  CHECK(timeline.listen_first());
  CHECK(world.now() - World::start >= 440ms);
  CHECK(looks < 10'000);  // some ten for each millisecond
}

TEST_CASE("run: where less than 40 ms are left to listen no board is asked: an answer takes that long") {
  const Silence silence;
  for (const auto& [left, asks] : {std::pair{39ms, false}, std::pair{40ms, true}, std::pair{100ms, true}}) {
    INFO(left.count() << " ms are left");
    World world{1};
    PlayedBus bus{world, {}};
    Timeline timeline{bus, amiro::catalogue, "run", Timeline::Others::refused, cli::Confirm::no, {}};
    CHECK(timeline.listen_first(left));
    const Duration listened = world.now() - World::start;
    CHECK(listened >= left);
    CHECK(listened < left + 2ms);
    CHECK(timeline.has_asked() == asks);
    CHECK(bus.sent().empty() != asks);
  }
}

TEST_CASE("drive: set points that come while the question is held up are as old as they are") {
  const Silence silence;
  can::Frame theirs = drive(1s).frames.front();
  theirs.data[0] ^= 1;
  // It begins at 440 ms, and looks back for 150 ms.
  for (const auto& [at, refused] : {std::pair{200ms, false}, std::pair{350ms, true}}) {
    INFO("at " << at.count() << " ms");
    World world{1};
    auto conditions = stuck_for(400ms);
    conditions.incoming = {{World::start + at, theirs}};
    PlayedBus bus{world, conditions};
    CHECK(drive_a_second(world, bus) == refused);
    CHECK((bus.sent().size() == 1) == refused);
  }
}

TEST_CASE("drive: a bus that has room a moment after the drive was given up gets the rest") {
  const Silence silence;
  // Set points at 150 and 250 ms; 500 ms behind the last it is given up.
  for (const Duration until : {700ms, 760ms, 800ms, 840ms, 900ms}) {
    INFO("down until " << until.count() << " ns");
    World world{1};
    PlayedBus::Conditions conditions;
    conditions.down = {{World::start + 300ms, World::start + until}};
    PlayedBus bus{world, conditions};
    CHECK(drive_a_second(world, bus) == (until > 700ms));
    CHECK(cli::is_rest(bus.sent().back().frame) == (until < 900ms));
  }
}

TEST_CASE("behave: no set point is given to a bus that has not sent the first one") {
  const Silence silence;
  World world{1};
  PlayedBus bus{world, stuck_for(60s)};
  Timeline timeline{bus, amiro::catalogue, "behave", Timeline::Others::allowed, cli::Confirm::no, {}};
  const auto& follow = *amiro::catalogue.find("follow");
  client::Command command;
  command.hold = client::Hold{
      client::set_point(follow, std::vector<std::int64_t>{1000}), client::set_point(follow, {}), {}};
  command.frames = {command.hold->frame};
  timeline.carry_out(command);
  CHECK_THROWS_AS(timeline.wait_for_end(), cli::Exit);
  CHECK(world.now() - World::start <
        client::longest_without_set_point + 1s + 50ms);  // 1 s for the rest to leave
  REQUIRE(bus.sent().size() == 2);
  CHECK(bus.sent()[0].frame == command.hold->frame);
  CHECK(cli::is_rest(bus.sent()[1].frame));
}

TEST_CASE("drive: a signal ends the wait for the question to leave") {
  const Silence silence;
  World world{1};
  PlayedBus bus{world, stuck_for(60s)};
  const Moment signal = World::start + client::listen_before_hold + 100ms;
  world.interrupt(signal, SIGINT);
  Timeline timeline{bus, amiro::catalogue, "drive", Timeline::Others::refused, cli::Confirm::no, {}};
  CHECK_FALSE(timeline.listen_first());
  CHECK(world.now() - signal < 5ms);
  CHECK(bus.sent().size() == 1);
}

TEST_CASE("drive: the answer to a question that left late is heeded") {
  const Silence silence;
  const cli::BehaviourSensor sensor{amiro::catalogue};
  const auto& topic = sensor.topic();
  const auto& layout = topic.frames[0];
  can::Frame answer{protocol::Identifier{protocol::Direction::sensor, topic.priority, layout.id}.encode(),
                    layout.dlc(),
                    {}};
  const auto& values = sensor.active().values;
  const auto travel =
      std::find_if(values.begin(), values.end(), [](const auto& value) { return value.name == "travel"; });
  REQUIRE(travel != values.end());
  for (const bool active : {false, true}) {
    INFO("active " << active);
    protocol::put(answer.data, sensor.active().position, active ? travel->raw : 0);
    World world{1};
    auto conditions = stuck_for(400ms);
    conditions.incoming = {{World::start + 430ms, answer}};
    PlayedBus bus{world, conditions};
    CHECK(drive_a_second(world, bus) == active);
    CHECK((bus.sent().size() == 1) == active);
  }
}

/// A command every 100 ms, as `run` carries out a script; the program is stopped, mostly while it sends.
void play_script(std::uint64_t seed) {
  World world{seed};
  PlayedBus bus{world, {}};
  const cli::words::CommandParser parser{amiro::catalogue};
  const std::vector<std::string_view> words{"led", "1", "red"};
  const auto command = parser.parse_line(words);
  REQUIRE(command.ok());
  Timeline timeline{bus, amiro::catalogue, "run", Timeline::Others::refused, cli::Confirm::no, {}};
  const Moment begin = world.now();
  const int step = world.between(1, 18);
  const Moment stopped = begin + step * 100ms + world.between(0us, world.chance(0.8) ? 6us : 100ms);
  // It would have slept until the next step.
  const Duration lasting = world.between(watchdog + 100ms, 10 * watchdog);
  world.stop(stopped, lasting);
  bool left = false;
  try {
    for (int i = 1; i <= 20 && timeline.wait_for_step(begin + i * 100ms); ++i) timeline.carry_out(*command);
    static_cast<void>(timeline.finish());
  } catch (const cli::Exit& exit) {
    left = true;
    CHECK(exit.code == 1);
  }
  INFO("step " << step << ", stopped at " << (stopped - begin).count() << " ns");
  CHECK(left);
  const auto& sent = bus.sent();
  CHECK(std::count_if(sent.begin(), sent.end(),
                      [&](const auto& each) { return each.taken >= stopped + lasting; }) <= 1);
}

TEST_CASE("drive: another frame just before a set point is due holds no set point up") {
  const Silence silence;
  for (const int microseconds : {0, 10, 50, 150, 240, 400, 1000}) {
    const Duration before = std::chrono::microseconds{microseconds};
    INFO(microseconds << " us before");
    World world{1};
    PlayedBus bus{world, {}};
    Timeline timeline{bus, amiro::catalogue, "run", Timeline::Others::refused, cli::Confirm::no, {}};
    const auto start = world.now();
    timeline.carry_out(drive(0s));
    const auto first = bus.sent().front().taken;
    const cli::words::CommandParser parser{amiro::catalogue};
    const std::vector<std::string_view> words{"led", "1", "red"};
    const auto led = parser.parse_line(words);
    REQUIRE(led.ok());
    for (int turn = 1; turn <= 20; ++turn) {
      REQUIRE(timeline.wait_for_step(first + turn * client::hold_period - before));
      timeline.carry_out(*led);
    }
    timeline.rest();
    Moment last = start;
    int set_points = 0;
    for (const auto& each : bus.sent()) {
      if (each.frame.id == led->frames.front().id) continue;
      CHECK(each.taken - last < client::hold_period + 2ms);
      last = each.taken;
      ++set_points;
    }
    CHECK(set_points > 20);
  }
}

TEST_CASE("drive: what is sent again and again beside it holds no set point up") {
  const Silence silence;
  World world{1};
  PlayedBus::Conditions conditions;
  conditions.frame_time = 8ms;  // one of them is always under way
  PlayedBus bus{world, conditions};
  Timeline timeline{bus, amiro::catalogue, "run", Timeline::Others::refused, cli::Confirm::no, {}};
  const cli::words::CommandParser parser{amiro::catalogue};
  const std::vector<std::string_view> words{"led", "1", "red"};
  auto led = parser.parse_line(words);
  REQUIRE(led.ok());
  led->repeat = client::Repeat{9ms, 2s};
  timeline.carry_out(*led);
  timeline.carry_out(drive(2s));
  CHECK(timeline.wait_for_end());
  CHECK(timeline.finish());
  Moment last = World::start;
  int set_points = 0, others = 0;
  for (const auto& each : bus.sent()) {
    if (each.frame.id == led->frames.front().id) {
      ++others;
      continue;
    }
    CHECK(each.taken - last < client::hold_period + conditions.frame_time);
    last = each.taken;
    ++set_points;
  }
  CHECK(set_points == 21);  // with the one of rest
  CHECK(others > 190);
}

TEST_CASE("set: after a stop nothing is sent behind the end of what is sent again and again") {
  struct Row {
    Duration stop, lasting;
    std::size_t sent;
    Duration end = 2s;
  };
  // Every 500 ms for 2 s: at 0, 0.5, 1 and 1.5 s.
  for (const Row& row : {Row{700ms, 6s, 2}, Row{700ms, 1s, 3}, Row{700ms, 1200ms, 3}, Row{700ms, 1400ms, 2},
                         Row{1600ms, 6s, 4}, Row{700ms, 200ms, 4}, Row{1400ms, 700ms, 3},
                         Row{1400ms, 700ms, 4, 2s + 1ns}}) {  // at 2 s, too
    INFO(row.stop.count() << ", " << row.lasting.count());
    const Silence silence;
    World world{1};
    PlayedBus bus{world, {}};
    Timeline timeline{bus, amiro::catalogue, "set", Timeline::Others::allowed, cli::Confirm::no, {}};
    const std::vector<std::string_view> words{"led", "1", "red"};
    auto led = cli::words::CommandParser{amiro::catalogue}.parse_line(words);
    REQUIRE(led.ok());
    led->repeat = client::Repeat{500ms, row.end};
    world.stop(world.now() + row.stop, row.lasting);
    timeline.carry_out(*led);
    CHECK(timeline.wait_for_end());
    CHECK(timeline.finish());
    CHECK(bus.sent().size() == row.sent);
  }
}

TEST_CASE("set: at its end what others send is handed on, but not the answer to its own question") {
  constexpr std::uint32_t gyroscope = 0x608, light_ring_status = 0x757;
  const std::vector<std::string_view> words{"led", "1", "red"};
  const auto led = cli::words::CommandParser{amiro::catalogue}.parse_line(words);
  REQUIRE(led.ok());
  PlayedBus::Conditions conditions;
  // While it listens for a refusal, and behind its question.
  conditions.incoming = {{World::start + 50ms, {.id = gyroscope, .dlc = 6}},
                         {World::start + 150ms, {.id = gyroscope, .dlc = 6}},
                         {World::start + 160ms, {.id = light_ring_status, .dlc = 8}}};
  for (const bool hands_on : {true, false}) {
    World world{1};
    PlayedBus bus{world, conditions};
    std::vector<std::uint32_t> heard;
    std::function<void(const can::Received&)> on_receive;
    if (hands_on) on_receive = [&](const can::Received& received) { heard.push_back(received.frame.id); };
    Timeline timeline{bus, amiro::catalogue, "set", Timeline::Others::allowed, cli::Confirm::yes, on_receive};
    timeline.carry_out(*led);
    CHECK(timeline.finish());
    CHECK((world.now() - World::start) / 1ms == 160);
    CHECK(heard == std::vector<std::uint32_t>(hands_on ? 2 : 0, gyroscope));
  }
}

/// What is said of a command that is carried out, to its end.
std::string said_of(const client::Command& command, PlayedBus::Conditions conditions,
                    std::optional<std::pair<Moment, Duration>> stop = {}) {
  World world{1};
  PlayedBus bus{world, std::move(conditions)};
  if (stop) world.stop(stop->first, stop->second);
  Captured said{STDERR_FILENO};
  try {
    Timeline timeline{bus, amiro::catalogue, "set", Timeline::Others::allowed, cli::Confirm::no, {}};
    timeline.carry_out(command);
    static_cast<void>(timeline.wait_for_end());
    static_cast<void>(timeline.finish());
  } catch (const cli::Exit& exit) {
    CHECK(exit.code == cli::exit_failure);
  }
  return said.text();
}

TEST_CASE("set: what was not sent is counted and said, with the reason") {
  const std::vector<std::string_view> words{"led", "1", "red"};
  auto led = cli::words::CommandParser{amiro::catalogue}.parse_line(words);
  REQUIRE(led.ok());
  led->repeat = client::Repeat{100ms, 1s};
  const auto stops = [&](Duration lasting) {
    return said_of(*led, {}, std::pair{World::start + 310ms, lasting});
  };
  CHECK(stops(10ms).empty());
  CHECK(stops(180ms).empty());  // of two turns neither is lost
  CHECK(stops(230ms) == "set: 1 frame was not sent, because this program ran too late for its time\n");
  CHECK(stops(5s) == "set: 6 frames were not sent, because this program ran too late for their time\n");
  const auto down = [&](Duration lasting) {
    return said_of(*led, {.down = {{World::start + 150ms, World::start + 150ms + lasting}}});
  };
  CHECK(down(30ms).empty());
  const std::string goes = "can0 went down; waiting for it to come back\n", comes = "can0 is up again\n";
  CHECK(down(100ms) == goes + comes + "set: 1 frame was not sent, because can0 had not taken those before\n");
  CHECK(down(300ms) ==
        goes + comes + "set: 3 frames were not sent, because can0 had not taken those before\n");
  CHECK(down(10s) ==
        goes +
            "set: 5 frames were not sent, because can0 had not taken those before\n"
            "amiroctl: set: can0 has taken no frame for 500ms: can0 is down\n          bring it up\n");
  const auto stuck = [&](Duration from, Duration lasting) {
    return said_of(drive(1s),
                   {.frame_time = 1ms, .stuck = {{World::start + from, World::start + from + lasting}}});
  };
  CHECK(stuck(150ms, 30ms).empty());
  CHECK(stuck(150ms, 200ms) == "set: 1 set point was not sent, because the one before had not left\n");
  CHECK(stuck(150ms, 300ms) == "set: 2 set points were not sent, because the one before had not left\n");
  const std::string
      five =
          "set: 5 set points were not sent, because the one before had not left\n"
          "amiroctl: set: no set point has left can0 for 500ms; ",
      remedy =
          "          no node acknowledges the frames: is a board powered and connected, and is the bit "
          "rate the same?\n";
  CHECK(stuck(150ms, 10s) == five + cli::still_moving + "\n" + remedy);
  CHECK(stuck(0ms, 10s) == five + "no set point has reached the robot\n" + remedy);
  // It is given up at 700 ms; the rest may leave within a second.
  CHECK(stuck(150ms, 850ms) == five + "the motors were set to zero\n" + remedy);
  CHECK(stuck(150ms, 1700ms) == five + cli::still_moving + "\n" + remedy);
}

TEST_CASE("drive: what ends it, a bus that is down or a queue that stays full, is said") {
  const std::vector<PlayedBus::Time> from_then_on{{World::start + 150ms, World::start + 60s}};
  const std::string moving = std::string{"; "} + cli::still_moving + "\n          ";
  const std::string down = said_of(drive(1s), {.down = from_then_on});
  CAPTURE(down);
  CHECK_THAT(down, Catch::Contains("amiroctl: set: no set point has left can0 for "));
  CHECK_THAT(down, Catch::EndsWith(": can0 is down" + moving + "bring it up\n"));
  const std::string full = said_of(drive(1s), {.room = 1, .knows_delivery = false, .stuck = from_then_on});
  CAPTURE(full);
  CHECK_THAT(full, Catch::Contains(" set points were not sent, because the one before had not left\n"
                                   "amiroctl: set: the transmit queue of can0 has been full for "));
  CHECK_THAT(full, Catch::EndsWith(
                       moving + "no node acknowledges the frames: is a board powered and connected, and is "
                                "the bit rate the same?\n"));
}

TEST_CASE("set, drive: what is to last for a nanosecond is over with its first frame") {
  const Silence silence;
  const std::vector<std::string_view> words{"led", "1", "red"};
  auto led = cli::words::CommandParser{amiro::catalogue}.parse_line(words);
  REQUIRE(led.ok());
  led->repeat = client::Repeat{100ms, 1ns};
  for (const client::Command& command : {*led, drive(1ns)}) {
    CAPTURE(command.hold.has_value());
    World world{1};
    world.interrupt(World::start + 1s, SIGINT);
    PlayedBus bus{world, {}};
    Timeline timeline{bus, amiro::catalogue, "set", Timeline::Others::allowed, cli::Confirm::no, {}};
    timeline.carry_out(command);
    CHECK(timeline.wait_for_end());
    CHECK(timeline.finish());
    CHECK(world.now() - World::start < 50ms);
    REQUIRE(bus.sent().size() == (command.hold ? 2 : 1));  // a drive ends with rest
    CHECK(bus.sent().front().frame == command.frames.front());
    CHECK(cli::is_rest(bus.sent().back().frame) == command.hold.has_value());
  }
  // Without a time it goes on until a signal.
  led->repeat = client::Repeat{100ms, {}};
  World world{1};
  world.interrupt(World::start + 1s, SIGINT);
  PlayedBus bus{world, {}};
  Timeline timeline{bus, amiro::catalogue, "set", Timeline::Others::allowed, cli::Confirm::no, {}};
  timeline.carry_out(*led);
  CHECK_FALSE(timeline.wait_for_end());
  CHECK(bus.sent().size() == 10);
}

TEST_CASE("run: a program that did not run for as long as a watchdog waits sends no further command") {
  const std::vector<std::string_view> words{"led", "1", "red"};
  const auto led = cli::words::CommandParser{amiro::catalogue}.parse_line(words);
  REQUIRE(led.ok());
  for (const Duration less : {0ns, 1ns}) {
    CAPTURE(less.count());
    World world{1};
    PlayedBus bus{world, {}};
    Timeline timeline{bus, amiro::catalogue, "run", Timeline::Others::allowed, cli::Confirm::no, {}};
    const Moment before = cli::Clock::now();
    const Duration look = cli::Clock::now() - before;  // what one takes
    timeline.forgive_a_stop();
    world.pass(watchdog - look - less);
    const Leaving left = leaving([&] { timeline.carry_out_once(*led); });
    const bool late = less == 0ns;
    CHECK(left.code.has_value() == late);
    CHECK(bus.sent().empty() == late);
    if (late)
      CHECK_THAT(left.text,
                 Catch::Contains("amiroctl: run: this program did not run for 500ms, so no further "
                                 "command is sent\n"));
  }
}

TEST_CASE("drive: of a script whose program was stopped, whenever that was, one step at most is late") {
  const auto runs = static_cast<std::uint64_t>(explored(2000));
  const Silence silence;
  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    INFO("seed " << seed);
    play_script(seed);
  }
}

}  // namespace tool_clock_command_test
