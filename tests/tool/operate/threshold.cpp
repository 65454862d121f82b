#include "cli/operate/threshold.hpp"

#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/reflective/monitor.hpp"

namespace operate_threshold_test {

using namespace ocm;
using cli::operate::threshold;
using cli::words::Comparison;

constexpr Comparison all[] = {Comparison::equal,   Comparison::different, Comparison::less,
                              Comparison::at_most, Comparison::greater,   Comparison::at_least};

/// What a supervisor makes of a raw number.
bool holds(const protocol::Field& field, const cli::operate::Threshold& of, std::int64_t raw) {
  const bool ordered = of.is == reflective::Is::above || of.is == reflective::Is::below;
  const reflective::Condition condition{.is = of.is, .limit = of.limit};
  return reflective::holds(condition, ordered ? reflective::ordered(field, raw) : raw, false) != of.negated;
}

protocol::Field field_of(unsigned width, bool is_signed) {
  protocol::Field field;
  field.name = "value";
  field.position = {0, static_cast<std::uint8_t>(width)};
  field.is_signed = is_signed;
  field.raw_min = is_signed ? -(std::int64_t{1} << (width - 1)) : 0;
  field.raw_max = (std::int64_t{1} << (is_signed ? width - 1 : width)) - 1;
  return field;
}

TEST_CASE("threshold: holds for the same raw numbers as the condition that was typed, for all of them") {
  std::size_t refused = 0;
  std::size_t compared = 0;
  for (const bool is_signed : {false, true}) {
    for (const base::Decimal scale : {base::Decimal{1, 0}, base::Decimal{-1, 0}, base::Decimal{25, -2}}) {
      for (const base::Decimal offset : {base::Decimal{}, base::Decimal{-40, 0}}) {
        protocol::Field field = field_of(8, is_signed);
        field.scale = scale;
        field.offset = offset;
        for (const char* const text : {"0", "12", "-12.5", "12.6", "63.75", "300", "-168", "127"}) {
          for (const Comparison comparison : all) {
            const auto typed = cli::words::Condition::of(field, comparison, text);
            REQUIRE(typed);
            const auto found = threshold(field, comparison, text);
            std::size_t fulfilled = 0;
            for (std::int64_t raw = field.raw_min; raw <= field.raw_max; ++raw) {
              fulfilled += typed->holds(raw) ? 1U : 0U;
              if (!found) continue;
              ++compared;
              if (holds(field, *found, raw) != typed->holds(raw))
                FAIL(text << " comparison " << static_cast<int>(comparison) << " of " << raw);
            }
            // Refused is what is the same for all.
            if (!found) ++refused;
            CHECK((fulfilled != 0 && fulfilled != 256) == static_cast<bool>(found));
          }
        }
      }
    }
  }
  CHECK(refused > 100);
  CHECK(compared > 50'000);
}

TEST_CASE("threshold: on a derived field it is one on what is measured") {
  static constexpr protocol::Law law{{942'693'757, -9}, {2350, 0}, {457, -2}, {38, -4}, {2, -1}};
  const protocol::Field counts = field_of(16, false);
  for (const bool uncertainty : {false, true}) {
    const auto field = protocol::derived(counts, 0, "distance", "m", law, uncertainty);
    for (const char* const text : {"0.1", "0.05m", "0.2", "0.004", "0.0001", "0.01"}) {
      for (const Comparison comparison : {Comparison::less, Comparison::greater, Comparison::at_least}) {
        const auto typed = cli::words::Condition::of(field, comparison, text);
        REQUIRE(typed);
        const auto raw = threshold(field, comparison, text);
        CAPTURE(uncertainty, text, comparison);
        std::int64_t fulfilled = 0;
        for (std::int64_t each = 0; each <= UINT16_MAX; ++each) {
          fulfilled += typed->holds(each);
          if (raw && typed->holds(each) != holds(counts, *raw, each)) FAIL(each);
        }
        // Refused is what is the same for all: nothing is nearer than 0.1 mm.
        CHECK(static_cast<bool>(raw) == (fulfilled != 0 && fulfilled != UINT16_MAX + 1));
      }
    }
  }
  const auto near =
      threshold(protocol::derived(counts, 0, "distance", "m", law, false), Comparison::less, "0.1");
  REQUIRE(near);
  CHECK(near->is == reflective::Is::above);
  CHECK(near->limit == 2444);  // 94 counts above the offset are 0.1001 m, 95 0.0996 m
}

TEST_CASE("threshold: of 64 bits without a sign the upper half is above the lower") {
  protocol::Field field;
  field.name = "wide";
  field.position = {0, 64};
  field.raw_min = 0;
  field.raw_max = INT64_MAX;
  const auto found = threshold(field, Comparison::greater, "1000");
  REQUIRE(found);
  CHECK_FALSE(holds(field, *found, 1000));
  CHECK(holds(field, *found, 1001));
  CHECK(holds(field, *found, -1));  // 2^64 - 1
}

TEST_CASE("threshold: floats are in the order of their values, infinities too") {
  protocol::Field field;
  field.name = "real";
  field.position = {0, 32};
  field.number = protocol::Number::float32;
  const auto bits = [](float value) { return std::int64_t{std::bit_cast<std::uint32_t>(value)}; };
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const std::vector<float> values{-infinity, -1e30F, -1.5F, -1e-30F, -0.0F,   0.0F,
                                  1e-30F,    0.5F,   1.5F,  1e30F,   infinity};
  for (const char* const text : {"0", "-1.5", "0.5", "1e-30", "3"}) {
    for (const Comparison comparison :
         {Comparison::less, Comparison::at_most, Comparison::greater, Comparison::at_least}) {
      const auto typed = cli::words::Condition::of(field, comparison, text);
      const auto found = threshold(field, comparison, text);
      REQUIRE(typed);
      REQUIRE(found);
      for (const float value : values) CHECK(holds(field, *found, bits(value)) == typed->holds(bits(value)));
    }
    CHECK_FALSE(threshold(field, Comparison::equal, text));
  }
}

TEST_CASE("threshold: of double precision the same") {
  protocol::Field field;
  field.name = "real";
  field.position = {0, 64};
  field.number = protocol::Number::float64;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::vector<double> values{-infinity, -1e12, -1.5, -1e-12, -0.0,    0.0,
                                   1e-12,     0.5,   1.5,  1e12,   infinity};
  for (const char* const text : {"0", "-1.5", "0.5", "1e-12", "-1e12", "3"}) {
    for (const Comparison comparison :
         {Comparison::less, Comparison::at_most, Comparison::greater, Comparison::at_least}) {
      CAPTURE(text, comparison);
      const auto typed = cli::words::Condition::of(field, comparison, text);
      const auto found = threshold(field, comparison, text);
      REQUIRE(typed);
      REQUIRE(found);
      for (const double value : values) {
        const auto raw = std::bit_cast<std::int64_t>(value);
        CHECK(holds(field, *found, raw) == typed->holds(raw));
      }
    }
    CHECK_FALSE(threshold(field, Comparison::equal, text));
  }
}

TEST_CASE("threshold: named values and flags") {
  constexpr protocol::NamedValue names[] = {{0, "off"}, {2, "on"}, {3, "broken"}};
  protocol::Field field = field_of(8, false);
  field.values = names;
  for (const Comparison comparison : all) {
    const auto typed = cli::words::Condition::of(field, comparison, "on");
    const auto found = threshold(field, comparison, "on");
    REQUIRE(found);
    for (std::int64_t raw = 0; raw < 256; ++raw) CHECK(holds(field, *found, raw) == typed->holds(raw));
  }
  field.flags = true;
  for (const Comparison comparison : {Comparison::equal, Comparison::different}) {
    const auto typed = cli::words::Condition::of(field, comparison, "on");
    const auto found = threshold(field, comparison, "on");
    REQUIRE(found);
    for (std::int64_t raw = 0; raw < 256; ++raw) CHECK(holds(field, *found, raw) == typed->holds(raw));
  }
}

}  // namespace operate_threshold_test
