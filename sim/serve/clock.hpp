/// Virtual time of a simulator that runs beside the user: `speed` times as fast as the clock, from zero on.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

#include "ocm/base/time.hpp"

namespace ocm::sim {

class SimulatedClock {
 public:
  explicit SimulatedClock(double speed) : speed_(speed), start_(std::chrono::steady_clock::now()) {}
  [[nodiscard]] base::Time now() const {
    const auto elapsed = std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start_);
    return base::Time{base::Duration{static_cast<std::int64_t>(elapsed.count() * speed_)}};
  }
  /// Real time until `when`, at least zero and at most 200 ms, so that a signal is seen soon.
  [[nodiscard]] base::Duration until(base::Time when) const {
    constexpr base::Duration longest{200'000'000};
    const base::Time present = now();
    if (when <= present) return base::Duration{0};
    if (when - present > base::Duration{std::chrono::hours{1}}) return longest;
    const double left = static_cast<double>((when - present).count()) / speed_;
    return std::min(longest, base::Duration{static_cast<std::int64_t>(left) + 1});
  }
  /// For how long of real time a simulation that has come to `reached` is late.
  [[nodiscard]] base::Duration behind(base::Time reached) const {
    const auto late = static_cast<double>((now() - reached).count()) / speed_;
    return base::Duration{static_cast<std::int64_t>(late)};
  }

 private:
  double speed_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace ocm::sim
