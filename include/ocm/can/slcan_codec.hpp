/// SLCAN: CAN frames and the settings of an adapter as lines of text on a serial line. What both of its ends
/// share: the line of a frame, bit rates, status flags, and what happens to characters that make no line. A
/// host goes on in slcan_host.hpp, an adapter in slcan_adapter.hpp.
///
/// A line ends with CR. `t205401840302` CR is the frame 205#01840302: t is a base data frame, T an extended
/// one, r and R are the remote ones; then identifier (3 or 8 digits), length, data. An adapter may add four
/// digits of milliseconds. It answers a command with CR, or with BEL (which ends no line) when it refuses; a
/// frame with z or Z and CR. [LAWICEL CAN232 manual, version 3, chapter "CAN232 ASCII commands"]
///
/// No heap, constexpr; O(1) a character, O(line) at its end. What is not a line of the protocol is counted by
/// cause, never acted upon, and ends at the next CR.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ocm/base/result.hpp"
#include "ocm/base/text.hpp"
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
  std::string_view text = plain->view();
  text.remove_suffix(1);  // CR
  Line line;
  line << text;
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

namespace detail {

/// The `count` digits from `at` on, at most 8, as one number: Error::bad_syntax unless there are so many.
/// Without substr, which can throw: a board's image would contain what that needs.
[[nodiscard]] constexpr base::Result<std::uint32_t> digits(std::string_view line, std::size_t at,
                                                           std::size_t count) noexcept {
  if (line.size() < at + count) return base::Error::bad_syntax;
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const int digit = base::hex_digit(line[at + i]);
    if (digit < 0) return base::Error::bad_syntax;
    number = number << 4 | static_cast<std::uint32_t>(digit);
  }
  return number;
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

}  // namespace ocm::can::slcan
