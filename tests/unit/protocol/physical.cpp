#include "ocm/protocol/physical.hpp"

#include <limits>

#include <catch2/catch.hpp>

namespace protocol_physical_test {

using ocm::protocol::nearest_raw;

constexpr std::int16_t low = INT16_MIN;
constexpr std::int16_t high = INT16_MAX;

TEST_CASE("a raw number is the nearest one, halves away from zero") {
  STATIC_REQUIRE(nearest_raw<std::int16_t>(2.5, low, high) == 3);
  STATIC_REQUIRE(nearest_raw<std::int16_t>(-2.5, low, high) == -3);
  STATIC_REQUIRE(nearest_raw<std::int16_t>(2.4999, low, high) == 2);
  // Adding 0.5 first would round this up: the sum is 1.0 in binary.
  STATIC_REQUIRE(nearest_raw<std::int16_t>(0.49999999999999994, low, high) == 0);
}

TEST_CASE("a raw number stays within the range") {
  STATIC_REQUIRE(nearest_raw<std::int16_t>(32768.0, low, high) == 32767);
  STATIC_REQUIRE(nearest_raw<std::int16_t>(-1e300, low, high) == -32768);
  STATIC_REQUIRE(nearest_raw<std::uint8_t>(101.0, 0, 100) == 100);
  STATIC_REQUIRE(nearest_raw<std::int64_t>(1e19, INT64_MIN, INT64_MAX) == INT64_MAX);
  // Beyond what an int64_t holds.
  STATIC_REQUIRE(nearest_raw<std::uint64_t>(1e19, 0, UINT64_MAX) == 10'000'000'000'000'000'000U);
  STATIC_REQUIRE(nearest_raw<std::uint64_t>(-1, 0, UINT64_MAX) == 0);
  STATIC_REQUIRE(nearest_raw<std::uint64_t>(2.5, 0, UINT64_MAX) == 3);
  STATIC_REQUIRE(nearest_raw<std::uint64_t>(2e19, 0, UINT64_MAX) == UINT64_MAX);
  // The nearest doubles to the greatest numbers, which are one more.
  STATIC_REQUIRE(nearest_raw<std::int64_t>(0x1p63, INT64_MIN, INT64_MAX) == INT64_MAX);
  STATIC_REQUIRE(nearest_raw<std::uint64_t>(0x1p64, 0, UINT64_MAX) == UINT64_MAX);
  CHECK(nearest_raw<std::int16_t>(-std::numeric_limits<double>::infinity(), low, high) == -32768);
}

TEST_CASE("not a number is the nearest to zero, so that nothing moves") {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  STATIC_REQUIRE(nearest_raw<std::int16_t>(nan, low, high) == 0);
  STATIC_REQUIRE(nearest_raw<std::int16_t>(nan, 5, 9) == 5);
  STATIC_REQUIRE(nearest_raw<std::int16_t>(nan, -9, -5) == -5);
  STATIC_REQUIRE(nearest_raw<std::int16_t>(nan, 1, 9) == 1);
  STATIC_REQUIRE(nearest_raw<std::int16_t>(nan, -9, -1) == -1);
}

TEST_CASE("a floating-point number stays within a range") {
  using ocm::protocol::within;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  STATIC_REQUIRE(within(0.25, -1, 1) == 0.25);
  STATIC_REQUIRE(within(1, -1, 1) == 1);
  STATIC_REQUIRE(within(1.5, -1, 1) == 1);
  STATIC_REQUIRE(within(-infinity, -1, 1) == -1);
  STATIC_REQUIRE(within(nan, -1, 1) == 0);
  STATIC_REQUIRE(within(nan, 5, 9) == 5);
  STATIC_REQUIRE(within(nan, -9, -5) == -5);
  STATIC_REQUIRE(within(nan, -0.5, 0.5) == 0);
  STATIC_REQUIRE(within(nan, 0.5, 9) == 0.5);
  STATIC_REQUIRE(within(nan, -9, -0.5) == -0.5);
}

}  // namespace protocol_physical_test
