/// A mapper on parts that obey exactly, in virtual time, for the tests of this floor: no noise,
/// no slip, an empty floor with a wall where a test puts one.
#pragma once

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/mapper/app/models.hpp"
#include "ocm/mapper/app/parts.hpp"
#include "ocm/mapper/app/robot.hpp"
#include "ocm/mapper/link/sentence_reader.hpp"
#include "ocm/mapper/link/sentences.hpp"
#include "ocm/motion/pose.hpp"
#include "ocm/scheduling/cooperative.hpp"

namespace app_testing {

using namespace ocm;
using namespace std::chrono_literals;
using mapper::app::RobotModel;
using mapper::app::State;

/// The speed of a wheel at an effort, as a share of the greatest: motors that know on and off, or all
/// between.
inline float speed_share(float effort, bool on_off) {
  if (!on_off) return effort;
  return std::fabs(effort) < 0.395F ? 0.0F : effort > 0.0F ? 1.0F : -1.0F;
}

class IdealParts {
 public:
  explicit IdealParts(const RobotModel& model)
      : geometry(model.estimator.drive),
        on_off(model.motors.kind == mapper::app::MotorKind::gated),
        full_rad_s(motion::two_pi * model.motors.most_ticks_s / model.estimator.drive.ticks_per_turn) {}

  // As parts
  mapper::app::WheelTicks ticks() {
    if (on_ticks) on_ticks();
    return {counted(left_ticks), counted(right_ticks)};
  }
  base::Result<float> gyro() {
    if (gyro_missing) return base::Error::no_answer;
    return twist.turn_rad_s + gyro_bias;
  }
  base::Result<sensing::Field> field() {
    if (compass_missing) return base::Error::no_answer;
    const float angle = north_rad - pose.heading_rad;
    return sensing::Field{earth * (1 + soft_iron) * std::cos(angle) + own_field.x,
                          earth * std::sin(angle) + own_field.y};
  }
  base::Result<float> infrared(std::size_t sensor) {
    if (on_infrared) on_infrared();
    if (infrared_missing[sensor]) return base::Error::not_sampled;
    return sensing::ir_volts(distance_cm(sensor));
  }
  void drive(motion::Efforts wanted) {
    efforts = wanted;
    ++drives;
  }
  void turn_tower(std::int32_t degrees) {
    servo_deg = degrees;
    towers.push_back(degrees);
  }
  void show(mapper::app::Lights wanted) { lights = wanted; }
  bool linked() const { return link; }
  std::size_t send(std::span<const std::uint8_t> bytes) {
    if (on_send) on_send(bytes);
    const std::size_t taken = bytes.size() < room ? bytes.size() : room;
    sent.append(reinterpret_cast<const char*>(bytes.data()), taken);
    return taken;
  }

  void store(const sensing::CompassFit& fit) {
    ++stores;
    if (!memory_missing) memory = fit;
  }
  base::Result<sensing::CompassFit> stored() { return memory; }

  /// What happens in a millisecond.
  void step() {
    constexpr float dt_s = 0.001F;
    const float share = dt_s / (lag_s + dt_s);
    const float most = full_rad_s;
    wheels.left_rad_s +=
        share * (most * speed_share(efforts.left, on_off) * left_strength - wheels.left_rad_s);
    wheels.right_rad_s += share * (most * speed_share(efforts.right, on_off) - wheels.right_rad_s);
    const float per_tick = motion::two_pi / geometry.ticks_per_turn;
    left_ticks += static_cast<double>(wheels.left_rad_s * dt_s / per_tick);
    right_ticks += static_cast<double>(wheels.right_rad_s * dt_s / per_tick);
    twist = motion::twist(wheels, geometry);
    pose = motion::moved(pose, {twist.speed_m_s * dt_s, twist.turn_rad_s * dt_s});
  }
  [[nodiscard]] bool still() const {
    return std::fabs(wheels.left_rad_s) + std::fabs(wheels.right_rad_s) < 0.01F;
  }

  motion::Drive geometry;
  bool on_off;
  float full_rad_s;
  float lag_s = 0.03F;
  float left_strength = 1.0F;
  motion::Pose pose{};
  motion::Twist twist{};
  motion::WheelSpeeds wheels{};
  double left_ticks = 0.0;
  double right_ticks = 0.0;
  motion::Efforts efforts{};
  int drives = 0;
  std::int32_t servo_deg = -1;
  std::vector<std::int32_t> towers;
  mapper::app::Lights lights{};
  bool link = false;
  bool gyro_missing = false;
  bool compass_missing = false;
  std::array<bool, 4> infrared_missing{};
  float gyro_bias = 0.03F;
  float north_rad = 1.1F;
  sensing::Field own_field{};
  float soft_iron = 0.0F;  ///< what the field is stronger ahead, as a part of it
  float earth = 0.2F;
  base::Result<sensing::CompassFit> memory{base::Error::not_sampled};  ///< outlives a robot
  bool memory_missing = false;
  int stores = 0;
  std::function<void()> on_ticks;  ///< an interrupt in the middle of a job
  std::function<void()> on_infrared;
  std::function<void(std::span<const std::uint8_t>)> on_send;
  std::string sent;
  std::size_t room = 10'000;
  /// What a sensor sees, by where it looks in the world; cm.
  std::function<float(float)> distance = [](float) { return 200.0F; };

