#include "cli/words/condition.hpp"

#include <bit>
#include <limits>

#include <catch2/catch.hpp>

namespace tool_words_condition_test {

using namespace ocm;
using namespace ocm::cli::words;

constexpr ConditionWords split(const char* text) {
  return *split_condition(text);
}

TEST_CASE("a condition is a field, a comparison and a value") {
  constexpr auto parts = split("Engine.Speed>=3000");
  STATIC_REQUIRE(parts.field == "Engine.Speed");
  STATIC_REQUIRE(parts.comparison == Comparison::at_least);
  STATIC_REQUIRE(parts.value == "3000");
  STATIC_REQUIRE(split("a=b").comparison == Comparison::equal);
  STATIC_REQUIRE(split("a==b").comparison == Comparison::equal);
  STATIC_REQUIRE(split("a!=b").comparison == Comparison::different);
  STATIC_REQUIRE(split("a<b").comparison == Comparison::less);
  STATIC_REQUIRE(split("a<=b").comparison == Comparison::at_most);
  STATIC_REQUIRE(split("a>b").comparison == Comparison::greater);
  STATIC_REQUIRE(split("  a  >  -1 m/s ").field == "a");
  STATIC_REQUIRE(split("  a  >  -1 m/s ").value == "-1 m/s");
  STATIC_REQUIRE(split("a>>b").value == ">b");  // a name may be anything
  for (const char* text : {"", "a", "a>", ">3", "a!b", "a>=", " > "}) {
    CAPTURE(text);
    CHECK(split_condition(text).error == base::Error::bad_syntax);
  }
}

constexpr protocol::NamedValue names[] = {{0, "off"}, {3, "on"}};
protocol::Field field(bool is_signed = true) {
  protocol::Field out;
  out.name = "x";
  out.position = {0, 16, protocol::ByteOrder::little};
  out.is_signed = is_signed;
  out.scale = {1, -1};
  out.unit = "m/s";
  out.raw_min = is_signed ? INT16_MIN : 0;
  out.raw_max = is_signed ? INT16_MAX : UINT16_MAX;
  out.values = names;
  return out;
}
bool holds(const protocol::Field& of, Comparison comparison, const char* value, std::int64_t raw) {
  return Condition::of(of, comparison, value)->holds(raw);
}

TEST_CASE("a condition is compared exactly, in the field's unit") {
  const auto x = field();
  CHECK(holds(x, Comparison::equal, "0.3", 3));
  CHECK(holds(x, Comparison::equal, "0.3m/s", 3));
  CHECK(holds(x, Comparison::equal, "+0.3 m/s", 3));
  CHECK_FALSE(holds(x, Comparison::equal, "0.30000000000000001", 3));
  CHECK(holds(x, Comparison::less, "0.30000000000000001", 3));
  CHECK(holds(x, Comparison::different, "0.4", 3));
  CHECK_FALSE(holds(x, Comparison::less, "0.3", 3));
  CHECK(holds(x, Comparison::at_most, "0.3", 3));
  CHECK(holds(x, Comparison::at_least, "0.3", 3));
  CHECK_FALSE(holds(x, Comparison::greater, "0.3", 3));
  CHECK(holds(x, Comparison::greater, "-99999", -3));  // beyond what the field can be
}

TEST_CASE("a condition takes the units and digits that set takes") {
  const auto x = field();
  CHECK(holds(x, Comparison::equal, "30cm/s", 3));
  CHECK(holds(x, Comparison::greater, "-400mm/s", -3));
  CHECK(holds(x, Comparison::less, "0x1", 3));
  CHECK(holds(x, Comparison::greater, "0x1", 11));
  CHECK_FALSE(Condition::of(x, Comparison::equal, "30cm").ok());
  CHECK_FALSE(Condition::of(x, Comparison::equal, "0xG").ok());
  auto plain = field(false);
  plain.unit = "";
  CHECK_FALSE(Condition::of(plain, Comparison::equal, "3V").ok());
}

TEST_CASE("a named value is its raw number, a flag its bit") {
  const auto x = field();
  CHECK(holds(x, Comparison::equal, "on", 3));
  CHECK(holds(x, Comparison::less, "on", 2));
  auto flags = field(false);
  flags.flags = true;
  CHECK(holds(flags, Comparison::equal, "on", 0x18));  // bit 3 among others
  CHECK_FALSE(holds(flags, Comparison::equal, "on", 0x10));
  CHECK(holds(flags, Comparison::different, "on", 0x10));
  CHECK(Condition::of(flags, Comparison::less, "on").error == "a flag is set or not: write x=on");
}

TEST_CASE("a number that is the name of another value means the number") {
  constexpr protocol::NamedValue numbers[] = {{0, "1"}, {1, "2"}, {2, "300"}, {3, "1.5 V"}};
  auto x = field(false);
  x.values = numbers;
  x.scale = {1, 0};
  x.unit = "V";
  x.raw_max = 255;
  CHECK(holds(x, Comparison::equal, "1", 1));
  CHECK_FALSE(holds(x, Comparison::equal, "1", 0));
  CHECK(holds(x, Comparison::equal, "2 V", 2));
  CHECK(holds(x, Comparison::greater, "1", 2));
  CHECK(holds(x, Comparison::equal, "300", 2));  // which the field cannot be
  CHECK(parse_value(x, "1") == 1);
  CHECK(parse_value(x, "1V") == 1);
  CHECK(parse_value(x, "300") == 2);
  CHECK(parse_value(x, "1.5 V") == 3);  // with a blank it is a name, if there is one
  CHECK(parse_value(x, "2 V") == 2);
}

TEST_CASE("floats and 64 bits without sign") {
  auto real = field(false);
  real.number = protocol::Number::float32;
  real.position.width = 32;
  real.scale = {1, 0};
  const auto bits = [](float value) { return std::int64_t{std::bit_cast<std::uint32_t>(value)}; };
  CHECK(holds(real, Comparison::greater, "1.25", bits(1.5F)));
  CHECK_FALSE(holds(real, Comparison::greater, "1.5", bits(1.5F)));
  for (const auto comparison : {Comparison::equal, Comparison::at_most, Comparison::at_least})
    CHECK(holds(real, comparison, "1.5", bits(1.5F)));
  for (const auto comparison : {Comparison::different, Comparison::less})
    CHECK_FALSE(holds(real, comparison, "1.5", bits(1.5F)));
  CHECK(holds(real, Comparison::less, "1.5", bits(1.25F)));
  const auto nan = bits(std::numeric_limits<float>::quiet_NaN());
  for (const auto comparison :
       {Comparison::equal, Comparison::less, Comparison::at_most, Comparison::greater, Comparison::at_least})
    CHECK_FALSE(holds(real, comparison, "0", nan));
  CHECK(holds(real, Comparison::different, "0", nan));

  auto wide = field(false);
  wide.position.width = 64;
  wide.scale = {1, 0};
  CHECK(holds(wide, Comparison::greater, "10000000000000000000", -1));  // all bits: 2^64 - 1
  const auto from_2_63 = static_cast<std::int64_t>(9'223'372'036'854'775'810U);
  CHECK(holds(wide, Comparison::equal, "9223372036854775810", from_2_63));
  CHECK_FALSE(holds(wide, Comparison::greater, "9223372036854775810", from_2_63));
  CHECK(holds(wide, Comparison::greater, "on", -1));
  CHECK_FALSE(holds(wide, Comparison::less, "on", from_2_63));
  // More digits than a decimal has.
  wide.raw_min = 0;
  wide.raw_max = INT64_MAX;  // as specs have it, where there is no room for the bits
  CHECK(holds(wide, Comparison::equal, "18446744073709551615", -1));
  CHECK(holds(wide, Comparison::greater, "18446744073709551614", -1));
  CHECK_FALSE(holds(wide, Comparison::greater, "18446744073709551615", -1));
  CHECK_FALSE(holds(wide, Comparison::at_least, "18446744073709551614", 5));
  CHECK_FALSE(Condition::of(wide, Comparison::equal, "18446744073709551616").ok());
  auto whole = field();
  whole.position.width = 64;
  whole.scale = {1, 0};
  whole.raw_min = INT64_MIN;
  whole.raw_max = INT64_MAX;
  CHECK(holds(whole, Comparison::equal, "-9223372036854775808", INT64_MIN));
  CHECK(holds(whole, Comparison::less, "-9223372036854775807", INT64_MIN));
}

TEST_CASE("digits that a decimal has no room for are compared where the wire has the number itself alone") {
  auto wide = field(false);
  wide.position.width = 64;
  wide.raw_min = 0;
  wide.raw_max = INT64_MAX;
  wide.scale = {1, 0};
  CHECK(Condition::of(wide, Comparison::equal, "18446744073709551615").ok());
  wide.offset = {6, 0};
  CHECK(Condition::of(wide, Comparison::equal, "18446744073709551621").error.starts_with("x takes"));
  wide.offset = {};
  wide.scale = {1, -1};
  CHECK(Condition::of(wide, Comparison::equal, "1844674407370955161.5").error.starts_with("x takes"));
}

TEST_CASE("what is no value says what the field takes") {
  CHECK(Condition::of(field(), Comparison::equal, "fast").error ==
        "x takes off, on, or -3276.8 to 3276.7 m/s");
  CHECK(Condition::of(field(), Comparison::equal, "3kg").error.starts_with("x takes"));
  CHECK(Condition::of(field(), Comparison::equal, "m/s").error.starts_with("x takes"));
}

}  // namespace tool_words_condition_test
