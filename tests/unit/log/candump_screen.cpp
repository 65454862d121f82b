#include "ocm/log/candump_screen.hpp"

#include <string>

#include <catch2/catch.hpp>

#include "unit/host/host_testing.hpp"
#include "unit/log/entries.hpp"

namespace log_candump_screen_test {

using namespace ocm;
using log::Cause;
using log::Direction;
using test::ReadLog;
using Log = ReadLog<log::CandumpScreenReader>;

/// What candump -L writes of the same frame, behind its time and interface.
std::string as_log(const log::Entry& entry) {
  log::CandumpNanoWriter writer;
  const std::string line = test::written(writer, {&entry, 1}, test::interfaces_named({"can0"}));
  CHECK_FALSE(writer.lost().any());
  return line.substr(0, line.size() - 1);
}

std::string read_as_log(std::string_view screen) {
  INFO(screen);
  CHECK(log::CandumpScreenReader::recognises(screen));
  CHECK_FALSE(log::CandumpReader::recognises(screen));
  const Log log{screen};
  REQUIRE(log.entries.size() == 1);
  CHECK(log.reader.complaints().total() == 0);
  CHECK(log.reader.interfaces().name(log.entries[0].interface) == "can0");
  return as_log(log.entries[0]);
}

struct Vector {
  std::string_view screen;
  std::string_view log;
};

// Typed from what candump and log2long 2020.11 print, which share the function. [can-utils lib.c,
// sprint_long_canframe; candump.c]
const Vector vectors[] = {
    {"  can0  605   [4]  00 D2 00 00", "(0000000000.000000000) can0 605#00D20000"},
    {"  can0  7FF   [0] ", "(0000000000.000000000) can0 7FF#"},
    {"  can0  605   [4]  00 D2 00 00               '....'", "(0000000000.000000000) can0 605#00D20000"},
    {"  can0       605   [4]  00 D2 00 00", "(0000000000.000000000) can0 605#00D20000"},  // behind 29 bits
    {"  can0  1F334455   [8]  11 22 33 44 55 66 77 88   '.\"3DUfw.'",
     "(0000000000.000000000) can0 1F334455#1122334455667788"},
    {"  can0  605   [3]  remote request", "(0000000000.000000000) can0 605#R3"},
    {"  can0  1F334455   [0]  remote request", "(0000000000.000000000) can0 1F334455#R"},
    {"  can0  123  [12]  11 22 33 44 55 66 77 88 99 AA BB CC",
     "(0000000000.000000000) can0 123##0112233445566778899AABBCC"},
    {"  can0  123  [00] ", "(0000000000.000000000) can0 123##0"},
    {"  can0  605   {C}  00 11 22 33 44 55 66 77", "(0000000000.000000000) can0 605#0011223344556677_C"},
    {"  can0  605   {4}  00 D2 00 00", "(0000000000.000000000) can0 605#00D20000"},
    {"  can0  605   {F}  00 11 22 33 44 55 66 77", "(0000000000.000000000) can0 605#0011223344556677_F"},
    {"  can0  605   [0]                            ''", "(0000000000.000000000) can0 605#"},
    {"  can0  20000004   [8]  00 04 00 00 00 00 00 00   ERRORFRAME",
     "(0000000000.000000000) can0 20000004#0004000000000000"},
    // -x
    {"  can0  RX - -  605   [4]  00 D2 00 00", "(0000000000.000000000) can0 605#00D20000 R"},
    {"  can0  TX - -  605   [4]  00 D2 00 00", "(0000000000.000000000) can0 605#00D20000 T"},
    {"  can0  RX B -  123  [02]  11 22", "(0000000000.000000000) can0 123##11122 R"},
    {"  can0  TX B E  123  [01]  11", "(0000000000.000000000) can0 123##311 T"},
    // -t a, -t z
    {" (1436509052.249713)  can0  605   [4]  00 D2 00 00", "(1436509052.249713000) can0 605#00D20000"},
    {" (000.249713)  can0  605   [4]  00 D2 00 00", "(0000000000.249713000) can0 605#00D20000"},
    {" (1436509052.249713)  can0  RX - -  605   [4]  00 D2 00 00   '....'",
     "(1436509052.249713000) can0 605#00D20000 R"},
    // -i, -S
    {"  can0  605   [4]  00000000 11010010 00000000 00000001", "(0000000000.000000000) can0 605#00D20001"},
    {"  can0  605   [4]  01`00`D2`00", "(0000000000.000000000) can0 605#00D20001"},
    {"  can0  605   [4]  01`00`D2`00               `....`", "(0000000000.000000000) can0 605#00D20001"},
    {"  can0  605   [2]  00000001`11010010", "(0000000000.000000000) can0 605#D201"},
    {"  can0  605   [0]                            ``", "(0000000000.000000000) can0 605#"},
};

TEST_CASE("what candump shows is read as what it writes into a log") {
  for (const Vector& v : vectors) {
    CHECK(read_as_log(v.screen) == v.log);
    CHECK(read_as_log(std::string{v.screen} + "\r\n") == v.log);
    CHECK(read_as_log(v.screen.substr(v.screen.find_first_not_of(' '))) == v.log);  // as some paste it
  }
}

TEST_CASE("a time with a date is local time") {
  const test::Environment zone{"TZ", "CET-1CEST,M3.5.0,M10.5.0/3"};
  CHECK(read_as_log(" (2015-07-10 08:17:32.249713)  can0  605   [1]  00") ==
        "(1436509052.249713000) can0 605#00");
  CHECK(Log{" (2015-02-30 08:17:32.249713)  can0  605   [1]  00"}.reader.complaints().total() == 1);
}

std::vector<std::int64_t> times_ms(std::string_view screen) {
  std::vector<std::int64_t> times;
  for (const auto& entry : Log{screen}.entries)
    times.push_back(entry.time.time_since_epoch().count() / 1'000'000);
  return times;
}

TEST_CASE("times since the first frame, and since the frame before") {
  CHECK(times_ms(" (000.000000)  can0  605   [0]\n (000.100000)  can0  605   [0]\n (000.300000)  can0  605   "
                 "[0]\n") == std::vector<std::int64_t>{0, 100, 300});
  CHECK(times_ms(
            " (000.000000)  can0  605   [0]\n (000.100000)  can0  605   [0]\n (000.300000)  can0  605   [0]\n"
            " (000.200000)  can0  605   [0]\n") == std::vector<std::int64_t>{0, 100, 400, 600});
  // Two at the same time.
  CHECK(times_ms(" (000.000000)  can0  605   [0]\n (000.100000)  can0  605   [0]\n"
                 " (000.100000)  can0  605   [0]\n (000.300000)  can0  605   [0]\n") ==
        std::vector<std::int64_t>{0, 100, 100, 300});
  // What cannot be read between them says nothing of how they count.
  CHECK(times_ms(" (000.000000)  can0  605   [0]\n (000.100000)  can0  605   [0]\n"
                 " (000.050000)  can0  6055   [0]\n^C\n (000.300000)  can0  605   [0]\n") ==
        std::vector<std::int64_t>{0, 100, 300});
}

TEST_CASE("times since 1970 are those that are shown, if they go back, too") {
  CHECK(times_ms(" (1436509052.000000)  can0  605   [0]\n (1436509053.000000)  can0  605   [0]\n"
                 " (1436509052.500000)  can0  605   [0]\n") ==
        std::vector<std::int64_t>{1'436'509'052'000, 1'436'509'053'000, 1'436'509'052'500});
}

TEST_CASE("times that go back where nothing was to be seen of it count from there on") {
  const std::string first =
      " (000.000000)  can0  605   [0]\n (000.100000)  can0  605   [0]\n (000.300000)  can0  605   [0]\n";
  const std::string text = first + " (000.200000)  can0  605   [0]\n";
  test::Drops drops{text, first.size()};
  log::Input input{drops};
  log::CandumpScreenReader reader{input};
  log::Entry entries[8];
  REQUIRE(reader.read(entries) == 3);
  CHECK(entries[2].time == base::Time{base::Duration{300'000'000}});
  REQUIRE(reader.read(entries) == 1);
  CHECK(entries[0].time == base::Time{base::Duration{500'000'000}});
}

TEST_CASE("times since the frame before add up to what comes within a second of the last one that there is") {
  std::string lines;
  for (int i = 0; i < 9; ++i) lines += " (999999999.000000)  can0  605   [0]\n";
  lines += " (000.000000)  can0  605   [0]\n";  // 8'999'999'991 s; the last one is 9'223'372'036.854'775'807
  CHECK(times_ms(lines + " (223372044.000000)  can0  605   [0]\n").back() == 9'223'372'035'000);
  CHECK(times_ms(lines + " (223372045.000000)  can0  605   [0]\n").back() == 8'999'999'991'000);
  CHECK(times_ms(lines + " (223372044.854775806)  can0  605   [0]\n").back() == 9'223'372'035'854);
  CHECK(times_ms(lines + " (223372044.854775807)  can0  605   [0]\n").back() == 8'999'999'991'000);
}

TEST_CASE("candump -e explains an error frame below it, and -d counts what it lost") {
  const Log log{
      "  can0  20000004   [8]  00 08 00 00 00 00 60 00   ERRORFRAME\n"
      "\tcontroller-problem{tx-error-warning}\n"
      "\terror-counter-tx-rx{{96}{0}}\n"
      "DROPCOUNT: dropped 3 CAN frames on 'can0' socket (total drops 3)\n"
      "DROPCOUNT: dropped 1 CAN frame on 'can0' socket (total drops 4)\n"
      "  can0  605   [0]\n"};
  CHECK(log.entries.size() == 2);
  CHECK(log.reader.complaints().total() == 0);
  REQUIRE(log.reader.recorded().size() == 1);
  CHECK(log.reader.recorded()[0].dropped == 4);
}

Cause refusal_of(std::string_view line) {
  const Log log{"  can0  605   [0]\n" + std::string{line} + "\n"};
  INFO(line);
  REQUIRE(log.entries.size() == 1);
  REQUIRE(log.reader.complaints().total() == 1);
  CHECK(log.reader.complaints().first()[0].place == log::Place{2, true});
  return log.reader.complaints().first()[0].cause;
}

TEST_CASE("what candump never shows is refused by cause, and the rest is read") {
  for (const char* line : {"$ candump can0",
                           "^C",
                           "  can0  605",
                           "  can0  6055   [0]",
                           "  can0  60   [0]",
                           "  can0  605   [x]",
                           "  can0  605   (4)  00 D2 00 00",
                           "  can0  605   <4>  00 D2 00 00",
                           "  can0  605   {4]  00 D2 00 00",
                           "  can0  605   [4}  00 D2 00 00",
                           " (soon)  can0  605   [0]",
                           " (1.5  can0  605   [0]",
                           "  can0  RX ? -  605   [0]",
                           "  can0  605   [4]  0`0",
                           "  can0  20000004   [8]  remote request",
                           "\tcontroller-problem{}",
                           "  can0  RX - ?  605   [0]",
                           "  can0  6x5   [0]",
                           "  can0  605   [123]  00",
                           "  can0  800   []",
                           "  can0  800   (4)  00",
                           "  can0  605   {12}  00",
                           "  can0  123  [12]  remote request"})
    CHECK(refusal_of(line) == Cause::syntax);
  const std::string longest(log::candump::longest_name, 'n');
  CHECK(refusal_of("  " + longest + "n  605   [0]") == Cause::syntax);
  CHECK(Log{"  " + longest + "  605   [0]"}.entries.size() == 1);
  CHECK(refusal_of("  can0  800   [0]") == Cause::identifier);
  CHECK(refusal_of("  can0  40000000   [0]") == Cause::identifier);
  for (const char* line :
       {"  can0  605   [9]  00 01 02 03 04 05 06 07 08", "  can0  605   [9]  00 01 02 03 04 05 06 07",
        "  can0  605   [4]  00 D2 00", "  can0  605   [4]  00 D2 00 00 00",
        "  can0  123  [09]  00 01 02 03 04 05 06 07 08", "  can0  605   [1]  0",
        "  can0  605   [1]  ERRORFRAME", "  can0  605   [2]  01`02`03",
        "  can0  20000004   {C}  00 08 00 00 00 00 60 00   ERRORFRAME",
        "  can0  20000004  [08]  00 08 00 00 00 00 60 00   ERRORFRAME", "  can0  605   [1]  00   ERRORFRAME",
        "  can0  20000004   [8]  00 08 00 00 00 00 60 00   00"})
    CHECK(refusal_of(line) == Cause::length);
  CHECK(refusal_of(" (9999999999.000000)  can0  605   [0]") == Cause::time);
}

TEST_CASE("a date that is shown is one in each of its characters") {
  const test::Environment zone{"TZ", "CET-1CEST,M3.5.0,M10.5.0/3"};
  CHECK(read_as_log(" (2015-07-10 08:17:32)  can0  605   [1]  00") == "(1436509052.000000000) can0 605#00");
  CHECK(read_as_log(" (2015-07-10 08:17:32.123456789)  can0  605   [1]  00") ==
        "(1436509052.123456789) can0 605#00");
  for (const std::string& date :
       {std::string{"2015:07-10 08:17:32.249713"}, std::string{"2015-07:10 08:17:32.249713"},
        std::string{"2015-07-10T08:17:32.249713"}, std::string{"2015-07-10 08-17:32.249713"},
        std::string{"2015-07-10 08:17-32.249713"}, std::string{"2015-07-10 0x:17:32.249713"},
        std::string{"2015-07-10 08:1x:32.249713"}, std::string{"2015-07-10 08:17:3x.249713"},
        std::string{"2015-07-10 08:17:32.1234567890"}, std::string{"2015-07-10 08:17:3"},
        "2015-07-10 08:17:32." + std::string(60, '0')})
    CHECK(refusal_of(" (" + date + ")  can0  605   [1]  00") == Cause::syntax);
}

TEST_CASE("a classic frame that is shown has no flags, and a length code from nine on only") {
  const auto shown = [](std::string_view line) {
    const Log log{line};
    REQUIRE(log.entries.size() == 1);
    return log.entries[0];
  };
  const log::Entry classic = shown("  can0  RX B E  605   [4]  00 D2 00 00");
  CHECK(classic.flags == 0);
  CHECK(classic.direction == Direction::received);
  CHECK(shown("  can0  605   [4]  00 D2 00 00").flags == 0);
  CHECK(shown("  can0  605   [8]  00 11 22 33 44 55 66 77").raw_dlc == 0);
  CHECK(shown("  can0  605   {8}  00 11 22 33 44 55 66 77").raw_dlc == 0);
  CHECK(shown("  can0  605   {9}  00 11 22 33 44 55 66 77").raw_dlc == 9);
}

TEST_CASE("a count of lost frames is one with a number and the name of an interface") {
  const std::string longest(log::candump::longest_name, 'n');
  for (const std::string& line :
       {std::string{"DROPCOUNT: dropped x CAN frames on 'can0' socket (total drops 3)"},
        std::string{"DROPCOUNT: dropped 3 CAN frames on can0 socket (total drops 3)"},
        std::string{"DROPCOUNT: dropped 3 CAN frames on 'can0 socket (total drops 3)"},
        std::string{"DROPCOUNT: dropped 3 CAN frames on '' socket (total drops 3)"},
        "DROPCOUNT: dropped 3 CAN frames on '" + longest + "n' socket (total drops 3)"})
    CHECK(refusal_of(line) == Cause::syntax);
  const Log log{"DROPCOUNT: dropped 3 CAN frames on '" + longest + "' socket (total drops 3)\n"};
  CHECK(log.reader.complaints().total() == 0);
  REQUIRE(log.reader.recorded().size() == 1);
  CHECK(log.reader.recorded()[0].dropped == 3);
}

TEST_CASE("an explanation needs an error frame above it, or its line is refused") {
  const Log log{"\tcontroller-problem{}\n  can0  605   [0]\n"};
  CHECK(log.entries.size() == 1);
  CHECK(log.reader.complaints().count(Cause::syntax) == 1);
}

TEST_CASE("a last line of candump's that is cut off is said to be, a prompt is not") {
  const std::string line = "  can0  605   [4]  00 D2 00 00";
  for (std::size_t size = 1; size < line.size(); ++size) {
    const Log log{line + "\n" + line.substr(0, size)};
    INFO(size);
    CHECK(log.entries.size() == 1);
    CHECK(log.reader.complaints().count(Cause::cut_line) == (size > 2 ? 1 : 0));  // blanks are no line
    CHECK(log.reader.complaints().total() == (size > 2 ? 1 : 0));
  }
  for (const char* after : {"^C", "me@robot:~$ "})
    CHECK(Log{line + "\n" + after}.reader.complaints().count(Cause::syntax) == 1);
}

TEST_CASE("a line of candump's without an end is reported as too long, and the next one is read") {
  std::string text(log::Input::longest + 10, '0');
  text += "\n  can0  123   [1]  7F\n";
  const Log log{text};
  CHECK(log.entries.size() == 1);
  REQUIRE(log.reader.complaints().total() == 1);
  CHECK(log.reader.complaints().first()[0].cause == Cause::too_long);
  CHECK(log.reader.complaints().first()[0].place == log::Place{1, true});
}

TEST_CASE(
    "what candump shows comes out of a pipe when it comes in, and half a line of one that is cut is none") {
  const std::string text = "  can0  123   [1]  7F\n  can0  124   [1]  7F\n  can0  125   [1]  7F";
  for (const char* const failure : {"", "cut"}) {
    test::Drops drops{text, text.size(), failure};
    log::Input input{drops};
    log::CandumpScreenReader reader{input};
    log::Entry entries[8];
    CHECK(reader.read(entries) == 2);
    CHECK(drops.reads == 1);
    const bool cut = failure[0] != '\0';
    CHECK(reader.read(entries) == (cut ? 0 : 1));
    CHECK(reader.complaints().count(Cause::truncated) == (cut ? 1 : 0));
  }
}

TEST_CASE("more interfaces than any log has are reported in what candump shows, too") {
  std::string text;
  for (std::size_t i = 0; i <= log::Interfaces::most; ++i)
    text += "  c" + std::to_string(i) + "  123   [0]\n";
  const Log log{text};
  CHECK(log.entries.size() == log::Interfaces::most);
  CHECK(log.reader.complaints().count(Cause::unsupported) == 1);
}

TEST_CASE("other logs are not taken for it") {
  for (const char* line : {"(1436509052.249713) can0 605#00D20000", "", "\n", "time,topic,field,value,unit"})
    CHECK_FALSE(log::CandumpScreenReader::recognises(line));
}

}  // namespace log_candump_screen_test
