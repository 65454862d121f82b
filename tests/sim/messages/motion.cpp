#include "sim/messages/motion.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>

#include <catch2/catch.hpp>

namespace sim_messages_motion_test {

using namespace ocm;

/// An integer that states no range.
protocol::Field field_of(unsigned width, bool is_signed, std::int64_t start) {
  protocol::Field field{};
  field.position.width = static_cast<std::uint8_t>(width);
  field.is_signed = is_signed;
  field.raw_min = protocol::lowest(field.position.width, is_signed);
  field.raw_max = protocol::highest(field.position.width, is_signed);
  field.start = start;
  return field;
}

TEST_CASE(
    "Near a start value is an eighth of what the bits hold, at most 1000, and nothing beyond the bits") {
  for (unsigned width = 1; width < 63; ++width)
    for (const bool is_signed : {false, true}) {
      const std::int64_t lowest = is_signed ? -(std::int64_t{1} << (width - 1)) : 0;
      const std::int64_t highest = lowest + (std::int64_t{1} << width) - 1;
      const std::int64_t reach = std::clamp<std::int64_t>((highest - lowest) / 8, 1, 1000);
      const std::int64_t middle = lowest + (highest - lowest) / 2;
      for (const std::int64_t start :
           {lowest, lowest + 1, middle, highest - 1, highest, INT64_MIN, INT64_MAX}) {
        CAPTURE(width, is_signed, start);
        const sim::RawRange range = sim::near_start(field_of(width, is_signed, start));
        const std::int64_t from = std::clamp(start, lowest, highest);
        CHECK(range.low == std::max(lowest, from - reach));
        CHECK(range.high == std::min(highest, from + reach));
      }
    }
  CHECK(sim::near_start(field_of(64, false, 5)).holds(5));
  CHECK(sim::near_start(field_of(64, true, INT64_MIN)).high == INT64_MIN + 1000);
  CHECK(sim::near_start(field_of(64, true, INT64_MAX)).low == INT64_MAX - 1000);
}

TEST_CASE("A float stays within a range that its rounding could leave") {
  // Where floats of 32 bits are 2 and 4 apart: one of them, and two, are within.
  for (const std::int64_t low : {16'777'217, 33'554'437}) {
    protocol::Field field{};
    field.position.width = 32;
    field.number = protocol::Number::float32;
    field.min = {low, 0};
    field.max = {low + (low < 20'000'000 ? 2 : 6), 0};
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
      const sim::FieldMotion motion{field, seed, 1};
      for (int second = 0; second < 60; ++second) {
        const double value = field.value(motion.at(base::Time{std::chrono::seconds{second}}));
        CAPTURE(low, seed, second, value);
        REQUIRE(value >= field.min.as_double());
        REQUIRE(value <= field.max.as_double());
      }
    }
  }
}

}  // namespace sim_messages_motion_test
