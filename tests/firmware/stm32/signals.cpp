#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "firmware/chibios/stm32/board_signals.hpp"
#include "firmware/stm32/fixture.hpp"

namespace firmware_stm32_signals_test {

using namespace ocm::stm32_tests;
using namespace ocm::firmware::chibios;

const std::vector<std::string> into_the_bootloader{"interrupts off", "interrupts on", "rest", "reset"};

TEST_CASE("signals: a falling edge of SYS_PD_N, and each byte on the programming UART, interrupt") {
  for (const std::uint8_t pad : {std::uint8_t{8}, std::uint8_t{14}}) {
    Chip played;
#if defined(STM32F103xE)
    volatile std::uint32_t* const choices = AFIO->EXTICR;
#else
    volatile std::uint32_t* const choices = SYSCFG->EXTICR;
#endif
    for (int i = 0; i < 4; ++i) choices[i] = 0x1111;
    stm32::obey_shutdown({.sync_port = GPIOC, .sync_pad = 1, .power_down_pad = pad});
    CAPTURE(pad);
    // Port C is 2, in the nibble of the line; its neighbours keep theirs. [RM0008 9.4.3, RM0090 9.2.3]
    CHECK(choices[2] == (pad == 8 ? 0x1112 : 0x1111));
    CHECK(choices[3] == (pad == 14 ? 0x1211 : 0x1111));
    CHECK(EXTI->FTSR == 1U << pad);
    CHECK(EXTI->RTSR == 0);
    CHECK(EXTI->IMR == 1U << pad);
    CHECK(EXTI->PR == 1U << pad);  // an edge of before is forgotten
    CHECK(played.enabled(EXTI9_5_IRQn) == (pad == 8));
    CHECK(played.enabled(EXTI15_10_IRQn) == (pad == 14));
    CHECK(played.priorities[pad == 8 ? EXTI9_5_IRQn : EXTI15_10_IRQn] == 13);
    CHECK((RCC->APB2ENR & RCC_APB2ENR_USART1EN) != 0);
    CHECK(USART1->CR1 == (USART_CR1_UE | USART_CR1_RE | USART_CR1_TE | USART_CR1_RXNEIE));
    // 72 and 84 MHz by 115200: 625 and 729.2. [RM0008 27.3.4]
#if defined(STM32F103xE)
    CHECK(USART1->BRR == 625);
#else
    CHECK(USART1->BRR == 729);
    CHECK((RCC->APB2ENR & RCC_APB2ENR_SYSCFGEN) != 0);
#endif
    CHECK(played.enabled(USART1_IRQn));
    CHECK(played.priorities[USART1_IRQn] == 13);
  }
}

TEST_CASE("signals: who asks for the robot off has the actuators at rest, and then the bootloader") {
  Chip played;
  stm32::obey_shutdown({.sync_port = GPIOC, .sync_pad = 1, .power_down_pad = 14});
  EXTI->PR = 1U << 13;  // another line's
  CHECK(!ends([] { VectorE0(); }));
  CHECK(EXTI->PR == 1U << 13);
  EXTI->PR = 1U << 14;
  CHECK(ends([] { VectorE0(); }));
  CHECK(EXTI->PR == 1U << 14);  // taken back by writing it
  // There is no table of a bootloader here: this chip is reset.
  CHECK(played.calls == into_the_bootloader);
}

TEST_CASE(
    "signals: the flashing tool's three bytes restart the robot, also beside another talk on the line") {
  for (const bool shared : {false, true}) {
    Chip played;
    if (shared)
      stm32::share_programming_uart([] { stm32::heed(static_cast<std::uint8_t>(USART1->DR)); });
    else
      stm32::share_programming_uart(nullptr);
    const auto hear = [](std::uint8_t byte) {
      USART1->SR = USART_SR_RXNE;
      USART1->DR = byte;
      return ends([] { VectorD4(); });
    };
    for (const std::uint8_t byte : std::array<std::uint8_t, 7>{0x02, 0xFF, 0x01, 0xFF, 0x00, 0x02, 0xFF})
      CHECK(!hear(byte));
    CHECK(hear(0x00));
    CHECK(played.calls == into_the_bootloader);
  }
  stm32::share_programming_uart(nullptr);
}

TEST_CASE("signals: an interrupt without a byte is no byte") {
  Chip played;
  USART1->SR = USART_SR_ORE;
  for (const std::uint32_t byte : {0x02U, 0xFFU, 0x00U}) {
    USART1->DR = byte;
    CHECK(!ends([] { VectorD4(); }));
  }
}

TEST_CASE("signals: a board that is ready lets SYS_SYNC_N go") {
  Chip played;
  stm32::obey_shutdown({.sync_port = GPIOC, .sync_pad = 1, .power_down_pad = 14});
  CHECK(played.calls.empty());
  stm32::say_ready();
  CHECK(played.calls == std::vector<std::string>{"C1 high"});
}

}  // namespace firmware_stm32_signals_test
