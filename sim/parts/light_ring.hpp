/// The parts of LightRing as register models in a world.
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/samples.hpp"
#include "sim/amiro/world.hpp"
#include "sim/parts/board_parts.hpp"
#include "sim/parts/tlc5947_model.hpp"

namespace ocm::sim {

/// Numbers of devices and pins: boards/light_ring/parts.hpp, wiring.
class LightRingParts : public BoardParts {
 public:
  /// The world must outlive the parts.
  explicit LightRingParts(World& world)
      : lights(violations_, [&world](std::size_t light,
                                     firmware::boards::Colour colour) { world.set_light(light, colour); }),
        outputs_([this](std::uint8_t levels) { lights.set_blank((levels & 0x01) != 0); }) {}

  [[nodiscard]] SpiDevice& spi(std::uint8_t device) override {
    if (device == 1) return lights;
    return BoardParts::spi(device);
  }
  [[nodiscard]] OutputPins& outputs() override { return outputs_; }

  Tlc5947Model lights;

 private:
  OutputPins outputs_;
};

}  // namespace ocm::sim
