/// Angles in radians, kept in (-pi, pi], and compared the short way round. [T2 §8.2, listing 8.1]
///
/// The listing takes turns off one at a time; here they are taken off at once, so the cost is the same for
/// every angle. Exact within (-pi, pi]; up to 65,536 turns as good as the float that holds the angle; beyond
/// that a float holds no angle to speak of, and only the range of the result is promised. What is not finite
/// becomes NaN: a step that takes measurements refuses it before.
#pragma once

#include <cstdint>
#include <limits>

#include "ocm/motion/real.hpp"

namespace ocm::motion {

inline constexpr float pi = 3.14159265F;
inline constexpr float two_pi = 6.28318531F;

[[nodiscard]] constexpr float radians(float degrees) noexcept {
  return degrees * (pi / 180.0F);
}
[[nodiscard]] constexpr float degrees(float radians) noexcept {
  return radians * (180.0F / pi);
}

/// The same direction in (-pi, pi].
[[nodiscard]] constexpr float wrap(float angle_rad) noexcept {
  if (angle_rad > -pi && angle_rad <= pi) return angle_rad;
  if (!is_finite(angle_rad)) return std::numeric_limits<float>::quiet_NaN();
  constexpr float most = 1e18F;  // rad: more does not fit the whole number of turns
  if (magnitude(angle_rad) > most) return 0.0F;
  const float half = angle_rad < 0.0F ? -0.5F : 0.5F;
  const auto turns = static_cast<float>(static_cast<std::int64_t>(angle_rad / two_pi + half));
  // 2 pi as a sum, so that the product of turns and its large part is exact
  constexpr float high = 6.28125F;  // 8 binary digits
  constexpr float low = 1.93530718e-3F;
  const float rest = angle_rad - turns * high - turns * low;
  constexpr float least = -3.1415925F;  // the next float above -pi
  static_assert(least > -pi);
  return clamp(rest, least, pi);
}

/// How far to turn from `from` to `to`: in (-pi, pi], left is positive.
[[nodiscard]] constexpr float difference(float to_rad, float from_rad) noexcept {
  return wrap(to_rad - from_rad);
}

}  // namespace ocm::motion
