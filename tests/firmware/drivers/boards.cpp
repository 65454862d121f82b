// All parts of a board, by the real drivers, on models of their registers, in a world: they must say what the
// world says by itself.
#include <array>
#include <cmath>
#include <cstdint>

#include <catch2/catch.hpp>

#include "ocm/protocol/message.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/boards/di_wheel_drive/board.hpp"
#include "firmware/boards/di_wheel_drive/geometry.hpp"
#include "firmware/boards/di_wheel_drive/parts.hpp"
#include "firmware/boards/light_ring/parts.hpp"
#include "firmware/boards/power_management/parts.hpp"
#include "sim/amiro/world.hpp"
#include "sim/parts/di_wheel_drive.hpp"
#include "sim/parts/light_ring.hpp"
#include "sim/parts/power_management.hpp"
#include "tests/firmware/drivers/fixture.hpp"

namespace firmware_drivers_boards_test {

using namespace drivers_tests;
using namespace ocm;
using namespace ocm::firmware;
namespace bottom = boards::di_wheel_drive;
namespace middle = boards::power_management;
namespace top = boards::light_ring;

sim::WorldOptions frozen(std::uint64_t seed = 1) {
  sim::WorldOptions options;
  options.seed = seed;
  options.frozen = true;
  return options;
}

struct Bottom {
  HandClock time;
  sim::World world;
  sim::DiWheelDriveParts models{world, time.clock()};
  using Parts = bottom::Parts<sim::I2cBus, sim::I2cBus, sim::SpiDevice, sim::SpiDevice, sim::MotorsModel,
                              sim::OutputPins>;
  Parts parts{models.i2c(bottom::wiring::compass_i2c),
              models.i2c(bottom::wiring::floor_i2c),
              models.spi(bottom::wiring::gyroscope_spi),
              models.spi(bottom::wiring::accelerometer_spi),
              models.motors(),
              models.outputs()};
  static_assert(bottom::Regulated<Parts>);

  explicit Bottom(sim::WorldOptions options = frozen()) : world(std::move(options)) {}
  /// What the board's low level does, for so long.
  void maintain(base::Duration duration) {
    for (base::Duration t{}; t < duration; t += 10ms) {
      time.pass(10ms);
      parts.maintain(time.now);
    }
  }
  void start() {
    parts.start(time.now);
    maintain(400ms);
  }
};

struct Middle {
  HandClock time;
  sim::World world;
  sim::PowerManagementParts models{world, time.clock()};
  using Parts = middle::Parts<sim::I2cBus, sim::I2cBus, sim::InputPins>;
  Parts parts{models.i2c(middle::wiring::back_i2c), models.i2c(middle::wiring::front_i2c), models.inputs()};
  static_assert(middle::Hardware<Parts>);

  explicit Middle(sim::WorldOptions options = frozen()) : world(std::move(options)) {}
  void maintain(base::Duration duration) {
    for (base::Duration t{}; t < duration; t += 10ms) {
      time.pass(10ms);
      parts.maintain(time.now);
    }
  }
  void start() {
    parts.start(time.now);
    maintain(200ms);
  }
};

TEST_CASE("DiWheelDrive in a frozen world: the same digits as the world's") {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    auto options = frozen(seed);
    options.start = {0.02 * static_cast<double>(seed), -0.4 + 0.002 * static_cast<double>(seed),
                     0.1 * static_cast<double>(seed)};
    Bottom b{options};
    b.start();
    CHECK(b.parts.absent() == 0);
    CHECK(b.parts.faults() == 0);
    CHECK(b.parts.gyroscope() == b.world.gyroscope());
    CHECK(b.parts.accelerometer() == b.world.accelerometer());
    CHECK(b.parts.magnetometer() == b.world.magnetometer());
    CHECK(b.parts.floor() == b.world.floor());
    CHECK(b.parts.encoders() == b.world.encoders());
    CHECK(b.models.violations().texts() == std::vector<std::string>{});
  }
}

TEST_CASE("DiWheelDrive: before its parts are settled they say so, and no call waits") {
  Bottom b;
  CHECK(b.parts.gyroscope().error == Error::no_answer);
  b.parts.start(b.time.now);
  CHECK(b.parts.gyroscope().error == Error::not_sampled);
  CHECK(b.parts.floor().error == Error::not_sampled);
  CHECK(b.parts.absent() == 0);
  b.maintain(20ms);
  CHECK(b.parts.accelerometer().ok());
  CHECK(b.parts.floor().ok());
  CHECK(b.parts.gyroscope().error == Error::not_sampled);
  b.maintain(290ms);
  CHECK(b.parts.gyroscope().ok());
}

