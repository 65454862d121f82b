/// A wheel with its motor and its encoder: effort in, speed and ticks out. Pure steps of 1 ms, a few
/// operations each.
///
/// The encoder has one channel: it counts edges, and the motor's last command says which way, also while the
/// wheel rolls out or is being reversed. Before the first command it is not known, and nothing is counted.
/// [T2 §6.4.1]
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "ocm/motion/odometry.hpp"

#include "sim/mapper/robot_model.hpp"
#include "sim/physics/step.hpp"

namespace ocm::sim::mapper {

class Wheel {
 public:
  /// `draw`: this motor's standard normal number, which makes it slower than the best.
  Wheel(const MotorModel& motor, double draw) noexcept
      : motor_(motor),
        full_ticks_per_s_(motor.full_ticks_per_s * (1 - std::min(0.5, std::abs(draw) * motor.spread))) {}

  /// [-1, 1]; beyond is cut, and what is no number is off.
  void drive(float effort) noexcept {
    const double wanted = effort >= -1.0F && effort <= 1.0F ? effort
                          : effort > 1.0F                   ? 1.0
                          : effort < -1.0F                  ? -1.0
                                                            : 0.0;
    if (wanted > 0) encoder_.command(motion::DirectedTicks::Direction::forward);
    if (wanted < 0) encoder_.command(motion::DirectedTicks::Direction::backward);
    effort_ = std::abs(wanted) >= motor_.least_effort ? wanted : 0;
  }

  /// One step; how far the wheel turned in it, in ticks, forwards positive.
  double step() noexcept {
    if (at_rest()) return 0;
    const double on = std::abs(effort_);
    const double full = effort_ < 0 ? -full_ticks_per_s_ : full_ticks_per_s_;
    speed_ += (on * (full - speed_) / motor_.start_s - (1 - on) * speed_ / motor_.stop_s) * step_s;
    if (effort_ == 0 && std::abs(speed_) < motor_.standstill * full_ticks_per_s_) speed_ = 0;
    const double turned = speed_ * step_s;
    const double before = std::floor(angle_ticks_);
    angle_ticks_ += turned;
    encoder_.pulses(static_cast<std::uint32_t>(std::abs(std::floor(angle_ticks_) - before)));
    return turned;
  }

  [[nodiscard]] bool at_rest() const noexcept { return effort_ == 0 && speed_ == 0; }
  [[nodiscard]] bool powered() const noexcept { return effort_ != 0; }
  [[nodiscard]] double ticks_per_s() const noexcept { return speed_; }
  [[nodiscard]] double full_ticks_per_s() const noexcept { return full_ticks_per_s_; }
  /// The encoder's running counter; it wraps.
  [[nodiscard]] std::uint32_t ticks() const noexcept { return encoder_.count(); }

 private:
  MotorModel motor_;
  double full_ticks_per_s_;
  double effort_ = 0;
  double speed_ = 0;        // ticks/s
  double angle_ticks_ = 0;  // how far it turned, forwards positive
  motion::DirectedTicks encoder_;
};

}  // namespace ocm::sim::mapper
