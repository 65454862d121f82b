#include "generator/dbc/lexer.hpp"

namespace ocm::dbc {
namespace {

constexpr bool is_blank(char c) noexcept {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v' || c == '\0';
}
constexpr bool stands_alone(char c) noexcept {
  return std::string_view{":;,|@()[]"}.find(c) != std::string_view::npos;
}

}  // namespace

void Lexer::advance() {
  for (; at_ < text_.size() && is_blank(text_[at_]); ++at_) {
    if (text_[at_] != '\n') continue;
    ++line_;
    fresh_line_ = true;
  }
  next_ = {Token::Kind::end, {}, line_, fresh_line_};
  fresh_line_ = false;
  if (at_ == text_.size()) return;
  const std::size_t begin = at_;
  if (stands_alone(text_[at_])) {
    next_.kind = Token::Kind::character;
    next_.text = text_.substr(at_++, 1);
    return;
  }
  if (text_[at_] != '"') {
    next_.kind = Token::Kind::word;
    while (at_ < text_.size() && !is_blank(text_[at_]) && !stands_alone(text_[at_]) && text_[at_] != '"')
      ++at_;
    next_.text = text_.substr(begin, at_ - begin);
    return;
  }
  for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_) {
    if (text_[at_] == '\n') ++line_;
    if (text_[at_] == '\\' && text_.substr(at_ + 1, 1) == "\"") ++at_;
  }
  next_.kind = at_ < text_.size() ? Token::Kind::string : Token::Kind::open_string;
  next_.text = text_.substr(begin + 1, at_ - begin - 1);
  if (at_ < text_.size()) ++at_;
}

std::string unescaped(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && text.substr(i + 1, 1) == "\"") continue;
    out += text[i];
  }
  return out;
}

}  // namespace ocm::dbc
