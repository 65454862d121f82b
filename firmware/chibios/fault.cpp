#include "firmware/chibios/fault.hpp"

#include <ch.h>

namespace chibios = ocm::firmware::chibios;

extern "C" {
/// Its place is the linker script's: outside of what start-up code fills and clears.
extern volatile chibios::RestartNote ocm_restart_note;
extern const std::uint32_t __ram0_start__[];
extern const std::uint32_t __ram0_end__[];
}

namespace ocm::firmware::chibios {
namespace {

/// The instruction that faulted, from what the processor stacked: r0 to r3, r12, lr, pc, psr. 0 if that is
/// not in RAM, since reading it would be the next fault.
[[nodiscard]] std::uint32_t stacked_pc(const std::uint32_t* frame) noexcept {
  constexpr std::uint32_t words = 8;
  const auto at = reinterpret_cast<std::uintptr_t>(frame);
  const auto begin = reinterpret_cast<std::uintptr_t>(__ram0_start__);
  const auto end = reinterpret_cast<std::uintptr_t>(__ram0_end__);
  return at >= begin && at <= end - words * sizeof *frame && at % sizeof *frame == 0 ? frame[6] : 0;
}

}  // namespace

void rest_and_restart(ResetCause cause, std::uint32_t where) noexcept {
  __disable_irq();
  bring_to_rest();
  const RestartNote note = make_note(cause, where);
  ocm_restart_note.magic = note.magic;
  ocm_restart_note.cause = note.cause;
  ocm_restart_note.where = note.where;
  ocm_restart_note.check = note.check;
  restart(cause);
}

ResetCause take_noted_cause() noexcept {
  const ResetCause cause = cause_in_note(
      {ocm_restart_note.magic, ocm_restart_note.cause, ocm_restart_note.where, ocm_restart_note.check});
  ocm_restart_note.magic = 0;
  return cause;
}

}  // namespace ocm::firmware::chibios

// What the vectors and the kernel call.
extern "C" {

[[noreturn, gnu::used]] void ocm_faulted(const std::uint32_t* frame, std::uint32_t exception) {
  // Rest comes first: what follows reads memory. rest_and_restart() says it once more.
  chibios::bring_to_rest();
  chibios::rest_and_restart(chibios::cause_of_exception(exception, SCB->CFSR), chibios::stacked_pc(frame));
}

// Until the stack is known to be good there is none: no prologue. LR says which stack the processor used.
[[gnu::naked, gnu::used]] void ocm_fault_entry() noexcept {
  asm volatile(
      "cpsid i                               \n"
      "tst   lr, #4                          \n"
      "ite   eq                              \n"
      "mrseq r0, msp                         \n"
      "mrsne r0, psp                         \n"
      "mrs   r1, ipsr                        \n"
      "movw  r2, #:lower16:__main_stack_end__\n"
      "movt  r2, #:upper16:__main_stack_end__\n"
      "msr   msp, r2                         \n"
      "b     ocm_faulted                     \n");
}

void HardFault_Handler() noexcept __attribute__((alias("ocm_fault_entry")));
void MemManage_Handler() noexcept __attribute__((alias("ocm_fault_entry")));
void BusFault_Handler() noexcept __attribute__((alias("ocm_fault_entry")));
void UsageFault_Handler() noexcept __attribute__((alias("ocm_fault_entry")));
void NMI_Handler() noexcept __attribute__((alias("ocm_fault_entry")));

/// The kernel found itself broken. Where: the address of its reason in words.
void ocm_halted(const char* reason) {
  chibios::rest_and_restart(chibios::ResetCause::kernel_halt,
                            static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(reason)));
}
}
