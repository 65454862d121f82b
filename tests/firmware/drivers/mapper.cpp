// The mapper's own parts: the gyroscope LSM6DS3, the converter's volts, the servo's pulses, and all of
// them together: what the robot's parts say through registers is what was put in behind the registers.
#include "sim/parts/mapper.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/mapper/app/parts.hpp"

#include "firmware/boards/mapper/parts.hpp"
#include "firmware/drivers/gp2y0a21yk.hpp"
#include "firmware/drivers/lsm6ds3.hpp"
#include "firmware/qemu/parts_frames.hpp"
#include "sim/parts/lsm6ds3_model.hpp"
#include "tests/firmware/drivers/fixture.hpp"

namespace firmware_drivers_mapper_test {

using namespace drivers_tests;
using namespace ocm;
using namespace ocm::firmware;
using boards::AngularRate;

constexpr AngularRate decode(std::array<std::uint8_t, 6> out) {
  return drivers::lsm6ds3::decode(out);
}
// 100, -100, 200 dps: 11428, -11428, 22857 digits of 8.75 mdps, as bytes. [AN4650 table 20]
static_assert(decode({0xA4, 0x2C, 0x5C, 0xD3, 0x49, 0x59}) == AngularRate{11428, -11428, 22857});

constexpr double deg = 3.14159265358979 / 180;

struct Gyroscope {
  HandClock time;
  sim::Violations violations;
  sim::Lsm6ds3Model::Rates rates{11 * 0.0175 * deg, -22 * 0.0175 * deg, 28571 * 0.0175 * deg};
  sim::Lsm6ds3Model model{violations, time.clock(), [this] { return rates; }};
  SpoiledSpi bus{&model, {}};
  drivers::Lsm6ds3<SpoiledSpi> driver{bus};

  void settle() {
    const auto settling = driver.start();
    REQUIRE(settling.ok());
    time.pass(*settling);
  }
};

TEST_CASE("LSM6DS3: configured, settled, read, digit by digit") {
  Gyroscope g;
  g.settle();
  CHECK(g.driver.read() == base::Result<AngularRate>{AngularRate{11, -22, 28571}});
  for (int digits = -32768; digits <= 32767; digits += 991) {
    g.rates = {0, 0, digits * 0.0175 * deg};
    REQUIRE(g.driver.read()->z == digits);
  }
  CHECK(g.violations.none());
}

TEST_CASE("LSM6DS3: before it is settled there is nothing, so the driver must say how long that is") {
  Gyroscope g;
  const auto settling = g.driver.start();
  REQUIRE(settling.ok());
  CHECK(*settling == 80ms);
  g.time.pass(*settling - 1us);
  CHECK(g.driver.read() == base::Result<AngularRate>{AngularRate{}});
  g.time.pass(1us);
  CHECK(g.driver.read()->x == 11);
}

TEST_CASE("LSM6DS3: wrong modes, too fast a clock, frames of an Arduino library that is too short") {
  Gyroscope g;
  SECTION("mode") {
    const int mode = GENERATE(0, 1, 2);
    g.bus.spoil = [mode](drivers::SpiSettings& s, auto&) { s.mode = static_cast<std::uint8_t>(mode); };
    CHECK(g.driver.start().error == Error::no_answer);
    CHECK(complained(g.violations, "SPI mode"));
  }
  SECTION("clock") {
    g.bus.spoil = [](drivers::SpiSettings& s, auto&) { s.highest_clock_hz = 12'000'000; };
    CHECK(g.driver.start().error == Error::no_answer);
    CHECK(complained(g.violations, "10 MHz"));
  }
  SECTION("increment") {
    g.bus.spoil = [](drivers::SpiSettings&, auto& bytes) {
      if (bytes[0] == 0x12) bytes[1] &= 0xFB;
    };
    CHECK(g.driver.start().error == Error::no_answer);
    CHECK(complained(g.violations, "IF_INC"));
  }
  SECTION("reserved") {
    g.bus.spoil = [](drivers::SpiSettings&, auto& bytes) {
      if (bytes[0] == 0x11) bytes[1] |= 0x01;
    };
    CHECK(g.driver.start().error == Error::no_answer);
    CHECK(complained(g.violations, "reserved bits in CTRL2_G"));
  }
  SECTION("the wrong register") {
    g.bus.spoil = [](drivers::SpiSettings&, auto& bytes) {
      if (bytes[0] == 0x11) bytes[0] = 0x1E;
    };
    CHECK(g.driver.start().error == Error::no_answer);
    CHECK(complained(g.violations, "register 30"));
  }
}

TEST_CASE("LSM6DS3: an absent part, one that comes back unconfigured, another part, a bus that fails") {
  Gyroscope g;
  g.model.set_present(false);
  CHECK(g.driver.start().error == Error::no_answer);
  g.model.set_present(true);
  g.settle();
  REQUIRE(g.driver.read().ok());
  g.model.set_present(false);
  CHECK(g.driver.read().error == Error::no_answer);
  g.model.set_present(true);  // it answers, but has forgotten everything
  CHECK(g.driver.check().error == Error::no_answer);
  g.settle();
  CHECK(g.driver.check().ok());
  g.model.set_stuck(true);
  CHECK(g.driver.read().error == Error::bus_fault);
  CHECK(g.driver.start().error == Error::bus_fault);
}

TEST_CASE("a converter's counts are volts, and counts that it cannot have are none") {
  struct Converter {
    base::Result<std::uint16_t> count{std::uint16_t{0}};
    std::uint8_t asked = 255;
    base::Result<std::uint16_t> convert(std::uint8_t channel) {
      asked = channel;
      return count;
    }
  } converter;
  drivers::Gp2y0a21yk sensor{converter, 3, drivers::ConverterScale{10, 5.0F}};
  CHECK(*sensor.read() == 0.0F);
  CHECK(converter.asked == 3);
  converter.count = std::uint16_t{1023};
  CHECK(*sensor.read() == 5.0F);
  converter.count = std::uint16_t{470};  // 2.297 V: 10 cm [data sheet]
  CHECK(sensing::ir_distance(*sensor.read()).distance_cm == Approx(10.0).margin(0.1));
  converter.count = std::uint16_t{1024};
  CHECK(sensor.read().error == Error::bus_fault);
  converter.count = Error::bus_fault;
  CHECK(sensor.read().error == Error::bus_fault);
}

TEST_CASE("duty of an effort") {
  using boards::mapper::duty;
  STATIC_REQUIRE(duty(0.0F) == 0);
  STATIC_REQUIRE(duty(1.0F) == 32767);
  STATIC_REQUIRE(duty(-1.0F) == -32767);
  STATIC_REQUIRE(duty(7.0F) == 32767);
  STATIC_REQUIRE(duty(std::numeric_limits<float>::quiet_NaN()) == 0);
  STATIC_REQUIRE(duty(std::numeric_limits<float>::infinity()) == 0);
  STATIC_REQUIRE(duty(0.4F) == 13107);  // 13106.8: less would not move a motor whose least is 0.4
  STATIC_REQUIRE(duty(-0.4F) == -13107);
}

// What is put in by hand, in the application's units.
struct Robot {
  mapper::app::WheelTicks wheels{};
  base::Result<float> rate{0.0F};
  base::Result<sensing::Field> magnetic{sensing::Field{}};
  std::array<float, 4> volts{};
  motion::Efforts efforts{};
  std::int32_t tower = -1;
  mapper::app::Lights lights{};

