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
static_assert(ir_distance(1.0F, {0.0F, 0.0F}) == IrReading{}, "a curve without a slope tells no distance");

// 10 bits at 5 V.
static_assert(adc_volts(0, 10, 5.0F) == 0.0F && adc_volts(1023, 10, 5.0F) == 5.0F);
static_assert(near(adc_volts(512, 10, 5.0F), 2.50244F));

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
    const IrReading low = ir_distance(static_cast<float>(mv) / 1000.0F);
    const IrReading high = ir_distance(static_cast<float>(mv + 1) / 1000.0F);
    REQUIRE((high.distance_cm < low.distance_cm || low.range == IrRange::nothing));
  }
}

}  // namespace sensing_ir_sensor_test
