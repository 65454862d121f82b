// The analysis held against processors that know no formula: no simulated job takes longer than predicted,
// and where the worst case can be arranged, it takes as long. Analyses that leave something out are caught by
// the same sets.
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/analysis/blocking.hpp"
#include "ocm/analysis/task_response.hpp"
#include "ocm/simulation/cpu.hpp"

#include "unit/analysis/naive_task_response.hpp"
#include "unit/base/explore.hpp"
#include "unit/base/random.hpp"

namespace analysis_task_response_properties_test {

using namespace ocm;
using namespace ocm::analysis;
using test::NaiveCpu;
using test::Random;
using test::Releases;
using test::Step;
using test::Steps;

constexpr int effort = test::at_full_speed ? 100 : 2;

double fraction(Random& random) {
  return static_cast<double>(random.word() >> 11U) * 0x1p-53;
}

/// How a set is drawn.
struct Kind {
  bool jitter = false;
  bool resources = false;
};

struct RandomSet {
  std::vector<Task> tasks;        // the most urgent first, a level each
  std::vector<Section> sections;  // of which each is a whole step of its task's program
  std::vector<Steps> programs;
  std::size_t resources = 0;
};

/// U uniform in 0.3 to 0.99, shared out by UUniFast [Bini, Buttazzo 2005]; T from 10 to 1000 with equally
/// many of each magnitude; D on both sides of T; J up to T, now and then up to 3 T.
RandomSet draw(Random& random, Kind kind) {
  RandomSet set;
  const int count = random.within(2, 6);
  double left = 0.3 + 0.69 * fraction(random);
  for (int i = 0; i < count; ++i) {
    const double next =
        i + 1 == count ? 0 : left * std::pow(fraction(random), 1.0 / static_cast<double>(count - 1 - i));
    Task task;
    task.period = static_cast<std::int64_t>(10 * std::pow(100.0, fraction(random)));
    task.cost = std::max<std::int64_t>(
        1, static_cast<std::int64_t>((left - next) * static_cast<double>(task.period)));
    left = next;
    const int period = static_cast<int>(task.period);
    task.deadline = random.within(period / 2, 3 * period);
    if (kind.jitter && random.below(3) != 0)
      task.jitter = random.within(0, random.below(8) == 0 ? 3 * period : period);
    set.tasks.push_back(task);
  }
  random.below(2) == 0 ? deadline_monotonic(set.tasks) : rate_monotonic(set.tasks);
  std::sort(set.tasks.begin(), set.tasks.end(),
            [](const Task& a, const Task& b) { return a.level < b.level; });
  if (kind.resources) set.resources = 1 + random.below(3);
  for (std::size_t i = 0; i < set.tasks.size(); ++i) {
    Steps steps;
    std::int64_t rest = set.tasks[i].cost;
    if (kind.resources && random.below(4) != 0) {
      for (int sections = random.within(1, 2); sections > 0 && rest > 0; --sections) {
        // Often at once, so that it can be in the way at once.
        const std::int64_t before = random.below(2) * random.below(static_cast<std::uint32_t>(rest));
        rest -= before;
        const std::int64_t length = 1 + random.below(static_cast<std::uint32_t>(rest));
        rest -= length;
        const std::uint32_t resource = random.below(static_cast<std::uint32_t>(set.resources));
        const std::size_t outer = set.sections.size();
        set.sections.push_back({i, resource, length});
        if (before > 0) steps.push_back({Step::Kind::compute, before, 0});
        steps.push_back({Step::Kind::lock, 0, resource});
        // Nested upwards only: no deadlock.
        if (resource + 1 < set.resources && random.below(3) == 0) {
          const std::int64_t inner = 1 + random.below(static_cast<std::uint32_t>(length));
          set.sections.push_back({i, resource + 1, inner, outer});
          steps.push_back({Step::Kind::lock, 0, resource + 1});
          steps.push_back({Step::Kind::compute, inner, 0});
          steps.push_back({Step::Kind::unlock, 0, resource + 1});
          if (inner < length) steps.push_back({Step::Kind::compute, length - inner, 0});
        } else {
          steps.push_back({Step::Kind::compute, length, 0});
        }
        steps.push_back({Step::Kind::unlock, 0, resource});
      }
    }
    if (rest > 0) steps.push_back({Step::Kind::compute, rest, 0});
    set.programs.push_back(std::move(steps));
  }
  return set;
}

/// As many releases as fall into `length`: those before `moment` as late as possible and then at that moment,
/// the others punctual. All at one moment: the critical instant.
Releases critical(const Task& task, std::int64_t moment, std::int64_t length) {
  Releases result{moment - task.jitter, {}};
  for (std::int64_t planned = result.first; planned < moment + length; planned += task.period)
    result.late.push_back(std::max<std::int64_t>(0, moment - planned));
  return result;
}
Releases anyhow(Random& random, const Task& task, std::int64_t length) {
  Releases result{random.below(static_cast<std::uint32_t>(task.period)), {}};
  for (std::int64_t planned = 0; planned < length; planned += task.period)
    result.late.push_back(random.below(static_cast<std::uint32_t>(task.jitter + 1)));
  return result;
}

/// What a run of sets showed.
struct Seen {
  std::int64_t tasks = 0;    // bounded
  std::int64_t beyond = 0;   // simulated longer than predicted
  std::int64_t reached = 0;  // predicted to the tick
  std::int64_t nearly = 0;   // to a tick: who blocks had to begin before
  std::int64_t missed = 0;   // simulated beyond the deadline
  std::int64_t denied = 0;   // and called schedulable
  std::int64_t unbounded = 0;