  mapper::app::WheelTicks ticks() { return wheels; }
  base::Result<float> gyro() { return rate; }
  base::Result<sensing::Field> field() { return magnetic; }
  base::Result<float> infrared(std::size_t sensor) {
    if (sensor >= 4) return Error::out_of_range;
    return volts[sensor];
  }
  void drive(motion::Efforts e) { efforts = e; }
  void turn_tower(std::int32_t degrees) { tower = degrees; }
  void show(mapper::app::Lights l) { lights = l; }
  void store(const sensing::CompassFit&) {}
  base::Result<sensing::CompassFit> stored() { return Error::not_sampled; }
  bool linked() { return true; }
  std::size_t send(std::span<const std::uint8_t> bytes) { return bytes.size(); }
};
static_assert(mapper::app::RobotParts<Robot>);

using Models = sim::RobotModels<Robot>;
using Kind = qemu::link::Kind;

// The buses of boards/mapper/parts.hpp, each transfer a request to the models: the emulated board's way
// without the line.
struct Wires {
  Models& models;
  base::Status ask(Kind kind, std::uint8_t unit, std::uint8_t a, std::span<const std::uint8_t> written,
                   std::span<std::uint8_t> read) {
    return models.answer({.kind = kind,
                          .unit = unit,
                          .a = a,
                          .asked = static_cast<std::uint8_t>(read.size()),
                          .written = written},
                         read);
  }
  base::Status transfer(std::uint8_t address, std::span<const std::uint8_t> write,
                        std::span<std::uint8_t> read) {
    return ask(Kind::i2c, 1, address, write, read);
  }
  base::Status transfer(const drivers::SpiSettings& settings, std::span<const std::uint8_t> out,
                        std::span<std::uint8_t> in) {
    std::vector<std::uint8_t> bytes(4 + out.size());
    for (std::size_t i = 0; i < 4; ++i)
      bytes[i] = static_cast<std::uint8_t>(settings.highest_clock_hz >> (8 * i));
    std::copy(out.begin(), out.end(), bytes.begin() + 4);
    return ask(Kind::spi, 1, settings.mode, bytes, in);
  }
  base::Result<std::uint16_t> convert(std::uint8_t channel) {
    std::array<std::uint8_t, 2> count{};
    if (const auto done = ask(Kind::convert, channel, 0, {}, count); !done) return done.error;
    return static_cast<std::uint16_t>(count[0] | count[1] << 8);
  }
  std::array<std::uint16_t, 2> encoders() {
    std::array<std::uint8_t, 4> counts{};
    REQUIRE(ask(Kind::encoders, 0, 0, {}, counts).ok());
    return {static_cast<std::uint16_t>(counts[0] | counts[1] << 8),
            static_cast<std::uint16_t>(counts[2] | counts[3] << 8)};
  }
  void set_duty(std::int16_t left, std::int16_t right) {
    const auto l = static_cast<std::uint16_t>(left), r = static_cast<std::uint16_t>(right);
    const std::array<std::uint8_t, 4> bytes{static_cast<std::uint8_t>(l), static_cast<std::uint8_t>(l >> 8),
                                            static_cast<std::uint8_t>(r), static_cast<std::uint8_t>(r >> 8)};
    REQUIRE(ask(Kind::set_duty, 0, 0, bytes, {}).ok());
  }
  void set_width(std::uint16_t counts) {
    const std::array<std::uint8_t, 2> bytes{static_cast<std::uint8_t>(counts),
                                            static_cast<std::uint8_t>(counts >> 8)};
    REQUIRE(ask(Kind::set_pulse, 0, 0, bytes, {}).ok());
  }
  void write(std::uint8_t levels) { REQUIRE(ask(Kind::outputs, 0, 0, {&levels, 1}, {}).ok()); }
  std::size_t send(std::span<const std::uint8_t> bytes) { return bytes.size(); }
  bool linked() { return false; }
};

struct Whole {
  HandClock time;
  Robot robot;
  Models models{robot, time.clock()};
  Wires wires{models};
  boards::mapper::Parts<Wires, Wires, Wires, Wires, Wires, Wires, Wires> parts{wires, wires, wires, wires,
                                                                               wires, wires, wires};
  static_assert(mapper::app::RobotParts<decltype(parts)>);

