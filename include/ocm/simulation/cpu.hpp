/// A processor in virtual time: a context a priority level, preemption, context switches, and resources with
/// priority inheritance or a priority ceiling. It is a scheduling::Port, so what runs on it is the boards'
/// own dispatcher, and what it says of response times is observed, not calculated: no formula of any analysis
/// is in here.
///
///     Cpu cpu{{.context_switch = 2us}};
///     Dispatcher<8, Cpu> dispatcher{cpu};
///     const auto i2c = cpu.add_resource(Level::high);            // the most urgent level that uses it
///     cpu.drive(dispatcher, [&](const Release& release) {        // what a job needs
///       return Program{compute(100us), lock(i2c), compute(300us), unlock(i2c)};
///     });
///     cpu.at(Time{5ms}, [&] { dispatcher.start(0, 10ms, Level::high, cpu.now()); });
///     cpu.run_until(Time{24h});
///
/// The dispatcher's own functions take no time, unless `interrupt` and `context_switch` say so.
/// Deterministic: equal inputs give equal runs; what falls on one moment happens in the order in which it was
/// asked for, the timer first. Host only; a job costs some hundred nanoseconds and its program on the heap.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/scheduling/port.hpp"
#include "ocm/scheduling/publisher.hpp"

namespace ocm::simulation {

/// How a resource that is taken is kept from holding up those who do not use it.
enum class ResourceProtocol : std::uint8_t {
  none,         ///< not at all: priority inversion without bound
  inheritance,  ///< who has it runs at the level of the most urgent one that waits for it
  ceiling,      ///< who has it runs at the level of the most urgent one that ever uses it
};

struct CpuOptions {
  base::Duration context_switch{};  ///< paid by a context that runs after another one, or after idling
  base::Duration interrupt{};       ///< paid by all at each timer and each event from outside
  ResourceProtocol protocol = ResourceProtocol::inheritance;
};

using ResourceNumber = std::size_t;

/// A piece of a job.
struct Segment {
  enum class Kind : std::uint8_t { compute, lock, unlock };
  Kind kind = Kind::compute;
  base::Duration time{};
  ResourceNumber resource = 0;
};
[[nodiscard]] constexpr Segment compute(base::Duration time) noexcept {
  return {Segment::Kind::compute, time, 0};
}
[[nodiscard]] constexpr Segment lock(ResourceNumber resource) noexcept {
  return {Segment::Kind::lock, {}, resource};
}
[[nodiscard]] constexpr Segment unlock(ResourceNumber resource) noexcept {
  return {Segment::Kind::unlock, {}, resource};
}
/// What is locked is to be unlocked by the same program.
using Program = std::vector<Segment>;

/// What became of one release.
struct JobRecord {
  scheduling::Release release{};
  base::Time started{};      ///< when it was taken
  base::Time ended{};        ///< its response time is this, less release.scheduled
  base::Duration blocked{};  ///< for how long its level wanted to run and a less urgent one ran instead
};

class Cpu {
 public:
  using Level = scheduling::Level;

  /// A job that a level's context has begun.
  struct Job {
    Program program;
    std::function<void()> end;
  };

  explicit Cpu(CpuOptions options = {}) : options_(options) {}
  Cpu(const Cpu&) = delete;
  Cpu& operator=(const Cpu&) = delete;

  // As a port
  [[nodiscard]] base::Time now() const noexcept { return now_; }
  void arm(base::Time when) noexcept {
    misuses_ += locked_ ? 0 : 1;
    armed_ = when;
  }
  void pend(Level level) noexcept {
    misuses_ += locked_ ? 0 : 1;
    context(level).pended = true;
  }
  class [[nodiscard]] Guard {
   public:
    explicit Guard(Cpu& cpu) noexcept : cpu_(&cpu) {
      cpu_->misuses_ += cpu_->locked_ ? 1 : 0;
      cpu_->locked_ = true;
    }
    ~Guard() { cpu_->locked_ = false; }
    Guard(const Guard&) = delete;
    Guard& operator=(const Guard&) = delete;

