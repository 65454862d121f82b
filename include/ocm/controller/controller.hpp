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
/// No heap, no exceptions; the bus must outlive the controller. Not reentrant.
#pragma once

#include <algorithm>
#include <cstdint>
#include <type_traits>

#include "ocm/base/time.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/controller/actuator_handler.hpp"
#include "ocm/controller/sensor_handler.hpp"
#include "ocm/protocol/counters.hpp"
#include "ocm/protocol/identifier.hpp"

namespace ocm::controller {

template <class Board, can::Sender Bus>
class Controller {
 public:
  explicit Controller(Bus& bus) noexcept : bus_(&bus) {}

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

  /// A frame from the bus, received at `now`.
  void receive(const can::Frame& frame, base::Time now) noexcept {
    ++counters_.received;
    const bool command = frame.format == can::Format::base &&
                         protocol::Identifier::decode(frame.id).direction == protocol::Direction::command;
    if (!command || (!sensors_.handle(frame, now, counters_) && !actuators_.handle(frame, now, counters_)))
      ++counters_.foreign;
  }

  /// Does what is due at `now`: brings overdue actuators to rest, samples and sends.
  void poll(base::Time now) noexcept {
    actuators_.poll(now, counters_);
    sensors_.poll(now, *bus_, counters_);
  }

  /// When to poll next; base::never when nothing is to come.
  [[nodiscard]] base::Time next_event() const noexcept {
    return std::min(sensors_.next_release(), actuators_.next_timeout());
  }
  /// Frames wait for the bus: poll as soon as it has room.
  [[nodiscard]] bool waiting() const noexcept { return sensors_.waiting(); }
  [[nodiscard]] const protocol::Counters& counters() const noexcept { return counters_; }

 private:
  Bus* bus_;
  SensorHandler<typename Board::sensors> sensors_;
  ActuatorHandler<typename Board::actuators> actuators_;
  protocol::Counters counters_;
};

}  // namespace ocm::controller
