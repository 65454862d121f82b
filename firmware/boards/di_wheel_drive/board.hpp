/// DiWheelDrive, the bottom board: wheels, inertial sensors, compass, floor sensors. The same code runs on
/// the board, with drivers, and on a host, with a simulated world.
///
/// Three tasks of its own: at `high` the odometry, every `odometry_period`; at `low` the behaviours, every
/// `behaviour_period`, which read the floor, and so take long, only while one is active; at `urgent`, on
/// hardware that has a speed controller to be stepped, that, every `control_period`.
///
/// No heap, no exceptions. Who may call what: ocm/controller/controller.hpp.
#pragma once

#include <chrono>
#include <concepts>
#include <cstddef>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/controller/controller.hpp"
#include "ocm/scheduling/admission.hpp"
#include "ocm/scheduling/cooperative.hpp"
#include "ocm/scheduling/dispatcher.hpp"
#include "ocm/scheduling/port.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/boards/calibration.hpp"
#include "firmware/boards/di_wheel_drive/behaviours.hpp"
#include "firmware/boards/di_wheel_drive/geometry.hpp"
#include "firmware/boards/di_wheel_drive/odometry.hpp"
#include "firmware/boards/node.hpp"
#include "firmware/boards/samples.hpp"

namespace ocm::firmware::boards::di_wheel_drive {

/// What the board needs of its parts. A part that has nothing to say answers Error::not_sampled.
///
/// With a port other than the cooperative one they are called from several contexts: each sensor from the
/// level that it was asked for, `encoders` at high and low, and `floor` at low, too, while a line is
/// followed: both may be preempted by themselves. `set_wheels` is called where set points come from and at
/// low, with the port's lock held; of Regulated hardware it is called in the context of `control`, just
/// before it.
template <class H>
concept Hardware = requires(H& hardware, WheelSpeeds speeds) {
  { hardware.gyroscope() } -> std::same_as<base::Result<AngularRate>>;
  { hardware.accelerometer() } -> std::same_as<base::Result<SpecificForce>>;
  { hardware.magnetometer() } -> std::same_as<base::Result<MagneticField>>;
  { hardware.floor() } -> std::same_as<base::Result<FloorCounts>>;
  { hardware.encoders() } -> std::same_as<base::Result<WheelTicks>>;
  hardware.set_wheels(speeds);                                       // the speed controllers' set points
  { hardware.calibrate_floor(true) } -> std::same_as<base::Status>;  // true: forget the offsets
};

/// Hardware whose speed controllers are software: `control` is one step of them.
template <class H>
concept Regulated = Hardware<H> && requires(H& hardware) {
  hardware.control();
};

/// Hardware whose parts come and go, and whose calibration takes time.
template <class H>
concept Maintained = Hardware<H> && requires(H& hardware, base::Time now) {
  hardware.maintain(now);
  { hardware.calibrating() } -> std::same_as<bool>;
  { hardware.calibration_error() } -> std::same_as<base::Error>;
};

/// How often the speed controllers are stepped. [decided: five steps in an odometry period]
inline constexpr base::Duration control_period = std::chrono::milliseconds{10};
static_assert(odometry_period % control_period == base::Duration{0});

static_assert(odometry_period == amiro::Odometry::shortest_period);

/// An odometry state as it travels; what is beyond a field's range becomes its bound.
[[nodiscard]] constexpr amiro::Odometry to_wire(const Odometry::State& state) noexcept {
  amiro::Odometry wire;
  wire.velocity.set_x_m_per_s(state.forward_m_per_s);
  wire.velocity.set_z_rad_per_s(state.turn_rad_per_s);
  wire.pose.set_x_m(state.x_m);
  wire.pose.set_y_m(state.y_m);
  wire.pose.set_orientation_rad(state.heading_rad);
  return wire;
}

template <Hardware H, can::Sender Bus, scheduling::Port P = scheduling::Cooperative,
          scheduling::Admission A = scheduling::AdmitAll>
class Board : public Node<amiro::DiWheelDrive, Bus, P, (Regulated<H> ? 3 : 2), A> {
  using Base = Node<amiro::DiWheelDrive, Bus, P, (Regulated<H> ? 3 : 2), A>;
  using Base::controller_;

