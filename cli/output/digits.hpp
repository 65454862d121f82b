/// Numbers as digits, written where the caller has room: eight digits at a time and without branches, because
/// a log of ten million frames has a thousand million of them. Every function returns the end of what it
/// wrote, and may write up to eight bytes more behind it.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>

#include "ocm/base/swar.hpp"

namespace ocm::cli {

inline constexpr std::uint64_t ten_to_8 = 100'000'000;
inline constexpr std::uint64_t ascii_zeros = 0x3030'3030'3030'3030;

/// The eight digits of a number below 10^8 as bytes 0..9, the first digit in the lowest byte. The number is
/// halved into four-digit, two-digit and one-digit lanes; 10486 / 2^20 and 103 / 2^10 are 1/100 and 1/10
/// closely enough for every number of their lane.
[[nodiscard]] constexpr std::uint64_t eight_digits(std::uint32_t number) noexcept {
  const std::uint64_t fours = number / 10'000 | std::uint64_t{number % 10'000} << 32;
  const std::uint64_t hundreds = fours * 10486 >> 20 & 0x0000'007F'0000'007F;
  const std::uint64_t twos = hundreds | (fours - hundreds * 100) << 16;
  const std::uint64_t tens = twos * 103 >> 10 & 0x000F'000F'000F'000F;
  return tens | (twos - tens * 10) << 8;
}

inline void put_word(char* to, std::uint64_t bytes) noexcept {
  static_assert(std::endian::native == std::endian::little);
  std::memcpy(to, &bytes, sizeof bytes);
}

/// Exactly eight digits; the number is below 10^8.
inline char* put_eight(char* to, std::uint64_t number) noexcept {
  put_word(to, eight_digits(static_cast<std::uint32_t>(number)) | ascii_zeros);
  return to + 8;
}

/// Without leading zeros; the number is below 10^8.
inline char* put_short(char* to, std::uint64_t number) noexcept {
  const std::uint64_t digits = eight_digits(static_cast<std::uint32_t>(number));
  // A bit in the last digit: of zero, one digit is left.
  const int zeros = std::countr_zero(digits | std::uint64_t{1} << 56) / 8;
  put_word(to, (digits | ascii_zeros) >> 8 * zeros);
  return to + (8 - zeros);
}

inline char* put_unsigned(char* to, std::uint64_t number) noexcept {
  if (number < ten_to_8) return put_short(to, number);
  if (number < ten_to_8 * ten_to_8)
    to = put_short(to, number / ten_to_8);
  else {
    to = put_short(to, number / (ten_to_8 * ten_to_8));
    to = put_eight(to, number / ten_to_8 % ten_to_8);
  }
  return put_eight(to, number % ten_to_8);
}

inline char* put_signed(char* to, std::int64_t number) noexcept {
  *to = '-';
  to += number < 0 ? 1 : 0;
  return put_unsigned(
      to, number < 0 ? 0 - static_cast<std::uint64_t>(number) : static_cast<std::uint64_t>(number));
}

/// Seconds and nine digits of nanoseconds: 1436509052.249713000.
inline char* put_seconds(char* to, std::int64_t nanoseconds) noexcept {
  *to = '-';
  to += nanoseconds < 0 ? 1 : 0;
  const std::uint64_t magnitude =
      nanoseconds < 0 ? 0 - static_cast<std::uint64_t>(nanoseconds) : static_cast<std::uint64_t>(nanoseconds);
  const std::uint64_t fraction = magnitude % 1'000'000'000;
  to = put_unsigned(to, magnitude / 1'000'000'000);
  *to++ = '.';
  *to++ = static_cast<char>('0' + fraction / ten_to_8);
  return put_eight(to, fraction % ten_to_8);
}

/// Two upper-case digits a byte.
inline char* put_hex(char* to, std::span<const std::uint8_t> bytes) noexcept {
  for (const std::uint8_t byte : bytes) to = base::swar::hex_byte(to, byte);
  return to;
}

/// Exactly `digits` upper-case digits.
inline char* put_hex(char* to, std::uint32_t number, int digits) noexcept {
  for (int i = digits - 1; i >= 0; --i) *to++ = base::swar::upper_digits[number >> 4 * i & 0xF];
  return to;
}

}  // namespace ocm::cli
