// DiWheelDrive on its own chip. Pins: AMiRo-OS boards/DiWheelDrive/board.h, version 1.1;
// docs/boards/di_wheel_drive.md.
#include <array>

#include "ocm/topics/amiro.hpp"

#include "firmware/boards/di_wheel_drive/board.hpp"
#include "firmware/boards/di_wheel_drive/costs.hpp"
#include "firmware/boards/di_wheel_drive/parts.hpp"
#include "firmware/chibios/fault.hpp"
#include "firmware/chibios/stm32/board_signals.hpp"
#include "firmware/chibios/stm32/chip.hpp"
#include "firmware/chibios/stm32/host_line.hpp"
#include "firmware/chibios/stm32/i2c_bus.hpp"
#include "firmware/chibios/stm32/main.hpp"
#include "firmware/chibios/stm32/motor_timers.hpp"
#include "firmware/chibios/stm32/pins.hpp"
#include "firmware/chibios/stm32/spi_device.hpp"

namespace chibios = ocm::firmware::chibios;
namespace stm32 = chibios::stm32;
namespace di_wheel_drive = ocm::firmware::boards::di_wheel_drive;
using stm32::PinMode;

namespace {

constexpr std::array pins{
    stm32::Pin{'A', 0, PinMode::input},                  // WKUP
    stm32::Pin{'A', 1, PinMode::open_drain},             // LED, low: on
    stm32::Pin{'A', 2, PinMode::alternate},              // DRIVE_PWM1A, TIM2 channel 3
    stm32::Pin{'A', 3, PinMode::alternate},              // DRIVE_PWM1B, channel 4
    stm32::Pin{'A', 5, PinMode::alternate},              // MOTION_SCLK, SPI1
    stm32::Pin{'A', 6, PinMode::pull_up},                // MOTION_MISO
    stm32::Pin{'A', 7, PinMode::alternate},              // MOTION_MOSI
    stm32::Pin{'A', 9, PinMode::alternate},              // PROG, USART1 transmits
    stm32::Pin{'A', 10, PinMode::pull_up},               // PROG, USART1 receives
    stm32::Pin{'A', 11, PinMode::pull_down},             // CAN_RX; never fed through this pin [AMiRo-OS]
    stm32::Pin{'A', 12, PinMode::alternate},             // CAN_TX
    stm32::Pin{'A', 15, PinMode::alternate},             // DRIVE_PWM2B, channel 1
    stm32::Pin{'B', 1, PinMode::analog},                 // DRIVE_SENSE2
    stm32::Pin{'B', 2, PinMode::push_pull, false},       // POWER_EN of the motors
    stm32::Pin{'B', 3, PinMode::alternate},              // DRIVE_PWM2A, channel 2
    stm32::Pin{'B', 6, PinMode::input},                  // DRIVE_ENC1A, TIM4
    stm32::Pin{'B', 7, PinMode::input},                  // DRIVE_ENC1B
    stm32::Pin{'B', 8, PinMode::alternate_open_drain},   // COMPASS_SCL, I2C1
    stm32::Pin{'B', 9, PinMode::alternate_open_drain},   // COMPASS_SDA
    stm32::Pin{'B', 10, PinMode::alternate_open_drain},  // IR_SCL, I2C2
    stm32::Pin{'B', 11, PinMode::alternate_open_drain},  // IR_SDA
    stm32::Pin{'B', 12, PinMode::input},                 // IR_INT
    stm32::Pin{'B', 14, PinMode::open_drain},            // SYS_UART_UP
    stm32::Pin{'C', 0, PinMode::analog},                 // DRIVE_SENSE1
    stm32::Pin{'C', 1, PinMode::open_drain, false},      // SYS_SYNC_N, low: busy
    stm32::Pin{'C', 3, PinMode::input},                  // PATH_DCSTAT
    stm32::Pin{'C', 5, PinMode::push_pull, false},       // PATH_DCEN: not charged through the pins below
    stm32::Pin{'C', 6, PinMode::input},                  // DRIVE_ENC2B, TIM3
    stm32::Pin{'C', 7, PinMode::input},                  // DRIVE_ENC2A
    stm32::Pin{'C', 8, PinMode::open_drain},             // SYS_PD_N
    stm32::Pin{'C', 9, PinMode::input},                  // SYS_REG_EN
    stm32::Pin{'C', 10, PinMode::input},                 // SYS_UART_RX
    stm32::Pin{'C', 11, PinMode::input},                 // SYS_UART_TX
    stm32::Pin{'C', 13, PinMode::push_pull},             // ACCEL_SS_N
    stm32::Pin{'C', 14, PinMode::push_pull},             // GYRO_SS_N
    stm32::Pin{'D', 0, PinMode::input},                  // OSC_IN
    stm32::Pin{'D', 1, PinMode::input},                  // OSC_OUT
    stm32::Pin{'D', 2, PinMode::open_drain},             // SYS_WARMRST_N
};
constexpr PALConfig pin_setup = stm32::pin_setup(pins);
constexpr std::uint8_t motor_power = 2;  // on port B

constexpr std::uint32_t i2c_bit_rate = 400'000;      // [AMiRo-OS global.hpp]
constexpr std::uint32_t spi1_clock_hz = 72'000'000;  // APB2

}  // namespace

void chibios::bring_to_rest() noexcept {
  palClearPad(GPIOB, motor_power);
  stm32::MotorTimers::stop();
}

int main() {
  stm32::start_chip(pin_setup);
  stm32::obey_shutdown({GPIOC, 1, 8});
  static stm32::I2cBus compass{I2CD1, {GPIOB, 8, PAL_MODE_STM32_ALTERNATE_OPENDRAIN}, i2c_bit_rate};
  static stm32::I2cBus floor{I2CD2, {GPIOB, 10, PAL_MODE_STM32_ALTERNATE_OPENDRAIN}, i2c_bit_rate};
  static stm32::SpiBus motion{SPID1, spi1_clock_hz};
  static stm32::SpiDevice gyroscope{motion, GPIOC, 14};
  static stm32::SpiDevice accelerometer{motion, GPIOC, 13};
  static stm32::MotorTimers motors;
  static stm32::OnePin power{GPIOB, motor_power};
  compass.start();
  floor.start();
  motors.start();
  static di_wheel_drive::Parts<stm32::I2cBus, stm32::I2cBus, stm32::SpiDevice, stm32::SpiDevice,
                               stm32::MotorTimers, stm32::OnePin, chibios::Mutex>
      parts{compass, floor, gyroscope, accelerometer, motors, power};
  stm32::run<amiro::DiWheelDrive, di_wheel_drive::Board, di_wheel_drive::Costs, stm32::HostLine>(parts);
}
