#include "cli/words/wide_number.hpp"

#include <cstdint>

#include <catch2/catch.hpp>

#include "cli/words/value.hpp"

namespace tool_words_wide_number_test {

using namespace ocm;
using ocm::cli::words::greatest_raw;
using ocm::cli::words::wide_raw_from;

constexpr protocol::Field field_of(base::Decimal scale, base::Decimal offset) {
  protocol::Field field;
  field.name = "wide";
  field.position = {0, 64};
  field.is_signed = true;
  field.scale = scale;
  field.offset = offset;
  field.raw_min = INT64_MIN;
  field.raw_max = INT64_MAX;
  return field;
}

// By hand: (number - offset) / scale, to the nearest, away from 0 in the middle.
TEST_CASE("a typed number of a wide field: number, scale and offset may each have the most decimal places") {
  const auto offset_has_most = field_of({1, 0}, {25, -2});
  CHECK(*wide_raw_from(offset_has_most, "3") == 3);       // 2.75
  CHECK(*wide_raw_from(offset_has_most, "3.5") == 3);     // 3.25
  CHECK(*wide_raw_from(offset_has_most, "-3") == -3);     // -3.25
  CHECK(*wide_raw_from(offset_has_most, "0.75") == 1);    // 0.5
  CHECK(*wide_raw_from(offset_has_most, "-0.25") == -1);  // -0.5
  const auto scale_has_most = field_of({5, -3}, {1, 0});
  CHECK(*wide_raw_from(scale_has_most, "2") == 200);
  CHECK(*wide_raw_from(scale_has_most, "1.0024") == 0);
  CHECK(*wide_raw_from(scale_has_most, "1.0025") == 1);
  const auto number_has_most = field_of({2, 0}, {0, 0});
  CHECK(*wide_raw_from(number_has_most, "4.99") == 2);
  CHECK(*wide_raw_from(number_has_most, "5") == 3);
  CHECK(*wide_raw_from(number_has_most, "-5") == -3);
  CHECK(*wide_raw_from(field_of({-2, 0}, {0, 0}), "5") == -3);
}

TEST_CASE("a typed number of a wide field: beyond the range, and what is no number") {
  const auto field = field_of({1, 0}, {0, 0});
  CHECK(*wide_raw_from(field, "9223372036854775807") == INT64_MAX);
  CHECK(*wide_raw_from(field, "-9223372036854775808") == INT64_MIN);
  for (const auto* const beyond :
       {"9223372036854775808", "-9223372036854775809", "1000000000000000000000000000000000000000"})
    CHECK(wide_raw_from(field, beyond).error == base::Error::out_of_range);
  for (const auto* const wrong : {"", "-", "1e3", "1.2.3", "--1", "0x1"}) {
    CAPTURE(wrong);
    CHECK(wide_raw_from(field, wrong).error == base::Error::bad_syntax);
  }
  CHECK(wide_raw_from(field_of({0, 0}, {0, 0}), "1").error == base::Error::out_of_range);
}

TEST_CASE(
    "a typed number of a wide field: an unsigned word of 64 bits takes all its numbers, unless a range is "
    "stated") {
  auto word = field_of({1, 0}, {0, 0});
  word.is_signed = false;
  word.raw_min = 0;
  CHECK(*wide_raw_from(word, "9223372036854775808") == INT64_MIN);  // the same bits
  CHECK(*wide_raw_from(word, "18446744073709551615") == -1);
  CHECK(greatest_raw(word) == -1);
  for (const auto* const beyond : {"-1", "18446744073709551616"})
    CHECK(wide_raw_from(word, beyond).error == base::Error::out_of_range);
  auto ends_below = word;
  ends_below.raw_max = INT64_MAX - 1;
  CHECK(*wide_raw_from(ends_below, "9223372036854775806") == INT64_MAX - 1);
  CHECK(wide_raw_from(ends_below, "9223372036854775807").error == base::Error::out_of_range);
  CHECK(greatest_raw(ends_below) == INT64_MAX - 1);
  auto begins_above = word;
  begins_above.raw_min = 1;
  auto with_a_sign = word;
  with_a_sign.is_signed = true;
  auto narrower = word;
  narrower.position.width = 63;
  for (const auto& field : {begins_above, with_a_sign, narrower}) {
    CHECK(*wide_raw_from(field, "9223372036854775807") == INT64_MAX);
    CHECK(wide_raw_from(field, "9223372036854775808").error == base::Error::out_of_range);
    CHECK(greatest_raw(field) == INT64_MAX);
  }
}

}  // namespace tool_words_wide_number_test
