/// DiWheelDrive, the bottom board: wheels, inertial sensors, compass, floor sensors. The same code runs on
/// the board, with drivers, and on a host, with a simulated world.
///
/// No heap, no exceptions. Not reentrant: call all of it from one context, or lock around it.
#pragma once

#include <concepts>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/controller/controller.hpp"
#include "ocm/protocol/counters.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/boards/di_wheel_drive/geometry.hpp"
#include "firmware/boards/di_wheel_drive/odometry.hpp"
#include "firmware/boards/samples.hpp"

namespace ocm::firmware::boards::di_wheel_drive {

/// What the board needs of its parts. A part that has nothing to say answers Error::not_sampled.
template <class H>
concept Hardware = requires(H& hardware, WheelSpeeds speeds) {
  { hardware.gyroscope() } -> std::same_as<base::Result<AngularRate>>;
  { hardware.accelerometer() } -> std::same_as<base::Result<SpecificForce>>;
  { hardware.magnetometer() } -> std::same_as<base::Result<MagneticField>>;
  { hardware.floor() } -> std::same_as<base::Result<FloorCounts>>;
  { hardware.encoders() } -> std::same_as<base::Result<WheelTicks>>;
  hardware.set_wheels(speeds);  // the speed controllers' set points
};

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

template <Hardware H, can::Sender Bus>
class Board {
 public:
  /// Both must outlive the board.
  Board(H& hardware, Bus& bus) noexcept : hardware_(&hardware), controller_(bus) {
    controller_.template serve<amiro::Odometry>([this]() -> base::Result<amiro::Odometry> {
      if (!odometry_.valid()) return base::Error::not_sampled;
      return to_wire(odometry_.state());
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
    controller_.template accept<amiro::Motors>([this](const amiro::Motors& target) {
      hardware_->set_wheels(wheel_speeds(target.x_m_per_s(), target.z_rad_per_s()));
    });
  }
  Board(const Board&) = delete;  // the controller holds this address
  Board& operator=(const Board&) = delete;

  /// To be called once every `odometry_period`, whatever else is going on.
  void update_odometry() noexcept {
    const auto ticks = hardware_->encoders();
    if (ticks)
      odometry_.update(*ticks);
    else
      odometry_.interrupt();
  }

  void receive(const can::Frame& frame, base::Time now) noexcept { controller_.receive(frame, now); }
  void poll(base::Time now) noexcept { controller_.poll(now); }
  [[nodiscard]] base::Time next_event() const noexcept { return controller_.next_event(); }
  [[nodiscard]] bool waiting() const noexcept { return controller_.waiting(); }
  [[nodiscard]] const protocol::Counters& counters() const noexcept { return controller_.counters(); }
  [[nodiscard]] const Odometry& odometry() const noexcept { return odometry_; }

 private:
  H* hardware_;
  Odometry odometry_;
  controller::Controller<amiro::DiWheelDrive, Bus> controller_;
};

}  // namespace ocm::firmware::boards::di_wheel_drive
