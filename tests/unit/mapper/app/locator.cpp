#include "ocm/mapper/app/locator.hpp"

#include <cmath>

#include <catch2/catch.hpp>

#include "unit/motion/near.hpp"

namespace mapper_app_locator_test {

using namespace ocm;
using mapper::app::Activity;
using mapper::app::Locator;
using mapper::app::Readings;
using mapper::app::RobotModel;
using mapper::app::WheelTicks;
using motion::Movement;
using ocm::test::near;
using ocm::test::near_angle;
using sensing::Field;

constexpr float dt = 0.030F;
constexpr Activity at_rest{};
constexpr Activity rotating{Movement::rotating, false, false};
constexpr Activity driving{Movement::straight, false, false};
constexpr Activity standing{Movement::standing, false, false};

/// What a robot at a heading sees of a field of 0.2 that points to `north`, with its own on top.
Field field_at(float heading_rad, float north_rad = 0.7F, Field own = {}) {
  const float angle = north_rad - heading_rad;
  return {0.2F * std::cos(angle) + own.x, 0.2F * std::sin(angle) + own.y};
}
void rest(Locator& locator, float bias, float heading_rad, Field own = {}) {
  for (int i = 0; i < 64; ++i) locator.step({{}, bias, field_at(heading_rad, 0.7F, own)}, at_rest, dt);
}

TEST_CASE("mapper locator: where the robot is confirmed is 0, whatever the compass says there",
          "[mapper_locator]") {
  Locator locator{mapper::app::avr_robot};
  CHECK_FALSE(locator.ready());
  rest(locator, 0.05F, 2.0F);
  CHECK(locator.ready());
  locator.begin_at_zero();
  CHECK(locator.estimate().pose == motion::Pose{});
  CHECK(near(locator.gyro_bias_rad_s(), 0.05F));
  // The gyro shows its bias alone, and the robot does not turn for ten seconds.
  for (int i = 0; i < 333; ++i) locator.step({{}, 0.05F, field_at(2.0F)}, rotating, dt);
  CHECK(near_angle(locator.estimate().pose.heading_rad, 0.0F, 1e-4F));
}

TEST_CASE("mapper locator: the compass turns with the robot, to the same side", "[mapper_locator]") {
  // A model in which the compass alone decides: what it shows is the heading.
  RobotModel model = calibrated(mapper::app::avr_robot, {});
  model.estimator.compass_rule = motion::CompassRule::always;
  model.estimator.compass_variance_rad2 = 1e-9F;
  model.estimator.compass_gate = 0.0F;
  Locator locator{model};
  rest(locator, 0.0F, 2.0F);
  locator.begin_at_zero();
  for (const float turned : {0.5F, 1.5F, 3.0F, -1.0F}) {
    for (int i = 0; i < 5; ++i) locator.step({{}, 0.0F, field_at(2.0F + turned)}, standing, dt);
    CHECK(near_angle(locator.estimate().pose.heading_rad, turned, 1e-3F));
  }
}

TEST_CASE("mapper locator: a compass that was never calibrated corrects nothing, until it is",
          "[mapper_locator]") {
  RobotModel model = mapper::app::avr_robot;
  model.estimator.compass_rule = motion::CompassRule::always;
  model.estimator.compass_variance_rad2 = 1e-9F;
  model.estimator.compass_gate = 0.0F;
  Locator locator{model};
  rest(locator, 0.0F, 0.0F);
  locator.begin_at_zero();
  CHECK_FALSE(locator.calibrated());
  for (int i = 0; i < 5; ++i) locator.step({{}, 0.0F, field_at(1.0F)}, standing, dt);
  CHECK(locator.estimate().pose.heading_rad == 0.0F);
  locator.begin_calibration();
  for (int i = 0; i < 400 && !locator.turned_around(); ++i)
    locator.step({{}, 0.9F, field_at(0.9F * dt * static_cast<float>(i))}, {Movement::rotating, false, true},
                 dt);
  REQUIRE(locator.end_calibration().taken);
  CHECK(locator.calibrated());
  const float turned = locator.estimate().pose.heading_rad;
  for (int i = 0; i < 5; ++i) locator.step({{}, 0.0F, field_at(1.0F)}, standing, dt);
  CHECK(locator.estimate().pose.heading_rad != turned);
}

TEST_CASE("mapper locator: confirmed while it rolls out, the compass keeps its word", "[mapper_locator]") {
  RobotModel model = calibrated(mapper::app::avr_robot, {});
  model.estimator.compass_rule = motion::CompassRule::always;
  model.estimator.compass_variance_rad2 = 1e-9F;
  model.estimator.compass_gate = 0.0F;
  Locator locator{model};
  rest(locator, 0.0F, 0.0F);
  locator.begin_at_zero();
  for (int i = 0; i < 5; ++i) locator.step({{}, 0.0F, field_at(1.0F)}, driving, dt);
  CHECK(near_angle(locator.estimate().pose.heading_rad, 1.0F, 1e-3F));
  locator.begin_at_zero();  // measured long ago: at another heading
  CHECK(locator.estimate().pose == motion::Pose{});
  for (int i = 0; i < 5; ++i) locator.step({{}, 0.0F, field_at(1.25F)}, driving, dt);
  CHECK(near_angle(locator.estimate().pose.heading_rad, 0.25F, 1e-3F));
}

TEST_CASE("mapper locator: wheels move the pose, and a new operator does not see where they were",
          "[mapper_locator]") {
  Locator locator{mapper::app::avr_robot};
  rest(locator, 0.0F, 0.0F);
  locator.begin_at_zero();
  // 99 ticks are half a turn of a wheel of 33 mm: 103.67 mm.
  for (std::uint32_t n = 1; n <= 33; ++n) locator.step({{3 * n, 3 * n}, 0.0F, field_at(0)}, driving, dt);
  CHECK(near(locator.estimate().pose.x_m, 0.10367F, 1e-4F));
  locator.begin_at_zero();
  locator.step({{99, 99}, 0.0F, field_at(0)}, driving, dt);
  CHECK(locator.estimate().pose == motion::Pose{});
}

TEST_CASE("mapper locator: told to stand, a robot that rolls out still turns", "[mapper_locator]") {
  Locator locator{mapper::app::avr_robot};
  rest(locator, 0.0F, 0.0F);
  locator.begin_at_zero();
  locator.step({{0, 0}, 1.0F, field_at(0)}, rotating, dt);
  const float before = locator.estimate().pose.heading_rad;
  locator.step({{0U - 1, 1}, 1.0F, field_at(0)}, standing, dt);  // the wheels move on
  CHECK(locator.estimate().pose.heading_rad - before > 0.75F * dt);
  // Once they stand, what the gyro says is left out: 0.06 rad of wheels less than that.
  const float stood = locator.estimate().pose.heading_rad;
  locator.step({{0U - 1, 1}, 1.0F, field_at(0)}, standing, dt);
  CHECK(locator.estimate().pose.heading_rad == stood);
}

TEST_CASE("mapper locator: without gyro or compass it goes on, and counts", "[mapper_locator]") {
  Locator locator{mapper::app::avr_robot};
  rest(locator, 0.0F, 0.0F);
  locator.begin_at_zero();
  for (std::uint32_t n = 1; n <= 10; ++n)
    locator.step({{0U - n, n}, base::Error::no_answer, base::Error::no_answer}, rotating, dt);
  CHECK(locator.gyro_failed() == 10);
  CHECK(locator.compass_failed() == 10);
  // The wheels alone: 20 ticks apart on 150 mm.
  CHECK(near(locator.estimate().pose.heading_rad, 20 * motion::two_pi * 0.033F / 198 / 0.15F, 1e-4F));
  CHECK(locator.estimate().rejected.gyro == 10);
  CHECK_FALSE(locator.failed());  // it was measured: it is no fault of the start
  locator.begin_at_zero();
  CHECK(locator.estimate().rejected.gyro == 10);  // since the start, whatever confirms it
}

TEST_CASE("mapper locator: parts that never answered are a fault, until they do", "[mapper_locator]") {
  Locator locator{mapper::app::avr_robot};
  for (int i = 0; i < 10; ++i) locator.step({{}, base::Error::no_answer, field_at(0)}, at_rest, dt);
  CHECK(locator.failed());
  CHECK_FALSE(locator.ready());
  rest(locator, 0.0F, 0.0F);
  CHECK_FALSE(locator.failed());
  CHECK(locator.ready());
}

TEST_CASE("mapper locator: a turn finds the robot's own field, and the heading stays", "[mapper_locator]") {
  constexpr Field own{0.05F, -0.03F};
  RobotModel model = mapper::app::avr_robot;
  Locator locator{model};
  rest(locator, 0.02F, 0.4F, own);
  locator.begin_at_zero();
  locator.begin_calibration();
  constexpr Activity calibrating{Movement::rotating, false, true};
  float heading = 0.0F;
  int steps = 0;
  for (; !locator.turned_around() && steps < 1000; ++steps) {
    heading += 0.9F * dt;
    locator.step({{}, 0.92F, field_at(0.4F + heading, 0.7F, own)}, calibrating, dt);
  }
  CHECK(steps > 220);
  CHECK(steps < 240);  // 360 degrees at 0.9 rad/s are 232.7
  const float before = locator.estimate().pose.heading_rad;
  const auto found = locator.end_calibration();
  CHECK(found.verdict == mapper::link::Calibration::good);
  REQUIRE(found.taken);
  CHECK(near(found.fit.offset.x, own.x, 0.002F));
  CHECK(near(found.fit.offset.y, own.y, 0.002F));
  CHECK(near(locator.offset().x, own.x, 0.002F));
  CHECK(locator.estimate().pose.heading_rad == before);
}

TEST_CASE("mapper locator: after a turn the compass goes on from the heading that the robot has",
          "[mapper_locator]") {
  constexpr Field own{0.05F, -0.03F};
  RobotModel model = mapper::app::avr_robot;
  model.estimator.compass_rule = motion::CompassRule::always;
  model.estimator.compass_variance_rad2 = 1e-9F;
  model.estimator.compass_gate = 0.0F;
  Locator locator{model};
  rest(locator, 0.0F, 0.4F, own);
  locator.begin_at_zero();
  locator.begin_calibration();
  float heading = 0.4F;
  for (int i = 0; i < 400 && !locator.turned_around(); ++i) {
    heading += 0.9F * dt;
    locator.step({{}, 0.9F, field_at(heading, 0.7F, own)}, {Movement::rotating, false, true}, dt);
  }
  REQUIRE(locator.end_calibration().taken);
  const float before = locator.estimate().pose.heading_rad;
  for (const float turned : {0.0F, 0.5F}) {
    for (int i = 0; i < 5; ++i) locator.step({{}, 0.0F, field_at(heading + turned, 0.7F, own)}, standing, dt);
    CHECK(near_angle(locator.estimate().pose.heading_rad, before + turned, 0.05F));
  }
}

TEST_CASE("mapper locator: a turn that was not all around keeps the offset that was", "[mapper_locator]") {
  RobotModel model = mapper::app::avr_robot;
  model.compass.offset = {0.01F, 0.02F};
  Locator locator{model};
  rest(locator, 0.0F, 0.0F);
  locator.begin_calibration();
  for (int i = 0; i < 100; ++i)
    locator.step({{}, 0.9F, field_at(0.9F * dt * static_cast<float>(i))}, {Movement::rotating, false, true},
                 dt);
  const auto found = locator.end_calibration();
  CHECK(found.verdict == mapper::link::Calibration::incomplete);
  CHECK_FALSE(found.taken);
  CHECK(locator.offset() == Field{0.01F, 0.02F});
}

TEST_CASE("mapper locator: a poor calibration is taken only by a robot that has none", "[mapper_locator]") {
  for (const bool had_one : {false, true}) {
    RobotModel model = mapper::app::avr_robot;
    if (had_one) model = calibrated(model, {0.01F, 0.02F});
    Locator locator{model};
    rest(locator, 0.0F, 0.0F);
    locator.begin_at_zero();
    locator.begin_calibration();
    for (int i = 0; !locator.turned_around(); ++i) {
      Field field = field_at(0.9F * dt * static_cast<float>(i));
      field.x *= 1.2F;  // an ellipse: 5 degrees
      locator.step({{}, 0.9F, field}, {Movement::rotating, false, true}, dt);
    }
    const auto found = locator.end_calibration();
    CHECK(found.verdict == mapper::link::Calibration::poor);
    CHECK(found.taken == !had_one);
    CHECK(locator.calibrated());
    CHECK((locator.offset() == Field{0.01F, 0.02F}) == had_one);
  }
}

TEST_CASE("mapper locator: before an operator confirms, heading 0 is where the field points ahead",
          "[mapper_locator]") {
  RobotModel model = calibrated(mapper::app::avr_robot, {});
  model.estimator.compass_rule = motion::CompassRule::always;
  model.estimator.compass_variance_rad2 = 1e-9F;
  model.estimator.compass_gate = 0.0F;
  for (const float turned : {0.0F, 0.5F}) {
    Locator locator{model};
    for (int i = 0; i < 5; ++i) locator.step({{}, 0.0F, field_at(turned, 0.0F)}, at_rest, dt);
    CHECK(near_angle(locator.estimate().pose.heading_rad, turned, 1e-3F));
  }
}

}  // namespace mapper_app_locator_test
