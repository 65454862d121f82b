#include "ocm/motion/compass_filter.hpp"

#include <limits>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"
#include "unit/motion/near.hpp"

namespace motion_compass_filter_test {

using namespace ocm::motion;
using ocm::test::near;
using ocm::test::near_angle;
using ocm::test::Random;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

// K = 0.01 / (0.01 + 0.03) = 1/4: from 1.0 towards 1.4 it is 1.1, and P = 3/4 * 0.01. [T2 listing 7.1]
constexpr CorrectedHeading quarter = correct({1.0F, 0.01F}, 1.4F, 0.03F);
static_assert(near(quarter.heading.angle_rad, 1.1F) && near(quarter.heading.variance_rad2, 0.0075F, 1e-8F));
static_assert(!quarter.rejected);

// From 175 degrees towards -175 the way is 10 to the left: at K = 1/2 it ends at 180.
static_assert(near_angle(correct({radians(175.0F), 1.0F}, radians(-175.0F), 1.0F).heading.angle_rad, pi));

static_assert(correct({1.0F, 0.01F}, nan, 0.03F).rejected);
static_assert(correct({1.0F, 0.01F}, nan, 0.03F).heading == Heading{1.0F, 0.01F});
static_assert(correct({1.0F, 0.01F}, 1.4F, 0.0F).rejected && correct({1.0F, 0.01F}, 1.4F, -1.0F).rejected);
static_assert(correct({1.0F, 0.01F}, 1.4F, nan).rejected);
static_assert(correct({1.0F, 0.0F}, 1.4F, 0.03F).heading == Heading{1.0F, 0.0F}, "nothing to learn");

static_assert(CorrectedHeading{}.heading == Heading{} && !CorrectedHeading{}.rejected);

// sqrt(0.0016 + 0.0009) = 0.05: two sigmas are 0.1.
static_assert(agrees({1.0F, 0.0016F}, 1.09F, 0.03F, 2.0F) && agrees({1.0F, 0.0016F}, 0.91F, 0.03F, 2.0F));
static_assert(!agrees({1.0F, 0.0016F}, 1.11F, 0.03F, 2.0F) && !agrees({1.0F, 0.0016F}, 0.89F, 0.03F, 2.0F));
static_assert(agrees({1.0F, 0.0016F}, 1.11F, 0.03F, 3.0F));
static_assert(agrees({1.0F, 0.0016F}, 1.02F, 0.03F, 0.5F) && !agrees({1.0F, 0.0016F}, 1.03F, 0.03F, 0.5F));
static_assert(agrees({0.0F, 0.25F}, 1.0F, 0.0F, 2.0F), "two sigmas are within two sigmas");
static_assert(agrees({pi, 0.0016F}, -pi + 0.05F, 0.03F, 2.0F), "around the back");
static_assert(agrees({1.0F, 0.0016F}, 2.5F, 0.03F, 0.0F), "no gate");
static_assert(agrees({1.0F, 0.0016F}, nan, 0.03F, 2.0F), "no number: correct() rejects and counts it");

TEST_CASE("a number that gets lost inside the correction is rejected, too", "[motion]") {
  CHECK(correct({1.0F, infinity}, 1.4F, 0.03F).rejected);
  CHECK(correct({1.0F, infinity}, 1.4F, 0.03F).heading == Heading{1.0F, infinity});
}

TEST_CASE("the variance stays positive and falls, the angle stays in its range", "[motion]") {
  Random random{4};
  for (int round = 0; round < 2000; ++round) {
    Heading heading{static_cast<float>(random.within(-314, 314)) / 100.0F,
                    static_cast<float>(random.below(1'000'000)) / 1e4F};
    const float variance = static_cast<float>(1 + random.below(1'000'000)) / 1e5F;
    for (int i = 0; i < 20; ++i) {
      const float before = heading.variance_rad2;
      const auto corrected =
          correct(heading, static_cast<float>(random.within(-900, 900)) / 100.0F, variance);
      REQUIRE_FALSE(corrected.rejected);
      heading = corrected.heading;
      REQUIRE(heading.variance_rad2 >= 0.0F);
      REQUIRE(heading.variance_rad2 <= before);
      REQUIRE(heading.variance_rad2 <= variance);
      REQUIRE((heading.angle_rad > -pi && heading.angle_rad <= pi));
    }
  }
}

TEST_CASE("n equal measurements are one with an n-th of the variance", "[motion]") {
  // 1/P = 1/P0 + n/R: the information adds up.
  Heading heading{0.0F, 1.0F};
  for (int i = 0; i < 9; ++i) heading = correct(heading, 1.0F, 3.0F).heading;
  CHECK(near(heading.variance_rad2, 0.25F));
  CHECK(near(heading.angle_rad, 0.75F));
}

constexpr CompassTrust drive(float from_deg, float to_deg) {
  CompassTrust trust = judge({}, Movement::straight, radians(from_deg));
  trust = judge(trust, Movement::straight, radians(from_deg + 90.0F));  // on the way it may do what it likes
  return judge(trust, Movement::standing, radians(to_deg));
}

static_assert(!judge({}, Movement::standing, 0.0F).trusted, "not before a straight drive");
static_assert(drive(10.0F, 11.9F).trusted && drive(10.0F, 8.1F).trusted);
static_assert(!drive(10.0F, 12.1F).trusted && !drive(10.0F, 7.9F).trusted);
constexpr bool trusted_at(float end_rad) {
  return judge(judge({}, Movement::straight, 1.0F, 0.25F), Movement::standing, end_rad, 0.25F).trusted;
}
static_assert(trusted_at(1.25F) && trusted_at(0.75F) && !trusted_at(1.28125F) && !trusted_at(0.71875F),
              "the spread is within it");
static_assert(CompassTrust{} == CompassTrust{0.0F, false, false});
static_assert(drive(179.5F, -179.5F).trusted, "one degree, across the edge");
static_assert(!drive(0.0F, 180.0F).trusted);
static_assert(!judge(drive(10.0F, 10.0F), Movement::straight, 0.0F).trusted, "a new drive, a new judgement");
static_assert(judge(drive(10.0F, 10.0F), Movement::standing, 1.0F).trusted, "it stays where it stands");
static_assert(judge(drive(10.0F, 10.0F), Movement::rotating, 1.0F).trusted, "and turning does not move it");
static_assert(!judge(judge({}, Movement::straight, nan), Movement::standing, 0.0F).trusted);
static_assert(!judge(judge({}, Movement::straight, 0.0F), Movement::standing, nan).trusted);

constexpr CompassTrust trusted = drive(0.0F, 0.0F);
static_assert(may_correct(trusted, Movement::standing, CompassRule::standing_where_trusted));
static_assert(!may_correct(trusted, Movement::rotating, CompassRule::standing_where_trusted));
static_assert(!may_correct(trusted, Movement::straight, CompassRule::standing_where_trusted));
static_assert(!may_correct({}, Movement::standing, CompassRule::standing_where_trusted));
static_assert(may_correct({}, Movement::straight, CompassRule::always));

}  // namespace motion_compass_filter_test
