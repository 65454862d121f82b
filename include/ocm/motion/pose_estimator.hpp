/// The thesis' estimator in one step: wheels and gyro move the pose, the compass corrects its heading, where
/// it may. [T2 listing 7.1; every 30 ms there, here over the time that really passed]
///
/// State in, state out; 30-odd float operations, one sin, one cos. Readings that are not finite, and counts
/// that no wheel can make, are left out and counted one by one: the pose stays finite whatever comes.
#pragma once

#include <cstdint>

#include "ocm/motion/angle.hpp"
#include "ocm/motion/compass_filter.hpp"
#include "ocm/motion/heading.hpp"
#include "ocm/motion/odometry.hpp"
#include "ocm/motion/pose.hpp"
#include "ocm/motion/real.hpp"

namespace ocm::motion {

struct EstimatorModel {
  Drive drive{};
  HeadingModel heading{};
  std::int32_t most_ticks = 0;         ///< of one wheel in one step, see count()
  float compass_variance_rad2 = 0.0F;  ///< the thesis' COMPASS_FACTOR: high
  float compass_spread_rad = motion::compass_spread_rad;
  CompassRule compass_rule = CompassRule::standing_where_trusted;
  float compass_gate = 0.0F;              ///< sigmas; 0: whatever it says, see agrees()
  float compass_undisturbed_rad = 0.05F;  ///< spread of a compass with its offset, away from steel
};

/// The second robot: gyro alone, and the compass corrects all the time. [T2 §14.3]
[[nodiscard]] constexpr EstimatorModel gyro_and_compass(EstimatorModel model) noexcept {
  model.heading.source = HeadingSource::gyro;
  model.compass_rule = CompassRule::always;
  model.compass_gate = 0.0F;
  return model;
}

struct EstimatorReadings {
  std::uint32_t left_ticks = 0;
  std::uint32_t right_ticks = 0;
  float gyro_rad_s = 0.0F;   ///< its bias taken off
  float compass_rad = 0.0F;  ///< one for each step
  Movement movement = Movement::standing;
};

/// Why something was left out.
struct EstimatorCounters {
  std::uint32_t time = 0;     ///< dt not finite or not positive: the wheels alone move the pose
  std::uint32_t gyro = 0;     ///< not finite
  std::uint32_t compass = 0;  ///< not finite, when it was its turn to correct
  friend bool operator==(const EstimatorCounters&, const EstimatorCounters&) = default;
};

struct Estimate {
  Pose pose{};
  float heading_variance_rad2 = 0.0F;
  WheelCounts wheels{};  ///< counts its own rejections
  CompassTrust compass{};
  EstimatorCounters rejected{};
  bool compass_used = false;  ///< in the last step
};

[[nodiscard]] inline Estimate estimate(Estimate state, const EstimatorReadings& readings, float dt_s,
                                       const EstimatorModel& model) noexcept {
  const auto [wheels, advance] =
      count(state.wheels, readings.left_ticks, readings.right_ticks, model.most_ticks, model.drive);
  state.wheels = wheels;
  state.compass_used = false;
  if (!is_step(dt_s)) {
    // What the wheels did is real whatever the clock says; the gyro cannot be integrated.
    ++state.rejected.time;
    state.pose = moved(state.pose, advance);
    return state;
  }

  const Turn turn = blend({readings.gyro_rad_s, advance.turn_rad}, readings.movement, dt_s, model.heading);
  if (turn.wheels_rejected) ++state.wheels.rejected;
  if (turn.gyro_rejected) ++state.rejected.gyro;
  Heading heading =
      predict({state.pose.heading_rad, state.heading_variance_rad2}, turn.angle_rad, dt_s, model.heading);
  state.pose = moved(state.pose, {advance.distance_m, turn.angle_rad});

  state.compass = judge(state.compass, readings.movement, readings.compass_rad, model.compass_spread_rad);
  if (may_correct(state.compass, readings.movement, model.compass_rule) &&
      agrees(heading, readings.compass_rad, model.compass_undisturbed_rad, model.compass_gate)) {
    const auto corrected = correct(heading, readings.compass_rad, model.compass_variance_rad2);
    heading = corrected.heading;
    state.compass_used = !corrected.rejected;
    if (corrected.rejected) ++state.rejected.compass;
  }
  state.pose.heading_rad = heading.angle_rad;
  state.heading_variance_rad2 = heading.variance_rad2;
  return state;
}

}  // namespace ocm::motion
