#include "firmware/chibios/stm32/watchdog.hpp"

#include <cstdint>

#include <catch2/catch.hpp>

#include "firmware/chibios/stm32/watchdog_turns.hpp"
#include "firmware/stm32/fixture.hpp"

namespace firmware_stm32_watchdog_test {

using namespace ocm::stm32_tests;
using namespace ocm::firmware::chibios;

constexpr std::uint32_t full_count = WWDG_CR_WDGA | 0x7F;
/// By hand: 4096 * 8 / 36 MHz is 0.91 ms a count, 57.3 ms a turn of 63: 7 in 410 ms. At 42 MHz 49.2 ms: 8.
#if defined(STM32F103xE)
constexpr int turns = 7;
#else
constexpr int turns = 8;
#endif

/// A watchdog that was just fed, in a program that listens to the programming UART.
void begin() {
  stm32::start_watchdog();
  stm32::feed_watchdog();
  nvicEnableVector(STM32_USART1_NUMBER, 13);
}
/// The early interrupt: false where the program ends.
bool turn() {
  WWDG->CR = WWDG_CR_WDGA | 0x40;
  WWDG->SR = WWDG_SR_EWIF;
  const bool ended = ends([] { Vector40(); });
  if (!ended) {
    CHECK(WWDG->SR == 0);
    CHECK(WWDG->CR == full_count);
  }
  return !ended;
}

TEST_CASE(
    "watchdog: it counts as slowly as it can, may be fed at any time, and interrupts ahead of the kernel") {
  Chip played;
  stm32::start_watchdog();
  CHECK((RCC->APB1ENR & RCC_APB1ENR_WWDGEN) != 0);
  CHECK(WWDG->CR == full_count);
  CHECK(WWDG->CFR == (WWDG_CFR_EWI | WWDG_CFR_WDGTB | WWDG_CFR_W));  // divided by 8; the window is all of it
  CHECK(played.enabled(WWDG_IRQn));
  CHECK(played.priorities[WWDG_IRQn] == 0);
#if defined(STM32F103xE)
  CHECK(DBGMCU->CR == DBGMCU_CR_DBG_WWDG_STOP);
#else
  CHECK(DBGMCU->APB1FZ == DBGMCU_APB1_FZ_DBG_WWDG_STOP);
#endif
}

TEST_CASE(
    "watchdog: without a sign of the levels the program ends in an orderly way, and the count runs on") {
  Chip played;
  begin();
  for (int n = 1; n < turns; ++n) REQUIRE(turn());
  CHECK(!turn());
  CHECK(played.calls == std::vector<std::string>{"rest and restart 4"});
  CHECK(WWDG->CR == (WWDG_CR_WDGA | 0x40));  // not fed: if that hangs, too, the chip resets itself
}

TEST_CASE("watchdog: a sign of the levels buys all turns again") {
  Chip played;
  begin();
  for (int round = 0; round < 3; ++round) {
    for (int n = 1; n < turns; ++n) REQUIRE(turn());
    stm32::feed_watchdog();
  }
  CHECK(played.calls.empty());
}

TEST_CASE("watchdog: the bootloader's functions have the time that they take") {
  Chip played;
  begin();
  nvicEnableVector(WWDG_IRQn + 32, 5);
  NVIC->ISER[STM32_USART1_NUMBER / 32] = 0;  // what leave_only_watchdog's write to ICER does in a chip
  for (int n = 0; n < 10 * turns; ++n) REQUIRE(turn());
  CHECK(played.calls.empty());
}

TEST_CASE("watchdog: its interrupt is the only one that is left, and no switch of threads waits") {
  Chip played;
  stm32::leave_only_watchdog();
  CHECK(NVIC->ICER[0] == ~1U);
  CHECK(NVIC->ICER[1] == ~0U);
  CHECK(NVIC->ICER[2] == ~0U);
  CHECK(SysTick->CTRL == 0);
  CHECK(SCB->ICSR == SCB_ICSR_PENDSVCLR_Msk);
  CHECK(played.calls == std::vector<std::string>{"interrupts off", "interrupts on"});
}

}  // namespace firmware_stm32_watchdog_test
