/// A disc that drives on the plane: where an arc ends, and how it is kept out of what stands there. Pure
/// functions, shared by the simulated robots.
///
/// A step must be shorter than the disc's radius, or it could jump over a wall. Cost: `arc` two sines and two
/// cosines, `push_out` one root for each obstacle that it looks at.
#pragma once

#include <cmath>
#include <vector>

#include "sim/physics/geometry.hpp"

namespace ocm::sim {

/// The end of an arc of this length and angle.
[[nodiscard]] inline Pose arc(const Pose& from, double length_m, double angle_rad) noexcept {
  const double end = from.heading_rad + angle_rad;
  if (std::abs(angle_rad) < 1e-9)
    return {from.x_m + length_m * std::cos(end), from.y_m + length_m * std::sin(end), end};
  const double radius = length_m / angle_rad;
  return {from.x_m + radius * (std::sin(end) - std::sin(from.heading_rad)),
          from.y_m - radius * (std::cos(end) - std::cos(from.heading_rad)), end};
}

/// Less is rounding: a robot comes to rest at a wall.
inline constexpr double contact_m = 1e-9;

/// The way out of something whose nearest point is `from`, for a centre that has to be `apart_m` away;
/// nothing while it is.
struct Push {
  double depth_m = contact_m;
  Vector way{};

  /// The deeper of this and that of another obstacle.
  void consider(Vector centre, Vector from, double apart_m) noexcept {
    const Vector away = centre - from;
    if (dot(away, away) >= apart_m * apart_m) return;  // most of them: no root
    const double distance = length(away);
    const double depth = apart_m - distance;
    if (depth <= depth_m || distance == 0) return;
    depth_m = depth;
    way = away * (depth / distance);
  }
  [[nodiscard]] bool needed() const noexcept { return depth_m > contact_m; }
};

[[nodiscard]] inline Push push_out(const std::vector<Segment>& walls, Vector centre,
                                   double radius_m) noexcept {
  Push push;
  for (const Segment& wall : walls) push.consider(centre, nearest_point(wall, centre), radius_m);
  return push;
}

/// Moves a centre out of what is in its way, along the normal of what it is deepest in: it stops, or slides
/// along. `deepest(centre)` is the push of all obstacles together. Where a few pushes are not enough it is
/// wedged, and stays where it was `before`. Returns whether it touched anything.
template <class Deepest>
bool keep_out(Vector& centre, Vector before, const Deepest& deepest) noexcept {
  for (int i = 0; i < 4; ++i) {  // a corner takes two, a wedge a few
    const Push push = deepest(centre);
    if (!push.needed()) return i > 0;
    centre = centre + push.way;
  }
  centre = before;
  return true;
}

}  // namespace ocm::sim
