// All mistakes of a kind, made one by one in files that have none: each value of a spec is left out, or
// another one is in its place; each word of a DBC file's statements is left out, doubled, or another one, or
// the file or the line ends there. What is reported of each is in golden/mistakes.*.txt. bad_specs.json and
// dbc.cpp have the mistakes that people make, one by one.
//
// OCM_WRITE_GOLDEN=1 build/mistakes_tests writes the files again; read the difference before you commit it.
#include "tests/generator/mistakes.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "generator/spec/sentences.hpp"
#include "generator/spec/spec.hpp"
#include "generator/targets/target.hpp"

namespace generator_mistakes_test {

using mistakes::compare;
using mistakes::mistakes_of;

TEST_CASE("what is reported of each mistake in a spec of topics, and of messages") {
  const auto parse = [](const std::string& text) { return ocm::spec::parse(text, "f"); };
  compare("generator/golden/mistakes.topics.txt", mistakes_of("generator/mistakes.json", parse));
  compare("generator/golden/mistakes.messages.txt", mistakes_of("generator/good_messages.json", parse));
}

TEST_CASE("what is reported of each mistake in a file of sentences") {
  compare("generator/golden/mistakes.sentences.txt",
          mistakes_of("generator/golden/sentences.json",
                      [](const std::string& text) { return ocm::spec::parse_sentences(text, "f"); }));
}

// --- DBC -----------------------------------------------------------------------------------------------------

/// The words of a line as the format has them; a quoted text is one.
std::vector<std::string> words_of(const std::string& line) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < line.size();) {
    std::size_t end = i + 1;
    if (line[i] == '"') {
      end = line.find('"', i + 1) + 1;
    } else if (std::string_view{":;,|@()[]"}.find(line[i]) == std::string_view::npos && line[i] != ' ') {
      while (end < line.size() && std::string_view{":;,|@()[]\" "}.find(line[end]) == std::string_view::npos)
        ++end;
    }
    if (line[i] != ' ') words.push_back(line.substr(i, end - i));
    i = end;
  }
  return words;
}

/// What is reported, and in which lines our JSON of it is another than `good`: what is left of the file
/// counts as well. The whole JSON where there is no good one.
std::string read_dbc(const std::string& text, std::vector<std::string>& good) {
  const auto loaded = ocm::spec::parse(text, "f.dbc");
  std::string out;
  const auto add = [&out](const auto& findings) {
    for (const auto& each : findings)
      out += (out.empty() ? "" : " | ") + each.place.substr(5) + ": " + each.what + "; " + each.remedy;
  };
  add(loaded.problems);
  if (!loaded.doubts.empty()) out += out.empty() ? "doubtful" : " | doubtful";
  add(loaded.doubts);
  if (!loaded.spec) return " " + out;
  std::istringstream json{ocm::generate::make_spec(loaded.spec->model(), {"f.dbc", std::nullopt})};
  std::vector<std::string> lines;
  for (std::string line; std::getline(json, line);)
    if (line.find("\"source\": \"f.dbc:") == std::string::npos) lines.push_back(line);  // each line's number
  const auto without = [&out](const std::vector<std::string>& all, const std::vector<std::string>& others,
                              char mark) {
    for (const std::string& line : all)
      if (std::find(others.begin(), others.end(), line) == others.end())
        out += "\n    " + (mark + line.substr(std::min(line.find_first_not_of(' '), line.size())));
  };
  without(good, lines, '-');
  without(lines, good, '+');
  if (good.empty()) good = lines;
  return out.empty() ? " the same" : out.starts_with('\n') ? out : " " + out;
}

