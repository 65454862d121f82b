/// A board's pins as one table, and from it what ChibiOS's PAL writes at start. Levels are written before
/// directions, so no output is ever in between. A pin that the table does not name is an input with pull-up.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <hal.h>
#include <span>

namespace ocm::firmware::chibios::stm32 {

enum class PinMode : std::uint8_t {
  input,  ///< floating
  pull_up,
  pull_down,
  analog,
  push_pull,
  open_drain,
  alternate,
  alternate_open_drain,
};

struct Pin {
  char port;
  std::uint8_t pad;
  PinMode mode;
  bool high = true;           ///< level of an output
  std::uint8_t function = 0;  ///< of an alternate pin on the F4 [STM32F405 data sheet, table 9]
};

namespace detail {

inline constexpr std::size_t ports = 9;  // A to I

struct PortSetup {
  std::array<Pin, 16> pads{};
};

[[nodiscard]] constexpr std::array<PortSetup, ports> by_port(std::span<const Pin> pins) {
  std::array<PortSetup, ports> result{};
  for (std::size_t port = 0; port < ports; ++port)
    for (std::uint8_t pad = 0; pad < 16; ++pad)
      result[port].pads[pad] = {static_cast<char>('A' + port), pad, PinMode::pull_up};
  for (const Pin& pin : pins) result[static_cast<std::size_t>(pin.port - 'A')].pads[pin.pad] = pin;
  return result;
}

/// The output register; on the F1 it also chooses between pull-up and pull-down. [RM0008 table 20]
[[nodiscard]] constexpr std::uint32_t levels(const PortSetup& port) {
  std::uint32_t bits = 0;
  for (const Pin& pin : port.pads) bits |= (pin.mode != PinMode::pull_down && pin.high ? 1U : 0U) << pin.pad;
  return bits;
}

#if defined(STM32F103xE)

[[nodiscard]] constexpr std::uint32_t nibble(PinMode mode) {  // [RM0008 9.2.1]
  constexpr std::array<std::uint32_t, 8> values{0x4, 0x8, 0x8, 0x0, 0x3, 0x7, 0xB, 0xF};
  return values[static_cast<std::size_t>(mode)];
}
[[nodiscard]] constexpr stm32_gpio_setup_t setup(const PortSetup& port) {
  stm32_gpio_setup_t result{levels(port), 0, 0};
  for (const Pin& pin : port.pads)
    (pin.pad < 8 ? result.crl : result.crh) |= nibble(pin.mode) << 4 * (pin.pad % 8);
  return result;
}

#else

[[nodiscard]] constexpr stm32_gpio_setup_t setup(const PortSetup& port) {  // [RM0090 8.4]
  stm32_gpio_setup_t result{0, 0, 0xFFFF'FFFF, 0, levels(port), 0, 0};
  for (const Pin& pin : port.pads) {
    const unsigned twice = 2U * pin.pad;
    const bool alternate = pin.mode == PinMode::alternate || pin.mode == PinMode::alternate_open_drain;
    const bool open_drain = pin.mode == PinMode::open_drain || pin.mode == PinMode::alternate_open_drain;
    const std::uint32_t mode = alternate                                                           ? 2
                               : pin.mode == PinMode::analog                                       ? 3
                               : pin.mode == PinMode::push_pull || pin.mode == PinMode::open_drain ? 1
                                                                                                   : 0;
    result.moder |= mode << twice;
    result.otyper |= (open_drain ? 1U : 0U) << pin.pad;
    result.pupdr |= (pin.mode == PinMode::pull_up ? 1U : pin.mode == PinMode::pull_down ? 2U : 0U) << twice;
    (pin.pad < 8 ? result.afrl : result.afrh) |= std::uint32_t{pin.function} << 4 * (pin.pad % 8);
  }
  return result;
}

#endif

}  // namespace detail

/// All ports of the chip.
[[nodiscard]] constexpr PALConfig pin_setup(std::span<const Pin> pins) {
  const auto ports = detail::by_port(pins);
  return {
    detail::setup(ports[0]), detail::setup(ports[1]), detail::setup(ports[2]), detail::setup(ports[3]),
        detail::setup(ports[4]), detail::setup(ports[5]), detail::setup(ports[6]),
#if !defined(STM32F103xE)
        detail::setup(ports[7]), detail::setup(ports[8]),
#endif
  };
}

/// One pin as drivers::Outputs (bit 0) and drivers::Inputs (bit 0).
class OnePin {
 public:
  OnePin(ioportid_t port, std::uint8_t pad) noexcept : port_(port), pad_(pad) {}
  void write(std::uint8_t levels) noexcept { palWritePad(port_, pad_, levels & 1U); }
  [[nodiscard]] std::uint8_t read() noexcept { return static_cast<std::uint8_t>(palReadPad(port_, pad_)); }

 private:
  ioportid_t port_;
  std::uint8_t pad_;
};

}  // namespace ocm::firmware::chibios::stm32
