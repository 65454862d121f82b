/// The USART of the STM32F1 as its reference manual describes it: data and shift register each way, the
/// flags, the interrupt. Written from RM0008 27 without a look at the driver. What a program must not do is
/// recorded in `violations`.
///
/// Time is the test's: `arrive` ends a character on the receiving wire, `shift` one on the sending wire.
/// `on_access` runs before each access of the program to a register.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "firmware/drivers/usart.hpp"

namespace ocm::sim {

class UsartModel {
 public:
  using Register = firmware::drivers::usart::Register;

  std::function<void()> on_access;
  std::vector<std::string> violations;
  std::string sent;           ///< what has left the shift register
  unsigned overwritten = 0;   ///< characters that arrived while DR was full
  std::uint32_t divider = 0;  ///< BRR

  // --- the program's side ---

  std::uint32_t read(Register which) {
    if (on_access) on_access();
    switch (which) {
      case Register::sr:
        return seen_ = status();
      case Register::dr:
        // Takes the character, and clears of ORE, NE and FE what the last read of SR has shown: an overrun
        // between the two stays, without RXNE. [RM0008 27.3.3, 27.6.1]
        if ((seen_ & 8) != 0) overrun_ = false;
        noisy_ = broken_ = false;
        seen_ = 0;
        full_ = false;
        return data_;
      case Register::brr:
        return divider;
      case Register::cr1:
        return control_;
    }
    return 0;
  }
  void write(Register which, std::uint32_t value) {
    if (on_access) on_access();
    switch (which) {
      case Register::sr:
        violations.emplace_back("SR written");
        return;
      case Register::dr:
        if ((control_ & enabled) != enabled) violations.emplace_back("sent by a transmitter that is off");
        if (to_send_) violations.emplace_back("DR written while it is full");
        if (value > 0xFF) violations.emplace_back("nine bits");
        to_send_ = static_cast<char>(value);
        if (!on_wire_) load();
        return;
      case Register::brr:
        if (on_wire_) violations.emplace_back("bit rate changed in a character");
        divider = value;
        return;
      case Register::cr1:
        control_ = value;
        return;
    }
  }
  /// The interrupt is asserted. RXNEIE is that of ORE, too. [RM0008 table 198]
  [[nodiscard]] bool interrupt() const {
    const std::uint32_t flags = status();
    return ((control_ & 1U << 5) != 0 && (flags & (1U << 5 | 1U << 3)) != 0) ||
           ((control_ & 1U << 7) != 0 && (flags & 1U << 7) != 0);
  }

  // --- the wires' side ---

  /// A character is complete. One that finds DR full is lost, and DR stays. [RM0008 27.3.3, overrun error]
  void arrive(std::uint8_t byte, bool noisy = false, bool broken = false) {
    if ((control_ & 1U << 13) == 0 || (control_ & 1U << 2) == 0) return;
    if (full_) {
      overrun_ = true;
      ++overwritten;
      return;
    }
    data_ = byte;
    full_ = true;
    noisy_ = noisy;
    broken_ = broken;
  }
  /// The character on the sending wire is over. False: there was none.
  bool shift() {
    if (!on_wire_) return false;
    sent += *on_wire_;
    on_wire_.reset();
    if (to_send_) load();
    return true;
  }

 private:
  static constexpr std::uint32_t enabled = 1U << 13 | 1U << 3;  // UE, TE

  void load() {
    on_wire_ = to_send_;
    to_send_.reset();
  }
  [[nodiscard]] std::uint32_t status() const {
    return (broken_ ? 2U : 0U) | (noisy_ ? 4U : 0U) | (overrun_ ? 8U : 0U) | (full_ ? 1U << 5 : 0U) |
           (!to_send_ && !on_wire_ ? 1U << 6 : 0U) | (!to_send_ ? 1U << 7 : 0U);
  }

  std::uint32_t control_ = 0;
  std::uint32_t data_ = 0;
  bool full_ = false, overrun_ = false, noisy_ = false, broken_ = false;
  std::uint32_t seen_ = 0;  ///< what SR has shown
  std::optional<char> to_send_, on_wire_;
};

/// What a driver holds: the model's registers.
class UsartModelRegisters {
 public:
  explicit UsartModelRegisters(UsartModel& model) noexcept : model_(&model) {}
  std::uint32_t read(firmware::drivers::usart::Register which) { return model_->read(which); }
  void write(firmware::drivers::usart::Register which, std::uint32_t value) { model_->write(which, value); }

 private:
  UsartModel* model_;
};
static_assert(firmware::drivers::usart::Registers<UsartModelRegisters>);

}  // namespace ocm::sim
