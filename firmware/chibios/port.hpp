/// The scheduling's port on ChibiOS/RT 4: a thread a priority level, one virtual timer, the kernel's lock,
/// its mutex with priority inheritance. The only place, with the buses beside it, where a board meets the
/// kernel.
///
///     chSysInit();
///     static Port port;
///     static Board board{parts, can, port};
///     static Runtime runtime{port, board.controller(), can};
///     runtime.run([](base::Time now) { parts.maintain(now); }, feed);  // main()'s thread is the lowest
///     level's now; `feed()` is called as long as every level runs (scheduling/level_watch.hpp)
///
/// Time: 64-bit nanoseconds since the kernel's start, in steps of 1 us. The kernel's own counter turns over
/// every 65 ms (16 bits) or 71 minutes (32 bits): the port looks at it at least four times a turn.
/// Threads: receiver > urgent > high > medium > low; low is main()'s own, so its stack is main()'s.
/// Costs: RAM of Port 112 bytes, of Runtime three stacks and the receiver's; lock and unlock some 20
/// instructions.
#pragma once

#include <array>
#include <ch.h>
#include <chrono>
#include <concepts>
#include <cstddef>
#include <cstdint>

#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/scheduling/level_watch.hpp"
#include "ocm/scheduling/port.hpp"

namespace ocm::firmware::chibios {

using scheduling::Level;

/// How often the levels are called up, to prove that they run.
inline constexpr base::Duration watch_period = std::chrono::milliseconds{100};

/// The kernel locked: no other thread, no interrupt that talks to the kernel. From threads, interrupts and
/// where it is locked already. Its end lets a more urgent thread in that became ready meanwhile.
class Lock {
 public:
  Lock() noexcept : status_(chSysGetStatusAndLockX()) {}
  ~Lock() { chSysRestoreStatusX(status_); }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

