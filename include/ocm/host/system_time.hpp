/// Durations as the kernel takes them. Where its seconds have 32 bits, as on the operator's board, a longer
/// time becomes the longest that there is, 68 years: cut off it would be negative, which the kernel refuses.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <sys/time.h>
#include <time.h>

#include "ocm/base/time.hpp"

namespace ocm::host {

/// What has passed is zero.
[[nodiscard]] constexpr timespec to_timespec(base::Duration time) noexcept {
  constexpr std::int64_t second = 1'000'000'000;
  const std::int64_t ns = std::max<std::int64_t>(time.count(), 0);
  timespec result{};
  result.tv_sec = static_cast<decltype(result.tv_sec)>(
      std::min<std::int64_t>(ns / second, std::numeric_limits<decltype(result.tv_sec)>::max()));
  result.tv_nsec = static_cast<decltype(result.tv_nsec)>(ns % second);
  return result;
}

/// Rounded up, for here zero would be for ever.
[[nodiscard]] constexpr timeval to_timeval(base::Duration time) noexcept {
  const bool longest = time > base::Duration::max() - std::chrono::microseconds{1};
  const timespec spec = to_timespec(longest ? time : time + std::chrono::nanoseconds{999});
  timeval result{};
  result.tv_sec = spec.tv_sec;
  result.tv_usec = static_cast<decltype(result.tv_usec)>(spec.tv_nsec / 1000);
  if (result.tv_sec == 0 && result.tv_usec == 0) result.tv_usec = 1;
  return result;
}

}  // namespace ocm::host
