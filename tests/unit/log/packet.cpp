#include "ocm/log/packet.hpp"

#include <catch2/catch.hpp>

#include "tests/unit/log/log_testing.hpp"

namespace log_packet_test {

using namespace ocm;
using namespace ocm::log;
using log::testing::bytes;

struct Loaded {
  Entry entry;
  std::optional<Cause> wrong;
};
Loaded load(std::string_view hex, LinkType type = LinkType::can_socketcan, bool swapped = false) {
  Loaded loaded;
  loaded.wrong = packet::load(bytes(hex), type, swapped, loaded.entry);
  return loaded;
}

TEST_CASE("packet: a classic frame is identifier, length and eight bytes") {
  // [tcpdump.org, LINKTYPE_CAN_SOCKETCAN]
  const Loaded loaded = load("00 00 01 23 03 00 00 00 11 22 33 00 00 00 00 00");
  REQUIRE_FALSE(loaded.wrong);
  CHECK(loaded.entry == Entry{{}, {0x123, 3, {0x11, 0x22, 0x33}}});
  char stored[packet::classic_size];
  packet::store(stored, loaded.entry);
  CHECK(std::string_view(stored, sizeof stored) == bytes("00000123 03000000 1122330000000000"));
}

TEST_CASE("packet: what is stored of each kind of frame, byte by byte, and read again") {
  const auto stored = [](const Entry& entry) {
    char bytes[2 * packet::fd_size];
    std::fill_n(bytes, sizeof bytes, '\xEE');
    packet::store(bytes, entry);
    const std::size_t size = packet::size_of(entry);
    for (std::size_t i = size; i < sizeof bytes; ++i) CHECK(bytes[i] == '\xEE');
    Entry again;
    CHECK_FALSE(packet::load({bytes, size}, LinkType::can_socketcan, false, again));
    CHECK(again == entry);
    return std::string(bytes, size);
  };
  Entry eight{{}, {0x123, 8, {1, 2, 3, 4, 5, 6, 7, 8}}};
  eight.raw_dlc = 9;
  CHECK(stored(eight) == bytes("00000123 08000009 0102030405060708"));
  CHECK(stored(Entry{{}, {0x1F334455, 1, {0xAA}, can::Format::extended}}) ==
        bytes("9F334455 01000000 AA00000000000000"));
  CHECK(stored(Entry{{}, {0x123, 3, {}, can::Format::base_remote}}) ==
        bytes("40000123 03000000 0000000000000000"));
  CHECK(stored(Entry{{}, {0x1F334455, 8, {}, can::Format::extended_remote}}) ==
        bytes("DF334455 08000000 0000000000000000"));
  CHECK(stored(Entry{{}, {4, 8, {0, 1}, can::Format::error}}) == bytes("20000004 08000000 0001000000000000"));
  can::AnyFrame fd;
  fd.id = 0x7FF;
  fd.length = 12;
  fd.flags = flag::fd | flag::bit_rate_switch;
  for (std::size_t i = 0; i < 12; ++i) fd.data[i] = static_cast<std::uint8_t>(0x10 + i);
  CHECK(stored(Entry{{}, fd}) == bytes("000007FF 0C050000 101112131415161718191A1B") + std::string(52, '\0'));
  CHECK(holds_can(LinkType::linux_cooked));
  CHECK(holds_can(LinkType::can_socketcan));
  CHECK(holds_can(LinkType::linux_cooked2));
  CHECK_FALSE(holds_can(LinkType::none));
}

TEST_CASE("packet: the flags of the identifier are formats") {
  CHECK(load("9F334455 00000000 0000000000000000").entry.format == can::Format::extended);
  CHECK(load("9F334455 00000000 0000000000000000").entry.id == 0x1F334455);
  CHECK(load("40000123 05000000 0000000000000000").entry.format == can::Format::base_remote);
  CHECK(load("40000123 05000000 0000000000000000").entry.length == 5);
  CHECK(load("DF334455 00000000 0000000000000000").entry.format == can::Format::extended_remote);
  CHECK(load("20000004 08000000 0001000000000000").entry.format == can::Format::error);
  CHECK(load("20000004 08000000 0001000000000000").entry.data[1] == 1);
}

TEST_CASE("packet: the length code of eight bytes") {
  CHECK(load("00000123 0800000F 1122334455667788").entry.raw_dlc == 15);
  CHECK(load("00000123 08000008 1122334455667788").entry.raw_dlc == 0);
  CHECK(load("00000123 0700000F 1122334455667700").entry.raw_dlc == 0);
  CHECK(load("00000123 08000010 1122334455667788").entry.raw_dlc == 0);
  CHECK(load("20000004 0800000F 0001000000000000").entry.raw_dlc == 0);  // of a controller, not of a bus
}

TEST_CASE("packet: CAN FD by its flag, its length or its size") {
  const std::string twelve = "0102030405060708090A0B0C";
  for (const std::string& text : {"00000123 0C050000" + twelve,                           // flag and length
                                  "00000123 0C010000" + twelve,                           // older: length
                                  "00000123 0C010000" + twelve + std::string(104, '0')})  // as recorded
    CHECK(load(text).entry.length == 12);
  CHECK(load("00000123 0C010000" + twelve).entry.flags == (flag::fd | flag::bit_rate_switch));
  CHECK(load("00000123 03040000 010203").entry.is_fd());
  CHECK(load("00000123 03000000 010203" + std::string(122, '0')).entry.is_fd());  // 72 bytes
  CHECK_FALSE(load("00000123 03000000 0102030000000000").entry.is_fd());
}

TEST_CASE("packet: bytes beyond the length are zero") {
  const Entry entry = load("00000123 03000000 1122334455667788").entry;
  CHECK(entry.data[2] == 0x33);
  for (std::size_t i = 3; i < 8; ++i) CHECK(entry.data[i] == 0);
  CHECK(load("00000123 03000000 112233").entry.data[2] == 0x33);  // no more than needed
  CHECK(load("40000123 03000000 1122334455667788").entry.data[0] == 0);
}

TEST_CASE("packet: nothing of the frame that the entry held before stays") {
  for (const char* const hex : {"00000123 03040000 010203", "40000123 03000000 1122334455667788",
                                "00000123 03000000 112233", "00000123 03000000 1122334455667788"}) {
    Entry entry{{}, {0x1F334455, 8, {}, can::Format::extended}};
    entry.data.fill(0xAA);
    entry.flags = flag::all;
    entry.raw_dlc = 9;
    REQUIRE_FALSE(packet::load(bytes(hex), LinkType::can_socketcan, false, entry));
    CAPTURE(hex);
    CHECK(log::testing::can_exist(entry));
    CHECK(entry.length == 3);
    CHECK(entry.raw_dlc == 0);
    CHECK(entry.is_fd() == (hex[12] == '4'));
  }
}

TEST_CASE("packet: a frame without data may end with its head") {
  const Loaded loaded = load("00000123 00000000");
  REQUIRE_FALSE(loaded.wrong);
  CHECK(loaded.entry == Entry{{}, {0x123, 0, {}}});
  const Loaded cooked =
      load("0004 0118 0000 0000000000000000 000C 23010000 00000000", LinkType::linux_cooked);
  REQUIRE_FALSE(cooked.wrong);
  CHECK(cooked.entry.id == 0x123);
  CHECK(cooked.entry.length == 0);
}

TEST_CASE("packet: what cannot be a frame") {
  CHECK(load("00000123 030000").wrong == Cause::length);
  CHECK(load("00000123 03000000 1122").wrong == Cause::length);
  CHECK(load("00000123 09000000 112233445566778899").wrong == Cause::length);  // no FD frame has 9
  CHECK(load("00000123 41040000" + std::string(130, '0')).wrong == Cause::length);
  CHECK(load("00000800 00000000 0000000000000000").wrong == Cause::identifier);
  CHECK(load("40000123 00040000 00").wrong == Cause::syntax);
  CHECK(load("20000123 00040000 00").wrong == Cause::syntax);
  CHECK(load("00000123 00000000 00", static_cast<LinkType>(1)).wrong == Cause::unsupported);
}

TEST_CASE("packet: cooked captures have a direction and the recorder's byte order") {
  // [tcpdump.org, LINKTYPE_LINUX_SLL]: to whom, device (280: CAN), address, protocol
  const std::string head = "0118 0000 0000000000000000 000C";
  const std::string little = "23010080 02000000 AABB000000000000";
  Loaded loaded = load("0004" + head + little, LinkType::linux_cooked);
  REQUIRE_FALSE(loaded.wrong);
  CHECK(loaded.entry.id == 0x123);
  CHECK(loaded.entry.format == can::Format::extended);
  CHECK(loaded.entry.direction == Direction::sent);
  loaded = load("0001" + head + "80000123 02000000 AABB000000000000", LinkType::linux_cooked, true);
  REQUIRE_FALSE(loaded.wrong);
  CHECK(loaded.entry.id == 0x123);
  CHECK(loaded.entry.direction == Direction::received);

  // [tcpdump.org, LINKTYPE_LINUX_SLL2]: protocol, zero, interface, device, to whom, address
  loaded = load("000D 0000 00000003 0118 04 00 0000000000000000" + little, LinkType::linux_cooked2);
  REQUIRE_FALSE(loaded.wrong);
  CHECK(loaded.entry.direction == Direction::sent);
  CHECK(loaded.entry.is_fd());

  CHECK(load("0004 0001 0000 0000000000000000 000C" + little, LinkType::linux_cooked).wrong ==
        Cause::unsupported);  // Ethernet
  CHECK(load("0004 0118 0000 0000000000000000 0800" + little, LinkType::linux_cooked).wrong ==
        Cause::unsupported);
  CHECK(load("0004 0001 0000 0000000000000000 000C", LinkType::linux_cooked).wrong ==
        Cause::unsupported);  // Ethernet, of which nothing else is needed
  CHECK(load("0004" + head, LinkType::linux_cooked).wrong == Cause::length);
  CHECK(load("0004 0118", LinkType::linux_cooked).wrong == Cause::length);
}

TEST_CASE("packet: what is stored loads equal, in 16 or 72 bytes") {
  test::RandomEntries random{1, {.interfaces = 1}};
  for (int i = 0; i < 20'000; ++i) {
    const Entry entry = random.next();
    char stored[packet::fd_size];
    packet::store(stored, entry);
    const std::size_t size = packet::size_of(entry);
    REQUIRE(size == (entry.is_fd() ? 72 : 16));
    Entry again;
    again.time = entry.time;
    again.direction = entry.direction;
    REQUIRE_FALSE(packet::load({stored, size}, LinkType::can_socketcan, false, again));
    REQUIRE(again == entry);
    REQUIRE(log::testing::can_exist(again));
  }
}

}  // namespace log_packet_test
