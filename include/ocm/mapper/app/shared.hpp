/// What the tasks of a mapper have in common: parts, port and model, the state and what leads from it, the
/// queues between tasks, the pose, and counters. Public to the tasks of the robot (robot.hpp,
/// communication.hpp, control.hpp), and to no other.
///
/// `_locked`: the caller has the port's lock. When the motors are switched off, whatever was ordered before
/// is void: orders and commands carry the `epoch` in which they were decided. No heap. O(1).
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include "ocm/base/time.hpp"
#include "ocm/mapper/app/compass.hpp"
#include "ocm/mapper/app/counters.hpp"
#include "ocm/mapper/app/input.hpp"
#include "ocm/mapper/app/locator.hpp"
#include "ocm/mapper/app/models.hpp"
#include "ocm/mapper/app/parts.hpp"
#include "ocm/mapper/app/state.hpp"
#include "ocm/motion/pose_controller.hpp"
#include "ocm/motion/pose_estimator.hpp"
#include "ocm/scheduling/dispatcher.hpp"
#include "ocm/scheduling/mailbox.hpp"
#include "ocm/scheduling/port.hpp"
#include "ocm/scheduling/resource.hpp"

namespace ocm::mapper::app {

/// The streams of a Robot, in the order in which those of one level and one moment run.
enum class Task : std::uint8_t { estimator, movement, communication, pose_controller, tower };
inline constexpr std::size_t task_count = 5;
[[nodiscard]] constexpr std::size_t stream(Task task) noexcept {
  return static_cast<std::size_t>(task);
}

/// What was ordered last. It is void when the motors are switched off.
struct Order {
  bool halt = false;  ///< something is in the way
  motion::SetPoint set_point{};
};
/// What the motors are to do, and since which switch-off that was decided: one of before is void.
struct Command {
  motion::PoseCommand pose{};
  std::uint32_t epoch = 0;
};
/// What the robot is doing.
struct Motion {
  motion::Movement movement = motion::Movement::standing;
  bool backwards = false;
  bool busy = false;
};
/// What a job goes by: all of one moment.
struct Moment {
  State state{};
  Motion motion{};
  std::uint32_t epoch = 0;
  std::uint32_t resets = 0;
  std::uint32_t links = 0;
  std::uint32_t orders = 0;  ///< that the pose controller has taken
};

/// In seconds.
[[nodiscard]] constexpr float seconds(base::Duration time) noexcept {
  return static_cast<float>(time.count()) * 1e-9F;
}
/// Since `last`, which becomes `now`.
[[nodiscard]] constexpr float step_s(base::Time& last, base::Time now) noexcept {
  const float dt_s = seconds(now - last);
  last = now;
  return dt_s;
}

template <RobotParts Parts, scheduling::Port Port, scheduling::Lockable Mutex>
struct Shared {
  static constexpr std::size_t input_bytes = 128;  ///< some seven packets

  Shared(Parts& parts_, Port& port_, const RobotModel& model_) noexcept
      : parts(&parts_),
        port(&port_),
        model(&model_),
        dispatcher(port_),
        orders(port_),
        commands(port_),
        located(port_),
        locator(model_),
        compass{.verdict = model_.compass.calibrated ? link::Calibration::good : link::Calibration::none,
                .fit = {.offset = model_.compass.offset}} {}
  Shared(const Shared&) = delete;
  Shared& operator=(const Shared&) = delete;

  [[nodiscard]] auto lock() const noexcept { return port->lock(); }
  [[nodiscard]] Moment moment() const noexcept {
    [[maybe_unused]] const auto guard = lock();
    return moment_locked();
  }
  [[nodiscard]] Moment moment_locked() const noexcept {
    return {state, motion, epoch, resets, links, orders_taken};
  }
  [[nodiscard]] State state_now() const noexcept {
    [[maybe_unused]] const auto guard = lock();
    return state;
  }
  [[nodiscard]] motion::Pose pose() noexcept {
    [[maybe_unused]] const auto claim = located.claim();
    return locator.estimate().pose;
  }
  [[nodiscard]] CompassReport compass_now() noexcept {
    [[maybe_unused]] const auto claim = located.claim();
    return compass;
  }
  void count(std::uint32_t& counter) noexcept {
    [[maybe_unused]] const auto guard = lock();
    ++counter;
  }

