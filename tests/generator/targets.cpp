// What generated files make of names, texts and numbers that few specs have, at the edges of each.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "generator/spec/spec.hpp"
#include "generator/targets/cpp_messages.hpp"
#include "generator/targets/dbc_names.hpp"
#include "generator/targets/message_fields.hpp"
#include "generator/targets/target.hpp"

namespace generator_targets_test {

using namespace ocm;

/// What a target makes of a spec.
std::string made(std::string_view target, const std::string& text, const std::string& name = "f.json") {
  const auto loaded = spec::parse(text, name);
  for (const auto& problem : loaded.problems) UNSCOPED_INFO(problem.place << ": " << problem.what);
  REQUIRE(loaded.spec != nullptr);
  const auto* found = generate::find_target(target);
  REQUIRE(found != nullptr);
  return found->make(loaded.spec->model(), {name, {}});
}
bool has(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}
/// A spec of one topic.
std::string of_topic(const std::string& fields) {
  return R"({"robot": "r", "namespace": "r", "bus": {"bit_rate": 500000, "source": "s"},
    "boards": [{"name": "b", "mcu": "m", "source": "s"}],
    "topics": [{"name": "t", "id": "0x10", "board": "b", "source": "s", "frames": [{"fields": [)" +
         fields + "]}]}]}";
}

TEST_CASE("targets: letters and digits of a name stay, all else becomes an underscore") {
  CHECK(generate::cpp_name("azAZ09") == "azAZ09");
  CHECK(generate::cpp_name("0a9") == "n0a9");
  CHECK(generate::cpp_name("9") == "n9");
  for (const char c : std::string_view{"/:@[`{ .-+\x7F\xC3"}) {
    CAPTURE(c);
    CHECK(generate::cpp_name(std::string{"a"} + c + "b") == "a_b");
  }
  CHECK(generate::cpp_name("a.-b") == "a_b");
  CHECK(generate::cpp_name("a_b_") == "a_b_");
  CHECK(generate::cpp_name("__a") == "a");
  CHECK(generate::cpp_name("") == "n");
  CHECK(generate::cpp_name("!?") == "n");
  for (const char* word : {"int", "class", "EOF", "HUGE_VAL", "INFINITY", "NAN", "NULL"})
    CHECK(generate::cpp_name(word) == std::string{word} + "_");
  CHECK(generate::cpp_name("Null") == "Null");
}

TEST_CASE("targets: a comment has no control character and no backslash") {
  CHECK(generate::comment_text("a\x1F b\x7F"
                               "c\td\\e~ f") == "a  b c d/e~ f");
  CHECK(generate::comment_text("").empty());
}

TEST_CASE("targets: a literal of C++ has control characters as three digits") {
  const std::string text = made("cpp", "BO_ 1 A\x1F\x7F: 8 N\x01\n", "f.dbc");
  CHECK(has(text, R"( name = "A\037\177";)"));
  CHECK(has(text, R"( sender = "N\001";)"));
}

TEST_CASE("targets: flags of all bits that a field has") {
  const std::string text = made(
      "cpp", of_topic(R"({"name": "x", "byte": 0, "type": "u63", "flags": {"low": 0, "seven": 7, "eight": 8,
                             "half": 31, "more": 32, "most": 62}})"));
  CHECK(has(text, " low_flag = 0x01;"));
  CHECK(has(text, " seven_flag = 0x80;"));
  CHECK(has(text, " eight_flag = 0x0100;"));
  CHECK(has(text, " half_flag = 0x80000000;"));
  CHECK(has(text, " more_flag = 0x0100000000;"));
  CHECK(has(text, " most_flag = 0x4000000000000000;"));
}

TEST_CASE("targets: an attribute of whole numbers in a DBC file, as long as 32 bits hold them") {
  const auto type = [](const std::string& value) {
    const std::string text = made("dbc", R"({"robot": "r", "messages": [{"name": "M", "id": 1, "fields": [],
      "attributes": {"K": ")" + value + R"("}}]})");
    const std::string head = "BA_DEF_ BO_ \"K\" ";
    REQUIRE(has(text, head));
    const auto at = text.find(head) + head.size();
    return text.substr(at, text.find(' ', at) - at);
  };
  CHECK(type("0") == "INT");
  CHECK(type("2147483647") == "INT");
  CHECK(type("2147483648") == "FLOAT");
  CHECK(type("3000000000") == "FLOAT");
  CHECK(type("2000000000") == "INT");
  CHECK(type("-2147483648") == "INT");
  CHECK(type("-2147483649") == "FLOAT");
  CHECK(type("0.5") == "FLOAT");
  CHECK(type("2.0") == "FLOAT");
  CHECK(type("1e3") == "FLOAT");
  CHECK(type("1E3") == "FLOAT");
  CHECK(type("one") == "STRING");
}

TEST_CASE("targets: a DBC file of topics is of a classic bus, and one of messages does not say") {
  const std::string field = R"({"name": "x", "byte": 0, "type": "u8"})";
  const std::string topics = made("dbc", of_topic(field));
  CHECK(has(topics, "BA_DEF_ \"BusType\" STRING ;\n"));
  CHECK(has(topics, "BA_DEF_DEF_ \"BusType\" \"CAN\";\n"));
  CHECK(has(topics, "BA_ \"BusType\" \"CAN\";\n"));
  CHECK(has(topics, "BA_DEF_ \"Baudrate\" INT 1000 1000000;\n"));
  CHECK(has(topics, "BA_ \"Baudrate\" 500000;\n"));
  CHECK_FALSE(has(topics, "BaudrateCANFD"));
  const std::string messages =
      made("dbc", R"({"robot": "r", "messages": [{"name": "M", "id": 1, "fields": [)" + field + "]}]}");
  CHECK_FALSE(has(messages, "BusType"));
  CHECK_FALSE(has(messages, "Baudrate"));
}

TEST_CASE("targets: in a spec the byte order of most fields is said once") {
  const auto spec_of = [](const std::string& fields) {
    return made("spec",
                R"({"robot": "r", "messages": [{"name": "M", "id": 1, "fields": [)" + fields + "]}]}");
  };
  const std::string little = R"({"name": "a", "byte": 0, "type": "u8"})";
  const std::string big = R"({"name": "b", "byte": 1, "type": "u8", "byte_order": "big"})";
  const std::string another = R"({"name": "c", "byte": 2, "type": "u8", "byte_order": "big"})";
  CHECK_FALSE(has(spec_of(""), "byte_order"));
  CHECK_FALSE(has(spec_of(little), "byte_order"));
  const std::string equal = spec_of(little + "," + big);
  CHECK_FALSE(has(equal, "\n  \"byte_order\""));
  CHECK(has(equal, R"({ "name": "a", "byte": 0, "type": "u8" })"));
  CHECK(has(equal, R"({ "name": "b", "byte": 1, "byte_order": "big", "type": "u8" })"));
  const std::string more = spec_of(little + "," + big + "," + another);
  CHECK(has(more, "\n  \"byte_order\": \"big\",\n"));
  CHECK(has(more, R"({ "name": "a", "byte": 0, "byte_order": "little", "type": "u8" })"));
  CHECK(has(more, R"({ "name": "b", "byte": 1, "type": "u8" })"));
}

TEST_CASE("targets: numbers of a selector are one range where there is none between them") {
  using Ranges = std::vector<protocol::SelectorRange>;
  const auto of = [](Ranges ranges, std::uint64_t most = 255) {
    return generate::in_ranges(ranges, most, "v", "1",
                               [](std::uint64_t number) { return std::to_string(number); });
  };
  CHECK(generate::merged({{1, 1}, {3, 3}}, 255) == Ranges{{1, 1}, {3, 3}});
  CHECK(generate::merged({{1, 1}, {2, 3}}, 255) == Ranges{{1, 3}});
  CHECK(generate::merged({{6, 9}, {4, 7}, {1, 1}}, 255) == Ranges{{1, 1}, {4, 9}});
  CHECK(generate::merged({{4, 9}, {5, 6}}, 255) == Ranges{{4, 9}});
  CHECK(generate::merged({{0, UINT64_MAX}, {5, 6}}, UINT64_MAX) == Ranges{{0, UINT64_MAX}});
  CHECK(of({}).empty());
  CHECK(of({{0, 0}}) == "v == 0");
  CHECK(of({{1, 1}, {3, 3}}) == "v == 1 || v == 3");
  CHECK(of({{1, 1}, {2, 2}}) == "(v >= 1 && v <= 2)");
  CHECK(of({{0, 7}}) == "v <= 7");
  CHECK(of({{0, 254}}) == "v <= 254");
  CHECK(of({{0, 255}}) == "1");
  CHECK(of({{0, 300}}) == "1");
  CHECK(of({{4, 254}}) == "(v >= 4 && v <= 254)");
  CHECK(of({{4, 255}}) == "v >= 4");
  CHECK(of({{4, 300}}) == "v >= 4");
  CHECK(of({{255, 300}}) == "v == 255");
  CHECK(of({{256, 300}}).empty());
}

TEST_CASE("targets: a parameter group has a destination below 240, which is no part of it") {
  const auto group = [](std::uint32_t identifier) {
    return generate::group_of({protocol::Address::By::pgn, true, identifier});
  };
  CHECK(group(0x0CEF2103) == 0xEF00);
  CHECK(group(0x0CF02103) == 0xF021);
  CHECK(group(0x18FEF1FE) == 0xFEF1);
  CHECK(group(0x19FEF1FE) == 0x1FEF1);
  CHECK(group(0x1BFFFFFF) == 0x3FFFF);
  CHECK(group(0x00000000) == 0);
}

TEST_CASE("targets: names of a DBC file have 32 characters, and each is given out once") {
  const std::string longest(32, 'a'), cut(30, 'a');
  generate::DbcNames names;
  CHECK(names.unique("azAZ09_") == "azAZ09_");
  CHECK(names.unique(longest) == longest);
  CHECK(names.unique(longest + "b") == cut + "_2");
  CHECK(names.unique(longest + "c") == cut + "_3");
  CHECK(names.unique("9a") == "_9a");
  CHECK(names.unique("0") == "_0");
  CHECK(names.unique("") == "_");
  CHECK(names.unique("on", "_high") == "on_high");
  CHECK(names.unique("on", "_high") == "on_2_high");
  for (const char c : std::string_view{"/:@[`{ .-"}) {
    CAPTURE(c);
    CHECK(generate::DbcNames{}.unique(std::string{"a"} + c + "b") == "a_b");
  }
  // A name that is still to come goes to what has it.
  generate::DbcNames expecting;
  expecting.expect(longest);
  expecting.expect("b-d");  // none that it could have
  CHECK(expecting.unique(longest + "b") == cut + "_2");
  CHECK(expecting.unique(longest) == longest);
  CHECK(expecting.unique("b_d") == "b_d");
  generate::DbcNames other;
  other.expect(longest + "b");
  CHECK(other.unique(longest + "c") == longest);
}

TEST_CASE(
    "targets: in C++ the second value of one name has its number behind it, 0 too, and no name that is "
    "taken") {
  const std::string text = made("cpp", R"({"robot": "r", "messages": [{"name": "M", "id": 1, "fields": [
        {"name": "x", "byte": 0, "type": "u8", "values": [{"raw": 1, "name": "a.b"}, {"raw": 0, "name": "a-b"},
         {"raw": 5, "name": "a_b_7"}, {"raw": 7, "name": "a b"}, {"raw": 9, "name": "c"}]}]}]})");
  CHECK(has(text, "    a_b = 1,\n    a_b_0 = 0,\n    a_b_7 = 5,\n    a_b_7_ = 7,\n    c = 9,\n"));
  const std::string below = made("cpp", R"({"robot": "r", "messages": [{"name": "M", "id": 1, "fields": [
        {"name": "x", "byte": 0, "type": "i64", "values": [{"raw": 1, "name": "a.b"}, {"raw": -1, "name": "a-b"},
         {"raw": -9223372036854775807, "name": "a b"}]}]}]})");
  CHECK(has(below,
            "    a_b = 1,\n    a_b_minus_1 = -1,\n    a_b_minus_9223372036854775807 = "
            "-9'223'372'036'854'775'807,\n"));
}