 public:
  /// All of them must outlive the board. The tasks' grid begins now, so the port works by now.
  Board(H& hardware, Bus& bus, controller::PortArgument<P> port = {}) noexcept
      : Base(bus, port), hardware_(&hardware) {
    controller_.template serve<amiro::Odometry>([this]() -> base::Result<amiro::Odometry> {
      const Odometry odometry = [this] {
        [[maybe_unused]] const auto guard = controller_.port().lock();
        return odometry_;
      }();
      if (!odometry.valid()) return base::Error::not_sampled;
      return to_wire(odometry.state());  // not in the odometry's task, for which less urgent topics wait
    });
    controller_.template serve<amiro::Gyroscope>([this]() -> base::Result<amiro::Gyroscope> {
      const auto rate = hardware_->gyroscope();
      if (!rate) return rate.error;
      return amiro::Gyroscope{rate->x, rate->y, rate->z};
    });
    controller_.template serve<amiro::Accelerometer>([this]() -> base::Result<amiro::Accelerometer> {
      const auto force = hardware_->accelerometer();
      if (!force) return force.error;
      return amiro::Accelerometer{force->x, force->y, force->z};
    });
    controller_.template serve<amiro::Magnetometer>([this]() -> base::Result<amiro::Magnetometer> {
      const auto field = hardware_->magnetometer();
      if (!field) return field.error;
      return amiro::Magnetometer{{field->x}, {field->y}, {field->z}};
    });
    controller_.template serve<amiro::FloorProximity>([this]() -> base::Result<amiro::FloorProximity> {
      const auto counts = hardware_->floor();
      if (!counts) return counts.error;
      return amiro::FloorProximity{(*counts)[0], (*counts)[1], (*counts)[2], (*counts)[3]};
    });
    controller_.template serve<amiro::Behaviour>([this]() -> base::Result<amiro::Behaviour> {
      [[maybe_unused]] const auto guard = controller_.port().lock();
      return orders_.report();
    });
    controller_.template accept<amiro::Motors>([this](const amiro::Motors& target) {
      const WheelSpeeds speeds = wheel_speeds(target.x_m_per_s(), target.z_rad_per_s());
      [[maybe_unused]] const auto guard = controller_.port().lock();
      orders_.end(target == amiro::Motors{} ? Ended::stopped : Ended::replaced);
      turn_wheels(speeds);
    });
    controller_.template accept<amiro::Travel>([this](const amiro::Travel& travel) {
      const bool possible = can_travel(travel);
      if (travel != amiro::Travel{} && !possible)
        return controller_.refuse(amiro::Travel::id, base::Error::out_of_range);
      [[maybe_unused]] const auto guard = controller_.port().lock();
      if (possible)
        orders_.travel(travel);
      else if (orders_.end(Active::travel, Ended::stopped))
        turn_wheels({});
    });
    controller_.template accept<amiro::Follow>([this](const amiro::Follow& follow) {
      if (!can_follow(follow)) return controller_.refuse(amiro::Follow::id, base::Error::out_of_range);
      [[maybe_unused]] const auto guard = controller_.port().lock();
      if (follow != amiro::Follow{})
        orders_.follow(follow);
      else if (orders_.end(Active::follow, Ended::stopped))
        turn_wheels({});
    });
    controller_.template accept<amiro::FloorCalibration>([this](const amiro::FloorCalibration& command) {
      calibration_.apply(command, controller_,
                         [this](bool forget) { return hardware_->calibrate_floor(forget); });
    });
    controller_.template every<0>(
        odometry_period, scheduling::Level::high,
        [this](const scheduling::Release& release) { update_odometry(release.missed + 1); });
    controller_.template every<1>(
        behaviour_period, scheduling::Level::low,
        [this](const scheduling::Release& release) { step_behaviour(release.missed + 1); });
    if constexpr (Regulated<H>)
      controller_.template every<2>(control_period, scheduling::Level::urgent, [this] { control(); });
  }
  /// On hardware that needs it, to be called every 10 ms or so on the low level: looks after the parts, and
  /// tells how a calibration ended.
  void maintain(base::Time now) noexcept requires Maintained<H> {
    hardware_->maintain(now);
    calibration_.look(
        controller_, [this] { return hardware_->calibrating(); },
        [this] { return hardware_->calibration_error(); });
  }

 private:
  using Active = Orders::Active;
  using Ended = Orders::Ended;

  /// With the port's lock held.
  void turn_wheels(WheelSpeeds speeds) noexcept {
    if constexpr (Regulated<H>)
      wheels_ = speeds;
    else
      hardware_->set_wheels(speeds);
  }

  /// Parts are read and numbers worked out without the lock; an order that ended meanwhile moves no wheel.
  void step_behaviour(std::uint32_t periods) noexcept {
    Orders::Order order;
    {
      [[maybe_unused]] const auto guard = controller_.port().lock();
      order = orders_.order();
    }
    if (order.active == Active::none) return;
    const Behaviours::Step step = behaviours_.step(
        order, periods, [this] { return hardware_->encoders(); }, [this] { return hardware_->floor(); });
    [[maybe_unused]] const auto guard = controller_.port().lock();
    if (orders_.take(order.number, step.distance, step.angle, step.ended)) turn_wheels(step.wheels);
  }

  void update_odometry(std::uint32_t periods) noexcept {
    const auto ticks = hardware_->encoders();
    Odometry next = odometry_;  // only this task changes it
    if (ticks)
      next.update(*ticks, periods);
    else
      next.interrupt();
    [[maybe_unused]] const auto guard = controller_.port().lock();
    odometry_ = next;
  }

  void control() noexcept requires Regulated<H> {
    WheelSpeeds wheels;
    {
      [[maybe_unused]] const auto guard = controller_.port().lock();
      if (orders_.pass(control_period)) wheels_ = {};
      wheels = wheels_;
    }
    hardware_->set_wheels(wheels);
    hardware_->control();
  }

  H* hardware_;
  Calibration<amiro::FloorCalibration> calibration_;
  Odometry odometry_;  // changed by its task, with the lock
  WheelSpeeds wheels_{};
  Orders orders_;          // with the lock
  Behaviours behaviours_;  // of its task only
};

}  // namespace ocm::firmware::boards::di_wheel_drive
