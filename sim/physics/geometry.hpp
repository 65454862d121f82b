/// Points, walls and rays in the plane. Metres, radians counter-clockwise.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace ocm::sim {

inline constexpr double pi = std::numbers::pi;
inline constexpr double degree = pi / 180;

struct Vector {
  double x = 0;
  double y = 0;

  friend constexpr Vector operator+(Vector a, Vector b) noexcept { return {a.x + b.x, a.y + b.y}; }
  friend constexpr Vector operator-(Vector a, Vector b) noexcept { return {a.x - b.x, a.y - b.y}; }
  friend constexpr Vector operator*(Vector a, double f) noexcept { return {a.x * f, a.y * f}; }
  friend constexpr bool operator==(const Vector&, const Vector&) = default;
};

[[nodiscard]] constexpr double dot(Vector a, Vector b) noexcept {
  return a.x * b.x + a.y * b.y;
}
[[nodiscard]] constexpr double cross(Vector a, Vector b) noexcept {
  return a.x * b.y - a.y * b.x;
}
[[nodiscard]] inline double length(Vector a) noexcept {
  return std::hypot(a.x, a.y);
}
[[nodiscard]] inline Vector direction(double angle_rad) noexcept {
  return {std::cos(angle_rad), std::sin(angle_rad)};
}

/// A place and the way the robot looks; `heading_rad` is not wrapped.
struct Pose {
  double x_m = 0;
  double y_m = 0;
  double heading_rad = 0;
  friend constexpr bool operator==(const Pose&, const Pose&) = default;

  [[nodiscard]] constexpr Vector position() const noexcept { return {x_m, y_m}; }
  /// A point fixed to the robot (x forwards, y left), in the arena.
  [[nodiscard]] Vector place_of(Vector on_robot) const noexcept {
    const Vector forwards = direction(heading_rad);
    return position() + forwards * on_robot.x + Vector{-forwards.y, forwards.x} * on_robot.y;
  }
};

struct Segment {
  Vector a;
  Vector b;
};

/// The point of the segment that is nearest to `p`.
[[nodiscard]] constexpr Vector nearest_point(const Segment& segment, Vector p) noexcept {
  const Vector along = segment.b - segment.a;
  const double square = dot(along, along);
  if (square == 0) return segment.a;
  return segment.a + along * std::clamp(dot(p - segment.a, along) / square, 0.0, 1.0);
}

/// How far a ray from `origin` goes until it meets the segment; infinity when it does not. `ray` has
/// length 1.
[[nodiscard]] constexpr double distance_along(Vector origin, Vector ray, const Segment& segment) noexcept {
  constexpr double never = std::numeric_limits<double>::infinity();
  const Vector along = segment.b - segment.a;
  const double slant = cross(ray, along);
  if (slant == 0) return never;  // parallel
  const Vector to_start = segment.a - origin;
  const double distance = cross(to_start, along) / slant;
  const double part = cross(to_start, ray) / slant;
  return distance >= 0 && part >= 0 && part <= 1 ? distance : never;
}
static_assert(distance_along({0, 0}, {1, 0}, {{2, -1}, {2, 1}}) == 2);

}  // namespace ocm::sim
