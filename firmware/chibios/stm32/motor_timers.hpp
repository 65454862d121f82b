/// drivers::MotorTimers of DiWheelDrive on TIM2 (duty), TIM3 (left encoder) and TIM4 (right encoder) of the
/// STM32F103. [AMiRo-OS DiWheelDrive: global.hpp, board.h, board.c; MotorControl.cpp]
///
/// A motor hangs between two outputs; one has the duty, the other is low. 20 kHz, 3600 steps.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/drivers/bus.hpp"

namespace ocm::firmware::chibios::stm32 {

class MotorTimers {
 public:
  /// Motors without voltage, counters from 0. With the pins set up.
  void start() noexcept;
  [[nodiscard]] std::array<std::uint16_t, 2> encoders() noexcept;
  void set_duty(std::int16_t left, std::int16_t right) noexcept;
  /// No voltage, at once: for a program that cannot go on. Needs no object.
  static void stop() noexcept;
};
static_assert(drivers::MotorTimers<MotorTimers>);

}  // namespace ocm::firmware::chibios::stm32
