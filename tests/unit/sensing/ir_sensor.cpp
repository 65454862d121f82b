#include "ocm/sensing/ir_sensor.hpp"

#include <limits>

#include <catch2/catch.hpp>

#include "unit/motion/near.hpp"

namespace sensing_ir_sensor_test {

using namespace ocm::sensing;
using ocm::test::near;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

// a = 1.9 / (1/10 - 1/80) = 21.714, b = 0.4 - 21.714 / 80 = 0.12857. [Data sheet: 0.4 V at 80 cm, 1.9 V more
// at 10]
static_assert(near(typical_ir_curve.slope_v_cm, 21.7143F, 1e-3F) &&
              near(typical_ir_curve.offset_v, 0.128571F));
static_assert(near(ir_volts(10.0F), 2.3F) && near(ir_volts(80.0F), 0.4F));
static_assert(near(ir_volts(20.0F), 1.214286F));  // 21.714 / 20 + 0.12857
static_assert(ir_volts(4.9F) == ir_volts(80.0F) && ir_volts(0.0F) == ir_volts(80.0F),
              "below 5 cm like far away");
static_assert(ir_volts(5.0F) > 4.0F);

static_assert(ir_distance(2.3F).range == IrRange::useful &&
              near(ir_distance(2.3F).distance_cm, 10.0F, 1e-3F));
static_assert(ir_distance(0.4F).range == IrRange::useful &&
              near(ir_distance(0.4F).distance_cm, 80.0F, 1e-2F));
static_assert(near(ir_distance(1.214286F).distance_cm, 20.0F, 1e-3F));
static_assert(ir_distance(2.4F).range == IrRange::too_near && ir_distance(2.4F).distance_cm < 10.0F);
static_assert(ir_distance(0.39F) == IrReading{}, "beyond 80 cm nothing is seen, and the distance is 0");
static_assert(ir_distance(0.0F) == IrReading{} && ir_distance(-1.0F) == IrReading{});
static_assert(ir_distance(0.128571F) == IrReading{} && ir_distance(nan) == IrReading{});
static_assert(ir_distance(std::numeric_limits<float>::infinity()) == IrReading{});

// 10 bits at 5 V.
static_assert(adc_volts(0, 10, 5.0F) == 0.0F && adc_volts(1023, 10, 5.0F) == 5.0F);
static_assert(near(adc_volts(512, 10, 5.0F), 2.50244F));

constexpr IrTable<3> table{{{{10.0F, 2.5F}, {20.0F, 1.5F}, {80.0F, 0.3F}}}};
static_assert(table.valid());
static_assert(near(ir_distance(2.5F, table).distance_cm, 10.0F, 1e-3F));
static_assert(near(ir_distance(1.5F, table).distance_cm, 20.0F, 1e-3F));
static_assert(near(ir_distance(0.3F, table).distance_cm, 80.0F, 1e-2F));
// Half way between 2.5 and 1.5 V is half way in 1/d: 2 / (1/10 + 1/20) = 13.33 cm.
static_assert(near(ir_distance(2.0F, table).distance_cm, 13.3333F, 1e-3F));
// Half way between 1.5 and 0.3 V: 2 / (1/20 + 1/80) = 32 cm.
static_assert(near(ir_distance(0.9F, table).distance_cm, 32.0F, 1e-3F));
static_assert(ir_distance(0.2F, table) == IrReading{} && ir_distance(nan, table) == IrReading{});
static_assert(ir_distance(2.6F, table).range == IrRange::too_near);

static_assert(!IrTable<2>{{{{20.0F, 1.5F}, {10.0F, 2.5F}}}}.valid(), "from near to far");
static_assert(!IrTable<2>{{{{10.0F, 1.5F}, {20.0F, 1.5F}}}}.valid());
static_assert(!IrTable<2>{{{{0.0F, 1.5F}, {20.0F, 1.0F}}}}.valid());
static_assert(!IrTable<2>{{{{10.0F, nan}, {20.0F, 1.0F}}}}.valid());

constexpr IrReading at(float cm) {
  return {cm, cm < 10.0F ? IrRange::too_near : IrRange::useful};
}
static_assert(plausible(at(6.0F), {}, 2.0F) == IrReading{6.0F, IrRange::too_near},
              "it came nearer than 5 cm");
static_assert(plausible(at(6.0F), at(70.0F), 2.0F) == IrReading{6.0F, IrRange::too_near});
static_assert(plausible(at(6.0F), at(8.0F), 2.0F) == at(8.0F), "it went away as fast as the robot can");
static_assert(plausible(at(30.0F), {}, 2.0F) == IrReading{}, "from 30 cm nothing is under 5 cm in one step");
static_assert(plausible({}, at(70.0F), 2.0F) == at(70.0F) && plausible({}, {}, 2.0F) == IrReading{});

TEST_CASE("from distance to volts and back", "[sensing]") {
  for (float cm = 10.0F; cm <= 80.0F; cm += 0.5F) {
    const IrReading reading = ir_distance(ir_volts(cm));
    CAPTURE(cm, reading.distance_cm);
    REQUIRE(reading.range == IrRange::useful);
    REQUIRE(near(reading.distance_cm, cm, 0.01F));
  }
}

TEST_CASE("a higher voltage is never farther", "[sensing]") {
  for (int mv = 300; mv < 3500; ++mv) {
    const IrReading low = ir_distance(static_cast<float>(mv) / 1000.0F, table);
    const IrReading high = ir_distance(static_cast<float>(mv + 1) / 1000.0F, table);
    REQUIRE((high.distance_cm < low.distance_cm || low.range == IrRange::nothing));
  }
}

}  // namespace sensing_ir_sensor_test
