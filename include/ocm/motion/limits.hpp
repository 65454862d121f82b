/// What a robot may be asked for: bounds on speed and on how fast it changes. Pure steps, constant time; a
/// request that is not finite is answered by the last one, and a last one that is not finite by a stop.
#pragma once

#include "ocm/motion/pose.hpp"
#include "ocm/motion/real.hpp"

namespace ocm::motion {

struct Limits {
  float speed_m_s = 0.0F;
  float acceleration_m_s2 = 0.0F;
  float turn_rad_s = 0.0F;
  float turn_acceleration_rad_s2 = 0.0F;
};

/// `wanted`, at most `most` either way, and changed by at most `per_s` * dt since `last`.
[[nodiscard]] constexpr float limited(float last, float wanted, float most, float per_s,
                                      float dt_s) noexcept {
  if (!is_finite(last)) return 0.0F;
  if (!is_finite(wanted) || !is_step(dt_s)) return clamp(last, -most, most);
  const float change = per_s * dt_s;
  return clamp(clamp(wanted, last - change, last + change), -most, most);
}

[[nodiscard]] constexpr Twist limited(Twist last, Twist wanted, const Limits& limits, float dt_s) noexcept {
  return {
      limited(last.speed_m_s, wanted.speed_m_s, limits.speed_m_s, limits.acceleration_m_s2, dt_s),
      limited(last.turn_rad_s, wanted.turn_rad_s, limits.turn_rad_s, limits.turn_acceleration_rad_s2, dt_s)};
}

/// The longest that anything may take from what is measured to the speed, s, for a loop whose speed is
/// gain * (distance that is left): up to gain * T = 1/e it comes to rest without running over. [a first-order
/// loop with a dead time is not oscillatory up to 1/e]
[[nodiscard]] constexpr float most_dead_time_s(float gain_per_s) noexcept {
  constexpr float one_by_e = 0.36787944F;
  return one_by_e / gain_per_s;
}

/// What the two motors get, each in [-1, 1].
struct Efforts {
  float left = 0.0F;
  float right = 0.0F;
  friend bool operator==(const Efforts&, const Efforts&) = default;
};

/// Ahead and turn on two motors. What one motor cannot do is taken from both in proportion, so that the robot
/// keeps the curve and loses speed. Standing for what is not finite.
[[nodiscard]] constexpr Efforts mixed(float ahead, float turn) noexcept {
  if (!all_finite(ahead, turn)) return {};
  const float left = ahead - turn;
  const float right = ahead + turn;
  const float greatest = magnitude(left) > magnitude(right) ? magnitude(left) : magnitude(right);
  if (greatest <= 1.0F) return {left, right};
  if (!is_finite(greatest)) return {};
  return {left / greatest, right / greatest};
}

}  // namespace ocm::motion
