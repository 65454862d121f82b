/// The robot's CAN bus on the chip's own controller: firmware/drivers/bxcan_node.hpp with its interrupts and
/// the kernel's lock. Clock, interrupt numbers and vectors are ChibiOS's (CANv1's names); its
/// CAN driver is not used, for its transmit interrupt takes an aborted mailbox for a sent one.
///
/// RAM: 1 KiB. Interrupt priorities lie below the kernel's timer, so that a burst of frames delays none of
/// its releases.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/bit_timing.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/can/frame.hpp"

#include "firmware/chibios/port.hpp"
#include "firmware/drivers/bxcan.hpp"
#include "firmware/drivers/bxcan_node.hpp"

namespace ocm::firmware::chibios::stm32 {

/// CAN1 is at the same address on both chips. [RM0008 table 3, RM0090 table 1]
inline constexpr std::uintptr_t can1_address = 0x4000'6400;

/// The timing of a board of the generated header, sampled as AMiRo's own boards do: 15 of 18 quanta at 36
/// MHz; 42 MHz has no such point, 17 of 21 is its neighbour. Does not compile when the clock cannot give the
/// rate. [RM0008 24.7.7; spec/conflicts.md]
template <class Board, std::uint32_t bit_rate>
inline constexpr can::BitTiming bit_timing = [] {
  constexpr auto timing =
      can::find_bit_timing(Board::can_clock_hz, bit_rate, Board::can_clock_hz == 42'000'000 ? 810 : 833);
  static_assert(timing.ok() && timing->exact(Board::can_clock_hz));
  return *timing;
}();

class CanBus {
 public:
  CanBus() noexcept = default;
  CanBus(const CanBus&) = delete;
  CanBus& operator=(const CanBus&) = delete;

  /// Joins the bus. With the kernel running.
  /// `filters` must outlive the bus.
  base::Status start(Port& port, const can::BitTiming& timing,
                     const drivers::bxcan::FilterBanks& filters) noexcept;

  /// can::Sender: from any context.
  base::Result<bool> send(const can::Frame& frame) noexcept;

  /// chibios::EventSource: for one thread.
  BusEvent wait(can::Frame& frame) noexcept;

  /// For the status frames; any context.
  [[nodiscard]] drivers::bxcan::Counters counters() noexcept;
  [[nodiscard]] drivers::bxcan::BusErrors errors() noexcept;
  /// Frames that came while the queue below was full.
  [[nodiscard]] std::uint32_t missed() noexcept;

  /// What a host on the board's line sees (host_line.hpp).
  void attach(const drivers::bxcan::Ear& ear) noexcept { node_.attach(ear); }
  [[nodiscard]] drivers::bxcan::Node<drivers::bxcan::MappedRegisters>& node() noexcept { return node_; }
  void listen(bool all) noexcept;
  /// With the lock held: the board has it at once.
  void deliver(const can::Frame& frame) noexcept;

  void on_transmit() noexcept;
  void on_receive() noexcept;
  void on_overhear() noexcept;
  void on_status_change() noexcept;

 private:
  void watch() noexcept;
  /// `waited`: how many frames waited before. With the lock held.
  void room_again(std::size_t waited) noexcept;
  /// The clock is read only for a host that hears.
  [[nodiscard]] base::Time now_if_heard() noexcept { return node_.listening() ? port_->now() : base::Time{}; }

  drivers::bxcan::Node<drivers::bxcan::MappedRegisters> node_{drivers::bxcan::MappedRegisters{can1_address}};
  Port* port_ = nullptr;
  bool refused_ = false;   ///< `send` said no since room was last announced
  bool writable_ = false;  ///< there is room again
  bool lost_ = false;      ///< the bus went since that was last announced
  Signal signal_;
};
static_assert(can::Sender<CanBus>);
static_assert(EventSource<CanBus>);

}  // namespace ocm::firmware::chibios::stm32
