/// A mapper of the world with its application running in virtual time. Its link is chosen by the code that
/// composes it: a dongle on a radio, or a line of its own.
///
///     RunningRobot<Dongle> robot{world.robot(0), dongle, start};
///     robot.advance_to(now);                    // at next_event(), the world being there already
///     robot.receive(bytes, now);
///
/// Host only. Its jobs take no time. It must stay where it is.
#pragma once

#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/base/time.hpp"
#include "ocm/mapper/app/models.hpp"
#include "ocm/mapper/app/robot.hpp"
#include "ocm/scheduling/cooperative.hpp"

#include "sim/mapper/parts.hpp"
#include "sim/mapper/robot.hpp"

namespace ocm::sim::mapper {

/// What a robot's application asks of its link.
template <class L>
concept RobotLink = requires(L& link, std::span<const std::uint8_t> bytes, base::Time now) {
  { link.linked() } -> std::same_as<bool>;
  { link.write(bytes, now) } -> std::same_as<std::size_t>;  ///< how many found room
};

/// The application's model of a robot of this kind.
[[nodiscard]] constexpr const ocm::mapper::app::RobotModel& application_of(RobotKind kind) noexcept {
  return kind == RobotKind::avr ? ocm::mapper::app::avr_robot : ocm::mapper::app::arduino_robot;
}

/// And with what its owner has measured of its wheels.
[[nodiscard]] inline ocm::mapper::app::RobotModel as_its_owner_has_it(const Robot& body) noexcept {
  return ocm::mapper::app::wheels_calibrated(application_of(body.model().kind), body.wheels_say_per_m());
}
/// What a calibration of its compass would find, in an undisturbed place, without noise; into its memory,
/// unless that keeps one.
inline void calibrate(Robot& body) noexcept {
  if (body.stored()) return;
  const sensing::Field own = body.own_field();
  const auto seen = body.field();
  body.store({.offset = own, .field = seen ? std::hypot(seen->x - own.x, seen->y - own.y) : 0.0F});
}

template <RobotLink Link>
class RunningRobot {
 public:
  /// As its owner has it: its wheels were calibrated on a measured way. Its compass is as its memory has it.
  RunningRobot(Robot& body, Link& link, base::Time start)
      : RunningRobot(body, link, start, as_its_owner_has_it(body)) {}
  RunningRobot(Robot& body, Link& link, base::Time start, const ocm::mapper::app::RobotModel& model)
      : body_(&body),
        model_(model),
        port_(start),
        parts_(body, Linked{&link}, Send{&link, &port_}),
        application_(parts_, port_, model_) {
    application_.start();
  }
  RunningRobot(const RunningRobot&) = delete;  // the application holds its port and parts
  RunningRobot& operator=(const RunningRobot&) = delete;

  /// Whatever is due until `now`, at `now`.
  void advance_to(base::Time now) {
    port_.advance(now);
    while (port_.armed() <= now || port_.pended()) {
      if (port_.armed() <= now) application_.expire();
      for (scheduling::Level level{}; port_.take_pended(level);) application_.run(level);
    }
  }
  /// When there is something to do.
  [[nodiscard]] base::Time next_event() const noexcept {
    return port_.pended() ? port_.now() : port_.armed();
  }

  /// From its link.
  void receive(std::span<const std::uint8_t> bytes, base::Time now) {
    port_.advance(now);
    for (const std::uint8_t byte : bytes) application_.receive(byte);
  }
  void link_changed(base::Time now) {
    port_.advance(now);
    application_.link_changed();
  }

  /// The truth, which its application does not know.
  [[nodiscard]] const Pose& pose() const noexcept { return body_->pose(); }
  [[nodiscard]] const Robot& body() const noexcept { return *body_; }
  [[nodiscard]] auto& application() noexcept { return application_; }

 private:
  struct Linked {
    Link* link;
    [[nodiscard]] bool operator()() const { return link->linked(); }
  };
  struct Send {
    Link* link;
    const scheduling::Cooperative* port;
    [[nodiscard]] std::size_t operator()(std::span<const std::uint8_t> bytes) const {
      return link->write(bytes, port->now());
    }
  };
  using Parts = WorldParts<Linked, Send>;

  Robot* body_;
  ocm::mapper::app::RobotModel model_;
  scheduling::Cooperative port_;
  Parts parts_;
  ocm::mapper::app::Robot<Parts, scheduling::Cooperative> application_;
};

}  // namespace ocm::sim::mapper
