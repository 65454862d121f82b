/// SLCAN: CAN frames and the settings of an adapter as lines of text on a serial line, for both of its ends.
/// A host writes commands and reads answers (`AnswerReader`); an adapter reads commands and writes answers
/// (`CommandReader`, or `Adapter`, which also knows what is allowed when).
///
/// A line ends with CR. `t205401840302` CR is the frame 205#01840302: t is a base data frame, T an extended
/// one, r and R are the remote ones; then identifier (3 or 8 digits), length, data. An adapter may add four
/// digits of milliseconds. It answers a command with CR, or with BEL (which ends no line) when it refuses; a
/// frame with z or Z and CR. [LAWICEL CAN232 manual, version 3, chapter "CAN232 ASCII commands"]
/// Beyond that manual, answers hold what linux's driver understands of bus errors: `e1a`, `sw128096`.
/// [linux 6.1, drivers/net/can/slcan/slcan-core.c, slc_bump_err and slc_bump_state]
///
/// No heap, constexpr; O(1) a character, O(line) at its end. A reader of answers and an Adapter take 84 bytes
/// each. What is not a line of the protocol is counted by cause, never acted upon, and ends at the next CR.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ocm/base/result.hpp"
#include "ocm/base/text.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/can/error_frame.hpp"
#include "ocm/can/frame.hpp"

