/// What the boards say to each other beside CAN: SYS_SYNC_N, low while any board is busy; SYS_PD_N, low when
/// any board requests the robot off or restarted. And the programming UART, on which the flashing tool says
/// hello. [AMiRo-BLT main.c of each board; AMiRo-OS main.cpp]
///
/// When a shutdown or restart is requested nothing of ours runs on but the watchdog's interrupt: the
/// actuators are brought to rest (fault.hpp), then the bootloader has the chip, and does not come back.
#pragma once

#include <cstdint>
#include <hal.h>

#include "firmware/chibios/stm32/bootloader.hpp"

namespace ocm::firmware::chibios::stm32 {

struct SignalPins {
  ioportid_t sync_port;
  std::uint8_t sync_pad;
  std::uint8_t power_down_pad;  ///< on port C of all three boards
  char power_down_port = 'C';
};

/// The programming UART, USART1 on all three boards.
inline constexpr std::uint32_t prog_bit_rate = 115'200;  ///< [AMiRo-OS bootloader.mk, FLASH_BAUDRATE]
#if defined(STM32F103xE)
inline constexpr std::uint32_t prog_clock_hz = 72'000'000;  ///< APB2, undivided
#else
inline constexpr std::uint32_t prog_clock_hz = 84'000'000;
#endif

/// From now on SYS_PD_N and the UART are obeyed.
void obey_shutdown(const SignalPins& pins) noexcept;

/// From now on the UART's interrupt calls `interrupt` instead of only listening. It must call `heed` with
/// each byte, as it comes: the flashing tool is obeyed whatever else is said on the line.
void share_programming_uart(void (*interrupt)()) noexcept;
void heed(std::uint8_t byte) noexcept;

/// Lets SYS_SYNC_N go: this board is ready. Other boards' programs wait for it.
void say_ready() noexcept;

/// Into the bootloader, with all boards. By the bootloader's own function; where its table is not one that we
/// know, by a reset of this chip.
[[noreturn]] void shut_down(Shutdown kind) noexcept;

}  // namespace ocm::firmware::chibios::stm32
