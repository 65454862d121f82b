// Whose worst case a picture of a set draws, and how much of it.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
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
std::string picture_of(const std::vector<Given>& tasks) {
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
  return to_svg(study_tasks(set, analysis::Processor{}));
}

/// Of frames of 8 bytes, 135 us each, the most urgent first; their periods in us.
std::string picture_of_bus(const std::vector<std::int64_t>& periods) {
  BusSet set;
  for (const std::int64_t period : periods) {
    BusEntry entry;
    entry.name = std::string(1, static_cast<char>('a' + set.entries.size()));
    entry.head.id = static_cast<std::uint32_t>(set.entries.size() + 1);
    entry.head.length = 8;
    entry.period = period * 1000;
    set.entries.push_back(std::move(entry));
  }
  BusOptions options;
  options.bit_rate = 1'000'000;
  return to_svg(study_bus(set, options));
}

/// Whose worst case it is.
std::string whose(const std::string& picture) {
  constexpr std::string_view title = ">Worst case of ";
  const auto at = picture.find(title);
  REQUIRE(at != std::string::npos);
  const auto begin = at + title.size();
  return picture.substr(begin, picture.find('<', begin) - begin);
}
std::string drawn(const std::vector<Given>& tasks) {
  return whose(picture_of(tasks));
}

std::size_t count_of(const std::string& text, std::string_view part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
  return count;
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

TEST_CASE("picture: what blocks it is drawn where it has a bound", "[shared]") {
  constexpr std::string_view grey = "fill=\"#bbb\"";
  const std::string bounded = picture_of_bus({300, 1000});  // 270 of 300 us, behind b
  CHECK(whose(bounded) == "a");
  CHECK(count_of(bounded, grey) == 1);
  const std::string unbounded = picture_of_bus({300, 200, 1000});  // 112.5 %, and c is less urgent
  CHECK(whose(unbounded) == "b");
  CHECK(count_of(unbounded, "no bound</text>") == 2);
  CHECK(count_of(unbounded, grey) == 0);
}

TEST_CASE("picture: it has 3000 pieces at most", "[shared]") {
  std::vector<Given> tasks(40, Given{"often", 1, 50, 50});
  tasks.push_back({"long", 1900, 10'000, 10'000});
  // 9500 ns and an eighth, 200 of the shortest periods at most: in each the others, and a piece of its own.
  const std::string picture = picture_of(tasks);
  CHECK(whose(picture) == "long");
  CHECK_THAT(picture, Catch::Contains("9.5us of 10us, 500ns left"));
  CHECK(count_of(picture, "height=\"14\"") == 3000);
}

}  // namespace tool_analyse_picture_test
