#include "ocm/log/csv.hpp"

#include <string>

#include <catch2/catch.hpp>

#include "unit/log/entries.hpp"

namespace log_csv_test {

using namespace ocm;
using log::Cause;
using log::Entry;
using log::Lost;
using test::RandomEntries;
using Log = test::ReadLog<log::CsvReader>;

static_assert(log::csv::max_base64 == 88);  // of 64 bytes

const std::string head = std::string{log::csv::head} + "\n";

base::Time at_ns(std::int64_t ns) {
  return base::Time{base::Duration{ns}};
}

struct Vector {
  std::string_view row;
  Entry entry;
};

// The first is the example of CSVWriter's documentation, the others as it prints Message objects.
// [python-can 4.1.0, can/io/csv.py]; base64 by RFC 4648, 10: "Zm9vYmFy" is "foobar".
const Vector vectors[] = {
    {"1483389946.197000,0xdadada,1,0,0,6,WzQyLCA5XQ==",
     {at_ns(1'483'389'946'197'000'000),
      {0xDA'DADA, 7, {'[', '4', '2', ',', ' ', '9', ']'}, can::Format::extended}}},
    {"0.000000,0x7ff,0,0,0,6,Zm9vYmFy", {at_ns(0), {0x7FF, 6, {'f', 'o', 'o', 'b', 'a', 'r'}}}},
    {"1.500000,0x0,0,0,0,0,", {at_ns(1'500'000'000), {0, 0, {}}}},
    {"1.000000001,0x123,0,1,0,8,", {at_ns(1'000'000'001), {0x123, 8, {}, can::Format::base_remote}}},
    {"1.000000,0x1fffffff,1,1,0,3,",
     {at_ns(1'000'000'000), {0x1FFF'FFFF, 3, {}, can::Format::extended_remote}}},
    {"-0.000001,0x4,1,0,1,8,AAQAAAAAAAA=", {at_ns(-1000), {4, 8, {0, 4}, can::Format::error}}},
};

Cause refusal_of(std::string_view row) {
  const Log log{head + std::string{row} + "\n0.0,0x1,0,0,0,0,\n"};
  INFO(row);
  REQUIRE(log.entries.size() == 1);
  REQUIRE(log.reader.complaints().total() == 1);
  CHECK(log.reader.complaints().first()[0].place == log::Place{2, true});
  return log.reader.complaints().first()[0].cause;
}

TEST_CASE("python-can's rows are read and written") {
  const auto interfaces = test::interfaces_named({"can0"});
  for (const Vector& v : vectors) {
    INFO(v.row);
    std::string row{v.row};
    if (v.entry.length == 7)
      row.replace(row.find(",6,"), 3, ",7,");  // the documentation's length is not its data's
    const Log log{head + row + "\n"};
    CHECK(log.reader.complaints().total() == 0);
    REQUIRE(log.entries.size() == 1);
    CHECK(log.entries[0] == v.entry);
    log::CsvWriter writer;
    CHECK(test::written(writer, {&v.entry, 1}, interfaces) == head + row + "\n");
  }
}

TEST_CASE("times are read as Python prints them") {
  const auto time_of = [](std::string_view text) { return log::csv::parse_time(text); };
  CHECK(time_of("5e-05") == at_ns(50'000));
  CHECK(time_of("1.2345678901234567e-05") == at_ns(12'346));
  CHECK(time_of("1436509052.249713") == at_ns(1'436'509'052'249'713'000));
  CHECK(time_of("1436509052.2497131824493408203125") == at_ns(1'436'509'052'249'713'182));
  CHECK(time_of("0.12345678950000000000001") == at_ns(123'456'789));
  CHECK(time_of("12") == at_ns(12'000'000'000));
  CHECK(time_of("1436509052.2497131824") == at_ns(1'436'509'052'249'713'182));
  CHECK_FALSE(time_of("9999999999999.123456789"));
  CHECK_FALSE(time_of("9999999999999.1234567890"));
  CHECK_FALSE(time_of(""));
  CHECK_FALSE(time_of("nan"));
  CHECK_FALSE(time_of("9999999999.0"));
  CHECK_FALSE(time_of("1.0000000000000000000000000x"));
}

TEST_CASE("times and identifiers of every width are written as Python prints them, and read again") {
  const auto interfaces = test::interfaces_named({""});
  const auto row_of = [&](std::int64_t ns, std::uint32_t id) {
    const Entry entry{at_ns(ns), {id, 0, {}, can::Format::extended}};
    log::CsvWriter writer;
    const std::string file = test::written(writer, {&entry, 1}, interfaces);
    CHECK_FALSE(writer.lost().any());
    const Log log{file};
    REQUIRE(log.entries.size() == 1);
    CHECK(log.entries[0] == entry);
    return file.substr(head.size());
  };
  CHECK(row_of(INT64_MAX, 0x1) == "9223372036.854775807,0x1,1,0,0,0,\n");
  CHECK(row_of(-INT64_MAX, 0x12) == "-9223372036.854775807,0x12,1,0,0,0,\n");
  CHECK(row_of(99'999'999'999'999'000, 0x123) == "99999999.999999,0x123,1,0,0,0,\n");
  CHECK(row_of(100'000'000'000'000'000, 0xFFFF) == "100000000.000000,0xffff,1,0,0,0,\n");
  CHECK(row_of(1, 0x1'0000) == "0.000000001,0x10000,1,0,0,0,\n");
  CHECK(row_of(999, 0x10'0000) == "0.000000999,0x100000,1,0,0,0,\n");
  CHECK(row_of(1000, 0x100'0000) == "0.000001,0x1000000,1,0,0,0,\n");
  CHECK(row_of(-1, 0x1FFF'FFFF) == "-0.000000001,0x1fffffff,1,0,0,0,\n");
  test::Random random{13};
  for (int i = 0; i < 2000; ++i)
    row_of(static_cast<std::int64_t>(random.word() >> (1 + random.below(62))), random.below(0x2000'0000));
}

TEST_CASE("a row of every length is one, of CAN FD beyond eight bytes") {
  for (std::size_t length = 0; length <= 65; ++length) {
    const std::string bytes(length, '\xFF');
    char text[2 * log::csv::max_base64];
    char* const end =
        log::csv::to_base64(text, std::span{reinterpret_cast<const std::uint8_t*>(bytes.data()), length});
    const Log log{head + "1.0,0x123,0,0,0," + std::to_string(length) + "," + std::string{text, end} + "\n"};
    CAPTURE(length);
    if (length > 8 && !log::is_fd_length(length)) {
      CHECK(log.entries.empty());
      CHECK(log.reader.complaints().total() == 1);
      continue;
    }
    REQUIRE(log.entries.size() == 1);
    CHECK(log.entries[0].length == length);
    CHECK(log.entries[0].is_fd() == (length > 8));
    CHECK(log.reader.interfaces().name(log.entries[0].interface) == "can0");
  }
}

TEST_CASE("rows that no writer makes are refused by cause, and the rest is read") {
  CHECK(refusal_of("1.0,0x1,0,0,0") == Cause::syntax);
  CHECK(refusal_of("1.0,0x1,0,0,0,0,,") == Cause::syntax);
  CHECK(refusal_of("1.0,0x1,2,0,0,0,") == Cause::syntax);
  CHECK(refusal_of("1.0,0x1,0,1,1,0,") == Cause::syntax);
  CHECK(refusal_of("x,0x1,0,0,0,0,") == Cause::time);
  CHECK(refusal_of("1.0,0x800,0,0,0,0,") == Cause::identifier);
  CHECK(refusal_of("1.0,0x20000000,1,0,0,0,") == Cause::identifier);
  CHECK(refusal_of("1.0,,0,0,0,0,") == Cause::identifier);
  CHECK(refusal_of("1.0,0x1,0,0,0,2,AA==") == Cause::length);
  CHECK(refusal_of("1.0,0x1,0,0,0,9,AAAAAAAAAAAA") == Cause::length);
  CHECK(refusal_of("1.0,0x1,0,1,0,1,AA==") == Cause::length);
  CHECK(refusal_of("1.0,0x1,0,1,0,9,") == Cause::length);
  CHECK(refusal_of("1.0,0x1,0,1,0,12,") == Cause::length);
  CHECK(refusal_of("1.0,0x1,1,0,1,12,AAAAAAAAAAAAAAAA") == Cause::length);
  CHECK(refusal_of("1.0,0x1,0,0,0,1,AA") == Cause::syntax);
  CHECK(refusal_of("1.0,0x1,0,0,0,1,A===") == Cause::syntax);
  CHECK(refusal_of("1.0,0x1,0,0,0,1,A*==") == Cause::syntax);
}

TEST_CASE("random entries survive rows, but for what is counted") {
  const auto interfaces = test::interfaces_named({"can0", "can1", "can2"});
  const auto entries = RandomEntries{5, {}}.many(5000);
  log::CsvWriter writer;
  const Log log{test::written(writer, entries, interfaces)};
  CHECK(log.reader.complaints().total() == 0);
  REQUIRE(log.entries.size() == entries.size());
  std::uint64_t directions = 0, raw = 0, flags = 0;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    Entry expected = entries[i];
    directions += expected.direction != log::Direction::unknown;
    raw += expected.raw_dlc != 0;
    flags += expected.is_fd() && log.entries[i].flags != expected.flags;
    expected.interface = 0;
    expected.direction = log::Direction::unknown;
    expected.raw_dlc = 0;
    expected.flags = expected.length > 8 ? log::flag::fd : 0;
    REQUIRE(log.entries[i] == expected);
  }
  CHECK(writer.lost().count(Lost::direction) == directions);
  CHECK(writer.lost().count(Lost::raw_dlc) == raw);
  CHECK(writer.lost().count(Lost::fd_flags) == flags);
  CHECK(writer.lost().count(Lost::interface) == entries.size());
}

TEST_CASE("base64 of every length, there and back") {
  test::Random random{9};
  for (std::size_t size = 0; size <= 64; ++size) {
    std::array<std::uint8_t, log::max_fd_length> bytes{}, again{};
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(random());
    char text[log::csv::max_base64];
    const char* const end = log::csv::to_base64(text, std::span{bytes}.first(size));
    CHECK(log::csv::from_base64({text, static_cast<std::size_t>(end - text)}, again) == size);
    CHECK(again == bytes);
  }
  std::array<std::uint8_t, log::max_fd_length> bytes{};
  CHECK_FALSE(log::csv::from_base64(std::string{"A\0AA", 4}, bytes));
  CHECK_FALSE(log::csv::from_base64(std::string(92, 'A'), bytes));
  CHECK_FALSE(log::csv::from_base64(std::string(88, 'A'), bytes));  // 66 bytes
}

TEST_CASE("rows that are cut anywhere lose the last at most") {
  const auto entries =
      RandomEntries{3, {.fd = false, .raw_dlc = false, .direction = false, .interfaces = 1}}.many(20);
  log::CsvWriter writer;
  const std::string text = test::written(writer, entries, test::interfaces_named({"can0"}));
  for (std::size_t size = head.size(); size < text.size(); ++size) {
    const auto begin = text.begin() + static_cast<std::ptrdiff_t>(head.size());
    const auto whole =
        static_cast<std::size_t>(std::count(begin, text.begin() + static_cast<std::ptrdiff_t>(size), '\n'));
    test::Drops drops{std::string_view{text}.substr(0, size), 1000, "cut"};
    log::Input input{drops};
    log::CsvReader reader{input};
    Entry some[64];
    std::size_t count = 0;
    while (const std::size_t more = reader.read(some)) {
      for (std::size_t i = 0; i < more; ++i) REQUIRE(some[i] == entries[count + i]);
      count += more;
    }
    REQUIRE(count == whole);
    // Of a file, the row without its end is read where it is whole, and else said to be cut off.
    const test::ReadLog<log::CsvReader> file{std::string_view{text}.substr(0, size)};
    REQUIRE(file.entries.size() >= whole);
    for (std::size_t i = 0; i < file.entries.size(); ++i) REQUIRE(file.entries[i] == entries[i]);
    const bool refused = text[size - 1] != '\n' && file.entries.size() == whole;
    REQUIRE(file.reader.complaints().count(Cause::cut_line) == (refused ? 1 : 0));
    REQUIRE(file.reader.complaints().total() == (refused ? 1 : 0));
  }
}

TEST_CASE("a row without an end is reported as too long, and the next one is read") {
  std::string text = head;
  text.append(log::Input::longest + 10, '0');
  text += "\n0.0,0x1,0,0,0,0,\n";
  const Log log{text};
  CHECK(log.entries.size() == 1);
  REQUIRE(log.reader.complaints().total() == 1);
  CHECK(log.reader.complaints().first()[0].cause == Cause::too_long);
  CHECK(log.reader.complaints().first()[0].place == log::Place{2, true});
}

TEST_CASE("rows come out of a pipe when they come in") {
  const std::string text = head + "0.0,0x1,0,0,0,0,\n0.0,0x2,0,0,0,0,\n0.0,0x";
  test::Drops drops{text, text.size()};
  log::Input input{drops};
  log::CsvReader reader{input};
  Entry entries[8];
  CHECK(reader.read(entries) == 2);
  CHECK(drops.reads == 1);
}

TEST_CASE("the head line is one as the first line alone") {
  CHECK(refusal_of(log::csv::head) == Cause::syntax);
}

TEST_CASE("rows are read without a head line, and with blank ones between them") {
  const Log log{"0.0,0x1,0,0,0,0,\n\n0.0,0x2,0,0,0,0,\n"};
  CHECK(log.reader.complaints().total() == 0);
  REQUIRE(log.entries.size() == 2);
  CHECK(log.entries[1].id == 2);
}

TEST_CASE("the longest row has room, however much there is already") {
  Entry entry;
  entry.time = at_ns(-INT64_MAX);
  entry.id = can::max_extended_id;
  entry.format = can::Format::extended;
  entry.flags = log::flag::fd;
  entry.data.fill(0);
  entry.length = 64;
  const auto interfaces = test::interfaces_named({"can0"});
  const std::string row = "-9223372036.854775807,0x1fffffff,1,0,0,64," + std::string(86, 'A') + "==\n";
  for (std::size_t left = 0; left != 2 * row.size(); ++left) {
    log::Bytes out;
    // What is taken at first is so large; Bytes asserts that no more is written.
    out.zeros((std::size_t{1} << 16) - left);
    log::CsvWriter writer;
    writer.write(out, std::span{&entry, 1}, interfaces);
    CHECK(out.view().substr(out.size() - row.size()) == row);
  }
}

TEST_CASE("python-can's rows are recognised by their head line") {
  CHECK(log::CsvReader::recognises(head + "0.0,0x1,0,0,0,0,\n"));
  CHECK_FALSE(log::CsvReader::recognises("timestamp,arbitration_id"));
  CHECK_FALSE(log::CsvReader::recognises(""));
}

}  // namespace log_csv_test
