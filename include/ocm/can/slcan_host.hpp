/// The host's end of SLCAN (slcan_codec.hpp): reads what an adapter answers. Beyond the manual, answers hold
/// what linux's driver understands of bus errors: `e1a`, `sw128096`. [linux 6.1,
/// drivers/net/can/slcan/slcan-core.c, slc_bump_err and slc_bump_state]
///
/// No heap, constexpr; O(1) a character, O(line) at its end. A reader takes 84 bytes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "ocm/base/result.hpp"
#include "ocm/base/text.hpp"
#include "ocm/can/error_frame.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/can/slcan_codec.hpp"

namespace ocm::can::slcan {

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

namespace detail {

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

/// What the answer to F means, as an error frame like those of linux's drivers: events are reported each
/// time, states when they are not as in `before`. Its identifier is 0 when there is nothing to tell.
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

}  // namespace ocm::can::slcan