TEST_CASE("targets: a DBC file says how often messages come, where any message says so") {
  const auto times = [](const std::string& members) {
    return made("dbc", R"({"robot": "r", "messages": [{"name": "M", "id": 1, "fields": []},
      {"name": "N", "id": 2)" +
                           members + R"(, "fields": []}]})");
  };
  for (const auto& [member, attribute] :
       {std::pair{"period", "GenMsgCycleTime"}, std::pair{"shortest_period", "GenMsgDelayTime"}}) {
    CAPTURE(member);
    const auto with = [&, name = std::string{member}](const std::string& time) {
      return times(", \"" + name + "\": \"" + time + "\"");
    };
    const std::string definition = "BA_DEF_ BO_ \"" + std::string{attribute} + "\" ";
    const std::string value = "BA_ \"" + std::string{attribute} + "\" BO_ ";
    CHECK_FALSE(has(times(""), attribute));
    CHECK_FALSE(has(times(""), "GenMsg"));
    CHECK(has(with("10ms"), definition + "INT 0 2147483647 ;\n"));
    CHECK(has(with("10ms"), value + "2 10;\n"));
    CHECK_FALSE(has(with("10ms"), value + "1 "));
    CHECK(has(with("500us"), definition + "FLOAT 0 2147483647 ;\n"));
    CHECK(has(with("500us"), value + "2 0.5;\n"));
    const std::string_view other = attribute == std::string_view{"GenMsgDelayTime"} ? "Cycle" : "Delay";
    CHECK_FALSE(has(with("10ms"), other));
  }
}

