/// How often a stream is asked for, as a function of a measured value: the ring fast when driving fast.
/// Pure; whole numbers only; O(1).
#pragma once

#include <algorithm>
#include <cstdint>

#include "ocm/base/time.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/reflective/operator.hpp"

namespace ocm::reflective {

/// The period at a value: within the bounds of the adaptation whatever the value is, in whole grains counted
/// from its shortest period, and rounded towards it.
[[nodiscard]] constexpr base::Duration adapted_period(const Adaptation& adaptation,
                                                      std::int64_t value) noexcept {
  if (adaptation.magnitude && value < 0) value = value == INT64_MIN ? INT64_MAX : -value;
  if (value <= adaptation.from) return adaptation.at_from;
  if (value >= adaptation.to) return adaptation.at_to;
  // In parts of 2^20, so that nothing overflows: periods are below 2^43 ns.
  const auto width = static_cast<std::uint64_t>(adaptation.to) - static_cast<std::uint64_t>(adaptation.from);
  const auto above = static_cast<std::uint64_t>(value) - static_cast<std::uint64_t>(adaptation.from);
  const std::uint64_t unit = std::max<std::uint64_t>(1, width >> 20U);
  const auto part = static_cast<std::int64_t>(std::min(above / unit, std::uint64_t{1} << 21U));
  const auto whole = static_cast<std::int64_t>(std::max<std::uint64_t>(1, width / unit));
  const std::int64_t span = (adaptation.at_to - adaptation.at_from).count();
  const std::int64_t grain = std::max<std::int64_t>(1, adaptation.grain.count());
  const base::Duration plain =
      adaptation.at_from + base::Duration{span / whole * part + span % whole * part / whole};
  const base::Duration above_shortest = plain - adaptation.shortest();
  return std::clamp(adaptation.shortest() + base::Duration{above_shortest.count() / grain * grain},
                    adaptation.shortest(), adaptation.longest());
}

}  // namespace ocm::reflective
