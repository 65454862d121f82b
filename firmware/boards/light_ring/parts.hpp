/// The parts of LightRing: what its Board asks for, by the real driver. Which pins, and from where that is
/// known: docs/parts.md.
///
/// `set_light` from any level: `Lock` (with priority inheritance where levels preempt) is held for one
/// transfer of 36 bytes, 16 us at 18 MHz. No heap.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"

#include "firmware/boards/light_ring/board.hpp"
#include "firmware/boards/samples.hpp"
#include "firmware/drivers/bus.hpp"
#include "firmware/drivers/tlc5947.hpp"

namespace ocm::firmware::boards::light_ring {

/// Numbers of devices and pins, for code that names them. [AMiRo-OS 1.0, LightRing: global.hpp]
namespace wiring {
inline constexpr std::uint8_t lights_spi = 1;    ///< SPI1, chip select PC4, which is XLAT
inline constexpr std::uint8_t blank_pin = 0x01;  ///< output bit 0: PA4, BLANK; high: all lights off
}  // namespace wiring

/// Bits of `absent()`.
namespace part {
inline constexpr std::uint8_t lights = 0x01;  ///< its bus fails; the part itself cannot be asked
}  // namespace part

/// How often all lights are shown again: the part may have lost its power for a moment and cannot say so.
/// [decided]
inline constexpr base::Duration refresh_period = std::chrono::seconds{1};

template <drivers::Spi LightsDevice, drivers::Outputs Pins, drivers::Mutex Lock = drivers::NoMutex>
class Parts {
 public:
  /// Both must outlive the parts.
  Parts(LightsDevice& lights, Pins& pins) : lights_(lights), pins_(&pins) {}
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  /// Once, before anything else: all lights off, then the outputs on. What the part holds at power-up is
  /// random, so never the other way round. [TLC5947 data sheet, Register Configuration]
  void start(base::Time now) {
    pins_->write(wiring::blank_pin);
    show();
    next_refresh_ = now + refresh_period;
  }

  /// To be called every 10 ms or so on a low level.
  void maintain(base::Time now) {
    if (now < next_refresh_) return;
    next_refresh_ = now + refresh_period;
    show();
  }

  void set_light(std::size_t light, Colour colour) {
    if (light >= colours_.size()) return;
    const drivers::Guard<Lock> guard{lock_};
    colours_[light] = colour;
    show_locked();
  }

  // --- for the status frames ---

  [[nodiscard]] std::uint8_t absent() const noexcept {
    return failing_.load(std::memory_order_relaxed) ? part::lights : std::uint8_t{0};
  }
  /// Transfers that failed; stays at 65535.
  [[nodiscard]] std::uint16_t faults(std::size_t) const noexcept {
    return faults_.load(std::memory_order_relaxed);
  }
  [[nodiscard]] std::uint32_t faults() const noexcept { return faults(0); }

  static constexpr std::size_t parts = 1;

 private:
  void show() {
    const drivers::Guard<Lock> guard{lock_};
    show_locked();
  }
  void show_locked() {
    const bool shown = lights_.show(colours_).ok();
    failing_.store(!shown, std::memory_order_relaxed);
    if (shown) {
      if (!lit_) pins_->write(0);
      lit_ = true;
    } else if (const std::uint16_t faults = faults_.load(std::memory_order_relaxed); faults != 65535) {
      faults_.store(static_cast<std::uint16_t>(faults + 1), std::memory_order_relaxed);
    }
  }

  drivers::Tlc5947<LightsDevice> lights_;
  Pins* pins_;
  Lock lock_{};
  std::array<Colour, drivers::tlc5947::lights> colours_{};
  base::Time next_refresh_{};
  bool lit_ = false;
  std::atomic<bool> failing_{false};
  std::atomic<std::uint16_t> faults_{0};
};

}  // namespace ocm::firmware::boards::light_ring
