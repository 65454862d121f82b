#include "ocm/sensing/ring_distance.hpp"

#include <cmath>

#include <catch2/catch.hpp>

#include "unit/base/explore.hpp"

namespace sensing_ring_distance_test {

using namespace ocm::sensing;

// The law's own figures: 9427 counts at 10 mm, 377 at 50, 24 at 200.
static_assert(ring_distance_mm(2300 + 9427, 2300) == 9);  // 9.9998
static_assert(ring_distance_mm(2300 + 9426, 2300) == 10);
static_assert(ring_distance_mm(2300 + 377, 2300) == 50);
static_assert(ring_distance_mm(2300 + 94, 2300) == 100);
static_assert(ring_distance_mm(2300 + 24, 2300) == 198);

// Nothing in sight: noise around the offset, less than it, and an offset that nothing exceeds.
static_assert(ring_distance_mm(2300 + 23, 2300) == ring_range_mm);
static_assert(ring_distance_mm(2300, 2300) == ring_range_mm);
static_assert(ring_distance_mm(0, 2300) == ring_range_mm);
static_assert(ring_distance_mm(65'535, 65'535) == ring_range_mm);
// The converter at its end.
static_assert(ring_distance_mm(65'535, 0) == 3);

static_assert(square_root(0) == 0 && square_root(1) == 1 && square_root(3) == 1 && square_root(4) == 2);
static_assert(square_root(0xFFFF'FFFF) == 65'535 && square_root(0xFFFE'0001) == 65'535 &&
              square_root(0xFFFE'0000) == 65'534);

TEST_CASE("a distance falls with the counts, and is that of the law, rounded down") {
  std::uint16_t before = ring_range_mm;
  for (std::uint32_t above = 0; above <= 63'000;
       above += static_cast<std::uint32_t>(ocm::test::coarser(17))) {
    const std::uint16_t distance = ring_distance_mm(static_cast<std::uint16_t>(2300 + above), 2300);
    REQUIRE(distance <= before);
    before = distance;
    if (above < least_ring_counts) continue;
    const float exact_mm = std::sqrt(942'694.0F / static_cast<float>(above));
    REQUIRE(static_cast<float>(distance) <= exact_mm + 1e-3F);
    REQUIRE(static_cast<float>(distance) > exact_mm - 1.05F);
  }
}

}  // namespace sensing_ring_distance_test
