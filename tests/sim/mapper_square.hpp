/// The square of thesis 2, table 13.1, driven by a mapper's whole application in virtual time, with all
/// that its estimator heard written down: so that other estimators can be asked what they make of the very
/// same drive. 15 ms and 0.7 MB a drive; an application that does not answer throws.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/mapper/app/locator.hpp"
#include "ocm/mapper/app/models.hpp"
#include "ocm/mapper/link/sentence_reader.hpp"
#include "ocm/motion/pose.hpp"

#include "sim/mapper/running_robot.hpp"
#include "sim/mapper/world.hpp"
#include "sim/physics/geometry.hpp"

namespace ocm::square {

using sim::degree;
using sim::Pose;
using sim::Vector;
using sim::mapper::RobotKind;
using sim::mapper::RunningRobot;
using sim::mapper::World;
using sim::mapper::WorldModel;

struct Leg {
  int degrees = 0;
  int centimetres = 0;
};
/// [T2 table 13.1]
inline constexpr std::array<Leg, 5> legs{{{0, 60}, {90, 130}, {90, 120}, {90, 130}, {85, 52}}};
/// Where a robot that obeys exactly is after this many of them, as seen from the start.
[[nodiscard]] inline Pose ideal_after(std::size_t count) {
  Pose pose;
  for (const Leg& leg : std::span{legs}.first(count)) {
    pose.heading_rad += leg.degrees * degree;
    const Vector place = pose.place_of({leg.centimetres / 100.0, 0});
    pose.x_m = place.x;
    pose.y_m = place.y;
  }
  return pose;
}
/// What the thesis's robot missed at the end of it. [the same, last row]
inline constexpr double most_x_m = 0.148;
inline constexpr double most_y_m = 0.062;
inline constexpr double most_heading_rad = 6.9 * degree;

/// sim/worlds/square.json.
[[nodiscard]] inline WorldModel open_room() {
  WorldModel model;
  model.name = "square";
  const Vector corners[] = {{-1.2, -0.6}, {1.2, -0.6}, {1.2, 1.9}, {-1.2, 1.9}};
  for (std::size_t i = 0; i < 4; ++i) model.walls.push_back({corners[i], corners[(i + 1) % 4]});
  model.central.place = {0, -0.5};
  model.starts = {{"AVR", RobotKind::avr, {}}};
  return model;
}

/// The same with steel in its floor: around the end of the second leg, and on the fourth leg; as strong as in
/// sim/worlds/labyrinth.json.
[[nodiscard]] inline WorldModel steel_on_the_way() {
  WorldModel model = open_room();
  model.anomalies = {{{0.6, 1.3}, 0.5, {0.08, -0.06}}, {{-0.6, 0.6}, 0.35, {-0.09, -0.03}}};
  return model;
}
/// The same with steel under the start, too: where the compass takes its zero.
[[nodiscard]] inline WorldModel steel_at_the_start() {
  WorldModel model = steel_on_the_way();
  model.anomalies.push_back({{0, 0}, 0.6, {-0.09, -0.03}});
  return model;
}

/// The pose `now` as seen from `start`, its heading within (-pi, pi].
[[nodiscard]] inline Pose relative(const Pose& now, const Pose& start) {
  const Vector way = now.position() - start.position();
  const Vector ahead = sim::direction(start.heading_rad);
  return {dot(ahead, way), cross(ahead, way),
          std::remainder(now.heading_rad - start.heading_rad, 2 * sim::pi)};
}
/// What an estimate says too much.
[[nodiscard]] inline Pose error(const motion::Pose& estimate, const Pose& truth) {
  return {static_cast<double>(estimate.x_m) - truth.x_m, static_cast<double>(estimate.y_m) - truth.y_m,
          std::remainder(static_cast<double>(estimate.heading_rad) - truth.heading_rad, 2 * sim::pi)};
}

/// A step of the estimator: what it heard, and what was true.
struct Step {
  base::Time time{};
  float dt_s = 0;
  mapper::app::Readings readings{};
  mapper::app::Activity activity{};
  bool zeroed_after = false;  ///< an operator confirmed: from here on the pose counts
  Pose truth{};               ///< in the world
  motion::Pose estimate{};    ///< the application's own
};

/// A link that loses nothing, to a server that listens for idle.
class Wire {
 public:
  [[nodiscard]] bool linked() const noexcept { return linked_; }
  [[nodiscard]] std::size_t write(std::span<const std::uint8_t> bytes, base::Time) noexcept {
    for (const std::uint8_t byte : bytes) {
      const mapper::link::Kind kind = reader_.feed(static_cast<char>(byte));
      idles_ += kind == mapper::link::Kind::idle ? 1U : 0U;
      handshakes_ += kind == mapper::link::Kind::handshake ? 1U : 0U;
    }
    return bytes.size();
  }
  void link(bool on) noexcept { linked_ = on; }
  [[nodiscard]] unsigned idles() const noexcept { return idles_; }
  [[nodiscard]] unsigned handshakes() const noexcept { return handshakes_; }

