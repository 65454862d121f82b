/// Frames as text, in the notation of can-utils: `205#01840302`, `605#R`, `1F334455#DEADBEEF`, and the log
/// line
/// `(1436509052.249713) can0 605#00D20000` of `candump -l`. Both ways, constexpr, no heap.
///
/// An identifier of three hex digits is a base one, of eight an extended one; bit 29 of eight digits marks an
/// error frame (20000040#...). [can-utils lib.h]
#pragma once

#include <cstdint>
#include <string_view>

#include "ocm/base/result.hpp"
#include "ocm/base/text.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"

namespace ocm::can {

inline constexpr std::uint32_t error_frame_flag = 0x2000'0000;  ///< CAN_ERR_FLAG [linux/can.h]
inline constexpr std::size_t max_frame_text = 8 + 1 + 16;

using FrameText = base::Text<max_frame_text>;

/// Longest: `1F334455#1122334455667788`, 25 characters.
[[nodiscard]] constexpr FrameText to_text(const Frame& frame) noexcept {
  FrameText out;
  if (frame.format == Format::error)
    out.hex(frame.id | error_frame_flag, 8);
  else
    out.hex(frame.id, is_extended(frame.format) ? 8 : 3);
  out << '#';
  if (is_remote(frame.format)) {
    out << 'R';
    if (frame.dlc != 0) out.decimal(frame.dlc);
    return out;
  }
  for (const std::uint8_t byte : frame.bytes()) out.hex(byte, 2);
  return out;
}

/// Reads what `to_text` writes, lower-case too, and single dots between data bytes as cansend does. Refuses
/// with bad_syntax, bad_identifier (too large, or not of three or eight digits), bad_length (more than 8
/// bytes).
[[nodiscard]] constexpr base::Result<Frame> parse_frame(std::string_view text) noexcept {
  using base::Error;
  const auto hash = text.find('#');
  if (hash == std::string_view::npos) return Error::bad_syntax;
  const std::string_view id_text = text.substr(0, hash);
  std::string_view data_text = text.substr(hash + 1);
  const auto id = base::parse_unsigned(id_text, 16);
  if (!id || (id_text.size() != 3 && id_text.size() != 8)) return Error::bad_identifier;

  Frame frame;
  frame.id = static_cast<std::uint32_t>(*id);
  frame.format = id_text.size() == 3 ? Format::base : Format::extended;
  if (frame.format == Format::extended && (frame.id & error_frame_flag) != 0) {
    frame.format = Format::error;
    frame.id &= ~error_frame_flag;
  }
  if (!data_text.empty() && (data_text.front() == 'R' || data_text.front() == 'r')) {
    if (frame.format == Format::error) return Error::bad_syntax;
    frame.format = frame.format == Format::base ? Format::base_remote : Format::extended_remote;
    data_text.remove_prefix(1);
    if (!data_text.empty()) {
      const auto length = base::parse_unsigned(data_text);
      if (!length || data_text.size() != 1) return Error::bad_syntax;
      if (*length > max_dlc) return Error::bad_length;
      frame.dlc = static_cast<std::uint8_t>(*length);
    }
  } else {
    std::size_t i = 0;
    while (i < data_text.size()) {
      if (data_text[i] == '.' && i > 0) ++i;  // one, between bytes
      if (i + 1 >= data_text.size()) return Error::bad_syntax;
      const int high = base::hex_digit(data_text[i]);
      const int low = base::hex_digit(data_text[i + 1]);
      if (high < 0 || low < 0) return Error::bad_syntax;
      if (frame.dlc == max_dlc) return Error::bad_length;
      frame.data[frame.dlc++] = static_cast<std::uint8_t>(high << 4 | low);
      i += 2;
    }
  }
  const auto valid = validate(frame);
  if (!valid) return valid.error;
  return frame;
}

/// The words of a line of a candump log; the views point into the line.
struct LogWords {
  base::Time time{};
  std::string_view interface;
  std::string_view frame;  ///< not read yet
  char direction = 0;      ///< 'R' received, 'T' sent, 0 not said (candump's optional suffix)
};

/// One line of a candump log: when, on which interface, what. `interface` points into the parsed line.
struct LogLine {
  base::Time time{};
  std::string_view interface;
  Frame frame;
  char direction = 0;  ///< as in LogWords
};

namespace detail {
constexpr std::string_view take_word(std::string_view& text) noexcept {
  std::size_t begin = 0;
  while (begin < text.size() && (text[begin] == ' ' || text[begin] == '\t')) ++begin;
  std::size_t end = begin;
  while (end < text.size() && text[end] != ' ' && text[end] != '\t') ++end;
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

/// `seconds.fraction`, with 0 to 9 digits of fraction.
constexpr base::Result<base::Time> parse_stamp(std::string_view stamp) noexcept {
  using base::Error;
  const auto point = stamp.find('.');
  const auto seconds = base::parse_unsigned(stamp.substr(0, point));
  if (!seconds) return seconds.error;
  if (*seconds > INT64_MAX / 1'000'000'000 - 1) return Error::out_of_range;
  std::uint64_t nanoseconds = 0;
  if (point != std::string_view::npos) {
    const std::string_view fraction = stamp.substr(point + 1);
    const auto digits = base::parse_unsigned(fraction);
    if (!digits || fraction.size() > 9) return Error::bad_syntax;
    nanoseconds = *digits;
    for (std::size_t i = fraction.size(); i < 9; ++i) nanoseconds *= 10;
  }
  return base::Time{base::Duration{static_cast<std::int64_t>(*seconds * 1'000'000'000 + nanoseconds)}};
}
}  // namespace detail

/// Takes `(seconds.fraction) interface frame [R|T]` apart and reads all but the frame, which may be of more
/// kinds than a board knows. Refuses with bad_syntax, and out_of_range (a time beyond 64 bits of
/// nanoseconds).
[[nodiscard]] constexpr base::Result<LogWords> split_log_line(std::string_view text) noexcept {
  using base::Error;
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r' || text.back() == ' '))
    text.remove_suffix(1);
  const std::string_view stamp = detail::take_word(text);
  if (stamp.size() < 3 || stamp.front() != '(' || stamp.back() != ')') return Error::bad_syntax;
  const auto time = detail::parse_stamp(stamp.substr(1, stamp.size() - 2));
  if (!time) return time.error;
  LogWords words;
  words.time = *time;
  words.interface = detail::take_word(text);
  words.frame = detail::take_word(text);
  if (words.frame.empty()) return Error::bad_syntax;
  const std::string_view direction = detail::take_word(text);
  if (!direction.empty()) {
    if (direction != "R" && direction != "T") return Error::bad_syntax;
    words.direction = direction.front();
  }
  if (!detail::take_word(text).empty()) return Error::bad_syntax;
  return words;
}

/// Reads a line of a log of classic frames.
[[nodiscard]] constexpr base::Result<LogLine> parse_log_line(std::string_view text) noexcept {
  const auto words = split_log_line(text);
  if (!words) return words.error;
  const auto frame = parse_frame(words->frame);
  if (!frame) return frame.error;
  return LogLine{words->time, words->interface, *frame, words->direction};
}

/// Interface names have at most 15 characters on Linux; longer ones overflow the text, which says so.
using LogLineText = base::Text<96>;

/// Microseconds, as candump -l writes them. A time before 1970 is written as 0.
[[nodiscard]] constexpr LogLineText to_log_line(base::Time time, std::string_view interface,
                                                const Frame& frame) noexcept {
  const std::int64_t ns = time.time_since_epoch().count();
  const std::uint64_t us = ns < 0 ? 0 : static_cast<std::uint64_t>(ns) / 1000;
  LogLineText out;
  out << '(';
  out.decimal(us / 1'000'000, 10) << '.';
  out.decimal(us % 1'000'000, 6) << ") " << interface << ' ' << to_text(frame).view();
  return out;
}

}  // namespace ocm::can
