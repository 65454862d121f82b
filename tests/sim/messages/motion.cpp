#include "sim/messages/motion.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

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

/// A stated range, physical: scale and offset are decimal digits.
std::optional<sim::RawRange> stated(unsigned width, bool is_signed, base::Decimal scale, base::Decimal offset,
                                    base::Decimal min, base::Decimal max) {
  protocol::Field field = field_of(width, is_signed, 0);
  field.scale = scale;
  field.offset = offset;
  field.min = min;
  field.max = max;
  return sim::stated_range(field);
}

TEST_CASE("A stated range is of whole numbers within it, whatever scale and offset are") {
  const auto is = [](const std::optional<sim::RawRange>& range, std::int64_t low, std::int64_t high) {
    REQUIRE(range);
    CHECK(range->low == low);
    CHECK(range->high == high);
  };
  is(stated(8, false, {1, 0}, {}, {10, 0}, {20, 0}), 10, 20);
  is(stated(8, false, {5, -1}, {-40, 0}, {-40, 0}, {875, -1}), 0, 255);
  is(stated(8, true, {1, 0}, {}, {-1000, 0}, {1000, 0}), -128, 127);  // no further than the bits
  is(stated(16, false, {3, 0}, {}, {10, 0}, {20, 0}), 4, 6);          // 12 to 18
  is(stated(16, false, {3, 0}, {}, {11, 0}, {19, 0}), 4, 6);
  is(stated(16, false, {3, 0}, {}, {12, 0}, {18, 0}), 4, 6);
  is(stated(16, true, {-3, 0}, {}, {10, 0}, {20, 0}), -6, -4);  // a falling scale
  is(stated(16, true, {-3, 0}, {}, {11, 0}, {19, 0}), -6, -4);
  is(stated(16, true, {-3, 0}, {1, 0}, {-17, 0}, {-8, 0}), 3, 6);
  is(stated(8, false, {1, 0}, {}, {7, 0}, {7, 0}), 7, 7);
  is(stated(8, false, {1, 0}, {}, {}, {5, 0}), 0, 5);
  is(stated(8, true, {1, 0}, {}, {-5, 0}, {}), -5, 0);
  is(stated(8, false, {1, 0}, {}, {}, {}), 0, 255);              // none is stated
  CHECK_FALSE(stated(16, false, {3, 0}, {}, {13, 0}, {14, 0}));  // between two numbers
  CHECK_FALSE(stated(8, false, {1, 0}, {}, {300, 0}, {400, 0}));
  // Beyond 64 bits: as the bits allow.
  is(stated(8, false, {1, -30}, {}, {-1, 30}, {1, 30}), 0, 255);
  protocol::Field field = field_of(8, false, 0);
  CHECK_FALSE(sim::has_stated_range(field));
  field.raw_max = 254;
  CHECK(sim::has_stated_range(field));
  field.raw_max = 255, field.raw_min = 1;
  CHECK(sim::has_stated_range(field));
  field.raw_min = 0, field.max = {5, 0};
  CHECK(sim::has_stated_range(field));
  field.max = {}, field.min = {-5, 0};
  CHECK(sim::has_stated_range(field));
  field = field_of(32, false, 0);
  field.number = protocol::Number::float32;
  field.raw_max = 7;
  CHECK_FALSE(sim::has_stated_range(field));
}

/// All values of a field in 20 minutes, seen each second, with several seeds.
std::vector<std::int64_t> seen_of(const protocol::Field& field) {
  std::vector<std::int64_t> seen;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const sim::FieldMotion motion{field, seed, seed % 3};
    for (int second = 0; second < 1200; ++second)
      seen.push_back(motion.at(base::Time{std::chrono::seconds{second}}));
  }
  std::sort(seen.begin(), seen.end());
  return seen;
}
std::vector<std::int64_t> different(std::vector<std::int64_t> seen) {
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  return seen;
}

