/// A room with robots that obey exactly, and see exactly what is there: for tests of maps
/// and explorers. No motor, no noise, no radio; time goes in steps of an update, 200 ms.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "ocm/cognitive/grid.hpp"
#include "ocm/cognitive/map.hpp"
#include "ocm/mapper/link/sentence.hpp"
#include "ocm/sensing/anti_collision.hpp"
#include "ocm/sensing/tower.hpp"

namespace ocm::test {

using cognitive::Wall;

/// Walls of a rectangle.
[[nodiscard]] inline std::vector<Wall> rectangle(float x0, float y0, float x1, float y1) {
  return {{{x0, y0}, {x1, y0}}, {{x1, y0}, {x1, y1}}, {{x1, y1}, {x0, y1}}, {{x0, y1}, {x0, y0}}};
}

/// How far a ray goes until it meets a wall; infinity when it meets none.
[[nodiscard]] inline float ray_m(motion::Point from, float angle, const std::vector<Wall>& walls) {
  float best = std::numeric_limits<float>::infinity();
  const float c = std::cos(angle), s = std::sin(angle);
  for (const Wall& wall : walls) {
    const float x = wall.to.x_m - wall.from.x_m, y = wall.to.y_m - wall.from.y_m;
    const float slant = c * y - s * x;
    if (slant == 0.0F) continue;
    const float ax = wall.from.x_m - from.x_m, ay = wall.from.y_m - from.y_m;
    const float way = (ax * y - ay * x) / slant;
    const float part = (ax * s - ay * c) / slant;
    if (way >= 0.0F && part >= 0.0F && part <= 1.0F) best = std::min(best, way);
  }
  return best;
}

/// Any walls; outside of them nothing.
struct Room {
  std::vector<Wall> walls;

  [[nodiscard]] float distance(motion::Point p) const {
    float best = std::numeric_limits<float>::infinity();
    for (const Wall& wall : walls) best = std::min(best, cognitive::distance_m(wall, p));
    return best;
  }
};

/// A robot that turns 90 degrees and drives 20 cm in a second, and stops in front of what it sees.
class PerfectRobot {
 public:
  explicit PerfectRobot(const motion::Pose& start, const cognitive::Shape& shape = {})
      : start_(start), pose_(start), shape_(shape) {}

  void go(const mapper::link::SetPoint& set_point) {
    turn_ = motion::radians(set_point.angle);
    way_ = static_cast<float>(set_point.distance) / 100.0F;
  }
  /// 200 ms.
  void step(const Room& room, const std::vector<PerfectRobot>& all) {
    constexpr float turn_rad = 0.314F, drive_m = 0.04F;
    movement_ = motion::Movement::standing;
    if (turn_ != 0.0F) {
      const float part = std::clamp(turn_, -turn_rad, turn_rad);
      pose_.heading_rad = motion::wrap(pose_.heading_rad + part);
      turn_ -= part;
      movement_ = motion::Movement::rotating;
    } else if (way_ > 0.0F) {
      const float part = std::min(way_, drive_m);
      const motion::Point next = motion::to_world(pose_, {part, 0.0F});
      const auto at_other = std::any_of(all.begin(), all.end(), [&](const PerfectRobot& other) {
        return &other != this && cognitive::distance_m(cognitive::place(other.pose_), next) <
                                     shape_.radius_m() + other.shape_.radius_m();
      });
      way_ -= part;
      if (at_other || room.distance(next) < shape_.width_m / 2) {
        way_ = 0.0F;  // something is in front of it
        ++bumps_;
      } else {
        pose_.x_m = next.x_m;
        pose_.y_m = next.y_m;
        movement_ = motion::Movement::straight;
      }
    }
    if (sensing::must_stop(sweep_.servo_deg, see(room, all, 0), see(room, all, 3), 12) && turn_ == 0.0F)
      way_ = 0.0F;
    sweep_ = sensing::next(sweep_, sensing::tower_mode(true, false, movement_));
  }
  [[nodiscard]] bool idle() const { return turn_ == 0.0F && way_ == 0.0F; }
  [[nodiscard]] mapper::link::Update update(const Room& room, const std::vector<PerfectRobot>& all) const {
    const motion::Point p = motion::to_robot(start_, cognitive::place(pose_));
    const auto cm = [](float m) { return static_cast<std::int16_t>(std::lround(m * 100.0F)); };
    return {cm(p.x_m),
            cm(p.y_m),
            static_cast<std::int16_t>(
                std::lround(motion::degrees(motion::difference(pose_.heading_rad, start_.heading_rad)))),
            static_cast<std::int16_t>(sweep_.servo_deg),
            see(room, all, 0),
            see(room, all, 1),
            see(room, all, 2),
            see(room, all, 3)};
  }
  [[nodiscard]] const motion::Pose& pose() const { return pose_; }
  [[nodiscard]] const motion::Pose& start() const { return start_; }
  [[nodiscard]] const cognitive::Shape& shape() const { return shape_; }
  [[nodiscard]] unsigned bumps() const { return bumps_; }

 private:
  [[nodiscard]] std::int16_t see(const Room& room, const std::vector<PerfectRobot>& all,
                                 std::size_t sensor) const {
    const float bearing =
        sensing::bearing_rad(shape_.tower, sweep_.servo_deg, static_cast<sensing::TowerSensor>(sensor));
    const motion::Point from = motion::to_world(pose_, {shape_.tower.ahead_of_axle_m, 0.0F});
    const float angle = pose_.heading_rad + bearing;
    float way = ray_m(from, angle, room.walls);
    for (const PerfectRobot& other : all) {
      if (&other == this) continue;
      const motion::Point seen = motion::to_robot({from.x_m, from.y_m, angle}, cognitive::place(other.pose_));
      const float radius = other.shape_.width_m / 2;
      if (std::abs(seen.y_m) < radius && seen.x_m > 0.0F)
        way = std::min(way, seen.x_m - std::sqrt(radius * radius - seen.y_m * seen.y_m));
    }
    return way >= 0.05F && way <= 0.80F ? static_cast<std::int16_t>(std::lround(way * 100.0F))
                                        : std::int16_t{0};
  }

  motion::Pose start_;
  motion::Pose pose_;
  cognitive::Shape shape_;
  sensing::Sweep sweep_{};
  motion::Movement movement_ = motion::Movement::standing;
  float turn_ = 0.0F;
  float way_ = 0.0F;
  unsigned bumps_ = 0;
};

/// A map as characters, the top first: `#` occupied, `.` free, blank unknown.
[[nodiscard]] inline std::string drawn(const cognitive::Map& map) {
  std::string text;
  const cognitive::Box& box = map.box();
  for (int y = box.high.y; y >= box.low.y; --y) {
    for (int x = box.low.x; x <= box.high.x; ++x) {
      const auto state = map.state({x, y});
      text += state == cognitive::CellState::occupied ? '#' : state == cognitive::CellState::free ? '.' : ' ';
    }
    text.erase(text.find_last_not_of(' ') + 1);
    text += '\n';
  }
  return text;
}

}  // namespace ocm::test
