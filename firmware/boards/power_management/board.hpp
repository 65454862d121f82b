/// PowerManagement, the middle board: fuel gauge and proximity ring. The same code runs on the board, with
/// drivers, and on a host, with a simulated world.
///
/// No heap, no exceptions. Not reentrant.
#pragma once

#include <concepts>
#include <cstddef>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/controller/controller.hpp"
#include "ocm/protocol/counters.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/boards/samples.hpp"

namespace ocm::firmware::boards::power_management {

/// What the board needs of its parts. A part that has nothing to say answers Error::not_sampled.
template <class H>
concept Hardware = requires(H& hardware) {
  { hardware.gauge() } -> std::same_as<base::Result<GaugeReading>>;
  { hardware.ring() } -> std::same_as<base::Result<RingCounts>>;
};

template <Hardware H, can::Sender Bus>
class Board {
 public:
  /// Both must outlive the board.
  Board(H& hardware, Bus& bus) noexcept : hardware_(&hardware), controller_(bus) {
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
  }
  Board(const Board&) = delete;  // the controller holds this address
  Board& operator=(const Board&) = delete;

  void receive(const can::Frame& frame, base::Time now) noexcept { controller_.receive(frame, now); }
  void poll(base::Time now) noexcept { controller_.poll(now); }
  [[nodiscard]] base::Time next_event() const noexcept { return controller_.next_event(); }
  [[nodiscard]] bool waiting() const noexcept { return controller_.waiting(); }
  [[nodiscard]] const protocol::Counters& counters() const noexcept { return controller_.counters(); }

 private:
  H* hardware_;
  controller::Controller<amiro::PowerManagement, Bus> controller_;
};

}  // namespace ocm::firmware::boards::power_management
