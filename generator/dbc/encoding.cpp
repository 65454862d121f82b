#include "generator/dbc/encoding.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace ocm::dbc {
namespace {

/// Code page 1252 from 0x80 to 0x9F; from 0xA0 on it is Unicode. [unicode.org, CP1252.TXT]
constexpr std::array<char16_t, 32> cp1252 = {0x20AC, 0xFFFD, 0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021,
                                             0x02C6, 0x2030, 0x0160, 0x2039, 0x0152, 0xFFFD, 0x017D, 0xFFFD,
                                             0xFFFD, 0x2018, 0x2019, 0x201C, 0x201D, 0x2022, 0x2013, 0x2014,
                                             0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0xFFFD, 0x017E, 0x0178};

void append_utf8(std::string& out, char32_t code) {
  if (code < 0x80) {
    out += static_cast<char>(code);
  } else if (code < 0x800) {
    out += static_cast<char>(0xC0 | code >> 6);
    out += static_cast<char>(0x80 | (code & 0x3F));
  } else {
    out += static_cast<char>(0xE0 | code >> 12);
    out += static_cast<char>(0x80 | (code >> 6 & 0x3F));
    out += static_cast<char>(0x80 | (code & 0x3F));
  }
}

}  // namespace

bool is_utf8(std::string_view bytes) noexcept {
  for (std::size_t i = 0; i < bytes.size();) {
    // Nearly all of it has 7 bits: eight characters at once.
    if (i + 8 <= bytes.size()) {
      std::uint64_t eight = 0;
      std::memcpy(&eight, bytes.data() + i, 8);
      if ((eight & 0x8080'8080'8080'8080) == 0) {
        i += 8;
        continue;
      }
    }
    const auto at = [&](std::size_t j) {
      return i + j < bytes.size() ? static_cast<std::uint8_t>(bytes[i + j]) : std::uint8_t{0};
    };
    const std::uint8_t first = at(0);
    if (first < 0x80) {
      ++i;
      continue;
    }
    const std::size_t length = first >= 0xC2 && first < 0xE0   ? 2
                               : first >= 0xE0 && first < 0xF0 ? 3
                               : first >= 0xF0 && first < 0xF5 ? 4
                                                               : 0;
    if (length == 0) return false;
    for (std::size_t j = 1; j < length; ++j)
      if (at(j) >> 6 != 2) return false;
    // Longer than needed, a surrogate, or beyond U+10FFFF.
    if (first == 0xE0 && at(1) < 0xA0) return false;
    if (first == 0xED && at(1) > 0x9F) return false;
    if (first == 0xF0 && at(1) < 0x90) return false;
    if (first == 0xF4 && at(1) > 0x8F) return false;
    i += length;
  }
  return true;
}

std::optional<std::string_view> as_utf8(std::string_view bytes) noexcept {
  if (!is_utf8(bytes)) return std::nullopt;
  if (bytes.substr(0, 3) == "\xEF\xBB\xBF") bytes.remove_prefix(3);
  return bytes;
}

std::string to_utf8(std::string_view bytes) {
  if (const auto same = as_utf8(bytes)) return std::string{*same};
  std::string text;
  text.reserve(bytes.size() + bytes.size() / 8);
  for (const char c : bytes) {
    const auto byte = static_cast<std::uint8_t>(c);
    append_utf8(text, byte >= 0x80 && byte < 0xA0 ? char32_t{cp1252[byte - 0x80U]} : char32_t{byte});
  }
  return text;
}

namespace {

/// The byte of a character, at the front of a text of UTF-8, which is cut off. Nothing: there is none.
std::optional<char> take_cp1252(std::string_view& utf8) noexcept {
  const auto first = static_cast<std::uint8_t>(utf8[0]);
  const std::size_t length = std::min<std::size_t>(first < 0x80   ? 1
                                                   : first < 0xE0 ? 2
                                                   : first < 0xF0 ? 3
                                                                  : 4,
                                                   utf8.size());
  char32_t code = length == 1 ? first : first & (0xFFU >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) code = code << 6 | (static_cast<std::uint8_t>(utf8[i]) & 0x3FU);
  utf8.remove_prefix(length);
  if (code < 0x80 || (code >= 0xA0 && code <= 0xFF)) return static_cast<char>(code);
  const auto at = std::find(cp1252.begin(), cp1252.end(), code);
  if (at == cp1252.end() || code == 0xFFFD) return std::nullopt;
  return static_cast<char>(0x80 + (at - cp1252.begin()));
}

}  // namespace

bool has_cp1252(std::string_view utf8) noexcept {
  while (!utf8.empty())
    if (!take_cp1252(utf8)) return false;
  return true;
}

std::optional<std::string> to_cp1252(std::string_view utf8) {
  std::string bytes;
  bytes.reserve(utf8.size());
  for (std::string_view rest = utf8; !rest.empty();) {
    const auto byte = take_cp1252(rest);
    if (!byte) return std::nullopt;
    bytes += *byte;
  }
  // Bytes that read as UTF-8 would be taken for it.
  if (bytes != utf8 && is_utf8(bytes)) return std::nullopt;
  return bytes;
}

}  // namespace ocm::dbc
