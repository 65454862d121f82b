/// A classic CAN frame: identifier, format, length and up to 8 bytes of data. 16 bytes, no heap.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/base/result.hpp"

namespace ocm::can {

inline constexpr std::uint32_t max_base_id = 0x7FF;            ///< 11 bits [ISO 11898-1]
inline constexpr std::uint32_t max_extended_id = 0x1FFF'FFFF;  ///< 29 bits [ISO 11898-1]
inline constexpr std::uint8_t max_dlc = 8;

/// What kind of frame it is. `error` exists on the host only: a report of the CAN controller (SocketCAN's
/// CAN_ERR_FLAG), never something on the wire.
enum class Format : std::uint8_t { base, extended, base_remote, extended_remote, error };

[[nodiscard]] constexpr bool is_extended(Format format) noexcept {
  return format == Format::extended || format == Format::extended_remote;
}
[[nodiscard]] constexpr bool is_remote(Format format) noexcept {
  return format == Format::base_remote || format == Format::extended_remote;
}

/// That of data frames with such an identifier.
[[nodiscard]] constexpr Format data_format(Format format) noexcept {
  return format == Format::base_remote       ? Format::base
         : format == Format::extended_remote ? Format::extended
                                             : format;
}

/// Always eight bytes; those beyond the DLC are zero, so that frames compare as values.
using Payload = std::array<std::uint8_t, 8>;

struct Frame {
  std::uint32_t id = 0;  ///< 11 or 29 bits by `format`; the error class for Format::error
  std::uint8_t dlc = 0;  ///< number of data bytes, 0..8 (for remote frames: the length asked for)
  Payload data{};
  Format format = Format::base;

  [[nodiscard]] constexpr std::span<const std::uint8_t> bytes() const noexcept {
    return {data.data(), is_remote(format) ? std::size_t{0} : dlc};
  }
  friend constexpr bool operator==(const Frame&, const Frame&) = default;
};

/// Whether the frame can exist: identifier within its format, DLC at most 8.
[[nodiscard]] constexpr base::Status validate(const Frame& frame) noexcept {
  if (frame.dlc > max_dlc) return base::Error::bad_length;
  const bool wide = is_extended(frame.format) || frame.format == Format::error;
  if (frame.id > (wide ? max_extended_id : max_base_id)) return base::Error::bad_identifier;
  return {};
}

/// Order on the bus: the frame with the lower key wins the arbitration, that is sends the first dominant bit
/// where they differ. The base identifier goes first, then RTR (or SRR) and IDE, then the extension. Equal
/// keys collide. [ISO 11898-1, 6.6]
[[nodiscard]] constexpr std::uint32_t arbitration_key(const Frame& frame) noexcept {
  // 11 bits base identifier | RTR or SRR | IDE | 18 bits extension | RTR of an extended frame
  const std::uint32_t rtr = is_remote(frame.format) ? 1 : 0;
  if (!is_extended(frame.format)) return frame.id << 21 | rtr << 20;
  const std::uint32_t base_id = frame.id >> 18;
  const std::uint32_t extension = frame.id & 0x3'FFFF;
  return base_id << 21 | std::uint32_t{3} << 19 | extension << 1 | rtr;
}

/// A frame of either kind to look at: classic, or CAN FD with up to 64 bytes.
struct FrameView {
  std::uint32_t id = 0;
  Format format = Format::base;
  bool fd = false;
  /// What it carries; none of a remote frame. Behind fewer than eight bytes, or fewer than 64 where there are
  /// more than eight, the memory goes on to that size, so that a field is read in one step.
  std::span<const std::uint8_t> bytes;

  constexpr FrameView() = default;
  constexpr FrameView(std::uint32_t id_, Format format_, bool fd_,
                      std::span<const std::uint8_t> bytes_) noexcept
      : id(id_), format(format_), fd(fd_), bytes(bytes_) {}
  /// The frame must outlive the view.
  constexpr explicit FrameView(const Frame& frame) noexcept
      : id(frame.id), format(frame.format), bytes(frame.bytes()) {}
};

}  // namespace ocm::can
