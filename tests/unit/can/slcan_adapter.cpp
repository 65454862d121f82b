#include "ocm/can/slcan_adapter.hpp"

#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/can/slcan_vectors.hpp"

namespace can_slcan_adapter_test {

namespace slcan = ocm::can::slcan;
using ocm::base::Error;
using ocm::base::Result;
using ocm::can::Format;
using ocm::can::Frame;
using ocm::test::slcan::body;
using ocm::test::slcan::vectors;
using slcan::Adapter;
using slcan::Command;

constexpr ocm::base::Time at_ms(std::int64_t ms) {
  return ocm::base::Time{std::chrono::milliseconds{ms}};
}

constexpr bool commands_are_the_vectors() {
  for (const auto& v : vectors) {
    if (slcan::parse_command(body(v.line))->kind != Command::Kind::transmit) return false;
    if (!(slcan::parse_command(body(v.line))->frame == v.frame)) return false;
  }
  return true;
}
static_assert(commands_are_the_vectors());

// The highest number that each command has, and the first that it does not have.
static_assert(slcan::parse_command("S8")->value == 8);
static_assert(slcan::parse_command("S9").error == Error::bad_syntax);
static_assert(slcan::parse_command("sFFFF")->value == 0xFFFF);
static_assert(slcan::parse_command("Z1")->value == 1 && slcan::parse_command("X1")->value == 1);
static_assert(slcan::parse_command("Z2").error == Error::bad_syntax);
static_assert(slcan::parse_command("X2").error == Error::bad_syntax);
static_assert(slcan::parse_command("MFFFFFFFF")->value == 0xFFFF'FFFF);
static_assert(slcan::parse_command("mFFFFFFFF")->value == 0xFFFF'FFFF);

/// A CAN controller with so many mailboxes free.
struct Mailboxes {
  std::size_t room = 1000;
  std::vector<Frame> sent;
  Result<bool> send(const Frame& frame) {
    if (sent.size() >= room) return false;
    sent.push_back(frame);
    return true;
  }
};

/// All that comes back for a text.
std::string tell(Adapter& adapter, Mailboxes& bus, std::string_view text) {
  std::string answers;
  for (const char c : text) answers += adapter.feed(c, bus).view();
  return answers;
}

TEST_CASE("slcan adapter: each command only when the manual allows it") {
  Adapter adapter;
  Mailboxes bus;
  const auto say = [&](std::string_view text) { return tell(adapter, bus, text); };
  // closed, and no bit rate chosen
  CHECK(say("O\r") == "\a");
  CHECK(say("L\r") == "\a");
  CHECK(say("C\r") == "\a");
  CHECK(say("F\r") == "\a");
  CHECK(say("t1000\r") == "\a");
  CHECK(say("M00000000\r") == "\a");
  CHECK(say("\r\r\r") == "\r\r\r");
  CHECK(say("V\r") == "V1010\r");
  CHECK(say("N\r") == "N0000\r");
  CHECK(say("S9\r") == "\a");
  CHECK(say("S\r") == "\a");
  CHECK(say("S66\r") == "\a");
  CHECK(say("S6\r") == "\r");
  CHECK(adapter.bit_rate() == 500'000);
  CHECK(say("s031C\r") == "\r");
  CHECK(adapter.bit_rate() == 125'000);
  CHECK(say("s7F7F\r") == "\a");  // a rate that is none of S0 to S8
  CHECK(adapter.bit_rate() == 125'000);
  CHECK(say("Z1\r") == "\r");
  CHECK(say("Z2\r") == "\a");
  CHECK(say("X1\r") == "\r");
  CHECK(say("X0\r") == "\a");
  CHECK(say("M00000000\r") == "\r");
  CHECK(say("mFFFFFFFF\r") == "\r");
  CHECK(say("mFFFFFFF\r") == "\a");
  // open
  CHECK(say("O\r") == "\r");
  CHECK(adapter.channel() == Adapter::Channel::open);
  for (const char* refused :
       {"O\r", "L\r", "S6\r", "s031C\r", "Z0\r", "X1\r", "M00000000\r", "mFFFFFFFF\r", "P\r", "A\r", "W0\r",
        "U1\r", "Q1\r", "o\r", "?\r", "t100\r", "t8000\r", "t1009\r"})
    CHECK(say(refused) == "\a");
  CHECK(adapter.stamps());
  CHECK(say("t10021133\r") == "z\r");
  CHECK(say("r1002\r") == "z\r");
  CHECK(say("T0000010021133\r") == "Z\r");
  CHECK(say("R000001002\r") == "Z\r");
  CHECK(bus.sent ==
        std::vector<Frame>{vectors[0].frame, vectors[1].frame, vectors[2].frame, vectors[3].frame});
  CHECK(say("V\rN\r") == "V1010\rN0000\r");
  CHECK(say("C\r") == "\r");
  CHECK(say("C\r") == "\a");
  // listen only
  CHECK(say("L\r") == "\r");
  CHECK(say("t10021133\r") == "\a");
  CHECK(say("F\r") == "F00\r");
  CHECK(bus.sent.size() == 4);
  CHECK(say("C\r") == "\r");
}

TEST_CASE("slcan adapter: only the bit rates that its bus has") {
  slcan::AdapterInfo info;
  info.bit_rates = 1U << 6;
  info.hardware = 0x21;
  info.software = 0x43;
  info.serial = {'R', 'I', 'N', 'G'};
  Adapter adapter{info};
  Mailboxes bus;
  CHECK(tell(adapter, bus, "S5\r") == "\a");
  CHECK(tell(adapter, bus, "S6\r") == "\r");
  CHECK(tell(adapter, bus, "s031C\r") == "\a");
  CHECK(tell(adapter, bus, "s001C\r") == "\r");
  CHECK(tell(adapter, bus, "V\rN\r") == "V2143\rNRING\r");
}

TEST_CASE("slcan adapter: a full bus is reported, and the flags stay until they were asked for") {
  Adapter adapter;
  Mailboxes bus;
  bus.room = 1;
  CHECK(tell(adapter, bus, "S6\rO\rt1000\rt1010\r") == "\r\rz\r\a");
  CHECK(tell(adapter, bus, "F\rF\r") == "F02\rF00\r");
  adapter.report(slcan::status::warning | slcan::status::bus_error);
  CHECK(tell(adapter, bus, "F\rF\r") == "F84\rF04\r");  // the state stays, the event does not
  adapter.report(slcan::status::overrun);
  CHECK(tell(adapter, bus, "F\rF\r") == "F08\rF00\r");
  bus.room = 2;
  CHECK(tell(adapter, bus, "t1010\r") == "z\r");
  CHECK(bus.sent.back().id == 0x101);
}

TEST_CASE("slcan adapter: what happened before the channel was opened is not told") {
  Adapter adapter;
  Mailboxes bus;
  bus.room = 0;
  CHECK(tell(adapter, bus, "S6\rO\rt1000\rC\rO\rF\r") == "\r\r\a\r\rF00\r");
}

TEST_CASE("slcan adapter: frames go up when the channel is open, with the time when asked for") {
  Adapter adapter;
  Mailboxes bus;
  const Frame frame{0x605, 2, {0xAB, 0xCD}};
  CHECK(adapter.hear(frame, at_ms(5)).view().empty());
  tell(adapter, bus, "S6\rO\r");
  CHECK(adapter.hear(frame, at_ms(5)) == "t6052ABCD\r");
  tell(adapter, bus, "C\rZ1\rL\r");
  CHECK(adapter.hear(frame, at_ms(5)) == "t6052ABCD0005\r");
  CHECK(adapter.hear(frame, at_ms(3'600'000 + 59'999)) == "t6052ABCDEA5F\r");
  CHECK(adapter.hear(frame, at_ms(60'000)) == "t6052ABCD0000\r");
  CHECK(adapter.hear(frame, at_ms(-1)) == "t6052ABCDEA5F\r");
  CHECK(adapter.hear({4, 8, {}, Format::error}, at_ms(5)).view().empty());
  tell(adapter, bus, "C\r");
  CHECK(adapter.hear(frame, at_ms(5)).view().empty());
}

TEST_CASE("slcan adapter: acceptance code and mask, as the SJA1000's two filters") {
  Adapter adapter;
  Mailboxes bus;
  const auto heard = [&](const Frame& frame) { return !adapter.hear(frame, at_ms(0)).view().empty(); };
  const auto filter = [&](std::string_view code, std::string_view mask) {
    tell(adapter, bus, "C\r");
    REQUIRE(tell(adapter, bus, "S6\rM" + std::string(code) + "\rm" + std::string(mask) + "\rO\r") ==
            "\r\r\r\r");
  };
  // 0x300 to 0x3FF of base data frames by both filters: ID.10..8 = 011 [SJA1000 data sheet, table 19]
  filter("60006000", "1FEF1FEF");
  CHECK(heard({0x300, 1, {7}}));
  CHECK(heard({0x3FF, 0, {}}));
  CHECK_FALSE(heard({0x2FF, 0, {}}));
  CHECK_FALSE(heard({0x400, 0, {}}));
  CHECK_FALSE(heard({0x300, 0, {}, Format::base_remote}));
  // 0x605 in the first filter only if its first byte is 0x5A, 0x123 in the second
  // 0x605 << 5 = 0xC0A0, low nibble the byte's high one; 0x123 << 5 = 0x2460
  filter("C0A5246A", "00000000");
  CHECK(heard({0x605, 1, {0x5A}}));
  CHECK_FALSE(heard({0x605, 1, {0x5B}}));
  CHECK(heard({0x605, 0, {}}));
  CHECK(heard({0x123, 1, {0x5A}}));
  CHECK(heard({0x123, 8, {0xFF}}));
  CHECK_FALSE(heard({0x124, 1, {0x5A}}));
  CHECK_FALSE(heard({0x605, 1, {0x4A}}));
  CHECK_FALSE(heard({0x605, 0, {}, Format::base_remote}));
  CHECK_FALSE(heard({0x123, 0, {}, Format::base_remote}));
  // ... or one that differs from it in bits 4 and 1 alone: the low nibbles of AM1 and AM3
  filter("C0A5246A", "00010002");
  for (const unsigned byte : {0x5AU, 0x4AU, 0x58U, 0x48U})
    CHECK(heard({0x605, 1, {static_cast<std::uint8_t>(byte)}}));
  for (const unsigned byte : {0x5BU, 0x52U, 0x7AU, 0xDAU})
    CHECK_FALSE(heard({0x605, 1, {static_cast<std::uint8_t>(byte)}}));
  // 0x300 to 0x3FF by one of the filters and 0x7FF by the other, whichever has which
  for (const bool swapped : {false, true}) {
    CAPTURE(swapped);
    filter(swapped ? "FFE06000" : "6000FFE0", swapped ? "000F1FEF" : "1FEF000F");
    CHECK(heard({0x300, 1, {7}}));
    CHECK(heard({0x3FF, 0, {}}));
    CHECK(heard({0x7FF, 1, {1}}));
    CHECK_FALSE(heard({0x2FF, 0, {}}));
    CHECK_FALSE(heard({0x400, 0, {}}));
    CHECK_FALSE(heard({0x7FE, 1, {1}}));
    CHECK_FALSE(heard({0x300, 0, {}, Format::base_remote}));
    CHECK_FALSE(heard({0x7FF, 0, {}, Format::base_remote}));
  }
  // ID.28 to ID.13 of extended frames: 0x1F334455 >> 13 = 0xF99A [SJA1000 data sheet, table 20]
  filter("F99A0000", "00000000");
  CHECK(heard({0x1F33'4455, 0, {}, Format::extended}));
  CHECK(heard({0x1F33'5FFF, 0, {}, Format::extended}));
  CHECK_FALSE(heard({0x1F33'6000, 0, {}, Format::extended}));
  CHECK(heard({0x0000'0455, 0, {}, Format::extended}));  // the second filter
  // F990 to F99F by the first, 1204, 1214 to 12F4 by the second
  filter("F99A1234", "000F00F0");
  CHECK(heard({0xF995U << 13, 0, {}, Format::extended}));
  CHECK(heard({0x12A4U << 13, 0, {}, Format::extended}));
  CHECK_FALSE(heard({0xF985U << 13, 0, {}, Format::extended}));
  CHECK_FALSE(heard({0x12A5U << 13, 0, {}, Format::extended}));
  filter("00000000", "FFFFFFFF");
  CHECK(heard({0x1F33'6000, 0, {}, Format::extended_remote}));
  CHECK(heard({0x7FF, 8, {1}}));
}

TEST_CASE("slcan adapter: garbage is refused line by line, and counted") {
  Adapter adapter;
  Mailboxes bus;
  CHECK(tell(adapter, bus, "S6\rO\r") == "\r\r");
  CHECK(tell(adapter, bus, std::string(100, '0') + "\r") == "\a");
  CHECK(tell(adapter, bus, "\xFFt1000\r") == "\a");
  CHECK(tell(adapter, bus, "t1000") == "");
  CHECK(tell(adapter, bus, "\r") == "z\r");
  CHECK(adapter.faults().too_long == 1);
  CHECK(adapter.faults().noise == 1);
  CHECK(adapter.faults().total() == 2);
  CHECK(bus.sent.size() == 1);
}

TEST_CASE("slcan adapter: no line has more than 30 characters") {
  Adapter adapter;
  Mailboxes bus;
  CHECK(tell(adapter, bus, std::string(30, 't') + "\r") == "\a");
  CHECK(adapter.faults().bad_syntax == 1);
  CHECK(adapter.faults().too_long == 0);
  CHECK(tell(adapter, bus, std::string(31, 't') + "\r") == "\a");
  CHECK(adapter.faults().too_long == 1);
}

constexpr bool works_at_compile_time() {
  struct One {
    Frame last{};
    constexpr Result<bool> send(const Frame& frame) noexcept {
      last = frame;
      return true;
    }
  };
  Adapter adapter;
  One bus;
  for (const char c : std::string_view{"S6\rO\rt10021133\r"}) (void)adapter.feed(c, bus);
  return bus.last == vectors[0].frame && adapter.hear(bus.last, at_ms(0)) == "t10021133\r";
}
static_assert(works_at_compile_time());

static_assert(sizeof(Adapter) <= 84);

}  // namespace can_slcan_adapter_test
