/// From a physical value to the raw number of a field: what generated setters call.
#pragma once

#include <concepts>
#include <cstdint>
#include <type_traits>

namespace ocm::protocol {

/// The whole number nearest to `value`, halves away from zero, held within [min, max]: a set point that is
/// too large becomes the largest, never one backwards. Not a number gives the number in the range that is
/// nearest to zero: a fault upstream must not move the robot.
template <std::integral T>
[[nodiscard]] constexpr T nearest_raw(double value, T min, T max) noexcept {
  if (value != value) return min > 0 ? min : max < 0 ? max : T{0};
  if (value <= static_cast<double>(min)) return min;
  if (value >= static_cast<double>(max)) return max;
  using Whole = std::conditional_t<std::is_unsigned_v<T> && sizeof(T) == 8, std::uint64_t, std::int64_t>;
  const auto whole = static_cast<Whole>(value);  // towards zero; the difference below is exact
  const double rest = value - static_cast<double>(whole);
  if constexpr (std::is_unsigned_v<Whole>)
    return static_cast<T>(whole + (rest >= 0.5 ? 1 : 0));
  else
    return static_cast<T>(whole + (rest >= 0.5 ? 1 : rest <= -0.5 ? -1 : 0));
}

/// The value in [low, high] that is nearest to `value`. Not a number becomes the one nearest to zero: a motor
/// stops.
[[nodiscard]] constexpr double within(double value, double low, double high) noexcept {
  if (value != value) return low > 0 ? low : high < 0 ? high : 0;
  return value < low ? low : value > high ? high : value;
}

}  // namespace ocm::protocol
