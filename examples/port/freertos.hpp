/// The scheduling's port on FreeRTOS, complete: a task a level, a hardware counter of microseconds with one
/// alarm, and critical sections. docs/porting.md explains each line; tests/unit/scheduling/port.cpp runs it.
///
/// It compiles against FreeRTOS and the two functions of the hardware that it names; here they are
/// freertos_fake.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "ocm/base/time.hpp"
#include "ocm/scheduling/port.hpp"

#include "examples/port/freertos_fake.hpp"

namespace example {

using ocm::base::Duration;
using ocm::base::Time;
using ocm::scheduling::Level;

// snippet: port
class FreeRtosPort {
 public:
  /// now: the counter has 32 bits and wraps every 71 minutes; the port counts how often.
  Time now() noexcept {
    const Critical critical;  // of FreeRTOS, which nests: now() is also called with the lock held
    const std::uint32_t count = hal_microseconds();
    wraps_ += count < last_count_ ? 1U : 0U;
    last_count_ = count;
    return Time{std::chrono::microseconds{std::int64_t{wraps_} << 32 | count}};
  }

  /// arm: the alarm cannot reach further than half the counter, and then goes off for nothing. That is
  /// harmless, and counts the wraps when no other call asks for the time.
  void arm(Time when) noexcept {
    armed_ = when;
    set_alarm();
  }

  /// pend: FreeRTOS allows no calls from a critical section, so the level's task is woken as the lock goes.
  void pend(Level level) noexcept { pended_[index(level)] = true; }

  class [[nodiscard]] Guard {
   public:
    explicit Guard(FreeRtosPort& port) noexcept : port_(&port), mask_(enter()) {}
    ~Guard() {
      const auto pended = std::exchange(port_->pended_, {});
      leave(mask_);
      for (std::size_t level = 0; level < pended.size(); ++level)
        if (pended[level]) port_->wake(level);
    }
    Guard(const Guard&) = delete;
    Guard& operator=(const Guard&) = delete;

   private:
    FreeRtosPort* port_;
    UBaseType_t mask_;
  };
  /// lock: keeps out every task, and every interrupt that calls the library.
  Guard lock() noexcept { return Guard{*this}; }
  // endsnippet

  // snippet: port-contexts
  /// The contexts. `expire` and `run` are those of the board's controller; what was armed and pended before
  /// is done now.
  void start(void* board, void (*expire)(void*), void (*run)(void*, Level)) noexcept {
    board_ = board;
    expire_ = expire;
    run_ = run;
    for (std::size_t level = 0; level < tasks_.size(); ++level) {
      Task& task = tasks_[level];
      task.port = this;
      // FreeRTOS: a higher number is more urgent. One more than low is left for the idle task below.
      task.handle =
          xTaskCreateStatic(enter_level, "level", stack_words, &task,
                            static_cast<UBaseType_t>(tasks_.size() - level), task.stack, &task.memory);
    }
    hal_on_alarm(on_alarm, this);
    started_ = true;
    const Guard early{*this};  // wakes, as it goes, whom it was asked to wake before there were tasks
    set_alarm();
  }

 private:
  static void enter_level(void* argument) {
    Task& task = *static_cast<Task*>(argument);
    const auto level = static_cast<Level>(&task - task.port->tasks_.data());
    for (;;) {
      ulTaskNotifyTake(pdTRUE, portMAX_DELAY);  // sticky: a pend during run() comes back at once
      task.port->run_(task.port->board_, level);
    }
  }
  static void on_alarm(void* argument) {  // the alarm's interrupt
    auto& port = *static_cast<FreeRtosPort*>(argument);
    bool due = false;
    {
      const Critical critical;
      due = port.armed_ <= port.now();
      if (due) port.armed_ = ocm::base::never;
      port.set_alarm();
    }
    if (due) port.expire_(port.board_);
  }
  // endsnippet

  static constexpr std::uint32_t stack_words = 256;
  struct Task {
    FreeRtosPort* port = nullptr;
    TaskHandle_t handle = nullptr;
    StaticTask_t memory{};
    StackType_t stack[stack_words]{};
  };

  static constexpr std::size_t index(Level level) noexcept { return static_cast<std::size_t>(level); }

  static UBaseType_t enter() noexcept {
    if (xPortIsInsideInterrupt() != pdFALSE) return taskENTER_CRITICAL_FROM_ISR();
    taskENTER_CRITICAL();
    return 0;
  }
  static void leave(UBaseType_t mask) noexcept {
    if (xPortIsInsideInterrupt() != pdFALSE)
      taskEXIT_CRITICAL_FROM_ISR(mask);
    else
      taskEXIT_CRITICAL();
  }
  class Critical {
   public:
    Critical() noexcept : mask_(enter()) {}
    ~Critical() { leave(mask_); }
    Critical(const Critical&) = delete;
    Critical& operator=(const Critical&) = delete;

   private:
    UBaseType_t mask_;
  };

  void wake(std::size_t level) noexcept {
    if (!started_) {
      const Critical critical;
      pended_[level] = true;
    } else if (xPortIsInsideInterrupt() != pdFALSE) {
      BaseType_t switch_needed = pdFALSE;
      vTaskNotifyGiveFromISR(tasks_[level].handle, &switch_needed);
      portYIELD_FROM_ISR(switch_needed);
    } else {
      xTaskNotifyGive(tasks_[level].handle);
    }
  }
  void set_alarm() noexcept {
    const Time present = now();
    const auto left = std::chrono::ceil<std::chrono::microseconds>(std::max(armed_ - present, Duration{0}));
    constexpr std::int64_t furthest = std::int64_t{1} << 31;
    hal_alarm_in(static_cast<std::uint32_t>(std::clamp<std::int64_t>(left.count(), 1, furthest)));
  }

  void* board_ = nullptr;
  void (*expire_)(void*) = nullptr;
  void (*run_)(void*, Level) = nullptr;
  std::array<Task, ocm::scheduling::level_count> tasks_{};
  std::array<bool, ocm::scheduling::level_count> pended_{};
  Time armed_ = ocm::base::never;
  std::uint32_t wraps_ = 0;
  std::uint32_t last_count_ = 0;
  bool started_ = false;
};

static_assert(ocm::scheduling::Port<FreeRtosPort>);

}  // namespace example
