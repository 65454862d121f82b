#include "cli/words/value.hpp"

#include <algorithm>
#include <random>
#include <string>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "ocm/can/text.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/words/command.hpp"
#include "tests/unit/base/explore.hpp"

namespace tool_words_value_test {

using namespace ocm;
using namespace ocm::cli::words;

/// An actuator to drive whose fields have the scales that a test gives them.
struct Motors {
  explicit Motors(base::Decimal x_scale, base::Decimal z_scale, std::int64_t greatest = INT32_MAX)
      : fields{{{"z",
                 {32, 32, protocol::ByteOrder::little},
                 true,
                 z_scale,
                 {},
                 "rad/s",
                 -greatest,
                 greatest,
                 {}},
                {"x",
                 {0, 32, protocol::ByteOrder::little},
                 true,
                 x_scale,
                 {},
                 "m/s",
                 -greatest,
                 greatest,
                 {}}}} {
    frame.id = protocol::TopicId{0x01};
    frame.length = 8;
    frame.fields = fields;
    topic.name = "motors";
    topic.id = frame.id;
    topic.kind = protocol::Kind::actuator;
    topic.role = protocol::Role::drive;
    topic.frames = {&frame, 1};
    catalogue.robot = "any";
    catalogue.topics = {&topic, 1};
  }
  Motors(const Motors&) = delete;

  [[nodiscard]] auto parse(std::vector<std::string> words) const {
    const std::vector<std::string_view> views{words.begin(), words.end()};
    return CommandParser{catalogue}.parse(views, {});
  }

