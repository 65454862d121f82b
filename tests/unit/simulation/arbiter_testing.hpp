/// What the tests of the arbiter share: frames by their text, a run, and what it delivered as texts.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/can/text.hpp"
#include "ocm/simulation/arbiter.hpp"

#include "unit/can/frame_of.hpp"

namespace ocm::test {

inline std::vector<simulation::Delivery> run(simulation::Arbiter& bus, base::Time until = base::never) {
  std::vector<simulation::Delivery> deliveries;
  bus.advance(until, [&](const simulation::Delivery& delivery) { deliveries.push_back(delivery); });
  return deliveries;
}

using Texts = std::vector<std::string>;

inline Texts texts(const std::vector<simulation::Delivery>& deliveries) {
  Texts result;
  for (const auto& delivery : deliveries) result.emplace_back(can::to_text(delivery.frame).view());
  return result;
}

}  // namespace ocm::test
