/// Logs as candump writes them (candump -l, -L), a line a frame, in the notation of can/text.hpp and what a
/// board never sees: `605##1...` with the flags of a CAN FD frame, `605#0011223344556677_9` with the length
/// code of 8 bytes. Without allocation a frame; a line that candump itself wrote takes a path without a loop
/// over its characters, any other line the careful one.
///
/// Read are 0 to 9 digits of a second's fraction, blank lines, CR LF and upper or lower case. A line that
/// cannot be read is complained of with its number. [can-utils lib.h, candump.c]
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/swar.hpp"
#include "ocm/base/text.hpp"
#include "ocm/can/any_text.hpp"
#include "ocm/can/text.hpp"
#include "ocm/log/reader.hpp"
#include "ocm/log/writer.hpp"

namespace ocm::log {

namespace candump {

/// Longest name of an interface that is believed; Linux has 15 characters.
inline constexpr std::size_t longest_name = 64;

/// A line as an entry, but for its interface; or what is wrong with it.
struct Line {
  Entry entry;
  std::string_view interface;
  std::optional<Cause> wrong;
};

[[nodiscard]] constexpr Cause cause_of(base::Error error) noexcept {
  switch (error) {
    case base::Error::bad_identifier:
      return Cause::identifier;
    case base::Error::bad_length:
      return Cause::length;
    case base::Error::out_of_range:
      return Cause::time;
    default:
      return Cause::syntax;
  }
}

/// A classic frame, with `_9` to `_F` behind 8 bytes (or behind the 8 that a remote frame asks for).
[[nodiscard]] inline base::Error parse_classic(std::string_view text, Entry& entry) noexcept {
  using base::Error;
  const auto bar = text.find('_');
  const auto frame = can::parse_frame(text.substr(0, bar));
  if (!frame) return frame.error;
  entry = Entry{entry.time, *frame};
  if (bar == std::string_view::npos) return Error::none;
  const int code = bar + 2 == text.size() ? base::hex_digit(text[bar + 1]) : -1;
  if (code < 0 || frame->format == can::Format::error) return Error::bad_syntax;
  if (code <= can::max_dlc || frame->dlc != can::max_dlc) return Error::bad_length;
  entry.raw_dlc = static_cast<std::uint8_t>(code);
  return Error::none;
}

/// The careful way: any line, whatever is in it.
[[nodiscard]] inline Line parse_line(std::string_view text) noexcept {
  Line line;
  const auto words = can::split_log_line(text);
  if (!words) {
    line.wrong = cause_of(words.error);
    return line;
  }
  line.interface = words->interface;
  line.entry.time = words->time;
  base::Error error{};
  if (words->frame.find("##") == std::string_view::npos) {
    error = parse_classic(words->frame, line.entry);
  } else {
    const auto frame = can::parse_any_frame(words->frame);
    error = frame.error;
    line.entry = Entry{line.entry.time, *frame};
  }
  if (error != base::Error::none) line.wrong = cause_of(error);
  if (line.interface.size() > longest_name) line.wrong = Cause::syntax;
  line.entry.direction = words->direction == 'R'   ? Direction::received
                         : words->direction == 'T' ? Direction::sent
                                                   : Direction::unknown;
  return line;
}

[[nodiscard]] inline bool is_blank(std::string_view text) noexcept {
  return text.find_first_not_of(" \t\r") == std::string_view::npos;
}

/// Whether any line of a log's beginning is one of a format's, which `is_one` says; its last may be cut.
template <class IsOne>
[[nodiscard]] bool any_line(std::string_view beginning, IsOne is_one) {
  while (!beginning.empty()) {
    const auto end = beginning.find('\n');
    if (is_one(beginning.substr(0, end))) return true;
    if (end == std::string_view::npos) return false;
    beginning.remove_prefix(end + 1);
  }
  return false;
}

}  // namespace candump

class CandumpReader final : public Reader {
 public:
  using Reader::Reader;

  /// Whether a line of what is shown is one of candump's.
  [[nodiscard]] static bool recognises(std::string_view beginning) {
    return candump::any_line(beginning, [](auto line) { return !candump::parse_line(line).wrong; });
  }

