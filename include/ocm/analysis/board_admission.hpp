/// A board's own answer to "one stream more?": yes only if each sample of each of its streams is read and on
/// the wire before its deadline, or before the next one if that is earlier.
///
///     using Admission = analysis::BoardAdmission<amiro::DiWheelDrive, amiro::bit_rate, Costs>;
///     controller::Controller<amiro::DiWheelDrive, Can, Port, 2, Admission> controller{can, port};
///
/// Of stream s, at its level and in whole microseconds:
///
///     reads = blocking + C_s + sum over tasks and streams k, no less urgent, of ceil(reads / T_k) C_k
///     sends = B + F_s + sum over streams k, no less urgent, of ceil((sends + reads_k + tau) / T_k) F_k
///     reads + sends <= min(D_s, max(T_s, Q_s)), and each of the two <= T_s
///
/// C: processor and waiting for the part; of more urgent ones without W, what they wait for less urgent ones,
/// and as if they came up to S later, as in task_response.hpp. F: all frames of a sample, at their exact
/// lengths and priority. B: one frame of any node, already on its way. Q: the topic's shortest period, before
/// which the part has nothing new, and nothing is lost by a late sample. The board's own tasks are demand,
/// and what the less urgent of them are left is not looked at. The first is the response time on a preemptive
/// processor, the second the sufficient one on CAN [Davis et al. 2007, equation 16], with a sample's frames
/// as one. Streams of one level delay each other whatever their order. A board does not hear what others
/// send, so `Costs` says which share of the bus is its own; who hears all is the operator's tool
/// (docs/admission.md).
///
/// Memory: 8 bytes a sensor. Time: sensors^2 steps an iteration and at most `most_iterations` of each sum, no
/// division wider than 32 bits; what that is on a Cortex-M3 is in docs/admission.md. Who would take longer is
/// refused. No heap.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/can/length.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/scheduling/admission.hpp"
#include "ocm/scheduling/level.hpp"
#include "ocm/scheduling/port.hpp"

namespace ocm::analysis {

/// Something that a board does by itself, every period.
struct OwnTask {
  std::uint32_t cost_us = 0;
  std::uint32_t period_us = 0;
  scheduling::Level level = scheduling::Level::urgent;
  std::uint32_t waits_us = 0;  ///< of its cost, for less urgent ones
};

/// What a board without a processor to speak of needs: a simulated one. Also what `Costs` must have.
struct NoCosts {
  /// C of a sample of this topic.
  template <class Topic>
  static constexpr std::uint32_t sample_us = 0;
  /// How much of C it waits for less urgent ones, which go on meanwhile. May be left out.
  template <class Topic>
  static constexpr std::uint32_t waits_us = 0;
  static constexpr std::array<OwnTask, 0> own{};
  /// How long a job can wait for a part's bus that a less urgent one holds, and for the kernel.
  static constexpr std::uint32_t blocking_us = 0;
  /// The board may fill so much of the bus.
  static constexpr std::uint32_t bus_percent = 100;
};

namespace detail {

/// What is known of a sensor before it is requested.
struct SensorCost {
  std::uint32_t sample_us = 0;
  std::uint32_t waits_us = 0;                                      ///< of it, for less urgent ones
  std::uint32_t deadline_us = 0;                                   ///< 0: none but the period
  std::uint32_t shortest_us = 0;                                   ///< how often the part has something new
  std::array<std::uint32_t, scheduling::level_count> frames_us{};  ///< by level
};

[[nodiscard]] constexpr std::uint32_t bits_us(std::uint32_t bits, std::uint32_t bit_rate) noexcept {
  return static_cast<std::uint32_t>((std::uint64_t{bits} * 1'000'000 + bit_rate - 1) / bit_rate);
}

[[nodiscard]] constexpr std::uint32_t bounded_us(base::Duration duration) noexcept {
  return static_cast<std::uint32_t>(
      std::min<std::int64_t>(duration.count() / 1000, std::numeric_limits<std::int32_t>::max()));
}
/// Rounded down, so that the stream seems no less frequent than it is; half an hour at most, and at least
/// one.
[[nodiscard]] constexpr std::uint32_t stream_us(base::Duration period) noexcept {
  return static_cast<std::uint32_t>(
      std::clamp<std::int64_t>(period.count() / 1000, 1, std::numeric_limits<std::int32_t>::max()));
}
/// All frames of a sample.
template <class Frames>
[[nodiscard]] constexpr std::uint32_t frames_us(const Frames& frames, protocol::Priority priority,
                                                std::uint32_t bit_rate) noexcept {
  std::uint32_t bits = 0;
  for (const auto& frame : frames) bits += protocol::worst_bits(frame, priority);
  return bits_us(bits, bit_rate);
}

template <class Topic, class Costs>
[[nodiscard]] constexpr SensorCost sensor_cost(std::uint32_t bit_rate) noexcept {
  SensorCost cost;
  cost.sample_us = Costs::template sample_us<Topic>;
  if constexpr (requires { Costs::template waits_us<Topic>; })
    cost.waits_us = Costs::template waits_us<Topic>;
  cost.deadline_us = bounded_us(Topic::deadline);
  cost.shortest_us = bounded_us(Topic::shortest_period);
  // A request's priority is the level that its samples run at.
  static_assert(protocol::priority_levels == scheduling::level_count);
  for (std::size_t level = 0; level < scheduling::level_count; ++level)
    cost.frames_us[level] = frames_us(Topic::frames, static_cast<protocol::Priority>(level), bit_rate);
  return cost;
}

template <class Sensors, class Costs>
struct SensorCosts;
template <class... Topics, class Costs>
struct SensorCosts<protocol::TopicList<Topics...>, Costs> {
  static constexpr std::array<SensorCost, sizeof...(Topics)> of(std::uint32_t bit_rate) noexcept {
    return {sensor_cost<Topics, Costs>(bit_rate)...};
  }
};

/// What is asked of a board now. Apart from BoardAdmission so that it is compiled once a number of sensors.
template <std::size_t N>
class BoardLoad {
 public:
  static constexpr std::uint32_t late = std::numeric_limits<std::uint32_t>::max();
  static constexpr int most_iterations = 16;
  static constexpr std::size_t most_own = 8;

