/// The parts of PowerManagement as register models in a world.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "firmware/boards/samples.hpp"
#include "sim/amiro/world.hpp"
#include "sim/parts/at24c01b_model.hpp"
#include "sim/parts/board_parts.hpp"
#include "sim/parts/bq27500_model.hpp"
#include "sim/parts/pca9544_model.hpp"
#include "sim/parts/stored_calibration.hpp"
#include "sim/parts/vcnl4020_model.hpp"

namespace ocm::sim {

/// One of two equal batteries, as its gauge sees it while the world's reading is of both.
[[nodiscard]] inline GaugeState half_of(const World& world, bool larger_half) {
  const firmware::boards::GaugeReading both = *world.gauge();
  const firmware::boards::BatteryReading own = (*world.batteries())[larger_half ? 0 : 1];
  GaugeState state;
  state.voltage_mv = own.voltage_mv;
  state.current_ma = own.current_ma;
  state.remaining_mah = own.remaining_mah;
  state.temperature_dk = own.temperature_dk;
  const int half = both.power_mw / 2;
  state.power_mw = static_cast<std::int16_t>(larger_half ? both.power_mw - half : half);
  state.state_of_charge_percent = both.state_of_charge_percent;
  state.full = both.plugged && !both.charging;
  (both.charging ? state.minutes_to_full : state.minutes_to_empty) = both.minutes;
  return state;
}

/// Numbers of buses and pins: boards/power_management/parts.hpp, wiring.
class PowerManagementParts : public BoardParts {
 public:
  /// The world must outlive the parts. The EEPROM holds the offsets of the world's ring.
  PowerManagementParts(World& world, const PartClock& now)
      : back_multiplexer(violations_),
        front_multiplexer(violations_),
        gauge_p7(violations_, [&world] { return half_of(world, true); }),
        gauge_p8(violations_, [&world] { return half_of(world, false); }),
        ring{sensor(world, now, 0), sensor(world, now, 1), sensor(world, now, 2), sensor(world, now, 3),
             sensor(world, now, 4), sensor(world, now, 5), sensor(world, now, 6), sensor(world, now, 7)},
        eeprom(violations_, now),
        inputs_([&world] { return static_cast<std::uint8_t>(world.battery().plugged() ? 0x01 : 0x00); }) {
    gauge_p7.set_presence([&world] { return world.gauge().ok(); });
    gauge_p8.set_presence([&world] { return world.gauge().ok(); });
    for (Vcnl4020Model& each : ring) each.set_presence([&world] { return world.ring().ok(); });
    // Around the robot, from the back on the left clockwise. [AMiRo-OS 1.0, PowerManagement: global.hpp]
    back_multiplexer.channel(1).attach(ring[0]);
    back_multiplexer.channel(3).attach(ring[1]);
    back_multiplexer.channel(2).attach(ring[2]);
    front_multiplexer.channel(0).attach(ring[3]);
    front_multiplexer.channel(1).attach(ring[4]);
    front_multiplexer.channel(3).attach(ring[5]);
    front_multiplexer.channel(2).attach(ring[6]);
    back_multiplexer.channel(0).attach(ring[7]);
    back_bus_.attach(back_multiplexer);
    back_bus_.attach(gauge_p8);
    front_bus_.attach(front_multiplexer);
    front_bus_.attach(gauge_p7);
    front_bus_.attach(eeprom);
    store_calibration(eeprom, world.ring_offset());
  }

  [[nodiscard]] I2cBus& i2c(std::uint8_t bus) override {
    return bus == 1 ? back_bus_ : bus == 2 ? front_bus_ : BoardParts::i2c(bus);
  }
  [[nodiscard]] InputPins& inputs() override { return inputs_; }

  Pca9544Model back_multiplexer;
  Pca9544Model front_multiplexer;
  Bq27500Model gauge_p7;
  Bq27500Model gauge_p8;
  std::array<Vcnl4020Model, 8> ring;
  At24c01bModel eeprom;

 private:
  [[nodiscard]] Vcnl4020Model sensor(World& world, const PartClock& now, std::size_t i) {
    return Vcnl4020Model{violations_, now, [&world, i] { return (*world.ring())[i]; },
                         [&world, i] { return (*world.ring_light())[i]; }};
  }

  I2cBus back_bus_{violations_};
  I2cBus front_bus_{violations_};
  InputPins inputs_;
};

}  // namespace ocm::sim
