/// Frames that a test types, and a bus on which others send them.
#pragma once

#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/can/text.hpp"

#include "tests/tool/clock/played_bus.hpp"

namespace ocm::test {

/// As candump writes it.
inline can::Frame frame(std::string_view text) {
  const auto parsed = can::parse_frame(text);
  REQUIRE(parsed.ok());
  return *parsed;
}

/// What comes from others, and when, from the start.
using Frames = std::vector<std::pair<Duration, const char*>>;
inline PlayedBus::Conditions bus_with(const Frames& frames) {
  PlayedBus::Conditions conditions;
  for (const auto& [at, text] : frames) conditions.incoming.push_back({World::start + at, frame(text)});
  return conditions;
}

}  // namespace ocm::test
