// Driving by a gamepad that is played, on a bus and a clock that are made of a seed: the robot moves only
// while the dead man's button is held, and rests when the pad is gone.
#include "cli/command/pad_drive.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

#include "cli/shared/messages.hpp"
#include "cli/shared/set_points.hpp"
#include "tests/tool/clock/played_bus.hpp"
#include "tests/tool/clock/question.hpp"
#include "tests/unit/base/explore.hpp"

namespace tool_clock_pad_drive_test {

using namespace ocm;
using namespace ocm::test;
using cli::PadDrive;
using cli::PadState;
using cli::Timeline;

/// Says what it is at each time; what is pressed for a moment is said once.
class PlayedPad final : public cli::Gamepad {
 public:
  explicit PlayedPad(World& world) : world_(&world) {}

  void at(Moment time, PadState state) { states_.push_back({time, state}); }
  std::optional<PadState> read() override {
    ++looks;
    PadState pressed;
    for (; next_ < states_.size() && states_[next_].first <= world_->now(); ++next_) {
      newest_ = states_[next_].second;
      pressed.stop = pressed.stop || newest_.stop;
      pressed.quit = pressed.quit || newest_.quit;
    }
    if (world_->now() >= gone) return std::nullopt;
    newest_.stop = pressed.stop;
    newest_.quit = pressed.quit;
    return newest_;
  }
  std::string name() const override { return "played"; }
  /// Whether the button was held at any time between these.
  [[nodiscard]] bool held_between(Moment from, Moment to) const {
    bool held = false;
    for (const auto& [time, state] : states_) {
      if (time <= from) held = state.dead_man;
      if (time > from && time <= to) held = held || state.dead_man;
    }
    return held;
  }

  Moment gone = Moment::max();
  int looks = 0;

 private:
  World* world_;
  std::vector<std::pair<Moment, PadState>> states_;
  std::size_t next_ = 0;
  PadState newest_{};
};

/// A pad on a bus that takes all; times are from the beginning.
struct Drive {
  explicit Drive(std::uint64_t seed = 1) : world(seed), pad(world), bus(world, {}) {
    world.interrupt(World::start + 60s, SIGINT);
  }
  void at(Duration time, PadState state) { pad.at(World::start + time, state); }

  PadDrive::End go(std::string_view forward = "10cm/s", std::string_view turning = "45deg/s") {
    const Silence silence;  // the board that is asked first is not there
    PadDrive drive{amiro::catalogue,
                   {},
                   *cli::words::KeySpeed::parse(forward),
                   *cli::words::KeySpeed::parse(turning),
                   [this](std::string_view text) { shown.emplace_back(text); }};
    Timeline timeline{bus, amiro::catalogue, "drive", Timeline::Others::refused, cli::Confirm::no, {}};
    REQUIRE(timeline.listen_first());
    const PadDrive::End end = drive.run(pad, timeline);
    // Without finish(), too.
    if (const auto driven = sent(); !driven.empty()) CHECK(cli::is_rest(driven.back().frame));
    static_cast<void>(timeline.finish());
    return end;
  }
  /// All that was sent once it drives.
  [[nodiscard]] std::vector<PlayedBus::Sent> sent() { return after_question(bus.sent()); }
  /// Set points that move, by the time at which they were sent.
  [[nodiscard]] std::vector<Duration> moving() {
    std::vector<Duration> times;
    for (const auto& each : sent())
      if (!cli::is_rest(each.frame)) times.push_back(each.taken - World::start);
    return times;
  }
  [[nodiscard]] static std::int32_t forward_um_s(const can::Frame& frame) {
    std::uint32_t raw = 0;
    for (unsigned i = 0; i < 4; ++i) raw |= std::uint32_t{frame.data[i]} << 8 * i;
    return static_cast<std::int32_t>(raw);
  }

