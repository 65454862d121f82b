#include <array>

#include <catch2/catch.hpp>

#include "firmware/drivers/l3g4200d.hpp"
#include "firmware/drivers/lis331dlh.hpp"
#include "sim/parts/st_motion_model.hpp"
#include "tests/firmware/drivers/fixture.hpp"

namespace firmware_drivers_motion_test {

using namespace drivers_tests;
using namespace ocm;
using namespace ocm::firmware;
using boards::AngularRate;
using boards::SpecificForce;

constexpr AngularRate decode_rate(std::array<std::uint8_t, 6> out) {
  return drivers::L3g4200dChip::decode(out);
}
constexpr SpecificForce decode_force(std::array<std::uint8_t, 6> out) {
  return drivers::Lis331dlhChip::decode(out);
}

// 100, -100, 200 dps at 250 dps full scale: 11428, -11428, 22857 digits of 8.75 mdps. [AN3393, table of the
// output registers' content against the rate, BLE = 0]
static_assert(decode_rate({0xA4, 0x2C, 0x5C, 0xD3, 0x49, 0x59}) == AngularRate{11428, -11428, 22857});
// 350 mg, -350 mg, 1 g at 2 g full scale: 350, -350, 1024 digits of 12 bits [ST AN3308 4.2.3, the same
// format]; at 4 g each is two of 1/1024 g.
static_assert(decode_force({0xE0, 0x15, 0x20, 0xEA, 0x00, 0x40}) == SpecificForce{700, -700, 2048});
// The lowest four bits are not part of the number.
static_assert(decode_force({0x0F, 0x00, 0xFF, 0xFF, 0xFF, 0x7F}) == SpecificForce{0, -2, 4094});

struct Gyroscope {
  HandClock time;
  sim::Violations violations;
  AngularRate rate{11, -22, 28571};
  sim::L3g4200dModel model{violations, time.clock(), [this] { return rate; }};
  SpoiledSpi bus{&model, {}};
  drivers::L3g4200d<SpoiledSpi> driver{bus};
};
struct Accelerometer {
  HandClock time;
  sim::Violations violations;
  SpecificForce force{26, -4096, 4094};
  sim::Lis331dlhModel model{violations, time.clock(), [this] { return force; }};
  SpoiledSpi bus{&model, {}};
  drivers::Lis331dlh<SpoiledSpi> driver{bus};
};

TEST_CASE("gyroscope: configured, settled, read, digit by digit") {
  Gyroscope g;
  const auto settling = g.driver.start();
  REQUIRE(settling.ok());
  g.time.pass(*settling);
  CHECK(g.driver.read() == base::Result<AngularRate>{g.rate});
  for (int value = -28571; value <= 28571; value += 997) {
    g.rate = {static_cast<std::int16_t>(value), static_cast<std::int16_t>(-value), 1};
    REQUIRE(g.driver.read() == base::Result<AngularRate>{g.rate});
  }
  CHECK(g.violations.none());
}

TEST_CASE("gyroscope: before it is settled there is nothing, so the driver must say how long that is") {
  Gyroscope g;
  const auto settling = g.driver.start();
  REQUIRE(settling.ok());
  g.time.pass(*settling - 1us);
  CHECK(g.driver.read() == base::Result<AngularRate>{AngularRate{}});
}

TEST_CASE("gyroscope: a wrong SPI mode is noticed") {
  Gyroscope g;
  const int mode = GENERATE(0, 1, 2);
  g.bus.spoil = [mode](drivers::SpiSettings& s, auto&) { s.mode = static_cast<std::uint8_t>(mode); };
  const auto started = g.driver.start();
  CHECK(complained(g.violations, "SPI mode"));
  if (mode != 0) CHECK(started.error == Error::no_answer);  // mode 0 works, though it is not the data sheet's
}

TEST_CASE("gyroscope: too fast a clock is noticed") {
  Gyroscope g;
  g.bus.spoil = [](drivers::SpiSettings& s, auto&) { s.highest_clock_hz = 18'000'000; };
  CHECK(g.driver.start().error == Error::no_answer);
  CHECK(complained(g.violations, "10 MHz"));
}

TEST_CASE("gyroscope: without the auto-increment bit nothing fits") {
  Gyroscope g;
  g.bus.spoil = [](drivers::SpiSettings&, auto& bytes) { bytes[0] &= 0xBF; };
  CHECK(g.driver.start().error == Error::no_answer);
  CHECK(complained(g.violations, "MS bit"));
}

TEST_CASE("gyroscope: reserved bits and registers") {
  Gyroscope g;
  g.bus.spoil = [](drivers::SpiSettings&, auto& bytes) {
    if (bytes[0] == 0x60) bytes[4] |= 0x08;  // CTRL_REG4, bit 3
  };
  CHECK(g.driver.start().error == Error::no_answer);  // read back, it differs
  CHECK(complained(g.violations, "reserved bits in register 35"));
  const std::array<std::uint8_t, 2> out{0x0F, 0x55};
  std::array<std::uint8_t, 2> in{};
  CHECK(g.model.transfer({3, 1'000'000}, out, in).ok());
  CHECK(complained(g.violations, "register 15"));
}

TEST_CASE("gyroscope: an absent part, one that comes back unconfigured, another part, a bus that fails") {
  Gyroscope g;
  g.model.set_present(false);
  CHECK(g.driver.start().error == Error::no_answer);
  g.model.set_present(true);
  REQUIRE(g.driver.start().ok());
  g.time.pass(300ms);
  REQUIRE(g.driver.read().ok());
  g.model.set_present(false);
  CHECK(g.driver.read().error == Error::no_answer);
  g.model.set_present(true);  // it answers, but has forgotten everything
  CHECK(g.driver.read().error == Error::no_answer);
  CHECK(g.driver.check().error == Error::no_answer);
  REQUIRE(g.driver.start().ok());
  g.model.set_stuck(true);
  CHECK(g.driver.read().error == Error::bus_fault);

  Accelerometer other;
  drivers::L3g4200d<SpoiledSpi> mistaken{other.bus};
  CHECK(mistaken.start().error == Error::no_answer);
  CHECK(g.violations.none());
}

TEST_CASE("gyroscope model: another full scale has another sensitivity") {
  Gyroscope g;
  g.bus.spoil = [](drivers::SpiSettings&, auto& bytes) {
    if (bytes[0] == 0x60) bytes[4] = 0x80;  // 250 dps, as 100 dps of AN3393's table
  };
  g.rate = {5714, -5714, 0};  // 100 dps
  CHECK(g.driver.start().error == Error::no_answer);
  g.time.pass(300ms);
  std::array<std::uint8_t, 7> out{0xE8}, in{};
  REQUIRE(g.model.transfer({3, 1'000'000}, out, in).ok());
  CHECK(drivers::join_signed(in[2], in[1]) == 11428);
  CHECK(drivers::join_signed(in[4], in[3]) == -11428);
}

/// What the status register says: 0x0F is new data on all axes, 0 is none.
std::uint8_t status(sim::StMotionModel& model) {
  const std::array<std::uint8_t, 2> out{0xA7, 0};
  std::array<std::uint8_t, 2> in{};
  REQUIRE(model.transfer({3, 1'000'000}, out, in).ok());
  return in[1];
}
void set_control_1(sim::StMotionModel& model, std::uint8_t value) {
  const std::array<std::uint8_t, 2> out{0x20, value};
  std::array<std::uint8_t, 2> in{};
  REQUIRE(model.transfer({3, 1'000'000}, out, in).ok());
}

TEST_CASE("motion models: powered down there is no data, and each time it settles from when it was powered") {
  struct Part {
    std::uint8_t off, on;  ///< CTRL_REG1: the axes alone, and with PD or PM
    std::chrono::milliseconds turn_on;
  };
  // L3G4200D: PD, 300 ms; LIS331DLH: PM = 1, 50 Hz, 1/ODR + 1 ms. [the models name the data sheets]
  const auto follow = [](auto& scene, const Part& part) {
    scene.time.pass(10s);
    CHECK(status(scene.model) == 0);
    for (int time = 0; time < 3; ++time) {
      set_control_1(scene.model, part.on);
      CHECK(status(scene.model) == 0);
      scene.time.pass(part.turn_on - 1us);
      CHECK(status(scene.model) == 0);
      scene.time.pass(1us);
      CHECK(status(scene.model) == 0x0F);
      set_control_1(scene.model, part.off);
      CHECK(status(scene.model) == 0);
      scene.time.pass(10s);
      CHECK(status(scene.model) == 0);
    }
    CHECK(scene.violations.none());
  };
  Gyroscope g;
  follow(g, {0x07, 0x0F, 300ms});
  Accelerometer a;
  follow(a, {0x07, 0x27, 21ms});
}

TEST_CASE("accelerometer: configured, settled, read, digit by digit") {
  Accelerometer a;
  const auto settling = a.driver.start();
  REQUIRE(settling.ok());
  CHECK(a.driver.read() == base::Result<SpecificForce>{SpecificForce{}});
  a.time.pass(*settling);
  CHECK(a.driver.read() == base::Result<SpecificForce>{a.force});
  for (int value = -4096; value <= 4094; value += 2) {
    a.force = {static_cast<std::int16_t>(value), 0, 1024};
    REQUIRE(a.driver.read() == base::Result<SpecificForce>{a.force});
  }
  CHECK(a.violations.none());
}

TEST_CASE("accelerometer: what is wrong is noticed") {
  Accelerometer a;
  SECTION("mode") {
    a.bus.spoil = [](drivers::SpiSettings& s, auto&) { s.mode = 1; };
    CHECK(a.driver.start().error == Error::no_answer);
    CHECK(complained(a.violations, "SPI mode 1"));
  }
  SECTION("auto-increment") {
    a.bus.spoil = [](drivers::SpiSettings&, auto& bytes) { bytes[0] &= 0xBF; };
    CHECK(a.driver.start().error == Error::no_answer);
    CHECK(complained(a.violations, "MS bit"));
  }
  SECTION("range") {
    a.bus.spoil = [](drivers::SpiSettings&, auto& bytes) {
      if (bytes[0] == 0x60) bytes[4] = 0xB0;  // 8 g
    };
    CHECK(a.driver.start().error == Error::no_answer);
  }
  SECTION("reserved bits") {
    a.bus.spoil = [](drivers::SpiSettings&, auto& bytes) {
      if (bytes[0] == 0x60) bytes[5] = 0x04;  // CTRL_REG5
    };
    CHECK(a.driver.start().error == Error::no_answer);
    CHECK(complained(a.violations, "reserved bits in register 36"));
  }
  SECTION("absence") {
    a.model.set_present(false);
    CHECK(a.driver.start().error == Error::no_answer);
  }
}

}  // namespace firmware_drivers_motion_test
