/// The share of the time for which a motor that knows only on and off is on: 40 to 100 %, or not at all. Who
/// switches it, a task in slots of 20 ms or a timer, is the part's affair. [T2 §10.2.3, listing 10.1: the AVR
/// robot]
///
/// Integers, constexpr, constant time. Below 40 % the motor hums and stands: the thesis cut
/// such efforts off, and its robot always stopped short [T2 §13.3]; here they are raised to 40 %.
#pragma once

#include <cstdint>

#include "ocm/motion/real.hpp"

namespace ocm::motion {

struct SoftPwm {
  std::uint8_t least_percent = 40;
};

/// What a motor gets: which way, and how much of the time. 0 %: off.
struct MotorDuty {
  bool forward = true;
  std::uint8_t percent = 0;
  friend bool operator==(const MotorDuty&, const MotorDuty&) = default;
};

/// `effort` in [-1, 1], what is beyond counts as 1. Off where it is not finite, or less than `dead_band`: so
/// that an effort of almost nothing is none.
[[nodiscard]] constexpr MotorDuty duty(float effort, float dead_band, const SoftPwm& pwm = {}) noexcept {
  const float size = magnitude(effort);
  if (!is_finite(effort) || size == 0.0F || size < dead_band) return {};
  const auto percent = static_cast<std::uint8_t>(clamp(size, 0.0F, 1.0F) * 100.0F + 0.5F);
  return {effort > 0.0F, percent < pwm.least_percent ? pwm.least_percent : percent};
}

}  // namespace ocm::motion
