#include "ocm/reflective/operator.hpp"

#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <limits>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

namespace reflective_operator_test {

using namespace ocm;
using namespace ocm::reflective;
using namespace std::chrono_literals;

static_assert(topic_index(amiro::catalogue, "ring") == topic_index(amiro::catalogue, "proximity_ring"));
static_assert(amiro::catalogue.topics[topic_index(amiro::catalogue, "gyro")].id == amiro::Gyroscope::id);
static_assert(topic_index(amiro::catalogue, "nothing") == none);

// What a table does not say.
static_assert(none == 0xFFFF);
static_assert(Limit{}.field == 0 && Limit{}.min == 0 && Limit{}.max == 0 && Limit{}.per_second == 0);
static_assert(Adaptation{}.frame == 0 && Adaptation{}.field == 0);
static_assert(Adaptation{}.from == 0 && Adaptation{}.to == 0);
static_assert(Adaptation{}.grain == 1ms && Adaptation{}.every == 1s);
static_assert(Condition{}.frame == 0 && Condition{}.field == 0);
static_assert(Condition{}.limit == 0 && Condition{}.hysteresis == 0);
static_assert(Term{}.condition == 0 && Transition{}.precedence == 0);
static_assert(Operator{}.initial == 0 && Operator{}.fall_back == 0);

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
  // Infinity is one, and the next bits are none. [IEEE 754]
  CHECK(is_number(float_32, 0x7F80'0000));
  CHECK_FALSE(is_number(float_32, 0x7F80'0001));
  CHECK(is_number(float_64, 0x7FF0'0000'0000'0000));
  CHECK_FALSE(is_number(float_64, 0x7FF0'0000'0000'0001));
}

TEST_CASE("operator: streams that other configurations ask for and one does not, each once") {
  const std::array<Stream, 2> first{{{0, 50ms}, {1, 50ms}}};
  const std::array<Stream, 2> second{{{1, 50ms}, {2, 50ms}}};
  const std::array<Stream, 3> third{{{0, 50ms}, {2, 50ms}, {3, 50ms}}};
  const std::array<Configuration, 3> configurations{
      {{"a", first, {}, {}, {}}, {"b", second, {}, {}, {}}, {"c", third, {}, {}, {}}}};
  Operator op;
  op.configurations = configurations;
  const auto elsewhere = [&](std::size_t configuration) {
    std::vector<int> topics;
    for_each_stream_elsewhere(op, configuration,
                              [&](const Stream& stream) { topics.push_back(stream.topic); });
    return topics;
  };
  CHECK(elsewhere(0) == std::vector{2, 3});
  CHECK(elsewhere(1) == std::vector{0, 3});
  CHECK(elsewhere(2) == std::vector{1});
}

}  // namespace reflective_operator_test
