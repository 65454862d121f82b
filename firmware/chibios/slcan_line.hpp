/// A host on a board's serial line (ocm/can/slcan_bridge.hpp) in a thread of its own, below all levels: it
/// runs only while nothing of the protocol has anything to do. What it adds above that are its interrupts,
/// one a character each way, and the lock for a few dozen instructions at a time.
///
/// RAM: 2.1 KiB, of which frames 1.5 KiB, the rings 384 bytes; and the stack.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/can/slcan_adapter.hpp"
#include "ocm/can/slcan_bridge.hpp"

#include "firmware/chibios/port.hpp"
#include "firmware/drivers/usart.hpp"

namespace ocm::firmware::chibios {

/// Below the lowest level's.
inline constexpr tprio_t line_priority = priority_of(Level::low) - 1;

/// Bytes on top of what the kernel needs. [tests/firmware/qemu/test_line.py measures what is left]
inline constexpr std::size_t line_stack = 768;

template <drivers::usart::Registers R, can::slcan::BridgedBus B>
class SlcanLine {
 public:
  /// All must outlive the line. With the kernel running; `start` once.
  SlcanLine(R registers, B bus, Port& port, const can::slcan::AdapterInfo& info) noexcept
      : line_(registers), bus_(bus), port_(&port), bridge_(info) {}
  SlcanLine(const SlcanLine&) = delete;
  SlcanLine& operator=(const SlcanLine&) = delete;

  void start(std::uint32_t clock_hz, std::uint32_t bit_rate) noexcept {
    {
      const Lock lock;
      line_.start(clock_hz, bit_rate);
    }
    thread_.start(
        line_priority, [](void* self) { static_cast<SlcanLine*>(self)->work(); }, this);
  }

  /// A frame of the bus, or of the board. With the lock held.
  void hear(const can::Frame& frame, base::Time now) noexcept {
    bridge_.hear(frame, now);
    news_.raise_locked();
  }

  /// In the interrupt. `heed(byte)` sees each byte as it came, without the lock: it may not come back.
  template <class F>
  void on_interrupt(F heed) noexcept {
    std::optional<std::uint8_t> byte;
    {
      const Lock lock;
      const drivers::usart::News news = line_.on_interrupt([&byte](std::uint8_t came) { byte = came; });
      if (news.received || news.room) news_.raise_locked();
    }
    if (byte) heed(*byte);
  }

  [[nodiscard]] can::slcan::BridgeCounters counters() noexcept {
    const Lock lock;
    return bridge_.counters();
  }
  [[nodiscard]] drivers::usart::Counters line_counters() noexcept {
    const Lock lock;
    return line_.counters();
  }
  /// Frames that found no place on their way up or down, and characters of the host's; wraps around.
  [[nodiscard]] std::uint32_t lost() noexcept {
    const Lock lock;
    const can::slcan::BridgeCounters counters = bridge_.counters();
    return counters.lost + counters.no_room + bus_.condition().lost + line_.lost();
  }
  /// Bytes of stack that were never touched.
  [[nodiscard]] std::size_t untouched() const noexcept { return thread_.untouched(); }

 private:
  using Usart = drivers::usart::Line<R>;
  using Bridge = can::slcan::Bridge<>;

  /// can::slcan::BridgedLine: each call locked, none long.
  class Locked {
   public:
    explicit Locked(Usart& line) noexcept : line_(&line) {}
    bool read(char& character) noexcept {
      const Lock lock;
      return line_->read(character);
    }
    [[nodiscard]] std::size_t room() noexcept {
      const Lock lock;
      return line_->room();
    }
    void write(std::string_view text) noexcept {
      const Lock lock;
      line_->write(text);
    }
    [[nodiscard]] std::uint32_t lost() noexcept {
      const Lock lock;
      return line_->lost();
    }

   private:
    Usart* line_;
  };

  [[noreturn]] void work() noexcept {
    Locked line{line_};
    for (;;) {
      while (bridge_.turn(line, bus_, *port_) == can::slcan::Turn::more) {
      }
      news_.wait();
    }
  }

  Usart line_;
  B bus_;
  Port* port_;
  Bridge bridge_;
  Signal news_;
  Thread<line_stack> thread_;
};

}  // namespace ocm::firmware::chibios
