/// Fails on purpose: nothing runs behind a REQUIRE that does not hold.
#include <catch2/catch.hpp>

TEST_CASE("does not hold") {
  const int error = 10;
  INFO("error " << error);
  REQUIRE(error == 0);
  CHECK(error == 0);
}
