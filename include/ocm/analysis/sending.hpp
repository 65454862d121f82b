/// How far apart the frames of a message are at least, from what its source says of when it is sent: on a
/// grid, on events, or both. That is T of the analysis, and a bound on its load only where all that is sent
/// is that far apart. Names of DBC attributes are those of Vector's interaction layer.
///
/// Assumed: a message that is sent while it is active does not become active sooner than a fast cycle after
/// it was sent last; a delay time holds between any two frames, whatever they are sent for.
#pragma once

#include <cstdint>

namespace ocm::analysis {

/// Times are ticks of the caller; 0: not stated.
struct Sending {
  std::int64_t cycle = 0;       ///< GenMsgCycleTime: on a grid
  std::int64_t fast_cycle = 0;  ///< GenMsgCycleTimeFast: while it is active, and between repetitions
  std::int64_t delay = 0;       ///< GenMsgDelayTime: the shortest distance of two
  bool events = false;          ///< also when something happens: a value changes, a request comes
};

struct Distance {
  std::int64_t shortest = 0;  ///< T; 0: none is known
  bool covers_all = false;    ///< no two frames are closer; else only those of the grid are as far apart
  bool on_grid = false;       ///< nothing but one grid: its offset holds for all of its frames
  friend constexpr bool operator==(const Distance&, const Distance&) = default;
};

[[nodiscard]] constexpr Distance distance_of(const Sending& sending) noexcept {
  const auto shorter = [](std::int64_t a, std::int64_t b) { return b > 0 && (a == 0 || b < a) ? b : a; };
  const std::int64_t grid = shorter(sending.cycle, sending.fast_cycle);
  if (sending.events) return {shorter(grid, sending.delay), sending.delay > 0, false};
  if (grid > 0) return {grid, true, sending.cycle > 0 && sending.fast_cycle == 0};
  return {sending.delay, sending.delay > 0, false};
}

}  // namespace ocm::analysis
