/// Tasks as types, so that a set that misses a deadline does not compile and the compiler names who does:
///
///     struct Estimator {
///       static constexpr ocm::analysis::Task task{.cost = 1'700, .period = 30'000, .level = 3};
///     };
///     static_assert(ocm::analysis::schedulable<ocm::analysis::TaskList<Encoder, Estimator>>);
///
/// The sets of spec/tasks.json are such lists (task_sets.hpp). Cost: one analysis at compile time
/// (task_response.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ocm/analysis/board_admission.hpp"
#include "ocm/analysis/schedulable.hpp"
#include "ocm/analysis/task_response.hpp"
#include "ocm/analysis/task_set.hpp"
#include "ocm/scheduling/port.hpp"

namespace ocm::analysis {

/// Types with a member `task`; those of a spec have a `name` and `own`, too.
template <class... Tasks>
struct TaskList {
  static constexpr std::size_t size = sizeof...(Tasks);
  template <std::size_t index>
  using item = typename detail::TypeAt<index, Tasks...>::type;
  static constexpr std::array<Task, size> tasks{Tasks::task...};
  static constexpr std::array<Explained, size> results = response_times(tasks);

  /// Microseconds of the task of this name, rounded up; 0: there is none.
  [[nodiscard]] static constexpr std::uint32_t cost_us(std::string_view name) noexcept {
    std::uint32_t found = 0;
    static_cast<void>(((Tasks::name == name ? (found = us(Tasks::task.cost), true) : false) || ...));
    return found;
  }
  /// How much of that it waits for less urgent ones, rounded down.
  [[nodiscard]] static constexpr std::uint32_t waits_us(std::string_view name) noexcept {
    std::int64_t found = 0;
    static_cast<void>(((Tasks::name == name ? (found = Tasks::task.waits, true) : false) || ...));
    return static_cast<std::uint32_t>(found / 1000);
  }
  /// Tasks that are not the sample of a topic, in microseconds.
  [[nodiscard]] static constexpr auto own() noexcept {
    constexpr std::size_t count = (std::size_t{Tasks::own ? 1 : 0} + ... + 0);
    std::array<OwnTask, count> result{};
    if constexpr (count > 0) {
      std::size_t i = 0;
      static_cast<void>(
          ((Tasks::own ? void(result[i++] = {us(Tasks::task.cost),  // rounded up
                                             static_cast<std::uint32_t>(Tasks::task.period / 1000),
                                             static_cast<scheduling::Level>(Tasks::task.level),
                                             static_cast<std::uint32_t>(Tasks::task.waits / 1000)})
                       : void()),
           ...));
    }
    return result;
  }

 private:
  static constexpr std::uint32_t us(std::int64_t ns) noexcept {
    return static_cast<std::uint32_t>((ns + 999) / 1000);
  }
};

/// What BoardAdmission must know of a board, from its set in spec/tasks.json: `Facts` has `Tasks`, `blocking`
/// and `bus_percent`. Each sensor of the board needs a task of its name.
template <class Facts>
struct CostsOf {
  template <class Topic>
  static constexpr std::uint32_t sample_us = [] {
    constexpr std::uint32_t cost = Facts::Tasks::cost_us(Topic::name);
    static_assert(cost > 0, "spec/tasks.json has no task of this topic's name in the board's set");
    return cost;
  }();
  template <class Topic>
  static constexpr std::uint32_t waits_us = Facts::Tasks::waits_us(Topic::name);
  static constexpr auto own = Facts::Tasks::own();
  static constexpr std::uint32_t blocking_us = static_cast<std::uint32_t>((Facts::blocking + 999) / 1000);
  static constexpr std::uint32_t bus_percent = Facts::bus_percent;
};

}  // namespace ocm::analysis
