#include "ocm/client/counted.hpp"

#include <catch2/catch.hpp>

namespace client_counted_test {

using namespace ocm::client;

TEST_CASE("client: a number of things is in words, and what follows them behind a star") {
  CHECK(counted(0, "frame") == "0 frames");
  CHECK(counted(1, "frame") == "1 frame");
  CHECK(counted(2, "frame") == "2 frames");
  CHECK(counted(18'446'744'073'709'551'615U, "set point") == "18446744073709551615 set points");
  CHECK(counted(1, "error* on the bus") == "1 error on the bus");
  CHECK(counted(3, "error* on the bus") == "3 errors on the bus");
  CHECK(counted(3, "time*") == "3 times");
}

}  // namespace client_counted_test
