/// IEEE 754's numbers of 64 bits, also where `double` has fewer: on an AVR it has 32. A number too small or
/// too large for such a double becomes zero or infinite, one between two of its numbers the nearer. No
/// allocation.
#pragma once

#include <bit>
#include <cstdint>
#include <type_traits>

namespace ocm::base {

/// The number that 64 bits mean.
template <class Real = double>
[[nodiscard]] constexpr Real from_binary64(std::uint64_t bits) noexcept {
  if constexpr (sizeof(Real) == sizeof(bits)) {
    return std::bit_cast<Real>(bits);
  } else {
    constexpr int narrower = 52 - 23;  // bits of the fraction
    const auto sign = static_cast<std::uint32_t>(bits >> 63) << 31;
    const int exponent = static_cast<int>(bits >> 52 & 0x7FF) - 1023 + 127;
    const std::uint64_t fraction = bits & 0xF'FFFF'FFFF'FFFF;
    if (exponent == 0x7FF - 1023 + 127)  // infinite, or not a number: quiet, as arithmetic would make it
      return std::bit_cast<Real>(sign | 0x7F80'0000 | (fraction != 0 ? 0x40'0000U : 0U));
    if (exponent >= 0xFF) return std::bit_cast<Real>(sign | 0x7F80'0000);
    const int shift = exponent > 0 ? narrower : narrower + 1 - exponent;  // below 2^-126 fewer bits are left
    if (shift > 53) return std::bit_cast<Real>(sign);
    const std::uint64_t whole = fraction | std::uint64_t{1} << 52;
    const std::uint64_t half = std::uint64_t{1} << (shift - 1);
    auto kept = static_cast<std::uint32_t>(whole >> shift);
    const std::uint64_t rest = whole & (2 * half - 1);
    if (rest > half || (rest == half && (kept & 1) != 0))
      ++kept;  // may carry into the exponent: that is right
    if (exponent > 0) kept += static_cast<std::uint32_t>(exponent - 1) << 23;  // `kept` has the leading one
    return std::bit_cast<Real>(sign | kept);
  }
}

/// The 64 bits of a number.
template <class Real>
requires std::is_floating_point_v<Real>
[[nodiscard]] constexpr std::uint64_t to_binary64(Real value) noexcept {
  if constexpr (sizeof(Real) == sizeof(std::uint64_t)) {
    return std::bit_cast<std::uint64_t>(value);
  } else {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    const auto sign = std::uint64_t{bits >> 31} << 63;
    auto exponent = static_cast<int>(bits >> 23 & 0xFF);
    std::uint32_t fraction = bits & 0x7F'FFFF;
    if (exponent == 0 && fraction == 0) return sign;
    if (exponent == 0) {  // 64 bits have a leading one also for what is below 2^-126
      const int missing = std::countl_zero(fraction) - 8;
      fraction = (fraction << missing) & 0x7F'FFFF;
      exponent = 1 - missing;
    }
    const auto wide = static_cast<std::uint64_t>(exponent == 0xFF ? 0x7FF : exponent - 127 + 1023);
    return sign | wide << 52 | std::uint64_t{fraction} << 29;
  }
}

}  // namespace ocm::base
