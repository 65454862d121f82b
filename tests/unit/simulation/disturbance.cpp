#include "ocm/simulation/disturbance.hpp"

#include <catch2/catch.hpp>

namespace simulation_disturbance_test {

using namespace ocm;
using simulation::Disturbance;
using simulation::Disturbances;

// The disturbed bit, 6 to 12 bits of flags, 8 of delimiter, 3 of intermission. [ISO 11898-1]
static_assert(Disturbance{100}.over() == 100 + 1 + 6 + 8 + 3);
static_assert(Disturbance{100, 9}.over() == 100 + 1 + 9 + 8 + 3);
static_assert(Disturbance{100, 12}.over() == 100 + 1 + 12 + 8 + 3);
static_assert(Disturbance{}.boundary == 0 && Disturbance{}.flag_bits == 6);
static_assert(Disturbance{100, 0}.over() == 118);
static_assert(Disturbance{100, 100}.over() == 124);

TEST_CASE("disturbances come in order, however they were added") {
  Disturbances ahead;
  for (const std::uint64_t boundary : {50U, 10U, 30U, 70U, 20U}) ahead.push({boundary});
  CHECK(ahead.size() == 5);
  CHECK_FALSE(ahead.any_before(10));
  CHECK(ahead.any_before(11));
  for (const std::uint64_t boundary : {10U, 20U, 30U, 50U, 70U}) {
    CHECK(ahead.front().boundary == boundary);
    CHECK(ahead.pop().boundary == boundary);
  }
  CHECK_FALSE(ahead.any_before(UINT64_MAX));
}

TEST_CASE("two disturbances of one bit are one, with the longer flags") {
  Disturbances ahead;
  ahead.push({10, 7});
  ahead.push({10, 11});
  ahead.push({10, 6});
  CHECK(ahead.size() == 1);
  CHECK(ahead.pop().flag_bits == 11);
}

}  // namespace simulation_disturbance_test
