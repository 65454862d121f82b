/// What candump shows on a terminal, which people paste into files and messages: read only.
///
///      (1436509052.249713)  can0  RX - -  605   [4]  00 D2 00 00   '....'
///
/// Of that, all but interface, identifier, length and data depends on candump's options. Read are -t a, A, d
/// and z, -x (direction, flags of CAN FD), -e and ERRORFRAME, -a, -i (binary digits), -S (bytes from the last
/// to the first), -8 (the length code in braces) and -d (DROPCOUNT). [can-utils candump.c, lib.c:
/// sprint_long_canframe]
///
/// Without -t all times are 0. The times of -t d and -t z look alike: if any of those that are here when the
/// first one is read is less than the one before it, they are distances. -t A is local time (calendar.hpp).
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "ocm/base/text.hpp"
#include "ocm/can/text.hpp"
#include "ocm/log/calendar.hpp"
#include "ocm/log/candump.hpp"
#include "ocm/log/reader.hpp"

namespace ocm::log {

namespace candump_screen {

/// Which of candump's -t wrote a time.
enum class Stamp : std::uint8_t { none, absolute, relative };

struct Line {
  Entry entry;  ///< its time as it is written: of a relative one, since 1970
  std::string_view interface;
  Stamp stamp = Stamp::none;
  std::optional<Cause> wrong;
};

/// Takes words off the front of a line.
class Words {
 public:
  explicit Words(std::string_view text) : rest_(text) {}
  [[nodiscard]] std::string_view next() noexcept {
    skip_blanks();
    const std::string_view word = rest_.substr(0, rest_.find_first_of(" \t"));
    rest_.remove_prefix(word.size());
    return word;
  }
  /// Up to a character, which is taken, too; nothing if it is missing.
  [[nodiscard]] std::optional<std::string_view> up_to(char end) noexcept {
    const auto at = rest_.find(end);
    if (at == std::string_view::npos) return std::nullopt;
    const std::string_view text = rest_.substr(0, at);
    rest_.remove_prefix(at + 1);
    return text;
  }
  [[nodiscard]] std::string_view rest() noexcept {
    skip_blanks();
    return rest_;
  }

