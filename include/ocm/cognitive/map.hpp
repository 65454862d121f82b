/// What is where: an occupancy grid in log odds, drawn by what robots say of their tower. Each update is four
/// beams; each beam says "free" of the cells that it passes and "occupied" of the one where it ends.
/// [Moravec, Elfes: High resolution maps from wide angle sonar, ICRA 1985; Thrun, Burgard, Fox: Probabilistic
/// Robotics, 9.2]
///
/// The sensor is the GP2Y0A21YK as an update prints it: 10 to 80 cm are useful; 0 is "nothing seen", which is
/// also said of something under 5 cm, so it frees a bounded stretch only, and weighs little; under 10 cm it
/// is near, but how near is not certain. Cells under a robot are free, and what is seen where another robot
/// stands is no wall.
///
/// Poses that are no place are refused and counted; the grid is bounded. O(cells of four beams) an update.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "ocm/cognitive/grid.hpp"
#include "ocm/mapper/link/sentence.hpp"
#include "ocm/motion/pose.hpp"
#include "ocm/sensing/tower.hpp"

namespace ocm::cognitive {

/// What a robot told of itself at the handshake, in the frame of its axle, of which its pose speaks.
struct Shape {
  float width_m = 0.15F;
  float length_m = 0.20F;
  float centre_m = 0.0F;  ///< middle of the body, ahead of the axle
  sensing::Tower tower{};

  /// Of the circle around the middle of the axle that has all of the body in it: the robot turns about there.
  [[nodiscard]] float radius_m() const noexcept {
    return std::hypot(width_m / 2, length_m / 2 + std::abs(centre_m));
  }
};

/// The fields that were given and can be; of others a robot's usual ones.
[[nodiscard]] inline Shape shape_of(const mapper::link::Handshake& handshake) noexcept {
  Shape shape;
  const auto metres = [](std::int16_t cm) { return static_cast<float>(cm) / 100.0F; };
  constexpr std::int16_t most_cm = 100;  // for a robot with a tower of this reach
  if (handshake.given >= 1 && handshake.width > 0 && handshake.width <= most_cm)
    shape.width_m = metres(handshake.width);
  if (handshake.given >= 2 && handshake.length > 0 && handshake.length <= most_cm)
    shape.length_m = metres(handshake.length);
  const bool axle = handshake.given >= 3 && std::abs(handshake.axle_offset) <= most_cm;
  if (axle) shape.centre_m = -metres(handshake.axle_offset);
  if (axle && handshake.given >= 4 && std::abs(handshake.tower_offset) <= most_cm)
    shape.tower.ahead_of_axle_m =
        metres(static_cast<std::int16_t>(handshake.tower_offset - handshake.axle_offset));
  if (handshake.given >= 8) {
    const std::array headings{handshake.sensor1, handshake.sensor2, handshake.sensor3, handshake.sensor4};
    for (std::size_t i = 0; i < headings.size(); ++i)
      shape.tower.sensor_heading_deg[i] = static_cast<float>(headings[i] % 360);
  }
  if (handshake.given >= 11 && handshake.sensor_out >= 0 && handshake.sensor_out <= most_cm)
    shape.tower.sensor_out_m.fill(metres(handshake.sensor_out));
  return shape;
}

/// A robot somewhere.
struct Body {
  motion::Pose pose{};
  Shape shape{};
};

/// Where a robot is in the world whose frame began at `origin`.
[[nodiscard]] inline motion::Pose placed(const motion::Pose& origin, const motion::Pose& pose) noexcept {
  const motion::Point p = motion::to_world(origin, place(pose));
  return {p.x_m, p.y_m, motion::wrap(origin.heading_rad + pose.heading_rad)};
}
[[nodiscard]] inline motion::Pose pose_of(const mapper::link::Update& update) noexcept {
  return {static_cast<float>(update.x) / 100.0F, static_cast<float>(update.y) / 100.0F,
          motion::wrap(motion::radians(static_cast<float>(update.heading)))};
}

/// How much a beam says, in log odds. [decided; the sensor's figures: GP2Y0A21YK data sheet]
struct BeamModel {
  float hit = 0.9F;            ///< of the cell where something was seen, up to `sharp_m`
  float hit_far = 0.45F;       ///< the same at the end of the range, where a centimetre is a few millivolts
  float hit_near = 0.3F;       ///< under 10 cm: something is there, more or less
  float pass = -0.2F;          ///< of a cell that the beam passed
  float pass_nothing = -0.1F;  ///< the same, when nothing was seen
  float sharp_m = 0.40F;
  float clear_m = 0.60F;           ///< as far as "nothing seen" frees
  float unsure_m = 0.06F;          ///< before what was seen nothing is said for so long
  float half_width_rad = 0.0175F;  ///< the beam is a wedge: what it passes is freed along its borders, too
};

struct MapOptions {
  float resolution_m = 0.04F;
  std::size_t most_cells = std::size_t{1} << 22;  ///< 16 MiB
  BeamModel beam{};
  float most = 4.0F;  ///< log odds stay within these, so that the world may change
  float least = -3.0F;
  float occupied_from = 0.7F;
  float free_below = -0.3F;
};

/// What was said to the map, and what it did not take. They wrap.
struct MapCounters {
  std::uint32_t updates = 0;        ///< taken
  std::uint32_t hits = 0;           ///< beams that ended at something
  std::uint32_t nothing = 0;        ///< beams that saw nothing
  std::uint32_t near = 0;           ///< beams that ended under 10 cm
  std::uint32_t on_robots = 0;      ///< beams that ended at another robot
  std::uint32_t refused_poses = 0;  ///< not finite, or farther than 1 km
  std::uint32_t outside = 0;        ///< cells for which there was no room
  friend constexpr bool operator==(const MapCounters&, const MapCounters&) = default;
};

enum class CellState : std::uint8_t { unknown, free, occupied };

class Map {
 public:
  explicit Map(const MapOptions& options = {})
      : options_(options), raster_(options.resolution_m), odds_(0.0F, options.most_cells) {}

