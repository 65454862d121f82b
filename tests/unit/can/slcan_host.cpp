#include "ocm/can/slcan_host.hpp"

#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/can/slcan_adapter.hpp"

#include "unit/base/random.hpp"
#include "unit/can/slcan_vectors.hpp"

namespace can_slcan_host_test {

namespace slcan = ocm::can::slcan;
using ocm::base::Error;
using ocm::can::Format;
using ocm::can::Frame;
using ocm::test::slcan::body;
using ocm::test::slcan::vectors;
using slcan::Answer;

constexpr bool answers_are_the_vectors() {
  for (const auto& v : vectors) {
    if (slcan::parse_answer(body(v.line))->kind != Answer::Kind::frame) return false;
    if (!(slcan::parse_answer(body(v.line))->frame == v.frame)) return false;
  }
  return true;
}
static_assert(answers_are_the_vectors());

static_assert(slcan::parse_answer("t10021133EA5F")->stamp == 59'999);
static_assert(slcan::parse_answer("t10021133EA5F")->stamped);
static_assert(!slcan::parse_answer("t10021133")->stamped);

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
  for (const auto& v : vectors) text += v.line;
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
  CHECK(faults("t10021133E0x0\r").bad_syntax == 1);
  CHECK(faults("t1\r").bad_syntax == 1);
  CHECK(faults("t10x0\r").bad_syntax == 1);
  CHECK(faults("t8000\r").bad_identifier == 1);
  CHECK(faults("T200000000\r").bad_identifier == 1);
  CHECK(faults("t1009112233445566778899\r").bad_length == 1);
  CHECK(faults("FA\r").bad_syntax == 1);
  CHECK(faults("FA40\r").bad_syntax == 1);
  CHECK(faults("Fx0\r").bad_syntax == 1);
  CHECK(faults("zz\r").bad_syntax == 1);
  CHECK(faults("e0\r").bad_syntax == 1);
  CHECK(faults("e2a\r").bad_syntax == 1);
  CHECK(faults("e1x\r").bad_syntax == 1);
  CHECK(faults("sx000000\r").bad_syntax == 1);
  CHECK(faults("sa0x7033\r").bad_syntax == 1);
  CHECK(faults("sa0570x3\r").bad_syntax == 1);
  // The first and the last character that a line may have, and those beside them.
  CHECK(faults(" \r").unknown == 1);
  CHECK(faults("~\r").unknown == 1);
  CHECK(faults("\x1F\r").noise == 1);
  CHECK(faults("\x7F\r").noise == 1);
}

TEST_CASE("slcan: a version has at most 47 characters") {
  slcan::AnswerReader reader;
  const std::string longest(47, '1');
  const auto all = read(reader, "V" + longest + "\r");
  REQUIRE(all.size() == 1);
  CHECK(all[0].kind == Answer::Kind::version);
  CHECK(all[0].text == longest);
  CHECK(read(reader, "V" + longest + "1\r").empty());
  CHECK(reader.faults().too_long == 1);
}

TEST_CASE("slcan: a line has begun at its first character, also at one that spoils it, until it ends") {
  slcan::AnswerReader reader;
  CHECK_FALSE(reader.mid_line());
  read(reader, "z");
  CHECK(reader.mid_line());
  read(reader, "\r");
  CHECK_FALSE(reader.mid_line());
  read(reader, "\n");
  CHECK_FALSE(reader.mid_line());
  read(reader, "\xFF");
  CHECK(reader.mid_line());
  read(reader, "\r");
  CHECK_FALSE(reader.mid_line());
  read(reader, "t1");
  CHECK(reader.mid_line());
  read(reader, "\a");
  CHECK_FALSE(reader.mid_line());
}

TEST_CASE("slcan: every true beginning of a line is refused") {
  for (const auto& v : vectors)
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
  CHECK(frame("sa057033").id == (error_class::controller | error_class::counters));
  CHECK(frame("sw012096").data[1] == controller_error::tx_warning);
  CHECK(frame("sp130012").data[1] == controller_error::rx_passive);
  // Where both counters are equal, it is both sides.
  CHECK(frame("sw096096").data[1] == (controller_error::tx_warning | controller_error::rx_warning));
  CHECK(frame("sp130130").data[1] == (controller_error::tx_passive | controller_error::rx_passive));
  CHECK(frame("sp256999").data == Payload{0, controller_error::tx_passive, 0, 0, 0, 0, 255, 255});
  CHECK(frame("e1O") == Frame{error_class::controller | error_class::protocol | error_class::bus_error,
                              8,
                              {0, controller_error::tx_overflow},
                              Format::error});
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
  CHECK(slcan::to_error_frame(slcan::status::transmit_queue_full, 0) ==
        Frame{error_class::controller, 8, {0, controller_error::tx_overflow}, Format::error});
  CHECK(slcan::to_error_frame(slcan::status::receive_queue_full, 0) ==
        Frame{error_class::controller, 8, {0, controller_error::rx_overflow}, Format::error});
  CHECK(slcan::to_error_frame(slcan::status::warning | slcan::status::bus_error, 0) ==
        Frame{error_class::controller | error_class::bus_error,
              8,
              {0, controller_error::rx_warning | controller_error::tx_warning},
              Format::error});
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

static_assert(sizeof(slcan::AnswerReader) <= 84);

}  // namespace can_slcan_host_test
