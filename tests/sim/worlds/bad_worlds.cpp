// bad_worlds.json: what is changed in good.json (nothing named: all of it), and all that must be said about
// it.
#include <filesystem>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "generator/spec/json.hpp"
#include "generator/spec/schema.hpp"
#include "sim/worlds/reader.hpp"
#include "tests/sim/worlds/read.hpp"

namespace sim_worlds_bad_worlds_test {

TEST_CASE("every mistake in a world is reported with its place, what is wrong and what would be right") {
  const std::string good = read("tests/sim/worlds/good.json");
  const auto table = nlohmann::json::parse(read("tests/sim/worlds/bad_worlds.json"));
  REQUIRE(table.size() >= 30);
  static const ocm::spec::Schema schema{ocm::sim::worlds::schema_text(), {}};
  for (const auto& row : table) {
    const std::string from = row.at("replace");
    const std::string to = row.at("by");
    CAPTURE(from, to);
    std::string text = good;
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    text.replace(at, from.empty() ? text.size() : from.size(), to);
    const auto loaded = ocm::sim::worlds::parse(text, "bad.json");
    CHECK(printed(loaded.problems) == row.at("problems").get<std::vector<std::string>>());
    CHECK_FALSE(loaded.world);

    // An editor has only the schema: what is a matter of form it must see as well.
    std::vector<ocm::sim::worlds::Problem> problems;
    const auto root = ocm::spec::parse_json(text, "bad.json", problems);
    if (!problems.empty()) continue;
    schema.validate(root, "bad.json", problems);
    CHECK(problems.empty() != row.at("schema").get<bool>());
  }
}

TEST_CASE("no file, no world: the path is named") {
  const auto only = [](const std::filesystem::path& file) {
    const auto loaded = ocm::sim::worlds::load(file);
    REQUIRE(loaded.problems.size() == 1);
    CHECK(loaded.problems[0].place == file.string());
    CHECK_FALSE(loaded.world);
    return loaded.problems[0].what + "; " + loaded.problems[0].remedy;
  };
  CHECK(only("no/such.json") == "there is no such file; the path of a world, such as sim/worlds/square.json");
  CHECK(only("/tmp") == "it is a folder; the path of the world within it");
  CHECK(only("/dev/zero") == "the file is larger than 1000000 bytes; a world is smaller");
  const auto empty = ocm::sim::worlds::load("/dev/null");
  REQUIRE(empty.problems.size() == 1);
  CHECK(printed(empty.problems)[0] ==
        "/dev/null:1:1: the file is empty; a world is a JSON object with name, walls and robots");
}

TEST_CASE("a world of two bytes a character is named as that, as every file of JSON") {
  using namespace std::string_literals;
  CHECK(printed(ocm::sim::worlds::parse("\xFF\xFE"s + "{\0}\0"s, "w.json").problems) ==
        std::vector<std::string>{
            "w.json: the text is UTF-16LE; save it as UTF-8, such as iconv -f UTF-16LE -t UTF-8 writes it"});
}

TEST_CASE("a world that is neither a file nor built in, nor a folder") {
  for (const std::string name : {"atlantis", "/tmp"}) {
    const auto loaded = ocm::sim::worlds::find(name);
    REQUIRE(loaded.problems.size() == 1);
    CHECK_FALSE(loaded.world);
    CHECK(ocm::sim::worlds::in_words(loaded.problems[0]) == "there is no world '" + name + "'");
    CHECK(loaded.problems[0].remedy == "give a file, or one of those built in: labyrinth, range, square");
  }
  CHECK(ocm::sim::worlds::find("square").world);
}

TEST_CASE("a world with too much in it is refused") {
  const auto problems_of = [](const std::string& walls, const std::string& robots) {
    return printed(
        ocm::sim::worlds::parse(R"({"name":"w","walls":[)" + walls + R"(],"robots":[)" + robots + "]}", "f")
            .problems);
  };
  const std::string one = R"({"name":"AVR","model":"avr","at":[0,0]})";
  CHECK(problems_of("", one).empty());
  std::string zigzag = "[[9,9]";
  for (int i = 0; i < 999; ++i) zigzag += i % 2 == 0 ? ",[10,9]" : ",[9,9]";
  zigzag += "]";
  CHECK(problems_of(zigzag, one).empty());  // 999 pieces
  CHECK(problems_of(zigzag + ",[[9,9],[10,9],[9,9]]", one) ==
        std::vector<std::string>{"f:1: /walls/1: more than 1000 pieces of wall; fewer of them"});
  std::string crowd;
  for (int i = 0; i < 201; ++i)
    crowd += std::string{i == 0 ? "" : ","} + R"({"name":"r)" + std::to_string(i) +
             R"(","model":"avr","at":[)" + std::to_string(i) + ",0]}";
  CHECK(problems_of("", crowd) ==
        std::vector<std::string>{"f:1: /robots: a list of 201; a list of 1 to 200 robots"});
}

}  // namespace sim_worlds_bad_worlds_test
