#include "sim/physics/geometry.hpp"

#include <cmath>

#include <catch2/catch.hpp>

namespace sim_geometry_test {

using namespace ocm::sim;

TEST_CASE("geometry: a ray meets a wall at each of its places, both ends included") {
  const Segment wall{{2, -1}, {2, 1}}, other_way{wall.b, wall.a};
  for (const Segment& each : {wall, other_way}) {
    for (const double y : {-1.0, -0.5, 0.0, 1.0}) CHECK(distance_along({0, y}, {1, 0}, each) == 2);
    CHECK(distance_along({4, 0.5}, {-1, 0}, each) == 2);
    CHECK(distance_along({2, 0.5}, {1, 0}, each) == 0);  // it is there
    for (const double y : {-1.001, 1.001}) CHECK(std::isinf(distance_along({0, y}, {1, 0}, each)));
    CHECK(std::isinf(distance_along({2.001, 0.5}, {1, 0}, each)));  // behind it
    CHECK(std::isinf(distance_along({2, -3}, {0, 1}, each)));       // along it
  }
}

TEST_CASE("geometry: the nearest point of a wall is beside, or an end") {
  const Segment wall{{1, 1}, {5, 1}};
  CHECK(nearest_point(wall, {2, 3}) == Vector{2, 1});
  CHECK(nearest_point(wall, {2, 1}) == Vector{2, 1});
  CHECK(nearest_point(wall, {0, 3}) == wall.a);
  CHECK(nearest_point(wall, {6, 0}) == wall.b);
  CHECK(nearest_point({wall.a, wall.a}, {6, 0}) == wall.a);
}

}  // namespace sim_geometry_test
