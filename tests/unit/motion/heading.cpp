#include "ocm/motion/heading.hpp"

#include <limits>

#include <catch2/catch.hpp>

#include "unit/motion/near.hpp"

namespace motion_heading_test {

using namespace ocm::motion;
using ocm::test::near;
using ocm::test::near_angle;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float dt = 0.030F;

constexpr HeadingModel model{
    .gyro_threshold_rad_s = 0.01F, .gyro_variance_rad2_per_s = 0.001F, .wheel_variance_rad2_per_s = 0.002F};

constexpr float turn(float gyro, float wheels, Movement movement, const HeadingModel& m = model) {
  return blend({gyro, wheels}, movement, dt, m).angle_rad;
}

// 0.75 * 1 rad/s * 30 ms + 0.25 * 0.04 rad = 0.0325 rad. [T2 eq. 7.4]
static_assert(near(turn(1.0F, 0.04F, Movement::rotating), 0.0325F, 1e-7F));
static_assert(turn(1.0F, 0.04F, Movement::straight) == 0.04F, "only the wheels while it does not rotate");
static_assert(turn(1.0F, 0.04F, Movement::standing) == 0.04F);
static_assert(turn(0.0099F, 0.04F, Movement::rotating) == 0.04F, "a small reading is left out");
static_assert(turn(-0.0099F, 0.04F, Movement::rotating) == 0.04F);
constexpr HeadingModel exact{.gyro_threshold_rad_s = 0.25F};
static_assert(blend({0.25F, 0.0F}, Movement::rotating, 0.5F, exact).angle_rad == 0.75F * 0.125F,
              "the threshold itself is no small reading");
static_assert(turn(nan, 0.04F, Movement::rotating) == 0.04F && near(turn(1.0F, nan, Movement::rotating), dt));
static_assert(turn(nan, nan, Movement::rotating) == 0.0F);
static_assert(blend({nan, 0.0F}, Movement::standing, dt, model).gyro_rejected);
static_assert(blend({0.0F, nan}, Movement::standing, dt, model).wheels_rejected);
static_assert(!blend({0.0F, 0.0F}, Movement::standing, dt, model).gyro_rejected);
// Without a threshold every reading counts; without readings nothing turns, and nothing is rejected.
static_assert(near(turn(1e-4F, 0.0F, Movement::rotating, {}), 0.75F * 1e-4F * dt, 1e-9F));
static_assert(Turn{}.angle_rad == 0.0F && !Turn{}.gyro_rejected && !Turn{}.wheels_rejected);
static_assert(predict({}, 0.0F, dt, {}) == Heading{0.0F, 0.0F});

// A weight that cannot be is the nearest that can: all of the gyro, or nothing of it.
constexpr HeadingModel too_much{.gyro_weight = 1.5F};
constexpr HeadingModel too_little{.gyro_weight = -0.5F};
static_assert(near(turn(1.0F, 0.04F, Movement::rotating, too_much), dt, 1e-7F));
static_assert(turn(1.0F, 0.04F, Movement::rotating, too_little) == 0.04F);

// The second robot: gyro alone, whatever it does. [T2 §14.3]
constexpr HeadingModel gyro_alone{.source = HeadingSource::gyro, .gyro_threshold_rad_s = 0.01F};
static_assert(near(turn(1.0F, 0.9F, Movement::standing, gyro_alone), dt));
static_assert(turn(nan, 0.9F, Movement::rotating, gyro_alone) == 0.0F);
static_assert(turn(0.009F, 0.9F, Movement::rotating, gyro_alone) == 0.0F);

// P = 0.01 + (0.001 + 0.002) * 0.030 = 0.01009
static_assert(near(predict({1.0F, 0.01F}, 0.1F, dt, model).angle_rad, 1.1F));
static_assert(predict({1.0F, 0.01F}, 0.1F, dt, {.gyro_variance_rad2_per_s = -1.0F}).variance_rad2 == 0.0F,
              "no variance is less than none");
static_assert(near(predict({1.0F, 0.01F}, 0.1F, dt, model).variance_rad2, 0.01009F, 1e-8F));
static_assert(predict({3.1F, 0.0F}, 0.1F, dt, model).angle_rad < 0.0F, "wrapped");
static_assert(predict({1.0F, 0.01F}, nan, dt, model) == Heading{1.0F, 0.01F});
static_assert(predict({1.0F, 0.01F}, 0.1F, nan, model) == Heading{1.0F, 0.01F});
static_assert(predict({1.0F, 0.01F}, 0.1F, -dt, model) == Heading{1.0F, 0.01F});

// mm per tick 1, wheelbase 100 mm: 2 * 1 / 100 = 0.02 rad, squared 0.0004. [T2 eq. 7.3]
static_assert(near(wheel_variance_rad2({0.1F / two_pi, 0.1F, 100.0F}), 0.0004F, 1e-8F));

TEST_CASE("the thesis' weight is right where the gyro is 1/30 low and the wheels 1/10 high", "[motion]") {
  // 0.75 (1 - 1/30) + 0.25 (1 + 1/10) = 1: each sensor alone is wrong, the blend is not.
  Heading heading{};
  for (int i = 0; i < 100; ++i) {
    heading = predict(heading, turn(29.0F / 30.0F * 0.5F, 1.1F * 0.5F * dt, Movement::rotating), dt, model);
  }
  CHECK(near(heading.angle_rad, 100 * 0.5F * dt, 1e-4F));
}

TEST_CASE("the variance grows without end and stays finite", "[motion]") {
  Heading heading{};
  const HeadingModel wild{.gyro_variance_rad2_per_s = 1e30F, .wheel_variance_rad2_per_s = 1e30F};
  for (int i = 0; i < 1000; ++i) {
    const float before = heading.variance_rad2;
    heading = predict(heading, 0.1F, dt, wild);
    REQUIRE(heading.variance_rad2 >= before);
    REQUIRE(is_finite(heading.variance_rad2));
    REQUIRE((heading.angle_rad > -pi && heading.angle_rad <= pi));
  }
  CHECK(heading.variance_rad2 == two_pi * two_pi);  // a whole turn: nothing more can be unknown
}

TEST_CASE("what gets too great for a float turns nothing, and leaves the heading as it was", "[motion]") {
  const Turn blended = blend({3e38F, 0.04F}, Movement::rotating, 10.0F, model);
  CHECK(blended.gyro_rejected);
  CHECK(blended.angle_rad == 0.04F);
  const Turn alone = blend({3e38F, 0.04F}, Movement::rotating, 10.0F, gyro_alone);
  CHECK(alone.gyro_rejected);
  CHECK(alone.angle_rad == 0.0F);
  const HeadingModel wild{.gyro_variance_rad2_per_s = 1e30F, .wheel_variance_rad2_per_s = 1e30F};
  CHECK(predict({1.0F, 0.01F}, 0.1F, 1e10F, wild) == Heading{1.0F, 0.01F});
}

TEST_CASE("the bias is the mean at rest, and what moves is no bias", "[motion]") {
  GyroBias bias{0.1F};
  for (const float reading : {0.01F, 0.02F, 0.03F, 0.04F}) CHECK(bias.add(reading));
  CHECK(GyroBias{0.1F}.add(0.1F));  // the bound is not beyond it
  CHECK(GyroBias{0.1F}.add(-0.1F));
  CHECK_FALSE(bias.add(0.2F));
  CHECK_FALSE(bias.add(-0.2F));
  CHECK_FALSE(bias.add(nan));
  CHECK(near(bias.bias_rad_s(), 0.025F, 1e-7F));
  // (0.015^2 + 0.005^2) * 2 / 3
  CHECK(near(bias.variance_rad2_s2(), 0.00016667F, 1e-8F));
  CHECK(bias.count() == 4);
  CHECK(bias.rejected() == 3);
}

TEST_CASE("one reading has no variance, and the second gives it one", "[motion]") {
  GyroBias bias{0.1F};
  CHECK(bias.variance_rad2_s2() == 0.0F);
  bias.add(0.05F);
  CHECK(bias.variance_rad2_s2() == 0.0F);
  CHECK(bias.bias_rad_s() == 0.05F);
  bias.add(0.07F);
  CHECK(near(bias.variance_rad2_s2(), 0.0002F, 1e-8F));  // of two: half of their difference squared
}

}  // namespace motion_heading_test