TEST_CASE("targets: in a spec CAN FD is said where the length does not say it") {
  const auto said = [](const std::string& members) {
    const std::string text =
        made("spec", R"({"robot": "r", "messages": [{"name": "M", )" + members + R"(, "fields": []}]})");
    return std::string{has(text, R"("fd": true)") ? "true" : has(text, R"("fd")") ? "other" : "nothing"};
  };
  CHECK(said(R"("id": 1, "length": 8)") == "nothing");
  CHECK(said(R"("id": 1, "length": 8, "fd": true)") == "true");
  CHECK(said(R"("id": 1, "length": 9)") == "nothing");
  CHECK(said(R"("id": 1, "length": 64, "fd": true)") == "nothing");
  CHECK(said(R"("pgn": "0xFEF1", "length": 8, "fd": true)") == "true");
  CHECK(said(R"("pgn": "0xFEF1", "length": 9)") == "nothing");
  CHECK(said(R"("pgn": "0xFEF1", "length": 9, "fd": true)") == "true");
}

TEST_CASE("targets: in C++ a number that not every double can hold becomes one in so many words") {
  const auto physical = [](const std::string& type) {
    return made("cpp", of_topic(R"({"name": "x", "byte": 0, "type": ")" + type + R"(", "unit": "V"})"));
  };
  for (const char* type : {"u8", "i32", "u32"})
    CHECK(has(physical(type), " x_V() const noexcept { return x; }\n"));
  for (const char* type : {"i33", "u33", "u63", "i64"})
    CHECK(has(physical(type), " x_V() const noexcept { return static_cast<double>(x); }\n"));
}