TEST_CASE("A number comes to each part of its range alike, its ends among them") {
  protocol::Field field = field_of(8, false, 0);
  field.raw_min = 10, field.raw_max = 19;
  const auto seen = seen_of(field);
  CHECK(different(seen) == std::vector<std::int64_t>{10, 11, 12, 13, 14, 15, 16, 17, 18, 19});
  double mean = 0;
  for (const std::int64_t value : seen) mean += static_cast<double>(value) / static_cast<double>(seen.size());
  CHECK(mean == Approx(14.5).margin(0.2));
  // Without a range it stays near its start.
  const auto near = seen_of(field_of(16, false, 40'000));
  CHECK(near.front() >= 39'000);
  CHECK(near.front() < 39'050);
  CHECK(near.back() <= 41'000);
  CHECK(near.back() > 40'950);
  // All 64 bits.
  protocol::Field wide = field_of(64, true, 0);
  wide.raw_min = INT64_MIN + 1;
  const auto far = seen_of(wide);
  CHECK(far.front() < INT64_MIN / 10 * 9);
  CHECK(far.back() > INT64_MAX / 10 * 9);
}

TEST_CASE("A bit is both, names are what they name, flags are those that have names") {
  CHECK(different(seen_of(field_of(1, false, 0))) == std::vector<std::int64_t>{0, 1});
  CHECK(different(seen_of(field_of(1, true, 0))) == std::vector<std::int64_t>{-1, 0});
  const std::vector<protocol::NamedValue> names{{2, "a"}, {7, "b"}, {9, "c"}, {300, "never"}};
  protocol::Field field = field_of(8, false, 0);
  field.values = names;
  CHECK(different(seen_of(field)) == std::vector<std::int64_t>{2, 7, 9});
  field.raw_max = 8;  // a range without the third
  CHECK(different(seen_of(field)) == std::vector<std::int64_t>{2, 7});
  field.raw_max = 6;  // and with one alone: a number
  CHECK(different(seen_of(field)).size() == 7);
  protocol::Field wide = field_of(9, false, 100);  // of 512 the few names say what is special
  wide.values = std::span{names}.first(3);
  const auto numbers = different(seen_of(wide));  // an eighth to both sides of 100
  CHECK((numbers.front() >= 37 && numbers.front() < 45 && numbers.back() <= 163 && numbers.back() > 155));
  CHECK(numbers.size() > 100);
  // Few: less than half of those that may come.
  const std::vector<protocol::NamedValue> two{{0, "a"}, {2, "b"}};
  wide.values = two;
  wide.raw_max = 5;
  CHECK(different(seen_of(wide)) == std::vector<std::int64_t>{0, 2});
  wide.raw_max = 6;
  CHECK(different(seen_of(wide)) == std::vector<std::int64_t>{0, 1, 2, 3, 4, 5, 6});
  protocol::Field flags = field_of(8, false, 0);
  flags.flags = true;
  const std::vector<protocol::NamedValue> bits{{0, "low"}, {7, "high"}, {8, "beyond"}, {-1, "none"}};
  flags.values = bits;
  const auto sets = seen_of(flags);
  CHECK(different(sets) == std::vector<std::int64_t>{0, 1, 128, 129});
  for (const std::int64_t set : {0, 1, 128, 129}) {  // alike: a name of no bit takes none away
    const auto count = static_cast<double>(std::count(sets.begin(), sets.end(), set));
    CAPTURE(set);
    CHECK(count / static_cast<double>(sets.size()) == Approx(0.25).margin(0.06));
  }
  flags.raw_max = 128;  // what is not within a stated range is the least of it
  CHECK(different(seen_of(flags)) == std::vector<std::int64_t>{0, 1, 128});
  flags.raw_min = 2;
  CHECK(different(seen_of(flags)) == std::vector<std::int64_t>{2, 128});
}

TEST_CASE(
    "Where no range that the bits hold is stated, names count however far from the start value they are") {
  const std::vector<protocol::NamedValue> names{{0, "off"}, {100, "on"}};
  protocol::Field field = field_of(8, false, 0);
  field.values = names;
  CHECK(different(seen_of(field)) == std::vector<std::int64_t>{0, 100});
  field.min = {300, 0}, field.max = {400, 0};  // beyond the bits
  CHECK(different(seen_of(field)) == std::vector<std::int64_t>{0, 100});
  field.values = {};
  const auto numbers = seen_of(field);
  CHECK(numbers.front() == 0);
  CHECK(numbers.back() == 31);  // an eighth of what they hold
  protocol::Field bit = field_of(1, false, 0);
  bit.raw_min = 1;
  CHECK(different(seen_of(bit)) == std::vector<std::int64_t>{1});
}

TEST_CASE("A name or a bit stays for 5 to 20 s, a number takes a new way every 2 to 8 s, without a corner") {
  using std::chrono::milliseconds;
  const std::vector<protocol::NamedValue> names{{0, "a"}, {1, "b"}, {2, "c"}, {3, "d"}};
  double least = 1e9, most = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    protocol::Field field = field_of(2, false, 0);
    field.values = names;
    const sim::FieldMotion motion{field, seed, 1};
    int last = -1, shortest = 1'000'000;
    std::int64_t before = motion.at(base::Time{});
    for (int ms = 10; ms < 600'000; ms += 10) {
      const std::int64_t now = motion.at(base::Time{milliseconds{ms}});
      if (now != before) {
        if (last >= 0) shortest = std::min(shortest, ms - last);
        last = ms;
      }
      before = now;
    }
    least = std::min(least, shortest / 1000.0);
    most = std::max(most, shortest / 1000.0);
  }
  CHECK(least >= 4.98);
  CHECK(least < 7);
  CHECK(most <= 20.02);
  CHECK(most > 17);

  least = 1e9, most = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    protocol::Field field = field_of(32, false, 0);
    field.raw_max = 1'000'000'000;
    const sim::FieldMotion motion{field, seed, 1};
    const auto at = [&motion](int ms) {
      return static_cast<double>(motion.at(base::Time{milliseconds{ms}}));
    };
    // It turns, or at least rests, at the end of each way.
    std::vector<int> turns;
    for (int ms = 20; ms < 120'000; ms += 10) {
      const double before = at(ms) - at(ms - 10), after = at(ms + 10) - at(ms);
      if (before * after < 0) turns.push_back(ms);
      CHECK(std::abs(after - before) < 1e9 * 6 * 0.01 * 0.01 / 4 * 1.1);  // 6/step^2: no corner
    }
    REQUIRE(turns.size() > 3);
    int shortest = 1'000'000;
    for (std::size_t i = 1; i < turns.size(); ++i) shortest = std::min(shortest, turns[i] - turns[i - 1]);
    least = std::min(least, shortest / 1000.0);
    most = std::max(most, shortest / 1000.0);
  }
  CHECK(least >= 1.97);
  CHECK(least < 3);
  CHECK(most > 6);
}

TEST_CASE("Before the beginning a field is as it is there") {
  protocol::Field field = field_of(32, false, 0);
  field.raw_max = 1'000'000'000;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const sim::FieldMotion motion{field, seed, 1};
    for (const std::int64_t ns : {std::int64_t{-1}, std::int64_t{-5'000'000'000}, INT64_MIN})
      CHECK(motion.at(base::Time{std::chrono::nanoseconds{ns}}) == motion.at(base::Time{}));
  }
}

TEST_CASE("A float takes the way of a number with the same range, seed and place") {
  protocol::Field whole = field_of(32, false, 0);
  whole.raw_max = 1'000'000'000;
  protocol::Field real{};
  real.position.width = 64;
  real.number = protocol::Number::float64;
  real.max = {1, 9};
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const sim::FieldMotion motion{whole, seed, 1}, same{real, seed, 1};
    for (int ms = 0; ms < 60'000; ms += 100) {
      const base::Time now{std::chrono::milliseconds{ms}};
      CAPTURE(seed, ms);
      REQUIRE(std::abs(real.value(same.at(now)) - static_cast<double>(motion.at(now))) < 2);
    }
  }
}

TEST_CASE("A float without a range moves within 100 above its start, or above 0") {
  for (const bool wide : {false, true}) {
    protocol::Field field{};
    field.position.width = wide ? 64 : 32;
    field.number = wide ? protocol::Number::float64 : protocol::Number::float32;
    const auto range = [&field] {
      double low = 1e9, high = -1e9;
      for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const sim::FieldMotion motion{field, seed, 1};
        for (int second = 0; second < 600; ++second) {
          const double value = field.value(motion.at(base::Time{std::chrono::seconds{second}}));
          low = std::min(low, value);
          high = std::max(high, value);
        }
      }
      return std::pair{low, high};
    };
    const auto between = [&range](double low, double high) {
      const auto [least, most] = range();
      CHECK(least >= low);
      CHECK(least < low + (high - low) / 20);
      CHECK(most <= high);
      CHECK(most > high - (high - low) / 20);
    };
    between(0, 100);
    field.start = *field.float_from(50.0);
    between(50, 150);
    field.start = *field.float_from(std::numeric_limits<double>::infinity());
    between(0, 100);
    field.min = {-25, -1}, field.max = {1, 0};
    between(-2.5, 1);
    field.min = {}, field.max = {3, 0};
    between(0, 3);
    field.min = {3, 0};
    CHECK(range() == std::pair{3.0, 3.0});
    field.min = {4, 0};  // which ends below its beginning: none
    between(0, 100);
  }
}

}  // namespace sim_messages_motion_test
