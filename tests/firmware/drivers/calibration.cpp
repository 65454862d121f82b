#include "firmware/drivers/calibration.hpp"

#include <array>

#include <catch2/catch.hpp>

#include "firmware/drivers/at24c01b.hpp"
#include "sim/parts/at24c01b_model.hpp"
#include "tests/firmware/drivers/fixture.hpp"

namespace firmware_drivers_calibration_test {

using namespace drivers_tests;
using namespace ocm;
using namespace ocm::firmware;
using drivers::CalibrationRecord;

constexpr CalibrationRecord record{200, 4, {1, 256, 65535, 2289}};
static_assert(drivers::decode(drivers::encode(record)) == record);
static_assert(drivers::encode(record)[8] == 0x00 && drivers::encode(record)[9] == 0x01);  // low byte first

static_assert(drivers::later(1, 0) && drivers::later(0, 255) && !drivers::later(255, 0) &&
              !drivers::later(5, 5));

struct Eeprom {
  HandClock time;
  sim::Violations violations;
  sim::At24c01bModel model{violations, time.clock()};
  sim::I2cBus wires{violations};
  Eeprom() { wires.attach(model); }
};

using Calibration = drivers::Calibration<sim::I2cBus, 4>;

/// Steps of 10 ms until it is done.
template <class Read>
int run(Calibration& calibration, HandClock& time, Read read) {
  int steps = 0;
  while (calibration.busy() && steps < 1000) {
    calibration.step(read);
    time.pass(10ms);
    ++steps;
  }
  return steps;
}
base::Result<std::uint16_t> steady(std::size_t sensor) {
  return static_cast<std::uint16_t>(2300 + sensor);
}
std::array<std::uint16_t, 4> offsets(const Calibration& c) {
  return {c.offset(0), c.offset(1), c.offset(2), c.offset(3)};
}

TEST_CASE("a record with one bit wrong is none") {
  const auto bytes = drivers::encode(record);
  for (std::size_t bit = 0; bit < bytes.size() * 8; ++bit) {
    auto wrong = bytes;
    wrong[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    REQUIRE_FALSE(drivers::decode(wrong).has_value());
  }
  CalibrationRecord::Bytes empty;
  empty.fill(0xFF);
  CHECK_FALSE(drivers::decode(empty).has_value());
  empty.fill(0);
  CHECK_FALSE(drivers::decode(empty).has_value());
}

TEST_CASE("eeprom: pages, write cycle, acknowledge polling") {
  Eeprom e;
  drivers::At24c01b<sim::I2cBus> driver{e.wires};
  const std::array<std::uint8_t, 8> page{1, 2, 3, 4, 5, 6, 7, 8};
  REQUIRE(driver.ready().ok());
  REQUIRE(driver.write(0x20, page).ok());
  CHECK(driver.ready().error == Error::no_answer);
  CHECK(driver.write(0x28, page).error == Error::no_answer);
  e.time.pass(5ms);
  CHECK(driver.ready().ok());
  std::array<std::uint8_t, 8> back{};
  REQUIRE(driver.read(0x20, back).ok());
  CHECK(back == page);
  CHECK(driver.write(0x21, page).error == Error::bad_length);
  CHECK(driver.read(0x79, back).error == Error::bad_length);
  CHECK(e.violations.none());

  // What the driver refuses the part would have done to the page's start.
  std::array<std::uint8_t, 9> over{0x24, 9, 9, 9, 9, 9, 9, 9, 9};
  REQUIRE(e.wires.transfer(0x50, over, {}).ok());
  CHECK(complained(e.violations, "over the end of a page"));
  e.time.pass(5ms);
  REQUIRE(driver.read(0x20, back).ok());
  CHECK(back == std::array<std::uint8_t, 8>{9, 9, 9, 9, 9, 9, 9, 9});
}

TEST_CASE("an EEPROM as delivered has no offsets, and that is no error") {
  Eeprom e;
  Calibration c{e.wires};
  CHECK(c.start().ok());
  CHECK(offsets(c) == std::array<std::uint16_t, 4>{});
  e.model.set_present(false);
  CHECK(c.start().error == Error::no_answer);
}

TEST_CASE("measured, stored, and there again after a reset") {
  Eeprom e;
  Calibration c{e.wires};
  REQUIRE(c.start().ok());
  REQUIRE(c.request(false).ok());
  CHECK(c.request(false).error == Error::full);
  // Each step is one sample or one transfer: 64 and a first, three pages, one look.
  CHECK(run(c, e.time, steady) == 1 + 64 + 3 + 1);
  CHECK(c.last() == Error::none);
  CHECK(offsets(c) == std::array<std::uint16_t, 4>{2300, 2301, 2302, 2303});
  CHECK(e.model.pages_written() == 3);

  Calibration after_reset{e.wires};
  REQUIRE(after_reset.start().ok());
  CHECK(offsets(after_reset) == offsets(c));

  REQUIRE(after_reset.request(true).ok());
  run(after_reset, e.time, steady);
  CHECK(offsets(after_reset) == std::array<std::uint16_t, 4>{});
  Calibration again{e.wires};
  REQUIRE(again.start().ok());
  CHECK(offsets(again) == std::array<std::uint16_t, 4>{});
  CHECK(e.violations.none());
}

TEST_CASE("an offset is the rounded mean") {
  Eeprom e;
  Calibration c{e.wires};
  REQUIRE(c.request(false).ok());
  int n = 0;
  run(c, e.time, [&](std::size_t sensor) -> base::Result<std::uint16_t> {
    const int sample = n++ / 4;
    if (sensor == 3) return std::uint16_t{65535};
    return static_cast<std::uint16_t>(1000 + (sample < 8 + static_cast<int>(sensor) ? 1 : 0));
  });
  CHECK(offsets(c) == std::array<std::uint16_t, 4>{1001, 1001, 1001, 65535});  // 8, 9 and 10 sixteenths
}

TEST_CASE("a sensor that fails ends the measurement, and nothing changes") {
  Eeprom e;
  Calibration c{e.wires};
  REQUIRE(c.request(false).ok());
  run(c, e.time, steady);
  const auto before = offsets(c);
  REQUIRE(c.request(false).ok());
  int reads = 0;
  run(c, e.time, [&](std::size_t) -> base::Result<std::uint16_t> {
    if (++reads == 30) return Error::no_answer;
    return std::uint16_t{1};
  });
  CHECK(c.last() == Error::no_answer);
  CHECK(offsets(c) == before);
  CHECK(e.model.pages_written() == 3);
}

TEST_CASE("power that fails while a record is written leaves the one before") {
  const std::size_t page = GENERATE(1U, 2U, 3U);
  const int records = GENERATE(1, 2, 3);
  const bool reset_before = GENERATE(false, true);
  CAPTURE(page, records, reset_before);
  Eeprom e;
  {
    Calibration first{e.wires}, after_reset{e.wires};
    REQUIRE(first.start().ok());
    for (int i = 0; i < records; ++i) {
      REQUIRE(first.request(false).ok());
      run(first, e.time, [=](std::size_t) {
        return base::Result<std::uint16_t>{static_cast<std::uint16_t>(103 + i - records)};
      });
    }
    REQUIRE(after_reset.start().ok());
    Calibration& c = reset_before ? after_reset : first;
    e.model.tear(page);
    REQUIRE(c.request(false).ok());
    run(c, e.time, steady);
    CHECK(c.last() == Error::no_answer);
    CHECK(offsets(c) == std::array<std::uint16_t, 4>{2300, 2301, 2302, 2303});  // in use until the reset
  }
  e.model.set_present(true);
  Calibration c{e.wires};
  REQUIRE(c.start().ok());
  CHECK(offsets(c) == std::array<std::uint16_t, 4>{102, 102, 102, 102});
  // And the next one goes where the torn one is.
  REQUIRE(c.request(false).ok());
  run(c, e.time, steady);
  CHECK(c.last() == Error::none);
  Calibration next{e.wires};
  REQUIRE(next.start().ok());
  CHECK(offsets(next) == std::array<std::uint16_t, 4>{2300, 2301, 2302, 2303});
}

TEST_CASE("the sequence wraps and the newest still wins") {
  Eeprom e;
  Calibration c{e.wires};
  REQUIRE(c.start().ok());
  for (int i = 0; i < 300; ++i) {
    REQUIRE(c.request(true).ok());
    run(c, e.time, steady);
    REQUIRE(c.request(false).ok());
    run(c, e.time, [i](std::size_t) { return base::Result<std::uint16_t>{static_cast<std::uint16_t>(i)}; });
    Calibration other{e.wires};
    REQUIRE(other.start().ok());
    REQUIRE(other.offset(0) == i);
  }
}

TEST_CASE("a protected EEPROM is noticed, the offsets serve until the reset") {
  Eeprom e;
  Calibration c{e.wires};
  e.model.set_protected(true);
  REQUIRE(c.request(false).ok());
  run(c, e.time, steady);
  CHECK(c.last() == Error::bus_fault);
  CHECK(c.offset(0) == 2300);
}

TEST_CASE("a record of another board, or of other software, is not used") {
  Eeprom e;
  CalibrationRecord eight{1, 8, {1, 2, 3, 4, 5, 6, 7, 8}};
  auto bytes = drivers::encode(eight);
  std::copy(bytes.begin(), bytes.end(), e.model.bytes().begin() + 0x40);
  Calibration c{e.wires};
  REQUIRE(c.start().ok());
  CHECK(offsets(c) == std::array<std::uint16_t, 4>{});
}

TEST_CASE("what was measured is not overwritten by what was stored before, when the EEPROM comes back") {
  Eeprom e;
  Calibration c{e.wires};
  REQUIRE(c.start().ok());
  REQUIRE(c.request(true).ok());
  run(c, e.time, steady);
  e.model.set_present(false);
  REQUIRE(c.request(false).ok());
  run(c, e.time, steady);
  CHECK(c.last() == Error::no_answer);
  e.model.set_present(true);
  REQUIRE(c.start().ok());
  CHECK(c.offset(0) == 2300);
}

}  // namespace firmware_drivers_calibration_test
