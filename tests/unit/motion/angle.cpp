#include "ocm/motion/angle.hpp"

#include <cmath>
#include <limits>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"
#include "unit/motion/near.hpp"

namespace motion_angle_test {

using namespace ocm::motion;
using ocm::test::near;
using ocm::test::near_angle;
using ocm::test::Random;

static_assert(wrap(0.0F) == 0.0F && wrap(1.0F) == 1.0F && wrap(-3.0F) == -3.0F);
static_assert(wrap(pi) == pi, "pi belongs to the range");
static_assert(near(wrap(-pi), pi, 3e-7F), "-pi does not");
static_assert(near(wrap(radians(190.0F)), radians(-170.0F)) && near(wrap(radians(-190.0F)), radians(170.0F)));
static_assert(near(wrap(radians(360.0F)), 0.0F) && near(wrap(radians(725.0F)), radians(5.0F)));
static_assert(near(radians(180.0F), pi) && near(degrees(pi / 2.0F), 90.0F));

// From 170 to -170 degrees it is 20 to the left, not 340 to the right. [T2 §8.2]
static_assert(near(difference(radians(-170.0F), radians(170.0F)), radians(20.0F)));
static_assert(near(difference(radians(170.0F), radians(-170.0F)), radians(-20.0F)));

/// T2 listing 8.1, in double.
double by_listing(double angle) {
  constexpr double half = 3.14159265358979;
  do {
    if (angle > half) angle -= 2.0 * half;
    if (angle < -half) angle += 2.0 * half;
  } while (std::fabs(angle) > half);
  return angle;
}

TEST_CASE("wrap is the listing's loop, and never leaves its range", "[motion]") {
  Random random{1};
  for (int i = 0; i < 20'000; ++i) {
    const auto angle = static_cast<float>(random.within(-2'000'000, 2'000'000)) / 1e4F;  // 32 turns each way
    const float wrapped = wrap(angle);
    CAPTURE(angle, wrapped);
    REQUIRE((wrapped > -pi && wrapped <= pi));
    REQUIRE(near_angle(wrapped, static_cast<float>(by_listing(angle)), 2e-5F));
  }
}

TEST_CASE("an angle of any size is wrapped into the range", "[motion]") {
  for (float angle = 1.0F; angle < 1e38F; angle *= 1.7F) {
    for (const float signed_angle : {angle, -angle}) {
      const float wrapped = wrap(signed_angle);
      CAPTURE(signed_angle, wrapped);
      REQUIRE((wrapped > -pi && wrapped <= pi));
    }
  }
}

TEST_CASE("around every odd multiple of pi the result stays in the range", "[motion]") {
  for (int k = -101; k <= 101; k += 2) {
    float angle = static_cast<float>(k) * pi;
    for (int i = 0; i < 5; ++i) angle = std::nextafter(angle, -1e9F);
    for (int i = 0; i < 11; ++i, angle = std::nextafter(angle, 1e9F)) {
      const float wrapped = wrap(angle);
      CAPTURE(angle, wrapped);
      REQUIRE((wrapped > -pi && wrapped <= pi));
      REQUIRE(near(std::fabs(wrapped), pi, 4e-4F));  // 11 steps of a float at 101 pi
    }
  }
}

TEST_CASE("what is not finite has no direction", "[motion]") {
  CHECK(std::isnan(wrap(std::numeric_limits<float>::quiet_NaN())));
  CHECK(std::isnan(wrap(std::numeric_limits<float>::infinity())));
  CHECK(std::isnan(wrap(-std::numeric_limits<float>::infinity())));
}

}  // namespace motion_angle_test