  [[nodiscard]] std::size_t read(std::span<Entry> into) override {
    std::size_t count = 0;
    while (count < into.size()) {
      if (input_->here() >= longest_usual) {
        if (const std::size_t size = usual(input_->peek(1).data(), into[count]); size != 0) {
          input_->skip_line(size);
          ++count;
          continue;
        }
      }
      const Step step = careful(into[count], count == 0 ? Input::Wait::yes : Input::Wait::no);
      if (step == Step::entry) ++count;
      if (step == Step::end) break;
    }
    return count;
  }

 private:
  /// What `usual` looks at, at most: 20 of a time with 6 digits, 9 of a name, 9 of an identifier, 3 of flags,
  /// 128 of data, and 8 behind.
  static constexpr std::size_t longest_usual = 192;
  enum class Step : std::uint8_t { entry, nothing, end };

  /// A name of up to 7 characters with the blank behind it, as the bytes of a word.
  struct Name {
    std::uint64_t word = 0;
    std::uint64_t mask = 0;
    std::uint8_t size = 0;
    std::uint16_t number = 0;
  };

  /// A line as candump writes it, of an interface that was seen before: how long it is, with its end; 0 for
  /// every other line, which then is not of interest here.
  [[nodiscard]] std::size_t usual(const char* const line, Entry& entry) const noexcept {
    // "(1436509052.249713) ": the last two digits of the seconds and the fraction make one word.
    std::uint64_t low = base::swar::load64(line + 10) & ~std::uint64_t{0xFFFF};
    low |= base::swar::load16(line + 9);
    const std::uint64_t high = base::swar::load64(line + 1);
    if (line[0] != '(' || line[11] != '.' || !base::swar::are_digits(high) || !base::swar::are_digits(low))
      return 0;
    auto ns = static_cast<std::int64_t>((base::swar::decimal(high) * 100'000'000 + base::swar::decimal(low)) *
                                        1000);
    if (base::swar::decimal(high) >= 92'233'720) return 0;  // near the end of 64 bits
    const char* at = line + 18;
    if (*at != ')') {  // nine digits
      const unsigned a = digit(at[0]), b = digit(at[1]), c = digit(at[2]);
      if (a > 9 || b > 9 || c > 9) return 0;
      ns += static_cast<std::int64_t>(a * 100 + b * 10 + c);
      at += 3;
    }
    if (at[0] != ')' || at[1] != ' ') return 0;
    at += 2;
    const Name* const name = known(base::swar::load64(at));
    if (name == nullptr) return 0;
    at += name->size;

    const base::swar::Hex id = base::swar::hex(base::swar::load64(at));
    const unsigned digits = id.count();
    if ((digits != 3 && digits != 8) || at[digits] != '#') return 0;
    std::uint32_t number = base::swar::big_endian(id.bytes()) >> (32 - 4 * digits);
    if (digits == 3) {
      if (number > can::max_base_id) return 0;
      entry.format = can::Format::base;
    } else {
      const bool error = (number & can::error_frame_flag) != 0;
      number &= ~can::error_frame_flag;
      if (number > can::max_extended_id) return 0;
      entry.format = error ? can::Format::error : can::Format::extended;
    }
    at += digits + 1;
    entry.id = number;
    entry.time = base::Time{base::Duration{ns}};
    entry.interface = name->number;
    entry.raw_dlc = 0;
    entry.flags = 0;
    if (*at == '#') {
      if (entry.format == can::Format::error) return 0;
      at = fd_data(at + 1, entry);
    } else {
      at = data(at, entry);
    }
    return at == nullptr ? 0 : line_end(line, at, entry);
  }

  /// Up to 16 digits, all at once: random lengths cost no wrong guess of a jump.
  static const char* data(const char* at, Entry& entry) noexcept {
    const base::swar::Hex first = base::swar::hex(base::swar::load64(at));
    const base::swar::Hex second = base::swar::hex(base::swar::load64(at + 8));
    const std::uint32_t both = first.bad == 0 ? ~std::uint32_t{0} : 0;
    const unsigned digits = first.count() + (second.count() & both);
    const std::uint32_t words[2] = {first.bytes(), second.bytes() & both};
    if (digits % 2 != 0) return nullptr;
    std::memcpy(entry.data.data(), words, sizeof words);
    entry.length = static_cast<std::uint8_t>(digits / 2);
    return at + digits;
  }

