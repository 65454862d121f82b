/// drivers::I2c on ChibiOS's I2C driver (DMA, interrupts): the caller's thread sleeps while a transfer runs.
/// Several levels may share a bus: a mutex with priority inheritance is held for one transfer.
///
/// Two things that the chip cannot do are done otherwise, both harmless to every part on these boards: a read
/// of one byte reads two and drops the second on the F103 [ChibiOS I2Cv1: rxbytes > 1]; a transfer without
/// any byte, by which a driver asks whether a part is there, reads two and drops them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <hal.h>
#include <span>

#include "ocm/base/result.hpp"

#include "firmware/chibios/port.hpp"
#include "firmware/drivers/bus.hpp"

namespace ocm::firmware::chibios::stm32 {

/// Where the lines of a bus are, for clearing it.
struct I2cPins {
  ioportid_t port;
  std::uint8_t scl;
  iomode_t mode;  ///< of SCL when the controller has it
};

class I2cBus {
 public:
  /// 100 kbit/s to 400 kbit/s.
  I2cBus(I2CDriver& driver, I2cPins pins, std::uint32_t bit_rate) noexcept;
  I2cBus(const I2cBus&) = delete;
  I2cBus& operator=(const I2cBus&) = delete;

  /// Clears the bus first: a part may hold SDA since a reset in the middle of a transfer. [UM10204 3.1.16]
  void start() noexcept;
  base::Status transfer(std::uint8_t address7, std::span<const std::uint8_t> write,
                        std::span<std::uint8_t> read) noexcept;

 private:
  msg_t attempt(std::uint8_t address7, std::span<const std::uint8_t> write,
                std::span<std::uint8_t> read) noexcept;
  void clear() noexcept;

  I2CDriver* driver_;
  I2cPins pins_;
  I2CConfig config_;
  Mutex mutex_;
};
static_assert(drivers::I2c<I2cBus>);

}  // namespace ocm::firmware::chibios::stm32
