/// The first steps of a program behind the robot's bootloader, and the last.
///
/// ChibiOS's halInit() is not used: it resets every peripheral, ports included, and on PowerManagement the
/// ports hold up the power of the other two boards; and it may clear the backup registers, in which that
/// board's bootloader keeps why it was reset. [ChibiOS hal_lld.c; AMiRo-BLT main.c]
#pragma once

#include "firmware/chibios/stm32/bootloader.hpp"
#include "firmware/chibios/stm32/pins.hpp"

namespace ocm::firmware::chibios::stm32 {

/// Pins, buses' drivers, system timer, kernel. First thing in main(); clocks run since before.
void start_chip(const PALConfig& pins) noexcept;

/// What is known of why this program started: first the note of the program before it (fault.hpp), then the
/// chip's flags. The bootloader of the F103 boards clears the flags before they can be read; that of
/// PowerManagement keeps a copy. To be asked once.
[[nodiscard]] ResetCause reset_cause() noexcept;

/// Resets this chip in a way that its bootloader takes for a restart: that of PowerManagement blinks SOS for
/// ever after any other reset by software. [AMiRo-BLT PowerManagement main.c, handleSoftwareReset]
[[noreturn]] void restart_chip() noexcept;

}  // namespace ocm::firmware::chibios::stm32
