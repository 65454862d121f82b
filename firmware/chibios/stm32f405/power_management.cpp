// PowerManagement on its own chip. Pins: AMiRo-OS boards/PowerManagement/board.h, version 1.1;
// docs/boards/power_management.md. It holds the power and the reset of the other boards in its hands:
// POWER_EN, SYS_REG_EN and SYS_WARMRST_N are high when the bootloader starts the program, and stay so.
#include <array>

#include "ocm/topics/amiro.hpp"

#include "firmware/boards/power_management/board.hpp"
#include "firmware/boards/power_management/costs.hpp"
#include "firmware/boards/power_management/parts.hpp"
#include "firmware/chibios/fault.hpp"
#include "firmware/chibios/stm32/board_signals.hpp"
#include "firmware/chibios/stm32/chip.hpp"
#include "firmware/chibios/stm32/i2c_bus.hpp"
#include "firmware/chibios/stm32/main.hpp"
#include "firmware/chibios/stm32/pins.hpp"

namespace chibios = ocm::firmware::chibios;
namespace stm32 = chibios::stm32;
namespace power_management = ocm::firmware::boards::power_management;
using stm32::PinMode;

namespace {

constexpr std::array pins{
    stm32::Pin{'A', 0, PinMode::input},                          // WKUP
    stm32::Pin{'A', 2, PinMode::input},                          // SYS_UART_TX
    stm32::Pin{'A', 3, PinMode::input},                          // SYS_UART_RX
    stm32::Pin{'A', 4, PinMode::input},                          // SYS_SPI_SS0_N
    stm32::Pin{'A', 5, PinMode::input},                          // SYS_SPI_SCLK
    stm32::Pin{'A', 6, PinMode::input},                          // SYS_SPI_MISO
    stm32::Pin{'A', 7, PinMode::input},                          // SYS_SPI_MOSI
    stm32::Pin{'A', 8, PinMode::push_pull, true},                // SYS_REG_EN: 1.8, 3.3 and 5 V of all boards
    stm32::Pin{'A', 9, PinMode::alternate, true, 7},             // PROG, USART1 transmits
    stm32::Pin{'A', 10, PinMode::alternate, true, 7},            // PROG, USART1 receives
    stm32::Pin{'A', 11, PinMode::alternate, true, 9},            // CAN_RX
    stm32::Pin{'A', 12, PinMode::alternate, true, 9},            // CAN_TX
    stm32::Pin{'A', 13, PinMode::alternate, true, 0},            // SWDIO
    stm32::Pin{'A', 14, PinMode::alternate, true, 0},            // SWCLK
    stm32::Pin{'A', 15, PinMode::input},                         // SYS_SPI_SS1_N
    stm32::Pin{'B', 0, PinMode::input},                          // IR_INT1_N
    stm32::Pin{'B', 1, PinMode::analog},                         // VSYS_SENSE
    stm32::Pin{'B', 2, PinMode::push_pull, true},                // POWER_EN: 4.2 V of all boards
    stm32::Pin{'B', 3, PinMode::open_drain},                     // SYS_UART_DN
    stm32::Pin{'B', 4, PinMode::input},                          // CHARGE_STAT2A
    stm32::Pin{'B', 5, PinMode::push_pull, false},               // BUZZER
    stm32::Pin{'B', 6, PinMode::input},                          // GAUGE_BATLOW2
    stm32::Pin{'B', 7, PinMode::input},                          // GAUGE_BATGD2_N
    stm32::Pin{'B', 8, PinMode::alternate_open_drain, true, 4},  // GAUGE_SCL2, I2C1
    stm32::Pin{'B', 9, PinMode::alternate_open_drain, true, 4},  // GAUGE_SDA2
    stm32::Pin{'B', 10, PinMode::alternate_open_drain, true, 4},  // GAUGE_SCL1, I2C2
    stm32::Pin{'B', 11, PinMode::alternate_open_drain, true, 4},  // GAUGE_SDA1
    stm32::Pin{'B', 12, PinMode::open_drain},                     // LED, low: on
    stm32::Pin{'B', 13, PinMode::input},                          // BT_RTS
    stm32::Pin{'B', 14, PinMode::input},                          // BT_CTS
    stm32::Pin{'B', 15, PinMode::open_drain},                     // SYS_UART_UP
    stm32::Pin{'C', 0, PinMode::input},                           // CHARGE_STAT1A
    stm32::Pin{'C', 1, PinMode::input},                           // GAUGE_BATLOW1
    stm32::Pin{'C', 2, PinMode::input},                           // GAUGE_BATGD1_N
    stm32::Pin{'C', 3, PinMode::open_drain},                      // CHARGE_EN1_N: off
    stm32::Pin{'C', 4, PinMode::input},                           // IR_INT2_N
    stm32::Pin{'C', 5, PinMode::input},                           // TOUCH_INT_N
    stm32::Pin{'C', 6, PinMode::input},                           // SYS_DONE
    stm32::Pin{'C', 7, PinMode::open_drain},                      // SYS_PROG_N
    stm32::Pin{'C', 8, PinMode::input},                           // PATH_DC, high: plugged in
    stm32::Pin{'C', 9, PinMode::open_drain},                      // SYS_SPI_DIR
    stm32::Pin{'C', 10, PinMode::input},                          // BT_RX
    stm32::Pin{'C', 11, PinMode::input},                          // BT_TX
    stm32::Pin{'C', 12, PinMode::open_drain, false},              // SYS_SYNC_N, low: busy
    stm32::Pin{'C', 13, PinMode::open_drain},                     // SYS_PD_N
    stm32::Pin{'C', 14, PinMode::open_drain},  // SYS_WARMRST_N: low resets the other boards
    stm32::Pin{'C', 15, PinMode::open_drain},  // BT_RST
    stm32::Pin{'D', 2, PinMode::open_drain},   // CHARGE_EN2_N: off
    stm32::Pin{'H', 0, PinMode::input},        // OSC_IN
    stm32::Pin{'H', 1, PinMode::input},        // OSC_OUT
};
constexpr PALConfig pin_setup = stm32::pin_setup(pins);

// Once more, for it must never change unnoticed: high outputs, of which the port's modes say that they are
// outputs.
static_assert((pin_setup.PAData.odr >> 8 & 1) == 1 && (pin_setup.PAData.moder >> 16 & 3) == 1);  // SYS_REG_EN
static_assert((pin_setup.PBData.odr >> 2 & 1) == 1 && (pin_setup.PBData.moder >> 4 & 3) == 1);   // POWER_EN
static_assert((pin_setup.PCData.odr >> 14 & 1) == 1 &&
              (pin_setup.PCData.otyper >> 14 & 1) == 1);  // SYS_WARMRST_N

constexpr std::uint32_t i2c_bit_rate = 100'000;  // the gauges' highest [BQ27500 data sheet, 7.12]
constexpr iomode_t i2c_mode = PAL_MODE_ALTERNATE(4) | PAL_STM32_OTYPE_OPENDRAIN;

}  // namespace

void chibios::bring_to_rest() noexcept {}  // nothing of this board moves or shines

int main() {
  stm32::start_chip(pin_setup);
  stm32::obey_shutdown({GPIOC, 12, 13});
  static stm32::I2cBus back{I2CD1, {GPIOB, 8, i2c_mode}, i2c_bit_rate};
  static stm32::I2cBus front{I2CD2, {GPIOB, 10, i2c_mode}, i2c_bit_rate};
  static stm32::OnePin plugged{GPIOC, 8};
  back.start();
  front.start();
  static power_management::Parts<stm32::I2cBus, stm32::I2cBus, stm32::OnePin, chibios::Mutex> parts{
      back, front, plugged};
  stm32::run<amiro::PowerManagement, power_management::Board, power_management::Costs>(parts);
}
