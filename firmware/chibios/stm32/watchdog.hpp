/// The chip's window watchdog: a board whose levels do not all run, or that hangs with interrupts off, is
/// restarted with its actuators at rest. Once started it stops only with the chip.
#pragma once

#include <chrono>

#include "ocm/base/time.hpp"

namespace ocm::firmware::chibios::stm32 {

/// So long the levels may be without a sign: a little less, since turns are whole. More than four times the
/// time in which they are called up (port.hpp).
inline constexpr base::Duration watchdog_patience = std::chrono::milliseconds{410};

/// From now on every level has to run. With the kernel running.
void start_watchdog() noexcept;

/// Every level has run since the last time.
void feed_watchdog() noexcept;

/// All interrupts off but the watchdog's, which from now on asks for nothing: for the bootloader's functions,
/// which take seconds, and at whose end the chip sleeps. In an interrupt.
void leave_only_watchdog() noexcept;

}  // namespace ocm::firmware::chibios::stm32
