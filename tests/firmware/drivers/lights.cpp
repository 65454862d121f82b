#include <array>
#include <map>

#include <catch2/catch.hpp>

#include "firmware/boards/light_ring/parts.hpp"
#include "firmware/drivers/tlc5947.hpp"
#include "sim/parts/board_parts.hpp"
#include "sim/parts/tlc5947_model.hpp"
#include "tests/firmware/drivers/fixture.hpp"

namespace firmware_drivers_lights_test {

using namespace drivers_tests;
using namespace ocm;
using namespace ocm::firmware;
using boards::Colour;

// Output 23 goes first, high bit first. [data sheet, Register Configuration]
constexpr auto frame = [] {
  std::array<std::uint16_t, 24> levels{};
  levels[23] = 0xABC;
  levels[22] = 0x123;
  levels[0] = 0xFFF;
  return drivers::tlc5947::pack(levels);
}();
static_assert(frame[0] == 0xAB && frame[1] == 0xC1 && frame[2] == 0x23);
static_assert(frame[34] == 0x0F && frame[35] == 0xFF);

struct Lights {
  sim::Violations violations;
  std::map<std::size_t, Colour> seen;
  sim::Tlc5947Model model{violations, [this](std::size_t light, Colour colour) { seen[light] = colour; }};
  SpoiledSpi bus{&model, {}};
  sim::OutputPins pins{[this](std::uint8_t levels) { model.set_blank((levels & 1) != 0); }};
  boards::light_ring::Parts<SpoiledSpi, sim::OutputPins> parts{bus, pins};
};

TEST_CASE("lights: dark at the start, then each its colour") {
  Lights l;
  l.parts.start({});
  for (std::size_t i = 0; i < 8; ++i) CHECK(l.seen[i] == Colour{});
  CHECK(l.violations.none());
  for (std::size_t i = 0; i < 8; ++i) {
    const Colour colour{static_cast<std::uint8_t>(255 - i), static_cast<std::uint8_t>(10 * i + 1),
                        static_cast<std::uint8_t>(i)};
    l.parts.set_light(i, colour);
    CHECK(l.seen[i] == colour);
  }
  CHECK(l.seen[0] == Colour{255, 1, 0});  // the others stay
  l.parts.set_light(8, {1, 2, 3});        // there is none
  for (int level = 0; level < 256; ++level) {
    l.parts.set_light(3, {static_cast<std::uint8_t>(level), 0, static_cast<std::uint8_t>(255 - level)});
    REQUIRE(l.seen[3] == Colour{static_cast<std::uint8_t>(level), 0, static_cast<std::uint8_t>(255 - level)});
  }
  CHECK(l.violations.none());
}

TEST_CASE("lights: full is all the time, off is never") {
  Lights l;
  l.parts.start({});
  l.parts.set_light(0, {255, 128, 0});
  CHECK(l.model.level(21) == 4095);
  CHECK(l.model.level(22) == 2056);
  CHECK(l.model.level(23) == 0);
}

TEST_CASE("lights: what is wrong is noticed") {
  Lights l;
  SECTION("outputs on before anything is latched") {
    l.model.set_blank(false);
    CHECK(complained(l.violations, "BLANK"));
    CHECK(l.model.level(5) != 0);  // random
  }
  SECTION("mode") {
    l.bus.spoil = [](drivers::SpiSettings& s, auto&) { s.mode = 1; };
    l.parts.start({});
    l.parts.set_light(0, {0xAA, 0, 0});
    CHECK(complained(l.violations, "rising edge"));
    CHECK_FALSE(l.seen[0] == Colour{0xAA, 0, 0});
  }
  SECTION("length") {
    l.bus.spoil = [](drivers::SpiSettings&, auto& bytes) { bytes.pop_back(); };
    l.parts.start({});
    l.parts.set_light(7, {1, 2, 3});
    CHECK(complained(l.violations, "288"));
    CHECK_FALSE(l.seen[7] == Colour{1, 2, 3});
  }
  SECTION("clock") {
    l.bus.spoil = [](drivers::SpiSettings& s, auto&) { s.highest_clock_hz = 36'000'000; };
    l.parts.start({});
    CHECK(complained(l.violations, "30 MHz"));
  }
}

TEST_CASE("lights: a bus that fails is said, and all is shown again when it works") {
  Lights l;
  l.model.set_stuck(true);
  l.parts.start({});
  CHECK(l.parts.absent() == boards::light_ring::part::lights);
  l.parts.set_light(2, {9, 9, 9});
  CHECK(l.parts.faults() == 2);
  CHECK(l.model.level(15) == 0);  // blanked as long as the latch is random
  l.model.set_stuck(false);
  l.parts.maintain(base::Time{} + 999ms);
  CHECK(l.parts.absent() != 0);
  l.parts.maintain(base::Time{} + 1s);
  CHECK(l.parts.absent() == 0);
  CHECK(l.seen[2] == Colour{9, 9, 9});
  CHECK(l.violations.none());
}

}  // namespace firmware_drivers_lights_test
