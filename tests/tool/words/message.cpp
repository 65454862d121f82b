// set with plain messages: what is not given is at its start value, selectors follow, ranges are reported.
#include "cli/words/message.hpp"

#include <array>
#include <initializer_list>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/can/any_text.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/words/command.hpp"

namespace tool_words_message_test {

using namespace ocm;
using namespace ocm::cli::words;
using protocol::ByteOrder;
using protocol::Field;
using protocol::NamedValue;
using protocol::no_selector;
using protocol::SelectorRange;

constexpr NamedValue gears[] = {{0, "neutral"}, {1, "first"}, {7, "broken"}};
constexpr SelectorRange page_1[] = {{1, 1}};
constexpr SelectorRange pages_2_to_3[] = {{2, 3}};
constexpr SelectorRange inner_5[] = {{5, 5}};

constexpr Field field(std::string_view name, protocol::Position position, bool is_signed = false) {
  Field field;
  field.name = name;
  field.position = position;
  field.is_signed = is_signed;
  field.raw_min = protocol::lowest(position.width, is_signed);
  field.raw_max = protocol::highest(position.width, is_signed);
  return field;
}

constexpr std::array<Field, 4> engine_fields = [] {
  std::array<Field, 4> fields{
      field("rpm", {0, 16, ByteOrder::little}), field("gear", {16, 3, ByteOrder::little}),
      field("heat", {24, 8, ByteOrder::little}, true), field("torque", {32, 32, ByteOrder::little})};
  fields[0].scale = {25, -2};
  fields[0].unit = "rpm";
  fields[0].min = {0, 0};
  fields[0].max = {3000, 0};
  fields[1].values = gears;
  fields[1].max = {2, 0};
  fields[2].offset = {-40, 0};
  fields[2].start = 40;  // 0 degrees
  fields[3].number = protocol::Number::float32;
  return fields;
}();

constexpr std::array<Field, 5> paged_fields = [] {
  std::array<Field, 5> fields{field("page", {0, 8, ByteOrder::little}), field("a", {8, 8, ByteOrder::little}),
                              field("inner", {8, 4, ByteOrder::little}),
                              field("b", {16, 8, ByteOrder::little}),
                              field("always", {24, 8, ByteOrder::little})};
  fields[1].selector = 0;
  fields[1].selected = page_1;
  fields[2].selector = 0;
  fields[2].selected = pages_2_to_3;
  fields[3].selector = 2;
  fields[3].selected = inner_5;
  fields[1].start = 0x11;
  fields[4].start = 0x44;
  return fields;
}();

// A byte, two parts of it, and what lies behind the message's bytes; the parts are before it and behind it.
constexpr std::array<Field, 4> shared_fields{
    field("low", {0, 4, ByteOrder::little}), field("whole", {0, 8, ByteOrder::little}, true),
    field("top", {7, 1, ByteOrder::little}), field("beyond", {4, 8, ByteOrder::little})};

constexpr protocol::FrameLayout layout(std::span<const Field> fields, std::uint32_t identifier, bool extended,
                                       std::uint16_t length) {
  protocol::FrameLayout layout;
  layout.length = length;
  layout.fields = fields;
  layout.address = {protocol::Address::By::identifier, extended, identifier};
  return layout;
}

constexpr std::array engine_frames{layout(engine_fields, 0x100, false, 8)};
constexpr std::array paged_frames{layout(paged_fields, 0x18FEF100, true, 5)};
constexpr std::array shared_frames{layout(shared_fields, 0x400, false, 1)};
constexpr std::array long_frames{layout({}, 0x200, false, 64)};

constexpr std::array<Field, 2> radar_fields{field("first", {0, 8, ByteOrder::little}),
                                            field("last", {72, 8, ByteOrder::little})};
constexpr std::array radar_frames{[] {
  protocol::FrameLayout radar = layout(radar_fields, 0x300, false, 10);
  radar.fd = true;
  return radar;
}()};

constexpr std::array slow_radar_frames{[] {
  protocol::FrameLayout radar = radar_frames[0];
  radar.address.number = 0x301;
  radar.bit_rate_switch = false;
  return radar;
}()};

constexpr protocol::Topic message(std::string_view name, std::span<const protocol::FrameLayout> frames) {
  protocol::Topic topic;
  topic.name = name;
  topic.kind = protocol::Kind::message;
  topic.board = protocol::no_board;
  topic.frames = frames;
  return topic;
}

constexpr std::array topics{message("Engine", engine_frames),
                            message("Paged", paged_frames),
                            message("Long", long_frames),
                            message("Radar", radar_frames),
                            message("SlowRadar", slow_radar_frames),
                            message("Shared", shared_frames)};
constexpr protocol::Catalogue catalogue{"car", 500'000, {}, topics};

auto parse(const std::string& line) {
  std::vector<std::string_view> words;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(' ', begin), line.size());
    words.push_back(std::string_view{line}.substr(begin, end - begin));
    begin = end + 1;
  }
  return CommandParser{catalogue}.parse_line(words);
}

