/// The sentences of the mapper: ASCII, integers only, `{LETTER,...}` and a line feed. What each says, its
/// fields with unit and range, and how it is written. spec/sentences.json describes the same; a test holds
/// the two against each other. "Thesis 2" is the thesis on the FreeRTOS mapping robots (2016), tables 4.3
/// and 4.4.
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

namespace ocm::mapper::link {

/// Who a sentence is for: the same letter means different things each way.
enum class Direction : std::uint8_t { to_robot, from_robot };

/// Which sentence; none: not one, or not yet.
enum class Kind : std::uint8_t {
  none,
  confirm,    ///< `{S,CON}` the handshake has come: start
  set_point,  ///< `{U,angle,distance}`
  pause,      ///< `{S,PAU}` hold the tower, send no updates; control goes on
  unpause,    ///< `{S,UNP}`
  packed,     ///< `{S,BIN}` send updates packed (packed.hpp); only to a robot that offered it
  text,       ///< `{S,TXT}` send updates as text again
  ping,       ///< `{}`
  handshake,  ///< `{H,...}` what robot this is, each second until confirmed
  update,     ///< `{U,x,y,heading,servo,s1,s2,s3,s4}`
  idle,       ///< `{S,IDL}` at the set point, or paused
  pong,       ///< `\t!` answers a ping
};

/// A robot may say this many integers in one sentence; only handshakes come near.
inline constexpr std::size_t max_integers = 16;

/// One integer of a sentence T: where it is kept, its unit, and the range outside which the sentence is
/// refused.
template <class T>
struct Field {
  std::int16_t T::*member;
  std::string_view name;
  std::string_view unit;
  std::int16_t min = INT16_MIN;
  std::int16_t max = INT16_MAX;
};

/// New set point, relative to the present pose: turn, then drive. 0, 0 stops. [Thesis 2, table 4.3 and
/// appendix J]
struct SetPoint {
  std::int16_t angle = 0;     ///< degrees, counter-clockwise, [-360, 360]
  std::int16_t distance = 0;  ///< cm, forwards

  static constexpr Kind kind = Kind::set_point;
  static constexpr std::array<Field<SetPoint>, 2> fields{{
      {&SetPoint::angle, "angle", "deg", -360, 360},
      {&SetPoint::distance, "distance", "cm"},
  }};
  friend constexpr bool operator==(const SetPoint&, const SetPoint&) = default;
};

/// Pose and what the tower sees. [Thesis 2, table 4.4]
struct Update {
  std::int16_t x = 0;        ///< cm from the start, along the heading at the start
  std::int16_t y = 0;        ///< cm from the start, to its left
  std::int16_t heading = 0;  ///< degrees, counter-clockwise, [-360, 360]: robots wrap it in either way
  std::int16_t servo = 0;    ///< degrees, angle of the tower, [0, 90] [Thesis 2, table 6.1]
  /// cm, 0: nothing seen, [0, 255]. The part's range ends at 80 cm. [GP2Y0A21YK data sheet]
  std::int16_t s1 = 0;
  std::int16_t s2 = 0;
  std::int16_t s3 = 0;
  std::int16_t s4 = 0;

  static constexpr Kind kind = Kind::update;
  static constexpr std::array<Field<Update>, 8> fields{{
      {&Update::x, "x", "cm"},
      {&Update::y, "y", "cm"},
      {&Update::heading, "heading", "deg", -360, 360},
      {&Update::servo, "servo", "deg", 0, 90},
      {&Update::s1, "s1", "cm", 0, 255},
      {&Update::s2, "s2", "cm", 0, 255},
      {&Update::s3, "s3", "cm", 0, 255},
      {&Update::s4, "s4", "cm", 0, 255},
  }};
  friend constexpr bool operator==(const Update&, const Update&) = default;
};

/// What robot this is. Thesis 2 says "information about the robot" and fixes no list: these are ours, and of
/// an older robot only `given` is certain. Fields that were not given are 0; integers beyond the last field
/// are let go.
struct Handshake {
  std::int16_t width = 0;         ///< cm
  std::int16_t length = 0;        ///< cm
  std::int16_t axle_offset = 0;   ///< cm, from the centre forwards
  std::int16_t tower_offset = 0;  ///< cm, from the centre forwards
  std::int16_t sensor1 = 0;       ///< degrees, where sensor 1 looks when the tower is at 0; so the others
  std::int16_t sensor2 = 0;
  std::int16_t sensor3 = 0;
  std::int16_t sensor4 = 0;
  std::int16_t deadline = 0;  ///< ms without a word from the robot after which it counts as lost
  std::int16_t formats =
      0;  ///< `packed_offer` (format.hpp): can send packed updates; anything else: text only
  std::uint8_t given = 10;  ///< integers in the sentence, 1 .. max_integers

  static constexpr Kind kind = Kind::handshake;
  static constexpr std::array<Field<Handshake>, 10> fields{{
      {&Handshake::width, "width", "cm"},
      {&Handshake::length, "length", "cm"},
      {&Handshake::axle_offset, "axle_offset", "cm"},
      {&Handshake::tower_offset, "tower_offset", "cm"},
      {&Handshake::sensor1, "sensor1", "deg"},
      {&Handshake::sensor2, "sensor2", "deg"},
      {&Handshake::sensor3, "sensor3", "deg"},
      {&Handshake::sensor4, "sensor4", "deg"},
      {&Handshake::deadline, "deadline", "ms"},
      {&Handshake::formats, "formats", ""},
  }};
  friend constexpr bool operator==(const Handshake&, const Handshake&) = default;
};

/// A sentence without integers, and the word it consists of.
struct Word {
  Kind kind;
  Direction direction;
  std::string_view text;  ///< behind `{S,`
};
inline constexpr std::array<Word, 6> words{{
    {Kind::confirm, Direction::to_robot, "CON"},
    {Kind::pause, Direction::to_robot, "PAU"},
    {Kind::unpause, Direction::to_robot, "UNP"},
    {Kind::packed, Direction::to_robot, "BIN"},
    {Kind::text, Direction::to_robot, "TXT"},
    {Kind::idle, Direction::from_robot, "IDL"},
}};
inline constexpr std::size_t word_length = 3;

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
[[nodiscard]] constexpr base::Result<Line> write(char letter, const T& sentence, std::size_t count) noexcept {
  Line line;
  line << '{' << letter;
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
  return detail::write('U', sentence, SetPoint::fields.size());
}
[[nodiscard]] constexpr base::Result<Line> write(const Update& sentence) noexcept {
  return detail::write('U', sentence, Update::fields.size());
}
/// The first `given` fields; Error::bad_length when that is 0 or more than there are.
[[nodiscard]] constexpr base::Result<Line> write(const Handshake& sentence) noexcept {
  if (sentence.given == 0 || sentence.given > Handshake::fields.size()) return base::Error::bad_length;
  return detail::write('H', sentence, sentence.given);
}
/// The line of a sentence without integers; Error::bad_syntax for a kind that has some, or none.
[[nodiscard]] constexpr base::Result<Line> write(Kind kind) noexcept {
  Line line;
  if (kind == Kind::ping) return line << "{}\n";
  if (kind == Kind::pong) return line << "\t!\n";
  for (const Word& word : words)
    if (word.kind == kind) return line << "{S," << word.text << "}\n";
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
