/// One mapper in its world: a body on two wheels, a tower of distance sensors, a gyro and a compass. It
/// has what ocm::mapper::app::RobotParts asks of wheels, sensors and lights; parts.hpp adds the link.
///
/// World moves it, in steps of 1 ms. What a sensor reads depends on the seed, on the commands with their
/// times and on the time of reading: on nothing else, so reading does not disturb. A part delivers something
/// new once in its period; in between it repeats itself.
///
/// Host only. A step of a moving robot costs about 0.2 us.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/mapper/app/parts.hpp"
#include "ocm/motion/limits.hpp"
#include "ocm/sensing/compass_calibration.hpp"

#include "sim/mapper/robot_model.hpp"
#include "sim/mapper/sensors.hpp"
#include "sim/mapper/servo.hpp"
#include "sim/mapper/wheel.hpp"
#include "sim/mapper/world_model.hpp"
#include "sim/physics/body.hpp"

namespace ocm::sim::mapper {

/// What can be taken out of a robot, or break.
enum class Part : std::uint8_t { gyro, compass, infrared };
inline constexpr std::size_t part_count = 3;

/// What is around a robot while it moves.
struct Surroundings {
  const WorldModel& world;
  std::span<const Disc> robots;  ///< all of them
  std::size_t self = 0;          ///< which of them it is
  double fastest_step_m = 0;     ///< no robot gets on by more in a step
};

/// Where a sensor of the tower looks, and how far it is to what is there: infinite where nothing is.
struct Look {
  Vector from{};  ///< its face
  Vector ray{};   ///< of length 1
  double distance_m = 0;
};

class Robot {
 public:
  Robot(const Start& start, const RobotModel& model, std::uint64_t seed, std::size_t number)
      : model_(model),
        seed_(split_mix(seed, number)),
        name_(start.name),
        left_(model.motor, body_noise().constant(0)),
        right_(model.motor, body_noise().constant(1)),
        servo_(model.servo),
        left_m_per_tick_(model.drive.m_per_tick() * (1 + radius_error(2))),
        right_m_per_tick_(model.drive.m_per_tick() * (1 + radius_error(3))),
        wheelbase_m_(model.drive.wheelbase_m *
                     (1 + model.wheel_errors.wheelbase_spread * body_noise().constant(4))),
        pose_(start.pose) {}

  // --- what its application does to it ---

  /// Each motor, [-1, 1]; 0 is off.
  void drive(motion::Efforts efforts) noexcept {
    left_.drive(efforts.left);
    right_.drive(efforts.right);
  }
  /// [0, 90] degrees.
  void turn_tower(std::int32_t degrees) noexcept { servo_.turn(degrees); }
  void show(ocm::mapper::app::Lights lights) noexcept { lights_ = lights; }
  /// Into a memory that needs no power: it outlives the application.
  void store(const sensing::CompassFit& fit) noexcept { memory_ = fit; }

  // --- what its parts deliver; Error::not_sampled when they are absent ---

  [[nodiscard]] ocm::mapper::app::WheelTicks ticks() const noexcept {
    return {left_.ticks(), right_.ticks()};
  }
  /// rad/s, left positive, with its bias.
  [[nodiscard]] base::Result<float> gyro() const noexcept {
    if (absent(Part::gyro)) return base::Error::not_sampled;
    return gyro_reading(model_.gyro, noise(Part::gyro), gyro_);
  }
  /// Gauss, x ahead, y left, with the robot's own magnetism.
  [[nodiscard]] base::Result<sensing::Field> field() const noexcept {
    if (absent(Part::compass)) return base::Error::not_sampled;
    return compass_reading(model_.compass, noise(Part::compass), compass_);
  }
  /// Volts of sensor 0 to 3, in the order of sensing::TowerSensor; others: Error::out_of_range.
  [[nodiscard]] base::Result<float> infrared(std::size_t sensor) const noexcept {
    if (sensor >= sensing::tower_sensors) return base::Error::out_of_range;
    if (absent(Part::infrared)) return base::Error::not_sampled;
    return infrared_reading(model_.infrared, noise(Part::infrared), infrared_, sensor);
  }

  [[nodiscard]] base::Result<sensing::CompassFit> stored() const noexcept { return memory_; }

  // --- what others do to it ---

  /// An absent part delivers no sample until it is put back.
  void set_absent(Part part, bool absent) noexcept { absent_[index(part)] = absent; }

