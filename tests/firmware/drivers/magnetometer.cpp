#include <array>

#include <catch2/catch.hpp>

#include "firmware/drivers/hmc5883l.hpp"
#include "sim/parts/hmc5883l_model.hpp"
#include "tests/firmware/drivers/fixture.hpp"

namespace firmware_drivers_magnetometer_test {

using namespace drivers_tests;
using namespace ocm;
using namespace ocm::firmware;
using boards::MagneticField;

// The thesis's log, figure 7.2: 21, -367 and 595 counts. The order is x, z, y. [data sheet, table 2]
static_assert(drivers::hmc5883l::decode(std::array<std::uint8_t, 6>{0x00, 0x15, 0x02, 0x53, 0xFE, 0x91}) ==
              base::Result<MagneticField>{MagneticField{53'760, -939'520, 1'523'200}});
// The ends, 0xF800 and 0x07FF. [data sheet, Data Output X Registers]
static_assert(drivers::hmc5883l::decode(std::array<std::uint8_t, 6>{0xF8, 0x00, 0x07, 0xFF, 0x00, 0x00}) ==
              base::Result<MagneticField>{MagneticField{-5'242'880, 0, 5'240'320}});
// -4096 is no number but an overflow.
static_assert(drivers::hmc5883l::decode(std::array<std::uint8_t, 6>{0x08, 0x00, 0x00, 0x00, 0x00, 0x00})
                  .error == base::Error::bus_fault);  // 2048 needs a thirteenth bit
static_assert(drivers::hmc5883l::decode(std::array<std::uint8_t, 6>{0x00, 0x00, 0xF0, 0x00, 0x00, 0x00})
                  .error == Error::not_sampled);

struct Magnetometer {
  HandClock time;
  sim::Violations violations;
  MagneticField field{53'760, -939'520, 1'523'200};
  sim::Hmc5883lModel model{violations, time.clock(), [this] { return field; }};
  sim::I2cBus wires{violations};
  SpoiledI2c bus{&wires, {}};
  drivers::Hmc5883l<SpoiledI2c> driver{bus};
  Magnetometer() { wires.attach(model); }
};

TEST_CASE("magnetometer: configured, settled, read, count by count") {
  Magnetometer m;
  const auto settling = m.driver.start();
  REQUIRE(settling.ok());
  CHECK(m.driver.read() == base::Result<MagneticField>{MagneticField{}});  // not yet
  m.time.pass(*settling);
  for (int count = -2048; count <= 2047; ++count) {
    m.field = {count * 2560, -1, 2560};
    m.field.y = (count / 2) * 2560;
    REQUIRE(m.driver.read() == base::Result<MagneticField>{m.field});
  }
  m.field = {2048 * 2560, 0, 0};
  CHECK(m.driver.read().error == Error::not_sampled);
  CHECK(m.driver.check().ok());
  CHECK(m.violations.none());
}

// 50 ms from power on, 6 ms from a change of the mode. [data sheet, Operational Examples: 56 ms]
TEST_CASE("magnetometer model: nothing is measured before it is on and in its mode for long enough") {
  Magnetometer m;
  const auto first_at = [&](std::chrono::microseconds after) {
    m.time.pass(after - 1us);
    CHECK(m.driver.read() == base::Result<MagneticField>{MagneticField{}});
    m.time.pass(1us);
    CHECK(m.driver.read() == base::Result<MagneticField>{m.field});
  };
  SECTION("from power on") {
    m.time.pass(10ms);
    REQUIRE(m.driver.start().ok());
    first_at(40ms);
  }
  SECTION("from the mode") {
    m.time.pass(49ms);
    REQUIRE(m.driver.start().ok());
    first_at(6ms);
  }
  SECTION("from the mode, long after") {
    m.time.pass(10s);
    REQUIRE(m.driver.start().ok());
    first_at(6ms);
  }
}

TEST_CASE("magnetometer: reading the mode, or a part of the outputs, locks them") {
  Magnetometer m;
  REQUIRE(m.driver.start().ok());
  m.time.pass(56ms);
  REQUIRE(m.driver.read().ok());
  const MagneticField before = m.field;
  std::array<std::uint8_t, 2> two{};
  const std::array<std::uint8_t, 1> first{3};
  REQUIRE(m.wires.transfer(0x1E, first, two).ok());
  m.field = {};
  CHECK(m.driver.read() == base::Result<MagneticField>{before});  // these six end the lock
  CHECK(m.driver.read() == base::Result<MagneticField>{MagneticField{}});
}

TEST_CASE("magnetometer: what is wrong is noticed") {
  Magnetometer m;
  SECTION("address") {
    m.bus.spoil = [](std::uint8_t& address, auto&) { address = 0x3C; };  // shifted
    CHECK(m.driver.start().error == Error::no_answer);
  }
  SECTION("several registers in one write") {
    const std::array<std::uint8_t, 4> all{0, 0x78, 0xA0, 0x00};
    CHECK(m.wires.transfer(0x1E, all, {}).ok());
    CHECK(complained(m.violations, "increment"));
    CHECK(m.driver.check().error == Error::no_answer);  // only the first went in
  }
  SECTION("gain") {
    m.bus.spoil = [](std::uint8_t&, auto& bytes) {
      if (bytes.size() == 2 && bytes[0] == 1) bytes[1] = 0x20;
    };
    REQUIRE(m.driver.start().ok());
    CHECK(m.driver.check().error == Error::no_answer);
    m.time.pass(56ms);
    CHECK(m.driver.read()->x == 59 * 2560);  // 0.05376 G at 1090 counts/G: the number is another
  }
  SECTION("reserved bits") {
    m.bus.spoil = [](std::uint8_t&, auto& bytes) {
      if (bytes.size() == 2) bytes[1] |= 0x9C;
    };
    REQUIRE(m.driver.start().ok());
    CHECK(complained(m.violations, "bit 7 of configuration A"));
    CHECK(complained(m.violations, "configuration B"));
    CHECK(complained(m.violations, "mode"));
  }
  SECTION("single measurement in place of continuous") {
    m.bus.spoil = [](std::uint8_t&, auto& bytes) {
      if (bytes.size() == 2 && bytes[0] == 2) bytes[1] = 0x01;
    };
    REQUIRE(m.driver.start().ok());
    m.time.pass(56ms);
    CHECK(m.driver.read() == base::Result<MagneticField>{MagneticField{}});
  }
}

TEST_CASE("magnetometer: absence, reset, a bus that fails") {
  Magnetometer m;
  m.model.set_present(false);
  CHECK(m.driver.start().error == Error::no_answer);
  CHECK(m.driver.read().error == Error::no_answer);
  m.model.set_present(true);
  REQUIRE(m.driver.start().ok());
  CHECK(m.driver.check().ok());
  m.model.set_present(false);
  m.model.set_present(true);
  CHECK(m.driver.check().error == Error::no_answer);
  m.wires.set_stuck(true);
  CHECK(m.driver.check().error == Error::bus_fault);
  CHECK(m.violations.none());
}

}  // namespace firmware_drivers_magnetometer_test