  static const char* fd_data(const char* at, Entry& entry) noexcept {
    const unsigned flags = digit(at[0]);
    if (flags > 9) return nullptr;
    entry.flags = static_cast<std::uint8_t>(flags | flag::fd);
    ++at;
    std::memset(entry.data.data(), 0, 8);
    std::size_t digits = 0;
    for (unsigned count = 8; count == 8 && digits < std::size_t{2} * max_fd_length; digits += count) {
      const base::swar::Hex some = base::swar::hex(base::swar::load64(at + digits));
      const std::uint32_t word = some.bytes();
      std::memcpy(entry.data.data() + digits / 2, &word, sizeof word);
      count = some.count();
    }
    if (digits % 2 != 0 || !is_fd_length(digits / 2)) return nullptr;
    entry.length = static_cast<std::uint8_t>(digits / 2);
    return at + digits;
  }

  static std::size_t line_end(const char* line, const char* at, Entry& entry) noexcept {
    entry.direction = Direction::unknown;
    if (at[0] == ' ' && (at[1] == 'R' || at[1] == 'T')) {
      entry.direction = at[1] == 'R' ? Direction::received : Direction::sent;
      at += 2;
    }
    if (*at == '\r') ++at;
    return *at == '\n' ? static_cast<std::size_t>(at + 1 - line) : 0;
  }

  [[nodiscard]] static constexpr unsigned digit(char c) noexcept {
    return static_cast<unsigned char>(c) - unsigned{'0'};
  }

  [[nodiscard]] const Name* known(std::uint64_t word) const noexcept {
    for (const Name& name : names_)
      if ((word & name.mask) == name.word) return &name;
    return nullptr;
  }

  Step careful(Entry& entry, Input::Wait wait) {
    std::string_view text;
    const auto taken = input_->take_line(text, wait);
    const Place place{input_->line_number(), true};
    switch (taken) {
      case Input::Line::later:
      case Input::Line::none:
        return Step::end;
      case Input::Line::too_long:
        complain(Cause::too_long, place, text);
        return Step::nothing;
      case Input::Line::last:
        if (!input_->failure().empty()) {  // half a line may look like a whole one
          complain(Cause::truncated, place, text);
          return Step::end;
        }
        break;
      case Input::Line::whole:
        break;
    }
    if (candump::is_blank(text)) return Step::nothing;
    const candump::Line line = candump::parse_line(text);
    if (line.wrong) {
      complain(text.front() == '(' ? cause_of_line(*line.wrong, taken) : *line.wrong, place, text);
      return Step::nothing;
    }
    entry = line.entry;
    entry.interface = interfaces_.number(line.interface);
    if (interfaces_.name(entry.interface) != line.interface) {
      complain(Cause::unsupported, place, "more interfaces than any log has");
      return Step::nothing;
    }
    remember(line.interface, entry.interface);
    return Step::entry;
  }

  void remember(std::string_view interface, std::uint16_t number) {
    constexpr std::size_t enough = 8;  // a machine has few, and the search is linear
    if (interface.size() > 7 || names_.size() == enough) return;
    for (const Name& name : names_)
      if (name.number == number) return;
    char text[8] = {};
    interface.copy(text, interface.size());
    text[interface.size()] = ' ';
    const auto size = static_cast<std::uint8_t>(interface.size() + 1);
    names_.push_back({base::swar::load64(text), ~std::uint64_t{0} >> (64 - 8 * size), size, number});
  }

  std::vector<Name> names_;
};

/// Writes what candump -L writes. The field's tools read six digits of a second's fraction and take nine for
/// something else, so nine are written on demand only.
class CandumpWriter : public Writer {
 public:
  enum class Digits : std::uint8_t { microseconds = 6, nanoseconds = 9 };
  explicit CandumpWriter(Digits digits = Digits::microseconds) : digits_(digits) {}

  void write(Bytes& out, std::span<const Entry> entries, const Interfaces& interfaces) override {
    for (const Entry& entry : entries) {
      while (names_.size() <= entry.interface)
        names_.push_back(prepare(interfaces, static_cast<std::uint16_t>(names_.size())));
      const Name& name = names_[entry.interface];
      if (name.changed) losses_.add(Lost::interface);
      char* const begin = out.room(longest_line + name.text.size());
      out.grow_to(line(begin, entry, name.text));
    }
  }

 private:
  static constexpr std::size_t longest_line = 24 + 9 + 3 + 2 * max_fd_length + 2 + 2 + 1;

