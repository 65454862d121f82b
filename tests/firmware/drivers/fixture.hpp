/// What the tests of drivers share: a clock that is set by hand, and a look at what a model complained of.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"

#include "firmware/drivers/bus.hpp"
#include "sim/parts/i2c_bus.hpp"
#include "sim/parts/part_clock.hpp"
#include "sim/parts/spi_device.hpp"
#include "sim/parts/violations.hpp"

namespace drivers_tests {

using namespace std::chrono_literals;
using ocm::base::Error;

struct HandClock {
  ocm::base::Time now{};
  void pass(ocm::base::Duration duration) { now += duration; }
  [[nodiscard]] ocm::sim::PartClock clock() {
    return [this] { return now; };
  }
};

/// Some complaint has this in it.
inline bool complained(const ocm::sim::Violations& violations, const std::string& of) {
  return std::any_of(violations.texts().begin(), violations.texts().end(),
                     [&](const std::string& text) { return text.find(of) != std::string::npos; });
}

/// An SPI device whose frames a test may spoil on the way: a driver whose author read the data sheet
/// badly.
struct SpoiledSpi {
  ocm::sim::SpiDevice* device = nullptr;
  std::function<void(ocm::firmware::drivers::SpiSettings&, std::vector<std::uint8_t>&)> spoil;

  ocm::base::Status transfer(const ocm::firmware::drivers::SpiSettings& settings,
                             std::span<const std::uint8_t> out, std::span<std::uint8_t> in) {
    ocm::firmware::drivers::SpiSettings s = settings;
    std::vector<std::uint8_t> bytes(out.begin(), out.end());
    if (spoil) spoil(s, bytes);
    std::vector<std::uint8_t> answer(bytes.size());
    const auto done = device->transfer(s, bytes, answer);
    std::copy_n(answer.begin(), std::min(answer.size(), in.size()), in.begin());
    return done;
  }
};

/// The same on I2C.
struct SpoiledI2c {
  ocm::sim::I2cBus* bus = nullptr;
  std::function<void(std::uint8_t&, std::vector<std::uint8_t>&)> spoil;

  ocm::base::Status transfer(std::uint8_t address, std::span<const std::uint8_t> write,
                             std::span<std::uint8_t> read) {
    std::vector<std::uint8_t> bytes(write.begin(), write.end());
    if (spoil) spoil(address, bytes);
    return bus->transfer(address, bytes, read);
  }
};

}  // namespace drivers_tests