std::string frame(const std::string& line) {
  const auto command = parse(line);
  INFO(line << ": " << command.error.what);
  REQUIRE(command.ok());
  REQUIRE(command->frames.size() == 1);
  return std::string{can::to_text(command->frames[0]).view()};
}

TEST_CASE("a message is sent with physical values, and start values for the rest") {
  CHECK(frame("set Engine rpm=2500") == "100#1027002800000000");  // 2500 / 0.25 = 0x2710; heat starts at 40
  CHECK(frame("set Engine rpm=2500rpm heat=-40") == "100#1027000000000000");
  CHECK(frame("set Engine gear=first heat=87") == "100#0000017F00000000");
  CHECK(frame("set Engine gear=broken") == "100#0000072800000000");  // named, though beyond the stated range
  CHECK(frame("set Engine torque=1.5") == "100#000000280000C03F");   // IEEE 754: 3FC00000
  CHECK(frame("set Engine torque=-Infinity") == "100#00000028000080FF");
}

TEST_CASE("a message of CAN FD is sent as one, filled up to a length that there is") {
  const auto command = parse("set Radar last=255 first=1");
  REQUIRE(command.ok());
  CHECK(command->frames.empty());
  REQUIRE(command->fd_frames.size() == 1);
  CHECK(can::validate(command->fd_frames[0]).ok());
  CHECK(can::to_text(command->fd_frames[0]).view() == "300##1010000000000000000FF0000");  // 10 bytes: 12
  std::size_t count = 0;
  command->each_frame([&](const can::AnyFrame& each) { count += each == command->fd_frames[0] ? 1 : 0; });
  CHECK(count == 1);
  const auto slow = parse("set SlowRadar first=1");
  REQUIRE(slow.ok());
  CHECK(can::to_text(slow->fd_frames[0]).view() == "301##0010000000000000000000000");  // one bit rate
}

TEST_CASE("a selector that is not given follows the fields that are") {
  CHECK(frame("set Paged a=3") == "18FEF100#0103004400");
  CHECK(frame("set Paged page=1") == "18FEF100#0111004400");  // a at its start
  CHECK(frame("set Paged page=9") == "18FEF100#0900004400");
  CHECK(frame("set Paged b=7") == "18FEF100#0205074400");  // the first page with inner, inner=5
  CHECK(frame("set Paged page=3 b=7") == "18FEF100#0305074400");
  CHECK(frame("set Paged inner=4 always=0") == "18FEF100#0204000000");
}

struct Row {
  std::string line;
  std::size_t word;
  std::string what;
};
void check_refusals(std::initializer_list<Row> rows) {
  for (const Row& row : rows) {
    const auto command = parse(row.line);
    INFO(row.line << ": " << command.error.what);
    CHECK_FALSE(command.ok());
    CHECK(command.error.word == row.word);
    CHECK(command.error.what == row.what);
    CHECK_FALSE(command.error.remedy.empty());
  }
}

TEST_CASE("fields that are never in one frame are refused at the word") {
  check_refusals({
      {"set Paged page=2 a=1", 3, "a is there only with page=1"},
      {"set Paged a=1 inner=1", 3, "inner is there only with page=2 to 3"},
      {"set Paged inner=4 b=1", 3, "b is there only with inner=5"},
      {"set Engine rpm=3000.25", 2, "'3000.25' is beyond the stated range: rpm takes 0 to 3000 rpm"},
      {"set Engine rpm=20000", 2, "'20000' is out of range: rpm takes 0 to 3000 rpm"},
      {"set Engine rpm=20000 --force", 2, "'20000' is out of range: rpm takes 0 to 16383.75 rpm"},
      {"set Engine gear=5", 2,
       "'5' is beyond the stated range: gear takes neutral, first, broken, or 0 to 2"},
      {"set Engine heat=88", 2, "'88' is out of range: heat takes -168 to 87"},
      {"set Engine torque=1e39", 2, "'1e39' is out of range: torque takes any number"},
      {"set Engine speed=1", 2, "Engine has no field 'speed'"},
      {"set Engine rpm=1 rpm=2", 3, "field 'rpm' is given twice"},
      {"set Engine rpm", 2, "'rpm' is not of the form FIELD=VALUE"},
      {"set Long a=1", 2, "Long has no field 'a'"},
      {"set Engine rpm=1 --priority high", 0, "a message carries its priority in its identifier"},
      {"publish Engine 1s", 1, "'Engine' is a message"},
      {"stop Engine", 1, "'Engine' is a message"},
  });
  CHECK(parse("set Paged page=2 a=1").error.remedy == "give fields that are in one frame, or leave page out");
  CHECK(parse("set Paged a=1 inner=1").error.remedy ==
        "give fields that are in one frame");                                // page is not given
  CHECK(frame("set Engine rpm=3000.25 --force") == "100#E12E002800000000");  // 12001 quarters
  CHECK(compose(topics[2], {}).error.what == "Long is a message of 64 bytes");
  // The transport protocol of J1939 has an end, too, and CAN FD is no remedy.
  protocol::FrameLayout group = layout({}, 0x18FEEC00, true, 1786);
  group.address.by = protocol::Address::By::pgn;
  protocol::Topic identification = topics[2];
  identification.frames = {&group, 1};
  CHECK(compose(identification, {}).error.what == "Long is a message of 1786 bytes of J1939");
  CHECK(compose(identification, {}).error.remedy.find("FD") == std::string::npos);
}

