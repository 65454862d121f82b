// Names of specs and units, at the edges of what each may be.
#include "generator/spec/names.hpp"

#include <chrono>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "generator/spec/node_reader.hpp"

namespace generator_names_test {

using namespace ocm;

TEST_CASE("names: of a spec") {
  for (const char* name : {"a", "z", "a0", "a9", "a_b", "a1_2z", "sensor_1"}) {
    CAPTURE(name);
    CHECK(spec::is_name(name));
  }
  for (const char* name : {"",    "_",  "_a", "a_", "a__b", "0a", "9",  "A",  "aB", "aZ",      "a-b",
                           "a b", "a/", "a:", "a`", "`a",   "a{", "{a", "a@", "a[", "\xC3\xA4"}) {
    CAPTURE(name);
    CHECK_FALSE(spec::is_name(name));
  }
}

TEST_CASE("names: of a DBC file") {
  for (const char* word : {"a", "9", "a.b", "!", "~", "_", "5.a+b", "\xC3\xA4"}) {
    CAPTURE(word);
    CHECK(spec::is_word(word));
  }
  for (const char c : std::string_view{" \t\n\x01\x1F\x7F:;,|@()[]\""}) {
    CAPTURE(static_cast<int>(c));
    CHECK_FALSE(spec::is_word(std::string{"a"} + c + "b"));
  }
  CHECK_FALSE(spec::is_word(""));
}

TEST_CASE("names: words of C++") {
  for (const char* word : {"alignas", "int", "operator", "switch", "xor", "xor_eq", "linux", "errno"}) {
    CAPTURE(word);
    CHECK(spec::is_reserved(word));
  }
  for (const char* word : {"", "a", "alignat", "Int", "ints", "in", "zzz"}) {
    CAPTURE(word);
    CHECK_FALSE(spec::is_reserved(word));
  }
}

TEST_CASE("names: as types") {
  CHECK(spec::pascal_case("di_wheel_drive") == "DiWheelDrive");
  CHECK(spec::pascal_case("a") == "A");
  CHECK(spec::pascal_case("z_a_m") == "ZAM");
  CHECK(spec::pascal_case("a_1b") == "A1b");
  CHECK(spec::pascal_case("").empty());
}

TEST_CASE("names: of units") {
  struct Row {
    const char* unit;
    const char* name;
  };
  const Row rows[] = {{"m", "m"},
                      {"azAZ09_V", "azAZ09_V"},
                      {"deg/s", "deg_per_s"},
                      {"%", "percent"},
                      {"\u00b0C", "degC"},
                      {"\u00b5V", "uV"},
                      {"\u03bcs", "us"},
                      {"m\u00b2", "m2"},
                      {"m\u00b3", "m3"},
                      {"m/s^2", "m_per_s2"},
                      {"N*m", "N_m"},
                      {"N m", "N_m"},
                      {"N\u00b7m", "N_m"},
                      {"k\u03a9", "kohm"},
                      {"1/s", "1_per_s"},
                      {"/s", "per_s"},
                      {"m/", "m_per"},
                      {"", ""},
                      {"/", "per"},
                      {"*", ""},
                      {"m / s", ""},
                      {"a__b", ""},
                      {"m?", ""},
                      {"a@", ""},
                      {"a[", ""},
                      {"a`", ""},
                      {"a{", ""},
                      {"a:", ""},
                      {"\u20ac", ""}};
  for (const auto& [unit, name] : rows) {
    CAPTURE(unit);
    CHECK(spec::unit_name(unit) == name);
  }
}

TEST_CASE("names: of a duration's units the largest that it is a whole number of") {
  using namespace std::chrono_literals;
  const std::pair<base::Duration, const char*> rows[] = {{1ns, "1ns"},
                                                         {999ns, "999ns"},
                                                         {1001ns, "1001ns"},
                                                         {1us, "1us"},
                                                         {999us, "999us"},
                                                         {1'001us, "1001us"},
                                                         {1ms, "1ms"},
                                                         {13'334us, "13334us"},
                                                         {1'001ms, "1001ms"},
                                                         {1s, "1s"},
                                                         {65'535s, "65535s"},
                                                         {60s, "60s"},
                                                         {1'000'001us, "1000001us"},
                                                         {0ns, "0s"}};
  for (const auto& [duration, text] : rows) CHECK(spec::print(duration) == text);
}

TEST_CASE("names: the nearest has one edit, and one more for every three letters; the first of equals") {
  const auto nearest = [](std::string_view typed, const std::vector<std::string>& known) {
    return spec::nearest_name(typed, known);
  };
  CHECK(nearest("gyrscope", {"ring", "gyroscope"}) == "gyroscope");
  CHECK(nearest("cat", {"bat", "hat"}) == "bat");
  CHECK(nearest("ab", {"xb"}) == "xb");
  CHECK(nearest("ab", {"xy"}).empty());
  CHECK(nearest("abc", {"xyc"}) == "xyc");
  CHECK(nearest("abc", {"xyz"}).empty());
  CHECK(nearest("abcdef", {"xyzdef"}) == "xyzdef");
  CHECK(nearest("abcdef", {"wxyzef"}).empty());
  CHECK(nearest("abcd", {"abxx", "abcx"}) == "abcx");
  CHECK(nearest("abcd", {"abcx", "abxx"}) == "abcx");
  CHECK(nearest("abcd", {"abcd", "abcx"}) == "abcd");
  CHECK(nearest("abcd", {}).empty());
}

}  // namespace generator_names_test
