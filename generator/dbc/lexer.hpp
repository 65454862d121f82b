/// A DBC file's text as tokens: words, strings and single characters, each with its line. A word is all that
/// stands between blanks and the characters `: ; , | @ ( ) [ ]`: names that begin with a digit and names with
/// a dot are in real files, so what a word is, its statement decides.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace ocm::dbc {

struct Token {
  enum class Kind : unsigned char { end, word, string, character, open_string };
  Kind kind = Kind::end;
  std::string_view text;  ///< of a string: what stands between the quotes, escapes as they are
  std::size_t line = 1;
  bool first_of_line = false;

  [[nodiscard]] bool is(char c) const noexcept { return kind == Kind::character && text.front() == c; }
  [[nodiscard]] bool is_word() const noexcept { return kind == Kind::word; }
  [[nodiscard]] bool is_string() const noexcept { return kind == Kind::string; }
};

class Lexer {
 public:
  /// The text must outlive the tokens.
  explicit Lexer(std::string_view text) : text_(text) { advance(); }

  /// The token that comes next.
  [[nodiscard]] const Token& peek() const noexcept { return next_; }
  Token take() {
    const Token token = next_;
    advance();
    return token;
  }

 private:
  void advance();

  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
  bool fresh_line_ = true;
  Token next_;
};

/// A string's text without its escapes: `\"` is a quote; any other backslash is one.
[[nodiscard]] std::string unescaped(std::string_view text);

}  // namespace ocm::dbc
