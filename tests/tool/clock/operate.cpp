// The loop of `operate`, on a bus and a clock that are made of a seed: obstacles, silent boards, stops of the
// program, a wall clock that is set, a bus that is stuck, down, passive or away, boards that are reset and
// refuse, storms of frames, signals. It never commands motion by what it could know to be out of date, it
// stops in time, asks for streams that are silent, drives again once all is clear, and every end is at rest.
#include <algorithm>
#include <csignal>
#include <iterator>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <unistd.h>
#include <vector>

#include "ocm/can/error_frame.hpp"
#include "ocm/protocol/codec.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/operate/runner.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/set_points.hpp"
#include "cli/words/quantity.hpp"
#include "tests/tool/clock/played_bus.hpp"
#include "tests/unit/base/explore.hpp"

namespace tool_clock_operate_test {

using namespace ocm;
using namespace ocm::test;
namespace operate = cli::operate;

constexpr std::string_view file_text = R"({
  "name": "clock", "initial": "driving", "fall_back": "stopped",
  "settle": "60ms", "retry": "1s", "reaction": "5ms", "handling": "1ms",
  "configurations": [
    {"name": "driving", "streams": [{"topic": "ring", "period": "50ms", "priority": "high"}],
     "entry": [{"topic": "motors", "values": {"x": "0.05m/s", "z": "0rad/s"}, "repeat": "100ms"}]},
    {"name": "stopped", "streams": [{"topic": "ring", "period": "50ms", "priority": "high"}],
     "entry": [{"topic": "motors", "values": {"x": "0m/s", "z": "0rad/s"}, "priority": "urgent", "repeat": "100ms"}]}
  ],
  "monitors": [
    {"name": "obstacle", "when": {"any": ["ring.sensor_1>20000", {"age": "ring", "above": "250ms"}]}},
    {"name": "clear", "when": {"all": ["ring.sensor_1<10000", {"not": {"bus_state": "passive"}}]}, "for": "300ms"},
    {"name": "bad_bus", "when": {"bus_state": "passive"}}
  ],
  "transitions": [
    {"from": "driving", "to": "stopped", "when": "obstacle"},
    {"to": "stopped", "when": "bad_bus"},
    {"from": "stopped", "to": "driving", "when": "clear"}
  ]
})";

constexpr Duration lasting = 8s;
constexpr Duration oldest = 250ms;     // of a sample while it drives
constexpr Duration stale = 150ms;      // three periods of the ring
constexpr Duration cleared = 300ms;    // without an obstacle before it drives again
constexpr Duration drives_again = 1s;  // of all clear, and it does
constexpr Duration settle = 60ms;
constexpr Duration reaction = 5ms;
constexpr Duration repeat = 100ms;
constexpr Duration retry = 1s;

const protocol::Topic& ring() {
  return *amiro::catalogue.find("ring");
}

/// How often it had to drive again, and to ask for the ring, in all runs.
int drove_again = 0;
int asked_again = 0;

class Run {
 public:
  explicit Run(std::uint64_t seed) : world_(seed) {
    const auto sometime = [this] { return World::start + world_.between(0s, lasting); };
    while (world_.chance(0.3)) {
      calm_ = false;
      const auto stop = sometime();
      const Duration stopped = world_.between(1ms, world_.chance(0.2) ? 3s : 300ms);
      world_.stop(stop, stopped);
      stopped_ += stopped;
      if (world_.chance(0.3)) world_.set_wall_clock(stop + stopped / 2, world_.between(-3h, 3h));
    }
    while (world_.chance(0.2)) world_.set_wall_clock(sometime(), world_.between(-3s, 3s));
    world_.interrupt(World::start + lasting, SIGINT);
    // What the program prints; it comes from another thread.
    world_.disk = [this](int, std::string_view text) {
      const std::lock_guard lock{mutex_};
      printed_ += text;
      return cli::Written{};
    };
    make_robot();
  }

