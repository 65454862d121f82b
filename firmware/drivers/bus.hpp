/// What a driver needs of the buses that its part hangs on. A real controller, the link of an emulated board
/// to its host and a register model satisfy these alike, so the drivers above are the same source everywhere.
///
/// A transfer blocks until it is done, in bounded time: a bus that hangs answers Error::bus_fault. A bus that
/// several priority levels share locks inside its `transfer` (a mutex with priority inheritance, held for one
/// transfer only).
///
/// Errors: no_answer, no part acknowledged the address or a byte (I2C only: SPI cannot tell); bus_fault, all
/// else: arbitration lost, a line stuck, a time-out.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <span>

#include "ocm/base/result.hpp"

namespace ocm::firmware::drivers {

/// `transfer(address, write, read)`: START, write, repeated START, read, STOP. Either span may be empty; with
/// both empty only the address is sent, for writing. The address has 7 bits, not shifted.
template <class B>
concept I2c = requires(B& bus, std::uint8_t address7, std::span<const std::uint8_t> write,
                       std::span<std::uint8_t> read) {
  { bus.transfer(address7, write, read) } -> std::same_as<base::Status>;
};

struct SpiSettings {
  std::uint8_t mode = 0;               ///< CPOL << 1 | CPHA
  std::uint32_t highest_clock_hz = 0;  ///< the controller takes the fastest clock that it has up to this
  friend constexpr bool operator==(const SpiSettings&, const SpiSettings&) = default;
};

/// One device: a bus and a chip select. `transfer(settings, out, in)`: one frame of the chip select, full
/// duplex, most significant bit first; `out` and `in` are equally long.
template <class S>
concept Spi = requires(S& device, const SpiSettings& settings, std::span<const std::uint8_t> out,
                       std::span<std::uint8_t> in) {
  { device.transfer(settings, out, in) } -> std::same_as<base::Status>;
};

/// Full duty of a motor, forwards; its negative is full duty backwards, 0 is no voltage (both ends of the
/// motor at the same level: it brakes).
inline constexpr std::int16_t full_duty = 32767;

/// Two motors with their encoders: left, right. `encoders()` is two free-running 16-bit quadrature counts,
/// forwards up. It can fail only where the timers are behind a link; then it says the last counts again.
template <class M>
concept MotorTimers = requires(M& motors, std::int16_t duty) {
  { motors.encoders() } -> std::same_as<std::array<std::uint16_t, 2>>;
  motors.set_duty(duty, duty);
};

/// Up to eight input pins, as the board's parts.hpp numbers them. 1: the pin is high.
template <class P>
concept Inputs = requires(P& pins) {
  { pins.read() } -> std::same_as<std::uint8_t>;
};

/// Up to eight output pins, all set at once. 1: the pin goes high.
template <class P>
concept Outputs = requires(P& pins, std::uint8_t levels) {
  pins.write(levels);
};

/// An analogue-to-digital converter: `convert(channel)` is one conversion, in counts.
template <class A>
concept Converter = requires(A& converter, std::uint8_t channel) {
  { converter.convert(channel) } -> std::same_as<base::Result<std::uint16_t>>;
};

/// A timer's channel that repeats a pulse; a new width, in the timer's counts, holds from the next one on.
template <class T>
concept PulseTimer = requires(T& timer, std::uint16_t counts) {
  timer.set_width(counts);
};

/// For what is more than one transfer and used from more than one priority level, such as "select the
/// channel, then talk to the part behind it". On an RTOS: a mutex with priority inheritance, held for one
/// such pair.
template <class M>
concept Mutex = requires(M& mutex) {
  mutex.lock();
  mutex.unlock();
};

/// Where one context calls everything.
struct NoMutex {
  constexpr void lock() noexcept {}
  constexpr void unlock() noexcept {}
};

template <Mutex M>
class Guard {
 public:
  explicit Guard(M& mutex) noexcept : mutex_(&mutex) { mutex_->lock(); }
  ~Guard() { mutex_->unlock(); }
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;

 private:
  M* mutex_;
};

}  // namespace ocm::firmware::drivers
