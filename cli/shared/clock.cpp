#include "cli/shared/clock.hpp"

#include <chrono>
#include <ctime>

#include "ocm/host/system_time.hpp"

namespace ocm::cli {

Clock::time_point Clock::now() noexcept {
  return time_point{std::chrono::steady_clock::now().time_since_epoch()};
}

base::Time unix_time() noexcept {
  return base::Time{std::chrono::system_clock::now().time_since_epoch()};
}

void sleep_for(base::Duration duration) noexcept {
  const timespec time = host::to_timespec(duration);
  ::nanosleep(&time, nullptr);
}

void sleep_until(Clock::time_point time) noexcept {
  const timespec until = host::to_timespec(time.time_since_epoch());
  ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
}

bool wait_for_input(std::span<pollfd> inputs, base::Duration longest) noexcept {
  const timespec time = host::to_timespec(longest);
  return ::ppoll(inputs.data(), inputs.size(), &time, nullptr) > 0;
}

}  // namespace ocm::cli