TEST_CASE("DiWheelDrive: each part that is taken out is missed alone, and found again") {
  Bottom b;
  b.start();
  const auto all_but = [&](std::uint8_t missing) {
    CHECK(b.parts.gyroscope().ok() == ((missing & bottom::part::gyroscope) == 0));
    CHECK(b.parts.accelerometer().ok() == ((missing & bottom::part::accelerometer) == 0));
    CHECK(b.parts.magnetometer().ok() == ((missing & bottom::part::magnetometer) == 0));
    CHECK(b.parts.floor().ok() == ((missing & 0x78) == 0));
    CHECK(b.parts.encoders().ok());
    CHECK(b.parts.absent() == missing);
  };
  all_but(0);
  const auto without = [&](auto& model, std::uint8_t bit) {
    CAPTURE(int{bit});
    model.set_present(false);
    b.maintain(1100ms);
    all_but(bit);
    model.set_present(true);
    b.maintain(1500ms);
    all_but(0);
  };
  without(b.models.gyroscope, bottom::part::gyroscope);
  without(b.models.accelerometer, bottom::part::accelerometer);
  without(b.models.magnetometer, bottom::part::magnetometer);
  for (unsigned i = 0; i < 4; ++i)
    without(b.models.floor[i], static_cast<std::uint8_t>(bottom::part::floor_1 << i));
  without(b.models.eeprom, bottom::part::eeprom);
  CHECK(b.parts.faults() > 8);
  CHECK(b.parts.faults(2) > 0);
  b.models.violations().clear();
  CHECK(b.parts.floor() == b.world.floor());
}

TEST_CASE("DiWheelDrive: a part that is taken out of the world is missed on the board, and found again") {
  Bottom b;
  b.start();
  using Found = std::array<bool, 4>;
  const auto found = [&b] {
    return Found{b.parts.gyroscope().ok(), b.parts.accelerometer().ok(), b.parts.magnetometer().ok(),
                 b.parts.floor().ok()};
  };
  const Found all{true, true, true, true};
  CHECK(found() == all);
  constexpr std::array parts{sim::Part::gyroscope, sim::Part::accelerometer, sim::Part::magnetometer,
                             sim::Part::floor};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    CAPTURE(i);
    Found others = all;
    others[i] = false;
    b.world.set_absent(parts[i], true);
    b.maintain(1100ms);
    CHECK(found() == others);
    b.world.set_absent(parts[i], false);
    b.maintain(3s);
    CHECK(found() == all);
  }
  CHECK(b.parts.gyroscope() == b.world.gyroscope());
  CHECK(b.parts.accelerometer() == b.world.accelerometer());
  CHECK(b.parts.magnetometer() == b.world.magnetometer());
  CHECK(b.parts.floor() == b.world.floor());
}

TEST_CASE("DiWheelDrive: what is away costs next to nothing") {
  Bottom b;
  for (auto& each : b.models.floor) each.set_present(false);
  b.models.magnetometer.set_present(false);
  b.parts.start(b.time.now);
  const auto transfers = [&] { return b.models.i2c(1).transfers() + b.models.i2c(2).transfers(); };
  const auto before = transfers();
  for (int i = 0; i < 1000; ++i) {  // 10 s, read every 10 ms
    b.maintain(10ms);
    (void)b.parts.floor();
    (void)b.parts.magnetometer();
  }
  // Five parts, a try a second, two transfers each; and the EEPROM's checks.
  CHECK(transfers() - before < 120);
  // A stuck bus takes nothing else with it.
  b.models.i2c(2).set_stuck(true);
  CHECK(b.parts.gyroscope().ok());
}

TEST_CASE("DiWheelDrive: at most one part is looked after in a call") {
  Bottom b;
  b.start();
  for (auto& each : b.models.floor) {
    each.set_present(false);
    each.set_present(true);  // all four want to be configured again
  }
  std::uint64_t most = 0;
  for (int i = 0; i < 300; ++i) {
    const auto before = b.models.i2c(1).transfers() + b.models.i2c(2).transfers();
    b.maintain(10ms);
    most = std::max(most, b.models.i2c(1).transfers() + b.models.i2c(2).transfers() - before);
  }
  CHECK(most == 10);  // one sensor's start: five registers, each after its channel
  CHECK(b.parts.floor() == b.world.floor());
}