  struct Facts {
    std::array<SensorCost, N> sensors{};
    const OwnTask* own = nullptr;
    std::size_t own_count = 0;
    std::uint32_t blocking_us = 0;
    std::uint32_t any_frame_us = 0;  ///< B
    std::uint32_t bit_us = 0;        ///< tau
    std::uint32_t bus_percent = 100;
  };
  struct Stream {
    std::uint32_t period_us = 0;  ///< 0: it does not run
    scheduling::Level level = scheduling::Level::low;
  };
  using Streams = std::array<Stream, N>;

  /// Every stream meets its deadline.
  [[nodiscard]] static constexpr bool fits(const Facts& facts, const Streams& streams) noexcept {
    if (!within_share(facts, streams)) return false;
    Bounds bounds;
    if (!read_bounds(facts, streams, bounds)) return false;
    const auto& reads = bounds.reads;
    for (std::size_t s = 0; s < N; ++s) {
      if (streams[s].period_us == 0) continue;
      // Once more for the jitter that reading leaves: the deadline is for both.
      const std::uint32_t due = std::min(deadline(facts, streams, s) - reads[s], streams[s].period_us);
      if (send_bound(facts, streams, reads, s, due) == late) return false;
    }
    return true;
  }

 private:
  /// The next sample overwrites this one; but only when the part has a new one is anything lost by that.
  static constexpr std::uint32_t deadline(const Facts& facts, const Streams& streams,
                                          std::size_t s) noexcept {
    const std::uint32_t own = facts.sensors[s].deadline_us;
    const std::uint32_t next = std::max(streams[s].period_us, facts.sensors[s].shortest_us);
    return own == 0 ? next : std::min(own, next);
  }
  static constexpr std::uint32_t frames(const Facts& facts, const Streams& streams, std::size_t s) noexcept {
    return facts.sensors[s].frames_us[static_cast<std::size_t>(streams[s].level)];
  }

  /// In parts of 2^20, each rounded up.
  static constexpr bool within_share(const Facts& facts, const Streams& streams) noexcept {
    std::uint64_t load = 0;
    for (std::size_t s = 0; s < N; ++s)
      if (streams[s].period_us != 0)
        load += (std::uint64_t{frames(facts, streams, s)} << 20U) / streams[s].period_us + 1;
    return load * 100 <= std::uint64_t{facts.bus_percent} << 20U;
  }

  /// The least w with w = base + demand(w), or `late` where that is beyond `due`.
  template <class Demand>
  static constexpr std::uint32_t solve(std::uint64_t base, std::uint32_t due, Demand demand) noexcept {
    std::uint64_t window = base;
    for (int i = 0; i < most_iterations; ++i) {
      if (window > due) return late;
      const std::uint64_t next = base + demand(static_cast<std::uint32_t>(window));
      if (next == window) return static_cast<std::uint32_t>(window);
      window = next;
    }
    return late;
  }
  static constexpr std::uint64_t demand_of(std::uint32_t window, std::uint32_t period,
                                           std::uint32_t cost) noexcept {
    return std::uint64_t{(window - 1) / period + 1} * cost;  // window: at least 1
  }

  /// What can come before a job, and from when on.
  struct Bounds {
    std::array<std::uint32_t, N> reads{};       ///< of the streams, from their release to the end of reading
    std::array<std::uint32_t, most_own> own{};  ///< of the board's own tasks that wait for less urgent ones
  };

