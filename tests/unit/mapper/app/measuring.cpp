#include "ocm/mapper/app/measuring.hpp"

#include <limits>

#include <catch2/catch.hpp>

#include "unit/motion/near.hpp"

namespace mapper_app_measuring_test {

using namespace ocm;
using mapper::app::Measurement;
using mapper::app::Measuring;
using ocm::test::near;
using sensing::Field;

constexpr Measuring model{.samples = 4, .failures = 3, .moving_rad_s = 0.3F};
constexpr base::Result<float> no_gyro{base::Error::no_answer};
constexpr base::Result<Field> no_field{base::Error::no_answer};

TEST_CASE("mapper measuring: means of a window, by hand", "[mapper_measuring]") {
  Measurement measurement{model};
  const float gyro[] = {0.01F, 0.03F, 0.02F, 0.02F};
  const Field field[] = {{1, 2}, {3, 2}, {1, 4}, {3, 4}};
  for (int i = 0; i < 4; ++i) {
    CHECK_FALSE(measurement.ready());
    measurement.add(gyro[i], field[i], false);
  }
  CHECK(measurement.ready());
  CHECK(measurement.fresh());
  CHECK(near(measurement.result().gyro_bias_rad_s, 0.02F));
  CHECK(near(measurement.result().field.x, 2.0F));
  CHECK(near(measurement.result().field.y, 3.0F));
}

TEST_CASE("mapper measuring: a window with a movement in it is none", "[mapper_measuring]") {
  Measurement measurement{model};
  const auto still = [&](int n) {
    for (int i = 0; i < n; ++i) measurement.add(0.0F, Field{1, 0}, false);
  };
  still(3);
  SECTION("a wheel") {
    measurement.add(0.0F, Field{1, 0}, true);
  }
  SECTION("a turn by hand") {
    measurement.add(0.5F, Field{1, 0}, false);
  }
  SECTION("a gyro that says nothing") {
    measurement.add(no_gyro, Field{1, 0}, false);
  }
  SECTION("a compass that says nothing") {
    measurement.add(0.0F, no_field, false);
  }
  SECTION("a gyro that is no number") {
    measurement.add(std::numeric_limits<float>::quiet_NaN(), Field{1, 0}, false);
  }
  SECTION("a field that is no number") {
    measurement.add(0.0F, Field{1, std::numeric_limits<float>::quiet_NaN()}, false);
  }
  SECTION("the motors go on") {
    measurement.drive_off();
  }
  still(3);
  CHECK_FALSE(measurement.ready());
  still(1);
  CHECK(measurement.ready());
}

TEST_CASE("mapper measuring: it goes on, and the last window counts", "[mapper_measuring]") {
  Measurement measurement{model};
  for (int i = 0; i < 4; ++i) measurement.add(0.01F, Field{1, 0}, false);
  for (int i = 0; i < 4; ++i) measurement.add(0.05F, Field{0, 1}, false);
  CHECK(near(measurement.result().gyro_bias_rad_s, 0.05F));
  CHECK(near(measurement.result().field.x, 0.0F));
  CHECK(near(measurement.result().field.y, 1.0F));
  SECTION("known, and no longer of this place, once it drove off") {
    measurement.drive_off();
    CHECK(measurement.ready());
    CHECK_FALSE(measurement.fresh());
    CHECK(near(measurement.result().gyro_bias_rad_s, 0.05F));
    for (int i = 0; i < 4; ++i) measurement.add(0.01F, Field{1, 0}, false);
    CHECK(measurement.fresh());
  }
}

TEST_CASE("mapper measuring: a part has failed after some failures in a row", "[mapper_measuring]") {
  Measurement measurement{model};
  measurement.add(no_gyro, Field{1, 0}, false);
  measurement.add(0.0F, no_field, false);
  CHECK_FALSE(measurement.failed());
  measurement.add(0.0F, Field{1, 0}, false);  // between two failures
  measurement.add(no_gyro, no_field, false);
  measurement.add(no_gyro, no_field, false);
  CHECK_FALSE(measurement.failed());
  measurement.add(no_gyro, no_field, false);
  CHECK(measurement.failed());
  for (int i = 0; i < 1000; ++i) {  // the count does not turn over
    measurement.add(no_gyro, no_field, false);
    CHECK(measurement.failed());
  }
  measurement.add(0.0F, Field{1, 0}, false);
  CHECK_FALSE(measurement.failed());
}

}  // namespace mapper_app_measuring_test
