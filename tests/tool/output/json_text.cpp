#include "cli/output/json_text.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/client/sample.hpp"
#include "ocm/j1939/transport.hpp"
#include "ocm/log/bytes.hpp"
#include "ocm/protocol/topic.hpp"

#include "tests/tool/output/rooms.hpp"

namespace tool_output_json_text_test {

using namespace ocm;
using protocol::Field;

Field field(std::string_view name, unsigned first_bit, unsigned width) {
  Field made;
  made.name = name;
  made.position = {static_cast<std::uint16_t>(first_bit), static_cast<std::uint8_t>(width),
                   protocol::ByteOrder::little};
  made.raw_max = protocol::highest(width, false);
  return made;
}

/// A message of eight bytes, or as many as are given, with these fields.
class Message {
 public:
  explicit Message(std::vector<Field> fields,
                   protocol::Address address = {protocol::Address::By::identifier, false, 0x123},
                   std::uint16_t length = 8)
      : fields_(std::move(fields)) {
    layout_.length = length;
    layout_.fields = fields_;
    layout_.address = address;
    topic_.name = "Message";
    topic_.kind = protocol::Kind::message;
    topic_.frames = {&layout_, 1};
    catalogue_.topics = {&topic_, 1};
  }

  [[nodiscard]] const protocol::FrameLayout& layout() const noexcept { return layout_; }
  [[nodiscard]] const protocol::Catalogue& catalogue() const noexcept { return catalogue_; }

