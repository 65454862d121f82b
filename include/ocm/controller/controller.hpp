/// One board of the robot, OCM layer 1: it answers requests for its sensors, obeys set points for its
/// actuators, and is silent on everything that is not its own. The board's type comes from the generated
/// header and says which topics those are.
///
///     ocm::controller::Controller<amiro::DiWheelDrive, Can> controller{can};
///     controller.serve<amiro::Gyroscope>([&] { return gyroscope.read(); });
///     controller.accept<amiro::Motors>([&](const amiro::Motors& target) { drive.set(target); });
///     ...
///     controller.receive(frame, now);   // for each frame from the bus
///     controller.poll(now);             // at next_event(), and when a mailbox became free while waiting()
///
/// That is a program of one context. With another port the four priority levels preempt each other:
///
///     ocm::controller::Controller<amiro::DiWheelDrive, Can, Rtos> controller{can, rtos};
///
/// | who may call | what |
/// |---|---|
/// | set-up, before the others | serve, accept, every, report |
/// | one context, of any priority | receive |
/// | the port's timer context | expire |
/// | the context of a level | run(level), after the port was pended for it |
/// | any context, interrupts too | writable, bus_lost, refuse, counters, overload, active, waiting |
///
/// They may preempt each other anywhere. `read` functions run in the context of the level that was asked for,
/// tasks in theirs, `apply` functions in that of `receive` or the urgent one (never of one topic in both).
/// `bus.send` is called with the port's lock held, so it needs no protection of its own, must not take the
/// lock, and must be short.
///
/// No heap, no exceptions; bus and port must outlive the controller. RAM and instructions of a whole board
/// are in docs/scheduling.md.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "ocm/base/inline_function.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/controller/actuator_handler.hpp"
#include "ocm/controller/level.hpp"
#include "ocm/controller/report.hpp"
#include "ocm/controller/sensor_handler.hpp"
#include "ocm/protocol/counters.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/message.hpp"
#include "ocm/scheduling/admission.hpp"
#include "ocm/scheduling/cooperative.hpp"
#include "ocm/scheduling/dispatcher.hpp"
#include "ocm/scheduling/port.hpp"

namespace ocm::controller {

/// What a controller needs of its port: a system's port itself; of the cooperative one, which is a part of
/// the controller, the time at which it begins.
template <class P>
using PortArgument = std::conditional_t<std::same_as<P, scheduling::Cooperative>, base::Time, P&>;

namespace detail {
template <class P>
class PortPlace {
 public:
  explicit PortPlace(P& port) noexcept : port_(&port) {}
  [[nodiscard]] P& get() noexcept { return *port_; }

 private:
  P* port_;
};
template <>
class PortPlace<scheduling::Cooperative> {
 public:
  explicit PortPlace(base::Time start) noexcept : port_(start) {}
  [[nodiscard]] scheduling::Cooperative& get() noexcept { return port_; }

 private:
  scheduling::Cooperative port_;
};
}  // namespace detail

/// `Tasks`: how many periodic tasks of its own the board has. `A` may refuse streams that would make another
/// late (docs/admission.md).
template <class Board, can::Sender Bus, scheduling::Port P = scheduling::Cooperative, std::size_t Tasks = 0,
          scheduling::Admission A = scheduling::AdmitAll>
class Controller {
  static constexpr bool cooperative = std::same_as<P, scheduling::Cooperative>;
  static constexpr bool has_status = requires { requires !std::is_void_v<typename Board::status>; };
  static constexpr bool has_refusal = requires { requires !std::is_void_v<typename Board::refusal>; };

 public:
  static constexpr std::size_t sensors = Board::sensors::size;

  explicit Controller(Bus& bus, PortArgument<P> port = {}) noexcept
      : bus_(&bus), place_(port), dispatcher_(place_.get()), start_(place_.get().now()) {
    if constexpr (has_status)
      serve<typename Board::status>(
          [this](base::Time now) -> base::Result<typename Board::status> { return status(now); });
    if constexpr (has_refusal)
      serve<typename Board::refusal>([this]() -> base::Result<typename Board::refusal> { return refusal(); });
  }

  // Set-up
  /// `read` is called whenever a sample of `Topic` is due: Result<Topic>() or Result<Topic>(base::Time now).
  template <class Topic, class F>
  void serve(F read) noexcept {
    static_assert(Board::sensors::template contains<Topic>, "this topic belongs to another board");
    if constexpr (std::is_invocable_v<F&, base::Time>)
      sensors_.template serve<Topic>(read);
    else
      sensors_.template serve<Topic>([read](base::Time) mutable { return read(); });
  }

