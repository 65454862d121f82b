#include "generator/spec/names.hpp"

#include <algorithm>
#include <iterator>
#include <vector>

namespace ocm::spec {

namespace {

bool is_lower(char c) noexcept {
  return c >= 'a' && c <= 'z';
}
bool is_digit(char c) noexcept {
  return c >= '0' && c <= '9';
}

// [ISO C++20, 5.11], the alternative tokens, and the lower-case macros of GCC in its GNU mode. Sorted.
// clang-format off
constexpr std::string_view reserved[] = {
    "alignas", "alignof", "and", "and_eq", "asm", "assert", "auto", "bitand", "bitor", "bool", "break",
    "case", "catch", "char", "char16_t", "char32_t", "char8_t", "class", "co_await", "co_return",
    "co_yield", "compl", "concept", "const", "const_cast", "consteval", "constexpr", "constinit",
    "continue", "decltype", "default", "delete", "do", "double", "dynamic_cast", "else", "enum", "errno",
    "explicit", "export", "extern", "false", "float", "for", "friend", "goto", "i386", "if", "inline",
    "int", "linux", "long", "mutable", "namespace", "new", "noexcept", "not", "not_eq", "nullptr",
    "operator", "or", "or_eq", "private", "protected", "public", "register", "reinterpret_cast", "requires",
    "return", "short", "signed", "sizeof", "static", "static_assert", "static_cast", "stderr", "stdin",
    "stdout", "struct", "switch", "template", "this", "thread_local", "throw", "true", "try", "typedef",
    "typeid", "typename", "union", "unix", "unsigned", "using", "virtual", "void", "volatile", "wchar_t",
    "while", "xor", "xor_eq",
};
// clang-format on

}  // namespace

bool is_name(std::string_view text) noexcept {
  if (text.empty() || !is_lower(text.front()) || text.back() == '_') return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (!is_lower(text[i]) && !is_digit(text[i]) && text[i] != '_') return false;
    if (text[i] == '_' && text[i - 1] == '_') return false;
  }
  return true;
}

bool is_word(std::string_view text) noexcept {
  static constexpr std::string_view apart = ":;,|@()[]\"";
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return static_cast<unsigned char>(c) > ' ' && c != '\x7F' && apart.find(c) == std::string_view::npos;
  });
}

bool is_reserved(std::string_view name) noexcept {
  return std::binary_search(std::begin(reserved), std::end(reserved), name);
}

std::string pascal_case(std::string_view name) {
  std::string out;
  bool upper = true;
  for (const char c : name) {
    if (c == '_') {
      upper = true;
      continue;
    }
    out += upper && is_lower(c) ? static_cast<char>(c - 'a' + 'A') : c;
    upper = false;
  }
  return out;
}

std::string unit_name(std::string_view unit) {
  struct Reading {
    std::string_view sign;
    std::string_view word;
  };
  // What follows a sign that stands between two letters is parted by an underscore.
  static constexpr Reading readings[] = {{"/", "_per_"},  {"%", "percent"}, {"\u00b0", "deg"},
                                         {"\u00b5", "u"}, {"\u03bc", "u"},  {"\u00b2", "2"},
                                         {"\u00b3", "3"}, {"^", ""},        {"*", "_"},
                                         {" ", "_"},      {"\u00b7", "_"},  {"\u03a9", "ohm"}};
  std::string out;
  while (!unit.empty()) {
    const char c = unit.front();
    if (is_lower(c) || is_digit(c) || (c >= 'A' && c <= 'Z') || c == '_') {
      out += c;
      unit.remove_prefix(1);
      continue;
    }
    const auto reading = std::find_if(std::begin(readings), std::end(readings), [&](const Reading& r) {
      return unit.substr(0, r.sign.size()) == r.sign;
    });
    if (reading == std::end(readings)) return {};
    out += reading->word;
    unit.remove_prefix(reading->sign.size());
  }
  while (!out.empty() && out.front() == '_') out.erase(0, 1);  // "1/s" stays, "/s" reads per_s
  while (!out.empty() && out.back() == '_') out.pop_back();
  if (out.find("__") != std::string::npos) return {};
  return out;
}

}  // namespace ocm::spec
