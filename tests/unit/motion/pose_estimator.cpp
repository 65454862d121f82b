#include "ocm/motion/pose_estimator.hpp"

#include <cmath>
#include <limits>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"
#include "unit/motion/near.hpp"

namespace motion_pose_estimator_test {

using namespace ocm::motion;
using ocm::test::near;
using ocm::test::near_angle;
using ocm::test::Random;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float dt = 0.030F;

// One tick is 1 mm, the wheels stand 100 mm apart.
constexpr EstimatorModel model{
    .drive = {0.1F / two_pi, 0.1F, 100.0F},
    .heading = {.gyro_variance_rad2_per_s = 0.001F, .wheel_variance_rad2_per_s = 0.0004F},
    .most_ticks = 100,
    .compass_variance_rad2 = 10.0F};

Estimate begun() {
  return estimate({}, {}, dt, model);
}

TEST_CASE("one step of the listing, by hand", "[motion]") {
  // 60 and 40 ticks: 50 mm, -0.2 rad by the wheels; the gyro says -6 rad/s * 30 ms = -0.18 rad. Blended at
  // 0.75: -0.185 rad. x = 50 cos(-0.0925) = 49.786 mm, y = 50 sin(-0.0925) = -4.6184 mm. [T2 listing 7.1]
  const Estimate e = estimate(begun(), {60, 40, -6.0F, 0.0F, Movement::rotating}, dt, model);
  CHECK(near(e.pose.x_m, 0.049786F, 1e-6F));
  CHECK(near(e.pose.y_m, -0.0046184F, 1e-6F));
  CHECK(near(e.pose.heading_rad, -0.185F));
  CHECK(near(e.heading_variance_rad2, 2 * 0.0014F * dt, 1e-8F));
  CHECK_FALSE(e.compass_used);
}

TEST_CASE("the compass corrects where the robot stands and trusts it, and slowly", "[motion]") {
  Estimate e = begun();
  e = estimate(e, {10, 10, 0.0F, 0.1F, Movement::straight}, dt, model);
  CHECK_FALSE(e.compass_used);
  e = estimate(e, {20, 20, 0.0F, 0.1F, Movement::straight}, dt, model);
  e.heading_variance_rad2 = 0.1F;
  e = estimate(e, {20, 20, 0.0F, 0.1F, Movement::standing}, dt, model);
  CHECK(e.compass_used);
  // K = 0.1 / 10.1, of 0.1 rad
  CHECK(near(e.pose.heading_rad, 0.00099F, 1e-5F));
  for (int i = 0; i < 20'000; ++i) e = estimate(e, {20, 20, 0.0F, 0.1F, Movement::standing}, dt, model);
  CHECK(near(e.pose.heading_rad, 0.1F, 1e-3F));
  CHECK(near(e.pose.x_m, 0.020F, 1e-6F));
}

TEST_CASE("a disturbed place turns nothing", "[motion]") {
  Estimate e = begun();
  e = estimate(e, {10, 10, 0.0F, 0.0F, Movement::straight}, dt, model);
  for (int i = 0; i < 1000; ++i) e = estimate(e, {20, 20, 0.0F, 0.5F, Movement::standing}, dt, model);
  CHECK(e.pose.heading_rad == 0.0F);
  CHECK_FALSE(e.compass_used);
}

TEST_CASE("a compass that is farther off than two sigmas turns nothing, where the model has the gate",
          "[motion]") {
  EstimatorModel gated = model;
  gated.compass_variance_rad2 = 0.01F;
  gated.compass_rule = CompassRule::always;
  gated.compass_undisturbed_rad = 0.05F;
  for (const float gate : {0.0F, 2.0F}) {
    gated.compass_gate = gate;
    Estimate state = begun();
    state.heading_variance_rad2 = 0.0F;
    const float far = 0.6F;  // of sigma 0.05 and little
    const Estimate after = estimate(state, {0, 0, 0.0F, far, Movement::standing}, dt, gated);
    CHECK(after.compass_used == (gate == 0.0F));
    CHECK(after.rejected.compass == 0);
    const Estimate near_it = estimate(state, {0, 0, 0.0F, 0.05F, Movement::standing}, dt, gated);
    CHECK(near_it.compass_used);
    CHECK(near_it.pose.heading_rad > 0.0F);
  }
}

TEST_CASE("the second robot turns by its gyro, and its compass speaks always", "[motion]") {
  const EstimatorModel second = gyro_and_compass(model);
  Estimate e = estimate({}, {}, dt, second);
  // The encoder is broken: it says that the robot turned.
  e = estimate(e, {0, 50, 0.0F, 0.0F, Movement::rotating}, dt, second);
  CHECK(near(e.pose.heading_rad, 0.0F));
  CHECK(e.compass_used);
  e = estimate(e, {0, 50, 2.0F, 0.06F, Movement::rotating}, dt, second);
  CHECK(near(e.pose.heading_rad, 0.06F));
}

TEST_CASE("every cause of a rejection has its counter, and the pose stays as it was", "[motion]") {
  Estimate e = begun();
  e = estimate(e, {0, 0, nan, 0.0F, Movement::rotating}, dt, model);
  CHECK(e.rejected == EstimatorCounters{.time = 0, .gyro = 1, .compass = 0});
  e = estimate(e, {0, 0, 0.0F, nan, Movement::standing}, dt, gyro_and_compass(model));
  CHECK(e.rejected == EstimatorCounters{.time = 0, .gyro = 1, .compass = 1});
  e = estimate(e, {0, 0, 0.0F, 0.0F, Movement::standing}, 0.0F, model);
  CHECK(e.rejected == EstimatorCounters{.time = 1, .gyro = 1, .compass = 1});
  e = estimate(e, {1000, 0, 0.0F, 0.0F, Movement::straight}, dt, model);
  CHECK(e.wheels.rejected == 1);
  CHECK(e.pose == Pose{});
}

TEST_CASE("a turn of the wheels that is no number is left out and counted as theirs", "[motion]") {
  EstimatorModel flat = model;
  flat.drive.wheelbase_m = 0.0F;
  Estimate e = estimate({}, {}, dt, flat);
  const std::uint32_t before = e.wheels.rejected;
  e = estimate(e, {60, 40, -6.0F, 0.0F, Movement::rotating}, dt, flat);
  CHECK(e.wheels.rejected == before + 1);
  CHECK(e.rejected == EstimatorCounters{0, 0, 0});
  CHECK(near(e.pose.heading_rad, -0.18F));  // by the gyro in full
}

TEST_CASE("whether the compass corrected is said of the last step alone", "[motion]") {
  const EstimatorModel always = gyro_and_compass(model);
  CHECK_FALSE(Estimate{}.compass_used);
  for (const float dt_s : {nan, dt}) {
    Estimate e = estimate({}, {}, dt, always);
    e = estimate(e, {0, 0, 0.0F, 0.1F, Movement::standing}, dt, always);
    REQUIRE(e.compass_used);
    e = estimate(e, {0, 0, 0.0F, nan, Movement::standing}, dt_s, always);
    CHECK_FALSE(e.compass_used);
  }
}

TEST_CASE("the second robot has no gate, whatever the first one's is", "[motion]") {
  EstimatorModel gated = model;
  gated.compass_gate = 2.0F;
  Estimate e = estimate({}, {}, dt, gyro_and_compass(gated));
  e = estimate(e, {0, 0, 0.0F, 3.0F, Movement::standing}, dt, gyro_and_compass(gated));
  CHECK(e.compass_used);
}

TEST_CASE("a model that says nothing of a number has the careful one", "[motion]") {
  // No wheel makes a tick, and a compass is within three degrees where nothing disturbs it: two sigmas are
  // 0.1.
  const EstimatorModel bare{.drive = model.drive};
  const Estimate still = estimate({}, {}, dt, bare);
  CHECK(estimate(still, {1, 1, 0.0F, 0.0F, Movement::straight}, dt, bare).wheels.rejected == 1);
  const EstimatorModel plain{
      .compass_variance_rad2 = 1.0F, .compass_rule = CompassRule::always, .compass_gate = 2.0F};
  const Estimate begun = estimate({}, {}, dt, plain);
  CHECK(estimate(begun, {0, 0, 0.0F, 0.09F, Movement::standing}, dt, plain).compass_used);
  CHECK_FALSE(estimate(begun, {0, 0, 0.0F, 0.11F, Movement::standing}, dt, plain).compass_used);
  // It speaks where the robot stands after a straight drive, and there only.
  EstimatorModel quiet{.compass_variance_rad2 = 1.0F};
  CHECK_FALSE(estimate(begun, {0, 0, 0.0F, 0.0F, Movement::standing}, dt, quiet).compass_used);
  const Estimate driven = estimate(begun, {0, 0, 0.0F, 0.0F, Movement::straight}, dt, quiet);
  CHECK(estimate(driven, {0, 0, 0.0F, radians(1.9F), Movement::standing}, dt, quiet).compass_used);
  CHECK_FALSE(estimate(driven, {0, 0, 0.0F, radians(2.1F), Movement::standing}, dt, quiet).compass_used);
}

TEST_CASE("without a time the wheels move the pose all the same", "[motion]") {
  Estimate e = estimate(begun(), {60, 40, 0.0F, 0.0F, Movement::straight}, nan, model);
  CHECK(near(e.pose.heading_rad, -0.2F));
  CHECK(near(e.pose.x_m, 0.05F * std::cos(-0.1F), 1e-6F));
}

TEST_CASE("nonsense of any kind leaves pose and variance finite", "[motion]") {
  Random random{5};
  const float odd[] = {nan, infinity, -infinity, 0.0F, 1e38F, -1e38F, 1e-40F, 0.5F, -0.5F, 0.03F};
  Estimate e{};
  for (int i = 0; i < 50'000; ++i) {
    const auto pick = [&] { return odd[random.below(10)]; };
    const EstimatorReadings readings{.left_ticks = e.wheels.left + random.below(40),
                                     .right_ticks = e.wheels.right + random.below(40),
                                     .gyro_rad_s = pick(),
                                     .compass_rad = pick(),
                                     .movement = static_cast<Movement>(random.below(3))};
    const float dt_s = pick();
    e = estimate(e, readings, dt_s, random.below(2) == 0 ? model : gyro_and_compass(model));
    CAPTURE(i, readings.gyro_rad_s, readings.compass_rad, dt_s);
    REQUIRE(is_finite(e.pose));
    REQUIRE(is_finite(e.heading_variance_rad2));
    REQUIRE(e.heading_variance_rad2 >= 0.0F);
    REQUIRE((e.pose.heading_rad > -pi && e.pose.heading_rad <= pi));
  }
  CHECK(e.rejected.time > 1000);
  CHECK(e.rejected.gyro > 1000);
  CHECK(e.rejected.compass > 100);
}

}  // namespace motion_pose_estimator_test