  /// `apply` gets every set point of `Topic`: void(const Topic&), or void(instance, const Topic&) where there
  /// are several of a kind. When none came for `timeout` it gets one of zeros; zero: never.
  template <class Topic, class F>
  void accept(F apply, base::Duration timeout = Topic::timeout) noexcept {
    static_assert(Board::actuators::template contains<Topic>, "this topic belongs to another board");
    if constexpr (std::is_invocable_v<F&, std::uint8_t, const Topic&>)
      actuators_.template accept<Topic>(apply, timeout);
    else
      actuators_.template accept<Topic>(
          [apply](std::uint8_t, const Topic& set_point) mutable { apply(set_point); }, timeout);
  }

  /// `job` is called every `period` (above zero) at `level`, from now on: void() or
  /// void(const scheduling::Release&). The board's task number `Task`. One that commands other boards answers
  /// with the Outcome of `command`, and is called again when the bus has room, if that waits.
  template <std::size_t Task, class F>
  void every(base::Duration period, scheduling::Level level, F job) noexcept {
    static_assert(Task < Tasks, "the controller has fewer tasks");
    if constexpr (std::is_invocable_r_v<scheduling::Outcome, F&, const scheduling::Release&>)
      tasks_[Task] = job;
    else
      tasks_[Task] = [job](const scheduling::Release& release) mutable {
        if constexpr (std::is_invocable_v<F&, const scheduling::Release&>)
          job(release);
        else
          job();
        return scheduling::Outcome::done;
      };
    dispatcher_.start(first_task + Task, period, level, port().now());
  }

  /// `health` is asked whenever the board's status is due: Health(). Without it the status says "unknown".
  template <class F>
  void report(F health) noexcept {
    health_ = health;
  }

  // Running
  /// A frame from the bus, received at `now`: the grid of what it asks for begins there.
  void receive(const can::Frame& frame, base::Time now) noexcept {
    if constexpr (cooperative) port().advance(now);
    const bool command = frame.format == can::Format::base &&
                         protocol::Identifier::decode(frame.id).direction == protocol::Direction::command;
    Verdict verdict;
    if (command) {
      verdict = sensors_.handle(frame, now, dispatcher_, first_sensor, port(), counters_, admission_);
      if (!verdict.mine) {
        verdict = actuators_.handle(frame, now, port(), counters_);
        if (verdict.mine) watch();
      }
      if (verdict.refused != base::Error::none)
        tell({protocol::Identifier::decode(frame.id).topic, verdict.refused});
    }
    [[maybe_unused]] const auto guard = port().lock();
    ++counters_.received;
    counters_.foreign += verdict.mine ? 0U : 1U;
  }
  /// What was asked of `topic` turned out to be impossible after it was taken: counted and told like any
  /// other refusal.
  void refuse(protocol::TopicId topic, base::Error reason) noexcept {
    {
      [[maybe_unused]] const auto guard = port().lock();
      counters_.refuse(reason);
    }
    tell({topic, reason});
  }
  /// Commands an actuator of another board; to be called from a task, which answers with the Outcome. A bus
  /// without room: `waits`; the task is called once more as soon as there is some (`Release::resumed`), and
  /// commands what is right then, so no set point is sent that is older than its task. A bus that answers
  /// with an error: counted as `send_failed`, and the set point is given up.
  template <class Topic>
  [[nodiscard]] scheduling::Outcome command(const Topic& set_point,
                                            protocol::Priority priority = Topic::priority) noexcept {
    static_assert(!Board::actuators::template contains<Topic>, "this board has the actuator itself");
    const can::Frame frame = protocol::command(set_point, priority);
    [[maybe_unused]] const auto guard = port().lock();
    const base::Result<bool> taken = bus_->send(frame);
    if (!taken) {
      ++counters_.send_failed;
      return scheduling::Outcome::done;
    }
    if (!*taken) return scheduling::Outcome::waits;
    ++counters_.sent;
    return scheduling::Outcome::done;
  }
  /// The port's timer went off.
  void expire() noexcept { dispatcher_.expire(); }
  /// Does what is due at `level`.
  void run(scheduling::Level level) noexcept {
    dispatcher_.run(level, [this](const scheduling::Release& release) { return serve(release); });
  }
  /// The bus has room again.
  void writable() noexcept { dispatcher_.wake(); }
  /// No command can reach this board any more: what has a timeout comes to rest now, not when that has
  /// passed.
  void bus_lost() noexcept {
    actuators_.lose_bus(port(), counters_);
    watch();
  }

  /// In a program of one context: does all that is due at `now`, level by level, and offers the bus what
  /// waits.
  void poll(base::Time now) noexcept requires cooperative {
    port().advance(now);
    dispatcher_.wake();
    dispatcher_.expire();
    for (scheduling::Level level; port().take_pended(level);) run(level);
  }
  /// When to poll next; it may have passed. base::never when nothing is to come.
  [[nodiscard]] base::Time next_event() const noexcept requires cooperative {
    return port().pended() ? port().now() : dispatcher_.next_release();
  }

