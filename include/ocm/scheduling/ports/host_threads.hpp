/// The scheduling's port on a host: a thread a priority level and one for the timer, on CLOCK_MONOTONIC. For
/// a controller that runs on Linux, and to see a board's code really preempted.
///
///     HostThreads threads;
///     Controller<Board, Bus, HostThreads> controller{bus, threads};
///     const auto started = threads.start([&] { controller.expire(); }, [&](Level l) { controller.run(l); });
///     if (threads.shortfall()) ...say it
///
/// Where the system permits, the threads have SCHED_FIFO priorities and share one processor, which makes the
/// levels strict: the more urgent one preempts. Where it does not, a level still begins only while no more
/// urgent one has something to do, but one that runs already goes on beside it; `shortfall` says so, and what
/// to do. Linux only.
#pragma once

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <ctime>
#include <functional>
#include <optional>
#include <pthread.h>
#include <sched.h>
#include <string>
#include <system_error>
#include <utility>

#include "ocm/base/time.hpp"
#include "ocm/host/failure.hpp"
#include "ocm/host/system_time.hpp"
#include "ocm/scheduling/port.hpp"

namespace ocm::scheduling::ports {

/// A mutex with priority inheritance, for what levels share: scheduling::Resource<HostMutex, HostThreads>.
class HostMutex {
 public:
  HostMutex() noexcept {
    pthread_mutexattr_t attributes;
    pthread_mutexattr_init(&attributes);
    pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
    pthread_mutex_init(&mutex_, &attributes);
    pthread_mutexattr_destroy(&attributes);
  }
  ~HostMutex() { pthread_mutex_destroy(&mutex_); }
  HostMutex(const HostMutex&) = delete;
  HostMutex& operator=(const HostMutex&) = delete;

  void lock() noexcept { pthread_mutex_lock(&mutex_); }
  bool try_lock() noexcept { return pthread_mutex_trylock(&mutex_) == 0; }
  void unlock() noexcept { pthread_mutex_unlock(&mutex_); }
  [[nodiscard]] pthread_mutex_t* native() noexcept { return &mutex_; }

 private:
  pthread_mutex_t mutex_{};
};

struct HostThreadsOptions {
  bool real_time = true;     ///< ask for SCHED_FIFO
  int lowest_priority = 10;  ///< of level low; medium, high, urgent and the timer are above it
};

class HostThreads {
 public:
  using Level = scheduling::Level;

  explicit HostThreads(HostThreadsOptions options = {}) : options_(options) {
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    for (Context& context : contexts_) pthread_cond_init(&context.wake, &attributes);
    pthread_condattr_destroy(&attributes);
  }
  ~HostThreads() {
    stop();
    for (Context& context : contexts_) pthread_cond_destroy(&context.wake);
  }
  HostThreads(const HostThreads&) = delete;
  HostThreads& operator=(const HostThreads&) = delete;

  // As a port
  [[nodiscard]] base::Time now() const noexcept {
    timespec time{};
    ::clock_gettime(CLOCK_MONOTONIC, &time);
    return base::Time{base::Duration{time.tv_sec * second_ns + time.tv_nsec}};
  }
  void arm(base::Time when) noexcept {
    armed_ = when;
    pthread_cond_signal(&contexts_[timer].wake);
  }
  void pend(Level level) noexcept {
    Context& context = contexts_[static_cast<std::size_t>(level)];
    context.pended = true;
    pthread_cond_signal(&context.wake);
  }
  class [[nodiscard]] Guard {
   public:
    explicit Guard(HostMutex& mutex) noexcept : mutex_(&mutex) { mutex_->lock(); }
    ~Guard() { mutex_->unlock(); }
    Guard(const Guard&) = delete;
    Guard& operator=(const Guard&) = delete;

   private:
    HostMutex* mutex_;
  };
  [[nodiscard]] Guard lock() noexcept { return Guard{mutex_}; }

  // For who owns the threads
  /// Starts them; what was armed and pended before is done now. To be called once.
  host::Outcome<bool> start(std::function<void()> expire, std::function<void(Level)> run) {
    expire_ = std::move(expire);
    run_ = std::move(run);
    // The highest priority first: who is not permitted that one is not permitted any.
    for (std::size_t who = contexts_.size(); who-- > 0;) {
      contexts_[who].owner = this;
      if (const int error = create(who); error != 0) {
        stop();
        return host::Failure{"cannot start a thread: " + describe(error), "allow more threads (ulimit -u)"};
      }
    }
    return true;
  }
  /// Waits until what runs has ended. No context runs after it. Not from one of the contexts.
  void stop() noexcept {
    {
      const Guard guard{mutex_};
      stopping_ = true;
      for (Context& context : contexts_) pthread_cond_signal(&context.wake);
    }
    for (Context& context : contexts_)
      if (std::exchange(context.started, false)) pthread_join(context.thread, nullptr);
  }
  /// Why levels are less strict than they should be; nothing when they are strict. Known after `start`.
  [[nodiscard]] const std::optional<host::Failure>& shortfall() const noexcept { return shortfall_; }

