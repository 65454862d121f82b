#include "ocm/sensing/compass_calibration.hpp"

#include <cmath>
#include <limits>

#include <catch2/catch.hpp>

#include "unit/motion/near.hpp"

namespace sensing_compass_calibration_test {

using namespace ocm::sensing;
using ocm::base::Error;
using ocm::motion::pi;
using ocm::motion::radians;
using ocm::motion::two_pi;
using ocm::test::near;
using ocm::test::near_angle;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// Turns by `degrees` in steps of 2 in a field of `x_radius` and `y_radius` around (30, -20).
CompassCalibration turned(int degrees, float x_radius, float y_radius) {
  CompassCalibration calibration;
  for (int i = 0; i <= degrees; i += 2) {
    const float angle = radians(static_cast<float>(i));
    calibration.add({30.0F + x_radius * std::cos(angle), -20.0F + y_radius * std::sin(angle)}, radians(2.0F));
  }
  return calibration;
}

TEST_CASE("once around gives the middle of the circle", "[sensing]") {
  for (const float clockwise : {1.0F, -1.0F}) {
    CompassCalibration calibration;
    for (int i = 0; i <= 360; i += 2) {
      const float angle = clockwise * radians(static_cast<float>(i));
      calibration.add({30.0F + 50.0F * std::cos(angle), -20.0F + 50.0F * std::sin(angle)},
                      clockwise * radians(2.0F));
    }
    const auto found = calibration.fit();
    REQUIRE(found.ok());
    CHECK(near(found->offset.x, 30.0F, 1e-3F));
    CHECK(near(found->offset.y, -20.0F, 1e-3F));
    CHECK(near(found->field, 50.0F, 0.5F));
    CHECK(found->error_rad < radians(0.2F));
  }
}

TEST_CASE("a robot that stands for long before it turns has no other offset for it", "[sensing]") {
  CompassCalibration calibration;
  for (int i = 0; i < 200'000; ++i) calibration.add({80.0F, -20.0F}, 0.0F);
  for (int i = 0; i <= 360; i += 2) {
    const float angle = radians(static_cast<float>(i));
    calibration.add({30.0F + 50.0F * std::cos(angle), -20.0F + 50.0F * std::sin(angle)},
                    radians(i == 0 ? 0.0F : 2.0F));
  }
  const auto found = calibration.fit();
  REQUIRE(found.ok());
  CHECK(near(found->offset.x, 30.0F, 1.0F));
  CHECK(near(found->offset.y, -20.0F, 1.0F));
}

TEST_CASE("a turn that was not all around, or without readings, has no fit", "[sensing]") {
  CHECK(CompassCalibration{}.fit().error == Error::not_sampled);
  CHECK(turned(350, 50.0F, 50.0F).fit().error == Error::not_sampled);
  CHECK(turned(356, 50.0F, 50.0F).fit().ok());
  CHECK(turned(360, 0.0F, 0.0F).fit().error == Error::out_of_range);  // a field without a direction
  CompassCalibration gap;                                             // silent for a quarter of the turn
  for (int i = 0; i <= 270; i += 2)
    gap.add({std::cos(radians(static_cast<float>(i))), std::sin(radians(static_cast<float>(i)))},
            radians(2.0F));
  gap.add({1.0F, 0.0F}, radians(90.0F));
  CHECK(gap.fit().error == Error::no_answer);
}

TEST_CASE("how far the circle is from one is what the compass is wrong by", "[sensing]") {
  // Stretched by e one way and shortened by e the other: cos and sin of the same angle, so that the compass
  // is wrong by e sin 2a, at most e.
  for (const float e : {0.02F, 0.05F, 0.1F}) {
    const auto found = turned(360, 50.0F * (1 + e), 50.0F * (1 - e)).fit();
    REQUIRE(found.ok());
    CHECK(near(found->error_rad, e, 0.1F * e));
    float worst = 0.0F;
    for (int i = 0; i < 360; ++i) {
      const float angle = radians(static_cast<float>(i));
      const Field seen{30.0F + 50.0F * (1 + e) * std::cos(angle), -20.0F + 50.0F * (1 - e) * std::sin(angle)};
      worst = std::fmax(worst, std::fabs(ocm::motion::difference(field_angle(seen, found->offset), angle)));
    }
    CHECK(near(found->error_rad, worst, 0.15F * worst));
  }
}

TEST_CASE("noise counts for little, one field that changes for much", "[sensing]") {
  CompassCalibration noisy, changed;
  for (int i = 0; i <= 360; ++i) {
    const float angle = radians(static_cast<float>(i));
    const float noise = i % 2 == 0 ? 1.0F : -1.0F;  // 1.1 degrees of 50
    noisy.add({50.0F * std::cos(angle) + noise, 50.0F * std::sin(angle)}, radians(1.0F));
    const float door = i > 240 && i < 300 ? 15.0F : 0.0F;
    changed.add({50.0F * std::cos(angle) + door, 50.0F * std::sin(angle) + door}, radians(1.0F));
  }
  CHECK(noisy.fit()->error_rad < radians(1.0F));
  CHECK(changed.fit()->error_rad > radians(8.0F));
}

TEST_CASE("readings that are no numbers are counted and left out", "[sensing]") {
  CompassCalibration calibration = turned(360, 50.0F, 50.0F);
  CHECK_FALSE(calibration.add({nan, 0.0F}, 0.1F));
  CHECK_FALSE(calibration.add({0.0F, nan}, 0.1F));
  CHECK_FALSE(calibration.add({0.0F, 0.0F}, nan));
  CHECK(calibration.rejected() == 3);
  CHECK(calibration.count() == 181);
  CHECK(calibration.fit().ok());
}

TEST_CASE("the angle of a field, its offset taken off", "[sensing]") {
  const Field offset{30.0F, -20.0F};
  CHECK(near(field_angle({40.0F, -20.0F}, offset), 0.0F));
  CHECK(near(field_angle({30.0F, -10.0F}, offset), pi / 2.0F));
  CHECK(near_angle(field_angle({20.0F, -20.0F}, offset), pi));
  CHECK(std::isnan(field_angle(offset, offset)));
  CHECK(std::isnan(field_angle({nan, 0.0F}, offset)));
  CHECK(field_angle({-1.0F, -0.0F}, {}) > 0.0F);  // pi, not -pi
}

}  // namespace sensing_compass_calibration_test
