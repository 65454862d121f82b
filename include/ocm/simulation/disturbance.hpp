/// Bits that the nodes of a bus see wrong, told before they happen, and how long the frames are by which
/// nodes tell each other. Host side: memory is taken for each disturbance that lies ahead. `push` costs
/// O(log n) when they come in order.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>

#include "ocm/can/length.hpp"

namespace ocm::simulation {

/// Six dominant bits of the node that sees the error first; the others answer with six of their own, at the
/// latest when these six are over. Overload flags are as long. [ISO 11898-1, error frame, overload frame]
inline constexpr unsigned shortest_flag_bits = 6;
inline constexpr unsigned longest_flag_bits = 12;
/// Recessive bits after the flags.
inline constexpr unsigned delimiter_bits = 8;
/// Equal bits in a row that make a stuff error.
inline constexpr unsigned stuff_error_bits = 6;

/// One bit is seen wrong: by all nodes at once (flags of 6 bits together), or by some, which tell the others
/// (up to 12).
struct Disturbance {
  std::uint64_t boundary = 0;  ///< at which the bit begins
  unsigned flag_bits =
      shortest_flag_bits;  ///< of all flags together, 6 to 12; others are taken as the nearest
  /// From the disturbed bit on: until a frame can start again. `bit`: boundaries in a bit.
  [[nodiscard]] constexpr std::uint64_t over(std::uint64_t bit = 1) const noexcept {
    return boundary + bit * (1 + std::clamp(flag_bits, shortest_flag_bits, longest_flag_bits) +
                             delimiter_bits + can::intermission_bits);
  }
};

/// Disturbances that lie ahead, in order. Two of the same bit are one, with the longer flags.
class Disturbances {
 public:
  void push(const Disturbance& disturbance) {
    const auto place =
        std::lower_bound(ahead_.begin(), ahead_.end(), disturbance,
                         [](const Disturbance& a, const Disturbance& b) { return a.boundary < b.boundary; });
    if (place != ahead_.end() && place->boundary == disturbance.boundary)
      place->flag_bits = std::max(place->flag_bits, disturbance.flag_bits);
    else
      ahead_.insert(place, disturbance);
  }
  [[nodiscard]] bool any_before(std::uint64_t boundary) const noexcept {
    return !ahead_.empty() && ahead_.front().boundary < boundary;
  }
  [[nodiscard]] std::size_t size() const noexcept { return ahead_.size(); }
  /// There is one.
  [[nodiscard]] const Disturbance& front() const noexcept { return ahead_.front(); }
  Disturbance pop() noexcept {
    const Disturbance first = ahead_.front();
    ahead_.pop_front();
    return first;
  }

 private:
  std::deque<Disturbance> ahead_;
};

}  // namespace ocm::simulation
