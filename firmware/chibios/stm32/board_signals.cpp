#include "firmware/chibios/stm32/board_signals.hpp"

#include <algorithm>

#include "firmware/chibios/fault.hpp"
#include "firmware/chibios/stm32/chip.hpp"
#include "firmware/chibios/stm32/watchdog.hpp"

extern "C" {
extern const std::uint32_t _vectors[];  // ChibiOS's: where this program begins
}

namespace ocm::firmware::chibios::stm32 {
namespace {

constinit SignalPins signals{};
constinit ConnectDetector connect{};
using Interrupt = void (*)();
constinit Interrupt prog_interrupt = nullptr;  // of who shares the programming UART

// The same on both chips. [RM0008 table 63, RM0090 table 62]
constexpr std::uint32_t lines_9_to_5_number = 23;
constexpr std::uint32_t lines_15_to_10_number = 40;
constexpr std::uint32_t interrupt_priority = 13;  // of the lowest: 14 is the kernel's own

void choose_port_of_line(std::uint32_t line, char port) noexcept {
  const auto number = static_cast<std::uint32_t>(port - 'A');
#if defined(STM32F103xE)
  volatile std::uint32_t& choice = AFIO->EXTICR[line / 4];
#else
  rccEnableAPB2(RCC_APB2ENR_SYSCFGEN, FALSE);
  volatile std::uint32_t& choice = SYSCFG->EXTICR[line / 4];
#endif
  const std::uint32_t shift = 4 * (line % 4);
  choice = (choice & ~(0xFU << shift)) | number << shift;
}

void power_down_fell() noexcept {
  const std::uint32_t line = 1U << signals.power_down_pad;
  if ((EXTI->PR & line) == 0) return;
  EXTI->PR = line;
  shut_down(Shutdown::handle_request);
}

}  // namespace

void obey_shutdown(const SignalPins& pins) noexcept {
  signals = pins;

  // A pulse of 1 ms means restart, so it must be an interrupt. [AMiRo-BLT, blCallbackShutdownRestart]
  const std::uint32_t line = 1U << pins.power_down_pad;
  choose_port_of_line(pins.power_down_pad, pins.power_down_port);
  EXTI->FTSR |= line;
  EXTI->PR = line;
  EXTI->IMR |= line;
  nvicEnableVector(pins.power_down_pad < 10 ? lines_9_to_5_number : lines_15_to_10_number,
                   interrupt_priority);

  rccEnableUSART1(FALSE);
  USART1->BRR = (prog_clock_hz + prog_bit_rate / 2) / prog_bit_rate;
  USART1->CR1 = USART_CR1_UE | USART_CR1_RE | USART_CR1_TE | USART_CR1_RXNEIE;
  nvicEnableVector(STM32_USART1_NUMBER, interrupt_priority);
}

void share_programming_uart(void (*interrupt)()) noexcept {
  prog_interrupt = interrupt;
}

void heed(std::uint8_t byte) noexcept {
  if (connect.feed(byte)) shut_down(Shutdown::restart);
}

void say_ready() noexcept {
  palSetPad(signals.sync_port, signals.sync_pad);
}

void shut_down(Shutdown kind) noexcept {
  leave_only_watchdog();  // SysTick is off, too: the bootloader polls it for its time
  bring_to_rest();
  BootloaderTable table{};
  const auto* const words = reinterpret_cast<const volatile std::uint32_t*>(bootloader_table_address);
  std::copy_n(words, table.size(), table.begin());
  const auto application = static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(_vectors));
  if (const std::uint32_t address = bootloader_function(table, kind, application); address != 0) {
    reinterpret_cast<void (*)()>(address)();
  }
  restart_chip();
}

}  // namespace ocm::firmware::chibios::stm32

namespace stm32 = ocm::firmware::chibios::stm32;

// C++ would mangle the names, and the vectors would lead nowhere.
extern "C" {

OSAL_IRQ_HANDLER(Vector9C) {  // lines 9 to 5
  OSAL_IRQ_PROLOGUE();
  stm32::power_down_fell();
  OSAL_IRQ_EPILOGUE();
}

OSAL_IRQ_HANDLER(VectorE0) {  // lines 15 to 10
  OSAL_IRQ_PROLOGUE();
  stm32::power_down_fell();
  OSAL_IRQ_EPILOGUE();
}

OSAL_IRQ_HANDLER(STM32_USART1_HANDLER) {
  OSAL_IRQ_PROLOGUE();
  if (stm32::prog_interrupt != nullptr) {
    stm32::prog_interrupt();
  } else {
    const std::uint32_t status = USART1->SR;
    const auto byte = static_cast<std::uint8_t>(USART1->DR);  // after SR: clears overrun and framing errors
    if ((status & USART_SR_RXNE) != 0) stm32::heed(byte);
  }
  OSAL_IRQ_EPILOGUE();
}

}  // extern "C"
