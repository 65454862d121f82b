/// What an analysis says of one task or one message, and why: the bound on its response time, the instance in
/// which it is reached, what delays it most. What cannot be bounded gets a reason, never a number.
///
/// All times are ticks of the caller: nanoseconds, bit times. Plain values, no heap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>

namespace ocm::analysis {

enum class Reason : std::uint8_t {
  schedulable,      ///< the bound is within the deadline
  misses_deadline,  ///< the bound is beyond the deadline
  overloaded,       ///< it and what goes before it ask for all there is, or more: the busy period never ends
  too_long,         ///< no end within the limits: more steps than allowed, or more ticks than 63 bits
  bad_input,        ///< an invalid number: a period of 0, a negative jitter; `largest` says whose
};

[[nodiscard]] constexpr std::string_view describe(Reason reason) noexcept {
  switch (reason) {
    case Reason::schedulable:
      return "meets its deadline";
    case Reason::misses_deadline:
      return "misses its deadline";
    case Reason::overloaded:
      return "overloaded: it and what is more urgent ask for all there is, or more";
    case Reason::too_long:
      return "no bound found: its busy period is longer than the limits of the analysis";
    case Reason::bad_input:
      return "an invalid number, such as a period of 0";
  }
  return "unknown reason";
}

/// A response time without bound, or of which none is known.
inline constexpr std::int64_t unbounded = std::numeric_limits<std::int64_t>::max();
/// An index that is none.
inline constexpr std::size_t no_index = std::numeric_limits<std::size_t>::max();
/// A deadline that is the period, whatever that is.
inline constexpr std::int64_t implicit_deadline = std::numeric_limits<std::int64_t>::min();

/// How long an analysis may take before it says too_long.
struct Limits {
  /// Terms of a sum (one task's interference, once) for each task or message that is analysed. A term costs
  /// about 10 ns on a host; clang gives up on a constant expression after some 8'000, a set of 48 tasks.
  std::int64_t terms = 20'000'000;
};

/// One task or message, explained. Of the worst instance:
/// response = jitter + blocking + own cost + interference - the time from the first release to its own.
struct Explained {
  std::int64_t response = unbounded;  ///< R, from the release as planned to the end, at worst
  std::int64_t deadline = 0;          ///< D
  Reason reason = Reason::bad_input;  ///< schedulable, or why not
  std::size_t instance = 0;           ///< q: the release of the busy period, from 0, that is the worst
  std::size_t instances = 0;          ///< how many releases of the busy period were looked at
  std::int64_t blocking = 0;          ///< B, with all that holds it up from below
  std::size_t blocked_by = no_index;  ///< whose; no_index: none, or not known
  std::int64_t interference = 0;      ///< of all that go before it
  std::size_t largest = no_index;     ///< who delays it most; bad_input: whose numbers are bad
  std::int64_t largest_share = 0;     ///< how long that one does

  [[nodiscard]] constexpr bool ok() const noexcept { return reason == Reason::schedulable; }
  [[nodiscard]] constexpr bool bounded() const noexcept { return response != unbounded; }
  /// How much later it could be; negative: by how much it misses. Valid if bounded().
  [[nodiscard]] constexpr std::int64_t slack() const noexcept { return deadline - response; }
  friend bool operator==(const Explained&, const Explained&) = default;
};

}  // namespace ocm::analysis
