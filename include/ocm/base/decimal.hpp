/// Exact decimal numbers: a scale of 0.0175 is 175 * 10^-4 and not the nearest binary fraction, so that three
/// digits of a gyroscope print as 0.0525 and not as 0.052500000000000005.
#pragma once

#include <cstdint>
#include <string_view>

#include "ocm/base/result.hpp"
#include "ocm/base/text.hpp"

namespace ocm::base {

/// Parsed and computed numbers lie within 10^-100 .. 10^100 a digit: anything else is out_of_range.
inline constexpr int max_decimal_exponent = 100;

/// `digits * 10^exponent`. Normalised: no trailing zero in `digits` unless it is 0, and then exponent 0.
struct Decimal {
  std::int64_t digits = 0;
  std::int8_t exponent = 0;

  friend constexpr bool operator==(const Decimal&, const Decimal&) = default;
  [[nodiscard]] constexpr double as_double() const noexcept {
    // Dividing by an exact power of ten (up to 10^22) rounds once; multiplying by 10^-n would round twice.
    double power = 1;
    const int n = exponent < 0 ? -exponent : exponent;
    for (int i = 0; i < n; ++i) power *= 10;
    return exponent < 0 ? static_cast<double>(digits) / power : static_cast<double>(digits) * power;
  }
};

/// `exponent` within -128 .. 109, which leaves room for the zeros that move into it.
[[nodiscard]] constexpr Decimal normalised(std::int64_t digits, int exponent) noexcept {
  if (digits == 0) return {};
  while (digits % 10 == 0) digits /= 10, ++exponent;
  return {digits, static_cast<std::int8_t>(exponent)};
}

namespace detail {
[[nodiscard]] constexpr bool multiply_overflows(std::int64_t a, std::int64_t b,
                                                std::int64_t& product) noexcept {
  return __builtin_mul_overflow(a, b, &product);
}
/// digits * 10^n, or an error.
[[nodiscard]] constexpr Result<std::int64_t> scaled(std::int64_t digits, int n) noexcept {
  for (; n > 0; --n)
    if (multiply_overflows(digits, 10, digits)) return Error::out_of_range;
  return digits;
}
/// Normalised, or out_of_range.
[[nodiscard]] constexpr Result<Decimal> bounded(std::int64_t digits, int exponent) noexcept {
  while (digits != 0 && digits % 10 == 0) digits /= 10, ++exponent;
  if (digits == 0) return Decimal{};
  if (exponent < -max_decimal_exponent || exponent > max_decimal_exponent) return Error::out_of_range;
  return Decimal{digits, static_cast<std::int8_t>(exponent)};
}
[[nodiscard]] constexpr std::uint64_t magnitude(std::int64_t number) noexcept {
  return number < 0 ? 0 - static_cast<std::uint64_t>(number) : static_cast<std::uint64_t>(number);
}
}  // namespace detail

/// a * b; out_of_range where the product of the digits needs more than 63 bits.
[[nodiscard]] constexpr Result<Decimal> multiply(Decimal a, Decimal b) noexcept {
  std::int64_t product = 0;
  if (detail::multiply_overflows(a.digits, b.digits, product)) return Error::out_of_range;
  return detail::bounded(product, a.exponent + b.exponent);
}

/// a + b, exact or out_of_range.
[[nodiscard]] constexpr Result<Decimal> add(Decimal a, Decimal b) noexcept {
  if (a.digits == 0) return detail::bounded(b.digits, b.exponent);
  if (b.digits == 0) return detail::bounded(a.digits, a.exponent);
  const int exponent = a.exponent < b.exponent ? a.exponent : b.exponent;
  const auto x = detail::scaled(a.digits, a.exponent - exponent);
  const auto y = detail::scaled(b.digits, b.exponent - exponent);
  std::int64_t sum = 0;
  if (!x || !y || __builtin_add_overflow(*x, *y, &sum)) return Error::out_of_range;
  return detail::bounded(sum, exponent);
}

[[nodiscard]] constexpr Result<Decimal> subtract(Decimal a, Decimal b) noexcept {
  if (b.digits == INT64_MIN) return Error::out_of_range;
  return add(a, Decimal{-b.digits, b.exponent});
}

/// a / b rounded half away from zero to a whole number; out_of_range where that needs more than 63 bits, or b
/// is 0. Exact for every other pair; no 128-bit arithmetic, which a Cortex-M has not.
[[nodiscard]] constexpr Result<std::int64_t> divide_rounded(Decimal a, Decimal b) noexcept {
  if (b.digits == 0) return Error::out_of_range;
  if (a.digits == 0) return std::int64_t{0};
  const bool negative = (a.digits < 0) != (b.digits < 0);
  std::uint64_t divisor = detail::magnitude(b.digits);
  for (int n = b.exponent - a.exponent; n > 0; --n)
    // A divisor of 2^64 or more is more than twice any dividend: the quotient rounds to 0.
    if (__builtin_mul_overflow(divisor, std::uint64_t{10}, &divisor)) return std::int64_t{0};
  std::uint64_t quotient = detail::magnitude(a.digits) / divisor;
  std::uint64_t rest = detail::magnitude(a.digits) % divisor;
  // One decimal place a step, as on paper. A divisor that was scaled up above needs no step, so that here it
  // is at most 2^63, the rest smaller, and twice the rest fits.
  for (int n = a.exponent - b.exponent; n > 0 && (quotient | rest) != 0; --n) {
    if (__builtin_mul_overflow(quotient, std::uint64_t{10}, &quotient)) return Error::out_of_range;
    std::uint64_t place = 0;
    std::uint64_t tenfold = 0;                           // 10 * rest, less place * divisor
    for (const bool bit : {true, false, true, false}) {  // 10 in binary
      tenfold *= 2;
      place *= 2;
      if (tenfold >= divisor) tenfold -= divisor, ++place;
      if (!bit) continue;
      tenfold += rest;
      if (tenfold >= divisor) tenfold -= divisor, ++place;
    }
    rest = tenfold;
    if (__builtin_add_overflow(quotient, place, &quotient)) return Error::out_of_range;
  }
  if (rest >= divisor - rest && __builtin_add_overflow(quotient, std::uint64_t{1}, &quotient))
    return Error::out_of_range;
  const std::uint64_t limit = static_cast<std::uint64_t>(INT64_MAX) + (negative ? 1 : 0);
  if (quotient > limit) return Error::out_of_range;
  return static_cast<std::int64_t>(negative ? 0 - quotient : quotient);
}

/// -1, 0 or 1 as a < b, a == b, a > b. Exact for every pair.
[[nodiscard]] constexpr int compare(Decimal a, Decimal b) noexcept {
  const int sign_a = a.digits < 0 ? -1 : a.digits > 0;
  const int sign_b = b.digits < 0 ? -1 : b.digits > 0;
  if (sign_a != sign_b) return sign_a < sign_b ? -1 : 1;
  const int exponent = a.exponent < b.exponent ? a.exponent : b.exponent;
  const auto x = detail::scaled(a.digits, a.exponent - exponent);
  const auto y = detail::scaled(b.digits, b.exponent - exponent);
  if (!x) return sign_a;  // a alone was scaled up, past any 64-bit b
  if (!y) return -sign_b;
  return *x < *y ? -1 : *x > *y;
}

/// "-0.0175", ".5", "12", "1e-3". No blanks, no locale.
[[nodiscard]] constexpr Result<Decimal> parse_decimal(std::string_view text) noexcept {
  bool negative = false;
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) {
    negative = text.front() == '-';
    text.remove_prefix(1);
  }
  std::int64_t digits = 0;
  int exponent = 0;
  int zeros = 0;  // after `digits`: taken into them before another digit only, so that 10^100 can be read
  bool point = false;
  bool any = false;
  std::size_t i = 0;
  for (; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '.' && !point) {
      point = true;
    } else if (is_digit(c)) {
      any = true;
      if (point && --exponent < -max_decimal_exponent) return Error::out_of_range;
      if (c == '0') {
        if (digits != 0 && ++zeros > 2 * max_decimal_exponent) return Error::out_of_range;
        continue;
      }
      // Negative whatever the sign: there is one more negative number than there are positive ones.
      for (++zeros; zeros > 0; --zeros)
        if (detail::multiply_overflows(digits, 10, digits)) return Error::out_of_range;
      if (__builtin_sub_overflow(digits, c - '0', &digits)) return Error::out_of_range;
    } else {
      break;
    }
  }
  exponent += zeros;
  if (!any) return Error::bad_syntax;
  if (i < text.size()) {
    if (text[i] != 'e' && text[i] != 'E') return Error::bad_syntax;
    std::string_view tail = text.substr(i + 1);
    const bool down = !tail.empty() && tail.front() == '-';
    if (!tail.empty() && (tail.front() == '-' || tail.front() == '+')) tail.remove_prefix(1);
    const auto shift = parse_unsigned(tail);
    if (!shift) return shift.error;
    if (*shift > 2 * max_decimal_exponent) return Error::out_of_range;
    exponent += down ? -static_cast<int>(*shift) : static_cast<int>(*shift);
  }
  if (!negative && digits == INT64_MIN) return Error::out_of_range;
  return detail::bounded(negative ? digits : -digits, exponent);
}

/// Plain notation without an exponent, shortest: 0.0525, -930, 1200. At most 120 characters for exponents up
/// to max_decimal_exponent.
template <std::size_t N>
constexpr Text<N>& print(Text<N>& out, Decimal number) noexcept {
  const std::uint64_t magnitude = detail::magnitude(number.digits);
  if (number.digits < 0) out << '-';
  if (number.exponent >= 0) {
    out.decimal(magnitude);
    for (int i = 0; i < number.exponent; ++i) out << '0';
    return out;
  }
  Text<20> digits;
  digits.decimal(magnitude, 1);
  const int places = -number.exponent;
  const int length = static_cast<int>(digits.view().size());
  if (length > places) {
    out << digits.view().substr(0, static_cast<std::size_t>(length - places)) << '.'
        << digits.view().substr(static_cast<std::size_t>(length - places));
  } else {
    out << "0.";
    for (int i = length; i < places; ++i) out << '0';
    out << digits.view();
  }
  return out;
}

[[nodiscard]] constexpr Text<120> to_text(Decimal number) noexcept {
  Text<120> text;
  print(text, number);
  return text;
}

}  // namespace ocm::base
