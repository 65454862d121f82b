/// Digits eight at a time, in the bytes of a 64-bit word (SIMD within a register): what reading and writing
/// logs and a robot's updates spends its time on. No jump depends on the text. Any byte order and alignment;
/// nothing fails: bad digits are reported or asked for.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace ocm::base::swar {

/// A byte in each of the eight.
[[nodiscard]] constexpr std::uint64_t each(std::uint8_t byte) noexcept {
  return byte * std::uint64_t{0x0101'0101'0101'0101};
}

/// Eight characters, the first in the lowest byte.
[[nodiscard]] constexpr std::uint64_t load64(const char* text) noexcept {
  std::array<char, 8> bytes{};
  std::string_view{text, bytes.size()}.copy(bytes.data(), bytes.size());
  const auto word = std::bit_cast<std::uint64_t>(bytes);
  return std::endian::native == std::endian::little ? word : __builtin_bswap64(word);
}
/// Two characters, the first in the low byte.
[[nodiscard]] constexpr std::uint16_t load16(const char* text) noexcept {
  return static_cast<std::uint16_t>(static_cast<std::uint8_t>(text[0]) | static_cast<std::uint8_t>(text[1])
                                                                             << 8);
}

/// Whether all eight characters are 0 to 9.
[[nodiscard]] constexpr bool are_digits(std::uint64_t text) noexcept {
  return ((text & each(0xF0)) | ((text + each(0x06)) & each(0xF0)) >> 4) == each(0x33);
}

/// Eight decimal digits as a number: pairs, then pairs of pairs.
[[nodiscard]] constexpr std::uint64_t decimal(std::uint64_t digits) noexcept {
  digits &= each(0x0F);
  digits = (digits * 10 + (digits >> 8)) & 0x00FF'00FF'00FF'00FF;
  digits = (digits * 100 + (digits >> 16)) & 0x0000'FFFF'0000'FFFF;
  return (digits * 10'000 + (digits >> 32)) & 0xFFFF'FFFF;
}

/// Eight characters read as hexadecimal digits, of either case, as far as they are.
struct Hex {
  std::uint64_t values;  ///< a byte a digit; zero from the first other character on
  std::uint64_t bad;     ///< of the characters that are none some bit is set
  /// How many digits stand in front.
  [[nodiscard]] constexpr unsigned count() const noexcept {
    return static_cast<unsigned>(std::countr_zero(bad)) / 8;  // 8 for a word without any
  }
  /// Pairs of digits as bytes, the first in the lowest byte.
  [[nodiscard]] constexpr std::uint32_t bytes() const noexcept {
    std::uint64_t pairs = (values << 4 | values >> 8) & 0x00FF'00FF'00FF'00FF;
    pairs = (pairs | pairs >> 8) & 0x0000'FFFF'0000'FFFF;
    return static_cast<std::uint32_t>(pairs | pairs >> 16);
  }
};

[[nodiscard]] constexpr Hex hex(std::uint64_t text) noexcept {
  // Letters have bit 6: their low four bits count from 1, and bit 5 tells the case.
  const std::uint64_t letter = text >> 6 & each(0x01);
  const std::uint64_t value = (text & each(0x0F)) + letter * 9;
  const std::uint64_t high = (text & (each(0xF0) - letter * 0x20)) ^ (each(0x30) + letter * 0x10);
  // Digits end at 9 and letters begin at 10: adding 6 carries for letters only; none carries by itself.
  const std::uint64_t low = (((value + each(0x06)) ^ letter << 4) | value) & each(0x10);
  const std::uint64_t bad = high | low;
  const unsigned good = static_cast<unsigned>(std::countr_zero(bad)) & ~7U;  // bits, 64 for all
  return {value & ((good < 64 ? std::uint64_t{1} << good : 0) - 1), bad};
}

[[nodiscard]] constexpr std::uint32_t big_endian(std::uint32_t word) noexcept {
  return word << 24 | (word & 0xFF00) << 8 | (word >> 8 & 0xFF00) | word >> 24;
}

inline constexpr char upper_digits[] = "0123456789ABCDEF";

namespace detail {
struct Pair {
  char text[2];
};
inline constexpr auto hex_pairs = [] {
  std::array<Pair, 256> pairs{};
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i] = {{upper_digits[i >> 4], upper_digits[i & 0xF]}};
  return pairs;
}();
inline constexpr auto decimal_pairs = [] {
  std::array<Pair, 100> pairs{};
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i] = {{upper_digits[i / 10], upper_digits[i % 10]}};
  return pairs;
}();
}  // namespace detail

/// Each writes at `at` and returns the place behind.
inline char* hex_byte(char* at, std::uint8_t byte) noexcept {
  std::memcpy(at, detail::hex_pairs[byte].text, 2);
  return at + 2;
}
/// Below 100.
inline char* two_digits(char* at, std::uint32_t number) noexcept {
  std::memcpy(at, detail::decimal_pairs[static_cast<std::size_t>(number)].text, 2);
  return at + 2;
}
/// Below 100'000'000.
inline char* eight_digits(char* at, std::uint32_t number) noexcept {
  const std::uint32_t high = number / 10'000, low = number % 10'000;
  at = two_digits(at, high / 100);
  at = two_digits(at, high % 100);
  at = two_digits(at, low / 100);
  return two_digits(at, low % 100);
}
inline char* copy(char* at, std::string_view text) noexcept {
  std::memcpy(at, text.data(), text.size());
  return at + text.size();
}

}  // namespace ocm::base::swar
