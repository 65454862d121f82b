/// How long it takes from a sensor to a motor: a chain of tasks and frames, each of which is triggered by
/// what came before it or looks at it with a period of its own.
///
///     sensor task -> frame -> operator -> frame -> motor task
///      sampled      triggered  sampled   triggered  triggered
///
/// Of each hop the response time is known, from the planned release to the end. Then, from the planned
/// release of the sensor's task on:
///
///     triggered   adds R - J at most (J, that it has inherited, is counted already) and `best` at least;
///                 its output varies by what its input does, and by R - J - best
///     sampled     adds T + R at most: what comes just after it has looked waits for a period. Its output is
///                 late by its own R - best only: it follows its own grid, and hands on no jitter
///
/// [Tindell, Clark 1994, jitter that is handed on; Davare, Zhu, Di Natale, Pinello, Kanajan,
/// Sangiovanni-Vincentelli 2007, sum of T + R where hops sample]
///
/// Assumed: clocks of one speed; a hop that samples takes the newest value, and values may be overwritten by
/// newer ones; a triggered hop loses none. Cost: O(hops), and one analysis for each hop in each pass.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/analysis/checked.hpp"
#include "ocm/analysis/verdict.hpp"

namespace ocm::analysis {

enum class Activation : std::uint8_t { triggered, sampled };

struct Hop {
  Activation activation = Activation::triggered;
  std::int64_t period = 0;  ///< T, of one that samples; the first hop of a chain does: a sensor has a period
  std::int64_t best = 0;    ///< shortest time from its activation to its end: 0 is always right
  std::int64_t jitter = 0;  ///< J, of its own release, of one that samples

  // What `bound` says of it:
  std::int64_t inherited = 0;  ///< jitter with which it is activated
  std::int64_t waits = 0;      ///< at most, for the hop to look
  std::int64_t responds = 0;   ///< at most, from its activation on
  std::int64_t until = 0;      ///< longest time from the sensor's release to its end
  std::int64_t hands_on = 0;   ///< jitter of its output
};

struct ChainBound {
  Reason reason = Reason::bad_input;  ///< misses_deadline: see `age`
  std::size_t hop = no_index;         ///< schedulable, misses_deadline: what takes longest; else whose fault
  std::int64_t latency = unbounded;   ///< from the sensor's planned release to the end of the last hop
  std::int64_t shortest = 0;          ///< the same at best
  /// From an event in the world to the end of the first reaction to it; and how old what the last hop acts
  /// upon can be when it is replaced. Both are the latency and one period of the sensor.
  std::int64_t age = unbounded;

  [[nodiscard]] constexpr bool ok() const noexcept { return reason == Reason::schedulable; }
};

/// Bounds a chain and fills in what is said of its hops. `respond(hop, jitter)` returns the Explained of that
/// hop's task or message when it is released with so much jitter: it puts the jitter into its set and
/// analyses that. Hops that share a processor or a bus delay each other, so it is asked again until no jitter
/// grows, `most_passes` times at most. `deadline` is of the age.
template <class Respond>
constexpr ChainBound bound_chain(std::span<Hop> hops, std::int64_t deadline, Respond&& respond,
                                 int most_passes = 1'000) noexcept {
  ChainBound bound;
  for (std::size_t i = 0; i < hops.size(); ++i) {
    const Hop& hop = hops[i];
    const bool samples = hop.activation == Activation::sampled;
    if (hop.best < 0 || hop.jitter < 0 || (samples && hop.period < 1) || (i == 0 && !samples)) {
      bound.hop = i;
      return bound;
    }
  }
  if (hops.empty()) return bound;
  for (Hop& hop : hops) hop.inherited = hop.activation == Activation::sampled ? hop.jitter : 0;

  for (int pass = 0; pass < most_passes; ++pass) {
    bool grew = false;
    Checked latest = 0;    // from the sensor's release to the end of the hop before
    Checked earliest = 0;  // the same at best
    Checked varies = 0;    // jitter of its output
    for (std::size_t i = 0; i < hops.size(); ++i) {
      Hop& hop = hops[i];
      const bool samples = hop.activation == Activation::sampled;
      if (!samples) {
        grew = grew || varies > Checked{hop.inherited};
        hop.inherited = std::max(hop.inherited, varies.value_or(unbounded));
      }
      const Explained result = respond(i, hop.inherited);
      if (!result.bounded()) {
        bound.reason = result.reason;
        bound.hop = i;
        return bound;
      }
      const Checked responds = Checked{result.response} - (samples ? 0 : hop.inherited);
      // No hop is faster than it is slow, whatever `best` says.
      const Checked best = std::min(hop.best, responds.value_or(hop.best));
      hop.waits = samples && i > 0 ? hop.period : 0;
      hop.responds = responds.value_or(unbounded);
      latest += responds + hop.waits;
      earliest += best;
      varies = responds - best + (samples ? Checked{0} : varies);
      hop.until = latest.value_or(unbounded);
      hop.hands_on = varies.value_or(unbounded);
      if (!latest.ok() || !varies.ok()) {
        bound.reason = Reason::too_long;
        bound.hop = i;
        return bound;
      }
    }
    if (grew) continue;

    const Checked age = latest + hops[0].period;
    if (!age.ok()) break;
    bound.latency = latest.value();
    bound.shortest = earliest.value();
    bound.age = age.value();
    bound.reason = bound.age <= deadline ? Reason::schedulable : Reason::misses_deadline;
    std::int64_t most = -1;
    for (std::size_t i = 0; i < hops.size(); ++i) {
      if (hops[i].waits + hops[i].responds <= most) continue;
      most = hops[i].waits + hops[i].responds;
      bound.hop = i;
    }
    return bound;
  }
  bound.reason = Reason::too_long;
  return bound;
}

}  // namespace ocm::analysis
