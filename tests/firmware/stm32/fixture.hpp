/// A chip whose registers are memory, and ChibiOS's drivers, played: what is called is written down in order.
#pragma once

#include <csetjmp>
#include <cstdint>
#include <hal.h>
#include <string>
#include <vector>

#include "ocm/base/time.hpp"

#include "firmware/chibios/restart_note.hpp"

namespace ocm::stm32_tests {

/// The chip after a reset, with the registers that matter here at zero.
struct Chip {
  Chip();

  std::vector<std::string> calls;  ///< of the drivers that are played
  std::vector<std::uint32_t> priorities = std::vector<std::uint32_t>(128, no_priority);  ///< of interrupts
  static constexpr std::uint32_t no_priority = ~0U;
  firmware::chibios::ResetCause noted = firmware::chibios::ResetCause::unknown;

  // I2C: what the bus says to the next transfers, first to last, and then MSG_OK; `received` is what it
  // reads.
  std::vector<msg_t> answers;
  std::vector<std::uint8_t> received;
  i2cflags_t errors = 0;

  // CAN
  int resets = 0;         ///< of the controller
  base::Time now{};       ///< each wait of a thread takes as long as it may
  int waits_left = 1000;  ///< then the program of the test ends: it would wait for ever

  [[nodiscard]] bool enabled(std::uint32_t interrupt) const {
    return (NVIC->ISER[interrupt / 32] & 1U << interrupt % 32) != 0;
  }
  [[nodiscard]] std::size_t count(const std::string& call) const;
};
extern Chip* chip;  ///< the one of the test that runs

/// Runs what may end the program: true, and how, in `chip->calls`.
template <class Function>
[[nodiscard]] bool ends(Function&& run) {
  extern std::jmp_buf the_end;
  if (setjmp(the_end) != 0) return true;
  run();
  return false;
}

/// The handlers in the table of vectors. [ChibiOS vectors.c: by the offset of their place]
extern "C" {
void Vector40();  // WWDG
void Vector8C();  // CAN1 TX
void Vector90();  // CAN1 RX0
void Vector98();  // CAN1 SCE
void Vector9C();  // EXTI lines 9 to 5
void VectorE0();  // EXTI lines 15 to 10
void VectorD4();  // USART1
}

}  // namespace ocm::stm32_tests
