#include "cli/logs/json_lines.hpp"

#include <array>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/can/text.hpp"
#include "ocm/client/frame_index.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/output/output.hpp"
#include "unit/base/explore.hpp"
#include "unit/log/entries.hpp"
#include "unit/log/log_testing.hpp"

namespace tool_output_json_lines_test {

using namespace ocm;
using cli::logs::JsonLineParser;
using cli::logs::JsonLinesReader;
using cli::logs::JsonLinesWriter;

// The line of a gyroscope's frame: three digits of 0.0175 deg/s. [docs/verbs/listen.md]
constexpr std::string_view gyroscope =
    R"({"time_ns":"1436509052249713000","bus":"can0","id":"608","priority":"medium","topic":"gyroscope",)"
    R"("frame":"gyroscope","fields":{"x":0.0525,"y":-0.0175,"z":0},)"
    R"("units":{"x":"deg/s","y":"deg/s","z":"deg/s"},"data":"0300FFFF0000"})";

log::Entry entry_of(std::string_view frame) {
  const auto parsed = can::parse_frame(frame);
  REQUIRE(parsed.ok());
  return {base::Time{base::Duration{1'436'509'052'249'713'000}}, *parsed};
}

std::string line_of(const log::Entry& entry, std::string_view bus = "can0",
                    const cli::Selection& chosen = {}) {
  cli::JsonText text{amiro::catalogue, chosen};
  log::Bytes out;
  text.write(out, bus, entry);
  return std::string{out.view()};
}

/// The frame that a line makes, in candump's notation; or what is wrong with it.
std::string frame_of(std::string_view line) {
  JsonLineParser parser{amiro::catalogue};
  log::Entry entry;
  std::string_view bus;
  if (!parser.parse(line, entry, bus)) return parser.problem().what + "; " + parser.problem().remedy;
  return std::string{can::to_text(entry.classic().value()).view()};
}

std::string replaced(std::string_view text, std::string_view what, std::string_view with) {
  std::string out{text};
  const auto at = out.find(what);
  REQUIRE(at != std::string::npos);
  return out.replace(at, what.size(), with);
}

bool has(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

cli::Selection selection(const std::vector<std::string>& words) {
  auto chosen = cli::Selection::of(amiro::catalogue, words);
  REQUIRE(chosen.ok());
  return *chosen;
}

TEST_CASE("JSON lines: what each kind of frame looks like", "[output]") {
  const std::string head = R"({"time_ns":"1436509052249713000","bus":"can0","id":)";
  CHECK(line_of(entry_of("608#0300FFFF0000")) == std::string{gyroscope} + '\n');
  CHECK(line_of(entry_of("208#01F40100")) ==
        head + R"("208","priority":"medium","topic":"gyroscope","frame":"request",)"
               R"("fields":{"mode":"publish","period":0.5},"units":{"period":"s"},"data":"01F40100"})"
               "\n");
  CHECK(line_of(entry_of("608#00")) ==
        head + R"("608","priority":"medium","topic":"gyroscope","frame":"gyroscope",)"
               R"("error":"DLC 1 instead of 6","data":"00"})"
               "\n");
  CHECK(line_of(entry_of("4FF#1122")) ==
        head + R"("4FF","error":"unknown identifier","data":"1122"})" + "\n");
  CHECK(line_of(entry_of("12345678#R4")) ==
        head + R"("12345678","error":"unknown identifier","data":"R4"})" + "\n");
  auto entry = entry_of("605#01020304");
  entry.flags = log::flag::fd | log::flag::bit_rate_switch;
  entry.direction = log::Direction::sent;
  CHECK(line_of(entry) == head + R"("605","error":"CAN FD frame","data":"01020304","direction":"sent",)"
                                 R"("fd":{"brs":true,"esi":false}})"
                                 "\n");
  auto long_code = entry_of("601#0102030405060708");
  long_code.raw_dlc = 12;
  CHECK(has(line_of(long_code), R"("data":"0102030405060708","raw_dlc":12})"));
  long_code.direction = log::Direction::received;
  CHECK(has(line_of(long_code), R"("data":"0102030405060708","direction":"received","raw_dlc":12})"));
  // The odometry's velocity, of which the end of the line is most often the same.
  auto velocity = entry_of("602#0102030405060708");
  CHECK(has(line_of(velocity), R"("topic":"odometry")"));
  CHECK(line_of(velocity).ends_with(R"("data":"0102030405060708"})"
                                    "\n"));
  velocity.raw_dlc = 12;
  CHECK(line_of(velocity).ends_with(R"("data":"0102030405060708","raw_dlc":12})"
                                    "\n"));
  velocity.raw_dlc = 0;
  velocity.direction = log::Direction::sent;
  CHECK(line_of(velocity).ends_with(R"("data":"0102030405060708","direction":"sent"})"
                                    "\n"));
  entry.flags = log::flag::fd | log::flag::error_state;
  entry.direction = log::Direction::unknown;
  CHECK(has(line_of(entry), R"("data":"01020304","fd":{"brs":false,"esi":true}})"));
  CHECK(has(line_of(entry_of("605#R")), R"("data":"R"})"));
  CHECK(has(line_of(entry_of("208#01")),
            R"("fields":{"mode":"publish","period":0.05},"units":{"period":"s"},"data":"01"})"));
  CHECK(has(line_of(entry_of("208#00")), R"("fields":{"mode":"stop"},"units":{"period":"s"},"data":"00"})"));
  CHECK(has(line_of(entry_of("208#02")), R"("fields":{"mode":"once"},"units":{"period":"s"},"data":"02"})"));
  CHECK(has(line_of(entry_of("208#07")), R"("frame":"request","error":")"));
  CHECK(has(line_of(entry_of("20000040#0000000000000000")), R"("id":"20000040","error":"error frame: )"));
  CHECK(has(line_of(entry_of("608#0300FFFF0000"), "a\"b\\\x01\xFF"), R"("bus":"a\"b\\\u0001\\xff")"));
  // What looks like UTF-8 and is none: overlong, a surrogate, beyond U+10FFFF. [RFC 3629]
  CHECK(has(line_of(entry_of("608#0300FFFF0000"), "\xC0\x80"), R"("bus":"\\xc0\\x80")"));
  CHECK(has(line_of(entry_of("608#0300FFFF0000"), "\xED\xA0\x80"), R"("bus":"\\xed\\xa0\\x80")"));
  CHECK(has(line_of(entry_of("608#0300FFFF0000"), "\xF4\x90\x80\x80"), R"("bus":"\\xf4\\x90\\x80\\x80")"));
  // A name that looks like such a byte stays what it is; any other backslash is one.
  CHECK(has(line_of(entry_of("608#0300FFFF0000"), "a\\x41"), R"("bus":"a\\x5cx41")"));
  CHECK(has(line_of(entry_of("608#0300FFFF0000"), "a\\xg1"), R"("bus":"a\\xg1")"));
  CHECK(has(line_of(entry_of("608#0300FFFF0000"), "caf\xC3\xA9"), "\"bus\":\"caf\xC3\xA9\""));
}

TEST_CASE("JSON lines: the first and the last character of each length of UTF-8, and what lies between",
          "[output]") {
  const auto inside = [](std::string_view text) {
    std::string out;
    cli::append_json(out, text);
    return out;
  };
  // [RFC 3629, 4]: 00..7F | C2..DF t | E0 A0..BF t | E1..EC t t | ED 80..9F t | EE..EF t t | F0 90..BF t t |
  // F1..F3 t t t | F4 80..8F t t, where t is 80..BF.
  for (const std::string_view text :
       {" ", "\x7F", "\xC2\x80", "\xDF\xBF", "\xE0\xA0\x80", "\xE0\xBF\xBF", "\xED\x80\x80", "\xED\x9F\xBF",
        "\xEE\x80\x80", "\xEF\xBF\xBF", "\xF0\x90\x80\x80", "\xF0\xBF\xBF\xBF", "\xF3\x80\x80\x80",
        "\xF4\x80\x80\x80", "\xF4\x8F\xBF\xBF"})
    CHECK(inside(text) == text);
  CHECK(inside("\x1F\"\\/") == R"(\u001f\"\\/)");
  CHECK(inside("\x80") == R"(\\x80)");
  CHECK(inside("\xBF") == R"(\\xbf)");
  CHECK(inside("\xC1\xBF") == R"(\\xc1\\xbf)");
  CHECK(inside("\xC2") == R"(\\xc2)");         // cut off
  CHECK(inside("\xC2\x7F") == "\\\\xc2\x7F");  // no byte that goes on
  CHECK(inside(std::string_view{"\xC2\x80"}.substr(0, 1)) == R"(\\xc2)");
  CHECK(inside("\xC2\xC0") == R"(\\xc2\\xc0)");
  CHECK(inside("\xE1\x80") == R"(\\xe1\\x80)");
  CHECK(inside("\xE1\x80 ") == R"(\\xe1\\x80 )");
  CHECK(inside("\xE0\x9F\xBF") == R"(\\xe0\\x9f\\xbf)");
  CHECK(inside("\xED\xA0\x80") == R"(\\xed\\xa0\\x80)");
  CHECK(inside("\xF0\x8F\xBF\xBF") == R"(\\xf0\\x8f\\xbf\\xbf)");
  CHECK(inside("\xF1\x80\x80 ") == R"(\\xf1\\x80\\x80 )");
  CHECK(inside("\xF5\x80\x80\x80") == R"(\\xf5\\x80\\x80\\x80)");
  CHECK(inside("\\x4") == R"(\\x4)");  // too short for a byte in words
  for (const std::string digits : {"41", "00", "40", "04", "0a", "A0", "ff", "F9"}) {
    CAPTURE(digits);
    CHECK(inside("\\x" + digits) == R"(\\x5cx)" + digits);
  }
  CHECK(inside("\\y41") == R"(\\y41)");
  CHECK(inside("\\x4g") == R"(\\x4g)");
  CHECK(inside("\\xg4") == R"(\\xg4)");
}

TEST_CASE("JSON lines: samples and requests of each priority are those of their topic", "[output]") {
  const std::vector<std::string> priorities{"urgent", "high", "medium", "low"};
  for (std::size_t level = 0; level < priorities.size(); ++level) {
    const std::string sample = fmt::format("{}08", 4 + level), request = fmt::format("{}08", level);
    CHECK(has(line_of(entry_of(sample + "#0300FFFF0000")),
              fmt::format(R"("id":"{}","priority":"{}","topic":"gyroscope","frame":"gyroscope","fields":)",
                          sample, priorities[level])));
    CHECK(has(line_of(entry_of(request + "#02")),
              fmt::format(R"("id":"{}","priority":"{}","topic":"gyroscope","frame":"request","fields":)",
                          request, priorities[level])));
  }
}

TEST_CASE("JSON lines: values that have names have them beside the numbers", "[output]") {
  // The power's flags are plugged and charging, and 65535 of its minutes is "unknown". [spec/topics.json]
  CHECK(has(line_of(entry_of("61E#03640AFF0A00")), R"("names":{"flags":"plugged|charging"},"data":"03)"));
  CHECK(has(line_of(entry_of("61E#0264FFFF0A00")),
            R"("names":{"flags":"charging","minutes":"unknown"},"data":"02)"));
  const std::string none = line_of(entry_of("61E#00640AFF0A00"));
  CHECK_FALSE(has(none, "names"));
  CHECK(has(none, R"(},"data":"00640AFF0A00"})"));
  CHECK_FALSE(has(line_of(entry_of("61E#FC640AFF0A00")), "names"));  // bits without a name
}

TEST_CASE("JSON lines: twenty interfaces, each under its own name", "[output]") {
  cli::JsonText text{amiro::catalogue};
  for (int round = 0; round < 2; ++round)
    for (std::uint16_t i = 0; i < 20; ++i) {  // more than are kept ready
      auto entry = entry_of("608#0300FFFF0000");
      entry.interface = i;
      log::Bytes out;
      text.write(out, "can" + std::to_string(i), entry);
      CHECK(has(std::string{out.view()}, "\"bus\":\"can" + std::to_string(i) + "\""));
    }
}

TEST_CASE("JSON lines: chosen fields only", "[output]") {
  const auto chosen = selection({"gyro.z", "odom.velocity"});
  CHECK(has(line_of(entry_of("608#0300FFFF0000"), "can0", chosen),
            R"("fields":{"z":0},"units":{"z":"deg/s"},"data":"0300FFFF0000"})"));
  CHECK(has(line_of(entry_of("602#0102030405060708"), "can0", chosen), R"("fields":{"x":67.305985,"z":)"));
  CHECK(line_of(entry_of("603#0102030405060708"), "can0", chosen).empty());
  CHECK(line_of(entry_of("4FF#11"), "can0", chosen).empty());
  CHECK(line_of(entry_of("608#11"), "can0", chosen).empty());
  CHECK(selection({"power.flags", "power"}).fields().size() == 4);
  CHECK(selection({"led.red"}).fields().size() == 8);
  // In each frame that has it, or in the one that is named.
  CHECK(selection({"odom.x"}).fields().size() == 2);
  CHECK(selection({"odom.pose.x"}).fields().size() == 1);
  CHECK(selection({"ring.distance"}).fields().size() == 8);
  const std::vector<std::string> wrong{"gyro.w"};
  CHECK(has(cli::Selection::of(amiro::catalogue, wrong).error.remedy, "gyro.x"));
}

TEST_CASE("JSON lines: any entries come back bit by bit", "[output]") {
  std::mt19937 random{4};
  log::Interfaces interfaces;
  for (const std::string_view name : {"can0", "a \"b\"\t\\", "\xFF\xC3", "\xED\xA0\x80 \xF0\x9F\x98\x80",
                                      "\\xff", "\\x5cxff\\", "\\\\xfF\xFF"})
    interfaces.add(name);
  auto entries = test::RandomEntries{4, {.interfaces = 7}}.many(20'000);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    auto& entry = entries[i];
    if (i % 3 == 0 || entry.format != can::Format::base || entry.is_fd()) continue;
    entry.id = (entry.id & 0x700U) |
               static_cast<std::uint32_t>(random() % 0x60);  // mostly topics, and often with their length
    if (random() % 4 == 0) continue;
    const auto ref = client::FrameIndex{amiro::catalogue}.find(protocol::Identifier::decode(entry.id));
    if (ref && entry.raw_dlc == 0) entry.length = ref.layout().dlc();
    for (std::size_t j = 0; j < 8; ++j)
      entry.data[j] = static_cast<std::uint8_t>(j < entry.length ? random() : 0);
  }
  JsonLinesWriter writer{amiro::catalogue};
  const std::string text = log::testing::write_all(writer, entries, interfaces);
  CHECK(JsonLinesReader::recognises(text.substr(0, 4096)));
  const auto log = log::testing::read_all<JsonLinesReader>(text, amiro::catalogue);
  for (const auto& complaint : log.complaints) UNSCOPED_INFO(complaint.detail);
  REQUIRE(log.complained == 0);
  REQUIRE(log.entries.size() == entries.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    auto read = log.entries[i];
    REQUIRE(log.names[i] == interfaces.name(entries[i].interface));
    read.interface = entries[i].interface;
    REQUIRE(read == entries[i]);
    REQUIRE(log::testing::can_exist(read));
  }
}

TEST_CASE("JSON lines: an edited value counts, unused bits stay", "[output]") {
  CHECK(frame_of(gyroscope) == "608#0300FFFF0000");
  CHECK(frame_of(replaced(gyroscope, "0.0525", "0.07")) == "608#0400FFFF0000");
  CHECK(frame_of(replaced(gyroscope, "0.0525", "5.25e-02")) == "608#0300FFFF0000");
  CHECK(frame_of(replaced(gyroscope, "0.0525", "\"0.07deg/s\"")) == "608#0400FFFF0000");
  // Out of range, but what the data says: 0x7FFF is 573.4225 deg/s, of 500.
  const std::string far = replaced(replaced(gyroscope, "0.0525", "573.4225"), "0300FFFF", "FF7FFFFF");
  CHECK(frame_of(far) == "608#FF7FFFFF0000");
  CHECK(frame_of(replaced(far, "573.4225", "5.734225e2")) == "608#FF7FFFFF0000");
  CHECK(frame_of(replaced(far, "573.4225", "\"5.734225e2\"")) == "608#FF7FFFFF0000");
  CHECK(has(frame_of(replaced(far, "573.4225", "570")), "out of range"));
  // Keys as jq -S sorts them, blanks, unknown keys.
  CHECK(
      frame_of(R"( { "data" : "0300FFFF0000" , "x":[1,{"y":null}], "fields":{"z":0.0175}, "id":"608" } )") ==
      "608#0300FFFF0100");
  // Value names: what has a name may be written as it.
  CHECK(frame_of(R"({"topic":"floor_calibration","fields":{"action":"measure"}})") == "20A#01");
}

TEST_CASE("JSON lines: frames from topic and fields", "[output]") {
  // Thesis: 0.05 m/s forwards, 0.2 rad/s [docs/verbs/drive.md]
  CHECK(frame_of(R"({"topic":"motors","fields":{"x":0.05,"z":0.2}})") == "201#50C30000400D0300");
  CHECK(frame_of(R"({"topic":"motors","priority":"urgent","fields":{}})") == "001#0000000000000000");
  CHECK(frame_of(R"({"topic":"mag","frame":"y","fields":{"field":1e-06}})") == "606#01000000");
  CHECK(frame_of(R"({"topic":"gyro","frame":"request","fields":{"mode":"publish","period":0.5}})") ==
        "208#01F40100");
  CHECK(frame_of(R"({"topic":"gyro","frame":"request","fields":{"mode":"stop"}})") == "208#00");
  CHECK(frame_of(R"({"topic":"gyro","frame":"request","fields":{"mode":"publish"}})") == "208#01");
  CHECK(frame_of(R"({"id":"208","fields":{"mode":"once","period":1},"data":"01F40100"})") == "208#02");
  CHECK(frame_of(R"({"id":"208","fields":{"mode":"publish","period":0.25},"data":"01F40100"})") ==
        "208#01FA0000");
  // Seconds on the wire stay seconds where nothing was edited.
  CHECK(frame_of(R"({"id":"208","fields":{"mode":"publish","period":2},"data":"01020001"})") ==
        "208#01020001");
}

TEST_CASE("JSON lines: a CAN FD frame of fields alone is zero elsewhere, whatever its place held before",
          "[output]") {
  protocol::Field field;
  field.name = "count";
  field.position = {0, 8, protocol::ByteOrder::little};
  field.raw_max = 255;
  protocol::FrameLayout layout;
  layout.length = 64;
  layout.fields = {&field, 1};
  layout.address = {protocol::Address::By::identifier, false, 0x123};
  layout.fd = true;
  protocol::Topic topic;
  topic.name = "Wide";
  topic.kind = protocol::Kind::message;
  topic.frames = {&layout, 1};
  protocol::Catalogue catalogue;
  catalogue.topics = {&topic, 1};
  JsonLineParser parser{catalogue};
  log::Entry entry;
  entry.data.fill(0xEE);
  std::string_view bus;
  REQUIRE(parser.parse(R"({"topic":"Wide","fields":{"count":7}})", entry, bus));
  REQUIRE(entry.length == 64);
  CHECK(entry.data[0] == 7);
  for (std::size_t i = 1; i < 64; ++i) CHECK(entry.data[i] == 0);
}

TEST_CASE("JSON lines: of fields that have bits in common those count that were edited", "[output]") {
  std::array<protocol::Field, 4> fields;
  const auto put = [&fields](std::size_t i, std::string_view name, std::uint16_t start, std::uint8_t width) {
    fields[i].name = name;
    fields[i].position = {start, width, protocol::ByteOrder::little};
    fields[i].raw_max = (1 << width) - 1;
  };
  put(0, "number", 0, 8);
  put(1, "whole", 8, 16);
  put(2, "low", 8, 8);
  put(3, "high", 16, 8);
  protocol::FrameLayout layout;
  layout.length = 3;
  layout.fields = fields;
  layout.address = {protocol::Address::By::identifier, false, 0x123};
  protocol::Topic topic;
  topic.name = "M";
  topic.kind = protocol::Kind::message;
  topic.frames = {&layout, 1};
  protocol::Catalogue catalogue;
  catalogue.topics = {&topic, 1};
  const auto frame = [&catalogue](std::string_view given, std::string_view data = "") {
    JsonLineParser parser{catalogue};
    log::Entry entry;
    std::string_view bus;
    const std::string line = fmt::format(R"({{"topic":"M","fields":{{{}}}{}}})", given,
                                         data.empty() ? "" : fmt::format(R"(,"data":"{}")", data));
    if (!parser.parse(line, entry, bus)) return parser.problem().what + "; " + parser.problem().remedy;
    return std::string{can::to_text(entry.classic().value()).view()};
  };
  const auto both = [](std::string_view one, std::string_view other) {
    return fmt::format(
        R"(fields "{}" and "{}" have bits in common, and cannot be what both are given; leave one of them out)",
        one, other);
  };
  CHECK(frame(R"("whole":4660)") == "123#003412");
  CHECK(frame(R"("number":9,"low":5,"high":6)") == "123#090506");
  CHECK(frame(R"("low":52,"whole":4660,"high":18)") == "123#003412");
  CHECK(frame(R"("number":9,"whole":4660,"low":5)") == both("whole", "low"));
  CHECK(frame(R"("low":5,"number":9,"whole":4660)") == both("low", "whole"));
  CHECK(frame(R"("high":5,"whole":4660)") == both("high", "whole"));
  // Of a line with data what that says is what was not edited.
  CHECK(frame(R"("number":0,"whole":513,"low":1,"high":2)", "000102") == "123#000102");
  CHECK(frame(R"("number":0,"whole":513,"low":7,"high":2)", "000102") == "123#000702");
  CHECK(frame(R"("number":0,"whole":772,"low":1,"high":2)", "000102") == "123#000403");
  CHECK(frame(R"("number":0,"whole":772,"low":4,"high":2)", "000102") == "123#000403");
  CHECK(frame(R"("number":0,"whole":5.13e2,"low":7,"high":8)", "000102") == "123#000708");
  CHECK(frame(R"("number":0,"whole":772,"low":7,"high":2)", "000102") == both("whole", "low"));
}

TEST_CASE("JSON lines: what contradicts itself or is none is refused in words", "[output]") {
  const auto wrong = [](std::string_view line, std::string_view part) {
    const std::string answer = frame_of(line);
    CAPTURE(line, answer);
    CHECK(has(answer, part));
  };
  wrong(replaced(gyroscope, "medium", "high"), "contradict");
  wrong(replaced(gyroscope, "\"topic\":\"gyroscope\"", "\"topic\":\"motors\""), "contradict");
  wrong(replaced(gyroscope, "\"frame\":\"gyroscope\"", "\"frame\":\"request\""), "contradict");
  wrong(replaced(gyroscope, "\"x\":0.0525", "\"w\":1"), "no field \"w\"; did you mean");
  wrong(replaced(gyroscope, "0.0525", "true"), "x takes");
  wrong(replaced(gyroscope, "0300FFFF0000", "0300"),
        "data of 2 bytes with fields of gyroscope; it has 6 bytes");
  wrong("{", "no JSON object in one line");
  wrong("[1]", "jq needs -c");
  wrong("{}", "neither id nor topic");
  wrong("{} x", "no JSON object");
  wrong(R"({"id":"608"})", "no data");
  wrong(R"({"id":"8FF","data":""})", "too large");
  wrong(R"({"id":"60","data":""})", "is not an identifier");
  wrong(R"({"id":"608","data":"0"})", "not hexadecimal");
  wrong(R"({"id":"608","data":"000102030405060708"})", "data of 9 bytes");
  wrong(R"({"id":"608","fd":{},"data":"000102030405060708"})", "data of 9 bytes; CAN FD has");
  wrong(R"({"id":"608","data":"R9"})", "no remote frame");
  wrong(R"({"id":"608","data":"R04"})", "no remote frame");
  wrong(R"({"id":"608","data":"Rx"})", "no remote frame");
  wrong(R"({"id":"608","data":"R4","fd":{}})", "no remote frame");
  wrong(R"({"id":"20000040","data":"R"})", "no remote frame");
  wrong(R"({"id":"608","data":"00","raw_dlc":9})", "raw_dlc");
  for (const std::string_view code : {"8", "16", "x"})
    wrong(R"({"id":"4FF","data":"0011223344556677","raw_dlc":)" + std::string{code} + "}", "raw_dlc");
  wrong(R"({"id":"4FF","fd":{},"data":"0011223344556677","raw_dlc":9})", "raw_dlc");
  wrong(R"({"id":"20000040","data":"0000000000000000","raw_dlc":9})", "raw_dlc");
  wrong(R"({"id":"608","data":"00","direction":"left"})", "received or sent");
  wrong(R"({"id":"608","data":"00","time_ns":"9223372036854775808"})", "is not a time");
  wrong(R"({"id":"608","data":"00","time_ns":"-9223372036854775809"})", "is not a time");
  wrong(R"({"topic":"gyr","fields":{}})", "did you mean 'gyro'");
  wrong(R"({"topic":"magnetometer","fields":{}})", "several frames; frame is one of: x, y, z");
  wrong(R"({"topic":"gyro","frame":"request","fields":{"mode":"publish","period":1e-7}})", "period");
  for (const std::string_view nothing : {"null", "true", "[5]"}) {
    wrong(fmt::format(R"({{"topic":"gyro","frame":"request","fields":{{"mode":"publish","period":{}}}}})",
                      nothing),
          "field \"period\" has no value");
    wrong(
        fmt::format(R"({{"topic":"gyro","frame":"request","fields":{{"mode":{},"mode":"stop"}}}})", nothing),
        "field \"mode\" has no value");
  }
  wrong(R"({"topic":"gyro","frame":"request","fields":{"mode":"publish","period":"5mm"}})", "such as 0.5");
  CHECK(frame_of(R"({"topic":"gyro","frame":"request","fields":{"mode":"publish","period":"500ms"}})") ==
        frame_of(R"({"topic":"gyro","frame":"request","fields":{"mode":"publish","period":0.5}})"));
  wrong(R"({"id":"4FF","fields":{"x":1},"data":"00"})", "of no topic");
}

TEST_CASE("JSON lines: what is given twice is refused, same or not", "[output]") {
  const auto twice = [](std::string_view line, std::string_view what) {
    const std::string answer = frame_of(line);
    CAPTURE(line, answer);
    CHECK(has(answer, fmt::format("{} is given twice; give it once", what)));
  };
  for (const std::string_view pair :
       {R"("time_ns":5)", R"("bus":"can0")", R"("id":"608")", R"("priority":"medium")",
        R"("topic":"gyroscope")", R"("frame":"gyroscope")", R"("data":"000000000000")",
        R"("direction":"sent")", R"("raw_dlc":9)", R"("fields":{})", R"("fd":{})"})
    twice(fmt::format("{{{},{}}}", pair, pair), fmt::format("key {}", pair.substr(0, pair.find(':'))));
  twice(R"({"topic":"gyro","topic":"accel","fields":{}})", R"(key "topic")");
  twice(R"({"id":null,"id":"201","data":""})", R"(key "id")");
  twice(R"({"id":"201","time_ns":[5],"time_ns":7,"data":""})", R"(key "time_ns")");
  twice(replaced(gyroscope, "\"x\":", "\"x\":1,\"x\":"), R"(field "x")");
  twice(replaced(gyroscope, "\"x\":0.0525", "\"x\":0.0525,\"x\":0.0525"), R"(field "x")");
  twice(R"({"topic":"gyro","fields":{"x":1,"y":1,"x":2}})", R"(field "x")");
  twice(R"({"topic":"gyro","frame":"request","fields":{"mode":"stop","mode":"publish"}})", R"(field "mode")");
  twice(R"({"topic":"gyro","frame":"request","fields":{"mode":"publish","period":1,"period":1}})",
        R"(field "period")");
  twice(R"({"id":"608","fd":{"brs":true,"brs":false},"data":""})", R"(key "brs")");
  twice(R"({"id":"608","fd":{"esi":true,"brs":false,"esi":true},"data":""})", R"(key "esi")");
  // A key that is not read may be there twice, and each line has its own.
  CHECK(has(frame_of(replaced(gyroscope, "{", R"({"note":1,"note":2,)")), "608#"));
  const auto log = log::testing::read_all<JsonLinesReader>(fmt::format("{}\n{}\n", gyroscope, gyroscope),
                                                           amiro::catalogue);
  CHECK(log.entries.size() == 2);
}

TEST_CASE("JSON lines: a line has as many fields as a frame has bits, and no more", "[output]") {
  const auto line = [](std::size_t fields) {
    std::string text;
    for (std::size_t i = 0; i < fields; ++i) text += (i == 0 ? "\"f" : ",\"f") + std::to_string(i) + "\":0";
    return R"({"id":"4FF","data":"","fields":{)" + text + "}}";
  };
  CHECK(has(frame_of(line(512)), "fields, but id 4FF is of no topic"));
  CHECK(frame_of(line(513)) == "more than 512 fields; a frame has at most 512 bits");
  CHECK(frame_of(line(0)) == "4FF#");
}

TEST_CASE("JSON lines: a line that is too long is one place, and the next one is read", "[output]") {
  const std::string text = R"({"id":"123","note":")" + std::string(2 * log::Input::longest, 'x') + "\"}\n" +
                           R"({"id":"123","data":"11"})" + "\n";
  const auto log = log::testing::read_all<JsonLinesReader>(text, amiro::catalogue);
  CHECK(log.entries.size() == 1);
  CHECK(log.complained == 1);
  REQUIRE(log.complaints.size() == 1);
  CHECK(log.complaints[0].cause == log::Cause::too_long);
}

TEST_CASE("JSON lines: a log that is cut or damaged anywhere gives entries that can exist", "[output]") {
  const std::string text = std::string{gyroscope} + "\n" + std::string{gyroscope} + "\n";
  for (std::size_t size = 0; size < text.size(); ++size) {
    const auto log = log::testing::read_all<JsonLinesReader>(text.substr(0, size), amiro::catalogue);
    const bool whole = size + 1 == gyroscope.size() + 1 || size + 1 == text.size();
    CHECK(log.complained == (size % (gyroscope.size() + 1) == 0 || whole ? 0U : 1U));
    for (const auto& complaint : log.complaints) CHECK(complaint.cause == log::Cause::cut_line);
    CHECK(log.entries.size() == (size + 1) / (gyroscope.size() + 1));
  }
  const auto whole = log::testing::read_all<JsonLinesReader>(R"({"id":"608","data":"0"})", amiro::catalogue);
  REQUIRE(whole.complained == 1);
  CHECK(whole.complaints[0].cause == log::Cause::syntax);  // its end is missing, and no more
  std::mt19937 random{5};
  for (int i = 0, runs = test::explored(20'000); i < runs; ++i) {
    std::string damaged = text;
    for (int flips = 0; flips < 3; ++flips)
      damaged[random() % damaged.size()] ^= static_cast<char>(1U << random() % 8);
    for (const auto& entry : log::testing::read_all<JsonLinesReader>(damaged, amiro::catalogue).entries)
      REQUIRE(log::testing::can_exist(entry));
  }
}

TEST_CASE("JSON lines: a line without a time has the time of the one before, and blank lines are none",
          "[output]") {
  const std::string text = std::string{gyroscope} + "\n\n \t\n" + R"({"id":"123","data":"R"})" + "\n";
  const auto log = log::testing::read_all<JsonLinesReader>(text, amiro::catalogue);
  CHECK(log.complained == 0);
  REQUIRE(log.entries.size() == 2);
  CHECK(log.entries[1].time == log.entries[0].time);
}

TEST_CASE("JSON lines: the earliest and the latest time of 64 bits", "[output]") {
  const std::string text = R"({"time_ns":"-9223372036854775808","id":"123","data":""})"
                           "\n"
                           R"({"time_ns":"9223372036854775807","id":"123","data":""})"
                           "\n";
  const auto log = log::testing::read_all<JsonLinesReader>(text, amiro::catalogue);
  REQUIRE(log.entries.size() == 2);
  CHECK(log.entries[0].time.time_since_epoch().count() == INT64_MIN);
  CHECK(log.entries[1].time.time_since_epoch().count() == INT64_MAX);
}

TEST_CASE(
    "JSON lines: topic, priority and frame beside the identifier agree with it, by any name of the topic",
    "[output]") {
  CHECK(frame_of(R"({"id":"608","topic":"gyro","data":"0300FFFF0000"})") == "608#0300FFFF0000");
  CHECK(frame_of(R"({"id":"608","priority":"medium","frame":"gyroscope","data":"0300FFFF0000"})") ==
        "608#0300FFFF0000");
  CHECK(frame_of(R"({"id":"208","topic":"gyro","priority":"medium","frame":"request","data":"01F40100"})") ==
        "208#01F40100");
  // Of no topic there is nothing that could contradict.
  CHECK(frame_of(R"({"id":"4FF","priority":"low","frame":"x","data":"11"})") == "4FF#11");
  const auto contradiction = [](std::string_view id, std::string_view key, std::string_view text) {
    CHECK(frame_of(fmt::format(R"({{"id":"{}","{}":"{}","data":"01"}})", id, key, text)) ==
          fmt::format("id {} and {} \"{}\" contradict each other; leave one of them out: jq 'del(.id)' makes "
                      "the id from topic, frame and priority",
                      id, key, text));
  };
  contradiction("608", "topic", "accel");
  contradiction("208", "topic", "accel");
  contradiction("608", "topic", "no such topic");
  contradiction("4FF", "topic", "gyro");
  contradiction("608", "priority", "urgent");
  contradiction("208", "priority", "low");
  contradiction("608", "frame", "request");
  contradiction("208", "frame", "gyroscope");
}

TEST_CASE("JSON lines: the largest identifiers, and what is none", "[output]") {
  CHECK(frame_of(R"({"id":"7FF","data":""})") == "7FF#");
  CHECK(frame_of(R"({"id":"1FFFFFFF","data":""})") == "1FFFFFFF#");
  for (const std::string_view id : {"800", "FFF", "40000000", "FFFFFFFF"})
    CHECK(frame_of(fmt::format(R"({{"id":"{}","data":""}})", id)) ==
          fmt::format("id \"{}\" is too large; 7FF is the largest of three digits, 1FFFFFFF of eight", id));
  for (const std::string_view id :
       {"\"\"", "\"60\"", "\"0608\"", "\"0000608\"", "\"000000608\"", "\"60G\"", "608"})
    CHECK(
        has(frame_of(fmt::format(R"({{"id":{},"data":""}})", id)),
            "is not an identifier; expected three hexadecimal digits, or eight for an extended identifier"));
}

TEST_CASE("JSON lines: a topic without an identifier says which frame, and with which priority", "[output]") {
  CHECK(frame_of(R"({"topic":"magnetometer","fields":{}})") ==
        "magnetometer has several frames; frame is one of: x, y, z");
  CHECK(frame_of(R"({"topic":"mag","frame":"w","fields":{}})") ==
        "magnetometer has no frame \"w\"; frame is one of: x, y, z");
  CHECK(frame_of(R"({"topic":"motors","frame":"request","fields":{}})") ==
        "motors has no frame \"request\"; frame is one of: motors");
  CHECK(frame_of(R"({"topic":"motors","priority":"first","fields":{}})") ==
        "no priority \"first\"; one of: urgent, high, medium, low");
  CHECK(frame_of(R"({"topic":"motors"})") == "no data; expected data, or fields of a topic");
  CHECK(frame_of(R"({"data":""})") == "neither id nor topic; give one of them");
  CHECK(frame_of(R"({"topic":"gyro","frame":"request","priority":"urgent","fields":{"mode":"once"}})") ==
        "008#02");
}

TEST_CASE("JSON lines: a remote frame asks for up to eight bytes, and has no fields", "[output]") {
  CHECK(frame_of(R"({"id":"608","data":"R","fields":{}})") == "608#R");
  CHECK(frame_of(R"({"id":"608","data":"R1"})") == "608#R1");
  CHECK(frame_of(R"({"id":"608","data":"R8"})") == "608#R8");
  CHECK(frame_of(R"({"id":"608","data":"R","fields":{"x":1}})") ==
        "fields, but id 608 is of no topic; leave them out, or name the robot's topics with --spec");
  CHECK(frame_of(R"({"id":"608","data":"R9"})") ==
        "data \"R9\" is no remote frame's; expected R or R0 to R8, with neither fd nor an error frame's id");
}

TEST_CASE("JSON lines: flags of CAN FD are those that are given", "[output]") {
  JsonLineParser parser{amiro::catalogue};
  const auto flags = [&parser](std::string_view fd) {
    log::Entry entry;
    std::string_view bus;
    REQUIRE(parser.parse(fmt::format(R"({{"id":"123",{}"data":"11"}})", fd), entry, bus));
    return int{entry.flags};
  };
  CHECK(flags(R"("fd":{"brs":true,"esi":true},)") ==
        (log::flag::fd | log::flag::bit_rate_switch | log::flag::error_state));
  CHECK(flags(R"("fd":{},)") == log::flag::fd);
  CHECK(flags(R"("fd":{"brs":true},)") == (log::flag::fd | log::flag::bit_rate_switch));
  CHECK(flags(R"("fd":{"esi":true,"brs":false},)") == (log::flag::fd | log::flag::error_state));
  CHECK(flags("") == 0);
  for (const std::string_view line :
       {R"({"id":"123","fd":{5},"data":"11"})", R"({"id":"123","fd":{"brs":true},)",
        R"({"id":"123","fd":{"brs":true "data":"11"}})", R"({"id":"123","fields":{"x"},"data":"11"})",
        R"({"id":"123","fields":{"x":1 "y":2},"data":"11"})", R"({"id":"123","fields":{"x":1,"data":"11"})"})
    CHECK(has(frame_of(line), "no JSON object in one line"));
  CHECK(frame_of(R"({"id":"123","fd":{"brs":1},"data":"11"})") ==
        R"("fd" has no flags; write "fd":{"brs":true,"esi":false}, or leave it out for a classic frame)");
  CHECK(frame_of(R"({"id":"123","fields":[],"data":"11"})") ==
        R"("fields" is no object; write "fields":{"x":0.1}, or leave it out)");
}

TEST_CASE("JSON lines: a line has nothing of the one before but its time", "[output]") {
  JsonLineParser parser{amiro::catalogue};
  log::Entry entry;
  std::string_view bus;
  REQUIRE(parser.parse(gyroscope, entry, bus));
  CHECK(bus == "can0");
  REQUIRE(parser.parse(R"({"id":"123","data":"1122"})", entry, bus));
  CHECK(entry == entry_of("123#1122"));
  CHECK(bus.empty());
  REQUIRE(
      parser.parse(R"({"id":"4FF","direction":"sent","raw_dlc":9,"data":"0011223344556677"})", entry, bus));
  CHECK(entry.direction == log::Direction::sent);
  CHECK(int{entry.raw_dlc} == 9);
  REQUIRE(parser.parse(R"({"id":"4FF","direction":"received","data":"0011223344556677"})", entry, bus));
  CHECK(entry.direction == log::Direction::received);
  CHECK(int{entry.raw_dlc} == 0);
  REQUIRE(parser.parse(R"({"id":"4FF","data":"0011223344556677"})", entry, bus));
  CHECK(entry == entry_of("4FF#0011223344556677"));
}

TEST_CASE(
    "JSON lines: a key that is not read is counted once a line, and nothing else is other than without it",
    "[output]") {
  JsonLineParser parser{amiro::catalogue};
  log::Entry entry;
  std::string_view bus;
  const std::string line = replaced(gyroscope, "{", R"({"note":1,"note":2,)");
  for (int i = 0; i < 3; ++i) {
    INFO(parser.problem().what);
    CHECK(parser.parse(line, entry, bus));
  }
  REQUIRE(parser.unknown_keys().size() == 1);
  CHECK(parser.unknown_keys()[0].name == "note");
  CHECK(parser.unknown_keys()[0].lines == 3);
  // What decode prints for people is none, and what is in "fd" may be one.
  CHECK(parser.parse(R"({"id":"123","data":"","units":0,"names":0,"error":0,"pgn":0,"source":0,)"
                     R"("destination":0,"transport":0,"message":0})",
                     entry, bus));
  CHECK(parser.unknown_keys().size() == 1);
  CHECK(parser.parse(R"({"id":"123","data":"","fd":{"who":true,"brs":true}})", entry, bus));
  REQUIRE(parser.unknown_keys().size() == 2);
  CHECK(parser.unknown_keys()[1].name == "who");
  CHECK(parser.unknown_keys()[1].lines == 1);
  CHECK(JsonLineParser::meant_by("time") == "time_ns");
  CHECK(JsonLineParser::meant_by("topics") == "topic");
  CHECK(JsonLineParser::meant_by("who").empty());
}

TEST_CASE("JSON lines: of keys that are not read the first 64 are known by name, and others are counted",
          "[output]") {
  std::string line = R"({"id":"123","data":"")";
  for (int i = 0; i < 66; ++i) line += fmt::format(R"(,"k{}":{})", i, i);
  line += '}';
  JsonLineParser parser{amiro::catalogue};
  log::Entry entry;
  std::string_view bus;
  for (std::uint64_t lines = 1; lines <= 2; ++lines) {
    REQUIRE(parser.parse(line, entry, bus));
    REQUIRE(parser.unknown_keys().size() == 64);
    CHECK(parser.unknown_keys().back().name == "k63");
    CHECK(parser.unknown_keys().back().lines == lines);
    CHECK(parser.more_unknown_keys() == 2 * lines);
  }
}

TEST_CASE("JSON lines: what a request's data says already stays, and else its fields count", "[output]") {
  const auto request = [](std::string_view fields, std::string_view data) {
    return frame_of(fmt::format(R"({{"id":"208","fields":{{{}}},"data":"{}"}})", fields, data));
  };
  CHECK(request(R"("mode":"publish","period":0.05)", "01") == "208#01");  // the gyroscope's own
  CHECK(request(R"("mode":"publish")", "01F40100") == "208#01F40100");
  CHECK(request(R"("mode":"publish","period":0.5)", "01") == "208#01F40100");
  CHECK(request(R"("mode":"stop","period":0.5)", "01F40100") == "208#00");
  CHECK(request(R"("mode":"stop","period":0.5)", "00") == "208#00");
  CHECK(request(R"("mode":"publish")", "00") == "208#01");
  const auto made = [](std::string_view fields) {
    return frame_of(fmt::format(R"({{"topic":"gyro","frame":"request","fields":{{{}}}}})", fields));
  };
  CHECK(made(R"("mode":"publish","period":65535)") == "208#01FFFF01");
  for (const std::string_view period : {"65536", "1e-7"})
    CHECK(made(fmt::format(R"("mode":"publish","period":{})", period)) ==
          fmt::format("period \"{}\" is none that a request has; write seconds or a time with its unit, such "
                      "as 0.5 or \"500ms\": 1 to 65535 us, ms or s",
                      period));
  for (const std::string_view mode : {"once", "stop"})
    CHECK(made(fmt::format(R"("mode":"{}","period":1)", mode)) ==
          fmt::format("a period with mode {}; only publish has one; leave it out", mode));
  CHECK(made(R"("mode":"dance")") == R"(mode "dance"; one of: stop, publish, once)");
  CHECK(made(R"("period":1)") == R"(mode ""; one of: stop, publish, once)");
  CHECK(made(R"("mode":"stop","x":1)") == R"(no field "x"; a request has mode and period)");
  CHECK(made(R"("mode":null)") == R"(field "mode" has no value; one of: stop, publish, once)");
  CHECK(made(R"("mode":"publish","period":null)") ==
        R"(field "period" has no value; write seconds, or a time such as "500ms")");
}

TEST_CASE("JSON lines: what is derived is what the data or the edited field says, or is refused",
          "[output]") {
  // Sensor 4 sees 377 counts above its offset, 2350, and so something 50 mm away; sensor 1 nothing.
  const auto ring = [](std::string_view fields) {
    return frame_of(fmt::format(R"({{"id":"622","data":"A70A","fields":{{{}}}}})", fields));
  };
  const auto refused = [](std::string_view name) {
    return fmt::format(
        "\"{}\" is not what proximity says, of which it is derived; edit proximity, and leave {} out", name,
        name);
  };
  CHECK(ring(R"("proximity":2727,"distance":0.05001,"distance_uncertainty":0.0003)") == "622#A70A");
  CHECK(ring(R"("distance":0.05001,"proximity":2726)") == "622#A60A");
  CHECK(ring(R"("distance":0.04)") == refused("distance"));
  CHECK(ring(R"("distance_uncertainty":0.05001)") == refused("distance_uncertainty"));
  CHECK(ring(R"("proximity":2726,"distance":0.04)") == refused("distance"));
  CHECK(ring(R"("distance":"near")") == refused("distance"));
  CHECK(frame_of(R"({"id":"61F","data":"F108","fields":{"proximity":2289,"distance":1}})") ==
        refused("distance"));
  // Without data it is what the frame says now.
  CHECK(frame_of(R"({"topic":"ring","frame":"sensor_4","fields":{"distance":0.05001,"proximity":2727}})") ==
        "622#A70A");
  CHECK(frame_of(R"({"topic":"ring","frame":"sensor_4","fields":{"distance":0.05}})") == refused("distance"));
}

TEST_CASE("JSON lines: a value that is none says what the field takes, and what else can be done",
          "[output]") {
  CHECK(frame_of(R"({"topic":"motors","fields":{"x":5}})") ==
        "'5' is out of range: x takes -1 to 1 m/s; write a value in its range");
  CHECK(frame_of(R"({"id":"201","data":"0000000000000000","fields":{"x":5}})") ==
        "'5' is out of range: x takes -1 to 1 m/s; leave the field out, and data counts");
  CHECK(frame_of(R"({"topic":"motors","fields":{"x":true}})") ==
        "field \"x\" has no value; x takes -1 to 1 m/s; write a number or a string");
  // Of a count there is no fraction, as a number and as a text.
  for (const std::string value : {"1.5", "\"1.5\"", "15e-1"})
    CHECK_THAT(frame_of(R"({"topic":"led_1","fields":{"red":)" + value + "}}"),
               Catch::Contains("1") &&
                   Catch::Contains("is no whole number: red takes 0 to 255; write a value in its range"));
  CHECK_THAT(frame_of(R"({"topic":"led_1","fields":{"red":-0.4}})"), Catch::Contains("'-0.4'"));
  CHECK_THAT(
      frame_of(R"({"topic":"led_1","fields":{"red":1.5},"data":"000000"})"),
      Catch::Contains("'1.5' is no whole number: red takes 0 to 255; leave the field out, and data counts"));
  CHECK(frame_of(R"({"topic":"led_1","fields":{"red":2.0}})") ==
        frame_of(R"({"topic":"led_1","fields":{"red":2}})"));
}

/// A message of a byte, of which 10 to 20 are stated, and one without fields.
struct Stated {
  explicit Stated(std::uint16_t length = 1, bool fd = false, bool bit_rate_switch = true) {
    level.name = "level";
    level.position = {0, 8, protocol::ByteOrder::little};
    level.raw_max = 255;
    level.min = {10, 0};
    level.max = {20, 0};
    layouts[0].length = length;
    layouts[0].fields = {&level, 1};
    layouts[0].address = {protocol::Address::By::identifier, fd, fd ? 0x12345678U : 0x123U};
    layouts[0].fd = fd;
    layouts[0].bit_rate_switch = bit_rate_switch;
    layouts[1].address = {protocol::Address::By::identifier, false, 0x124};
    for (std::size_t i = 0; i < topics.size(); ++i) {
      topics[i].name = i == 0 ? "M" : "Empty";
      topics[i].kind = protocol::Kind::message;
      topics[i].frames = {&layouts[i], 1};
    }
    catalogue.topics = topics;
  }
  Stated(const Stated&) = delete;
  Stated& operator=(const Stated&) = delete;
  [[nodiscard]] std::string frame(std::string_view line, cli::logs::Values values) const {
    JsonLineParser parser{catalogue, values};
    log::Entry entry;
    std::string_view bus;
    if (!parser.parse(line, entry, bus)) return parser.problem().what + "; " + parser.problem().remedy;
    return std::string{can::to_text(entry.classic().value()).view()};
  }

  protocol::Field level;
  std::array<protocol::FrameLayout, 2> layouts;
  std::array<protocol::Topic, 2> topics;
  protocol::Catalogue catalogue;
};

TEST_CASE("JSON lines: a value beyond the stated range is refused to who asks for that, if it was edited",
          "[output]") {
  using cli::logs::Values;
  const Stated spec;
  const auto beyond = [](std::string_view value) {
    return fmt::format(
        "'{}' is beyond the stated range: level takes 10 to 20; many stated ranges are wrong: "
        "--force takes what the bits can hold",
        value);
  };
  const auto made = [&spec](int level, Values values) {
    return spec.frame(fmt::format(R"({{"topic":"M","fields":{{"level":{}}}}})", level), values);
  };
  CHECK(made(10, Values::as_stated) == "123#0A");
  CHECK(made(20, Values::as_stated) == "123#14");
  CHECK(made(9, Values::as_stated) == beyond("9"));
  CHECK(made(21, Values::as_stated) == beyond("21"));
  CHECK(made(21, Values::of_bits) == "123#15");
  const auto edited = [&spec](std::string_view level) {
    return spec.frame(fmt::format(R"({{"id":"123","data":"FF","fields":{{"level":{}}}}})", level),
                      Values::as_stated);
  };
  CHECK(edited("255") == "123#FF");
  CHECK(edited("2.55e2") == "123#FF");
  CHECK(edited("20") == "123#14");
  CHECK(edited("254") == beyond("254"));
}

TEST_CASE("JSON lines: a message by its name, with the frame that it has", "[output]") {
  using cli::logs::Values;
  const Stated spec;
  CHECK(spec.frame(R"({"topic":"M","frame":"M","fields":{"level":12}})", Values::of_bits) == "123#0C");
  CHECK(spec.frame(R"({"topic":"M","frame":"N","fields":{}})", Values::of_bits) ==
        R"(M has no frame "N"; frame is M)");
  CHECK(spec.frame(R"({"topic":"Empty","fields":{}})", Values::of_bits) == "124#");
  CHECK(spec.frame(R"({"topic":"Empty","fields":{"a":1}})", Values::of_bits) ==
        R"(no field "a"; the frame has none)");
  for (const bool bit_rate_switch : {false, true})
    for (const auto& [length, bytes] : {std::pair{1, 1}, {8, 8}, {9, 12}, {33, 48}}) {
      CAPTURE(bit_rate_switch, length);
      const Stated wide{static_cast<std::uint16_t>(length), true, bit_rate_switch};
      JsonLineParser parser{wide.catalogue};
      log::Entry entry;
      std::string_view bus;
      REQUIRE(parser.parse(R"({"topic":"M","fields":{"level":12}})", entry, bus));
      CHECK(entry.id == 0x12345678);
      CHECK(entry.format == can::Format::extended);
      CHECK(int{entry.length} == bytes);
      CHECK(int{entry.flags} == (log::flag::fd | (bit_rate_switch ? log::flag::bit_rate_switch : 0)));
    }
}

TEST_CASE("JSON lines: a file is one if its first line is an object with a key that decode prints",
          "[output]") {
  for (const std::string_view file : {R"({"id":"123"})", R"({"fields":{}})", R"({"data":""})",
                                      " \t\r\n{\"time_ns\":5,\"data\":\"\"}\n{", R"({ "id" )"})
    CHECK(JsonLinesReader::recognises(file));
  for (const std::string_view file : {"", " \n", R"(["id"])", R"("id")", R"({"time_ns":5})", R"({"ids":5})",
                                      "{\"time_ns\":5}\n{\"id\":\"123\"}"})
    CHECK_FALSE(JsonLinesReader::recognises(file));
}

}  // namespace tool_output_json_lines_test