  std::array<protocol::Field, 2> fields;  // z first: a field is found by its name
  protocol::FrameLayout frame;
  protocol::Topic topic;
  protocol::Catalogue catalogue;
};

std::string text(base::Decimal number) {
  return std::string{base::to_text(number).view()};
}

TEST_CASE("a typed number means the same whatever the scale on the wire, in drive and in set") {
  std::mt19937_64 random{27};
  const auto between = [&random](std::int64_t low, std::int64_t high) {
    return std::uniform_int_distribution<std::int64_t>{low, high}(random);
  };
  for (int i = 0; i < test::explored(2000); ++i) {
    const auto scale = [&between] {
      return base::normalised(between(1, 9999), static_cast<int>(between(-9, -3)));
    };
    const Motors motors{scale(), scale()};
    const protocol::Field& x = motors.fields[1];
    const protocol::Field& z = motors.fields[0];
    const std::int64_t x_raw = between(-1'000'000, 1'000'000);
    const std::int64_t z_raw = between(-1'000'000, 1'000'000);
    const base::Decimal x_value = *x.physical(x_raw);
    const base::Decimal z_value = *z.physical(z_raw);
    CAPTURE(text(x.scale), text(z.scale), text(x_value), text(z_value));
    const auto typed = [](base::Decimal value, int shift, const char* unit) {
      return text(*base::multiply(value, {1, static_cast<std::int8_t>(shift)})) + unit;
    };

    const auto driven = motors.parse({"drive", typed(x_value, 0, "m/s"), typed(z_value, 3, "mrad/s")});
    const auto set =
        motors.parse({"set", "motors", "x=" + typed(x_value, 6, "um/s"), "z=" + typed(z_value, 0, "rad/s")});
    REQUIRE(driven.ok());
    REQUIRE(set.ok());
    CHECK(driven->frames == set->frames);
    CHECK(driven->hold->frame == driven->frames[0]);
    CHECK(x.raw(driven->frames[0].data) == x_raw);
    CHECK(z.raw(driven->frames[0].data) == z_raw);

    // A bare number is refused everywhere, but zero.
    const std::string bare = text(x_value);
    CHECK(motors.parse({"drive", bare}).ok() == (x_raw == 0));
    CHECK(motors.parse({"drive", "0", text(z_value)}).ok() == (z_raw == 0));
    CHECK(motors.parse({"set", "motors", "x=" + bare}).ok() == (x_raw == 0));
    CHECK(motors.parse({"set", "motors", "z=" + text(z_value)}).ok() == (z_raw == 0));
  }
}

TEST_CASE("the refusal of a bare number names the units") {
  const Motors motors{{1, -3}, {1, -3}, 1000};
  const auto drive = motors.parse({"drive", "500"});
  CHECK(drive.error.what == "'500' needs a unit: x takes -1 to 1 m/s");
  CHECK(drive.error.remedy == "write 0.05m/s, 5cm/s or 50000um/s");
  const auto turn = motors.parse({"drive", "5cm/s", "1"});
  CHECK(turn.error.word == 2);
  CHECK(turn.error.what == "'1' needs a unit: z takes -1 to 1 rad/s");
  CHECK(turn.error.remedy == "write 0.2rad/s or 30deg/s");
  const auto set = motors.parse({"set", "motors", "x=1"});
  CHECK(set.error.what == "'1' needs a unit: x takes -1 to 1 m/s");
  CHECK(set.error.remedy == "for example x=1m/s");
  CHECK(motors.parse({"drive", "0", "-0.0"}).ok());
  CHECK(motors.parse({"set", "motors", "x=0"}).ok());
}

TEST_CASE("beyond its range a velocity is refused with its limits") {
  const Motors motors{{1, -3}, {1, -3}, 1000};
  CHECK(motors.parse({"drive", "2000m/s"}).error.what == "'2000m/s' is out of range: x takes -1 to 1 m/s");
  CHECK(motors.parse({"drive", "1m/s", "-1rad/s"}).ok());
  CHECK_FALSE(motors.parse({"drive", "1001mm/s"}).ok());
  CHECK_FALSE(motors.parse({"set", "motors", "z=-1001mrad/s"}).ok());
}

TEST_CASE("zero needs a unit where the unit has an offset") {
  protocol::Field field{
      "target", {0, 16, protocol::ByteOrder::little}, true, {1, -1}, {-27315, -2}, "degC", 0, 4000, {}};
  CHECK_THAT(parse_typed_value(field, "0").error, Catch::Contains("'0' needs a unit"));
  CHECK(parse_typed_value(field, "0degC") == parse_value(field, "0"));
  CHECK(parse_typed_value(field, "0degC").ok());
}

TEST_CASE("hexadecimal digits mean what the number in decimal ones does") {
  protocol::Field field{"service", {0, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}};
  CHECK(parse_typed_value(field, "0x22") == 0x22);
  CHECK(parse_typed_value(field, "0XfF") == 0xFF);
  CHECK(parse_typed_value(field, "0x0") == 0);
  CHECK(parse_typed_value(field, "0x100").error == "'256' is out of range: service takes 0 to 255");
  for (const char* bad : {"0x", "0xG", "-0x1", "0x 1", "0x11111111111111111"})
    CHECK_FALSE(parse_typed_value(field, bad).ok());
  CHECK(parse_typed_value(field, "0xG").error ==
        "'0xG' is no hexadecimal number of 64 bits: service takes 0 to 255");
  field.scale = {5, -1};
  CHECK(parse_value(field, "0x22") == 68);
  field.unit = "V";
  CHECK_THAT(parse_typed_value(field, "0x22").error, Catch::Contains("needs a unit"));
  CHECK(parse_typed_value(field, "0x0") == 0);
  constexpr protocol::NamedValue names[] = {{7, "0x22"}};
  field.values = names;  // a name, where it is no number that the field can be
  CHECK(parse_typed_value(field, "0x22") == 7);
  protocol::Field wide{"word", {0, 64, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, INT64_MAX, {}};
  CHECK(parse_value(wide, "0xFFFFFFFFFFFFFFFF") == -1);
}

TEST_CASE("a unit that begins like a number is read, too") {
  protocol::Field field{"speed", {0, 16, protocol::ByteOrder::little}, true, {1, 0}, {}, "1/min", -900, 900,
                        {}};
  CHECK(parse_typed_value(field, "5001/min") == 500);
  CHECK(parse_typed_value(field, "-5.01/min") == -5);
  CHECK_FALSE(parse_typed_value(field, "500").ok());
}

TEST_CASE("a number without a unit stays one") {
  const auto& red = amiro::catalogue.find("led_1")->frames[0].fields[0];
  CHECK(parse_typed_value(red, "200") == 200);
  const auto& action = amiro::catalogue.find("floor_calibration")->frames[0].fields[0];
  CHECK(parse_typed_value(action, "measure") == parse_value(action, "measure"));
}

TEST_CASE("of a count or a code there are no fractions") {
  const auto& red = amiro::catalogue.find("led_1")->frames[0].fields[0];
  const auto& action = amiro::catalogue.find("floor_calibration")->frames[0].fields[0];
  CHECK(parse_value(red, "1.5").error == "'1.5' is no whole number: red takes 0 to 255");
  CHECK(parse_value(action, "0.5").error.starts_with("'0.5' is no whole number: action takes "));
  CHECK(parse_value(red, "-0.4").error.starts_with("'-0.4' is no whole number"));
  CHECK(parse_value(red, "1.0") == 1);
  CHECK(parse_value(red, "20e1") == 200);
  // Of what is measured the nearest is meant.
  const auto& x = amiro::catalogue.find("motors")->frames[0].fields[0];
  CHECK(parse_value(x, "0.0000014") == 1);
  protocol::Field field{"count", {0, 16, protocol::ByteOrder::little}, true, {1, 0}, {}, "1/min", -900, 900,
                        {}};
  CHECK(parse_value(field, "1.5") == 2);
  field.unit = {};
  CHECK_FALSE(parse_value(field, "1.5").ok());
  field.offset = {5, -1};
  CHECK(parse_value(field, "1.5") == 1);
  field.offset = {};
  field.scale = {5, -1};
  CHECK(parse_value(field, "1.5") == 3);
}

TEST_CASE("a number with more digits than a Decimal has is a raw number all the same") {
  const auto has = [](const std::string& text, std::string_view part) {
    return text.find(part) != std::string::npos;
  };
  protocol::Field word{"word", {0, 64, protocol::ByteOrder::little}, false, {1, 0}, {}, "s", 0, INT64_MAX,
                       {}};
  CHECK(has(parse_value(word, "-1").error, "word takes 0 to 18446744073709551615 s"));
  CHECK(parse_value(word, "18446744073709551615") == -1);
  CHECK(parse_value(word, "18446744073709551615 s") == -1);
  CHECK(parse_value(word, "9223372036854775808s") == INT64_MIN);
  CHECK_FALSE(parse_value(word, "18446744073709551616").ok());
  CHECK_FALSE(parse_value(word, "-1").ok());
  CHECK_FALSE(parse_value(word, "18446744073709551615m").ok());
  CHECK_FALSE(parse_value(word, std::string(60, '9')).ok());
  word.raw_max = 10;  // a range that is stated
  CHECK(has(parse_value(word, "11").error, "word takes 0 to 10 s"));
  word.raw_max = INT64_MAX;
  word.scale = {123, -3};
  CHECK(has(parse_value(word, "-1").error, "word takes 0 to 2.26894952106627e+18 s"));
  CHECK(parse_value(word, "2268949521066274848.645") == -1);
  CHECK(parse_value(word, "2268949521066274848.6") == -1);  // the nearest
  word.scale = {-1, 2};
  word.offset = {5, -1};
  CHECK(parse_value(word, "-1844674407370955161499.5") == -1);
  protocol::Field number{
      "n", {0, 64, protocol::ByteOrder::little}, true, {123457, -9}, {}, "", INT64_MIN, INT64_MAX, {}};
  CHECK(parse_value(number, "-1138689841553980.056928256") == INT64_MIN);
  CHECK(parse_value(number, "1138689841553980.056804799") == INT64_MAX);
  number.raw_max = 1'000'000'000'000'000'000;  // a range that is stated
  CHECK_FALSE(parse_value(number, "1138689841553980.056804799").ok());
}

TEST_CASE("what a field takes is said with its range, or by its law") {
  protocol::Field field{"n", {0, 8, protocol::ByteOrder::little}, false, {5, -1}, {}, "", 0, 255, {}};
  CHECK(detail::takes(field) == "n takes 0 to 127.5");
  field.unit = "V";
  field.min = {1, 0};
  field.max = {100, 0};
  CHECK(detail::takes(field) == "n takes 1 to 100 V");
  constexpr protocol::NamedValue names[] = {{0, "off"}, {1, "on"}};
  field.values = names;
  CHECK(detail::takes(field) == "n takes off, on, or 1 to 100 V");
  field.flags = true;
  CHECK(detail::takes(field) == "n takes 1 to 100 V");
  field = {"f", {0, 32, protocol::ByteOrder::little}, false, {1, 0}, {}, "m", 0, 0, {}};
  field.number = protocol::Number::float32;
  CHECK(detail::takes(field) == "f takes any number m");
  field.min = {-1, 0};
  field.max = {25, -1};
  CHECK(detail::takes(field) == "f takes -1 to 2.5 m");
  const auto ring = amiro::catalogue.find("ring")->frames[0].values();
  const auto distance =
      std::find_if(ring.begin(), ring.end(), [](const protocol::Field& each) { return each.is_derived(); });
  REQUIRE(distance != ring.end());
  CHECK(detail::takes(*distance) == "distance is 0.0038 to 0.2 m");
}

TEST_CASE("the near name of a value is found whatever the case of each letter is, from A to Z") {
  constexpr protocol::NamedValue names[] = {{0, "zero"}, {1, "alpha"}};
  protocol::Field field{"n", {0, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}};
  field.values = names;
  CHECK(detail::near_name(field, "ZERRO") == "did you mean 'zero'? ");
  CHECK(detail::near_name(field, "ALPA") == "did you mean 'alpha'? ");
  CHECK(detail::near_name(field, "GAMMA").empty());
}

TEST_CASE("a float is read with its unit or without, in another unit, and no further than it goes") {
  protocol::Field field{"f", {0, 32, protocol::ByteOrder::little}, false, {1, 0}, {}, "m", 0, 0, {}};
  field.number = protocol::Number::float32;
  const auto value = [&field](std::string_view typed) {
    const auto raw = parse_value(field, typed);
    return raw.ok() ? text(*base::parse_decimal(fmt::format("{}", field.value(*raw)))) : raw.error;
  };
  CHECK(value("1.5") == "1.5");
  CHECK(value("+1.5 m") == "1.5");
  CHECK(value("25cm") == "0.25");
  CHECK(value("1e39") == "'1e39' is out of range: f takes any number m");
  CHECK(value("1e999") == "'1e999' is out of range: f takes any number m");
  CHECK(value("1.5s") == "'1.5s' is in another unit: f takes any number m");
  CHECK(value("1.5x5") == "'1.5x5' is in another unit: f takes any number m");
  CHECK(value("fast") == "'fast' is not a number: f takes any number m");
  CHECK_FALSE(parse_typed_value(field, "1.5").ok());
  CHECK(parse_typed_value(field, "1.5m").ok());
}

}  // namespace tool_words_value_test
