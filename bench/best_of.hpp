/// The least time of several runs: what other load disturbs least.
#pragma once

#include <algorithm>
#include <chrono>
#include <limits>

namespace ocm::bench {

/// Microseconds of the fastest of `times` runs of what().
template <class What>
double best_of(int times, What what) {
  using Clock = std::chrono::steady_clock;
  double least = std::numeric_limits<double>::max();
  for (int i = 0; i < times; ++i) {
    const auto start = Clock::now();
    what();
    least = std::min(least, std::chrono::duration<double, std::micro>(Clock::now() - start).count());
  }
  return least;
}

}  // namespace ocm::bench
