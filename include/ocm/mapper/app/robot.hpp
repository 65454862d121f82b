/// The mapper's application, OCM layer 1: says who it is, obeys set points, tells where it is and what it
/// sees, stops in front of things and when its link dies, and finds its way home. [T2 chapters 4, 6 to 9]
///
///     ocm::mapper::app::Robot robot{parts, port, ocm::mapper::app::avr_robot};
///     robot.start();
///     ...
///     robot.receive(byte);     // interrupt of the UART
///     robot.link_changed();    // interrupt of the dongle's pin
///     robot.expire();          // the port's timer
///     robot.run(level);        // the context of a level, after the port was pended for it
///
/// Five tasks on four levels (docs/mapper.md has their response times):
///
/// | level | task | released |
/// |---|---|---|
/// | urgent | estimator | every 30 ms |
/// | high | movement | every 20 ms |
/// | high | communication | by a line, and every 100 ms to look after things |
/// | medium | pose controller | by the estimator, at its end |
/// | low | tower | every 200 ms |
///
/// communication.hpp and control.hpp (the pose controller) are tasks of their own; the others are short, and
/// here. What all have in common is shared.hpp. Between tasks lie one-place queues, which count what was not
/// taken, and two resources under the system's mutex, which should inherit priorities: the pose, and the
/// UART. All times are measured; a late step is a longer step. Each cause of a refusal or a loss has a
/// counter.
///
/// When the link dies the motors are off before `link_changed` returns, whatever any task was about to do,
/// and nothing that was said or ordered over it lives on. Pose and way home do: they start again when the
/// next operator confirms.
///
/// No heap, no exceptions. RAM and flash are in docs/mapper.md. Parts, port and model must outlive it.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/mapper/app/communication.hpp"
#include "ocm/mapper/app/compass.hpp"
#include "ocm/mapper/app/control.hpp"
#include "ocm/mapper/app/counters.hpp"
#include "ocm/mapper/app/load.hpp"
#include "ocm/mapper/app/locator.hpp"
#include "ocm/mapper/app/models.hpp"
#include "ocm/mapper/app/motors.hpp"
#include "ocm/mapper/app/output.hpp"
#include "ocm/mapper/app/parts.hpp"
#include "ocm/mapper/app/shared.hpp"
#include "ocm/mapper/app/state.hpp"
#include "ocm/mapper/app/tower.hpp"
#include "ocm/motion/pose_controller.hpp"
#include "ocm/motion/pose_estimator.hpp"
#include "ocm/scheduling/dispatcher.hpp"
#include "ocm/scheduling/port.hpp"
#include "ocm/sensing/tower.hpp"

namespace ocm::mapper::app {

template <RobotParts Parts, scheduling::Port Port, scheduling::Lockable Mutex = scheduling::NoMutex>
class Robot {
 public:
  using Level = scheduling::Level;
  using Release = scheduling::Release;
  using Shared = app::Shared<Parts, Port, Mutex>;
  static constexpr std::size_t input_bytes = Shared::input_bytes;

  Robot(Parts& parts, Port& port, const RobotModel& model) noexcept
      : shared_(parts, port, model),
        output_(parts, port, model.can_pack),
        communication_(shared_, output_),
        control_(shared_) {}
  Robot(Parts&, Port&, const RobotModel&&) = delete;  // the model must outlive the robot
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;

  /// Begins to measure and to advertise. Once, before all others.
  void start() noexcept {
    const base::Time now = shared_.port->now();
    const Periods& periods = shared_.model->periods;
    started_ = shared_.entered = shared_.supervision_due = now;
    shared_.last_communication = now - periods.communication_apart;
    last_estimate_ = now - periods.estimator;  // so that the first step is one
    control_.start(now);
    last_movement_ = now - periods.movement;
    idle_at_start_ = port_idle();
    {
      [[maybe_unused]] const auto guard = shared_.lock();
      shared_.parts->drive({});
    }
    shared_.parts->turn_tower(0);
    communication_.show();
    shared_.dispatcher.start(stream(Task::estimator), periods.estimator, Level::urgent, now);
    shared_.dispatcher.start(stream(Task::movement), periods.movement, Level::high, now);
    shared_.dispatcher.start(stream(Task::tower), periods.tower, Level::low, now);
    shared_.attend_communication();
  }

  // Interrupts
  /// A byte from the dongle.
  void receive(std::uint8_t byte) noexcept {
    {
      [[maybe_unused]] const auto guard = shared_.lock();
      if (!app::has_link(shared_.state)) {
        ++shared_.counters.input_unlinked;
        return;
      }
      shared_.input.push(byte);
      if (byte != '}' && !shared_.input.filling()) return;
      shared_.line_waits = true;
    }
    shared_.attend_communication();
  }
  /// The dongle's pin changed. When the link is gone, the motors are off on return.
  void link_changed() noexcept { shared_.look_at_link(); }
  /// The port's timer went off.
  void expire() noexcept { shared_.dispatcher.expire(); }

