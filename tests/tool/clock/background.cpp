// Work that an operator leaves to another thread.
#include "cli/operate/background.hpp"

#include <future>
#include <vector>

#include <catch2/catch.hpp>

namespace tool_clock_background_test {

using ocm::cli::operate::Background;

TEST_CASE("background: so much waits, in order; more is refused, and all that was taken is done") {
  std::promise<void> begun, goes_on;
  std::vector<int> done;
  {
    Background background{2};
    REQUIRE(background.post([&] {
      begun.set_value();
      goes_on.get_future().wait();
      done.push_back(0);
    }));
    begun.get_future().wait();
    CHECK(background.post([&] { done.push_back(1); }));
    CHECK(background.post([&] { done.push_back(2); }));
    CHECK_FALSE(background.post([&] { done.push_back(3); }));
    goes_on.set_value();
  }
  CHECK(done == std::vector<int>{0, 1, 2});
}

}  // namespace tool_clock_background_test
