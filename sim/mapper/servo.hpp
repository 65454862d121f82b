/// The tower's servo: it needs time to reach its set point. A lag, within a greatest speed. Pure steps of 1
/// ms.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "ocm/sensing/servo.hpp"

#include "sim/mapper/robot_model.hpp"
#include "sim/physics/step.hpp"

namespace ocm::sim::mapper {

class Servo {
 public:
  explicit Servo(const ServoModel& model) noexcept
      : gain_(1 - std::exp(-step_s / model.lag_s)), most_deg_(model.most_deg_per_s * step_s) {}

  /// Angles outside are taken for the nearest end.
  void turn(std::int32_t degrees) noexcept { target_deg_ = sensing::within_servo(degrees); }

  void step() noexcept {
    if (at_rest()) return;
    angle_deg_ += std::clamp((target_deg_ - angle_deg_) * gain_, -most_deg_, most_deg_);
    if (std::abs(target_deg_ - angle_deg_) < there_deg) angle_deg_ = target_deg_;
  }

  [[nodiscard]] bool at_rest() const noexcept { return angle_deg_ == target_deg_; }
  [[nodiscard]] double angle_deg() const noexcept { return angle_deg_; }

 private:
  static constexpr double there_deg = 0.01;

  double gain_;      // how much of the rest of the way it goes in a step
  double most_deg_;  // in a step
  double angle_deg_ = 0;
  double target_deg_ = 0;
};

}  // namespace ocm::sim::mapper