TEST_CASE("what is reported of each mistake in each statement of a DBC file, and what is read then") {
  const std::string head =
      "BU_: N O\nVAL_TABLE_ T 3 \"c\" ;\nBO_ 1 A: 8 N\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" N\n SG_ P M : 8|8@1+ "
      "(1,0) [0|0] \"\" N\n SG_ Q m1 : 32|32@1- (1,0) [0|0] \"\" N\n";
  const std::string tail = "BO_ 2 B: 1 O\n";
  const std::string statements[] = {
      "VERSION \"1\"",
      "NS_ : CM_ BA_",
      "BS_: 500 : 1,2",
      "BU_: X, Y",
      "BO_ 7 C: 3 N",
      "BO_ 8 D: 4 N\n SG_ E m3M : 7|16@0- (0.5,-1.5) [-2|3] \"u\" N,O",
      "CM_ BO_ 1 \"text\";",
      "CM_ SG_ 1 S \"text\";",
      "CM_ BU_ N \"text\";",
      "CM_ \"text\";",
      "VAL_ 1 S 0 \"a\" -1 \"b\" ;",
      "VAL_ 1 S T ;",
      "VAL_ Env 0 \"a\" ;",
      "VAL_TABLE_ U 0 \"a\" 1 \"b\" ;",
      "BA_DEF_ BO_ \"I\" INT 0 10 ;",
      "BA_DEF_ \"E\" ENUM \"a\",\"b\" ;",
      "BA_DEF_ SG_ \"T\" STRING ;",
      "BA_DEF_ BU_ \"F\" FLOAT -1.5 1e3 ;",
      "BA_DEF_ BO_ \"I\" HEX 0 255 ;\nBA_DEF_DEF_ \"I\" 5 ;",
      "BA_ \"K\" 1 ;",
      "BA_ \"K\" BO_ 1 \"v\" ;",
      "BA_ \"K\" SG_ 1 S 2 ;",
      "BA_ \"K\" BU_ N 3 ;",
      "SIG_VALTYPE_ 1 Q : 1 ;",
      "SG_MUL_VAL_ 1 Q P 1-2, 4-4 ;",
      "BO_TX_BU_ 1 : N,O ;",
      "EV_ V: 0 [0|1] \"\" 0 1 D N ;",
  };
  std::string text;
  std::vector<std::string> base;
  text += "== nothing more:" + read_dbc(head + tail, base) + "\n";
  for (const std::string& statement : statements) {
    std::vector<std::string> good = base;
    text += "== " + statement + "\n";
    std::vector<std::string> words;  // with the breaks of lines
    std::istringstream lines{statement};
    for (std::string line; std::getline(lines, line);) {
      if (!words.empty()) words.emplace_back("\n");
      for (std::string& word : words_of(line)) words.push_back(std::move(word));
    }
    const auto joined = [](const std::vector<std::string>& all) {
      std::string out;
      for (const std::string& word : all) out += (out.empty() || out.ends_with('\n') ? "" : " ") + word;
      return out;
    };
    text += "good:" + read_dbc(head + joined(words) + "\n" + tail, good) + "\n";
    good.clear();
    read_dbc(head + joined(words) + "\n" + tail, good);
    for (std::size_t i = 0; i < words.size(); ++i) {
      const auto with = [&](const std::string& what, const std::vector<std::string>& between,
                            std::size_t skipped) {
        std::vector<std::string> changed{words.begin(), words.begin() + static_cast<std::ptrdiff_t>(i)};
        changed.insert(changed.end(), between.begin(), between.end());
        changed.insert(changed.end(), words.begin() + static_cast<std::ptrdiff_t>(i + skipped), words.end());
        text += what + " " + std::to_string(i) + ":" + read_dbc(head + joined(changed) + "\n" + tail, good) +
                "\n";
      };
      with("without", {}, 1);
      with("word", {"odd"}, 1);
      with("number", {"9"}, 1);
      with("text", {"\"t\""}, 1);
      with("end", {";"}, 1);
      with("comma", {","}, 1);
      with("line", {"\n"}, 0);
      const std::vector<std::string> first{words.begin(), words.begin() + static_cast<std::ptrdiff_t>(i)};
      text += "cut " + std::to_string(i) + ":" + read_dbc(head + joined(first), good) + "\n";
    }
    text += "open:" + read_dbc(head + joined(words) + "\nCM_ \"open", good) + "\n";
  }
  compare("generator/golden/mistakes.dbc.txt", text);
}

}  // namespace generator_mistakes_test