  World world;
  PlayedPad pad;
  PlayedBus bus;
  std::vector<std::string> shown;
};

constexpr PadState let_go{};
constexpr PadState stick_only{.forward = 1};
constexpr PadState drives{.forward = 1, .dead_man = true};

TEST_CASE("drive by gamepad: only while a shoulder button is held") {
  Drive drive;
  drive.at(0s, stick_only);
  drive.at(2s, drives);
  drive.at(3s, stick_only);
  drive.at(4s, {.forward = -0.5, .left = 0.5, .dead_man = true});
  drive.at(5s, let_go);
  drive.at(6s, {.quit = true});
  CHECK(drive.go() == PadDrive::End::quit);
  const auto times = drive.moving();
  REQUIRE(times.size() >= 18);  // ten a second
  CHECK(times.front() >= 2s);
  CHECK(times.front() <= 2s + 25ms);
  for (const Duration time : times) {
    INFO(time.count());
    CHECK(((time >= 2s && time <= 3s + 25ms) || (time >= 4s && time <= 5s + 25ms)));
  }
  const auto sent = drive.sent();
  CHECK(drive.forward_um_s(sent.front().frame) == 100'000);
  CHECK(cli::is_rest(sent.back().frame));
  const auto rest =
      std::find_if(sent.begin(), sent.end(), [](const auto& each) { return cli::is_rest(each.frame); });
  CHECK(rest->taken - World::start >= 3s);
  CHECK(rest->taken - World::start <= 3s + 25ms);
  const auto half = std::find_if(sent.begin(), sent.end(),
                                 [](const auto& each) { return Drive::forward_um_s(each.frame) == -50'000; });
  CHECK(half != sent.end());
}

TEST_CASE(
    "drive by gamepad: a button that is held at the beginning, or after a stop, has to be released first") {
  Drive drive;
  drive.at(0s, drives);
  drive.at(2s, let_go);
  drive.at(3s, drives);
  drive.at(4s, {.forward = 1, .dead_man = true, .stop = true});
  drive.at(6s, let_go);
  drive.at(7s, drives);
  drive.at(8s, {.quit = true});
  CHECK(drive.go() == PadDrive::End::quit);
  for (const Duration time : drive.moving()) {
    INFO(time.count());
    CHECK(((time >= 3s && time <= 4s + 25ms) || (time >= 7s && time <= 8s + 25ms)));
  }
  CHECK(drive.moving().back() >= 7s);
  CHECK(std::count(drive.shown.begin(), drive.shown.end(), "rests: release the shoulder button first") == 2);
}

TEST_CASE("drive by gamepad: how fast it drives, or why it rests, is said whenever that changes") {
  Drive drive;
  drive.at(0s, drives);
  drive.at(1s, let_go);
  drive.at(2s, {.dead_man = true});
  drive.at(3s, {.forward = 0.5, .left = -1, .dead_man = true});
  drive.at(4s, drives);
  drive.at(5s, {.forward = 1, .dead_man = true, .stop = true});
  drive.at(6s, let_go);
  drive.at(7s, {.quit = true});
  CHECK(drive.go() == PadDrive::End::quit);
  CHECK(drive.shown == std::vector<std::string>{"rests: release the shoulder button first",
                                                "rests: hold a shoulder button to drive", "rests",
                                                "5cm/s -45deg/s", "10cm/s 0deg/s",
                                                "rests: release the shoulder button first",
                                                "rests: hold a shoulder button to drive"});
}

TEST_CASE("drive by gamepad: a pad that is gone stops the robot") {
  Drive drive;
  drive.at(0s, let_go);
  drive.at(1s, drives);
  drive.pad.gone = World::start + 3s;
  CHECK(drive.go() == PadDrive::End::gone);
  CHECK(drive.moving().back() <= 3s + 25ms);
  const auto& last = drive.bus.sent().back();
  CHECK(cli::is_rest(last.frame));
  CHECK(last.taken - World::start <= 3s + 25ms);
}

TEST_CASE("drive by gamepad: a signal stops the robot") {
  Drive drive;
  drive.at(0s, let_go);
  drive.at(1s, drives);
  drive.world.interrupt(World::start + 2s, SIGTERM);
  CHECK(drive.go() == PadDrive::End::signal);
  CHECK(drive.pad.looks >= 80);  // 50 a second, behind 150 ms in which it listens
  CHECK(drive.pad.looks <= 100);
  CHECK(cli::is_rest(drive.bus.sent().back().frame));
  CHECK(drive.moving().back() <= 2s + 25ms);
}

TEST_CASE("drive by gamepad: beyond the limits of the spec nothing begins") {
  Drive drive;
  CHECK_THROWS_AS(drive.go("2m/s"), cli::Exit);
  CHECK_THROWS_AS(drive.go("10cm/s", "1m/s"), cli::Exit);
  CHECK(drive.bus.sent().empty());
}

/// Whether it begins, at 10 cm/s and 1 rad/s, where a speed of the motors has another limit: x is 0, z is 1.
bool begins_where(std::size_t speed, std::int64_t protocol::Field::*limit, std::int64_t raw) {
  std::vector<protocol::Topic> topics{amiro::catalogue.topics.begin(), amiro::catalogue.topics.end()};
  const auto motors = std::find_if(topics.begin(), topics.end(), [](const protocol::Topic& topic) {
    return topic.role == protocol::Role::drive;
  });
  REQUIRE(motors != topics.end());
  std::vector<protocol::FrameLayout> frames{motors->frames.begin(), motors->frames.end()};
  std::vector<protocol::Field> fields{frames[0].fields.begin(), frames[0].fields.end()};
  fields[speed].*limit = raw;
  frames[0].fields = fields;
  motors->frames = frames;
  const protocol::Catalogue catalogue{amiro::catalogue.robot, amiro::catalogue.bit_rate,
                                      amiro::catalogue.boards, topics};
  const World world{1};
  const Silence silence;
  try {
    const PadDrive drive{catalogue,
                         {},
                         *cli::words::KeySpeed::parse("10cm/s"),
                         *cli::words::KeySpeed::parse("1rad/s"),
                         [](std::string_view) {}};
    return true;
  } catch (const cli::Exit&) {
    return false;
  }
}

TEST_CASE("drive by gamepad: beyond a limit of one direction nothing begins, either") {
  using protocol::Field;
  CHECK(begins_where(0, &Field::raw_max, 100'000));
  CHECK_FALSE(begins_where(0, &Field::raw_max, 99'999));
  CHECK(begins_where(0, &Field::raw_min, -100'000));
  CHECK_FALSE(begins_where(0, &Field::raw_min, -99'999));
  CHECK(begins_where(1, &Field::raw_max, 1'000'000));
  CHECK_FALSE(begins_where(1, &Field::raw_max, 999'999));
  CHECK(begins_where(1, &Field::raw_min, -1'000'000));
  CHECK_FALSE(begins_where(1, &Field::raw_min, -999'999));
}

TEST_CASE("drive by gamepad: whatever a person presses, a robot moves only while the button is held") {
  const auto runs = static_cast<std::uint64_t>(explored(200));
  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    INFO("seed " << seed);
    Drive drive{seed};
    Duration time = 0s;
    for (int i = 0; i < 40; ++i) {
      time += drive.world.between(1ms, 400ms);
      PadState state;
      state.forward =
          drive.world.chance(0.3) ? 0 : cli::deflection(drive.world.between(-100, 100), {-100, 100});
      state.left = drive.world.chance(0.3) ? 0 : cli::deflection(drive.world.between(-100, 100), {-100, 100});
      state.dead_man = drive.world.chance(0.6);
      state.stop = drive.world.chance(0.05);
      drive.at(time, state);
    }
    const bool goes = drive.world.chance(0.5);
    if (goes)
      drive.pad.gone = World::start + time + 1s;
    else
      drive.at(time + 1s, {.quit = true});
    CHECK(drive.go() == (goes ? PadDrive::End::gone : PadDrive::End::quit));
    const auto sent = drive.sent();
    for (const auto& each : sent)
      if (!cli::is_rest(each.frame)) CHECK(drive.pad.held_between(each.taken - 25ms, each.taken));
    if (!sent.empty()) CHECK(cli::is_rest(sent.back().frame));
  }
}

TEST_CASE("drive by gamepad: where a stick is") {
  using cli::deflection;
  CHECK(deflection(0, {-32768, 32767}) == 0);
  CHECK(deflection(-32768, {-32768, 32767}) == -1);
  CHECK(deflection(32767, {-32768, 32767}) == 1);
  CHECK(deflection(128, {0, 255}) == 0);
  CHECK(deflection(138, {0, 255}) == 0);  // within a tenth of the middle
  CHECK(deflection(0, {0, 255}) == -1);
  CHECK(deflection(192, {0, 255}) == Approx(0.45));  // in steps of a twentieth
  CHECK(deflection(500, {0, 255}) == 1);             // beyond what the device says
  CHECK(deflection(7, {0, 0}) == 0);
  for (const int value : {-1, 0, 1}) CHECK(deflection(value, {-1, 1}) == value);  // a cross
  for (const int value : {0, 1}) CHECK(deflection(value, {0, 1}) == 2 * value - 1);
  CHECK_FALSE(std::signbit(deflection(-1, {-100, 100})));
  const double hardly = deflection(-11, {-100, 100});  // beyond the middle, and no step from it
  CHECK(hardly == 0);
  CHECK_FALSE(std::signbit(hardly));
}

}  // namespace tool_clock_pad_drive_test
