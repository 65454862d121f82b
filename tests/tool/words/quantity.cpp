#include "cli/words/quantity.hpp"

#include <utility>

#include <catch2/catch.hpp>

namespace tool_words_quantity_test {

using namespace ocm;
using namespace ocm::cli::words;
using namespace std::chrono_literals;

constexpr base::Duration duration(std::string_view text) {
  return parse_duration(text).value;
}
static_assert(duration("500ms") == 500ms);
static_assert(duration("900us") == 900us);
static_assert(duration("900\u00b5s") == 900us);
static_assert(duration("900\u03bcs") == 900us);  // the Greek letter, which keyboards have, too
static_assert(duration("7ns") == 7ns);
static_assert(duration("3h") == 3h);
static_assert(duration("-2min") == -120s);
static_assert(duration("0.000000001s") == 1ns);
static_assert(duration("1.5s") == 1500ms);
static_assert(duration(".5s") == 500ms);
static_assert(duration("1e3ms") == 1s);
static_assert(duration("2min") == 120s);
static_assert(duration("0s") == 0s);
static_assert(parse_duration("500").error == base::Error::bad_unit);
static_assert(parse_duration("500mss").error == base::Error::bad_unit);
static_assert(parse_duration("").error == base::Error::bad_syntax);
static_assert(parse_duration("ms").error == base::Error::bad_syntax);
static_assert(parse_duration("e3s").error == base::Error::bad_syntax);
static_assert(parse_quantity("1e").value.unit == "e");
static_assert(parse_quantity("1e-").value.unit == "e-");
static_assert(parse_quantity("1e3e5").value.unit == "e5");
static_assert(parse_quantity("+2E-1W").value.unit == "W");
static_assert(duration("500 ms") == 500ms);  // as one word, from a config file or in quotes
static_assert(parse_quantity("5  s").value.unit == " s");
static_assert(parse_quantity("5 ").value.unit == " ");
static_assert(parse_quantity(" 5").error == base::Error::bad_syntax);
static_assert(parse_duration("1.5ns").error == base::Error::out_of_range);
static_assert(parse_duration("99999999999h").error == base::Error::out_of_range);

std::string converted(std::string_view text, std::string_view unit) {
  const auto quantity = parse_quantity(text);
  REQUIRE(quantity.ok());
  const auto result = convert(*quantity, unit);
  if (!result) return std::string{base::describe(result.error)};
  return std::string{base::to_text(*result).view()};
}

TEST_CASE("units of the same kind convert exactly") {
  CHECK(converted("5cm/s", "m/s") == "0.05");
  CHECK(converted("5 cm/s", "m/s") == "0.05");
  CHECK(converted("-.1m/s", "m/s") == "-0.1");
  CHECK(converted("50000um/s", "m/s") == "0.05");
  CHECK(converted("3mrad", "rad") == "0.003");
  CHECK(converted("0.001km", "m") == "1");
  CHECK(converted("7", "m/s") == "7");  // bare: already in the field's unit
  CHECK(converted("-930mW", "W") == "-0.93");
  CHECK(converted("7nm", "um") == "0.007");
  CHECK(converted("5dm", "cm") == "50");
  CHECK(converted("3\u00b5m", "nm") == "3000");
  CHECK(converted("3\u03bcm", "nm") == "3000");
  CHECK(converted("2l", "L") == "2");
}

TEST_CASE("units per second, minute and hour convert") {
  CHECK(converted("36km/h", "m/s") == "10");
  CHECK(converted("10m/s", "km/h") == "36");
  CHECK(converted("355555555.64444412km/h", "m/s") == "98765432.1234567");  // more digits than a double has
  CHECK(converted("1km/h", "m/s") == "0.277777778");                        // no end: to a billionth
  CHECK(converted("3krpm", "rpm") == "3000");
  CHECK(converted("3000rpm", "1/min") == "3000");
  CHECK(converted("3000U/min", "rpm") == "3000");
  CHECK(converted("50kph", "km/h") == "50");
  CHECK(converted("60mph", "km/h") == "96.56064");
  CHECK(converted("1l/min", "l/h") == "60");
  CHECK(converted("6deg/min", "deg/s") == "0.1");
  CHECK(converted("90\u00b0", "deg") == "90");
}

TEST_CASE("units that are so many of others convert") {
  CHECK(converted("2min", "s") == "120");
  CHECK(converted("90s", "min") == "1.5");
  CHECK(converted("1.5h", "min") == "90");
  CHECK(converted("2.5bar", "kPa") == "250");
  CHECK(converted("101.3kPa", "bar") == "1.013");
  CHECK(converted("1013hPa", "mbar") == "1013");
  CHECK(converted("1.5MW", "kW") == "1500");
  CHECK(converted("2.5kNm", "Nm") == "2500");
}

TEST_CASE("degrees and radians convert to a billionth") {
  CHECK(converted("180deg/s", "rad/s") == "3.141592654");
  CHECK(converted("-30deg/s", "rad/s") == "-0.523598776");
  CHECK(converted("1rad/s", "deg/s") == "57.295779513");
}

TEST_CASE("units of another kind are refused") {
  for (const auto& [text, unit] : {std::pair{"3Hz", "rpm"},
                                   {"3rpm", "deg/s"},
                                   {"3mkm", "m"},
                                   {"3kmin", "s"},
                                   {"20degC", "K"},
                                   {"3rpm/s", "rpm"}}) {
    CAPTURE(text, unit);
    CHECK(converted(text, unit) == base::describe(base::Error::bad_unit));
  }
  for (const char* text : {"5m", "5m/day", "5G/s", "5furlong", "5mm/s/s", "5s"}) {
    CAPTURE(text);
    CHECK(converted(text, "m/s") == base::describe(base::Error::bad_unit));
  }
}

TEST_CASE("the period of a rate is one to a nanosecond, from one in 30 years to 1 GHz") {
  const auto nanoseconds = [](std::string_view text) {
    const auto period = period_of_rate(text);
    return period ? period->count() : -1;
  };
  CHECK(nanoseconds("20Hz") == 50'000'000);
  CHECK(nanoseconds("20 Hz") == 50'000'000);
  CHECK(nanoseconds("1.5kHz") == 666'667);
  CHECK(nanoseconds("3kHz") == 333'333);
  CHECK(nanoseconds("1000000kHz") == 1);
  CHECK(nanoseconds("0.001Hz") == 1'000'000'000'000);
  CHECK(nanoseconds("0.000000001Hz") == 1'000'000'000'000'000'000);
  for (const char* text : {"0Hz", "-5Hz", "1000000001Hz", "0.0000000009Hz", "20", "20s", "20MHz", "Hz", ""}) {
    CAPTURE(text);
    CHECK_FALSE(period_of_rate(text));
  }
}

TEST_CASE("durations print in the largest exact unit") {
  CHECK(to_text(base::Duration{500ms}) == "500ms");
  CHECK(to_text(base::Duration{1500ms}) == "1.5s");
  CHECK(to_text(base::Duration{900us}) == "900us");
  CHECK(to_text(base::Duration{65'535s}) == "65535s");
  CHECK(to_text(base::Duration{1'234'567us}) == "1234.567ms");
  CHECK(to_text(base::Duration{0}) == "0s");
  CHECK(to_text(base::Duration{-20ms}) == "-20ms");
  CHECK(to_text(base::Duration{1}) == "1ns");
}

TEST_CASE("every duration reads back as it was printed") {
  for (std::int64_t ns = 1; ns < 4'000'000'000'000'000; ns = ns * 3 + 7) {
    const base::Duration duration{ns};
    CAPTURE(ns, to_text(duration));
    REQUIRE(parse_duration(to_text(duration)) == base::Result<base::Duration>{duration});
  }
}

}  // namespace tool_words_quantity_test
