/// The mapper's pose controller task: takes orders, drives to set points, home, or around for the compass,
/// and tells movement what the motors are to do. [T2 chapters 8, 9]
///
/// Released by the estimator at its end. What was decided before the motors were switched off is void. No
/// heap; O(1) a job.
#pragma once

#include <cstdint>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/mapper/app/pilot.hpp"
#include "ocm/mapper/app/shared.hpp"
#include "ocm/motion/pose_controller.hpp"

namespace ocm::mapper::app {

template <RobotParts Parts, scheduling::Port Port, scheduling::Lockable Mutex>
class Control {
 public:
  using Shared = app::Shared<Parts, Port, Mutex>;

  /// It must outlive it.
  explicit Control(Shared& shared) noexcept : shared_(shared), pilot_(shared.model->controller) {}

  /// Before the first job, which then is a step as any other.
  void start(base::Time now) noexcept { last_ = now - shared_.model->periods.estimator; }

  /// A job.
  void run() noexcept {
    const float dt_s = step_s(last_, shared_.port->now());
    Moment at;
    base::Result<Order> order;
    {
      [[maybe_unused]] const auto guard = shared_.lock();
      shared_.control_due = false;
      at = shared_.moment_locked();
      order = shared_.orders.take_locked();  // given in this state, and not switched off since
      if (order) ++shared_.orders_taken;
    }
    if (at.epoch != controlled_epoch_) pilot_.stop();
    if (at.resets != controlled_resets_) pilot_.forget();
    controlled_epoch_ = at.epoch;
    controlled_resets_ = at.resets;

    motion::PoseCommand command;
    bool ended = false;
    if (at.state == State::calibrating) {
      command = turn_around(at);
    } else if (may_drive(at.state)) {
      const motion::Pose pose = shared_.pose();
      ended = order && obey(*order, at, pose);
      const auto step = at.state == State::returning ? pilot_.go_home(pose, dt_s) : pilot_.go(pose, dt_s);
      command = step.command;
      if (step.end == PilotEnd::home) (void)shared_.apply(Event::returned);
      if (step.end == PilotEnd::arrived) shared_.count(shared_.counters.arrived);
      ended = ended || step.end == PilotEnd::arrived;
    }
    publish(at, command);
    if (ended) shared_.want_idle();
  }

 private:
  /// True: the robot stops here, in front of something.
  bool obey(const Order& order, const Moment& at, const motion::Pose& pose) noexcept {
    if (!order.halt) {
      shared_.count(shared_.counters.set_points);
      pilot_.begin(order.set_point, pose);
      return false;
    }
    const bool drove = pilot_.driving();
    pilot_.stop();
    if (at.state == State::returning) {
      shared_.count(shared_.counters.returns_blocked);
      pilot_.forget();
    }
    return drove;
  }
  /// Around once, while the estimator looks at the field; then the offset is known, or why not.
  motion::PoseCommand turn_around(const Moment& at) noexcept {
    const base::Time now = shared_.port->now();
    const bool first = calibration_epoch_ != at.epoch;  // each begins with the motors switched off
    if (first) calibration_began_ = now;
    calibration_epoch_ = at.epoch;
    const bool late = now - calibration_began_ > shared_.model->times.calibration_limit;
    bool done = false;
    {
      [[maybe_unused]] const auto claim = shared_.located.claim();
      if (first) shared_.locator.begin_calibration();
      done = late || shared_.locator.turned_around();
    }
    if (!done) return {motion::Movement::rotating, 0.0F, shared_.model->compass.calibration_effort, false};
    bool taken = false;
    {
      [[maybe_unused]] const auto claim = shared_.located.claim();
      // Before the state says that it is over: who asks then hears it.
      shared_.compass = shared_.locator.end_calibration();
      taken = shared_.compass.taken;
    }
    if (!taken) shared_.count(shared_.counters.calibrations_failed);
    const Step step = shared_.apply(Event::calibrated);
    {
      [[maybe_unused]] const auto guard = shared_.lock();
      shared_.compass_wanted = true;
    }
    if (step.idle) shared_.want_idle();
    return {};
  }
  void publish(const Moment& at, const motion::PoseCommand& command) noexcept {
    {
      [[maybe_unused]] const auto guard = shared_.lock();
      shared_.counters.control_rejected = pilot_.rejected();
      shared_.counters.places_forgotten = pilot_.history().forgotten();
      if (at.epoch != shared_.epoch) return;  // switched off meanwhile
      shared_.motion.movement = command.movement;
      shared_.motion.backwards = command.ahead < 0.0F;
      shared_.motion.busy = pilot_.driving() || !shared_.orders.empty_locked();
    }
    shared_.commands.put({command, at.epoch});
  }

  Shared& shared_;
  base::Time last_{};
  base::Time calibration_began_{};
  Pilot pilot_;
  std::uint32_t controlled_epoch_ = 0;
  std::uint32_t controlled_resets_ = 0;
  std::uint32_t calibration_epoch_ = 0;  ///< in which it turns around
};

}  // namespace ocm::mapper::app
