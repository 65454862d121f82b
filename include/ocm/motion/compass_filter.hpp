/// Corrects a heading by a compass, carefully: a scalar Kalman filter, and the rule that says when the
/// compass may speak at all. [T2 §7.3.1, §7.4, listing 7.1]
///
///   K = P / (P + R),  th += K wrap(compass - th),  P = (1 - K) P
///
/// R is no property of the part (its data sheet says 2 degrees) but set high, so that the compass acts over a
/// long time only: steel in the floor turns it by tens of degrees. It is trusted where, over the last
/// straight drive, it turned by no more than those 2 degrees; and it corrects while the robot stands. Known
/// weakness: a short drive inside one disturbed place passes the test [T2 figure 7.9]. Constant time; a
/// compass that is not finite, or an R that is not positive, corrects nothing, and the result says so.
#pragma once

#include "ocm/motion/angle.hpp"
#include "ocm/motion/heading.hpp"
#include "ocm/motion/pose.hpp"
#include "ocm/motion/real.hpp"

namespace ocm::motion {

/// What the data sheet allows a compass at rest. [HMC5883L data sheet; T2 §7.2.2]
inline constexpr float compass_spread_rad = radians(2.0F);

struct CorrectedHeading {
  Heading heading{};
  bool rejected = false;  ///< the measurement was no number, or its variance not positive
};

/// One measurement. The variance stays in [0, P].
[[nodiscard]] constexpr CorrectedHeading correct(Heading prior, float compass_rad,
                                                 float compass_variance_rad2) noexcept {
  if (!is_finite(compass_rad) || !is_step(compass_variance_rad2)) return {prior, true};
  const float sum = prior.variance_rad2 + compass_variance_rad2;
  const float gain = prior.variance_rad2 / sum;
  const float angle_rad = wrap(prior.angle_rad + gain * difference(compass_rad, prior.angle_rad));
  if (!all_finite(gain, angle_rad)) return {prior, true};
  // (1 - K) P, written so that no rounding makes it negative
  return {{angle_rad, prior.variance_rad2 * (compass_variance_rad2 / sum)}, false};
}

/// Whether the compass may mean the heading that is believed: no farther off than `sigmas` times what both
/// can be wrong by together, `spread_rad` being that of a compass that nothing disturbs. What is farther off
/// is steel. No positive `sigmas`: always.
[[nodiscard]] constexpr bool agrees(Heading prior, float compass_rad, float spread_rad,
                                    float sigmas) noexcept {
  if (!(sigmas > 0.0F) || !is_finite(compass_rad)) return true;  // a reading that is no number is counted
  const float off_rad = difference(compass_rad, prior.angle_rad);
  return off_rad * off_rad <= sigmas * sigmas * (prior.variance_rad2 + spread_rad * spread_rad);
}

/// When a compass corrects.
enum class CompassRule : unsigned char {
  standing_where_trusted,  ///< the AVR robot
  always,                  ///< the Arduino robot [T2 §14.3]
};

/// Whether the compass can be trusted where the robot is. Not before the first straight drive ended well.
struct CompassTrust {
  float at_start_rad = 0.0F;  ///< of the straight drive
  bool driving = false;
  bool trusted = false;
  friend bool operator==(const CompassTrust&, const CompassTrust&) = default;
};

/// To be called each step. A drive that starts or ends without a finite compass ends without trust.
[[nodiscard]] constexpr CompassTrust judge(CompassTrust trust, Movement movement, float compass_rad,
                                           float spread_rad = compass_spread_rad) noexcept {
  if (movement == Movement::straight) {
    if (!trust.driving) trust = {compass_rad, true, false};
    return trust;
  }
  if (trust.driving) {
    trust.driving = false;
    trust.trusted = all_finite(compass_rad, trust.at_start_rad) &&
                    magnitude(difference(compass_rad, trust.at_start_rad)) <= spread_rad;
  }
  return trust;
}

[[nodiscard]] constexpr bool may_correct(CompassTrust trust, Movement movement, CompassRule rule) noexcept {
  return rule == CompassRule::always || (movement == Movement::standing && trust.trusted);
}

}  // namespace ocm::motion
