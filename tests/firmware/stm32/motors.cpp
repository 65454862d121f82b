#include <array>
#include <cstdint>

#include <catch2/catch.hpp>

#include "firmware/chibios/stm32/motor_timers.hpp"
#include "firmware/stm32/fixture.hpp"

namespace firmware_stm32_motors_test {

using namespace ocm::stm32_tests;
using ocm::firmware::chibios::stm32::MotorTimers;
namespace drivers = ocm::firmware::drivers;

std::array<std::uint32_t, 4> widths() {
  return {TIM2->CCR1, TIM2->CCR2, TIM2->CCR3, TIM2->CCR4};
}

TEST_CASE("motor timers: 20 kHz on four outputs without voltage, and counters of both edges from 0") {
  Chip played;
  // What the bootloader may have left.
  TIM2->PSC = 9;
  TIM2->CCR1 = TIM2->CCR4 = 77;
  TIM3->CCER = TIM4->CCER = TIM_CCER_CC1P;
  TIM3->CNT = TIM4->CNT = 5;
  MotorTimers timers;
  timers.start();

  CHECK((RCC->APB1ENR & (RCC_APB1ENR_TIM2EN | RCC_APB1ENR_TIM3EN | RCC_APB1ENR_TIM4EN)) ==
        (RCC_APB1ENR_TIM2EN | RCC_APB1ENR_TIM3EN | RCC_APB1ENR_TIM4EN));
  CHECK(72'000'000 / ((TIM2->PSC + 1) * (TIM2->ARR + 1)) == 20'000);
  CHECK(widths() == std::array<std::uint32_t, 4>{0, 0, 0, 0});
  // PWM mode 1 is 110 of OC1M to OC4M; a new width counts from the next period on. [RM0008 15.4.7]
  constexpr std::uint32_t pwm = TIM_CCMR1_OC1M_2 | TIM_CCMR1_OC1M_1 | TIM_CCMR1_OC1PE | TIM_CCMR1_OC2M_2 |
                                TIM_CCMR1_OC2M_1 | TIM_CCMR1_OC2PE;
  CHECK(TIM2->CCMR1 == pwm);
  CHECK(TIM2->CCMR2 == pwm);
  CHECK(TIM2->CCER == (TIM_CCER_CC1E | TIM_CCER_CC2E | TIM_CCER_CC3E | TIM_CCER_CC4E));
  CHECK(TIM2->CR1 == (TIM_CR1_ARPE | TIM_CR1_CEN));
  for (const TIM_TypeDef* const encoder : {TIM3, TIM4}) {
    CHECK(encoder->SMCR == (TIM_SMCR_SMS_1 | TIM_SMCR_SMS_0));  // encoder mode 3: both edges of both inputs
    CHECK(encoder->CCMR1 == (TIM_CCMR1_CC1S_0 | TIM_CCMR1_CC2S_0));
    CHECK(encoder->CCER == 0);
    CHECK(encoder->ARR == 0xFFFF);
    CHECK(encoder->CNT == 0);
    CHECK(encoder->CR1 == TIM_CR1_CEN);
  }
}

TEST_CASE("motor timers: a motor hangs between two outputs, one of which is low") {
  Chip played;
  MotorTimers timers;
  timers.start();
  constexpr auto full = drivers::full_duty;
  constexpr auto half = static_cast<std::int16_t>((full + 1) / 2);
  timers.set_duty(full, static_cast<std::int16_t>(-full));
  CHECK(widths() == std::array<std::uint32_t, 4>{3600, 0, 0, 3600});
  timers.set_duty(static_cast<std::int16_t>(-half), half);
  CHECK(widths() == std::array<std::uint32_t, 4>{0, 1800, 1800, 0});
  timers.set_duty(0, 0);
  CHECK(widths() == std::array<std::uint32_t, 4>{0, 0, 0, 0});
}

TEST_CASE("motor timers: to stop is to stop within this period") {
  Chip played;
  MotorTimers timers;
  timers.start();
  timers.set_duty(1000, 1000);
  TIM2->EGR = 0;
  MotorTimers::stop();
  CHECK(widths() == std::array<std::uint32_t, 4>{0, 0, 0, 0});
  CHECK(TIM2->EGR == TIM_EGR_UG);
}

TEST_CASE("motor timers: the left encoder is TIM3, the right one TIM4") {
  Chip played;
  MotorTimers timers;
  timers.start();
  TIM3->CNT = 0xFFFE;
  TIM4->CNT = 3;
  CHECK(timers.encoders() == std::array<std::uint16_t, 2>{0xFFFE, 3});
}

}  // namespace firmware_stm32_motors_test
