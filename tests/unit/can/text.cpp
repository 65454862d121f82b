#include "ocm/can/text.hpp"

#include <string>

#include <catch2/catch.hpp>

#include "unit/base/explore.hpp"
#include "unit/base/random.hpp"

namespace can_text_test {

using ocm::base::Error;
using ocm::can::Format;
using ocm::can::Frame;
using ocm::can::parse_frame;
using ocm::can::parse_log_line;
using ocm::can::to_log_line;
using ocm::can::to_text;

constexpr ocm::base::Time at_ns(std::int64_t ns) {
  return ocm::base::Time{ocm::base::Duration{ns}};
}

// --- vectors ---

// Magnetometer every 900 us, medium priority, and its x axis. [Thesis 4.2]
constexpr Frame magnetometer_every_900_us{0x205, 4, {0x01, 0x84, 0x03, 0x02}};
static_assert(to_text(magnetometer_every_900_us) == "205#01840302");
static_assert(parse_frame("205#01840302") == magnetometer_every_900_us);

struct Vector {
  std::string_view text;
  Frame frame;
};

// The notation of can-utils' cansend and candump -l.
constexpr Vector vectors[] = {
    {"204#02", {0x204, 1, {2}}},
    {"000#", {0x000, 0, {}}},
    {"7FF#0011223344556677", {0x7FF, 8, {0x00, 0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77}}},
    {"1F334455#1122334455667788",
     {0x1F33'4455, 8, {0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88}, Format::extended}},
    {"00000005#DE", {0x005, 1, {0xDE}, Format::extended}},
    {"1FFFFFFF#", {0x1FFF'FFFF, 0, {}, Format::extended}},
    {"605#R", {0x605, 0, {}, Format::base_remote}},
    {"605#R8", {0x605, 8, {}, Format::base_remote}},
    {"1F334455#R", {0x1F33'4455, 0, {}, Format::extended_remote}},
    {"1F334455#R3", {0x1F33'4455, 3, {}, Format::extended_remote}},
    {"20000040#0000000000000000", {0x040, 8, {}, Format::error}},
    {"20000004#0004000000000000", {0x004, 8, {0, 4}, Format::error}},
};

constexpr bool both_ways() {
  for (const Vector& v : vectors)
    if (!(to_text(v.frame) == v.text) || !(parse_frame(v.text) == v.frame)) return false;
  return true;
}
static_assert(both_ways());

TEST_CASE("other ways to write a frame") {
  STATIC_REQUIRE(parse_frame("7ff#deadbeef") == parse_frame("7FF#DEADBEEF"));
  STATIC_REQUIRE(parse_frame("205#01.84.03.02") == magnetometer_every_900_us);
  STATIC_REQUIRE(parse_frame("205#0184.0302") == magnetometer_every_900_us);
  STATIC_REQUIRE(parse_frame("605#r4") == Frame{0x605, 4, {}, Format::base_remote});
  STATIC_REQUIRE(parse_frame("605#R0") == Frame{0x605, 0, {}, Format::base_remote});
  STATIC_REQUIRE(parse_frame("123#00.11.22.33.44.55.66.77")->dlc == 8);
}

TEST_CASE("text that is no frame is refused, with the reason") {
  struct Bad {
    const char* text;
    Error error;
  };
  const Bad table[] = {
      {"", Error::bad_syntax},
      {"205", Error::bad_syntax},
      {"#", Error::bad_identifier},
      {"#01", Error::bad_identifier},
      {"5#01", Error::bad_identifier},
      {"05#01", Error::bad_identifier},
      {"0205#01", Error::bad_identifier},
      {"1234567#01", Error::bad_identifier},
      {"123456789#01", Error::bad_identifier},
      {"2G5#01", Error::bad_identifier},
      {"-05#01", Error::bad_identifier},
      {" 05#01", Error::bad_identifier},
      {"0x5#01", Error::bad_identifier},
      // identifiers too wide for their format
      {"800#", Error::bad_identifier},
      {"FFF#01", Error::bad_identifier},
      {"800#R", Error::bad_identifier},
      {"40000000#", Error::bad_identifier},
      {"80000005#01", Error::bad_identifier},
      {"FFFFFFFF#", Error::bad_identifier},
      {"60000040#00", Error::bad_identifier},
      // data
      {"205#0", Error::bad_syntax},
      {"205#018", Error::bad_syntax},
      {"205#0G", Error::bad_syntax},
      {"205#G0", Error::bad_syntax},
      {"205#01 84", Error::bad_syntax},
      {"205#01\n", Error::bad_syntax},
      {"205# 01", Error::bad_syntax},
      {"205#.", Error::bad_syntax},
      {"205#.01", Error::bad_syntax},
      {"205#01.", Error::bad_syntax},
      {"205#01..84", Error::bad_syntax},
      {"205#0.1", Error::bad_syntax},
      {"205#01.8", Error::bad_syntax},
      {"205#112233445566778899", Error::bad_length},
      {"205#11.22.33.44.55.66.77.88.99", Error::bad_length},
      {"205#11223344556677889", Error::bad_syntax},
      // CAN FD is not this robot's bus
      {"205##0", Error::bad_syntax},
      {"205##311", Error::bad_syntax},
      // remote
      {"205#R9", Error::bad_length},
      {"205#R10", Error::bad_syntax},
      {"205#R-", Error::bad_syntax},
      {"205#Rx", Error::bad_syntax},
      {"205#RR", Error::bad_syntax},
      {"205#R1 ", Error::bad_syntax},
      {"20000040#R", Error::bad_syntax},
      {"205#01R", Error::bad_syntax},
  };
  for (const Bad& bad : table) {
    INFO('"' << bad.text << '"');
    CHECK(parse_frame(bad.text).error == bad.error);
  }
  CHECK(parse_frame(std::string_view("205#\0\0", 6)).error == Error::bad_syntax);
  CHECK(parse_frame(std::string_view("2\0005#", 4)).error == Error::bad_identifier);
}

// A write beyond the frame's eight bytes would not compile here; at run time it might hit nothing.
static_assert(parse_frame("205#112233445566778899").error == Error::bad_length);
static_assert(parse_frame("205#11.22.33.44.55.66.77.88.99").error == Error::bad_length);
static_assert(parse_frame("205#112233445566778899AABBCCDDEEFF").error == Error::bad_length);

Frame random_frame(ocm::test::Random& random) {
  Frame frame;
  frame.format = static_cast<Format>(random.below(5));
  const bool narrow = frame.format == Format::base || frame.format == Format::base_remote;
  frame.id = random() & (narrow ? ocm::can::max_base_id : ocm::can::max_extended_id);
  frame.dlc = static_cast<std::uint8_t>(random.below(9));
  if (!ocm::can::is_remote(frame.format))
    for (unsigned i = 0; i < frame.dlc; ++i) frame.data[i] = static_cast<std::uint8_t>(random());
  return frame;
}

TEST_CASE("every frame comes back from its text and from its log line") {
  ocm::test::Random random{1};
  for (int i = 0; i < 20'000; ++i) {
    const Frame frame = random_frame(random);
    const auto text = to_text(frame);
    INFO(std::string{text.view()});
    REQUIRE_FALSE(text.overflowed());
    REQUIRE(parse_frame(text.view()) == frame);

    const auto time = at_ns(std::int64_t{random()} * 1'000'000'000 + random.below(1'000'000) * 1000);
    const auto log = to_log_line(time, "a_15_chars_name", frame);
    REQUIRE_FALSE(log.overflowed());
    const auto line = parse_log_line(log.view());
    REQUIRE(line.ok());
    REQUIRE(line->time == time);
    REQUIRE(line->interface == "a_15_chars_name");
    REQUIRE(line->frame == frame);
    REQUIRE(line->direction == 0);
  }
}

TEST_CASE("garbage gets an answer and never a frame that cannot exist") {
  ocm::test::Random random{2};
  const std::string_view letters = "0123456789ABCDEFabcdef#.Rr(). \n-xG";
  int taken = 0;
  for (int i = 0; i < 200'000 / ocm::test::coarser(10); ++i) {
    std::string text;
    // Half of them begin as a frame does, or the identifier would stop nearly all.
    if (random.below(2) == 0) text = random.below(2) == 0 ? "205#" : "1F334455#";
    for (auto n = random.below(20); n > 0; --n)
      text += random.below(50) == 0 ? static_cast<char>(random())
                                    : letters[random.below(static_cast<std::uint32_t>(letters.size()))];
    INFO(text);
    if (const auto frame = parse_frame(text); frame) {
      REQUIRE(ocm::can::validate(*frame).ok());
      REQUIRE(parse_frame(to_text(*frame).view()) == *frame);
      ++taken;
    }
    if (const auto line = parse_log_line("(1.5) can0 " + text); line)
      REQUIRE(ocm::can::validate(line->frame).ok());
    REQUIRE_FALSE(parse_log_line(text).ok());  // no time, no interface
  }
  CHECK(taken > 1000 / ocm::test::coarser(10));
}

// --- log lines ---

static_assert(to_log_line(at_ns(1'436'509'052'249'713'000), "can0", {0x605, 4, {0x00, 0xD2, 0x00, 0x00}}) ==
              "(1436509052.249713) can0 605#00D20000");
static_assert(parse_log_line("(1436509052.249713) can0 605#00D20000")->time ==
              at_ns(1'436'509'052'249'713'000));

TEST_CASE("a log line's fraction has 0 to 9 digits") {
  constexpr std::string_view digits = "987654321";
  for (std::size_t n = 0; n <= 9; ++n) {
    const std::string fraction = n == 0 ? "" : '.' + std::string{digits.substr(0, n)};
    const auto line = parse_log_line("(12" + fraction + ") can0 605#R");
    INFO(fraction);
    REQUIRE(line.ok());
    const std::string nine = std::string{digits.substr(0, n)} + std::string(9 - n, '0');
    CHECK(line->time == at_ns(12'000'000'000 + std::stol(nine)));
  }
  STATIC_REQUIRE(parse_log_line("(12.000000001) can0 605#R")->time == at_ns(12'000'000'001));
  STATIC_REQUIRE(parse_log_line("(0000000012.1) can0 605#R")->time == at_ns(12'100'000'000));
  STATIC_REQUIRE(parse_log_line("(1) can0 605#R")->time == at_ns(1'000'000'000));
  CHECK(parse_log_line("(12.1234567890) can0 605#R").error == Error::bad_syntax);
}

TEST_CASE("a log line may say the direction, and blanks do not matter") {
  const auto line = parse_log_line("(1.5)  vcan0\t204#02 T\r\n");
  REQUIRE(line.ok());
  CHECK(line->direction == 'T');
  CHECK(line->interface == "vcan0");
  CHECK(line->frame == Frame{0x204, 1, {2}});
  STATIC_REQUIRE(parse_log_line("(1.5) can0 204#02 R")->direction == 'R');
  STATIC_REQUIRE(parse_log_line("  (1.5) can0 204#02  ")->direction == 0);
}

TEST_CASE("text that is no log line is refused") {
  struct Bad {
    const char* text;
    Error error;
  };
  const Bad table[] = {
      {"", Error::bad_syntax},
      {" \n", Error::bad_syntax},
      {"204#02", Error::bad_syntax},
      {"(1.5)", Error::bad_syntax},
      {"(1.5) can0", Error::bad_syntax},
      {"(1.5) 204#02", Error::bad_syntax},
      {"() can0 204#02", Error::bad_syntax},
      {"(.) can0 204#02", Error::bad_syntax},
      {"(.5) can0 204#02", Error::bad_syntax},
      {"(-1.5) can0 204#02", Error::bad_syntax},
      {"(1.-5) can0 204#02", Error::bad_syntax},
      {"(1.5.5) can0 204#02", Error::bad_syntax},
      {"(1,5) can0 204#02", Error::bad_syntax},
      {"(1.5 can0 204#02", Error::bad_syntax},
      {"1.5) can0 204#02", Error::bad_syntax},
      {"(9223372035.999999999) can0 204#02", Error::none},
      {"(9223372036.0) can0 204#02", Error::out_of_range},
      {"(99999999999999999999.0) can0 204#02", Error::out_of_range},
      {"(1.5) can0 204#0", Error::bad_syntax},
      {"(1.5) can0 804#02", Error::bad_identifier},
      {"(1.5) can0 204#112233445566778899", Error::bad_length},
      {"(1.5) can0 204#02 X", Error::bad_syntax},
      {"(1.5) can0 204#02 RT", Error::bad_syntax},
      {"(1.5) can0 204#02 R R", Error::bad_syntax},
      {"(1.5) can0 204 # 02", Error::bad_syntax},
  };
  for (const Bad& bad : table) {
    INFO('"' << bad.text << '"');
    CHECK(parse_log_line(bad.text).error == bad.error);
  }
}

TEST_CASE("log lines at the ends of time") {
  const Frame frame{0x204, 1, {2}};
  CHECK(to_log_line(at_ns(0), "can0", frame) == "(0000000000.000000) can0 204#02");
  CHECK(to_log_line(at_ns(-1), "can0", frame) == "(0000000000.000000) can0 204#02");
  CHECK(to_log_line(at_ns(INT64_MIN), "can0", frame) == "(0000000000.000000) can0 204#02");
  CHECK(to_log_line(at_ns(1999), "can0", frame) == "(0000000000.000001) can0 204#02");
  CHECK(to_log_line(ocm::base::never, "can0", frame) == "(9223372036.854775) can0 204#02");
  CHECK(to_log_line(at_ns(0), std::string(100, 'x'), frame).overflowed());
}

}  // namespace can_text_test
