/// Which frames of a bus are meant, by their identifiers: what the kernel compares, and candump's words for
/// it.
#pragma once

#include <linux/can.h>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "ocm/can/filter.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/j1939/transport.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/transport/bus.hpp"

namespace ocm::cli {

/// As the kernel compares: `(id & mask) == (filter.id & mask)`, with the format's bits in the identifier
/// (CAN_EFF_FLAG, CAN_RTR_FLAG) and CAN_INV_FILTER for the opposite. [linux/can.h]
using Filters = std::vector<can_filter>;

/// Passed by no frame, where a list without filters is passed by all. The kernel takes it, too.
inline constexpr can_filter no_frame{CAN_INV_FILTER, 0};

/// "123:7FF", "18FF1234:1FFFFFFF", and with ~ in place of : for all that do not match, as candump has them.
/// Eight digits are an extended identifier. The failure names the option --filter.
[[nodiscard]] transport::Outcome<can_filter> parse_filter(std::string_view text);

/// The messages of a parameter group of J1939, from any sender, with any priority. [SAE J1939-21]
[[nodiscard]] can_filter group_filter(std::uint32_t pgn) noexcept;

/// Sensor data of the topics at every priority, and messages; with `commands` also requests and set points.
/// With one that goes in packets, all packets.
[[nodiscard]] Filters filters_for(std::span<const protocol::Topic* const> topics, bool commands);

/// Whether the topic is a message of J1939 that may go in packets, by the transport protocol.
[[nodiscard]] inline bool goes_in_packets(const protocol::Topic& topic) noexcept {
  return topic.is_message() && topic.frames[0].any_length();
}
/// Whether the frame belongs to that protocol. Which message it is of, its identifier does not say.
[[nodiscard]] inline bool is_packet(std::uint32_t id, can::Format format) noexcept {
  return format == can::Format::extended && j1939::is_transport(id);
}
[[nodiscard]] inline bool is_packet(const log::Entry& entry) noexcept {
  return !entry.is_fd() && is_packet(entry.id, entry.format);
}

/// Whether a frame passes one of the filters, or there is none. Error frames always do.
[[nodiscard]] bool passes(std::uint32_t id, can::Format format, std::span<const can_filter> filters) noexcept;
[[nodiscard]] inline bool passes(const log::Entry& entry, std::span<const can_filter> filters) noexcept {
  return passes(entry.id, entry.format, filters);
}

/// The same for a transport::Bus, whose filters know frames of 11 bits only; nothing where that is not
/// enough.
[[nodiscard]] std::optional<std::vector<can::Filter>> bus_filters(std::span<const can_filter> filters);

}  // namespace ocm::cli
