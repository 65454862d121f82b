/// How long it takes, at most, from something that comes near the robot to wheels that are controlled
/// accordingly, while PowerManagement avoids obstacles: proven from the boards' task sets and the bus. Where
/// a topic, a task or a priority makes it too long for the law of the avoidance, this stops the compiler.
///
///     ring read, every 50 ms -> set point on CAN -> taken by DiWheelDrive -> speed controllers, every 10 ms
///
/// Nothing at run time.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include "ocm/analysis/chain.hpp"
#include "ocm/analysis/task_response.hpp"
#include "ocm/analysis/task_sets.hpp"
#include "ocm/sensing/avoidance.hpp"

#include "firmware/boards/avoidance.hpp"
#include "firmware/boards/bus.hpp"

namespace ocm::firmware::boards {

struct Reaction {
  /// Reading the ring, the frame, its reception, the speed controllers.
  std::array<analysis::Hop, 4> hops{};
  analysis::ChainBound bound{};
};

/// What receiving a set point takes DiWheelDrive, twelve times over. [docs/boards/figures.md: 245
/// instructions of 32 ns]
inline constexpr std::int64_t reception_ns = 100'000;

/// The part's own period, a measurement of ambient light in between, and the wheels' lag. [VCNL4020 data
/// sheet: 250 measurements a second; light: 1 ms, decided: a conversion and its offset's; sim: 50 ms,
/// decided]
inline constexpr std::int64_t measuring_ns = 4'000'000 + 1'000'000;
inline constexpr std::int64_t wheels_ns = 50'000'000;

/// What the law of the avoidance leaves for the boards and the bus.
inline constexpr std::int64_t longest_reaction_ns =
    static_cast<std::int64_t>(sensing::most_delay_s(avoidance_model) * 1e9F) - measuring_ns - wheels_ns;

[[nodiscard]] constexpr Reaction reaction_of(std::int64_t longest_ns) noexcept {
  namespace ring = analysis::task_sets::power_management;
  namespace wheels = analysis::task_sets::di_wheel_drive;
  using enum analysis::Activation;
  Reaction reaction;
  reaction.hops = {{{.activation = sampled, .period = ring::Avoidance::task.period},
                    {.activation = triggered},
                    {.activation = triggered},
                    {.activation = sampled, .period = wheels::Control::task.period}}};
  const auto with_jitter = [](auto tasks, std::size_t index, std::int64_t jitter) {
    tasks[index].jitter = jitter;
    return analysis::response_time(tasks, index);
  };
  reaction.bound =
      analysis::bound_chain(reaction.hops, longest_ns, [&](std::size_t hop, std::int64_t jitter) {
        switch (hop) {
          case 0:
            return with_jitter(ring::Facts::Tasks::tasks, 0, jitter);
          case 1:  // the bus's proof has the set point's jitter in it: no more may come
            return jitter <= AvoidanceSetPoint::message.jitter ? Bus::results[avoidance_on_bus]
                                                               : analysis::Explained{};
          case 2:
            return analysis::Explained{.response = jitter + reception_ns,
                                       .deadline = analysis::unbounded,
                                       .reason = analysis::Reason::schedulable};
          default:
            return with_jitter(wheels::Facts::Tasks::tasks, 0, jitter);
        }
      });
  return reaction;
}

// The tasks that are named by their place.
static_assert(analysis::task_sets::power_management::Facts::Tasks::item<0>::name == "avoidance");
static_assert(analysis::task_sets::di_wheel_drive::Facts::Tasks::item<0>::name == "control");

inline constexpr Reaction reaction = reaction_of(longest_reaction_ns);
static_assert(reaction.bound.ok(), "an obstacle can be noticed too late: see docs/behaviours.md");

}  // namespace ocm::firmware::boards
