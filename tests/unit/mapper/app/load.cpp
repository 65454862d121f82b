#include "ocm/mapper/app/load.hpp"

#include <chrono>

#include <catch2/catch.hpp>

namespace mapper_app_load_test {

using namespace ocm;
using namespace std::chrono_literals;
using mapper::app::Load;

constexpr base::Time at(base::Duration time) {
  return base::Time{time};
}

TEST_CASE("mapper load: one job after the other", "[mapper_load]") {
  Load load;
  const auto first = load.begin(at(10ms));
  load.end(first, at(12ms));
  const auto second = load.begin(at(20ms));
  load.end(second, at(25ms));
  CHECK(load.busy() == 7ms);
}

TEST_CASE("mapper load: a job that was preempted counts without those in between", "[mapper_load]") {
  Load load;
  const auto low = load.begin(at(0ms));  // 0 to 10, of which 2 to 5 and 6 to 7 are others'
  const auto high = load.begin(at(2ms));
  const auto urgent = load.begin(at(3ms));
  load.end(urgent, at(4ms));
  load.end(high, at(5ms));
  const auto again = load.begin(at(6ms));
  load.end(again, at(7ms));
  load.end(low, at(10ms));
  CHECK(load.busy() == 10ms);
}

TEST_CASE("mapper load: a clock that goes back takes nothing away", "[mapper_load]") {
  Load load;
  load.end(load.begin(at(10ms)), at(9ms));
  CHECK(load.busy() == 0ms);
}

}  // namespace mapper_app_load_test
