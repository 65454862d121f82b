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
    const auto offset = calibration.offset(60.0F);
    REQUIRE(offset.ok());
    CHECK(near(offset->x, 30.0F, 1e-3F));
    CHECK(near(offset->y, -20.0F, 1e-3F));
  }
}

TEST_CASE("what is no circle gives no offset", "[sensing]") {
  CHECK(CompassCalibration{}.offset(0.0F).error == Error::not_sampled);
  CHECK(turned(350, 50.0F, 50.0F).offset(60.0F).error == Error::not_sampled);
  CHECK(turned(356, 50.0F, 50.0F).offset(60.0F).ok());
  CHECK(turned(360, 50.0F, 50.0F).offset(110.0F).error == Error::out_of_range);  // too weak
  CHECK(turned(360, 50.0F, 36.0F).offset(60.0F).error == Error::out_of_range);   // an ellipse of 4 to 3
  CHECK(turned(360, 36.0F, 50.0F).offset(60.0F).error == Error::out_of_range);
  CHECK(turned(360, 50.0F, 40.0F).offset(60.0F).ok());
  CHECK(turned(360, 0.0F, 0.0F).offset(0.0F).error == Error::out_of_range);
}

TEST_CASE("readings that are no numbers are counted and left out", "[sensing]") {
  CompassCalibration calibration = turned(360, 50.0F, 50.0F);
  CHECK_FALSE(calibration.add({nan, 0.0F}, 0.1F));
  CHECK_FALSE(calibration.add({0.0F, nan}, 0.1F));
  CHECK_FALSE(calibration.add({0.0F, 0.0F}, nan));
  CHECK(calibration.rejected() == 3);
  CHECK(calibration.count() == 181);
  CHECK(calibration.offset(60.0F).ok());
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
