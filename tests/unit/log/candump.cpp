#include "ocm/log/candump.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <new>
#include <span>
#include <string>

#include <catch2/catch.hpp>

#include "unit/base/explore.hpp"
#include "unit/log/entries.hpp"

namespace log_candump_test {

using namespace ocm;
using log::Cause;
using log::Direction;
using log::Entry;
using test::RandomEntries;
using test::ReadLog;
using Log = ReadLog<log::CandumpReader>;

base::Time at_ns(std::int64_t ns) {
  return base::Time{base::Duration{ns}};
}

Entry entry_of(const can::Frame& frame) {
  return {at_ns(1'436'509'052'249'713'000), frame};
}

/// A line behind one that makes the interface known, so that it may take the usual path; and enough behind
/// it, without which no line does.
std::string amid(std::string_view line, std::string_view end = "\n") {
  return "(1436509052.249713) can0 123#\n" + std::string{line} + std::string{end} + std::string(300, '\n');
}

/// The entry of `line`, which both ways make the same of.
Entry entry_of_line(std::string_view line) {
  const Log alone{line};
  const Log among{amid(line)};
  INFO(line);
  REQUIRE(alone.entries.size() == 1);
  REQUIRE(among.entries.size() == 2);
  CHECK(alone.entries[0] == among.entries[1]);
  return among.entries[1];
}

Cause refusal_of(std::string_view line) {
  const Log log{amid(line)};
  INFO(line);
  REQUIRE(log.entries.size() == 1);
  REQUIRE(log.reader.complaints().total() == 1);
  CHECK(log.reader.complaints().first()[0].place == log::Place{2, true});
  return log.reader.complaints().first()[0].cause;
}

struct Vector {
  std::string_view text;
  Entry entry;
};

Entry fd(std::uint32_t id, can::Format format, std::uint8_t flags, std::initializer_list<std::uint8_t> data) {
  Entry entry = entry_of(can::Frame{id, 0, {}, format});
  entry.flags = log::flag::fd | flags;
  entry.length = static_cast<std::uint8_t>(data.size());
  std::copy(data.begin(), data.end(), entry.data.begin());
  return entry;
}

Entry with(Entry entry, std::uint8_t raw_dlc, Direction direction = Direction::unknown) {
  entry.raw_dlc = raw_dlc;
  entry.direction = direction;
  return entry;
}

// The notation of sprint_canframe and candump -L. [can-utils lib.h, lib.c, candump.c]
const Vector vectors[] = {
    {"605#00D20000", entry_of({0x605, 4, {0, 0xD2, 0, 0}})},
    {"000#", entry_of({0, 0, {}})},
    {"7FF#0011223344556677", entry_of({0x7FF, 8, {0, 0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77}})},
    {"1F334455#1122334455667788",
     entry_of({0x1F33'4455, 8, {0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88}, can::Format::extended})},
    {"00000005#DE", entry_of({5, 1, {0xDE}, can::Format::extended})},
    {"605#R", entry_of({0x605, 0, {}, can::Format::base_remote})},
    {"605#R3", entry_of({0x605, 3, {}, can::Format::base_remote})},
    {"1F334455#R8", entry_of({0x1F33'4455, 8, {}, can::Format::extended_remote})},
    {"20000004#0004000000000000", entry_of({4, 8, {0, 4}, can::Format::error})},
    {"123##0", fd(0x123, can::Format::base, 0, {})},
    {"123##1112233445566778899AABBCC",
     fd(0x123, can::Format::base, log::flag::bit_rate_switch,
        {0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88, 0x99, 0xAA, 0xBB, 0xCC})},
    {"1F334455##3DEAD", fd(0x1F33'4455, can::Format::extended, 3, {0xDE, 0xAD})},
    {"123#0102030405060708_9", with(entry_of({0x123, 8, {1, 2, 3, 4, 5, 6, 7, 8}}), 9)},
    {"123#0102030405060708_F", with(entry_of({0x123, 8, {1, 2, 3, 4, 5, 6, 7, 8}}), 15)},
    {"123#R8_C", with(entry_of({0x123, 8, {}, can::Format::base_remote}), 12)},
    {"123#01 R", with(entry_of({0x123, 1, {1}}), 0, Direction::received)},
    {"123##101 T", with(fd(0x123, can::Format::base, 1, {1}), 0, Direction::sent)},
};

TEST_CASE("candump's lines are read and written") {
  const auto interfaces = test::interfaces_named({"can0"});
  for (const Vector& v : vectors) {
    const std::string line = "(1436509052.249713) can0 " + std::string{v.text};
    CHECK(entry_of_line(line) == v.entry);
    log::CandumpWriter writer;
    CHECK(test::written(writer, {&v.entry, 1}, interfaces) == line + "\n");
    CHECK_FALSE(writer.lost().any());
  }
}

TEST_CASE("candump's lines are read with any end, any case and any number of digits") {
  const Entry expected = entry_of({0x1AB, 2, {0xCD, 0xEF}});
  for (const char* line :
       {"(1436509052.249713) can0 1ab#cdEf", "(1436509052.249713) can0 1AB#CD.EF",
        "  (1436509052.249713000)  can0\t1AB#CDEF  ", "(1436509052.2497130) can0 1AB#CDEF"})
    CHECK(entry_of_line(line) == expected);
  CHECK(Log{amid("(1436509052.249713) can0 1AB#CDEF", "\r\n")}.entries.at(1) == expected);
  CHECK(Log{amid("(1436509052.249713) can0 1AB#CDEF R", "\r\n")}.entries.at(1).direction ==
        Direction::received);
  CHECK(entry_of_line("(1436509052.249713001) can0 1AB#").time == at_ns(1'436'509'052'249'713'001));
  CHECK(entry_of_line("(0.5) can0 1AB#").time == at_ns(500'000'000));
  CHECK(entry_of_line("(7) can0 1AB#").time == at_ns(7'000'000'000));
  CHECK(entry_of_line("(9223372034.999999) can0 1AB#").time == at_ns(9'223'372'034'999'999'000));
  // the flag that a newer kernel sets [linux/can.h, CANFD_FDF]
  CHECK(entry_of_line("(1436509052.249713) can0 123##501") == fd(0x123, can::Format::base, 1, {1}));
  // An entry holds nothing of the line before.
  const Log after{amid("(1436509052.249713) can0 7FF#0011223344556677\n(1436509052.249713) can0 123##501")};
  CHECK(after.entries.at(2) == fd(0x123, can::Format::base, 1, {1}));
}

TEST_CASE("what is no line of candump's is refused by cause, and the rest is read") {
  const std::string begin = "(1436509052.249713) can0 ";
  CHECK(refusal_of("hello") == Cause::syntax);
  CHECK(refusal_of("(1436509052.24971x) can0 123#") == Cause::syntax);
  CHECK(refusal_of("(1436509052.2497130001) can0 123#") == Cause::syntax);
  CHECK(refusal_of("(-436509052.249713) can0 123#") == Cause::syntax);
  CHECK(refusal_of("x1436509052.249713) can0 123#") == Cause::syntax);
  CHECK(refusal_of("(1436509052x249713) can0 123#") == Cause::syntax);
  CHECK(refusal_of("(9223372036.854776) can0 123#") == Cause::time);
  CHECK(refusal_of("(9999999999.854776) can0 123#") == Cause::time);
  CHECK(refusal_of(begin + "123") == Cause::syntax);
  CHECK(refusal_of(begin + "12#00") == Cause::identifier);
  CHECK(refusal_of(begin + "800#00") == Cause::identifier);
  CHECK(refusal_of(begin + "40000000#00") == Cause::identifier);
  CHECK(refusal_of(begin + "80000000#00") == Cause::identifier);
  CHECK(refusal_of(begin + "123#0") == Cause::syntax);
  CHECK(refusal_of(begin + "123#001122334455667788") == Cause::length);
  CHECK(refusal_of(begin + "123#R9") == Cause::length);
  CHECK(refusal_of(begin + "123#0011_9") == Cause::length);
  CHECK(refusal_of(begin + "123#0011223344556677_8") == Cause::length);
  CHECK(refusal_of(begin + "123#0011223344556677_") == Cause::syntax);
  CHECK(refusal_of(begin + "123#0011223344556677_0") == Cause::length);
  CHECK(refusal_of(begin + "123#0011223344556677_99") == Cause::syntax);
  CHECK(refusal_of(begin + "20000004#0004000000000000_9") == Cause::syntax);
  CHECK(refusal_of(begin + "123##") == Cause::syntax);
  CHECK(refusal_of(begin + "123##1000102030405060708") == Cause::length);  // 9 bytes
  CHECK(refusal_of(begin + "123##1" + std::string(130, '0')) == Cause::length);
  CHECK(refusal_of(begin + "123##10") == Cause::syntax);
  CHECK(refusal_of(begin + "123##1012") == Cause::syntax);
  CHECK(refusal_of(begin + "123##1012345678") == Cause::syntax);
  CHECK(refusal_of(begin + "20000004##100") == Cause::syntax);
  CHECK(refusal_of(begin + "123#00 X") == Cause::syntax);
  CHECK(refusal_of(begin + "123#00 R R") == Cause::syntax);
  CHECK(refusal_of("(1436509052.249713) " + std::string(65, 'n') + " 123#") == Cause::syntax);
  CHECK(Log{"(1436509052.249713) " + std::string(64, 'n') + " 123#"}.entries.size() == 1);
}

TEST_CASE("candump's longest frame writes its 64 bytes, and none behind them") {
  constexpr std::size_t end = offsetof(Entry, data) + log::max_fd_length;
  static_assert(end < sizeof(Entry), "what is behind the data shows");
  alignas(Entry) std::array<unsigned char, sizeof(Entry)> memory;
  memory.fill(0xA5);
  Entry& entry = *new (memory.data()) Entry;
  const std::string text = amid("(1436509052.249713) can0 123##1" + std::string(128, 'F'));
  log::MemorySource source{text};
  log::Input input{source};
  log::CandumpReader reader{input};
  for (int i = 0; i < 2; ++i) REQUIRE(reader.read(std::span{&entry, 1}) == 1);
  CHECK(entry.length == 64);
  CHECK(entry.data[63] == 0xFF);
  CHECK(std::all_of(memory.begin() + end, memory.end(), [](unsigned char byte) { return byte == 0xA5; }));
}

TEST_CASE("candump's longest line has room, however much there is already") {
  Entry entry;
  entry.time = at_ns(1'436'509'052'249'713'123);
  entry.id = can::max_extended_id;
  entry.format = can::Format::extended;
  entry.flags = log::flag::fd;
  entry.data.fill(0);
  entry.length = 64;
  entry.direction = Direction::received;
  const auto interfaces = test::interfaces_named({"can0"});
  const std::string line = "(1436509052.249713123) can0 1FFFFFFF##0" + std::string(128, '0') + " R\n";
  for (std::size_t left = 0; left != 2 * line.size(); ++left) {
    log::Bytes out;
    // What is taken at first is so large; Bytes asserts that no more is written.
    out.zeros((std::size_t{1} << 16) - left);
    log::CandumpNanoWriter writer;
    writer.write(out, std::span{&entry, 1}, interfaces);
    CHECK(out.view().substr(out.size() - line.size()) == line);
  }
}

TEST_CASE("random entries survive candump's notation, to the nanosecond with nine digits") {
  const auto interfaces = test::interfaces_named({"can0", "vcan17", "a_name_of_15_ch"});
  for (const std::int64_t tick : {1, 1000}) {
    const auto entries = RandomEntries{static_cast<std::uint64_t>(tick), {.tick = tick}}.many(5000);
    log::CandumpWriter six;
    log::CandumpNanoWriter nine;
    const std::string text =
        tick == 1 ? test::written(nine, entries, interfaces) : test::written(six, entries, interfaces);
    const Log log{text};
    CHECK(log.reader.complaints().total() == 0);
    REQUIRE(log.entries.size() == entries.size());
    for (std::size_t i = 0; i < entries.size(); ++i) {
      Entry expected = entries[i];
      expected.interface = log.entries[i].interface;
      REQUIRE(log.entries[i] == expected);
      REQUIRE(log.reader.interfaces().name(expected.interface) == interfaces.name(entries[i].interface));
      for (std::size_t k = log.entries[i].bytes().size(); k < 8; ++k) REQUIRE(log.entries[i].data[k] == 0);
    }
    CHECK_FALSE(six.lost().any());
    CHECK_FALSE(nine.lost().any());
  }
}

TEST_CASE("the usual path makes the same of any line as the careful one, and as can/text.hpp") {
  const auto interfaces = test::interfaces_named({"can0", "can1", "a_name_of_15_ch"});
  RandomEntries entries{11, {}};
  test::Random random{12};
  for (int round = 0; round < test::explored(20'000); ++round) {
    const Entry entry = entries.next();
    log::CandumpWriter writer{random.below(2) == 0 ? log::CandumpWriter::Digits::microseconds
                                                   : log::CandumpWriter::Digits::nanoseconds};
    std::string line = test::written(writer, {&entry, 1}, interfaces);
    line.pop_back();
    for (std::uint32_t changes = random.below(3); changes > 0; --changes) {
      const std::size_t place = random.below(static_cast<std::uint32_t>(line.size()));
      if (random.below(3) == 0)
        line.erase(place, 1);
      else
        line[place] = random.below(2) == 0 ? static_cast<char>(random.below(256))
                                           : "0123456789abcdefABCDEF#() _.RT"[random.below(30)];
      if (line.empty()) line = " ";
    }
    if (line.find('\n') != std::string::npos) continue;
    INFO(line);
    const Log log{"(1.000000) can0 1#\n(1.000000) can0 123#\n(1.000000) can1 123#\n" + line + "\n" +
                  std::string(300, '\n')};
    const log::candump::Line careful = log::candump::parse_line(line);
    const bool blank = log::candump::is_blank(line);
    REQUIRE(log.entries.size() == (careful.wrong ? 2 : 3));
    REQUIRE(log.reader.complaints().total() == (careful.wrong && !blank ? 2 : 1));
    const auto classic = can::parse_log_line(line);
    if (classic) {
      REQUIRE_FALSE(careful.wrong);
      CHECK(careful.entry.classic() == classic->frame);
      CHECK(careful.entry.time == classic->time);
      CHECK(careful.interface == classic->interface);
    }
    if (careful.wrong) continue;
    CHECK((classic.ok() || careful.entry.is_fd() || careful.entry.raw_dlc != 0));
    Entry expected = careful.entry;
    expected.interface = log.entries[2].interface;
    CHECK(log.entries[2] == expected);
    CHECK(log.reader.interfaces().name(expected.interface) == careful.interface);
  }
}

TEST_CASE("candump's log that is cut anywhere loses its last line at most") {
  const auto interfaces = test::interfaces_named({"can0"});
  const auto entries = RandomEntries{3, {.interfaces = 1, .tick = 1000}}.many(30);
  log::CandumpWriter writer;
  const std::string text = test::written(writer, entries, interfaces);
  for (std::size_t size = 0; size < text.size(); ++size) {
    const auto whole = static_cast<std::size_t>(
        std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(size), '\n'));
    const Log log{std::string_view{text}.substr(0, size)};
    REQUIRE(log.entries.size() >= whole);
    REQUIRE(log.entries.size() <= whole + 1);
    for (std::size_t i = 0; i < whole; ++i) REQUIRE(log.entries[i] == entries[i]);
    const bool rest = size > 0 && text[size - 1] != '\n';
    const bool refused = rest && log.entries.size() == whole;
    REQUIRE(log.reader.complaints().count(Cause::cut_line) == (refused ? 1 : 0));
    REQUIRE(log.reader.complaints().total() == (refused ? 1 : 0));
    // Where the source knows that it was cut, half a line is none.
    test::Drops drops{std::string_view{text}.substr(0, size), 50, "cut"};
    log::Input input{drops};
    log::CandumpReader reader{input};
    Entry some[64];
    std::size_t count = 0;
    while (const std::size_t more = reader.read(some)) count += more;
    REQUIRE(count == whole);
    REQUIRE(reader.complaints().count(Cause::truncated) == (rest ? 1 : 0));
  }
}

TEST_CASE("candump's last line that is no beginning of one is not taken for one that is cut off") {
  const Log log{"(1.0) can0 123#\nhello"};
  CHECK(log.entries.size() == 1);
  CHECK(log.reader.complaints().count(Cause::syntax) == 1);
}

TEST_CASE("candump's line without an end is reported as too long, and the next one is read") {
  std::string text = "(1.0) can0 123#\n";
  text.append(log::Input::longest + 10, '0');
  text += "\n(2.0) can0 124#\n";
  const Log log{text};
  CHECK(log.entries.size() == 2);
  REQUIRE(log.reader.complaints().total() == 1);
  CHECK(log.reader.complaints().first()[0].cause == Cause::too_long);
  CHECK(log.reader.complaints().first()[0].place == log::Place{2, true});
}

TEST_CASE("candump's lines come out of a pipe when they come in") {
  test::Drops drops{"(1.0) can0 123#\n(2.0) can0 123#\n(3.0) ca", 32};
  log::Input input{drops};
  log::CandumpReader reader{input};
  Entry entries[8];
  CHECK(reader.read(entries) == 2);
  CHECK(drops.reads == 1);
}

TEST_CASE("candump's text names every interface, and says when it had to change the name") {
  Entry entry = entry_of({1, 0, {}});
  log::Interfaces interfaces;
  interfaces.add("");
  interfaces.add("USB\t1");
  log::CandumpWriter writer;
  CHECK(test::written(writer, {&entry, 1}, interfaces) == "(1436509052.249713) can0 001#\n");
  entry.interface = 1;
  CHECK(test::written(writer, {&entry, 1}, interfaces) == "(1436509052.249713) USB_1 001#\n");
  CHECK(writer.lost().count(log::Lost::interface) == 1);  // an empty name is none that could be lost
}

TEST_CASE("candump's text counts times that it cannot hold") {
  const auto interfaces = test::interfaces_named({"can0"});
  Entry entry = entry_of({1, 0, {}});
  entry.time = at_ns(1'999);
  log::CandumpWriter writer;
  CHECK(test::written(writer, {&entry, 1}, interfaces) == "(0000000000.000001) can0 001#\n");
  entry.time = at_ns(-1);
  CHECK(test::written(writer, {&entry, 1}, interfaces) == "(0000000000.000000) can0 001#\n");
  CHECK(writer.lost().count(log::Lost::time_digits) == 1);
  CHECK(writer.lost().count(log::Lost::time) == 1);
  log::CandumpNanoWriter nine;
  entry.time = at_ns(1'999);
  CHECK(test::written(nine, {&entry, 1}, interfaces) == "(0000000000.000001999) can0 001#\n");
  CHECK_FALSE(nine.lost().any());
}

TEST_CASE("a log with more interfaces than any has is reported, and takes no more memory") {
  std::string text;
  for (std::size_t i = 0; i <= log::Interfaces::most; ++i) text += "(1.0) c" + std::to_string(i) + " 123#\n";
  const Log log{text};
  CHECK(log.entries.size() == log::Interfaces::most);
  CHECK(log.reader.complaints().count(Cause::unsupported) == 1);
}

TEST_CASE("candump's logs are recognised by a line, wherever it stands") {
  using log::CandumpReader;
  CHECK(CandumpReader::recognises("(1436509052.249713) can0 605#00D20000\n"));
  CHECK(CandumpReader::recognises("rubbish\n\n(0.0) vcan0 123##1\nmore"));
  CHECK(CandumpReader::recognises("rubbish\n(0.0) vcan0 123##1\nmore"));
  CHECK_FALSE(CandumpReader::recognises(""));
  CHECK_FALSE(CandumpReader::recognises("(14365"));
  CHECK_FALSE(CandumpReader::recognises("timestamp,arbitration_id\n0.0,0x1\n"));
}

}  // namespace log_candump_test
