#include "cli/shared/filters.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "ocm/base/text.hpp"
#include "ocm/j1939/identifier.hpp"
#include "ocm/j1939/transport.hpp"
#include "ocm/protocol/identifier.hpp"

namespace ocm::cli {
namespace {

/// What tells formats apart; data frames have none of the two, or the first.
constexpr canid_t format_bits = CAN_EFF_FLAG | CAN_RTR_FLAG;

canid_t raw_id(canid_t id, can::Format format) noexcept {
  if (can::is_extended(format)) id |= CAN_EFF_FLAG;
  if (can::is_remote(format)) id |= CAN_RTR_FLAG;
  return id;
}

}  // namespace

bool passes(std::uint32_t number, can::Format format, std::span<const can_filter> filters) noexcept {
  if (filters.empty() || format == can::Format::error) return true;
  const canid_t id = raw_id(number, format);
  return std::any_of(filters.begin(), filters.end(), [id](const can_filter& filter) {
    const bool opposite = (filter.can_id & CAN_INV_FILTER) != 0;
    const canid_t wanted = filter.can_id & ~canid_t{CAN_INV_FILTER};
    return ((id & filter.can_mask) == (wanted & filter.can_mask)) != opposite;
  });
}

transport::Outcome<can_filter> parse_filter(std::string_view text) {
  const transport::Failure refused{fmt::format("--filter {}: not a filter", text),
                                   "write id:mask in hexadecimal, such as 600:700 or 18FF0000:1FFF0000; "
                                   "id~mask for all the others"};
  const auto sign = text.find_first_of(":~");
  if (sign == std::string_view::npos) return refused;
  const auto id = base::parse_unsigned(text.substr(0, sign), 16);
  const auto mask = base::parse_unsigned(text.substr(sign + 1), 16);
  if (!id || !mask || *id > CAN_EFF_MASK || *mask > UINT32_MAX) return refused;
  can_filter filter{static_cast<canid_t>(*id), static_cast<canid_t>(*mask) & ~canid_t{CAN_ERR_FLAG}};
  if (sign == 8) filter.can_id |= CAN_EFF_FLAG;
  if (text[sign] == '~') filter.can_id |= CAN_INV_FILTER;
  return filter;
}

can_filter group_filter(std::uint32_t pgn) noexcept {
  const std::uint32_t id = j1939::Identifier{.pgn = pgn}.encode();
  return {id | CAN_EFF_FLAG, j1939::mask_of(pgn) | format_bits};
}

Filters filters_for(std::span<const protocol::Topic* const> topics, bool commands) {
  using protocol::Direction;
  Filters filters;
  bool has_packets = false;
  const auto of_topic = [&](Direction direction, protocol::TopicId id) {
    constexpr std::uint32_t mask = protocol::topic_mask;
    filters.push_back({protocol::Identifier{direction, {}, id}.encode() & mask, mask | format_bits});
  };
  for (const auto* topic : topics) {
    if (topic->is_message()) {
      const protocol::Address& address = topic->frames[0].address;
      if (address.by == protocol::Address::By::pgn) {
        filters.push_back(group_filter(j1939::pgn_of(address.number)));
        has_packets = has_packets || goes_in_packets(*topic);
      } else {
        filters.push_back({address.number | (address.extended ? CAN_EFF_FLAG : 0U),
                           (address.extended ? CAN_EFF_MASK : CAN_SFF_MASK) | format_bits});
      }
      continue;
    }
    if (topic->kind == protocol::Kind::sensor)
      for (const auto& layout : topic->frames) of_topic(Direction::sensor, layout.id);
    if (commands || topic->kind == protocol::Kind::actuator) of_topic(Direction::command, topic->id);
  }
  if (has_packets)
    for (const std::uint32_t group : {j1939::connection_group, j1939::transfer_group})
      filters.push_back(group_filter(group));
  return filters;
}

std::optional<std::vector<can::Filter>> bus_filters(std::span<const can_filter> filters) {
  std::vector<can::Filter> out;
  for (const can_filter& filter : filters) {
    const bool base_data = (filter.can_id & (format_bits | CAN_INV_FILTER)) == 0 &&
                           (filter.can_mask & format_bits) == format_bits;
    if (!base_data) return std::nullopt;
    out.push_back({filter.can_id & CAN_SFF_MASK, filter.can_mask & CAN_SFF_MASK});
  }
  return out;
}

}  // namespace ocm::cli