  // Levels
  /// Does what is due at `level`.
  void run(Level level) noexcept {
    shared_.dispatcher.run(level, [this](const Release& release) {
      perform(release);
      return scheduling::Outcome::done;
    });
  }
  /// What `run` is made of, for a port that calls jobs itself: the job's effects are at its end.
  [[nodiscard]] bool take(Level level, Release& release) noexcept {
    return shared_.dispatcher.take(level, release);
  }
  void finish(const Release& release) noexcept {
    perform(release);
    shared_.dispatcher.done(release.stream);
  }

  // Looking on
  [[nodiscard]] State state() const noexcept { return shared_.state_now(); }
  [[nodiscard]] motion::Pose pose() noexcept { return shared_.pose(); }
  [[nodiscard]] Locator locator() noexcept {
    [[maybe_unused]] const auto claim = shared_.located.claim();
    return shared_.locator;
  }
  /// How the last calibration of the compass ended, or what is stored.
  [[nodiscard]] CompassReport compass() noexcept { return shared_.compass_now(); }
  /// On the way to a set point.
  [[nodiscard]] bool busy() const noexcept {
    [[maybe_unused]] const auto guard = shared_.lock();
    return shared_.motion.busy;
  }
  [[nodiscard]] Counters counters() noexcept;
  [[nodiscard]] scheduling::Overload overload(Task task) const noexcept {
    return shared_.dispatcher.overload(stream(task));
  }
  /// Since `start`, in which nothing of the robot ran: as the port has it, or else what its jobs left.
  [[nodiscard]] base::Duration idle() noexcept {
    if constexpr (port_measures_idle) return port_idle() - idle_at_start_;
    [[maybe_unused]] const auto guard = shared_.lock();
    return shared_.port->now() - started_ - load_.busy();
  }
  /// Since `start`.
  [[nodiscard]] base::Duration uptime() const noexcept { return shared_.port->now() - started_; }
  /// What it cost to share the pose.
  [[nodiscard]] scheduling::Contention contention() noexcept { return shared_.located.contention(); }

 private:
  static constexpr bool port_measures_idle = requires(Port & port) {
    { port.idle() } -> std::convertible_to<base::Duration>;
  };

  [[nodiscard]] base::Duration port_idle() noexcept {
    if constexpr (port_measures_idle) return shared_.port->idle();
    return {};
  }
  // --- jobs ----------------------------------------------------------------------------------------------

  void perform(const Release& release) noexcept {
    Load::Begun begun;
    {
      [[maybe_unused]] const auto guard = shared_.lock();
      begun = load_.begin(shared_.port->now());
    }
    switch (static_cast<Task>(release.stream)) {
      case Task::estimator:
        estimate_pose();
        break;
      case Task::movement:
        move_wheels();
        break;
      case Task::communication:
        communication_.run();
        break;
      case Task::pose_controller:
        control_.run();
        break;
      case Task::tower:
        look_around();
        break;
    }
    [[maybe_unused]] const auto guard = shared_.lock();
    load_.end(begun, shared_.port->now());
  }

  // --- estimator (urgent) --------------------------------------------------------------------------------

  void estimate_pose() noexcept {
    const Moment at = shared_.moment();
    const Activity activity{at.motion.movement, !may_drive(at.state), at.state == State::calibrating};
    const float dt_s = step_s(last_estimate_, shared_.port->now());
    const Readings readings{shared_.parts->ticks(), shared_.parts->gyro(), shared_.parts->field()};
    bool ready = false;
    bool failed = false;
    bool corrected = false;
    {
      [[maybe_unused]] const auto claim = shared_.located.claim();
      shared_.locator.step(readings, activity, dt_s);
      ready = shared_.locator.ready();
      failed = shared_.locator.failed();
      corrected = shared_.locator.corrected_at_rest();
    }
    {
      [[maybe_unused]] const auto guard = shared_.lock();
      if (ready && !shared_.ready) (void)shared_.apply_locked(Event::parts_answered);
      if (failed) (void)shared_.apply_locked(Event::parts_failed);
      shared_.ready = ready;
      shared_.compass_at_rest = corrected;
      shared_.counters.control_skipped += shared_.control_due ? 1U : 0U;
      shared_.control_due = true;
    }
    shared_.dispatcher.once(stream(Task::pose_controller), Level::medium, shared_.port->now());
  }

  // --- movement (high) -----------------------------------------------------------------------------------

