/// A part or a bus that several priority levels share: one level has it at a time, and how long the others
/// had to wait is measured.
///
///     Resource<Mutex, Port> i2c{port};
///     const auto claim = i2c.claim();   // until it goes out of scope
///
/// The mutex is the system's, with priority inheritance or a priority ceiling: while a lower level has the
/// resource and an upper one claims it, nothing in between may run. Then a job is held up by at most one
/// critical section of a lower level for each claim (inheritance), or one in all (ceiling), and never by a
/// job that does not use the resource. Claims are not nested within one another's resource, and nested claims
/// of two resources go in one order everywhere. [Sha, Rajkumar, Lehoczky 1990, theorems 6 and 12]
///
/// Two readings of the clock a claim; 24 bytes and the mutex. No heap.
#pragma once

#include <concepts>
#include <cstdint>

#include "ocm/base/time.hpp"

namespace ocm::scheduling {

/// The system's mutex; `try_lock` is optional, and makes the count of contentions exact.
template <class M>
concept Lockable = requires(M& mutex) {
  mutex.lock();
  mutex.unlock();
};

/// Of a system with one context, where there is no wait.
struct NoMutex {
  constexpr void lock() noexcept {}
  constexpr void unlock() noexcept {}
};

/// What it cost to share, since the start. Times are what the clock showed: a holder that was preempted by
/// an upper level counts those jobs too.
struct Contention {
  std::uint32_t claims = 0;     ///< wraps
  std::uint32_t contended = 0;  ///< claims that had to wait; wraps
  base::Duration longest_wait{};
  base::Duration longest_hold{};
  friend constexpr bool operator==(const Contention&, const Contention&) = default;
};

/// `Clock`: anything with `now()`, such as the port.
template <Lockable Mutex, class Clock>
class Resource {
 public:
  class [[nodiscard]] Claim {
   public:
    explicit Claim(Resource& resource) noexcept : resource_(&resource) { resource_->enter(); }
    ~Claim() { resource_->leave(); }
    Claim(const Claim&) = delete;
    Claim& operator=(const Claim&) = delete;

   private:
    Resource* resource_;
  };

  /// The clock must outlive the resource; further arguments are the mutex's.
  template <class... Args>
  explicit Resource(Clock& clock, Args&&... args) noexcept
      : clock_(&clock), mutex_(static_cast<Args&&>(args)...) {}
  Resource(const Resource&) = delete;
  Resource& operator=(const Resource&) = delete;

  /// Waits until the resource is free. From a level's context; not from a timer, interrupt or the port's
  /// lock.
  Claim claim() noexcept { return Claim{*this}; }

  /// What it cost so far. Waits for the resource itself.
  [[nodiscard]] Contention contention() noexcept {
    mutex_.lock();
    const Contention result = contention_;
    mutex_.unlock();
    return result;
  }

 private:
  void enter() noexcept {
    const base::Time wanted = clock_->now();
    bool waited = false;
    if constexpr (requires(Mutex & mutex) {
                    { mutex.try_lock() } -> std::convertible_to<bool>;
                  }) {
      if (!mutex_.try_lock()) {
        waited = true;
        mutex_.lock();
      }
      entered_ = waited ? clock_->now() : wanted;
    } else {
      mutex_.lock();
      entered_ = clock_->now();
      waited = entered_ > wanted;
    }
    ++contention_.claims;
    contention_.contended += waited ? 1U : 0U;
    if (entered_ - wanted > contention_.longest_wait) contention_.longest_wait = entered_ - wanted;
  }
  void leave() noexcept {
    const base::Duration held = clock_->now() - entered_;
    if (held > contention_.longest_hold) contention_.longest_hold = held;
    mutex_.unlock();
  }

  Clock* clock_;
  Mutex mutex_;
  base::Time entered_{};  // this and the next are the holder's
  Contention contention_{};
};

}  // namespace ocm::scheduling
