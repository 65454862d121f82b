/// Everything in which one mapper differs from another, as one value; and those of the two robots of the
/// thesis. A model is a constant: it lies in flash, and a robot only points to it.
///
/// [T2] the thesis on the FreeRTOS mapping robots (NTNU, 2016). It gives no size of its robots, no gains and
/// no tuning; what is marked [decided] is ours, and fits the robots that sim/mapper simulates.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "ocm/base/time.hpp"
#include "ocm/mapper/app/motors.hpp"
#include "ocm/mapper/link/format.hpp"
#include "ocm/mapper/link/sentence.hpp"
#include "ocm/motion/pose_controller.hpp"
#include "ocm/motion/pose_estimator.hpp"
#include "ocm/sensing/compass_calibration.hpp"
#include "ocm/sensing/ir_sensor.hpp"
#include "ocm/sensing/tower.hpp"

namespace ocm::mapper::app {

/// The tasks' periods. [T2 tables 9.2 and 9.3]
struct Periods {
  base::Duration estimator = std::chrono::milliseconds{30};
  base::Duration movement = std::chrono::milliseconds{20};
  base::Duration tower = std::chrono::milliseconds{200};
  base::Duration supervision = std::chrono::milliseconds{100};  ///< a part of communication [decided]
  /// Communication comes no more often than this, however fast lines come: a flooded line takes
  /// nothing from the tasks below. [decided]
  base::Duration communication_apart = std::chrono::milliseconds{20};
};

/// What happens when nothing does.
struct Times {
  base::Duration handshake = std::chrono::seconds{1};  ///< from one to the next [T2 §6.3]
  base::Duration idle =
      std::chrono::seconds{1};  ///< said again while it stands [T2 table 4.4: "an interval"]
  /// Motors stop when the pose controller has said nothing for so long. [decided]
  base::Duration command_lives = std::chrono::milliseconds{200};
  /// Without a link for so long the robot goes back the way it came; zero: it stays where it is. [T2 §17.1]
  base::Duration return_after{};
  base::Duration calibration_limit = std::chrono::seconds{60};  ///< a turn takes less, or fails [decided]
};

/// Of gyro and compass before the robot says who it is. [T2 §6.3]
struct Measuring {
  std::uint16_t samples = 64;  ///< at rest, one after the other: 2 s of estimator steps [decided]
  std::uint8_t failures = 10;  ///< in a row, and the part counts as missing: 0.3 s [decided]
  /// A gyro that shows more moves: above its bias (10 deg/s) [LSM6DS3 data sheet, zero-rate level] and below
  /// any turn that matters.
  float moving_rad_s = motion::radians(20.0F);
};

/// An offset belongs to one robot, not to its type: without one the compass would be wrong by tens of degrees
/// at some headings, so it does not correct until the robot has turned around for it. Then the parts keep the
/// offset. [T2 §5.2, §8.1]
struct CompassUse {
  bool calibrated = false;
  sensing::Field offset{};  ///< the robot's own field, in gauss
  /// Gauss: a field that is weaker has no direction. The earth's is 0.1 to 0.4, horizontally, but for the
  /// poles. [decided]
  float least_field = 0.05F;
  /// A calibration is good within that: what the estimator takes a compass away from steel for,
  /// EstimatorModel::compass_undisturbed_rad. [decided]
  float good_rad = motion::radians(3.0F);
  /// And useless beyond that: a circle that is wider by a third one way than the other. [decided]
  float most_rad = motion::radians(8.0F);
  float calibration_effort = 0.5F;  ///< of the turn
};

struct RobotModel {
  link::Handshake handshake{};  ///< without `formats`, which follows from `can_pack`
  bool can_pack = true;         ///< offers packed updates
  motion::EstimatorModel estimator{};
  motion::PoseControllerModel controller{};
  MotorModel motors{};
  sensing::SweepModel sweep{};
  sensing::IrCurve infrared = sensing::typical_ir_curve;
  std::int32_t minimum_distance_cm = 0;  ///< to what is ahead, see sensing::must_stop
  CompassUse compass{};
  Measuring measuring{};
  Periods periods{};
  Times times{};
};

namespace detail {

/// Where each sensor looks is where sensing::Tower has it.
inline constexpr link::Handshake usual_handshake{.width = 20,
                                                 .length = 20,
                                                 .axle_offset = 1,
                                                 .tower_offset = 3,
                                                 .sensor1 = 0,
                                                 .sensor2 = 90,
                                                 .sensor3 = 180,
                                                 .sensor4 = 270,
                                                 .deadline = 5000,
                                                 .sensor_out = 3};

inline constexpr motion::PidModel heading_pid{
    .kp = 2.0F, .ki = 0.2F, .kd = 0.05F, .derivative_filter_s = 0.05F, .derivative_of_reference = 1.0F};
inline constexpr motion::PidModel distance_pid{
    .kp = 5.0F, .ki = 0.2F, .kd = 0.1F, .derivative_filter_s = 0.05F, .derivative_of_reference = 1.0F};

}  // namespace detail

/// Motors that know on and off, an encoder of 198 ticks a turn and 66 ticks/s. [T2 §11.2.3; that the 198 are
/// its own is decided, spec/conflicts.md]
inline constexpr RobotModel avr_robot = [] {
  RobotModel model;
  model.handshake = detail::usual_handshake;
  const motion::Drive drive{.wheel_radius_m = 0.033F, .wheelbase_m = 0.15F, .ticks_per_turn = 198.0F};
  model.estimator.drive = drive;
  model.estimator.heading.gyro_weight = 0.75F;  // [T2 §7.3]
  model.estimator.heading.gyro_threshold_rad_s = motion::radians(0.5F);
  // A turn of 90 degrees takes 2 s and is off by a degree: floors are not alike everywhere. [decided]
  model.estimator.heading.gyro_variance_rad2_per_s = 2e-4F;
  model.estimator.heading.wheel_variance_rad2_per_s = motion::wheel_variance_rad2(drive);
  model.estimator.most_ticks = 66;               // of a second: a step is never as late as that
  model.estimator.compass_variance_rad2 = 0.5F;  // so that it takes seconds to correct [T2 §7.4; decided]
  // Steel turns a compass by more than it and the heading can be wrong by. [decided; docs/cognitive.md]
  model.estimator.compass_gate = 2.0F;
  model.controller.heading = detail::heading_pid;
  model.controller.distance = detail::distance_pid;
  model.controller.heading_tolerance_rad = motion::radians(2.0F);
  model.controller.distance_tolerance_m = 0.01F;
  model.motors = {.kind = MotorKind::gated, .most_ticks_s = 66.0F};
  model.minimum_distance_cm = 15;
  return model;
}();

/// Motors with PWM, geared down, 2475 ticks a turn and 1250 ticks/s. [T2 §11.2.1, §11.2.3]
inline constexpr RobotModel arduino_robot = [] {
  RobotModel model = avr_robot;
  model.handshake.axle_offset = 4;  // moved forwards by the gears [T2 §11.2.1; size decided]
  model.handshake.tower_offset = 0;
  const motion::Drive drive{.wheel_radius_m = 0.028F, .wheelbase_m = 0.15F, .ticks_per_turn = 2475.0F};
  model.estimator.drive = drive;
  model.estimator.heading.wheel_variance_rad2_per_s = motion::wheel_variance_rad2(drive);
  model.estimator.most_ticks = 1250;
  model.controller.heading_tolerance_rad = motion::radians(1.0F);
  model.motors.kind = MotorKind::paced;
  model.motors.most_ticks_s = 1250.0F;
  model.controller.distance.least = -0.8F;  // so that the weaker motor can still turn the robot
  model.controller.distance.most = 0.8F;
  model.motors.wheel_pi.pi = {.kp = 6e-4F, .ki = 8e-3F, .least = 0.0F, .most = 1.0F};
  model.motors.wheel_pi.starting_effort = 0.3F;
  return model;
}();

/// A robot of this type whose compass was calibrated: `offset` is what its turn found.
[[nodiscard]] constexpr RobotModel calibrated(RobotModel model, sensing::Field offset) noexcept {
  model.compass.calibrated = true;
  model.compass.offset = offset;
  return model;
}

/// A robot of this type whose wheels were calibrated: driven straight on for a measured way, they said
/// `said_per_m` metres for each one that it got on. Wheels slip, so they say too much. [T2 table 13.1] The
/// wheelbase goes with the radius: what they say of a turn, for which the gyro's weight was found, stays.
[[nodiscard]] constexpr RobotModel wheels_calibrated(RobotModel model, float said_per_m) noexcept {
  motion::Drive& drive = model.estimator.drive;
  drive.wheel_radius_m /= said_per_m;
  drive.wheelbase_m /= said_per_m;
  return model;
}

}  // namespace ocm::mapper::app
