/// A model on SPI with its chip select, as the boards' bundles hand it out. It satisfies
/// firmware::drivers::Spi.
#pragma once

#include <cstdint>
#include <span>

#include "ocm/base/result.hpp"

#include "firmware/drivers/bus.hpp"

namespace ocm::sim {

class SpiDevice {
 public:
  SpiDevice() = default;
  virtual ~SpiDevice() = default;
  SpiDevice(const SpiDevice&) = delete;
  SpiDevice& operator=(const SpiDevice&) = delete;

  virtual base::Status transfer(const firmware::drivers::SpiSettings& settings,
                                std::span<const std::uint8_t> out, std::span<std::uint8_t> in) = 0;
};
static_assert(firmware::drivers::Spi<SpiDevice>);

/// A chip select without a part: the line is pulled up.
class NoSpiDevice : public SpiDevice {
 public:
  base::Status transfer(const firmware::drivers::SpiSettings&, std::span<const std::uint8_t>,
                        std::span<std::uint8_t> in) override {
    for (std::uint8_t& byte : in) byte = 0xFF;
    return {};
  }
};

}  // namespace ocm::sim
