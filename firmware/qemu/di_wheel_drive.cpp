#include <array>
#include <cstdint>

#include "firmware/boards/di_wheel_drive/board.hpp"
#include "firmware/boards/di_wheel_drive/costs.hpp"
#include "firmware/boards/di_wheel_drive/parts.hpp"
#include "firmware/chibios/fault.hpp"
#include "firmware/chibios/port.hpp"
#include "firmware/qemu/machine.hpp"
#include "firmware/qemu/main.hpp"
#include "firmware/qemu/parts_link.hpp"

namespace qemu = ocm::firmware::qemu;
namespace di_wheel_drive = ocm::firmware::boards::di_wheel_drive;
namespace wiring = di_wheel_drive::wiring;

void ocm::firmware::chibios::bring_to_rest() noexcept {
  constexpr std::array<std::uint8_t, 4> no_duty{};
  constexpr std::array<std::uint8_t, 1> no_power{};
  qemu::PartsLink::post_at_last({.kind = qemu::link::Kind::outputs, .written = no_power});
  qemu::PartsLink::post_at_last({.kind = qemu::link::Kind::set_duty, .written = no_duty});
}

int main() {
  qemu::start_machine();
  static qemu::Machine machine;
  static qemu::LinkI2c compass{machine.link, wiring::compass_i2c};
  static qemu::LinkI2c floor{machine.link, wiring::floor_i2c};
  static qemu::LinkSpi gyroscope{machine.link, wiring::gyroscope_spi};
  static qemu::LinkSpi accelerometer{machine.link, wiring::accelerometer_spi};
  static qemu::LinkMotorTimers motors{machine.link};
  static qemu::LinkOutputs pins{machine.link, 0};
  static di_wheel_drive::Parts<qemu::LinkI2c, qemu::LinkI2c, qemu::LinkSpi, qemu::LinkSpi,
                               qemu::LinkMotorTimers, qemu::LinkOutputs, ocm::firmware::chibios::Mutex>
      parts{compass, floor, gyroscope, accelerometer, motors, pins};
  qemu::run<amiro::DiWheelDrive, di_wheel_drive::Board, di_wheel_drive::Costs>(machine, parts);
}
