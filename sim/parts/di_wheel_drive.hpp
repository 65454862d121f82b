/// The parts of DiWheelDrive as register models in a world.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "sim/amiro/world.hpp"
#include "sim/parts/at24c01b_model.hpp"
#include "sim/parts/board_parts.hpp"
#include "sim/parts/hmc5883l_model.hpp"
#include "sim/parts/pca9544_model.hpp"
#include "sim/parts/st_motion_model.hpp"
#include "sim/parts/stored_calibration.hpp"
#include "sim/parts/vcnl4020_model.hpp"

namespace ocm::sim {

/// Numbers of buses and devices: boards/di_wheel_drive/parts.hpp, wiring.
class DiWheelDriveParts : public BoardParts {
 public:
  /// The world must outlive the parts. The EEPROM holds the offsets of the world's floor sensors.
  DiWheelDriveParts(World& world, const PartClock& now)
      : gyroscope(violations_, now, [&world] { return *world.gyroscope(); }),
        accelerometer(violations_, now, [&world] { return *world.accelerometer(); }),
        magnetometer(violations_, now, [&world] { return *world.magnetometer(); }),
        multiplexer(violations_),
        floor{Vcnl4020Model{violations_, now, [&world] { return (*world.raw_floor())[0]; }},
              Vcnl4020Model{violations_, now, [&world] { return (*world.raw_floor())[1]; }},
              Vcnl4020Model{violations_, now, [&world] { return (*world.raw_floor())[2]; }},
              Vcnl4020Model{violations_, now, [&world] { return (*world.raw_floor())[3]; }}},
        eeprom(violations_, now),
        motors_(world, violations_),
        outputs_([this](std::uint8_t levels) { motors_.set_power((levels & 0x01) != 0); }) {
    gyroscope.set_presence([&world] { return world.gyroscope().ok(); });
    accelerometer.set_presence([&world] { return world.accelerometer().ok(); });
    magnetometer.set_presence([&world] { return world.magnetometer().ok(); });
    compass_bus_.attach(magnetometer);
    floor_bus_.attach(multiplexer);
    floor_bus_.attach(eeprom);
    for (std::size_t i = 0; i < floor.size(); ++i) {
      floor[i].set_presence([&world] { return world.raw_floor().ok(); });
      multiplexer.channel(i).attach(floor[i]);
    }
    store_calibration(eeprom, world.options().floor.offset_counts);
  }

  [[nodiscard]] I2cBus& i2c(std::uint8_t bus) override {
    return bus == 1 ? compass_bus_ : bus == 2 ? floor_bus_ : BoardParts::i2c(bus);
  }
  [[nodiscard]] SpiDevice& spi(std::uint8_t device) override {
    if (device == 1) return gyroscope;
    if (device == 2) return accelerometer;
    return BoardParts::spi(device);
  }
  [[nodiscard]] MotorsModel& motors() override { return motors_; }
  [[nodiscard]] OutputPins& outputs() override { return outputs_; }

  L3g4200dModel gyroscope;
  Lis331dlhModel accelerometer;
  Hmc5883lModel magnetometer;
  Pca9544Model multiplexer;
  std::array<Vcnl4020Model, 4> floor;
  At24c01bModel eeprom;

 private:
  I2cBus compass_bus_{violations_};
  I2cBus floor_bus_{violations_};
  MotorsModel motors_;
  OutputPins outputs_;
};

}  // namespace ocm::sim
