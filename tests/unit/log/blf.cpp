#include "ocm/log/blf.hpp"

#include <catch2/catch.hpp>

#include "tests/unit/log/log_testing.hpp"

namespace log_blf_test {

using namespace ocm;
using namespace ocm::log;
using log::testing::at;
using log::testing::bytes;
using log::testing::Zone;

constexpr std::int64_t start = 1'700'000'000'123'000'000;

/// In place of zlib: data that is to repeat its first byte so often, "3x" for "xxx".
std::size_t repeat(std::string_view packed, std::span<char> into) {
  if (packed.size() < 2 || packed[0] < '0' || packed[0] > '9') return 0;
  const std::size_t times = static_cast<std::size_t>(packed[0] - '0');
  std::string out;
  for (std::size_t i = 0; i < times; ++i) out += packed.substr(1);
  const std::size_t count = std::min(out.size(), into.size());
  std::memcpy(into.data(), out.data(), count);
  return count;
}

log::testing::Log read_blf(std::string_view file, Inflate inflate = repeat) {
  const Zone zone{"UTC0"};
  return log::testing::read_all<BlfReader>(file, inflate);
}

// By hand. [python-can io/blf.py; Vector BLF, FileStatistics] LOGG, 144 bytes, application, sizes, counts;
// 2023-11-14 (Tuesday) 22:13:20.123; the same as end; padding
const std::string head =
    bytes(
        "4C4F4747 90000000 05000000 02060801 9000000000000000 9000000000000000 00000000 00000000"
        "E707 0B00 0200 0E00 1600 0D00 1400 7B00  E707 0B00 0200 0E00 1600 0D00 1400 7B00") +
    std::string(72, '\0');

/// An object with a head of version 1: time in nanoseconds, unless `flags` is 1.
std::string object(std::uint32_t type, std::uint64_t time, std::string_view body_in_hex,
                   std::uint32_t flags = 2) {
  const std::string body = bytes(body_in_hex);
  Bytes out;
  out.append("LOBJ");
  out.little(std::uint16_t{32});
  out.little(std::uint16_t{1});
  out.little(static_cast<std::uint32_t>(32 + body.size()));
  out.little(type);
  out.little(flags);
  out.little(std::uint32_t{0});
  out.little(time);
  out.append(body);
  return std::string{out.view()};
}
std::string container(std::string_view content, std::uint16_t method = 0, std::uint32_t size = 0) {
  Bytes out;
  out.append("LOBJ");
  out.little(std::uint16_t{16});
  out.little(std::uint16_t{1});
  out.little(static_cast<std::uint32_t>(32 + content.size()));
  out.little(std::uint32_t{10});
  out.little(method);
  out.zeros(6);
  out.little(size != 0 ? size : static_cast<std::uint32_t>(content.size()));
  out.zeros(4);
  out.append(content);
  out.zeros(content.size() % 4);  // as python-can and Vector's tools fill up
  return std::string{out.view()};
}
// Channel 2, received, 2 bytes, 0x123
const std::string message = object(1, 5, "0200 00 02 23010000 1122000000000000");

Entry entry_of(std::string_view one) {
  const auto log = read_blf(head + container(one));
  REQUIRE(log.complained == 0);
  REQUIRE(log.entries.size() == 1);
  return log.entries[0];
}
Cause cause_of(std::string_view one) {
  const auto log = read_blf(head + container(std::string{one} + message));
  REQUIRE(log.entries.size() == 1);  // the one behind
  REQUIRE(log.complained == 1);
  return log.complaints[0].cause;
}

TEST_CASE("blf: a file by hand") {
  CHECK(BlfReader::recognises(head));
  const auto log = read_blf(head + container(message));
  REQUIRE(log.complained == 0);
  REQUIRE(log.entries.size() == 1);
  Entry wanted{at(start + 5), {0x123, 2, {0x11, 0x22}}};
  wanted.direction = Direction::received;
  CHECK(log.entries[0] == wanted);
  CHECK(log.names[0] == "can1");
}

TEST_CASE("blf: kinds of frames") {
  const Entry sent = entry_of(object(86, 5, "0100 01 0F 23010080 1122334455667788 00000000 00000000"));
  CHECK(sent.direction == Direction::sent);
  CHECK(sent.raw_dlc == 15);
  CHECK(sent.length == 8);
  CHECK(sent.format == can::Format::extended);
  const Entry remote = entry_of(object(1, 5, "0100 80 05 23010000 1122334455667788"));
  CHECK(remote.format == can::Format::base_remote);
  CHECK(remote.length == 5);
  CHECK(remote.data[0] == 0);

  const std::string twelve = "0102030405060708090A0B0C";
  const Entry fd = entry_of(
      object(100, 5, "0100 01 09 23010000 00000000 00 07 0C 00 00000000" + twelve + std::string(104, '0')));
  CHECK(fd.length == 12);
  CHECK(fd.data[11] == 0x0C);
  CHECK(fd.flags == (flag::fd | flag::bit_rate_switch | flag::error_state));
  CHECK(fd.direction == Direction::sent);
  CHECK(entry_of(object(100, 5, "0100 00 02 23010000 00000000 00 00 02 00 00000000 1122")).flags == 0);

  const std::string middle = "00000000 00000000 00000000 00000000 0000";  // bit rates, offsets, bits
  const Entry fd64 =
      entry_of(object(101, 5, "02 09 0C 00 23010080 00000000 00300000" + middle + "01 00 00000000" + twelve));
  CHECK(fd64.length == 12);
  CHECK(fd64.flags == (flag::fd | flag::bit_rate_switch));
  CHECK(fd64.direction == Direction::sent);
  CHECK(fd64.format == can::Format::extended);
  const Entry remote64 =
      entry_of(object(101, 5, "01 03 00 00 23010000 00000000 10000000" + middle + "00 00 00000000"));
  CHECK(remote64.format == can::Format::base_remote);
  CHECK(remote64.length == 3);

  CHECK(is_bus_error(entry_of(object(2, 5, "0100 0600"))));
  CHECK(is_bus_error(entry_of(
      object(73, 5, "0100 0000 00000000 00 00 08 00 00000000 04000000 0000 0000 0011223344556677"))));
  CHECK(is_bus_error(entry_of(object(104, 5, "01 00 00 00 0000 0000 0000 00 00"))));
}

/// Bytes of numbers, low byte first.
std::string hex8(unsigned number) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  return {digits[number / 16 % 16], digits[number % 16]};
}
std::string hex16(unsigned number) {
  return hex8(number) + hex8(number >> 8);
}
std::string hex32(std::uint32_t number) {
  return hex16(number) + hex16(number >> 16);
}
std::string counted(std::size_t bytes) {
  std::string text;
  for (std::size_t i = 0; i < bytes; ++i) text += hex8(static_cast<unsigned>(i + 1));
  return text;
}