/// Whether a header has a line as it is, and not what it is broken into: up to 110 columns.
void check_fits(const std::string& text, const std::string& line, const std::string& broken) {
  CAPTURE(line, line.size());
  CHECK(has(text, "\n" + line + "\n") == (line.size() <= 110));
  CHECK(has(text, "\n" + broken + "\n") == (line.size() > 110));
}

TEST_CASE("targets: a line of C++ may be full, and is broken where it has one letter more") {
  for (const std::size_t size : {11U, 12U}) {
    const std::string rest(size - 1, 'a');
    const std::string text =
        made("cpp", R"({"robot": "r", "namespace": "r", "bus": {"bit_rate": 500000, "source": "s"},
          "boards": [{"name": "b", "mcu": "m", "source": "s"}], "topics": [{"name": "t)" +
                        rest + R"(", "id": 16, "board": "b", "source": "s",
          "frames": [{"name": "cccccc", "id": 16, "count": 2, "dlc": 0, "fields": []}]}]})");
    const std::string head = "    for (std::size_t i = 0; i < value.cccccc.size(); ++i)";
    const std::string body = "value.cccccc[i] = T" + rest + "Cccccc::decode(all[i]);";
    CHECK((head + " " + body).size() == 99 + size);
    check_fits(text, head + " " + body, head + "\n      " + body);
  }
  // A board's topics: on one line, or on a second one alone, or broken there, too.
  for (const std::size_t letters : {63U, 64U, 75U, 76U}) {
    const std::string first(39, 'a'), second(letters - 41, 'b');
    const auto topic = [](const std::string& name, int id) {
      return R"({"name": ")" + name + R"(", "id": )" + std::to_string(id) +
             R"(, "board": "b", "source": "s", "frames": [{"dlc": 0, "fields": []}]})";
    };
    const std::string text =
        made("cpp", R"({"robot": "r", "namespace": "r", "bus": {"bit_rate": 500000, "source": "s"},
          "boards": [{"name": "b", "mcu": "m", "source": "s"}], "topics": [)" +
                        topic("a" + first, 16) + ", " + topic("b" + second, 17) + "]}");
    const std::string start = "  using sensors =", list = "ocm::protocol::TopicList<A" + first + ",";
    const std::string last = "B" + second + ">;";
    CAPTURE(letters);
    CHECK((start + " " + list + " " + last).size() == 47 + letters);
    CHECK(has(text, start + " " + list + " " + last + "\n") == (letters <= 63));
    CHECK(has(text, start + "\n      " + list + " " + last + "\n") == (letters > 63 && letters <= 75));
    CHECK(has(text, start + " " + list + "\n" + std::string(43, ' ') + last + "\n") == (letters > 75));
  }
}

