/// A frame of either kind, classic or CAN FD, with its data: for hosts, which see both on one bus. Boards of
/// the robot know can::Frame alone. 72 bytes, no heap, constexpr.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "ocm/base/result.hpp"
#include "ocm/can/frame.hpp"

namespace ocm::can {

inline constexpr std::uint8_t max_fd_length = 64;  ///< data bytes of a CAN FD frame [ISO 11898-1:2015]

/// Bits of AnyFrame::flags, with the values of [linux/can.h] (CANFD_BRS, CANFD_ESI, CANFD_FDF).
namespace frame_flag {
inline constexpr std::uint8_t bit_rate_switch = 0x01;
inline constexpr std::uint8_t error_state = 0x02;  ///< the sender is error passive
inline constexpr std::uint8_t fd = 0x04;           ///< a CAN FD frame
inline constexpr std::uint8_t all = bit_rate_switch | error_state | fd;
}  // namespace frame_flag

/// The lengths that a CAN FD frame can have: 0..8, 12, 16, 20, 24, 32, 48, 64 [ISO 11898-1:2015].
[[nodiscard]] constexpr bool is_fd_length(std::size_t length) noexcept {
  return length <= 8 || length == 12 || length == 16 || length == 20 || length == 24 || length == 32 ||
         length == 48 || length == 64;
}

/// The length that a length code stands for; codes over 15 as 15. [ISO 11898-1:2015]
[[nodiscard]] constexpr std::uint8_t fd_length(unsigned dlc) noexcept {
  constexpr std::uint8_t lengths[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};
  return lengths[dlc < 16 ? dlc : 15];
}

/// The smallest length code whose length holds `length` bytes.
[[nodiscard]] constexpr std::uint8_t fd_dlc(std::size_t length) noexcept {
  std::uint8_t dlc = 0;
  while (dlc < 15 && fd_length(dlc) < length) ++dlc;
  return dlc;
}

/// Of a CAN FD frame that reports no error state.
[[nodiscard]] constexpr std::uint8_t fd_flags(bool bit_rate_switch) noexcept {
  return bit_rate_switch ? frame_flag::fd | frame_flag::bit_rate_switch : frame_flag::fd;
}

struct AnyFrame {
  std::uint32_t id = 0;  ///< as in Frame
  Format format = Format::base;
  std::uint8_t length = 0;  ///< data bytes, 0..8, FD 0..64; of a remote frame the length asked for
  std::uint8_t flags = 0;   ///< of namespace frame_flag; 0 for a classic frame
  std::array<std::uint8_t, max_fd_length> data{};  ///< those beyond `length` are zero

  constexpr AnyFrame() noexcept = default;
  /// A classic frame is one of either kind.
  constexpr AnyFrame(const Frame& frame) noexcept  // NOLINT: implicit on purpose
      : id(frame.id), format(frame.format), length(frame.dlc) {
    std::copy(frame.data.begin(), frame.data.end(), data.begin());
  }

  [[nodiscard]] constexpr bool is_fd() const noexcept { return (flags & frame_flag::fd) != 0; }
  [[nodiscard]] constexpr std::span<const std::uint8_t> bytes() const noexcept {
    return {data.data(), is_remote(format) ? std::size_t{0} : length};
  }
  /// To look at; valid as long as the frame.
  [[nodiscard]] constexpr FrameView view() const noexcept { return {id, format, is_fd(), bytes()}; }
  /// Nothing for a CAN FD frame.
  [[nodiscard]] constexpr std::optional<Frame> classic() const noexcept {
    if (is_fd()) return std::nullopt;
    Frame frame;
    frame.id = id;
    frame.dlc = length;
    frame.format = format;
    std::copy_n(data.begin(), frame.data.size(), frame.data.begin());
    return frame;
  }
  friend constexpr bool operator==(const AnyFrame&, const AnyFrame&) = default;
};

/// Whether the frame can exist. CAN FD has data frames alone, of some lengths alone, and a classic frame has
/// no flags: bad_identifier, bad_length, bad_syntax of a flag that there is not. [ISO 11898-1:2015]
[[nodiscard]] constexpr base::Status validate(const AnyFrame& frame) noexcept {
  if (!frame.is_fd()) {
    if (frame.flags != 0) return base::Error::bad_syntax;
    return validate(Frame{.id = frame.id, .dlc = frame.length, .format = frame.format});
  }
  if (frame.format != Format::base && frame.format != Format::extended) return base::Error::bad_identifier;
  if (frame.id > (is_extended(frame.format) ? max_extended_id : max_base_id))
    return base::Error::bad_identifier;
  if ((frame.flags & ~frame_flag::all) != 0) return base::Error::bad_syntax;
  if (!is_fd_length(frame.length)) return base::Error::bad_length;
  return {};
}

/// As of a classic frame: where that has RTR, a CAN FD frame has a dominant bit. [ISO 11898-1:2015]
[[nodiscard]] constexpr std::uint32_t arbitration_key(const AnyFrame& frame) noexcept {
  return arbitration_key(Frame{.id = frame.id, .format = frame.format});
}

}  // namespace ocm::can
