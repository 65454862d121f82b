/// The weight of the gyro in the heading, from a heading that is known to be right (a compass that is
/// trusted, a camera): where between wheels and gyro it lies. [T2 eq. 7.5]
///
///   a = (th - th_wheels) / (th_gyro - th_wheels), clamped to [0, 1]
///
/// So the weight follows the floor, which makes the wheels slip more or less. The thesis built this and never
/// tried it; single steps gave a > 1 there, hence the clamp, the least disagreement asked for, and the slow
/// adaptation. Constant time.
#pragma once

#include "ocm/base/result.hpp"
#include "ocm/motion/angle.hpp"
#include "ocm/motion/real.hpp"

namespace ocm::motion {

/// Headings of the same moment, each carried on from a common start.
struct Headings {
  float known_rad = 0.0F;
  float gyro_rad = 0.0F;
  float wheels_rad = 0.0F;
};

/// `least_rad`: gyro and wheels that differ by less say nothing of their weights, Error::out_of_range.
/// Headings that are not finite: Error::not_sampled.
[[nodiscard]] constexpr base::Result<float> gyro_weight(Headings headings, float least_rad) noexcept {
  if (!all_finite(headings.known_rad, headings.gyro_rad, headings.wheels_rad)) {
    return base::Error::not_sampled;
  }
  const float apart = difference(headings.gyro_rad, headings.wheels_rad);
  if (apart == 0.0F || !(magnitude(apart) >= least_rad)) return base::Error::out_of_range;
  return clamp(difference(headings.known_rad, headings.wheels_rad) / apart, 0.0F, 1.0F);
}

/// Part of the way from one weight to another: `rate` in [0, 1]. In [0, 1] always.
[[nodiscard]] constexpr float adapted(float weight, float towards, float rate) noexcept {
  if (!is_finite(towards)) return clamp(weight, 0.0F, 1.0F);
  return clamp(weight + clamp(rate, 0.0F, 1.0F) * (towards - weight), 0.0F, 1.0F);
}

}  // namespace ocm::motion
