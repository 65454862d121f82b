#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "firmware/chibios/stm32/i2c_bus.hpp"
#include "firmware/chibios/stm32/spi_device.hpp"
#include "firmware/stm32/fixture.hpp"

namespace firmware_stm32_buses_test {

using namespace ocm::stm32_tests;
using namespace ocm::firmware::chibios;
using ocm::base::Error;
namespace drivers = ocm::firmware::drivers;
using Calls = std::vector<std::string>;

constexpr std::uint32_t alternate = 15;
constexpr std::uint8_t part = 0x68;

/// Nine clocks, 50 us each at least, then SCL is the controller's. [UM10204 3.1.16]
Calls cleared() {
  Calls calls{"B8 high", "B8 mode 7"};
  for (int i = 0; i < 9; ++i) calls.insert(calls.end(), {"B8 low", "sleep 20", "B8 high", "sleep 20"});
  calls.push_back("B8 mode 15");
  return calls;
}
Calls operator+(Calls left, const Calls& right) {
  left.insert(left.end(), right.begin(), right.end());
  return left;
}

struct I2c {
  Chip played;
  I2CDriver driver{};
  stm32::I2cBus bus{driver, {GPIOB, 8, alternate}, 100'000};
};

TEST_CASE("I2C: the bus is cleared before its controller has it") {
  I2c i2c;
  i2c.bus.start();
  CHECK(i2c.played.calls == cleared() + Calls{"start"});
  REQUIRE(i2c.driver.config != nullptr);
  CHECK(i2c.driver.config->clock_speed == 100'000);
  CHECK(i2c.driver.config->duty_cycle == STD_DUTY_CYCLE);
  I2CDriver fast_driver{};
  stm32::I2cBus fast{fast_driver, {GPIOB, 8, alternate}, 400'000};
  fast.start();
  CHECK(fast_driver.config->duty_cycle == FAST_DUTY_CYCLE_2);
}

TEST_CASE("I2C: a read of one byte, and a look whether a part is there, read two") {
  I2c i2c;
  i2c.played.received = {0x11, 0x22, 0x33};
  std::array<std::uint8_t, 3> in{0xAA, 0xAA, 0xAA};
  const std::array<std::uint8_t, 1> out{7};
  REQUIRE(i2c.bus.transfer(part, out, std::span{in}.first(1)).ok());
  CHECK(in == std::array<std::uint8_t, 3>{0x11, 0xAA, 0xAA});
  REQUIRE(i2c.bus.transfer(part, {}, {}).ok());
  REQUIRE(i2c.bus.transfer(part, out, {}).ok());
  REQUIRE(i2c.bus.transfer(part, out, in).ok());
  CHECK(in == std::array<std::uint8_t, 3>{0x11, 0x22, 0x33});
  REQUIRE(i2c.bus.transfer(part, {}, std::span{in}.first(2)).ok());
  CHECK(i2c.played.calls == Calls{"to 104 write 7, read 2 within 10000", "to 104 read 2 within 10000",
                                  "to 104 write 7, read 0 within 10000",
                                  "to 104 write 7, read 3 within 10000", "to 104 read 2 within 10000"});
}

TEST_CASE("I2C: no answer is the part's, anything else the bus's; a bus that hangs is cleared") {
  I2c i2c;
  i2c.bus.start();
  i2c.played.calls.clear();
  std::array<std::uint8_t, 2> in{};
  i2c.played.answers = {MSG_RESET, MSG_RESET, MSG_TIMEOUT, MSG_OK};
  i2c.played.errors = I2C_ACK_FAILURE;
  CHECK(i2c.bus.transfer(part, {}, in).error == Error::no_answer);
  i2c.played.errors = I2C_ACK_FAILURE | I2C_ARBITRATION_LOST;
  CHECK(i2c.bus.transfer(part, {}, in).error == Error::bus_fault);
  i2c.played.calls.clear();
  i2c.played.errors = I2C_ACK_FAILURE;
  CHECK(i2c.bus.transfer(part, {}, in).error == Error::bus_fault);
  CHECK(i2c.played.calls == Calls{"to 104 read 2 within 10000", "stop"} + cleared() + Calls{"start"});
  CHECK(i2c.driver.config != nullptr);
  CHECK(i2c.bus.transfer(part, {}, in).ok());
}

TEST_CASE("SPI: a part is selected for its frame, with the fastest clock that it takes") {
  Chip played;
  SPIDriver driver{};
  stm32::SpiBus bus{driver, 36'000'000};
  stm32::SpiDevice device{bus, GPIOC, 15};
  played.received = {9, 8};
  const std::array<std::uint8_t, 2> out{1, 2};
  std::array<std::uint8_t, 2> in{};
  REQUIRE(device.transfer({.mode = 3, .highest_clock_hz = 10'000'000}, out, in).ok());
  CHECK(in == std::array<std::uint8_t, 2>{9, 8});
  CHECK(played.calls == Calls{"start", "C15 low", "exchange 1 2", "C15 high", "stop"});
  CHECK(driver.config == nullptr);  // of this frame, and no longer there

  // 36 MHz by 2, 4, 8 ... 256; BR is in bits 5 to 3. [RM0008 25.5.1]
  const auto divided = [&](std::uint32_t highest) {
    const auto done = device.transfer({.mode = 0, .highest_clock_hz = highest}, {}, {});
    return done.ok() ? 36'000'000U >> ((driver.last.cr1 >> 3U) + 1) : 0;
  };
  CHECK(divided(100'000'000) == 18'000'000);
  CHECK(divided(18'000'000) == 18'000'000);
  CHECK(divided(17'999'999) == 9'000'000);
  CHECK(divided(140'625) == 140'625);
  CHECK(divided(140'624) == 0);
  CHECK((driver.last.cr1 & 7U) == 0);
  REQUIRE(device.transfer({.mode = 3, .highest_clock_hz = 10'000'000}, {}, {}).ok());
  CHECK(driver.last.cr1 == (1U << 3U | 3U));
}

TEST_CASE("SPI: what cannot be is refused, and nothing is selected") {
  Chip played;
  SPIDriver driver{};
  stm32::SpiBus bus{driver, 36'000'000};
  stm32::SpiDevice device{bus, GPIOC, 15};
  const std::array<std::uint8_t, 2> out{1, 2};
  std::array<std::uint8_t, 3> in{};
  CHECK(device.transfer({.mode = 0, .highest_clock_hz = 10'000'000}, out, in).error == Error::bad_length);
  CHECK(device.transfer({.mode = 0, .highest_clock_hz = 100'000}, out, std::span{in}.first(2)).error ==
        Error::out_of_range);
  CHECK(played.calls.empty());
}

}  // namespace firmware_stm32_buses_test
