/// ASC, the text log of Vector's tools: times since a date in local time, channels in place of names, CAN FD
/// in lines of their own. Without allocation a frame.
///
/// Read are 0 to 9 digits of a second's fraction, absolute and relative times, hexadecimal and decimal
/// numbers, English and German dates. What is no frame (statistics, states of chips, comments) is passed
/// over; so are requests to send (TxRq), which the frame itself follows. Where a symbolic name stands in
/// place of an identifier, the line is read if it ends with the number, as those of newer tools do. [Vector,
/// CAN Log & Trigger ASC Logging Format; can-utils asc2log.c; python-can io/asc.py]
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>

#include "ocm/base/swar.hpp"
#include "ocm/base/text.hpp"
#include "ocm/log/calendar.hpp"
#include "ocm/log/channels.hpp"
#include "ocm/log/reader.hpp"
#include "ocm/log/writer.hpp"

namespace ocm::log {

namespace asc {

/// Bits of the column of flags in lines of CAN FD.
inline constexpr std::uint32_t remote_flag = 0x10, fd_flag = 0x1000, switch_flag = 0x2000,
                               state_flag = 0x4000;

/// Words of a line, one after the other; "" behind the last.
class Words {
 public:
  explicit Words(std::string_view line) noexcept : at_(line.data()), end_(line.data() + line.size()) {}
  std::string_view next() noexcept {
    while (at_ != end_ && is_blank(*at_)) ++at_;
    const char* const begin = at_;
    while (at_ != end_ && !is_blank(*at_)) ++at_;
    return {begin, static_cast<std::size_t>(at_ - begin)};
  }
  [[nodiscard]] std::string_view rest() const noexcept { return {at_, static_cast<std::size_t>(end_ - at_)}; }
  void skip(std::size_t count) noexcept { at_ += count; }

