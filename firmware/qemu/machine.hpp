/// QEMU's machines netduino2 (STM32F205, Cortex-M3) and netduinoplus2 (STM32F405, Cortex-M4) as far as they
/// are emulated: two UARTs, a counter, SysTick, and semihosting for the way out. Registers of both chips are
/// alike.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/chibios/port.hpp"

namespace ocm::firmware::qemu {

/// Counter and kernel. First thing in main().
void start_machine() noexcept;

/// Ends QEMU with this exit code, the reason on its stderr. (QEMU wants -semihosting; without it, it aborts.)
[[noreturn]] void leave(const char* reason, int code) noexcept;

/// Received by interrupt into a ring, sent at once by waiting: QEMU has no transmit interrupt, and takes
/// bytes as fast as its other end reads. When the ring is full the line waits; nothing is lost.
class Uart {
 public:
  /// 1 or 2.
  explicit Uart(unsigned number) noexcept : number_(number) {}
  Uart(const Uart&) = delete;
  Uart& operator=(const Uart&) = delete;

  /// Raises `received` at each byte from now on.
  void start(chibios::Signal& received) noexcept;
  void write(std::span<const std::uint8_t> bytes) noexcept;
  /// False: nothing there.
  [[nodiscard]] bool read(std::uint8_t& byte) noexcept;

  void on_interrupt() noexcept;

 private:
  unsigned number_;
  chibios::Signal* received_ = nullptr;
  std::array<std::uint8_t, 128> ring_{};
  std::size_t begin_ = 0;
  std::size_t size_ = 0;
};

}  // namespace ocm::firmware::qemu
