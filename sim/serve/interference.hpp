/// Interference on a simulated wire: single bits at random, at no moment more likely than at another.
#pragma once

#include <chrono>
#include <cstdint>
#include <random>

#include "ocm/base/time.hpp"
#include "ocm/simulation/arbiter.hpp"

namespace ocm::sim {

class Interference {
 public:
  Interference(double bits_per_second, std::uint64_t seed)
      : random_(seed), seconds_(bits_per_second > 0 ? bits_per_second : 1), on_(bits_per_second > 0) {
    if (on_) step();
  }
  /// Disturbs what lies within a second from `now`, what the bus has come to: always ahead of what it has
  /// done, and never further, however late it is.
  void disturb(simulation::Arbiter& bus, base::Time now) {
    for (; on_ && next_ <= now + std::chrono::seconds{1}; step())
      bus.disturb({bus.clock().boundary_from(next_), flag_bits_(random_)});
  }

 private:
  void step() { next_ += base::Duration{static_cast<std::int64_t>(seconds_(random_) * 1e9) + 1}; }

  std::mt19937_64 random_;
  std::exponential_distribution<> seconds_;
  std::uniform_int_distribution<unsigned> flag_bits_{simulation::shortest_flag_bits,
                                                     simulation::longest_flag_bits};
  bool on_;
  base::Time next_{};
};

}  // namespace ocm::sim
