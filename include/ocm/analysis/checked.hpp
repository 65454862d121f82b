/// Arithmetic on ticks that knows when 64 bits were too few, instead of wrapping: a sum over a set of tasks
/// is written as in its paper, and looked at once at the end.
///
///     Checked w = task.cost + Checked{task.blocking};
///     for (const Task& k : more_urgent) w += ceil_div(w + k.jitter, k.period) * k.cost;
///     if (!w.ok()) return Reason::too_long;
///
/// A tick is what the caller says: a nanosecond, a bit time. Once spoilt, a number stays spoilt. No 128-bit
/// type is used: there is none on a Cortex-M. Cost: a comparison or two an operation; a product divides only
/// if a factor has more than 31 bits.
#pragma once

#include <cstdint>
#include <limits>

namespace ocm::analysis {

class Checked {
 public:
  constexpr Checked() = default;
  constexpr Checked(std::int64_t ticks) noexcept : value_(ticks) {}  // NOLINT: a number is a checked number

  /// The result of what does not fit.
  [[nodiscard]] static constexpr Checked spoilt() noexcept {
    Checked result;
    result.ok_ = false;
    return result;
  }

  /// False: it did not fit, or was divided by less than one.
  [[nodiscard]] constexpr bool ok() const noexcept { return ok_; }
  /// Valid if ok().
  [[nodiscard]] constexpr std::int64_t value() const noexcept { return value_; }
  [[nodiscard]] constexpr std::int64_t value_or(std::int64_t other) const noexcept {
    return ok_ ? value_ : other;
  }

  friend constexpr Checked operator+(Checked a, Checked b) noexcept {
    std::int64_t sum = 0;
    if (!a.ok_ || !b.ok_ || __builtin_add_overflow(a.value_, b.value_, &sum)) return spoilt();
    return sum;
  }
  friend constexpr Checked operator-(Checked a, Checked b) noexcept {
    std::int64_t difference = 0;
    if (!a.ok_ || !b.ok_ || __builtin_sub_overflow(a.value_, b.value_, &difference)) return spoilt();
    return difference;
  }
  friend constexpr Checked operator*(Checked a, Checked b) noexcept {
    if (!a.ok_ || !b.ok_) return spoilt();
    const std::uint64_t x = magnitude(a.value_);
    const std::uint64_t y = magnitude(b.value_);
    if (((x | y) >> 31U) != 0 && y != 0 && x > static_cast<std::uint64_t>(most) / y) return spoilt();
    return a.value_ * b.value_;
  }
  constexpr Checked& operator+=(Checked other) noexcept { return *this = *this + other; }
  constexpr Checked& operator-=(Checked other) noexcept { return *this = *this - other; }
  constexpr Checked& operator*=(Checked other) noexcept { return *this = *this * other; }

  /// What is spoilt equals nothing, and is neither above nor below.
  friend constexpr bool operator==(Checked a, Checked b) noexcept {
    return a.ok_ && b.ok_ && a.value_ == b.value_;
  }
  friend constexpr bool operator<(Checked a, Checked b) noexcept {
    return a.ok_ && b.ok_ && a.value_ < b.value_;
  }
  friend constexpr bool operator>(Checked a, Checked b) noexcept { return b < a; }
  friend constexpr bool operator<=(Checked a, Checked b) noexcept { return a < b || a == b; }
  friend constexpr bool operator>=(Checked a, Checked b) noexcept { return b <= a; }

 private:
  static constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();

  static constexpr std::uint64_t magnitude(std::int64_t value) noexcept {
    return value < 0 ? ~static_cast<std::uint64_t>(value) + 1 : static_cast<std::uint64_t>(value);
  }

  std::int64_t value_ = 0;
  bool ok_ = true;
};

namespace detail {
/// Towards zero; b is at least 1. Short where 32 bits hold both, which is where a Cortex-M has an
/// instruction.
constexpr std::int64_t quotient(std::int64_t a, std::int64_t b) noexcept {
  if ((static_cast<std::uint64_t>(a) | static_cast<std::uint64_t>(b)) >> 32U != 0) return a / b;
  return static_cast<std::uint32_t>(a) / static_cast<std::uint32_t>(b);
}
}  // namespace detail

/// The least whole number that is not below a / b; b is at least 1.
[[nodiscard]] constexpr Checked ceil_div(Checked a, Checked b) noexcept {
  if (!a.ok() || !b.ok() || b.value() < 1) return Checked::spoilt();
  const std::int64_t quotient = detail::quotient(a.value(), b.value());
  return quotient * b.value() < a.value() ? quotient + 1 : quotient;
}
/// The greatest whole number that is not above a / b; b is at least 1.
[[nodiscard]] constexpr Checked floor_div(Checked a, Checked b) noexcept {
  if (!a.ok() || !b.ok() || b.value() < 1) return Checked::spoilt();
  const std::int64_t quotient = detail::quotient(a.value(), b.value());
  return quotient * b.value() > a.value() ? quotient - 1 : quotient;
}

}  // namespace ocm::analysis
