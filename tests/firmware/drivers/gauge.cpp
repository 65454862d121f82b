#include <catch2/catch.hpp>

#include "firmware/drivers/bq27500.hpp"
#include "sim/parts/bq27500_model.hpp"
#include "tests/firmware/drivers/fixture.hpp"

namespace firmware_drivers_gauge_test {

using namespace drivers_tests;
using namespace ocm;
using namespace ocm::firmware;
using boards::GaugeReading;
using drivers::bq27500::Battery;
using drivers::bq27500::combine;

constexpr Battery draining(std::uint16_t minutes, std::int16_t power, std::uint8_t charge) {
  return {true, false, minutes, 65535, power, charge};
}
constexpr Battery filling(std::uint16_t minutes, std::int16_t power, std::uint8_t charge) {
  return {true, false, 65535, minutes, power, charge};
}

// The thesis's figure 7.2: 52 %, 137 minutes, -930 mW, here as two halves.
static_assert(combine(draining(137, -465, 52), draining(137, -465, 52), false) ==
              GaugeReading{false, false, 52, 137, -930});
static_assert(combine(draining(100, -400, 40), draining(201, -500, 61), false) ==
              GaugeReading{false, false, 50, 150, -900});
static_assert(combine(filling(30, 2000, 80), filling(45, 2100, 70), true) ==
              GaugeReading{true, true, 75, 45, 4100});
// One that does not know: not (65535 + 77)/2 = 32806, as in the thesis's figure 6.3.
static_assert(combine(draining(77, -300, 50), draining(65535, 0, 50), false).minutes == 77);
static_assert(combine(draining(65535, 0, 50), draining(65535, 0, 50), false).minutes == 65535);
// Plugged in, but drained all the same.
static_assert(!combine(draining(77, -300, 50), draining(77, -300, 50), true).charging);
// Full: no longer charging.
constexpr Battery full{true, true, 65535, 65535, 0, 100};
static_assert(combine(full, full, true) == GaugeReading{true, false, 100, 65535, 0});
static_assert(combine(full, filling(5, 100, 98), true).charging);
// One battery only, and none.
static_assert(combine(Battery{}, draining(60, -900, 30), false) == GaugeReading{false, false, 30, 60, -900});
static_assert(combine(draining(60, -900, 30), Battery{}, false) == GaugeReading{false, false, 30, 60, -900});
static_assert(combine(Battery{}, Battery{}, true) == GaugeReading{true, false, 0, 65535, 0});
// The sum does not wrap.
static_assert(combine(draining(1, -30000, 1), draining(1, -30000, 1), false).power_mw == -32768);

struct Gauge {
  sim::Violations violations;
  sim::GaugeState state{true, false, 137, 65535, -930, 52};
  sim::Bq27500Model model{violations, [this] { return state; }};
  sim::I2cBus wires{violations};
  SpoiledI2c bus{&wires, {}};
  drivers::Bq27500<SpoiledI2c> driver{bus};
  Gauge() { wires.attach(model); }
};

TEST_CASE("gauge: what it says") {
  Gauge g;
  REQUIRE(g.driver.start().ok());
  CHECK(g.driver.read() == base::Result<Battery>{Battery{true, false, 137, 65535, -930, 52}});
  g.state = {false, true, 65535, 45, 2047, 100};
  CHECK(g.driver.read() == base::Result<Battery>{Battery{false, true, 65535, 45, 2047, 100}});
  CHECK(g.violations.none());
}

TEST_CASE("gauge: its battery alone, and none") {
  Gauge g;
  REQUIRE(g.driver.start().ok());
  g.state.voltage_mv = 3812;
  g.state.current_ma = -122;
  g.state.remaining_mah = 551;
  g.state.temperature_dk = 2931;
  CHECK(g.driver.measure() ==
        base::Result<boards::BatteryReading>{boards::BatteryReading{3812, -122, 551, 2931}});
  g.state.battery = false;
  CHECK(g.driver.measure() == base::Result<boards::BatteryReading>{boards::BatteryReading{}});
  CHECK(g.violations.none());
  g.wires.set_stuck(true);
  CHECK(g.driver.measure().error == Error::bus_fault);
}

TEST_CASE("gauge: what is wrong is noticed") {
  Gauge g;
  SECTION("address") {
    g.bus.spoil = [](std::uint8_t& address, auto&) { address = 0xAA >> 2; };
    CHECK(g.driver.start().error == Error::no_answer);
  }
  SECTION("subcommand") {
    g.bus.spoil = [](std::uint8_t&, auto& bytes) {
      if (bytes.size() == 3) bytes[1] = 0x02;
    };
    CHECK(g.driver.start().error == Error::no_answer);
    g.bus.spoil = [](std::uint8_t&, auto& bytes) {
      if (bytes.size() == 3) bytes[1] = 0x41;  // reset
    };
    CHECK(g.driver.start().error == Error::no_answer);
    CHECK(complained(g.violations, "changes it"));
  }
  SECTION("odd command") {
    REQUIRE(g.driver.start().ok());
    g.bus.spoil = [](std::uint8_t&, auto& bytes) { bytes[0] |= 0x01; };
    CHECK(g.driver.read().ok());
    CHECK(complained(g.violations, "half a word"));
  }
  SECTION("command that is none") {
    g.bus.spoil = [](std::uint8_t&, auto& bytes) { bytes[0] |= 0x80; };
    CHECK(g.driver.read().error == Error::no_answer);
    CHECK(complained(g.violations, "0x7F"));
  }
}

TEST_CASE("gauge: absence and a bus that fails") {
  Gauge g;
  g.model.set_present(false);
  CHECK(g.driver.start().error == Error::no_answer);
  CHECK(g.driver.read().error == Error::no_answer);
  g.model.set_present(true);
  CHECK(g.driver.start().ok());
  g.wires.set_stuck(true);
  CHECK(g.driver.read().error == Error::bus_fault);
}

}  // namespace firmware_drivers_gauge_test
