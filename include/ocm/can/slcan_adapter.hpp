/// The adapter's end of SLCAN (slcan_codec.hpp): reads a host's commands (`CommandReader`), or also knows
/// what is allowed when (`Adapter`).
///
/// No heap, constexpr; O(1) a character, O(line) at its end. An Adapter takes 84 bytes.
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
#include "ocm/can/frame.hpp"
#include "ocm/can/slcan_codec.hpp"

namespace ocm::can::slcan {

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

/// Makes commands of what comes from a host, a character at a time.
class CommandReader {
 public:
  struct Outcome {
    bool complete = false;  ///< a line has ended; `command` is it, or why it is none
    base::Result<Command> command{};
  };
  constexpr Outcome feed(char c) noexcept {
    if (collect(c)) return {};
    Outcome out{.complete = true, .command = base::Error::bad_syntax};
    if (!line_.spoilt()) {
      out.command = parse_command(line_.line());
      if (!out.command) detail::count(out.command.error, faults_);
    }
    line_.restart();
    return out;
  }
  /// The same for a character that ends no line, without an outcome to copy; false: it ends one, `feed` it.
  constexpr bool collect(char c) noexcept {
    if (c == carriage_return) return false;
    line_.feed(c, faults_);
    return true;
  }
  [[nodiscard]] constexpr const LineFaults& faults() const noexcept { return faults_; }

 private:
  detail::LineCollector<max_frame_line> line_;
  LineFaults faults_{};
};

/// What an adapter says of itself.
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
    if (reader_.collect(c)) return {};
    const auto line = reader_.feed(c);
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
