/// The dongle of an emulated mapper: its serial line is one UART, its pin 19 another. QEMU's machines
/// have no pins: a byte on the second UART is the level that pin 19 has now, '0' low, connected, or '1' high
/// [Thesis 2, 6.4.1]; the robot itself says CR there once it listens.
///
/// Received bytes and changes of the pin are handed on in the interrupt. What is sent takes the time of its
/// bits at 38400 baud, from a ring of 128 bytes: half an update and a handshake, more than the application
/// has under way at once. When the link is lost, what waits is dropped and counted.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/chibios/port.hpp"
#include "firmware/qemu/machine.hpp"

namespace ocm::firmware::qemu {

class DongleLine {
 public:
  static constexpr std::uint32_t baud = 38'400;  ///< [Thesis 2, guide to the dongles' programs]

  /// Numbers of the UARTs.
  DongleLine(unsigned line, unsigned pin) noexcept : line_(line), pin_(pin) {}
  DongleLine(const DongleLine&) = delete;
  DongleLine& operator=(const DongleLine&) = delete;

  /// From now on `robot.receive(byte)` and `robot.link_changed()`, in the interrupt. It must outlive the
  /// line.
  template <class Robot>
  void start(Robot& robot) noexcept {
    robot_ = &robot;
    receive_ = [](void* to, std::uint8_t byte) { static_cast<Robot*>(to)->receive(byte); };
    link_changed_ = [](void* to) { static_cast<Robot*>(to)->link_changed(); };
    listen();
  }

  /// How many of the bytes found room. Any context.
  [[nodiscard]] std::size_t send(std::span<const std::uint8_t> bytes) noexcept;
  [[nodiscard]] bool linked() const noexcept { return linked_; }
  /// Bytes that waited for a link that was lost.
  [[nodiscard]] std::uint32_t dropped() const noexcept { return dropped_; }

 private:
  void listen() noexcept;
  void on_byte() noexcept;
  void on_pin() noexcept;
  void send_next() noexcept;

  UartRegisters line_;
  UartRegisters pin_;
  void* robot_ = nullptr;
  void (*receive_)(void*, std::uint8_t) = nullptr;
  void (*link_changed_)(void*) = nullptr;
  virtual_timer_t timer_{};
  std::array<std::uint8_t, 128> ring_{};
  std::size_t begin_ = 0;
  std::size_t size_ = 0;
  std::uint32_t dropped_ = 0;
  bool sending_ = false;  ///< the timer runs: a byte is on the line
  volatile bool linked_ = false;
};

}  // namespace ocm::firmware::qemu
