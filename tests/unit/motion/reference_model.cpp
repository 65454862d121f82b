#include "ocm/motion/reference_model.hpp"

#include <limits>

#include <catch2/catch.hpp>

#include "unit/motion/near.hpp"

namespace motion_reference_model_test {

using namespace ocm::motion;
using ocm::test::near;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

// r = 0, then 0.25 of 8, then 0.25 of the 6 that are left. [T2 eq. 7.1]
static_assert(approach(0.0F, 8.0F, 0.25F) == 2.0F && approach(2.0F, 8.0F, 0.25F) == 3.5F);
static_assert(approach(2.0F, nan, 0.25F) == 2.0F && approach(2.0F, 8.0F, 0.0F) == 2.0F);
static_assert(approach(2.0F, 8.0F, 7.0F) == 8.0F, "a gain above 1 does not overshoot");

constexpr ReferenceModel model{.gain = 0.36F, .period_s = 0.030F};

TEST_CASE("with no numbers of its own, the model is the thesis' period and a tenth", "[motion]") {
  CHECK(near(approach(2.0F, 12.0F, ReferenceModel{}, 0.030F), 3.0F));  // [T2 table 9.2]
}

TEST_CASE("half the time twice is the whole time once", "[motion]") {
  CHECK(gain_over(model, 0.030F) == 0.36F);
  CHECK(near(gain_over(model, 0.015F), 0.2F));     // 1 - sqrt(0.64)
  CHECK(near(gain_over(model, 0.060F), 0.5904F));  // 1 - 0.64^2
  const float once = approach(1.0F, 5.0F, model, 0.030F);
  const float twice = approach(approach(1.0F, 5.0F, model, 0.010F), 5.0F, model, 0.020F);
  CHECK(near(once, twice));
}

TEST_CASE("the reference approaches, and never passes the set point", "[motion]") {
  float r = 0.0F;
  for (int i = 0; i < 200; ++i) {
    const float next = approach(r, 1.0F, model, 0.007F + 0.001F * static_cast<float>(i % 40));
    REQUIRE(next >= r);
    REQUIRE(next <= 1.0F);
    r = next;
  }
  CHECK(near(r, 1.0F));
}

TEST_CASE("a gain that cannot be is the nearest that can, for a part of the period, too", "[motion]") {
  CHECK(gain_over({.gain = 1.5F, .period_s = 0.03F}, 0.01F) == 1.0F);
  CHECK(gain_over({.gain = -0.5F, .period_s = 0.03F}, 0.01F) == 0.0F);
}

TEST_CASE("a step that is too great for a float moves nothing", "[motion]") {
  CHECK(approach(3e38F, -3e38F, 0.25F) == 3e38F);
}

TEST_CASE("a time that cannot be moves nothing", "[motion]") {
  for (const float dt : {0.0F, -1.0F, nan, std::numeric_limits<float>::infinity()}) {
    CHECK(approach(2.0F, 8.0F, model, dt) == 2.0F);
  }
  CHECK(approach(2.0F, 8.0F, ReferenceModel{.gain = 0.5F, .period_s = 0.0F}, 0.03F) == 2.0F);
}

}  // namespace motion_reference_model_test