  // --- what an onlooker sees ---

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] const RobotModel& model() const noexcept { return model_; }
  /// Of the middle of the axle, in the world; the heading is not wrapped.
  [[nodiscard]] const Pose& pose() const noexcept { return pose_; }
  [[nodiscard]] Disc disc() const noexcept {
    return {pose_.place_of({model_.body.centre_ahead_m, 0}), model_.body.radius_m};
  }
  [[nodiscard]] double turn_rad_per_s() const noexcept { return turn_rad_per_s_; }
  [[nodiscard]] double tower_deg() const noexcept { return servo_.angle_deg(); }
  [[nodiscard]] ocm::mapper::app::Lights lights() const noexcept { return lights_; }
  [[nodiscard]] const Wheel& left() const noexcept { return left_; }
  [[nodiscard]] const Wheel& right() const noexcept { return right_; }
  /// Of the rims, slip apart.
  [[nodiscard]] double left_m_per_s() const noexcept { return left_.ticks_per_s() * left_m_per_tick_; }
  [[nodiscard]] double right_m_per_s() const noexcept { return right_.ticks_per_s() * right_m_per_tick_; }
  /// @param sensor 0 to 3. Where it looks now; the distance is that of its newest sample
  [[nodiscard]] Look look(std::size_t sensor) const noexcept {
    Look now = aim(sensor);
    now.distance_m = infrared_.distance_m[sensor];
    return now;
  }
  /// It pushes against a wall or another robot.
  [[nodiscard]] bool touching() const noexcept { return touching_; }
  /// Its own magnetism: what a calibration of its compass would find.
  [[nodiscard]] sensing::Field own_field() const noexcept {
    const Vector field = sim::mapper::own_field(model_.compass, noise(Part::compass));
    return {static_cast<float>(field.x), static_cast<float>(field.y)};
  }
  /// Metres that its wheels say for each one that it gets on, on the floor of its model: what driving a
  /// measured way would find.
  [[nodiscard]] float wheels_say_per_m() const noexcept {
    const double believed = model_.drive.m_per_tick();
    const double true_m = (left_m_per_tick_ + right_m_per_tick_) / 2;
    return static_cast<float>(believed / true_m * (1 + model_.slip.straight));
  }

  // --- for the world ---

  /// Nothing of it moves, and nothing will until the next command: steps change nothing.
  [[nodiscard]] bool at_rest() const noexcept {
    return left_.at_rest() && right_.at_rest() && turn_rad_per_s_ == 0 && servo_.at_rest();
  }

  /// One step, from the `step`th millisecond to the next.
  void move(const Surroundings& around, std::int64_t step) noexcept {
    const bool unhindered = unhindered_steps_ > 0;
    if (unhindered) --unhindered_steps_;  // also at rest: others come nearer
    servo_.step();
    const double left_m = left_.step() * left_m_per_tick_;
    const double right_m = right_.step() * right_m_per_tick_;
    if (left_m == 0 && right_m == 0) {
      turn_rad_per_s_ = 0;
      return;
    }
    const double slip = slip_factor(around.world.friction, step);
    const double turn = (right_m - left_m) / wheelbase_m_ / (1 + model_.slip.turning * slip);
    const double ahead = (left_m + right_m) / 2 / (1 + model_.slip.straight * slip);
    const Pose before = pose_;
    pose_ = arc(before, ahead, turn);
    turn_rad_per_s_ = turn / step_s;
    touching_ = false;
    if (!unhindered) stay_outside(around, before);
  }

  /// Each sensor with a new sample since the last step takes it now.
  void sample(const Surroundings& around, base::Duration elapsed) noexcept {
    const auto due = [elapsed](base::Duration period, std::uint64_t& number) {
      const auto now = static_cast<std::uint64_t>(elapsed / period);
      return now == number ? false : (number = now, true);
    };
    if (due(model_.gyro.period, gyro_.number)) {
      gyro_.turn_rad_per_s = turn_rad_per_s_;
      gyro_.driving = left_.powered() || right_.powered();
    }
    if (due(model_.compass.period, compass_.number)) look_at_field(around);
    if (due(model_.infrared.period, infrared_.number)) look_around(around);
  }

  /// The samples that the parts have when the world begins.
  void begin(const Surroundings& around) noexcept {
    look_at_field(around);
    look_around(around);
  }

  /// The middle of its disc gets on by no more in a step.
  [[nodiscard]] double most_step_m() const noexcept {
    const double wheels = model_.motor.full_ticks_per_s * std::max(left_m_per_tick_, right_m_per_tick_);
    return wheels * (1 + 2 * std::abs(model_.body.centre_ahead_m) / wheelbase_m_) * step_s;
  }

 private:
  static constexpr std::uint64_t body_stream = part_count;

