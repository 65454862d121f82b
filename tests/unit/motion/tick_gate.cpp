#include "ocm/motion/tick_gate.hpp"

#include <cstdint>
#include <cstdlib>

#include <catch2/catch.hpp>

namespace motion_tick_gate_test {

using namespace ocm::motion;

// u2 = 1 where |e2| < 1, else the faster wheel waits. [T2 eq. 7.1]
static_assert(WheelGate{} == WheelGate{true, true}, "each runs unless it has to wait");
static_assert(gate(5, 5) == WheelGate{true, true});
static_assert(gate(5, 6) == WheelGate{true, false});
static_assert(gate(6, 5) == WheelGate{false, true});
static_assert(gate(INT32_MAX, INT32_MIN) == WheelGate{false, true}, "no overflow");

// Turning left: the left wheel goes back from 2 across 0 to -3, the right one from 10 to 14.
static_assert(gate(2, 0xFFFF'FFFD, false, 10, 14, true) == WheelGate{false, true});
static_assert(gate(2, 0xFFFF'FFFE, false, 10, 14, true) == WheelGate{true, true});
static_assert(gate(2, 0xFFFF'FFFF, false, 10, 14, true) == WheelGate{true, false});

TEST_CASE("two motors of different pace stay within a step of each other", "[motion]") {
  std::int32_t left = 0;
  std::int32_t right = 0;
  for (int i = 0; i < 1000; ++i) {
    const WheelGate open = gate(left, right);
    if (open.left) left += 1;
    if (open.right) right += 2;  // twice as fast
    REQUIRE(std::abs(left - right) <= 2);
  }
  CHECK(left >= 999);
}

}  // namespace motion_tick_gate_test