 private:
  void skip_blanks() noexcept {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t\r"), rest_.size()));
  }
  std::string_view rest_;
};

/// "2015-07-10 03:10:52.249713", in local time.
[[nodiscard]] inline std::optional<base::Time> parse_date(std::string_view text) noexcept {
  if (text.size() < 19 || text[4] != '-' || text[7] != '-' || text[10] != ' ' || text[13] != ':' ||
      text[16] != ':')
    return std::nullopt;
  const auto number = [&text](std::size_t at, std::size_t digits) {
    const auto read = base::parse_unsigned(text.substr(at, digits));
    return read ? static_cast<int>(*read) : -1;
  };
  const auto seconds =
      seconds_of({number(0, 4), number(5, 2), number(8, 2), number(11, 2), number(14, 2), number(17, 2)});
  // The fraction as candump's own stamps have it.
  char fraction[12] = {'0'};
  if (!seconds || text.size() - 19 >= sizeof fraction) return std::nullopt;
  text.substr(19).copy(fraction + 1, text.size() - 19);
  const auto rest = can::detail::parse_stamp({fraction, text.size() - 18});
  if (!rest) return std::nullopt;
  return *rest + std::chrono::seconds{*seconds};
}

/// The time in brackets, if there is one.
[[nodiscard]] inline std::optional<Cause> parse_time(Words& words, Line& line) noexcept {
  if (!words.rest().starts_with('(')) return std::nullopt;
  (void)words.up_to('(');
  const auto text = words.up_to(')');
  if (!text) return Cause::syntax;
  if (const auto date = parse_date(*text)) {
    line.stamp = Stamp::absolute;
    line.entry.time = *date;
    return std::nullopt;
  }
  const auto time = can::detail::parse_stamp(*text);
  if (!time) return candump::cause_of(time.error);
  // -t a has ten digits of a second, -t d and -t z have three.
  line.stamp = text->find('.') < 10 ? Stamp::relative : Stamp::absolute;
  line.entry.time = *time;
  return std::nullopt;
}

/// "RX - -", "TX B E" of -x: direction, bit rate switch, state of the sender.
[[nodiscard]] inline std::optional<Cause> parse_extra(Words& words, std::string_view direction,
                                                      Entry& entry) noexcept {
  entry.direction = direction == "RX" ? Direction::received : Direction::sent;
  const std::string_view rate = words.next(), state = words.next();
  if ((rate != "-" && rate != "B") || (state != "-" && state != "E")) return Cause::syntax;
  if (rate == "B") entry.flags |= flag::bit_rate_switch;
  if (state == "E") entry.flags |= flag::error_state;
  return std::nullopt;
}

[[nodiscard]] inline std::optional<Cause> parse_identifier(std::string_view text, Entry& entry) noexcept {
  const auto id = base::parse_unsigned(text, 16);
  if (!id || (text.size() != 3 && text.size() != 8)) return Cause::syntax;
  entry.id = static_cast<std::uint32_t>(*id);
  entry.format = can::Format::base;
  if (text.size() == 8) {
    entry.format = (*id & can::error_frame_flag) != 0 ? can::Format::error : can::Format::extended;
    entry.id &= ~can::error_frame_flag;
  }
  const bool fits = entry.id <= (text.size() == 3 ? can::max_base_id : can::max_extended_id);
  return fits ? std::optional<Cause>{} : Cause::identifier;
}

/// "[4]", "{C}" of a classic frame, "[12]" of CAN FD.
[[nodiscard]] inline std::optional<Cause> parse_length(std::string_view text, Entry& entry) noexcept {
  if (text.size() < 3 || text.size() > 4) return Cause::syntax;
  const bool code = text.front() == '{' && text.back() == '}' && text.size() == 3;
  if (!code && (text.front() != '[' || text.back() != ']')) return Cause::syntax;
  const auto number = base::parse_unsigned(text.substr(1, text.size() - 2), code ? 16 : 10);
  if (!number) return Cause::syntax;
  const auto length = static_cast<std::size_t>(*number);
  if (text.size() == 4) {
    if (!is_fd_length(length) || entry.format == can::Format::error) return Cause::length;
    entry.flags |= flag::fd;
  } else {
    const bool any_code = code && entry.format != can::Format::error;  // a controller reports 8 bytes
    if (length > (any_code ? 15U : can::max_dlc)) return Cause::length;
    if (length > can::max_dlc) entry.raw_dlc = static_cast<std::uint8_t>(length);
    entry.flags = 0;  // -x shows some bits of every frame, which mean nothing in a classic one
  }
  entry.length =
      static_cast<std::uint8_t>(std::min<std::size_t>(length, text.size() == 4 ? length : can::max_dlc));
  return std::nullopt;
}

/// Two hexadecimal digits, or eight binary ones.
[[nodiscard]] inline std::optional<std::uint8_t> parse_byte(std::string_view text) noexcept {
  if (text.size() != 2 && text.size() != 8) return std::nullopt;
  const auto number = base::parse_unsigned(text, text.size() == 2 ? 16 : 2);
  if (!number) return std::nullopt;
  return static_cast<std::uint8_t>(*number);
}

/// The bytes, and what may follow them: the same as characters, or ERRORFRAME.
[[nodiscard]] inline std::optional<Cause> parse_data(Words& words, Entry& entry) noexcept {
  const bool error = entry.format == can::Format::error;
  std::size_t count = 0;
  if (entry.length > 0 &&
      words.rest().substr(0, words.rest().find(' ')).find('`') != std::string_view::npos) {
    // -S: "77`66`55", the last byte first.
    std::string_view all = words.next();
    for (count = 0; count < entry.length; ++count) {
      const auto end = std::min(all.find('`'), all.size());
      const auto byte = parse_byte(all.substr(0, end));
      if (!byte) return Cause::syntax;
      entry.data[entry.length - 1U - count] = *byte;
      all.remove_prefix(std::min(end + 1, all.size()));
    }
    if (!all.empty()) return Cause::length;
  }
  for (; count < entry.length; ++count) {
    const auto byte = parse_byte(words.next());
    if (!byte) return Cause::length;
    entry.data[count] = *byte;
  }
  const std::string_view rest = words.rest();
  const bool shown = rest.empty() || rest.front() == '\'' || rest.front() == '`';
  return shown || (error && rest.starts_with("ERRORFRAME")) ? std::optional<Cause>{} : Cause::length;
}

[[nodiscard]] inline std::optional<Cause> parse_frame(Words& words, Line& line) noexcept {
  Entry& entry = line.entry;
  if (const auto wrong = parse_time(words, line)) return wrong;
  line.interface = words.next();
  if (line.interface.empty() || line.interface.size() > candump::longest_name) return Cause::syntax;
  std::string_view word = words.next();
  if (word == "RX" || word == "TX") {
    if (const auto wrong = parse_extra(words, word, entry)) return wrong;
    word = words.next();
  }
  // First its form: a line that is not one of candump's has no identifier that could be out of range.
  const std::string_view length = words.next();
  if (length.size() < 3 || (length.front() != '[' && length.front() != '{')) return Cause::syntax;
  if (const auto wrong = parse_identifier(word, entry)) return wrong;
  if (const auto wrong = parse_length(length, entry)) return wrong;
  if (words.rest() == "remote request") {
    if (entry.is_fd() || entry.format == can::Format::error) return Cause::syntax;
    entry.format =
        entry.format == can::Format::base ? can::Format::base_remote : can::Format::extended_remote;
    return std::nullopt;
  }
  if (const auto wrong = parse_data(words, entry)) return wrong;
  if (entry.is_fd() || can::validate(*entry.classic())) return std::nullopt;
  return Cause::length;
}

[[nodiscard]] inline Line parse_line(std::string_view text) noexcept {
  Line line;
  Words words{text.substr(0, text.find_last_not_of(" \t\r") + 1)};
  line.wrong = parse_frame(words, line);
  return line;
}

}  // namespace candump_screen

class CandumpScreenReader final : public Reader {
 public:
  using Reader::Reader;

