#include "sim/parts/violations.hpp"

#include <catch2/catch.hpp>

namespace firmware_drivers_violations_test {

TEST_CASE("violations: a driver that repeats itself keeps the first thousand") {
  ocm::sim::Violations violations;
  CHECK(violations.none());
  for (int i = 0; i < 5000; ++i) violations.add(std::to_string(i));
  REQUIRE(violations.texts().size() == 1000);
  CHECK(violations.texts().front() == "0");
  CHECK(violations.texts().back() == "999");
  violations.clear();
  CHECK(violations.none());
  violations.add("again");
  CHECK(violations.texts() == std::vector<std::string>{"again"});
}

}  // namespace firmware_drivers_violations_test