  void maintain(base::Duration duration) {
    for (const base::Time end = time.now + duration; time.now < end; time.pass(10ms))
      parts.maintain(time.now);
  }
};

TEST_CASE("the mapper's parts say what is put in behind their registers") {
  Whole whole;
  whole.robot.efforts = {0.5F, 0.5F};
  whole.robot.lights = {true, true};
  whole.parts.start(whole.time.now);
  CHECK(whole.robot.efforts == motion::Efforts{});
  CHECK(whole.robot.lights == mapper::app::Lights{});
  CHECK(whole.robot.tower == 0);
  CHECK(whole.parts.gyro().error == Error::not_sampled);
  whole.maintain(200ms);
  CHECK(whole.parts.absent() == 0);

  whole.robot.rate = 0.5F;
  CHECK(*whole.parts.gyro() == Approx(0.5).margin(0.0175 / 2 * deg));
  whole.robot.rate = -8.0F;
  CHECK(*whole.parts.gyro() == Approx(-8.0).margin(0.0175 / 2 * deg));
  whole.robot.magnetic = sensing::Field{0.21F, -0.43F};
  CHECK(whole.parts.field()->x == Approx(0.21).margin(0.00128));
  CHECK(whole.parts.field()->y == Approx(-0.43).margin(0.00128));
  whole.robot.volts = {0.4F, 1.1F, 2.3F, 3.0F};
  for (std::size_t i = 0; i < 4; ++i)
    CHECK(*whole.parts.infrared(i) == Approx(whole.robot.volts[i]).margin(5.0 / 1023 / 2 + 1e-6));
  CHECK(whole.parts.infrared(4).error == Error::out_of_range);
  for (std::int32_t degrees = 0; degrees <= 90; ++degrees) {
    whole.parts.turn_tower(degrees);
    REQUIRE(whole.robot.tower == degrees);
  }
  whole.parts.drive({-0.25F, 1.0F});
  CHECK(whole.robot.efforts.left == Approx(-0.25).margin(1e-4));
  CHECK(whole.robot.efforts.right == 1.0F);
  whole.parts.show({true, false});
  CHECK(whole.robot.lights == mapper::app::Lights{true, false});
  whole.parts.show({false, true});
  CHECK(whole.robot.lights == mapper::app::Lights{false, true});
  CHECK(whole.models.violations().none());
}

TEST_CASE("the mapper's wheels are counted beyond 16 bits, both ways") {
  Whole whole;
  whole.parts.start(whole.time.now);
  const auto first = whole.parts.ticks();
  std::uint32_t way = 0;
  for (int i = 0; i < 40; ++i) {
    way += 5000;
    whole.robot.wheels = {way, 0U - way};
    const auto ticks = whole.parts.ticks();
    REQUIRE(ticks.left - first.left == way);
    REQUIRE(ticks.right - first.right == 0U - way);
  }
}

TEST_CASE("a gyro or compass of the mapper that goes away is said at once, and comes back by itself") {
  Whole whole;
  whole.robot.rate = Error::no_answer;
  whole.parts.start(whole.time.now);
  CHECK(whole.parts.absent() == boards::mapper::part::gyroscope);
  CHECK(whole.parts.gyro().error == Error::no_answer);
  whole.robot.rate = 0.1F;
  whole.maintain(1200ms);
  CHECK(whole.parts.gyro().ok());
  CHECK(whole.parts.field().ok());
  whole.robot.magnetic = Error::no_answer;
  CHECK(whole.parts.field().error == Error::no_answer);
  CHECK(whole.parts.absent() == boards::mapper::part::compass);
  CHECK(whole.parts.gyro().ok());
  whole.robot.magnetic = sensing::Field{0.1F, 0.1F};
  whole.maintain(1200ms);
  CHECK(whole.parts.field().ok());
}

TEST_CASE("the mapper's parts keep a calibration across a restart, and go on without a memory") {
  Whole whole;
  whole.parts.start(whole.time.now);
  whole.maintain(200ms);
  constexpr sensing::CompassFit fit{{0.041F, -0.057F}, 0.152F, 0.02F};
  whole.parts.store(fit);
  CHECK_FALSE(whole.parts.stored().ok());
  whole.maintain(200ms);
  REQUIRE(whole.parts.stored().ok());
  CHECK(*whole.parts.stored() == fit);
  CHECK(whole.models.violations().none());

  Whole again;
  again.models.memory.bytes() = whole.models.memory.bytes();
  again.parts.start(again.time.now);
  REQUIRE(again.parts.stored().ok());
  CHECK(again.parts.stored()->offset.y == Approx(-0.057).margin(5e-5));

  Whole without;
  without.models.memory.set_present(false);
  without.parts.start(without.time.now);
  without.maintain(200ms);
  CHECK(without.parts.absent() == boards::mapper::part::memory);
  CHECK(without.parts.field().ok());
  without.parts.store(fit);
  without.maintain(2s);
  CHECK_FALSE(without.parts.stored().ok());
  CHECK(without.parts.gyro().ok());
  without.models.memory.set_present(true);
  without.maintain(2s);  // it is written once the memory answers
  CHECK(without.parts.stored().ok());
}

TEST_CASE("what no mapper has is refused, and nothing is harmed") {
  Whole whole;
  std::array<std::uint8_t, 4> four{};
  const std::span<std::uint8_t> none;
  using namespace qemu;
  CHECK(whole.wires.ask(Kind::convert, 4, 0, {}, std::span{four}.first(2)).error == Error::bad_mode);
  CHECK(whole.wires.ask(Kind::convert, 0, 0, {}, std::span{four}.first(1)).error == Error::bad_length);
  CHECK(whole.wires.ask(Kind::set_pulse, 1, 0, std::span{four}.first(2), none).error == Error::bad_mode);
  CHECK(whole.wires.ask(Kind::set_pulse, 0, 0, std::span{four}.first(1), none).error == Error::bad_length);
  CHECK(whole.wires.ask(Kind::set_duty, 0, 0, std::span{four}.first(3), none).error == Error::bad_length);
  CHECK(whole.wires.ask(Kind::encoders, 0, 0, {}, std::span{four}.first(3)).error == Error::bad_length);
  CHECK(whole.wires.ask(Kind::outputs, 0, 0, {}, none).error == Error::bad_length);
  CHECK(whole.wires.ask(Kind::inputs, 0, 0, {}, std::span{four}.first(1)).error == Error::bad_mode);
  CHECK(whole.wires.ask(Kind::i2c, 2, 0x1E, {}, std::span{four}.first(1)).error == Error::no_answer);
  CHECK(whole.wires.ask(Kind::spi, 1, 3, std::span{four}.first(3), none).error == Error::bad_length);
  CHECK(whole.wires.ask(Kind{0}, 0, 0, {}, none).error == Error::bad_mode);
}

}  // namespace firmware_drivers_mapper_test