  /// A name as it can stand in a line: not empty, without blanks.
  struct Name {
    std::string text;
    bool changed = false;
  };

  static Name prepare(const Interfaces& interfaces, std::uint16_t number) {
    Name name{std::string{interfaces.name(number)}};
    for (char& c : name.text) {
      if (c > ' ' && c != '\x7F') continue;
      c = '_';
      name.changed = true;
    }
    if (name.text.empty()) name.text = "can" + std::to_string(number);
    return name;
  }

  char* line(char* at, const Entry& entry, std::string_view name) noexcept {
    at = time(at, entry.time);
    at = base::swar::copy(at, name);
    *at++ = ' ';
    at = identifier(at, entry);
    at = can::is_remote(entry.format) ? remote(at, entry) : data(at, entry);
    if (entry.raw_dlc > can::max_dlc && entry.length == can::max_dlc && !entry.is_fd()) {
      *at++ = '_';
      *at++ = base::swar::upper_digits[entry.raw_dlc & 0xF];
    }
    if (entry.direction != Direction::unknown) {
      *at++ = ' ';
      *at++ = entry.direction == Direction::received ? 'R' : 'T';
    }
    *at++ = '\n';
    return at;
  }

  char* time(char* at, base::Time when) noexcept {
    std::int64_t ns = when.time_since_epoch().count();
    if (ns < 0) {  // before 1970: candump has no sign
      losses_.add(Lost::time);
      ns = 0;
    }
    const auto us = static_cast<std::uint64_t>(ns) / 1000;
    const auto rest = static_cast<unsigned>(static_cast<std::uint64_t>(ns) % 1000);
    const std::uint64_t seconds = us / 1'000'000;
    const auto fraction = static_cast<std::uint32_t>(us % 1'000'000);
    *at++ = '(';
    at = base::swar::two_digits(at, static_cast<std::uint32_t>(seconds / 100'000'000));
    at = base::swar::eight_digits(at, static_cast<std::uint32_t>(seconds % 100'000'000));
    *at++ = '.';
    at = base::swar::two_digits(at, fraction / 10'000);
    at = base::swar::two_digits(at, fraction / 100 % 100);
    at = base::swar::two_digits(at, fraction % 100);
    if (digits_ == Digits::nanoseconds) {
      at = base::swar::two_digits(at, rest / 10);
      *at++ = static_cast<char>('0' + rest % 10);
    } else if (rest != 0) {
      losses_.add(Lost::time_digits);
    }
    *at++ = ')';
    *at++ = ' ';
    return at;
  }

  static char* identifier(char* at, const Entry& entry) noexcept {
    if (entry.format == can::Format::base || entry.format == can::Format::base_remote) {
      *at++ = base::swar::upper_digits[entry.id >> 8 & 0xF];
      at = base::swar::hex_byte(at, static_cast<std::uint8_t>(entry.id));
    } else {
      const std::uint32_t id = entry.id | (entry.format == can::Format::error ? can::error_frame_flag : 0);
      for (int shift = 24; shift >= 0; shift -= 8)
        at = base::swar::hex_byte(at, static_cast<std::uint8_t>(id >> shift));
    }
    *at++ = '#';
    return at;
  }

  static char* remote(char* at, const Entry& entry) noexcept {
    *at++ = 'R';
    if (entry.length != 0) *at++ = base::swar::upper_digits[entry.length & 0xF];
    return at;
  }

  static char* data(char* at, const Entry& entry) noexcept {
    if (entry.is_fd()) {
      *at++ = '#';
      *at++ = base::swar::upper_digits[entry.flags & 0xF & ~flag::fd];
      for (std::size_t i = 8; i < entry.length; ++i) base::swar::hex_byte(at + 2 * i, entry.data[i]);
    }
    for (std::size_t i = 0; i < 8; ++i)
      base::swar::hex_byte(at + 2 * i, entry.data[i]);  // a fixed count is unrolled
    return at + std::size_t{2} * entry.length;
  }

  Digits digits_;
  std::vector<Name> names_;
};

/// With nine digits: reread exactly by this library, and by tools that read a fraction of any length.
class CandumpNanoWriter final : public CandumpWriter {
 public:
  CandumpNanoWriter() : CandumpWriter(Digits::nanoseconds) {}
};

}  // namespace ocm::log
