/// How long an operator takes at most, as sums whose parts are shown: from an event to the frame that acts,
/// and from a board that is back after a reset to its first sample. proof.hpp finds them.
///
/// Pure, constexpr, no heap. All times in nanoseconds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ocm/analysis/checked.hpp"
#include "ocm/analysis/message_set.hpp"
#include "ocm/reflective/operator.hpp"

namespace ocm::reflective {

struct LatencyPart {
  std::string_view name{};
  std::int64_t time = 0;
};

namespace detail {
template <std::size_t N>
[[nodiscard]] constexpr std::int64_t sum_of(const std::array<LatencyPart, N>& parts, bool bounded) noexcept {
  analysis::Checked sum;
  for (const LatencyPart& part : parts) sum += part.time;
  return bounded ? sum.value_or(analysis::unbounded) : analysis::unbounded;
}
[[nodiscard]] constexpr std::int64_t later(std::int64_t sum, std::int64_t settle) noexcept {
  return sum == analysis::unbounded ? sum : (analysis::Checked{sum} + settle).value_or(analysis::unbounded);
}
}  // namespace detail

/// The parts of a latency, in nanoseconds; those that do not apply are 0.
struct Latency {
  bool bounded = false;
  std::uint16_t condition = none;  ///< which one of the monitor is the latest
  std::int64_t period = 0;         ///< until the stream samples again
  std::int64_t jitter = 0;         ///< of its release
  std::int64_t sampling = 0;       ///< on its board: from the release to the hand-over of its frames
  std::int64_t bus = 0;            ///< of its last frame
  std::int64_t reading = 0;        ///< until the operator's step is over
  std::int64_t limit = 0;          ///< age or gap
  std::int64_t window = 0;         ///< of a rate or load: what is left of one, and a whole one
  std::int64_t lasting = 0;
  std::int64_t timer = 0;    ///< reaction to the timers of those
  std::int64_t command = 0;  ///< until the set points have been sent
  std::int64_t settle = 0;   ///< not in the total: until a change that is under way is over

  [[nodiscard]] constexpr std::array<LatencyPart, 10> parts() const noexcept {
    return {{{"period", period},
             {"jitter", jitter},
             {"sampling", sampling},
             {"bus", bus},
             {"reading", reading},
             {"limit", limit},
             {"window", window},
             {"lasting", lasting},
             {"timer", timer},
             {"command", command}}};
  }
  /// From the event to the end of the last set point's frame, in a configuration that has settled.
  [[nodiscard]] constexpr std::int64_t total() const noexcept { return detail::sum_of(parts(), bounded); }
  /// The same if the configuration was just entered.
  [[nodiscard]] constexpr std::int64_t at_worst() const noexcept { return detail::later(total(), settle); }
};

/// The parts of a recovery: how long after a board takes requests again, having lost its streams, the first
/// sample of one is on the bus. Either its silence or `retry` is waited for, whichever is longer.
struct Recovery {
  bool bounded = false;       ///< false: it is never asked for again, or no bound exists
  std::int64_t silence = 0;   ///< three periods, from the step that took the last sample on
  std::int64_t last = 0;      ///< until that step: sampling, bus and reading of a sample before the reset
  std::int64_t retry = 0;     ///< since a request that the board could just not take
  std::int64_t timer = 0;     ///< reaction to the end of that
  std::int64_t request = 0;   ///< until the request has been sent
  std::int64_t handling = 0;  ///< until its board has taken it
  std::int64_t jitter = 0;    ///< of the first sample, as `sampling` and `bus`
  std::int64_t sampling = 0;
  std::int64_t bus = 0;
  std::int64_t settle = 0;  ///< not in the total: until a change that is under way is over

  [[nodiscard]] constexpr std::array<LatencyPart, 9> parts() const noexcept {
    return {{{"silence", silence},
             {"last sample", last},
             {"retry", retry},
             {"timer", timer},
             {"request", request},
             {"handling", handling},
             {"jitter", jitter},
             {"sampling", sampling},
             {"bus", bus}}};
  }
  /// From the board's return to the end of the first sample's last frame, in a configuration that has
  /// settled and is not left until then.
  [[nodiscard]] constexpr std::int64_t total() const noexcept { return detail::sum_of(parts(), bounded); }
  /// The same, from the return or from the entry, whichever is later.
  [[nodiscard]] constexpr std::int64_t at_worst() const noexcept { return detail::later(total(), settle); }
};

}  // namespace ocm::reflective
