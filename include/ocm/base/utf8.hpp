/// Text in UTF-8 [RFC 3629]: its characters as columns, as bytes and as numbers of Unicode, and whether it is
/// any. No heap.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ocm/base/swar.hpp"

namespace ocm::base {

/// Whether this byte continues a character, and does not begin one.
[[nodiscard]] constexpr bool continues_character(char byte) noexcept {
  return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U;
}

/// How many columns a terminal takes for it: bytes that continue a character take none. Characters that are
/// wider than one column, or combine with another, count as one.
[[nodiscard]] constexpr std::size_t columns(std::string_view text) noexcept {
  std::size_t count = 0;
  for (const char c : text) count += continues_character(c) ? 0U : 1U;
  return count;
}

/// How many bytes at the beginning of `text` are one character of UTF-8; 0: they are none. [RFC 3629]
[[nodiscard]] constexpr std::size_t utf8_length(std::string_view text) noexcept {
  if (text.empty()) return 0;
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  const std::size_t length = first < 0x80   ? 1
                             : first < 0xC2 ? 0
                             : first < 0xE0 ? 2
                             : first < 0xF0 ? 3
                             : first < 0xF5 ? 4
                                            : 0;
  if (length == 0 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if (!continues_character(text[i])) return 0;
  if (length < 3) return length;
  const unsigned second = byte(1);
  const bool overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool beyond = (first == 0xED && second > 0x9F) || (first == 0xF4 && second > 0x8F);
  return overlong || beyond ? 0 : length;
}

/// Whether all of it is UTF-8. Nearly all text has 7 bits a character: eight of them at once.
[[nodiscard]] constexpr bool is_utf8(std::string_view text) noexcept {
  while (!text.empty()) {
    std::size_t length = utf8_length(text);
    if (text.size() >= 8 && (swar::load64(text.data()) & swar::each(0x80)) == 0) length = 8;
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

/// One character as its 1 to 4 bytes.
struct Utf8Character {
  std::array<char, 4> bytes{};
  std::size_t size = 0;
  [[nodiscard]] constexpr std::string_view view() const noexcept { return {bytes.data(), size}; }
};

/// The character of a number of Unicode, at most 0x10FFFF. Halves of a pair of UTF-16 (0xD800 to 0xDFFF) are
/// none: the caller refuses them.
[[nodiscard]] constexpr Utf8Character utf8_of(char32_t code) noexcept {
  const auto byte = [](std::uint32_t value) { return static_cast<char>(static_cast<unsigned char>(value)); };
  const auto tail = [&](unsigned shift) { return byte(0x80U | (code >> shift & 0x3FU)); };
  if (code < 0x80) return {{byte(code)}, 1};
  if (code < 0x800) return {{byte(0xC0U | code >> 6), tail(0)}, 2};
  if (code < 0x10000) return {{byte(0xE0U | code >> 12), tail(6), tail(0)}, 3};
  return {{byte(0xF0U | code >> 18), tail(12), tail(6), tail(0)}, 4};
}

/// The number of Unicode of one character, as long as `utf8_length` says.
[[nodiscard]] constexpr char32_t unicode_of(std::string_view character) noexcept {
  const std::uint32_t first = static_cast<unsigned char>(character[0]);
  std::uint32_t code = character.size() == 1 ? first : first & (0xFFU >> (character.size() + 1));
  for (std::size_t i = 1; i < character.size(); ++i)
    code = code << 6 | (static_cast<unsigned char>(character[i]) & 0x3FU);
  return code;
}

}  // namespace ocm::base
