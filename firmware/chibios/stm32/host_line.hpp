/// A host on the board's programming UART: SLCAN beside the flashing tool's CONNECT. The robot's bus is then
/// in reach of any computer with a serial line, without a CAN adapter. docs/boards/di_wheel_drive.md
///
/// Until a host opens the channel only its commands are answered, and the CAN controller lets through what it
/// always does.
#pragma once

#include <cstdint>
#include <hal.h>

#include "ocm/base/result.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/can/slcan_bridge.hpp"

#include "firmware/chibios/port.hpp"
#include "firmware/chibios/slcan_line.hpp"
#include "firmware/chibios/stm32/can_bus.hpp"
#include "firmware/drivers/bxcan_filter.hpp"
#include "firmware/drivers/usart.hpp"

namespace ocm::firmware::chibios::stm32 {

/// can::slcan::BridgedBus: the robot's bus, and this board on it.
class BusOfHost {
 public:
  explicit BusOfHost(CanBus& can) noexcept : can_(&can) {}
  [[nodiscard]] bool board_has_room(const can::Frame& frame) noexcept {
    return can_->node().board_has_room(frame);
  }
  base::Result<bool> send(const can::Frame& frame) noexcept { return can_->node().send_of_host(frame); }
  void deliver(const can::Frame& frame) noexcept { can_->deliver(frame); }
  [[nodiscard]] can::slcan::BusCondition condition() noexcept { return can_->node().condition(); }
  void listen(bool all) noexcept { can_->listen(all); }

 private:
  CanBus* can_;
};

class HostLine {
 public:
  /// With what it overhears behind them.
  template <class Type>
  static constexpr drivers::bxcan::FilterBanks filters = drivers::bxcan::wide_filter_banks_of<Type>();

  HostLine(Port& port, CanBus& can) noexcept;
  HostLine(const HostLine&) = delete;
  HostLine& operator=(const HostLine&) = delete;

  /// Once, with the bus joined and the UART listened to (obey_shutdown).
  void start() noexcept;

  void on_interrupt() noexcept;

  /// Of the host's frames and characters.
  [[nodiscard]] std::uint32_t lost() noexcept { return line_.lost(); }

 private:
  CanBus* can_;
  SlcanLine<drivers::usart::MappedRegisters, BusOfHost> line_;
};

}  // namespace ocm::firmware::chibios::stm32