 private:
  static std::uint32_t counted(double ticks) {
    return static_cast<std::uint32_t>(static_cast<std::int64_t>(std::floor(ticks)));
  }
  float distance_cm(std::size_t sensor) {
    const float looks = static_cast<float>(servo_deg) + 90.0F * static_cast<float>(sensor);
    return distance(motion::wrap(pose.heading_rad + motion::radians(looks)));
  }
};
static_assert(mapper::app::RobotParts<IdealParts>);

/// A system with one processor whose levels preempt each other, between any two critical sections: `between`
/// is what happens there.
class Preemptive {
 public:
  class [[nodiscard]] Guard {
   public:
    explicit Guard(Preemptive& port) : port_(&port) { REQUIRE_FALSE(std::exchange(port_->locked_, true)); }
    ~Guard() {
      port_->locked_ = false;
      if (port_->between) port_->between();
    }
    Guard(const Guard&) = delete;
    Guard& operator=(const Guard&) = delete;

   private:
    Preemptive* port_;
  };

  [[nodiscard]] base::Time now() const { return cooperative_.now(); }
  void arm(base::Time when) { cooperative_.arm(when); }
  void pend(scheduling::Level level) { cooperative_.pend(level); }
  Guard lock() { return Guard{*this}; }

  void advance(base::Time now) { cooperative_.advance(now); }
  [[nodiscard]] base::Time armed() const { return cooperative_.armed(); }
  /// Only one that is more urgent than what runs.
  [[nodiscard]] bool take_pended(scheduling::Level& level) {
    if (!cooperative_.take_pended(level)) return false;
    if (static_cast<std::size_t>(level) < running) return true;
    cooperative_.pend(level);
    return false;
  }

  std::size_t running = scheduling::level_count;  ///< none
  std::function<void()> between;

 private:
  scheduling::Cooperative cooperative_;
  bool locked_ = false;
};
static_assert(scheduling::Port<Preemptive>);

/// A robot, and the world's clock.
template <class Port>
struct BasicBench {
  explicit BasicBench(const RobotModel& given = mapper::app::avr_robot)
      : model(given), parts(model), robot(parts, port, model) {
    robot.start();
  }

  void step() {
    now += 1ms;
    parts.step();
    port.advance(now);
    work();
    if (each_step) each_step();
  }
  /// All that is due.
  void work() {
    if (port.armed() <= now) robot.expire();
    for (scheduling::Level level; port.take_pended(level);) {
      if constexpr (requires { port.running; }) {
        const auto outer = std::exchange(port.running, static_cast<std::size_t>(level));
        robot.run(level);
        port.running = outer;
      } else {
        robot.run(level);
      }
    }
  }
  void run_for(base::Duration time) {
    for (const base::Time end = now + time; now < end;) step();
  }
  /// Until it is so; false: not within `most`.
  template <class F>
  bool run_until(F so, base::Duration most = 60s) {
    for (const base::Time end = now + most; now < end && !so();) step();
    return so();
  }
  void say(std::string_view text) {
    for (const char c : text) robot.receive(static_cast<std::uint8_t>(c));
  }
  void link(bool up) {
    parts.link = up;
    robot.link_changed();
  }
  /// What it said since it was asked last.
  std::string heard() { return std::exchange(parts.sent, {}); }
  int heard(std::string_view text) const {
    int count = 0;
    for (auto at = parts.sent.find(text); at != std::string::npos; at = parts.sent.find(text, at + 1))
      ++count;
    return count;
  }
  bool is(State state) const { return robot.state() == state; }
  /// From power on to an operator's word.
  void confirm() {
    run_for(3s);
    link(true);
    run_for(200ms);
    say("{S,CON}\n");
    run_for(50ms);
    REQUIRE(is(State::confirmed));
    parts.sent.clear();
  }
  /// Says it, and 21 ms later communication has heard it: in the middle of a job of a lower level.
  /// `least`: the least urgent level that runs meanwhile.
  void preempt(std::string_view text, scheduling::Level least = scheduling::Level::high) {
    say(text);
    for (int i = 0; i < 21; ++i) parts.step();
    port.advance(now += 21ms);
    robot.expire();
    for (const auto level : {scheduling::Level::urgent, scheduling::Level::high, scheduling::Level::medium})
      if (level <= least) robot.run(level);
  }
  /// Says it, and waits until it has ended.
  bool drive(std::string_view sentence, base::Duration most = 120s) {
    say(sentence);
    run_for(25ms);
    return run_until([this] { return !robot.busy(); }, most);
  }

  RobotModel model;
  IdealParts parts;
  Port port;
  mapper::app::Robot<IdealParts, Port> robot;
  base::Time now{};
  std::function<void()> each_step;
};
using Bench = BasicBench<scheduling::Cooperative>;

/// Of the robot of `Bench`.
inline const std::string handshake = "{H,20,20,1,3,0,90,180,270,5000,20225,3}\n";
inline constexpr mapper::app::Lights green{.green = true};
inline constexpr mapper::app::Lights yellow{.yellow = true};
inline constexpr mapper::app::Lights both{.green = true, .yellow = true};

/// What the robot said that is an update, in text.
inline std::vector<mapper::link::Update> updates(std::string_view said) {
  mapper::link::Reader reader{mapper::link::Direction::from_robot};
  std::vector<mapper::link::Update> result;
  for (const char c : said)
    if (reader.feed(c) == mapper::link::Kind::update)
      result.push_back(*reader.sentence().as<mapper::link::Update>());
  CHECK(reader.faults().total() == 0);
  return result;
}

}  // namespace app_testing
