/// PowerManagement, the middle board: fuel gauges, proximity ring and its ambient light. The same code runs
/// on the board, with drivers, and on a host, with a simulated world.
///
/// One task of its own, at `high`, every `avoidance_period`: while it is asked to avoid obstacles, or to
/// go home to a wall, it reads the ring and commands the motors of DiWheelDrive.
///
/// No heap, no exceptions. Who may call what: ocm/controller/controller.hpp.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>

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
#include "firmware/boards/node.hpp"
#include "firmware/boards/power_management/ring_behaviours.hpp"
#include "firmware/boards/samples.hpp"

namespace ocm::firmware::boards::power_management {

/// What the board needs of its parts. A part that has nothing to say answers Error::not_sampled.
template <class H>
concept Hardware = requires(H& hardware) {
  { hardware.gauge() } -> std::same_as<base::Result<GaugeReading>>;
  { hardware.ring() } -> std::same_as<base::Result<RingCounts>>;
  { hardware.batteries() } -> std::same_as<base::Result<BatteryReadings>>;
  { hardware.ring_light() } -> std::same_as<base::Result<RingLight>>;
  { hardware.calibrate_ring(true) } -> std::same_as<base::Status>;         // true: forget the offsets
  { hardware.ring_offset(std::size_t{}) } -> std::same_as<std::uint16_t>;  // of sensor 0..7; 0: not known
};

/// Hardware whose parts come and go, and whose calibration takes time.
template <class H>
concept Maintained = Hardware<H> && requires(H& hardware, base::Time now) {
  hardware.maintain(now);
  { hardware.calibrating() } -> std::same_as<bool>;
  { hardware.calibration_error() } -> std::same_as<base::Error>;
};

template <Hardware H, can::Sender Bus, scheduling::Port P = scheduling::Cooperative,
          scheduling::Admission A = scheduling::AdmitAll>
class Board : public Node<amiro::PowerManagement, Bus, P, 1, A> {
  using Base = Node<amiro::PowerManagement, Bus, P, 1, A>;
  using Base::controller_;

 public:
  /// All of them must outlive the board.
  Board(H& hardware, Bus& bus, controller::PortArgument<P> port = {}) noexcept
      : Base(bus, port), hardware_(&hardware) {
    controller_.template serve<amiro::PowerStatus>([this]() -> base::Result<amiro::PowerStatus> {
      const auto gauge = hardware_->gauge();
      if (!gauge) return gauge.error;
      amiro::PowerStatus status;
      status.set_plugged(gauge->plugged);
      status.set_charging(gauge->charging);
      status.state_of_charge = gauge->state_of_charge_percent;
      status.minutes = gauge->minutes;
      status.power = gauge->power_mw;
      return status;
    });
    controller_.template serve<amiro::ProximityRing>([this]() -> base::Result<amiro::ProximityRing> {
      const auto counts = hardware_->ring();
      if (!counts) return counts.error;
      amiro::ProximityRing ring;
      for (std::size_t i = 0; i < ring.sensor.size(); ++i) ring.sensor[i].proximity = (*counts)[i];
      return ring;
    });
    controller_.template serve<amiro::Batteries>([this]() -> base::Result<amiro::Batteries> {
      const auto readings = hardware_->batteries();
      if (!readings) return readings.error;
      amiro::Batteries batteries;
      for (std::size_t i = 0; i < batteries.battery.size(); ++i) {
        const BatteryReading& reading = (*readings)[i];
        batteries.battery[i] = {reading.voltage_mv, reading.current_ma, reading.remaining_mah,
                                reading.temperature_dk};
      }
      return batteries;
    });
    controller_.template serve<amiro::RingLight>([this]() -> base::Result<amiro::RingLight> {
      const auto counts = hardware_->ring_light();
      if (!counts) return counts.error;
      amiro::RingLight light;
      for (std::size_t i = 0; i < light.sensor.size(); ++i) light.sensor[i].illuminance = (*counts)[i];
      return light;
    });
    controller_.template accept<amiro::RingCalibration>([this](const amiro::RingCalibration& command) {
      calibration_.apply(command, controller_,
                         [this](bool forget) { return hardware_->calibrate_ring(forget); });
    });
    controller_.template accept<amiro::Avoid>([this](const amiro::Avoid& avoid) {
      if (!can_avoid(avoid)) return controller_.refuse(amiro::Avoid::id, base::Error::out_of_range);
      // Counts without an offset are no distance: everything would seem near.
      if (avoid != amiro::Avoid{} && !offsets())
        return controller_.refuse(amiro::Avoid::id, base::Error::not_sampled);
      [[maybe_unused]] const auto guard = controller_.port().lock();
      want(wanted_.avoid, avoid, wanted_.home);
    });
    controller_.template accept<amiro::Home>([this](const amiro::Home& home) {
      if (!can_go_home(home)) return controller_.refuse(amiro::Home::id, base::Error::out_of_range);
      if (home != amiro::Home{} && !offsets())
        return controller_.refuse(amiro::Home::id, base::Error::not_sampled);
      [[maybe_unused]] const auto guard = controller_.port().lock();
      want(wanted_.home, home, wanted_.avoid);
    });
    controller_.template every<0>(avoidance_period, scheduling::Level::high,
                                  [this](const scheduling::Release& release) { return avoid(release); });
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
  /// Of all eight sensors; nothing when one has none.
  [[nodiscard]] base::Result<RingCounts> offsets() const noexcept {
    RingCounts offsets{};
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      offsets[i] = hardware_->ring_offset(i);
      if (offsets[i] == 0) return base::Error::not_sampled;
    }
    return offsets;
  }

  /// One at a time: a request for one ends the other. With the port's lock held.
  template <class Topic, class Other>
  static void want(Topic& wanted, const Topic& command, Other& other) noexcept {
    wanted = command;
    if (command != Topic{}) other = {};
  }

  /// Commands the motors while it is asked to; once more, with rest, when that has ended. Without a sample of
  /// the ring the wheels rest.
  scheduling::Outcome avoid(const scheduling::Release& release) noexcept {
    Wanted wanted;
    {
      [[maybe_unused]] const auto guard = controller_.port().lock();
      wanted = wanted_;
    }
    const bool active = wanted.any();
    if (!active && !commanding_) return scheduling::Outcome::done;
    amiro::Motors motors;
    if (active) {
      if (!commanding_) {
        behaviours_ = {};
        blind_for_ = {};
      }
      const auto counts = hardware_->ring();
      const auto offsets = this->offsets();
      const bool blind = !counts || !offsets;
      const protocol::TopicId asked = wanted.home != amiro::Home{} ? amiro::Home::id : amiro::Avoid::id;
      if (blind && blind_for_ != asked)
        controller_.refuse(asked, counts ? base::Error::not_sampled : counts.error);
      blind_for_ = blind ? asked : protocol::TopicId{};
      if (!blind) motors = behaviours_.step(wanted, *counts, *offsets, release.missed + 1);
    }
    const scheduling::Outcome outcome = controller_.command(motors, avoidance_priority);
    commanding_ = active || outcome == scheduling::Outcome::waits;
    return outcome;
  }

  H* hardware_;
  Calibration<amiro::RingCalibration> calibration_;
  Wanted wanted_{};  // with the lock
  // Of the task only
  RingBehaviours behaviours_{};
  bool commanding_ = false;        // the motors follow this board, or their rest could not be sent yet
  protocol::TopicId blind_for_{};  // active without a sample, which was reported; 0 is none of both
};

}  // namespace ocm::firmware::boards::power_management
