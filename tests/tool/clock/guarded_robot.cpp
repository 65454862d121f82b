// examples/guard.operator.json on the simulated robot, in virtual time, while a program drives it as fast and
// as badly as it may: it never touches a wall. Frames, steps and set points are as late as the proof takes
// them to be.
#include <algorithm>
#include <array>
#include <deque>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/client/sample.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/operate/operator_file.hpp"
#include "cli/operate/study.hpp"
#include "sim/amiro/robot.hpp"
#include "tests/unit/base/explore.hpp"

namespace tool_clock_guarded_robot_test {

using namespace ocm;
using namespace std::chrono_literals;
namespace operate = cli::operate;
using reflective::Event;

constexpr base::Duration until_it_acts = 6ms;  // `reaction`, and the set point's frame

struct Port {
  base::Result<bool> send(const can::Frame& frame) {
    frames->push_back(frame);
    return true;
  }
  std::vector<can::Frame>* frames;
};

const operate::OperatorFile& guard() {
  static const auto loaded = operate::load(std::string{OCM_SOURCE_DIR} + "/examples/guard.operator.json",
                                           amiro::catalogue, amiro::bit_rate);
  if (!loaded.file) throw std::runtime_error{"the example has a mistake"};
  return *loaded.file;
}
std::uint16_t configuration(std::string_view name) {
  const auto& all = guard().configurations;
  return static_cast<std::uint16_t>(
      std::find_if(all.begin(), all.end(), [&](const auto& each) { return each.name == name; }) -
      all.begin());
}

/// From the release of the ring's sample on, on its board and on the bus, as late as the proof takes it to
/// be.
base::Duration until_it_is_seen() {
  static const base::Duration longest = [] {
    const auto study = operate::study(guard(), amiro::bit_rate);
    for (const auto& stream : study.configurations[configuration("driving")].streams)
      if (stream.topic == reflective::topic_index(amiro::catalogue, "proximity_ring") && stream.on_board > 0)
        return base::Duration{stream.response};
    throw std::runtime_error{"the ring has no bound"};
  }();
  return longest;
}

/// A robot somewhere between walls and boxes, its operator, and a program that drives.
class Run {
 public:
  Run(unsigned seed, bool guarded)
      : chance_(seed), guarded_(guarded), robot_(world(seed), port_, port_, port_) {}

  void go() {
    hand_over(supervisor_.start(now_));
    ask_ = configuration("driving");
    for (const base::Time end = now_ + 40s; now_ < end && !touched && !stays_stopped(); now_ += 1ms) {
      deliver();
      if (now_ >= supervisor_.next()) step({});
      if (ask_ != reflective::none && now_ > base::Time{100ms}) {
        step({.kind = Event::Kind::request, .value = ask_});
        ask_ = reflective::none;
      }
      if (now_ >= drives_at_) drive();
      robot_.advance(now_);
      for (const auto& frame : sent_) to_operator_.push_back({now_ + until_it_is_seen(), frame});
      sent_.clear();
      touched = touched || robot_.world().touching();
      const auto& at = robot_.world().pose();
      went = std::max(went, sim::length(at.position() - from_.position()));
    }
    stopped = stays_stopped();
    at_rest = robot_.world().wheels().left == 0 && robot_.world().wheels().right == 0;
  }

  bool touched = false;
  bool stopped = false;
  bool at_rest = false;
  double went = 0;  ///< m

 private:
  struct Delayed {
    base::Time at;
    can::Frame frame;
  };
  double between(double low, double high) { return std::uniform_real_distribution<>{low, high}(chance_); }

  sim::WorldOptions world(unsigned seed) {
    sim::WorldOptions options;
    options.seed = seed;
    for (int box = 0; box < 3; ++box) {
      const sim::Vector low{between(-1.1, 1.0), between(-0.7, 0.6)};
      sim::add_rectangle(options.arena.walls, low, {low.x + between(0.01, 0.3), low.y + between(0.01, 0.3)});
    }
    const auto is_free = [&](sim::Vector place) {
      return std::none_of(options.arena.walls.begin(), options.arena.walls.end(),
                          [&](const sim::Segment& wall) {
                            return sim::length(sim::nearest_point(wall, place) - place) < 0.15;
                          });
    };
    sim::Vector place{};
    do place = {between(-1.1, 1.1), between(-0.7, 0.7)};
    while (!is_free(place));
    options.start = {place.x, place.y, between(-sim::pi, sim::pi)};
    from_ = options.start;
    return options;
  }

