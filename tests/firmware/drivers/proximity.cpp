#include <array>

#include <catch2/catch.hpp>

#include "firmware/drivers/pca9544.hpp"
#include "firmware/drivers/vcnl4020.hpp"
#include "sim/parts/pca9544_model.hpp"
#include "sim/parts/vcnl4020_model.hpp"
#include "tests/firmware/drivers/fixture.hpp"

namespace firmware_drivers_proximity_test {

using namespace drivers_tests;
using namespace ocm;
using namespace ocm::firmware;

/// Counts how deep it is held.
struct Recorder {
  static inline int held = 0, most = 0, times = 0;
  void lock() {
    ++times;
    most = std::max(most, ++held);
  }
  void unlock() { --held; }
};

struct Proximity {
  HandClock time;
  sim::Violations violations;
  std::array<std::uint16_t, 4> counts{2289, 2302, 65535, 0};
  std::array<std::uint16_t, 4> light{1200, 65535, 1, 0};
  sim::Pca9544Model mux{violations};
  std::array<sim::Vcnl4020Model, 4> parts{make(0), make(1), make(2), make(3)};
  sim::I2cBus wires{violations};
  SpoiledI2c bus{&wires, {}};
  drivers::Pca9544<SpoiledI2c, Recorder> multiplexer{bus};
  using Channel = decltype(multiplexer)::Channel;