  /// Of a job that costs so much at this level; `stream` and `own` are not counted, being the job itself.
  static constexpr std::uint32_t read_bound(const Facts& facts, const Streams& streams, const Bounds& bounds,
                                            std::uint32_t cost_us, scheduling::Level level, std::uint32_t due,
                                            std::size_t stream, std::size_t own) noexcept {
    const std::uint64_t base = std::uint64_t{facts.blocking_us} + cost_us;
    if (base == 0) return 0;
    return solve(base, due, [&](std::uint32_t window) {
      // One that is more urgent and waits for less urgent ones suspends itself: what it takes, C - W, comes
      // up to R - (C - W) later than its release.
      const auto taken = [&](scheduling::Level of, std::uint32_t period, std::uint32_t cost,
                             std::uint32_t waits, std::uint32_t bound) {
        if (of == level || waits == 0) return demand_of(window, period, cost);
        return demand_of(window + (bound - (cost - waits)), period, cost - waits);
      };
      std::uint64_t sum = 0;
      for (std::size_t k = 0; k < facts.own_count; ++k)
        if (k != own && facts.own[k].level <= level)
          sum += taken(facts.own[k].level, facts.own[k].period_us, facts.own[k].cost_us,
                       facts.own[k].waits_us, bounds.own[k]);
      for (std::size_t k = 0; k < N; ++k)
        if (k != stream && streams[k].period_us != 0 && streams[k].level <= level)
          sum += taken(streams[k].level, streams[k].period_us, facts.sensors[k].sample_us,
                       facts.sensors[k].waits_us, bounds.reads[k]);
      return sum;
    });
  }
  /// From the most urgent level on, as each needs those above. False: one is late.
  static constexpr bool read_bounds(const Facts& facts, const Streams& streams, Bounds& bounds) noexcept {
    for (std::size_t each = 0; each < scheduling::level_count; ++each) {
      const auto level = static_cast<scheduling::Level>(each);
      for (std::size_t k = 0; k < facts.own_count; ++k) {
        if (facts.own[k].level != level || facts.own[k].waits_us == 0) continue;
        bounds.own[k] =
            read_bound(facts, streams, bounds, facts.own[k].cost_us, level, facts.own[k].period_us, N, k);
        if (bounds.own[k] == late) return false;
      }
      for (std::size_t s = 0; s < N; ++s) {
        if (streams[s].level != level || streams[s].period_us == 0) continue;
        // One instance at a time: within the period, also where the deadline is later.
        bounds.reads[s] =
            read_bound(facts, streams, bounds, facts.sensors[s].sample_us, level,
                       std::min(deadline(facts, streams, s), streams[s].period_us), s, most_own);
        if (bounds.reads[s] == late) return false;
      }
    }
    return true;
  }
  static constexpr std::uint32_t send_bound(const Facts& facts, const Streams& streams,
                                            const std::array<std::uint32_t, N>& reads, std::size_t s,
                                            std::uint32_t due) noexcept {
    return solve(std::uint64_t{facts.any_frame_us} + frames(facts, streams, s), due,
                 [&](std::uint32_t window) {
                   std::uint64_t sum = 0;
                   for (std::size_t k = 0; k < N; ++k)
                     if (k != s && streams[k].period_us != 0 && streams[k].level <= streams[s].level)
                       sum += demand_of(window + reads[k] + facts.bit_us, streams[k].period_us,
                                        frames(facts, streams, k));
                   return sum;
                 });
  }
};

}  // namespace detail

/// A scheduling::Admission for the sensors of `Board`, a board of the generated header.
template <class Board, std::uint32_t bit_rate, class Costs = NoCosts>
class BoardAdmission {
  static constexpr std::size_t sensors = Board::sensors::size;
  using Load = detail::BoardLoad<sensors>;

 public:
  constexpr base::Error admit(std::size_t stream, base::Duration period, scheduling::Level level) noexcept {
    const typename Load::Stream before = streams_[stream];
    streams_[stream] = {detail::stream_us(period), level};
    if (Load::fits(facts, streams_)) return base::Error::none;
    streams_[stream] = before;
    return base::Error::not_schedulable;
  }
  constexpr void ended(std::size_t stream) noexcept { streams_[stream] = {}; }

 private:
  static constexpr typename Load::Facts facts = [] {
    typename Load::Facts f;
    f.sensors = detail::SensorCosts<typename Board::sensors, Costs>::of(bit_rate);
    static_assert(Costs::own.size() <= Load::most_own, "raise most_own: a board has more tasks of its own");
    f.own = Costs::own.data();
    f.own_count = Costs::own.size();
    f.blocking_us = Costs::blocking_us;
    f.any_frame_us = detail::bits_us(can::worst_frame_bits(can::Format::base, can::max_dlc), bit_rate);
    f.bit_us = detail::bits_us(1, bit_rate);
    f.bus_percent = Costs::bus_percent;
    return f;
  }();

  typename Load::Streams streams_{};
};

/// Whether a board takes all of its sensors together, each at its default period and priority.
template <class Board, std::uint32_t bit_rate, class Costs = NoCosts>
[[nodiscard]] constexpr bool admits_defaults() noexcept {
  return []<class... Topics>(protocol::TopicList<Topics...> /*sensors*/) {
    BoardAdmission<Board, bit_rate, Costs> admission;
    std::size_t stream = 0;
    return ((admission.admit(stream++, Topics::period.duration(),
                             static_cast<scheduling::Level>(Topics::priority)) == base::Error::none) &&
            ...);
  }(typename Board::sensors{});
}

}  // namespace ocm::analysis