 private:
  std::vector<Field> fields_;
  protocol::FrameLayout layout_;
  protocol::Topic topic_;
  protocol::Catalogue catalogue_;
};

log::Entry entry_of(std::uint64_t data) {
  log::Entry entry;
  entry.id = 0x123;
  entry.length = 8;
  for (std::size_t i = 0; i < 8; ++i) entry.data[i] = static_cast<std::uint8_t>(data >> 8 * i);
  return entry;
}

std::string line_of(cli::JsonText& text, const log::Entry& entry) {
  log::Bytes out;
  text.write(out, "can0", entry);
  return std::string{out.view()};
}

TEST_CASE("JSON text: any time, whatever came before it", "[output]") {
  constexpr std::int64_t second = 1'000'000'000;
  const Message message{{field("a", 0, 8)}};
  cli::JsonText text{message.catalogue()};
  const std::array<std::int64_t, 16> times{0,
                                           7,
                                           second - 1,
                                           second,
                                           second + 1,
                                           -second - 1,
                                           second + 10'000'000,
                                           2 * second - 1,
                                           2 * second,
                                           -1,
                                           2 * second,
                                           10 * second,
                                           1'436'509'052'000'000'001,
                                           1'436'509'052'999'999'999,
                                           std::numeric_limits<std::int64_t>::max(),
                                           std::numeric_limits<std::int64_t>::min()};
  for (const std::int64_t first : times)
    for (const std::int64_t then : times)
      for (const std::int64_t ns : {first, then}) {
        log::Entry entry = entry_of(0);
        entry.time = base::Time{base::Duration{ns}};
        const std::string begin = R"({"time_ns":")" + std::to_string(ns) + R"(","bus":"can0","id":"123",)";
        REQUIRE(line_of(text, entry).substr(0, begin.size()) == begin);
      }
}

TEST_CASE("JSON text: an identifier has eight digits or three, and that of J1939 what it says in words, too",
          "[output]") {
  using protocol::Address;
  const auto line = [](Address address, std::uint32_t id) {
    const Message message{{field("a", 0, 8)}, address};
    cli::JsonText text{message.catalogue()};
    log::Entry entry = entry_of(0);
    entry.id = id;
    entry.format = address.extended ? can::Format::extended : can::Format::base;
    return line_of(text, entry);
  };
  using Catch::Contains;
  CHECK_THAT(line({Address::By::identifier, false, 0x7A5}, 0x7A5), Contains(R"("id":"7A5","topic":)"));
  CHECK_THAT(line({Address::By::identifier, true, 0x1234'5678}, 0x1234'5678),
             Contains(R"("id":"12345678","topic":)"));
  CHECK_THAT(line({Address::By::identifier, true, 0x7A5}, 0x7A5), Contains(R"("id":"000007A5","topic":)"));
  CHECK_THAT(line({Address::By::pgn, true, 0x18FE'EC00}, 0x0CFE'EC05),
             Contains(R"("id":"0CFEEC05","priority":3,"pgn":"0FEEC","source":5,"destination":255,"topic":)"));
  CHECK_THAT(line({Address::By::pgn, true, 0x18EF'0000}, 0x18EF'2103),
             Contains(R"("id":"18EF2103","priority":6,"pgn":"0EF00","source":3,"destination":33,"topic":)"));
}

TEST_CASE("JSON text: a line has the fields that its frame has, of pages in any order", "[output]") {
  // Pages of a selector and of one within a page, some of several ranges, one beside the other as often as
  // not.
  using protocol::SelectorRange;
  static constexpr std::array<SelectorRange, 1> zero{{{0, 0}}}, one{{{1, 1}}};
  static constexpr std::array<SelectorRange, 2> some{{{1, 1}, {3, 3}}};
  const std::array<std::span<const SelectorRange>, 3> pages{zero, one, some};
  const std::array<std::string_view, 24> names{"f00", "f01", "f02", "f03", "f04", "f05", "f06", "f07",
                                               "f08", "f09", "f10", "f11", "f12", "f13", "f14", "f15",
                                               "f16", "f17", "f18", "f19", "f20", "f21", "f22", "f23"};
  std::mt19937 random{11};
  for (int round = 0; round < 50; ++round) {
    std::vector<Field> fields{field("outer", 0, 2), field("inner", 2, 2)};
    fields[1].selector = 0;
    fields[1].selected = some;
    for (const std::string_view name : names) {
      Field& made = fields.emplace_back(field(name, 4 + static_cast<unsigned>(random() % 56), 4));
      if (random() % 4 != 0) {
        made.selector = static_cast<std::uint16_t>(random() % 2);
        made.selected = pages[random() % pages.size()];
      }
    }
    const Message message{fields};
    cli::JsonText text{message.catalogue()};
    for (int frame = 0; frame < 50; ++frame) {
      const log::Entry entry = entry_of(random() | std::uint64_t{random()} << 32);
      const std::string line = line_of(text, entry);
      const auto units = line.find("\"units\"");
      REQUIRE(units != std::string::npos);
      for (const Field& each : message.layout().fields) {
        const std::string key = '"' + std::string{each.name} + "\":";
        CAPTURE(line, each.name);
        const auto at = line.find(key);
        REQUIRE((at != std::string::npos) == message.layout().has(each, entry.bytes()));
        REQUIRE((line.find(key, units) != std::string::npos) == (at < units));
      }
    }
  }
}

TEST_CASE("JSON text: names of values that lie together, apart, below zero and beyond the field",
          "[output]") {
  using protocol::NamedValue;
  static constexpr std::array<NamedValue, 2> together{{{0, "off"}, {1, "on"}}};
  static constexpr std::array<NamedValue, 2> apart{{{3, "few"}, {250, "many"}}};
  static constexpr std::array<NamedValue, 2> below{{{-1, "wrong"}, {2, "two"}}};
  static constexpr std::array<NamedValue, 2> beyond{{{1, "one"}, {9, "nine"}}};
  std::vector<Field> fields{field("a", 0, 8), field("b", 8, 8), field("c", 16, 8), field("d", 24, 4)};
  fields[0].values = together;
  fields[1].values = apart;
  fields[2].values = below;
  fields[2].is_signed = true;
  fields[3].values = beyond;
  fields[3].is_signed = true;  // -8 to 7: nine is no value of it, and the bits of -7
  const Message message{fields};
  cli::JsonText text{message.catalogue()};
  const auto names = [&](std::uint64_t data) {
    const std::string line = line_of(text, entry_of(data));
    const auto begin = line.find("\"names\":");
    return begin == std::string::npos ? std::string{} : line.substr(begin, line.find('}', begin) + 1 - begin);
  };
  CHECK(names(0x01'FF'FA'01) == R"("names":{"a":"on","b":"many","c":"wrong","d":"one"})");
  CHECK(names(0x09'02'03'00) == R"("names":{"a":"off","b":"few","c":"two"})");
  CHECK(names(0x02'00'04'02).empty());
  CHECK(names(0x00'FE'FF'FF).empty());
}

TEST_CASE(
    "JSON text: a CAN FD frame with all of its bytes, and the name of a value that lies in nine of them",
    "[output]") {
  static constexpr std::array<protocol::NamedValue, 2> names{{{0, "none"}, {5, "five"}}};
  std::vector<Field> fields{field("wide", 4, 62)};
  fields[0].values = names;
  const Message message{fields, {protocol::Address::By::identifier, false, 0x123}, 12};
  cli::JsonText text{message.catalogue()};
  log::Entry entry = entry_of(0x5F);
  entry.length = 12;
  entry.flags = log::flag::fd;
  std::fill(entry.data.begin() + 8, entry.data.end(), std::uint8_t{0});
  entry.data[8] = 0xA8;  // its two lowest bits are the field's highest
  entry.data[11] = 0xAB;
  const std::string head = R"({"time_ns":"0","bus":"can0","id":"123","topic":"Message","frame":"Message",)";
  const std::string fd = R"(,"fd":{"brs":false,"esi":false}})"
                         "\n";
  CHECK(line_of(text, entry) == head +
                                    R"("fields":{"wide":5},"units":{"wide":""},"names":{"wide":"five"},)"
                                    R"("data":"5F00000000000000A80000AB")" +
                                    fd);
  entry.data[0] = 0;
  CHECK(line_of(text, entry) == head +
                                    R"("fields":{"wide":0},"units":{"wide":""},"names":{"wide":"none"},)"
                                    R"("data":"0000000000000000A80000AB")" +
                                    fd);
  entry.data[8] = 0xA9;
  CHECK(line_of(text, entry) == head +
                                    R"("fields":{"wide":1152921504606846976},"units":{"wide":""},)"
                                    R"("data":"0000000000000000A90000AB")" +
                                    fd);
}

TEST_CASE("JSON text: a line is written to where there is room for it, however little is left", "[output]") {
  const Message message{{field("a", 0, 8), field("b", 8, 56)}};
  cli::JsonText text{message.catalogue()};
  std::vector<log::Entry> entries(6, entry_of(UINT64_MAX));
  entries[1].id = 0x124;  // of no message
  entries[1].raw_dlc = 15;
  entries[1].direction = log::Direction::received;
  entries[2].length = 7;  // too short
  entries[3].format = can::Format::base_remote;
  entries[4].format = can::Format::error;
  entries[4].id = 0x40;
  entries[5].id = 0x124;
  entries[5].flags = log::flag::fd;
  entries[5].length = log::max_fd_length;
  entries[5].direction = log::Direction::received;
  entries[5].data.fill(0xA5);
  for (const log::Entry& entry : entries) {
    CHECK(line_of(text, entry).ends_with("}\n"));
    test::check_room([&](log::Bytes& out) { text.write(out, "can0", entry); });
  }
}

TEST_CASE("JSON text: of J1939, too, a line is written to where there is room for it", "[output]") {
  const Message message{
      {field("Near", 0, 8), field("Far", 72, 8)}, {protocol::Address::By::pgn, true, 0x18FE'EC00}, 10};
  cli::JsonText text{message.catalogue()};
  std::array<std::uint8_t, 18> bytes{1};  // behind a message eight may be read
  bytes[9] = 7;
  // What takes the most digits.
  log::Entry packet;
  packet.time = base::Time{base::Duration{std::numeric_limits<std::int64_t>::min()}};
  packet.id = 0x1FEB'FFFE;
  packet.format = can::Format::extended;
  packet.length = 8;
  packet.direction = log::Direction::received;
  j1939::Transported whole;
  whole.id = {7, 0x3'FEEC, 255, 254};
  whole.data = std::span{bytes}.first(10);
  client::Reception known, unknown, alone;
  known.topic = &message.catalogue().topics[0];
  known.transported = unknown.transported = &whole;
  for (const client::Reception& reception : {known, unknown, alone})
    test::check_room([&](log::Bytes& out) { text.write_transport(out, "can0", packet, reception); });
  for (const std::uint32_t id : {0x1FFF'FEFEU, 0x1CFE'ECFEU}) {  // of no message, and of one frame
    packet.id = id;
    test::check_room([&](log::Bytes& out) { text.write(out, "can0", packet); });
  }
}

TEST_CASE("JSON text: there is room for names and units, however long they are", "[output]") {
  static constexpr std::array<protocol::SelectorRange, 1> one{{{1, 1}}};
  const std::string name(600, 'n'), unit(600, 'u');
  const std::array<std::string, 3> names{name + "a", name + "b", name + "c"};
  std::string values, units;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string key = (i == 0 ? "\"" : ",\"") + names[i] + "\":";
    values += key + std::to_string(i + 1);
    units += key + '"' + unit + '"';
  }
  for (const bool paged : {false, true}) {
    CAPTURE(paged);
    std::vector<Field> fields{field(names[0], 0, 8), field(names[1], 8, 8), field(names[2], 16, 8)};
    for (Field& each : fields) each.unit = unit;
    if (paged) {
      fields[2].selector = 0;
      fields[2].selected = one;
    }
    const Message message{fields};
    cli::JsonText text{message.catalogue()};
    const log::Entry entry = entry_of(0x03'02'01);
    const std::string line =
        R"({"time_ns":"0","bus":"can0","id":"123","topic":"Message","frame":"Message","fields":{)" + values +
        R"(},"units":{)" + units + R"(},"data":"0102030000000000"})" + "\n";
    CHECK((line_of(text, entry) == line));
    test::check_room([&](log::Bytes& out) { text.write(out, "can0", entry); }, 61);
  }
}

TEST_CASE("JSON text: of a choice, what has none of its fields is no line, and that is said", "[output]") {
  static constexpr std::array<protocol::SelectorRange, 1> one{{{1, 1}}};
  std::vector<Field> fields{field("page", 0, 8), field("a", 8, 8), field("b", 16, 8)};
  fields[2].selector = 0;
  fields[2].selected = one;
  const Message message{fields};
  const auto shown = [&message](const std::string& word, const log::Entry& entry) {
    const std::vector<std::string> words{word};
    const auto choice = cli::Selection::of(message.catalogue(), words);
    REQUIRE(choice);
    cli::JsonText text{message.catalogue(), *choice};
    log::Bytes out;
    const bool any = text.write(out, "can0", entry);
    CHECK(any == !out.view().empty());
    return std::string{out.view()};
  };
  using Catch::Contains;
  CHECK_THAT(shown("Message.b", entry_of(0x09'07'01)), Contains(R"("fields":{"b":9},"units":{"b":""})"));
  CHECK(shown("Message.b", entry_of(0x09'07'02)).empty());
  CHECK_THAT(shown("Message.a", entry_of(0x09'07'02)), Contains(R"("fields":{"a":7},"units":{"a":""})"));
  for (const std::string word : {"Message.a", "Message.b"}) {
    log::Entry entry = entry_of(0x09'07'01);
    entry.id = 0x124;  // of no message
    CHECK(shown(word, entry).empty());
    entry.id = 0x123;
    entry.length = 7;  // too short
    CHECK(shown(word, entry).empty());
    entry.length = 8;
    entry.format = can::Format::base_remote;
    CHECK(shown(word, entry).empty());
  }
}

TEST_CASE("JSON text: on an interface what another one has is unknown", "[output]") {
  constexpr std::array<std::string_view, 3> names{"Here", "There", "Anywhere"}, buses{"can0", "can1", ""};
  for (const bool wide : {false, true}) {
    const std::array<Field, 1> fields{field("a", 0, 8)};
    std::array<protocol::FrameLayout, 3> layouts;
    std::array<protocol::Topic, 3> topics;
    for (std::size_t i = 0; i < topics.size(); ++i) {
      layouts[i].length = 1;
      layouts[i].fields = fields;
      layouts[i].address = {protocol::Address::By::identifier, wide, 0x100 + static_cast<std::uint32_t>(i)};
      topics[i].name = names[i];
      topics[i].kind = protocol::Kind::message;
      topics[i].board = protocol::no_board;
      topics[i].frames = {&layouts[i], 1};
      topics[i].bus = buses[i];
    }
    const protocol::Catalogue catalogue{"car", 250'000, {}, topics};
    cli::JsonText all{catalogue}, here{catalogue, {}, "can0"};
    log::Entry entry = entry_of(5);
    entry.format = wide ? can::Format::extended : can::Format::base;
    for (std::size_t i = 0; i < topics.size(); ++i) {
      entry.id = 0x100 + static_cast<std::uint32_t>(i);
      const std::string known = R"("topic":")" + std::string{names[i]} + R"(","frame":")" +
                                std::string{names[i]} + R"(","fields":{"a":5})";
      CHECK_THAT(line_of(all, entry), Catch::Contains(known));
      CHECK_THAT(line_of(here, entry),
                 Catch::Contains(i == 1 ? std::string{R"("error":"unknown identifier")"} : known));
    }
  }
}

TEST_CASE("JSON text: there is room for names of values, be some very short and others very long",
          "[output]") {
  using protocol::NamedValue;
  const std::string together_name(3000, 'a'), apart_name(3000, 'b'), bit_name(400, 'c');
  const std::array<NamedValue, 2> together{{{0, "x"}, {1, together_name}}};
  const std::array<NamedValue, 2> apart{{{3, "y"}, {250, apart_name}}};
  std::vector<NamedValue> bits;
  std::string of_all_bits;
  for (std::int64_t bit = 0; bit < 8; ++bit) {
    bits.push_back({bit, bit_name});
    of_all_bits += (bit == 0 ? "" : "|") + bit_name;
  }
  std::vector<Field> fields{field("a", 0, 8), field("b", 8, 8), field("c", 16, 8)};
  fields[0].values = together;
  fields[1].values = apart;
  fields[2].values = bits;
  fields[2].flags = true;
  const Message message{fields};
  cli::JsonText text{message.catalogue()};
  const log::Entry entry = entry_of(0xFF'FA'01);
  const std::string line = line_of(text, entry);
  CHECK_THAT(line, Catch::Contains(R"("names":{"a":")" + together_name + R"(","b":")" + apart_name +
                                   R"(","c":")" + of_all_bits + R"("},"data":)"));
  test::check_room([&](log::Bytes& out) { text.write(out, "can0", entry); }, 61);
}

TEST_CASE("JSON text: of J1939's transport protocol a choice shows what completes a message with its field",
          "[output]") {
  const std::array<Field, 2> fields{field("Near", 0, 8), field("Far", 72, 8)};
  std::array<protocol::FrameLayout, 2> layouts;
  std::array<protocol::Topic, 2> topics;
  for (std::size_t i = 0; i < topics.size(); ++i) {
    layouts[i].length = 10;
    layouts[i].fields = fields;
    layouts[i].address = {protocol::Address::By::pgn, true, i == 0 ? 0x18FE'EC00U : 0x18FE'EB00U};
    topics[i].name = i == 0 ? "Chosen" : "Other";
    topics[i].kind = protocol::Kind::message;
    topics[i].board = protocol::no_board;
    topics[i].frames = {&layouts[i], 1};
  }
  const protocol::Catalogue catalogue{"truck", 250'000, {}, topics};
  const std::vector<std::string> words{"Chosen.Far"};
  const auto choice = cli::Selection::of(catalogue, words);
  REQUIRE(choice);
  cli::JsonText all{catalogue}, chosen{catalogue, *choice};

  std::array<std::uint8_t, 18> bytes{1};  // behind a message eight may be read
  bytes[9] = 7;
  log::Entry packet;
  packet.id = 0x1CEB'FF00;
  packet.format = can::Format::extended;
  packet.length = 8;
  // The line of a packet that completes so many bytes of a message; of none where there are none.
  const auto line = [&](cli::JsonText& text, const protocol::Topic* topic, std::size_t size) {
    j1939::Transported whole;
    whole.data = std::span{bytes}.first(size);
    client::Reception reception;
    reception.topic = topic;
    if (size != 0) reception.transported = &whole;
    log::Bytes out;
    const bool any = text.write_transport(out, "can0", packet, reception);
    CHECK(any == !out.view().empty());
    return std::string{out.view()};
  };
  using Catch::Contains;
  CHECK_THAT(line(chosen, &topics[0], 10),
             Contains(R"("topic":"Chosen","fields":{"Far":7},"units":{"Far":""})"));
  CHECK(line(chosen, &topics[0], 9).empty());  // without that field
  CHECK(line(chosen, &topics[1], 10).empty());
  CHECK(line(chosen, nullptr, 10).empty());  // of a message that the spec has not
  CHECK(line(chosen, nullptr, 0).empty());
  CHECK_THAT(line(all, &topics[0], 10),
             Contains(R"("fields":{"Near":1,"Far":7},"units":{"Near":"","Far":""})"));
  CHECK_THAT(line(all, &topics[0], 9), Contains(R"("fields":{"Near":1},"units":{"Near":""})"));
  CHECK_THAT(line(all, &topics[1], 10), Contains(R"("topic":"Other","fields":{"Near":1,"Far":7})"));
  CHECK_THAT(line(all, nullptr, 10), Contains(R"("error":"unknown identifier")"));
  CHECK_THAT(line(all, nullptr, 0), Contains(R"("transport":"packet","data":"0000000000000000")"));
}

}  // namespace tool_output_json_text_test
