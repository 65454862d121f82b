/// The VCNL4020 infrared sensors: eight around the robot, four that look at the floor.
///
/// Light that comes back falls with the square of the distance and with the angle. The constants were
/// measured on the AMiRo itself: counts above the offset = 0.9427 / d^2 * |cos(1.2365 * angle)|, d in metres,
/// with a variance of 20.9 counts. [obstacle model in VCNL4020Models.h of github.com/tik0/amiro_senseact,
/// solved for the counts] At 10 mm this gives 9427, at 50 mm 377 and at 200 mm, the greatest range of the
/// data sheet, 24; below 3.8 mm the converter is at its end, 65535.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "firmware/boards/samples.hpp"
#include "sim/amiro/arena.hpp"
#include "sim/amiro/inertial.hpp"
#include "sim/physics/digits.hpp"

namespace ocm::sim {

inline constexpr double counts_at_one_metre = 0.942693757414292;
inline constexpr double angle_factor = 1.236518540376969;
inline constexpr double count_noise = 4.57;
inline constexpr double most_counts = 65535;
/// 250 samples/s. [VCNL4020 data sheet]
inline constexpr base::Duration proximity_period = std::chrono::milliseconds{4};

/// Of ambient light, everywhere: 300 lx, a lit room. [decided; 0.25 lx a count: VCNL4020 data sheet]
inline constexpr std::uint16_t ambient_counts = 1200;

/// Counts above the offset from a white obstacle. `distance_m` may be 0 or infinite.
[[nodiscard]] inline double reflected_counts(double distance_m, double angle_rad) noexcept {
  const double nearest = 0.001;  // far beyond the converter's end already
  const double distance = std::max(distance_m, nearest);
  return counts_at_one_metre / (distance * distance) * std::abs(std::cos(angle_factor * angle_rad));
}

struct RingModel {
  double radius_m = 0.0495;  ///< [amiro_robot, amiro.xacro: base_radius]
  /// Sensor 1 looks back left, then clockwise in steps of 45 degrees. [AMiRo-OS 1.0, Constants.h:
  /// SENSOR_ANGULAR_POS_FIRST]
  double first_rad = 157.5 * degree;
  double step_rad = -45 * degree;
  /// With nothing in sight. [thesis, figure 7.1: one reading of each sensor]
  std::array<double, 8> offset_counts{2289, 2302, 2420, 2350, 2318, 2272, 2382, 2269};
  /// What a sensor sees: rays at 0, 10 ... 70 degrees to either side; beyond, nothing comes back.
  double ray_step_rad = 10 * degree;
  int rays_a_side = 7;

  [[nodiscard]] double angle(std::size_t sensor) const noexcept {
    return first_rad + step_rad * static_cast<double>(sensor);
  }

  [[nodiscard]] firmware::boards::RingCounts read(const std::vector<Segment>& walls,
                                                  const Sample& sample) const noexcept {
    firmware::boards::RingCounts counts{};
    for (std::size_t i = 0; i < counts.size(); ++i)
      counts[i] = digits<std::uint16_t>(offset_counts[i] + seen(walls, sample.motion.pose, angle(i)) +
                                            count_noise * sample.normal(static_cast<std::uint8_t>(i)),
                                        0, most_counts);
    return counts;
  }

 private:
  /// The brightest of the rays.
  [[nodiscard]] double seen(const std::vector<Segment>& walls, const Pose& pose,
                            double angle_rad) const noexcept {
    const Vector origin = pose.place_of(direction(angle_rad) * radius_m);
    double most = 0;
    for (int ray = -rays_a_side; ray <= rays_a_side; ++ray) {
      const double off_axis = ray_step_rad * ray;
      const Vector towards = direction(pose.heading_rad + angle_rad + off_axis);
      double distance = std::numeric_limits<double>::infinity();
      for (const Segment& wall : walls) distance = std::min(distance, distance_along(origin, towards, wall));
      most = std::max(most, reflected_counts(distance, off_axis));
    }
    return most;
  }
};

struct FloorModel {
  /// x forwards, y left: front right, right wheel, left wheel, front left.
  /// [order: AMiRo-OS 1.0, Constants.h: proximitySensorIdx; places: amiro_robot, amiro.xacro]
  std::array<Vector, 4> places{Vector{0.0445, -0.0035}, {0.0285, -0.032}, {0.0285, 0.032}, {0.0445, 0.0035}};
  double height_m = 0.01;        ///< [amiro_robot, amiro.xacro: base_clearance]
  double spot_radius_m = 0.004;  ///< [decided]
  /// What a sensor reads with nothing below it; of the size of the ring's. [decided]
  std::array<std::uint16_t, 4> offset_counts{2310, 2294, 2351, 2278};

  /// Offset removed: as the converter has it at its end, too.
  [[nodiscard]] firmware::boards::FloorCounts read(const Arena& arena, const Sample& sample) const noexcept {
    firmware::boards::FloorCounts counts{};
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const double reflectance = arena.reflectance(sample.motion.pose.place_of(places[i]), spot_radius_m);
      counts[i] = digits<std::uint16_t>(reflectance * reflected_counts(height_m, 0) +
                                            count_noise * sample.normal(static_cast<std::uint8_t>(i)),
                                        0, most_counts - offset_counts[i]);
    }
    return counts;
  }
};

}  // namespace ocm::sim