TEST_CASE("floor calibration: forgotten, measured, kept over a reset") {
  Bottom b;
  b.start();
  REQUIRE(b.parts.calibrate_floor(true).ok());
  CHECK(b.parts.calibrate_floor(true).error == Error::full);
  b.maintain(200ms);
  REQUIRE(b.world.calibrate_floor(true).ok());
  CHECK(b.parts.calibration_error() == Error::none);
  CHECK(b.parts.floor() == b.world.raw_floor());
  CHECK(b.parts.floor() == b.world.floor());

  REQUIRE(b.parts.calibrate_floor(false).ok());
  b.maintain(1s);
  CHECK_FALSE(b.parts.calibrating());
  REQUIRE(b.world.calibrate_floor(false).ok());
  CHECK(b.parts.floor() == base::Result<boards::FloorCounts>{boards::FloorCounts{}});
  CHECK(b.parts.floor() == b.world.floor());

  Bottom::Parts after_reset{b.models.i2c(1), b.models.i2c(2),   b.models.spi(1),
                            b.models.spi(2), b.models.motors(), b.models.outputs()};
  after_reset.start(b.time.now);
  for (int i = 0; i < 40; ++i) after_reset.maintain(b.time.now += 10ms);
  CHECK(after_reset.floor() == b.world.floor());
  CHECK(b.models.violations().none());
}

TEST_CASE("floor calibration of a sensor that is away changes nothing and says why") {
  Bottom b;
  b.start();
  b.models.floor[1].set_present(false);
  REQUIRE(b.parts.calibrate_floor(false).ok());
  b.maintain(1s);
  CHECK(b.parts.calibration_error() == Error::no_answer);
  b.models.floor[1].set_present(true);
  b.maintain(2s);
  CHECK(b.parts.floor() == b.world.floor());
}

TEST_CASE("driving through drivers: the speed is reached, the ticks are the world's") {
  sim::WorldOptions options;
  options.arena.walls.clear();
  Bottom b{options};
  const auto drive = [&](boards::WheelSpeeds speeds, base::Duration duration) {
    for (base::Duration t{}; t < duration; t += 10ms) {
      b.time.pass(10ms);
      b.world.advance_to(b.time.now);
      b.parts.maintain(b.time.now);
      b.parts.set_wheels(speeds);
      b.parts.control();
    }
  };
  b.parts.start(b.time.now);
  drive({}, 500ms);
  CHECK(b.world.wheels() == boards::WheelSpeeds{});

  const boards::WheelSpeeds target = GENERATE(boards::WheelSpeeds{0.05, 0.05}, boards::WheelSpeeds{0.3, 0.2},
                                              boards::WheelSpeeds{-0.4, 0.4}, boards::WheelSpeeds{0.9, 0.9});
  CAPTURE(target.left, target.right);
  drive(target, 1500ms);
  const auto before = *b.world.encoders();
  CHECK(b.world.wheels().left == Approx(target.left).margin(0.02));
  CHECK(b.world.wheels().right == Approx(target.right).margin(0.02));
  drive(target, 2s);
  const auto after = *b.world.encoders();
  CHECK((after.left - before.left) * bottom::metres_per_tick == Approx(2 * target.left).margin(0.001));
  CHECK((after.right - before.right) * bottom::metres_per_tick == Approx(2 * target.right).margin(0.001));
  CHECK(*b.parts.encoders() == after);

  // The sensors that live on the robot are the world's, sample by sample.
  CHECK(b.parts.gyroscope() == b.world.gyroscope());
  CHECK(b.parts.accelerometer() == b.world.accelerometer());
  CHECK(b.parts.magnetometer() == b.world.magnetometer());
  CHECK(b.parts.floor() == b.world.floor());

  drive({}, 1s);
  CHECK(std::abs(b.world.wheels().left) < 1e-3);
  CHECK(std::abs(b.world.wheels().right) < 1e-3);
  CHECK(b.models.motors().duty() == std::array<std::int16_t, 2>{0, 0});
  CHECK(b.models.violations().texts() == std::vector<std::string>{});
}

