#include "firmware/chibios/stm32/motor_timers.hpp"

#include <hal.h>

namespace ocm::firmware::chibios::stm32 {
namespace {

constexpr std::uint32_t timer_clock_hz = 72'000'000;  // twice APB1 [RM0008 7.2]
constexpr std::uint32_t pwm_hz = 20'000;              // above hearing; AMiRo-OS: 7.2 MHz / 360
constexpr std::uint16_t period = timer_clock_hz / pwm_hz;
static_assert(period == 3600);

// PWM mode 1, compare values taken over at the end of a period: OC1M = OC2M = 110, preload. [RM0008 15.4.7]
constexpr std::uint16_t pwm_mode = 0b0110'1000'0110'1000;
constexpr std::uint16_t all_outputs = 0b0001'0001'0001'0001;

constexpr std::uint16_t width(std::int32_t duty) noexcept {
  return static_cast<std::uint16_t>(duty <= 0 ? 0 : duty * period / drivers::full_duty);
}
static_assert(width(drivers::full_duty) == period && width(-1) == 0);

// Counts each edge of both inputs; TI1 and TI2 as they come, so that forwards is up: AMiRo-OS inverts one and
// subtracts the other way round. [RM0008 15.3.12; AMiRo-OS MotorIncrements.cpp, MotorControl.cpp]
void start_encoder(TIM_TypeDef& timer) noexcept {
  timer.CR1 = 0;
  timer.ARR = 0xFFFF;
  timer.CCMR1 = 0x0101;  // each input on its own channel, no filter
  timer.CCER = 0;
  timer.SMCR = 3;
  timer.CNT = 0;
  timer.CR1 = 1;
}

}  // namespace

void MotorTimers::start() noexcept {
  rccEnableTIM2(FALSE);
  rccEnableTIM3(FALSE);
  rccEnableTIM4(FALSE);
  TIM_TypeDef& pwm = *TIM2;
  pwm.CR1 = 0;
  pwm.PSC = 0;
  pwm.ARR = period - 1;
  set_duty(0, 0);
  pwm.CCMR1 = pwm_mode;
  pwm.CCMR2 = pwm_mode;
  pwm.CCER = all_outputs;
  pwm.EGR = 1;     // takes the preloaded values over
  pwm.CR1 = 0x81;  // ARPE, CEN
  start_encoder(*TIM3);
  start_encoder(*TIM4);
}

std::array<std::uint16_t, 2> MotorTimers::encoders() noexcept {
  return {static_cast<std::uint16_t>(TIM3->CNT), static_cast<std::uint16_t>(TIM4->CNT)};
}

// Left is on channels 1 and 2 (PA15, PB3), right on 3 and 4 (PA2, PA3); forwards is the first of each.
void MotorTimers::set_duty(std::int16_t left, std::int16_t right) noexcept {
  TIM_TypeDef& pwm = *TIM2;
  pwm.CCR1 = width(left);
  pwm.CCR2 = width(-left);
  pwm.CCR3 = width(right);
  pwm.CCR4 = width(-right);
}

void MotorTimers::stop() noexcept {
  TIM_TypeDef& pwm = *TIM2;
  pwm.CCR1 = 0;
  pwm.CCR2 = 0;
  pwm.CCR3 = 0;
  pwm.CCR4 = 0;
  pwm.EGR = 1;  // now, and not at the end of the period
}

}  // namespace ocm::firmware::chibios::stm32
