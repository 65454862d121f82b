#include "ocm/log/pcap.hpp"

#include <catch2/catch.hpp>

#include "tests/unit/log/log_testing.hpp"
#include "unit/base/random.hpp"

namespace log_pcap_test {

using namespace ocm;
using namespace ocm::log;
using log::testing::at;
using log::testing::bytes;
using log::testing::read_all;

// By hand. [draft-ietf-opsawg-pcap, 4 and 5]: magic, version 2.4, zone, accuracy, longest, link type 227
const std::string little_us = bytes("D4C3B2A1 0200 0400 00000000 00000000 00000400 E3000000");
const std::string big_us = bytes("A1B2C3D4 0002 0004 00000000 00000000 00040000 000000E3");
const std::string little_ns = bytes("4D3CB2A1 0200 0400 00000000 00000000 00000400 E3000000");
const std::string big_ns = bytes("A1B23C4D 0002 0004 00000000 00000000 00040000 000000E3");
// 1 s and 2 units of the fraction, 123#1122
const std::string frame = bytes("00000123 02000000 1122000000000000");
const std::string little_record = bytes("01000000 02000000 10000000 10000000") + frame;
const std::string big_record = bytes("00000001 00000002 00000010 00000010") + frame;

TEST_CASE("pcap: a file by hand, in either byte order and resolution") {
  const can::Frame wanted{0x123, 2, {0x11, 0x22}};
  for (const auto& file :
       {little_us + little_record, big_us + big_record, little_ns + little_record, big_ns + big_record}) {
    CHECK(PcapReader::recognises(file));
    const auto log = read_all<PcapReader>(file);
    REQUIRE(log.entries.size() == 1);
    CHECK(log.complained == 0);
    const bool in_ns =
        static_cast<unsigned char>(file[0]) == 0x4D || static_cast<unsigned char>(file[3]) == 0x4D;
    CHECK(log.entries[0] == Entry{at(in_ns ? 1'000'000'002 : 1'000'002'000), wanted});
    CHECK(log.names[0] == "can0");
  }
}

TEST_CASE("pcap: what is written, byte by byte") {
  Interfaces interfaces;
  interfaces.add("can0");
  PcapWriter writer;
  const std::vector<Entry> entries{Entry{at(1'000'000'002), {0x123, 2, {0x11, 0x22}}}};
  CHECK(log::testing::write_all(writer, entries, interfaces) == little_ns + little_record);
  CHECK_FALSE(writer.lost().any());
}

TEST_CASE("pcap: entries at random survive, but for direction and interface") {
  Interfaces interfaces;
  interfaces.add("can0");
  interfaces.add("vcan1");
  const auto entries = test::RandomEntries{3, {.interfaces = 2}}.many(2000);
  std::uint64_t directed = 0, elsewhere = 0;
  for (const Entry& entry : entries) {
    directed += entry.direction != Direction::unknown ? 1 : 0;
    elsewhere += entry.interface != 0 ? 1 : 0;
  }
  PcapWriter writer;
  const std::string file = log::testing::write_all(writer, entries, interfaces);
  CHECK(writer.lost().count(Lost::direction) == directed);
  CHECK(writer.lost().count(Lost::interface) == elsewhere);
  for (const std::size_t piece : {std::size_t{5}, file.size()}) {
    test::Drops source{file, piece};
    const auto log = log::testing::read_from<PcapReader>(source, 100);
    REQUIRE(log.complained == 0);
    REQUIRE(log.entries.size() == entries.size());
    for (std::size_t i = 0; i < entries.size(); ++i) {
      Entry wanted = entries[i];
      wanted.direction = Direction::unknown;
      wanted.interface = 0;
      REQUIRE(log.entries[i] == wanted);
    }
  }
}

TEST_CASE("pcap: times that 32 bits of seconds do not hold are counted") {
  Interfaces interfaces;
  interfaces.add("can0");
  PcapWriter writer;
  const std::vector<Entry> entries{
      Entry{at(-1), {1, 0, {}}}, Entry{at(4'294'967'296'000'000'000), {1, 0, {}}},
      Entry{at(4'294'967'295'999'999'999), {1, 0, {}}}, Entry{at(0), {1, 0, {}}}};
  const auto log = read_all<PcapReader>(log::testing::write_all(writer, entries, interfaces));
  CHECK(writer.lost().count(Lost::time) == 2);
  CHECK(log.entries.at(0).time == at(0));
  CHECK(log.entries.at(1).time == at(4'294'967'295'999'999'999));
  CHECK(log.entries.at(2).time == at(4'294'967'295'999'999'999));
  CHECK(log.entries.at(3).time == at(0));
}

TEST_CASE("pcap: a capture of all devices") {
  // 276: LINKTYPE_LINUX_SLL2, interface 3 and 4; the bits above 28 of the link type say something else.
  const std::string head = bytes("D4C3B2A1 0200 0400 00000000 00000000 00000400 140100F0");
  const std::string record = bytes(
      "01000000 02000000 24000000 24000000 000C 0000 00000003 0118 04 00"
      "0000000000000000 23010000 02000000 1122000000000000");
  std::string other = record;
  other[23] = 4;
  const auto log = read_all<PcapReader>(head + record + other + record);
  REQUIRE(log.complained == 0);
  CHECK(log.names == std::vector<std::string>{"if3", "if4", "if3"});
  CHECK(log.entries.at(0).id == 0x123);
  CHECK(log.entries.at(0).direction == Direction::sent);
}

TEST_CASE("pcap: more interfaces than any log has are refused, not mixed up") {
  std::string file = bytes("D4C3B2A1 0200 0400 00000000 00000000 00000400 14010000");
  std::string record = bytes(
      "01000000 02000000 24000000 24000000 000C 0000 00000000 0118 04 00"
      "0000000000000000 23010000 02000000 1122000000000000");
  for (std::size_t i = 0; i <= Interfaces::most; ++i) {
    record[22] = static_cast<char>(i >> 8);
    record[23] = static_cast<char>(i & 0xFF);
    file += record;
  }
  const auto log = read_all<PcapReader>(file);
  CHECK(log.entries.size() == Interfaces::most);
  REQUIRE(log.complained == 1);
  CHECK(log.complaints[0].cause == Cause::unsupported);
  CHECK(log.complaints[0].place.number == file.size() - record.size());
}

TEST_CASE("pcap: a live pipe hands on what is there, and nothing of the entries before") {
  const std::string first = little_us + little_record + little_record;
  const std::string file = first + little_record;
  for (const std::size_t beyond : {0U, 5U, 20U}) {  // a bit of the next record
    test::Drops source{file, first.size() + beyond};
    Input input{source};
    PcapReader reader{input};
    std::vector<Entry> some(8);
    for (Entry& entry : some) {
      entry.direction = Direction::sent;
      entry.interface = 7;
    }
    CHECK(reader.read(some) == 2);
    CHECK(source.reads == 1);
    CHECK(some[1].direction == Direction::unknown);
    CHECK(some[1].interface == 0);
    CHECK(reader.read(some) == 1);
    CHECK(reader.read(some) == 0);
    CHECK(reader.complaints().total() == 0);
  }
}

TEST_CASE("pcap: what cannot be a frame is reported, and the rest read") {
  const std::string bad_time = bytes("01000000 40420F00 10000000 10000000") + frame;  // 1'000'000 us
  const std::string cut = bytes("01000000 02000000 09000000 10000000") + frame.substr(0, 9);
  const auto log = read_all<PcapReader>(little_us + bad_time + cut + little_record);
  CHECK(log.entries.size() == 1);
  REQUIRE(log.complaints.size() == 2);
  CHECK(log.complaints[0].cause == Cause::time);
  CHECK(log.complaints[0].place.number == 24);
  CHECK(log.complaints[1].cause == Cause::length);
}

TEST_CASE("pcap: any fraction of a second, and none that is a second") {
  test::Random random{7};
  for (const bool in_ns : {false, true}) {
    const std::uint32_t second = in_ns ? 1'000'000'000 : 1'000'000;
    const auto read = [&](std::uint32_t fraction) {
      std::string record = little_record;
      for (std::size_t i = 0; i < 4; ++i) record[4 + i] = static_cast<char>(fraction >> 8 * i & 0xFF);
      return read_all<PcapReader>((in_ns ? little_ns : little_us) + record);
    };
    std::vector<std::uint32_t> fractions{0, 1, second / 2, second - 1};
    for (int i = 0; i < 100; ++i) fractions.push_back(random.below(second));
    for (const std::uint32_t fraction : fractions) {
      CAPTURE(in_ns, fraction);
      const auto log = read(fraction);
      REQUIRE(log.entries.size() == 1);
      REQUIRE(log.entries[0].time == at(1'000'000'000 + std::int64_t{fraction} * (in_ns ? 1 : 1000)));
    }
    for (const std::uint32_t fraction : {second, second + 1, UINT32_MAX}) {
      CAPTURE(in_ns, fraction);
      const auto log = read(fraction);
      REQUIRE(log.complained == 1);
      REQUIRE(log.complaints[0].cause == Cause::time);
    }
  }
}

TEST_CASE("pcap: other link types are no CAN frames") {
  std::string file = little_us + little_record + little_record;
  file[20] = 1;  // Ethernet
  const auto log = read_all<PcapReader>(file);
  CHECK(log.entries.empty());
  CHECK(log.complained == 2);
  CHECK(log.complaints[0].cause == Cause::unsupported);
  CHECK(log.complaints[0].detail == "link type 1");
}

TEST_CASE("pcap: cut off anywhere, all whole records before are read") {
  const std::string file = little_us + little_record + little_record;
  for (std::size_t size = 0; size <= file.size(); ++size) {
    INFO(size);
    const auto log = read_all<PcapReader>(file.substr(0, size));
    REQUIRE(log.entries.size() == (size < 24 ? 0 : (size - 24) / 32));
    const bool between = size == 0 || (size >= 24 && (size - 24) % 32 == 0);
    REQUIRE(log.complained == (between ? 0 : 1));
    if (!between) REQUIRE(log.complaints[0].cause == Cause::truncated);
  }
}

TEST_CASE("pcap: any bit flipped, and every entry can exist") {
  const std::string whole = little_us + little_record + little_record;
  for (std::size_t bit = 0; bit < whole.size() * 8; ++bit) {
    std::string file = whole;
    file[bit / 8] = static_cast<char>(file[bit / 8] ^ 1 << bit % 8);
    const auto log = read_all<PcapReader>(file);
    REQUIRE(log.entries.size() <= 2);
    for (const Entry& entry : log.entries) REQUIRE(log::testing::can_exist(entry));
  }
}

TEST_CASE("pcap: a record of gigabytes ends the reading") {
  const auto log =
      read_all<PcapReader>(little_us + little_record + bytes("01000000 02000000 FFFFFFFF 10000000") + frame);
  CHECK(log.entries.size() == 1);
  REQUIRE(log.complained == 1);
  CHECK(log.complaints[0].cause == Cause::too_long);
  CHECK(log.complaints[0].place.number == 24 + 32);
}

TEST_CASE("pcap: the longest record that is read, and one that is longer") {
  const auto with_packet_of = [](std::size_t size) {
    std::string head = bytes("01000000 02000000");
    for (int i = 0; i < 8; ++i) head += static_cast<char>(size >> 8 * (i % 4) & 0xFF);
    return read_all<PcapReader>(little_us + head + std::string(size, '\xFF') + little_record);
  };
  const auto longest = with_packet_of(Input::longest - pcap::record_header);
  CHECK(longest.entries.size() == 1);  // what is behind it
  REQUIRE(longest.complained == 1);
  CHECK(longest.complaints[0].cause != Cause::too_long);  // it is no frame
  const auto longer = with_packet_of(Input::longest - pcap::record_header + 1);
  CHECK(longer.entries.empty());
  REQUIRE(longer.complained == 1);
  CHECK(longer.complaints[0].cause == Cause::too_long);
}

TEST_CASE("pcap: what it is not") {
  CHECK_FALSE(PcapReader::recognises(""));
  CHECK_FALSE(PcapReader::recognises(little_us.substr(0, 23)));
  CHECK(PcapReader::recognises(little_us));  // of a log without frames
  CHECK_FALSE(PcapReader::recognises(std::string(24, 'x')));
  const auto log = read_all<PcapReader>(std::string(24, 'x') + little_record);
  CHECK(log.entries.empty());
  CHECK(log.complained == 1);
}

}  // namespace log_pcap_test
