/// Whose packet it is: the central puts `[index]:name:` before each one that it forwards, in the middle of a
/// sentence as well. Writes prefixes, and takes them out of a stream again, a character at a time; logs have
/// a blank behind the bracket as well. [Thesis 2, listing 15.1]
///
/// No heap, constexpr, O(1) a character. Nothing that looks like the beginning of a prefix is ever passed on:
/// a broken one is counted, and what follows belongs to no robot until the next.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ocm/base/text.hpp"

namespace ocm::mapper::link {

inline constexpr std::size_t max_name = 20;
using Name = base::Text<max_name>;
using Prefix = base::Text<1 + 3 + 2 + max_name + 1>;

/// Whether a name may have it: printed, and not one of those that structure the line.
[[nodiscard]] constexpr bool fits_name(char c) noexcept {
  return c >= ' ' && c <= '~' && std::string_view{":[]{}"}.find(c) == std::string_view::npos;
}

/// A name as it is safe on the line: what does not fit becomes `_`, what is too long is cut, an empty one is
/// `?`.
[[nodiscard]] constexpr Name safe_name(std::string_view name) noexcept {
  Name safe;
  for (const char c : name.substr(0, max_name)) safe << (fits_name(c) ? c : '_');
  if (name.empty()) safe << '?';
  return safe;
}

/// `[0]:AVR:`
[[nodiscard]] constexpr Prefix write_prefix(std::uint8_t index, std::string_view name) noexcept {
  return (Prefix{} << '[').decimal(index) << "]:" << safe_name(name).view() << ':';
}

class PrefixFilter {
 public:
  enum class Step : std::uint8_t {
    text,      ///< the character is of the stream, from `source()`
    prefix,    ///< it is of a prefix
    source,    ///< it completes one: `source()` has changed, or is said again
    no_robot,  ///< it is of the stream, but not known whose
  };

  /// `known`: until the first prefix the stream is that of source 0, as on a line without a central.
  constexpr explicit PrefixFilter(bool known = false) noexcept : known_(known) {}

  constexpr Step feed(char c) noexcept {
    if (c == '[') {
      if (state_ != State::outside) ++broken_;
      known_ = false;
      state_ = State::index;
      index_ = 0;
      length_ = 0;
      return Step::prefix;
    }
    switch (state_) {
      case State::outside:
        return known_ ? Step::text : Step::no_robot;
      case State::index:
        return index(c);
      case State::bracket:
        if (c == ' ') return ++length_ <= max_blanks ? Step::prefix : give_up();
        if (c != ':') return give_up();
        state_ = State::name;
        length_ = 0;
        return Step::prefix;
      case State::name:
        return name(c);
    }
    return Step::no_robot;
  }

  /// 0 .. 255; of the last whole prefix.
  [[nodiscard]] constexpr std::uint8_t source() const noexcept { return source_; }
  /// Prefixes that were begun and are none; it wraps.
  [[nodiscard]] constexpr std::uint32_t broken() const noexcept { return broken_; }

 private:
  enum class State : std::uint8_t { outside, index, bracket, name };
  static constexpr std::uint8_t max_blanks = 2;

  constexpr Step index(char c) noexcept {
    if (c == ']' && length_ > 0) {
      state_ = State::bracket;
      length_ = 0;
      return Step::prefix;
    }
    if (!base::is_digit(c)) return give_up();
    index_ = static_cast<std::uint16_t>(index_ * 10U + static_cast<unsigned>(c - '0'));
    return ++length_ <= 3 && index_ <= 255 ? Step::prefix : give_up();
  }
  constexpr Step name(char c) noexcept {
    if (c == ':' && length_ > 0) {
      state_ = State::outside;
      source_ = static_cast<std::uint8_t>(index_);
      known_ = true;
      return Step::source;
    }
    return fits_name(c) && ++length_ <= max_name ? Step::prefix : give_up();
  }
  constexpr Step give_up() noexcept {
    ++broken_;
    state_ = State::outside;
    return Step::no_robot;
  }

  std::uint32_t broken_ = 0;
  std::uint16_t index_ = 0;
  std::uint8_t length_ = 0;
  std::uint8_t source_ = 0;
  bool known_ = false;
  State state_ = State::outside;
};

}  // namespace ocm::mapper::link
