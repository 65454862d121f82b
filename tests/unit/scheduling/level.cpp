#include "ocm/scheduling/level.hpp"

#include <catch2/catch.hpp>

namespace scheduling_level_test {

using ocm::scheduling::Level;

TEST_CASE("the more urgent level comes first") {
  STATIC_REQUIRE(Level::urgent < Level::high);
  STATIC_REQUIRE(Level::high < Level::medium);
  STATIC_REQUIRE(Level::medium < Level::low);
  STATIC_REQUIRE(static_cast<std::size_t>(Level::low) + 1 == ocm::scheduling::level_count);
}

TEST_CASE("what does not say otherwise runs at medium") {
  STATIC_REQUIRE(ocm::scheduling::default_level == Level::medium);
}

}  // namespace scheduling_level_test
