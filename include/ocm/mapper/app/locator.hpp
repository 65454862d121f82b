/// Where a mapper is: the estimator of `motion`, with what it needs to know first, the gyro's bias and
/// where the compass has its zero, and with the calibration of the compass. [T2 §6.3, §7.4, §8.1]
///
/// One step a reading, O(1): 30-odd float operations, a sine, a cosine and an arc tangent; 380 bytes, no
/// heap, no clock. A part that does not answer is counted and left out of the step.
#pragma once

#include <cstdint>
#include <limits>

#include "ocm/base/result.hpp"
#include "ocm/mapper/app/compass.hpp"
#include "ocm/mapper/app/measuring.hpp"
#include "ocm/mapper/app/models.hpp"
#include "ocm/mapper/app/parts.hpp"
#include "ocm/motion/angle.hpp"
#include "ocm/motion/pose_estimator.hpp"
#include "ocm/sensing/compass_calibration.hpp"

namespace ocm::mapper::app {

struct Readings {
  WheelTicks ticks{};
  base::Result<float> gyro{};
  base::Result<sensing::Field> field{};
};

/// What the robot is about while it is located.
struct Activity {
  motion::Movement movement = motion::Movement::standing;  ///< what the motors were set to
  bool at_rest = true;  ///< they are off until an operator confirms: time to measure
  bool calibrating = false;
};

class Locator {
 public:
  constexpr explicit Locator(const RobotModel& model) noexcept
      : model_(&model),
        measurement_(model.measuring),
        offset_(model.compass.offset),
        calibrated_(model.compass.calibrated) {}

  void step(const Readings& readings, const Activity& activity, float dt_s) noexcept {
    gyro_failed_ += readings.gyro ? 0U : 1U;
    compass_failed_ += readings.field ? 0U : 1U;
    const bool rolls = readings.ticks != ticks_;
    ticks_ = readings.ticks;
    // A robot that was stopped rolls out, and goes on turning while it does.
    if (activity.movement != motion::Movement::standing || !rolls) movement_ = activity.movement;

    if (activity.at_rest)
      measurement_.add(readings.gyro, readings.field, rolls);
    else
      measurement_.drive_off();
    const float gyro_rad_s = readings.gyro ? *readings.gyro - gyro_bias_ : no_reading;
    if (activity.calibrating) calibrate(readings.field, gyro_rad_s * dt_s);
    estimate_ =
        motion::estimate(estimate_,
                         {ticks_.left, ticks_.right, gyro_rad_s,
                          readings.field && calibrated_ ? compass(*readings.field) : no_reading, movement_},
                         dt_s, model_->estimator);
  }

  /// The robot is at 0, 0 and looks along x: an operator confirmed it. [T2 §6.3]
  void begin_at_zero() noexcept {
    if (measurement_.fresh()) {
      gyro_bias_ = measurement_.result().gyro_bias_rad_s;
      zero_rad_ = sensing::field_angle(measurement_.result().field, offset_);
    } else {
      zero_rad_ = motion::wrap(zero_rad_ - estimate_.pose.heading_rad);
    }
    motion::Estimate fresh;
    fresh.wheels = estimate_.wheels;
    fresh.rejected = estimate_.rejected;
    estimate_ = fresh;
  }

  /// From now on, while the robot turns, the steps find the compass's offset.
  constexpr void begin_calibration() noexcept {
    calibration_ = {};
    turned_rad_ = 0.0F;
  }
  /// It has turned around once.
  [[nodiscard]] constexpr bool turned_around() const noexcept { return calibration_.complete(); }
  /// How that ended. A good offset is the robot's from now on, and a poor one if it has none; else it keeps
  /// what it had.
  CompassReport end_calibration() noexcept {
    const auto found = calibration_.fit();
    if (!found) return {.verdict = judge(found.error, calibration_.count())};
    CompassReport report{.verdict = judge(*found, model_->compass), .fit = *found};
    report.taken = report.verdict == link::Calibration::good ||
                   (report.verdict == link::Calibration::poor && !calibrated_);
    if (report.taken) {
      use(found->offset);  // and the compass goes on from the heading that the robot has
      zero_rad_ = motion::wrap(estimate_.pose.heading_rad + sensing::field_angle(last_field_, offset_));
    }
    return report;
  }
  /// An offset that was found before. It counts from `begin_at_zero` on, which finds where the compass has
  /// its zero.
  constexpr void use(sensing::Field offset) noexcept {
    calibrated_ = true;
    offset_ = offset;
  }

  [[nodiscard]] constexpr const motion::Estimate& estimate() const noexcept { return estimate_; }
  /// Gyro and compass were measured at rest, once at least: the robot may say who it is.
  [[nodiscard]] constexpr bool ready() const noexcept { return measurement_.ready(); }
  /// One of them does not answer, and never did.
  [[nodiscard]] constexpr bool failed() const noexcept {
    return !measurement_.ready() && measurement_.failed();
  }
  /// In the last step, while the robot stood.
  [[nodiscard]] constexpr bool corrected_at_rest() const noexcept {
    return estimate_.compass_used && movement_ == motion::Movement::standing;
  }
  /// What the estimator took the last step for: told to stand, a robot that still rolls goes on as before.
  [[nodiscard]] constexpr motion::Movement movement() const noexcept { return movement_; }
  /// The compass may correct.
  [[nodiscard]] constexpr bool calibrated() const noexcept { return calibrated_; }
  [[nodiscard]] constexpr sensing::Field offset() const noexcept { return offset_; }
  [[nodiscard]] constexpr float gyro_bias_rad_s() const noexcept { return gyro_bias_; }
  /// Readings that did not come. They wrap.
  [[nodiscard]] constexpr std::uint32_t gyro_failed() const noexcept { return gyro_failed_; }
  [[nodiscard]] constexpr std::uint32_t compass_failed() const noexcept { return compass_failed_; }

 private:
  static constexpr float no_reading = std::numeric_limits<float>::quiet_NaN();

  /// The heading that the field says. The field is fixed, so it turns to the right as the robot turns
  /// left.
  [[nodiscard]] float compass(sensing::Field field) const noexcept {
    return motion::difference(zero_rad_, sensing::field_angle(field, offset_));
  }
  constexpr void calibrate(base::Result<sensing::Field> field, float turned_rad) noexcept {
    if (motion::is_finite(turned_rad)) turned_rad_ += turned_rad;
    if (!field) return;
    last_field_ = *field;
    if (calibration_.add(*field, turned_rad_)) turned_rad_ = 0.0F;
  }

  const RobotModel* model_;
  Measurement measurement_;
  motion::Estimate estimate_{};
  sensing::CompassCalibration calibration_{};
  sensing::Field offset_;
  sensing::Field last_field_{};
  bool calibrated_;
  WheelTicks ticks_{};
  float gyro_bias_ = 0.0F;
  float zero_rad_ = 0.0F;    ///< angle of the field, as the robot sees it at heading 0
  float turned_rad_ = 0.0F;  ///< since the calibration's last reading
  std::uint32_t gyro_failed_ = 0;
  std::uint32_t compass_failed_ = 0;
  motion::Movement movement_ = motion::Movement::standing;  ///< rolling out included
};

}  // namespace ocm::mapper::app
