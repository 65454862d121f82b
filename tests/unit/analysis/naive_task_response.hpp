/// A processor for any number of levels, to judge response times: it takes the most urgent job that can go
/// on, gives it time until something happens, and knows no formula. Tests only; simulation/cpu.hpp is the one
/// for the four levels of the boards. A task has one job at a time; its others wait in the order of their
/// release.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "ocm/analysis/blocking.hpp"
#include "ocm/analysis/task_set.hpp"

namespace ocm::test {

/// When a task's jobs are released: planned at first + n * period, and really `late(n)` after that at most.
struct Releases {
  std::int64_t first = 0;
  std::vector<std::int64_t> late;  ///< of each job; the task releases as many as there are numbers
};

/// What a job does, one after the other. It begins with compute or lock, and no compute takes no time.
struct Step {
  enum class Kind : std::uint8_t { compute, lock, unlock };
  Kind kind = Kind::compute;
  std::int64_t time = 0;
  std::uint32_t resource = 0;
};
using Steps = std::vector<Step>;

class NaiveCpu {
 public:
  NaiveCpu(const std::vector<analysis::Task>& tasks, std::vector<Steps> programs, std::size_t resources,
           analysis::Protocol protocol)
      : tasks_(tasks),
        contexts_(tasks.size()),
        owner_(resources, analysis::no_index),
        ceiling_(resources),
        protocol_(protocol) {
    for (std::size_t r = 0; r < resources; ++r) ceiling_[r] = 0xFFFF'FFFF;
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      contexts_[i].program = std::move(programs[i]);
      for (const Step& step : contexts_[i].program)
        if (step.kind == Step::Kind::lock)
          ceiling_[step.resource] = std::min(ceiling_[step.resource], tasks[i].level);
    }
  }

  /// Runs all jobs to their end; the longest response of each task, from the release as planned.
  std::vector<std::int64_t> run(const std::vector<Releases>& releases) {
    std::vector<std::int64_t> longest(tasks_.size(), 0);
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      contexts_[i].releases = &releases[i];
      contexts_[i].next = release(i, 0, 0);
    }
    std::int64_t now = 0;
    for (;;) {
      std::int64_t soonest = never;
      for (std::size_t i = 0; i < tasks_.size(); ++i) {
        Context& context = contexts_[i];
        while (context.next <= now) {
          ++context.released;
          context.next = release(i, context.released, context.next);
        }
        soonest = std::min(soonest, context.next);
      }
      const std::size_t who = choose();
      if (who == analysis::no_index) {
        if (soonest == never) return longest;
        now = soonest;
        continue;
      }
      Context& context = contexts_[who];
      const Step& step = context.program[context.step];
      if (step.kind == Step::Kind::compute) {
        const std::int64_t slice = std::min(step.time - context.spent, soonest - now);
        now += slice;
        context.spent += slice;
        if (context.spent < step.time) continue;
        context.spent = 0;
      } else if (owner_[step.resource] != analysis::no_index) {
        context.waits_for = step.resource;
        continue;
      } else {
        owner_[step.resource] = who;
      }
      // What takes no time is done at once, whatever is released at this very moment.
      while (++context.step < context.program.size() &&
             context.program[context.step].kind == Step::Kind::unlock) {
        const std::uint32_t resource = context.program[context.step].resource;
        owner_[resource] = analysis::no_index;
        for (Context& other : contexts_)
          if (other.waits_for == resource) other.waits_for = nothing;
      }
      if (context.step < context.program.size()) continue;
      const std::int64_t planned =
          context.releases->first + static_cast<std::int64_t>(context.done) * tasks_[who].period;
      longest[who] = std::max(longest[who], now - planned);
      ++context.done;
      context.step = 0;
    }
  }

 private:
  static constexpr std::int64_t never = analysis::unbounded;
  static constexpr std::uint32_t nothing = 0xFFFF'FFFF;

  struct Context {
    Steps program;
    const Releases* releases = nullptr;
    std::int64_t next = 0;     // release
    std::size_t released = 0;  // jobs
    std::size_t done = 0;
    std::size_t step = 0;
    std::int64_t spent = 0;  // in the step
    std::uint32_t waits_for = nothing;
  };

  [[nodiscard]] std::int64_t release(std::size_t i, std::size_t job, std::int64_t not_before) const {
    const Releases& releases = *contexts_[i].releases;
    if (job >= releases.late.size()) return never;
    const std::int64_t planned = releases.first + static_cast<std::int64_t>(job) * tasks_[i].period;
    return std::max(not_before, planned + releases.late[job]);  // jobs of one task do not overtake
  }
  [[nodiscard]] std::uint32_t effective(std::size_t who) const {
    std::uint32_t level = tasks_[who].level;
    for (std::size_t r = 0; r < owner_.size(); ++r) {
      if (owner_[r] != who) continue;
      if (protocol_ == analysis::Protocol::ceiling) level = std::min(level, ceiling_[r]);
      for (std::size_t other = 0; other < contexts_.size(); ++other)
        if (contexts_[other].waits_for == r) level = std::min(level, effective(other));
    }
    return level;
  }
  [[nodiscard]] std::size_t choose() const {
    std::size_t best = analysis::no_index;
    std::uint32_t best_level = 0;
    for (std::size_t i = 0; i < contexts_.size(); ++i) {
      if (contexts_[i].done == contexts_[i].released || contexts_[i].waits_for != nothing) continue;
      const std::uint32_t level = owner_.empty() ? tasks_[i].level : effective(i);
      // Of equal ones the one that was raised: it has what the other may want.
      if (best != analysis::no_index &&
          (level > best_level || (level == best_level && tasks_[i].level <= tasks_[best].level)))
        continue;
      best = i;
      best_level = level;
    }
    return best;
  }

  const std::vector<analysis::Task>& tasks_;
  std::vector<Context> contexts_;
  std::vector<std::size_t> owner_;      // of each resource
  std::vector<std::uint32_t> ceiling_;  // of each resource
  analysis::Protocol protocol_;
};

}  // namespace ocm::test