TEST_CASE("DiWheelDrive: a travel whose steps do not come ends as late, and the wheels stand") {
  using scheduling::Level;
  struct Bus {
    base::Result<bool> send(const can::Frame&) { return true; }
  } bus;
  sim::WorldOptions options;
  options.arena.walls.clear();
  Bottom b{options};
  b.start();
  bottom::Board<Bottom::Parts, Bus> board{b.parts, bus, b.time.now};
  const auto pass = [&](base::Duration duration, Level least) {
    for (base::Duration t{}; t < duration; t += 10ms) {
      b.time.pass(10ms);
      b.world.advance_to(b.time.now);
      b.parts.maintain(b.time.now);
      board.controller().port().advance(b.time.now);
      board.controller().expire();
      for (const Level level : {Level::urgent, Level::high, Level::medium, Level::low})
        if (level <= least) board.controller().run(level);
    }
  };
  amiro::Travel travel;
  travel.set_distance_m(5);
  travel.set_speed_m_per_s(0.1);
  board.receive(protocol::command(travel), b.time.now);
  pass(1s, Level::low);
  REQUIRE(b.world.wheels().left == Approx(0.1).margin(0.02));
  pass(1s, Level::high);  // whatever holds the low level up
  CHECK(std::abs(b.world.wheels().left) < 1e-3);
  CHECK(std::abs(b.world.wheels().right) < 1e-3);
}

TEST_CASE("a weak motor reaches its set point too") {
  sim::WorldOptions options;
  options.arena.walls.clear();
  options.drive.greatest_speed_m_per_s = 0.6;
  Bottom b{options};
  b.parts.start(b.time.now);
  const auto drive = [&](double speed, int steps) {
    for (int i = 0; i < steps; ++i) {
      b.world.advance_to(b.time.now += 10ms);
      b.parts.set_wheels({speed, speed});
      b.parts.control();
    }
  };
  drive(0.3, 300);
  CHECK(b.world.wheels().left == Approx(0.3).margin(0.02));
  drive(0.9, 500);  // more than it can
  CHECK(b.world.wheels().left == Approx(0.6).margin(0.001));
  drive(0.2, 60);  // and back, without making up for what was missed
  CHECK(b.world.wheels().left == Approx(0.2).margin(0.03));
}

TEST_CASE("motors without power do not turn, and who drives them so is noticed") {
  sim::WorldOptions options;
  options.arena.walls.clear();
  Bottom b{options};
  b.models.motors().set_duty(10'000, 10'000);
  b.world.advance_to(b.time.now += 1s);
  CHECK(b.world.wheels() == boards::WheelSpeeds{});
  CHECK(complained(b.models.violations(), "without power"));
}

TEST_CASE("PowerManagement in a frozen world: the same digits as the world's") {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    auto options = frozen(seed);
    options.state_of_charge = static_cast<double>(seed) / 30;
    options.plugged = seed % 3 == 0;
    options.start = {-1.0 + 0.03 * static_cast<double>(seed), -0.6, 0.2 * static_cast<double>(seed)};
    Middle m{options};
    m.start();
    CHECK(m.parts.absent() == 0);
    CHECK(m.parts.ring() == m.world.ring());
    CAPTURE(seed);
    CHECK(m.parts.gauge()->plugged == m.world.gauge()->plugged);
    CHECK(m.parts.gauge()->charging == m.world.gauge()->charging);
    CHECK(m.parts.gauge()->minutes == m.world.gauge()->minutes);
    CHECK(m.parts.gauge() == m.world.gauge());
    CHECK(m.parts.batteries() == m.world.batteries());
    m.maintain(100ms);
    CHECK(m.parts.ring_light() == m.world.ring_light());
    CHECK(m.models.violations().texts() == std::vector<std::string>{});
  }
}

TEST_CASE("PowerManagement: charged in a world whose time passes") {
  sim::WorldOptions options;
  options.state_of_charge = 0.995;
  Middle m{options};
  m.start();
  m.world.set_plugged(true);
  for (int minute = 0; minute < 5; ++minute) {
    m.world.advance_to(base::Time{} + (minute + 1) * 60s);
    CHECK(m.parts.gauge() == m.world.gauge());
  }
  CHECK_FALSE(m.parts.gauge()->charging);  // full by now
  CHECK(m.parts.gauge()->state_of_charge_percent == 100);
}

