/// The sentences of the mapper: ASCII, integers only, `{LETTER,...}` and a line feed: how they are written,
/// and what is heard. What each says is in sentences.hpp, which is generated from spec/sentences.json.
///
/// No heap, constexpr. Writing is O(characters), at most `max_line`; a field out of its range is refused,
/// never clipped.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ocm/base/result.hpp"
#include "ocm/base/text.hpp"
#include "ocm/mapper/link/field.hpp"
#include "ocm/mapper/link/sentences.hpp"

namespace ocm::mapper::link {

/// Kind::none when there is no such word that way.
[[nodiscard]] constexpr Kind kind_of_word(Direction direction, std::string_view text) noexcept {
  for (const Word& word : words)
    if (word.direction == direction && word.text == text) return word.kind;
  return Kind::none;
}

/// A number takes at most a comma, a sign and five digits.
inline constexpr std::size_t max_number = 7;
/// The longest line that is written: a handshake. `{H`, its numbers, `}`, line feed.
inline constexpr std::size_t max_line = 2 + Handshake::fields.size() * max_number + 2;
using Line = base::Text<max_line>;

namespace detail {

template <std::size_t N>
constexpr void append(base::Text<N>& line, int number) noexcept {
  if (number < 0) line << '-';
  line.decimal(static_cast<std::uint64_t>(number < 0 ? -number : number));
}

template <class T>
[[nodiscard]] constexpr base::Result<Line> write(const T& sentence, std::size_t count) noexcept {
  Line line;
  line << '{' << T::letter;
  for (std::size_t i = 0; i < count; ++i) {
    const Field<T>& field = T::fields[i];
    const std::int16_t number = sentence.*field.member;
    if (number < field.min || number > field.max) return base::Error::out_of_range;
    append(line << ',', number);
  }
  return line << '}' << '\n';
}

}  // namespace detail

/// The line of a sentence; Error::out_of_range when a field is.
[[nodiscard]] constexpr base::Result<Line> write(const SetPoint& sentence) noexcept {
  return detail::write(sentence, SetPoint::fields.size());
}
[[nodiscard]] constexpr base::Result<Line> write(const Update& sentence) noexcept {
  return detail::write(sentence, Update::fields.size());
}
[[nodiscard]] constexpr base::Result<Line> write(const Calibrate& sentence) noexcept {
  return detail::write(sentence, Calibrate::fields.size());
}
[[nodiscard]] constexpr base::Result<Line> write(const Calibration& sentence) noexcept {
  return detail::write(sentence, Calibration::fields.size());
}
/// The first `given` fields; Error::bad_length when that is 0 or more than there are.
[[nodiscard]] constexpr base::Result<Line> write(const Handshake& sentence) noexcept {
  if (sentence.given == 0 || sentence.given > Handshake::fields.size()) return base::Error::bad_length;
  return detail::write(sentence, sentence.given);
}
/// The line of a sentence without integers; Error::bad_syntax for a kind that has some, or none.
[[nodiscard]] constexpr base::Result<Line> write(Kind kind) noexcept {
  Line line;
  if (const std::string_view fixed = fixed_text(kind); !fixed.empty()) return line << fixed << '\n';
  for (const Word& word : words)
    if (word.kind == kind) return line << '{' << word_letter << ',' << word.text << "}\n";
  return base::Error::bad_syntax;
}

/// A sentence that was heard: its kind and its integers, all within their ranges.
struct Sentence {
  Kind kind = Kind::none;
  std::uint8_t count = 0;
  std::array<std::int16_t, max_integers> integers{};

  /// The sentence as a struct; Error::bad_syntax when it is another one.
  template <class T>
  [[nodiscard]] constexpr base::Result<T> as() const noexcept {
    if (kind != T::kind) return base::Error::bad_syntax;
    T out{};
    for (std::size_t i = 0; i < T::fields.size() && i < count; ++i) out.*T::fields[i].member = integers[i];
    if constexpr (requires { out.given; }) out.given = count;
    return out;
  }
};

}  // namespace ocm::mapper::link
