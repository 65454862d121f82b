/// Model of the LED driver TLC5947 with eight coloured lights. It satisfies firmware::drivers::Spi; the chip
/// select is XLAT. [data sheet: TI TLC5947, SBVS114B]
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>

#include "ocm/base/result.hpp"

#include "firmware/boards/samples.hpp"
#include "firmware/drivers/bus.hpp"
#include "sim/parts/spi_device.hpp"
#include "sim/parts/violations.hpp"

namespace ocm::sim {

class Tlc5947Model : public SpiDevice {
 public:
  /// `light(number, colour)` is called for all lights whenever what they show may have changed.
  Tlc5947Model(Violations& violations, std::function<void(std::size_t, firmware::boards::Colour)> light)
      : violations_(&violations), light_(std::move(light)) {
    // Register and latch hold anything after power-up.
    for (std::size_t i = 0; i < bits; ++i) shift_[i] = latch_[i] = i % 3 == 0;
  }

  void set_stuck(bool stuck) noexcept { stuck_ = stuck; }

  base::Status transfer(const firmware::drivers::SpiSettings& settings, std::span<const std::uint8_t> out,
                        std::span<std::uint8_t> in) override {
    if (stuck_) return base::Error::bus_fault;
    if (settings.highest_clock_hz > 30'000'000) violations_->add("TLC5947: SCLK above 30 MHz");
    // Modes 1 and 2 change the data at the rising edge, at which the part takes them: it gets the bit before.
    const bool late = settings.mode == 1 || settings.mode == 2;
    if (late) violations_->add("TLC5947: data are taken at the rising edge");
    if (out.size() * 8 != bits) violations_->add("TLC5947: not 288 bits between two edges of XLAT");
    std::fill(in.begin(), in.end(), std::uint8_t{0xFF});  // SOUT is not connected, the pin is pulled up
    bool before = true;
    for (const std::uint8_t byte : out) {
      for (int bit = 7; bit >= 0; --bit) {
        const bool now = (byte >> bit & 1) != 0;
        std::rotate(shift_.begin(), shift_.begin() + 1, shift_.end());
        shift_.back() = late ? before : now;
        before = now;
      }
    }
    latch_ = shift_;
    latched_ = true;
    show();
    return {};
  }

  /// BLANK high: all outputs off.
  void set_blank(bool high) {
    blank_ = high;
    if (!high && !latched_) violations_->add("TLC5947: BLANK low before anything was latched");
    show();
  }

  /// What output `number` does, 0..4095.
  [[nodiscard]] unsigned level(std::size_t number) const {
    if (blank_) return 0;
    unsigned level = 0;
    for (std::size_t i = 0; i < 12; ++i)
      level = level << 1U | static_cast<unsigned>(latch_[(23 - number) * 12 + i]);
    return level;
  }

 private:
  static constexpr std::size_t bits = 288;

  void show() {
    if (!light_) return;
    for (std::size_t i = 0; i < 8; ++i) {
      const auto colour = [&](std::size_t output) { return static_cast<std::uint8_t>(level(output) >> 4); };
      light_(i, {colour(21 - 3 * i), colour(22 - 3 * i), colour(23 - 3 * i)});
    }
  }

  Violations* violations_;
  std::function<void(std::size_t, firmware::boards::Colour)> light_;
  std::array<bool, bits> shift_{}, latch_{};  // first the bit that came first
  bool blank_ = true;                         // pulled up until it is driven
  bool latched_ = false;
  bool stuck_ = false;
};

}  // namespace ocm::sim
