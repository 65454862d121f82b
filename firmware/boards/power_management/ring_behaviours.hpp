/// How PowerManagement avoids obstacles, and goes home to a wall: counts of the ring go in, a set point for
/// the motors comes out. Pure steps, no heap; 32 bytes.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "ocm/motion/pose.hpp"
#include "ocm/sensing/avoidance.hpp"
#include "ocm/sensing/homing.hpp"
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

/// Within the spec's ranges, and not nearer to the wall than the ring can tell from touching it; or all
/// zeros, its end.
[[nodiscard]] constexpr bool can_go_home(const amiro::Home& home) noexcept {
  amiro::Home bounded = home;
  bounded.set_speed_m_per_s(home.speed_m_per_s());
  bounded.set_distance_m(home.distance_m());
  amiro::Home nearest;
  nearest.set_distance_m(0.03);
  return home == amiro::Home{} || (bounded == home && home.speed != 0 && home.distance >= nearest.distance);
}

/// What the ring's board does by itself: nothing, or one of both.
struct Wanted {
  amiro::Avoid avoid{};
  amiro::Home home{};
  [[nodiscard]] constexpr bool any() const noexcept {
    return avoid != amiro::Avoid{} || home != amiro::Home{};
  }
};

class RingBehaviours {
 public:
  /// One step, so many `avoidance_period`s after the last one.
  [[nodiscard]] amiro::Motors step(const Wanted& wanted, const RingCounts& counts, const RingCounts& offsets,
                                   std::uint32_t periods) noexcept {
    sensing::RingDistances ring{};
    for (std::size_t i = 0; i < ring.size(); ++i) ring[i] = sensing::ring_distance_mm(counts[i], offsets[i]);
    const float dt_s = std::chrono::duration<float>{avoidance_period}.count() * static_cast<float>(periods);
    motion::Twist command;
    if (wanted.home != amiro::Home{}) {
      const sensing::HomingStep step =
          sensing::home(homing_, ring, static_cast<float>(wanted.home.distance_m()),
                        static_cast<float>(wanted.home.speed_m_per_s()), dt_s, homing_model);
      homing_ = step.state;
      avoidance_ = {};
      command = step.command;
    } else {
      const sensing::AvoidanceStep step = sensing::avoid(
          avoidance_, ring, static_cast<float>(wanted.avoid.speed_m_per_s()), dt_s, avoidance_model);
      avoidance_ = step.state;
      homing_ = {};
      command = step.command;
    }
    amiro::Motors motors;
    motors.set_x_m_per_s(static_cast<double>(command.speed_m_s));
    motors.set_z_rad_per_s(static_cast<double>(command.turn_rad_s));
    return motors;
  }

 private:
  sensing::Avoidance avoidance_{};
  sensing::Homing homing_{};
};

}  // namespace ocm::firmware::boards::power_management
