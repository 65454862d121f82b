#include "ocm/can/slcan.hpp"

#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"

namespace {

namespace slcan = ocm::can::slcan;
using ocm::base::Error;
using ocm::base::Result;
using ocm::can::Format;
using ocm::can::Frame;
using slcan::Adapter;
using slcan::Answer;
using slcan::Command;

constexpr ocm::base::Time at_ms(std::int64_t ms) {
  return ocm::base::Time{std::chrono::milliseconds{ms}};
}

// --- vectors, typed by hand --------------------------------------------------------------------------------

struct Vector {
  std::string_view line;
  Frame frame;
};

constexpr Vector vectors[] = {
    // [CAN232 manual, commands t, r, T, R: their examples]
    {"t10021133\r", {0x100, 2, {0x11, 0x33}}},
    {"r1002\r", {0x100, 2, {}, Format::base_remote}},
    {"T0000010021133\r", {0x100, 2, {0x11, 0x33}, Format::extended}},
    {"R000001002\r", {0x100, 2, {}, Format::extended_remote}},
    // Magnetometer every 900 us, medium priority [Thesis 4.2]
    {"t205401840302\r", {0x205, 4, {0x01, 0x84, 0x03, 0x02}}},
    {"t0000\r", {0x000, 0, {}}},
    {"t7FF8FFFFFFFFFFFFFFFF\r", {0x7FF, 8, {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}}},
    {"T1FFFFFFF80123456789ABCDEF\r",
     {0x1FFF'FFFF, 8, {0x01, 0x23, 0x45, 0x67, 0x89, 0xAB, 0xCD, 0xEF}, Format::extended}},
    {"r7FF8\r", {0x7FF, 8, {}, Format::base_remote}},
    {"R1FFFFFFF0\r", {0x1FFF'FFFF, 0, {}, Format::extended_remote}},
};

constexpr std::string_view body(std::string_view line) {
  return line.substr(0, line.size() - 1);
}

constexpr bool both_ways() {
  for (const Vector& v : vectors) {
    if (!(slcan::encode(v.frame)->view() == v.line)) return false;
    if (slcan::parse_command(body(v.line))->kind != Command::Kind::transmit) return false;
    if (!(slcan::parse_command(body(v.line))->frame == v.frame)) return false;
    if (slcan::parse_answer(body(v.line))->kind != Answer::Kind::frame) return false;
    if (!(slcan::parse_answer(body(v.line))->frame == v.frame)) return false;
  }
  return true;
}
static_assert(both_ways());

static_assert(slcan::encode({0x100, 2, {0x11, 0x33}}, 0x2B4C % 60'000)->view() == "t100211332B4C\r");
static_assert(slcan::encode({0x100, 0, {}}, 59'999)->view() == "t1000EA5F\r");  // the last of a minute
static_assert(slcan::encode({0x100, 0, {}}, 60'000)->view() == "t10000000\r");
static_assert(slcan::parse_answer("t10021133EA5F")->stamp == 59'999);
static_assert(slcan::parse_answer("t10021133EA5F")->stamped);
static_assert(!slcan::parse_answer("t10021133")->stamped);
static_assert(slcan::encode({0x800, 0, {}}).error == Error::bad_identifier);
static_assert(slcan::encode({0x100, 9, {}}).error == Error::bad_length);
static_assert(slcan::encode({0x004, 8, {}, Format::error}).error == Error::bad_identifier);
static_assert(slcan::encode({0x1FFF'FFFF, 8, {}, Format::extended}, 1)->view().size() ==
              slcan::max_frame_line + 1);

// [CAN232 manual, command S]
static_assert(*slcan::bit_rate_code(10'000) == 0 && *slcan::bit_rate_code(125'000) == 4 &&
              *slcan::bit_rate_code(500'000) == 6 && *slcan::bit_rate_code(1'000'000) == 8);
static_assert(slcan::bit_rate_code(83'333).error == Error::out_of_range);
static_assert(slcan::nearest_bit_rate(83'333) == 100'000 && slcan::nearest_bit_rate(650'000) == 500'000 &&
              slcan::nearest_bit_rate(0) == 10'000 && slcan::nearest_bit_rate(UINT32_MAX) == 1'000'000);
// 03 1C is 125 kbit/s [CAN232 manual, command s]; 00 14 is 1 Mbit/s, 00 1C 500 kbit/s for an SJA1000 at 16
// MHz
static_assert(slcan::bit_rate_of_registers(0x03, 0x1C) == 125'000);
static_assert(slcan::bit_rate_of_registers(0x00, 0x14) == 1'000'000);
static_assert(slcan::bit_rate_of_registers(0x00, 0x1C) == 500'000);

// --- answers -----------------------------------------------------------------------------------------------

/// Everything that the reader makes of a text.
std::vector<Answer> read(slcan::AnswerReader& reader, std::string_view text) {
  std::vector<Answer> all;
  for (const char c : text)
    if (const Answer answer = reader.feed(c); answer.kind != Answer::Kind::none) all.push_back(answer);
  return all;
}

TEST_CASE("slcan: what an adapter says") {
  slcan::AnswerReader reader;
  const auto kind = [&](std::string_view text) {
    const auto all = read(reader, text);
    REQUIRE(all.size() == 1);
    return all[0].kind;
  };
  CHECK(kind("\r") == Answer::Kind::done);
  CHECK(kind("\n\r") == Answer::Kind::done);  // of CR LF the second belongs to the next line
  CHECK(kind("z\r") == Answer::Kind::taken);
  CHECK(kind("Z\r") == Answer::Kind::taken);
  CHECK(kind("\a") == Answer::Kind::refused);
  CHECK(kind("V1013\r") == Answer::Kind::version);
  CHECK(read(reader, "V1013\r")[0].text == "1013");
  CHECK(read(reader, "NA123\r")[0].text == "A123");
  CHECK(read(reader, "FA4\r")[0].flags == 0xA4);
  CHECK(reader.faults() == slcan::LineFaults{});
}

TEST_CASE("slcan: answers come whole however the characters are cut, and one fault costs one line") {
  slcan::AnswerReader reader;
  std::string text;
  for (const Vector& v : vectors) text += v.line;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto all = read(reader, text.substr(0, i) + "\x01\r" + text);  // torn anywhere by noise
    std::size_t whole = 0;
    for (std::size_t at = 0; at < i; ++at) whole += text[at] == '\r' ? 1 : 0;
    REQUIRE(all.size() == whole + std::size(vectors));
    for (std::size_t k = 0; k < std::size(vectors); ++k) REQUIRE(all[whole + k].frame == vectors[k].frame);
  }
  CHECK(reader.faults().noise == text.size());
  CHECK(reader.faults().total() == text.size());
}

TEST_CASE("slcan: what is no line is counted by its cause") {
  const auto faults = [](std::string_view text) {
    slcan::AnswerReader reader;
    const auto all = read(reader, text);
    CHECK((all.empty() || all[0].kind == Answer::Kind::refused));
    CHECK(reader.faults().total() == 1);
    // and the next line is heard
    const auto next = read(reader, "z\r");
    CHECK((next.size() == 1 && next[0].kind == Answer::Kind::taken));
    return reader.faults();
  };
  CHECK(faults(std::string(1000, 't') + "\r").too_long == 1);
  CHECK(faults("t100\xFF\x80z\r").noise == 1);
  CHECK(faults("t1002113\a").torn == 1);
  CHECK(faults("q\r").unknown == 1);
  CHECK(faults("O\r").unknown == 1);  // an echo is no answer
  CHECK(faults("t1002113\r").bad_syntax == 1);
  CHECK(faults("t10021133E\r").bad_syntax == 1);
  CHECK(faults("t10021133EA60\r").bad_syntax == 1);  // 60000 ms: a minute ends before
  CHECK(faults("t100211330000F\r").bad_syntax == 1);
  CHECK(faults("t1\r").bad_syntax == 1);
  CHECK(faults("t10x0\r").bad_syntax == 1);
  CHECK(faults("t8000\r").bad_identifier == 1);
  CHECK(faults("T200000000\r").bad_identifier == 1);
  CHECK(faults("t1009112233445566778899\r").bad_length == 1);
  CHECK(faults("FA\r").bad_syntax == 1);
  CHECK(faults("zz\r").bad_syntax == 1);
  CHECK(faults("e0\r").bad_syntax == 1);
  CHECK(faults("e2a\r").bad_syntax == 1);
  CHECK(faults("e1x\r").bad_syntax == 1);
  CHECK(faults("sx000000\r").bad_syntax == 1);
}

TEST_CASE("slcan: every true beginning of a line is refused") {
  for (const Vector& v : vectors)
    for (std::size_t length = 1; length < body(v.line).size(); ++length) {
      INFO(v.line.substr(0, length));
      // A cut frame with data is too short; it is never taken for another frame.
      CHECK_FALSE(slcan::parse_command(v.line.substr(0, length)).ok());
      CHECK_FALSE(slcan::parse_answer(v.line.substr(0, length)).ok());
    }
}

TEST_CASE("slcan: reports of errors become the error frames that linux makes of them") {
  using namespace ocm::can;
  const auto frame = [](std::string_view line) {
    const auto answer = slcan::parse_answer(line);
    REQUIRE(answer);
    REQUIRE(answer->frame.format == Format::error);
    return answer->frame;
  };
  CHECK(frame("e1a").id == 0xA8);
  CHECK(frame("e1a").data == Payload{0, 0, 0, 0x19});
  CHECK(frame("e1c").data == Payload{0, 0, 1, 8});
  CHECK(frame("e3bcO").data == Payload{0, 2, 9, 8});
  CHECK(frame("e1B").data[2] == 0x10);
  CHECK(frame("e2fs").data[2] == 0x06);
  CHECK(lost_in_controller(frame("e1o")));
  CHECK(frame("sb256256") == Frame{error_class::bus_off, 8, {}, Format::error});
  CHECK(frame("sa057033").data == Payload{0, 0x40, 0, 0, 0, 0, 33, 57});
  CHECK(frame("sw096012").data == Payload{0, controller_error::rx_warning, 0, 0, 0, 0, 12, 96});
  CHECK(frame("sp012130").data == Payload{0, controller_error::tx_passive, 0, 0, 0, 0, 130, 12});
}

TEST_CASE("slcan: status flags become error frames, states once and events each time") {
  using namespace ocm::can;
  CHECK(slcan::to_error_frame(0, 0).id == 0);
  CHECK(slcan::to_error_frame(slcan::status::arbitration_lost, 0).id == 0);  // is no error
  CHECK(slcan::to_error_frame(slcan::status::warning, 0).data[1] == 0x0C);
  CHECK(slcan::to_error_frame(slcan::status::warning, slcan::status::warning).id == 0);
  CHECK(slcan::to_error_frame(slcan::status::passive | slcan::status::warning, slcan::status::warning)
            .data[1] == 0x30);
  CHECK(slcan::to_error_frame(0, slcan::status::warning).data[1] == controller_error::active);
  for (int i = 0; i < 2; ++i)
    CHECK(lost_in_controller(slcan::to_error_frame(slcan::status::overrun, slcan::status::overrun)));
  CHECK(slcan::to_error_frame(slcan::status::bus_error, 0).id == error_class::bus_error);
}

TEST_CASE("slcan: any frame comes back, with its time stamp") {
  ocm::test::Random random{1};
  slcan::AnswerReader reader;
  for (int i = 0; i < 20'000; ++i) {
    Frame frame;
    frame.format = static_cast<Format>(random.below(4));
    frame.id = random() & (ocm::can::is_extended(frame.format) ? 0x1FFF'FFFFU : 0x7FFU);
    frame.dlc = static_cast<std::uint8_t>(random.below(9));
    if (!ocm::can::is_remote(frame.format))
      for (std::size_t k = 0; k < frame.dlc; ++k)
        frame.data[k] = static_cast<std::uint8_t>(random.below(256));
    const std::uint32_t ms = random();
    const auto all = read(
        reader, std::string(slcan::encode(frame)->view()) + std::string(slcan::encode(frame, ms)->view()));
    REQUIRE(all.size() == 2);
    REQUIRE(all[0].frame == frame);
    REQUIRE_FALSE(all[0].stamped);
    REQUIRE(all[1].frame == frame);
    REQUIRE(all[1].stamp == ms % 60'000);
  }
  CHECK(reader.faults().total() == 0);
}

TEST_CASE("slcan: whatever comes, the reader finds the next line") {
  ocm::test::Random random{2};
  slcan::AnswerReader reader;
  for (int i = 0; i < 20'000; ++i) {
    std::string noise;
    for (std::uint32_t k = random.below(80); k > 0; --k)
      noise += "tTrRzZFVNes0123456789ABCDEF\r\a\n\xFF "[random.below(33)];
    read(reader, noise + "\r");
    const auto all = read(reader, "t10021133\r");
    REQUIRE(all.size() == 1);
    REQUIRE(all[0].frame == vectors[0].frame);
  }
  CHECK(reader.faults().total() > 10'000);
}

// --- the adapter -------------------------------------------------------------------------------------------

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

TEST_CASE("slcan adapter: a full bus is told, and the flags stay until they were asked for") {
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
  // ID.28 to ID.13 of extended frames: 0x1F334455 >> 13 = 0xF99A [SJA1000 data sheet, table 20]
  filter("F99A0000", "00000000");
  CHECK(heard({0x1F33'4455, 0, {}, Format::extended}));
  CHECK(heard({0x1F33'5FFF, 0, {}, Format::extended}));
  CHECK_FALSE(heard({0x1F33'6000, 0, {}, Format::extended}));
  CHECK(heard({0x0000'0455, 0, {}, Format::extended}));  // the second filter
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

static_assert(sizeof(slcan::AnswerReader) <= 84);
static_assert(sizeof(Adapter) <= 84);

}  // namespace
