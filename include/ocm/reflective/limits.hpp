/// What an actuator may be commanded in a configuration: values and how fast they change. For every set
/// point that passes the operator, from any source.
///
/// Pure steps on raw numbers; O(limits) a set point; no heap, no clock.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/base/time.hpp"
#include "ocm/reflective/operator.hpp"

namespace ocm::reflective {

/// How far a value may change in `passed`, in whole raw numbers rounded down, but one in the time that one
/// takes: who asks often goes slower than the limit, never faster. INT64_MAX: any.
[[nodiscard]] constexpr std::int64_t change_within(const Limit& limit, base::Duration passed) noexcept {
  if (limit.per_second == 0) return INT64_MAX;
  const std::int64_t whole = passed.count() / 1'000'000'000;
  const std::int64_t rest = passed.count() % 1'000'000'000;
  std::int64_t change = 0;
  std::int64_t part = 0;
  if (__builtin_mul_overflow(limit.per_second, whole, &change)) return INT64_MAX;
  if (__builtin_mul_overflow(limit.per_second, rest, &part))
    part = limit.per_second / 1'000'000'000 * rest;
  else
    part /= 1'000'000'000;
  return __builtin_add_overflow(change, part, &change) ? INT64_MAX : change;
}

/// Of the time since the last set point so much counts at most: what was not commanded for a while does not
/// jump. [decided: five set points a watchdog's time of 500 ms]
inline constexpr base::Duration longest_pause{100'000'000};

/// A value within a limit, coming from `last`.
[[nodiscard]] constexpr std::int64_t limited(const Limit& limit, std::int64_t value, std::int64_t last,
                                             base::Duration passed) noexcept {
  const std::int64_t change = change_within(limit, passed < base::Duration{0} ? base::Duration{0} : passed);
  std::int64_t low = 0;
  std::int64_t high = 0;
  if (__builtin_sub_overflow(last, change, &low)) low = INT64_MIN;
  if (__builtin_add_overflow(last, change, &high)) high = INT64_MAX;
  return std::clamp(std::clamp(value, low, high), limit.min, limit.max);
}

/// Holds the set points of a configuration within its limits; N limits at most.
template <std::size_t N>
class Limiter {
 public:
  /// From now on these. What was commanded last is not known, but for what `commanded` says.
  constexpr void enter(std::span<const Limit> limits) noexcept {
    limits_ = limits.first(std::min(limits.size(), N));
    last_ = {};
  }
  /// This was sent as it is: the next one starts from it.
  constexpr void commanded(std::uint16_t topic, std::span<const std::int64_t> raw, base::Time now) noexcept {
    for (std::size_t i = 0; i < limits_.size(); ++i)
      if (limits_[i].topic == topic)
        last_[i] = {limits_[i].field < raw.size() ? raw[limits_[i].field] : 0, now, true};
  }
  /// Changes a set point to what is permitted, and notes it as commanded. Returns how many values it changed.
  /// The first of a configuration starts from rest.
  constexpr std::size_t permit(std::uint16_t topic, std::span<std::int64_t> raw, base::Time now) noexcept {
    std::size_t changed = 0;
    for (std::size_t i = 0; i < limits_.size(); ++i) {
      const Limit& limit = limits_[i];
      if (limit.topic != topic || limit.field >= raw.size()) continue;
      Last& last = last_[i];
      const base::Duration passed = last.known ? std::min(now - last.at, longest_pause) : base::Duration{0};
      const std::int64_t value = limited(limit, raw[limit.field], last.value, passed);
      changed += value != raw[limit.field] ? 1U : 0U;
      raw[limit.field] = value;
      // Time in which nothing could change yet is kept, or else many small steps would never move it.
      if (!last.known || value != last.value || change_within(limit, passed) > 0) last.at = now;
      last.value = value;
      last.known = true;
    }
    return changed;
  }

 private:
  struct Last {
    std::int64_t value = 0;
    base::Time at{};
    bool known = false;
  };
  std::span<const Limit> limits_{};
  std::array<Last, N> last_{};
};

}  // namespace ocm::reflective
