#include "ocm/log/asc.hpp"

#include <algorithm>

#include <catch2/catch.hpp>

#include "tests/unit/log/log_testing.hpp"

namespace log_asc_test {

using namespace ocm;
using namespace ocm::log;
using log::testing::at;
using log::testing::read_all;
using log::testing::Zone;

constexpr std::int64_t second = 1'000'000'000;

const std::string head = "date Tue Nov 14 10:13:20.000 pm 2023\nbase hex  timestamps absolute\n";
constexpr std::int64_t start = 1'700'000'000 * second;

/// The entry of a single line, behind a head; REQUIREs that there is one and nothing to complain of.
Entry entry_of(std::string_view line, std::string_view before = head) {
  const Zone zone{"UTC0"};
  INFO(line);
  const auto log = read_all<AscReader>(std::string{before} + std::string{line} + "\n");
  REQUIRE(log.complained == 0);
  REQUIRE(log.entries.size() == 1);
  return log.entries[0];
}
/// Why a single line is refused.
Cause cause_of(std::string_view line) {
  const auto log = read_all<AscReader>(head + std::string{line} + "\n");
  INFO(line);
  REQUIRE(log.entries.empty());
  REQUIRE(log.complained == 1);
  CHECK(log.complaints[0].place == Place{3, true});
  CHECK(log.complaints[0].detail.substr(0, 20) == line.substr(0, 20));  // long ones are cut
  return log.complaints[0].cause;
}
/// The nanoseconds since 1970 that a date is read as, -1 for none.
std::int64_t date_of(std::string_view date) {
  const Zone zone{"UTC0"};
  return asc::parse_date(asc::Words{date}).value_or(-1);
}

// Bits of the column of flags. [Vector, CAN Log & Trigger ASC Logging Format]
static_assert(asc::remote_flag == 0x10 && asc::fd_flag == 0x1000);
static_assert(asc::switch_flag == 0x2000 && asc::state_flag == 0x4000);
static_assert(asc::same("AZ", "az") && asc::same("az", "az") && !asc::same("AZ", "ay"));
// Length codes: a hexadecimal digit, or 10 to 15.
static_assert(asc::parse_dlc("0") == 0 && asc::parse_dlc("9") == 9 && asc::parse_dlc("f") == 15);
static_assert(asc::parse_dlc("10") == 10 && asc::parse_dlc("15") == 15 && !asc::parse_dlc("16"));
static_assert(!asc::parse_dlc("") && !asc::parse_dlc("007") && !asc::parse_dlc("x"));

Entry directed(Entry entry, Direction direction) {
  entry.direction = direction;
  return entry;
}

TEST_CASE("asc: lines as log2asc writes them") {
  // log2asc 2020.11 -I a.log can0 can1
  Entry wanted{at(start), {0x123, 8, {0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88}}};
  wanted.direction = Direction::received;
  CHECK(entry_of("   0.000000 1  123             Rx   d 8 11 22 33 44 55 66 77 88") == wanted);

  Entry remote = entry_of("   0.000100 1  123             Tx   r 5");
  CHECK(remote ==
        directed(Entry{at(start + 100'000), {0x123, 5, {}, can::Format::base_remote}}, Direction::sent));

  const Entry extended = entry_of("   0.100000 2  1FFFFFFFx       Rx   d 0");
  CHECK(extended == directed(Entry{at(start + second / 10), {0x1FFFFFFF, 0, {}, can::Format::extended}},
                             Direction::received));

  const Entry fd = entry_of(
      "   0.200000 CANFD   1 Rx        123                                   1 0 9 12 11 22 33 44 55 66 77 "
      "88 AA BB "
      "CC DD   130000  130     3000 0 0 0 0 0");
  CHECK(fd.length == 12);
  CHECK(fd.data[11] == 0xDD);
  CHECK(fd.flags == (flag::fd | flag::bit_rate_switch));

  const Entry error = entry_of("   0.300000 2  ErrorFrame");
  CHECK(is_bus_error(error));
  CHECK(error.direction == Direction::unknown);

  // log2asc -f: classic frames in the form of CAN FD
  const Entry as_fd = entry_of(
      "   0.000100 CANFD   1 Rx        123                                   0 0 5  0   130000  130       10 "
      "0 0 0 0 0");
  CHECK(as_fd.format == can::Format::base_remote);
  CHECK(as_fd.length == 5);
  CHECK_FALSE(as_fd.is_fd());
  CHECK(entry_of("0.0 CANFD   1 Rx        123                                   0 0 2  2 11 22   130000  130 "
                 "       0 0 0 0 0 0")
            .flags == 0);
}

TEST_CASE("asc: lines as python-can writes them") {
  CHECK(entry_of(" 0.000000 1  123             Rx   d 2 11 22").length == 2);
  CHECK(entry_of(" 0.000000 1  123             Rx   r 2").length == 2);
  CHECK(entry_of(" 0.000000 1  ErrorFrame").format == can::Format::error);
  const Entry fd = entry_of(
      " 0.500000 CANFD   3 Tx    1234567x                                    1 1 9 12 00 01 02 03 04 05 06 "
      "07 08 09 0A "
      "0B        0    0     7000        0        0        0        0        0");
  CHECK(fd.flags == (flag::fd | flag::bit_rate_switch | flag::error_state));
  CHECK(fd.format == can::Format::extended);
  CHECK(fd.direction == Direction::sent);
}

TEST_CASE("asc: lines as newer tools of Vector write them") {
  // Duration, bits and the number of the identifier behind the data; names in a column of their own.
  CHECK(entry_of("0.003040 1 123 Tx d 2 00 01 Length = 768000 BitCount = 67 ID = 291").id == 0x123);
  CHECK(entry_of("0.003040 1 EngineData Rx d 1 7F Length = 768000 BitCount = 67 ID = 291").id == 0x123);
  CHECK(entry_of("0.003040 1 BED Rx d 1 7F Length = 768000 BitCount = 67 ID = 291").id == 0x123);
  const Entry extended =
      entry_of("0.016 1 54C5638x Tx d 1 00 Length = 1704000 BitCount = 145 ID = 88888888x");
  CHECK(extended.id == 0x54C5638);
  CHECK(extended.format == can::Format::extended);
  CHECK(entry_of("0.01 1 Gear Rx d 1 7F Length = 0 BitCount = 0 ID = 88888888x").id == 88888888);
  const Entry named = entry_of(
      "30.300 CANFD 2 Rx 300 Generic_Name_12 1 0 8 8 01 02 03 04 05 06 07 08 102203 133 303000 e0006659");
  CHECK(named.id == 0x300);
  CHECK(named.data[7] == 8);
  CHECK(named.is_fd());
  CHECK(entry_of("2.501010 1 ErrorFrame\tECC: 10100010").format == can::Format::error);
  CHECK(entry_of("2.5 2 ErrorFrame\tFlags = 0xe\tCodeExt = 0x20a2\tCode = 0x82\tID = 0\tDLC = 0").format ==
        can::Format::error);
  const Entry error =
      entry_of("30.806898 CANFD 5 Tx ErrorFrame Not Acknowledge error, dominant error flag 44 0 0 f");
  CHECK(error.format == can::Format::error);
  CHECK(error.direction == Direction::sent);
  CHECK(entry_of("0.1 1 123 Rx d f 00 01 02 03 04 05 06 07").raw_dlc == 15);
  CHECK(entry_of("0.1 1 123 Rx r Length = 0").length == 0);  // before version 8.5: no length
  CHECK(entry_of("0.1 1 123 Rx r").length == 0);
}

TEST_CASE("asc: decimal numbers") {
  const std::string decimal = "date Tue Nov 14 10:13:20 pm 2023\nbase dec  timestamps absolute\n";
  const Entry entry = entry_of("0.5 1 291x Rx d 3 255 0 17", decimal);
  CHECK(entry == directed(Entry{at(start + second / 2), {291, 3, {255, 0, 17}, can::Format::extended}},
                          Direction::received));
  CHECK(entry_of("0.5 CANFD 1 Rx 291 0 0 13 32 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 1 2 3 4 5 6 7 8 9 10 "
                 "11 12 13 14 "
                 "15 255 0 0 1000 0",
                 decimal)
            .data[31] == 255);
  for (const char* const byte : {"256", "-1", "FF"}) {
    const auto log = read_all<AscReader>(decimal + "0.5 1 291x Rx d 1 " + byte + "\n");
    CHECK(log.entries.empty());
    REQUIRE(log.complained == 1);
    CHECK(log.complaints[0].cause == Cause::length);
  }
}

TEST_CASE("asc: dates in English and German, 12 and 24 hours") {
  constexpr std::int64_t ms = 1'000'000;
  CHECK(date_of("Tue Nov 14 10:13:20.123 pm 2023") == start + 123 * ms);
  CHECK(date_of("Tue Nov 14 10:13:20.123 PM 2023") == start + 123 * ms);
  CHECK(date_of("Tue Nov 14 22:13:20 2023") == start);
  CHECK(date_of("Die Nov 14 22:13:20.001 2023") == start + ms);
  CHECK(date_of("Sam M\xE4r 4 15:06:13.191 2017") == 1'488'639'973 * second + 191 * ms);
  CHECK(date_of("Mit Dez 31 23:59:59 2025") == 1'767'225'599 * second);
  CHECK(date_of("Tue Nov 14 12:00:00 am 2023") == 1'699'920'000 * second);  // midnight
  CHECK(date_of("Tue Nov 14 12:00:00 pm 2023") == 1'699'963'200 * second);
  CHECK(date_of("Tue Nov 14 00:00:00.123456789 2023") == 1'699'920'000 * second + 123'456'789);
  CHECK(date_of("Tue Nov 14 12:00:00 AM 2023") == 1'699'920'000 * second);
  CHECK(date_of("Tue Nov 14 23:59:59.999999999 2023") == 1'700'006'399 * second + 999'999'999);
  for (const auto* wrong : {"Tue Nov 14 x:13:20 2023",
                            "Tue Nov 14 10:x:20 2023",
                            "Tue Nov 14 10:13:x 2023",
                            "Tue Nov x 10:13:20 2023",
                            "Tue Nov 14 10:13:20 x",
                            "Tue Nov 32 10:13:20 2023",
                            "",
                            "Tue",
                            "Tue Nov 14",
                            "Tue Nov 14 10:13 2023",
                            "Tue Nov 14 10:13:20",
                            "Tue Nov 31 10:13:20 2023",
                            "Tue Nux 14 10:13:20 2023",
                            "Tue Nov 14 13:13:20 pm 2023",
                            "Tue Nov 14 00:13:20 am 2023",
                            "Tue Nov 14 24:13:20 2023",
                            "Tue Nov 14 10:60:20 2023",
                            "Tue Nov 14 10:13:60 2023",
                            "Tue Nov 14 10:13:20 12023",
                            "Tue Nov -4 10:13:20 2023",
                            "Tue Nov 14 10:13:20.1234567890 2023"}) {
    INFO(wrong);
    CHECK(date_of(wrong) == -1);
  }
}

TEST_CASE("asc: 0 to 9 digits of a second") {
  CHECK(asc::parse_stamp("12") == 12 * second);
  CHECK(asc::parse_stamp("12.") == 12 * second);
  CHECK(asc::parse_stamp("0.0001") == 100'000);
  CHECK(asc::parse_stamp("0.123456789") == 123'456'789);
  CHECK(asc::parse_stamp("9223372036.854775807") == INT64_MAX);
  CHECK_FALSE(asc::parse_stamp("9223372036.854775808"));
  CHECK_FALSE(asc::parse_stamp("9999999999.999999999"));
  CHECK_FALSE(asc::parse_stamp("12345678901"));
  CHECK_FALSE(asc::parse_stamp("00000000001"));
  CHECK_FALSE(asc::parse_stamp("9999999999"));
  CHECK_FALSE(asc::parse_stamp("0.1234567890"));
  CHECK_FALSE(asc::parse_stamp("1.2.3"));
  CHECK_FALSE(asc::parse_stamp("1e3"));
}

TEST_CASE("asc: without a head, times count from 1970 and numbers are hexadecimal") {
  const Entry entry = entry_of("0.5 1 123 Rx d 1 7F", "");
  CHECK(entry.time == at(second / 2));
  CHECK(entry.id == 0x123);
  CHECK(entry.data[0] == 0x7F);
  const auto relative = read_all<AscReader>("base hex  timestamps relative\n0.5 1 123 Rx d 0\n");
  CHECK(relative.entries.at(0).time == at(second / 2));
}

TEST_CASE("asc: any blanks lie between bytes, and some columns may be missing") {
  for (const char* const line :
       {"0.1 1 123 Rx d 3 11 22 33", "0.1 1 123 Rx d 3  11\t22   33 ", "0.1 1 123 Rx d 3 11\t22 33\t"}) {
    const Entry entry = entry_of(line);
    CHECK((entry.length == 3 && entry.data[0] == 0x11 && entry.data[1] == 0x22 && entry.data[2] == 0x33));
  }
  CHECK(entry_of("0.1 CANFD 1 Rx 123 0 0 1 1 7F").is_fd());  // neither flags nor what lies before them
}

TEST_CASE("asc: lines come out of a pipe when they come in") {
  const std::string lines = head + "0.1 1 123 Rx d 0\n0.2 1 123 Rx d 0\n0.3 1 12";
  test::Drops source{lines, lines.size()};
  Input input{source};
  AscReader reader{input};
  std::vector<Entry> some(8);
  CHECK(reader.read(some) == 2);
  CHECK(source.reads == 1);
}

TEST_CASE("asc: where the source knows that it was cut, half a line is none") {
  const std::string lines = head + "0.1 1 123 Rx d 0\n0.2 1 123 Rx d 0";
  test::Drops source{lines, 1000, "cut"};
  const auto log = log::testing::read_from<AscReader>(source, 8);
  CHECK(log.entries.size() == 1);
  REQUIRE(log.complained == 1);
  CHECK(log.complaints[0].cause == Cause::truncated);
}

TEST_CASE("asc: relative times count from the line before, whatever it holds") {
  const Zone zone{"UTC0"};
  const auto log = read_all<AscReader>(
      "date Tue Nov 14 10:13:20.000 pm 2023\nbase hex  timestamps relative\n"
      "0.5 Start of measurement\n0.25 1 123 Rx d 0\n1.000000 1  Statistic: D 1 R 0\n0.25 1 123 Rx d 0\n");
  REQUIRE(log.entries.size() == 2);
  CHECK(log.entries[0].time == at(start + 3 * second / 4));
  CHECK(log.entries[1].time == at(start + 2 * second));
}

TEST_CASE("asc: two frames at once in a log of relative times have one time") {
  const Zone zone{"UTC0"};
  const auto log = read_all<AscReader>(
      "date Tue Nov 14 10:13:20.000 pm 2023\nbase hex  timestamps relative\n"
      "Begin Triggerblock Tue Nov 14 10:13:20.000 pm 2023\n"
      "0.000000 Start of measurement\n0.5 1 123 Rx d 0\n0.000000 1 124 Rx d 0\n0.25 1 125 Rx d 0\n");
  REQUIRE(log.entries.size() == 3);
  CHECK(log.entries[0].time == at(start + second / 2));
  CHECK(log.entries[1].time == at(start + second / 2));
  CHECK(log.entries[2].time == at(start + 3 * second / 4));
}

TEST_CASE("asc: a block that begins at 0 has its own date") {
  const Zone zone{"UTC0"};
  // python-can: the head has the time of writing, the block that of the first frame.
  const auto own = read_all<AscReader>(
      "date Wed Nov 15 10:13:20.000 pm 2023\nbase hex  timestamps absolute\n"
      "Begin Triggerblock Tue Nov 14 10:13:20.500 pm 2023\n"
      " 0.000000 Start of measurement\n 0.5 1 123 Rx d 0\nEnd TriggerBlock\n");
  CHECK(own.entries.at(0).time == at(start + second));
  // CANoe: times count from the head's date; a trigger comes later.
  const auto trigger = read_all<AscReader>(head +
                                           "Begin Triggerblock Tue Nov 14 10:13:30.000 pm 2023\n"
                                           "10.000000 1 123 Rx d 0\n");
  CHECK(trigger.entries.at(0).time == at(start + 10 * second));
}

TEST_CASE("asc: in each block of a log of relative times they count from its own date") {
  const Zone zone{"UTC0"};
  const auto log = read_all<AscReader>(
      "date Tue Nov 14 10:13:20.000 pm 2023\nbase hex  timestamps relative\n"
      "Begin Triggerblock Tue Nov 14 10:13:20.000 pm 2023\n"
      "0.000000 Start of measurement\n0.5 1 123 Rx d 0\nEnd TriggerBlock\n"
      "Begin Triggerblock Tue Nov 14 10:13:30.000 pm 2023\n"
      "0.000000 Start of measurement\n0.25 1 123 Rx d 0\nEnd TriggerBlock\n");
  REQUIRE(log.entries.size() == 2);
  CHECK(log.entries[0].time == at(start + second / 2));
  CHECK(log.entries[1].time == at(start + 10 * second + second / 4));
}

TEST_CASE("asc: relative times that add up to more than 64 bits hold are said") {
  const auto log = read_all<AscReader>(
      "base hex  timestamps relative\n9223372036.0 1 123 Rx d 0\n9223372036.0 1 123 Rx d 0\n");
  CHECK(log.entries.size() == 1);
  REQUIRE(log.complained == 1);
  CHECK(log.complaints[0].cause == Cause::time);
}

TEST_CASE("asc: what is no frame is passed over without a word") {
  const Zone zone{"UTC0"};
  const auto log = read_all<AscReader>(
      head +
      "internal events logged\r\nno internal events logged\n// version 9.0.0\n//0.000000 previous log file: "
      "a.asc\n\n"
      "previous log file: a.asc\nBegin Triggerblock Tue Nov 14 10:13:20.500 pm 2023\n"
      "   0.000000 Start of measurement\n"
      "   0.015991 CAN 1 Status:chip status error passive - TxErr: 132 RxErr: 0\n"
      "   1.015991 1  Statistic: D 0 R 0 XD 0 XR 0 E 0 O 0 B 0.00%\n"
      "   1.5 1  OverloadFrame\n   1.6 SV: 1 0 1 ::x = 5\n   1.7 Log Trigger Event\n   1.8 1 123 TxRq d 0\n"
      "   1.9 CANFD 1 TxRq 123 0 0 0 0 0 0 1000\n"
      "   2.0 1 123 Rx d 0\r\nEnd TriggerBlock\n");
  CHECK(log.entries.size() == 1);
  CHECK(log.complained == 0);
}

TEST_CASE("asc: channels are interfaces") {
  const auto log =
      read_all<AscReader>(head + "0.1 3 1 Rx d 0\n0.1 1 1 Rx d 0\n0.1 CANFD 12 Rx 1 0 0 0 0 0 0 1000\n");
  CHECK(log.names == std::vector<std::string>{"can2", "can0", "can11"});
  CHECK(read_all<AscReader>(head + "0.1 255 1 Rx d 0\n").names.at(0) == "can254");
}

TEST_CASE("asc: lines that are wrong, each with its cause") {
  CHECK(cause_of("nonsense") == Cause::syntax);
  CHECK(cause_of("date Tue Nov 31 10:13:20 2023") == Cause::time);
  CHECK(cause_of("0.1e3 1 123 Rx d 0") == Cause::time);
  CHECK(cause_of("9223372036 1 123 Rx d 0") == Cause::time);  // with the date, beyond 2262
  CHECK(cause_of("0.1 256 123 Rx d 0") == Cause::syntax);
  CHECK(cause_of("0.1 1x 123 Rx d 0") == Cause::syntax);
  CHECK(cause_of("0.1 1 123 Rx q 0") == Cause::syntax);
  CHECK(cause_of("0.1 1 800 Rx d 0") == Cause::identifier);
  CHECK(cause_of("0.1 1 20000000x Rx d 0") == Cause::identifier);
  CHECK(cause_of("0.1 1 EngineData Rx d 1 7F") == Cause::unsupported);
  CHECK(cause_of("0.1 1 123 Rx d 2 11") == Cause::length);
  CHECK(cause_of("0.1 1 123 Rx d 2 11 2") == Cause::length);
  CHECK(cause_of("0.1 1 123 Rx d 2 11 222") == Cause::length);
  CHECK(cause_of("0.1 1 123 Rx d 2 11 G2") == Cause::length);
  CHECK(cause_of("0.1 1 123 Rx d 16 11") == Cause::length);
  CHECK(cause_of("0.1 1 123 Rx d") == Cause::length);
  CHECK(cause_of("0.1 CANXL 1 Rx CBFF 0 0 123 0 0 0 0") == Cause::unsupported);
  CHECK(cause_of("0.1 CANFD 1 Up 123 0 0 0 0 0 0 1000") == Cause::syntax);
  CHECK(cause_of("0.1 CANFD 1 Rx 123 2 2 0 0 0 0 1000") == Cause::syntax);
  CHECK(cause_of("0.1 CANFD 1 Rx 123 0 2 0 0 0 0 1000") == Cause::syntax);
  CHECK(cause_of("0.1 CANFD 1 Rx 123 name 2 0 0 0 0 0 1000") == Cause::syntax);
  CHECK(cause_of("0.1 CANFD 1 Rx 123 0 0 x 0 0 0 1000") == Cause::length);
  CHECK(cause_of("0.1 CANFD 1 Rx 123 0 0 0 x 0 0 1000") == Cause::length);
  // A byte has two digits; fewer or more bytes than their code says.
  CHECK(cause_of("0.1 CANFD 1 Rx 123 0 0 8 8 1 2 3 4 5 6 7 8 0 0 1000") == Cause::length);
  CHECK(cause_of("0.1 CANFD 1 Rx 123 0 0 9 8 01 02 03 04 05 06 07 08 0 0 1000") == Cause::length);
  CHECK(cause_of("0.1 CANFD 1 Rx 123 0 0 7 8 01 02 03 04 05 06 07 08 0 0 1000") == Cause::length);
  CHECK(cause_of("0.1 CANFD 1 Rx 123 0 0 9 12 01 02 03 04 05 06 07 08 0 0 1000") == Cause::length);
  CHECK(cause_of("0.1 CANFD 1 Rx 123 0 0 f 65 01") == Cause::length);
  CHECK(cause_of("0.1 CANFD 1 Rx 123 0 0 9 12 01 02 03 04 05 06 07 08 09 0A 0B 0C 0 0 0") == Cause::length);
}

TEST_CASE("asc: the hours of a day are twelve twice, and noon is pm") {
  const Zone zone{"UTC0"};
  for (const auto& [seconds, written] :
       std::vector<std::pair<std::int64_t, std::string>>{{1'699'920'000, "12:00:00.000 am"},
                                                         {1'699'923'600, "01:00:00.000 am"},
                                                         {1'699'963'199, "11:59:59.000 am"},
                                                         {1'699'963'200, "12:00:00.000 pm"},
                                                         {1'699'966'800, "01:00:00.000 pm"}}) {
    Interfaces interfaces;
    interfaces.add("can0");
    const std::vector<Entry> entries{{at(seconds * second), {0x1, 0, {}}}};
    AscWriter writer;
    const std::string text = log::testing::write_all(writer, entries, interfaces);
    CHECK(text.starts_with("date Tue Nov 14 " + written + " 2023\n"));
  }
}

TEST_CASE("asc: what is written") {
  const Zone zone{"UTC0"};
  Interfaces interfaces;
  interfaces.add("can0");
  interfaces.add("can1");
  std::vector<Entry> entries;
  entries.push_back(directed({at(start + 123'456'000), {0x123, 2, {0x11, 0x2F}}}, Direction::sent));
  entries.push_back({at(start + second), {0x1F334455, 5, {}, can::Format::extended_remote}, 1});
  entries.push_back({at(start + 12'345 * second), {0x80, 8, {}, can::Format::error}, 1});
  Entry fd{at(start + 12'345 * second), {0x7, 0, {}}};
  fd.flags = flag::fd | flag::error_state;
  fd.length = 12;
  for (std::uint8_t i = 0; i < 12; ++i) fd.data[i] = static_cast<std::uint8_t>(0xA0 + i);
  entries.push_back(fd);
  AscWriter writer;
  CHECK(log::testing::write_all(writer, entries, interfaces) ==
        "date Tue Nov 14 10:13:20.000 pm 2023\n"
        "base hex  timestamps absolute\n"
        "internal events logged\n"
        "Begin Triggerblock Tue Nov 14 10:13:20.000 pm 2023\n"
        "   0.000000 Start of measurement\n"
        "   0.123456 1  123             Tx   d 2 11 2F\n"
        "   1.000000 2  1F334455x       Rx   r 5\n"
        "12345.000000 2  ErrorFrame\n"
        "12345.000000 CANFD   1 Rx          7                                   0 1 9 12 A0 A1 A2 A3 A4 A5 "
        "A6 A7 A8 A9 "
        "AA AB        0    0     5000 0 0 0 0 0\n"
        "End TriggerBlock\n");
  CHECK_FALSE(writer.lost().any());
}

TEST_CASE("asc: the flags of a CAN FD frame are written twice: as digits, and in the column of flags") {
  const Zone zone{"UTC0"};
  const auto written = [](std::uint8_t flags) {
    Interfaces interfaces;
    interfaces.add("can0");
    Entry entry{at(start), {0x7, 0, {}}};
    entry.flags = static_cast<std::uint8_t>(flag::fd | flags);
    AscWriter writer;
    return log::testing::write_all(writer, std::vector{entry}, interfaces);
  };
  CHECK_THAT(written(0), Catch::Contains(" 0 0 0  0        0    0     1000 0 0"));
  CHECK_THAT(written(flag::bit_rate_switch), Catch::Contains(" 1 0 0  0        0    0     3000 0 0"));
  CHECK_THAT(written(flag::error_state), Catch::Contains(" 0 1 0  0        0    0     5000 0 0"));
  CHECK_THAT(written(flag::bit_rate_switch | flag::error_state),
             Catch::Contains(" 1 1 0  0        0    0     7000 0 0"));
}

TEST_CASE("asc: what is behind an identifier stands in the same column, however long that is") {
  const Zone zone{"UTC0"};
  const auto column_of = [](std::uint32_t id, can::Format format, bool fd) {
    Interfaces interfaces;
    interfaces.add("can0");
    Entry entry{at(start), {id, 0, {}, format}};
    if (fd) entry.flags = flag::fd;
    AscWriter writer;
    const std::string text = log::testing::write_all(writer, std::vector{entry}, interfaces);
    const std::size_t line = text.find("   0.000000 ", text.find("measurement"));
    REQUIRE(line != std::string::npos);
    return text.find(fd ? " 0 0 0  0 " : "Rx   d 0", line) - line;
  };
  using enum can::Format;
  for (const bool fd : {false, true}) {
    const std::size_t column = fd ? 69 : 31;
    CHECK(column_of(0x0, base, fd) == column);
    CHECK(column_of(0x7FF, base, fd) == column);
    CHECK(column_of(0x0, extended, fd) == column);
    CHECK(column_of(0x1234567, extended, fd) == column);
  }
}

TEST_CASE("asc: a log that begins before 1970 begins with a whole second") {
  const Zone zone{"UTC0"};
  Interfaces interfaces;
  interfaces.add("can0");
  AscWriter writer;
  const std::vector<Entry> entries{{at(-second / 2), {0x1, 0, {}}}};
  const std::string text = log::testing::write_all(writer, entries, interfaces);
  CHECK(text.starts_with("date Wed Dec 31 11:59:59.000 pm 1969\n"));
  CHECK_THAT(text, Catch::Contains("\n   0.500000 1  1 "));
  CHECK_FALSE(writer.lost().any());
}

TEST_CASE("asc: the length of a CAN FD frame is right-aligned in two columns") {
  const Zone zone{"UTC0"};
  Interfaces interfaces;
  interfaces.add("can0");
  AscWriter writer;
  Entry some{at(start), {0x123, 3, {1, 2, 3}}}, many = some;
  some.flags = many.flags = flag::fd;
  many.length = 12;
  std::fill_n(many.data.begin() + 8, 4, std::uint8_t{0});
  const std::string text = log::testing::write_all(writer, std::vector{some, many}, interfaces);
  CHECK_THAT(text, Catch::Contains(" 0 0 3  3 01 02 03 ") && Catch::Contains(" 0 0 9 12 01 02 03 00 "));
}

TEST_CASE("asc: what the format cannot hold is counted") {
  const Zone zone{"UTC0"};
  Interfaces interfaces;
  interfaces.add("vcan0");
  AscWriter writer;
  Entry fd{at(start + 1), {1, 0, {}}};
  fd.flags = flag::fd | 0x8;
  const std::vector<Entry> entries{
      fd, Entry{at(start - 1), {1, 0, {}}},
      directed({at(start), {4, 8, {}, can::Format::error}}, Direction::received)};
  const auto log = read_all<AscReader>(log::testing::write_all(writer, entries, interfaces));
  CHECK(log.complained == 0);
  REQUIRE(log.entries.size() == 3);
  CHECK(log.entries[1].time == at(start));  // there are no times before the beginning
  CHECK(writer.lost().count(Lost::interface) == 3);
  CHECK(writer.lost().count(Lost::fd_flags) == 1);
  CHECK(writer.lost().count(Lost::time_digits) == 1);
  CHECK(writer.lost().count(Lost::time) == 1);
  CHECK(writer.lost().count(Lost::error_detail) == 1);
  CHECK(writer.lost().count(Lost::direction) == 1);
  CHECK(writer.lost().count(Lost::entry) == 0);
}

TEST_CASE("asc: entries at random survive to the microsecond, in any time zone") {
  for (const auto* name : {"UTC0", "NST3:30NDT", "CET-1CEST,M3.5.0,M10.5.0/3"}) {
    const Zone zone{name};
    Interfaces interfaces;
    for (const auto* interface : {"can0", "can3", "can1"}) interfaces.add(interface);
    auto entries = test::RandomEntries{4, {.tick = 1000}}.many(2000);
    for (Entry& entry : entries) {
      if (entry.direction == Direction::unknown) entry.direction = Direction::received;
      if (entry.format == can::Format::error) set_bus_error(entry);
    }
    AscWriter writer;
    const std::string file = log::testing::write_all(writer, entries, interfaces);
    CHECK_FALSE(writer.lost().any());
    test::Drops source{file, 1000};
    const auto log = log::testing::read_from<AscReader>(source, 64);
    REQUIRE(log.complained == 0);
    REQUIRE(log.entries.size() == entries.size());
    for (std::size_t i = 0; i < entries.size(); ++i) {
      REQUIRE(log.names[i] == interfaces.name(entries[i].interface));
      Entry wanted = entries[i];
      wanted.interface = log.entries[i].interface;
      INFO(i);
      REQUIRE(log.entries[i] == wanted);
      REQUIRE(log::testing::can_exist(log.entries[i]));
    }
  }
}

TEST_CASE("asc: a log without frames is a log") {
  AscWriter writer;
  const std::string file = log::testing::write_all(writer, {}, {});
  CHECK(AscReader::recognises(file));
  const auto log = read_all<AscReader>(file);
  CHECK(log.entries.empty());
  CHECK(log.complained == 0);
}

TEST_CASE("asc: cut off anywhere, at most the last line is missing, and that is said") {
  const std::string lines =
      head + "   0.000000 1  123             Rx   d 2 11 22\n   0.000000 1  123             Rx   d 2 11 22\n";
  for (std::size_t size = head.size(); size <= lines.size(); ++size) {
    INFO(size);
    const auto log = read_all<AscReader>(lines.substr(0, size));
    const std::size_t line_size = (lines.size() - head.size()) / 2;
    const std::size_t whole = (size - head.size()) / line_size, more = (size - head.size()) % line_size;
    const bool all_but_end = more == line_size - 1;
    REQUIRE(log.entries.size() == whole + (all_but_end ? 1 : 0));
    REQUIRE(log.complained == (more > 3 && !all_but_end ? 1 : 0));  // a line begins with three blanks
  }
}

TEST_CASE("asc: any bit flipped, and every entry can exist") {
  const std::string whole =
      head + "0.0 1 123 Rx d 2 11 22\n0.0 CANFD 1 Rx 123x name 1 0 3 3 11 22 33 0 0 1000\n0.0 1 1 Rx r 8\n";
  for (std::size_t bit = 0; bit < whole.size() * 8; ++bit) {
    std::string file = whole;
    file[bit / 8] = static_cast<char>(file[bit / 8] ^ 1 << bit % 8);
    const auto log = read_all<AscReader>(file);
    REQUIRE(log.entries.size() <= 3);
    for (const Entry& entry : log.entries) REQUIRE(log::testing::can_exist(entry));
  }
}

TEST_CASE("asc: a log that is cut anywhere loses its last line, and says so") {
  const std::string frame = "0.0 1 123 Rx d 2 11 22";
  const std::string text = head + frame + "\n" + frame;
  for (std::size_t size = head.size() + frame.size() + 2; size < text.size(); ++size) {
    const auto log = read_all<AscReader>(text.substr(0, size));
    INFO(text.substr(0, size));
    REQUIRE(log.entries.size() >= 1);
    REQUIRE(log.complained == (log.entries.size() == 2 ? 0U : 1U));
    if (log.complained != 0) CHECK(log.complaints[0].cause == Cause::cut_line);
  }
}

TEST_CASE("asc: a line without an end takes no memory") {
  std::string file = head;
  file.append(Input::longest + 10, '0');
  file += "\n0.0 1 123 Rx d 0\n";
  const auto log = read_all<AscReader>(file);
  CHECK(log.entries.size() == 1);
  REQUIRE(log.complained == 1);
  CHECK(log.complaints[0].cause == Cause::too_long);
}

TEST_CASE("asc: what it is") {
  CHECK(AscReader::recognises(head));
  CHECK(AscReader::recognises("date Tue Nov 14 10:13:20 pm 2023\r\n"));
  CHECK(AscReader::recognises("base hex  timestamps absolute\n"));
  CHECK_FALSE(AscReader::recognises(""));
  CHECK_FALSE(AscReader::recognises("date,time,id\n"));
  CHECK_FALSE(AscReader::recognises("date of birth\n"));
  CHECK_FALSE(AscReader::recognises("base of all\n"));
  CHECK_FALSE(AscReader::recognises("(1436509052.249713) can0 605#00D20000\n"));
}

}  // namespace log_asc_test
