#include "ocm/sensing/tower.hpp"

#include <limits>

#include <catch2/catch.hpp>

#include "unit/motion/near.hpp"

namespace sensing_tower_test {

using namespace ocm::sensing;
using ocm::base::Error;
using ocm::motion::Movement;
using ocm::motion::pi;
using ocm::motion::Point;
using ocm::motion::Pose;
using ocm::motion::radians;
using ocm::test::near;

// T2 table 6.1.
static_assert(tower_mode(false, false, Movement::straight) == TowerMode::parked);
static_assert(tower_mode(true, false, Movement::standing) == TowerMode::waiting);
static_assert(tower_mode(true, false, Movement::rotating) == TowerMode::holding);
static_assert(tower_mode(true, true, Movement::straight) == TowerMode::holding);
static_assert(tower_mode(true, false, Movement::straight) == TowerMode::driving);

static_assert(next({40, true}, TowerMode::parked) == Sweep{0, true});
static_assert(next({40, false}, TowerMode::holding) == Sweep{40, false});
static_assert(next({40, true}, TowerMode::waiting) == Sweep{42, true});
static_assert(next({40, false}, TowerMode::driving) == Sweep{30, false});
static_assert(next({85, true}, TowerMode::driving) == Sweep{90, false} &&
              next({90, true}, TowerMode::driving) == Sweep{90, false});
static_assert(next({5, false}, TowerMode::driving) == Sweep{0, true});

constexpr Tower tower{.ahead_of_axle_m = 0.05F};
static_assert(near(bearing_rad(tower, 0, TowerSensor::forward), 0.0F));
static_assert(near(bearing_rad(tower, 30, TowerSensor::left), radians(120.0F)));
static_assert(near(bearing_rad(tower, 90, TowerSensor::right), 0.0F, 1e-6F),
              "the right one looks ahead [T2 listing 8.2]");
static_assert(near(bearing_rad(tower, 90, TowerSensor::backward), radians(-90.0F)));
static_assert(near(bearing_rad(tower, 200, TowerSensor::forward), radians(90.0F)));

TEST_CASE("the sweep goes to and fro, and sees all around in both modes", "[sensing]") {
  for (const TowerMode mode : {TowerMode::waiting, TowerMode::driving}) {
    Sweep sweep{};
    int ends = 0;
    for (int i = 0; i < 360; ++i) {
      const Sweep before = sweep;
      sweep = next(sweep, mode);
      REQUIRE((sweep.servo_deg >= 0 && sweep.servo_deg <= 90));
      REQUIRE(sweep.servo_deg != before.servo_deg);
      ends += sweep.servo_deg == 90 ? 1 : 0;
    }
    CHECK(ends == (mode == TowerMode::waiting ? 4 : 20));
  }
}

TEST_CASE("where a reading lies, by hand", "[sensing]") {
  // The robot at (1, 2) looks left; its tower is 5 cm ahead of the axle.
  const Pose robot{1.0F, 2.0F, pi / 2.0F};
  const auto seen = [&](int servo, TowerSensor sensor, float cm) {
    return seen_at(robot, tower, servo, sensor, {cm, IrRange::useful}).value;
  };
  const auto is = [](Point point, float x, float y) { return near(point.x_m, x) && near(point.y_m, y); };
  CHECK(is(seen(0, TowerSensor::forward, 45.0F), 1.0F, 2.5F));
  CHECK(is(seen(0, TowerSensor::left, 45.0F), 0.55F, 2.05F));
  CHECK(is(seen(0, TowerSensor::backward, 45.0F), 1.0F, 1.6F));
  CHECK(is(seen(0, TowerSensor::right, 45.0F), 1.45F, 2.05F));
  CHECK(is(seen(90, TowerSensor::right, 45.0F), 1.0F, 2.5F));
  CHECK(is(seen(30, TowerSensor::forward, 40.0F), 0.8F, 2.05F + 0.4F * 0.8660254F));

  Tower wide = tower;
  wide.sensor_out_m[0] = 0.02F;
  CHECK(is(seen_at(robot, wide, 0, TowerSensor::forward, {45.0F, IrRange::useful}).value, 1.0F, 2.52F));
}

TEST_CASE("nothing seen is no point", "[sensing]") {
  CHECK(seen_at({}, tower, 0, TowerSensor::forward, {}).error == Error::not_sampled);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const IrReading reading{30.0F, IrRange::useful};
  CHECK(seen_at({nan, 0.0F, 0.0F}, tower, 0, TowerSensor::forward, reading).error == Error::not_sampled);
  CHECK(seen_at({}, tower, 0, TowerSensor::forward, reading).ok());
}

}  // namespace sensing_tower_test