  void go() {
    const auto loaded = operate::parse(file_text, "clock.operator.json", amiro::catalogue, 1'000'000);
    REQUIRE(loaded.file);
    auto conditions = bus_conditions();
    std::sort(incoming_.begin(), incoming_.end(), [](const auto& a, const auto& b) { return a.at < b.at; });
    conditions.incoming = incoming_;
    PlayedBus bus{world_, conditions, "clock-test-" + std::to_string(::getpid())};
    const auto control = operate::Control::open(bus.name());
    REQUIRE(control);
    world_.inputs[(*control)->descriptor()] = [] { return Moment::max(); };
    bool left = false;
    cli::Over over{};
    {
      operate::Runner runner{bus, **control, amiro::catalogue, *loaded.file, options_};
      try {
        over = runner.run();
        ended_ = world_.now();
        if (over == cli::Over::signal) runner.rest();
      } catch (const cli::Exit&) {
        left = true;
      }
      runner.sum_up();
    }
    judge(bus, over, left);
  }

 private:
  void add_sample(Moment at, std::int64_t value) {
    for (const auto& layout : ring().frames) {
      can::Frame frame{
          protocol::Identifier{protocol::Direction::sensor, protocol::Priority::high, layout.id}.encode(),
          layout.dlc(),
          {}};
      for (const auto& field : layout.fields) protocol::put(frame.data, field.position, value);
      incoming_.push_back({at, frame});
      at += 120us;
    }
  }
  /// A board that says no to what was asked: it counts, and changes nothing here.
  void add_refusal(Moment at) {
    const auto& layout = amiro::catalogue.find("power_management_refusal")->frames[0];
    can::Frame frame{
        protocol::Identifier{protocol::Direction::sensor, protocol::Priority::low, layout.id}.encode(),
        layout.dlc(),
        {}};
    frame.data[0] = static_cast<std::uint8_t>(ring().id.value);
    frame.data[2] = 1;
    incoming_.push_back({at, frame});
  }
  /// Frames of another program, as many as a bus has.
  void add_storm(Moment from) {
    for (Moment at = from; at < from + 300ms; at += 130us)
      incoming_.push_back({at, can::Frame{.id = 0x7F0, .dlc = 8}});
  }
  /// Samples each 50 ms, with obstacles and times of silence.
  void make_robot() {
    Moment time = World::start + world_.between(0ms, 60ms);
    bool near = false;
    while (time < World::start + lasting) {
      if (world_.chance(0.01)) time += world_.between(0ms, 700ms);
      if (world_.chance(0.002)) time += world_.between(1s, 3s);  // a board that was reset, and starts slowly
      if (world_.chance(near ? 0.1 : 0.02)) near = !near;
      add_sample(time, near ? world_.between(20'001, 60'000) : world_.between(0, 9'999));
      (near ? near_ : far_).push_back(time + 120us * (static_cast<int>(ring().frames.size()) - 1));
      time += world_.between(45ms, 55ms);
    }
    while (world_.chance(0.2)) add_refusal(World::start + world_.between(0s, lasting));
    if (world_.chance(0.1)) add_storm(World::start + world_.between(0s, lasting));
    if (world_.chance(0.2)) {
      can::Frame frame{can::error_class::controller, can::max_dlc, {}, can::Format::error};
      frame.data[1] = can::controller_error::tx_passive;
      const Moment from = World::start + world_.between(0s, lasting);
      const Moment until = from + world_.between(10ms, 2s);
      incoming_.push_back({from, frame});
      frame.data[1] = can::controller_error::active;
      incoming_.push_back({until, frame});
      passive_ = {from, until};
    }
  }
  PlayedBus::Conditions bus_conditions() {
    PlayedBus::Conditions bus;
    bus.room = world_.between<std::size_t>(1, 10);
    bus.frame_time = world_.between(50us, 300us);
    const auto trouble = [&](std::vector<PlayedBus::Time>& list) {
      const Moment from = World::start + world_.between(0s, lasting);
      list.push_back({from, from + world_.between(1ms, world_.chance(0.3) ? 4s : 300ms)});
      calm_ = false;
    };
    if (world_.chance(0.2)) trouble(bus.stuck);
    if (world_.chance(0.2)) trouble(bus.down);
    trouble_ = bus.stuck;
    trouble_.insert(trouble_.end(), bus.down.begin(), bus.down.end());
    if (world_.chance(0.05)) bus.gone = World::start + world_.between(0s, lasting), calm_ = false;
    // An interface that was down starts again.
    for (const auto& time : bus.down)
      if (time.until > passive_.from)
        passive_.until = std::min(passive_.until, std::max(time.from, passive_.from));
    return bus;
  }

  void judge(PlayedBus& bus, cli::Over over, bool left) {
    const client::FrameIndex index{amiro::catalogue};
    std::vector<PlayedBus::Sent> motors;
    for (const auto& each : bus.sent())
      if (cli::commanded_motors(index, each.frame) != nullptr) motors.push_back(each);
    const PlayedBus::Sent* before = nullptr;
    std::optional<Moment> went;  // since it commands motion without a rest between
    for (const auto& each : motors) {
      if (cli::is_rest(each.frame)) {
        went.reset();
      } else {
        if (!went) went = each.taken;
        judge_motion(each.taken, *went);
      }
      if (calm_ && before != nullptr && each.taken - before->taken > repeat + reaction)
        FAIL_CHECK("nothing was commanded from " << at(before->taken) << " to " << at(each.taken));
      before = &each;
    }
    if (calm_)
      for (const Moment obstacle : near_) judge_stop(motors, obstacle);
    if (calm_)
      for (const Moment sample : far_) judge_motion_again(motors, sample);
    if (calm_) judge_asked(bus);
    judge_late();
    if (over == cli::Over::gone) CHECK(bus.conditions().gone <= ended_);
    if (over != cli::Over::signal) return;
    CHECK(ended_ >= World::start + lasting);
    // It leaves where it cannot bring the robot to rest, and says so.
    if (left) {
      CHECK_FALSE(calm_);
      return;
    }
    REQUIRE(!motors.empty());
    CHECK(cli::is_rest(motors.back().frame));
    if (calm_) CHECK(ended_ - (World::start + lasting) < 250ms);
    const std::lock_guard lock{mutex_};
    CHECK(printed_.find("has ended, everything that it commands is at rest") != std::string::npos);
  }

  /// A step is as late as the program was stopped, whatever the wall clock says.
  void judge_late() {
    constexpr std::string_view begins = "a step took ";
    const std::lock_guard lock{mutex_};
    const auto at = printed_.find(begins);
    if (at == std::string::npos) return;
    const std::string text = printed_.substr(at + begins.size());
    const auto late = cli::words::parse_duration(text.substr(0, text.find(',')));
    REQUIRE(late);
    CHECK(*late <= stopped_ + 100ms);
  }
  /// The program had the time to see at `time` what was there at `seen`.
  [[nodiscard]] bool knew(Moment seen, Moment time) const {
    constexpr Duration look = 2ms;
    return time > seen + look && !world_.was_stopped(time - look, time, Duration{1});
  }
  void judge_motion(Moment time, Moment went) {
    const auto last_of = [time](const std::vector<Moment>& samples) {
      const auto next = std::upper_bound(samples.begin(), samples.end(), time);
      return next == samples.begin() ? Moment{} : next[-1];
    };
    const Moment near = last_of(near_), far = last_of(far_);
    // One that is gone when the change to driving is over leads nowhere, nor one that is stale when it is
    // first looked at.
    const auto gone = std::upper_bound(far_.begin(), far_.end(), near);
    const auto stopped_at = [this](Moment moment) {
      return world_.was_stopped(moment, moment + Duration{1}, Duration{1});
    };
    const auto was_settling = [&] {
      return near >= went && near < went + settle &&
             (*gone < went + settle || world_.was_stopped(near, *gone, Duration{1}));
    };
    const bool was_passing =
        gone != far_.end() && *gone < time && (was_settling() || stopped_at(near + stale));
    // Nor is it over when the bus takes its command only now.
    const bool was_waiting = time < near + settle && in_trouble(near);
    if (near > time - cleared && !was_passing && !was_waiting && knew(near, time))
      FAIL_CHECK("it drives at " << at(time) << ", an obstacle was seen at " << at(near));
    const Moment heard = std::max({went, near, far});
    if (time - heard > oldest + 2ms && knew(heard, time))
      FAIL_CHECK("it drives at " << at(time) << ", blind since " << at(heard));
    if (passive_.has(time) && knew(passive_.from, time))
      FAIL_CHECK("it drives at " << at(time) << ", the bus is passive since " << at(passive_.from));
  }
  /// Behind an obstacle rest was commanded, or was before.
  void judge_stop(const std::vector<PlayedBus::Sent>& motors, Moment obstacle) {
    const Moment by = obstacle + settle + reaction;
    if (by > World::start + lasting) return;
    const auto gone = std::upper_bound(far_.begin(), far_.end(), obstacle);
    if (gone != far_.end() && *gone < obstacle + settle) return;  // before the last change was over
    const auto later = std::upper_bound(motors.begin(), motors.end(), by,
                                        [](Moment time, const auto& each) { return time < each.taken; });
    REQUIRE(later != motors.begin());
    if (!cli::is_rest(later[-1].frame))
      FAIL_CHECK("no rest by " << at(by) << ", an obstacle was seen at " << at(obstacle));
  }
  /// Once all has been clear for long enough, it drives again.
  void judge_motion_again(const std::vector<PlayedBus::Sent>& motors, Moment sample) {
    const Moment since = sample - drives_again;
    if (since < World::start || sample > World::start + lasting) return;
    if (passive_.from <= sample && passive_.until > since) return;
    const auto after = std::upper_bound(near_.begin(), near_.end(), since);
    if (after != near_.end() && *after <= sample) return;
    Moment heard = since;
    for (auto each = std::lower_bound(far_.begin(), far_.end(), since); each != far_.end() && *each <= sample;
         ++each) {
      if (*each - heard >= stale) return;
      heard = *each;
    }
    const auto later = std::upper_bound(motors.begin(), motors.end(), sample,
                                        [](Moment time, const auto& each) { return time < each.taken; });
    if (later == motors.begin() || cli::is_rest(later[-1].frame))
      FAIL_CHECK("it does not drive at " << at(sample) << ", although all is clear since " << at(since));
    ++drove_again;
  }
  /// A ring that is silent is asked for, after three periods and not sooner than `retry` after the last time.
  void judge_asked(PlayedBus& bus) {
    const auto request = protocol::publish_every(ring().id, 50ms, protocol::Priority::high);
    std::vector<Moment> asked, heard{World::start};
    for (const auto& each : bus.sent())
      if (each.frame == *request) asked.push_back(each.taken);
    std::merge(near_.begin(), near_.end(), far_.begin(), far_.end(), std::back_inserter(heard));
    heard.push_back(World::start + lasting);
    for (std::size_t i = 1; i < heard.size(); ++i) {
      // A change of configuration may be under way, and another follow it.
      constexpr Duration slack = 2 * settle + reaction + 5ms;
      Moment last = World::start;
      for (const Moment each : asked)
        if (each <= heard[i - 1] + stale) last = each;
      const Moment by = std::max(heard[i - 1] + stale, last + retry) + slack;
      if (heard[i] <= by || by > World::start + lasting) continue;
      ++asked_again;
      if (std::none_of(asked.begin(), asked.end(),
                       [&](Moment each) { return each > heard[i - 1] && each <= by; }))
        FAIL_CHECK("the ring is silent from " << at(heard[i - 1]) << " to " << at(heard[i])
                                              << ", and not asked for by " << at(by));
    }
    for (std::size_t i = 1; i < asked.size(); ++i)
      if (asked[i] - asked[i - 1] < retry - 2 * reaction)
        FAIL_CHECK("the ring is asked for at " << at(asked[i - 1]) << " and at " << at(asked[i]));
  }
  [[nodiscard]] bool in_trouble(Moment time) const {
    return std::any_of(trouble_.begin(), trouble_.end(),
                       [time](const PlayedBus::Time& each) { return each.has(time); });
  }
  static double at(Moment time) { return std::chrono::duration<double>(time - World::start).count(); }

  std::mutex mutex_;
  std::string printed_;
  Duration stopped_{};  ///< the sum
  World world_;
  operate::RunOptions options_{.json = false, .bit_rate = 1'000'000, .black_box = {}};
  std::vector<PlayedBus::Incoming> incoming_;
  std::vector<Moment> near_, far_;  ///< whole samples
  PlayedBus::Time passive_{Moment::max(), Moment::max()};
  std::vector<PlayedBus::Time> trouble_;  ///< none is sent
  bool calm_ = true;
  Moment ended_{};
};

/// What a run of a second prints in which an obstacle is seen just behind a step of the wall clock.
std::string printed_behind_a_step(Duration by) {
  World world{1};
  const Moment seen = World::start + 570ms;
  world.set_wall_clock(seen - 1us, by);
  world.interrupt(World::start + 1s, SIGINT);
  std::mutex mutex;
  std::string printed;
  world.disk = [&](int, std::string_view text) {
    const std::lock_guard lock{mutex};
    printed += text;
    return cli::Written{};
  };
  PlayedBus::Conditions conditions;
  // All frames of a sample at once: the wait before them is what its age could be.
  const auto sample = [&conditions](Moment at, std::int64_t value) {
    for (const auto& layout : ring().frames) {
      can::Frame frame{
          protocol::Identifier{protocol::Direction::sensor, protocol::Priority::high, layout.id}.encode(),
          layout.dlc(),
          {}};
      for (const auto& field : layout.fields) protocol::put(frame.data, field.position, value);
      conditions.incoming.push_back({at, frame});
    }
  };
  for (Duration at = 20ms; at < 570ms; at += 50ms) sample(World::start + at, 0);
  sample(seen, 60'000);
  const auto loaded = operate::parse(file_text, "clock.operator.json", amiro::catalogue, 1'000'000);
  REQUIRE(loaded.file);
  PlayedBus bus{world, conditions, "clock-step-" + std::to_string(::getpid())};
  const auto control = operate::Control::open(bus.name());
  REQUIRE(control);
  world.inputs[(*control)->descriptor()] = [] { return Moment::max(); };
  const operate::RunOptions options{.json = false, .bit_rate = 1'000'000, .black_box = {}};
  {
    operate::Runner runner{bus, **control, amiro::catalogue, *loaded.file, options};
    CHECK(runner.run() == cli::Over::signal);
    runner.rest();
    runner.sum_up();
  }
  const std::lock_guard lock{mutex};
  return printed;
}

TEST_CASE("operate: a wall clock that is corrected by 5 ms at most makes no sample older than it is") {
  const Silence silence;
  for (const Duration by : {2ms, -2ms, 5ms, -5ms})
    CHECK(printed_behind_a_step(by).find("a step took") == std::string::npos);
  for (const Duration by : {Duration{5ms + 1ns}, Duration{-5ms - 1ns}, Duration{8ms}, Duration{-8ms}})
    CHECK(printed_behind_a_step(by).find("a step took") != std::string::npos);
}

TEST_CASE("operate: whatever happens, it does not drive by what is out of date, and ends at rest") {
  const auto runs = static_cast<std::uint64_t>(explored(1000));
  const Silence silence;
  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    INFO("seed " << seed);
    Run{seed}.go();
  }
  CHECK(drove_again > 10 * static_cast<int>(runs));
  CHECK(asked_again > static_cast<int>(runs) / 20);
}

}  // namespace tool_clock_operate_test