  [[nodiscard]] static constexpr std::size_t index(Part part) noexcept {
    return static_cast<std::size_t>(part);
  }
  [[nodiscard]] bool absent(Part part) const noexcept { return absent_[index(part)]; }
  [[nodiscard]] Noise noise(Part part) const noexcept { return {seed_, index(part)}; }
  [[nodiscard]] Noise body_noise() const noexcept { return {seed_, body_stream}; }
  [[nodiscard]] double radius_error(std::uint8_t channel) const noexcept {
    return model_.wheel_errors.radius_spread * body_noise().constant(channel);
  }

  /// How much more or less than the model's figures the wheels slip now.
  [[nodiscard]] double slip_factor(double friction, std::int64_t step) noexcept {
    const double places = static_cast<double>(step) * step_s / model_.slip.variation_s;
    const double varied = 1 + model_.slip.variation * slow_noise(body_noise(), places, 5);
    return std::max(0.0, varied) * model_.slip.friction / friction;
  }

  void stay_outside(const Surroundings& around, const Pose& before) noexcept {
    const Disc wanted = disc();
    const Vector was = before.place_of({model_.body.centre_ahead_m, 0});
    Vector centre = wanted.centre;
    touching_ = keep_out(centre, was, [&](Vector at) {
      Push push = push_out(around.world.walls, at, wanted.radius_m);
      for (std::size_t i = 0; i < around.robots.size(); ++i)
        if (i != around.self)
          push.consider(at, around.robots[i].centre, wanted.radius_m + around.robots[i].radius_m);
      return push;
    });
    pose_.x_m += centre.x - wanted.centre.x;
    pose_.y_m += centre.y - wanted.centre.y;
    if (!touching_) unhindered_steps_ = steps_to_anything(around, centre);
  }

  /// How many steps it takes at least until something can be touched, others coming towards it.
  [[nodiscard]] int steps_to_anything(const Surroundings& around, Vector centre) const noexcept {
    constexpr double far = 2;  // there is no use in looking farther
    double wall = far * far;   // squares, so that one root is enough
    for (const Segment& segment : around.world.walls) {
      const Vector off = centre - nearest_point(segment, centre);
      wall = std::min(wall, dot(off, off));
    }
    double room = std::sqrt(wall);
    for (std::size_t i = 0; i < around.robots.size(); ++i) {
      if (i == around.self) continue;
      const Vector off = centre - around.robots[i].centre;
      const double reach = room + around.robots[i].radius_m;
      if (dot(off, off) < reach * reach) room = length(off) - around.robots[i].radius_m;
    }
    room -= model_.body.radius_m;
    return std::max(0, static_cast<int>(room / (2 * around.fastest_step_m)) - 1);
  }

  void look_at_field(const Surroundings& around) noexcept {
    compass_.field_gauss = around.world.field_at(pose_.position());
    compass_.heading_rad = pose_.heading_rad;
  }

  [[nodiscard]] Look aim(std::size_t sensor) const noexcept {
    const Vector axis = pose_.place_of({model_.tower.ahead_of_axle_m, 0});
    const Vector ray = direction(pose_.heading_rad +
                                 (model_.tower.sensor_heading_deg[sensor] + servo_.angle_deg()) * degree);
    return {axis + ray * model_.tower.sensor_out_m[sensor], ray};
  }

  void look_around(const Surroundings& around) noexcept {
    for (std::size_t i = 0; i < sensing::tower_sensors; ++i) {
      const Look at = aim(i);
      double nearest = std::numeric_limits<double>::infinity();
      for (const Segment& wall : around.world.walls)
        nearest = std::min(nearest, distance_along(at.from, at.ray, wall));
      for (std::size_t other = 0; other < around.robots.size(); ++other)
        if (other != around.self)
          nearest = std::min(nearest, distance_along(at.from, at.ray, around.robots[other]));
      infrared_.distance_m[i] = nearest;
    }
  }

  RobotModel model_;
  std::uint64_t seed_;
  std::string name_;
  Wheel left_;
  Wheel right_;
  Servo servo_;
  double left_m_per_tick_;
  double right_m_per_tick_;
  double wheelbase_m_;
  Pose pose_;
  double turn_rad_per_s_ = 0;
  int unhindered_steps_ = 0;
  bool touching_ = false;
  ocm::mapper::app::Lights lights_{};
  base::Result<sensing::CompassFit> memory_{base::Error::not_sampled};
  std::array<bool, part_count> absent_{};
  GyroSample gyro_{};
  CompassSample compass_{};
  InfraredSample infrared_{};
};

}  // namespace ocm::sim::mapper