TEST_CASE("targets: a comparison of C++ is broken where its second argument does not fit") {
  for (const std::size_t size : {23U, 24U}) {  // 109 columns and 111
    const std::string rest(size - 1, 'a');
    const std::string text =
        made("cpp", R"({"robot": "r", "namespace": "r", "bus": {"bit_rate": 500000, "source": "s"},
          "boards": [{"name": "b", "mcu": "m", "source": "s"}], "topics": [{"name": "t)" +
                        rest + R"(", "id": 16, "board": "b", "source": "s",
          "frames": [{"dlc": 0, "fields": []}]}]})");
    const std::string head = "  friend constexpr bool operator==(";
    const std::string argument = "const T" + rest + "&", tail = argument + ") = default;";
    CHECK((head + argument + ", " + tail).size() == 63 + 2 * size);
    check_fits(text, head + argument + ", " + tail,
               head + argument + ",\n" + std::string(head.size(), ' ') + tail);
  }
}

TEST_CASE("targets: a function of C++ is on one line, or its head is, or the head is broken, too") {
  for (const std::size_t size : {30U, 31U}) {
    const std::string name(size, 'a');
    const std::string text =
        made("cpp", of_topic(R"({"name": ")" + name + R"(", "byte": 0, "type": "u8", "flags": {"up": 0}})"));
    const std::string head = "  [[nodiscard]] constexpr bool up() const noexcept {";
    const std::string body = "return (" + name + " & up_flag) != 0;";
    CHECK((head + " " + body + " }").size() == 80 + size);
    check_fits(text, head + " " + body + " }", head + "\n    " + body + "\n  }");
  }
  for (const std::size_t size : {14U, 15U}) {
    const std::string rest(size - 1, 'a');
    const std::string text =
        made("cpp", R"({"robot": "r", "namespace": "r", "bus": {"bit_rate": 500000, "source": "s"},
          "boards": [{"name": "b", "mcu": "m", "source": "s"}], "topics": [{"name": "t)" +
                        rest + R"(", "id": 16, "board": "b", "source": "s",
          "frames": [{"dlc": 0, "fields": []}]}]})");
    const std::string head = "  [[nodiscard]] static constexpr T" + rest + " decode(";
    const std::string argument = "const std::array<ocm::can::Payload, 1>& all) noexcept {";
    CHECK((head + argument).size() == 96 + size);
    check_fits(text, head + argument, head + "\n      " + argument);
  }
  for (const auto& [type, name] : {std::pair{"16", "aaa"}, std::pair{"8", "aaaa"}}) {
    const std::string text = made("cpp", std::string{R"({"robot": "r", "messages": [{"name": "M", "id": 1,
      "fields": [{"name": ")"} + name + R"(", "byte": 0, "type": "u)" +
                                             type + R"("}]}]})");
    const std::string head =
        std::string{"  constexpr void set_"} + name + "(std::uint" + type + "_t value_) noexcept {";
    const std::string body = std::string{"ocm::protocol::write_field(bytes, "} + name + "_at, value_);";
    check_fits(text, head + " " + body + " }", head + "\n    " + body + "\n  }");
  }
}

