// LightRing on its own chip. Pins: AMiRo-OS boards/LightRing/board.h, version 1.0; docs/boards/light_ring.md.
#include <array>

#include "ocm/topics/amiro.hpp"

#include "firmware/boards/light_ring/board.hpp"
#include "firmware/boards/light_ring/costs.hpp"
#include "firmware/boards/light_ring/parts.hpp"
#include "firmware/chibios/fault.hpp"
#include "firmware/chibios/stm32/board_signals.hpp"
#include "firmware/chibios/stm32/chip.hpp"
#include "firmware/chibios/stm32/main.hpp"
#include "firmware/chibios/stm32/pins.hpp"
#include "firmware/chibios/stm32/spi_device.hpp"

namespace chibios = ocm::firmware::chibios;
namespace stm32 = chibios::stm32;
namespace light_ring = ocm::firmware::boards::light_ring;
using stm32::PinMode;

namespace {

constexpr std::array pins{
    stm32::Pin{'A', 4, PinMode::push_pull},              // LIGHT_BLANK, high: dark
    stm32::Pin{'A', 5, PinMode::alternate},              // LIGHT_SCLK, SPI1
    stm32::Pin{'A', 7, PinMode::alternate},              // LIGHT_MOSI
    stm32::Pin{'A', 9, PinMode::alternate},              // PROG, USART1 transmits
    stm32::Pin{'A', 10, PinMode::pull_up},               // PROG, USART1 receives
    stm32::Pin{'A', 11, PinMode::input},                 // CAN_RX
    stm32::Pin{'A', 12, PinMode::alternate},             // CAN_TX
    stm32::Pin{'B', 2, PinMode::push_pull, false},       // LASER_EN
    stm32::Pin{'B', 5, PinMode::input},                  // LASER_OC_N
    stm32::Pin{'B', 6, PinMode::open_drain},             // SYS_UART_DN
    stm32::Pin{'B', 10, PinMode::alternate_open_drain},  // MEM_SCL, I2C2: unused here
    stm32::Pin{'B', 11, PinMode::alternate_open_drain},  // MEM_SDA
    stm32::Pin{'B', 12, PinMode::push_pull},             // WL_SS_N: the radio is never selected
    stm32::Pin{'C', 4, PinMode::push_pull},              // LIGHT_XLAT, rising: takes over
    stm32::Pin{'C', 10, PinMode::input},                 // SYS_UART_RX
    stm32::Pin{'C', 11, PinMode::input},                 // SYS_UART_TX
    stm32::Pin{'C', 14, PinMode::open_drain},            // SYS_PD_N
    stm32::Pin{'D', 0, PinMode::input},                  // OSC_IN
    stm32::Pin{'D', 1, PinMode::input},                  // OSC_OUT
    stm32::Pin{'D', 2, PinMode::open_drain, false},      // SYS_SYNC_N, low: busy
};
constexpr PALConfig pin_setup = stm32::pin_setup(pins);
constexpr std::uint8_t blank = 4;  // on port A

constexpr std::uint32_t spi1_clock_hz = 72'000'000;  // APB2

}  // namespace

void chibios::bring_to_rest() noexcept {
  palSetPad(GPIOA, blank);
}

int main() {
  stm32::start_chip(pin_setup);
  stm32::obey_shutdown({GPIOD, 2, 14});
  static stm32::SpiBus lights_bus{SPID1, spi1_clock_hz};
  static stm32::SpiDevice lights{lights_bus, GPIOC, 4};
  static stm32::OnePin dark{GPIOA, blank};
  static light_ring::Parts<stm32::SpiDevice, stm32::OnePin, chibios::Mutex> parts{lights, dark};
  stm32::run<amiro::LightRing, light_ring::Board, light_ring::Costs>(parts);
}
