/// A board in QEMU that breaks when its host asks for it: for the test of what it does then. Only in images
/// with OCM_FAULT_TEST. The host asks with the levels of a group of inputs that no board has.
///
/// The only bus fault is a lost stack's: these machines of QEMU answer a load from any address
/// (ignore_memory_transaction_failures).
/// QEMU has no watchdog. The board's own here is played: an interrupt of the kernel's timer counts the turns
/// in which the levels gave no sign, as the real one's interrupt does (chibios/stm32/watchdog.cpp).
#pragma once

#include <ch.h>
#include <chrono>
#include <cstdint>

#include "ocm/base/time.hpp"

#include "firmware/chibios/fault.hpp"
#include "firmware/chibios/port.hpp"
#include "firmware/chibios/stm32/watchdog_turns.hpp"
#include "firmware/qemu/parts_link.hpp"

namespace ocm::firmware::qemu {

enum class Breakdown : std::uint8_t {
  none,
  breakpoint,           ///< without a debugger: a HardFault of no other kind
  invalid_instruction,  ///< a usage fault
  execute_never,        ///< a memory fault
  lost_stack,           ///< a bus fault: the thread's stack pointer leads nowhere
  kernel_halt,
  hang_low,     ///< the lowest level's job does not come back
  hang_urgent,  ///< nor the highest's: nothing below runs
};

class FaultInjection {
 public:
  explicit FaultInjection(PartsLink& link) noexcept : inputs_(link, group) {}

  /// The played watchdog runs from now on. With the kernel running.
  void start() noexcept {
    const chibios::Lock lock;
    chVTSetI(&timer_, turn_ticks, &turn_over, this);
  }
  void feed() noexcept { turns_.fed(); }

  /// In the background, every 10 ms.
  void look(base::Time now) noexcept {
    if (now < next_) return;
    next_ = now + std::chrono::milliseconds{50};
    happen(static_cast<Breakdown>(inputs_.read()));
  }

 private:
  static constexpr std::uint8_t group = 9;
  static constexpr systime_t turn_ticks = MS2ST(50);
  static constexpr std::uint32_t turns = 20;  // 1 s: a host under load holds up QEMU for longer than 400 ms

  static constexpr std::uint32_t nowhere = 0x6000'0000;  // external memory, which these machines do not have

  static void happen(Breakdown breakdown) noexcept {
    switch (breakdown) {
      case Breakdown::none:
        break;
      case Breakdown::breakpoint:
        asm volatile("bkpt #1");
        break;
      case Breakdown::invalid_instruction:
        asm volatile("udf #0");
        break;
      case Breakdown::execute_never:
        asm volatile("bx %0" : : "r"(0xE000'0001U));
        break;
      case Breakdown::lost_stack:
        asm volatile("msr psp, %0 \n udf #0" : : "r"(nowhere));
        break;
      case Breakdown::kernel_halt:
        chSysHalt("on request");
        break;
      case Breakdown::hang_low:
        for (;;) asm volatile("");
      case Breakdown::hang_urgent:
        chThdSetPriority(HIGHPRIO);
        for (;;) asm volatile("");
    }
  }

  static void turn_over(void* self) {
    auto& injection = *static_cast<FaultInjection*>(self);
    if (!injection.turns_.next(turns)) chibios::rest_and_restart(chibios::ResetCause::watchdog);
    const chibios::Lock lock;
    chVTSetI(&injection.timer_, turn_ticks, &turn_over, self);
  }

  LinkInputs inputs_;
  base::Time next_{};
  virtual_timer_t timer_{};
  chibios::stm32::WatchdogTurns turns_;
};

}  // namespace ocm::firmware::qemu