TEST_CASE("targets: a named number of C++ is one that a compiler takes, whatever its size") {
  const std::string signed_values = R"({"least": -9223372036854775808, "near_least": -9223372036854775807,
    "below": -2147483649, "low": -2147483648, "near_low": -2147483647, "minus_one": -1, "zero": 0,
    "most": 9223372036854775807})";
  const std::string field = R"({"name": "x", "byte": 0, "type": "i64", "values": )" + signed_values + "}";
  for (const std::string& text :
       {made("cpp", of_topic(field)),
        made("cpp", R"({"robot": "r", "messages": [{"name": "M", "id": 1, "fields": [)" + field + "]}]}")})
    CHECK(has(text,
              " {\n    least = INT64_MIN,\n    near_least = -9'223'372'036'854'775'807,\n"
              "    below = -2'147'483'649,\n    low = INT32_MIN,\n    near_low = -2'147'483'647,\n"
              "    minus_one = -1,\n    zero = 0,\n    most = 9'223'372'036'854'775'807,\n  };\n"));
  CHECK(has(made("cpp", R"({"robot": "r", "messages": [{"name": "M", "id": 1, "fields": [
        {"name": "x", "byte": 0, "type": "u64", "values": {"zero": 0, "half": 9223372036854775807,
         "upper": 9223372036854775808, "all": 18446744073709551615}}]}]})"),
            " {\n    zero = 0,\n    half = 9'223'372'036'854'775'807,\n"
            "    upper = 9'223'372'036'854'775'808U,\n    all = 18'446'744'073'709'551'615U,\n  };\n"));
}

TEST_CASE("targets: a bus that names no namespace has its own name as one, in lower case") {
  const auto space = [](const std::string& robot, const std::string& name_space = {}) {
    spec::Model model;
    model.robot = robot;
    model.name_space = name_space;
    return generate::name_space_of(model);
  };
  CHECK(space("azAZ09") == "azaz09");
  CHECK(space("Small Car") == "small_car");
  CHECK(space("1st") == "n1st");
  CHECK(space("Robot", "other") == "other");
  // What none can be called has an underscore behind it.
  CHECK(space("Int") == "int_");
  CHECK(space("int") == "int_");
  CHECK(space("Ocm") == "ocm_");
  CHECK(space("STD") == "std_");
  CHECK(space("Ocm2") == "ocm2");
}

/// A field of the eight bits of a byte, that is there with these numbers of its selector.
spec::FieldModel field_of_byte(const std::string& name, unsigned byte, std::int64_t start,
                               const std::string& selector = {},
                               std::vector<protocol::SelectorRange> selected = {}) {
  spec::FieldModel field;
  field.name = name;
  field.position = {static_cast<std::uint16_t>(8 * byte), 8, protocol::ByteOrder::little};
  field.start = start;
  field.selector = selector;
  field.selected = std::move(selected);
  return field;
}

TEST_CASE("targets: a message begins with the start values of those fields that are there") {
  using Bytes = std::vector<std::uint8_t>;
  spec::MessageModel message;
  message.length = 6;
  message.fields = {field_of_byte("below", 1, 11, "page", {{0, 3}}),
                    field_of_byte("first", 2, 22, "page", {{4, 9}}),
                    field_of_byte("last", 3, 33, "page", {{0, 4}}),
                    field_of_byte("above", 4, 44, "page", {{5, 9}}),
                    field_of_byte("deep", 5, 55, "last", {{1, 1}, {33, 33}}),
                    field_of_byte("page", 0, 4)};
  CHECK(generate::start_bytes(message) == Bytes{4, 0, 22, 33, 0, 55, 0, 0});
  const auto levels = generate::selection_levels(message);
  REQUIRE(levels.size() == 6);
  for (const auto& [field, level] : {std::pair{0U, 1U}, {2U, 1U}, {4U, 2U}, {5U, 0U}}) {
    CAPTURE(field);
    CHECK(levels.at(&message.fields[field]) == level);
  }
  CHECK(generate::selector_of(message, message.fields[0]) == &message.fields[5]);
  CHECK(generate::selector_of(message, message.fields[5]) == nullptr);
  // What is selected by a field that the length does not hold is not there.
  message.length = 2;
  message.fields = {field_of_byte("own", 0, 7), field_of_byte("page", 2, 1),
                    field_of_byte("of_page", 1, 9, "page", {{0, 255}})};
  CHECK(generate::start_bytes(message) == Bytes{7, 0, 0, 0, 0, 0, 0, 0});
  const auto shorter = generate::selection_levels(message);
  REQUIRE(shorter.size() == 2);
  CHECK(shorter.at(&message.fields[0]) == 0);
  CHECK(shorter.at(&message.fields[2]) == 1);
  CHECK(generate::selector_of(message, message.fields[2]) == nullptr);
  CHECK(generate::fields_beyond(message) == std::vector<std::string>{"page"});
}

/// What stands behind these words on the first line of a text that has them; "none": no line has.
std::string behind(const std::string& text, const std::string& words) {
  const auto at = text.find(words);
  if (at == std::string::npos) return "none";
  const auto begin = at + words.size();
  return text.substr(begin, text.find('\n', begin) - begin);
}

