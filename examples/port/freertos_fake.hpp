/// The dozen functions of FreeRTOS that freertos.hpp calls, on a host's threads, and a hardware timer: enough
/// to compile it and to run the ports' common test on it. A task begins to run only while no more urgent one
/// wants to; one that runs is not stopped for it. FreeRTOS itself is not needed, and nothing of it is in
/// here.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <thread>

using BaseType_t = long;
using UBaseType_t = unsigned long;
using StackType_t = std::uint32_t;
struct StaticTask_t {};
inline constexpr BaseType_t pdFALSE = 0, pdTRUE = 1;
inline constexpr std::uint32_t portMAX_DELAY = 0xFFFFFFFF;

namespace fake {

struct Task {
  UBaseType_t priority = 0;
  std::uint32_t notified = 0;
  bool running = false;
  std::thread thread;
};
struct Ended {};  // leaves a task's endless loop

struct Kernel {
  std::mutex mutex;
  std::condition_variable changed;
  std::list<Task> tasks;
  bool ended = false;

  std::recursive_mutex critical;  // FreeRTOS's nest

  // The timer: a counter that wraps soon after the start, and an alarm.
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point alarm = std::chrono::steady_clock::time_point::max();
  void (*on_alarm)(void*) = nullptr;
  void* alarm_argument = nullptr;
  std::thread timer;

  /// As when the power goes off: every task is left where it waits next.
  void end() {
    {
      const std::lock_guard guard{mutex};
      ended = true;
    }
    changed.notify_all();
    for (Task& task : tasks)
      if (task.thread.joinable()) task.thread.join();
    if (timer.joinable()) timer.join();
  }
  void run_timer();
};
inline std::unique_ptr<Kernel> kernel;  // a test makes one, and ends it
inline thread_local Task* self = nullptr;
inline thread_local bool in_interrupt = false;

inline void Kernel::run_timer() {
  in_interrupt = true;
  std::unique_lock lock{mutex};
  while (!ended) {
    if (alarm > std::chrono::steady_clock::now()) {
      const auto wanted = alarm;
      if (wanted == std::chrono::steady_clock::time_point::max())
        changed.wait(lock);
      else
        changed.wait_until(lock, wanted);
      continue;
    }
    alarm = std::chrono::steady_clock::time_point::max();
    lock.unlock();
    on_alarm(alarm_argument);
    lock.lock();
  }
}

}  // namespace fake

using TaskHandle_t = fake::Task*;

// The hardware ----------------------------------------------------------------------------------------------

inline std::uint32_t hal_microseconds() {
  const auto passed = std::chrono::steady_clock::now() - fake::kernel->start;
  return 0xFFFFFFFF - 20'000 +
         static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::microseconds>(passed).count());
}
inline void hal_alarm_in(std::uint32_t microseconds) {
  {
    const std::lock_guard guard{fake::kernel->mutex};
    fake::kernel->alarm = std::chrono::steady_clock::now() + std::chrono::microseconds{microseconds};
  }
  fake::kernel->changed.notify_all();
}
inline void hal_on_alarm(void (*call)(void*), void* argument) {
  fake::kernel->on_alarm = call;
  fake::kernel->alarm_argument = argument;
  fake::kernel->timer = std::thread{[] { fake::kernel->run_timer(); }};
}

// FreeRTOS --------------------------------------------------------------------------------------------------

inline TaskHandle_t xTaskCreateStatic(void (*code)(void*), const char*, std::uint32_t, void* argument,
                                      UBaseType_t priority, StackType_t*, StaticTask_t*) {
  const std::lock_guard guard{fake::kernel->mutex};
  fake::Task& task = fake::kernel->tasks.emplace_back();
  task.priority = priority;
  task.thread = std::thread{[code, argument, &task] {
    fake::self = &task;
    try {
      code(argument);
    } catch (const fake::Ended&) {
    }
  }};
  return &task;
}
inline std::uint32_t ulTaskNotifyTake(BaseType_t, std::uint32_t) {
  fake::Kernel& kernel = *fake::kernel;
  std::unique_lock lock{kernel.mutex};
  fake::self->running = false;
  kernel.changed.notify_all();
  kernel.changed.wait(lock, [&] {
    if (kernel.ended) return true;
    if (fake::self->notified == 0) return false;
    for (const fake::Task& other : kernel.tasks)
      if (other.priority > fake::self->priority && (other.notified > 0 || other.running)) return false;
    return true;
  });
  if (kernel.ended) throw fake::Ended{};
  fake::self->running = true;
  return std::exchange(fake::self->notified, 0U);
}
inline void xTaskNotifyGive(TaskHandle_t task) {
  {
    const std::lock_guard guard{fake::kernel->mutex};
    ++task->notified;
  }
  fake::kernel->changed.notify_all();
}
inline void vTaskNotifyGiveFromISR(TaskHandle_t task, BaseType_t* switch_needed) {
  xTaskNotifyGive(task);
  *switch_needed = pdTRUE;
}
inline void portYIELD_FROM_ISR(BaseType_t) {}
inline BaseType_t xPortIsInsideInterrupt() {
  return fake::in_interrupt ? pdTRUE : pdFALSE;
}
inline void taskENTER_CRITICAL() {
  fake::kernel->critical.lock();
}
inline void taskEXIT_CRITICAL() {
  fake::kernel->critical.unlock();
}
inline UBaseType_t taskENTER_CRITICAL_FROM_ISR() {
  fake::kernel->critical.lock();
  return 0;
}
inline void taskEXIT_CRITICAL_FROM_ISR(UBaseType_t) {
  fake::kernel->critical.unlock();
}
