#include "firmware/chibios/stm32/chip.hpp"

#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "firmware/chibios/fault.hpp"
#include "firmware/stm32/fixture.hpp"

namespace firmware_stm32_chip_test {

using namespace ocm::stm32_tests;
using namespace ocm::firmware::chibios;

TEST_CASE("chip: pins before drivers, drivers before the kernel, and a crystal that is watched") {
  Chip played;
  stm32::start_chip(PALConfig{});
  CHECK(played.calls == std::vector<std::string>{"dma", "pins", "i2c", "spi", "timer", "kernel"});
  CHECK((RCC->CR & RCC_CR_CSSON) != 0);
  CHECK((RCC->APB1ENR & RCC_APB1ENR_PWREN) != 0);
#if defined(STM32F103xE)
  // SWD stays for a debugger; 10 of SWJ_CFG. [RM0008 9.4.2]
  CHECK(AFIO->MAPR ==
        (AFIO_MAPR_SWJ_CFG_1 | AFIO_MAPR_TIM2_REMAP_0 | AFIO_MAPR_TIM3_REMAP | AFIO_MAPR_I2C1_REMAP));
#endif
}

TEST_CASE("chip: why it started is what the program before it noted, or else what the chip says") {
  Chip played;
  RCC->CSR = 1U << 26U;  // of the pin, on both chips [RM0008 7.3.10, RM0090 7.3.21]
  played.noted = ResetCause::watchdog;
  CHECK(stm32::reset_cause() == ResetCause::watchdog);
  CHECK(stm32::reset_cause() == ResetCause::pin);  // the note is of one start
  RCC->CSR = 0;
#if defined(STM32F103xE)
  CHECK(stm32::reset_cause() == ResetCause::unknown);
#else
  RTC->BKP0R = 0x20U << 16;  // its bootloader's copy
  CHECK(stm32::reset_cause() == ResetCause::pin);
#endif
}

TEST_CASE("chip: a restart is one that its bootloader takes for a restart") {
  Chip played;
  CHECK(ends([] { restart(ResetCause::watchdog); }));
  CHECK(played.calls == std::vector<std::string>{"reset"});
#if !defined(STM32F103xE)
  CHECK(RTC->BKP0R == 0x04);
  CHECK((PWR->CR & PWR_CR_DBP) != 0);
  CHECK((RCC->APB1ENR & RCC_APB1ENR_PWREN) != 0);
#endif
}

}  // namespace firmware_stm32_chip_test
