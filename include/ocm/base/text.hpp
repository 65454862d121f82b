/// A bounded text to write into, and the number parsing and printing that the core needs: no heap, no locale.
/// What does not fit is not written; `overflowed()` says so.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ocm/base/result.hpp"

namespace ocm::base {

template <std::size_t N>
class Text {
 public:
  constexpr Text& operator<<(char c) noexcept {
    if (size_ < N)
      chars_[size_++] = c;
    else
      overflowed_ = true;
    return *this;
  }
  constexpr Text& operator<<(std::string_view text) noexcept {
    for (const char c : text) *this << c;
    return *this;
  }
  /// Upper-case hexadecimal with exactly `digits` digits, at most 16.
  constexpr Text& hex(std::uint64_t number, int digits) noexcept {
    for (int i = digits - 1; i >= 0; --i) *this << "0123456789ABCDEF"[(number >> (4 * i)) & 0xF];
    return *this;
  }
  /// Decimal, padded with zeros on the left to `width` digits.
  constexpr Text& decimal(std::uint64_t number, int width = 1) noexcept {
    char digits[20] = {};
    int n = 0;
    do {
      digits[n++] = static_cast<char>('0' + number % 10);
      number /= 10;
    } while (number != 0);
    for (int i = n; i < width; ++i) *this << '0';
    while (n > 0) *this << digits[--n];
    return *this;
  }

  [[nodiscard]] constexpr std::string_view view() const noexcept { return {chars_.data(), size_}; }
  [[nodiscard]] constexpr bool overflowed() const noexcept { return overflowed_; }
  friend constexpr bool operator==(const Text& text, std::string_view other) noexcept {
    return text.view() == other;
  }

 private:
  std::array<char, N> chars_{};
  std::size_t size_ = 0;
  bool overflowed_ = false;
};

/// Value of a hexadecimal digit, or -1.
[[nodiscard]] constexpr int hex_digit(char c) noexcept {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

[[nodiscard]] constexpr bool is_digit(char c) noexcept {
  return c >= '0' && c <= '9';
}

/// All of `text` as an unsigned number in `base` 10 or 16; at most 2^64 - 1.
[[nodiscard]] constexpr Result<std::uint64_t> parse_unsigned(std::string_view text,
                                                             unsigned base = 10) noexcept {
  if (text.empty()) return Error::bad_syntax;
  std::uint64_t number = 0;
  for (const char c : text) {
    const int digit = hex_digit(c);
    if (digit < 0 || static_cast<unsigned>(digit) >= base) return Error::bad_syntax;
    if (number > (UINT64_MAX - static_cast<unsigned>(digit)) / base) return Error::out_of_range;
    number = number * base + static_cast<unsigned>(digit);
  }
  return number;
}

}  // namespace ocm::base
