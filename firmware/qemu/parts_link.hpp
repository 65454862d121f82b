/// The buses of an emulated board: each transfer is an exchange over the second UART with the models on the
/// host (link.hpp). The concepts are those of firmware/drivers/bus.hpp, so the drivers above are the real
/// ones.
///
/// One line, so one mutex with priority inheritance around an exchange; with a host that answers, an exchange
/// takes as long as the host does. One that does not answer costs `patience`, and is Error::bus_fault. For
/// threads; what only sets something (motors, outputs, pulses) does not wait and may be called anywhere.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"

#include "firmware/chibios/port.hpp"
#include "firmware/drivers/bus.hpp"
#include "firmware/qemu/machine.hpp"
#include "firmware/qemu/parts_frames.hpp"

namespace ocm::firmware::qemu {

class PartsLink {
 public:
  /// A host under load may be away for some tens of milliseconds.
  static constexpr base::Duration patience = std::chrono::milliseconds{200};

  explicit PartsLink(Uart& uart) noexcept : uart_(&uart) {}
  void start() noexcept { uart_->start(signal_); }

  /// Sends `request` and what follows its header, `head` before `request.written`; its sequence is set here.
  /// `read.size()` bytes are expected, 255 at most, as are those written.
  base::Status exchange(link::Request request, std::span<std::uint8_t> read,
                        std::span<const std::uint8_t> head = {}) noexcept;
  /// Sends `request` and waits for nothing, as a write to a register does not. Any context, interrupts too.
  void post(link::Request request) noexcept;
  /// The same without lock, variable or interrupt: for a program that cannot go on.
  static void post_at_last(link::Request request) noexcept;
  static constexpr unsigned uart_number = 2;

 private:
  void write(link::Request request, std::span<const std::uint8_t> head) noexcept;

  Uart* uart_;
  chibios::Mutex mutex_;
  chibios::Signal signal_;
  link::AnswerReader reader_;
  std::uint8_t sequence_ = 0;
};

class LinkI2c {
 public:
  LinkI2c(PartsLink& link, std::uint8_t bus) noexcept : link_(&link), bus_(bus) {}
  base::Status transfer(std::uint8_t address7, std::span<const std::uint8_t> write,
                        std::span<std::uint8_t> read) noexcept {
    return link_->exchange({.kind = link::Kind::i2c, .unit = bus_, .a = address7, .written = write}, read);
  }

 private:
  PartsLink* link_;
  std::uint8_t bus_;
};
static_assert(drivers::I2c<LinkI2c>);

class LinkSpi {
 public:
  LinkSpi(PartsLink& link, std::uint8_t device) noexcept : link_(&link), device_(device) {}
  base::Status transfer(const drivers::SpiSettings& settings, std::span<const std::uint8_t> out,
                        std::span<std::uint8_t> in) noexcept {
    const std::uint32_t clock = settings.highest_clock_hz;
    const std::array<std::uint8_t, 4> head{
        static_cast<std::uint8_t>(clock), static_cast<std::uint8_t>(clock >> 8U),
        static_cast<std::uint8_t>(clock >> 16U), static_cast<std::uint8_t>(clock >> 24U)};
    return link_->exchange({.kind = link::Kind::spi, .unit = device_, .a = settings.mode, .written = out}, in,
                           head);
  }

 private:
  PartsLink* link_;
  std::uint8_t device_;
};
static_assert(drivers::Spi<LinkSpi>);

class LinkMotorTimers {
 public:
  explicit LinkMotorTimers(PartsLink& link) noexcept : link_(&link) {}
  [[nodiscard]] std::array<std::uint16_t, 2> encoders() noexcept;
  void set_duty(std::int16_t left, std::int16_t right) noexcept;

 private:
  PartsLink* link_;
  std::array<std::uint16_t, 2> counts_{};  ///< said again when the host does not answer
};
static_assert(drivers::MotorTimers<LinkMotorTimers>);

class LinkConverter {
 public:
  explicit LinkConverter(PartsLink& link) noexcept : link_(&link) {}
  [[nodiscard]] base::Result<std::uint16_t> convert(std::uint8_t channel) noexcept;

 private:
  PartsLink* link_;
};
static_assert(drivers::Converter<LinkConverter>);

class LinkPulseTimer {
 public:
  LinkPulseTimer(PartsLink& link, std::uint8_t channel) noexcept : link_(&link), channel_(channel) {}
  void set_width(std::uint16_t counts) noexcept;

 private:
  PartsLink* link_;
  std::uint8_t channel_;
};
static_assert(drivers::PulseTimer<LinkPulseTimer>);

class LinkInputs {
 public:
  LinkInputs(PartsLink& link, std::uint8_t group) noexcept : link_(&link), group_(group) {}
  [[nodiscard]] std::uint8_t read() noexcept;

 private:
  PartsLink* link_;
  std::uint8_t group_;
  std::uint8_t levels_ = 0;  ///< said again when the host does not answer
};
static_assert(drivers::Inputs<LinkInputs>);

class LinkOutputs {
 public:
  LinkOutputs(PartsLink& link, std::uint8_t group) noexcept : link_(&link), group_(group) {}
  void write(std::uint8_t levels) noexcept;

 private:
  PartsLink* link_;
  std::uint8_t group_;
};
static_assert(drivers::Outputs<LinkOutputs>);

}  // namespace ocm::firmware::qemu
