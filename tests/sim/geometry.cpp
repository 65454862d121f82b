#include "sim/physics/geometry.hpp"

#include <cmath>

#include <catch2/catch.hpp>

#include "sim/physics/body.hpp"

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

TEST_CASE("geometry: the way out is that of what a disc is deepest in, and of equals that of the first") {
  Push push;
  CHECK_FALSE(push.needed());
  const Vector centre{0.75, 0};
  push.consider(centre, {1.25, 0}, 0.5);  // beside it
  CHECK_FALSE(push.needed());
  push.consider(centre, {1, 0}, 0.5);
  CHECK(push.needed());
  CHECK((push.depth_m == 0.25 && push.way == Vector{-0.25, 0}));
  push.consider(centre, {0.75, 0.25}, 0.5);  // as deep
  push.consider(centre, {1.125, 0}, 0.5);    // less
  CHECK((push.depth_m == 0.25 && push.way == Vector{-0.25, 0}));
  push.consider(centre, {0.75, 0.125}, 0.5);  // more
  CHECK((push.depth_m == 0.375 && push.way == Vector{0, -0.375}));
  push.consider(centre, centre, 0.5);  // in its middle, from which there is no way
  CHECK((push.depth_m == 0.375 && push.way == Vector{0, -0.375}));

  const Segment above{{-1, 1}, {1, 1}}, ahead{{1, -1}, {1, 1}};
  CHECK(push_out({above, ahead}, {0.5, 0.5}, 1).way == Vector{0, -0.5});
  CHECK(push_out({ahead, above}, {0.5, 0.5}, 1).way == Vector{-0.5, 0});
  CHECK_FALSE(push_out({ahead, above}, {0, 0}, 1).needed());
  // A touch is none.
  CHECK_FALSE(push_out({ahead}, {0, 0}, 1 + contact_m / 2).needed());
  CHECK(push_out({ahead}, {0, 0}, 1 + 2 * contact_m).needed());
}

}  // namespace sim_geometry_test
