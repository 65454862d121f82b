#include "ocm/mapper/link/field.hpp"

#include <catch2/catch.hpp>

namespace mapper_link_field_test {

using namespace ocm::mapper::link;

struct Pair {
  std::int16_t first = 0;
  std::int16_t second = 0;
};

TEST_CASE("a field without a range takes any integer, and reaches its member") {
  constexpr Field<Pair> first{&Pair::first, "first", "cm"};
  constexpr Field<Pair> second{&Pair::second, "second", "", 0, 90};
  STATIC_REQUIRE(first.min == -32768);
  STATIC_REQUIRE(first.max == 32767);
  STATIC_REQUIRE(second.max == 90);
  STATIC_REQUIRE(Pair{3, 4}.*second.member == 4);
}

}  // namespace mapper_link_field_test
