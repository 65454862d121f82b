#include "ocm/j1939/identifier.hpp"

#include <random>

#include <catch2/catch.hpp>

namespace j1939_identifier_test {

using ocm::j1939::Identifier;
using ocm::j1939::mask_of;
using ocm::j1939::pgn_of;

// EEC1: priority 3, group F004 (PDU2: to all), from the engine. [SAE J1939-71]
static_assert(Identifier::decode(0x0CF0'0400) == Identifier{3, 0xF004, 255, 0x00});
// A request (group EA00, PDU1) to all and to one. [SAE J1939-21]
static_assert(Identifier::decode(0x18EA'FF00) == Identifier{6, 0xEA00, 255, 0x00});
static_assert(Identifier::decode(0x18EA'05F9) == Identifier{6, 0xEA00, 0x05, 0xF9});
// Whom all hear, and who has no address yet. [SAE J1939-81]
static_assert(ocm::j1939::global_address == 255 && ocm::j1939::null_address == 254);
static_assert(Identifier{} == Identifier{6, 0, 255, 254});
// The data page is a part of the number.
static_assert(pgn_of(0x19F0'0423) == 0x1F004);
static_assert(pgn_of(0x1CEF'1234) == 0xEF00);
static_assert(mask_of(0xF004) == 0x03FF'FF00);
static_assert(mask_of(0xEF00) == 0x03FF'0000);

TEST_CASE("an identifier of J1939 decodes to what encodes to it") {
  std::mt19937_64 random{1939};
  for (int i = 0; i < 20'000; ++i) {
    const auto id = static_cast<std::uint32_t>(random() & 0x1FFF'FFFF);
    const Identifier read = Identifier::decode(id);
    CAPTURE(id);
    REQUIRE(read.encode() == id);
    // What has the group's bits in common is of the group, and nothing else is.
    const auto other = static_cast<std::uint32_t>(random() & 0x1FFF'FFFF);
    const std::uint32_t same = (other & ~mask_of(read.pgn)) | (id & mask_of(read.pgn));
    REQUIRE(pgn_of(same) == read.pgn);
    REQUIRE((pgn_of(other) == read.pgn) == ((other & mask_of(read.pgn)) == (id & mask_of(read.pgn))));
  }
}

}  // namespace j1939_identifier_test
