// The models of parts by themselves, register by register, against what their data sheets say: a driver's
// test is worth what its model is. The models name the sheets.
#include <array>
#include <cstdint>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "sim/parts/at24c01b_model.hpp"
#include "sim/parts/board_parts.hpp"
#include "sim/parts/bq27500_model.hpp"
#include "sim/parts/hmc5883l_model.hpp"
#include "sim/parts/i2c_bus.hpp"
#include "sim/parts/lsm6ds3_model.hpp"
#include "sim/parts/pca9544_model.hpp"
#include "sim/parts/spi_device.hpp"
#include "sim/parts/st_motion_model.hpp"
#include "sim/parts/tlc5947_model.hpp"
#include "sim/parts/transfers.hpp"
#include "sim/parts/usart_model.hpp"
#include "sim/parts/vcnl4020_model.hpp"
#include "tests/firmware/drivers/fixture.hpp"

namespace firmware_drivers_models_test {

using namespace drivers_tests;
using namespace ocm;
using Bytes = std::vector<std::uint8_t>;

/// A part that is alone on its bus.
struct Scene {
  HandClock time;
  sim::Violations violations;
  sim::I2cBus bus{violations};

  base::Status write(std::uint8_t address, const Bytes& bytes) { return bus.transfer(address, bytes, {}); }
  /// `count` registers from `first` on, or what comes next where nothing is written.
  Bytes read(std::uint8_t address, const Bytes& first, std::size_t count) {
    Bytes in(count, 0xEE);
    REQUIRE(bus.transfer(address, first, in).ok());
    return in;
  }
  /// What was complained of since the last time, or nothing.
  std::string complaint() {
    REQUIRE(violations.texts().size() <= 1);
    const std::string text = violations.none() ? std::string{} : violations.texts().front();
    violations.clear();
    return text;
  }
};

// --- the bus -------------------------------------------------------------------------------------------------

struct Echo : sim::I2cPart {
  explicit Echo(std::uint8_t address) : I2cPart(address) {}
  bool write(std::span<const std::uint8_t> bytes) override {
    written.emplace_back(bytes.begin(), bytes.end());
    return acknowledges;
  }
  void read(std::span<std::uint8_t> bytes) override {
    ++reads;
    for (std::uint8_t& byte : bytes) byte = 0x5A;
  }
  void stop() override { ++stops; }
  void power_up() override { ++power_ups; }
  bool acknowledges = true;
  int reads = 0, stops = 0, power_ups = 0;
  std::vector<Bytes> written;
};

TEST_CASE("I2C bus: what is written, what is read, who answers") {
  Scene s;
  Echo part{0x10}, other{0x11};
  s.bus.attach(part);
  s.bus.attach(other);
  CHECK(s.bus.transfers() == 0);
  CHECK(s.read(0x10, {1, 2}, 2) == Bytes{0x5A, 0x5A});
  CHECK(part.written == std::vector<Bytes>{{1, 2}});
  CHECK(s.read(0x10, {}, 1) == Bytes{0x5A});  // no byte is written before a read alone
  CHECK(part.written.size() == 1);
  CHECK(s.write(0x10, {}).ok());  // its address alone
  CHECK(part.written.size() == 2);
  CHECK((part.reads == 2 && part.stops == 3 && other.stops == 0));
  part.acknowledges = false;
  Bytes in{1};
  CHECK(s.bus.transfer(0x10, Bytes{7}, in).error == Error::no_answer);
  CHECK((part.reads == 2 && in == Bytes{1} && part.stops == 4));
  CHECK(s.write(0x12, {1}).error == Error::no_answer);
  s.bus.set_stuck(true);
  CHECK(s.write(0x11, {1}).error == Error::bus_fault);
  s.bus.set_stuck(false);
  CHECK(s.write(0x11, {1}).ok());
  CHECK(s.bus.transfers() == 7);
  CHECK(s.complaint().empty());
}

TEST_CASE("I2C part: it begins as after power-up each time that it comes back, and only then") {
  Scene s;
  Echo part{0x10};
  s.bus.attach(part);
  part.set_present(true);
  CHECK(s.write(0x10, {}).ok());
  CHECK(part.power_ups == 0);
  part.set_present(false);
  CHECK(s.write(0x10, {}).error == Error::no_answer);
  part.set_present(true);
  const int once = part.power_ups;
  CHECK(once >= 1);
  CHECK(s.write(0x10, {}).ok());
  const int seen = part.power_ups;
  CHECK(s.write(0x10, {}).ok());
  CHECK(part.power_ups == seen);

  bool there = true;
  part.set_presence([&there] { return there; });
  CHECK(s.write(0x10, {}).ok());
  CHECK(part.power_ups == seen);
  there = false;
  CHECK(s.write(0x10, {}).error == Error::no_answer);
  CHECK(s.write(0x10, {}).error == Error::no_answer);
  there = true;
  CHECK(s.write(0x10, {}).ok());
  CHECK(s.write(0x10, {}).ok());
  CHECK(part.power_ups == seen + 1);
  part.set_present(false);  // both must say so
  CHECK(s.write(0x10, {}).error == Error::no_answer);
}

TEST_CASE("a chip select, and a bus, without a part") {
  sim::NoSpiDevice none;
  Bytes in(3, 0);
  CHECK(none.transfer({3, 1'000'000}, Bytes{1, 2, 3}, in).ok());
  CHECK(in == Bytes{0xFF, 0xFF, 0xFF});
}

// --- AT24C01B ------------------------------------------------------------------------------------------------

struct Eeprom : Scene {
  sim::At24c01bModel model{violations, time.clock()};
  Eeprom() { bus.attach(model); }
  /// A byte write or a page write, and its cycle.
  void store(const Bytes& bytes) {
    REQUIRE(write(0x50, bytes).ok());
    time.pass(5ms);
  }
};

TEST_CASE("AT24C01B: 128 bytes, which read on from the last to the first") {
  Eeprom e;
  CHECK(e.read(0x50, {0}, 128) == Bytes(128, 0xFF));
  for (std::uint8_t i = 0; i < 128; ++i) e.store({i, i});
  Bytes all(128);
  std::iota(all.begin(), all.end(), std::uint8_t{0});
  CHECK(e.read(0x50, {0}, 128) == all);
  CHECK(e.read(0x50, {126}, 4) == Bytes{126, 127, 0, 1});
  CHECK(e.read(0x50, {}, 2) == Bytes{2, 3});  // the current address
  CHECK(e.write(0x50, {5}).ok());             // no data: nothing is written, and there is no cycle
  CHECK(e.read(0x50, {}, 1) == Bytes{5});
  CHECK(e.model.pages_written() == 128);
  CHECK(e.complaint().empty());
  CHECK(e.read(0x50, {0x85}, 1) == Bytes{5});
  CHECK(e.complaint() == "AT24C01B: there are 128 bytes");
  CHECK(e.read(0x50, {0x7F}, 1) == Bytes{127});
  CHECK(e.complaint().empty());
}

TEST_CASE("AT24C01B: a page is eight bytes, and a write goes round in it") {
  Eeprom e;
  e.store({0x10, 1, 2, 3, 4, 5, 6, 7, 8});
  CHECK(e.complaint().empty());
  CHECK(e.read(0x50, {0x0F}, 10) == Bytes{0xFF, 1, 2, 3, 4, 5, 6, 7, 8, 0xFF});
  e.store({0x16, 9, 10});
  CHECK(e.complaint().empty());
  e.store({0x16, 11, 12, 13});
  CHECK(e.complaint().find("over the end of a page") != std::string::npos);
  CHECK(e.read(0x50, {0x0F}, 10) == Bytes{0xFF, 13, 2, 3, 4, 5, 6, 11, 12, 0xFF});
}

TEST_CASE("AT24C01B: 5 ms of a write cycle without an answer; protected there is none") {
  Eeprom e;
  REQUIRE(e.write(0x50, {0, 1}).ok());
  CHECK(e.write(0x50, {}).error == Error::no_answer);
  e.time.pass(5ms - 1us);
  CHECK(e.write(0x50, {}).error == Error::no_answer);
  e.time.pass(1us);
  CHECK(e.write(0x50, {}).ok());
  CHECK(e.write(0x50, {}).ok());
  e.model.set_protected(true);
  REQUIRE(e.write(0x50, {0, 7}).ok());
  CHECK(e.read(0x50, {0}, 1) == Bytes{1});
  e.model.set_protected(false);
  REQUIRE(e.write(0x50, {0, 7}).ok());
  e.model.set_present(false);
  e.model.set_present(true);  // its cycle ended with its power
  CHECK(e.read(0x50, {0}, 1) == Bytes{7});
}

TEST_CASE("AT24C01B: power that fails in a chosen page write leaves half of the page") {
  for (std::size_t n = 1; n <= 3; ++n) {
    Eeprom e;
    e.model.tear(n);
    for (std::size_t page = 1; page < n; ++page) e.store({0x20, 1, 1, 1, 1, 1, 1, 1, 1});
    REQUIRE(e.write(0x50, {0x28, 2, 2, 2, 2, 2, 2, 2, 2}).ok());
    e.time.pass(1s);
    CHECK(e.write(0x50, {}).error == Error::no_answer);
    e.model.set_present(true);
    CHECK(e.read(0x50, {0x28}, 8) == Bytes{2, 2, 2, 2, 0xFF, 0xFF, 0xFF, 0xFF});
    e.store({0x28, 3, 3, 3, 3, 3, 3, 3, 3});  // the next one is whole
    CHECK(e.read(0x50, {0x28}, 8) == Bytes(8, 3));
    CHECK(e.model.pages_written() == n + 1);
  }
}

// --- BQ27500 -------------------------------------------------------------------------------------------------

TEST_CASE("BQ27500: each word of its standard commands, the low byte first [table 2]") {
  Scene s;
  sim::GaugeState state{true, false, 0x1122, 0x3344, -2, 0x0055, 0x0E10, -300, 0x0789, 0x0BA6};
  sim::Bq27500Model model{s.violations, [&state] { return state; }};
  s.bus.attach(model);
  const auto word = [&s](std::uint8_t command) {
    const Bytes bytes = s.read(0x55, {command}, 2);
    return bytes[0] | bytes[1] << 8;
  };
  CHECK(word(0x06) == 0x0BA6);         // Temperature()
  CHECK(word(0x08) == 0x0E10);         // Voltage()
  CHECK(word(0x10) == 0x0789);         // RemainingCapacity()
  CHECK(word(0x14) == 0x10000 - 300);  // AverageCurrent()
  CHECK(word(0x16) == 0x1122);         // TimeToEmpty()
  CHECK(word(0x18) == 0x3344);         // TimeToFull()
  CHECK(word(0x24) == 0x10000 - 2);    // AveragePower()
  CHECK(word(0x2C) == 0x0055);         // StateOfCharge()
  CHECK(word(0x0C) == 0);
  CHECK(word(0x2E) == 0);
  CHECK(word(0x30) == 0);  // beyond what is modelled
  CHECK(word(0x7E) == 0);
  // Flags(): FC, CHG, BAT_DET, DSG.
  CHECK(word(0x0A) == 0x0109);
  state.power_mw = 0;
  CHECK(word(0x0A) == 0x0108);
  state.battery = false;
  CHECK(word(0x0A) == 0x0100);
  state.full = true;
  CHECK(word(0x0A) == 0x0200);
  // On from one word to the next.
  CHECK(s.read(0x55, {0x14}, 6) == Bytes{0xD4, 0xFE, 0x22, 0x11, 0x44, 0x33});
  CHECK(s.read(0x55, {}, 2) == Bytes{0, 0});
  CHECK(s.complaint().empty());
}

TEST_CASE("BQ27500: Control() and what must not be written") {
  Scene s;
  sim::Bq27500Model model{s.violations, [] { return sim::GaugeState{}; }};
  s.bus.attach(model);
  CHECK(s.read(0x55, {0x00}, 2) == Bytes{0, 0});
  REQUIRE(s.write(0x55, {0x00, 0x01, 0x00}).ok());  // DEVICE_TYPE
  CHECK(s.read(0x55, {0x00}, 2) == Bytes{0x00, 0x05});
  REQUIRE(s.write(0x55, {0x00, 0x12, 0x00}).ok());  // the last that only asks
  CHECK(s.read(0x55, {0x00}, 2) == Bytes{0, 0});
  CHECK(s.complaint().empty());
  REQUIRE(s.write(0x55, {0x00, 0x13, 0x00}).ok());
  CHECK(s.complaint() == "bq27500: a subcommand that changes it");
  REQUIRE(s.write(0x55, {0x00, 0x01, 0x01}).ok());
  CHECK(s.complaint() == "bq27500: a subcommand that changes it");
  CHECK(s.read(0x55, {0x00}, 2) == Bytes{0, 0});
  for (const Bytes& bad : {Bytes{0x00, 0x01}, Bytes{0x00, 1, 0, 0}, Bytes{0x06, 1, 0}}) {
    CHECK(s.write(0x55, bad).error == Error::no_answer);
    CHECK(s.complaint() == "bq27500: only a subcommand of two bytes to Control() is written here");
  }
  CHECK(s.write(0x55, {0x80}).error == Error::no_answer);
  CHECK(s.complaint() == "bq27500: no command above 0x7F");
  CHECK(s.write(0x55, {0x7F}).ok());
  CHECK(s.complaint().empty());
  s.read(0x55, {0x07}, 2);
  CHECK(s.complaint() == "bq27500: half a word read");
  s.read(0x55, {0x06}, 1);
  CHECK(s.complaint() == "bq27500: half a word read");
  REQUIRE(s.write(0x55, {0x00, 0x01, 0x00}).ok());
  model.set_present(false);
  model.set_present(true);
  CHECK(s.read(0x55, {0x00}, 2) == Bytes{0, 0});
}

// --- HMC5883L ------------------------------------------------------------------------------------------------

struct Compass : Scene {
  firmware::boards::MagneticField field{};
  sim::Hmc5883lModel model{violations, time.clock(), [this] { return field; }};
  Compass() { bus.attach(model); }
  /// X, Y, Z in counts.
  std::array<int, 3> outputs() {
    const Bytes b = read(0x1E, {3}, 6);
    const auto word = [&b](std::size_t at) { return int{static_cast<std::int16_t>(b[at] << 8 | b[at + 1])}; };
    return {word(0), word(4), word(2)};
  }
  void measure_at(std::uint8_t gain) {
    REQUIRE(write(0x1E, {1, static_cast<std::uint8_t>(gain << 5)}).ok());
    REQUIRE(write(0x1E, {2, 0}).ok());
    time.pass(1s);
  }
};

TEST_CASE("HMC5883L: what it is, and how it begins") {
  Compass c;
  CHECK(c.read(0x1E, {10}, 3) == Bytes{'H', '4', '3'});
  CHECK(c.read(0x1E, {0}, 3) == Bytes{0x10, 0x20, 0x01});
  CHECK(c.read(0x1E, {13}, 2) == Bytes{0, 0});
  REQUIRE(c.write(0x1E, {0, 0x78}).ok());
  REQUIRE(c.write(0x1E, {1, 0xA0}).ok());
  REQUIRE(c.write(0x1E, {2, 0x00}).ok());
  CHECK(c.read(0x1E, {0}, 2) == Bytes{0x78, 0xA0});
  c.field = {256'000, 256'000, 256'000};
  c.time.pass(1s);
  CHECK(c.outputs()[0] == 100);
  c.model.set_present(false);
  c.model.set_present(true);
  CHECK(c.read(0x1E, {}, 2) == Bytes{0x10, 0x20});  // from the first register on
  CHECK(c.read(0x1E, {0}, 2) == Bytes{0x10, 0x20});
  CHECK(c.outputs() == std::array{0, 0, 0});
  REQUIRE(c.write(0x1E, {2, 0x00}).ok());
  c.time.pass(50ms - 1us);  // from the power on
  CHECK(c.outputs() == std::array{0, 0, 0});
  c.time.pass(1us);
  CHECK(c.outputs()[0] == 279);  // 0.256 G at 1090 counts/G
  CHECK(c.complaint().empty());
}

TEST_CASE("HMC5883L: each gain has its counts a gauss [table 9], and overflow is -4096") {
  static constexpr int per_gauss[] = {1370, 1090, 820, 660, 440, 390, 330, 230};
  for (std::uint8_t gain = 0; gain < 8; ++gain) {
    Compass c;
    c.measure_at(gain);
    c.field = {1'000'000, -500'000, 250'000};
    const auto counts = c.outputs();
    CAPTURE(int{gain});
    const double of_a_gauss = gain == 5 ? 1e6 / 2560 : per_gauss[gain];
    CHECK(std::abs(counts[0] - of_a_gauss) <= 0.5);
    CHECK(std::abs(counts[1] + of_a_gauss / 2) <= 0.5);
    CHECK(std::abs(counts[2] - of_a_gauss / 4) <= 0.5);
  }
  Compass c;
  c.measure_at(5);
  c.field = {2047 * 2560, -2048 * 2560, 2048 * 2560};
  CHECK(c.outputs() == std::array{2047, -2048, -4096});
  c.field = {-2049 * 2560, 0, 0};
  CHECK(c.outputs()[0] == -4096);
}

TEST_CASE("HMC5883L: it measures in continuous mode alone, and says so in its status") {
  Compass c;
  c.field = {256'000, 0, 0};
  c.time.pass(1s);
  CHECK(c.read(0x1E, {9}, 1) == Bytes{0x00});
  for (const std::uint8_t mode : Bytes{1, 2, 3}) {
    REQUIRE(c.write(0x1E, {2, mode}).ok());
    c.time.pass(1s);
    CHECK(c.outputs()[0] == 0);
    CHECK(c.read(0x1E, {9}, 1) == Bytes{0x00});
  }
  REQUIRE(c.write(0x1E, {2, 0x80}).ok());
  CHECK(c.read(0x1E, {9}, 1) == Bytes{0x01});
  c.time.pass(6ms - 1us);  // a measurement takes 6 ms
  CHECK(c.outputs()[0] == 0);
  CHECK(c.read(0x1E, {9}, 1) == Bytes{0x01});
  c.time.pass(1us);
  CHECK(c.outputs()[0] == 279);
  CHECK(c.read(0x1E, {2}, 1) == Bytes{0x80});  // which locks the outputs
  CHECK(c.read(0x1E, {9}, 1) == Bytes{0x03});
  c.field = {};
  CHECK(c.outputs()[0] == 279);
  CHECK(c.read(0x1E, {9}, 1) == Bytes{0x01});  // all six were read
  CHECK(c.outputs()[0] == 0);
  // Each of these ends a lock; the configuration B does not.
  c.field = {256'000, 0, 0};
  CHECK(c.outputs()[0] == 279);
  for (const auto& [bytes, unlocks] :
       {std::pair{Bytes{0, 0x10}, true}, std::pair{Bytes{1, 0x20}, false}, std::pair{Bytes{2, 0x00}, true}}) {
    c.read(0x1E, {3}, 1);
    CHECK(c.read(0x1E, {9}, 1) == Bytes{0x03});
    REQUIRE(c.write(0x1E, bytes).ok());
    CHECK(c.read(0x1E, {9}, 1) == Bytes{unlocks ? std::uint8_t{0x01} : std::uint8_t{0x03}});
    c.outputs();
  }
  CHECK(c.complaint().empty());
}

TEST_CASE("HMC5883L: reserved bits") {
  Compass c;
  const auto complaint = [&c](Bytes bytes) {
    REQUIRE(c.write(0x1E, bytes).ok());
    return c.complaint();
  };
  CHECK(complaint({0, 0x80}) == "HMC5883L: bit 7 of configuration A is reserved");
  CHECK(c.read(0x1E, {0}, 1) == Bytes{0x00});
  CHECK(complaint({0, 0x1C}) == "HMC5883L: reserved output rate");
  CHECK(complaint({0, 0x18}).empty());
  for (const std::uint8_t bit : Bytes{0x01, 0x10})
    CHECK(complaint({1, bit}).find("configuration B") != std::string::npos);
  CHECK(c.read(0x1E, {1}, 1) == Bytes{0x00});
  CHECK(complaint({1, 0xE0}).empty());
  for (const std::uint8_t bit : Bytes{0x04, 0x40})
    CHECK(complaint({2, bit}) == "HMC5883L: reserved bits of the mode");
  CHECK(complaint({2, 0x83}).empty());
  CHECK(c.read(0x1E, {2}, 1) == Bytes{0x83});
  CHECK(complaint({3, 0}) == "HMC5883L: write to a register that can only be read");
  CHECK(complaint({0, 0x10, 0x20}).find("no increment") != std::string::npos);
  CHECK(complaint({0}).empty());
}

// --- PCA9544A ------------------------------------------------------------------------------------------------

TEST_CASE("PCA9544A: one channel or none, from the STOP on") {
  Scene s;
  sim::Pca9544Model mux{s.violations};
  s.bus.attach(mux);
  std::array<Echo, 4> parts{Echo{0x20}, Echo{0x21}, Echo{0x22}, Echo{0x23}};
  for (std::size_t i = 0; i < 4; ++i) mux.channel(i).attach(parts[i]);
  const auto who = [&s] {
    std::string answer;
    for (std::uint8_t i = 0; i < 4; ++i)
      if (s.write(static_cast<std::uint8_t>(0x20 + i), {}).ok()) answer += static_cast<char>('0' + i);
    return answer;
  };
  CHECK(who().empty());
  CHECK(s.read(0x77, {}, 1) == Bytes{0});
  for (std::uint8_t i = 0; i < 4; ++i) {
    REQUIRE(s.write(0x77, {static_cast<std::uint8_t>(4 + i)}).ok());
    CHECK(who() == std::string(1, static_cast<char>('0' + i)));
    CHECK(s.read(0x77, {}, 2) == Bytes{static_cast<std::uint8_t>(4 + i), static_cast<std::uint8_t>(4 + i)});
    REQUIRE(s.write(0x77, {i}).ok());  // B2 is not set
    CHECK(who().empty());
  }
  REQUIRE(s.write(0x77, {5, 6}).ok());  // the last byte counts
  CHECK(who() == "2");
  CHECK(s.read(0x77, {7}, 1) == Bytes{6});  // read before the STOP
  CHECK(who() == "3");
  CHECK(s.complaint().empty());
  REQUIRE(s.write(0x77, {0x0C}).ok());
  CHECK(s.complaint() == "PCA9544A: bits 7 to 3 can only be read");
  CHECK(who() == "0");
  mux.set_present(false);
  CHECK(who().empty());
  mux.set_present(true);
  CHECK(who().empty());
  CHECK(s.read(0x77, {}, 1) == Bytes{0});
}

// --- VCNL4020 ------------------------------------------------------------------------------------------------

struct Proximity : Scene {
  std::uint16_t counts = 0x1234, light = 0x5678;
  sim::Vcnl4020Model model{violations, time.clock(), [this] { return counts; }, [this] { return light; }};
  Proximity() { bus.attach(model); }
  std::uint8_t at(std::uint8_t where) { return read(0x13, {where}, 1)[0]; }
  void put(std::uint8_t where, std::uint8_t value) { REQUIRE(write(0x13, {where, value}).ok()); }
};

TEST_CASE("VCNL4020: its registers as it begins, and again when it comes back") {
  Proximity p;
  const Bytes reset{0x80, 0x21, 0x00, 0x02, 0x1D, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x01, 0, 0xFF};
  CHECK(p.read(0x13, {0x80}, 18) == reset);
  p.put(0x82, 7);
  p.put(0x83, 20);
  p.put(0x84, 0x7F);
  for (std::uint8_t where = 0x89; where <= 0x8E; ++where) p.put(where, where);
  CHECK(p.read(0x13, {0x82}, 3) == Bytes{7, 20, 0x7F});
  CHECK(p.read(0x13, {0x89}, 6) == Bytes{0x89, 0x8A, 0x8B, 0x8C, 0x8D, 0x8E});
  REQUIRE(p.write(0x13, {0x82, 1, 2, 3}).ok());  // one after the other
  CHECK(p.read(0x13, {0x82}, 3) == Bytes{1, 2, 3});
  CHECK(p.complaint().empty());
  p.model.set_present(false);
  p.model.set_present(true);
  CHECK(p.read(0x13, {}, 18) == reset);  // from the first register on
  CHECK(p.read(0x13, {0x80}, 18) == reset);
}

TEST_CASE("VCNL4020: what must not be written") {
  Proximity p;
  const auto complaint = [&p](std::uint8_t where, std::uint8_t value) {
    p.put(where, value);
    return p.complaint();
  };
  for (const std::uint8_t where : Bytes{0x81, 0x85, 0x86, 0x87, 0x88, 0x90})
    CHECK(complaint(where, 1) == "VCNL4020: write to a register that can only be read");
  CHECK(complaint(0x8F, 1) == "VCNL4020: the modulator's timing is the maker's");
  CHECK(complaint(0x82, 0x08) == "VCNL4020: reserved bits of the rate");
  CHECK(p.at(0x82) == 0);
  CHECK(complaint(0x83, 21) == "VCNL4020: LED current above 200 mA");
  CHECK(p.at(0x83) == 20);
  CHECK(complaint(0x83, 0x40) == "VCNL4020: bits 7 and 6 of the LED current can only be read");
  CHECK(p.at(0x83) == 0);
  CHECK(complaint(0x84, 0x80).find("continuous conversion") != std::string::npos);
  for (const std::uint8_t demand : Bytes{0x08, 0x10}) {
    CHECK(complaint(0x80, demand).empty());
    CHECK(complaint(0x80, demand | 0x01) == "VCNL4020: measurement on demand while self-timed");
    p.put(0x80, 0);
  }
  p.put(0x80, 0x01);
  CHECK(complaint(0x82, 1) == "VCNL4020: rate changed while self-timed");
  CHECK(complaint(0x84, 1) == "VCNL4020: rate changed while self-timed");
  CHECK((p.at(0x82) == 0 && p.at(0x84) == 0x80));
  for (const std::uint8_t where : Bytes{0x7F, 0x91}) {
    CHECK(p.write(0x13, {where}).error == Error::no_answer);
    CHECK(p.complaint() == "VCNL4020: register " + std::to_string(where) + " is none");
  }
}

TEST_CASE("VCNL4020: proximity at each rate, in proportion to the LED's current [registers #2, #3]") {
  for (std::uint8_t rate = 0; rate < 8; ++rate) {
    CAPTURE(int{rate});
    Proximity p;
    p.put(0x82, rate);
    p.put(0x83, 20);
    p.put(0x80, 0x03);
    p.time.pass(std::chrono::nanoseconds{512'000'000 >> rate} - 1us);
    CHECK(p.read(0x13, {0x87}, 2) == Bytes{0, 0});
    p.time.pass(1us);
    CHECK(p.at(0x80) == 0xA3);  // config_lock, prox_data_rdy, prox_en, selftimed_en
    CHECK(p.read(0x13, {0x87}, 2) == Bytes{0x12, 0x34});
  }
  Proximity p;
  p.counts = 1000;
  p.put(0x83, 7);
  p.put(0x80, 0x03);
  p.time.pass(1s);
  CHECK(p.read(0x13, {0x87}, 2) == Bytes{350 / 256, 350 % 256});
  p.put(0x80, 0x01);  // not this one
  p.counts = 0;
  CHECK(p.read(0x13, {0x87}, 2) == Bytes{350 / 256, 350 % 256});
  p.put(0x80, 0x02);
  CHECK(p.read(0x13, {0x87}, 2) == Bytes{350 / 256, 350 % 256});
}

TEST_CASE("VCNL4020: light at each rate [register #4]") {
  static constexpr int a_second[] = {1, 2, 3, 4, 5, 6, 8, 10};
  for (std::uint8_t rate = 0; rate < 8; ++rate) {
    CAPTURE(int{rate});
    Proximity p;
    p.put(0x84, static_cast<std::uint8_t>(rate << 4 | 5));
    p.put(0x80, 0x05);
    p.time.pass(std::chrono::nanoseconds{1'000'000'000 / a_second[rate]} - 1us);
    CHECK(p.read(0x13, {0x85}, 2) == Bytes{0, 0});
    p.time.pass(2us);
    CHECK(p.at(0x80) == 0xC5);  // als_data_rdy
    CHECK(p.read(0x13, {0x85}, 4) == Bytes{0x56, 0x78, 0, 0});
  }
  Proximity p;
  p.time.pass(10s);  // after a pause the time begins again
  p.put(0x80, 0x05);
  p.time.pass(400ms);
  p.put(0x80, 0x00);
  p.time.pass(10s);
  p.put(0x80, 0x05);
  p.time.pass(499ms);
  CHECK(p.read(0x13, {0x85}, 2) == Bytes{0, 0});
  p.put(0x80, 0x05);  // on already
  p.time.pass(1ms);
  CHECK(p.read(0x13, {0x85}, 2) == Bytes{0x56, 0x78});
  p.light = 1;
  p.put(0x80, 0x01);
  CHECK(p.read(0x13, {0x85}, 2) == Bytes{0x56, 0x78});
}

TEST_CASE("VCNL4020: reading a result takes its mark away, and no other") {
  Proximity p;
  p.put(0x80, 0x07);
  p.time.pass(1s);
  CHECK(p.at(0x80) == 0xE7);
  p.put(0x80, 0x00);  // nothing new comes
  CHECK(p.at(0x80) == 0xE0);
  for (const auto& [where, left] : {std::pair{0x87, 0xC0}, {0x88, 0xC0}, {0x85, 0xA0}, {0x86, 0xA0}}) {
    p.put(0x80, 0x07);
    CHECK(p.at(0x80) == 0x87 + (0xE0 & 0x60));
    p.put(0x80, 0x00);
    p.at(static_cast<std::uint8_t>(where));
    CHECK(p.at(0x80) == left);
    p.put(0x80, 0x07);
    p.time.pass(1s);
    p.at(0x80);
  }
  CHECK(p.complaint().empty());
}

// --- the motion sensors --------------------------------------------------------------------------------------

constexpr firmware::drivers::SpiSettings spi{3, 10'000'000};

/// A part on SPI: writes and reads of several registers, as both makers have them.
template <class Model, std::uint8_t several>
struct OnSpi {
  HandClock time;
  sim::Violations violations;

  static Bytes exchange(Model& model, const Bytes& out, const firmware::drivers::SpiSettings& how = spi) {
    Bytes in(out.size(), 0xEE);
    REQUIRE(model.transfer(how, out, in).ok());
    return in;
  }
  static Bytes read(Model& model, std::uint8_t first, std::size_t count) {
    Bytes out(1 + count, 0);
    out[0] = static_cast<std::uint8_t>(0x80 | (count > 1 ? several : 0) | first);
    const Bytes in = exchange(model, out);
    return {in.begin() + 1, in.end()};
  }
  static void put(Model& model, std::uint8_t where, std::uint8_t value) { exchange(model, {where, value}); }
  static std::array<int, 3> axes(Model& model, std::uint8_t first) {
    const Bytes b = read(model, first, 6);
    const auto word = [&b](std::size_t at) { return int{static_cast<std::int16_t>(b[at] | b[at + 1] << 8)}; };
    return {word(0), word(2), word(4)};
  }
  std::string complaint() {
    REQUIRE(violations.texts().size() <= 1);
    const std::string text = violations.none() ? std::string{} : violations.texts().front();
    violations.clear();
    return text;
  }
};

struct Gyroscope : OnSpi<sim::StMotionModel, 0x40> {
  firmware::boards::AngularRate rate{1000, -1000, 2};
  sim::L3g4200dModel model{violations, time.clock(), [this] { return rate; }};
};
struct Accelerometer : OnSpi<sim::StMotionModel, 0x40> {
  firmware::boards::SpecificForce force{1024, -1024, 4};
  sim::Lis331dlhModel model{violations, time.clock(), [this] { return force; }};
};

TEST_CASE("L3G4200D, LIS331DLH: what they are, and how they begin") {
  Gyroscope g;
  CHECK(g.read(g.model, 0x0F, 1) == Bytes{0xD3});
  CHECK(g.read(g.model, 0x20, 5) == Bytes{0x07, 0, 0, 0, 0});
  CHECK(g.read(g.model, 0x3F, 2) == Bytes{0, 0});  // from the last register on to the first
  CHECK(g.axes(g.model, 0x28) == std::array{0, 0, 0});
  g.put(g.model, 0x20, 0x0F);
  g.put(g.model, 0x24, 0x80);
  CHECK(g.read(g.model, 0x20, 5) == Bytes{0x0F, 0, 0, 0, 0x80});
  g.model.set_present(false);
  CHECK(g.read(g.model, 0x0F, 2) == Bytes{0xFF, 0xFF});
  g.model.set_present(true);
  CHECK(g.read(g.model, 0x20, 5) == Bytes{0x07, 0, 0, 0, 0});
  bool there = true;
  g.model.set_presence([&there] { return there; });
  g.put(g.model, 0x20, 0x0F);
  CHECK(g.read(g.model, 0x20, 1) == Bytes{0x0F});
  there = false;
  CHECK(g.read(g.model, 0x20, 1) == Bytes{0xFF});
  there = true;
  CHECK(g.read(g.model, 0x20, 1) == Bytes{0x07});
  g.time.pass(10s);  // powered down
  CHECK(g.read(g.model, 0x27, 1) == Bytes{0});
  CHECK(g.complaint().empty());
  Accelerometer a;
  CHECK(a.read(a.model, 0x0F, 1) == Bytes{0x32});
  CHECK(a.read(a.model, 0x20, 1) == Bytes{0x07});
}

TEST_CASE(
    "L3G4200D: each full scale has its sensitivity, each axis its switch, and there is an end [table 4]") {
  Gyroscope g;
  g.put(g.model, 0x20, 0x0F);
  g.time.pass(300ms);
  static constexpr std::pair<std::uint8_t, std::array<int, 3>> scales[] = {
      {0x00, {2000, -2000, 4}}, {0x10, {1000, -1000, 2}}, {0x20, {250, -250, 1}}, {0x30, {250, -250, 1}}};
  for (const auto& [control, digits] : scales) {
    g.put(g.model, 0x23, control);
    CHECK(g.axes(g.model, 0x28) == digits);
  }
  g.put(g.model, 0x23, 0x00);
  g.rate = {20'000, -20'000, 0};
  CHECK(g.axes(g.model, 0x28) == std::array{32767, -32768, 0});
  g.put(g.model, 0x23, 0x50);  // BLE
  g.rate = {0x1234, -2, 0x00FF};
  CHECK(g.read(g.model, 0x28, 6) == Bytes{0x12, 0x34, 0xFF, 0xFE, 0x00, 0xFF});
  g.put(g.model, 0x23, 0x10);
  g.rate = {1, 2, 3};
  g.put(g.model, 0x20, 0x09);
  CHECK(g.axes(g.model, 0x28) == std::array{1, 0, 0});
  g.put(g.model, 0x20, 0x0A);
  CHECK(g.axes(g.model, 0x28) == std::array{0, 2, 0});
  g.put(g.model, 0x20, 0x0C);
  CHECK(g.axes(g.model, 0x28) == std::array{0, 0, 3});
  CHECK(g.complaint().empty());
}

TEST_CASE("LIS331DLH: each full scale, twelve bits on the left, and how long each rate takes to begin") {
  static constexpr std::pair<std::uint8_t, std::array<int, 3>> scales[] = {
      {0x00, {16 * 1024, -16 * 1024, 16 * 4}},
      {0x10, {16 * 512, -16 * 512, 16 * 2}},
      {0x20, {0, 0, 0}},  // none
      {0x30, {16 * 256, -16 * 256, 16}}};
  Accelerometer a;
  a.put(a.model, 0x20, 0x27);
  a.time.pass(1s);
  for (const auto& [control, digits] : scales) {
    a.put(a.model, 0x23, control);
    CHECK(a.axes(a.model, 0x28) == digits);
  }
  a.put(a.model, 0x23, 0x00);
  a.force = {3000, -3000, 0};
  CHECK(a.axes(a.model, 0x28) == std::array{16 * 2047, -16 * 2048, 0});
  a.put(a.model, 0x23, 0x10);
  a.force = {-1, 1, 3};  // rounded down
  CHECK(a.axes(a.model, 0x28) == std::array{-16, 0, 16});
  a.force = {2, 4, 6};
  for (const auto& [enabled, digits] :
       {std::pair{0x21, std::array{16, 0, 0}}, std::pair{0x22, std::array{0, 32, 0}},
        std::pair{0x24, std::array{0, 0, 48}}}) {
    a.put(a.model, 0x20, static_cast<std::uint8_t>(enabled));
    CHECK(a.axes(a.model, 0x28) == digits);
  }
  CHECK(a.complaint().empty());
  static constexpr std::pair<std::uint8_t, std::chrono::microseconds> begins[] = {
      {0x27, 21'000us}, {0x2F, 11'000us}, {0x37, 3'500us}, {0x3F, 2'000us}, {0xC7, 21'000us}};
  for (const auto& [control, wait] : begins) {
    Accelerometer b;
    b.time.pass(1s);
    b.put(b.model, 0x20, control);
    b.time.pass(wait - 1us);
    CHECK(b.read(b.model, 0x27, 1) == Bytes{0});
    b.time.pass(1us);
    CHECK(b.read(b.model, 0x27, 1) == Bytes{0x0F});
  }
}

TEST_CASE("L3G4200D, LIS331DLH: what must not be sent") {
  Gyroscope g;
  const auto complaint = [&g](const Bytes& out, const firmware::drivers::SpiSettings& how = spi) {
    g.exchange(g.model, out, how);
    return g.complaint();
  };
  CHECK(complaint({0x20, 0x0F}).empty());
  CHECK(complaint({0x8F}) == "L3G4200D: a frame of fewer than 16 clocks");
  CHECK(complaint({0x8F, 0}, {3, 10'000'001}) == "L3G4200D: SPI clock above 10 MHz");
  CHECK(g.exchange(g.model, {0x8F, 0}, {3, 10'000'001}) == Bytes{0xA5, 0xA5});
  g.violations.clear();
  CHECK(complaint({0x8F, 0}, {0, 1}) == "L3G4200D: SPI mode 0: the clock idles high");
  CHECK(g.exchange(g.model, {0x8F, 0}, {0, 1})[1] == 0xD3);  // it works all the same
  g.violations.clear();
  // In modes 1 and 2 all is one bit late: 0x8F comes as 0xC7, and what is answered is seen late as well.
  g.put(g.model, 0x20, 0x0F);
  g.time.pass(1s);
  for (const std::uint8_t mode : Bytes{1, 2}) {
    const Bytes in = g.exchange(g.model, {0x1E, 0x00}, {mode, 1});  // taken for 0x8F, 0x00
    CHECK(in == Bytes{0xFF, 0xE9});                                 // 0xD3 behind a 1
    CHECK(g.complaint().find("SPI mode") != std::string::npos);
  }
  CHECK(complaint({0xA0, 0, 0}) == "L3G4200D: several bytes without the MS bit: the address stays");
  CHECK(g.exchange(g.model, {0xA0, 0, 0}) == Bytes{0xFF, 0x0F, 0x0F});
  g.violations.clear();
  CHECK(complaint({0xA0, 0}).empty());
  for (const std::uint8_t where : Bytes{0x1F, 0x25})
    CHECK(complaint({where, 0}) ==
          "L3G4200D: write to register " + std::to_string(where) + ", which is not one of control");
  for (const std::uint8_t where : Bytes{0x20, 0x24}) CHECK(complaint({where, 0}).empty());
  for (const auto& [where, bits] :
       {std::pair{0x20, 0x00}, {0x21, 0xC0}, {0x22, 0x00}, {0x23, 0x08}, {0x24, 0x20}})
    for (unsigned bit = 1; bit < 256; bit *= 2)
      CHECK(complaint({static_cast<std::uint8_t>(where), static_cast<std::uint8_t>(bit)}).empty() ==
            ((bit & static_cast<unsigned>(bits)) == 0));
  g.model.set_stuck(true);
  Bytes in(2);
  CHECK(g.model.transfer(spi, Bytes{0x8F, 0}, in).error == Error::bus_fault);
  Accelerometer a;
  for (std::uint8_t where = 0x20; where <= 0x24; ++where)
    for (unsigned bit = 1; bit < 256; bit *= 2) {
      a.put(a.model, where, static_cast<std::uint8_t>(bit));
      CHECK(a.complaint().empty() == !(where == 0x24 && (bit & 0xFC) != 0));
    }
}

struct Imu : OnSpi<sim::Lsm6ds3Model, 0> {
  sim::Lsm6ds3Model::Rates rates{};
  sim::Lsm6ds3Model model{violations, time.clock(), [this] { return rates; }};
};

TEST_CASE("LSM6DS3: what it is, how it begins, and what resets it") {
  Imu i;
  CHECK(i.read(i.model, 0x0F, 1) == Bytes{0x69});
  const Bytes reset{0, 0, 0x04, 0, 0, 0, 0, 0, 0x38, 0x38};
  CHECK(i.read(i.model, 0x10, 10) == reset);
  CHECK(i.read(i.model, 0x7F, 2) == Bytes{0, 0});
  const auto disturb = [&i] {
    i.put(i.model, 0x11, 0x1C);
    i.put(i.model, 0x19, 0x20);
    CHECK(i.read(i.model, 0x11, 1) == Bytes{0x1C});
    CHECK(i.read(i.model, 0x19, 1) == Bytes{0x20});
  };
  for (const std::uint8_t bit : Bytes{0x01, 0x80}) {  // SW_RESET, BOOT
    disturb();
    i.put(i.model, 0x12, bit);
    CHECK(i.read(i.model, 0x10, 10) == reset);
  }
  disturb();
  i.model.set_present(false);
  CHECK(i.read(i.model, 0x0F, 2) == Bytes{0xFF, 0xFF});
  i.model.set_present(true);
  CHECK(i.read(i.model, 0x10, 10) == reset);
  bool there = true;
  i.model.set_presence([&there] { return there; });
  disturb();
  there = false;
  CHECK(i.read(i.model, 0x11, 1) == Bytes{0xFF});
  there = true;
  CHECK(i.read(i.model, 0x10, 10) == reset);
  disturb();  // and it is not reset again
  CHECK(i.complaint().empty());
}

TEST_CASE("LSM6DS3: each full scale, each axis, both orders, and its ends [table 3]") {
  constexpr double deg = 3.14159265358979 / 180;
  Imu i;
  i.put(i.model, 0x11, 0x10);
  i.time.pass(80ms - 1us);
  CHECK(i.read(i.model, 0x1E, 1) == Bytes{0});
  i.time.pass(1us);
  CHECK(i.read(i.model, 0x1E, 1) == Bytes{0x02});
  i.rates = {70 * deg, -70 * deg, 0.07 * deg};
  static constexpr std::pair<std::uint8_t, std::array<int, 3>> scales[] = {
      {0x10, {8000, -8000, 8}}, {0x14, {4000, -4000, 4}},    {0x18, {2000, -2000, 2}},
      {0x1C, {1000, -1000, 1}}, {0x12, {16000, -16000, 16}}, {0x1E, {16000, -16000, 16}}};
  for (const auto& [control, digits] : scales) {
    i.put(i.model, 0x11, control);
    CHECK(i.axes(i.model, 0x22) == digits);
  }
  i.put(i.model, 0x11, 0x12);
  i.rates = {1000 * deg, -1000 * deg, 0};
  CHECK(i.axes(i.model, 0x22) == std::array{32767, -32768, 0});
  i.rates = {4.375e-3 * 0x1234 * deg, 4.375e-3 * -2 * deg, 4.375e-3 * 255 * deg};
  for (const auto& [enabled, shown] :
       {std::pair{0x08, std::array{0x1234, 0, 0}}, std::pair{0x10, std::array{0, -2, 0}},
        std::pair{0x20, std::array{0, 0, 255}}, std::pair{0x38, std::array{0x1234, -2, 255}}}) {
    i.put(i.model, 0x19, static_cast<std::uint8_t>(enabled));
    CHECK(i.axes(i.model, 0x22) == shown);
  }
  i.put(i.model, 0x12, 0x06);  // BLE
  CHECK(i.read(i.model, 0x22, 6) == Bytes{0x12, 0x34, 0xFF, 0xFE, 0x00, 0xFF});
  i.put(i.model, 0x11, 0x02);  // off
  CHECK(i.read(i.model, 0x1E, 1) == Bytes{0});
  CHECK(i.axes(i.model, 0x22) == std::array{0, 0, 0});
  i.time.pass(1s);
  i.put(i.model, 0x11, 0x82);  // 1.66 kHz, the fastest
  CHECK(i.read(i.model, 0x1E, 1) == Bytes{0});
  i.time.pass(40ms);
  i.put(i.model, 0x11, 0x42);  // on already
  i.time.pass(40ms);
  CHECK(i.read(i.model, 0x1E, 1) == Bytes{0x02});
  CHECK(i.complaint().empty());
}

TEST_CASE("LSM6DS3: what must not be sent") {
  Imu i;
  const auto complaint = [&i](const Bytes& out, const firmware::drivers::SpiSettings& how = spi) {
    i.exchange(i.model, out, how);
    return i.complaint();
  };
  CHECK(complaint({0x8F, 0}).empty());
  CHECK(complaint({0x8F}) == "LSM6DS3: a frame of fewer than 16 clocks");
  CHECK(complaint({0x8F, 0}, {3, 10'000'001}) == "LSM6DS3: SPI clock above 10 MHz");
  for (const std::uint8_t mode : Bytes{0, 1, 2}) {
    CHECK(i.exchange(i.model, {0x8F, 0}, {mode, 1}) == Bytes{0xA5, 0xA5});
    CHECK(i.complaint() == "LSM6DS3: SPI mode " + std::to_string(mode) + ": the clock idles high");
  }
  for (const std::uint8_t where : Bytes{0x0F, 0x1A})
    CHECK(complaint({where, 0}) ==
          "LSM6DS3: write to register " + std::to_string(where) + ", which is not one of control");
  for (const std::uint8_t where : Bytes{0x10, 0x19}) CHECK(complaint({where, 0}).empty());
  CHECK(complaint({0x11, 0x80}).empty());
  for (const std::uint8_t bad : Bytes{0x01, 0x90})
    CHECK(complaint({0x11, bad}) == "LSM6DS3: reserved bits in CTRL2_G");
  CHECK(complaint({0x12, 0x00}).empty());
  CHECK(complaint({0x8F, 0}).empty());
  CHECK(complaint({0x8F, 0, 0}) == "LSM6DS3: several bytes without IF_INC: the address stays");
  CHECK(i.exchange(i.model, {0x8F, 0, 0}) == Bytes{0xFF, 0x69, 0x69});
  i.violations.clear();
  i.model.set_stuck(true);
  Bytes in(2);
  CHECK(i.model.transfer(spi, Bytes{0x8F, 0}, in).error == Error::bus_fault);
}

// --- TLC5947 -------------------------------------------------------------------------------------------------

TEST_CASE("TLC5947: twelve bits an output, the last output first, each light of three") {
  sim::Violations violations;
  std::array<firmware::boards::Colour, 8> seen{};
  std::size_t calls = 0;
  sim::Tlc5947Model model{violations, [&](std::size_t light, firmware::boards::Colour colour) {
                            seen.at(light) = colour;
                            ++calls;
                          }};
  // Output n has 0x81 * n.
  Bytes frame(36);
  for (unsigned n = 0; n < 24; ++n) {
    const unsigned level = 0x81U * n, first = (23 - n) * 12;
    for (unsigned bit = 0; bit < 12; ++bit)
      if ((level >> (11 - bit) & 1) != 0)
        frame[(first + bit) / 8] |= static_cast<std::uint8_t>(0x80U >> (first + bit) % 8);
  }
  Bytes in(36, 0);
  REQUIRE(model.transfer({0, 30'000'000}, frame, in).ok());
  CHECK(in == Bytes(36, 0xFF));
  for (std::size_t n = 0; n < 24; ++n) CHECK(model.level(n) == 0);  // BLANK is high still
  CHECK(seen == std::array<firmware::boards::Colour, 8>{});
  model.set_blank(false);
  for (unsigned n = 0; n < 24; ++n) CHECK(model.level(n) == 0x81U * n);
  for (unsigned light = 0; light < 8; ++light) {
    const auto of = [](unsigned output) { return static_cast<std::uint8_t>((0x81U * output) >> 4); };
    CHECK(seen[light] ==
          firmware::boards::Colour{of(21 - 3 * light), of(22 - 3 * light), of(23 - 3 * light)});
  }
  CHECK(calls == 16);
  model.set_blank(true);
  CHECK(seen == std::array<firmware::boards::Colour, 8>{});
  CHECK(violations.none());
  REQUIRE(model.transfer({0, 30'000'001}, frame, in).ok());
  CHECK(violations.texts() == std::vector<std::string>{"TLC5947: SCLK above 30 MHz"});
  violations.clear();
  // Taken at the other edge: a bit late, the first is that of the line at rest.
  for (const std::uint8_t mode : Bytes{1, 2}) {
    REQUIRE(model.transfer({mode, 1}, Bytes(36, 0x00), in).ok());
    CHECK(violations.texts() == std::vector<std::string>{"TLC5947: data are taken at the rising edge"});
    violations.clear();
    model.set_blank(false);
    CHECK(model.level(23) == 0x800);
    CHECK(model.level(22) == 0);
    model.set_blank(true);
  }
  REQUIRE(model.transfer({3, 1}, Bytes(36, 0xFF), in).ok());
  CHECK(violations.none());
  // A byte too few: the rest is what was there, eight bits on.
  REQUIRE(model.transfer({0, 1}, Bytes(35, 0x00), in).ok());
  CHECK(violations.texts() == std::vector<std::string>{"TLC5947: not 288 bits between two edges of XLAT"});
  model.set_blank(false);
  CHECK(model.level(23) == 0xFF0);
  CHECK(model.level(0) == 0);
  model.set_stuck(true);
  CHECK(model.transfer({0, 1}, frame, in).error == Error::bus_fault);
}

TEST_CASE("TLC5947: with BLANK low before anything is latched it shows anything") {
  sim::Violations violations;
  sim::Tlc5947Model model{violations, nullptr};
  model.set_blank(true);
  CHECK(violations.none());
  model.set_blank(false);
  CHECK(violations.texts() == std::vector<std::string>{"TLC5947: BLANK low before anything was latched"});
  CHECK((model.level(0) != 0 && model.level(23) != 0));
}

// --- USART ---------------------------------------------------------------------------------------------------

using Usart = sim::UsartModel;
using firmware::drivers::usart::Register;

TEST_CASE("USART model: its flags and its interrupt [RM0008 27.6.1, table 198]") {
  constexpr std::uint32_t fe = 2, ne = 4, ore = 8, rxne = 1U << 5, tc = 1U << 6, txe = 1U << 7;
  constexpr std::uint32_t ue = 1U << 13, te = 1U << 3, re = 1U << 2, rxneie = 1U << 5, txeie = 1U << 7;
  Usart usart;
  sim::UsartModelRegisters registers{usart};
  CHECK(registers.read(Register::sr) == (txe | tc));
  CHECK_FALSE(usart.interrupt());
  usart.arrive('x');  // off
  registers.write(Register::cr1, re);
  usart.arrive('x');
  registers.write(Register::cr1, ue);
  usart.arrive('x');
  CHECK(registers.read(Register::sr) == (txe | tc));
  registers.write(Register::cr1, ue | re | te);
  CHECK(registers.read(Register::cr1) == (ue | re | te));
  registers.write(Register::brr, 625);
  CHECK(registers.read(Register::brr) == 625);

  usart.arrive('a');
  CHECK(registers.read(Register::sr) == (txe | tc | rxne));
  CHECK_FALSE(usart.interrupt());
  registers.write(Register::cr1, ue | re | te | rxneie);
  CHECK(usart.interrupt());
  CHECK(registers.read(Register::dr) == 'a');
  CHECK_FALSE(usart.interrupt());
  CHECK(registers.read(Register::sr) == (txe | tc));
  usart.arrive('b', true, false);
  CHECK(registers.read(Register::sr) == (txe | tc | rxne | ne));
  CHECK(registers.read(Register::dr) == 'b');
  usart.arrive('c', false, true);
  CHECK(registers.read(Register::sr) == (txe | tc | rxne | fe));
  usart.arrive('d');  // lost
  CHECK(usart.overwritten == 1);
  CHECK(registers.read(Register::dr) == 'c');
  CHECK(registers.read(Register::sr) == (txe | tc | ore));  // it had not been seen
  CHECK(usart.interrupt());
  registers.read(Register::dr);
  CHECK(registers.read(Register::sr) == (txe | tc));

  CHECK_FALSE(usart.shift());
  registers.write(Register::dr, '1');  // at once into the shift register
  CHECK(registers.read(Register::sr) == txe);
  registers.write(Register::dr, '2');
  CHECK(registers.read(Register::sr) == 0);
  CHECK(usart.sent.empty());
  registers.write(Register::cr1, ue | re | te | txeie);
  CHECK_FALSE(usart.interrupt());
  CHECK(usart.shift());
  CHECK(usart.sent == "1");
  CHECK(registers.read(Register::sr) == txe);
  CHECK(usart.interrupt());
  registers.write(Register::cr1, ue | re | te);
  CHECK_FALSE(usart.interrupt());
  CHECK(usart.shift());
  CHECK_FALSE(usart.shift());
  CHECK(usart.sent == "12");
  CHECK(registers.read(Register::sr) == (txe | tc));
  CHECK(usart.violations.empty());
}

TEST_CASE("USART model: what must not be written, and that each access is seen") {
  constexpr std::uint32_t on = 1U << 13 | 1U << 3;
  using Lines = std::vector<std::string>;
  Usart usart;
  unsigned accesses = 0;
  usart.on_access = [&accesses] { ++accesses; };
  const auto complaints = [&usart](Register which, std::uint32_t value) {
    usart.violations.clear();
    usart.write(which, value);
    return usart.violations;
  };
  CHECK(complaints(Register::sr, 0) == Lines{"SR written"});
  for (const std::uint32_t off : {0U, 1U << 13, 1U << 3}) {
    usart.write(Register::cr1, off);
    CHECK(complaints(Register::dr, 'x') == Lines{"sent by a transmitter that is off"});
    while (usart.shift()) {
    }
  }
  usart.write(Register::cr1, on);
  CHECK(complaints(Register::brr, 1).empty());
  CHECK(complaints(Register::dr, 0xFF).empty());
  CHECK(complaints(Register::brr, 2) == Lines{"bit rate changed in a character"});
  CHECK(complaints(Register::dr, 0x100) == Lines{"nine bits"});
  CHECK(complaints(Register::dr, 'y') == Lines{"DR written while it is full"});
  accesses = 0;
  usart.read(Register::sr);
  usart.write(Register::cr1, on);
  CHECK(accesses == 2);
}

// --- a board without parts -----------------------------------------------------------------------------------

struct Bare : sim::BoardParts {
  Bare() = default;
};

TEST_CASE("a board's parts that are not there") {
  Bare bare;
  CHECK(bare.i2c(1).transfer(0x10, Bytes{1}, {}).error == Error::no_answer);
  Bytes in(1);
  CHECK(bare.spi(1).transfer({3, 1}, Bytes{1}, in).ok());
  CHECK(in == Bytes{0xFF});
  CHECK(bare.inputs().read() == 0);
  bare.outputs().write(1);
  bare.motors().set_power(true);
  bare.motors().set_duty(1, 2);
  CHECK(bare.motors().duty() == std::array<std::int16_t, 2>{1, 2});
  CHECK(bare.violations().none());
}

TEST_CASE("motors: a duty is a part of full duty while there is power, and without it a mistake") {
  sim::World world;
  sim::Violations violations;
  sim::MotorsModel motors{world, violations};
  CHECK_FALSE(motors.powered());
  motors.set_duty(0, 0);
  CHECK(violations.none());
  for (const auto& [left, right] : {std::pair{1, 0}, {0, -1}}) {
    motors.set_duty(static_cast<std::int16_t>(left), static_cast<std::int16_t>(right));
    CHECK(violations.texts() == std::vector<std::string>{"motors: duty without power"});
    violations.clear();
  }
  motors.set_power(true);
  CHECK(motors.powered());
  motors.set_duty(-32767, 32767);
  CHECK(motors.duty() == std::array<std::int16_t, 2>{-32767, 32767});
  CHECK(violations.none());
  for (const auto& [left, right] : {std::pair{-32768, 0}, {0, -32768}}) {
    motors.set_duty(static_cast<std::int16_t>(left), static_cast<std::int16_t>(right));
    CHECK(violations.texts() == std::vector<std::string>{"motors: duty beyond all"});
    violations.clear();
  }
}

// --- the line to an emulated board ---------------------------------------------------------------------------

TEST_CASE("an SPI transfer of an emulated board: its clock in four bytes, and as many out as in") {
  struct Seen : sim::SpiDevice {
    base::Status transfer(const firmware::drivers::SpiSettings& how, std::span<const std::uint8_t> out,
                          std::span<std::uint8_t> in) override {
      settings = how;
      bytes.assign(out.begin(), out.end());
      std::fill(in.begin(), in.end(), std::uint8_t{9});
      return {};
    }
    firmware::drivers::SpiSettings settings{};
    Bytes bytes;
  } device;
  const Bytes written{0x78, 0x56, 0x34, 0x12, 7, 8};
  firmware::qemu::link::Request request{};
  request.a = 2;
  request.written = written;
  Bytes in(2);
  CHECK(sim::transfer(device, request, in).ok());
  CHECK(device.settings.mode == 2);
  CHECK(device.settings.highest_clock_hz == 0x1234'5678);
  CHECK(device.bytes == Bytes{7, 8});
  CHECK(in == Bytes{9, 9});
  for (const std::size_t count : {1U, 3U}) {
    Bytes other(count);
    CHECK(sim::transfer(device, request, other).error == Error::bad_length);
  }
  request.written = std::span{written}.first(3);
  CHECK(sim::transfer(device, request, std::span<std::uint8_t>{}).error == Error::bad_length);
  request.written = std::span{written}.first(4);
  CHECK(sim::transfer(device, request, std::span<std::uint8_t>{}).ok());
}

}  // namespace firmware_drivers_models_test
