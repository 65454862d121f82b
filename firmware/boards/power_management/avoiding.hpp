/// How PowerManagement avoids obstacles: counts of the ring go in, a set point for the motors comes out.
/// Pure steps, no heap; 16 bytes.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "ocm/sensing/avoidance.hpp"
#include "ocm/sensing/ring_distance.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/boards/avoidance.hpp"
#include "firmware/boards/samples.hpp"

namespace ocm::firmware::boards::power_management {

/// Not beyond the spec's range.
[[nodiscard]] constexpr bool can_avoid(const amiro::Avoid& avoid) noexcept {
  amiro::Avoid bounded = avoid;
  bounded.set_speed_m_per_s(avoid.speed_m_per_s());
  return bounded == avoid;
}

class Avoiding {
 public:
  /// One step, so many `avoidance_period`s after the last one.
  [[nodiscard]] amiro::Motors step(const amiro::Avoid& wanted, const RingCounts& counts,
                                   const RingCounts& offsets, std::uint32_t periods) noexcept {
    sensing::RingDistances ring{};
    for (std::size_t i = 0; i < ring.size(); ++i) ring[i] = sensing::ring_distance_mm(counts[i], offsets[i]);
    const float dt_s = std::chrono::duration<float>{avoidance_period}.count() * static_cast<float>(periods);
    const sensing::AvoidanceStep step =
        sensing::avoid(state_, ring, static_cast<float>(wanted.speed_m_per_s()), dt_s, avoidance_model);
    state_ = step.state;
    amiro::Motors motors;
    motors.set_x_m_per_s(static_cast<double>(step.command.speed_m_s));
    motors.set_z_rad_per_s(static_cast<double>(step.command.turn_rad_s));
    return motors;
  }

 private:
  sensing::Avoidance state_{};
};

}  // namespace ocm::firmware::boards::power_management
