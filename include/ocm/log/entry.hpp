/// What a log holds of a frame: more than a board ever sees. CAN FD, 29 bits and errors pass through,
/// whatever the robot at hand uses. Plain data of 88 bytes.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "ocm/base/time.hpp"
#include "ocm/can/any_frame.hpp"
#include "ocm/can/frame.hpp"

namespace ocm::log {

using can::fd_dlc;
using can::fd_length;
using can::is_fd_length;
using can::max_fd_length;

/// Who put the frame on the bus, as seen from where it was recorded.
enum class Direction : std::uint8_t { unknown, received, sent };

/// Bits of Entry::flags: bit_rate_switch, error_state, fd.
namespace flag = can::frame_flag;

struct Entry {
  base::Time time{};     ///< since 1970 (UTC) where the format knows it, since the log's beginning otherwise
  std::uint32_t id = 0;  ///< as in can::Frame
  std::uint16_t interface = 0;  ///< which of the log's Interfaces
  can::Format format = can::Format::base;
  std::uint8_t length = 0;  ///< data bytes, 0..8, FD 0..64; of a remote frame the length asked for
  std::uint8_t flags = 0;   ///< of namespace flag
  /// 9..15 where a classic frame of 8 bytes had this in its length code, 0 otherwise ("len8_dlc" of Linux),
  /// and of an error frame.
  std::uint8_t raw_dlc = 0;
  Direction direction = Direction::unknown;
  /// Those beyond `length` are not looked at, but the first eight of them are zero.
  std::array<std::uint8_t, max_fd_length> data;

  Entry() noexcept { std::fill_n(data.begin(), 8, std::uint8_t{0}); }  // not all 64: logs are long
  Entry(base::Time when, const can::Frame& frame, std::uint16_t from = 0) noexcept
      : time(when), id(frame.id), interface(from), format(frame.format), length(frame.dlc) {
    std::copy(frame.data.begin(), frame.data.end(), data.begin());
  }
  Entry(base::Time when, const can::AnyFrame& frame, std::uint16_t from = 0) noexcept
      : time(when),
        id(frame.id),
        interface(from),
        format(frame.format),
        length(frame.length),
        flags(frame.flags),
        data(frame.data) {}

  [[nodiscard]] bool is_fd() const noexcept { return (flags & flag::fd) != 0; }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const noexcept {
    return {data.data(), can::is_remote(format) ? std::size_t{0} : length};
  }
  /// To look at; valid as long as the entry.
  [[nodiscard]] can::FrameView view() const noexcept { return {id, format, is_fd(), bytes()}; }
  /// As a board knows frames; nothing for a CAN FD frame.
  [[nodiscard]] std::optional<can::Frame> classic() const noexcept {
    if (is_fd()) return std::nullopt;
    can::Frame frame;
    frame.id = id;
    frame.dlc = length;
    frame.format = format;
    std::copy_n(data.begin(), frame.data.size(), frame.data.begin());
    return frame;
  }
  /// As a bus takes it.
  [[nodiscard]] can::AnyFrame frame() const noexcept {
    can::AnyFrame out;
    out.id = id;
    out.format = format;
    out.length = length;
    out.flags = flags & flag::all;
    const auto from = bytes();
    std::copy(from.begin(), from.end(), out.data.begin());
    return out;
  }
  friend bool operator==(const Entry& a, const Entry& b) noexcept {
    const auto x = a.bytes(), y = b.bytes();
    return a.time == b.time && a.id == b.id && a.interface == b.interface && a.format == b.format &&
           a.length == b.length && a.flags == b.flags && a.raw_dlc == b.raw_dlc &&
           a.direction == b.direction && std::equal(x.begin(), x.end(), y.begin(), y.end());
  }
};

}  // namespace ocm::log
