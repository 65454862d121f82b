/// What every step asks of its numbers: are they finite, and within which bounds.
/// constexpr, no library call. -ffast-math takes infinity and NaN out of the language: not to be used here.
#pragma once

#include <limits>

namespace ocm::motion {

/// Neither infinite nor NaN.
[[nodiscard]] constexpr bool is_finite(float x) noexcept {
  constexpr float most = std::numeric_limits<float>::max();
  return x >= -most && x <= most;
}

/// All of them.
template <class... Floats>
[[nodiscard]] constexpr bool all_finite(Floats... x) noexcept {
  return (is_finite(x) && ...);
}

/// A time step that a step can be made over: finite and longer than zero.
[[nodiscard]] constexpr bool is_step(float dt_s) noexcept {
  return is_finite(dt_s) && dt_s > 0.0F;
}

[[nodiscard]] constexpr float magnitude(float x) noexcept {
  return x < 0.0F ? -x : x;
}

/// `x` within [low, high]; `low` for NaN, so that NaN ends here.
[[nodiscard]] constexpr float clamp(float x, float low, float high) noexcept {
  return x > high ? high : x > low ? x : low;
}

}  // namespace ocm::motion
