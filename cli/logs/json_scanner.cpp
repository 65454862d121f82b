#include "cli/logs/json_scanner.hpp"

#include <cstdint>
#include <optional>

#include "ocm/base/utf8.hpp"

namespace ocm::cli::logs {
namespace {

void append_utf8(std::string& out, std::uint32_t code) {
  out += base::utf8_of(code).view();
}

/// Four hexadecimal digits of a \u; nothing when there are none.
std::optional<std::uint32_t> code_unit(std::string_view text) {
  if (text.size() < 6 || text[0] != '\\' || text[1] != 'u') return std::nullopt;
  const auto unit = base::parse_unsigned(text.substr(2, 4), 16);
  return unit ? std::optional{static_cast<std::uint32_t>(*unit)} : std::nullopt;
}

/// Of `\\xff`, which append_json makes of a byte that is no UTF-8; -1: it is none.
int byte_in_words(std::string_view text) {
  if (text.size() < 5 || !text.starts_with(R"(\\x)")) return -1;
  const int high = base::hex_digit(text[3]), low = base::hex_digit(text[4]);
  return high < 0 || low < 0 ? -1 : high << 4 | low;
}

}  // namespace

bool unescape(std::string_view text, std::string& out) {
  out.clear();
  while (!text.empty()) {
    if (text.front() != '\\') {
      out += text.front();
      text.remove_prefix(1);
      continue;
    }
    if (const auto unit = code_unit(text)) {
      text.remove_prefix(6);
      const auto low = code_unit(text);
      const bool pair = *unit >= 0xD800 && *unit < 0xDC00 && low && *low >= 0xDC00 && *low < 0xE000;
      if (pair) {
        append_utf8(out, 0x10000 + ((*unit - 0xD800) << 10) + (*low - 0xDC00));
        text.remove_prefix(6);
      } else if (*unit >= 0xDC80 && *unit <= 0xDCFF) {
        // A byte that is no UTF-8, as earlier versions wrote it. [PEP 383]
        out += static_cast<char>(*unit & 0xFF);
      } else if (*unit >= 0xD800 && *unit < 0xE000) {
        return false;
      } else {
        append_utf8(out, *unit);
      }
      continue;
    }
    if (const int byte = byte_in_words(text); byte >= 0) {
      out += static_cast<char>(byte);
      text.remove_prefix(5);
      continue;
    }
    constexpr std::string_view letters = "\"\\/bfnrt";
    constexpr std::string_view meanings = "\"\\/\b\f\n\r\t";
    const auto i = text.size() < 2 ? std::string_view::npos : letters.find(text[1]);
    if (i == std::string_view::npos) return false;
    out += meanings[i];
    text.remove_prefix(2);
  }
  return true;
}

}  // namespace ocm::cli::logs
