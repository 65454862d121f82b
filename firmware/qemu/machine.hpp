/// QEMU's machines netduino2 (STM32F205, Cortex-M3) and netduinoplus2 (STM32F405, Cortex-M4) as far as they
/// are emulated: three UARTs, a counter, SysTick, and semihosting for the way out. Registers of both chips
/// are alike.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/chibios/port.hpp"

namespace ocm::firmware::qemu {

/// Counter and kernel. First thing in main().
void start_machine() noexcept;

/// On QEMU's stderr. (QEMU needs -semihosting; without it, it aborts.)
void say(const char* text) noexcept;

/// Ends QEMU with this exit code, the reason on its stderr.
[[noreturn]] void leave(const char* reason, int code) noexcept;

/// Of an image that has give_up.cpp. Before one that gives up ends QEMU, it calls this with the reason,
/// interrupts off: for what a robot has to do then. nullptr: nothing.
void before_giving_up(void (*last_words)(const char* reason)) noexcept;

/// Waits without the kernel, wherever that is. Microseconds.
void busy_wait(std::uint32_t us) noexcept;

/// The registers of an UART, 1 to 3, and what its receive interrupt calls. QEMU has no transmit interrupt,
/// and takes bytes as fast as its other end reads: writing waits for that.
class UartRegisters {
 public:
  explicit UartRegisters(unsigned number) noexcept : number_(number) {}

  /// From now on `received(object)` runs in the interrupt, without the lock, as long as a byte is there.
  void start(void (*received)(void*), void* object) noexcept;
  void write(std::span<const std::uint8_t> bytes) noexcept;
  /// In the interrupt. False: no byte.
  [[nodiscard]] bool take(std::uint8_t& byte) noexcept;
  /// Whether the interrupt comes. While it does not, QEMU holds back the next byte, and nothing is lost.
  void listen(bool on) noexcept;

 private:
  unsigned number_;
};

/// Received by interrupt into a ring, sent at once by waiting. When the ring is full the line waits; nothing
/// is lost.
class Uart {
 public:
  explicit Uart(unsigned number) noexcept : registers_(number) {}
  Uart(const Uart&) = delete;
  Uart& operator=(const Uart&) = delete;

  /// Raises `received` at each byte from now on.
  void start(chibios::Signal& received) noexcept;
  void write(std::span<const std::uint8_t> bytes) noexcept { registers_.write(bytes); }
  /// False: nothing there.
  [[nodiscard]] bool read(std::uint8_t& byte) noexcept;

 private:
  void on_interrupt() noexcept;

  UartRegisters registers_;
  chibios::Signal* received_ = nullptr;
  std::array<std::uint8_t, 128> ring_{};
  std::size_t begin_ = 0;
  std::size_t size_ = 0;
};

}  // namespace ocm::firmware::qemu
