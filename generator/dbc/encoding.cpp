#include "generator/dbc/encoding.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "ocm/base/utf8.hpp"

namespace ocm::dbc {
namespace {

/// Code page 1252 from 0x80 to 0x9F; from 0xA0 on it is Unicode. [unicode.org, CP1252.TXT]
constexpr std::array<char16_t, 32> cp1252 = {0x20AC, 0xFFFD, 0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021,
                                             0x02C6, 0x2030, 0x0160, 0x2039, 0x0152, 0xFFFD, 0x017D, 0xFFFD,
                                             0xFFFD, 0x2018, 0x2019, 0x201C, 0x201D, 0x2022, 0x2013, 0x2014,
                                             0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0xFFFD, 0x017E, 0x0178};

}  // namespace

std::optional<std::string_view> as_utf8(std::string_view bytes) noexcept {
  if (!base::is_utf8(bytes)) return std::nullopt;
  if (bytes.substr(0, 3) == "\xEF\xBB\xBF") bytes.remove_prefix(3);
  return bytes;
}

std::string to_utf8(std::string_view bytes) {
  if (const auto same = as_utf8(bytes)) return std::string{*same};
  std::string text;
  text.reserve(bytes.size() + bytes.size() / 8);
  for (const char c : bytes) {
    const auto byte = static_cast<std::uint8_t>(c);
    text += base::utf8_of(byte >= 0x80 && byte < 0xA0 ? cp1252[byte - 0x80U] : byte).view();
  }
  return text;
}

namespace {

/// The byte of a character, at the front of a text of UTF-8, which is cut off. Nothing: there is none.
std::optional<char> take_cp1252(std::string_view& utf8) noexcept {
  const std::size_t length = std::max<std::size_t>(base::utf8_length(utf8), 1);
  const char32_t code = base::unicode_of(utf8.substr(0, length));
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
  if (bytes != utf8 && base::is_utf8(bytes)) return std::nullopt;
  return bytes;
}

}  // namespace ocm::dbc
