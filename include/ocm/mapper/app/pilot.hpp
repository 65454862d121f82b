/// Takes a mapper to its set point, and home: the pose controller of `motion` with the way that it came.
///
/// A set point is driven from where the robot is. On the way home the places that it left are driven to, the
/// last one first, always forwards, where its sensors look: so a set point of 1 m backwards is undone by
/// turning round. One control step each time; 368 bytes on a 32-bit board, most of it the way home; no heap,
/// no clock.
#pragma once

#include <cstddef>
#include <cstdint>

#include "ocm/mapper/app/history.hpp"
#include "ocm/mapper/app/models.hpp"
#include "ocm/motion/pose_controller.hpp"

namespace ocm::mapper::app {

/// How a step ended.
enum class PilotEnd : std::uint8_t {
  none,     ///< on the way, or nowhere to go
  arrived,  ///< at the set point: to be reported, once
  home,     ///< there is no place left to go back to
};

class Pilot {
 public:
  static constexpr std::size_t places = 32;

  struct Step {
    motion::PoseCommand command{};
    PilotEnd end = PilotEnd::none;
  };

  constexpr explicit Pilot(const motion::PoseControllerModel& model) noexcept : model_(&model) {}

  /// To a place relative to this one, whatever was going on.
  void begin(motion::SetPoint set_point, const motion::Pose& pose) noexcept {
    history_.leave({pose.x_m, pose.y_m});
    controller_ = motion::started(controller_, set_point, pose);
  }
  /// Stays here.
  constexpr void stop() noexcept { controller_ = motion::stopped(controller_); }
  /// The next operator knows nothing of the way that it came.
  constexpr void forget() noexcept { history_.clear(); }

  [[nodiscard]] Step go(const motion::Pose& pose, float dt_s) noexcept {
    const motion::PoseCommand command = control(pose, dt_s);
    return {command, command.arrived ? PilotEnd::arrived : PilotEnd::none};
  }
  [[nodiscard]] Step go_home(const motion::Pose& pose, float dt_s) noexcept {
    if (!driving()) {
      const auto place = history_.last();
      if (!place) return {{}, PilotEnd::home};
      controller_ = motion::started(controller_, towards(pose, *place), pose);
      if (!driving()) history_.drop_last();  // the robot knows no more where it is: give the place up
    }
    const motion::PoseCommand command = control(pose, dt_s);
    if (command.arrived) history_.drop_last();
    return {command, PilotEnd::none};
  }

  [[nodiscard]] constexpr bool driving() const noexcept {
    return controller_.phase != motion::PoseController::Phase::idle;
  }
  /// Steps without a finite pose or without time.
  [[nodiscard]] constexpr std::uint32_t rejected() const noexcept { return controller_.rejected; }
  [[nodiscard]] constexpr const History<places>& history() const noexcept { return history_; }

 private:
  motion::PoseCommand control(const motion::Pose& pose, float dt_s) noexcept {
    const motion::PoseControllerStep step = motion::control(controller_, pose, dt_s, *model_);
    controller_ = step.state;
    return step.command;
  }

  const motion::PoseControllerModel* model_;
  motion::PoseController controller_{};
  History<places> history_{};
};

}  // namespace ocm::mapper::app
