#include "cli/top/short_number.hpp"

#include <random>

#include <catch2/catch.hpp>

namespace top_short_number_test {

using namespace ocm::cli::top;
using namespace std::chrono_literals;

TEST_CASE("top: times and numbers in six columns") {
  CHECK(short_time(0s) == "0us");
  CHECK(short_time(999us) == "999us");
  CHECK(short_time(1ms) == "1.0ms");
  CHECK(short_time(9'900us) == "9.9ms");
  CHECK(short_time(10ms) == "10ms");
  CHECK(short_time(999ms) == "999ms");
  CHECK(short_time(1s) == "1.0s");
  CHECK(short_time(99s) == "99.0s");
  CHECK(short_time(100s) == "2m");
  CHECK(short_time(2h) == "2h");
  CHECK(short_time(240h) == "10d");
  CHECK(short_time(-5ms) == "-5.0ms");
  CHECK(short_number(0.5) == "0.50");
  CHECK(short_number(10) == "10.0");
  CHECK(short_number(1000) == "1000");
  CHECK(short_number(999'999) == "999999");
  CHECK(short_number(1.5e6) == "1500k");
  std::mt19937_64 random{3};
  for (int i = 0; i < 20'000; ++i) {
    const auto ns = static_cast<std::int64_t>(random() >> (2 + random() % 62));
    REQUIRE(short_time(ocm::base::Duration{ns}).size() <= 7);
    REQUIRE(short_number(static_cast<double>(ns % 100'000'000) / 1000).size() <= 6);
  }
}

TEST_CASE("top: times and numbers at the ends of each unit") {
  using ocm::base::Duration;
  const auto before_and_at = [](Duration end) { return short_time(end - 1ns) + " " + short_time(end); };
  CHECK(before_and_at(999'500ns) == "999us 1.0ms");
  CHECK(before_and_at(9'950us) == "9.9ms 10ms");
  CHECK(before_and_at(999'500us) == "999ms 1.0s");
  CHECK(before_and_at(99'500ms) == "99.5s 2m");
  CHECK(before_and_at(99min + 30s) == "99m 2h");
  CHECK(before_and_at(99h + 30min) == "99h 4d");
  CHECK(short_number(9.994) == "9.99");
  CHECK(short_number(9.995) == "10.0");
  CHECK(short_number(999.94) == "999.9");
  CHECK(short_number(999.95) == "1000");
  CHECK(short_number(999'999.4) == "999999");
  CHECK(short_number(999'999.5) == "1000k");
}

TEST_CASE("top: a share that is too small for a digit is not nothing") {
  CHECK(percent(0) == "0.0%");
  CHECK(percent(0.0004) == "<0.1%");
  CHECK(percent(0.0005) == "0.1%");
  CHECK(percent(1) == "100.0%");
}

}  // namespace top_short_number_test
