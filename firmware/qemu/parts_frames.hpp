/// What an emulated board says to its host about its parts, and hears: the frames of the second UART. QEMU
/// has no I2C, no SPI slave and no motor; the host's models of the parts answer instead. One exchange at a
/// time, begun by the board.
///
///     board:  { sequence, kind, unit, a, written, asked, written bytes... }
///     host:   { sequence, status, length, bytes... }
///
/// `sequence` is the board's and comes back: an answer that is older than the board's patience is known by it
/// and skipped. 0: the board waits for no answer. `status` 0: done, `length` bytes follow, `asked` of them;
/// else the value of a base::Error, and no bytes.
///
///     kind       unit     a              written                          asked
///     i2c        bus      7-bit address  what is written after START      bytes after the repeated START
///     spi        device   mode, 0 to 3   clock in Hz (4 bytes, LE), out   as many as out
///     set_duty   0        0              left, right (int16, LE)          0
///     encoders   0        0              -                                4: left, right (uint16, LE)
///     inputs     group    0              -                                1
///     outputs    group    0              1                                0
///     convert    channel  0              -                                2: counts of the converter (LE)
///     set_pulse  channel  0              width, counts (uint16, LE)       0
///
/// For both ends: no heap, constexpr, O(1) a byte. A reader holds 262 bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/base/result.hpp"

namespace ocm::firmware::qemu::link {

enum class Kind : std::uint8_t { i2c = 1, spi, set_duty, encoders, inputs, outputs, convert, set_pulse };

inline constexpr std::size_t request_header = 6;
inline constexpr std::size_t answer_header = 3;
inline constexpr std::size_t max_bytes = 255;

struct Request {
  std::uint8_t sequence = 0;
  Kind kind = Kind::i2c;
  std::uint8_t unit = 0;
  std::uint8_t a = 0;
  std::uint8_t asked = 0;
  std::span<const std::uint8_t> written{};  ///< of a reader: valid until its next byte
};

[[nodiscard]] constexpr std::array<std::uint8_t, request_header> header(const Request& request) noexcept {
  return {request.sequence, static_cast<std::uint8_t>(request.kind),           request.unit,
          request.a,        static_cast<std::uint8_t>(request.written.size()), request.asked};
}

struct Answer {
  std::uint8_t sequence = 0;
  base::Error status = base::Error::none;
  std::span<const std::uint8_t> bytes{};  ///< of a reader: valid until its next byte
};

[[nodiscard]] constexpr std::array<std::uint8_t, answer_header> header(const Answer& answer) noexcept {
  return {answer.sequence, static_cast<std::uint8_t>(answer.status),
          static_cast<std::uint8_t>(answer.bytes.size())};
}

/// Collects a frame whose header has `Header` bytes, of which `length_at` counts the bytes that follow.
template <std::size_t Header, std::size_t LengthAt>
class Reader {
 public:
  /// True: the byte was the last of a frame. The next one begins a new frame.
  constexpr bool feed(std::uint8_t byte) noexcept {
    if (complete_) size_ = 0;
    bytes_[size_++] = byte;
    complete_ = size_ >= Header && size_ == Header + bytes_[LengthAt];
    return complete_;
  }

 protected:
  [[nodiscard]] constexpr std::uint8_t at(std::size_t i) const noexcept { return bytes_[i]; }
  [[nodiscard]] constexpr std::span<const std::uint8_t> rest() const noexcept {
    return {bytes_.data() + Header, bytes_[LengthAt]};
  }

 private:
  std::array<std::uint8_t, Header + max_bytes> bytes_{};
  std::uint16_t size_ = 0;
  bool complete_ = false;
};

/// The host's. `request()` after feed() was true; a kind that is none is to be answered with Error::bad_mode.
class RequestReader : public Reader<request_header, 4> {
 public:
  [[nodiscard]] constexpr Request request() const noexcept {
    return {.sequence = at(0),
            .kind = static_cast<Kind>(at(1)),
            .unit = at(2),
            .a = at(3),
            .asked = at(5),
            .written = rest()};
  }
};

/// The board's. `answer()` after feed() was true.
class AnswerReader : public Reader<answer_header, 2> {
 public:
  [[nodiscard]] constexpr Answer answer() const noexcept {
    return {.sequence = at(0), .status = static_cast<base::Error>(at(1)), .bytes = rest()};
  }
};

}  // namespace ocm::firmware::qemu::link