 private:
  static bool is_blank(char c) noexcept { return c == ' ' || c == '\t'; }
  const char* at_;
  const char* end_;
};

/// ASCII letters of either case; `lower` is in lower case.
[[nodiscard]] constexpr bool same(std::string_view word, std::string_view lower) noexcept {
  return std::equal(word.begin(), word.end(), lower.begin(), lower.end(), [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
  });
}

/// "12.5", with 0 to 9 digits behind the point, as nanoseconds.
[[nodiscard]] constexpr std::optional<std::int64_t> parse_stamp(std::string_view word) noexcept {
  std::uint64_t ns = 0;
  std::size_t i = 0;
  for (; i < word.size() && base::is_digit(word[i]); ++i) {
    if (i == 10) return std::nullopt;  // 64 bits of nanoseconds are less than 10^10 s
    ns = ns * 10 + static_cast<unsigned>(word[i] - '0');
  }
  int digits = 0;
  if (i < word.size() && word[i] == '.')
    for (++i; i < word.size() && base::is_digit(word[i]); ++i, ++digits) {
      if (digits == 9) return std::nullopt;
      ns = ns * 10 + static_cast<unsigned>(word[i] - '0');
    }
  if (i != word.size()) return std::nullopt;
  for (; digits < 9; ++digits)
    if (__builtin_mul_overflow(ns, std::uint64_t{10}, &ns)) return std::nullopt;
  if (ns > INT64_MAX) return std::nullopt;
  return static_cast<std::int64_t>(ns);
}

/// "10:13:20.123" and, unless "", "am" or "pm". Nothing where they are no time of a day.
[[nodiscard]] constexpr std::optional<std::int64_t> parse_clock(std::string_view text, std::string_view half,
                                                                CalendarTime& time) noexcept {
  const std::size_t first = text.find(':'), second = text.find(':', first + 1);
  if (first == text.npos || second == text.npos) return std::nullopt;
  const auto hour = base::parse_unsigned(text.substr(0, first));
  const auto minute = base::parse_unsigned(text.substr(first + 1, second - first - 1));
  const auto stamp = parse_stamp(text.substr(second + 1));
  if (!hour || !minute || !stamp || *hour > 23 || *minute > 59) return std::nullopt;
  time.hour = static_cast<int>(*hour);
  time.minute = static_cast<int>(*minute);
  time.second = static_cast<int>(std::min<std::int64_t>(*stamp / 1'000'000'000, 99));
  if (same(half, "am") || same(half, "pm")) {
    if (time.hour < 1 || time.hour > 12) return std::nullopt;
    time.hour = time.hour % 12 + (same(half, "pm") ? 12 : 0);
  }
  return *stamp % 1'000'000'000;
}

/// "Tue Nov 14 10:13:20.123 pm 2023", or without the pm and from 0 to 23 h: nanoseconds since 1970 (UTC).
[[nodiscard]] inline std::optional<std::int64_t> parse_date(Words words) noexcept {
  CalendarTime local;
  words.next();  // of the week
  local.month = month_of(words.next());
  const auto day = base::parse_unsigned(words.next());
  const std::string_view clock = words.next();
  std::string_view year = words.next(), half;
  if (same(year, "am") || same(year, "pm")) {
    half = year;
    year = words.next();
  }
  const auto years = base::parse_unsigned(year);
  if (!day || !years || *day > 31 || *years > 9999) return std::nullopt;
  local.day = static_cast<int>(*day);
  local.year = static_cast<int>(*years);
  const auto fraction = parse_clock(clock, half, local);
  const auto seconds = fraction ? seconds_of(local) : std::nullopt;
  if (!seconds) return std::nullopt;
  return *seconds * 1'000'000'000 + *fraction;
}

/// A length code: a hexadecimal digit, or 10 to 15.
[[nodiscard]] constexpr std::optional<std::uint8_t> parse_dlc(std::string_view word) noexcept {
  if (word.size() == 1 && base::hex_digit(word[0]) >= 0)
    return static_cast<std::uint8_t>(base::hex_digit(word[0]));
  const auto number = base::parse_unsigned(word);
  if (!number || *number > 15 || word.size() > 2) return std::nullopt;
  return static_cast<std::uint8_t>(*number);
}

}  // namespace asc

class AscReader final : public Reader {
 public:
  using Reader::Reader;

  /// The line with the date is the first, or the one with the base of numbers.
  [[nodiscard]] static bool recognises(std::string_view beginning) {
    asc::Words words{beginning.substr(0, beginning.find_first_of("\r\n"))};
    const std::string_view first = words.next();
    if (asc::same(first, "date")) return asc::parse_date(words).has_value();
    const std::string_view base = words.next();
    return asc::same(first, "base") && (asc::same(base, "hex") || asc::same(base, "dec"));
  }

  [[nodiscard]] std::size_t read(std::span<Entry> into) override {
    std::size_t count = 0;
    while (count < into.size()) {
      std::string_view line;
      const auto taken = input_->take_line(line, count == 0 ? Input::Wait::yes : Input::Wait::no);
      if (taken == Input::Line::none || taken == Input::Line::later) break;
      line_ = line;
      taken_ = taken;
      if (taken == Input::Line::too_long) {
        refuse(Cause::too_long);
        continue;
      }
      // Half a line may look like a whole one, or like no frame.
      if (taken == Input::Line::last && !input_->failure().empty()) {
        refuse(Cause::truncated);
        break;
      }
      const Found found = take(line, into[count]);
      if (found == Found::event && taken == Input::Line::last) refuse(Cause::cut_line);
      if (found == Found::frame) ++count;
    }
    return count;
  }

 private:
  enum class Found : std::uint8_t {
    frame,
    event,    ///< with a time, and no frame
    nothing,  ///< of the file's head, blank, or complained of
  };

  Found refuse(Cause cause) {
    complain(cause_of_line(cause, taken_), {input_->line_number(), true}, line_);
    return Found::nothing;
  }

  Found take(std::string_view line, Entry& entry) {
    asc::Words words{line};
    const std::string_view first = words.next();
    if (first.empty()) return Found::nothing;
    if (!base::is_digit(first.front())) return head(first, words);
    const auto stamp = asc::parse_stamp(first);
    if (!stamp || !keep_time(*stamp)) return refuse(Cause::time);
    entry.time = base::Time{base::Duration{time_}};
    const std::string_view second = words.next();
    if (!second.empty() && base::is_digit(second.front())) return classic(second, words, entry);
    if (second == "CANFD") return fd(words, entry);
    if (second == "CANXL") return refuse(Cause::unsupported);
    return Found::event;
  }

  /// A line of a word, not of a time: the file's head for the most part.
  Found head(std::string_view first, asc::Words words) {
    if (first.starts_with("//")) return Found::nothing;
    if (asc::same(first, "date")) {
      const auto date = asc::parse_date(words);
      if (!date) return refuse(Cause::time);
      start_ = *date;
    } else if (asc::same(first, "base")) {
      base_ = asc::same(words.next(), "dec") ? 10 : 16;
      if (asc::same(words.next(), "timestamps")) relative_ = asc::same(words.next(), "relative");
    } else if (asc::same(first, "begin")) {
      words.next();  // Triggerblock
      trigger_ = asc::parse_date(words);
    } else if (!asc::same(first, "end") && !asc::same(first, "internal") && !asc::same(first, "no") &&
               !asc::same(first, "previous")) {
      return refuse(Cause::syntax);
    }
    return Found::nothing;
  }

  /// false: beyond 64 bits.
  [[nodiscard]] bool keep_time(std::int64_t stamp) noexcept {
    if (trigger_) {
      // Tools count from the file's date, those that begin a block at 0 from the block's.
      if (stamp == 0) {
        start_ = *trigger_;
        passed_ = 0;
      }
      trigger_.reset();
    }
    if (!relative_)
      passed_ = stamp;
    else if (__builtin_add_overflow(passed_, stamp, &passed_))
      return false;
    return !__builtin_add_overflow(start_, passed_, &time_);
  }

  [[nodiscard]] bool channel(std::string_view word, Entry& entry) {
    const auto number = base::parse_unsigned(word);
    if (!number || *number > ChannelsRead::most) return false;
    entry.interface = channels_.interface(static_cast<std::uint32_t>(*number), interfaces_);
    return true;
  }

  /// Whether the frame was on the bus; nothing for a word that is no direction.
  [[nodiscard]] static std::optional<bool> direction(std::string_view word, Entry& entry) noexcept {
    if (word == "Rx")
      entry.direction = Direction::received;
    else if (word == "Tx")
      entry.direction = Direction::sent;
    else
      return word == "TxRq" ? std::optional{false} : std::nullopt;
    return true;
  }

  /// `<channel> <id>[x] Rx|Tx d <dlc> <data>`, `... r [<dlc>]`, `<channel> ErrorFrame`.
  Found classic(std::string_view channel_word, asc::Words words, Entry& entry) {
    const std::string_view id = words.next();
    if (id.starts_with("ErrorFrame")) {
      if (!channel(channel_word, entry)) return refuse(Cause::syntax);
      set_bus_error(entry);
      return Found::frame;
    }
    const auto on_bus = direction(words.next(), entry);
    if (!on_bus) return Found::event;
    if (!*on_bus) return Found::nothing;
    if (!channel(channel_word, entry)) return refuse(Cause::syntax);
    const std::string_view kind = words.next();
    if (kind != "d" && kind != "r") return refuse(Cause::syntax);
    if (const auto wrong = identifier(id, words.rest(), entry)) return refuse(*wrong);
    entry.flags = 0;
    const auto dlc = asc::parse_dlc(words.next());
    if (kind == "r") {
      make_remote(dlc.value_or(0), entry);  // older tools did not write it
      return Found::frame;
    }
    if (!dlc) return refuse(Cause::length);
    set_length(*dlc, entry);
    return data(words, entry.length, entry) ? Found::frame : refuse(Cause::length);
  }

  static void set_length(std::uint8_t dlc, Entry& entry) noexcept {
    entry.length = std::min(dlc, can::max_dlc);
    entry.raw_dlc = dlc > can::max_dlc ? dlc : std::uint8_t{0};
  }

  static void make_remote(std::uint8_t dlc, Entry& entry) noexcept {
    entry.format = can::is_extended(entry.format) ? can::Format::extended_remote : can::Format::base_remote;
    set_length(dlc, entry);
    std::memset(entry.data.data(), 0, can::max_dlc);
  }

  /// `<channel> Rx|Tx <id>[x] [<name>] <brs> <esi> <dlc> <length> <data> <duration> <bits> <flags>...`, or
  /// `<channel> Rx|Tx ErrorFrame...`. Classic frames come in such lines, too; their flags say so.
  Found fd(asc::Words words, Entry& entry) {
    if (!channel(words.next(), entry)) return refuse(Cause::syntax);
    const auto on_bus = direction(words.next(), entry);
    if (!on_bus) return refuse(Cause::syntax);
    if (!*on_bus) return Found::nothing;
    const std::string_view id = words.next();
    if (id.starts_with("ErrorFrame")) {
      const Direction said = entry.direction;
      set_bus_error(entry);
      entry.direction = said;
      return Found::frame;
    }
    if (const auto wrong = identifier(id, {}, entry)) return refuse(*wrong);
    std::string_view bit_rate_switch = words.next();
    if (!is_bit(bit_rate_switch)) bit_rate_switch = words.next();  // behind a name
    const std::string_view error_state = words.next();
    if (!is_bit(bit_rate_switch) || !is_bit(error_state)) return refuse(Cause::syntax);
    const auto dlc = asc::parse_dlc(words.next());
    const auto length = base::parse_unsigned(words.next());
    if (!dlc || !length || *length > max_fd_length) return refuse(Cause::length);
    if (!data(words, static_cast<std::size_t>(*length), entry)) return refuse(Cause::length);
    words.next();  // duration
    words.next();  // length in bits
    const auto flags = base::parse_unsigned(words.next(), 16);
    if (!flags || (*flags & asc::fd_flag) != 0) {
      if (*length != fd_length(*dlc)) return refuse(Cause::length);
      entry.length = static_cast<std::uint8_t>(*length);
      entry.raw_dlc = 0;
      entry.flags =
          static_cast<std::uint8_t>(flag::fd | (bit_rate_switch == "1" ? flag::bit_rate_switch : 0) |
                                    (error_state == "1" ? flag::error_state : 0));
      return Found::frame;
    }
    entry.flags = 0;
    if ((*flags & asc::remote_flag) != 0) {
      make_remote(*dlc, entry);
      return Found::frame;
    }
    set_length(*dlc, entry);
    return *length == entry.length ? Found::frame : refuse(Cause::length);
  }

  [[nodiscard]] static bool is_bit(std::string_view word) noexcept { return word == "0" || word == "1"; }

  /// What is wrong with it, or nothing. `rest` of the line may have a number for a symbolic name.
  [[nodiscard]] std::optional<Cause> identifier(std::string_view word, std::string_view rest,
                                                Entry& entry) const noexcept {
    unsigned base = base_;
    if (word.empty()) return Cause::syntax;
    if (!base::is_digit(word.front())) {  // "BED" is a number as well as a name
      constexpr std::string_view in_words = " ID = ";
      if (const auto found = rest.rfind(in_words); found != std::string_view::npos) {
        word = asc::Words{rest.substr(found + in_words.size())}.next();
        base = 10;
      }
    }
    const bool extended = word.ends_with('x') || word.ends_with('X');
    if (extended) word.remove_suffix(1);
    const auto number = base::parse_unsigned(word, base);
    if (!number) return Cause::unsupported;
    if (*number > (extended ? can::max_extended_id : can::max_base_id)) return Cause::identifier;
    entry.id = static_cast<std::uint32_t>(*number);
    entry.format = extended ? can::Format::extended : can::Format::base;
    return std::nullopt;
  }

  /// `count` words, each a byte; false: they are not.
  [[nodiscard]] bool data(asc::Words& words, std::size_t count, Entry& entry) const noexcept {
    std::memset(entry.data.data(), 0, can::max_dlc);
    for (std::size_t i = 0; i < count; ++i) {
      const std::string_view rest = words.rest();
      if (base_ == 16 && rest.size() >= 3 && rest[0] == ' ') {  // " 7F", the usual way
        const int high = base::hex_digit(rest[1]), low = base::hex_digit(rest[2]);
        if (high >= 0 && low >= 0 && (rest.size() == 3 || rest[3] == ' ')) {
          entry.data[i] = static_cast<std::uint8_t>(high << 4 | low);
          words.skip(3);
          continue;
        }
      }
      const std::string_view word = words.next();
      const auto byte = base::parse_unsigned(word, base_);
      if (!byte || *byte > 0xFF || (base_ == 16 && word.size() != 2)) return false;
      entry.data[i] = static_cast<std::uint8_t>(*byte);
    }
    return true;
  }

  std::string_view line_;                   // that is being read
  Input::Line taken_ = Input::Line::whole;  // how it ends
  unsigned base_ = 16;                      // of numbers
  bool relative_ = false;                   // each time to that of the line before
  std::int64_t start_ = 0;                  // what times count from, ns
  std::int64_t passed_ = 0;                 // since then
  std::int64_t time_ = 0;                   // of the line
  std::optional<std::int64_t> trigger_;     // date of a block of which no time was seen yet
  ChannelsRead channels_;
};

/// Microseconds, as the field's tools read them, from the whole second in which the log begins. A frame of
/// unknown direction is written as received.
class AscWriter final : public Writer {
 public:
  void write(Bytes& out, std::span<const Entry> entries, const Interfaces& interfaces) override {
    if (!entries.empty() && !started_) start(out, entries.front().time.time_since_epoch().count());
    for (const Entry& entry : entries) {
      const auto channel = channels_.of(entry.interface, interfaces);
      if (!channel.names_it && !interfaces.name(entry.interface).empty()) losses_.add(Lost::interface);
      out.grow_to(line(out.room(longest_line), entry, channel.number));
    }
  }

  void finish(Bytes& out) override {
    if (!started_) start(out, 0);
    out.append("End TriggerBlock\n");
  }

 private:
  static constexpr std::size_t longest_line =
      512;  // of CAN FD: 27 of time, 80 of head, 192 of data, 62 behind

  void start(Bytes& out, std::int64_t first_ns) {
    started_ = true;
    constexpr std::int64_t second = 1'000'000'000;
    const std::int64_t seconds = first_ns / second - (first_ns % second < 0 ? 1 : 0);
    start_ = seconds * second;
    const auto date = date_of(local_time_of(seconds));
    out.append("date ");
    out.append(date.view());
    out.append("\nbase hex  timestamps absolute\ninternal events logged\nBegin Triggerblock ");
    out.append(date.view());
    out.append("\n   0.000000 Start of measurement\n");
  }

  [[nodiscard]] static base::Text<40> date_of(const CalendarTime& local) noexcept {
    base::Text<40> text;
    text << weekday_names[weekday_of(local)] << ' ' << month_names[local.month - 1] << ' ';
    text.decimal(static_cast<unsigned>(local.day)) << ' ';
    text.decimal(static_cast<unsigned>((local.hour + 11) % 12 + 1), 2) << ':';
    text.decimal(static_cast<unsigned>(local.minute), 2) << ':';
    text.decimal(static_cast<unsigned>(local.second), 2) << ".000 " << (local.hour < 12 ? "am " : "pm ");
    return text.decimal(static_cast<unsigned>(local.year));
  }

  char* line(char* at, const Entry& entry, std::uint16_t channel) noexcept {
    at = time(at, entry.time.time_since_epoch().count());
    if (entry.format == can::Format::error)
      at = error(at, entry, channel);
    else if (entry.is_fd())
      at = fd(at, entry, channel);
    else
      at = classic(at, entry, channel);
    *at++ = '\n';
    return at;
  }

  char* time(char* at, std::int64_t ns) noexcept {
    std::int64_t since = 0;
    if (ns < start_ || __builtin_sub_overflow(ns, start_, &since)) {  // the format has no sign
      losses_.add(Lost::time);
      since = 0;
    } else if (ns % 1000 != 0) {
      losses_.add(Lost::time_digits);
    }
    const auto us = static_cast<std::uint64_t>(since) / 1000;
    const auto fraction = static_cast<std::uint32_t>(us % 1'000'000);
    at = right(at, us / 1'000'000, 4);
    *at++ = '.';
    at = base::swar::two_digits(at, fraction / 10'000);
    at = base::swar::two_digits(at, fraction / 100 % 100);
    at = base::swar::two_digits(at, fraction % 100);
    *at++ = ' ';
    return at;
  }

  char* error(char* at, const Entry& entry, std::uint16_t channel) noexcept {
    if (!is_bus_error(entry)) losses_.add(Lost::error_detail);
    if (entry.direction != Direction::unknown) losses_.add(Lost::direction);
    at = left(at, channel, 2);
    return base::swar::copy(at, " ErrorFrame");
  }

  static char* classic(char* at, const Entry& entry, std::uint16_t channel) noexcept {
    at = left(at, channel, 2);
    *at++ = ' ';
    const char* const id = at;
    at = identifier(at, entry);
    at = blanks(at, 16 - (at - id));
    at = base::swar::copy(at, entry.direction == Direction::sent ? "Tx   " : "Rx   ");
    *at++ = can::is_remote(entry.format) ? 'r' : 'd';
    *at++ = ' ';
    *at++ = base::swar::upper_digits[entry.raw_dlc > can::max_dlc ? entry.raw_dlc & 0xF : entry.length & 0xF];
    return data(at, entry);
  }

  char* fd(char* at, const Entry& entry, std::uint16_t channel) noexcept {
    constexpr std::uint8_t known = flag::fd | flag::bit_rate_switch | flag::error_state;
    if ((entry.flags & ~known) != 0) losses_.add(Lost::fd_flags);
    const bool bit_rate_switch = (entry.flags & flag::bit_rate_switch) != 0;
    const bool error_state = (entry.flags & flag::error_state) != 0;
    at = base::swar::copy(at, "CANFD ");
    at = right(at, channel, 3);
    at = base::swar::copy(at, entry.direction == Direction::sent ? " Tx   " : " Rx   ");
    char id[12];
    const char* const id_end = identifier(id, entry);
    const bool extended = can::is_extended(entry.format);
    at = blanks(at, 9 - (id_end - id) - (extended ? 0 : 1));
    at = base::swar::copy(at, {id, static_cast<std::size_t>(id_end - id)});
    at = blanks(at, extended ? 34 : 35);  // where a symbolic name would stand
    *at++ = bit_rate_switch ? '1' : '0';
    *at++ = ' ';
    *at++ = error_state ? '1' : '0';
    *at++ = ' ';
    *at++ = "0123456789abcdef"[fd_dlc(entry.length)];
    *at++ = ' ';
    at = right(at, entry.length, 2);
    at = data(at, entry);
    // Duration and length in bits are not known; flags; checksum and bit timing are not known.
    at = base::swar::copy(at, "        0    0     ");
    *at++ = static_cast<char>('1' + (bit_rate_switch ? 2 : 0) + (error_state ? 4 : 0));
    return base::swar::copy(at, "000 0 0 0 0 0");
  }

  static char* identifier(char* at, const Entry& entry) noexcept {
    int shift = 28;
    while (shift > 0 && entry.id >> shift == 0) shift -= 4;
    for (; shift >= 0; shift -= 4) *at++ = base::swar::upper_digits[entry.id >> shift & 0xF];
    if (can::is_extended(entry.format)) *at++ = 'x';
    return at;
  }

  static char* data(char* at, const Entry& entry) noexcept {
    for (const std::uint8_t byte : entry.bytes()) {
      *at++ = ' ';
      at = base::swar::hex_byte(at, byte);
    }
    return at;
  }

  static char* blanks(char* at, std::ptrdiff_t count) noexcept {
    for (; count > 0; --count) *at++ = ' ';
    return at;
  }
  static char* right(char* at, std::uint64_t number, std::ptrdiff_t width) noexcept {
    base::Text<20> digits;
    digits.decimal(number);
    at = blanks(at, width - static_cast<std::ptrdiff_t>(digits.view().size()));
    return base::swar::copy(at, digits.view());
  }
  static char* left(char* at, std::uint64_t number, std::ptrdiff_t width) noexcept {
    const char* const begin = at;
    at = right(at, number, 0);
    return blanks(at, width - (at - begin));
  }

  ChannelsWritten channels_;
  std::int64_t start_ = 0;  // what times count from, ns
  bool started_ = false;
};

}  // namespace ocm::log
