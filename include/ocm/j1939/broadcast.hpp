/// A message of 9 to 1785 bytes as its source broadcasts it by the transport protocol: an announcement
/// (TP.CM_BAM), then packets of seven bytes (TP.DT), `broadcast_distance` apart. No node answers, and a
/// source has one at a time. [SAE J1939-21, 5.10.2.1 and 5.10.3.5]
///
///     for (std::uint32_t i = 0; i < j1939::broadcast_frames(data.size()); ++i)
///       ... send(j1939::broadcast_frame(message, data, i)) ...
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/base/time.hpp"
#include "ocm/j1939/identifier.hpp"
#include "ocm/j1939/transport.hpp"

namespace ocm::j1939 {

/// From the announcement to the first packet, and from one to the next: 50 to 200 ms.
inline constexpr base::Duration broadcast_distance = std::chrono::milliseconds{50};

/// Of a message of so many bytes, the announcement included.
[[nodiscard]] constexpr std::uint32_t broadcast_frames(std::size_t bytes) noexcept {
  return 1 + packets_of(bytes);
}
/// From an announcement until its source may announce the next message.
[[nodiscard]] constexpr base::Duration broadcast_time(std::size_t bytes) noexcept {
  return broadcast_frames(bytes) * broadcast_distance;
}

/// A classic frame of eight bytes with an identifier of 29 bits.
struct BroadcastFrame {
  std::uint32_t id = 0;
  std::array<std::uint8_t, 8> data{};
};

/// The frame of that number: 0 announces, others are packets. It goes to all, whatever the message's
/// destination is. `data` has least_transported to most_transported bytes, `number` is below
/// broadcast_frames. O(1)
[[nodiscard]] constexpr BroadcastFrame broadcast_frame(const Identifier& message,
                                                       std::span<const std::uint8_t> data,
                                                       std::uint32_t number) noexcept {
  constexpr std::uint8_t lowest_priority = 7;  // of the protocol's own frames [5.10.3 and 5.10.4]
  constexpr std::uint8_t announcement = 32;
  const auto byte = [](std::size_t value) { return static_cast<std::uint8_t>(value); };
  BroadcastFrame frame;
  frame.id = Identifier{lowest_priority, number == 0 ? connection_group : transfer_group, global_address,
                        message.source}
                 .encode();
  if (number == 0) {
    frame.data = {announcement, byte(data.size()), byte(data.size() >> 8), byte(packets_of(data.size())),
                  0xFF,         byte(message.pgn), byte(message.pgn >> 8), byte(message.pgn >> 16)};
    return frame;
  }
  frame.data.fill(0xFF);  // behind the message's end
  frame.data[0] = byte(number);
  const auto rest = data.subspan((number - 1) * bytes_a_packet);
  std::copy_n(rest.begin(), std::min(rest.size(), bytes_a_packet), frame.data.begin() + 1);
  return frame;
}

}  // namespace ocm::j1939
