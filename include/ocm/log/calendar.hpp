/// Dates of logs that were written in the recorder's local time, with no word about its time zone (ASC, BLF).
/// They are read and written in the time zone of this machine (TZ), as the field's tools do. Once a file, not
/// once a frame.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <ctime>
#include <limits>
#include <optional>
#include <string_view>

#include "ocm/base/text.hpp"

namespace ocm::log {

/// What a calendar and a clock on the wall show.
struct CalendarTime {
  int year = 1970;
  int month = 1;   ///< 1..12
  int day = 1;     ///< 1..31
  int hour = 0;    ///< 0..23
  int minute = 0;  ///< 0..59
  int second = 0;  ///< 0..59
  friend bool operator==(const CalendarTime&, const CalendarTime&) = default;
};

namespace detail {

[[nodiscard]] constexpr std::chrono::year_month_day date_of(const CalendarTime& when) noexcept {
  return {std::chrono::year{when.year}, std::chrono::month{static_cast<unsigned>(when.month)},
          std::chrono::day{static_cast<unsigned>(when.day)}};
}

/// Seconds that local clocks are ahead of UTC at a moment; where time_t has 32 bits, beyond it what holds at
/// its end.
[[nodiscard]] inline std::int64_t ahead_of_utc(std::int64_t seconds) noexcept {
  using Limits = std::numeric_limits<std::time_t>;
  const auto when = static_cast<std::time_t>(std::clamp<std::int64_t>(seconds, Limits::min(), Limits::max()));
  std::tm parts{};
  ::tzset();
  ::localtime_r(&when, &parts);
  return parts.tm_gmtoff;
}

}  // namespace detail

/// 0 Sunday .. 6 Saturday.
[[nodiscard]] constexpr int weekday_of(const CalendarTime& when) noexcept {
  return static_cast<int>(std::chrono::weekday{std::chrono::sys_days{detail::date_of(when)}}.c_encoding());
}

/// Seconds since 1970 (UTC) of a local time; nothing for what no calendar has, and beyond 1678..2261, which
/// is what nanoseconds reach. Of an hour that comes twice, at the end of summer time, either one.
[[nodiscard]] inline std::optional<std::int64_t> seconds_of(const CalendarTime& local) noexcept {
  if (local.year < 1678 || local.year > 2261 || local.month < 1 || local.day < 1) return std::nullopt;
  const auto date = detail::date_of(local);
  if (!date.ok() || local.hour < 0 || local.hour > 23 || local.minute < 0 || local.minute > 59 ||
      local.second < 0 || local.second > 59)
    return std::nullopt;
  const std::int64_t days = std::chrono::sys_days{date}.time_since_epoch().count();
  const std::int64_t as_utc = ((days * 24 + local.hour) * 60 + local.minute) * 60 + local.second;
  return as_utc - detail::ahead_of_utc(as_utc - detail::ahead_of_utc(as_utc));
}

[[nodiscard]] inline CalendarTime local_time_of(std::int64_t seconds) noexcept {
  const std::chrono::sys_seconds local{std::chrono::seconds{seconds + detail::ahead_of_utc(seconds)}};
  const auto days = std::chrono::floor<std::chrono::days>(local);
  const std::chrono::year_month_day date{days};
  const std::chrono::hh_mm_ss clock{local - days};
  return {static_cast<int>(date.year()),
          static_cast<int>(static_cast<unsigned>(date.month())),
          static_cast<int>(static_cast<unsigned>(date.day())),
          static_cast<int>(clock.hours().count()),
          static_cast<int>(clock.minutes().count()),
          static_cast<int>(clock.seconds().count())};
}

inline constexpr std::string_view month_names[12] = {"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                                     "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
inline constexpr std::string_view weekday_names[7] = {"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};

/// 1..12 of an English or German name of a month, short or long, in Latin-1 or UTF-8; 0: it is none.
[[nodiscard]] constexpr int month_of(std::string_view name) noexcept {
  const std::string_view three = name.substr(0, 3);
  for (int i = 0; i < 12; ++i)
    if (three == month_names[i]) return i + 1;
  if (three == "Mrz" || (name.size() > 2 && name[0] == 'M' && static_cast<unsigned char>(name[1]) >= 0x80))
    return 3;
  return three == "Mai" ? 5 : three == "Okt" ? 10 : three == "Dez" ? 12 : 0;
}

}  // namespace ocm::log
