#include "firmware/chibios/stm32/watchdog.hpp"

#include <cstdint>
#include <hal.h>

#include "firmware/chibios/fault.hpp"
#include "firmware/chibios/stm32/watchdog_turns.hpp"

namespace ocm::firmware::chibios::stm32 {
namespace {

constexpr std::uint32_t interrupt_number = 0;    // of both chips [RM0008 table 63, RM0090 table 62]
constexpr std::uint32_t interrupt_priority = 0;  // before the kernel's own, whose lock does not hold it up

constexpr std::uint32_t activate = 1U << 7;  // WDGA, of CR
constexpr std::uint32_t slowest = 3U << 7;   // WDGTB, of CFR: divided by 8
constexpr std::uint32_t window = 0x7F;       // of CFR: may be fed at any time
constexpr std::uint32_t early = 1U << 9;     // EWI, of CFR

constexpr std::uint32_t turns = WatchdogTurns::turns_in(watchdog_patience, STM32_PCLK1);
static_assert(WatchdogTurns::turn(STM32_PCLK1) * turns > std::chrono::milliseconds{380});

constinit WatchdogTurns watchdog;

/// The bootloader's functions write where our variables are. So whether they run is read from the interrupt
/// controller: the programming UART is listened to in all other times.
[[nodiscard]] bool shutting_down() noexcept {
  return (NVIC->ISER[STM32_USART1_NUMBER / 32] & 1U << STM32_USART1_NUMBER % 32) == 0;
}

void turn_over() noexcept {
  WWDG->SR = 0;
  if (!shutting_down() && !watchdog.next(turns)) rest_and_restart(ResetCause::watchdog);
  WWDG->CR = activate | WatchdogTurns::reload;
}

}  // namespace

void start_watchdog() noexcept {
  RCC->APB1ENR |= RCC_APB1ENR_WWDGEN;
  // It waits while a debugger holds the core.
#if defined(STM32F103xE)
  DBGMCU->CR |= DBGMCU_CR_DBG_WWDG_STOP;
#else
  DBGMCU->APB1FZ |= DBGMCU_APB1_FZ_DBG_WWDG_STOP;
#endif
  WWDG->CR = activate | WatchdogTurns::reload;
  WWDG->CFR = early | slowest | window;
  nvicEnableVector(interrupt_number, interrupt_priority);
}

void feed_watchdog() noexcept {
  watchdog.fed();
}

void leave_only_watchdog() noexcept {
  __disable_irq();
  for (std::uint32_t i = 0; i < 3; ++i) NVIC->ICER[i] = i == 0 ? ~(1U << interrupt_number) : ~0U;
  SysTick->CTRL = 0;
  SCB->ICSR = SCB_ICSR_PENDSVCLR_Msk;
  __enable_irq();
}

}  // namespace ocm::firmware::chibios::stm32

extern "C" {

/// Above the kernel's priorities: no prologue of its, and no call of it.
PORT_FAST_IRQ_HANDLER(Vector40) {
  ocm::firmware::chibios::stm32::turn_over();
}
}
