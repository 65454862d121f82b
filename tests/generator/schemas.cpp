// spec/tasks.json and spec/sentences.json against the schemas that an editor has of them, and what the
// schemas must see.
#include <algorithm>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "generator/spec/sentences.hpp"

namespace generator_schemas_test {

using Json = nlohmann::json;
using Adapter = valijson::adapters::NlohmannJsonAdapter;

/// spec/NAME.json, spec/NAME.schema.json, and what the one says of the other when it is changed.
class Spec {
 public:
  explicit Spec(const std::string& name) : json_(read(name + ".json")), text_(read(name + ".schema.json")) {
    valijson::SchemaParser{}.populateSchema(Adapter{text_}, schema_);
  }
  [[nodiscard]] const Json& json() const { return json_; }
  [[nodiscard]] Json with(const char* pointer, const Json& value) const {
    Json changed = json_;
    changed[Json::json_pointer{pointer}] = value;
    return changed;
  }
  [[nodiscard]] Json without(const char* pointer, const char* member) const {
    Json changed = json_;
    REQUIRE(changed[Json::json_pointer{pointer}].erase(member) == 1);
    return changed;
  }
  [[nodiscard]] bool takes(const Json& json) const {
    valijson::Validator validator;
    return validator.validate(schema_, Adapter{json}, nullptr);
  }
  /// With another value, or a new one, at `pointer`.
  [[nodiscard]] bool takes(const char* pointer, const Json& value) const {
    return takes(with(pointer, value));
  }
  /// Without `member` of what is at `pointer`, which has it.
  [[nodiscard]] bool takes_without(const char* pointer, const char* member) const {
    return takes(without(pointer, member));
  }

 private:
  static Json read(const std::string& name) {
    std::ifstream in{std::string{OCM_SOURCE_DIR} + "/spec/" + name};
    REQUIRE(in);
    return Json::parse(in);
  }

