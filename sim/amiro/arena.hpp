/// What surrounds the robot and does not move: walls, the line on the floor, the earth's magnetic field.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/amiro/line.hpp"
#include "sim/physics/geometry.hpp"

namespace ocm::sim {

struct Arena {
  std::vector<Segment> walls;
  Line line = stadium(0.4, 0.4);
  double floor_reflectance = 0.8;
  double line_reflectance = 0.05;
  /// The earth's field, roughly that of central Europe. [decided]
  double field_horizontal_gauss = 0.2;
  double field_down_gauss = 0.45;
  double north_rad = pi / 2;  ///< direction of magnetic north

  /// What part of the light comes back from a spot of this radius. The edge of the line is blurred over the
  /// spot's width.
  [[nodiscard]] double reflectance(Vector place, double spot_radius_m) const noexcept {
    const double inside = line.width_m / 2 + spot_radius_m - line.distance(place);
    const double dark = std::clamp(inside / (2 * spot_radius_m), 0.0, 1.0);
    return floor_reflectance + (line_reflectance - floor_reflectance) * dark;
  }
};

inline void add_rectangle(std::vector<Segment>& walls, Vector low, Vector high) {
  const Vector corners[] = {low, {high.x, low.y}, high, {low.x, high.y}};
  for (int i = 0; i < 4; ++i) walls.push_back({corners[i], corners[(i + 1) % 4]});
}

/// 2.4 m by 1.6 m with two boxes, none of them nearer than 0.25 m to the line.
[[nodiscard]] inline Arena default_arena() {
  Arena arena;
  add_rectangle(arena.walls, {-1.2, -0.8}, {1.2, 0.8});
  add_rectangle(arena.walls, {-0.1, -0.1}, {0.1, 0.1});
  add_rectangle(arena.walls, {0.95, 0.5}, {1.1, 0.65});
  return arena;
}

/// Where the robot starts: on the line, looking along it, walls more than 0.3 m away.
inline constexpr Pose default_start{0, -0.4, 0};

}  // namespace ocm::sim
