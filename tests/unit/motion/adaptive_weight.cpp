#include "ocm/motion/adaptive_weight.hpp"

#include <limits>

#include <catch2/catch.hpp>

#include "unit/motion/near.hpp"

namespace motion_adaptive_weight_test {

using namespace ocm::motion;
using ocm::base::Error;
using ocm::test::near;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

// Known 1.5, gyro 1.45, wheels 1.65: (1.5 - 1.65) / (1.45 - 1.65) = 0.75. [T2 eq. 7.5]
static_assert(near(gyro_weight({1.5F, 1.45F, 1.65F}, 0.05F).value, 0.75F));
static_assert(gyro_weight({1.3F, 1.45F, 1.65F}, 0.05F).value == 1.0F, "beyond the gyro: clamped");
static_assert(gyro_weight({1.7F, 1.45F, 1.65F}, 0.05F).value == 0.0F, "beyond the wheels: clamped");
// The same three, 1.65 rad on: they lie on both sides of pi.
static_assert(near(gyro_weight({wrap(3.15F), wrap(3.10F), wrap(3.30F)}, 0.05F).value, 0.75F, 1e-4F));
static_assert(gyro_weight({1.5F, 1.49F, 1.51F}, 0.05F).error == Error::out_of_range);
static_assert(gyro_weight({1.5F, 1.5F, 1.5F}, 0.0F).error == Error::out_of_range);
static_assert(gyro_weight({nan, 1.45F, 1.65F}, 0.05F).error == Error::not_sampled);
static_assert(gyro_weight({1.5F, nan, 1.65F}, 0.05F).error == Error::not_sampled);
static_assert(gyro_weight({1.5F, 1.45F, nan}, 0.05F).error == Error::not_sampled);
static_assert(gyro_weight({1.5F, 1.45F, 1.65F}, nan).error == Error::out_of_range);

static_assert(near(adapted(0.75F, 0.25F, 0.1F), 0.70F) && adapted(0.75F, 0.25F, 0.0F) == 0.75F);
static_assert(adapted(0.75F, nan, 0.1F) == 0.75F && adapted(0.5F, 9.0F, 5.0F) == 1.0F);

TEST_CASE("the weight finds the floor it drives on", "[motion]") {
  // The gyro is 1/30 low and the wheels 1/10 high: eq. 7.4 is right at a = 0.75 only.
  float weight = 0.2F;
  for (int i = 0; i < 100; ++i) {
    const auto step = gyro_weight({1.0F, 29.0F / 30.0F, 1.1F}, 0.05F);
    REQUIRE(step.ok());
    weight = adapted(weight, *step, 0.1F);
    REQUIRE((weight >= 0.0F && weight <= 1.0F));
  }
  CHECK(near(weight, 0.75F, 1e-3F));
}

}  // namespace motion_adaptive_weight_test