  /// An update of the robot at `robot.pose`; `others` stand around. False, and nothing changes but a counter,
  /// when the pose is no place.
  bool take(const Body& robot, const mapper::link::Update& update, std::span<const Body> others = {}) {
    if (!motion::is_finite(robot.pose) || !Raster::has(place(robot.pose))) {
      ++counters_.refused_poses;
      return false;
    }
    ++counters_.updates;
    stand(robot);
    const std::array distances{update.s1, update.s2, update.s3, update.s4};
    for (std::size_t i = 0; i < distances.size(); ++i)
      beam(robot, update.servo, static_cast<sensing::TowerSensor>(i), distances[i], others);
    return true;
  }

  [[nodiscard]] CellState state(Cell c) const noexcept {
    const float odds = odds_.at(c);
    if (odds >= options_.occupied_from) return CellState::occupied;
    return odds <= options_.free_below ? CellState::free : CellState::unknown;
  }
  [[nodiscard]] float log_odds(Cell c) const noexcept { return odds_.at(c); }
  /// 0 to 1; 0.5 where it is not known.
  [[nodiscard]] float probability(Cell c) const noexcept {
    return 1.0F - 1.0F / (1.0F + std::exp(odds_.at(c)));
  }
  /// All that is not unknown lies within.
  [[nodiscard]] const Box& box() const noexcept { return odds_.box(); }
  [[nodiscard]] const Raster& raster() const noexcept { return raster_; }
  [[nodiscard]] const MapCounters& counters() const noexcept { return counters_; }

 private:
  void add(Cell c, float odds) {
    float* const at = odds_.reach(c);
    if (at == nullptr) return void(++counters_.outside);
    *at = std::clamp(*at + odds, options_.least, options_.most);
  }

