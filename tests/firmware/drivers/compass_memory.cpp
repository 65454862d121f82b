#include "firmware/drivers/compass_memory.hpp"

#include <catch2/catch.hpp>

#include "firmware/drivers/part.hpp"
#include "sim/parts/at24c01b_model.hpp"
#include "tests/firmware/drivers/fixture.hpp"

namespace firmware_drivers_compass_memory_test {

using namespace drivers_tests;
using namespace ocm;
using namespace ocm::firmware;
using sensing::CompassFit;

struct Eeprom {
  HandClock time;
  sim::Violations violations;
  sim::At24c01bModel model{violations, time.clock()};
  sim::I2cBus wires{violations};
  Eeprom() { wires.attach(model); }
};
using Memory = drivers::CompassMemory<sim::I2cBus>;

constexpr CompassFit mine{{0.0412F, -0.0573F}, 0.152F, motion::radians(1.25F)};
constexpr CompassFit other{{-0.01F, 0.02F}, 0.2F, motion::radians(3.0F)};

/// Steps of 10 ms until nothing is left to do.
void write(Memory& memory, HandClock& time) {
  for (int steps = 0; memory.busy() && steps < 100; ++steps, time.pass(10ms)) memory.step();
  REQUIRE_FALSE(memory.busy());
}
void check_near(const base::Result<CompassFit>& fit, const CompassFit& expected) {
  REQUIRE(fit.ok());
  CHECK(fit->offset.x == Approx(expected.offset.x).margin(5e-5));
  CHECK(fit->offset.y == Approx(expected.offset.y).margin(5e-5));
  CHECK(fit->field == Approx(expected.field).margin(5e-5));
  CHECK(fit->error_rad == Approx(expected.error_rad).margin(1e-4));
}

TEST_CASE("a compass's calibration outlives a reset, and is known once it is in") {
  Eeprom e;
  Memory memory{e.wires};
  REQUIRE(memory.start().ok());
  CHECK(memory.stored().error == base::Error::not_sampled);
  memory.store(mine);
  CHECK(memory.stored().error == base::Error::not_sampled);
  write(memory, e.time);
  REQUIRE(memory.stored().ok());
  CHECK(*memory.stored() == mine);  // as it was given
  Memory after_reset{e.wires};
  REQUIRE(after_reset.start().ok());
  check_near(after_reset.stored(), mine);
  CHECK(e.violations.none());
}

TEST_CASE("power that fails while a calibration is written leaves the one before") {
  for (std::size_t page = 1; page <= 3; ++page) {
    Eeprom e;
    Memory memory{e.wires};
    REQUIRE(memory.start().ok());
    memory.store(mine);
    write(memory, e.time);
    memory.store(other);
    e.model.tear(page);
    write(memory, e.time);
    CHECK(memory.stored().error == base::Error::not_sampled);
    e.model.set_present(true);
    Memory after_reset{e.wires};
    REQUIRE(after_reset.start().ok());
    check_near(after_reset.stored(), mine);
  }
}

TEST_CASE("a calibration that comes while one is written takes its place") {
  Eeprom e;
  Memory memory{e.wires};
  REQUIRE(memory.start().ok());
  memory.store(mine);
  memory.step();
  memory.step();
  memory.store(other);
  write(memory, e.time);
  CHECK(*memory.stored() == other);
  Memory after_reset{e.wires};
  REQUIRE(after_reset.start().ok());
  check_near(after_reset.stored(), other);
}

TEST_CASE("a memory that keeps nothing, or is away, is not taken for one that does") {
  Eeprom e;
  Memory memory{e.wires};
  REQUIRE(memory.start().ok());
  e.model.set_protected(true);
  memory.store(mine);
  write(memory, e.time);
  CHECK(memory.stored().error == base::Error::not_sampled);
  e.model.set_present(false);
  CHECK(memory.start().error == base::Error::no_answer);
  CHECK_FALSE(memory.check().ok());
}

TEST_CASE("the records of others are not taken for a compass's") {
  Eeprom e;
  const auto bytes = drivers::encode({.sequence = 1, .count = 8, .offsets = {1, 2, 3, 4, 5, 6, 7, 8}});
  std::copy(bytes.begin(), bytes.end(), e.model.bytes().begin() + drivers::calibration_slots[0]);
  Memory memory{e.wires};
  REQUIRE(memory.start().ok());
  CHECK(memory.stored().error == base::Error::not_sampled);
}

}  // namespace firmware_drivers_compass_memory_test
