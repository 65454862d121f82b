#include "cli/top/message_line.hpp"

#include <chrono>

#include <catch2/catch.hpp>

#include "cli/top/top.hpp"

namespace top_message_line_test {

using namespace std::chrono_literals;
using namespace ocm::cli::top;
using Time = std::chrono::steady_clock::time_point;

TEST_CASE("top: a message is in the last line for five seconds, and a newer one for five more") {
  MessageLine line;
  const Time begin{1h};
  CHECK_FALSE(line.shows(0, begin));
  CHECK(line.shows(1, begin + 1s));
  CHECK(line.shows(1, begin + 5999ms));
  CHECK_FALSE(line.shows(1, begin + 6s));
  CHECK(line.shows(2, begin + 7s));
  CHECK(line.shows(3, begin + 10s));
  CHECK(line.shows(3, begin + 14999ms));
  CHECK_FALSE(line.shows(3, begin + 15s));
}

TEST_CASE("top: ten pictures a second, twenty at most") {
  CHECK(TopOptions{}.interval * 10 == 1s);
  CHECK(shortest_interval * 20 == 1s);
}

}  // namespace top_message_line_test
