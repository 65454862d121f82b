/// Fails on purpose: an undefined instruction.
#include <catch2/catch.hpp>

TEST_CASE("faults") {
  asm volatile("udf #0");
}