  Proximity() {
    wires.attach(mux);
    for (std::size_t i = 0; i < 4; ++i) mux.channel(i).attach(parts[i]);
  }
  sim::Vcnl4020Model make(std::size_t i) {
    return sim::Vcnl4020Model{violations, time.clock(), [this, i] { return counts[i]; },
                              [this, i] { return light[i]; }};
  }
  drivers::Vcnl4020<Channel> driver(std::uint8_t i) {
    return drivers::Vcnl4020<Channel>{multiplexer.channel(i)};
  }
};

TEST_CASE("proximity: four sensors of one address, each behind its channel") {
  Proximity p;
  for (std::uint8_t i = 0; i < 4; ++i) {
    auto driver = p.driver(i);
    const auto settling = driver.start();
    REQUIRE(settling.ok());
    p.time.pass(*settling);
    CHECK(driver.read() == base::Result<std::uint16_t>{p.counts[i]});
    CHECK(driver.check().ok());
  }
  for (const std::uint8_t i : std::array<std::uint8_t, 4>{2, 0, 3, 1})
    CHECK(p.driver(i).read() == base::Result<std::uint16_t>{p.counts[i]});
  CHECK(p.violations.none());
  CHECK(Recorder::held == 0);
  CHECK(Recorder::most == 1);
  CHECK(Recorder::times > 0);
}

TEST_CASE("ambient light: ten times a second, beside the proximity, and none before the first measurement") {
  Proximity p;
  for (std::uint8_t i = 0; i < 4; ++i) {
    drivers::Vcnl4020<Proximity::Channel, true> driver{p.multiplexer.channel(i)};
    REQUIRE(driver.start().ok());
    p.time.pass(99ms);
    CHECK(driver.light().error == Error::not_sampled);
    CHECK(driver.read() == base::Result<std::uint16_t>{p.counts[i]});
    p.time.pass(1ms);
    CHECK(driver.light() == base::Result<std::uint16_t>{p.light[i]});
    CHECK(driver.light() == base::Result<std::uint16_t>{p.light[i]});  // again, though it is no longer new
    CHECK(driver.check().ok());
    REQUIRE(driver.start().ok());
    CHECK(driver.light().error == Error::not_sampled);
  }
  CHECK(p.driver(0).check().error == Error::no_answer);  // this one is not to measure light
  CHECK(p.violations.none());
}

TEST_CASE("ambient light: what is wrong is noticed") {
  Proximity p;
  drivers::Vcnl4020<Proximity::Channel, true> driver{p.multiplexer.channel(0)};
  SECTION("the mean of 32, as the part begins") {
    p.bus.spoil = [](std::uint8_t& address, auto& bytes) {
      if (address == 0x13 && bytes.size() == 2 && bytes[0] == 0x84) bytes[1] = 0x1D;
    };
    REQUIRE(driver.start().ok());
    CHECK(driver.check().error == Error::no_answer);
    CHECK(p.violations.none());
  }
  SECTION("continuous conversion") {
    p.bus.spoil = [](std::uint8_t& address, auto& bytes) {
      if (address == 0x13 && bytes.size() == 2 && bytes[0] == 0x84) bytes[1] |= 0x80;
    };
    REQUIRE(driver.start().ok());
    CHECK(complained(p.violations, "on demand"));
  }
  SECTION("a part that is away") {
    REQUIRE(driver.start().ok());
    p.parts[0].set_present(false);
    CHECK(driver.light().error == Error::no_answer);
  }
}

TEST_CASE("proximity: without the multiplexer no sensor answers") {
  Proximity p;
  drivers::Vcnl4020<SpoiledI2c> direct{p.bus};
  CHECK(direct.start().error == Error::no_answer);
  // One that forgets its channel reads another sensor's counts: the select must go before each transfer.
  p.bus.spoil = [](std::uint8_t& address, auto& bytes) {
    if (address == 0x77) bytes[0] = 0x04;
  };
  REQUIRE(p.driver(0).start().ok());
  p.time.pass(5ms);
  CHECK(*p.driver(1).read() == p.counts[0]);
  p.bus.spoil = [](std::uint8_t& address, auto& bytes) {
    if (address == 0x77) bytes[0] &= 0xFB;  // B2 not set
  };
  CHECK(p.driver(1).start().error == Error::no_answer);
  p.bus.spoil = [](std::uint8_t& address, auto&) {
    if (address == 0x77) address = 0x70;  // address pins taken for low
  };
  CHECK(p.driver(1).start().error == Error::no_answer);
}

TEST_CASE("proximity: what is wrong is noticed") {
  Proximity p;
  SECTION("rate changed while measuring") {
    REQUIRE(p.driver(0).start().ok());
    p.bus.spoil = [](std::uint8_t& address, auto& bytes) {
      if (address == 0x13 && bytes.size() == 2 && bytes[0] == 0x80) bytes[1] = 0x03;  // standby left out
    };
    CHECK(p.driver(0).start().ok());
    CHECK(complained(p.violations, "self-timed"));
  }
  SECTION("LED current") {
    p.bus.spoil = [](std::uint8_t& address, auto& bytes) {
      if (address == 0x13 && bytes.size() == 2 && bytes[0] == 0x83) bytes[1] = 2;
    };
    REQUIRE(p.driver(0).start().ok());
    p.time.pass(5ms);
    CHECK(*p.driver(0).read() == 228);  // a tenth of the light
    CHECK(p.driver(0).check().error == Error::no_answer);
    p.bus.spoil = [](std::uint8_t& address, auto& bytes) {
      if (address == 0x13 && bytes.size() == 2 && bytes[0] == 0x83) bytes[1] = 21;
    };
    REQUIRE(p.driver(0).start().ok());
    CHECK(complained(p.violations, "200 mA"));
  }
  SECTION("register") {
    p.bus.spoil = [](std::uint8_t& address, auto& bytes) {
      if (address == 0x13) bytes[0] &= 0x7F;
    };
    CHECK(p.driver(0).start().error == Error::no_answer);
    CHECK(complained(p.violations, "is none"));
  }
  SECTION("not self-timed") {
    p.bus.spoil = [](std::uint8_t& address, auto& bytes) {
      if (address == 0x13 && bytes.size() == 2 && bytes[0] == 0x80) bytes[1] &= 0x02;
    };
    REQUIRE(p.driver(0).start().ok());
    p.time.pass(5ms);
    CHECK(*p.driver(0).read() == 0);
    CHECK(p.driver(0).check().error == Error::no_answer);
  }
  SECTION("read before the first measurement is done") {
    REQUIRE(p.driver(0).start().ok());
    p.time.pass(3ms);
    CHECK(*p.driver(0).read() == 0);
  }
}

TEST_CASE("proximity: absence and reset of one do not touch the others") {
  Proximity p;
  for (std::uint8_t i = 0; i < 4; ++i) REQUIRE(p.driver(i).start().ok());
  p.time.pass(5ms);
  p.parts[2].set_present(false);
  CHECK(p.driver(2).read().error == Error::no_answer);
  CHECK(p.driver(1).read().ok());
  p.parts[2].set_present(true);
  CHECK(p.driver(2).check().error == Error::no_answer);  // it does not measure
  CHECK(p.driver(3).check().ok());
  p.mux.set_present(false);
  CHECK(p.driver(1).read().error == Error::no_answer);
  p.mux.set_present(true);
  CHECK(p.driver(1).read().ok());
  p.wires.set_stuck(true);
  CHECK(p.driver(1).read().error == Error::bus_fault);
}

TEST_CASE("two parts that answer at once are noticed") {
  Proximity p;
  auto twin = p.make(0);
  p.wires.attach(twin);  // not behind the multiplexer
  CHECK(p.driver(0).start().error == Error::bus_fault);
  CHECK(complained(p.violations, "two parts"));
}

}  // namespace firmware_drivers_proximity_test
