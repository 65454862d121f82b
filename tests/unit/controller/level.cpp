#include "ocm/controller/level.hpp"

#include <catch2/catch.hpp>

namespace controller_level_test {

using namespace ocm;
using protocol::Priority;
using scheduling::Level;

TEST_CASE("a level is the priority of a request, there and back") {
  for (const auto priority : {Priority::urgent, Priority::high, Priority::medium, Priority::low})
    CHECK(controller::priority_of(controller::level_of(priority)) == priority);
  STATIC_REQUIRE(controller::level_of(protocol::default_priority) == scheduling::default_level);
  STATIC_REQUIRE(controller::level_of(Priority::urgent) == Level::urgent);
  STATIC_REQUIRE(controller::priority_of(Level::low) == Priority::low);
}

}  // namespace controller_level_test
