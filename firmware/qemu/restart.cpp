// How a board of the robot's restarts in QEMU. The way here is that of the real boards: chibios/fault.cpp.
#include <ch.h>

#include "firmware/chibios/fault.hpp"
#include "firmware/qemu/machine.hpp"

void ocm::firmware::chibios::restart(ResetCause cause) noexcept {
  switch (cause) {
    case ResetCause::watchdog:
      qemu::say("restarts: watchdog\n");
      break;
    case ResetCause::kernel_halt:
      qemu::say("restarts: kernel halt\n");
      break;
    default:
      qemu::say("restarts: fault\n");
      break;
  }
  NVIC_SystemReset();
  for (;;) {
  }
}

extern "C" void abort() {
  ocm::firmware::chibios::rest_and_restart(ocm::firmware::chibios::ResetCause::fault);
}
