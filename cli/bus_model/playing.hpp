/// Of a log that is played: where it is, and how fast.
#pragma once

#include <algorithm>
#include <cstdint>

#include "ocm/base/time.hpp"

namespace ocm::cli::bus_model {

struct Playing {
  base::Duration at{};
  base::Duration length{};
  double speed = 1;
  bool ended = false;

  /// Where it is when the clock has gone on by so much.
  [[nodiscard]] base::Duration after(base::Duration time) const noexcept {
    return at + base::Duration{static_cast<std::int64_t>(static_cast<double>(time.count()) * speed)};
  }
  void faster(double factor) noexcept { speed = std::clamp(speed * factor, 1.0 / 64, 1024.0); }
};

}  // namespace ocm::cli::bus_model