  // Looking on
  /// Frames wait for the bus: call `writable` (or `poll`) as soon as it has room.
  [[nodiscard]] bool waiting() const noexcept { return dispatcher_.waiting(); }
  [[nodiscard]] protocol::Counters counters() const noexcept {
    protocol::Counters result;
    {
      [[maybe_unused]] const auto guard = port().lock();
      result = counters_;
    }
    for (std::size_t sensor = 0; sensor < sensors; ++sensor) {
      const scheduling::Overload one = overload(sensor);
      result.missed += one.missed;
      result.late += one.late;
      result.overrun += one.overrun;
    }
    return result;
  }
  /// What a sensor could not keep up with; numbered as in Board::sensors.
  [[nodiscard]] scheduling::Overload overload(std::size_t sensor) const noexcept {
    return dispatcher_.overload(first_sensor + sensor);
  }
  /// The same of the board's own tasks.
  [[nodiscard]] scheduling::Overload task_overload(std::size_t task) const noexcept {
    return dispatcher_.overload(first_task + task);
  }
  /// This sensor publishes.
  [[nodiscard]] bool active(std::size_t sensor) const noexcept {
    return dispatcher_.active(first_sensor + sensor);
  }
  [[nodiscard]] P& port() const noexcept { return place_.get(); }

 private:
  // Among releases of one moment and level: safety first, then what others read, then they.
  static constexpr std::size_t watchdog = 0;
  static constexpr std::size_t first_task = 1;
  static constexpr std::size_t first_sensor = first_task + Tasks;

  scheduling::Outcome serve(const scheduling::Release& release) noexcept {
    if (release.stream >= first_sensor)
      return sensors_.run(release.stream - first_sensor, release, port(), *bus_, counters_);
    if (release.stream == watchdog) {
      actuators_.settle(port().now(), port(), counters_);
      watch();
    } else if constexpr (Tasks > 0) {
      return tasks_[release.stream - first_task](release);
    }
    return scheduling::Outcome::done;
  }

  /// The board says unasked what it has refused, as soon as the low level has time. Several in a row make one
  /// frame, which has the last one and the number of all.
  void tell(const Refusal& refusal) noexcept {
    {
      [[maybe_unused]] const auto guard = port().lock();
      last_refusal_ = refusal;
    }
    if constexpr (has_refusal) {
      constexpr std::size_t sensor = Board::sensors::template index<typename Board::refusal>;
      // Who publishes it sees it at the next release; he may begin while this context waits.
      dispatcher_.once_unless_active(first_sensor + sensor, level_of(Board::refusal::priority), port().now());
    }
  }

  [[nodiscard]] auto status(base::Time now) const noexcept {
    Activity activity;
    activity.uptime = now - start_;
    activity.wire_hash = Board::wire_hash;
    for (std::size_t sensor = 0; sensor < sensors && sensor < 32; ++sensor)
      activity.publishing |= (active(sensor) ? std::uint32_t{1} : 0U) << sensor;
    activity.overload = dispatcher_.overload();
    {
      [[maybe_unused]] const auto guard = port().lock();
      activity.send_failed = counters_.send_failed;
      activity.faults = sensors_.faults();
    }
    return make_status<typename Board::status>(health(), activity);
  }
  [[nodiscard]] auto refusal() const noexcept {
    const Health now = health();  // a board that asks its line locks, too
    [[maybe_unused]] const auto guard = port().lock();
    return make_refusal<typename Board::refusal>(last_refusal_, counters_.refused(), counters_.not_sampled,
                                                 now);
  }
  [[nodiscard]] Health health() const noexcept { return health_ ? health_() : Health{}; }

  /// Has the actuators looked at when the first watchdog expires.
  void watch() noexcept {
    dispatcher_.once(watchdog, scheduling::Level::urgent,
                     [this] { return actuators_.next_settle(port().now()); });
  }

  Bus* bus_;
  mutable detail::PortPlace<P> place_;
  scheduling::Dispatcher<first_sensor + sensors, P> dispatcher_;
  SensorHandler<typename Board::sensors> sensors_;
  ActuatorHandler<typename Board::actuators> actuators_;
  std::array<base::InlineFunction<scheduling::Outcome(const scheduling::Release&)>, Tasks> tasks_{};
  mutable base::InlineFunction<Health()> health_;
  [[no_unique_address]] A admission_;
  Refusal last_refusal_;
  base::Time start_;
  protocol::Counters counters_;
};

}  // namespace ocm::controller