 private:
  mapper::link::Reader reader_{mapper::link::Direction::from_robot};
  bool linked_ = false;
  unsigned idles_ = 0;
  unsigned handshakes_ = 0;
};

/// The first robot of a world with its application, and its estimator's memory.
class Drive {
 public:
  using Application = RunningRobot<Wire>;

  /// Whose compass offset the application begins with.
  enum class Compass : std::uint8_t {
    calibrated,   ///< the robot's own, as after a turn around without noise
    as_in_model,  ///< the model's, or none: then the compass does not correct until the robot has turned
                  ///< around
  };

  Drive(WorldModel world, std::uint64_t seed, const mapper::app::RobotModel& model,
        Compass compass = Compass::calibrated)
      : world_(std::move(world), {.seed = seed}),
        model_(compass == Compass::calibrated ? mapper::app::calibrated(model, world_.robot(0).own_field())
                                              : model),
        robot_(world_.robot(0), wire_, world_.time(), model_),
        now_(world_.time()),
        next_step_(now_) {
    confirm();
  }
  Drive(const Drive&) = delete;
  Drive& operator=(const Drive&) = delete;

  void run(base::Duration time) { run_to(now_ + time); }
  /// One after the other, each when the one before is idle, and has been for so long.
  void square(base::Duration pause) {
    for (const Leg& leg : legs) {
      const unsigned idles = wire_.idles();
      say(std::string{"{U,"}
              .append(std::to_string(leg.degrees))
              .append(",")
              .append(std::to_string(leg.centimetres)) +
          "}\n");
      require([&] { return wire_.idles() > idles; }, std::chrono::minutes{2}, "not idle");
      idle_.push_back(relative(world_.robot(0).pose(), start_));
      run(pause);
    }
  }
  /// The link ends, and the next operator confirms the robot where it stands.
  void confirm_again() {
    wire_.link(false);
    robot_.link_changed(now_);
    confirm();
  }
  /// Around once for its compass.
  void calibrate() {
    say("{C,1}\n");
    run(std::chrono::milliseconds{100});
    require([this] { return robot_.application().state() == mapper::app::State::confirmed; },
            std::chrono::minutes{1}, "not around");
    run(std::chrono::seconds{20});
  }
  void say(std::string_view sentence) {
    robot_.receive({reinterpret_cast<const std::uint8_t*>(sentence.data()), sentence.size()}, now_);
  }
  /// Until it holds; std::runtime_error, if it does not in time.
  template <class Condition>
  void require(Condition holds, base::Duration limit, const char* otherwise) {
    for (const base::Time end = now_ + limit; !holds();) {
      if (now_ >= end) throw std::runtime_error{otherwise};
      run(std::chrono::milliseconds{10});
    }
  }

  [[nodiscard]] const std::vector<Step>& steps() const noexcept { return steps_; }
  [[nodiscard]] const mapper::app::RobotModel& model() const noexcept { return model_; }
  /// Where it was when it was confirmed.
  [[nodiscard]] const Pose& start() const noexcept { return start_; }
  /// Where it was when it said idle, as seen from the start.
  [[nodiscard]] const std::vector<Pose>& idle() const noexcept { return idle_; }
  [[nodiscard]] base::Time now() const noexcept { return now_; }
  [[nodiscard]] Application& robot() noexcept { return robot_; }
  [[nodiscard]] const World& world() const noexcept { return world_; }