TEST_CASE("targets: the times of a DBC file of topics are whole numbers where all of its periods are") {
  const auto type = [](const std::string& topic, const std::string& message) {
    const std::string text =
        made("dbc", R"({"robot": "r", "namespace": "r", "bus": {"bit_rate": 500000, "source": "s"},
          "boards": [{"name": "b", "mcu": "m", "source": "s"}], "topics": [{"name": "t", "id": "0x10", "board": "b",
          "source": "s", "frames": [{"dlc": 0, "fields": []}], "period": ")" +
                        topic + R"("}], "messages": [{"name": "M", "id": "0x7F0", "fields": [])" + message +
                        "}]}");
    return behind(text, "BA_DEF_ BO_ \"GenMsgCycleTime\" ");
  };
  CHECK(type("10ms", "") == "INT 0 65535000;");
  CHECK(type("10ms", R"(, "period": "20ms")") == "INT 0 65535000;");
  CHECK(type("1500us", "") == "FLOAT 0 65535000;");
  CHECK(type("10ms", R"(, "period": "1500us")") == "FLOAT 0 65535000;");
}

TEST_CASE("targets: how messages are sent is an enumeration of a DBC file where one can hold all of it") {
  const auto sent = [](const std::string& first, const std::string& second) {
    const auto member = [](const std::string& type) {
      return type.empty() ? "" : R"(, "send_type": ")" + type + "\"";
    };
    return made("dbc", R"({"robot": "r", "messages": [{"name": "M", "id": 1)" + member(first) +
                           R"(, "fields": []}, {"name": "N", "id": 2)" + member(second) +
                           R"(, "fields": []}]})");
  };
  const std::string definition = "BA_DEF_ BO_ \"GenMsgSendType\" ", value = "BA_ \"GenMsgSendType\" BO_ ";
  CHECK_FALSE(has(sent("", ""), "GenMsgSendType"));
  CHECK(behind(sent("Cyclic", "Once"), definition) == R"(ENUM "Cyclic","Once" ;)");
  CHECK(behind(sent("Cyclic", "Once"), value) == "2 1;");  // the first one is the default
  CHECK(behind(sent("Cyclic", "Cyclic"), definition) == R"(ENUM "Cyclic" ;)");
  CHECK_FALSE(has(sent("Cyclic", "Cyclic"), value));
  CHECK(behind(sent("Cyclic", "a b"), definition) == R"(ENUM "Cyclic","a b" ;)");
  CHECK(behind(sent("Cyclic", "7a"), definition) == R"(ENUM "Cyclic","7a" ;)");
  // Without one, of a character that a list cannot have, and of a number that would be that of a name.
  for (const char* other : {"", "a,b", R"(a\"b)", R"(a\\b)", "7", "0.5"}) {
    CAPTURE(other);
    for (const std::string& text : {sent("Cyclic", other), sent(other, "Cyclic")}) {
      CHECK(behind(text, definition) == "STRING ;");
      CHECK(behind(text, "BA_DEF_DEF_ \"GenMsgSendType\" ") == "\"\";");
    }
    CHECK(behind(sent("Cyclic", other), value + "1 ") == "\"Cyclic\";");
    CHECK(behind(sent(other, "Cyclic"), value + "2 ") == "\"Cyclic\";");
  }
  CHECK(behind(sent("Cyclic", "a,b"), value + "2 ") == "\"a,b\";");
  CHECK(behind(sent("Cyclic", "7"), value + "2 ") == "\"7\";");
}

TEST_CASE("targets: an attribute of a DBC file has one type, which all of its values have") {
  const auto with = [](const std::string& first, const std::string& second) {
    return made("dbc", R"({"robot": "r", "messages": [
      {"name": "M", "id": 1, "fields": [], "attributes": {"K": ")" +
                           first + R"("}}, {"name": "N", "id": 2, "fields": [], "attributes": {"K": ")" +
                           second + R"("}}]})");
  };
  const auto type = [&](const std::string& first, const std::string& second) {
    const std::string rest = behind(with(first, second), "BA_DEF_ BO_ \"K\" ");
    return rest.substr(0, rest.find(' '));
  };
  CHECK(type("1", "2") == "INT");
  CHECK(type("1", "2.5") == "FLOAT");
  CHECK(type("2.5", "1") == "FLOAT");
  for (const char* number : {"1", "2.5"}) {
    CAPTURE(number);
    CHECK(type(number, "one") == "STRING");
    CHECK(type("one", number) == "STRING");
    CHECK(behind(with(number, "one"), "BA_ \"K\" BO_ 1 ") == "\"" + std::string{number} + "\";");
    CHECK(behind(with(number, "one"), "BA_DEF_DEF_ \"K\" ") == "\"\";");
  }
  CHECK(behind(with("1", "2.5"), "BA_ \"K\" BO_ 1 ") == "1;");
  CHECK(behind(with("1", "2.5"), "BA_ \"K\" BO_ 2 ") == "2.5;");
  CHECK(behind(with("1", "2.5"), "BA_DEF_DEF_ \"K\" ") == "0;");
}

