/// Which frames a list of topics means to the bus, as acceptance filters.
#pragma once

#include <vector>

#include "ocm/can/filter.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::cli {

/// Sensor data of the topics at every priority; with `commands` also requests and set points. None:
/// everything.
[[nodiscard]] inline std::vector<can::Filter> filters_for(const std::vector<const protocol::Topic*>& topics,
                                                          bool commands) {
  constexpr std::uint32_t mask = protocol::topic_mask;
  std::vector<can::Filter> filters;
  for (const auto* topic : topics) {
    if (topic->kind == protocol::Kind::sensor)
      for (const auto& layout : topic->frames)
        filters.push_back(
            {protocol::Identifier{protocol::Direction::sensor, {}, layout.id}.encode() & mask, mask});
    if (commands || topic->kind == protocol::Kind::actuator)
      filters.push_back(
          {protocol::Identifier{protocol::Direction::command, {}, topic->id}.encode() & mask, mask});
  }
  return filters;
}

}  // namespace ocm::cli
