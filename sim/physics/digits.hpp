/// How a part's converter rounds: to the nearest digit, and no further than its range.
#pragma once

#include <cmath>

namespace ocm::sim {

/// The nearest digit; beyond the part's range the last one of it, as the part does. Never wraps.
template <class T>
[[nodiscard]] T digits(double value, double low, double high) noexcept {
  const double digit = std::floor(value + 0.5);
  return static_cast<T>(digit > high ? high : digit >= low ? digit : low);  // not a number: low
}

}  // namespace ocm::sim
