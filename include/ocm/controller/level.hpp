/// Where requests on the bus meet the scheduling: a request's priority is the level that its samples run at,
/// and the samples go to the bus at the priority of the level that they were released at.
#pragma once

#include "ocm/protocol/identifier.hpp"
#include "ocm/scheduling/level.hpp"

namespace ocm::controller {

static_assert(protocol::priority_levels == scheduling::level_count);

[[nodiscard]] constexpr scheduling::Level level_of(protocol::Priority priority) noexcept {
  return static_cast<scheduling::Level>(priority);
}
[[nodiscard]] constexpr protocol::Priority priority_of(scheduling::Level level) noexcept {
  return static_cast<protocol::Priority>(level);
}

static_assert(level_of(protocol::Priority::urgent) == scheduling::Level::urgent);
static_assert(level_of(protocol::Priority::high) == scheduling::Level::high);
static_assert(level_of(protocol::Priority::medium) == scheduling::Level::medium);
static_assert(level_of(protocol::Priority::low) == scheduling::Level::low);

}  // namespace ocm::controller
