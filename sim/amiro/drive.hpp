/// The robot as a body: two wheels with inertia, a disc between walls. Pure steps of 1 ms.
///
/// A wheel follows its set point with a first-order lag (motor and speed controller together), within the
/// greatest speed and acceleration. The disc follows the wheels on an exact arc. Where that would bring it
/// into a wall it is moved out again along the wall's normal: it stops, or slides along, and the wheels slip.
/// One step goes 1 mm at the most, so no wall is jumped over.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "firmware/boards/di_wheel_drive/geometry.hpp"
#include "firmware/boards/samples.hpp"
#include "sim/physics/body.hpp"
#include "sim/physics/geometry.hpp"
#include "sim/physics/step.hpp"

namespace ocm::sim {

using firmware::boards::WheelSpeeds;
using firmware::boards::WheelTicks;

struct DriveModel {
  double robot_radius_m = 0.05;               ///< [thesis, chapter 2: diameter 100 mm]
  double time_constant_s = 0.05;              ///< of a wheel's speed [decided]
  double greatest_acceleration_m_per_s2 = 4;  ///< of a wheel: what the tyres hold [decided]
  double greatest_speed_m_per_s = firmware::boards::di_wheel_drive::greatest_wheel_speed_m_per_s;
};

/// What the inertial sensors feel.
struct Motion {
  Pose pose{};
  double turn_rad_per_s = 0;
  Vector velocity_m_per_s{};       ///< in the arena
  Vector acceleration_m_per_s2{};  ///< on the robot: x forwards, y left
  friend constexpr bool operator==(const Motion&, const Motion&) = default;
};

class Drive {
 public:
  Drive(const DriveModel& model, const Pose& start) noexcept
      : model_(model), gain_(1 - std::exp(-step_s / model.time_constant_s)) {
    motion_.pose = start;
  }

  /// Wheel speeds to reach; beyond the model's limits they are cut.
  void set(WheelSpeeds speeds) noexcept {
    const double limit = model_.greatest_speed_m_per_s;
    target_ = {std::clamp(speeds.left, -limit, limit), std::clamp(speeds.right, -limit, limit)};
  }

  /// One step. Without power the wheels run down whatever the set point.
  void step(const std::vector<Segment>& walls, bool powered) noexcept {
    wheels_.left = follow(wheels_.left, powered ? target_.left : 0);
    wheels_.right = follow(wheels_.right, powered ? target_.right : 0);
    travel_.left += wheels_.left * step_s;
    travel_.right += wheels_.right * step_s;

    const Pose before = motion_.pose;
    Pose& pose = motion_.pose;
    const double turn = (wheels_.right - wheels_.left) / firmware::boards::di_wheel_drive::wheel_base_m;
    pose = arc(before, (wheels_.left + wheels_.right) / 2 * step_s, turn * step_s);
    Vector centre = pose.position();
    touching_ = keep_out(centre, before.position(),
                         [&](Vector at) { return push_out(walls, at, model_.robot_radius_m); });
    pose.x_m = centre.x;
    pose.y_m = centre.y;

    const Vector velocity = (pose.position() - before.position()) * (1 / step_s);
    const Vector change = (velocity - motion_.velocity_m_per_s) * (1 / step_s);
    const Vector forwards = direction(pose.heading_rad);
    motion_.acceleration_m_per_s2 = {dot(change, forwards), cross(forwards, change)};
    motion_.velocity_m_per_s = velocity;
    motion_.turn_rad_per_s = turn;
  }

  /// Nothing moves and nothing will until the next set point: steps change nothing.
  [[nodiscard]] bool at_rest() const noexcept {
    return target_ == WheelSpeeds{} && wheels_ == WheelSpeeds{} && motion_ == resting();
  }
  [[nodiscard]] const Motion& motion() const noexcept { return motion_; }
  [[nodiscard]] WheelSpeeds wheels() const noexcept { return wheels_; }
  /// It pushes against a wall.
  [[nodiscard]] bool touching() const noexcept { return touching_; }

  [[nodiscard]] WheelTicks ticks() const noexcept { return {ticks(travel_.left), ticks(travel_.right)}; }

 private:
  [[nodiscard]] Motion resting() const noexcept {
    Motion rest;
    rest.pose = motion_.pose;
    return rest;
  }

  [[nodiscard]] double follow(double speed, double target) const noexcept {
    const double most = model_.greatest_acceleration_m_per_s2 * step_s;
    const double next = speed + std::clamp((target - speed) * gain_, -most, most);
    return std::abs(target - next) < 1e-6 ? target : next;  // arrived
  }

  [[nodiscard]] static std::int32_t ticks(double travel_m) noexcept {
    const auto total =
        static_cast<std::int64_t>(std::floor(travel_m / firmware::boards::di_wheel_drive::metres_per_tick));
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(total));  // the counter wraps around
  }

  DriveModel model_;
  double gain_;  // how much of the way to its set point a wheel's speed goes in a step
  Motion motion_{};
  WheelSpeeds target_{};
  WheelSpeeds wheels_{};
  WheelSpeeds travel_{};  // m: how far each wheel has turned
  bool touching_ = false;
};

}  // namespace ocm::sim