 private:
  syssts_t status_;
};

/// Waits of at most this long end in time whatever the counter's phase: the kernel adds two such times in one
/// counter's width. [ChibiOS chvt.c, chVTDoSetI: now + delay - lasttime]
inline constexpr std::uint32_t longest_wait_ticks = static_cast<systime_t>(-1) / 4;
inline constexpr base::Duration tick = std::chrono::nanoseconds{1'000'000'000 / CH_CFG_ST_FREQUENCY};

/// The kernel's mutex: who holds it inherits the priority of the most urgent that waits for it. For threads.
class Mutex {
 public:
  Mutex() noexcept { chMtxObjectInit(&mutex_); }
  Mutex(const Mutex&) = delete;
  Mutex& operator=(const Mutex&) = delete;
  void lock() noexcept { chMtxLock(&mutex_); }
  [[nodiscard]] bool try_lock() noexcept { return chMtxTryLock(&mutex_); }
  void unlock() noexcept { chMtxUnlock(&mutex_); }

 private:
  mutex_t mutex_;
};

/// Where one thread waits for one cause, which any context may announce, interrupts too. An announcement
/// without a waiter is kept, once.
class Signal {
 public:
  /// With the lock held.
  void raise_locked() noexcept {
    raised_ = true;
    chThdResumeI(&waiter_, MSG_OK);
  }
  void raise() noexcept {
    const Lock lock;
    raise_locked();
  }
  void wait() noexcept {
    const Lock lock;
    while (!raised_) chThdSuspendS(&waiter_);
    raised_ = false;
  }
  /// Whether it came within `timeout`.
  [[nodiscard]] bool wait(base::Duration timeout) noexcept;

 private:
  thread_reference_t waiter_ = nullptr;
  bool raised_ = false;
};

class Port {
 public:
  Port() noexcept = default;
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;

  /// Any context; exact to one tick, rounded down.
  [[nodiscard]] base::Time now() noexcept;
  /// Never early, late by the kernel's shortest alarm (10 us) and what else is running.
  void arm(base::Time when) noexcept;
  void pend(Level level) noexcept { pended_[static_cast<std::size_t>(level)].raise_locked(); }
  [[nodiscard]] Lock lock() noexcept { return Lock{}; }
  void ran(Level level) noexcept { watch_.ran(level); }

  /// From now on the timer's interrupt calls `expire(object)`. The kernel runs already.
  void start(void (*expire)(void*), void* object) noexcept;
  /// In the level's own thread, until the level is pended; or, when `timeout` was over first, false.
  void wait(Level level) noexcept { pended_[static_cast<std::size_t>(level)].wait(); }
  [[nodiscard]] bool wait(Level level, base::Duration timeout) noexcept {
    return pended_[static_cast<std::size_t>(level)].wait(timeout);
  }

  /// At the lowest level, between its jobs: calls the levels up when it is time. True: every level has run
  /// since that was last so.
  [[nodiscard]] bool all_run(base::Time now) noexcept;

  /// Time in which no thread had anything to do, interrupts during it included.
  [[nodiscard]] base::Duration idle() noexcept;

 private:
  void set_timer() noexcept;
  static void timer_expired(void* self);

  std::array<Signal, scheduling::level_count> pended_{};
  scheduling::LevelWatch watch_{watch_period};
  virtual_timer_t timer_{};
  base::Time target_ = base::never;
  void (*expire_)(void*) = nullptr;
  void* object_ = nullptr;
};
static_assert(scheduling::LevelWatcher<Port>);

/// How the stack of a thread stands: bytes that it never touched.
[[nodiscard]] std::size_t untouched(const std::uint8_t* lowest, std::size_t size) noexcept;

/// A stack and the kernel's description of its thread.
template <std::size_t Bytes>
class Thread {
 public:
  void start(tprio_t priority, void (*function)(void*), void* argument) noexcept {
    chThdCreateStatic(area_, sizeof area_, priority, function, argument);
  }
  /// 0: the stack is too small by an unknown number.
  [[nodiscard]] std::size_t untouched() const noexcept {
    return chibios::untouched(reinterpret_cast<const std::uint8_t*>(area_) + sizeof(thread_t),
                              sizeof area_ - sizeof(thread_t));
  }

 private:
  THD_WORKING_AREA(area_, Bytes);
};

/// How often a board looks after its parts. [firmware/boards/*/parts.hpp, maintain]
inline constexpr base::Duration background_period = std::chrono::milliseconds{10};

/// Nothing is fed.
struct NoWatchdog {
  void operator()() const noexcept {}
};

/// The kernel's priority of a level's thread.
[[nodiscard]] constexpr tprio_t priority_of(Level level) noexcept {
  return NORMALPRIO + scheduling::level_count - 1 - static_cast<tprio_t>(level);
}

/// Stack sizes, in bytes, on top of what the kernel needs for a switch and an interrupt.
struct Stacks {
  std::size_t level = 768;
  std::size_t receiver = 768;
};

/// What the receiver's thread is woken for.
enum class BusEvent : std::uint8_t {
  frame,     ///< one was received
  writable,  ///< there is room again for frames to send
  lost,      ///< the bus is gone: bus-off, or no other node
};

/// A bus as the receiver's thread sees it: `wait` blocks until there is something, and fills `frame` if it is
/// one.
template <class C>
concept EventSource = requires(C& can, can::Frame& frame) {
  { can.wait(frame) } -> std::same_as<BusEvent>;
};

/// A thread a priority level. `Work` has `expire()` and `run(Level)`, as scheduling::Dispatcher.
template <class Work, std::size_t StackBytes = Stacks{}.level>
class Levels {
 public:
  /// Both must outlive the threads.
  Levels(Port& port, Work& work) noexcept : port_(&port), work_(&work) {}
  Levels(const Levels&) = delete;
  Levels& operator=(const Levels&) = delete;

  /// Makes the calling thread the lowest level, which between its jobs calls `background(now)` every
  /// `background_period`: what is not urgent and belongs to no topic. `feed()` is called each time that every
  /// level has run since the last time, some ten times a second.
  template <class F, class Feed = NoWatchdog>
  [[noreturn]] void run(F background, Feed feed = {}) noexcept {
    port_->start([](void* self) { static_cast<Levels*>(self)->work_->expire(); }, this);
    start_level<Level::urgent>();
    start_level<Level::high>();
    start_level<Level::medium>();
    chThdSetPriority(priority_of(Level::low));
    base::Time next = port_->now();
    for (;;) {
      const base::Time now = port_->now();
      if (port_->all_run(now)) feed();
      if (now >= next) {
        background(now);
        next = port_->now() + background_period;  // so that a job waits for one of them at most
      } else if (port_->wait(Level::low, next - now)) {
        work_->run(Level::low);
      }
    }
  }

  /// Bytes of stack that were never touched, of the three levels above low.
  [[nodiscard]] std::size_t untouched(Level level) const noexcept {
    return threads_[static_cast<std::size_t>(level)].untouched();
  }

 private:
  template <Level L>
  void start_level() noexcept {
    threads_[static_cast<std::size_t>(L)].start(
        priority_of(L), [](void* self) { static_cast<Levels*>(self)->serve(L); }, this);
  }
  [[noreturn]] void serve(Level level) noexcept {
    for (;;) {
      port_->wait(level);
      work_->run(level);
    }
  }

  Port* port_;
  Work* work_;
  std::array<Thread<StackBytes>, scheduling::level_count - 1> threads_;
};

/// The threads of a board on a bus. `Controller` is ocm/controller/controller.hpp's.
template <class Controller, EventSource Can, Stacks Sizes = Stacks{}>
class Runtime {
 public:
  /// All must outlive the runtime.
  Runtime(Port& port, Controller& controller, Can& can) noexcept
      : port_(&port), controller_(&controller), can_(&can), levels_(port, controller) {}
  Runtime(const Runtime&) = delete;
  Runtime& operator=(const Runtime&) = delete;

  /// As Levels::run.
  template <class F, class Feed = NoWatchdog>
  [[noreturn]] void run(F background, Feed feed = {}) noexcept {
    receiver_.start(
        priority_of(Level::urgent) + 1, [](void* self) { static_cast<Runtime*>(self)->receive(); }, this);
    levels_.run(background, feed);
  }

  /// Bytes of stack that were never touched, of the receiver or of the three levels above low.
  [[nodiscard]] std::size_t untouched_receiver() const noexcept { return receiver_.untouched(); }
  [[nodiscard]] std::size_t untouched(Level level) const noexcept { return levels_.untouched(level); }

 private:
  [[noreturn]] void receive() noexcept {
    for (;;) {
      can::Frame frame;
      switch (can_->wait(frame)) {
        case BusEvent::frame:
          controller_->receive(frame, port_->now());
          break;
        case BusEvent::writable:
          controller_->writable();
          break;
        case BusEvent::lost:
          controller_->bus_lost();
          break;
      }
    }
  }

  Port* port_;
  Controller* controller_;
  Can* can_;
  Thread<Sizes.receiver> receiver_;
  Levels<Controller, Sizes.level> levels_;
};

}  // namespace ocm::firmware::chibios