namespace ocm::can::slcan {

inline constexpr char carriage_return = '\r';  ///< ends a line; alone: done
inline constexpr char bell = '\a';             ///< refused

/// Time stamps count milliseconds from 0 to 0xEA5F and start again. [CAN232 manual, command Z]
inline constexpr std::uint16_t stamp_period = 60'000;

/// T, identifier, length, data, time stamp: 30 characters, and CR.
inline constexpr std::size_t max_frame_line = 1 + 8 + 1 + 16 + 4;
using Line = base::Text<max_frame_line + 1>;

/// Of command S, by its digit. [CAN232 manual, command S; can-utils slcand -s]
inline constexpr std::array<std::uint32_t, 9> bit_rates{10'000,  20'000,  50'000,  100'000,  125'000,
                                                        250'000, 500'000, 800'000, 1'000'000};

/// The digit of command S; Error::out_of_range when there is none.
[[nodiscard]] constexpr base::Result<std::uint8_t> bit_rate_code(std::uint32_t bit_rate) noexcept {
  for (std::size_t i = 0; i < bit_rates.size(); ++i)
    if (bit_rates[i] == bit_rate) return static_cast<std::uint8_t>(i);
  return base::Error::out_of_range;
}

/// The one of `bit_rates` that is nearest, the lower of two.
[[nodiscard]] constexpr std::uint32_t nearest_bit_rate(std::uint32_t bit_rate) noexcept {
  const auto distance = [bit_rate](std::uint32_t other) {
    return other > bit_rate ? other - bit_rate : bit_rate - other;
  };
  std::uint32_t best = bit_rates[0];
  for (const std::uint32_t rate : bit_rates)
    if (distance(rate) < distance(best)) best = rate;
  return best;
}

/// What command s asks for, in bit/s: the bus timing registers of an SJA1000 with a 16 MHz crystal.
/// [CAN232 manual, command s; SJA1000 data sheet, 6.5.1 and 6.5.2]
[[nodiscard]] constexpr std::uint32_t bit_rate_of_registers(std::uint8_t btr0, std::uint8_t btr1) noexcept {
  const std::uint32_t prescaler = 2 * ((btr0 & 0x3FU) + 1);
  const std::uint32_t quanta = 1 + ((btr1 & 0x0FU) + 1) + ((btr1 >> 4U & 0x07U) + 1);
  return 16'000'000 / (prescaler * quanta);
}

/// Bits of the answer to F. [CAN232 manual, command F]
namespace status {
inline constexpr std::uint8_t receive_queue_full = 0x01;
inline constexpr std::uint8_t transmit_queue_full = 0x02;
inline constexpr std::uint8_t warning = 0x04;
inline constexpr std::uint8_t overrun = 0x08;
inline constexpr std::uint8_t passive = 0x20;
inline constexpr std::uint8_t arbitration_lost = 0x40;
inline constexpr std::uint8_t bus_error = 0x80;
/// What stays as long as it is so; the others are events, and are cleared by F.
inline constexpr std::uint8_t states = warning | passive;
}  // namespace status

/// The line of a frame, CR included, without a time stamp: what a host sends. Error::bad_identifier and
/// bad_length as can::validate; an error frame has no line.
[[nodiscard]] constexpr base::Result<Line> encode(const Frame& frame) noexcept {
  if (frame.format == Format::error) return base::Error::bad_identifier;
  if (const auto valid = validate(frame); !valid) return valid.error;
  Line line;
  const bool extended = is_extended(frame.format);
  if (is_remote(frame.format))
    line << (extended ? 'R' : 'r');
  else
    line << (extended ? 'T' : 't');
  line.hex(frame.id, extended ? 8 : 3).decimal(frame.dlc);
  for (const std::uint8_t byte : frame.bytes()) line.hex(byte, 2);
  return line << carriage_return;
}

/// As above, with a time stamp in milliseconds (taken modulo a minute): what an adapter sends after Z1.
[[nodiscard]] constexpr base::Result<Line> encode(const Frame& frame, std::uint32_t milliseconds) noexcept {
  const auto plain = encode(frame);
  if (!plain) return plain.error;
  Line line;
  line << plain->view().substr(0, plain->view().size() - 1);
  return line.hex(milliseconds % stamp_period, 4) << carriage_return;
}

/// Why characters were thrown away: one count a line.
struct LineFaults {
  std::uint32_t too_long = 0;        ///< more characters than any line has: CRs are missing
  std::uint32_t noise = 0;           ///< a character that no line has: another speed of the serial line?
  std::uint32_t torn = 0;            ///< BEL in the middle of a line
  std::uint32_t unknown = 0;         ///< begins with a letter that has no meaning here
  std::uint32_t bad_syntax = 0;      ///< not digits where digits belong, or too few, or too many
  std::uint32_t bad_identifier = 0;  ///< of more than 11 or 29 bits
  std::uint32_t bad_length = 0;      ///< more than 8 bytes
  [[nodiscard]] constexpr std::uint64_t total() const noexcept {
    return std::uint64_t{too_long} + noise + torn + unknown + bad_syntax + bad_identifier + bad_length;
  }
  friend constexpr bool operator==(const LineFaults&, const LineFaults&) = default;
};

/// What an adapter says.
struct Answer {
  enum class Kind : std::uint8_t {
    none,
    frame,         ///< heard on the bus, or an error frame that the adapter's report stands for
    done,          ///< CR
    taken,         ///< z or Z: the frame was taken for transmission
    refused,       ///< BEL
    status_flags,  ///< F: `value`
    version,       ///< V: `text` after the letter
    serial,        ///< N: the same
  };
  Kind kind = Kind::none;
  bool stamped = false;
  std::uint16_t stamp = 0;  ///< milliseconds, below `stamp_period`
  std::uint8_t flags = 0;   ///< bits of `status`
  Frame frame{};
  std::string_view text{};  ///< valid until the reader's next `feed`
};

/// What a host says.
struct Command {
  enum class Kind : std::uint8_t {
    nothing,  ///< an empty line
    transmit,
    open,
    listen,
    close,
    bit_rate,   ///< S: `value` is the digit
    registers,  ///< s: `value` is BTR0 << 8 | BTR1
    version,
    serial,
    status_flags,
    stamps,           ///< Z: `value` is 0 or 1
    auto_poll,        ///< X: the same
    acceptance_code,  ///< M
    acceptance_mask,  ///< m
  };
  Kind kind = Kind::nothing;
  std::uint32_t value = 0;
  Frame frame{};
};

namespace detail {

/// The digits from `at` on as one number: Error::bad_syntax unless there are `count` of them.
[[nodiscard]] constexpr base::Result<std::uint32_t> digits(std::string_view line, std::size_t at,
                                                           std::size_t count) noexcept {
  if (line.size() < at + count) return base::Error::bad_syntax;
  const auto number = base::parse_unsigned(line.substr(at, count), 16);
  if (!number) return number.error;
  return static_cast<std::uint32_t>(*number);
}

/// A frame, and where in the line it ends.
struct ParsedFrame {
  Frame frame{};
  std::size_t end = 0;
};

/// `line` begins with one of t T r R.
[[nodiscard]] constexpr base::Result<ParsedFrame> parse_frame(std::string_view line) noexcept {
  ParsedFrame out;
  Frame& frame = out.frame;
  const bool extended = line[0] == 'T' || line[0] == 'R';
  const bool remote = line[0] == 'r' || line[0] == 'R';
  if (remote)
    frame.format = extended ? Format::extended_remote : Format::base_remote;
  else
    frame.format = extended ? Format::extended : Format::base;
  const std::size_t width = extended ? 8 : 3;
  const auto id = digits(line, 1, width);
  if (!id) return id.error;
  const auto length = digits(line, 1 + width, 1);
  if (!length) return length.error;
  if (*length > max_dlc) return base::Error::bad_length;
  frame.id = *id;
  frame.dlc = static_cast<std::uint8_t>(*length);
  if (const auto valid = validate(frame); !valid) return valid.error;
  out.end = 2 + width;
  for (std::size_t i = 0; i < frame.bytes().size(); ++i, out.end += 2) {
    const auto byte = digits(line, out.end, 2);
    if (!byte) return byte.error;
    frame.data[i] = static_cast<std::uint8_t>(*byte);
  }
  return out;
}

/// `e` and how many letters follow: each is an error. The frame is the one that linux's driver makes of it.
[[nodiscard]] constexpr base::Result<Frame> parse_errors(std::string_view line) noexcept {
  const auto count = digits(line, 1, 1);
  if (!count) return count.error;
  if (*count == 0 || line.size() != 2 + *count) return base::Error::bad_syntax;
  Frame frame{.id = error_class::protocol | error_class::bus_error,
              .dlc = max_dlc,
              .data = {},
              .format = Format::error};
  for (const char letter : line.substr(2)) {
    switch (letter) {
      case 'o':
      case 'O':
        frame.id |= error_class::controller;
        frame.data[1] |= letter == 'o' ? controller_error::rx_overflow : controller_error::tx_overflow;
        break;
      case 'a':
        frame.id |= error_class::no_acknowledgement;
        frame.data[3] = 0x19;
        break;
      case 'b':
        frame.data[2] |= protocol_error::dominant_bit;
        break;
      case 'B':
        frame.data[2] |= protocol_error::recessive_bit;
        break;
      case 'c':
        frame.data[2] |= protocol_error::bit;
        frame.data[3] = 0x08;
        break;
      case 'f':
        frame.data[2] |= protocol_error::form;
        break;
      case 's':
        frame.data[2] |= protocol_error::stuff;
        break;
      default:
        return base::Error::bad_syntax;
    }
  }
  return frame;
}

/// `s`, a state, and the error counters in three decimal digits each: receiving, then sending.
[[nodiscard]] constexpr base::Result<Frame> parse_state(std::string_view line) noexcept {
  if (line.size() != 8) return base::Error::bad_syntax;
  const auto rx = base::parse_unsigned(line.substr(2, 3));
  const auto tx = base::parse_unsigned(line.substr(5, 3));
  if (!rx || !tx) return base::Error::bad_syntax;
  Frame frame{.id = error_class::controller, .dlc = max_dlc, .data = {}, .format = Format::error};
  const bool of_tx = *tx >= *rx;
  const bool of_rx = *rx >= *tx;
  switch (line[1]) {
    case 'a':
      frame.data[1] = controller_error::active;
      break;
    case 'w':
      if (of_tx) frame.data[1] |= controller_error::tx_warning;
      if (of_rx) frame.data[1] |= controller_error::rx_warning;
      break;
    case 'p':
      if (of_tx) frame.data[1] |= controller_error::tx_passive;
      if (of_rx) frame.data[1] |= controller_error::rx_passive;
      break;
    case 'b':
      frame.id = error_class::bus_off;
      return frame;  // counters of 256 and more have no byte
    default:
      return base::Error::bad_syntax;
  }
  frame.id |= error_class::counters;
  frame.data[6] = static_cast<std::uint8_t>(std::min<std::uint64_t>(*tx, 255));
  frame.data[7] = static_cast<std::uint8_t>(std::min<std::uint64_t>(*rx, 255));
  return frame;
}

}  // namespace detail

/// One line of an adapter, without its CR. Error::bad_mode: begins with an unknown letter.
[[nodiscard]] constexpr base::Result<Answer> parse_answer(std::string_view line) noexcept {
  using Kind = Answer::Kind;
  Answer answer;
  if (line.empty()) {
    answer.kind = Kind::done;
    return answer;
  }
  switch (line[0]) {
    case 't':
    case 'T':
    case 'r':
    case 'R': {
      const auto parsed = detail::parse_frame(line);
      if (!parsed) return parsed.error;
      answer.kind = Kind::frame;
      answer.frame = parsed->frame;
      if (parsed->end == line.size()) return answer;
      const auto stamp = detail::digits(line, parsed->end, 4);
      if (!stamp || line.size() != parsed->end + 4 || *stamp >= stamp_period) return base::Error::bad_syntax;
      answer.stamped = true;
      answer.stamp = static_cast<std::uint16_t>(*stamp);
      return answer;
    }
    case 'z':
    case 'Z':
      if (line.size() != 1) return base::Error::bad_syntax;
      answer.kind = Kind::taken;
      return answer;
    case 'F': {
      const auto flags = detail::digits(line, 1, 2);
      if (!flags || line.size() != 3) return base::Error::bad_syntax;
      answer.kind = Kind::status_flags;
      answer.flags = static_cast<std::uint8_t>(*flags);
      return answer;
    }
    case 'V':
    case 'N':
      answer.kind = line[0] == 'V' ? Kind::version : Kind::serial;
      answer.text = line.substr(1);
      return answer;
    case 'e':
    case 's': {
      const auto frame = line[0] == 'e' ? detail::parse_errors(line) : detail::parse_state(line);
      if (!frame) return frame.error;
      answer.kind = Kind::frame;
      answer.frame = *frame;
      return answer;
    }
    default:
      return base::Error::bad_mode;
  }
}

/// One line of a host, without its CR. Error::bad_mode: begins with an unknown letter.
[[nodiscard]] constexpr base::Result<Command> parse_command(std::string_view line) noexcept {
  using Kind = Command::Kind;
  Command command;
  const auto alone = [&](Kind kind) -> base::Result<Command> {
    if (line.size() != 1) return base::Error::bad_syntax;
    command.kind = kind;
    return command;
  };
  const auto with_digits = [&](Kind kind, std::size_t count, std::uint32_t highest) -> base::Result<Command> {
    const auto value = detail::digits(line, 1, count);
    if (!value || line.size() != 1 + count || *value > highest) return base::Error::bad_syntax;
    command.kind = kind;
    command.value = *value;
    return command;
  };
  if (line.empty()) return command;
  switch (line[0]) {
    case 't':
    case 'T':
    case 'r':
    case 'R': {
      const auto parsed = detail::parse_frame(line);
      if (!parsed) return parsed.error;
      if (parsed->end != line.size()) return base::Error::bad_syntax;
      command.kind = Kind::transmit;
      command.frame = parsed->frame;
      return command;
    }
    case 'O':
      return alone(Kind::open);
    case 'L':
      return alone(Kind::listen);
    case 'C':
      return alone(Kind::close);
    case 'S':
      return with_digits(Kind::bit_rate, 1, bit_rates.size() - 1);
    case 's':
      return with_digits(Kind::registers, 4, 0xFFFF);
    case 'V':
      return alone(Kind::version);
    case 'N':
      return alone(Kind::serial);
    case 'F':
      return alone(Kind::status_flags);
    case 'Z':
      return with_digits(Kind::stamps, 1, 1);
    case 'X':
      return with_digits(Kind::auto_poll, 1, 1);
    case 'M':
      return with_digits(Kind::acceptance_code, 8, UINT32_MAX);
    case 'm':
      return with_digits(Kind::acceptance_mask, 8, UINT32_MAX);
    default:
      return base::Error::bad_mode;
  }
}

namespace detail {

/// Collects the characters of a line of at most N. What follows a fault is skipped to the next end.
template <std::size_t N>
class LineCollector {
 public:
  /// A line feed is skipped: some adapters end lines with both.
  constexpr void feed(char c, LineFaults& faults) noexcept {
    if (skipping_ || c == '\n') return;
    if (c < ' ' || c > '~') {
      ++faults.noise;
      skipping_ = true;
    } else if (size_ == N) {
      ++faults.too_long;
      skipping_ = true;
    } else {
      chars_[size_++] = c;
    }
  }
  [[nodiscard]] constexpr std::string_view line() const noexcept { return {chars_.data(), size_}; }
  /// Whether the characters so far are the beginning of a line, and no more.
  [[nodiscard]] constexpr bool started() const noexcept { return size_ != 0 && !skipping_; }
  [[nodiscard]] constexpr bool spoilt() const noexcept { return skipping_; }
  constexpr void restart() noexcept {
    size_ = 0;
    skipping_ = false;
  }

 private:
  std::array<char, N> chars_{};
  std::uint8_t size_ = 0;
  bool skipping_ = false;
};

constexpr void count(base::Error error, LineFaults& faults) noexcept {
  switch (error) {
    case base::Error::bad_mode:
      ++faults.unknown;
      return;
    case base::Error::bad_identifier:
      ++faults.bad_identifier;
      return;
    case base::Error::bad_length:
      ++faults.bad_length;
      return;
    default:
      ++faults.bad_syntax;
  }
}

}  // namespace detail

/// Makes answers of what comes from an adapter, a character at a time.
class AnswerReader {
 public:
  /// Kind::none unless the character completes an answer.
  constexpr Answer feed(char c) noexcept {
    if (ended_) line_.restart();
    ended_ = c == carriage_return || c == bell;
    if (!ended_) {
      line_.feed(c, faults_);
      return {};
    }
    if (c == bell) {
      if (line_.started()) ++faults_.torn;
      Answer answer;
      answer.kind = Answer::Kind::refused;
      return answer;
    }
    if (line_.spoilt()) return {};
    const auto answer = parse_answer(line_.line());
    if (answer) return *answer;
    detail::count(answer.error, faults_);
    return {};
  }
  [[nodiscard]] constexpr const LineFaults& faults() const noexcept { return faults_; }
  /// Whether a line has begun and not ended.
  [[nodiscard]] constexpr bool mid_line() const noexcept {
    return !ended_ && (line_.started() || line_.spoilt());
  }

 private:
  /// Some adapters have a long version: 47 characters of it fit.
  detail::LineCollector<48> line_;
  LineFaults faults_{};
  bool ended_ = false;
};

/// Makes commands of what comes from a host, a character at a time.
class CommandReader {
 public:
  struct Outcome {
    bool complete = false;  ///< a line has ended; `command` is it, or why it is none
    base::Result<Command> command{};
  };
  constexpr Outcome feed(char c) noexcept {
    if (c != carriage_return) {
      line_.feed(c, faults_);
      return {};
    }
    Outcome out{.complete = true, .command = base::Error::bad_syntax};
    if (!line_.spoilt()) {
      out.command = parse_command(line_.line());
      if (!out.command) detail::count(out.command.error, faults_);
    }
    line_.restart();
    return out;
  }
  [[nodiscard]] constexpr const LineFaults& faults() const noexcept { return faults_; }

 private:
  detail::LineCollector<max_frame_line> line_;
  LineFaults faults_{};
};

/// What the answer to F means, as an error frame like those of linux's drivers: events are told each time,
/// states when they are not as in `before`. Its identifier is 0 when there is nothing to tell.
[[nodiscard]] constexpr Frame to_error_frame(std::uint8_t flags, std::uint8_t before) noexcept {
  Frame frame{.id = 0, .dlc = max_dlc, .data = {}, .format = Format::error};
  std::uint8_t& what = frame.data[1];
  if ((flags & (status::receive_queue_full | status::overrun)) != 0) what |= controller_error::rx_overflow;
  if ((flags & status::transmit_queue_full) != 0) what |= controller_error::tx_overflow;
  if (((flags ^ before) & status::states) != 0) {
    if ((flags & status::passive) != 0)
      what |= controller_error::rx_passive | controller_error::tx_passive;
    else if ((flags & status::warning) != 0)
      what |= controller_error::rx_warning | controller_error::tx_warning;
    else
      what |= controller_error::active;
  }
  if (what != 0) frame.id |= error_class::controller;
  if ((flags & status::bus_error) != 0) frame.id |= error_class::bus_error;
  return frame;
}

/// What an adapter is, said to whoever asks.
struct AdapterInfo {
  std::uint8_t hardware = 0x10;  ///< two digits: 1.0
  std::uint8_t software = 0x10;
  std::array<char, 4> serial{'0', '0', '0', '0'};
  /// Bit n: command Sn is served. All of them unless told.
  std::uint16_t bit_rates = 0x1FF;
};

/// The adapter's side of the protocol: which command is allowed when, what is answered, which frames go up.
/// Commands P, A, W, U and Q of the manual are refused: frames go up by themselves (X1) and nothing is
/// stored.
class Adapter {
 public:
  enum class Channel : std::uint8_t { closed, open, listen_only };
  /// Longest: V, four digits, CR.
  using Reply = base::Text<8>;

  constexpr explicit Adapter(const AdapterInfo& info = {}) noexcept : info_(info) {}

  /// A character from the host. What is to go back is returned, mostly nothing; frames go to `bus`. A frame
  /// for which the bus has no room is refused with BEL and shows in the status flags: the host sends it
  /// again.
  template <Sender B>
  constexpr Reply feed(char c, B& bus) noexcept(noexcept(bus.send(Frame{}))) {
    const auto line = reader_.feed(c);
    if (!line.complete) return {};
    if (!line.command) return refused();
    return execute(*line.command, bus);
  }

  /// A frame from the bus: the line for the host, empty when the channel is closed, the filter refuses it or
  /// it is an error frame. `now` stamps it, from any start.
  [[nodiscard]] constexpr Line hear(const Frame& frame, base::Time now) const noexcept {
    if (channel_ == Channel::closed || !accepts(frame)) return {};
    const std::int64_t ms = now.time_since_epoch() / std::chrono::milliseconds{1};
    const auto phase = static_cast<std::uint32_t>((ms % stamp_period + stamp_period) % stamp_period);
    return (stamps_ ? encode(frame, phase) : encode(frame)).value;
  }

  /// What went wrong on the bus or in the adapter: bits of `status`. The states replace the old ones, the
  /// events stay until the host has asked with F.
  constexpr void report(std::uint8_t flags) noexcept {
    flags_ = static_cast<std::uint8_t>((flags_ & ~status::states) | flags);
  }

  [[nodiscard]] constexpr Channel channel() const noexcept { return channel_; }
  /// In bit/s; 0 until the host has chosen.
  [[nodiscard]] constexpr std::uint32_t bit_rate() const noexcept { return bit_rate_; }
  [[nodiscard]] constexpr bool stamps() const noexcept { return stamps_; }
  [[nodiscard]] constexpr std::uint8_t flags() const noexcept { return flags_; }
  [[nodiscard]] constexpr const LineFaults& faults() const noexcept { return reader_.faults(); }

  /// The SJA1000's two filters over code and mask (a mask bit of 1: either will do): each has the upper
  /// identifier bits, for base frames also RTR; the first has a data byte too, which code and mask split.
  /// [CAN232 manual, commands M and m; SJA1000 data sheet, 6.4.15.2 and tables 19, 20]
  [[nodiscard]] constexpr bool accepts(const Frame& frame) const noexcept {
    const auto matches = [](std::uint32_t have, std::uint32_t code, std::uint32_t mask) {
      return ((have ^ code) & ~mask) == 0;
    };
    const auto word = [](std::uint32_t all, unsigned shift) { return all >> shift & 0xFFFFU; };
    if (is_extended(frame.format)) {
      const std::uint32_t upper = frame.id >> 13;  // ID.28 to ID.13
      return matches(upper, word(code_, 16), word(mask_, 16)) ||
             matches(upper, word(code_, 0), word(mask_, 0));
    }
    const std::uint32_t rtr = is_remote(frame.format) ? 1 : 0;
    const std::uint32_t head = frame.id << 5 | rtr << 4;
    // The lower nibbles of the second and fourth register are the first data byte's, and the first filter's.
    const std::uint32_t byte = frame.bytes().empty() ? 0 : frame.data[0];
    const std::uint32_t byte_code = word(code_, 16) % 16 << 4 | code_ % 16;
    const std::uint32_t byte_mask = frame.bytes().empty() ? 0xFF : word(mask_, 16) % 16 << 4 | mask_ % 16;
    const bool first =
        matches(head, word(code_, 16) & ~0xFU, word(mask_, 16) | 0xF) && matches(byte, byte_code, byte_mask);
    return first || matches(head, word(code_, 0) & ~0xFU, word(mask_, 0) | 0xF);
  }

 private:
  [[nodiscard]] static constexpr Reply refused() noexcept { return Reply{} << bell; }
  [[nodiscard]] static constexpr Reply done() noexcept { return Reply{} << carriage_return; }
  [[nodiscard]] static constexpr Reply done_if(bool allowed) noexcept { return allowed ? done() : refused(); }

  template <Sender B>
  constexpr Reply execute(const Command& command, B& bus) {
    using Kind = Command::Kind;
    const bool closed = channel_ == Channel::closed;
    switch (command.kind) {
      case Kind::nothing:
        return done();
      case Kind::transmit: {
        if (channel_ != Channel::open) return refused();
        const base::Result<bool> sent = bus.send(command.frame);
        if (!sent || !*sent) {
          flags_ |= status::transmit_queue_full;
          return refused();
        }
        return Reply{} << (is_extended(command.frame.format) ? 'Z' : 'z') << carriage_return;
      }
      case Kind::open:
      case Kind::listen:
        if (!closed || bit_rate_ == 0) return refused();
        channel_ = command.kind == Kind::open ? Channel::open : Channel::listen_only;
        flags_ = 0;
        return done();
      case Kind::close:
        if (closed) return refused();
        channel_ = Channel::closed;
        return done();
      case Kind::bit_rate:
        return set_bit_rate(bit_rates[command.value]);
      case Kind::registers:
        return set_bit_rate(bit_rate_of_registers(static_cast<std::uint8_t>(command.value >> 8),
                                                  static_cast<std::uint8_t>(command.value & 0xFF)));
      case Kind::version:
        return (Reply{} << 'V').hex(info_.hardware, 2).hex(info_.software, 2) << carriage_return;
      case Kind::serial:
        return Reply{} << 'N' << std::string_view{info_.serial.data(), info_.serial.size()}
                       << carriage_return;
      case Kind::status_flags: {
        if (closed) return refused();
        const Reply reply = (Reply{} << 'F').hex(flags_, 2) << carriage_return;
        flags_ &= status::states;
        return reply;
      }
      case Kind::stamps:
        if (closed) stamps_ = command.value == 1;
        return done_if(closed);
      case Kind::auto_poll:
        return done_if(closed && command.value == 1);
      case Kind::acceptance_code:
      case Kind::acceptance_mask:
        if (!closed || bit_rate_ == 0) return refused();
        (command.kind == Kind::acceptance_code ? code_ : mask_) = command.value;
        return done();
    }
    return refused();
  }

  constexpr Reply set_bit_rate(std::uint32_t rate) noexcept {
    const auto code = bit_rate_code(rate);
    if (channel_ != Channel::closed || !code || (info_.bit_rates >> *code & 1U) == 0) return refused();
    bit_rate_ = rate;
    return done();
  }

  AdapterInfo info_;
  CommandReader reader_;
  Channel channel_ = Channel::closed;
  bool stamps_ = false;
  std::uint8_t flags_ = 0;
  std::uint32_t bit_rate_ = 0;
  std::uint32_t code_ = 0;            ///< AC0 to AC3, AC0 first
  std::uint32_t mask_ = 0xFFFF'FFFF;  ///< AM0 to AM3; as after power-up: everything passes
};

}  // namespace ocm::can::slcan