  /// Whether a line of what is shown is one of candump's.
  [[nodiscard]] static bool recognises(std::string_view beginning) {
    return candump::any_line(beginning, [](auto line) { return !candump_screen::parse_line(line).wrong; });
  }

  [[nodiscard]] std::size_t read(std::span<Entry> into) override {
    std::size_t count = 0;
    while (count < into.size()) {
      std::string_view text;
      const auto taken = input_->take_line(text, count == 0 ? Input::Wait::yes : Input::Wait::no);
      if (taken == Input::Line::later || taken == Input::Line::none) break;
      const Place place{input_->line_number(), true};
      if (taken == Input::Line::too_long) {
        complain(Cause::too_long, place, text);
      } else if (taken == Input::Line::last && !input_->failure().empty()) {
        complain(Cause::truncated, place, text);  // half a line may look like a whole one
        break;
      } else if (take(text, place, taken, into[count])) {
        ++count;
      }
    }
    return count;
  }

 private:
  /// How relative times count.
  enum class Relative : std::uint8_t { unknown, from_the_first, from_the_one_before };

  bool take(std::string_view text, Place place, Input::Line taken, Entry& entry) {
    if (candump::is_blank(text) || (text.front() == '\t' && after_error_)) return false;  // -e, in words
    if (take_drops(text)) return false;
    candump_screen::Line line = candump_screen::parse_line(text);
    if (line.wrong) {
      // What follows on a terminal, a prompt or ^C, has no blank at its beginning.
      complain(text.front() == ' ' ? cause_of_line(*line.wrong, taken) : *line.wrong, place, text);
      return false;
    }
    entry = line.entry;
    if (line.stamp == candump_screen::Stamp::relative) entry.time = time_of(line.entry.time);
    entry.interface = interfaces_.number(line.interface);
    after_error_ = entry.format == can::Format::error;
    if (interfaces_.name(entry.interface) == line.interface) return true;
    complain(Cause::unsupported, place, "more interfaces than any log has");
    return false;
  }

  base::Time time_of(base::Time stamp) {
    if (relative_ == Relative::unknown) relative_ = look_ahead(stamp);
    // Times from the first one do not go back.
    if (stamp < last_) relative_ = Relative::from_the_one_before;
    last_ = stamp;
    if (relative_ == Relative::from_the_first)
      time_ = stamp;
    else if (base::Time::max() - time_ > stamp.time_since_epoch() + std::chrono::seconds{1})
      time_ += stamp.time_since_epoch();
    return time_;
  }

  [[nodiscard]] Relative look_ahead(base::Time last) {
    std::string_view rest = input_->peek(input_->here());
    for (auto end = rest.find('\n'); end != std::string_view::npos; end = rest.find('\n')) {
      const candump_screen::Line line = candump_screen::parse_line(rest.substr(0, end));
      rest.remove_prefix(end + 1);
      if (line.wrong || line.stamp != candump_screen::Stamp::relative) continue;
      if (line.entry.time < last) return Relative::from_the_one_before;
      last = line.entry.time;
    }
    return Relative::from_the_first;
  }

  /// "DROPCOUNT: dropped 3 CAN frames on 'can0' socket (total drops 3)", of -d.
  bool take_drops(std::string_view text) {
    constexpr std::string_view begin = "DROPCOUNT: dropped ";
    if (!text.starts_with(begin)) return false;
    candump_screen::Words words{text.substr(begin.size())};
    const auto count = base::parse_unsigned(words.next());
    (void)words.up_to('\'');
    const auto name = words.up_to('\'');
    if (!count || !name || name->empty() || name->size() > candump::longest_name) return false;
    const std::uint16_t number = interfaces_.number(*name);
    if (recorded_.size() <= number) recorded_.resize(number + std::size_t{1});
    recorded_[number].dropped += *count;
    return true;
  }

  Relative relative_ = Relative::unknown;
  base::Time last_{};  ///< as it was written
  base::Time time_{};  ///< of the last entry
  bool after_error_ = false;
};

}  // namespace ocm::log
