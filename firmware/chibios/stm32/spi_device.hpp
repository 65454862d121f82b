/// drivers::Spi on ChibiOS's SPI driver (DMA): the caller's thread sleeps while a frame runs. Devices on one
/// bus share a mutex with priority inheritance, held for one frame of the chip select.
#pragma once

#include <cstddef>
#include <cstdint>
#include <hal.h>
#include <span>

#include "ocm/base/result.hpp"

#include "firmware/chibios/port.hpp"
#include "firmware/drivers/bus.hpp"

namespace ocm::firmware::chibios::stm32 {

/// A controller and the clock that it divides.
struct SpiBus {
  SPIDriver& driver;
  std::uint32_t clock_hz;
  Mutex mutex{};
};

class SpiDevice {
 public:
  /// The chip select goes low for the length of a frame.
  SpiDevice(SpiBus& bus, ioportid_t port, std::uint8_t pad) noexcept : bus_(&bus), port_(port), pad_(pad) {}

  base::Status transfer(const drivers::SpiSettings& settings, std::span<const std::uint8_t> out,
                        std::span<std::uint8_t> in) noexcept {
    if (out.size() != in.size()) return base::Error::bad_length;
    const auto divider = divider_for(settings.highest_clock_hz);
    if (!divider.ok()) return divider.error;
    const SPIConfig config{nullptr, port_, pad_,
                           static_cast<std::uint16_t>(*divider << 3 | settings.mode)};  // BR | CPOL | CPHA
    drivers::Guard guard{bus_->mutex};
    spiStart(&bus_->driver, &config);
    spiSelect(&bus_->driver);
    if (!out.empty()) spiExchange(&bus_->driver, out.size(), out.data(), in.data());
    spiUnselect(&bus_->driver);
    spiStop(&bus_->driver);
    return {};
  }

 private:
  /// BR of CR1: the clock is divided by 2 to the power of BR + 1. [RM0008 25.5.1]
  [[nodiscard]] base::Result<std::uint32_t> divider_for(std::uint32_t highest_hz) const noexcept {
    for (std::uint32_t br = 0; br < 8; ++br)
      if (bus_->clock_hz >> (br + 1) <= highest_hz) return br;
    return base::Error::out_of_range;
  }

  SpiBus* bus_;
  ioportid_t port_;
  std::uint8_t pad_;
};
static_assert(drivers::Spi<SpiDevice>);

}  // namespace ocm::firmware::chibios::stm32
