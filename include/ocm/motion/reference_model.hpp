/// A set point that arrives smoothly: a first-order reference, so that a controller can be stiff and the
/// robot still starts and stops gently. [T2 eq. 7.1]
///
///   r += K_R (set point - r), 0 < K_R < 1
///
/// K_R belongs to one period; over another time it is 1 - (1 - K_R)^(dt/T): the same curve at whatever
/// moments it is sampled. One pow where dt is not T. A new set point starts r at the present pose.
#pragma once

#include <cmath>

#include "ocm/motion/real.hpp"

namespace ocm::motion {

struct ReferenceModel {
  float gain = 0.1F;        ///< K_R, in (0, 1)
  float period_s = 0.030F;  ///< what the gain was chosen for [T2 table 9.2]
};

/// One step of the period itself. What is not finite moves nothing.
[[nodiscard]] constexpr float approach(float reference, float set_point, float gain) noexcept {
  if (!all_finite(reference, set_point)) return reference;
  const float next = reference + clamp(gain, 0.0F, 1.0F) * (set_point - reference);
  return is_finite(next) ? next : reference;
}

/// K_R for the time that really passed; 0 for one that cannot be.
[[nodiscard]] inline float gain_over(const ReferenceModel& model, float dt_s) noexcept {
  if (!is_step(dt_s) || !is_step(model.period_s)) return 0.0F;
  if (dt_s == model.period_s) return model.gain;
  return 1.0F - std::pow(1.0F - clamp(model.gain, 0.0F, 1.0F), dt_s / model.period_s);
}

[[nodiscard]] inline float approach(float reference, float set_point, const ReferenceModel& model,
                                    float dt_s) noexcept {
  return approach(reference, set_point, gain_over(model, dt_s));
}

}  // namespace ocm::motion
