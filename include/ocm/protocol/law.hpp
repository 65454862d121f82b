/// How a quantity follows from what a sensor measures: the sensor's law, solved for the quantity, with the
/// standard deviation that the sensor's noise gives it. A spec has them as derived fields.
///
/// There is one law, the inverse square: light that comes back from an obstacle falls with the square of the
/// distance. measured = at_one / value^2 + offset, so that value = sqrt(at_one / (measured - offset)), and a
/// deviation of `noise` in what is measured is one of value^3 * noise / (2 at_one) in the value, to first
/// order.
///
/// No heap; a look costs some 100 ns with a floating-point unit: a square root by Newton's method, because
/// the standard library's is no constant expression.
#pragma once

#include <cstdint>
#include <limits>

#include "ocm/base/decimal.hpp"

namespace ocm::protocol {

/// The square root; 0 of what is not above zero. To the last bit or the one before it.
[[nodiscard]] constexpr double square_root(double square) noexcept {
  if (!(square > 0)) return 0;
  if (square > std::numeric_limits<double>::max()) return square;  // infinite
  double root = square > 1 ? square : 1;  // above the root, from where each step comes nearer
  for (double next = (root + square / root) / 2; next < root; next = (root + square / root) / 2) root = next;
  return root;
}

/// A positive number with so many significant digits, rounded. 0 for what is not positive, too large, or too
/// small for a Decimal.
[[nodiscard]] constexpr base::Decimal rounded(double number, int digits) noexcept {
  if (!(number > 0) || number > 1e18 || number < 1e-18) return {};
  double least = 1;
  for (int i = 1; i < digits; ++i) least *= 10;
  int exponent = 0;
  for (; number < least; --exponent) number *= 10;
  for (; number >= least * 10; ++exponent) number /= 10;
  return base::normalised(static_cast<std::int64_t>(number + 0.5), exponent);
}

struct Law {
  base::Decimal at_one;  ///< what is measured above the offset where the value is 1; above 0
  base::Decimal offset;  ///< what is measured when nothing is there
  base::Decimal noise;   ///< standard deviation of what is measured; 0: not known
  base::Decimal min;     ///< the values at which the law holds; `min` above 0
  base::Decimal max;

  friend constexpr bool operator==(const Law&, const Law&) = default;
  /// Infinite where nothing is above the offset.
  [[nodiscard]] constexpr double value(double measured) const noexcept {
    const double above = measured - offset.as_double();
    if (!(above > 0)) return std::numeric_limits<double>::infinity();
    return square_root(at_one.as_double() / above);
  }
  /// Whether it says anything: the value is one at which the law holds.
  [[nodiscard]] constexpr bool holds(double measured) const noexcept {
    const double found = value(measured);
    return min.as_double() <= found && found <= max.as_double();
  }
  /// One standard deviation of the value.
  [[nodiscard]] constexpr double uncertainty(double measured) const noexcept {
    const double found = value(measured);
    return found * found * found * noise.as_double() / (2 * at_one.as_double());
  }
};

}  // namespace ocm::protocol