TEST_CASE("blf: CAN FD of every length and with each flag, in both kinds of message") {
  const std::string middle = "00000000 00000000 00000000 00000000 0000";
  for (unsigned dlc = 0; dlc < 16; ++dlc) {
    const unsigned length = fd_length(dlc);
    for (unsigned bits = 0; bits < 4; ++bits) {
      const bool switches = (bits & 1) != 0, passive = (bits & 2) != 0;
      CAPTURE(dlc, switches, passive);
      Entry wanted{at(start + 5), {0x7FF, 0, {}}};
      wanted.length = static_cast<std::uint8_t>(length);
      wanted.flags = static_cast<std::uint8_t>(flag::fd | (switches ? flag::bit_rate_switch : 0) |
                                               (passive ? flag::error_state : 0));
      for (unsigned i = 0; i < length; ++i) wanted.data[i] = static_cast<std::uint8_t>(i + 1);
      wanted.direction = Direction::sent;
      const unsigned fd = 1U | (switches ? 2U : 0U) | (passive ? 4U : 0U);
      CHECK(entry_of(object(100, 5,
                            "0100 01" + hex8(dlc) + hex32(0x7FF) + "00000000 00" + hex8(fd) + hex8(length) +
                                "00 00000000" + counted(length))) == wanted);
      const std::uint32_t flags = 0x1000U | (switches ? 0x2000U : 0U) | (passive ? 0x4000U : 0U);
      CHECK(entry_of(object(101, 5,
                            "01" + hex8(dlc) + hex8(length) + "00" + hex32(0x7FF) + "00000000" +
                                hex32(flags) + middle + "01 00 00000000" + counted(length))) == wanted);
    }
  }
}

