/// Acceptance filter: `(id & mask) == (filter.id & mask)`, as SocketCAN and bxCAN have it.
#pragma once

#include <cstdint>

#include "ocm/can/frame.hpp"

namespace ocm::can {

struct Filter {
  std::uint32_t id = 0;
  std::uint32_t mask = 0;  ///< 0 accepts everything

  /// Base data frames only: the robot's protocol has no others.
  [[nodiscard]] constexpr bool accepts(const Frame& frame) const noexcept {
    return accepts(frame.id, frame.format);
  }
  [[nodiscard]] constexpr bool accepts(std::uint32_t frame_id, Format format) const noexcept {
    return format == Format::base && (frame_id & mask) == (id & mask);
  }
  friend constexpr bool operator==(const Filter&, const Filter&) = default;
};

}  // namespace ocm::can