  // The state, and what leads from it.
  Step apply(Event event) noexcept {
    [[maybe_unused]] const auto guard = lock();
    return apply_locked(event);
  }
  Step apply_locked(Event event) noexcept {
    const Step step = app::step(state, event);
    if (step.state != state) entered = port->now();
    state = step.state;
    counters.refused += step.refused ? 1U : 0U;
    if (step.motors_off || step.reset) halt_locked();
    if (step.reset) ++resets;
    if (step.drop) drop_link_locked();
    return step;
  }
  void look_at_link() noexcept {
    [[maybe_unused]] const auto guard = lock();
    const State before = state;
    if (!parts->linked()) {
      (void)apply_locked(Event::link_down);
    } else if (ready) {
      (void)apply_locked(Event::link_up);
      if (state != before) ++counters.links;
    }
  }

  // What communication is to do.
  /// Has communication released when there is something to do, and no more often than it may.
  void attend_communication() noexcept {
    dispatcher.once(stream(Task::communication), scheduling::Level::high, [this] {
      const base::Time soonest = last_communication + model->periods.communication_apart;
      const bool wanted = line_waits || idle_wanted || compass_wanted;
      const base::Time due = wanted ? port->now() : supervision_due;
      return due < soonest ? soonest : due;
    });
  }
  /// The next job of communication says so.
  void want_idle() noexcept {
    {
      [[maybe_unused]] const auto guard = lock();
      idle_wanted = !motion.busy;
    }
    attend_communication();
  }
  /// Whether that is to be done. An idle that was wanted is taken back by a set point that was heard
  /// meanwhile.
  [[nodiscard]] bool take(bool& wanted) noexcept {
    [[maybe_unused]] const auto guard = lock();
    return std::exchange(wanted, false);
  }
  /// The link that a job began with is still there.
  [[nodiscard]] auto alive(const Moment& at) const noexcept {
    return [this, begun = at.links] {
      [[maybe_unused]] const auto guard = lock();
      return begun == links && app::has_link(state) && parts->linked();
    };
  }

  Parts* parts;
  Port* port;
  const RobotModel* model;
  scheduling::Dispatcher<task_count, Port> dispatcher;

  // Behind the port's lock
  Input<input_bytes> input;
  Counters counters{};
  State state = State::advertising;
  Motion motion{};
  std::uint32_t epoch = 0;         ///< how often the motors were switched off
  std::uint32_t resets = 0;        ///< how many operators confirmed
  std::uint32_t links = 0;         ///< how many links died
  std::uint32_t orders_taken = 0;  ///< by the pose controller
  base::Time entered{};            ///< into this state
  base::Time lost_at{};
  base::Time last_communication{};
  base::Time supervision_due{};
  bool may_return = false;
  bool line_waits = false;
  bool idle_wanted = false;
  bool compass_wanted = false;  ///< a calibration has ended: to be kept, and said
  bool control_due = false;
  bool compass_at_rest = false;
  bool ready = false;  ///< gyro and compass are measured

  // Queues of one place
  scheduling::Mailbox<Order, Port> orders;      ///< communication, tower -> pose controller
  scheduling::Mailbox<Command, Port> commands;  ///< pose controller -> movement

  scheduling::Resource<Mutex, Port> located;  ///< for the next two
  Locator locator;
  CompassReport compass;

 private:
  /// Motors off, and whatever was ordered is void.
  void halt_locked() noexcept {
    ++epoch;
    orders.clear_locked();
    commands.clear_locked();
    motion = {};
    parts->drive({});
  }
  void drop_link_locked() noexcept {
    ++links;
    ++counters.links_lost;
    input.drop();
    line_waits = idle_wanted = false;
    lost_at = port->now();
    may_return = true;
  }
};

}  // namespace ocm::mapper::app
