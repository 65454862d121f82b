#include "firmware/boards/power_management/board.hpp"
#include "firmware/boards/power_management/costs.hpp"
#include "firmware/boards/power_management/parts.hpp"
#include "firmware/chibios/fault.hpp"
#include "firmware/chibios/port.hpp"
#include "firmware/qemu/machine.hpp"
#include "firmware/qemu/main.hpp"
#include "firmware/qemu/parts_link.hpp"

namespace qemu = ocm::firmware::qemu;
namespace power_management = ocm::firmware::boards::power_management;
namespace wiring = power_management::wiring;

void ocm::firmware::chibios::bring_to_rest() noexcept {}  // nothing of this board moves or shines

int main() {
  qemu::start_machine();
  static qemu::Machine machine;
  static qemu::LinkI2c back{machine.link, wiring::back_i2c};
  static qemu::LinkI2c front{machine.link, wiring::front_i2c};
  static qemu::LinkInputs pins{machine.link, 0};
  static power_management::Parts<qemu::LinkI2c, qemu::LinkI2c, qemu::LinkInputs,
                                 ocm::firmware::chibios::Mutex>
      parts{back, front, pins};
  qemu::run<amiro::PowerManagement, power_management::Board, power_management::Costs>(machine, parts);
}
