// bad_specs.json: what is changed in good.json, and all that must be said about it; bad_messages.json of
// good_messages.json.
#include <algorithm>
#include <fstream>
#include <sstream>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

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
}

TEST_CASE("a file that is not there, or is no file") {
  const auto only = [](const std::filesystem::path& file) { return ocm::spec::load(file).problems.at(0); };
  CHECK(only("/nonexistent/spec.json").what == "there is no such file");
  CHECK(only("/").what == "it is a folder");
  CHECK(only("/dev/zero").what == "the file is larger than 10000000 bytes");
  CHECK(only("/dev/null").what == "the file is empty");
}

}  // namespace generator_bad_specs_test
