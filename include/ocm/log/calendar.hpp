/// Dates of logs that were written in the recorder's local time, with no word about its time zone (ASC, BLF).
/// They are read and written in the time zone of this machine (TZ), as the field's tools do. Once a file, not
/// once a frame.
#pragma once

#include <cstdint>
#include <ctime>
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

/// 0 Sunday .. 6 Saturday.
[[nodiscard]] inline int weekday_of(const CalendarTime& when) noexcept {
  constexpr int shifts[12] = {0, 3, 2, 5, 0, 3, 5, 1, 4, 6, 2, 4};  // [Sakamoto's method]
  const int year = when.year - (when.month < 3 ? 1 : 0);
  return (year + year / 4 - year / 100 + year / 400 + shifts[when.month - 1] + when.day) % 7;
}

/// Seconds since 1970 (UTC) of a local time; nothing for what no calendar has, and beyond 1678..2261, which
/// is what nanoseconds reach. Of an hour that comes twice, at the end of summer time, either one.
[[nodiscard]] inline std::optional<std::int64_t> seconds_of(const CalendarTime& local) noexcept {
  constexpr int days[12] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  if (local.year < 1678 || local.year > 2261 || local.month < 1 || local.month > 12) return std::nullopt;
  const bool leap = local.year % 4 == 0 && (local.year % 100 != 0 || local.year % 400 == 0);
  if (local.day < 1 || local.day > days[local.month - 1] + (leap && local.month == 2 ? 1 : 0))
    return std::nullopt;
  if (local.hour < 0 || local.hour > 23 || local.minute < 0 || local.minute > 59 || local.second < 0 ||
      local.second > 59)
    return std::nullopt;
  std::tm parts{};
  parts.tm_year = local.year - 1900;
  parts.tm_mon = local.month - 1;
  parts.tm_mday = local.day;
  parts.tm_hour = local.hour;
  parts.tm_min = local.minute;
  parts.tm_sec = local.second;
  parts.tm_isdst = -1;
  return std::mktime(&parts);
}

[[nodiscard]] inline CalendarTime local_time_of(std::int64_t seconds) noexcept {
  const auto when = static_cast<std::time_t>(seconds);  // which has 32 bits on some ARM hosts
  std::tm parts{};
  localtime_r(&when, &parts);
  return {parts.tm_year + 1900, parts.tm_mon + 1, parts.tm_mday, parts.tm_hour, parts.tm_min, parts.tm_sec};
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
