/// A bus on which others send frames that a test types; apart from the bus, which programs without Catch
/// play, too.
#pragma once

#include <utility>
#include <vector>

#include "tests/tool/clock/played_bus.hpp"
#include "tests/unit/can/frame_of.hpp"

namespace ocm::test {

/// What comes from others, and when, from the start.
using Frames = std::vector<std::pair<Duration, const char*>>;
inline PlayedBus::Conditions bus_with(const Frames& frames) {
  PlayedBus::Conditions conditions;
  for (const auto& [at, text] : frames) conditions.incoming.push_back({World::start + at, frame(text)});
  return conditions;
}

}  // namespace ocm::test