 private:
  void confirm() {
    run(std::chrono::seconds{3});  // its sensors are measured
    const unsigned before = wire_.handshakes();
    wire_.link(true);
    robot_.link_changed(now_);
    require([&] { return wire_.handshakes() > before; }, std::chrono::seconds{5}, "no handshake");
    say("{S,CON}\n");
    require([this] { return robot_.application().state() == mapper::app::State::confirmed; },
            std::chrono::seconds{1}, "not confirmed");
    start_ = world_.robot(0).pose();
  }
  void run_to(base::Time until) {
    for (base::Time next = robot_.next_event(); next <= until; next = robot_.next_event()) pass(next);
    pass(until);
  }
  void pass(base::Time now) {
    now_ = std::max(now, now_);
    world_.advance_to(now_);
    const mapper::app::State before = robot_.application().state();
    robot_.advance_to(now_);
    if (now_ >= next_step_) remember(before);
    if (before == mapper::app::State::connected &&
        robot_.application().state() == mapper::app::State::confirmed)
      steps_.back().zeroed_after = true;
  }
  /// The estimator is the first to run at any moment, so its `state` is that of before.
  void remember(mapper::app::State state) {
    next_step_ += model_.periods.estimator;
    const auto& body = world_.robot(0);
    const mapper::app::Locator locator = robot_.application().locator();
    steps_.push_back({now_,
                      static_cast<float>(model_.periods.estimator.count()) * 1e-9F,
                      {body.ticks(), body.gyro(), body.field()},
                      {locator.movement(), !mapper::app::may_drive(state), false},
                      false,
                      body.pose(),
                      locator.estimate().pose});
  }

