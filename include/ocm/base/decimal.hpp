/// Exact decimal numbers: a scale of 0.0175 is 175 * 10^-4 and not the nearest binary fraction, so that three
/// digits of a gyroscope print as 0.0525 and not as 0.052500000000000005.
#pragma once

#include <cstdint>
#include <string_view>

#include "ocm/base/result.hpp"
#include "ocm/base/text.hpp"

namespace ocm::base {

/// `digits * 10^exponent`. Normalised: no trailing zero in `digits` unless it is 0, and then exponent 0.
struct Decimal {
  std::int64_t digits = 0;
  std::int8_t exponent = 0;

  friend constexpr bool operator==(const Decimal&, const Decimal&) = default;
  [[nodiscard]] constexpr double as_double() const noexcept {
    // Dividing by an exact power of ten rounds once; multiplying by 10^-n would round twice.
    double power = 1;
    const int n = exponent < 0 ? -exponent : exponent;
    for (int i = 0; i < n; ++i) power *= 10;
    return exponent < 0 ? static_cast<double>(digits) / power : static_cast<double>(digits) * power;
  }
};

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
}  // namespace detail

/// a * b; out_of_range where the product needs more than 63 bits of digits.
[[nodiscard]] constexpr Result<Decimal> multiply(Decimal a, Decimal b) noexcept {
  std::int64_t product = 0;
  if (detail::multiply_overflows(a.digits, b.digits, product)) return Error::out_of_range;
  return normalised(product, a.exponent + b.exponent);
}

/// a + b, exact or out_of_range.
[[nodiscard]] constexpr Result<Decimal> add(Decimal a, Decimal b) noexcept {
  if (a.digits == 0) return b;
  if (b.digits == 0) return a;
  const int exponent = a.exponent < b.exponent ? a.exponent : b.exponent;
  const auto x = detail::scaled(a.digits, a.exponent - exponent);
  const auto y = detail::scaled(b.digits, b.exponent - exponent);
  std::int64_t sum = 0;
  if (!x || !y || __builtin_add_overflow(*x, *y, &sum)) return Error::out_of_range;
  return normalised(sum, exponent);
}

[[nodiscard]] constexpr Result<Decimal> subtract(Decimal a, Decimal b) noexcept {
  if (b.digits == INT64_MIN) return Error::out_of_range;
  return add(a, Decimal{-b.digits, b.exponent});
}

/// a / b rounded half away from zero to a whole number.
[[nodiscard]] constexpr Result<std::int64_t> divide_rounded(Decimal a, Decimal b) noexcept {
  if (b.digits == 0) return Error::out_of_range;
  const int exponent = a.exponent < b.exponent ? a.exponent : b.exponent;
  // Exponents differ by more than 18 only when the quotient is far out of range or zero.
  const auto numerator = detail::scaled(a.digits, a.exponent - exponent);
  if (!numerator) return a.digits == 0 ? Result<std::int64_t>{0} : Error::out_of_range;
  const auto denominator = detail::scaled(b.digits, b.exponent - exponent);
  if (!denominator) return std::int64_t{0};
  if (*numerator == INT64_MIN || *denominator == INT64_MIN) return Error::out_of_range;
  const bool negative = (*numerator < 0) != (*denominator < 0);
  const std::uint64_t n = static_cast<std::uint64_t>(*numerator < 0 ? -*numerator : *numerator);
  const std::uint64_t d = static_cast<std::uint64_t>(*denominator < 0 ? -*denominator : *denominator);
  const std::uint64_t quotient = n / d + (n % d >= d - n % d ? 1 : 0);
  return negative ? -static_cast<std::int64_t>(quotient) : static_cast<std::int64_t>(quotient);
}

/// Three-way: negative, zero or positive as a < b, a == b, a > b. Exact for every pair.
[[nodiscard]] constexpr int compare(Decimal a, Decimal b) noexcept {
  const int sign_a = a.digits < 0 ? -1 : a.digits > 0;
  const int sign_b = b.digits < 0 ? -1 : b.digits > 0;
  if (sign_a != sign_b) return sign_a - sign_b;
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
  bool point = false;
  bool any = false;
  std::size_t i = 0;
  for (; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '.' && !point) {
      point = true;
    } else if (is_digit(c)) {
      any = true;
      if (detail::multiply_overflows(digits, 10, digits) || __builtin_add_overflow(digits, c - '0', &digits))
        return Error::out_of_range;
      if (point && --exponent < -100) return Error::out_of_range;
    } else {
      break;
    }
  }
  if (!any) return Error::bad_syntax;
  if (i < text.size()) {
    if (text[i] != 'e' && text[i] != 'E') return Error::bad_syntax;
    std::string_view tail = text.substr(i + 1);
    const bool down = !tail.empty() && tail.front() == '-';
    if (!tail.empty() && (tail.front() == '-' || tail.front() == '+')) tail.remove_prefix(1);
    const auto shift = parse_unsigned(tail);
    if (!shift) return shift.error;
    if (*shift > 100) return Error::out_of_range;
    exponent += down ? -static_cast<int>(*shift) : static_cast<int>(*shift);
  }
  if (exponent < -100 || exponent > 100) return Error::out_of_range;
  return normalised(negative ? -digits : digits, exponent);
}

/// Plain notation without an exponent, shortest: 0.0525, -930, 1200. At most 130 characters.
template <std::size_t N>
constexpr Text<N>& print(Text<N>& out, Decimal number) noexcept {
  std::uint64_t magnitude = static_cast<std::uint64_t>(number.digits);
  if (number.digits < 0) {
    out << '-';
    magnitude = 0 - magnitude;
  }
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

[[nodiscard]] constexpr Text<132> to_text(Decimal number) noexcept {
  Text<132> text;
  print(text, number);
  return text;
}

}  // namespace ocm::base
