#include "ocm/log/pcapng.hpp"

#include <cstdio>

#include <catch2/catch.hpp>

#include "tests/unit/log/log_testing.hpp"

namespace log_pcapng_test {

using namespace ocm;
using namespace ocm::log;
using log::testing::at;
using log::testing::bytes;
using log::testing::read_all;

// Blocks by hand. [draft-ietf-opsawg-pcapng, 4.1, 4.2, 4.3]
const std::string little_section = bytes("0A0D0D0A 1C000000 4D3C2B1A 0100 0000 FFFFFFFFFFFFFFFF 1C000000");
const std::string big_section = bytes("0A0D0D0A 0000001C 1A2B3C4D 0001 0000 FFFFFFFFFFFFFFFF 0000001C");
// Link type 227, no limit; if_name "can7", if_tsresol 10^-9.
const std::string little_can7 = bytes(
    "01000000 28000000 E300 0000 00000000  0200 0400 63616E37  0900 0100 09 000000  0000 0000  28000000");
const std::string big_can7 = bytes(
    "00000001 00000028 00E3 0000 00000000  0002 0004 63616E37  0009 0001 09 000000  0000 0000  00000028");
// 1.000000002 s, 123#1122; epb_flags: outbound.
const std::string little_packet = bytes(
    "06000000 3C000000 00000000 00000000 02CA9A3B 10000000 10000000"
    "00000123 02000000 1122000000000000  0200 0400 02000000  0000 0000  3C000000");
const std::string big_packet = bytes(
    "00000006 0000003C 00000000 00000000 3B9ACA02 00000010 00000010"
    "00000123 02000000 1122000000000000  0002 0004 00000002  0000 0000  0000003C");

/// A little-endian block around its body.
std::string block(std::uint32_t type, std::string_view body) {
  Bytes out;
  const auto size = static_cast<std::uint32_t>(body.size() + 12);
  out.little(type);
  out.little(size);
  out.append(body);
  out.little(size);
  return std::string{out.view()};
}
std::string interface_with(std::string_view options_in_hex) {
  return block(1, bytes("E300 0000 00000000" + std::string{options_in_hex}));
}
std::string packet_at(std::uint32_t high, std::uint32_t low) {
  Bytes out;
  out.little(std::uint32_t{0});
  out.little(high);
  out.little(low);
  out.append(bytes("10000000 10000000 00000123 02000000 1122000000000000"));
  return block(6, out.view());
}
/// What a packet's time is read as; -1: it is complained of.
std::int64_t time_read(std::string_view options_in_hex, std::uint32_t high, std::uint32_t low) {
  const auto log =
      read_all<PcapngReader>(little_section + interface_with(options_in_hex) + packet_at(high, low));
  if (log.entries.size() == 1) return log.entries[0].time.time_since_epoch().count();
  REQUIRE(log.complaints.at(0).cause == Cause::time);
  return -1;
}

TEST_CASE("pcapng: a file by hand, in either byte order") {
  for (const auto& file :
       {little_section + little_can7 + little_packet, big_section + big_can7 + big_packet}) {
    CHECK(PcapngReader::recognises(file));
    const auto log = read_all<PcapngReader>(file);
    REQUIRE(log.entries.size() == 1);
    CHECK(log.complained == 0);
    CHECK(log.names[0] == "can7");
    Entry wanted{at(1'000'000'002), {0x123, 2, {0x11, 0x22}}};
    wanted.direction = Direction::sent;
    CHECK(log.entries[0] == wanted);
  }
}

TEST_CASE("pcapng: what is written, byte by byte") {
  Interfaces interfaces;
  interfaces.add("can7");
  Entry entry{at(1'000'000'002), {0x123, 2, {0x11, 0x22}}};
  entry.direction = Direction::sent;
  PcapngWriter writer;
  const std::vector<Recorded> recorded{{5, 2}};
  const std::string file = log::testing::write_all(writer, {{entry}}, interfaces, recorded);
  // shb_userappl "ocm"; statistics at the time of the last packet: isb_ifrecv 5, isb_ifdrop 2.
  CHECK(file ==
        bytes("0A0D0D0A 28000000 4D3C2B1A 0100 0000 FFFFFFFFFFFFFFFF 0400 0300 6F636D00 0000 0000 28000000") +
            little_can7 + little_packet +
            bytes("05000000 34000000 00000000 00000000 02CA9A3B"
                  "0400 0800 0500000000000000 0500 0800 0200000000000000 0000 0000 34000000"));
  CHECK_FALSE(writer.lost().any());
  const auto log = read_all<PcapngReader>(file);
  REQUIRE(log.recorded.size() == 1);
  CHECK(log.recorded[0].received == 5);
  CHECK(log.recorded[0].dropped == 2);
}

TEST_CASE("pcapng: entries at random survive, whatever the pieces they come in") {
  Interfaces interfaces;
  for (const auto* name : {"can0", "vcan0", "a name with blanks"}) interfaces.add(name);
  const auto entries = test::RandomEntries{2, {}}.many(3000);
  PcapngWriter writer;
  const std::string file = log::testing::write_all(writer, entries, interfaces);
  CHECK_FALSE(writer.lost().any());
  for (const std::size_t piece : {std::size_t{7}, std::size_t{4096}, file.size()})
    for (const std::size_t batch_size : {std::size_t{1}, std::size_t{256}}) {
      test::Drops source{file, piece};
      const auto log = log::testing::read_from<PcapngReader>(source, batch_size);
      REQUIRE(log.complained == 0);
      REQUIRE(log.entries == entries);
      for (std::size_t i = 0; i < entries.size(); ++i) {
        REQUIRE(log.names[i] == interfaces.name(entries[i].interface));
        REQUIRE(log::testing::can_exist(log.entries[i]));
      }
    }
}

TEST_CASE("pcapng: every resolution and offset of time") {
  CHECK(time_read("", 0, 1'500'000) == 1'500'000'000);                       // microseconds
  CHECK(time_read("0900 0100 00 000000", 0, 7) == 7'000'000'000);            // 1 s
  CHECK(time_read("0900 0100 03 000000", 0, 1500) == 1'500'000'000);         // 10^-3
  CHECK(time_read("0900 0100 0C 000000", 1, 0) == 4'294'967);                // 10^-12: 2^32 ps
  CHECK(time_read("0900 0100 7F 000000", 0xFFFF'FFFF, 0xFFFF'FFFF) == 0);    // 10^-127
  CHECK(time_read("0900 0100 1C 000000", 0xFFFF'FFFF, 0xFFFF'FFFF) == 1);    // 10^-28
  CHECK(time_read("0900 0100 80 000000", 0, 3) == 3'000'000'000);            // 2^0
  CHECK(time_read("0900 0100 9E 000000", 0, 0x6000'0000) == 1'500'000'000);  // 2^-30
  CHECK(time_read("0900 0100 BF 000000", 0xC000'0000, 0) == 1'500'000'000);  // 2^-63
  CHECK(time_read("0900 0100 FF 000000", 0xFFFF'FFFF, 0xFFFF'FFFF) == 0);    // 2^-127
  CHECK(time_read("0900 0100 C0 000000", 0x8000'0000, 0) == 500'000'000);    // 2^-64
  CHECK(time_read("0900 0100 E0 000000", 0xFFFF'FFFF, 0xFFFF'FFFF) == 0);    // 2^-96
  // Options of another kind, and of another length.
  CHECK(time_read("0200 0100 61000000", 0, 1'500'000) == 1'500'000'000);
  CHECK(time_read("0200 0800 6162636465666768", 0, 1'500'000) == 1'500'000'000);
  CHECK(time_read("0900 0400 09000000", 0, 1'500'000) == 1'500'000'000);
  CHECK(time_read("0E00 0400 01000000", 0, 1'500'000) == 1'500'000'000);
  CHECK(time_read("0900 0100 09 000000 0E00 0800 E803000000000000", 0, 5) == 1'000'000'000'005);
  CHECK(time_read("0900 0100 09 000000 0E00 0800 FFFFFFFFFFFFFFFF", 0, 1'000'000'001) == 1);
  CHECK(time_read("0900 0100 09 000000 0E00 0800 FEFFFFFFFFFFFFFF", 0, 5) == -1'999'999'995);  // before 1970
  CHECK(time_read("0900 0100 09 000000", 0x7FFF'FFFF, 0xFFFF'FFFF) == INT64_MAX);
  CHECK(time_read("0900 0100 09 000000", 0x8000'0000, 0) == -1);
  CHECK(time_read("0900 0100 00 000000", 2, 0x2551'0000) == 9'216'000'000'000'000'000);
  CHECK(time_read("0900 0100 00 000000", 3, 0) == -1);
  CHECK(time_read("0E00 0800 FFFFFFFFFFFFFF7F", 0, 0) == -1);
}

TEST_CASE("pcapng: blocks without frames are passed over, others said") {
  const std::string other = block(0x0BAD, bytes("00112233")) + block(0x0BAD, "");
  const std::string ethernet = block(1, bytes("0100 0000 00000000"));
  const std::string simple = block(3, bytes("10000000 00000123 02000000 1122000000000000"));
  const std::string of_ethernet = block(6, bytes("01000000 00000000 00000000 04000000 04000000 00000000"));
  const std::string of_no_interface =
      block(6, bytes("09000000 00000000 00000000 04000000 04000000 00000000"));
  const auto log = read_all<PcapngReader>(little_section + other + little_can7 + ethernet + simple +
                                          of_ethernet + of_no_interface + little_packet);
  CHECK(log.entries.size() == 1);
  REQUIRE(log.complaints.size() == 3);
  CHECK(log.complaints[0].cause == Cause::time);
  CHECK(log.complaints[0].place.number == 28 + 16 + 12 + 40 + 20);
  CHECK(log.complaints[1].cause == Cause::unsupported);
  CHECK(log.complaints[1].detail == "link type 1");
  CHECK(log.complaints[2].cause == Cause::syntax);
}

TEST_CASE("pcapng: options in any company say the direction") {
  const auto with = [](std::string_view options) {
    const auto log = read_all<PcapngReader>(
        little_section + little_can7 +
        block(6, bytes("00000000 00000000 02CA9A3B 10000000 10000000 00000123 02000000 1122000000000000" +
                       std::string{options})));
    REQUIRE(log.entries.size() == 1);
    CHECK(log.entries[0].id == 0x123);
    return log.entries[0].direction;
  };
  CHECK(with("") == Direction::unknown);
  CHECK(with("0200 0400 01000000 0000 0000") == Direction::received);
  CHECK(with("0200 0400 02000000") == Direction::sent);                               // no end
  CHECK(with("0100 0100 58000000 0200 0400 02000000 0000 0000") == Direction::sent);  // a comment before
  CHECK(with("0200 0400 02000000 0100 0100 58000000 0000 0000") == Direction::sent);  // and behind
  CHECK(with("0200 0400 03000000 0000 0000") == Direction::unknown);
  CHECK(with("0200 0400 FD000000 0000 0000") == Direction::received);          // other flags
  CHECK(with("0000 0000 0200 0400 02000000") == Direction::unknown);           // behind the end
  CHECK(with("0100 FF00 58000000 0200 0400 02000000") == Direction::unknown);  // longer than the block
  CHECK(with("0300 0400 02000000 0000 0000") == Direction::unknown);           // epb_hash
  CHECK(with("0200 0200 02000000 0000 0000") == Direction::unknown);           // of two bytes
}

TEST_CASE("pcapng: packets of the older kind") {
  // Packet Block: interface and drops of 16 bits each. [draft-ietf-opsawg-pcapng, appendix A]
  const auto log = read_all<PcapngReader>(
      little_section + little_can7 +
      block(2, bytes("0000 0500 00000000 02CA9A3B 10000000 10000000 00000123 02000000 1122000000000000")));
  REQUIRE(log.entries.size() == 1);
  CHECK(log.entries[0] == Entry{at(1'000'000'002), {0x123, 2, {0x11, 0x22}}});
}

TEST_CASE("pcapng: several sections, each with its interfaces and byte order") {
  const std::string other_name = interface_with("0200 0400 63616E38 0900 0100 09 000000");
  const auto log =
      read_all<PcapngReader>(little_section + little_can7 + little_packet + big_section + big_can7 +
                             big_packet + little_section + other_name + little_packet);
  REQUIRE(log.entries.size() == 3);
  CHECK(log.names == std::vector<std::string>{"can7", "can7", "can8"});
  CHECK(log.complained == 0);
}

TEST_CASE("pcapng: an interface without a name has one") {
  const auto log = read_all<PcapngReader>(little_section + interface_with("") + little_packet);
  CHECK(log.names.at(0) == "can0");
}

TEST_CASE("pcapng: a name ends at a zero, and at what an option holds") {
  const auto log =
      read_all<PcapngReader>(little_section + interface_with("0200 0800 63616E37 00616263") + little_packet);
  CHECK(log.names.at(0) == "can7");
  Interfaces interfaces;
  interfaces.add(std::string(70'000, 'n'));
  PcapngWriter writer;
  const std::vector<Entry> entries{Entry{at(1), {1, 0, {}}}};
  const auto cut = read_all<PcapngReader>(log::testing::write_all(writer, entries, interfaces));
  CHECK(cut.complained == 0);
  REQUIRE(cut.entries == entries);
  CHECK(cut.names[0] == std::string(65'535, 'n'));
}

TEST_CASE("pcapng: more interfaces than any log has are refused within a section, too") {
  std::string file = little_section;
  for (std::size_t i = 0; i <= Interfaces::most; ++i) file += little_can7;
  const auto log = read_all<PcapngReader>(file + little_packet);
  CHECK(log.entries.size() == 1);
  REQUIRE(log.complained == 1);
  CHECK(log.complaints[0].cause == Cause::unsupported);
  CHECK(log.complaints[0].detail == "more interfaces than any log has");
  CHECK(log.complaints[0].place.number == file.size() - little_can7.size());
}

TEST_CASE("pcapng: more interfaces than any log has are refused, not mixed up") {
  std::string file;
  for (int i = 0; i <= 4096; ++i) {  // a section each
    char name[16];
    std::snprintf(name, sizeof name, "x%04d00", i);
    Bytes body;
    body.append(bytes("E300 0000 00000000 0200 0700"));
    body.append({name, 7});
    body.zeros(1);
    file += little_section + block(1, body.view()) + (i >= 4095 ? little_packet : std::string{});
  }
  const auto log = read_all<PcapngReader>(file);
  CHECK(log.entries.size() == 1);
  REQUIRE(log.complaints.size() == 2);
  CHECK(log.complaints[0].detail == "more interfaces than any log has");
  CHECK(log.complaints[1].cause == Cause::unsupported);
  CHECK(log.complaints[1].detail == "link type 0");
}

TEST_CASE("pcapng: statistics count from the section's beginning, the last tell") {
  const auto statistics = [](const char* received, const char* dropped) {
    return block(
        5, bytes(std::string{"00000000 00000000 00000000 0400 0800 "} + received + " 0700 0800 " + dropped));
  };
  const auto first = statistics("0A00000000000000", "0100000000000000");
  const auto second = statistics("1400000000000000", "0300000000000000");
  const auto log = read_all<PcapngReader>(little_section + little_can7 + first + second + little_section +
                                          little_can7 + first);
  REQUIRE(log.recorded.size() == 1);
  CHECK(log.recorded[0].received == 30);
  CHECK(log.recorded[0].dropped == 4);
}

TEST_CASE("pcapng: statistics are of the interface that they name, and of nothing else") {
  const std::string can8 = interface_with("0200 0400 63616E38");
  const std::string ethernet = block(1, bytes("0100 0000 00000000"));
  // isb_ifdrop 2 and isb_osdrop 3 add up; isb_ifrecv 5; isb_filteraccept (6) and a count of four bytes are
  // passed over.
  const std::string of_can8 =
      block(5, bytes("01000000 00000000 00000000 0500 0800 0200000000000000 0700 0800 0300000000000000"
                     "0400 0800 0500000000000000 0600 0800 0900000000000000 0400 0400 07000000"));
  const std::string of_ethernet = block(5, bytes("02000000 00000000 00000000 0400 0800 0500000000000000"));
  const auto log =
      read_all<PcapngReader>(little_section + little_can7 + can8 + ethernet + of_can8 + of_ethernet);
  CHECK(log.complained == 0);
  REQUIRE(log.recorded.size() == 2);
  CHECK(log.recorded[0].received == 0);
  CHECK(log.recorded[0].dropped == 0);
  CHECK(log.recorded[1].received == 5);
  CHECK(log.recorded[1].dropped == 5);

  const std::string big_statistics =
      bytes("00000005 00000024 00000000 00000000 00000000 0004 0008 0000000100000002 00000024");
  const auto big = read_all<PcapngReader>(big_section + big_can7 + big_statistics);
  REQUIRE(big.recorded.size() == 1);
  CHECK(big.recorded[0].received == 0x1'0000'0002);

  for (const std::string& wrong :
       {block(5, bytes("01000000 00000000 00000000")),  // interface 1 is not described
        block(5, bytes("00000000 00000000"))}) {        // no room for the time
    const auto refused = read_all<PcapngReader>(little_section + little_can7 + wrong + little_packet);
    CHECK(refused.entries.size() == 1);
    CHECK(refused.recorded.empty());
    REQUIRE(refused.complained == 1);
    CHECK(refused.complaints[0].detail == "statistics of an interface that is not described");
    CHECK(refused.complaints[0].place.number == little_section.size() + little_can7.size());
  }
  const auto without_options =
      read_all<PcapngReader>(little_section + little_can7 + block(5, bytes("00000000 00000000 00000000")));
  CHECK(without_options.complained == 0);
}

TEST_CASE("pcapng: interfaces are described when they come up") {
  Interfaces interfaces;
  interfaces.add("can0");
  PcapngWriter writer;
  Bytes out;
  writer.begin(out);
  writer.write(out, {{Entry{at(1), {1, 0, {}}, 0}}}, interfaces);
  interfaces.add("can1");
  writer.write(out, {{Entry{at(2), {2, 0, {}}, 1}, Entry{at(3), {3, 0, {}}, 2}}}, interfaces);
  const auto log = read_all<PcapngReader>(out.view());
  CHECK(log.names == std::vector<std::string>{"can0", "can1", "can2"});  // the last had none
  CHECK(log.complained == 0);
}

TEST_CASE("pcapng: cut off anywhere, all whole blocks before are read") {
  const std::string file = little_section + little_can7 + little_packet + little_packet;
  const std::size_t head = little_section.size() + little_can7.size();
  for (std::size_t size = 0; size <= file.size(); ++size) {
    INFO(size);
    const auto log = read_all<PcapngReader>(file.substr(0, size));
    REQUIRE(log.entries.size() == (size < head ? 0 : (size - head) / little_packet.size()));
    const bool between =
        size == 0 || size == little_section.size() || (size >= head && (size - head) % 60 == 0);
    REQUIRE(log.complained == (between ? 0 : 1));
    if (!between && size >= 12) REQUIRE(log.complaints[0].cause == Cause::truncated);
  }
}

TEST_CASE("pcapng: behind damage reading goes on") {
  std::string file = little_section + little_can7;
  for (int i = 0; i < 10; ++i) file += little_packet;
  const std::size_t third = little_section.size() + little_can7.size() + 2 * little_packet.size();
  const std::string whole = file;
  for (const char wrong : {'\x00', '\x04', '\x3D', '\x40', '\x7C'}) {
    for (const std::size_t where : {std::size_t{4}, std::size_t{7}, little_packet.size() - 4}) {
      file = whole;
      file[third + where] = wrong;
      if (file == whole) continue;  // it was so
      const auto log = read_all<PcapngReader>(file);
      INFO(static_cast<int>(wrong) << " at " << where);
      CHECK(log.entries.size() == 9);
      REQUIRE(log.complained == 1);
      CHECK(log.complaints[0].place.number == third);
    }
  }
}

TEST_CASE("pcapng: behind damage, a block is what has a known type, is short, and says its length twice") {
  // Between damage and a packet is a block with another packet in it: 1 entry where it is taken for a block,
  // 2 where it is not.
  const std::string damage = bytes("FFFFFFFF FFFFFFFF FFFFFFFF FFFFFFFF");
  const auto entries = [&](const std::string& between) {
    const auto log = read_all<PcapngReader>(little_section + little_can7 + damage + between + little_packet);
    return log.entries.size();
  };
  const auto long_block = [](std::size_t size) {
    return block(0, little_packet + std::string(size - 12 - little_packet.size(), '\0'));
  };
  CHECK(entries("") == 1);
  CHECK(entries(block(0, little_packet)) == 1);
  CHECK(entries(block(7, little_packet)) == 2);
  CHECK(entries(long_block(65536)) == 1);
  CHECK(entries(long_block(65540)) == 2);
  std::string other_end = block(0, little_packet);
  other_end[other_end.size() - 4] ^= 4;
  CHECK(entries(other_end) == 2);
}

TEST_CASE("pcapng: behind damage, a section tells the byte order, and half a section does not") {
  const std::string damage = bytes("FFFFFFFF FFFFFFFF FFFFFFFF");
  const auto log =
      read_all<PcapngReader>(little_section + little_can7 + damage + big_section + big_can7 + big_packet);
  CHECK(log.entries.size() == 1);
  CHECK(log.complained == 1);
  const std::string torn = bytes("0A0D0D0A 0000001C 1A2B3C4D 0001 0000");  // of the other byte order
  const auto same = read_all<PcapngReader>(little_section + little_can7 + damage + torn + little_packet);
  CHECK(same.entries.size() == 1);
  CHECK(same.complained == 1);
  const auto never = read_all<PcapngReader>(damage + torn + big_packet);
  CHECK(never.entries.empty());
  REQUIRE(never.complained == 1);
  CHECK(never.complaints[0].detail == "no section begins here");
}

TEST_CASE("pcapng: a complaint says what is wrong with the block, and where it begins") {
  const std::string head = little_section + little_can7;
  const auto complaint = [&](const std::string& block) {
    const auto log = read_all<PcapngReader>(head + block);
    REQUIRE(log.complained == 1);
    CHECK(log.complaints[0].place.number == head.size());
    return log.complaints[0].detail;
  };
  CHECK(complaint(bytes("06000000 3C00")) == "the beginning of a block");
  CHECK(complaint(little_packet.substr(0, 30)) == "a block, 30 of 60 bytes");
  CHECK(complaint(bytes("06000000 08000000 00000000")) == "a block of 8 bytes");
  CHECK(complaint(bytes("06000000 0D000000 00000000 00000000")) == "a block of 13 bytes");
  CHECK(complaint(bytes("06000000 10000000 00000000 14000000")) ==
        "a block of 16 bytes, by its end of another length");
  CHECK(complaint(block(6, bytes("00000000 00000000 00000000 00000000"))) == "a packet without its head");
  CHECK(complaint(block(2, bytes("00000000 00000000 00000000 00000000"))) == "a packet without its head");
  CHECK(complaint(block(1, bytes("E300 0000"))) == "an interface without its head");
  CHECK(complaint(block(6, bytes("01000000 00000000 00000000 00000000 00000000"))) ==
        "a packet of interface 1, not described");
  CHECK(complaint(block(6, bytes("00000000 00000000 00000000 01000000 01000000"))) ==
        "a packet longer than its block");
  CHECK(complaint(block(6, bytes("00000000 00000000 00000000 00000000 00000000"))) == "a packet of 0 bytes");
  CHECK(complaint(block(2, bytes("00000000 00000000 00000000 00000000 00000000"))) == "a packet of 0 bytes");
}

TEST_CASE("pcapng: any bit flipped, and every entry can exist") {
  const std::string whole = little_section + little_can7 + little_packet + little_packet;
  for (std::size_t bit = 0; bit < whole.size() * 8; ++bit) {
    std::string file = whole;
    file[bit / 8] = static_cast<char>(file[bit / 8] ^ 1 << bit % 8);
    const auto log = read_all<PcapngReader>(file);
    REQUIRE(log.entries.size() <= 2);
    for (const Entry& entry : log.entries) REQUIRE(log::testing::can_exist(entry));
  }
}

TEST_CASE("pcapng: a block of gigabytes takes no memory") {
  const auto log = read_all<PcapngReader>(
      little_section + little_can7 + bytes("06000000 FCFFFFFF 00000000 00000000 00000000") + little_packet);
  CHECK(log.entries.size() == 1);
  REQUIRE(log.complained == 1);
  CHECK(log.complaints[0].cause == Cause::too_long);
}

TEST_CASE("pcapng: the longest block that is read, and one that is longer") {
  const auto with_block_of = [](std::size_t size) {
    return read_all<PcapngReader>(little_section + little_can7 + block(0, std::string(size - 12, '\xFF')) +
                                  little_packet);
  };
  const auto longest = with_block_of(Input::longest);
  CHECK(longest.entries.size() == 1);
  CHECK(longest.complained == 0);
  const auto longer = with_block_of(Input::longest + 4);
  REQUIRE(longer.complained == 1);
  CHECK(longer.complaints[0].cause == Cause::too_long);
}

TEST_CASE("pcapng: a live pipe hands on what is there") {
  const std::string head = little_section + little_can7;
  const std::string file = head + little_packet + little_packet.substr(0, 30);
  test::Drops source{file, head.size() + little_packet.size() + 30};
  Input input{source};
  PcapngReader reader{input};
  std::vector<Entry> some(8);
  CHECK(reader.read(some) == 1);
  CHECK(reader.complaints().total() == 0);  // it may still come
  CHECK(reader.read(some) == 0);
  CHECK(reader.complaints().count(Cause::truncated) == 1);
}

TEST_CASE("pcapng: a time before 1970 is counted as lost") {
  Interfaces interfaces;
  interfaces.add("can0");
  PcapngWriter writer;
  const std::string file = log::testing::write_all(writer, {{Entry{at(-5), {1, 0, {}}}}}, interfaces);
  CHECK(writer.lost().count(Lost::time) == 1);
  CHECK(read_all<PcapngReader>(file).entries.at(0).time == at(0));

  PcapngWriter at_zero;  // 1970 itself is not before it
  const std::vector<Entry> from_zero{{at(0), {1, 0, {}}}, {at(7), {1, 0, {}}}, {at(-5), {1, 0, {}}}};
  const std::string whole =
      log::testing::write_all(at_zero, from_zero, interfaces, std::vector<Recorded>{{3, 0}});
  CHECK(at_zero.lost().count(Lost::time) == 1);
  // Statistics are of the latest time, 7 ns. [draft-ietf-opsawg-pcapng, 4.6: interface, time high, time low]
  CHECK(whole.find(bytes("05000000 34000000 00000000 00000000 07000000")) != std::string::npos);
}

TEST_CASE("pcapng: what it is not") {
  CHECK_FALSE(PcapngReader::recognises(""));
  CHECK_FALSE(PcapngReader::recognises(little_section.substr(0, 11)));
  CHECK(PcapngReader::recognises(little_section.substr(0, 12)));
  CHECK_FALSE(PcapngReader::recognises("0A0D0D0A 1C000000 1A2B"));
  CHECK_FALSE(PcapngReader::recognises(bytes("0A0D0D0A 1C000000 4D3C2B1B")));
  const auto log = read_all<PcapngReader>("this is no pcapng file at all, but some text");
  CHECK(log.entries.empty());
  REQUIRE(log.complained == 1);
  CHECK(log.complaints[0].cause == Cause::syntax);
}

}  // namespace log_pcapng_test