TEST_CASE("PowerManagement: a gauge or a sensor that is away, and back") {
  Middle m;
  m.start();
  m.models.gauge_p8.set_present(false);
  CHECK(m.parts.gauge().error == Error::no_answer);
  CHECK(m.parts.batteries().error == Error::no_answer);
  CHECK(m.parts.absent() == middle::part::gauge_p8);
  CHECK(m.parts.ring().ok());
  m.models.gauge_p8.set_present(true);
  m.maintain(1200ms);
  CHECK(m.parts.gauge() == m.world.gauge());

  for (std::size_t i = 0; i < 8; ++i) {
    m.models.ring[i].set_present(false);
    m.maintain(1200ms);
    CHECK(m.parts.ring().error == Error::no_answer);
    CHECK(m.parts.ring_light().error == Error::no_answer);
    CHECK(m.parts.gauge().ok());
    CHECK(m.parts.absent() == middle::part::ring);
    CHECK(m.parts.absent_ring() == 1U << i);
    m.models.ring[i].set_present(true);
    m.maintain(1200ms);
    CHECK(m.parts.absent() == 0);
    CHECK(m.parts.ring() == m.world.ring());
  }
}

TEST_CASE("PowerManagement: gauges and ring that are taken out of the world are missed on the board") {
  Middle m;
  m.start();
  constexpr std::array<std::uint8_t, 1> voltage{0x08};
  const auto gauge_at = [&](std::uint8_t bus) { return m.models.i2c(bus).transfer(0x55, voltage, {}).error; };
  for (const bool absent : {true, false}) {
    CAPTURE(absent);
    m.world.set_absent(sim::Part::gauge, absent);
    CHECK(gauge_at(middle::wiring::back_i2c) == (absent ? Error::no_answer : Error::none));
    CHECK(gauge_at(middle::wiring::front_i2c) == (absent ? Error::no_answer : Error::none));
    m.maintain(3s);
    CHECK(m.parts.gauge().ok() == !absent);
    CHECK(m.parts.batteries().ok() == !absent);
    CHECK(m.parts.ring().ok());
  }
  CHECK(m.parts.gauge() == m.world.gauge());

  m.world.set_absent(sim::Part::ring, true);
  m.maintain(1200ms);
  CHECK(m.parts.ring().error == Error::no_answer);
  CHECK(m.parts.gauge().ok());
  m.world.set_absent(sim::Part::ring, false);
  m.maintain(3s);
  CHECK(m.parts.ring() == m.world.ring());
}

TEST_CASE("PowerManagement: ring offsets are kept for others, the counts stay") {
  Middle m;
  m.start();
  const auto before = m.parts.ring();
  REQUIRE(m.parts.calibrate_ring(false).ok());
  m.maintain(2s);
  CHECK(m.parts.calibration_error() == Error::none);
  CHECK(m.parts.ring() == before);
  REQUIRE(m.world.calibrate_ring(false).ok());
  for (std::size_t i = 0; i < 8; ++i) CHECK(m.parts.ring_offset(i) == m.world.ring_offset()[i]);
  REQUIRE(m.parts.calibrate_ring(true).ok());
  m.maintain(100ms);
  CHECK(m.parts.ring_offset(0) == 0);
  CHECK(m.models.violations().none());
}

TEST_CASE("LightRing: the world sees the colours") {
  sim::World world;
  sim::LightRingParts models{world};
  top::Parts<sim::SpiDevice, sim::OutputPins> parts{models.spi(top::wiring::lights_spi), models.outputs()};
  static_assert(top::Hardware<decltype(parts)>);
  parts.start({});
  for (std::size_t i = 0; i < 8; ++i) {
    const boards::Colour colour{static_cast<std::uint8_t>(31 * i), static_cast<std::uint8_t>(255 - i), 7};
    parts.set_light(i, colour);
    CHECK(world.light(i) == colour);
  }
  CHECK(models.violations().none());
}

TEST_CASE("a bus, a device or a motor that a board does not have") {
  sim::World world;
  HandClock time;
  sim::DiWheelDriveParts models{world, time.clock()};
  std::array<std::uint8_t, 2> two{};
  CHECK(models.i2c(3).transfer(0x1E, {}, two).error == Error::no_answer);
  CHECK(models.spi(9).transfer({0, 1000}, two, two).ok());
  CHECK(two == std::array<std::uint8_t, 2>{0xFF, 0xFF});
  CHECK(models.inputs().read() == 0);
  sim::LightRingParts ring{world};
  ring.motors().set_duty(0, 0);
  CHECK(ring.motors().encoders() == std::array<std::uint16_t, 2>{0, 0});
}

}  // namespace firmware_drivers_boards_test
