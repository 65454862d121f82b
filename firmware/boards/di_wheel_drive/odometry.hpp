/// Where the wheels say that the robot is: dead reckoning from encoder ticks. It cannot know of a wheel that
/// slips.
///
/// The mid-point rule over one period: the error is of third order in the turn of one period. No heap; about
/// ten double operations, one sine and one cosine an update.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "ocm/base/time.hpp"

#include "firmware/boards/di_wheel_drive/geometry.hpp"
#include "firmware/boards/samples.hpp"

namespace ocm::firmware::boards::di_wheel_drive {

/// How often the ticks are read. [AMiRo-OS 1.0, Odometry]
inline constexpr base::Duration odometry_period = std::chrono::milliseconds{50};

class Odometry {
 public:
  struct State {
    double x_m = 0;
    double y_m = 0;
    double heading_rad = 0;  ///< [0, 2 pi), counter-clockwise, 0 at the start
    double forward_m_per_s = 0;
    double turn_rad_per_s = 0;
  };

  /// The encoders' totals, so many `odometry_period`s (1 or more) after the last ones: more than one when the
  /// board was busy with something more urgent. The first totals only set the origin.
  void update(WheelTicks ticks, std::uint32_t periods = 1) noexcept {
    if (started_) move(metres(ticks.left, last_.left), metres(ticks.right, last_.right), periods);
    last_ = ticks;
    started_ = true;
  }
  /// The ticks since the last update are lost: the robot may be anywhere, so the pose stays and the next
  /// totals set a new origin.
  void interrupt() noexcept {
    started_ = false;
    state_.forward_m_per_s = state_.turn_rad_per_s = 0;
  }

  [[nodiscard]] const State& state() const noexcept { return state_; }
  /// The last totals came, so the state is as good as the wheels' grip.
  [[nodiscard]] bool valid() const noexcept { return started_; }

 private:
  [[nodiscard]] static double metres(std::int32_t now, std::int32_t before) noexcept {
    const auto difference = static_cast<std::uint32_t>(now) - static_cast<std::uint32_t>(before);
    return static_cast<std::int32_t>(difference) * metres_per_tick;  // right across the wrap, too
  }

  void move(double left_m, double right_m, std::uint32_t periods) noexcept {
    const double period_s = std::chrono::duration<double>(odometry_period).count() * periods;
    const double forward = (left_m + right_m) / 2;
    const double turn = (right_m - left_m) / wheel_base_m;
    const double middle = state_.heading_rad + turn / 2;
    state_.x_m += forward * std::cos(middle);
    state_.y_m += forward * std::sin(middle);
    constexpr double full_turn = 2 * std::numbers::pi;
    state_.heading_rad = std::fmod(state_.heading_rad + turn, full_turn);
    if (state_.heading_rad < 0) state_.heading_rad += full_turn;
    state_.forward_m_per_s = forward / period_s;
    state_.turn_rad_per_s = turn / period_s;
  }

  State state_{};
  WheelTicks last_{};
  bool started_ = false;
};

}  // namespace ocm::firmware::boards::di_wheel_drive