TEST_CASE("blf: the last channel, identifier and length code that a message may have") {
  const auto plain = [](std::uint32_t id, unsigned dlc, std::string_view channel = "0100") {
    return object(1, 5, std::string{channel} + "00" + hex8(dlc) + hex32(id) + counted(8));
  };
  CHECK(entry_of(plain(0x7FF, 8)).id == 0x7FF);
  CHECK(cause_of(plain(0x800, 8)) == Cause::identifier);
  CHECK(entry_of(plain(0x9FFF'FFFF, 8)).id == 0x1FFF'FFFF);
  CHECK(entry_of(plain(0x9FFF'FFFF, 8)).format == can::Format::extended);
  CHECK(cause_of(plain(0xA000'0000, 8)) == Cause::identifier);
  for (unsigned dlc = 0; dlc < 16; ++dlc) {
    const Entry entry = entry_of(plain(1, dlc));
    CHECK(entry.length == std::min(dlc, 8U));
    CHECK(entry.raw_dlc == (dlc > 8 ? dlc : 0));
    for (unsigned i = 0; i < 8; ++i) CHECK(entry.data[i] == (i < dlc ? i + 1 : 0));
  }
  CHECK(cause_of(plain(1, 16)) == Cause::length);
  const auto names = [](std::string_view one) { return read_blf(head + container(one)).names.at(0); };
  CHECK(names(plain(1, 8, "FF00")) == "can254");
  CHECK(cause_of(plain(1, 8, "0001")) == Cause::unsupported);
  CHECK(names(object(2, 5, "FF00 0600")) == "can254");
  CHECK(cause_of(object(2, 5, "0001 0600")) == Cause::unsupported);
  CHECK(names(object(104, 5, "FF 00 00 00 0000 0000 0000 00 00")) == "can254");
  CHECK(names(object(73, 5, "0300 0000 00000000")) == "can2");
  const Entry remote = entry_of(object(1, 5, "0100 81 03" + hex32(0x9FFF'FFFF) + counted(8)));
  CHECK(remote.format == can::Format::extended_remote);
  CHECK(remote.direction == Direction::sent);
}

TEST_CASE("blf: a message that ends with its last number has no data, a byte less is none") {
  const auto of_size = [](std::uint32_t type, std::size_t size) {
    return object(type, 5, std::string(2 * size, '0'));
  };
  for (const auto& [type, size] : {std::pair{1U, 8U}, {86U, 8U}, {100U, 20U}, {101U, 40U}}) {
    CAPTURE(type);
    CHECK(entry_of(of_size(type, size)).length == 0);
    CHECK(cause_of(of_size(type, size - 1)) == Cause::length);
  }
  for (const std::uint32_t type : {2U, 73U, 104U}) {
    CAPTURE(type);
    CHECK(is_bus_error(entry_of(of_size(type, 4))));
    CHECK(cause_of(of_size(type, 3)) == Cause::length);
  }
}

TEST_CASE("blf: times of either unit, and heads of either version") {
  CHECK(entry_of(object(1, 7, "0100 00 00 23010000 0000000000000000", 1)).time == at(start + 70'000));
  std::string second =
      object(1, 7, "00000000 00000000 0100 00 00 23010000 0000000000000000");  // original time
  second[4] = 40;
  second[6] = 2;
  CHECK(entry_of(second).time == at(start + 7));
}

TEST_CASE("blf: an unknown start is 0, one that cannot be is said") {
  std::string none = head;
  std::fill_n(none.begin() + 40, 16, '\0');
  const auto log = read_blf(none + container(message));
  CHECK(log.complained == 0);
  CHECK(log.entries.at(0).time == at(5));
  std::string wrong = head;
  wrong[42] = 13;
  CHECK(read_blf(wrong + container(message)).complaints.at(0).cause == Cause::time);
}

TEST_CASE("blf: objects go over from one container to the next") {
  const std::string objects = message + object(0x41, 0, "010203") + std::string(3, '\0') + message + message;
  for (std::size_t first = 1; first < objects.size(); ++first) {
    INFO(first);
    const auto log = read_blf(head + container(objects.substr(0, first)) + container(objects.substr(first)));
    REQUIRE(log.complained == 0);
    REQUIRE(log.entries.size() == 3);
  }
}

TEST_CASE("blf: containers that are packed") {
  const auto log =
      read_blf(head + container("2" + message, 2, static_cast<std::uint32_t>(2 * message.size())));
  CHECK(log.complained == 0);
  CHECK(log.entries.size() == 2);
  const auto short_one =
      read_blf(head + container("1" + message, 2, static_cast<std::uint32_t>(2 * message.size())));
  CHECK(short_one.entries.size() == 1);
  CHECK(short_one.complaints.at(0).cause == Cause::compressed);
  const auto bomb = read_blf(head + container("9" + message, 2, 48));
  CHECK(bomb.entries.size() == 1);  // no more than was said
  CHECK(read_blf(head + container("xyz", 2, 48) + container(message)).complaints.at(0).cause ==
        Cause::compressed);
  CHECK(read_blf(head + container("1" + message, 7, 48)).complaints.at(0).cause == Cause::compressed);
  CHECK(read_blf(head + container("1" + message, 2, 48), nullptr).complaints.at(0).cause ==
        Cause::compressed);
  const auto huge = read_blf(head + container("1" + message, 2, 0xFFFF'FFFF) + container(message));
  CHECK(huge.complaints.at(0).cause == Cause::too_long);
  CHECK(huge.entries.size() == 1);
  // As much as may be claimed, and one byte more.
  const auto most = static_cast<std::uint32_t>(Input::longest);
  CHECK(read_blf(head + container("1" + message, 2, most)).complaints.at(0).cause == Cause::compressed);
  CHECK(read_blf(head + container("1" + message, 2, most + 1)).complaints.at(0).cause == Cause::too_long);
}

TEST_CASE("blf: objects without a container") {
  const auto log = read_blf(head + message + message);
  CHECK(log.entries.size() == 2);
  CHECK(log.complained == 0);
}

TEST_CASE("blf: frames that cannot be, and requests to send") {
  CHECK(cause_of(object(1, 5, "0001 00 02 23010000 1122000000000000")) == Cause::unsupported);  // channel 256
  CHECK(cause_of(object(1, 5, "0100 00 02 00080000 1122000000000000")) == Cause::identifier);
  CHECK(cause_of(object(1, 5, "0100 00 02 000000A0 1122000000000000")) == Cause::identifier);
  CHECK(cause_of(object(1, 5, "0100 00 10 23010000 1122000000000000")) == Cause::length);
  CHECK(cause_of(object(1, 5, "0100 00 02 23010000 11")) == Cause::length);
  CHECK(cause_of(object(1, 5, "0100 00 02")) == Cause::length);
  CHECK(cause_of(object(100, 5, "0100 80 02 23010000 00000000 00 01 02 00 00000000 1122")) == Cause::syntax);
  CHECK(cause_of(object(100, 5, "0100 00 02 23010000 00000000 00 01 01 00 00000000 1122")) == Cause::length);
  CHECK(cause_of(object(100, 5, "0100")) == Cause::length);
  CHECK(cause_of(object(101, 5, "01")) == Cause::length);
  CHECK(cause_of(object(2, 5, "01")) == Cause::length);
  CHECK(cause_of(object(1, UINT64_MAX, "0100 00 00 23010000 0000000000000000")) == Cause::time);
  CHECK(cause_of(object(1, UINT64_MAX, "0100 00 00 23010000 0000000000000000", 1)) == Cause::time);
  std::string headless = message;
  headless[4] = 31;
  CHECK(cause_of(headless) == Cause::syntax);
  headless[4] = 100;
  CHECK(cause_of(headless) == Cause::syntax);
  const auto pending = read_blf(head + container(object(1, 5, "0100 02 00 23010000 0000000000000000")));
  CHECK(pending.entries.empty());
  CHECK(pending.complained == 0);
}

TEST_CASE("blf: sizes that cannot be are said, and reading goes on") {
  for (const std::uint32_t size : {0U, 15U, 0xFFFF'FFFFU, 0x7FFF'FFFFU}) {
    std::string wrong = message;
    std::memcpy(wrong.data() + 8, &size, sizeof size);
    INFO(size);
    const auto inside = read_blf(head + container(message + wrong + message));
    CHECK(inside.entries.size() == 2);
    CHECK(inside.complained == 1);
    std::string outside = container(message);
    std::memcpy(outside.data() + 8, &size, sizeof size);
    const auto log = read_blf(head + outside + container(message));
    CHECK(log.entries.size() == 2);  // the object inside is found by its signature
    CHECK(log.complained >= 1);
  }
}

TEST_CASE("blf: cut off anywhere, all whole objects before are read") {
  const std::string file = head + container(message) + container(message + message);
  const std::size_t first = head.size() + 32 + message.size();
  for (std::size_t size = 1; size < file.size(); ++size) {
    INFO(size);
    const auto log = read_blf(file.substr(0, size));
    REQUIRE(log.entries.size() == (size < first             ? 0
                                   : size < first + 32 + 48 ? 1
                                   : size < first + 32 + 96 ? 2
                                                            : 3));
    if (size != head.size() && size != first) REQUIRE(log.complained >= 1);
  }
}

TEST_CASE("blf: any bit flipped, and every entry can exist") {
  const std::string whole = head + container(message +
                                             object(100, 5,
                                                    "0100 01 09 23010000 00000000 00 07 0C 00 00000000 "
                                                    "0102030405060708090A0B0C") +
                                             message);
  for (std::size_t bit = 0; bit < whole.size() * 8; ++bit) {
    std::string file = whole;
    file[bit / 8] = static_cast<char>(file[bit / 8] ^ 1 << bit % 8);
    const auto log = read_blf(file);
    REQUIRE(log.entries.size() <= 3);
    for (const Entry& entry : log.entries) REQUIRE(log::testing::can_exist(entry));
  }
}

TEST_CASE("blf: a complaint says what is wrong, and where") {
  struct Case {
    std::string behind_head;
    Cause cause;
    std::string_view detail;
    std::size_t place, entries;
  };
  const auto sized = [](std::string object, std::uint32_t size) {
    std::memcpy(object.data() + 8, &size, sizeof size);
    return object;
  };
  const std::string one = container(message);
  const std::size_t begin = head.size();
  for (const Case& each : std::initializer_list<Case>{
           {container(sized(message, 15) + message), Cause::syntax, "an object of 15 bytes", begin, 1},
           {one + container(sized(message, 0x7FFF'FFFF) + message), Cause::too_long,
            "an object of 2147483647 bytes", begin + 80, 2},
           {one + "xxxx" + one, Cause::syntax, "no object begins here", begin + 80, 2},
           {container(message + "xxxx" + message), Cause::syntax, "no object begins in the container", begin,
            2},
           {one + container(message.substr(0, 20)), Cause::truncated, "an object", begin + 80, 1},
           {one + "LOB", Cause::truncated, "the beginning of an object", begin + 80, 1},
           {one + std::string(4, '\0'), Cause::truncated, "the beginning of an object", begin + 80, 1},
       }) {
    CAPTURE(each.detail);
    const auto log = read_blf(head + each.behind_head);
    CHECK(log.entries.size() == each.entries);
    REQUIRE(log.complained == 1);
    CHECK(log.complaints[0].cause == each.cause);
    CHECK(log.complaints[0].detail == each.detail);
    CHECK(log.complaints[0].place == Place{each.place});
  }
  const auto cut = read_blf(head + one + one.substr(0, 70));
  REQUIRE(cut.complained == 2);
  CHECK(cut.complaints[0].detail == "an object, 70 of 80 bytes");
  CHECK(cut.complaints[1].detail == "an object");
  for (const std::size_t size : {std::size_t{4}, begin - 1}) {
    const auto headless = read_blf(head.substr(0, size));
    REQUIRE(headless.complained == 1);
    CHECK(headless.complaints[0].cause == Cause::truncated);
    CHECK(headless.complaints[0].detail == "the file's head");
  }
  CHECK(read_blf("").complained == 0);
}

TEST_CASE("blf: objects of the shortest size, and containers without one, are passed over") {
  const std::string shortest = bytes("4C4F424A 1000 0100 10000000 41000000");
  const std::string file = head + shortest + container("") + container(shortest + message);
  const auto log = read_blf(file);
  CHECK(log.complained == 0);
  CHECK(log.entries.size() == 1);
  const auto headless =
      read_blf(head + bytes("4C4F424A 1000 0100 14000000 0A000000 00000000") + container(message));
  CHECK(headless.entries.size() == 1);
  REQUIRE(headless.complained == 1);
  CHECK(headless.complaints[0].cause == Cause::length);
  CHECK(headless.complaints[0].detail == "a container");
  CHECK(cause_of(object(1, 5, "")) == Cause::length);
}

TEST_CASE("blf: damage is said of once, and the next one again") {
  const std::string rubbish(200, 'x');
  const auto between = read_blf(head + rubbish + container(message) + rubbish + container(message));
  CHECK(between.entries.size() == 2);
  CHECK(between.complained == 2);
  const auto over = read_blf(head + container(rubbish) + container(rubbish + message + rubbish + message));
  CHECK(over.entries.size() == 2);
  CHECK(over.complained == 2);
  std::string small = message;
  small[8] = 15;
  const auto behind = read_blf(head + container(small + message + rubbish + message));
  CHECK(behind.entries.size() == 2);
  CHECK(behind.complained == 2);
  std::string large = message;
  large[7] = '\x7F';  // behind another signature it is the highest byte of a size
  const auto twice = read_blf(head + container("LOBJ" + large + rubbish + message));
  CHECK(twice.entries.size() == 2);
  CHECK(twice.complained == 2);
}

TEST_CASE("blf: a head of 72 bytes is long enough, a shorter one is none") {
  for (const char size : {'\x48', '\x0A'}) {  // a size that cannot be is at least so much
    std::string shortest = head.substr(0, 72);
    std::fill_n(shortest.begin() + 4, 4, '\0');
    shortest[4] = size;
    const auto log = read_blf(shortest + container(message));
    CHECK(log.complained == 0);
    REQUIRE(log.entries.size() == 1);
    CHECK(log.entries[0].time == at(start + 5));
    const auto shorter = read_blf(shortest.substr(0, 71));
    REQUIRE(shorter.complained == 1);
    CHECK(shorter.complaints[0].cause == Cause::truncated);
  }
}

TEST_CASE("blf: nothing of the entry before stays") {
  const std::string file =
      head +
      container(object(1, 5, "0100 00 0F 23010000 1122334455667788") +
                object(101, 5,
                       "01 0F 40 00 23010080 00000000 00700000 00000000 00000000 00000000 00000000"
                       "0000 01 00 00000000" +
                           counted(64)) +
                message + object(1, 5, "0100 80 05 23010000 1122334455667788") +
                object(1, 5, "0100 00 0F 23010000 1122334455667788") + object(2, 5, "0100 0600") + message);
  const Zone zone{"UTC0"};
  MemorySource source{file};
  const auto log = log::testing::read_from<BlfReader>(source, 1, Inflate{repeat});
  CHECK(log.complained == 0);
  REQUIRE(log.entries.size() == 7);
  CHECK(log.entries[1].length == 64);
  for (const Entry& entry : log.entries) CHECK(log::testing::can_exist(entry));
  CHECK(log.entries[2] == log.entries[6]);
}

TEST_CASE("blf: up to three bytes between objects are filling") {
  for (const std::size_t bytes_between : {1U, 2U, 3U}) {
    const std::string filling(bytes_between, '\0');
    CHECK(read_blf(head + container(message) + filling + container(message) + filling).complained == 0);
    CHECK(read_blf(head + container(message + filling + message + filling)).complained == 0);
  }
}

TEST_CASE("blf: what it is not") {
  CHECK_FALSE(BlfReader::recognises("LOG"));
  const auto log = read_blf(std::string(200, 'x'));
  CHECK(log.entries.empty());
  REQUIRE(log.complained == 1);
  CHECK(log.complaints[0].cause == Cause::syntax);
}

}  // namespace log_blf_test
