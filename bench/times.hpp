/// How long rounds of work took, and ways of doing it beside one another.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <vector>

namespace ocm::bench {

/// ns a frame, round after round.
class Times {
 public:
  template <class F>
  void round(std::size_t frames, F&& run) {
    const auto start = std::chrono::steady_clock::now();
    run();
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - start;
    ns_.push_back(took.count() / static_cast<double>(frames));
  }
  [[nodiscard]] double best() const { return *std::min_element(ns_.begin(), ns_.end()); }
  [[nodiscard]] double median() const {
    std::vector<double> sorted = ns_;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
  }

 private:
  std::vector<double> ns_;
};

/// `reference`: what the ratio is to.
inline void print(const char* what, const char* order, const char* name, const Times& times,
                  const Times& reference) {
  std::printf("%-7s %-9s %-13s median %6.2f  best %6.2f ns/frame  %5.2f x by hand\n", what, order, name,
              times.median(), times.best(), times.median() / reference.median());
}

}  // namespace ocm::bench