TEST_CASE("targets: a DBC file says what each frame is where there is CAN FD or another protocol") {
  const auto with = [](const std::string& members, const std::string& fd = {}) {
    return made("dbc", R"({"robot": "r", )" + members + R"("messages": [{"name": "M", "id": 1, "length": 8)" +
                           fd + R"(, "fields": []}, {"name": "W", "id": "0x18FEF100", "format": "extended",
                           "length": 8)" +
                           fd + R"(, "fields": []}]})");
  };
  const std::string value = "BA_ \"VFrameFormat\" BO_ ";
  CHECK_FALSE(has(with(""), "VFrameFormat"));
  CHECK_FALSE(has(with(R"("attributes": {"Maker": "x"}, )"), "VFrameFormat"));
  for (const char* members :
       {R"("attributes": {"ProtocolType": "J1939"}, )",
        R"("attribute_definitions": [{"of": "bus", "name": "ProtocolType", "type": "string"}], )"}) {
    CAPTURE(members);
    const std::string text = with(members);
    CHECK(behind(text, "BA_DEF_ BO_ \"VFrameFormat\" ")
              .starts_with(R"(ENUM "StandardCAN","ExtendedCAN","reserved","J1939PG",)"));
    CHECK(behind(text, value + "1 ") == "none");
    CHECK(behind(text, value + "2566844672 ") == "1;");
  }
  const std::string fd = with("", R"(, "fd": true)");
  CHECK(behind(fd, value + "1 ") == "14;");
  CHECK(behind(fd, value + "2566844672 ") == "15;");
}

TEST_CASE(
    "targets: a DBC file has the start values that are stated, and a default where all fields have one") {
  const auto with = [](const std::string& first, const std::string& second) {
    const auto member = [](const std::string& start) { return start.empty() ? "" : ", \"start\": " + start; };
    return made("dbc", R"({"robot": "r", "messages": [{"name": "M", "id": 1, "fields": [
      {"name": "a", "byte": 0, "type": "u32")" +
                           member(first) + R"(}, {"name": "b", "byte": 4, "type": "u32")" + member(second) +
                           "}]}]}");
  };
  const std::string definition = "BA_DEF_ SG_ \"GenSigStartValue\" ",
                    usual = "BA_DEF_DEF_ \"GenSigStartValue\" ", value = "BA_ \"GenSigStartValue\" SG_ 1 ",
                    whole = "INT -2147483648 2147483647 ;", real = "FLOAT -1e19 1e19 ;";
  CHECK_FALSE(has(with("", ""), "GenSigStartValue"));
  CHECK_FALSE(has(made("dbc", of_topic(R"({"name": "x", "byte": 0, "type": "u8"})")), "GenSigStartValue"));
  struct Row {
    const char* first;
    const char* second;
    std::string type;
    const char* usual;
    const char* a;
    const char* b;
  };
  for (const Row& row :
       {Row{"7", "", whole, "none", "7;", "none"}, Row{"0", "", whole, "none", "0;", "none"},
        Row{"", "7", whole, "none", "none", "7;"}, Row{"0", "0", whole, "0;", "none", "none"},
        Row{"0", "7", whole, "0;", "none", "7;"}, Row{"2147483647", "7", whole, "0;", "2147483647;", "7;"},
        Row{"2147483648", "7", real, "0;", "2147483648;", "7;"},
        Row{"7", "4294967295", real, "0;", "7;", "4294967295;"}}) {
    CAPTURE(row.first, row.second);
    const std::string text = with(row.first, row.second);
    CHECK(behind(text, definition) == row.type);
    CHECK(behind(text, usual) == row.usual);
    CHECK(behind(text, value + "a ") == row.a);
    CHECK(behind(text, value + "b ") == row.b);
  }
}

}  // namespace generator_targets_test
