/// Model of the I2C multiplexer PCA9544A with what is behind it. [data sheet: TI PCA9544A, SCPS146D]
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/parts/i2c_bus.hpp"
#include "sim/parts/violations.hpp"

namespace ocm::sim {

class Pca9544Model : public I2cPart {
 public:
  explicit Pca9544Model(Violations& violations)
      : I2cPart(0x77),
        violations_(&violations),
        channels_{I2cBus{violations}, I2cBus{violations}, I2cBus{violations}, I2cBus{violations}} {}

  [[nodiscard]] I2cBus& channel(std::size_t number) { return channels_[number]; }

  void find(std::uint8_t address7, std::vector<I2cPart*>& found) override {
    I2cPart::find(address7, found);
    if (present() && (control_ & 0x04) != 0) channels_[control_ & 0x03].find(address7, found);
  }
  bool write(std::span<const std::uint8_t> bytes) override {
    for (const std::uint8_t value : bytes) {
      if ((value & 0xF8) != 0) violations_->add("PCA9544A: bits 7 to 3 can only be read");
      next_ = value & 0x07;
    }
    return true;
  }
  void read(std::span<std::uint8_t> bytes) override {
    for (std::uint8_t& byte : bytes) byte = control_;
  }
  /// A channel is connected after the STOP, not before.
  void stop() override { control_ = next_; }

 private:
  void power_up() override { control_ = next_ = 0; }

  Violations* violations_;
  std::array<I2cBus, 4> channels_;
  std::uint8_t control_ = 0;  // power-up: no channel
  std::uint8_t next_ = 0;
};

}  // namespace ocm::sim
