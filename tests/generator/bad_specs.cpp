// bad_specs.json: what is changed in good.json, and all that must be said about it; bad_messages.json of
// good_messages.json.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "generator/spec/file.hpp"
#include "generator/spec/json.hpp"
#include "generator/spec/reader.hpp"
#include "generator/spec/spec.hpp"

namespace generator_bad_specs_test {

std::string read(const std::string& name) {
  std::ifstream in{std::string{OCM_SOURCE_DIR} + "/" + name, std::ios::binary};
  REQUIRE(in);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::vector<std::string> printed(const std::vector<ocm::spec::Problem>& problems) {
  std::vector<std::string> lines;
  for (const auto& p : problems) lines.push_back(p.place + ": " + p.what + "; " + p.remedy);
  return lines;
}

/// The table of what is wrong, and the spec that it changes.
struct Mistakes {
  const char* table;
  const char* good;
  std::size_t rows;  ///< at least
};
constexpr Mistakes all_mistakes[] = {
    {"tests/generator/bad_specs.json", "tests/generator/good.json", 100},
    {"tests/generator/bad_messages.json", "tests/generator/good_messages.json", 60},
};

TEST_CASE("the specs that the bad ones are made from are good") {
  for (const Mistakes& each : all_mistakes) {
    const auto loaded = ocm::spec::parse(read(each.good), each.good);
    CHECK(printed(loaded.problems).empty());
    CHECK(printed(loaded.doubts).empty());
    CHECK(loaded.spec != nullptr);
  }
}

TEST_CASE("every mistake is reported with its place, what is wrong and what would be right") {
  for (const Mistakes& each : all_mistakes) {
    const std::string good = read(each.good);
    const auto table = nlohmann::json::parse(read(each.table));
    REQUIRE(table.size() >= each.rows);
    for (const auto& row : table) {
      const std::string from = row.at("replace");
      const std::string to = row.at("by");
      CAPTURE(each.good, from, to);
      std::string text = good;
      const auto at = text.find(from);
      REQUIRE(at != std::string::npos);
      text.replace(at, from.size(), to);
      const auto loaded = ocm::spec::parse(text, "bad.json");
      CHECK(printed(loaded.problems) == row.at("problems").get<std::vector<std::string>>());
      CHECK(loaded.spec == nullptr);

      // An editor has only the schema: what is a matter of form it must see as well.
      std::vector<ocm::spec::Problem> syntax;
      const auto root = ocm::spec::parse_json(text, "bad.json", syntax);
      if (!syntax.empty()) continue;
      std::vector<ocm::spec::Problem> by_schema;
      ocm::spec::validate_by_schema(root, "bad.json", by_schema);
      CHECK(by_schema.empty() != row.at("schema").get<bool>());
    }
  }
}

TEST_CASE("all problems are reported, in the order of the file") {
  std::string text = read("tests/generator/good.json");
  const auto replace = [&](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  replace("500000", "5");
  replace("\"0x08\"", "\"0x1FF\"");
  replace("\"i24\"", "\"float\"");
  replace("\"1s\"", "\"soon\"");
  const auto loaded = ocm::spec::parse(text, "bad.json");
  std::vector<std::string> places;
  for (const auto& p : loaded.problems) places.push_back(p.place);
  CHECK(places == std::vector<std::string>{"bad.json:4: /bus/bit_rate", "bad.json:11: /topics/0/id",
                                           "bad.json:27: /topics/1/frames/0/fields/0/type",
                                           "bad.json:33: /topics/2/timeout"});
}

TEST_CASE("what is no spec at all") {
  const auto only = [](std::string_view text) {
    const auto loaded = ocm::spec::parse(text, "f");
    CHECK(loaded.spec == nullptr);
    REQUIRE(loaded.problems.size() == 1);
    return loaded.problems[0];
  };
  using ocm::spec::Problem;
  const std::string object = "a spec is an object with robot, namespace, bus, boards and topics";
  CHECK(only("") == Problem{"f:1:1", "the file is empty",
                            "a spec is a JSON object with robot, namespace, bus, boards and topics"});
  CHECK(only(" \n ").what == "the file is empty");
  CHECK(only("\xEF\xBB\xBF\n").what == "the file is empty");  // but for a byte order mark
  CHECK(only("[]") == Problem{"f:1: /", "a list, not an object", object});
  CHECK(only("null") == Problem{"f:1: /", "null, not an object", object});
  CHECK(only("\"topics\"") == Problem{"f:1: /", "\"topics\" is not an object", object});
  CHECK(only("{\"robot\": \"\xFF\"}").remedy == "save the file as UTF-8");
  CHECK(only("{\n\n  \"robot\": \"a\xC3\"}").place == "f:3:15");
  // Behind a NUL, at which the parser ends, there may be anything.
  using namespace std::string_view_literals;
  CHECK(only("{\n}\0{\"robot\": 1}"sv) == Problem{"f:2:2", "a NUL character", "end the text in front of it"});
  CHECK(only(std::string(100'000, '[')) ==
        Problem{"f:1", "nested deeper than 32 levels", "a spec needs 7 levels at most"});
  CHECK(only("[\"" + std::string(20'001, 'a') + "\"]") ==
        Problem{"f:1", "a text of 20001 bytes", "at most 20000"});
  CHECK(only(std::string(10'000'001, ' ')) ==
        Problem{"f", "the file has 10000001 bytes", "a spec has at most 10000000"});
  CHECK(only(std::string(2, '\0')).place == "f:1:1");
  CHECK(ocm::spec::parse("{}", "f").problems.size() == 5);
}

TEST_CASE("a spec may be as deep and as large as is said, and names and units as long") {
  const auto first = [](std::string_view text) {
    const auto loaded = ocm::spec::parse(text, "f");
    REQUIRE_FALSE(loaded.problems.empty());
    return loaded.problems[0].what;
  };
  CHECK(first(std::string(32, '[') + std::string(32, ']')) == "a list, not an object");
  CHECK(first(std::string(33, '[') + std::string(33, ']')) == "nested deeper than 32 levels");
  CHECK(first("[\"" + std::string(20'000, 'a') + "\"]") == "a list, not an object");
  CHECK(first(std::string(10'000'000, ' ')) == "the file is empty");
  // Of other documents a text is shorter.
  for (const std::size_t size : {std::size_t{1000}, std::size_t{1001}}) {
    std::vector<ocm::spec::Problem> problems;
    static_cast<void>(ocm::spec::parse_json("[\"" + std::string(size, 'a') + "\"]", "f", problems));
    CHECK(problems.empty() == (size == 1000));
  }

  const std::string good = read("tests/generator/good.json");
  const auto with = [&good](const std::string& from, const std::string& to) {
    std::string text = good;
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    return printed(ocm::spec::parse(text.replace(at, from.size(), to), "f").problems);
  };
  const std::string longest(40, 'a');
  const std::string unit = "\"unit\": \"deg/s\"";
  CHECK(with("\"gyroscope\"", '"' + longest + '"').empty());
  CHECK(with("\"gyroscope\"", '"' + longest + "a\"") ==
        std::vector<std::string>{"f:11: /topics/0/name: the name \"" + longest +
                                 "a\" has 41 characters; at most 40"});
  CHECK(with(unit, "\"unit\": \"" + longest + '"').empty());
  CHECK(with(unit, "\"unit\": \"" + longest + "a\"") ==
        std::vector<std::string>{"f:16: /topics/0/frames/0/fields/0/unit: the unit \"" + longest +
                                 "a\" cannot be read as a name; add \"unit_name\", which ends the name of "
                                 "the accessor, such as \"gauss\""});
  CHECK(with(unit, unit + ", \"unit_name\": \"" + longest + '"').empty());
  CHECK(with(unit, unit + ", \"unit_name\": \"" + longest + "a\"").size() == 1);
  const std::string line(1000, 'a');
  CHECK(with("\"Pair\"", '"' + line + '"').empty());
  CHECK(with("\"Pair\"", '"' + line + "a\"") ==
        std::vector<std::string>{"f:2: /robot: a text of 1001 bytes; at most 1000"});
}

/// good.json with another text in the place of one that is in it once.
std::string good_with(const std::string& from, const std::string& to) {
  std::string text = read("tests/generator/good.json");
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  REQUIRE(text.find(from, at + 1) == std::string::npos);
  return text.replace(at, from.size(), to);
}

TEST_CASE("a frame is as long as its fields, also where a single bit is all of it") {
  const auto length = [](const char* fields) {
    const auto loaded =
        ocm::spec::parse(good_with(R"([{ "name": "angle", "bit": 0, "type": "u12" }])", fields), "f");
    CHECK(printed(loaded.problems).empty());
    REQUIRE(loaded.spec != nullptr);
    return static_cast<int>(loaded.spec->model().topics.at(1).frames.at(1).dlc);
  };
  CHECK(length(R"([{ "name": "on", "bit": 0, "type": "u1" }])") == 1);
  CHECK(length(R"([{ "name": "on", "bit": 7, "type": "u1" }])") == 1);
  CHECK(length(R"([{ "name": "on", "bit": 8, "type": "u1" }])") == 2);
  CHECK(length(R"([{ "name": "on", "bit": 63, "type": "u1" }])") == 8);
  CHECK(length(R"([{ "name": "on", "bit": 0, "type": "u1", "byte_order": "big" }])") == 1);
}

TEST_CASE("a range may have a single raw number in it, and no fewer") {
  const auto held = [](const std::string& range, const std::string& scale = "0.0175") {
    const auto loaded =
        ocm::spec::parse(good_with(R"("scale": 0.0175, "unit": "deg/s", "range": [-500, 500])",
                                   "\"scale\": " + scale + R"(, "unit": "deg/s", "range": )" + range),
                         "f");
    std::vector<std::int64_t> raw;
    if (loaded.spec == nullptr) return raw;
    const auto& field = loaded.spec->model().topics.at(0).frames.at(0).fields.at(0);
    raw = {field.raw_min, field.raw_max};
    return raw;
  };
  using Raw = std::vector<std::int64_t>;
  CHECK(held("[0, 0]") == Raw{0, 0});
  CHECK(held("[0.0175, 0.0175]") == Raw{1, 1});
  CHECK(held("[-0.0175, 0]") == Raw{-1, 0});
  CHECK(held("[-573.44, 573.4225]") == Raw{-32768, 32767});
  CHECK(held("[573.4225, 573.4225]") == Raw{32767, 32767});
  CHECK(held("[-573.44, -573.44]") == Raw{-32768, -32768});
  CHECK(held("[0.01, 0.0174]").empty());
  CHECK(held("[-573.4401, 0]").empty());
  CHECK(held("[0, 573.4226]").empty());
  // Of a scale below zero the lowest raw number has the highest value.
  const auto falling = [&held](const std::string& range) { return held(range, "-0.0175"); };
  CHECK(falling("[0, 0]") == Raw{0, 0});
  CHECK(falling("[0.0175, 0.0175]") == Raw{-1, -1});
  CHECK(falling("[-0.0175, 0]") == Raw{0, 1});
  CHECK(falling("[-0.02, 0.04]") == Raw{-2, 1});
  CHECK(falling("[-573.4225, 573.44]") == Raw{-32768, 32767});
  CHECK(falling("[573.44, 573.44]") == Raw{-32768, -32768});
  CHECK(falling("[-573.4225, -573.4225]") == Raw{32767, 32767});
  CHECK(falling("[0.01, 0.0174]").empty());
  CHECK(falling("[-573.4226, 0]").empty());
  CHECK(falling("[0, 573.4401]").empty());
}

TEST_CASE("a topic has 255 frames, and no more, their counts included") {
  const auto problems = [](int count) {
    return printed(
        ocm::spec::parse(R"({"robot": "r", "namespace": "r", "bus": {"bit_rate": 500000, "source": "s"},
      "boards": [{"name": "b", "mcu": "m", "source": "s"}],
      "topics": [{"name": "t", "id": 0, "board": "b", "source": "s", "frames": [
        {"name": "one", "id": 0, "count": )" +
                             std::to_string(count) +
                             R"(, "dlc": 0, "fields": []},
        {"name": "last", "id": 255, "dlc": 0, "fields": []}]}]})",
                         "f")
            .problems);
  };
  CHECK(problems(254).empty());
  CHECK(problems(255) ==
        std::vector<std::string>{"f:3: /topics/0/frames: 256 frames with their counts; at most 255"});
  // Without counts.
  const auto of_frames = [](int count) {
    std::string frames;
    for (int i = 0; i < count; ++i)
      frames += std::string{i == 0 ? "" : ", "} + R"({"name": "f)" + std::to_string(i) + R"(", "id": )" +
                std::to_string(i) + R"(, "dlc": 0, "fields": []})";
    return printed(
        ocm::spec::parse(R"({"robot": "r", "namespace": "r", "bus": {"bit_rate": 500000, "source": "s"},
      "boards": [{"name": "b", "mcu": "m", "source": "s"}],
      "topics": [{"name": "t", "id": 0, "board": "b", "source": "s", "frames": [)" +
                             frames + "]}]}",
                         "f")
            .problems);
  };
  CHECK(of_frames(255).empty());
  CHECK(of_frames(256) == std::vector<std::string>{"f:3: /topics/0/frames: 256 frames; at most 255"});
}

TEST_CASE("what is derived wrongly takes no name from what is derived well") {
  const std::string derived =
      R"({ "name": "near", "of": "field", "law": "inverse_square", "at_one": 2, "offset": 1, "noise": 1, )"
      R"("unit": "m", "range": [0.1, 1] })";
  const std::string fields = R"([{ "name": "field", "byte": 0, "type": "i24" }, )"
                             R"({ "name": "mode", "byte": 3, "type": "u8", "values": { "off": 0 } }, )"
                             R"({ "name": "state", "byte": 4, "type": "u8", "flags": { "ready": 0 } }])";
  const auto problems = [&](const std::string& from, const std::string& to) {
    std::string first = derived;
    REQUIRE(first.find(from) != std::string::npos);
    first.replace(first.find(from), from.size(), to);
    return printed(ocm::spec::parse(good_with(R"([{ "name": "field", "byte": 0, "type": "i24" }])",
                                              fields + R"(, "derived": [)" + first + ", " + derived + "]"),
                                    "f")
                       .problems);
  };
  const std::string at = "f:27: /topics/1/frames/0/derived/0";
  using Lines = std::vector<std::string>;
  CHECK(problems(R"("near")", R"("far")").empty());
  CHECK(problems(R"("of": "field")", R"("of": "mode")") ==
        Lines{at + R"(/of: "mode" has names of values; a field that measures something)"});
  CHECK(problems(R"("of": "field")", R"("of": "state")") ==
        Lines{at + R"(/of: "state" has names of values; a field that measures something)"});
  CHECK(problems(R"("of": "field")", R"("of": "fild")") ==
        Lines{at + R"(/of: the frame has no field "fild"; the name of one of its fields)"});
  CHECK(problems(R"("of": "field", )", "") ==
        Lines{at + R"(: no "of"; add "of": the field of the frame from which it follows)"});
  CHECK(problems(R"("at_one": 2)", R"("at_one": 0)") ==
        Lines{at + "/at_one: not above zero; what is measured above the offset where the quantity is 1"});
  CHECK(problems("[0.1, 1]", "[0, 1]") ==
        Lines{at + "/range: the range begins at or below zero; above zero: [0.004, 0.2]"});
  CHECK(problems(R"(, "range": [0.1, 1])", "") ==
        Lines{at + R"(: no "range"; add "range": the values at which the law holds, [0.004, 0.2])"});
  CHECK(problems(R"("offset": 1)", R"("offset": [1, 2, 3])") ==
        Lines{at + "/offset: 3 offsets for 2 frames; what is measured when nothing is there: a number, or a "
                   "list with one for each of the frame's count"});
}

TEST_CASE("scale and offset have exponents of fewer than 80, either way") {
  const auto is_good = [](const std::string& scale, const std::string& offset) {
    const auto loaded =
        ocm::spec::parse(good_with(R"("bit": 0, "type": "u12")", R"("bit": 0, "type": "u12", "scale": )" +
                                                                     scale + R"(, "offset": )" + offset),
                         "f");
    if (!loaded.problems.empty())
      CHECK(printed(loaded.problems) ==
            std::vector<std::string>{
                "f:28: /topics/1/frames/1/fields/0/scale: scale and offset have too many digits for 12 bits; "
                "raw number times the digits of the scale, plus offset, must stay within 18 digits"});
    return loaded.problems.empty();
  };
  CHECK(is_good("1e79", "0"));
  CHECK_FALSE(is_good("1e80", "0"));
  CHECK(is_good("1e-79", "0"));
  CHECK_FALSE(is_good("1e-80", "0"));
  CHECK(is_good("1e79", "1e79"));
  CHECK_FALSE(is_good("1e79", "1e80"));
  CHECK(is_good("1e-79", "1e-79"));
  CHECK_FALSE(is_good("1e-79", "1e-80"));
  // So many digits that the offset and the greatest raw number, 4095, have no sum in 63 bits.
  CHECK(is_good("1", "9223372036854771712"));
  CHECK_FALSE(is_good("1", "9223372036854771713"));
  CHECK_FALSE(is_good("1", "1e20"));
  CHECK_FALSE(is_good("1", "1e-20"));
}

TEST_CASE("a spec has as many topics as there are numbers, and no more") {
  const auto problems = [](int count) {
    std::string topics;
    for (int i = 0; i < count; ++i)
      topics += std::string{i == 0 ? "" : ", "} + R"({"name": "t)" + std::to_string(i) + R"(", "id": )" +
                std::to_string(i % 256) +
                R"(, "board": "b", "source": "s", "frames": [{"dlc": 0, "fields": []}]})";
    return printed(
        ocm::spec::parse(R"({"robot": "r", "namespace": "r", "bus": {"bit_rate": 500000, "source": "s"},
      "boards": [{"name": "b", "mcu": "m", "source": "s"}], "topics": [)" +
                             topics + "]}",
                         "f")
            .problems);
  };
  CHECK(problems(256).empty());
  CHECK(problems(257) ==
        std::vector<std::string>{"f:2: /topics: 257 topics; at most 256: a topic's number has 8 bits"});
}

TEST_CASE("of a number that is taken, the first that is free is named, up to the last one") {
  const auto problems = [](int count) {
    return printed(
        ocm::spec::parse(R"({"robot": "r", "namespace": "r", "bus": {"bit_rate": 500000, "source": "s"},
      "boards": [{"name": "b", "mcu": "m", "source": "s"}],
      "topics": [{"name": "t", "id": 0, "board": "b", "source": "s", "frames": [
        {"name": "one", "id": 1, "count": )" +
                             std::to_string(count) + R"(, "dlc": 0, "fields": []}]},
       {"name": "u", "id": 1, "board": "b", "source": "s", "frames": [{"id": 1, "dlc": 0, "fields": []}]}]})",
                         "f")
            .problems);
  };
  const auto taken = [](const std::string& free) {
    return std::vector<std::string>{
        "f:5: /topics/1/frames/0/id: id 0x01 is taken (see /topics/0/frames/0/id); a number that no other of "
        "the sensors' frames has, such as " +
        free};
  };
  CHECK(problems(3) == taken("0x04"));
  CHECK(problems(253) == taken("0xFE"));
  CHECK(problems(254) == taken("0xFF"));
}

TEST_CASE("the sensors of a ring may lie at any distance above zero") {
  using Pointer = nlohmann::json::json_pointer;
  auto spec = nlohmann::json::parse(read("tests/generator/golden/whole.json"));
  const Pointer radius{"/topics/5/geometry/radius"};
  REQUIRE(spec.at(radius).is_number());
  const std::pair<double, ocm::base::Decimal> rows[] = {{1, {1, 0}}, {0.1, {1, -1}}, {0.01, {1, -2}}};
  for (const auto& [metres, expected] : rows) {
    CAPTURE(metres);
    spec.at(radius) = metres;
    const auto loaded = ocm::spec::parse(spec.dump(1), "f");
    CHECK(printed(loaded.problems).empty());
    REQUIRE(loaded.spec != nullptr);
    const auto& geometry = loaded.spec->model().topics.at(5).geometry;
    REQUIRE(geometry.has_value());
    CHECK(geometry->radius == expected);
  }
}

TEST_CASE("a field of the other byte order ends at the last bit of the frame, the lowest of its byte") {
  const auto problems = [](const std::string& type) {
    return printed(ocm::spec::parse(good_with(R"("bit": 0, "type": "u12")",
                                              R"("bit": 60, "byte_order": "big", "type": ")" + type + '"'),
                                    "f")
                       .problems);
  };
  CHECK(problems("u5").empty());
  CHECK(problems("u6") ==
        std::vector<std::string>{
            "f:28: /topics/1/frames/1/fields/0/bit: a field of 6 bits that begins here does not end within 8 "
            "bytes; at most 5 bits, or an earlier beginning"});
}

TEST_CASE("a line of text has no control character, and all else but a backslash") {
  const auto problems = [](const std::string& robot) {
    return printed(
        ocm::spec::parse(good_with(R"("robot": "Pair")", R"("robot": ")" + robot + '"'), "f").problems);
  };
  for (const char* good : {"a b", "~", "!", "[]^", "\xC3\xA4"}) {
    CAPTURE(good);
    CHECK(problems(good).empty());
  }
  for (const char* bad : {"a\\u0001b", "a\\u001fb", "a\x7F"}) {
    CAPTURE(bad);
    CHECK(problems(bad) ==
          std::vector<std::string>{
              "f:2: /robot: the text has a line break or another control character; one line of plain text"});
  }
}

TEST_CASE("of a number that cannot be forty characters are shown") {
  const std::string zeros(60, '0');
  const std::string shown(38, '0');
  const auto dlc = [](const std::string& number) {
    return printed(ocm::spec::parse(good_with(R"("dlc": 6)", R"("dlc": )" + number), "f").problems);
  };
  using Lines = std::vector<std::string>;
  const std::string whole = "; a whole number from 0 to 8";
  CHECK(dlc("9." + zeros) == Lines{"f:14: /topics/0/frames/0/dlc: 9." + shown + " is out of range" + whole});
  CHECK(dlc("6.5" + zeros) ==
        Lines{"f:14: /topics/0/frames/0/dlc: 6.5" + shown.substr(1) + " is not whole" + whole});
  const std::string digits = "at most 18 digits, and an exponent of at most 100";
  CHECK(dlc("6." + std::string(60, '1')) ==
        Lines{"f:14: /topics/0/frames/0/dlc: number 6." + std::string(38, '1') +
              " has more digits than can be kept exactly; " + digits});
  const auto too_large =
      ocm::spec::parse(good_with(R"("dlc": 6)", R"("dlc": 66)" + zeros + "e999"), "f").problems;
  REQUIRE(too_large.size() == 1);
  CHECK(too_large[0].what == "number 66" + shown + " is too large");
  CHECK(too_large[0].remedy == digits);
}

TEST_CASE("problems are in the order of their lines, those of one line as they were found") {
  std::vector<ocm::spec::Problem> problems;
  for (const char* place : {"f1:100: /a", "f1:99: /b", "f1:20: /c", "f1:19: /d", "f1:19", "f1:9:70",
                            "f1:10:1", "f1:9: /e", "f1", "f1:1000: /"})
    problems.push_back({place, "what", "remedy"});
  ocm::spec::sort_by_line(problems, "f1");
  std::vector<std::string> places;
  for (const auto& problem : problems) places.push_back(problem.place);
  CHECK(places == std::vector<std::string>{"f1", "f1:9:70", "f1:9: /e", "f1:10:1", "f1:19: /d", "f1:19",
                                           "f1:20: /c", "f1:99: /b", "f1:100: /a", "f1:1000: /"});
}

TEST_CASE("an id has sixteen digits at most") {
  const auto problems = [](const std::string& id) {
    return printed(ocm::spec::parse(good_with(R"("id": "0x08")", "\"id\": \"" + id + '"'), "f").problems);
  };
  CHECK(problems("0x0000000000000008").empty());
  CHECK(problems("0x00000000000000008") ==
        std::vector<std::string>{"f:11: /topics/0/id: \"0x00000000000000008\" is not an id; a topic's number "
                                 "has 8 bits: \"0x00\" to \"0xFF\""});
}

TEST_CASE("a file may be as large as is said, and not a byte larger") {
  const std::filesystem::path file = std::string{OCM_SOURCE_DIR} + "/tests/generator/good.json";
  const auto size = static_cast<std::size_t>(std::filesystem::file_size(file));
  std::vector<ocm::spec::Problem> problems;
  const auto whole = ocm::spec::read_document(file, "a spec", "spec/topics.json", problems, size);
  CHECK(problems.empty());
  REQUIRE(whole.has_value());
  CHECK(*whole == read("tests/generator/good.json"));
  CHECK_FALSE(ocm::spec::read_document(file, "a spec", "spec/topics.json", problems, size - 1).has_value());
  REQUIRE(problems.size() == 1);
  CHECK(problems[0] == ocm::spec::Problem{file.string(),
                                          "the file is larger than " + std::to_string(size - 1) + " bytes",
                                          "a spec is smaller"});
}

TEST_CASE("what does not end is larger than is allowed, however much of it is read at a time") {
  for (const std::size_t most : {0U, 1U, 65'535U, 65'536U, 65'537U, 131'072U}) {
    CAPTURE(most);
    std::vector<ocm::spec::Problem> problems;
    CHECK_FALSE(
        ocm::spec::read_document("/dev/zero", "a spec", "spec/topics.json", problems, most).has_value());
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].what == "the file is larger than " + std::to_string(most) + " bytes");
  }
}

TEST_CASE("an unknown member of any part of a spec is named, with those that there are") {
  using Pointer = nlohmann::json::json_pointer;
  const auto good = nlohmann::json::parse(read("tests/generator/golden/whole.json"));
  const auto problems = [](const nlohmann::json& spec) {
    std::vector<std::string> lines;  // without their numbers
    for (const std::string& line : printed(ocm::spec::parse(spec.dump(1), "f").problems))
      lines.push_back(line.substr(line.find(": ") + 2));
    return lines;
  };
  CHECK(problems(good).empty());
  const std::pair<std::string, std::string> rows[] = {
      {"",
       "$schema, robot, namespace, description, byte_order, bus, defaults, boards, topics, messages, "
       "attributes, attribute_definitions"},
      {"/bus", "bit_rate, data_bit_rate, source"},
      {"/defaults", "period, deadline, jitter, priority, timeout, source"},
      {"/boards/0", "name, description, mcu, clock_hz, can_clock_hz, source, attributes"},
      {"/topics/2",
       "name, alias, description, kind, role, geometry, id, count, board, byte_order, period, "
       "shortest_period, deadline, jitter, priority, timeout, frames, source"},
      {"/topics/2/frames/0", "name, description, id, count, dlc, byte_order, fields, derived, source"},
      {"/topics/2/frames/0/fields/0",
       "name, description, byte, bit, type, byte_order, scale, offset, unit, unit_name, range, values, "
       "flags, source"},
      {"/topics/5/geometry", "radius, first, step"},
      {"/topics/5/frames/0/derived/0",
       "name, description, of, law, at_one, offset, noise, unit, range, source"},
      {"/messages/0",
       "name, alias, description, id, pgn, format, length, fd, sender, other_senders, period, "
       "shortest_period, deadline, jitter, send_type, byte_order, fields, attributes, source"},
      {"/messages/0/fields/0",
       "name, description, byte, bit, type, byte_order, scale, offset, unit, range, values, flags, "
       "selector, selected, start, receivers, attributes, source"},
      {"/messages/4/fields/7/values/0", "raw, name"},
      {"/attribute_definitions/0", "of, name, type, min, max, values, default"}};
  for (const auto& [where, known] : rows) {
    CAPTURE(where);
    nlohmann::json bad = good;
    REQUIRE(bad[Pointer{where}].is_object());
    bad[Pointer{where}]["zzz"] = 1;
    CHECK(problems(bad) ==
          std::vector<std::string>{where + R"(/zzz: unknown member "zzz"; one of )" + known});
  }
}

TEST_CASE("a topic of an unknown board has that problem alone") {
  const auto topic = [](const std::string& name, const std::string& id, const std::string& board) {
    return R"({"name": ")" + name + R"(", "role": "refusal", "id": )" + id + R"(, "board": ")" + board +
           R"(", "source": "s", "frames": [{"fields": [{"name": "topic", "byte": 0, "type": "u8"}, )" +
           R"({"name": "reason", "byte": 1, "type": "u8"}, {"name": "refused", "byte": 2, "type": "u16"}]}]})";
  };
  const auto problems = [&topic](const std::string& first, const std::string& second) {
    return printed(
        ocm::spec::parse(R"({"robot": "r", "namespace": "r", "bus": {"bit_rate": 500000, "source": "s"},
      "boards": [{"name": "left", "mcu": "m", "source": "s"}, {"name": "right", "mcu": "m", "source": "s"}],
      "topics": [)" + topic("a", "1", first) +
                             ", " + topic("b", "2", second) + "]}",
                         "f")
            .problems);
  };
  using Lines = std::vector<std::string>;
  CHECK(problems("left", "right").empty());
  CHECK(problems("right", "right") ==
        Lines{R"(f:3: /topics/1/role: a second topic of its board has the role "refusal" )"
              "(see /topics/0/role); at most one of a board"});
  CHECK(problems("right", "rihgt") ==
        Lines{R"(f:3: /topics/1/board: unknown board "rihgt"; did you mean "right"?)"});
  CHECK(problems("rihgt", "right") ==
        Lines{R"(f:3: /topics/0/board: unknown board "rihgt"; did you mean "right"?)"});
  CHECK(problems("left", "rihgt") ==
        Lines{R"(f:3: /topics/1/board: unknown board "rihgt"; did you mean "right"?)"});
  CHECK(problems("rihgt", "left") ==
        Lines{R"(f:3: /topics/0/board: unknown board "rihgt"; did you mean "right"?)"});
}

TEST_CASE("what only the schema sees is reported with its place, and with what the schema says of it") {
  const auto loaded =
      ocm::spec::parse(good_with(R"("robot": "Pair",)", R"("$schema": 7, "robot": "Pair",)"), "f");
  CHECK(loaded.spec == nullptr);
  REQUIRE(loaded.problems.size() == 1);
  CHECK(loaded.problems[0].place == "f:2: /$schema");
  CHECK(loaded.problems[0].remedy == "see topics.schema.json");

  // And by itself, behind what a reader has told.
  using Problems = std::vector<ocm::spec::Problem>;
  Problems syntax;
  const auto root = ocm::spec::parse_json(
      good_with(R"("name": "mode", "byte": 2)", R"("name": "mode", "byte": 9)"), "f", syntax);
  REQUIRE(syntax.empty());
  const auto after = [&root](Problems problems) {
    const std::size_t before = problems.size();
    ocm::spec::validate_by_schema(root, "f", problems);
    REQUIRE(problems.size() >= before);
    return Problems(problems.begin() + static_cast<std::ptrdiff_t>(before), problems.end());
  };
  const std::string place = "f:17: /topics/0/frames/0/fields/1/byte";
  for (const char* told :
       {"f:17: /topics/0/frames/0/fields/1", "f:17: /topics/0/frames/0/fields/1/byte_order",
        "f:17: /topics/0/frames/0/fields/10/byte", "f:17:3"}) {
    CAPTURE(told);
    const Problems found = after({{told, "something", "another"}});
    REQUIRE(found.size() == 1);
    CHECK(found[0].place == place);
    CHECK(found[0].remedy ==
          "The byte where it begins, 0 to 7, from its lowest bit (little-endian) or its highest (big-endian) "
          "on");
  }
  CHECK(after({}).size() == 1);
  // Nothing where a reader has told already, of the value or within it.
  CHECK(after({{place, "something", "another"}}).empty());
  CHECK(after({{place + "/x", "something", "another"}}).empty());
}

TEST_CASE("a file that is not there, or is no file") {
  const auto only = [](const std::filesystem::path& file) { return ocm::spec::load(file).problems.at(0); };
  using ocm::spec::Problem;
  const std::string path = "the path of a spec, such as spec/topics.json";
  CHECK(only("/nonexistent/spec.json") == Problem{"/nonexistent/spec.json", "there is no such file", path});
  CHECK(only("/") == Problem{"/", "it is a folder", "the path of the spec within it"});
  CHECK(only("/dev/null/spec.json") == Problem{"/dev/null/spec.json", "Not a directory", path});
  const std::string longest(300, 'a');
  CHECK(only(longest) == Problem{longest, "File name too long", path});
  CHECK(only("/proc/self/mem") == Problem{"/proc/self/mem", "it cannot be read", "a readable file"});
  CHECK(only("/dev/zero").what == "the file is larger than 10000000 bytes");
  CHECK(only("/dev/null").what == "the file is empty");
}

}  // namespace generator_bad_specs_test