TEST_CASE("a message of J1939 with more than eight bytes is a broadcast") {
  // As long as a vehicle identification: 7, 7 and 3 bytes. [SAE J1939-21, 5.10.3.5]
  std::array<Field, 2> fields{field("first", {0, 8, ByteOrder::little}),
                              field("last", {128, 8, ByteOrder::little})};
  protocol::FrameLayout group = layout(fields, 0x18FEEC2A, true, 17);
  group.address.by = protocol::Address::By::pgn;
  protocol::Topic vehicle = topics[2];
  vehicle.name = "Vehicle";
  vehicle.frames = {&group, 1};
  const protocol::Catalogue truck{"truck", 250'000, {}, {&vehicle, 1}};
  const auto parsed = [&](std::vector<std::string_view> words) {
    return CommandParser{truck}.parse_line(words);
  };
  const auto command = parsed({"set", "Vehicle", "first=0x31", "last=0x39"});
  REQUIRE(command.ok());
  REQUIRE(command->broadcast);
  CHECK((command->frames.empty() && command->fd_frames.empty()));
  CHECK(command->broadcast->message == &vehicle);
  std::vector<std::string> frames;
  command->each_frame([&](const can::AnyFrame& frame) {
    CHECK(can::validate(frame).ok());
    frames.emplace_back(can::to_text(frame).view());
  });
  CHECK(frames == std::vector<std::string>{"1CECFF2A#20110003FFECFE00", "1CEBFF2A#0131000000000000",
                                           "1CEBFF2A#0200000000000000", "1CEBFF2A#03000039FFFFFFFF"});
  // Four frames, 50 ms apart, and as much before the next.
  CHECK(parsed({"set", "Vehicle", "--every", "200ms"}).ok());
  const auto hasty = parsed({"set", "Vehicle", "--every", "199ms"});
  CHECK(hasty.error.what == "--every 199ms is shorter than a broadcast of Vehicle takes");
  CHECK(hasty.error.remedy == "it has 4 frames, 50ms apart: --every 200ms or longer");
}

TEST_CASE("a field that lies over others is sent as it is given, wherever it is in the file") {
  CHECK(frame("set Shared") == "400#00");
  CHECK(frame("set Shared low=3") == "400#03");
  CHECK(frame("set Shared top=1") == "400#80");
  CHECK(frame("set Shared whole=-2") == "400#FE");
  CHECK(frame("set Shared low=3 top=1") == "400#83");
  CHECK(frame("set Shared whole=-125 low=3 top=1") == "400#83");  // 0x83: all three are true
  check_refusals({
      {"set Shared whole=3 low=4", 3, "low and whole have bits in common, and cannot be what both are given"},
      {"set Shared low=4 whole=3", 3, "low and whole have bits in common, and cannot be what both are given"},
      {"set Shared top=1 whole=1 low=1", 3,
       "whole and top have bits in common, and cannot be what both are given"},
      {"set Shared low=1 beyond=0", 3, "beyond ends in byte 1 of Shared, which is sent with 1 byte"},
  });
}

TEST_CASE("a message without fields, or with all at their start values, is sent as it is named") {
  CHECK(frame("set Engine") == frame("set Engine torque=0"));
}

TEST_CASE("a mistyped name of a value is met by the near one, whatever its case") {
  for (const char* word : {"Neutral", "neutrel", "NEUTRAL"}) {
    const auto command = parse("set Engine gear=" + std::string{word});
    CHECK(command.error.what == "'" + std::string{word} +
                                    "' has no meaning: did you mean 'neutral'? gear takes "
                                    "neutral, first, broken, or 0 to 2");
  }
  CHECK(parse("set Engine gear=xyz").error.what ==
        "'xyz' has no meaning: gear takes neutral, first, broken, or 0 to 2");
}

TEST_CASE("a message is sent again and again with --every") {
  using namespace std::chrono_literals;
  const auto command = parse("set Engine rpm=1 --every 10ms --for=2s");
  REQUIRE(command.ok());
  REQUIRE(command->repeat.has_value());
  CHECK(command->repeat->period == 10ms);
  CHECK(command->repeat->lasting == 2s);
  CHECK(parse("set Engine rpm=1 --every 10ms")->repeat->lasting == 0s);
  CHECK_FALSE(parse("set Engine rpm=1")->repeat.has_value());
}

TEST_CASE("a message of any length that its kind of frame has is composed, and none of one byte more") {
  const auto composes = [](bool fd, protocol::Address::By by, std::uint16_t length) {
    protocol::FrameLayout one = layout({}, 0x18FEEC00, true, length);
    one.fd = fd;
    one.address.by = by;
    protocol::Topic topic = topics[2];
    topic.frames = {&one, 1};
    const auto bytes = compose(topic, {});
    return bytes.ok() ? std::to_string(bytes->size()) : bytes.error.what + "; " + bytes.error.remedy;
  };
  using By = protocol::Address::By;
  CHECK(composes(false, By::identifier, 8) == "8");
  CHECK(composes(false, By::identifier, 9) ==
        "Long is a message of 9 bytes; a classic frame has 8 bytes at most; state CAN FD in the spec");
  CHECK(composes(true, By::identifier, 64) == "64");
  CHECK(composes(true, By::identifier, 65) ==
        "Long is a message of 65 bytes in CAN FD; a frame of CAN FD has 64 bytes at most");
  CHECK(composes(false, By::pgn, 8) == "8");
  CHECK(composes(false, By::pgn, 1785) == "1785");
  CHECK(composes(false, By::pgn, 1786) ==
        "Long is a message of 1786 bytes of J1939; its transport protocol takes 1785 bytes at most");
}

TEST_CASE("a stated range has its ends, of floats too, and all names of values") {
  Field real = field("r", {0, 32, ByteOrder::little});
  real.number = protocol::Number::float32;
  const auto raw = [&real](double value) { return *real.float_from(value); };
  CHECK(is_in_stated_range(real, raw(1e30)));  // none is stated
  real.min = {-1, 0};
  real.max = {25, -1};
  for (const double value : {-1.0, 0.0, 2.5}) CHECK(is_in_stated_range(real, raw(value)));
  for (const double value : {-1.0625, 2.5625, std::numeric_limits<double>::quiet_NaN()})
    CHECK_FALSE(is_in_stated_range(real, raw(value)));
  Field whole = field("w", {0, 8, ByteOrder::little});
  whole.scale = {5, -1};
  whole.min = {1, 0};
  whole.max = {10, 0};
  whole.values = gears;
  for (const int value : {0, 1, 2, 7, 20}) CHECK(is_in_stated_range(whole, value));
  for (const int value : {21, 255}) CHECK_FALSE(is_in_stated_range(whole, value));
}

TEST_CASE("the bits of a selector are its number, and are said by its names") {
  Field selector = field("gear", {0, 4, ByteOrder::little}, true);
  CHECK(detail::bits_of(selector, -1) == 0xF);
  CHECK(detail::raw_of(selector, 0xF) == -1);
  CHECK(detail::raw_of(selector, 0x7) == 7);
  selector.values = gears;
  Field chosen = field("speed", {8, 8, ByteOrder::little});
  constexpr SelectorRange some[] = {{1, 1}, {5, 7}, {0xF, 0xF}};
  chosen.selected = some;
  CHECK(detail::presence(chosen, selector) == "speed is there only with gear=first, 5 to broken, -1");
  selector.is_signed = false;
  CHECK(detail::raw_of(selector, 0xF) == 15);
  selector.values = {};
  selector.scale = {2, 0};
  CHECK(detail::presence(chosen, selector) == "speed is there only with gear=2, 10 to 14, 30");
  for (const std::uint64_t bits : {1U, 5U, 6U, 7U, 15U}) CHECK(detail::selects(chosen, bits));
  for (const std::uint64_t bits : {0U, 2U, 4U, 8U, 14U, 16U}) CHECK_FALSE(detail::selects(chosen, bits));
  const Field word = field("word", {0, 64, ByteOrder::little});
  CHECK(detail::bits_of(word, -1) == UINT64_MAX);
  CHECK(detail::raw_of(word, UINT64_MAX) == -1);
}

}  // namespace tool_words_message_test