   private:
    Cpu* cpu_;
  };
  [[nodiscard]] Guard lock() noexcept { return Guard{*this}; }
  /// Calls of arm and pend without the lock, and of lock while it was held: what a port may not be asked for.
  [[nodiscard]] std::uint64_t misuses() const noexcept { return misuses_; }

  // What runs on it
  /// `expire` is called at the time that was armed. `begin(level)` in the context of a level that was pended:
  /// it does something in no time and returns nothing, or a job, after whose end it is called again.
  void attach(std::function<void()> expire, std::function<std::optional<Job>(Level)> begin) {
    expire_ = std::move(expire);
    begin_ = std::move(begin);
  }
  /// The jobs of a dispatcher, whose releases need what `demand(release)` says; `record` gets each at its
  /// end.
  template <class Dispatcher>
  void drive(
      Dispatcher& dispatcher, std::function<Program(const scheduling::Release&)> demand,
      std::function<void(const JobRecord&)> record = [](const JobRecord&) {}) {
    attach([&dispatcher] { dispatcher.expire(); },
           [this, &dispatcher, demand = std::move(demand),
            record = std::move(record)](Level level) -> std::optional<Job> {
             JobRecord job;
             if (!dispatcher.take(level, job.release)) return std::nullopt;
             job.started = now_;
             return Job{demand(job.release), [this, &dispatcher, &record, job]() mutable {
                          job.ended = now_;
                          job.blocked = std::exchange(context(job.release.level).blocked, {});
                          record(job);
                          dispatcher.done(job.release.stream);
                        }};
           });
  }
  /// A resource that levels up to `ceiling` use.
  ResourceNumber add_resource(Level ceiling = Level::urgent) {
    resources_.push_back({ceiling, no_job});
    return resources_.size() - 1;
  }
  /// Something from outside, such as a frame that comes: `happen` is called at `when`, or now if that has
  /// passed, before any context goes on.
  void at(base::Time when, std::function<void()> happen) { at(when, {}, std::move(happen)); }
  /// The same, by an interrupt that takes `cost` besides what all of them do, and then has its effect.
  void at(base::Time when, base::Duration cost, std::function<void()> happen) {
    events_.emplace(std::max(when, now_), Event{cost, std::move(happen)});
  }

  /// Runs up to and with `end`: what takes no time there is done.
  void run_until(base::Time end) {
    for (;;) {
      if (happen()) continue;
      const std::size_t chosen = choose();
      const base::Time next = std::min({end, armed_, events_.empty() ? base::never : events_.begin()->first});
      if (chosen == no_job) {
        if (now_ >= end) return;
        idle_ += next - now_;
        now_ = next;
        continue;
      }
      Context& running = contexts_[chosen];
      if (last_ != chosen) {
        last_ = chosen;
        running.switching = options_.context_switch;
      }
      base::Duration* const need = needs(running);
      if (need == nullptr) {  // it did something in no time
        continue;
      }
      if (now_ >= end) return;
      const base::Duration slice = std::min(*need, next - now_);
      *need -= slice;
      running.busy += slice;
      for (std::size_t above = 0; above < chosen; ++above)
        if (contexts_[above].wants()) contexts_[above].blocked += slice;
      now_ += slice;
    }
  }

  // What was seen
  [[nodiscard]] base::Duration busy(Level level) const noexcept {
    return contexts_[static_cast<std::size_t>(level)].busy;
  }
  [[nodiscard]] base::Duration interrupted() const noexcept { return interrupted_; }
  [[nodiscard]] base::Duration idle() const noexcept { return idle_; }

 private:
  static constexpr std::size_t levels = scheduling::level_count;
  static constexpr std::size_t no_job = levels;

  struct Context {
    bool pended = false;
    bool waiting = false;  // for `wanted`
    ResourceNumber wanted = 0;
    std::optional<Job> job;
    std::size_t position = 0;    // in its program
    base::Duration switching{};  // left of the way to this context
    base::Duration busy{};
    base::Duration blocked{};  // since the level's last job ended

