/// Keeps a robot on a dark line on a bright floor, by four sensors that look at the floor: two close together
/// in front, one on either side of them that see the floor beside the line.
///
/// How dark each of the front pair is, in parts of what the brighter side sensor sees, says how far the line
/// is off: while it is under both alike not at all, then the far one brightens first, then the near one. So a
/// floor and its light need no calibration; only the line must be darker than half of the floor. The robot
/// steers along the circle that leads from its axle through the line in front of it (pure pursuit), and slows
/// down for what is far off.
///
/// When neither sees the line any more, the robot turns on the spot towards the side where it was last, and
/// gives up after `search_s`.
///
/// [the law of the circle: Coulter, Implementation of the Pure Pursuit Path Tracking Algorithm, CMU, 1992]
///
/// Pure steps, constant time: some twenty float operations, no library call. constexpr.
#pragma once

#include <cstdint>

#include "ocm/motion/limits.hpp"
#include "ocm/motion/pose.hpp"
#include "ocm/motion/real.hpp"

namespace ocm::motion {

struct LineFollowerModel {
  float ahead_m = 0.0F;        ///< from the axle to the front pair
  float apart_m = 0.0F;        ///< from one of them to the other
  float spot_radius_m = 0.0F;  ///< what a sensor sees of the floor
  float half_line_m = 0.01F;   ///< half the line's width
  float wheelbase_m = 0.0F;
  float acceleration_m_s2 = 0.5F;  ///< ahead
  /// Of the speed, what is left where the line is just being lost; between, in proportion.
  float slowest_part = 0.3F;
  float search_s = 1.0F;  ///< gives up after so long without the line
  float search_turn_rad_s = 2.0F;
  std::uint16_t least_floor = 200;  ///< counts: with less the floor is away, the robot is held up
};

/// Counts, more is brighter; offsets taken off.
struct FloorView {
  std::uint16_t front_left = 0;
  std::uint16_t front_right = 0;
  std::uint16_t side_left = 0;
  std::uint16_t side_right = 0;
};

/// Where the line is, seen from the middle between the front sensors.
struct LineSeen {
  bool seen = false;
  float offset_m = 0.0F;  ///< left is positive
};

struct LineFollower {
  float last_offset_m = 0.0F;  ///< where the line was seen last
  float lost_s = 0.0F;         ///< since it was
  float speed_m_s = 0.0F;
  bool begun = false;
  std::uint32_t rejected = 0;  ///< steps without a finite speed or without time: standing for that step
};

struct LineFollowerStep {
  LineFollower state{};
  Twist command{};
  bool lost = false;  ///< given up; the command is rest
};

/// The greatest offset at which the line is still seen.
[[nodiscard]] constexpr float greatest_offset_m(const LineFollowerModel& model) noexcept {
  return model.half_line_m + model.spot_radius_m + model.apart_m / 2.0F;
}

[[nodiscard]] constexpr LineSeen line_offset(const FloorView& view, const LineFollowerModel& model) noexcept {
  const std::uint16_t floor = view.side_left > view.side_right ? view.side_left : view.side_right;
  if (floor < model.least_floor) return {};
  const auto darkness = [floor](std::uint16_t counts) {
    // A dark line gives back a twentieth or so: nine tenths darker than the floor is on it in full.
    constexpr float in_full = 0.9F;
    const float part = 1.0F - static_cast<float>(counts) / static_cast<float>(floor);
    return clamp(part / in_full, 0.0F, 1.0F);
  };
  const float left = darkness(view.front_left);
  const float right = darkness(view.front_right);
  constexpr float least = 0.15F;  // less is a mark on the floor, or noise
  if (left < least && right < least) return {};
  // Both on it in full: within `flat` of its middle. Each brightens over the width of its spot, the far one
  // first.
  const float flat_m = model.half_line_m - model.spot_radius_m - model.apart_m / 2.0F;
  const float nearer = left > right ? left : right;
  const float farther = left > right ? right : left;
  // A line that is not quite black darkens both alike: what counts is how much brighter the far one is.
  const float brighter = 1.0F - farther / nearer;
  // With less than that, only a part of `flat`: by noise alone it would go from side to side.
  constexpr float noise = 0.1F;
  const float offset_m = (flat_m > 0.0F ? flat_m : 0.0F) * clamp(brighter / noise, 0.0F, 1.0F) +
                         brighter * (2.0F - nearer) * 2.0F * model.spot_radius_m;
  return {true, left > right ? offset_m : -offset_m};
}

/// One step at a speed of at most `speed_m_s` (zero or more), `dt_s` after the last one.
[[nodiscard]] constexpr LineFollowerStep control(LineFollower state, const FloorView& view, float speed_m_s,
                                                 float dt_s, const LineFollowerModel& model) noexcept {
  if (!is_finite(speed_m_s) || speed_m_s < 0.0F || !is_step(dt_s)) {
    ++state.rejected;
    state.speed_m_s = 0.0F;
    return {state, {}, false};
  }
  const LineSeen line = line_offset(view, model);
  if (!line.seen) {
    state.speed_m_s = 0.0F;
    state.lost_s += dt_s;
    // Never seen, the line can be on either side: no search.
    if (!state.begun || state.lost_s > model.search_s) return {state, {}, true};
    const float side = state.last_offset_m < 0.0F ? -1.0F : 1.0F;
    return {state, {0.0F, side * model.search_turn_rad_s}, false};
  }
  state.begun = true;
  state.lost_s = 0.0F;
  state.last_offset_m = line.offset_m;
  const float off = clamp(magnitude(line.offset_m) / greatest_offset_m(model), 0.0F, 1.0F);
  const float wanted_m_s = speed_m_s * (1.0F - (1.0F - model.slowest_part) * off);
  // Slower at once, faster on a ramp.
  const float faster_m_s = limited(state.speed_m_s, wanted_m_s, speed_m_s, model.acceleration_m_s2, dt_s);
  state.speed_m_s = wanted_m_s < state.speed_m_s ? wanted_m_s : faster_m_s;
  const float square_m2 = model.ahead_m * model.ahead_m + line.offset_m * line.offset_m;
  return {state, {state.speed_m_s, state.speed_m_s * 2.0F * line.offset_m / square_m2}, false};
}

}  // namespace ocm::motion
