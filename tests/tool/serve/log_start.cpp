#include "cli/serve/log_start.hpp"

#include <chrono>

#include <catch2/catch.hpp>

namespace serve_log_start_test {

using namespace std::chrono_literals;
using ocm::cli::Clock;
using ocm::cli::serve::LogStart;

constexpr Clock::time_point begin{1h};

TEST_CASE("log start: a log waits for who looks at it") {
  LogStart start;
  CHECK_FALSE(start.plays(false, 0, begin));
  CHECK_FALSE(start.plays(false, 0, begin + 1h));  // however long that takes
  CHECK_FALSE(start.plays(false, 1, begin + 1h));
  CHECK(start.plays(true, 1, begin + 1h));
  CHECK(start.plays(false, 0, begin + 2h));  // and goes on when it has gone
}

TEST_CASE("log start: a viewer that subscribes to nothing of it") {
  LogStart start;
  CHECK_FALSE(start.plays(false, 1, begin));
  CHECK_FALSE(start.plays(false, 1, begin + 999ms));
  CHECK_FALSE(start.plays(false, 0, begin + 1s));  // it has gone
  CHECK_FALSE(start.plays(false, 1, begin + 2s));
  CHECK_FALSE(start.plays(false, 2, begin + 2999ms));  // a second does not make the first wait longer
  CHECK(start.plays(false, 2, begin + 3s));
}

TEST_CASE("log start: a time bar begins it") {
  LogStart start;
  start.begin();
  CHECK(start.plays(false, 0, begin));
}

}  // namespace serve_log_start_test