 private:
  static constexpr std::int64_t second_ns = 1'000'000'000;
  static constexpr std::size_t timer = scheduling::level_count;

  struct Context {
    pthread_cond_t wake{};
    pthread_t thread{};
    HostThreads* owner = nullptr;
    bool started = false;
    bool pended = false;  // this and the next under the lock
    bool running = false;
  };

  [[nodiscard]] static std::string describe(int error) { return std::generic_category().message(error); }

  /// Level low has the lowest priority, the timer the highest.
  [[nodiscard]] int priority(std::size_t who) const noexcept {
    return options_.lowest_priority +
           (who == timer ? static_cast<int>(timer) : static_cast<int>(timer - 1 - who));
  }

  int create(std::size_t who) {
    int error = EPERM;
    if (options_.real_time && !shortfall_) {
      error = create_real_time(who);
      // The threads before this one, if any, have their priorities.
      if (error != 0)
        shortfall_ = host::Failure{"no real-time priorities for the levels: " + describe(error),
                                   "run it with CAP_SYS_NICE, or permit them (ulimit -r " +
                                       std::to_string(priority(timer)) +
                                       "); until then an urgent level does not "
                                       "stop one that runs"};
    } else if (!options_.real_time) {
      shortfall_ = host::Failure{"real-time priorities were not asked for", ""};
    }
    if (error != 0) error = pthread_create(&contexts_[who].thread, nullptr, enter, &contexts_[who]);
    contexts_[who].started = error == 0;
    return error;
  }
  int create_real_time(std::size_t who) noexcept {
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
    pthread_attr_setschedpolicy(&attributes, SCHED_FIFO);
    sched_param parameter{};
    parameter.sched_priority = priority(who);
    pthread_attr_setschedparam(&attributes, &parameter);
    // On two processors a less urgent level would run beside a more urgent one.
    if (processor_ < 0) processor_ = ::sched_getcpu();
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<std::size_t>(processor_ < 0 ? 0 : processor_), &one);
    pthread_attr_setaffinity_np(&attributes, sizeof one, &one);
    const int error = pthread_create(&contexts_[who].thread, &attributes, enter, &contexts_[who]);
    pthread_attr_destroy(&attributes);
    return error;
  }

  static void* enter(void* argument) {
    auto& context = *static_cast<Context*>(argument);
    HostThreads& self = *context.owner;
    const auto who = static_cast<std::size_t>(&context - self.contexts_.data());
    who == timer ? self.be_timer() : self.be_level(who);
    return nullptr;
  }

  void be_timer() {
    pthread_cond_t* const wake = &contexts_[timer].wake;
    mutex_.lock();
    while (!stopping_) {
      if (armed_ == base::never) {
        pthread_cond_wait(wake, mutex_.native());
      } else if (armed_ > now()) {
        const timespec limit = host::to_timespec(armed_.time_since_epoch());
        pthread_cond_timedwait(wake, mutex_.native(), &limit);
      } else {
        armed_ = base::never;
        mutex_.unlock();
        expire_();
        mutex_.lock();
      }
    }
    mutex_.unlock();
  }

  void be_level(std::size_t level) {
    Context& context = contexts_[level];
    mutex_.lock();
    while (!stopping_) {
      if (!context.pended || more_urgent_than(level)) {
        pthread_cond_wait(&context.wake, mutex_.native());
        continue;
      }
      context.pended = false;
      context.running = true;
      mutex_.unlock();
      run_(static_cast<Level>(level));
      mutex_.lock();
      context.running = false;
      for (std::size_t below = level + 1; below < timer; ++below)
        if (contexts_[below].pended) pthread_cond_signal(&contexts_[below].wake);
    }
    mutex_.unlock();
  }
  [[nodiscard]] bool more_urgent_than(std::size_t level) const noexcept {
    for (std::size_t above = 0; above < level; ++above)
      if (contexts_[above].pended || contexts_[above].running) return true;
    return false;
  }

  HostThreadsOptions options_;
  HostMutex mutex_;
  base::Time armed_ = base::never;
  bool stopping_ = false;
  std::function<void()> expire_;
  std::function<void(Level)> run_;
  std::array<Context, scheduling::level_count + 1> contexts_{};
  int processor_ = -1;
  std::optional<host::Failure> shortfall_;
};

static_assert(scheduling::Port<HostThreads>);

}  // namespace ocm::scheduling::ports
