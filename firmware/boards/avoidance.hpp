/// What the avoidance of obstacles, and the way home to a wall, are made of on the robot, for the board that
/// does it and for the proofs of bus and reaction time.
#pragma once

#include <chrono>

#include "ocm/base/time.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/sensing/avoidance.hpp"
#include "ocm/sensing/homing.hpp"

namespace ocm::firmware::boards {

/// How often the ring is read and the motors are commanded. [decided: a tenth of the motors' watchdog]
inline constexpr base::Duration avoidance_period = std::chrono::milliseconds{50};
/// Of the set points: before what others publish.
inline constexpr protocol::Priority avoidance_priority = protocol::Priority::high;

inline constexpr sensing::AvoidanceModel avoidance_model{};
inline constexpr sensing::HomingModel homing_model{};
/// What is proved of the reaction for the avoidance holds for the way home.
static_assert(sensing::most_delay_s(homing_model) >= sensing::most_delay_s(avoidance_model));

}  // namespace ocm::firmware::boards
