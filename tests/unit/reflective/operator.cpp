#include "ocm/reflective/operator.hpp"

#include <bit>
#include <cmath>
#include <limits>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

namespace reflective_operator_test {

using namespace ocm;
using namespace ocm::reflective;

static_assert(topic_index(amiro::catalogue, "ring") == topic_index(amiro::catalogue, "proximity_ring"));
static_assert(amiro::catalogue.topics[topic_index(amiro::catalogue, "gyro")].id == amiro::Gyroscope::id);
static_assert(topic_index(amiro::catalogue, "nothing") == none);

constexpr Transition from_any{.to = 1};
constexpr Transition from_two{.from = 2, .to = 1};
static_assert(Operator{}.leaves(from_any, 0) && Operator{}.leaves(from_any, 2));
static_assert(!Operator{}.leaves(from_any, 1));  // it is there already
static_assert(Operator{}.leaves(from_two, 2) && !Operator{}.leaves(from_two, 0));

constexpr protocol::Field of(std::uint8_t width, bool is_signed,
                             protocol::Number number = protocol::Number::integer) {
  protocol::Field field;
  field.position = {0, width};
  field.is_signed = is_signed;
  field.number = number;
  return field;
}
constexpr protocol::Field float_32 = of(32, true, protocol::Number::float32);
constexpr protocol::Field float_64 = of(64, true, protocol::Number::float64);
constexpr protocol::Field unsigned_64 = of(64, false);
constexpr protocol::Field signed_16 = of(16, true);

TEST_CASE("operator: ordered raw numbers have the order of their values") {
  const double values[] = {
      -std::numeric_limits<double>::infinity(), -1e30, -2, -1, -1e-30, 0, 1e-30, 0.5, 1, 2, 1e30,
      std::numeric_limits<double>::infinity()};
  const auto raw_32 = [](double value) {
    return std::int64_t{std::bit_cast<std::uint32_t>(static_cast<float>(value))};
  };
  const auto raw_64 = [](double value) { return std::bit_cast<std::int64_t>(value); };
  for (std::size_t i = 0; i + 1 < std::size(values); ++i) {
    CHECK(ordered(float_32, raw_32(values[i])) < ordered(float_32, raw_32(values[i + 1])));
    CHECK(ordered(float_64, raw_64(values[i])) < ordered(float_64, raw_64(values[i + 1])));
  }
  CHECK(ordered(float_32, raw_32(-0.0)) == ordered(float_32, raw_32(0.0)));
  CHECK(ordered(float_64, raw_64(-0.0)) == ordered(float_64, raw_64(0.0)));
  CHECK(ordered(unsigned_64, -1) > ordered(unsigned_64, 1));  // 2^64 - 1
  CHECK(ordered(unsigned_64, 0) < ordered(unsigned_64, 1));
  CHECK(ordered(signed_16, -5) == -5);
}

TEST_CASE("operator: what is not a number") {
  CHECK_FALSE(is_number(float_32, std::bit_cast<std::uint32_t>(std::numeric_limits<float>::quiet_NaN())));
  CHECK_FALSE(is_number(float_64, std::bit_cast<std::int64_t>(-std::numeric_limits<double>::quiet_NaN())));
  CHECK(is_number(float_32, std::bit_cast<std::uint32_t>(-std::numeric_limits<float>::infinity())));
  CHECK(is_number(float_64, std::bit_cast<std::int64_t>(1.5)));
  CHECK(is_number(signed_16, -1));
}

}  // namespace reflective_operator_test
