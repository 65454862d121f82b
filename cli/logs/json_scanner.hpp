/// Goes through one line of JSON without a tree and without a copy: a log has millions of them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "ocm/base/text.hpp"

namespace ocm::cli::logs {

/// A value as written in the line: of a string what is between its quotes.
struct JsonValue {
  std::string_view text;
  bool is_string = false;
  bool escaped = false;
  bool is_there = false;  ///< its key is, whatever the value is
  [[nodiscard]] explicit operator bool() const noexcept { return text.data() != nullptr; }
};

/// Goes through one line of JSON, in place. Each function is false where the line is not what it asks for.
class JsonScanner {
 public:
  explicit JsonScanner(std::string_view line) : at_(line.data()), end_(line.data() + line.size()) {}

  [[nodiscard]] bool take(char c) {
    skip_blanks();
    if (at_ == end_ || *at_ != c) return false;
    ++at_;
    return true;
  }
  [[nodiscard]] bool at_end() {
    skip_blanks();
    return at_ == end_;
  }
  /// The key and the colon behind it. Keys that matter have no escapes; of others it does not matter.
  [[nodiscard]] bool take_key(std::string_view& key) {
    JsonValue value;
    if (!take_string(value) || !take(':')) return false;
    key = value.text;
    return true;
  }
  /// A string or a number; of anything else nothing is kept.
  [[nodiscard]] bool take_value(JsonValue& value) {
    skip_blanks();
    if (at_ == end_) return false;
    if (*at_ == '"') return take_string(value);
    if (*at_ == '-' || base::is_digit(*at_)) {
      const char* const begin = at_;
      while (at_ != end_ && is_of_number(*at_)) ++at_;
      value = {{begin, static_cast<std::size_t>(at_ - begin)}, false, false};
      return true;
    }
    value = {};
    return skip_value();
  }
  [[nodiscard]] bool take_boolean(bool& value) {
    value = take_word("true");
    return value || take_word("false");
  }
  /// Any value, whatever is in it.
  [[nodiscard]] bool skip_value(int depth = 0) {
    constexpr int deepest = 32;
    if (depth == deepest) return false;
    skip_blanks();
    if (at_ == end_) return false;
    JsonValue ignored;
    if (*at_ == '{' || *at_ == '[') return skip_container(depth);
    if (*at_ == '"' || *at_ == '-' || base::is_digit(*at_)) return take_value(ignored);
    return take_word("true") || take_word("false") || take_word("null");
  }

 private:
  static bool is_of_number(char c) {
    return base::is_digit(c) || c == '.' || c == '-' || c == '+' || c == 'e' || c == 'E';
  }
  void skip_blanks() {
    while (at_ != end_ && (*at_ == ' ' || *at_ == '\t' || *at_ == '\r')) ++at_;
  }
  bool take_word(std::string_view word) {
    skip_blanks();
    if (!std::string_view{at_, static_cast<std::size_t>(end_ - at_)}.starts_with(word)) return false;
    at_ += word.size();
    return true;
  }
  bool take_string(JsonValue& value) {
    if (!take('"')) return false;
    const char* const begin = at_;
    bool escaped = false;
    while (at_ != end_ && *at_ != '"') {
      if (static_cast<unsigned char>(*at_) < 0x20) return false;
      if (*at_ == '\\') {
        escaped = true;
        if (++at_ == end_) return false;
      }
      ++at_;
    }
    if (at_ == end_) return false;
    value = {{begin, static_cast<std::size_t>(at_ - begin)}, true, escaped};
    ++at_;
    return true;
  }
  bool skip_container(int depth) {
    const bool object = *at_ == '{';
    const char closing = object ? '}' : ']';
    ++at_;
    if (take(closing)) return true;
    do {
      std::string_view key;
      if (object && !take_key(key)) return false;
      if (!skip_value(depth + 1)) return false;
    } while (take(','));
    return take(closing);
  }

  const char* at_;
  const char* end_;
};

/// The text that the inside of a JSON string means; the counterpart of append_json. false: no JSON.
[[nodiscard]] bool unescape(std::string_view text, std::string& out);

}  // namespace ocm::cli::logs
