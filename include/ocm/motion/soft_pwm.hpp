/// Pulse widths made by a task that switches a motor on and off: slots of 20 ms, on for 40 to 100 % of them,
/// or not at all. [T2 §10.2.3, listing 10.1: the AVR robot]
///
/// Integers and std::chrono, constexpr, constant time. Below 40 % the motor hums and stands: the thesis cut
/// such efforts off, and its robot always stopped short [T2 §13.3]; here they are raised to 40 %.
#pragma once

#include <chrono>
#include <cstdint>

#include "ocm/base/time.hpp"
#include "ocm/motion/real.hpp"

namespace ocm::motion {

struct SoftPwm {
  base::Duration slot = std::chrono::milliseconds{20};
  std::uint8_t least_percent = 40;
};

/// What a motor gets: which way, and how much of each slot. 0 %: off.
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

/// How long the motor is on in each slot.
[[nodiscard]] constexpr base::Duration on_time(MotorDuty duty, const SoftPwm& pwm = {}) noexcept {
  const std::uint8_t percent = duty.percent > 100 ? 100 : duty.percent;
  return pwm.slot * percent / 100;
}

/// Whether it is on, `since` the first slot began.
[[nodiscard]] constexpr bool is_on(MotorDuty duty, base::Duration since, const SoftPwm& pwm = {}) noexcept {
  return since >= base::Duration::zero() && since % pwm.slot < on_time(duty, pwm);
}

}  // namespace ocm::motion