    [[nodiscard]] bool wants() const noexcept { return pended || job.has_value(); }
  };
  struct Event {
    base::Duration cost;
    std::function<void()> happen;
  };
  struct Resource {
    Level ceiling;
    std::size_t owner;
  };

  [[nodiscard]] Context& context(Level level) noexcept { return contexts_[static_cast<std::size_t>(level)]; }

  /// Timer, then events, that are due now. True: something was.
  bool happen() {
    if (armed_ <= now_) {
      armed_ = base::never;
      interrupt();
      expire_();
      return true;
    }
    if (events_.empty() || events_.begin()->first > now_) return false;
    const Event event = std::move(events_.begin()->second);
    events_.erase(events_.begin());
    interrupt(event.cost);
    event.happen();
    return true;
  }
  void interrupt(base::Duration cost = {}) noexcept {
    now_ += options_.interrupt + cost;
    interrupted_ += options_.interrupt + cost;
  }

  /// The level that a context runs at, lower numbers being more urgent.
  [[nodiscard]] std::size_t effective(std::size_t who, std::size_t depth = 0) const noexcept {
    std::size_t level = who;
    if (options_.protocol == ResourceProtocol::none || depth == levels) return level;
    for (std::size_t r = 0; r < resources_.size(); ++r) {
      if (resources_[r].owner != who) continue;
      if (options_.protocol == ResourceProtocol::ceiling)
        level = std::min(level, static_cast<std::size_t>(resources_[r].ceiling));
      for (std::size_t other = 0; other < levels; ++other)
        if (contexts_[other].waiting && contexts_[other].wanted == r)
          level = std::min(level, effective(other, depth + 1));
    }
    return level;
  }
  /// Who is to run; of two at one level the one that was raised to it.
  [[nodiscard]] std::size_t choose() const noexcept {
    std::size_t best = no_job;
    std::size_t best_level = no_job;
    for (std::size_t who = 0; who < levels; ++who) {
      if (!contexts_[who].wants() || contexts_[who].waiting) continue;
      const std::size_t level = effective(who);
      if (level <= best_level) {
        best = who;
        best_level = level;
      }
    }
    return best;
  }

  /// The time that a context needs next; nullptr when it did a step that needs none.
  base::Duration* needs(Context& running) {
    if (running.switching > base::Duration{0}) return &running.switching;
    if (!running.job) {
      running.pended = false;
      running.position = 0;
      running.job = begin_(static_cast<Level>(&running - contexts_.data()));
      if (running.job) running.pended = true;  // ask again after it
      return nullptr;
    }
    Program& program = running.job->program;
    if (running.position == program.size()) {
      const auto end = std::move(running.job->end);
      running.job.reset();
      end();
      return nullptr;
    }
    Segment& segment = program[running.position];
    const auto self = static_cast<std::size_t>(&running - contexts_.data());
    switch (segment.kind) {
      case Segment::Kind::compute:
        if (segment.time > base::Duration{0}) return &segment.time;
        break;
      case Segment::Kind::lock:
        if (resources_[segment.resource].owner != no_job) {
          running.waiting = true;
          running.wanted = segment.resource;
          return nullptr;
        }
        resources_[segment.resource].owner = self;
        break;
      case Segment::Kind::unlock:
        resources_[segment.resource].owner = no_job;
        for (Context& other : contexts_)  // they try again, the most urgent first
          if (other.waiting && other.wanted == segment.resource) other.waiting = false;
        break;
    }
    ++running.position;
    return nullptr;
  }

  CpuOptions options_;
  base::Time now_{};
  base::Time armed_ = base::never;
  bool locked_ = false;
  std::uint64_t misuses_ = 0;
  std::function<void()> expire_ = [] {};
  std::function<std::optional<Job>(Level)> begin_ = [](Level) { return std::optional<Job>{}; };
  std::array<Context, levels> contexts_{};
  std::vector<Resource> resources_;
  std::multimap<base::Time, Event> events_;
  std::size_t last_ = no_job;
  base::Duration idle_{};
  base::Duration interrupted_{};
};

static_assert(scheduling::Port<Cpu>);

}  // namespace ocm::simulation