  /// Where a robot is, nothing else is: within the circle that its body fills whatever its heading.
  void stand(const Body& robot) {
    const float radius = std::min(robot.shape.width_m, robot.shape.length_m) / 2;
    const motion::Point centre = motion::to_world(robot.pose, {robot.shape.centre_m, 0.0F});
    const Cell low = raster_.cell({centre.x_m - radius, centre.y_m - radius});
    const Cell high = raster_.cell({centre.x_m + radius, centre.y_m + radius});
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        const motion::Point p = raster_.middle({x, y});
        if (std::hypot(p.x_m - centre.x_m, p.y_m - centre.y_m) > radius) continue;
        add({x, y}, options_.beam.pass);
      }
  }

  void beam(const Body& robot, std::int32_t servo_deg, sensing::TowerSensor sensor, std::int16_t cm,
            std::span<const Body> others) {
    const BeamModel& model = options_.beam;
    const bool seen = cm > 0 && static_cast<float>(cm) <= sensing::ir_farthest_cm;
    const float reach_m = seen ? static_cast<float>(cm) / 100.0F : model.clear_m;
    const float out_m = robot.shape.tower.sensor_out_m[static_cast<std::size_t>(sensor)];
    const float bearing = sensing::bearing_rad(robot.shape.tower, servo_deg, sensor);
    const auto along = [&](float metres, float aside_rad) {
      const float way = out_m + metres;
      return motion::to_world(robot.pose,
                              {robot.shape.tower.ahead_of_axle_m + way * std::cos(bearing + aside_rad),
                               way * std::sin(bearing + aside_rad)});
    };
    const bool too_near = seen && static_cast<float>(cm) < sensing::ir_nearest_cm;
    const motion::Point end = along(reach_m, 0.0F);
    const bool at_robot = seen && stands_at(end, others);
    ++(!seen      ? counters_.nothing
       : at_robot ? counters_.on_robots
       : too_near ? counters_.near
                  : counters_.hits);
    const Cell hit = raster_.cell(end);
    const float clear_m = seen ? reach_m - model.unsure_m : model.clear_m;
    // Of something too near, or of nothing at all, the way there is said with less weight.
    if (!too_near && clear_m > 0.0F)
      pass(along(0.0F, 0.0F), clear_m, along, seen ? model.pass : model.pass_nothing);
    if (!seen || at_robot) return;
    if (Raster::has(end)) add(hit, too_near ? model.hit_near : hit_at(reach_m));
  }
  /// A cell is passed once a beam, whichever border of the wedge touches it: the middle first.
  template <class Along>
  void pass(motion::Point from, float clear_m, Along along, float odds) {
    passed_.clear();
    for (const float aside : {0.0F, options_.beam.half_width_rad, -options_.beam.half_width_rad}) {
      const motion::Point to = along(clear_m, aside);
      if (!Raster::has(from) || !Raster::has(to)) return void(++counters_.outside);
      for_each_cell(raster_, from, to, [&](Cell c) {
        if (std::find(passed_.begin(), passed_.end(), c) == passed_.end()) passed_.push_back(c);
        return true;
      });
    }
    for (const Cell c : passed_) add(c, odds);
  }
  [[nodiscard]] float hit_at(float metres) const noexcept {
    const BeamModel& model = options_.beam;
    const float farthest = sensing::ir_farthest_cm / 100.0F;
    if (metres <= model.sharp_m) return model.hit;
    const float part = (metres - model.sharp_m) / (farthest - model.sharp_m);
    return model.hit + (model.hit_far - model.hit) * part;
  }
  /// Within the circle around a robot, and as far off as poses and distances may be wrong.
  [[nodiscard]] static bool stands_at(motion::Point p, std::span<const Body> others) noexcept {
    constexpr float unsure_m = 0.05F;
    return std::any_of(others.begin(), others.end(), [p](const Body& other) {
      return std::hypot(p.x_m - other.pose.x_m, p.y_m - other.pose.y_m) <= other.shape.radius_m() + unsure_m;
    });
  }

  MapOptions options_;
  Raster raster_;
  Grid<float> odds_;
  MapCounters counters_{};
  std::vector<Cell> passed_{};  ///< of one beam; kept for its room
};

}  // namespace ocm::cognitive
