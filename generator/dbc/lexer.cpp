#include "generator/dbc/lexer.hpp"

#include <array>

namespace ocm::dbc {
namespace {

enum class Class : unsigned char { word, blank, alone, quote };

/// By a table: a file has a million characters, and each is asked about.
constexpr auto classes = [] {
  std::array<Class, 256> table{};
  for (const char c : {' ', '\t', '\r', '\n', '\f', '\v', '\0'})
    table[static_cast<unsigned char>(c)] = Class::blank;
  for (const char c : std::string_view{":;,|@()[]"}) table[static_cast<unsigned char>(c)] = Class::alone;
  table[static_cast<unsigned char>('"')] = Class::quote;
  return table;
}();
constexpr Class class_of(char c) noexcept {
  return classes[static_cast<unsigned char>(c)];
}

}  // namespace

void Lexer::advance() {
  // Locals: a store to a member of this object could be one to the text.
  const char* const end = text_.data() + text_.size();
  const char* at = text_.data() + at_;
  for (; at != end && class_of(*at) == Class::blank; ++at) {
    if (*at != '\n') continue;
    ++line_;
    fresh_line_ = true;
  }
  next_ = {Token::Kind::end, {}, line_, fresh_line_};
  fresh_line_ = false;
  const char* const begin = at;
  const Class first = at == end ? Class::blank : class_of(*at);
  switch (first) {
    case Class::blank:
      break;
    case Class::alone:
      next_.kind = Token::Kind::character;
      next_.text = {begin, 1};
      ++at;
      break;
    case Class::word:
      next_.kind = Token::Kind::word;
      while (at != end && class_of(*at) == Class::word) ++at;
      next_.text = {begin, static_cast<std::size_t>(at - begin)};
      break;
    case Class::quote:
      for (++at; at != end && *at != '"'; ++at) {
        if (*at == '\n') ++line_;
        if (*at == '\\' && at + 1 != end && at[1] == '"') ++at;
      }
      next_.kind = at != end ? Token::Kind::string : Token::Kind::open_string;
      next_.text = {begin + 1, static_cast<std::size_t>(at - begin - 1)};
      if (at != end) ++at;
      break;
  }
  at_ = static_cast<std::size_t>(at - text_.data());
}

std::string unescaped(std::string_view text) {
  if (text.find('\\') == std::string_view::npos) return std::string{text};
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && text.substr(i + 1, 1) == "\"") continue;
    out += text[i];
  }
  return out;
}

}  // namespace ocm::dbc
