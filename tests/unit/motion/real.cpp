#include "ocm/motion/real.hpp"

#include <limits>

#include <catch2/catch.hpp>

namespace motion_real_test {

using namespace ocm::motion;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

static_assert(is_finite(0.0F) && is_finite(std::numeric_limits<float>::max()) && is_finite(-1e-40F));
static_assert(is_finite(-std::numeric_limits<float>::max()));
static_assert(!is_finite(nan) && !is_finite(infinity) && !is_finite(-infinity));
static_assert(all_finite(1.0F, 2.0F) && !all_finite(1.0F, nan) && !all_finite(infinity, 1.0F));

static_assert(is_step(0.03F) && !is_step(0.0F) && !is_step(-0.03F) && !is_step(nan) && !is_step(infinity));

static_assert(magnitude(0.5F) == 0.5F && magnitude(-0.5F) == 0.5F && magnitude(0.0F) == 0.0F);
static_assert(magnitude(-infinity) == infinity && magnitude(3.0F) == 3.0F);

static_assert(clamp(0.5F, 0.0F, 1.0F) == 0.5F);
static_assert(clamp(-2.0F, -1.0F, 1.0F) == -1.0F && clamp(2.0F, -1.0F, 1.0F) == 1.0F);
static_assert(clamp(infinity, -1.0F, 1.0F) == 1.0F && clamp(-infinity, -1.0F, 1.0F) == -1.0F);

TEST_CASE("clamp ends NaN at the lower bound", "[motion]") {
  CHECK(clamp(nan, -1.0F, 1.0F) == -1.0F);
}

}  // namespace motion_real_test
