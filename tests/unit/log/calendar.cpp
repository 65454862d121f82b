#include "ocm/log/calendar.hpp"

#include <catch2/catch.hpp>

#include "tests/unit/log/log_testing.hpp"

namespace log_calendar_test {

using namespace ocm::log;
using ocm::log::testing::Zone;

TEST_CASE("calendar: seconds of a date and back") {
  const Zone zone{"UTC0"};
  CHECK(seconds_of({1970, 1, 1, 0, 0, 0}) == 0);
  CHECK(seconds_of({2023, 11, 14, 22, 13, 20}) == 1'700'000'000);
  CHECK(seconds_of({1969, 12, 31, 23, 59, 59}) == -1);  // what mktime also says when it fails
  CHECK(seconds_of({1678, 1, 1, 0, 0, 0}) == -9'214'560'000);
  CHECK(local_time_of(1'700'000'000) == CalendarTime{2023, 11, 14, 22, 13, 20});
  CHECK(local_time_of(-1) == CalendarTime{1969, 12, 31, 23, 59, 59});
}

TEST_CASE("calendar: the time zone of this machine counts") {
  const Zone zone{"CET-1CEST,M3.5.0,M10.5.0/3"};  // Central Europe, without a data base of zones
  CHECK(seconds_of({2023, 11, 14, 23, 13, 20}) == 1'700'000'000);
  CHECK(seconds_of({2023, 7, 1, 14, 0, 0}) == 1'688'212'800);  // summer
  CHECK(local_time_of(1'688'212'800).hour == 14);
}

TEST_CASE(
    "calendar: any second comes back, in zones ahead of UTC and behind it, but an hour that comes twice") {
  ocm::test::Random random{11};
  for (const char* name :
       {"UTC0", "EST5", "CET-1", "IST-5:30", "CET-1CEST,M3.5.0,M10.5.0/3", "EST5EDT,M3.2.0,M11.1.0"}) {
    const Zone zone{name};
    const bool summer = std::string_view{name}.find(',') != std::string_view::npos;
    for (int i = 0; i < 300; ++i) {
      // 1970 to 2037, which a time_t of 32 bits holds, too.
      const auto seconds = static_cast<std::int64_t>(random.below(2'114'380'800));
      const CalendarTime local = local_time_of(seconds);
      CAPTURE(name, seconds);
      REQUIRE((local.month >= 1 && local.month <= 12 && local.day >= 1 && local.day <= 31));
      const auto again = seconds_of(local);
      REQUIRE(again);
      const std::int64_t off = *again - seconds;
      REQUIRE((off == 0 || (summer && (off == 3600 || off == -3600) && local_time_of(*again) == local)));
    }
  }
  const Zone west{"EST5"};
  CHECK(seconds_of({2023, 11, 14, 17, 13, 20}) == 1'700'000'000);
  CHECK(local_time_of(0) == CalendarTime{1969, 12, 31, 19, 0, 0});
  CHECK(CalendarTime{} == CalendarTime{1970, 1, 1, 0, 0, 0});
}

TEST_CASE("calendar: the hours before and behind the beginning of summer time") {
  {
    const Zone zone{"CET-1CEST,M3.5.0,M10.5.0/3"};  // at 1:00 UTC
    CHECK(seconds_of({2023, 3, 26, 1, 30, 0}) == 1'679'790'600);
    CHECK(seconds_of({2023, 3, 26, 3, 30, 0}) == 1'679'794'200);
  }
  const Zone zone{"EST5EDT,M3.2.0,M11.1.0"};  // at 7:00 UTC
  CHECK(seconds_of({2023, 3, 12, 1, 30, 0}) == 1'678'602'600);
  CHECK(seconds_of({2023, 3, 12, 3, 30, 0}) == 1'678'606'200);
}

TEST_CASE("calendar: a time zone that is set later counts from then on") {
  const Zone zone{"UTC0"};
  CHECK(local_time_of(0).hour == 0);
  setenv("TZ", "EST5", 1);
  CHECK(local_time_of(0).hour == 19);
}

TEST_CASE("calendar: what no calendar has") {
  const Zone zone{"UTC0"};
  CHECK(seconds_of({2024, 2, 29, 0, 0, 0}));
  CHECK(seconds_of({2000, 2, 29, 0, 0, 0}));
  CHECK(seconds_of({2023, 12, 31, 23, 59, 59}) == 1'704'067'199);
  CHECK(seconds_of({2261, 12, 31, 23, 59, 59}) == 9'214'646'399);
  for (const CalendarTime& wrong : {CalendarTime{2023, 2, 29, 0, 0, 0}, CalendarTime{1900, 2, 29, 0, 0, 0},
                                    CalendarTime{2023, 4, 31, 0, 0, 0}, CalendarTime{2023, 0, 1, 0, 0, 0},
                                    CalendarTime{2023, 13, 1, 0, 0, 0}, CalendarTime{2023, 1, 0, 0, 0, 0},
                                    CalendarTime{2023, 1, 1, 24, 0, 0}, CalendarTime{2023, 1, 1, 0, 60, 0},
                                    CalendarTime{2023, 1, 1, 0, 0, 60}, CalendarTime{2023, 1, 1, -1, 0, 0},
                                    CalendarTime{2023, 1, 1, 0, -1, 0}, CalendarTime{2023, 1, 1, 0, 0, -1},
                                    CalendarTime{2023, -1, 1, 0, 0, 0}, CalendarTime{2023, 1, -1, 0, 0, 0},
                                    CalendarTime{1677, 12, 31, 0, 0, 0}, CalendarTime{2262, 1, 1, 0, 0, 0}})
    CHECK_FALSE(seconds_of(wrong));
}

TEST_CASE("calendar: days of the week") {
  CHECK(weekday_of({1970, 1, 1, 0, 0, 0}) == 4);    // Thursday
  CHECK(weekday_of({2000, 2, 29, 0, 0, 0}) == 2);   // Tuesday
  CHECK(weekday_of({2023, 11, 14, 0, 0, 0}) == 2);  // Tuesday, as date(1) says
  CHECK(weekday_of({2023, 12, 31, 0, 0, 0}) == 0);  // Sunday
}

static_assert(month_of("Xyz") == 0 && month_of("M\x80r") == 3);

TEST_CASE("calendar: months in English and German") {
  CHECK(month_of("Jan") == 1);
  CHECK(month_of("January") == 1);
  CHECK(month_of("M\xE4r") == 3);       // Latin-1
  CHECK(month_of("M\xC3\xA4rz") == 3);  // UTF-8
  CHECK(month_of("Mrz") == 3);
  CHECK(month_of("M\x7Fr") == 0);
  CHECK(month_of("Mai") == 5);
  CHECK(month_of("Okt") == 10);
  CHECK(month_of("Dez") == 12);
  for (int i = 0; i < 12; ++i) CHECK(month_of(month_names[i]) == i + 1);
  for (const auto* wrong : {"", "M", "Ja", "jan", "Xyz", "M\xE4"}) CHECK(month_of(wrong) == 0);
}

}  // namespace log_calendar_test
