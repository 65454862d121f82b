#include <array>
#include <cstdint>

#include "firmware/boards/light_ring/board.hpp"
#include "firmware/boards/light_ring/costs.hpp"
#include "firmware/boards/light_ring/parts.hpp"
#include "firmware/chibios/fault.hpp"
#include "firmware/chibios/port.hpp"
#include "firmware/qemu/machine.hpp"
#include "firmware/qemu/main.hpp"
#include "firmware/qemu/parts_link.hpp"

namespace qemu = ocm::firmware::qemu;
namespace light_ring = ocm::firmware::boards::light_ring;
namespace wiring = light_ring::wiring;

void ocm::firmware::chibios::bring_to_rest() noexcept {
  constexpr std::array<std::uint8_t, 1> blank{wiring::blank_pin};
  qemu::PartsLink::post_at_last({.kind = qemu::link::Kind::outputs, .written = blank});
}

int main() {
  qemu::start_machine();
  static qemu::Machine machine;
  static qemu::LinkSpi lights{machine.link, wiring::lights_spi};
  static qemu::LinkOutputs pins{machine.link, 0};
  static light_ring::Parts<qemu::LinkSpi, qemu::LinkOutputs, ocm::firmware::chibios::Mutex> parts{lights,
                                                                                                  pins};
  qemu::run<amiro::LightRing, light_ring::Board, light_ring::Costs>(machine, parts);
}