  void move_wheels() noexcept {
    const base::Time now = shared_.port->now();
    const float dt_s = step_s(last_movement_, now);
    if (const auto command = shared_.commands.take()) {
      command_ = *command;
      commanded_ = now;
    } else if (now - commanded_ > shared_.model->times.command_lives &&
               command_.pose.movement != motion::Movement::standing) {
      command_.pose = {};
      shared_.count(shared_.counters.motors_starved);
    }
    const MotorStep step =
        app::move(motors_, command_.pose, shared_.parts->ticks(), dt_s, shared_.model->motors);
    motors_ = step.state;
    // Between this look and the motors nothing can happen: the interrupt of a lost link comes before or
    // after.
    [[maybe_unused]] const auto guard = shared_.lock();
    const bool stale = command_.epoch != shared_.epoch;
    if (stale && command_.pose.movement != motion::Movement::standing) {
      ++shared_.counters.commands_stale;
      command_ = {};
    }
    shared_.parts->drive(stale ? motion::Efforts{} : step.efforts);
  }

  // --- tower (low) ---------------------------------------------------------------------------------------

  void look_around() noexcept {
    const Moment at = shared_.moment();
    if (may_drive(at.state)) {
      const Distances seen = distances();
      if (at.state == State::confirmed) tell(at, seen);
      if (in_the_way(at.motion.movement, at.motion.backwards, sweep_.servo_deg, seen,
                     shared_.model->minimum_distance_cm)) {
        [[maybe_unused]] const auto guard = shared_.lock();
        ++shared_.counters.collisions;
        // A set point that came while the tower looked is newer than what it saw, also one that is obeyed
        // already.
        if (at.epoch == shared_.epoch && at.orders == shared_.orders_taken && shared_.orders.empty_locked())
          shared_.orders.put_locked({.halt = true, .set_point = {}});
      }
    }
    const bool parked = !may_drive(at.state) || at.state == State::calibrating;
    const sensing::Sweep before = sweep_;
    sweep_ =
        sensing::next(sweep_, sensing::tower_mode(!parked, at.state == State::paused, at.motion.movement),
                      shared_.model->sweep);
    if (sweep_ != before) shared_.parts->turn_tower(sweep_.servo_deg);
  }
  [[nodiscard]] Distances distances() noexcept {
    Distances seen{};
    for (std::size_t sensor = 0; sensor < seen.size(); ++sensor) {
      const base::Result<float> volts = shared_.parts->infrared(sensor);
      if (!volts) shared_.count(shared_.counters.infrared);
      seen[sensor] = distance_cm(volts, shared_.model->infrared);
    }
    return seen;
  }
  void tell(const Moment& at, const Distances& seen) noexcept {
    const auto wanted = [this, &at, alive = shared_.alive(at)] { return alive() && state() == at.state; };
    const auto update = app::update(pose(), sweep_.servo_deg, seen);
    if (!update)
      shared_.count(shared_.counters.out_of_range);
    else if (output_.say(*update, wanted))
      shared_.count(shared_.counters.updates);
  }

  Shared shared_;
  Output<Parts, Port, Mutex> output_;  ///< brings its own lock
  Load load_;                          ///< behind the port's lock
  base::Time started_{};
  base::Duration idle_at_start_{};
  // Of one task each
  base::Time last_estimate_{};  // estimator
  base::Time last_movement_{};  // movement
  base::Time commanded_{};
  Command command_{};
  Motors motors_{};
  Communication<Parts, Port, Mutex> communication_;
  Control<Parts, Port, Mutex> control_;
  sensing::Sweep sweep_{};  // tower
};

template <RobotParts Parts, scheduling::Port Port, scheduling::Lockable Mutex>
Counters Robot<Parts, Port, Mutex>::counters() noexcept {
  Counters result;
  {
    [[maybe_unused]] const auto guard = shared_.lock();
    result = shared_.counters;
    result.input_full = shared_.input.lost();
    result.input_dropped = shared_.input.dropped();
  }
  result.orders_lost = shared_.orders.lost();
  result.commands_lost = shared_.commands.lost();
  const OutputCounters output = output_.counters();
  result.unsent = output.unsent;
  result.out_of_range += output.out_of_range;
  result.output_full = output.full;
  const Locator known = locator();
  result.gyro = known.gyro_failed();
  result.compass = known.compass_failed();
  result.estimator = known.estimate().rejected;
  result.ticks_rejected = known.estimate().wheels.rejected;
  for (std::size_t task = 0; task < task_count; ++task) {
    const scheduling::Overload one = shared_.dispatcher.overload(task);
    result.overload.missed += one.missed;
    result.overload.late += one.late;
    result.overload.overrun += one.overrun;
  }
  return result;
}

}  // namespace ocm::mapper::app
