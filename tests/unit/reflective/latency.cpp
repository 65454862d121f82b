#include "ocm/reflective/latency.hpp"

#include <catch2/catch.hpp>

namespace reflective_latency_test {

using namespace ocm;
using namespace ocm::reflective;

static_assert(LatencyPart{}.time == 0);

TEST_CASE("latency: the total is the sum of the parts, and settle is no part of it") {
  Latency latency{.bounded = true, .settle = 1'000};
  std::int64_t unit = 1;
  for (std::int64_t* part :
       {&latency.period, &latency.jitter, &latency.sampling, &latency.bus, &latency.reading, &latency.limit,
        &latency.window, &latency.lasting, &latency.timer, &latency.command}) {
    *part = unit;
    unit *= 2;
  }
  CHECK(latency.total() == 1023);
  CHECK(latency.at_worst() == 2023);
  latency.bounded = false;
  CHECK(latency.total() == analysis::unbounded);
  CHECK(latency.at_worst() == analysis::unbounded);
}

TEST_CASE("latency: before anything is known there is no bound, and all parts are zero") {
  CHECK_FALSE(Latency{}.bounded);
  CHECK_FALSE(Recovery{}.bounded);
  CHECK(Latency{.bounded = true}.at_worst() == 0);
  CHECK(Recovery{.bounded = true}.at_worst() == 0);
}

TEST_CASE("latency: so is that of a recovery") {
  Recovery recovery{.bounded = true, .settle = 1'000};
  std::int64_t unit = 1;
  for (std::int64_t* part :
       {&recovery.silence, &recovery.last, &recovery.retry, &recovery.timer, &recovery.request,
        &recovery.handling, &recovery.jitter, &recovery.sampling, &recovery.bus}) {
    *part = unit;
    unit *= 2;
  }
  CHECK(recovery.total() == 511);
  CHECK(recovery.at_worst() == 1511);
  recovery.bounded = false;
  CHECK(recovery.total() == analysis::unbounded);
  CHECK(recovery.at_worst() == analysis::unbounded);
}

TEST_CASE("latency: a sum that does not fit is no bound") {
  CHECK(Latency{.bounded = true, .period = INT64_MAX, .bus = 1}.total() == analysis::unbounded);
  CHECK(Latency{.bounded = true, .period = INT64_MAX - 1, .settle = 2}.at_worst() == analysis::unbounded);
  CHECK(Recovery{.bounded = true, .retry = INT64_MAX, .bus = 1}.total() == analysis::unbounded);
  CHECK(Recovery{.bounded = true, .retry = INT64_MAX - 1, .settle = 2}.at_worst() == analysis::unbounded);
}

}  // namespace reflective_latency_test
