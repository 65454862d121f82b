/// Makes sentences of characters, a character at a time, from a line that loses, splices and interleaves:
/// accepts only what is whole, has the right number of integers, each as a robot prints it and within its
/// range; counts the rest by cause; starts afresh at each `{`. The closing brace completes a sentence: its
/// line feed may come in another packet, or not at all.
///
/// No heap, constexpr; O(1) a character, O(integers) at the end; 92 bytes, however long the line. Without a
/// checksum some splices of two updates look whole: docs/mapper-link.md has the measured rate, packed.hpp the
/// cure.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ocm/base/text.hpp"
#include "ocm/mapper/link/sentence.hpp"
#include "ocm/mapper/link/whole_update.hpp"

namespace ocm::mapper::link {

/// Why something was no sentence, each counted once. They wrap.
struct ReaderFaults {
  std::uint32_t torn = 0;          ///< `{` within a sentence: its end was lost
  std::uint32_t unclosed = 0;      ///< the line ended within a sentence
  std::uint32_t headless = 0;      ///< `}` outside: its beginning was lost
  std::uint32_t unknown = 0;       ///< no such letter or word, this way
  std::uint32_t bad_number = 0;    ///< empty, no digits, or not as printed: 007, -0, +5
  std::uint32_t wrong_count = 0;   ///< fewer or more integers than the sentence has
  std::uint32_t out_of_range = 0;  ///< an integer that its field, or 16 bits, cannot have
  std::uint32_t too_long = 0;      ///< more than `max_integers`

  [[nodiscard]] constexpr std::uint32_t total() const noexcept {
    return torn + unclosed + headless + unknown + bad_number + wrong_count + out_of_range + too_long;
  }
  friend constexpr bool operator==(const ReaderFaults&, const ReaderFaults&) = default;
};

namespace detail {

enum class Fit : std::uint8_t { good, wrong_count, out_of_range };

/// Whether the integers of a sentence can be those of a T, of which it has `fewest` to `most`.
template <class T>
[[nodiscard]] constexpr Fit fit(const Sentence& sentence, std::size_t fewest = T::fields.size(),
                                std::size_t most = T::fields.size()) noexcept {
  if (sentence.count < fewest || sentence.count > most) return Fit::wrong_count;
  for (std::size_t i = 0; i < T::fields.size() && i < sentence.count; ++i)
    if (sentence.integers[i] < T::fields[i].min || sentence.integers[i] > T::fields[i].max)
      return Fit::out_of_range;
  return Fit::good;
}

}  // namespace detail

/// One line, heard from one side. What begins is at most one sentence: nothing is kept of the text itself.
class Reader {
 public:
  constexpr explicit Reader(Direction heard = Direction::from_robot) noexcept : direction_(heard) {}

  /// Kind::none unless the character completes a sentence, which is then `sentence()` until the next `{` or
  /// answer.
  constexpr Kind feed(char c) noexcept {
    if (state_ == State::number && base::is_digit(c)) {  // first: most characters are digits
      digit(c);
      return Kind::none;
    }
    if (c == '{') return open();
    if (c == '\n' || c == '\r') return end_line();
    if (state_ == State::outside) return outside(c);
    if (c == '}') return close();
    if (state_ != State::skipping) inside(c);
    return Kind::none;
  }

  /// Takes characters off the front of a text until a sentence is complete or none is left: as if each was
  /// fed by itself, but twice as fast where updates lie whole in it.
  constexpr Kind feed(std::string_view& text) noexcept {
    Kind kind = Kind::none;
    while (kind == Kind::none && !text.empty()) {
      kind = feed(text.front());
      const std::size_t whole = state_ == State::opened ? whole_update(text) : 0;
      if (whole != 0) kind = end_sentence(Kind::update);
      text.remove_prefix(whole != 0 ? whole : 1);
    }
    return kind;
  }

  [[nodiscard]] constexpr const Sentence& sentence() const noexcept { return sentence_; }
  [[nodiscard]] constexpr const ReaderFaults& faults() const noexcept { return faults_; }
  /// Sentences accepted so far; it wraps.
  [[nodiscard]] constexpr std::uint32_t heard() const noexcept { return heard_; }
  /// Characters outside of sentences, other than blanks and line ends: tails of torn ones, and noise. It
  /// wraps.
  [[nodiscard]] constexpr std::uint32_t stray() const noexcept { return stray_; }
  /// Whether a sentence has begun that may still become whole.
  [[nodiscard]] constexpr bool mid_sentence() const noexcept {
    return state_ != State::outside && state_ != State::skipping;
  }
  /// The line is a new one: what was begun on the old one is counted as unclosed.
  constexpr void restart() noexcept { (void)end_line(); }

 private:
  enum class State : std::uint8_t { outside, opened, blank, letter, word, number, skipping };

  constexpr Kind open() noexcept {
    if (mid_sentence()) ++faults_.torn;
    state_ = State::opened;
    sentence_.kind = Kind::none;
    sentence_.count = 0;
    word_size_ = 0;
    return Kind::none;
  }
  constexpr Kind end_line() noexcept {
    if (mid_sentence()) ++faults_.unclosed;
    state_ = State::outside;
    tab_ = false;
    return Kind::none;
  }
  constexpr Kind outside(char c) noexcept {
    if (c == ' ') return Kind::none;
    if (c == '!' && tab_ && direction_ == Direction::from_robot) {
      tab_ = false;
      sentence_.count = 0;
      return accept(Kind::pong);
    }
    tab_ = c == '\t';
    if (c == '}') ++faults_.headless;
    if (!tab_ && c != '}') ++stray_;
    return Kind::none;
  }
  constexpr void fail(std::uint32_t& cause) noexcept {
    ++cause;
    state_ = State::skipping;
  }

