/// PowerManagement, the middle board: fuel gauge and proximity ring. The same code runs on the board, with
/// drivers, and on a host, with a simulated world.
///
/// No heap, no exceptions. Who may call what: ocm/controller/controller.hpp.
#pragma once

#include <concepts>
#include <cstddef>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/controller/controller.hpp"
#include "ocm/scheduling/admission.hpp"
#include "ocm/scheduling/cooperative.hpp"
#include "ocm/scheduling/port.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/boards/calibration.hpp"
#include "firmware/boards/node.hpp"
#include "firmware/boards/samples.hpp"

namespace ocm::firmware::boards::power_management {

/// What the board needs of its parts. A part that has nothing to say answers Error::not_sampled.
template <class H>
concept Hardware = requires(H& hardware) {
  { hardware.gauge() } -> std::same_as<base::Result<GaugeReading>>;
  { hardware.ring() } -> std::same_as<base::Result<RingCounts>>;
  { hardware.calibrate_ring(true) } -> std::same_as<base::Status>;  // true: forget the offsets
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
class Board : public Node<amiro::PowerManagement, Bus, P, 0, A> {
  using Base = Node<amiro::PowerManagement, Bus, P, 0, A>;
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
    controller_.template accept<amiro::RingCalibration>([this](const amiro::RingCalibration& command) {
      calibration_.apply(command, controller_,
                         [this](bool forget) { return hardware_->calibrate_ring(forget); });
    });
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
  H* hardware_;
  Calibration<amiro::RingCalibration> calibration_;
};

}  // namespace ocm::firmware::boards::power_management