  World world_;
  mapper::app::RobotModel model_;
  Wire wire_;
  Application robot_;
  base::Time now_;
  base::Time next_step_;
  std::vector<Step> steps_;
  Pose start_{};
  std::vector<Pose> idle_;
};

/// The offset that this robot finds by turning around once, where it starts.
[[nodiscard]] inline base::Result<sensing::Field> offset_by_turning(const WorldModel& world,
                                                                    std::uint64_t seed,
                                                                    const mapper::app::RobotModel& model) {
  Drive turn{world, seed, model, Drive::Compass::as_in_model};
  turn.calibrate();
  const mapper::app::CompassReport found = turn.robot().application().compass();
  if (found.verdict != mapper::link::Calibration::good) return base::Error::not_sampled;
  return found.fit.offset;
}

/// An estimator that a drive can be replayed through.
struct Variant {
  const char* name;
  mapper::app::RobotModel model;
};
inline constexpr std::size_t variant_count = 5;
/// What each sensor adds, one after the other; `model` is that of a robot whose compass is calibrated.
[[nodiscard]] inline std::array<Variant, variant_count> variants(const mapper::app::RobotModel& model) {
  mapper::app::RobotModel gyro = model;
  gyro.compass.calibrated = false;
  mapper::app::RobotModel wheels = gyro;
  wheels.estimator.heading.gyro_weight = 0;
  mapper::app::RobotModel always = model;
  always.estimator.compass_rule = motion::CompassRule::always;
  always.estimator.compass_gate = 0;
  mapper::app::RobotModel second = model;
  second.estimator = motion::gyro_and_compass(second.estimator);
  return {{{"encoders", wheels},
           {"encoders, gyro", gyro},
           {"encoders, gyro, compass always", always},
           {"encoders, gyro, compass where trusted", model},
           {"gyro, compass always", second}}};
}

/// What an estimator makes of a drive, step by step: `seen(step, pose)`.
template <class Seen>
void replay(const std::vector<Step>& steps, const mapper::app::RobotModel& model, Seen seen) {
  mapper::app::Locator locator{model};
  for (const Step& step : steps) {
    locator.step(step.readings, step.activity, step.dt_s);
    seen(step, locator.estimate().pose);
    if (step.zeroed_after) locator.begin_at_zero();
  }
}

// --- the least that any estimator must miss ---

/// Standard deviations at the end of a drive.
struct Floor {
  double x_m = 0;
  double y_m = 0;
  double heading_rad = 0;
};

/// Position: wheels slip from place to place by a share that no sensor sees on a straight way. The estimator
/// is given the true heading, what the wheels slip in the mean, their true sizes, and ticks without a gap.
[[nodiscard]] inline Vector position_floor_m(const Drive& drive) {
  const sim::mapper::SlipModel& slip = drive.world().robot(0).model().slip;
  const double unseen =
      slip.straight * slip.variation * slip.friction / drive.world().model().friction / (1 + slip.straight);
  Vector variance_m2{};
  Vector before = drive.start().position();
  double since_s = 0;
  for (const Step& step : drive.steps()) {
    since_s += static_cast<double>(step.dt_s);
    if (since_s < slip.variation_s && &step != &drive.steps().back()) continue;
    const Vector way = (step.truth.position() - before) * unseen;
    variance_m2 = variance_m2 + Vector{way.x * way.x, way.y * way.y};
    before = step.truth.position();
    since_s = 0;
  }
  return {std::sqrt(variance_m2.x), std::sqrt(variance_m2.y)};
}

/// Heading: noise of compass and gyro. The estimator is given perfect wheels where the robot stands or drives
/// straight, the gyro's bias and what it says too little, the compass's offset, and a field without steel.
/// What remains is linear with normal noise; the best there is for that is the Kalman filter of heading and
/// north with the noises' true variances. (What wheels tell of a turn is left out: they slip by a degree that
/// is not seen, fifteen times the gyro's noise.)
[[nodiscard]] inline double heading_floor_rad(const Drive& drive) {
  const sim::mapper::RobotModel& robot = drive.world().robot(0).model();
  const double digit = 1 / robot.compass.counts_per_gauss;
  const double field = drive.world().model().field_gauss;
  const double compass =
      (robot.compass.noise_gauss * robot.compass.noise_gauss + digit * digit / 12) / (field * field);
  // Variances of heading and of north, and what they have in common. The heading is known at the start.
  double heading = 0, north = sim::pi * sim::pi, both = 0;
  for (const Step& step : drive.steps()) {
    const double gyro = robot.gyro.driving_noise_deg_per_s * degree * static_cast<double>(step.dt_s);
    if (step.activity.movement == motion::Movement::rotating) heading += gyro * gyro;
    const double seen = heading + 2 * both + north + compass;  // the compass sees their sum
    const double of_heading = heading + both, of_north = north + both;
    heading -= of_heading * of_heading / seen;
    north -= of_north * of_north / seen;
    both -= of_heading * of_north / seen;
  }
  return std::sqrt(heading);
}

/// What the best of all estimators must miss with these sensors, because none of them tells it. All that it
/// is given besides only lowers the floor.
[[nodiscard]] inline Floor floor_of(const Drive& drive) {
  const Vector position = position_floor_m(drive);
  return {position.x, position.y, heading_floor_rad(drive)};
}

// --- many drives ---

/// What one drive came to.
struct Outcome {
  std::array<Pose, variant_count> error{};  ///< of each variant, at the end
  Pose own{};                               ///< the application's own
  Floor floor{};
};

[[nodiscard]] inline Outcome outcome_of(const Drive& drive) {
  Outcome outcome;
  const Pose truth = relative(drive.steps().back().truth, drive.start());
  outcome.own = error(drive.steps().back().estimate, truth);
  outcome.floor = floor_of(drive);
  const auto all = variants(drive.model());
  for (std::size_t i = 0; i < variant_count; ++i)
    replay(drive.steps(), all[i].model,
           [&](const Step&, const motion::Pose& pose) { outcome.error[i] = error(pose, truth); });
  return outcome;
}

/// `part` 0.5: the median of their sizes; of no values: 0.
[[nodiscard]] inline double quantile(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  for (double& value : values) value = std::abs(value);
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1) + 0.5)];
}
/// Of something of each outcome.
template <class Of>
[[nodiscard]] double quantile(const std::vector<Outcome>& outcomes, double part, Of of) {
  std::vector<double> values;
  values.reserve(outcomes.size());
  for (const Outcome& outcome : outcomes) values.push_back(of(outcome));
  return quantile(std::move(values), part);
}

}  // namespace ocm::square
