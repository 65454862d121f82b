/// The CAN controller of an emulated board: an SLCAN adapter on the first UART whose bus has one member, the
/// board. The host's end is any SLCAN host: it opens and closes the channel, what it transmits the board
/// receives, what the board sends it hears. The channel is open at 500 kbit/s from the start; closing it is
/// losing the bus.
///
/// Frames take their time: one goes out per its length at 500 kbit/s, and when one is done the most urgent
/// waiting is next, as from the mailboxes of a real controller. Each priority level has three places, so an
/// urgent frame finds one whatever waits below. O(1); 12 frames of 16 bytes, 700 bytes in all.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "ocm/base/fixed_vector.hpp"
#include "ocm/base/result.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/can/slcan_adapter.hpp"
#include "ocm/protocol/identifier.hpp"

#include "firmware/chibios/port.hpp"
#include "firmware/qemu/machine.hpp"

namespace ocm::firmware::qemu {

class SlcanBus {
 public:
  static constexpr std::uint32_t bit_rate = 500'000;
  static constexpr std::size_t places_a_level = 3;

  SlcanBus(Uart& uart, chibios::Port& port) noexcept : uart_(&uart), port_(&port) {}
  SlcanBus(const SlcanBus&) = delete;
  SlcanBus& operator=(const SlcanBus&) = delete;

  /// Says CR when it listens: QEMU throws away what comes before.
  void start() noexcept;

  /// can::Sender, with the port's lock held. False: the level's places are taken.
  base::Result<bool> send(const can::Frame& frame) noexcept;

  /// chibios::EventSource.
  chibios::BusEvent wait(can::Frame& frame) noexcept;

 private:
  /// What the adapter hands on from the host: one frame at a time, fetched before the next character.
  struct Inbox {
    can::Frame frame{};
    bool full = false;
    base::Result<bool> send(const can::Frame& from_host) noexcept {
      frame = from_host;
      full = true;
      return true;
    }
  };
  using Waiting = base::FixedVector<can::Frame, places_a_level * protocol::priority_levels>;

  [[nodiscard]] bool take(std::uint8_t character) noexcept;
  void begin_frame() noexcept;
  static void frame_sent(void* self);
  void write(std::string_view text) noexcept;

  Uart* uart_;
  chibios::Port* port_;
  can::slcan::Adapter adapter_;
  Inbox inbox_;
  Waiting waiting_;
  can::Frame sending_{};
  bool busy_ = false;      ///< `sending_` is on the wire
  bool writable_ = false;  ///< a place became free since the receiver looked
  bool lost_ = false;      ///< the channel was closed since the receiver looked
  chibios::Signal signal_;
  virtual_timer_t timer_{};
};
static_assert(can::Sender<SlcanBus>);
static_assert(chibios::EventSource<SlcanBus>);

}  // namespace ocm::firmware::qemu
