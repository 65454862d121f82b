#include "ocm/motion/limits.hpp"

#include <limits>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"
#include "unit/motion/near.hpp"

namespace motion_limits_test {

using namespace ocm::motion;
using ocm::test::near;
using ocm::test::Random;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

// At 2 m/s2 and 0.1 s a speed changes by 0.2.
static_assert(near(limited(0.3F, 1.0F, 2.0F, 2.0F, 0.1F), 0.5F));
static_assert(near(limited(0.3F, -1.0F, 2.0F, 2.0F, 0.1F), 0.1F));
static_assert(limited(0.3F, 0.4F, 2.0F, 2.0F, 0.1F) == 0.4F, "within both bounds");
static_assert(near(limited(1.9F, 9.0F, 2.0F, 2.0F, 0.1F), 2.0F), "at most the greatest speed");
static_assert(near(limited(-1.9F, -9.0F, 2.0F, 2.0F, 0.1F), -2.0F));
static_assert(limited(0.3F, nan, 2.0F, 2.0F, 0.1F) == 0.3F && limited(0.3F, 1.0F, 2.0F, 2.0F, nan) == 0.3F);
static_assert(limited(0.3F, 1.0F, 2.0F, 2.0F, -0.1F) == 0.3F);
static_assert(limited(3.0F, nan, 2.0F, 2.0F, 0.1F) == 2.0F &&
                  limited(-3.0F, nan, 2.0F, 2.0F, 0.1F) == -2.0F &&
                  limited(3.0F, 1.0F, 2.0F, 2.0F, 0.0F) == 2.0F,
              "the last one, too, is at most the greatest");

static_assert(limited(nan, 1.0F, 2.0F, 2.0F, 0.1F) == 0.0F &&
              limited(infinity, 1.0F, 2.0F, 2.0F, nan) == 0.0F);

constexpr Limits limits{
    .speed_m_s = 0.5F, .acceleration_m_s2 = 1.0F, .turn_rad_s = 2.0F, .turn_acceleration_rad_s2 = 10.0F};
static_assert(near(limited(Twist{}, {1.0F, 1.5F}, limits, 0.1F).speed_m_s, 0.1F));
static_assert(near(limited(Twist{}, {1.0F, 1.5F}, limits, 0.1F).turn_rad_s, 1.0F));

static_assert(limited(Twist{1.0F, 1.0F}, {1.0F, 1.0F}, {}, 0.1F) == Twist{0.0F, 0.0F},
              "no bounds given: it may not move");
constexpr Limits slow{.speed_m_s = 0.5F, .turn_rad_s = 2.0F};
static_assert(limited(Twist{0.25F, 1.0F}, {0.5F, 2.0F}, slow, 0.1F) == Twist{0.25F, 1.0F},
              "nor change its pace");
static_assert(limited(Twist{0.25F, 1.0F}, {9.0F, -9.0F}, limits, 10.0F) == Twist{0.5F, -2.0F});

// A loop of gain 2/s has come to rest, e-fold by e-fold, with up to 1/(2e) s of dead time.
static_assert(near(most_dead_time_s(2.0F), 0.18394F) && near(most_dead_time_s(0.5F), 0.73576F));

static_assert(Efforts{} == Efforts{0.0F, 0.0F});
static_assert(mixed(0.5F, 0.25F) == Efforts{0.25F, 0.75F});
static_assert(mixed(-0.5F, 0.25F) == Efforts{-0.75F, -0.25F});
static_assert(mixed(1.0F, 1.0F) == Efforts{0.0F, 1.0F}, "the curve stays, the speed goes");
static_assert(mixed(0.0F, -4.0F) == Efforts{1.0F, -1.0F});
static_assert(mixed(nan, 0.0F) == Efforts{} && mixed(0.0F, infinity) == Efforts{});

TEST_CASE("efforts stay in their range, in the proportion that was asked for", "[motion]") {
  Random random{7};
  for (int i = 0; i < 2000; ++i) {
    const float ahead = static_cast<float>(random.within(-300, 300)) / 100.0F;
    const float turn = static_cast<float>(random.within(-300, 300)) / 100.0F;
    const Efforts efforts = mixed(ahead, turn);
    REQUIRE(
        (efforts.left >= -1.0F && efforts.left <= 1.0F && efforts.right >= -1.0F && efforts.right <= 1.0F));
    REQUIRE(near(efforts.left * (ahead + turn), efforts.right * (ahead - turn)));
  }
  CHECK(mixed(3e38F, 3e38F) == Efforts{});
}

}  // namespace motion_limits_test
