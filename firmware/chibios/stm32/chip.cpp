#include "firmware/chibios/stm32/chip.hpp"

#include <ch.h>
#include <hal.h>

#include "firmware/chibios/fault.hpp"

namespace ocm::firmware::chibios::stm32 {

void start_chip(const PALConfig& pins) noexcept {
  RCC->CR |= RCC_CR_CSSON;  // a crystal that stops is an NMI, and the chip goes on with its own oscillator
  rccEnablePWRInterface(FALSE);
  dmaInit();
  palInit(&pins);
#if defined(STM32F103xE)
  // TIM2 on PA15, PB3, PA2, PA3; TIM3 on PC6, PC7; I2C1 on PB8, PB9; JTAG off, for PA15 and PB3, and SWD on.
  // The boards that lack these parts have nothing else there. [RM0008 9.3; AMiRo-OS board.c]
  AFIO->MAPR = AFIO_MAPR_SWJ_CFG_JTAGDISABLE | AFIO_MAPR_TIM2_REMAP_PARTIALREMAP1 |
               AFIO_MAPR_TIM3_REMAP_FULLREMAP | AFIO_MAPR_I2C1_REMAP;
#endif
  i2cInit();
  spiInit();
  stInit();
  chSysInit();
}

ResetCause reset_cause() noexcept {
  if (const ResetCause noted = take_noted_cause(); noted != ResetCause::unknown) return noted;
  const ResetCause cause = cause_in_csr(RCC->CSR);
#if !defined(STM32F103xE)
  if (cause == ResetCause::unknown) return cause_in_backup(RTC->BKP0R);
#endif
  return cause;
}

void restart_chip() noexcept {
#if !defined(STM32F103xE)
  constexpr std::uint32_t restart = 0x04;  // shutdown_pri_reason, the lowest byte [amiroblt.h]
  RCC->APB1ENR |= RCC_APB1ENR_PWREN;       // a fault may come before start_chip()
  PWR->CR |= PWR_CR_DBP;
  RTC->BKP0R = restart;
#endif
  NVIC_SystemReset();
  for (;;) {
  }
}

}  // namespace ocm::firmware::chibios::stm32

void ocm::firmware::chibios::restart(ResetCause /*cause*/) noexcept {
  stm32::restart_chip();
}

extern "C" {

/// Called by the start-up code before anything is in RAM.
void __early_init() {
  stm32_clock_init();
}
}
