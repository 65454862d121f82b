#include "firmware/chibios/stm32/i2c_bus.hpp"

#include <algorithm>
#include <array>

namespace ocm::firmware::chibios::stm32 {
namespace {

/// A transfer of n bytes takes n * 90 us at 100 kbit/s; parts stretch the clock by less than a millisecond.
constexpr std::uint32_t timeout_ms = 10;

/// The longest page of the boards' parts that is read with its address, and then some.
constexpr std::size_t shortest_read = 2;

}  // namespace

I2cBus::I2cBus(I2CDriver& driver, I2cPins pins, std::uint32_t bit_rate) noexcept
    : driver_(&driver),
      pins_(pins),
      config_{OPMODE_I2C, bit_rate, bit_rate > 100'000 ? FAST_DUTY_CYCLE_2 : STD_DUTY_CYCLE} {}

void I2cBus::start() noexcept {
  clear();
  i2cStart(driver_, &config_);
}

// Nine clocks let any part finish the byte that it is sending.
void I2cBus::clear() noexcept {
  palSetPad(pins_.port, pins_.scl);
  palSetPadMode(pins_.port, pins_.scl, PAL_MODE_OUTPUT_OPENDRAIN);
  for (int i = 0; i < 9; ++i) {
    palClearPad(pins_.port, pins_.scl);
    chThdSleepMicroseconds(20);  // the kernel's shortest sleep is 10 us
    palSetPad(pins_.port, pins_.scl);
    chThdSleepMicroseconds(20);
  }
  palSetPadMode(pins_.port, pins_.scl, pins_.mode);
}

base::Status I2cBus::transfer(std::uint8_t address7, std::span<const std::uint8_t> write,
                              std::span<std::uint8_t> read) noexcept {
  drivers::Guard guard{mutex_};
  msg_t result = MSG_OK;
  if (read.size() == 1 || (read.empty() && write.empty())) {
    std::array<std::uint8_t, shortest_read> bytes{};
    result = attempt(address7, write, bytes);
    std::copy_n(bytes.begin(), read.size(), read.begin());
  } else {
    result = attempt(address7, write, read);
  }
  if (result == MSG_OK) return {};
  const i2cflags_t errors = i2cGetErrors(driver_);
  if (result == MSG_TIMEOUT) {  // the driver is locked from now on until it is started again
    i2cStop(driver_);
    clear();
    i2cStart(driver_, &config_);
    return base::Error::bus_fault;
  }
  return errors == I2C_ACK_FAILURE ? base::Error::no_answer : base::Error::bus_fault;
}

msg_t I2cBus::attempt(std::uint8_t address7, std::span<const std::uint8_t> write,
                      std::span<std::uint8_t> read) noexcept {
  if (write.empty())
    return i2cMasterReceiveTimeout(driver_, address7, read.data(), read.size(), MS2ST(timeout_ms));
  return i2cMasterTransmitTimeout(driver_, address7, write.data(), write.size(), read.data(), read.size(),
                                  MS2ST(timeout_ms));
}

}  // namespace ocm::firmware::chibios::stm32
