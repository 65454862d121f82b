/// The dark line on the floor: straights and arcs, one after the other.
///
/// Host only (the pieces are in a std::vector). `distance` looks at every piece; an arc costs an arc tangent.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sim/physics/body.hpp"
#include "sim/physics/geometry.hpp"

namespace ocm::sim {

/// A piece of constant curvature.
struct LinePiece {
  Pose start{};
  double length_m = 0;
  double curvature_per_m = 0;  ///< left is positive; 0: straight

  [[nodiscard]] Pose at(double way_m) const noexcept { return arc(start, way_m, way_m * curvature_per_m); }
  [[nodiscard]] Pose end() const noexcept { return at(length_m); }

  /// Distance of a place from the middle of the piece. At most one turn around.
  [[nodiscard]] double distance(Vector place) const noexcept {
    if (curvature_per_m == 0) {
      const Segment segment{start.position(), end().position()};
      return length(place - nearest_point(segment, place));
    }
    const double radius = 1 / std::abs(curvature_per_m);
    const double side = curvature_per_m < 0 ? -1 : 1;
    const Vector centre = start.place_of({0, 1 / curvature_per_m});
    const Vector from_centre = place - centre;
    const Vector first = start.position() - centre;
    // How far around, in the direction of the piece: [0, 2 pi)
    double around = side * std::atan2(cross(first, from_centre), dot(first, from_centre));
    if (around < 0) around += 2 * pi;
    if (around * radius <= length_m) return std::abs(length(from_centre) - radius);
    return std::min(length(place - start.position()), length(place - end().position()));
  }
};

struct Line {
  std::vector<LinePiece> pieces;
  double width_m = 0.02;

  /// Distance of a place from the middle of the line; infinite where there is none.
  [[nodiscard]] double distance(Vector place) const noexcept {
    double least = std::numeric_limits<double>::infinity();
    for (const LinePiece& piece : pieces) least = std::min(least, piece.distance(place));
    return least;
  }
  /// Adds a piece where the line ends now.
  void go_on(double length_m, double curvature_per_m) {
    pieces.push_back({pieces.empty() ? Pose{} : pieces.back().end(), length_m, curvature_per_m});
  }
};

/// A closed line around the origin: two straights, parallel to the x axis, and two half circles.
[[nodiscard]] inline Line stadium(double half_straight_m, double radius_m) {
  Line line;
  line.pieces.push_back({{-half_straight_m, -radius_m, 0}, 2 * half_straight_m, 0});
  line.go_on(pi * radius_m, 1 / radius_m);
  line.go_on(2 * half_straight_m, 0);
  line.go_on(pi * radius_m, 1 / radius_m);
  return line;
}

}  // namespace ocm::sim
