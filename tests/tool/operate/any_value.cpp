// No value of an operator file that is missing or wrong makes the reader or the proof fall: it is said what
// is wrong, with its place, or it is taken.
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "ocm/topics/amiro.hpp"

#include "cli/operate/operator_file.hpp"
#include "cli/operate/study.hpp"
#include "tests/tool/golden.hpp"
#include "unit/base/explore.hpp"

namespace operate_any_value_test {

using namespace ocm;
using namespace ocm::test;
namespace operate = cli::operate;
using Json = nlohmann::ordered_json;
using Pointer = Json::json_pointer;

/// Of all values below this one, containers too.
void collect(const Json& node, const Pointer& at, std::vector<Pointer>& pointers) {
  for (const auto& [key, value] : node.items()) {
    const auto below = node.is_array() ? at / static_cast<std::size_t>(std::stoul(key)) : at / key;
    pointers.push_back(below);
    if (value.is_structured()) collect(value, below, pointers);
  }
}

void remove(Json& document, const Pointer& at) {
  auto& parent = document.at(at.parent_pointer());
  if (parent.is_array())
    parent.erase(std::stoul(at.back()));
  else
    parent.erase(at.back());
}

TEST_CASE("operate: every value of a file may be missing or wrong") {
  for (const auto* file : {"examples/guard.operator.json", "tests/tool/operate/wide.operator.json"}) {
    const auto document = Json::parse(text_of(file));
    std::vector<Pointer> pointers;
    collect(document, Pointer{}, pointers);
    CHECK(pointers.size() > 100);
    std::size_t refused = 0, taken = 0;
    const std::size_t step = test::sanitized ? 7 : 1;
    for (std::size_t i = 0; i < pointers.size(); i += step) {
      const auto& at = pointers[i];
      auto without = document, word = document, number = document;
      remove(without, at);
      word.at(at) = "none";
      number.at(at) = -1;
      for (const auto* changed : {&without, &word, &number}) {
        CAPTURE(at.to_string(), changed->dump());
        const auto loaded = operate::parse(changed->dump(), "changed.json", amiro::catalogue, 500'000);
        CHECK((loaded.file == nullptr) != loaded.problems.empty());
        const auto is_said = [](const std::vector<spec::Problem>& problems) {
          for (const auto& problem : problems) {
            CHECK(std::string_view{problem.place}.substr(0, 13) == "changed.json:");
            CHECK_FALSE(problem.what.empty());
            CHECK_FALSE(problem.remedy.empty());
          }
        };
        is_said(loaded.problems);
        (loaded.file ? taken : refused) += 1;
        if (!loaded.file) continue;
        const auto study = operate::study(*loaded.file, 500'000);
        is_said(study.doubts);
        CHECK(Json::accept(operate::to_json(study)));
        CHECK_FALSE(operate::to_table(study).empty());
      }
    }
    CHECK(refused > 100 / step);
    CHECK(taken > 20 / step);
  }
}

}  // namespace operate_any_value_test
