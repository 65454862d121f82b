#include "ocm/sensing/servo.hpp"

#include <catch2/catch.hpp>

namespace sensing_servo_test {

using namespace ocm::sensing;

static_assert(within_servo(-1) == 0 && within_servo(0) == 0 && within_servo(90) == 90 &&
              within_servo(91) == 90);

// 1150 counts from 0 to 90 degrees. [T2 §10.2.3]
constexpr ServoCalibration servo{1000, 2150};
static_assert(servo_count(0, servo) == 1000 && servo_count(90, servo) == 2150 &&
              servo_count(45, servo) == 1575);
static_assert(servo_count(1, servo) == 1013, "12.78, rounded");
static_assert(servo_count(-5, servo) == 1000 && servo_count(200, servo) == 2150);

constexpr ServoCalibration mirrored{2150, 1000};
static_assert(servo_count(0, mirrored) == 2150 && servo_count(90, mirrored) == 1000);
static_assert(servo_count(1, mirrored) == 2137 && servo_count(45, mirrored) == 1575);
static_assert(servo_count(90, {0, 65535}) == 65535 && servo_count(90, {65535, 0}) == 0);

TEST_CASE("each degree is a step of its own, of 12 or 13 counts", "[sensing]") {
  for (int degrees = 0; degrees < 90; ++degrees) {
    const int up = servo_count(degrees + 1, servo) - servo_count(degrees, servo);
    const int down = servo_count(degrees, mirrored) - servo_count(degrees + 1, mirrored);
    CHECK((up == 12 || up == 13));
    CHECK(up == down);
  }
}

}  // namespace sensing_servo_test
