// What is said of a study: which release is the worst, times, and the load.
#include <cstddef>
#include <string>
#include <utility>

#include <catch2/catch.hpp>

#include "cli/analyse/study.hpp"

namespace tool_analyse_explanation_test {

using namespace ocm;
using namespace ocm::cli::analyse;

/// Of the release of this number, from 1, of 200.
std::string explained(std::size_t release) {
  Row row;
  row.name = "a";
  row.cost = 2;
  row.period = 10;
  row.result.response = 5;
  row.result.deadline = 10;
  row.result.reason = analysis::Reason::schedulable;
  row.result.instance = release - 1;
  row.result.instances = 200;
  Study study;
  study.kind = Study::Kind::tasks;
  study.rows.push_back(row);
  return explain(study, 0);
}

TEST_CASE("explanation: which release of several is the worst, where it is not the first", "[shared]") {
  const std::string first = "ends 5ns before its deadline: takes 2ns";
  CHECK(explained(1) == first);
  using Named = std::pair<std::size_t, const char*>;
  for (const auto& [number, name] :
       {Named{2, "2nd"}, Named{3, "3rd"}, Named{4, "4th"}, Named{10, "10th"}, Named{11, "11th"},
        Named{12, "12th"}, Named{13, "13th"}, Named{14, "14th"}, Named{20, "20th"}, Named{21, "21st"},
        Named{22, "22nd"}, Named{23, "23rd"}, Named{24, "24th"}, Named{101, "101st"}, Named{103, "103rd"},
        Named{111, "111th"}, Named{113, "113th"}, Named{123, "123rd"}})
    CHECK(explained(number) == first + "; the " + name +
                                   " of 200 releases in a row is the worst, its wait counted from the first");
}

TEST_CASE("explanation: a time is in the largest unit of which there is one", "[shared]") {
  CHECK(time_text(0) == "0s");
  CHECK(time_text(1) == "1ns");
  CHECK(time_text(999) == "999ns");
  CHECK(time_text(1'000) == "1us");
  CHECK(time_text(999'999) == "999.999us");
  CHECK(time_text(1'000'000) == "1ms");
  CHECK(time_text(999'999'999) == "999.999999ms");
  CHECK(time_text(1'000'000'000) == "1s");
  CHECK(time_text(-1) == "-1ns");
  CHECK(time_text(-1'500) == "-1.5us");
}

TEST_CASE("explanation: a load is said to a millionth where 63 bits hold no fraction of it", "[shared]") {
  Study study;
  study.load.add(1, 4);
  CHECK(study.utilisation() == 0.25);
  // Periods without a common factor: a quarter more each, but for some billionths.
  study.load.add(1'000'000'000, 4'000'000'007);
  study.load.add(1'000'000'000, 4'000'000'009);
  REQUIRE(study.load.denominator() == 0);
  CHECK(study.utilisation() == Approx(0.75).margin(2e-6));
}

}  // namespace tool_analyse_explanation_test
