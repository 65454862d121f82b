/// Raw numbers of values with more digits than a base::Decimal has: an unsigned word of 64 bits, or one with
/// a scale of many digits. Slow, and asked only where base::parse_decimal or Field::raw_from say
/// out_of_range.
#pragma once

#include <cstdint>
#include <string_view>

#include "ocm/base/decimal.hpp"
#include "ocm/base/result.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::cli::words {

#ifdef __SIZEOF_INT128__

namespace detail {
__extension__ using Wide = __int128;

/// number * 10^places, or false.
[[nodiscard]] constexpr bool scale_up(Wide& number, int places) noexcept {
  for (; places > 0; --places)
    if (__builtin_mul_overflow(number, Wide{10}, &number)) return false;
  return true;
}
}  // namespace detail

/// The raw number of an integer field that is nearest to a number such as 18446744073709551615 or 1.25 (no
/// exponent); out_of_range where the field's range, or that of 127 bits, ends before.
[[nodiscard]] constexpr base::Result<std::int64_t> wide_raw_from(const protocol::Field& field,
                                                                 std::string_view text) noexcept {
  using detail::Wide;
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
  Wide number = 0;
  int exponent = 0;
  bool point = false;
  if (text.empty()) return base::Error::bad_syntax;
  for (const char c : text) {
    if (c == '.' && !point) {
      point = true;
      continue;
    }
    if (!base::is_digit(c)) return base::Error::bad_syntax;
    if (__builtin_mul_overflow(number, Wide{10}, &number) ||
        __builtin_add_overflow(number, Wide{c - '0'}, &number))
      return base::Error::out_of_range;
    exponent -= point ? 1 : 0;
  }
  if (negative) number = -number;
  // number - offset, and scale, in units of the same power of ten
  int least = exponent < field.scale.exponent ? exponent : field.scale.exponent;
  if (field.offset.digits != 0 && field.offset.exponent < least) least = field.offset.exponent;
  Wide offset = field.offset.digits;
  Wide scale = field.scale.digits;
  if (!detail::scale_up(number, exponent - least) || !detail::scale_up(scale, field.scale.exponent - least) ||
      (offset != 0 && !detail::scale_up(offset, field.offset.exponent - least)) ||
      __builtin_sub_overflow(number, offset, &number) || scale == 0)
    return base::Error::out_of_range;
  Wide raw = number / scale;
  const Wide rest = number % scale;
  const Wide left = rest < 0 ? -rest : rest;
  const Wide whole = scale < 0 ? -scale : scale;
  if (left >= whole - left) raw += (number < 0) == (scale < 0) ? 1 : -1;
  const bool word =
      !field.is_signed && field.position.width == 64 && field.raw_min == 0 && field.raw_max == INT64_MAX;
  if (raw < field.raw_min || raw > (word ? Wide{UINT64_MAX} : Wide{field.raw_max}))
    return base::Error::out_of_range;
  return static_cast<std::int64_t>(raw);  // an unsigned word as the same bits
}

#else

[[nodiscard]] constexpr base::Result<std::int64_t> wide_raw_from(const protocol::Field&,
                                                                 std::string_view) noexcept {
  return base::Error::out_of_range;
}

#endif

}  // namespace ocm::cli::words
