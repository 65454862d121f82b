#include "sim/serve/seen.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "ocm/sensing/ir_sensor.hpp"
#include "ocm/sensing/tower.hpp"

namespace ocm::sim {
namespace {

constexpr double ring_range_m = 0.2;  ///< [VCNL4020 data sheet]
constexpr double line_step_m = 0.05;  ///< its arcs, as straight pieces no longer than that [decided]

Beam beam(Vector from, Vector ray, double distance_m, double range_m) {
  const bool meets = distance_m <= range_m;
  return {from, from + ray * (meets ? distance_m : range_m), meets};
}

std::vector<Segment> straight_pieces(const Line& line) {
  std::vector<Segment> pieces;
  for (const LinePiece& piece : line.pieces) {
    const int count =
        piece.curvature_per_m == 0 ? 1 : static_cast<int>(std::ceil(piece.length_m / line_step_m));
    for (int i = 0; i < count; ++i)
      pieces.push_back({piece.at(piece.length_m * i / count).position(),
                        piece.at(piece.length_m * (i + 1) / count).position()});
  }
  return pieces;
}

}  // namespace

SeenWorld seen(const World& world, std::string_view name) {
  const auto& options = world.options();
  SeenWorld out{std::string{name}, world.time(), options.arena.walls, straight_pieces(options.arena.line)};
  SeenRobot robot{std::string{name}, world.pose(),    world.pose().position(), options.drive.robot_radius_m,
                  world.wheels(),    world.touching()};
  for (std::size_t i = 0; i < options.ring.offset_counts.size(); ++i) {
    const double angle = options.ring.angle(i);
    const Vector from = world.pose().place_of(direction(angle) * options.ring.radius_m);
    const Vector ray = direction(world.pose().heading_rad + angle);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Segment& wall : options.arena.walls)
      nearest = std::min(nearest, distance_along(from, ray, wall));
    robot.beams.push_back(beam(from, ray, nearest, ring_range_m));
  }
  for (std::size_t i = 0; i < World::lights; ++i) robot.lights.push_back(world.light(i));
  robot.charge =
      static_cast<double>(world.battery().energy_uj()) / static_cast<double>(options.power.capacity_uj);
  out.robots.push_back(std::move(robot));
  return out;
}

SeenWorld seen(const mapper::World& world) {
  SeenWorld out{world.model().name, world.time(), world.model().walls};
  for (std::size_t i = 0; i < world.size(); ++i) {
    const mapper::Robot& body = world.robot(i);
    SeenRobot robot{body.name(),
                    body.pose(),
                    body.disc().centre,
                    body.disc().radius_m,
                    {body.left_m_per_s(), body.right_m_per_s()},
                    body.touching()};
    for (std::size_t sensor = 0; sensor < sensing::tower_sensors; ++sensor) {
      const mapper::Look look = body.look(sensor);
      robot.beams.push_back(beam(look.from, look.ray, look.distance_m, sensing::ir_farthest_cm / 100.0));
    }
    const auto lights = body.lights();
    robot.lights = {{0, static_cast<std::uint8_t>(lights.green ? 255 : 0), 0},
                    {static_cast<std::uint8_t>(lights.yellow ? 255 : 0),
                     static_cast<std::uint8_t>(lights.yellow ? 255 : 0), 0}};
    out.robots.push_back(std::move(robot));
  }
  return out;
}

}  // namespace ocm::sim
