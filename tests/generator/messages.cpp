// Plain messages in our JSON: what the reader makes of each member, what it doubts, and that a spec becomes a
// DBC file and comes back as it was.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "generator/spec/json.hpp"
#include "generator/spec/reader.hpp"
#include "generator/spec/spec.hpp"
#include "generator/targets/target.hpp"
#include "unit/base/explore.hpp"

namespace generator_messages_test {

using namespace ocm;
using namespace std::chrono_literals;
using protocol::Address;
using protocol::ByteOrder;
using protocol::Number;
using spec::FieldModel;
using spec::MessageModel;
using spec::Model;

std::string read(const std::filesystem::path& file) {
  std::ifstream in{file, std::ios::binary};
  REQUIRE(in);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}
std::vector<std::string> printed(const std::vector<spec::Problem>& problems) {
  std::vector<std::string> lines;
  for (const auto& p : problems) lines.push_back(p.place + ": " + p.what + "; " + p.remedy);
  return lines;
}
Model parse(const std::string& text, const std::vector<std::string>& doubts = {},
            const std::string& name = "f.json") {
  auto loaded = spec::parse(text, name);
  INFO(text);
  CHECK(printed(loaded.problems).empty());
  CHECK(printed(loaded.doubts) == doubts);
  REQUIRE(loaded.spec);
  return loaded.spec->model();
}
/// One message with these fields.
std::string of_fields(const std::string& fields, const std::string& more = {}) {
  return R"({"robot": "r", "messages": [{"name": "M", "id": 1)" + more + R"(, "fields": [)" + fields + "]}]}";
}

TEST_CASE("messages: every member") {
  const Model model =
      parse(read(std::filesystem::path{OCM_SOURCE_DIR} / "tests/generator/good_messages.json"));
  CHECK(model.description == "two lines:\nof a comment");
  CHECK(model.bit_rate == 250'000);
  CHECK(model.attributes == std::vector<spec::AttributeModel>{{"BusType", "CAN"}});
  REQUIRE(model.boards.size() == 2);
  CHECK(model.boards[0].attributes == std::vector<spec::AttributeModel>{{"Maker", "ours"}});
  REQUIRE(model.messages.size() == 3);

  const MessageModel& engine = model.messages[0];
  CHECK(engine.name == "EEC1");
  CHECK(engine.aliases == std::vector<std::string>{"eec"});
  CHECK(engine.is_j1939());
  CHECK(engine.address.extended);
  CHECK(engine.address.number == 0x18F0'04FE);  // priority 6, source 254: the null address [SAE J1939-21]
  CHECK(engine.length == 8);
  CHECK_FALSE(engine.fd);
  CHECK(engine.board == 0);
  CHECK(engine.period == 20ms);
  CHECK(engine.send_type == "Cyclic");
  CHECK(engine.description == "engine's speed");
  CHECK(engine.attributes == std::vector<spec::AttributeModel>{{"Group", "engine"}});
  CHECK(engine.source.general == "by hand");
  const FieldModel& speed = engine.fields[0];
  CHECK(speed.position.start == 24);
  CHECK(speed.position.width == 16);
  CHECK(speed.position.order == ByteOrder::little);
  CHECK(base::compare(speed.scale, {125, -3}) == 0);
  CHECK(speed.unit == "rpm");
  REQUIRE(speed.range);
  CHECK(base::compare(speed.range->max, {8'031'875, -3}) == 0);
  CHECK(speed.receivers == std::vector<std::string>{"Dash"});
  CHECK(speed.start == 800);
  CHECK(engine.fields[1].values.at(1).name == "on");
  CHECK(base::compare(engine.fields[2].offset, {-125, 0}) == 0);

  const MessageModel& service = model.messages[1];
  CHECK(service.address == Address{Address::By::identifier, false, 0x7DF});
  CHECK(service.fd);
  CHECK(service.other_senders == std::vector<std::string>{"Engine"});
  CHECK(service.shortest_period == 5ms);
  CHECK(service.deadline == 10ms);
  CHECK(service.jitter == 1ms);
  CHECK(service.fields[1].number == Number::float32);
  CHECK(service.fields[1].selector == "Mode");
  CHECK(service.fields[1].selected == std::vector<protocol::SelectorRange>{{1, 1}, {4, 7}});
  CHECK(service.fields[2].flags);
  CHECK(service.fields[3].position.start == 71);  // the highest bit of byte 8
  CHECK(service.fields[3].position.order == ByteOrder::big);
  CHECK(service.fields[3].is_signed);
  CHECK(service.fields[3].values.size() == 2);

  CHECK(model.messages[2].address == Address{Address::By::identifier, true, 0x18FE'F100});
  CHECK(model.messages[2].length == 0);
}

TEST_CASE("messages: the catalogue says of each what its spec does") {
  const auto loaded = spec::parse(
      read(std::filesystem::path{OCM_SOURCE_DIR} / "tests/generator/good_messages.json"), "f.json");
  REQUIRE(loaded.spec);
  const auto& topics = loaded.spec->catalogue().topics;
  REQUIRE(topics.size() == 3);
  CHECK(topics[0].name == "EEC1");
  CHECK(topics[0].is_message());
  REQUIRE(topics[0].aliases.size() == 1);
  CHECK(topics[0].aliases[0] == "eec");
  CHECK(topics[0].board == 0);
  CHECK(topics[0].cycle == 20ms);
  CHECK(topics[0].shortest_period == 0ms);
  CHECK(topics[0].source == "by hand");
  REQUIRE(topics[0].frames.size() == 1);
  CHECK(topics[0].frames[0].length == 8);
  CHECK(topics[0].frames[0].address == Address{Address::By::pgn, true, 0x18F0'04FE});
  CHECK_FALSE(topics[0].frames[0].fd);
  CHECK(topics[1].board == 1);
  CHECK(topics[1].cycle == 0ms);
  CHECK(topics[1].shortest_period == 5ms);
  CHECK(topics[1].deadline == 10ms);
  CHECK(topics[1].jitter == 1ms);
  CHECK(topics[1].source.empty());
  CHECK(topics[1].frames[0].fd);
  CHECK(topics[1].frames[0].fields.size() == 4);
  CHECK(topics[2].board == protocol::no_board);
  CHECK(topics[2].frames[0].fields.empty());
}

TEST_CASE("messages: the length is that of the shortest frame that has all fields") {
  const auto length = [](unsigned byte) {
    return parse(of_fields(R"({"name": "a", "type": "u8", "byte": )" + std::to_string(byte) + "}"))
        .messages[0];
  };
  CHECK(length(0).length == 1);
  CHECK(length(7).length == 8);
  CHECK_FALSE(length(7).fd);
  CHECK(length(8).length == 12);  // [ISO 11898-1, DLC 9 to 15]
  CHECK(length(8).fd);
  CHECK(length(24).length == 32);
  CHECK(length(63).length == 64);
  const std::pair<unsigned, unsigned> lengths[] = {{9, 12},  {12, 12}, {13, 16}, {16, 16}, {17, 20},
                                                   {20, 20}, {21, 24}, {24, 24}, {25, 32}, {32, 32},
                                                   {33, 48}, {48, 48}, {49, 64}, {64, 64}};
  for (const auto& [used, whole] : lengths) {
    CAPTURE(used);
    CHECK(length(used - 1).length == whole);
  }
}

TEST_CASE("messages: a start value is raw, and of a float its number") {
  const Model model = parse(of_fields(R"({"name": "a", "type": "u8", "byte": 0, "scale": 2, "start": 7},
    {"name": "b", "type": "f32", "byte": 1, "start": 1.5})"));
  CHECK(model.messages[0].fields[0].start == 7);
  CHECK(model.messages[0].fields[1].start == 0x3FC0'0000);
}

TEST_CASE("messages: a value of many zeros is the number that it is") {
  const Model model = parse(of_fields(R"({"name": "a", "type": "i64", "byte": 0,
    "values": {"far": 1000000000000000000, "farther": -9000000000000000000, "near": 10}})"));
  const auto& values = model.messages.at(0).fields.at(0).values;
  REQUIRE(values.size() == 3);
  CHECK(values[0].raw == 1'000'000'000'000'000'000);
  CHECK(values[1].raw == -9'000'000'000'000'000'000);
  CHECK(values[2].raw == 10);
}

TEST_CASE(
    "messages: the data of CAN FD go at a rate of their own, but where an attribute says that they do not") {
  const auto switches = [](const std::string& attributes) {
    const auto loaded = spec::parse(
        of_fields("", R"(, "length": 12, "fd": true, "attributes": {)" + attributes + "}"), "f.json");
    REQUIRE(loaded.spec);
    return loaded.spec->catalogue().topics[0].frames[0].bit_rate_switch;
  };
  CHECK(switches(R"("Other": "1")"));
  CHECK(switches(R"("Other": "0")"));
  CHECK(switches(R"("CANFD_BRS": "1")"));
  CHECK_FALSE(switches(R"("CANFD_BRS": "0")"));
  CHECK_FALSE(switches(R"("Other": "1", "CANFD_BRS": "0")"));
}

TEST_CASE("messages: what other programs load is loaded with a doubt") {
  parse(of_fields(R"({"name": "a", "type": "u8", "byte": 0}, {"name": "b", "type": "u8", "bit": 4})"),
        {R"(f.json:1: /messages/0/fields/1: "a" and "b" have bits in common; each is read by itself)"});
  parse(
      of_fields(R"({"name": "a", "type": "u8", "byte": 4})", R"(, "length": 4)"),
      {R"(f.json:1: /messages/0/fields/0: "a" ends in byte 4, and the message has 4 bytes; it is there in longer frames only)"});
  parse(of_fields(R"({"name": "a", "type": "u4", "byte": 0, "values": {"far": 16}})"),
        {"f.json:1: /messages/0/fields/0/values/far: 16 is no value of 4 bits; it is kept, and never comes"});
  parse(of_fields(R"({"name": "a", "type": "u4", "byte": 0, "scale": 0})"),
        {"f.json:1: /messages/0/fields/0/scale: a scale of zero; every value is the offset"});
  parse(
      of_fields(R"({"name": "a", "type": "u4", "byte": 0, "receivers": ["X"]})"),
      {R"(f.json:1: /messages/0/fields/0/receivers/0: there is no board "X"; it is kept; add it to "boards")"});
  parse(
      R"({"robot": "r", "messages": [{"name": "M", "id": 1, "fields": []}, {"name": "M", "id": 1, "fields": []}]})",
      {R"(f.json:1: /messages/1/name: the name "M" is that of another message (see /messages/0/name); both are kept; give one another name)",
       "f.json:1: /messages/1/id: its identifier is that of another message (see /messages/0); the first one "
       "counts"});
  // Groups of J1939 differ by more than their sources.
  parse(
      R"({"robot": "r", "messages": [{"name": "A", "pgn": 65262, "fields": []}, {"name": "B", "pgn": 65263, "fields": []}]})");
}

TEST_CASE("messages: parts that are never there together have no bits in common") {
  const std::string mode = R"({"name": "mode", "type": "u8", "byte": 0})";
  const auto part = [](const char* name, const char* selected) {
    return std::string{R"(, {"name": ")"} + name +
           R"(", "type": "u8", "byte": 1, "selector": "mode", "selected": )" + selected + "}";
  };
  parse(of_fields(mode + part("a", "[1]") + part("b", "[[2, 9]]")));
  parse(of_fields(mode + part("a", "[3]") + part("b", "[[2, 9]]")),
        {R"(f.json:1: /messages/0/fields/2: "a" and "b" have bits in common; each is read by itself)"});
}

TEST_CASE("messages: what hundreds of pages have in common is found") {
  std::string fields = R"({"name": "mode", "type": "u16", "byte": 0})";
  const auto add = [&fields](const std::string& name, int page) {
    fields += R"(, {"name": ")" + name + R"(", "type": "u8", "byte": 2, "selector": "mode", "selected": [)" +
              std::to_string(page) + "]}";
  };
  constexpr int pages = 300;
  for (int i = 0; i < pages; ++i) add("p" + std::to_string(i), i);
  parse(of_fields(fields));
  add("a", pages);
  add("b", pages);
  parse(of_fields(fields),
        {R"(f.json:1: /messages/0/fields/302: "a" and "b" have bits in common; each is read by itself)"});
}

TEST_CASE("messages: a range of a selector may be a single number") {
  const Model model = parse(of_fields(R"({"name": "mode", "type": "u8", "byte": 0},
    {"name": "a", "type": "u8", "byte": 1, "selector": "mode", "selected": [[4, 4]]})"));
  CHECK(model.messages.at(0).fields.at(1).selected == std::vector<protocol::SelectorRange>{{4, 4}});
}

TEST_CASE("messages: up to two thousand fields of a message are compared with each other") {
  const auto doubts = [](int count) {
    std::string fields;
    for (int i = 0; i + 1 < count; ++i) {
      const std::string number = std::to_string(i);
      fields += R"({"name": "f)" + number + R"(", "type": "u1", "bit": )" + number + "}, ";
    }
    fields += R"({"name": "last", "type": "u1", "bit": 0})";
    // By the reader alone: the schema takes longer for so many.
    std::vector<spec::Problem> problems;
    std::vector<spec::Problem> told;
    const auto root =
        spec::parse_json(of_fields(fields, R"(, "format": "j1939", "length": 250)"), "f.json", problems);
    REQUIRE(problems.empty());
    static_cast<void>(spec::read_model(root, "f.json", problems, told));
    CHECK(printed(problems).empty());
    return printed(told);
  };
  CHECK(
      doubts(2000) ==
      std::vector<std::string>{
          R"(f.json:1: /messages/0/fields/1999: "f0" and "last" have bits in common; each is read by itself)"});
  CHECK(doubts(2001).empty());
}

TEST_CASE("messages: twenty million comparisons of selected numbers are made, and no more") {
  const auto numbers = [](int first, int count) {
    std::string list;
    for (int i = 0; i < count; ++i) list.append(i == 0 ? "" : ", ").append(std::to_string(first + i));
    return "[" + list + "]";
  };
  const auto selected = [](const std::string& name, const std::string& where, const std::string& by,
                           const std::string& with) {
    return R"(, {"name": ")" + name + "\", " + where + R"(, "selector": ")" + by + R"(", "selected": )" +
           with + "}";
  };
  const auto doubts = [&](int others) {
    const std::string fields =
        R"({"name": "mode", "type": "u8", "byte": 0})" +
        selected("left", R"("type": "u16", "byte": 1)", "mode", "[0]") +
        selected("right", R"("type": "u16", "byte": 3)", "mode", "[1]") +
        // Never there together: as many comparisons as there are others, and one.
        selected("x", R"("type": "u8", "byte": 5)", "mode", "[0]") +
        selected("y", R"("type": "u8", "byte": 5)", "mode", numbers(1, others)) +
        // Neither are these, as the last of 4472 * 4472 + 4 comparisons shows.
        selected("a", R"("type": "u8", "byte": 6)", "left", numbers(0, 4471)) +
        selected("b", R"("type": "u8", "byte": 6)", "right", numbers(0, 4471)) +
        R"(, {"name": "c", "type": "u8", "byte": 7}, {"name": "d", "type": "u8", "byte": 7})";
    std::vector<spec::Problem> problems;
    std::vector<spec::Problem> told;
    const auto root = spec::parse_json(of_fields(fields), "f.json", problems);
    REQUIRE(problems.empty());
    static_cast<void>(spec::read_model(root, "f.json", problems, told));
    CHECK(printed(problems).empty());
    return printed(told);
  };
  CHECK(doubts(1211) ==
        std::vector<std::string>{
            R"(f.json:1: /messages/0/fields/8: "c" and "d" have bits in common; each is read by itself)"});
  CHECK(doubts(1212).empty());
}

TEST_CASE("messages: the least and the greatest number that the bits hold may have names") {
  parse(of_fields(R"({"name": "a", "type": "u4", "byte": 0, "values": {"least": 0, "most": 15}},
    {"name": "b", "type": "i4", "byte": 1, "values": {"least": -8, "most": 7}})"));
  parse(of_fields(R"({"name": "b", "type": "i4", "byte": 1, "values": {"below": -9, "beyond": 8}})"),
        {"f.json:1: /messages/0/fields/0/values/below: -9 is no value of 4 bits; it is kept, and never comes",
         "f.json:1: /messages/0/fields/0/values/beyond: 8 is no value of 4 bits; it is kept, and never "
         "comes"});
}

TEST_CASE("messages: a field may lie in the last byte of the longest parameter group") {
  const auto problems = [](const std::string& place) {
    return printed(
        spec::parse(
            R"({"robot": "r", "messages": [{"name": "M", "pgn": "0xFEF1", "length": 1785, "fields": [)"
            R"({"name": "a", )" +
                place + "}]}]}",
            "f.json")
            .problems);
  };
  for (const char* good :
       {R"("byte": 1784, "type": "u8")", R"("byte": 1784, "type": "u8", "byte_order": "big")",
        R"("bit": 14279, "type": "u1")", R"("bit": 14272, "type": "u8")", R"("byte": 1777, "type": "u64")"}) {
    CAPTURE(good);
    CHECK(problems(good).empty());
  }
  const auto beyond = [](const std::string& member, const std::string& width) {
    return std::vector<std::string>{"f.json:1: /messages/0/fields/0/" + member + ": a field of " + width +
                                    " bits that begins here does not end within 1785 bytes; an earlier "
                                    "beginning"};
  };
  CHECK(problems(R"("byte": 1784, "type": "u9")") == beyond("byte", "9"));
  CHECK(problems(R"("byte": 1784, "type": "u9", "byte_order": "big")") == beyond("byte", "9"));
  CHECK(problems(R"("bit": 14279, "type": "u2")") == beyond("bit", "2"));
}

TEST_CASE("messages: doubts are in the order of the file") {
  parse(
      of_fields("\n"
                R"({"name": "a", "type": "u8", "byte": 1},)"
                "\n"
                R"({"name": "b", "type": "u4", "byte": 0, "values": {"far": 16}})",
                R"(, "length": 1)"),
      {R"(f.json:2: /messages/0/fields/0: "a" ends in byte 1, and the message has 1 bytes; it is there in longer frames only)",
       "f.json:3: /messages/0/fields/1/values/far: 16 is no value of 4 bits; it is kept, and never comes"});
}

TEST_CASE("messages: an identifier has sixteen digits at most") {
  const auto with = [](const std::string& id) {
    return spec::parse(R"({"robot": "r", "messages": [{"name": "M", "id": ")" + id + R"(", "fields": []}]})",
                       "f.json");
  };
  const auto longest = with("0x0000000000000123");
  REQUIRE(longest.spec);
  CHECK(longest.spec->model().messages.at(0).address.number == 0x123);
  CHECK(printed(with("0x00000000000000123").problems) ==
        std::vector<std::string>{
            R"(f.json:1: /messages/0/id: "0x00000000000000123" is not an id; "0x0" to "0x1FFFFFFF")"});
}

TEST_CASE("messages: identifiers to the last of 11 and of 29 bits") {
  const auto number = [](const std::string& members) {
    const Model model =
        parse(R"({"robot": "r", "messages": [{"name": "M", )" + members + R"(, "fields": []}]})");
    return model.messages.at(0).address.number;
  };
  CHECK(number(R"("id": "0x7FF")") == 0x7FF);
  CHECK(number(R"("id": 2047)") == 0x7FF);
  CHECK(number(R"("id": "0x1FFFFFFF", "format": "extended")") == 0x1FFF'FFFF);
  CHECK(number(R"("id": 536870911, "format": "extended")") == 0x1FFF'FFFF);
}

TEST_CASE("messages: the number of a parameter group that has a destination ends with a zero for it") {
  const auto with = [](const std::string& pgn) {
    return spec::parse(
        R"({"robot": "r", "messages": [{"name": "M", "pgn": ")" + pgn + R"(", "fields": []}]})", "f.json");
  };
  // Priority 6, to all, from the null address.
  const std::pair<const char*, std::uint32_t> good[] = {{"0xEA00", 0x18EA'FFFE},  {"0xEF00", 0x18EF'FFFE},
                                                        {"0x1EA00", 0x19EA'FFFE}, {"0x0", 0x1800'FFFE},
                                                        {"0xF001", 0x18F0'01FE},  {"0x3FFFF", 0x1BFF'FFFE}};
  for (const auto& [pgn, number] : good) {
    CAPTURE(pgn);
    const auto loaded = with(pgn);
    CHECK(printed(loaded.problems).empty());
    REQUIRE(loaded.spec);
    CHECK(loaded.spec->model().messages.at(0).address.number == number);
  }
  const std::pair<std::string, std::string> bad[] = {{"0xEA01", "0xEA00"},
                                                     {"0xEA80", "0xEA00"},
                                                     {"0xEFFF", "0xEF00"},
                                                     {"0x1EA21", "0x1EA00"},
                                                     {"0x3EA21", "0x3EA00"}};
  for (const auto& [pgn, group] : bad)
    CHECK(printed(with(pgn).problems) ==
          std::vector<std::string>{"f.json:1: /messages/0/pgn: \"" + pgn +
                                   "\" ends with a destination, which is no part of the group; \"" + group +
                                   "\""});
}

TEST_CASE("messages: a time of a DBC file is a whole number of nanoseconds, or there is none") {
  const auto times = [](const std::string& milliseconds) {
    const Model model = parse("BO_ 1 A: 8 X\nBA_ \"GenMsgCycleTime\" BO_ 1 " + milliseconds +
                                  ";\nBA_ \"GenMsgDelayTime\" BO_ 1 " + milliseconds + ";\n",
                              {}, "f.dbc");
    CHECK(model.messages.at(0).period == model.messages.at(0).shortest_period);
    return model.messages.at(0).period;
  };
  CHECK(times("12.5") == 12'500us);
  CHECK(times("0.000001") == 1ns);
  CHECK(times("0.0000006") == 1ns);
  CHECK(times("0.0000004") == 0ns);
  CHECK(times("1e30") == 0ns);  // longer than can be counted
}

TEST_CASE("messages: of a start value that cannot be forty characters are shown") {
  const std::string value = "256." + std::string(60, '0');
  const std::string shown = "256." + std::string(36, '0');
  CHECK(printed(spec::parse(of_fields(R"({"name": "a", "type": "u8", "byte": 0, "start": )" + value + "}"),
                            "f.json")
                    .problems) == std::vector<std::string>{"f.json:1: /messages/0/fields/0/start: " + shown +
                                                           " is out of range; a raw number of 8 bits"});
  parse("BO_ 1 A: 8 X\n SG_ a : 0|8@1+ (1,0) [0|0] \"\" X\nBA_ \"GenSigStartValue\" SG_ 1 a " + value + ";\n",
        {"f.dbc:2: the start value " + shown +
         " of a is no raw number of 8 bits; left out; the signal starts at 0"},
        "f.dbc");
}

TEST_CASE("messages: a frame of CAN FD has 64 bytes at most, a parameter group 1785 in several frames") {
  const auto with = [](const std::string& more) {
    return spec::parse(
        R"({"robot": "r", "messages": [{"name": "M", "pgn": "0xFEF1", "fields": [])" + more + "}]}",
        "f.json");
  };
  for (const char* good :
       {R"(, "length": 64, "fd": true)", R"(, "length": 1785)", R"(, "length": 65, "fd": false)"}) {
    INFO(good);
    CHECK(printed(with(good).problems).empty());
  }
  CHECK(printed(with(R"(, "length": 65, "fd": true)").problems) ==
        std::vector<std::string>{
            "f.json:1: /messages/0/fd: a frame of CAN FD of 65 bytes; at most 64 bytes, or no \"fd\": "
            "a longer parameter group comes in several frames"});
}

TEST_CASE("messages: a message with tens of thousands of selected fields is read in seconds") {
  std::string text = "BO_ 1 A: 8 N\n SG_ Page M : 0|20@1+ (1,0) [0|0] \"\" N\n";
  constexpr int last = 60'000;
  for (int i = 0; i <= last; ++i) {
    const std::string number = std::to_string(i);
    text += " SG_ S" + number + " m" + number + " : 20|8@1+ (1,0) [0|0] \"\" N\n";
  }
  const std::clock_t begin = std::clock();
  const auto loaded = spec::parse(text, "f.dbc");
  CHECK((std::clock() - begin) / CLOCKS_PER_SEC < 15);  // of the processor; a walk a field took minutes
  REQUIRE(loaded.spec);
  const auto& layout = loaded.spec->catalogue().topics[0].frames[0];
  CHECK(layout.fields.back().selector == 0);
  const std::array<std::uint8_t, 8> data{0x60, 0xEA, 0, 0, 0, 0, 0, 0};  // 60000
  CHECK(layout.has(layout.fields.back(), data));
  CHECK_FALSE(layout.has(layout.fields[1], data));
}

TEST_CASE("messages: what a terminal would obey is printed as text, and goes back as it was") {
  const std::string text =
      "BO_ 1 A: 8 N\n SG_ a : 0|8@1+ (1,0) [0|0] \"\x1B[2J\xC2\x9B\xC2\xB0\n\" N\n"
      "VAL_ 1 a 1 \"\x07 on\" ;\n";
  const auto loaded = spec::parse(text, "f.dbc");
  REQUIRE(loaded.spec);
  const auto& field = loaded.spec->catalogue().topics[0].frames[0].fields[0];
  CHECK(field.unit == "\\x1b[2J\\x9b\xC2\xB0\\x0a");
  CHECK(field.values[0].name == "\\x07 on");
  const auto& model = loaded.spec->model().messages[0].fields[0];
  CHECK(model.unit == "\x1B[2J\xC2\x9B\xC2\xB0\n");
  CHECK(model.values[0].name == "\x07 on");
}

TEST_CASE("messages: text is shown as it is beside what a terminal would obey, one character from it") {
  const auto shown = [](const std::string& unit) {
    const auto loaded =
        spec::parse("BO_ 1 A: 8 N\n SG_ a : 0|8@1+ (1,0) [0|0] \"" + unit + "\" N\n", "f.dbc");
    REQUIRE(loaded.spec);
    return std::string{loaded.spec->catalogue().topics[0].frames[0].fields[0].unit};
  };
  CHECK(shown("\x01|\x1F|\x7F") == "\\x01|\\x1f|\\x7f");
  CHECK(shown("a b~") == "a b~");
  CHECK(shown("\xC2\x80|\xC2\x9F") == "\\x80|\\x9f");
  CHECK(shown("\xC2\xA0|\xC3\x80") == "\xC2\xA0|\xC3\x80");
}

TEST_CASE("messages: topics and messages in one spec") {
  std::string text = read(std::filesystem::path{OCM_SOURCE_DIR} / "tests/generator/good.json");
  text.insert(text.rfind('}'),
              R"(, "messages": [{"name": "Extra", "id": "0x7F0", "sender": "main_board", "fields": []}])");
  const Model model = parse(text);
  CHECK_FALSE(model.topics.empty());
  REQUIRE(model.messages.size() == 1);
  CHECK(model.messages[0].board == 0);
  text.replace(text.find("\"Extra\""), 7, "\"lamp_1\"");
  const auto loaded = spec::parse(text, "f.json");
  REQUIRE(loaded.problems.size() == 1);
  CHECK(loaded.problems[0].what.starts_with("a second topic or message is called \"lamp_1\""));
}

// --- there and back ---

/// All that both formats can say. Sources are left out, which are the file's lines.
void check_same(const FieldModel& a, const FieldModel& b) {
  CAPTURE(a.name);
  CHECK(a.name == b.name);
  CHECK(a.description == b.description);
  CHECK(a.position.start == b.position.start);
  CHECK(a.position.width == b.position.width);
  CHECK(a.position.order == b.position.order);
  CHECK(a.is_signed == b.is_signed);
  CHECK(base::compare(a.scale, b.scale) == 0);
  CHECK(base::compare(a.offset, b.offset) == 0);
  CHECK(a.unit == b.unit);
  CHECK(a.number == b.number);
  CHECK(a.selector == b.selector);
  CHECK(a.selected == b.selected);
  CHECK(a.start == b.start);
  CHECK(a.receivers == b.receivers);
  CHECK(a.attributes == b.attributes);
  REQUIRE(a.range.has_value() == b.range.has_value());
  if (a.range) CHECK(base::compare(a.range->min, b.range->min) == 0);
  if (a.range) CHECK(base::compare(a.range->max, b.range->max) == 0);
  REQUIRE(a.values.size() == b.values.size());
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    CHECK(a.values[i].name == b.values[i].name);
    CHECK(a.values[i].raw == b.values[i].raw);
  }
}
void check_same(const MessageModel& a, const MessageModel& b) {
  CAPTURE(a.name);
  CHECK(a.name == b.name);
  CHECK(a.description == b.description);
  CHECK(a.address == b.address);
  CHECK(a.length == b.length);
  CHECK(a.fd == b.fd);
  CHECK(a.board == b.board);
  CHECK(a.other_senders == b.other_senders);
  CHECK(a.period == b.period);
  CHECK(a.shortest_period == b.shortest_period);
  CHECK(a.send_type == b.send_type);
  CHECK(a.attributes == b.attributes);
  REQUIRE(a.fields.size() == b.fields.size());
  for (std::size_t i = 0; i < a.fields.size(); ++i) check_same(a.fields[i], b.fields[i]);
}
void check_same(const Model& a, const Model& b) {
  CHECK(a.description == b.description);
  CHECK(a.bit_rate == b.bit_rate);
  CHECK(a.attributes == b.attributes);
  REQUIRE(a.boards.size() == b.boards.size());
  for (std::size_t i = 0; i < a.boards.size(); ++i) {
    CHECK(a.boards[i].name == b.boards[i].name);
    CHECK(a.boards[i].description == b.boards[i].description);
    CHECK(a.boards[i].attributes == b.boards[i].attributes);
  }
  for (const auto& definition : a.definitions)  // what has none gets one in DBC
    CHECK(std::find(b.definitions.begin(), b.definitions.end(), definition) != b.definitions.end());
  REQUIRE(a.messages.size() == b.messages.size());
  for (std::size_t i = 0; i < a.messages.size(); ++i) check_same(a.messages[i], b.messages[i]);
}
/// As JSON, and as DBC: each is read as the model that it was written from.
void check_both_ways(const Model& model) {
  const std::string json = generate::make_spec(model, {"x", std::nullopt});
  INFO(json);
  const auto from_json = spec::parse(json, "x.json");
  CHECK(printed(from_json.problems) == std::vector<std::string>{});
  for (const auto& doubt : from_json.doubts) CHECK_FALSE(doubt.what.starts_with("there is no board"));
  REQUIRE(from_json.spec);
  check_same(model, from_json.spec->model());
  const std::string dbc = generate::make_dbc(model, {"x", std::nullopt});
  INFO(dbc);
  const auto from_dbc = spec::parse(dbc, "x.dbc");
  CHECK(printed(from_dbc.problems) == std::vector<std::string>{});
  REQUIRE(from_dbc.spec);
  check_same(model, from_dbc.spec->model());
}

TEST_CASE("messages: start values and names of values to the last of 64 bits") {
  const std::string text =
      "BO_ 1 A: 8 N\n SG_ a : 0|64@1+ (1,0) [0|0] \"\" N\n"
      "BO_ 2 B: 8 N\n SG_ b : 0|64@1- (1,0) [0|0] \"\" N\n"
      "BA_DEF_ SG_ \"GenSigStartValue\" HEX 0 0;\nBA_ \"GenSigStartValue\" SG_ 1 a 18446744073709551615;\n"
      "BA_ \"GenSigStartValue\" SG_ 2 b -9223372036854775808;\n"
      "VAL_ 1 a 18446744073709551615 \"none\" 9223372036854775808 \"half\" 1 \"one\" ;\n"
      "VAL_ 2 b -9223372036854775808 \"least\" -1 \"minus\" ;\n";
  const Model model = parse(text, {}, "f.dbc");
  CHECK(model.messages[0].fields[0].start == -1);
  CHECK(model.messages[1].fields[0].start == INT64_MIN);
  check_both_ways(model);
  const std::string json = generate::make_spec(model, {"f.dbc", std::nullopt});
  CHECK(json.find(R"({ "none": 18446744073709551615, "half": 9223372036854775808, "one": 1 })") !=
        std::string::npos);
  CHECK(json.find(R"("start": 18446744073709551615)") != std::string::npos);
  CHECK(json.find(R"("minus": -1)") != std::string::npos);
  const std::string dbc = generate::make_dbc(model, {"f.json", std::nullopt});
  CHECK(dbc.find("VAL_ 1 a 18446744073709551615 \"none\" 9223372036854775808 \"half\" 1 \"one\" ;") !=
        std::string::npos);
  CHECK(dbc.find("\"GenSigStartValue\" SG_ 1 a 18446744073709551615;") != std::string::npos);
}

TEST_CASE("messages: a start value that the bits do not hold is left out, with a doubt") {
  const auto starts = [](const std::string& type, const std::string& value,
                         const std::vector<std::string>& doubts = {}) {
    return parse("BO_ 1 A: 8 N\n SG_ a : 0|8@1" + type +
                     " (1,0) [0|0] \"\" N\nBA_DEF_ SG_ \"GenSigStartValue\" FLOAT 0 0;\n"
                     "BA_ \"GenSigStartValue\" SG_ 1 a " +
                     value + ";\n",
                 doubts, "f.dbc")
        .messages[0]
        .fields[0]
        .start;
  };
  CHECK(starts("+", "255") == 255);
  CHECK(starts("-", "255") == -1);  // the same bits
  CHECK(starts("-", "-128") == -128);
  CHECK(starts("+", "1.2E1") == 12);
  CHECK(starts("+", "12.5", {"f.dbc:2: the start value 12.5 of a is no whole number; read as 13"}) == 13);
  for (const char* value : {"256", "-1", "-0.6", "255.5", "1E30", "18446744073709551616"})
    CHECK(starts("+", value,
                 {"f.dbc:2: the start value " + std::string{value} +
                  " of a is no raw number of 8 bits; left out; the signal starts at 0"}) == std::nullopt);
  CHECK(starts("-", "-129",
               {"f.dbc:2: the start value -129 of a is no raw number of 8 bits; left out; the signal "
                "starts at 0"}) == std::nullopt);
  CHECK(parse("BO_ 1 A: 8 N\n SG_ a : 0|32@1- (1,0) [0|0] \"\" N\nSIG_VALTYPE_ 1 a : 1;\n"
              "BA_DEF_ SG_ \"GenSigStartValue\" FLOAT 0 0;\nBA_ \"GenSigStartValue\" SG_ 1 a 1E60;\n",
              {"f.dbc:2: the start value 1E60 of a is no number that a float holds; left out; the signal "
               "starts at 0"},
              "f.dbc")
            .messages[0]
            .fields[0]
            .start == std::nullopt);
}

TEST_CASE("messages: DBC files become our JSON, and go back") {
  std::size_t files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator{std::filesystem::path{OCM_SOURCE_DIR} / "examples"}) {
    if (entry.path().extension() != ".dbc") continue;
    CAPTURE(entry.path());
    const auto loaded = spec::load(entry.path());
    REQUIRE(loaded.spec);
    check_both_ways(loaded.spec->model());
    ++files;
  }
  CHECK(files >= 2);
}

TEST_CASE("messages: nodes that a DBC file does not declare are boards, and its JSON is without doubts") {
  const std::string text =
      "BU_: Motor\n"
      "BO_ 1 A: 8 Motor\n SG_ a : 0|8@1+ (1,0) [0|0] \"\" XXX,Dash\n"
      "BO_ 2 B: 8 XXX\n SG_ b : 0|8@1+ (1,0) [0|0] \"\" Vector__XXX\n"
      "BO_ 3 C: 8 Vector__XXX\n"
      "BO_TX_BU_ 2 : XXX,Spare;\n";
  const Model model = parse(text, {}, "f.dbc");
  std::vector<std::string> boards;
  for (const auto& board : model.boards) boards.push_back(board.name);
  CHECK(boards == std::vector<std::string>{"Motor", "XXX", "Spare", "Dash"});
  CHECK(model.messages[0].board == 0);
  CHECK(model.messages[1].board == 1);
  CHECK(model.messages[2].board == protocol::no_board);
  check_same(model, parse(generate::make_spec(model, {"f.dbc", std::nullopt}), {}));
  check_both_ways(model);
}

TEST_CASE("messages: a DBC file is known by what it begins with, and JSON whatever it is called") {
  const std::string json = of_fields(R"({"name": "f", "byte": 0, "type": "u8"})");
  CHECK(parse("\xEF\xBB\xBF \n" + json, {}, "car.dbc").messages.size() == 1);
  CHECK(parse("BO_ 1 A: 8 X\n", {}, "car.json").messages.size() == 1);
  CHECK(parse("\n VERSION \"\"\nBO_ 1 A: 8 X\n", {}, "car").messages.size() == 1);
}

TEST_CASE("messages: each word that a DBC file begins with, whatever ends the word") {
  for (const char* begin : {"VERSION \"\"", "VERSION\"\"", "NS_ :", "NS_:", "BS_:", "BS_\t:", "BU_: X",
                            "BU_\n: X", "BU_\r\n:", "CM_ \"a car\";", "VAL_TABLE_ T 0 \"a\" ;"}) {
    CAPTURE(begin);
    CHECK(parse(std::string{begin} + "\nBO_ 1 A: 8 X\n", {}, "car").messages.size() == 1);
  }
  for (const char* begin : {"BU", "BU_X: Y", "bu_: X", "FOO_ 1;"}) {
    CAPTURE(begin);
    const auto problems = spec::parse(std::string{begin} + "\nBO_ 1 A: 8 X\n", "car").problems;
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].remedy == "strict JSON: double quotes, commas between members, no comments");
  }
  // What is called so is one, in whatever letters.
  const std::string odd = "FOO_ 1;\nBO_ 1 A: 8 X\n";
  CHECK(parse(odd, {"car.DBC:1: unknown statement 'FOO_'; left out"}, "car.DBC").messages.size() == 1);
  CHECK(parse(odd, {"car.dbc:1: unknown statement 'FOO_'; left out"}, "car.dbc").messages.size() == 1);
}

TEST_CASE("messages: a word of DBC that ends the text begins no DBC file") {
  const std::string_view text = "BO_ 1 A: 8 X\n";
  const auto told = [&](std::size_t size) { return spec::parse(text.substr(0, size), "car").problems; };
  CHECK(told(text.size()).empty());
  for (const std::size_t size : {std::size_t{2}, std::size_t{3}}) {
    CAPTURE(size);
    const auto problems = told(size);
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].remedy == "strict JSON: double quotes, commas between members, no comments");
  }
  CHECK(told(4).at(0).what.starts_with("BO_: the file ends here"));
}

TEST_CASE("messages: a file of two or four bytes a character is named as that") {
  using namespace std::string_literals;
  struct Row {
    std::string text;
    std::string encoding;
  };
  const Row rows[] = {{"\xFF\xFE"s + "V\0E\0"s, "UTF-16LE"},
                      {"V\0E\0"s, "UTF-16LE"},
                      {"\xFE\xFF"s + "\0V\0E"s, "UTF-16BE"},
                      {"\0{\0}"s, "UTF-16BE"},
                      {"\xFF\xFE\0\0"s, "UTF-32LE"},
                      {"{\0\0\0"s, "UTF-32LE"},
                      {"\0\0\xFE\xFF"s, "UTF-32BE"},
                      {"\0\0\0{"s, "UTF-32BE"},
                      {"{\0"s, "UTF-16LE"},
                      {"\0{"s, "UTF-16BE"}};
  for (const auto& [text, encoding] : rows) {
    const spec::Loaded loaded = spec::parse(text, "car.dbc");
    CHECK(!loaded.spec);
    REQUIRE(loaded.problems.size() == 1);
    CHECK(loaded.problems[0].place == "car.dbc");
    CHECK(loaded.problems[0].what == "the file is " + encoding);
  }
  // Too short to tell, or as it should be.
  for (const std::string& text : {""s, "\0"s, "{"s, "\0\0"s, "\0\0{"s, "{}"s, "\xFF"s, "\xFE"s}) {
    CAPTURE(text.size());
    CHECK(spec::wide_encoding(text).empty());
  }
}

TEST_CASE("messages: a DBC file without any is loaded, with a doubt") {
  const std::string doubt = "the file has no message; BO_ 257 Engine: 8 Gateway begins one";
  const Model model = parse("BU_: A B\n", {"nodes.dbc: " + doubt}, "nodes.dbc");
  CHECK(model.boards.size() == 2);
  parse("CM_ \"IMPORT base.dbc\";\n",
        {"f.dbc:1: IMPORT: base.dbc goes in front of this file; read without it: give that file, too",
         "f.dbc: " + doubt},
        "f.dbc");
}

TEST_CASE("messages: selectors in a circle are reported, also over a field that is always there") {
  const auto field = [](const std::string& name, const std::string& selector) {
    return R"({"name": ")" + name + R"(", "byte": 0, "type": "u8")" +
           (selector.empty() ? "" : R"(, "selector": ")" + selector + R"(", "selected": [0])") + "}";
  };
  for (const std::string& fields : {field("A", "B") + "," + field("B", "A") + "," + field("C", ""),
                                    field("C", "") + "," + field("A", "A"),
                                    field("D", "A") + "," + field("A", "A") + "," + field("C", "")}) {
    CAPTURE(fields);
    const auto loaded = spec::parse(
        R"({"robot": "r", "messages": [{"name": "M", "id": "0x1", "fields": [)" + fields + "]}]}", "f.json");
    CHECK(loaded.spec == nullptr);
    const auto lines = printed(loaded.problems);
    CHECK(std::any_of(lines.begin(), lines.end(), [](const std::string& line) {
      return line.find("go in a circle") != std::string::npos;
    }));
  }
}

TEST_CASE("messages: a bit rate of a DBC file is one that a bus can have, or none") {
  const auto rate = [](const std::string& text) {
    const std::string name = text.substr(0, text.find(' '));
    return parse("BO_ 1 A: 8 X\nBA_DEF_ \"" + name + "\" INT 0 100000000;\nBA_ \"" + name + "\" " +
                     text.substr(text.find(' ') + 1) + ";\n",
                 {}, "f.dbc");
  };
  CHECK(rate("Baudrate 999").bit_rate == 0);
  CHECK(rate("Baudrate 1000").bit_rate == 1'000);
  CHECK(rate("Baudrate 1000000").bit_rate == 1'000'000);
  CHECK(rate("Baudrate 1000001").bit_rate == 0);
  CHECK(rate("Baudrate 500000").data_bit_rate == 0);
  CHECK(rate("BaudrateCANFD 999").data_bit_rate == 0);
  CHECK(rate("BaudrateCANFD 1000").data_bit_rate == 1'000);
  CHECK(rate("BaudrateCANFD 16000000").data_bit_rate == 16'000'000);
  CHECK(rate("BaudrateCANFD 16000001").data_bit_rate == 0);
  CHECK(rate("BaudrateCANFD 2000000").bit_rate == 0);

  const std::string usual =
      "BO_ 1 A: 8 X\nBA_DEF_ \"Baudrate\" INT 0 100000000;\nBA_DEF_DEF_ \"Baudrate\" 250000;\n";
  CHECK(parse(usual, {}, "f.dbc").bit_rate == 250'000);
  CHECK(parse(usual + "BA_ \"Baudrate\" 500000;\n", {}, "f.dbc").bit_rate == 500'000);
  CHECK(parse("BO_ 1 A: 8 X\nBA_DEF_ BO_ \"Baudrate\" INT 0 100000000;\nBA_DEF_DEF_ \"Baudrate\" 250000;\n",
              {}, "f.dbc")
            .bit_rate == 0);
}

TEST_CASE("messages: the data of a DBC file's bus are no slower than the rest") {
  const auto of_data = [](const std::string& rate) {
    return parse(
               "BO_ 1 A: 8 X\nBA_DEF_ \"Baudrate\" INT 0 100000000;\nBA_DEF_ \"BaudrateCANFD\" INT 0 "
               "100000000;\nBA_ \"Baudrate\" 500000;\nBA_ \"BaudrateCANFD\" " +
                   rate + ";\n",
               {}, "f.dbc")
        .data_bit_rate;
  };
  CHECK(of_data("499999") == 0);
  CHECK(of_data("500000") == 500'000);
  CHECK(of_data("500001") == 500'001);
}

TEST_CASE("messages: what a signal of a DBC file can hold is what its bits can") {
  const Model model =
      parse("BO_ 1 A: 8 X\n SG_ S : 0|12@1- (1,0) [0|0] \"\" X\n SG_ U : 12|12@1+ (1,0) [0|0] \"\" X\n", {},
            "f.dbc");
  const auto& fields = model.messages.at(0).fields;
  CHECK(fields.at(0).raw_min == -2048);
  CHECK(fields.at(0).raw_max == 2047);
  CHECK(fields.at(1).raw_min == 0);
  CHECK(fields.at(1).raw_max == 4095);
}

TEST_CASE("messages: C++ has no name for a value that the bits of its field cannot hold") {
  const Model model = parse(
      "BO_ 1 A: 8 X\n SG_ U : 0|2@1+ (1,0) [0|0] \"\" X\n SG_ S : 8|2@1- (1,0) [0|0] \"\" X\n"
      "VAL_ 1 U 3 \"Most\" 4 \"Beyond\" ;\nVAL_ 1 S -3 \"Below\" -2 \"Least\" ;\n",
      {}, "f.dbc");
  const auto* cpp = generate::find_target("cpp");
  REQUIRE(cpp != nullptr);
  const std::string text = cpp->make(model, {});
  const auto has = [&text](const char* name) { return text.find(name) != std::string::npos; };
  CHECK(has("Most"));
  CHECK(has("Least"));
  CHECK_FALSE(has("Beyond"));
  CHECK_FALSE(has("Below"));
}

TEST_CASE("messages: of a DBC file those are kept that one frame carries, of J1939 several") {
  const auto of_length = [](const std::string& id, const std::string& length,
                            const std::vector<std::string>& doubts = {}) {
    return parse("BO_ 1 Other: 8 X\nBO_ " + id + " A: " + length +
                     " X\nBA_DEF_ BO_ \"VFrameFormat\" ENUM \"StandardCAN\",\"ExtendedCAN\",\"J1939PG\";\n"
                     "BA_ \"VFrameFormat\" BO_ 2566844672 2;\n",
                 doubts, "f.dbc");
  };
  const std::string no_group =
      "f.dbc:4: the attribute VFrameFormat is of a message 2566844672, which is not in the file; left out";
  const Model longest = of_length("2", "64", {no_group});
  REQUIRE(longest.messages.size() == 2);
  CHECK(longest.messages[1].length == 64);
  CHECK(longest.too_long.empty());
  const Model longer =
      of_length("2", "65", {no_group, "f.dbc:2: A has 65 bytes; it is left out: a frame has at most 64"});
  CHECK(longer.messages.size() == 1);
  CHECK(longer.too_long == std::vector<std::string>{"A"});
  const Model group = of_length("2566844672", "1785");
  REQUIRE(group.messages.size() == 2);
  CHECK(group.messages[1].is_j1939());
  CHECK(group.messages[1].length == 1785);
  CHECK(group.too_long.empty());
}

TEST_CASE("messages: more nodes than a catalogue has place for") {
  std::string text;
  for (int i = 0; i < 300; ++i)
    text += "BO_ " + std::to_string(i) + " M" + std::to_string(i) + ": 8 N" + std::to_string(i) + "\n";
  const Model model =
      parse(text, {"f.dbc:1: 300 nodes; the first 255 are kept: messages of others have no sender"}, "f.dbc");
  CHECK(model.boards.size() == 255);
  CHECK(model.messages[254].board == 254);
  CHECK(model.messages[255].board == protocol::no_board);
  for (const auto& target : generate::targets()) {
    CAPTURE(target.name);
    CHECK_FALSE(target.make(model, {}).empty());
  }
}

TEST_CASE("messages: what a DBC file says of its attributes themselves is kept both ways") {
  const std::string text =
      "BU_: N\nBO_ 1 A: 8 N\n SG_ a : 0|8@1+ (1,0) [0|0] \"\" N\nBO_ 2 B: 8 N\n"
      "BA_DEF_ \"Protocol\" STRING ;\nBA_DEF_DEF_ \"Protocol\" \"a \\\"car\\\"\";\n"
      "BA_DEF_ \"ProtocolType\" STRING ;\nBA_DEF_DEF_ \"ProtocolType\" \"J1939\";\n"
      "BA_DEF_ BO_ \"VFrameFormat\" ENUM \"StandardCAN\",\"ExtendedCAN\";\n"
      "BA_DEF_ BU_ \"Layer\" HEX 0 255;\nBA_DEF_DEF_ \"Layer\" 16;\n"
      "BA_DEF_ BO_ \"Support\" ENUM \"No\",\"Yes\",\"Maybe, not\";\nBA_DEF_DEF_ \"Support\" \"Yes\";\n"
      "BA_DEF_ BO_ \"Digit\" ENUM \"1\",\"0\";\nBA_DEF_DEF_ \"Digit\" \"0\";\n"
      "BA_DEF_ SG_ \"Weight\" FLOAT -1.5E+10 2.5;\nBA_DEF_DEF_ \"Weight\" 0.25;\n"
      "BA_DEF_ SG_ \"Unused\" INT 0 7;\n"
      "BA_ \"Support\" BO_ 1 2;\nBA_ \"Digit\" BO_ 1 \"1\";\nBA_ \"Weight\" SG_ 1 a 1;\nBA_ \"Layer\" BU_ N "
      "17;\n";
  const Model model = parse(text, {}, "f.dbc");
  REQUIRE(model.definitions.size() == 7);
  CHECK(model.definitions[3].values == std::vector<std::string>{"No", "Yes", "Maybe, not"});
  CHECK(model.definitions[3].default_text == "Yes");
  CHECK(model.definitions[5].min == "-1.5E+10");
  CHECK(model.messages[0].attributes ==
        std::vector<spec::AttributeModel>{{"Support", "Maybe, not"}, {"Digit", "1"}});
  check_both_ways(model);
  // And from one to the other.
  const Model from_json = parse(generate::make_spec(model, {"f.dbc", std::nullopt}));
  CHECK(from_json.definitions == model.definitions);
  CHECK(parse(generate::make_dbc(from_json, {"f.json", std::nullopt}), {}, "f.dbc").definitions ==
        model.definitions);
}

TEST_CASE("messages: definitions of attributes that cannot be") {
  const auto problem = [](const std::string& definition) {
    const auto loaded = spec::parse(R"({"robot": "r", "messages": [{"name": "M", "id": 1, "fields": []}],
      "attribute_definitions": [)" + definition +
                                        "]}",
                                    "f.json");
    REQUIRE_FALSE(loaded.problems.empty());
    return loaded.problems[0].what;
  };
  CHECK(problem(R"({"of": "message", "name": "a", "type": "enum"})") == "an enumeration without \"values\"");
  CHECK(problem(R"({"of": "message", "name": "a", "type": "int", "values": ["x"]})") ==
        "\"values\" of another type");
  CHECK(problem(R"({"of": "signal", "name": "a", "type": "int"})") == "\"signal\" is not known here");
  CHECK(problem(R"({"of": "bus", "name": "a", "type": "int", "min": "1"})") == "one bound of two");
  CHECK(problem(R"({"of": "bus", "name": "a", "type": "string", "min": "1", "max": "2"})") ==
        "\"1\" is no bound of this type");
}

TEST_CASE("messages: what our JSON and a new DBC file do not keep of a DBC file is named with its number") {
  const Model model = parse(
      "VERSION \"3\"\nBU_: N\nVAL_TABLE_ T 0 \"a\" ;\nBO_ 1 A: 8 N\n SG_ a : 0|8@1+ (1,0) [0|0] \"\" N\n"
      "BO_ 3221225472 VECTOR__INDEPENDENT_SIG_MSG: 0 Vector__XXX\n SG_ o : 0|8@1+ (1,0) [0|0] \"\" N\n"
      " SG_ p : 0|8@1+ (1,0) [0|0] \"\" N\nEV_ e: 0 [0|0] \"\" 0 1 DUMMY_NODE_VECTOR0 Vector__XXX;\n"
      "BA_DEF_REL_ BU_SG_REL_ \"R\" INT 0 1;\nBA_DEF_ EV_ \"E\" INT 0 1;\n"
      "SIG_GROUP_ 1 G 1 : a;\nSIG_GROUP_ 1 H 1 : a;\n",
      {}, "f.dbc");
  for (const char* name : {"dbc", "spec"})
    CHECK(generate::left_out(*generate::find_target(name), model) ==
          std::vector<std::string>{
              "1 BA_DEF_ EV_", "1 VERSION", "1 VAL_TABLE_, the values of which are with their signals",
              "2 signals of VECTOR__INDEPENDENT_SIG_MSG", "1 EV_", "1 BA_DEF_REL_", "2 SIG_GROUP_"});
}

/// Messages at random, of what both formats can say.
class RandomModel {
 public:
  explicit RandomModel(unsigned seed) : random_(seed) {}

  Model make() {
    Model model;
    model.robot = "x";
    if (one_in(2)) model.description = text();
    if (one_in(2)) {
      model.bit_rate = 250'000;
      model.attributes.push_back({"Baudrate", "250000"});
    }
    add_attributes(model.attributes);
    for (std::uint64_t i = up_to(3); i-- > 0;) {
      model.boards.push_back({});
      model.boards.back().name = name();
      if (one_in(2)) model.boards.back().description = text();
      add_attributes(model.boards.back().attributes);
    }
    const bool starts = one_in(3);
    for (std::uint64_t i = 1 + up_to(4); i-- > 0;) model.messages.push_back(message(model, starts));
    return model;
  }

 private:
  std::uint64_t up_to(std::uint64_t most) {
    return std::uniform_int_distribution<std::uint64_t>{0, most}(random_);
  }
  bool one_in(std::uint64_t n) { return up_to(n - 1) == 0; }
  /// Each time another one; sometimes longer than DBC has it, sometimes with characters that it has not.
  std::string name() {
    static constexpr std::string_view letters = "abcXYZ_0189";
    std::string out = "n" + std::to_string(++names_) + (one_in(8) ? "-\u00e4." : "");
    for (std::uint64_t i = one_in(5) ? 20 + up_to(30) : up_to(6); i-- > 0;)
      out += letters[up_to(letters.size() - 1)];
    return out;
  }
  std::string text() {
    static constexpr std::string_view parts[] = {"a",     " ",      "\"", "\\", "\n", ";", "\u00e4\u00b0",
                                                 "BO_ 1", "\u20ac", "1"};
    std::string out;
    for (std::uint64_t i = up_to(8); i-- > 0;) out += parts[up_to(std::size(parts) - 1)];
    if (one_in(20)) out += "\u4e2d";  // in no code page of Windows' Latin
    return out + "x";                 // not a backslash
  }
  base::Decimal decimal() {
    return base::normalised(static_cast<std::int64_t>(up_to(20'000)) - 10'000,
                            static_cast<int>(up_to(8)) - 6);
  }
  void add_attributes(std::vector<spec::AttributeModel>& to) {
    if (one_in(3)) to.push_back({"Whole", std::to_string(up_to(100))});
    if (one_in(3)) to.push_back({"Any", one_in(2) ? "0.5" : text()});
    if (one_in(3)) to.push_back({"Text", text()});
  }

  /// Of a board that there is from now on.
  std::string board(Model& model) {
    model.boards.emplace_back();
    return model.boards.back().name = name();
  }
  MessageModel message(Model& model, bool starts) {
    MessageModel out;
    out.name = name();
    if (one_in(2)) out.description = text();
    out.address.by = Address::By::identifier;
    out.address.extended = one_in(2);
    if (out.address.extended && one_in(3)) out.address.by = Address::By::pgn;
    out.address.number = static_cast<std::uint32_t>(up_to(out.address.extended ? 0x1FFF'FFFF : 0x7FF));
    const std::uint64_t most = out.is_j1939() ? 200 : one_in(2) ? 8 : 64;
    out.length = static_cast<std::uint16_t>(up_to(most));
    out.fd = !out.is_j1939() && (out.length > 8 || one_in(8));
    if (!model.boards.empty() && one_in(2))
      out.board = static_cast<std::uint8_t>(up_to(model.boards.size() - 1));
    if (out.board != protocol::no_board && one_in(4)) out.other_senders.push_back(board(model));
    if (one_in(2)) out.period = std::chrono::microseconds{1 + up_to(2'000'000)};
    if (one_in(4)) out.shortest_period = std::chrono::milliseconds{1 + up_to(1000)};
    if (one_in(3)) out.send_type = one_in(2) ? "Cyclic" : text();
    add_attributes(out.attributes);
    if (out.length == 0) return out;
    for (std::uint64_t i = up_to(6); i-- > 0;) out.fields.push_back(field(model, out, starts));
    return out;
  }

  FieldModel field(Model& model, const MessageModel& message, bool starts) {
    FieldModel out;
    out.name = name();
    if (one_in(3)) out.description = text();
    out.position.order = one_in(2) ? ByteOrder::little : ByteOrder::big;
    const std::uint64_t kind = message.length >= 8 ? up_to(5) : 5;
    if (kind < 2) out.number = kind == 0 ? Number::float32 : Number::float64;
    const unsigned most = std::min<unsigned>(64, 8U * message.length);
    do {
      out.position.width = static_cast<std::uint8_t>(kind == 0 ? 32 : kind == 1 ? 64 : 1 + up_to(most - 1));
      out.position.start = static_cast<std::uint16_t>(up_to(8U * message.length - 1));
    } while (out.position.bytes() > message.length);
    out.is_signed = kind > 1 && one_in(2);
    if (one_in(2)) out.scale = decimal();
    if (out.scale.digits == 0) out.scale = {1, 0};
    if (one_in(2)) out.offset = decimal();
    if (one_in(2)) out.unit = text();
    if (one_in(3))
      out.range = spec::RangeModel{{-5, 0}, base::normalised(static_cast<std::int64_t>(up_to(1000)) + 1, -2)};
    if (kind > 1 && one_in(3))
      for (std::uint64_t i = up_to(4); i-- > 0;)
        out.values.push_back({text(), static_cast<std::int64_t>(up_to(5)) - (out.is_signed ? 2 : 0)});
    if (starts || one_in(4)) {
      const auto start =
          out.start_from(kind < 2 ? std::string{base::to_text(decimal()).view()} : std::to_string(up_to(1)));
      out.start = start;
    }
    if (one_in(3)) out.receivers.push_back(board(model));
    add_attributes(out.attributes);
    if (!message.fields.empty() && one_in(2)) select(message, out);
    return out;
  }
  /// By any field before it, so that there is no circle.
  void select(const MessageModel& message, FieldModel& out) {
    const FieldModel& selector = message.fields[up_to(message.fields.size() - 1)];
    if (selector.number != Number::integer) return;
    out.selector = selector.name;
    std::uint64_t first = 0;
    for (std::uint64_t i = 1 + up_to(2); i-- > 0;) {
      first += up_to(9);
      const std::uint64_t last = first + (one_in(2) ? 0 : up_to(5));
      out.selected.push_back({first, last});
      first = last + 1;
    }
  }

  std::mt19937_64 random_;
  unsigned names_ = 0;
};

TEST_CASE("messages: any that both formats can say come back from each as they were") {
  for (unsigned seed = 1, last = static_cast<unsigned>(ocm::test::explored(300)); seed <= last; ++seed) {
    CAPTURE(seed);
    check_both_ways(RandomModel{seed}.make());
  }
}

TEST_CASE("messages: what a DBC file has no place for is reported") {
  const auto* dbc = generate::find_target("dbc");
  REQUIRE(dbc != nullptr);
  const Model model = parse(R"({"robot": "r", "messages": [
    {"name": "A", "alias": ["a"], "id": 1, "deadline": "1ms", "jitter": "1ms",
     "fields": [{"name": "f", "type": "u8", "byte": 0, "flags": {"x": 0}, "range": [0, 0], "unit": "\\"}]},
    {"name": "B", "alias": ["b"], "id": 2, "fields": []}]})");
  CHECK(generate::left_out(*dbc, model) ==
        std::vector<std::string>{
            "other names of A and 1 more", "deadlines of A", "jitter of A", "names of flags of A",
            "the end of texts at a backslash, which gets a blank behind it, of A", "a range of [0, 0] of A"});
  CHECK(generate::has_any(*dbc, model));
  const generate::Target of_topics{"own", "", nullptr};
  CHECK(generate::left_out(of_topics, model) == std::vector<std::string>{"all 2 messages"});
  CHECK_FALSE(generate::has_any(of_topics, model));
  Model topics;
  topics.topics.resize(3);
  const auto* spec = generate::find_target("spec");
  REQUIRE(spec != nullptr);
  CHECK(generate::left_out(*spec, topics) == std::vector<std::string>{"all 3 topics"});
  CHECK_FALSE(generate::has_any(*spec, topics));
}

}  // namespace generator_messages_test
