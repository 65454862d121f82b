#include "firmware/qemu/machine.hpp"

#include <algorithm>
#include <type_traits>

namespace ocm::firmware::qemu {
namespace {

constinit systime_t alarm_time = 0;
constinit bool alarm_set = false;

struct Handler {
  void (*received)(void*) = nullptr;
  void* object = nullptr;
};
constinit std::array<Handler, 3> handlers{};

/// All interrupts of ours: below what the kernel keeps for itself, all at one level. [ChibiOS
/// CORTEX_MAX_KERNEL_PRIORITY]
constexpr std::uint32_t interrupt_priority = 8;

/// Microseconds; not above 0 when it is due.
[[nodiscard]] std::int32_t until_alarm() noexcept {
  return static_cast<std::make_signed_t<systime_t>>(
      static_cast<systime_t>(alarm_time - port_timer_get_time()));
}

/// SysTick counts to the alarm, or as far as its 24 bits reach on the way.
void set_systick() noexcept {
  constexpr std::int32_t furthest_us = 0xFF'FFFF / OCM_SYSTICK_PER_US;
  const std::int32_t us = std::clamp(until_alarm(), std::int32_t{1}, furthest_us);
  SysTick->CTRL = 0;
  SysTick->LOAD = static_cast<std::uint32_t>(us) * OCM_SYSTICK_PER_US;
  SysTick->VAL = 0;
  SysTick->CTRL = SysTick_CTRL_TICKINT_Msk | SysTick_CTRL_ENABLE_Msk;  // from the reference clock, core / 8
}

USART_TypeDef& registers(unsigned number) noexcept {
  return number == 1 ? *USART1 : number == 2 ? *USART2 : *USART3;
}

/// [Semihosting for AArch32 and AArch64, 2.1: the operation in r0, its argument in r1]
std::uint32_t semihosting(std::uint32_t operation, const void* argument) noexcept {
  register std::uint32_t r0 asm("r0") = operation;
  register const void* r1 asm("r1") = argument;
  asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

}  // namespace

void start_machine() noexcept {
  // QEMU's TIM2 counts 1 GHz whatever the clock tree says. [qemu hw/timer/stm32f2xx_timer.c, clock-frequency]
  TIM2->PSC = 999;
  TIM2->EGR = TIM_EGR_UG;
  TIM2->CR1 = TIM_CR1_CEN;
  NVIC_SetPriority(SysTick_IRQn, interrupt_priority);
  chSysInit();
}

void say(const char* text) noexcept {
  constexpr std::uint32_t write0 = 0x04;
  semihosting(write0, text);
}

void leave(const char* reason, int code) noexcept {
  constexpr std::uint32_t exit_extended = 0x20;
  constexpr std::uint32_t application_exit = 0x20026;
  say(reason);
  say("\n");
  const std::array<std::uint32_t, 2> block{application_exit, static_cast<std::uint32_t>(code)};
  semihosting(exit_extended, block.data());
  for (;;) {
  }
}

void busy_wait(std::uint32_t us) noexcept {
  const std::uint32_t begin = TIM2->CNT;
  while (TIM2->CNT - begin < us) {
  }
}

void UartRegisters::start(void (*received)(void*), void* object) noexcept {
  const chibios::Lock lock;
  handlers[number_ - 1] = {received, object};
  constexpr std::array<IRQn_Type, 3> lines{USART1_IRQn, USART2_IRQn, USART3_IRQn};
  NVIC_SetPriority(lines[number_ - 1], interrupt_priority);
  NVIC_EnableIRQ(lines[number_ - 1]);
  registers(number_).CR1 = USART_CR1_UE | USART_CR1_TE | USART_CR1_RE | USART_CR1_RXNEIE;
}

void UartRegisters::write(std::span<const std::uint8_t> bytes) noexcept {
  USART_TypeDef& uart = registers(number_);
  for (const std::uint8_t byte : bytes) {
    while ((uart.SR & USART_SR_TXE) == 0) {
    }
    uart.DR = byte;
  }
}

bool UartRegisters::take(std::uint8_t& byte) noexcept {
  USART_TypeDef& uart = registers(number_);
  if ((uart.SR & USART_SR_RXNE) == 0) return false;
  byte = static_cast<std::uint8_t>(uart.DR);
  return true;
}

void UartRegisters::listen(bool on) noexcept {
  USART_TypeDef& uart = registers(number_);
  if (on)
    uart.CR1 |= USART_CR1_RXNEIE;
  else
    uart.CR1 &= ~USART_CR1_RXNEIE;
}

void Uart::start(chibios::Signal& received) noexcept {
  received_ = &received;
  registers_.start([](void* self) { static_cast<Uart*>(self)->on_interrupt(); }, this);
}

bool Uart::read(std::uint8_t& byte) noexcept {
  const chibios::Lock lock;
  if (size_ == 0) return false;
  byte = ring_[begin_];
  begin_ = (begin_ + 1) % ring_.size();
  --size_;
  registers_.listen(true);
  return true;
}

void Uart::on_interrupt() noexcept {
  const chibios::Lock lock;
  if (size_ == ring_.size()) {
    registers_.listen(false);
    return;
  }
  std::uint8_t byte = 0;
  if (!registers_.take(byte)) return;
  ring_[(begin_ + size_++) % ring_.size()] = byte;
  received_->raise_locked();
}

}  // namespace ocm::firmware::qemu

using ocm::firmware::qemu::alarm_set;
using ocm::firmware::qemu::alarm_time;

// --- what the kernel and the vector table call ---
extern "C" {

void ocm_alarm_start(systime_t time) {
  alarm_time = time;
  alarm_set = true;
  ocm::firmware::qemu::set_systick();
}

void ocm_alarm_stop() {
  alarm_set = false;
  SysTick->CTRL = 0;
}

systime_t ocm_alarm_get() {
  return alarm_time;
}

CH_IRQ_HANDLER(SysTick_Handler) {
  CH_IRQ_PROLOGUE();
  chSysLockFromISR();
  if (alarm_set && ocm::firmware::qemu::until_alarm() > 0)
    ocm::firmware::qemu::set_systick();
  else if (SysTick->CTRL = 0; alarm_set)
    chSysTimerHandlerI();
  chSysUnlockFromISR();
  CH_IRQ_EPILOGUE();
}

// Vectors have no names in ChibiOS: 0x40 + 4 * interrupt. USART1 is 37, USART2 38, USART3 39. [RM0090, table
// 62]
#define OCM_UART_INTERRUPT(vector, index)                       \
  CH_IRQ_HANDLER(vector) {                                      \
    CH_IRQ_PROLOGUE();                                          \
    const auto& handler = ocm::firmware::qemu::handlers[index]; \
    handler.received(handler.object);                           \
    CH_IRQ_EPILOGUE();                                          \
  }
OCM_UART_INTERRUPT(VectorD4, 0)
OCM_UART_INTERRUPT(VectorD8, 1)
OCM_UART_INTERRUPT(VectorDC, 2)
}