  void look(const Explained& predicted, std::int64_t bound, std::int64_t simulated) {
    ++tasks;
    beyond += simulated > bound ? 1 : 0;
    reached += simulated == bound ? 1 : 0;
    nearly += simulated >= bound - 1 ? 1 : 0;
    missed += simulated > predicted.deadline ? 1 : 0;
    denied += simulated > predicted.deadline && bound <= predicted.deadline ? 1 : 0;
  }
  [[nodiscard]] double share() const { return static_cast<double>(nearly) / static_cast<double>(tasks); }
};

/// An analysis, or one that leaves something out: what it says of task i.
using Analysis = std::int64_t (*)(const std::vector<Task>& tasks, std::size_t i);
std::int64_t complete(const std::vector<Task>& tasks, std::size_t i) {
  return response_time(tasks, i).response;
}

/// Sets of a kind, each released at its critical instant and anyhow, under one protocol.
Seen hold(Analysis analysis, Kind kind, Protocol protocol, int sets, std::uint64_t seed) {
  Random random{seed};
  Seen seen;
  for (int i = 0; i < sets; ++i) {
    RandomSet set = draw(random, kind);
    if (utilisation(set.tasks).versus_one() != Comparison::below) continue;  // C is at least 1
    std::vector<std::uint32_t> scratch(set.sections.size());
    if (set_blocking(set.tasks, set.sections, protocol, scratch) != Table::good) {
      ++seen.beyond;  // the sections are good
      continue;
    }
    std::vector<std::int64_t> longest(set.tasks.size(), 0);
    const auto run = [&](const std::vector<Releases>& releases) {
      const auto found = NaiveCpu{set.tasks, set.programs, set.resources, protocol}.run(releases);
      for (std::size_t k = 0; k < found.size(); ++k) longest[k] = std::max(longest[k], found[k]);
    };
    std::int64_t moment = 1;
    for (const Task& task : set.tasks) moment = std::max(moment, task.jitter);
    // The longest busy period, as the analysis says, and not too long.
    const Explained last = response_time(set.tasks, set.tasks.size() - 1);
    const std::int64_t length = std::min<std::int64_t>(
        static_cast<std::int64_t>(last.instances) * set.tasks.back().period + set.tasks.back().blocking,
        30'000);
    std::vector<Releases> releases;
    for (const Task& task : set.tasks) releases.push_back(critical(task, moment, length));
    run(releases);
    if (kind.resources) {
      // Of each task that can be in the way: it has just begun.
      for (std::size_t k = 1; k < set.tasks.size(); ++k) {
        std::vector<Releases> before = releases;
        before[k] = critical(set.tasks[k], moment - 1, length);
        run(before);
      }
    }
    std::vector<Releases> random_ones;
    for (const Task& task : set.tasks) random_ones.push_back(anyhow(random, task, 2'000));
    run(random_ones);
    for (std::size_t k = 0; k < set.tasks.size(); ++k) {
      const Explained predicted = response_time(set.tasks, k);
      if (!predicted.bounded()) {
        ++seen.unbounded;
        continue;
      }
      seen.look(predicted, analysis(set.tasks, k), longest[k]);
    }
  }
  return seen;
}

TEST_CASE("independent tasks: never longer than predicted, and at the critical instant as long") {
  const Seen seen = hold(complete, {}, Protocol::inheritance, 300 * effort, 11);
  CHECK(seen.tasks > 900 * effort);
  CHECK(seen.beyond == 0);
  CHECK(seen.reached == seen.tasks);  // 100 %
  CHECK(seen.denied == 0);
  CHECK(seen.missed > 5 * effort);  // deadlines on both sides
  CHECK(seen.unbounded == 0);
}

TEST_CASE("jitter: never longer than predicted, and at the critical instant as long") {
  const Seen seen = hold(complete, {.jitter = true}, Protocol::inheritance, 300 * effort, 12);
  CHECK(seen.tasks > 900 * effort);
  CHECK(seen.beyond == 0);
  CHECK(seen.reached == seen.tasks);
  CHECK(seen.denied == 0);
  CHECK(seen.missed > 100 * effort);
}

TEST_CASE("resources with inheritance: never longer than predicted") {
  const Seen seen =
      hold(complete, {.jitter = true, .resources = true}, Protocol::inheritance, 200 * effort, 13);
  CHECK(seen.tasks > 600 * effort);
  CHECK(seen.beyond == 0);
  CHECK(seen.denied == 0);
  CHECK(seen.share() > 0.65);  // 68 %; many sections never meet
}

TEST_CASE("resources with ceilings: never longer than predicted") {
  const Seen seen = hold(complete, {.jitter = true, .resources = true}, Protocol::ceiling, 200 * effort, 14);
  CHECK(seen.tasks > 600 * effort);
  CHECK(seen.beyond == 0);
  CHECK(seen.denied == 0);
  CHECK(seen.share() > 0.7);  // 74 %
}

// --- the boards' processor: four levels, tasks that share one, and what switches and interrupts cost ---

/// The longest response of each task, in nanoseconds, on the processor of the simulator. Each job does a
/// nanosecond less than it may: a task that ends at the very moment of a release is held to have been late
/// for it.
class Board {
 public:
  Board(const RandomSet& set, Protocol protocol, const Processor& processor)
      : set_(set),
        cpu_({.context_switch = base::Duration{processor.context_switch},
              .interrupt = base::Duration{processor.interrupt},
              .protocol = protocol == Protocol::ceiling ? simulation::ResourceProtocol::ceiling
                                                        : simulation::ResourceProtocol::inheritance}) {
    std::vector<std::uint32_t> ceilings(set.resources, 3);
    for (const Section& section : set.sections)
      ceilings[section.resource] = std::min(ceilings[section.resource], set.tasks[section.task].level);
    for (const std::uint32_t ceiling : ceilings) cpu_.add_resource(static_cast<scheduling::Level>(ceiling));
    cpu_.attach([] {}, [this](scheduling::Level level) { return begin(level); });
  }
  std::vector<std::int64_t> run(const std::vector<Releases>& releases) {
    longest.assign(set_.tasks.size(), 0);
    std::int64_t end = 0;
    for (std::size_t i = 0; i < releases.size(); ++i) {
      std::int64_t planned = releases[i].first;
      std::int64_t last = 0;
      for (const std::int64_t late : releases[i].late) {
        last = std::max(last, planned + late);
        cpu_.at(base::Time{base::Duration{last}}, [this, i, planned] {
          const auto level = static_cast<scheduling::Level>(set_.tasks[i].level);
          queues_[set_.tasks[i].level].push_back({i, planned});
          const auto guard = cpu_.lock();
          cpu_.pend(level);
        });
        planned += set_.tasks[i].period;
        end = std::max(end, last);
      }
    }
    cpu_.run_until(base::Time{base::Duration{10 * end}});
    return longest;
  }

 private:
  std::optional<simulation::Cpu::Job> begin(scheduling::Level level) {
    auto& queue = queues_[static_cast<std::size_t>(level)];
    if (queue.empty()) return std::nullopt;
    const auto [task, planned] = queue.front();
    queue.pop_front();
    simulation::Program program;
    for (const Step& step : set_.programs[task]) {
      if (step.kind == Step::Kind::compute) program.push_back(simulation::compute(base::Duration{step.time}));
      if (step.kind == Step::Kind::lock) program.push_back(simulation::lock(step.resource));
      if (step.kind == Step::Kind::unlock) program.push_back(simulation::unlock(step.resource));
    }
    for (simulation::Segment& segment : program)
      if (segment.kind == simulation::Segment::Kind::compute) {
        segment.time -= base::Duration{1};
        break;
      }
    return simulation::Cpu::Job{std::move(program), [this, task = task, planned = planned] {
                                  longest[task] = std::max(longest[task],
                                                           cpu_.now().time_since_epoch().count() - planned);
                                }};
  }

  const RandomSet& set_;
  simulation::Cpu cpu_;
  std::array<std::deque<std::pair<std::size_t, std::int64_t>>, 4> queues_;
  std::vector<std::int64_t> longest;
};

/// Sets in units of 100 ns, so that a switch is a small part of a job.
Seen hold_on_board(Analysis analysis, Processor processor, Protocol protocol, int sets, std::uint64_t seed) {
  constexpr std::int64_t unit = 100;
  Random random{seed};
  Seen seen;
  for (int i = 0; i < sets; ++i) {
    RandomSet set = draw(random, {.jitter = true, .resources = true});
    for (Task& task : set.tasks) {
      task.cost *= unit;
      task.period *= unit;
      task.deadline *= unit;
      task.jitter *= unit;
      task.level = random.below(4);
    }
    // Nested claims can wait twice: left to the other sets.
    if (std::any_of(set.sections.begin(), set.sections.end(),
                    [](const Section& s) { return s.inside != no_index; }))
      continue;
    for (Section& section : set.sections) section.length *= unit;
    for (Steps& steps : set.programs)
      for (Step& step : steps) step.time *= unit;
    std::vector<std::uint32_t> scratch(set.sections.size());
    if (set_blocking(set.tasks, set.sections, protocol, scratch) != Table::good) {
      ++seen.beyond;
      continue;
    }
    std::int64_t moment = 1;
    for (const Task& task : set.tasks) moment = std::max(moment, task.jitter);
    std::vector<std::int64_t> longest(set.tasks.size(), 0);
    for (std::size_t blocker = 0; blocker <= set.tasks.size(); ++blocker) {
      std::vector<Releases> releases;
      for (std::size_t k = 0; k < set.tasks.size(); ++k) {
        const std::int64_t before = k == blocker ? 1 + 2 * processor.interrupt + processor.context_switch : 0;
        releases.push_back(blocker == set.tasks.size()
                               ? anyhow(random, set.tasks[k], 500 * unit)
                               : critical(set.tasks[k], moment + 50 - before, 500 * unit));
      }
      const auto found = Board{set, protocol, processor}.run(releases);
      for (std::size_t k = 0; k < found.size(); ++k) longest[k] = std::max(longest[k], found[k]);
    }
    for (std::size_t k = 0; k < set.tasks.size(); ++k) {
      const Explained predicted = response_time(set.tasks, k, processor);
      if (!predicted.bounded()) {
        ++seen.unbounded;
        continue;
      }
      seen.look(predicted, analysis == nullptr ? predicted.response : analysis(set.tasks, k), longest[k]);
    }
  }
  return seen;
}

TEST_CASE("on a board: levels that are shared, switches, interrupts, resources") {
  const Processor processor{.context_switch = 12, .interrupt = 7};
  for (const Protocol protocol : {Protocol::inheritance, Protocol::ceiling}) {
    for (const Processor& each : {processor, Processor{}}) {
      const Seen seen = hold_on_board(nullptr, each, protocol, 30 * effort, 21);
      CHECK(seen.tasks > 30 * effort);
      CHECK(seen.beyond == 0);
      CHECK(seen.denied == 0);
    }
    const Seen without = hold_on_board(complete, processor, protocol, 10 * effort, 21);
    CHECK(without.beyond > 0);  // an analysis of the text books' processor
  }
}

// An analysis that leaves something out is caught by the sets above.
TEST_CASE("leaving out the blocking is noticed") {
  const Analysis without = [](const std::vector<Task>& tasks, std::size_t i) {
    std::vector<Task> changed = tasks;
    changed[i].blocking = 0;
    return response_time(changed, i).response;
  };
  CHECK(hold(without, {.jitter = true, .resources = true}, Protocol::inheritance, 10 * effort, 13).beyond >
        0);
  CHECK(hold(without, {.jitter = true, .resources = true}, Protocol::ceiling, 10 * effort, 14).beyond > 0);
}
TEST_CASE("leaving out the later instances is noticed") {
  const Analysis without = [](const std::vector<Task>& tasks, std::size_t i) {
    std::array<std::int64_t, 1> first{};
    (void)response_time(tasks, i, {}, {}, first);
    return first[0];
  };
  CHECK(hold(without, {}, Protocol::inheritance, 300 * effort, 11).beyond > 0);
  CHECK(hold(without, {.jitter = true}, Protocol::inheritance, 100 * effort, 12).beyond > 0);
}
TEST_CASE("leaving out the jitter of others is noticed") {
  const Analysis without = [](const std::vector<Task>& tasks, std::size_t i) {
    std::vector<Task> changed = tasks;
    for (std::size_t k = 0; k < i; ++k) changed[k].jitter = 0;
    return response_time(changed, i).response;
  };
  CHECK(hold(without, {.jitter = true}, Protocol::inheritance, 100 * effort, 12).beyond > 0);
}
TEST_CASE("a bound that is two ticks too low is noticed") {
  const Analysis without = [](const std::vector<Task>& tasks, std::size_t i) {
    std::vector<Task> changed = tasks;
    changed[i].blocking = std::max<std::int64_t>(0, changed[i].blocking - 2);
    return response_time(changed, i).response;
  };
  CHECK(hold(without, {.jitter = true, .resources = true}, Protocol::inheritance, 100 * effort, 13).beyond >
        0);
  CHECK(hold(without, {.jitter = true, .resources = true}, Protocol::ceiling, 100 * effort, 14).beyond > 0);
}

}  // namespace analysis_task_response_properties_test