  Json json_;
  Json text_;
  valijson::Schema schema_;
};

TEST_CASE("the task sets keep to their schema, which tells what does not") {
  const Spec tasks{"tasks"};
  CHECK(tasks.takes(tasks.json()));
  CHECK(tasks.takes("/sets/0/tasks/0/cost", "53us"));
  CHECK_FALSE(tasks.takes("/sets/0/tasks/0/cost", "53"));
  CHECK_FALSE(tasks.takes("/sets/0/tasks/0/cost", 53));
  CHECK_FALSE(tasks.takes("/sets/0/tasks/0/costs", "53us"));
  CHECK_FALSE(tasks.takes("/sets/0/tasks/0/name", "Control"));
  CHECK_FALSE(tasks.takes("/sets/0/tasks", Json::array()));
  CHECK_FALSE(tasks.takes("/sets/0/bus_percent", 101));
  CHECK_FALSE(tasks.takes(Json::object()));
  for (const char* needed : {"name", "cost", "period", "level"}) {
    CAPTURE(needed);
    CHECK_FALSE(tasks.takes_without("/sets/0/tasks/0", needed));
  }
}

/// What ocm-generate says of sentences that are wrong: each problem with its place and its remedy.
std::vector<std::string> told(const Json& sentences) {
  std::vector<std::string> lines;
  const auto loaded = ocm::spec::parse_sentences(sentences.dump(1), "s.json");
  CHECK(loaded.model.has_value() == loaded.problems.empty());
  for (const auto& problem : loaded.problems) {
    CHECK(problem.place.starts_with("s.json:"));
    CHECK_FALSE(problem.remedy.empty());
    lines.push_back(problem.place.substr(problem.place.find(": ") + 2) + ": " + problem.what + "; " +
                    problem.remedy);
  }
  return lines;
}

// In spec/sentences.json: a sentence of a word, one of integers, one of fixed text.
constexpr const char* confirm = "/sentences/0";
constexpr const char* set_point = "/sentences/1";
constexpr const char* ping = "/sentences/8";
constexpr const char* handshake = "/sentences/9";

TEST_CASE("the sentences keep to their schema") {
  const Spec sentences{"sentences"};
  CHECK(sentences.takes(sentences.json()));
  const auto name = [&](const char* at) { return sentences.json()[Json::json_pointer{at}]["name"]; };
  REQUIRE(name(confirm) == "confirm");
  REQUIRE(name(set_point) == "set_point");
  REQUIRE(name(ping) == "ping");
  REQUIRE(name(handshake) == "handshake");
  CHECK(sentences.takes("/sentences/0/word", "GOO"));
  CHECK(sentences.takes("/sentences/1/fields/0/range", {-32768, 32767}));
  CHECK(sentences.takes_without("/sentences/1/fields/0", "range"));
  CHECK(sentences.takes_without(handshake, "integers"));
  CHECK(sentences.takes("/sentences/1/source", "decided"));
}

TEST_CASE("what the schema of the sentences must see: a member that is missing") {
  const Spec sentences{"sentences"};
  CHECK_FALSE(sentences.takes(Json::object()));
  CHECK_FALSE(sentences.takes(nullptr));
  const std::pair<const char*, const char*> needed[] = {
      {"", "robot"},
      {"", "description"},
      {"", "integer"},
      {"", "packet"},
      {"", "sentences"},
      {"", "packed"},
      {"/integer", "min"},
      {"/integer", "max"},
      {"/integer", "source"},
      {"/packet", "bytes"},
      {"/packet", "source"},
      {confirm, "name"},
      {confirm, "direction"},
      {confirm, "description"},
      {confirm, "source"},
      {confirm, "letter"},
      {confirm, "word"},
      {set_point, "letter"},
      {set_point, "fields"},
      {ping, "text"},
      {"/sentences/1/source", "default"},
      {"/sentences/1/fields/0", "name"},
      {"/sentences/1/fields/0", "unit"},
      {"/sentences/1/fields/0", "description"},
      {"/packed", "version"},
      {"/packed", "tag"},
      {"/packed", "sentence"},
      {"/packed", "description"},
      {"/packed", "fields"},
      {"/packed", "source"},
      {"/packed/fields/0", "name"},
      {"/packed/fields/0", "bits"},
  };
  for (const auto& [where, member] : needed) {
    CAPTURE(where, member);
    CHECK_FALSE(sentences.takes_without(where, member));
    CHECK_FALSE(told(sentences.without(where, member)).empty());
  }
}

TEST_CASE("what the schema of the sentences must see: a value that cannot be") {
  const Spec sentences{"sentences"};
  const std::pair<const char*, Json> bad[] = {
      {"/robots", "mapper"},
      {"/robot", ""},
      {"/robot", 1},
      {"/robot", "line\nrobot"},
      {"/integer/min", -32769},
      {"/integer/max", 32768},
      {"/integer/max", "32767"},
      {"/integer/most", 1},
      {"/packet/bytes", 0},
      {"/packet/bytes", 256},
      {"/packet/bytes", 20.5},
      {"/sentences", Json::array()},
      {"/sentences", Json::object()},
      {"/sentences/0", "{S,CON}"},
      {"/sentences/0/name", "Confirm"},
      {"/sentences/0/name", "0confirm"},
      {"/sentences/0/direction", "to_server"},
      {"/sentences/0/letter", "s"},
      {"/sentences/0/letter", "SS"},
      {"/sentences/0/word", "con"},
      {"/sentences/0/word", "CONF"},
      {"/sentences/0/words", "CON"},
      {"/sentences/0/description", "two\nlines"},
      {"/sentences/0/source", 4.3},
      {"/sentences/1/source/angle", 4.3},
      {"/sentences/1/fields", Json::array()},
      {"/sentences/1/fields/0/name", "Angle"},
      {"/sentences/1/fields/0/unit", "degrees"},
      {"/sentences/1/fields/0/range", {0}},
      {"/sentences/1/fields/0/range", {0, 1, 2}},
      {"/sentences/1/fields/0/range", {0, 32768}},
      {"/sentences/1/fields/0/range", {"0", "1"}},
      {"/sentences/1/fields/0/default", 0},
      {"/sentences/9/fields/9/values", {20225}},
      {"/sentences/9/fields/9/values", {{"Offer", 1}}},
      {"/sentences/9/fields/9/values", {{"offer", "1"}}},
      {"/sentences/9/fields/9/values", {{"offer", 32768}}},
      {"/sentences/9/integers", {0, 16}},
      {"/sentences/9/integers", {1, 17}},
      {"/sentences/9/integers", 10},
      // One that is of two sorts at once.
      {"/sentences/0/fields", sentences.json()["sentences"][1]["fields"]},
      {"/sentences/0/text", "{}"},
      {"/sentences/0/integers", {1, 2}},
      {"/sentences/1/word", "CON"},
      {"/sentences/1/text", "{}"},
      {"/sentences/8/letter", "S"},
      {"/sentences/8/word", "CON"},
      {"/sentences/8/integers", {1, 2}},
      {"/sentences/8/text", ""},
      {"/packed/version", 0},
      {"/packed/tag", 127},
      {"/packed/tag", 256},
      {"/packed/sentence", ""},
      {"/packed/bits", 112},
      {"/packed/fields", Json::array()},
      {"/packed/fields/0/bits", 0},
      {"/packed/fields/0/bits", 17},
      {"/packed/fields/0/range", {0, 1}},
  };
  for (const auto& [where, value] : bad) {
    CAPTURE(where, value);
    CHECK_FALSE(sentences.takes(where, value));
    CHECK_FALSE(told(sentences.with(where, value)).empty());
  }
}

TEST_CASE("what no schema can see of sentences is reported with its place and what would be right") {
  using Lines = std::vector<std::string>;
  const Spec spec{"sentences"};
  const auto with = [&](const char* where, const Json& value) { return told(spec.with(where, value)); };
  CHECK(told(spec.json()).empty());
  CHECK(with("/robots", "mapper") == Lines{R"(/robots: unknown member "robots"; did you mean "robot"?)"});
  CHECK(with("/sentences/2/name", "confirm") ==
        Lines{R"(/sentences/2: a second sentence "confirm"; another name)"});
  CHECK(with("/sentences/0/name", "none") ==
        Lines{R"(/sentences/0: "none" is what a reader says when there is no sentence; another name)"});
  CHECK(with("/sentences/0/name", "switch") ==
        Lines{R"(/sentences/0/name: "switch" is a word of C++; another name, such as "switch_value")"});
  CHECK(with("/sentences/2/word", "CON") ==
        Lines{R"(/sentences/2: it cannot be distinguished from "confirm"; another letter, word or text)"});
  CHECK(
      with("/sentences/2/letter", "T") ==
      Lines{
          R"(/sentences/2: a word behind another letter than that of "confirm"; all words are behind one letter: "S")"});
  CHECK(with("/sentences/1/letter", "S") ==
        Lines{R"(/sentences/1: integers behind the letter of the word "confirm"; another letter)"});
  CHECK(with("/sentences/1/fields/1/name", "angle") ==
        Lines{R"(/sentences/1/fields/1/name: a second integer "angle"; another name)"});
  CHECK(
      with("/sentences/1/fields/1/name", "letter") ==
      Lines{R"(/sentences/1/fields/1/name: "letter" is a member of every sentence's struct; another name)"});
  CHECK(
      with("/sentences/1/fields/0/range", {360, -360}) ==
      Lines{
          "/sentences/1/fields/0/range: 360 is greater than -360; two whole numbers, [smallest, greatest]"});
  CHECK(
      with("/sentences/9/fields/9/values", {{"width", 1}}) ==
      Lines{
          R"(/sentences/9/fields/9/values/width: "width" is an integer of the sentence, too; another name)"});
  CHECK(with("/sentences/1/fields/0/values", {{"back", 361}}).size() == 1);  // out of its range
  CHECK(with("/sentences/9/integers", {12, 16}) ==
        Lines{"/sentences/9/integers: 11 fields are outside of it; a number below and one above, or leave it "
              "out"});
  CHECK(
      with("/sentences/1/source/width", "a ruler") ==
      Lines{
          R"(/sentences/1/source/width: source for "width", which is not a fact of this object; default, range, or one of angle, distance)"});
  CHECK(with("/packed/sentence", "idle") ==
        Lines{R"(/packed/sentence: no sentence "idle" has integers; the name of one that has)"});
  CHECK(
      with("/packed/fields/0/bits", 7) ==
      Lines{R"(/packed/fields/0: the first field is the packet's number; {"name": "sequence", "bits": 8})"});
  CHECK(with("/packed/fields/2/name", "z") ==
        Lines{R"(/packed/fields/2: "z" is not the next field of "update"; "y")"});
  CHECK(with("/packed/fields/1/bits", 15) ==
        Lines{"/packed/fields/1: 15 bits are too few for -32768 to 32767; 16, for integers below 0"});
  CHECK(with("/packed/fields/5/bits", 7) == Lines{"/packed/fields/5: 7 bits are too few for 0 to 255; more"});
  CHECK(with("/packed/fields/5/bits", 11) ==
        Lines{"/packed/fields: 111 bits; 112: seven for each byte between tag and CRC"});
}

TEST_CASE("an unknown member of any part of the sentences is named, with those that there are") {
  const Spec spec{"sentences"};
  const std::pair<std::string, const char*> rows[] = {
      {"", "$schema, robot, description, integer, packet, sentences, packed"},
      {"/integer", "min, max, source"},
      {"/packet", "bytes, source"},
      {confirm, "name, direction, description, letter, word, text, integers, fields, source"},
      {std::string{set_point} + "/fields/0", "name, unit, range, values, description"},
      {"/packed", "version, tag, sentence, description, fields, source"},
      {"/packed/fields/0", "name, bits"}};
  for (const auto& [where, known] : rows) {
    CAPTURE(where);
    CHECK(told(spec.with((where + "/zzz").c_str(), 1)) ==
          std::vector<std::string>{where + R"(/zzz: unknown member "zzz"; one of )" + known});
  }
}

TEST_CASE("a sentence has sixteen integers, and no more") {
  const Spec spec{"sentences"};
  const auto with = [&spec](int count) {
    Json fields = Json::array();
    for (int i = 0; i < count; ++i)
      fields.push_back({{"name", "f" + std::to_string(i)}, {"unit", ""}, {"description", "one of many"}});
    return told(spec.with("/sentences/1/fields", fields));
  };
  CHECK(with(16).empty());
  CHECK(with(17) == std::vector<std::string>{"/sentences/1/fields: 17 integers; at most 16"});
}

TEST_CASE("what only the schema of the sentences sees is reported with its place, and where to look") {
  const auto lines = told(Spec{"sentences"}.with("/$schema", 7));
  REQUIRE(lines.size() == 1);
  CHECK(lines[0].starts_with("/$schema: "));
  CHECK(lines[0].ends_with("; see sentences.schema.json"));
}

TEST_CASE("the least and the greatest integer of sentences may be one, and not the other way round") {
  const Spec spec{"sentences"};
  const auto is_told = [&](int min, int max) {
    const auto lines = told(spec.with("/integer", {{"min", min}, {"max", max}, {"source", "decided"}}));
    return std::find(lines.begin(), lines.end(),
                     "/integer: min is greater than max; the smaller one as min") != lines.end();
  };
  CHECK_FALSE(is_told(-32768, 32767));
  CHECK_FALSE(is_told(6, 7));
  CHECK_FALSE(is_told(7, 7));
  CHECK(is_told(8, 7));
}

TEST_CASE("of what is no file of sentences at all it is said what one has in it") {
  using ocm::spec::Problem;
  const auto only = [](const std::string& text) {
    const auto loaded = ocm::spec::parse_sentences(text, "s.json");
    REQUIRE(loaded.problems.size() == 1);
    return loaded.problems[0];
  };
  CHECK(only("") == Problem{"s.json:1:1", "the file is empty",
                            "a file of sentences is a JSON object with robot, description, integer, packet, "
                            "sentences and packed"});
  CHECK(only(std::string(33, '[') + std::string(33, ']')) ==
        Problem{"s.json:1", "nested deeper than 32 levels", "a file of sentences needs 7 levels at most"});
}

TEST_CASE("any bytes are a problem of the sentences, or sentences") {
  for (const char* text :
       {"", "{", "[]", "null", "{\"sentences\": [1]}", "\xFF\xFE", "{\"packed\": {\"fields\": [[]]}}"}) {
    CAPTURE(text);
    CHECK_FALSE(ocm::spec::parse_sentences(text, "s.json").problems.empty());
  }
}

}  // namespace generator_schemas_test
