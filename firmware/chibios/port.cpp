#include "firmware/chibios/port.hpp"

#include <algorithm>
#include <chrono>

namespace ocm::firmware::chibios {
namespace {

/// The kernel's counter with more digits. With the lock held.
class Clock {
 public:
  [[nodiscard]] std::uint64_t ticks() noexcept {
    const systime_t now = chVTGetSystemTimeX();
    ticks_ += static_cast<systime_t>(now - static_cast<systime_t>(ticks_));
    return ticks_;
  }

 private:
  std::uint64_t ticks_ = 0;
};

// One kernel, one clock, one idle thread.
constinit Clock clock;
constinit std::uint64_t idle_ticks = 0;
constinit std::uint64_t idle_since = 0;
constinit bool idling = false;

[[nodiscard]] constexpr base::Duration duration(std::uint64_t ticks) noexcept {
  return static_cast<std::int64_t>(ticks) * tick;
}

/// Not less than `wait`, as far as the kernel's counter allows.
[[nodiscard]] constexpr systime_t ticks_of(base::Duration wait) noexcept {
  const std::int64_t ticks = wait / tick + (wait % tick > base::Duration::zero() ? 1 : 0);
  return static_cast<systime_t>(std::clamp<std::int64_t>(ticks, 1, longest_wait_ticks));
}

}  // namespace

bool Signal::wait(base::Duration timeout) noexcept {
  const Lock lock;
  const base::Time end = base::Time{duration(clock.ticks())} + timeout;
  for (base::Time now; !raised_ && (now = base::Time{duration(clock.ticks())}) < end;)
    static_cast<void>(chThdSuspendTimeoutS(&waiter_, ticks_of(end - now)));
  const bool came = raised_;
  raised_ = false;
  return came;
}

base::Time Port::now() noexcept {
  const Lock lock;
  return base::Time{duration(clock.ticks())};
}

void Port::arm(base::Time when) noexcept {
  target_ = when;
  if (expire_ != nullptr) set_timer();
}

bool Port::all_run(base::Time now) noexcept {
  const Lock lock;
  if (watch_.due(now))
    for (Signal& level : pended_) level.raise_locked();
  return watch_.complete();
}

// The timer always runs, for at most a quarter of the counter's turn: that is what keeps the clock right.
void Port::set_timer() noexcept {
  const base::Duration left = target_ == base::never ? base::Duration::max() : target_ - now();
  chVTSetI(&timer_, ticks_of(left), &timer_expired, this);
}

void Port::timer_expired(void* self) {
  auto& port = *static_cast<Port*>(self);
  bool due = false;
  {
    const Lock lock;
    due = port.target_ <= port.now();
    if (due) port.target_ = base::never;
    port.set_timer();
  }
  if (due) port.expire_(port.object_);
}

void Port::start(void (*expire)(void*), void* object) noexcept {
  const Lock lock;
  object_ = object;
  expire_ = expire;
  set_timer();
}

base::Duration Port::idle() noexcept {
  const Lock lock;
  return duration(idle_ticks + (idling ? clock.ticks() - idle_since : 0));
}

std::size_t untouched(const std::uint8_t* lowest, std::size_t size) noexcept {
  std::size_t count = 0;
  while (count != size && lowest[count] == CH_DBG_STACK_FILL_VALUE) ++count;
  return count;
}

extern "C" void ocm_idle_enter() {
  idle_since = clock.ticks();
  idling = true;
}

extern "C" void ocm_idle_leave() {
  if (idling) idle_ticks += clock.ticks() - idle_since;
  idling = false;
}

}  // namespace ocm::firmware::chibios
