/// main() of an emulated board: parts on the link, bus on SLCAN, and the board between them. Each board has a
/// file that names its parts' buses and calls this.
#pragma once

#include "ocm/analysis/board_admission.hpp"
#include "ocm/base/time.hpp"
#include "ocm/controller/report.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/chibios/fault.hpp"
#include "firmware/chibios/load.hpp"
#include "firmware/chibios/port.hpp"
#ifdef OCM_FAULT_TEST
#include "firmware/qemu/fault_injection.hpp"
#endif
#include "firmware/qemu/machine.hpp"
#include "firmware/qemu/parts_link.hpp"
#include "firmware/qemu/slcan_bus.hpp"

namespace ocm::firmware::qemu {

/// What every emulated board stands on.
struct Machine {
  Uart can_line{1};
  Uart parts_line{PartsLink::uart_number};
  chibios::Port port;
  SlcanBus can{can_line, port};
  PartsLink link{parts_line};
};

/// From start_machine() to the board at work. `Type` is the board in the generated header, `Board` its
/// template, `Costs` what its admission reckons with; `parts` hang on the machine's link.
template <class Type, template <class, class, class, class> class Board, class Costs, class Parts>
[[noreturn]] void run(Machine& machine, Parts& parts) noexcept {
  machine.can.start();
  machine.link.start();
  parts.start(machine.port.now());
  using Admission = analysis::BoardAdmission<Type, amiro::bit_rate, Costs>;
  static Board<Parts, SlcanBus, chibios::Port, Admission> board{parts, machine.can, machine.port};
  static chibios::LoadMeter load{machine.port};
  // Without a note QEMU's machine has just been switched on: it has no register that would say so.
  static const chibios::ResetCause noted = chibios::take_noted_cause();
  static const chibios::ResetCause cause =
      noted == chibios::ResetCause::unknown ? chibios::ResetCause::power : noted;
  board.controller().report([] {
    controller::Health health;
    health.reset = static_cast<std::uint8_t>(cause);
    health.load = load.percent();
    return health;
  });
  static chibios::Runtime runtime{machine.port, board.controller(), machine.can};
#ifdef OCM_FAULT_TEST
  static FaultInjection injection{machine.link};
  injection.start();
  runtime.run(
      [](base::Time now) {
        load.look(now);
        board.maintain(now);
        injection.look(now);
      },
      [] { injection.feed(); });
#else
  runtime.run([](base::Time now) {
    load.look(now);
    board.maintain(now);
  });
#endif
}

}  // namespace ocm::firmware::qemu
