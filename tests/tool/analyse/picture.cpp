// Whose worst case a picture of a set draws.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "cli/analyse/report.hpp"
#include "cli/analyse/study.hpp"

namespace tool_analyse_picture_test {

using namespace ocm;
using namespace ocm::cli::analyse;

struct Given {
  const char* name;
  std::int64_t cost, period, deadline;
};

/// Of tasks, the most urgent first.
std::string drawn(const std::vector<Given>& tasks) {
  TaskSet set;
  for (const Given& given : tasks) {
    TaskEntry entry;
    entry.name = given.name;
    entry.task.cost = given.cost;
    entry.task.period = given.period;
    entry.task.deadline = given.deadline;
    entry.task.level = static_cast<std::uint32_t>(set.entries.size());
    set.entries.push_back(entry);
  }
  const std::string picture = to_svg(study_tasks(set, analysis::Processor{}));
  constexpr std::string_view title = ">Worst case of ";
  const auto at = picture.find(title);
  REQUIRE(at != std::string::npos);
  const auto begin = at + title.size();
  return picture.substr(begin, picture.find('<', begin) - begin);
}

TEST_CASE("picture: it is of what has the least left of its deadline, of several the most urgent one",
          "[shared]") {
  CHECK(drawn({{"a", 1, 10, 10}}) == "a");
  CHECK(drawn({{"a", 1, 10, 10}, {"b", 2, 20, 20}, {"c", 1, 40, 40}}) == "b");  // 1, 3 and 4
  CHECK(drawn({{"a", 1, 10, 10}, {"b", 1, 20, 20}}) == "a");                    // a tenth each
  CHECK(drawn({{"a", 1, 20, 20}, {"b", 1, 10, 10}, {"c", 1, 15, 15}}) == "b");  // b and c a fifth
}

TEST_CASE("picture: what has no bound goes before what is in time, and behind what is late by so much",
          "[shared]") {
  CHECK(drawn({{"a", 6, 10, 10}, {"b", 5, 10, 10}, {"c", 1, 10, 10}}) == "b");
  CHECK(drawn({{"a", 6, 10, 5}, {"b", 5, 10, 10}}) == "a");
  CHECK(drawn({{"a", 6, 10, 6}, {"b", 5, 10, 10}}) == "b");  // a just in time
}

}  // namespace tool_analyse_picture_test
