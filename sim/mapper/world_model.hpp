/// What a world of mappers consists of: walls, a magnetic field with its anomalies, the floor, the
/// server's radio, and where robots start. Plain values, made by hand or read from a file
/// (sim/worlds/reader.hpp). Metres, x to the right, y up, angles counter-clockwise.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "sim/mapper/robot_model.hpp"
#include "sim/physics/geometry.hpp"

namespace ocm::sim::mapper {

/// Steel in the floor, a table's leg: what adds to the earth's field, most in the middle and nothing beyond
/// the radius. [T2 §16.3]
struct Anomaly {
  Vector place{};
  double radius_m = 0;
  Vector field_gauss{};  ///< in the middle

  /// Smooth: (1 - (d/radius)^2)^2, with no step and no kink at the edge.
  [[nodiscard]] constexpr Vector field_at(Vector where) const noexcept {
    const Vector off = where - place;
    const double part = dot(off, off) / (radius_m * radius_m);
    return part < 1 ? field_gauss * ((1 - part) * (1 - part)) : Vector{};
  }
};

/// The server's dongle. What lies between is up to the radio's model.
struct Central {
  Vector place{};
  double range_m = 8;          ///< beyond, links die [decided]
  double loss_at_range = 0.5;  ///< of packets there, 0..1; none up to half the range [decided]
};

struct Start {
  std::string name;
  RobotKind kind = RobotKind::avr;
  Pose pose{};  ///< of the middle of its axle

  /// Middle of the disc that it fills.
  [[nodiscard]] Vector centre() const noexcept {
    return pose.place_of({model_of(kind).body.centre_ahead_m, 0});
  }
  [[nodiscard]] double radius_m() const noexcept { return model_of(kind).body.radius_m; }
};

struct WorldModel {
  std::string name;
  std::vector<Segment> walls;
  std::vector<Anomaly> anomalies;
  double friction = 0.5;      ///< of the floor; slip goes with its reciprocal [decided]
  double field_gauss = 0.14;  ///< horizontal part of the earth's field: Trondheim's, roughly [decided]
  double north_rad = pi / 2;  ///< direction of magnetic north
  Central central{};
  std::vector<Start> starts;

  /// Horizontal field, gauss. O(anomalies).
  [[nodiscard]] Vector field_at(Vector where) const noexcept {
    Vector field = direction(north_rad) * field_gauss;
    for (const Anomaly& anomaly : anomalies) field = field + anomaly.field_at(where);
    return field;
  }
};

/// How much room there is between a start and the nearest wall or the nearest of `others`; negative: it is
/// inside one of them. Infinite where there is nothing.
[[nodiscard]] inline double room_m(const Start& start, const std::vector<Segment>& walls,
                                   const std::vector<Start>& others) noexcept {
  double room = std::numeric_limits<double>::infinity();
  for (const Segment& wall : walls)
    room = std::min(room, length(start.centre() - nearest_point(wall, start.centre())) - start.radius_m());
  for (const Start& other : others)
    if (&other != &start)
      room = std::min(room, length(start.centre() - other.centre()) - start.radius_m() - other.radius_m());
  return room;
}

/// Starts for `count` robots: those of the world, and for more robots copies of the last one, put beside it
/// on a grid in growing squares, looking the same way, called robot_2, robot_3, ... by their place in the
/// list. Nothing where the world has no start, or no room within 10 m. A grid does not know which side of a
/// wall is inside: walls that are crossed on the straight way from the last start count as the end of the
/// room.
[[nodiscard]] inline std::optional<std::vector<Start>> starts_for(const WorldModel& world,
                                                                  std::size_t count) {
  std::vector<Start> starts = world.starts;
  if (starts.size() >= count) {
    starts.resize(count);
    return starts;
  }
  if (starts.empty()) return std::nullopt;
  const Start pattern = starts.back();
  const double pitch = 2.5 * pattern.radius_m();
  const auto reachable = [&](Vector place) {
    const Vector way = place - pattern.pose.position();
    const double far = length(way);
    return std::none_of(world.walls.begin(), world.walls.end(), [&](const Segment& wall) {
      return distance_along(pattern.pose.position(), way * (1 / far), wall) <= far;
    });
  };
  const int rings = static_cast<int>(10 / pitch);
  for (int ring = 1; ring <= rings; ++ring) {
    for (int row = -ring; row <= ring; ++row) {
      for (int column = -ring; column <= ring; ++column) {
        if (std::max(std::abs(row), std::abs(column)) != ring) continue;
        if (starts.size() == count) return starts;
        Start next = pattern;
        next.name = "robot_" + std::to_string(starts.size() + 1);
        while (std::any_of(starts.begin(), starts.end(), [&](const Start& s) { return s.name == next.name; }))
          next.name += '_';
        next.pose.x_m += column * pitch;
        next.pose.y_m += row * pitch;
        if (room_m(next, world.walls, starts) < 0.25 * pattern.radius_m()) continue;
        if (reachable(next.pose.position())) starts.push_back(std::move(next));
      }
    }
  }
  if (starts.size() == count) return starts;
  return std::nullopt;
}

}  // namespace ocm::sim::mapper
