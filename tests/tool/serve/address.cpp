#include "cli/serve/address.hpp"

#include <catch2/catch.hpp>

namespace serve_address_test {

using ocm::cli::serve::page_address;

TEST_CASE("address: token and what is shown are behind the #") {
  CHECK(page_address("http://127.0.0.1:8484/", "", "") == "http://127.0.0.1:8484/");
  CHECK(page_address("http://h/", "0f", "") == "http://h/#0f");
  CHECK(page_address("http://h/", "", "map") == "http://h/#map");
  CHECK(page_address("http://h/", "0f", "plot=/gyro.z") == "http://h/#0f&plot=/gyro.z");
}

}  // namespace serve_address_test
