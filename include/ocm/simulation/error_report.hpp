/// An error on the simulated bus as the driver of a real CAN controller would report it to its program. Pure.
#pragma once

#include <algorithm>
#include <cstdint>

#include "ocm/can/error_frame.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/simulation/fault_confinement.hpp"

namespace ocm::simulation {

/// What sends sees a bit error, what listens a stuff error: six dominant bits.
[[nodiscard]] inline can::Frame error_report(const FaultConfinement& faults, bool sends) noexcept {
  namespace c = can::error_class;
  can::Frame frame{.id = c::protocol | c::bus_error | c::counters, .dlc = 8, .format = can::Format::error};
  const unsigned passive = FaultConfinement::passive_from;
  if (faults.state() == FaultState::bus_off) frame.id |= c::bus_off;
  if (faults.state() == FaultState::error_passive) {
    frame.id |= c::controller;
    if (faults.transmit_errors() >= passive) frame.data[1] |= can::controller_error::tx_passive;
    if (faults.receive_errors() >= passive) frame.data[1] |= can::controller_error::rx_passive;
  }
  frame.data[2] =
      sends ? can::protocol_error::bit | can::protocol_error::transmission : can::protocol_error::stuff;
  frame.data[6] = static_cast<std::uint8_t>(std::min(faults.transmit_errors(), 255U));
  frame.data[7] = static_cast<std::uint8_t>(faults.receive_errors());
  return frame;
}

}  // namespace ocm::simulation