  /// Whether a sentence that way begins with it.
  [[nodiscard]] constexpr bool is_letter(char c) const noexcept {
    if (c == word_letter) return true;
    if (direction_ == Direction::to_robot) return c == SetPoint::letter || c == Calibrate::letter;
    return c == Update::letter || c == Handshake::letter || c == Calibration::letter;
  }
  constexpr void inside(char c) noexcept {
    switch (state_) {
      case State::opened:
        letter_ = c;
        if (c == ' ')
          state_ = State::blank;  // thesis 2 prints the ping as `{ }`
        else if (is_letter(c))
          state_ = State::letter;
        else
          fail(faults_.unknown);
        return;
      case State::blank:
        if (c != ' ') fail(faults_.unknown);
        return;
      case State::letter:
        if (c != ',') return fail(faults_.unknown);
        if (letter_ == word_letter)
          state_ = State::word;
        else
          begin_number();
        return;
      case State::word:
        if (word_size_ == word_length) return fail(faults_.unknown);
        word_[word_size_++] = c;
        return;
      case State::number:
        return number(c);
      case State::outside:
      case State::skipping:
        return;
    }
  }

  constexpr void begin_number() noexcept {
    state_ = State::number;
    negative_ = false;
    digits_ = 0;
    magnitude_ = 0;
  }
  /// Of what a digit ends, or a sign begins.
  constexpr void number(char c) noexcept {
    if (c == ',') {
      if (end_number()) begin_number();
      return;
    }
    if (c != '-' || digits_ != 0 || negative_) return fail(faults_.bad_number);
    negative_ = true;
  }
  constexpr void digit(char c) noexcept {
    // A zero has nothing in front and nothing behind: numbers that no robot prints are splices.
    if (digits_ != 0 && magnitude_ == 0) return fail(faults_.bad_number);
    if (digits_ == 5) return fail(faults_.out_of_range);
    magnitude_ = magnitude_ * 10 + (c - '0');
    ++digits_;
  }
  [[nodiscard]] constexpr bool end_number() noexcept {
    if (digits_ == 0 || (negative_ && magnitude_ == 0)) return fail(faults_.bad_number), false;
    const std::int32_t value = negative_ ? -magnitude_ : magnitude_;
    if (value < INT16_MIN || value > INT16_MAX) return fail(faults_.out_of_range), false;
    if (sentence_.count == max_integers) return fail(faults_.too_long), false;
    sentence_.integers[sentence_.count++] = static_cast<std::int16_t>(value);
    return true;
  }

  constexpr Kind close() noexcept { return end_sentence(whole()); }
  constexpr Kind end_sentence(Kind kind) noexcept {
    state_ = State::outside;
    tab_ = false;
    return kind == Kind::none ? kind : accept(kind);
  }
  /// How many characters the update has whose brace has opened; 0: none that can be taken at once.
  constexpr std::size_t whole_update(std::string_view text) noexcept {
    if (direction_ == Direction::to_robot) return 0;
    const std::size_t size = detail::whole_update(text, sentence_.integers);
    if (size != 0) sentence_.count = Update::fields.size();
    return size;
  }
  /// The sentence that ends here, or none and a counted cause.
  [[nodiscard]] constexpr Kind whole() noexcept {
    switch (state_) {
      case State::opened:
      case State::blank:
        return known(direction_ == Direction::to_robot ? Kind::ping : Kind::none);
      case State::letter:
        fail(letter_ == word_letter ? faults_.unknown : faults_.wrong_count);
        return Kind::none;
      case State::word:
        return known(kind_of_word(direction_, {word_.data(), word_size_}));
      case State::number:
        if (!end_number()) return Kind::none;
        return direction_ == Direction::to_robot ? whole_to_robot() : whole_from_robot();
      case State::outside:
      case State::skipping:
        break;
    }
    return Kind::none;
  }
  [[nodiscard]] constexpr Kind whole_to_robot() noexcept {
    if (letter_ == Calibrate::letter) return checked(Kind::calibrate, detail::fit<Calibrate>(sentence_));
    return checked(Kind::set_point, detail::fit<SetPoint>(sentence_));
  }
  [[nodiscard]] constexpr Kind whole_from_robot() noexcept {
    if (letter_ == Handshake::letter)
      return checked(Kind::handshake,
                     detail::fit<Handshake>(sentence_, Handshake::fewest_integers, Handshake::most_integers));
    if (letter_ == Calibration::letter)
      return checked(Kind::calibration, detail::fit<Calibration>(sentence_));
    return checked(Kind::update, detail::fit<Update>(sentence_));
  }
  [[nodiscard]] constexpr Kind known(Kind kind) noexcept {
    if (kind == Kind::none) ++faults_.unknown;
    return kind;
  }
  /// The kind, where nothing is to be counted.
  [[nodiscard]] constexpr Kind checked(Kind kind, detail::Fit fit) noexcept {
    if (fit == detail::Fit::good) return kind;
    ++(fit == detail::Fit::wrong_count ? faults_.wrong_count : faults_.out_of_range);
    return Kind::none;
  }
  constexpr Kind accept(Kind kind) noexcept {
    ++heard_;
    return sentence_.kind = kind;
  }

  Sentence sentence_{};
  ReaderFaults faults_{};
  std::uint32_t heard_ = 0;
  std::uint32_t stray_ = 0;
  std::int32_t magnitude_ = 0;
  std::array<char, word_length> word_{};
  std::uint8_t word_size_ = 0;
  std::uint8_t digits_ = 0;
  char letter_ = 0;
  bool negative_ = false;
  bool tab_ = false;  ///< outside, and only blanks since a tab: `!` is an answer
  State state_ = State::outside;
  Direction direction_;
};

}  // namespace ocm::mapper::link
