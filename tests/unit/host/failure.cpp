#include "ocm/host/failure.hpp"

#include <catch2/catch.hpp>

namespace host_failure_test {

using namespace ocm;
using host::Failure;

TEST_CASE("an outcome is a value or a failure in words") {
  const host::Outcome<int> number = 7;
  const host::Outcome<int> failure = Failure{"no bus", "start one"};
  CHECK(number.ok());
  CHECK_FALSE(failure.ok());
  CHECK(failure.error.remedy == "start one");
}

}  // namespace host_failure_test
