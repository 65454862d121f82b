/// Fails on purpose: one check among others that hold.
#include <catch2/catch.hpp>

TEST_CASE("holds") {
  CHECK(1 + 1 == 2);
}
TEST_CASE("does not hold") {
  for (int i = 0; i < 3; ++i) {
    CAPTURE(i);
    CHECK(i != 1);
  }
}
TEST_CASE("holds again") {
  REQUIRE_FALSE(1 + 1 == 3);
}
