#include "ocm/sensing/anti_collision.hpp"

#include <catch2/catch.hpp>

namespace sensing_anti_collision_test {

using namespace ocm::sensing;

// T2 listing 8.2: up to 30 degrees the forward sensor, from 60 the right one, 0 < object < minimum.
static_assert(must_stop(0, 14, 80, 15) && must_stop(30, 14, 80, 15));
static_assert(!must_stop(31, 14, 14, 15) && !must_stop(59, 14, 14, 15));
static_assert(must_stop(60, 80, 14, 15) && must_stop(90, 80, 14, 15));
static_assert(!must_stop(0, 80, 14, 15) && !must_stop(90, 14, 80, 15), "the other sensor looks elsewhere");
static_assert(!must_stop(0, 15, 80, 15) && must_stop(0, 1, 80, 15));
static_assert(!must_stop(0, 0, 80, 15) && !must_stop(90, 80, 0, 15), "0 is nothing seen");
static_assert(!must_stop(0, -1, 80, 15));

TEST_CASE("some sensor looks ahead at every angle but from 31 to 59 degrees", "[sensing]") {
  for (int servo = 0; servo <= 90; ++servo) CHECK((ahead_cm(servo, 7, 8) == 0) == (servo > 30 && servo < 60));
}

}  // namespace sensing_anti_collision_test