  void step(const Event& event) { hand_over(supervisor_.step(event, now_)); }
  void hand_over(reflective::Supervisor<operate::room>::Actions actions) {
    for (const auto& action : actions) {
      if (action.kind == reflective::Action::Kind::switched && action.to == configuration("stopped"))
        since_ = now_;
      if (action.sends()) to_robot_.push_back({now_ + until_it_acts, action.frame});
    }
  }
  void deliver() {
    for (; !to_operator_.empty() && to_operator_.front().at <= now_; to_operator_.pop_front()) {
      const auto reception = receiver_.take(can::FrameView{to_operator_.front().frame}, now_);
      if (reception.meaning != client::Meaning::sample) continue;
      const auto topic = static_cast<std::uint16_t>(reception.topic - amiro::catalogue.topics.data());
      static constexpr std::array<std::uint8_t, 64> nothing{};
      const auto bytes = reception.sample.bytes;
      step({.kind = Event::Kind::sample,
            .topic = topic,
            .bytes = guarded_ ? bytes : std::span<const std::uint8_t>{nothing}.first(bytes.size())});
    }
    for (; !to_robot_.empty() && to_robot_.front().at <= now_; to_robot_.pop_front())
      robot_.receive(to_robot_.front().frame, now_);
  }
  /// As `drive` and `run` do it, with anything that motors take, mostly ahead.
  void drive() {
    drives_at_ = now_ + 100ms;
    if (now_ >= turns_at_) {
      turns_at_ = now_ + std::chrono::milliseconds{static_cast<int>(between(200, 3000))};
      x_ = between(0, 1) < 0.2 ? between(-1, 1) : 1;
      z_ = between(0, 1) < 0.4 ? 0 : between(-2, 2);
    }
    const auto& commanders = guard().parts[supervisor_.configuration()].commanders;
    if (supervisor_.configuration() == configuration("idle") || (commanders && commanders->empty())) return;
    const std::uint16_t motors = reflective::topic_index(amiro::catalogue, "motors");
    std::int64_t raw[] = {static_cast<std::int64_t>(x_ * 1e6), static_cast<std::int64_t>(z_ * 1e6)};
    supervisor_.permit(motors, raw, now_);
    to_robot_.push_back({now_ + until_it_acts, reflective::Supervisor<operate::room>::frame_of(
                                                   guard().tables, {.topic = motors, .raw = raw})});
  }
  [[nodiscard]] bool stays_stopped() const {
    return supervisor_.configuration() == configuration("stopped") && now_ > since_ + 2s;
  }

  std::mt19937 chance_;
  bool guarded_;
  sim::Pose from_{};
  std::vector<can::Frame> sent_;
  Port port_{&sent_};
  sim::SimulatedRobot<Port> robot_;
  reflective::Supervisor<operate::room> supervisor_{guard().tables};
  client::Receiver receiver_{amiro::catalogue};
  std::deque<Delayed> to_operator_, to_robot_;
  base::Time now_{}, since_{}, drives_at_{}, turns_at_{};
  std::uint16_t ask_ = reflective::none;
  double x_ = 1, z_ = 0;
};

TEST_CASE("operate: a robot that the example guards never touches a wall") {
  const auto runs = static_cast<unsigned>(ocm::test::at_full_speed ? 1000 : ocm::test::explored(300));
  unsigned stopped = 0, drove = 0;
  for (unsigned seed = 1; seed <= runs; ++seed) {
    INFO("seed " << seed);
    Run run{seed, true};
    run.go();
    CHECK_FALSE(run.touched);
    if (run.stopped) CHECK(run.at_rest);
    stopped += run.stopped ? 1 : 0;
    drove += run.went > 0.1 ? 1 : 0;
  }
  CHECK(stopped > runs / 2);
  CHECK(drove > runs / 2);
}

TEST_CASE("operate: without what the sensors see the same driver touches walls") {
  const unsigned runs = ocm::test::sanitized ? 4 : 20;
  unsigned touched = 0;
  for (unsigned seed = 1; seed <= runs; ++seed) {
    Run run{seed, false};
    run.go();
    touched += run.touched ? 1 : 0;
  }
  CHECK(touched > runs / 2);
}

}  // namespace tool_clock_guarded_robot_test
