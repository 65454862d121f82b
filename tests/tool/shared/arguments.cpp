// What a command line comes to, before any verb reads its words.
#include "cli/shared/arguments.hpp"

#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "tests/tool/captured.hpp"

namespace tool_shared_arguments_test {

using namespace ocm;
using cli::Program;
using cli::Verb;
using Words = std::vector<std::string>;

/// What came of a command line of a program with a verb `go`, that takes words.
struct Taken {
  Program::Outcome outcome = Program::Outcome::told;
  Words words;
  std::string bus;
  std::string said;
};
Taken take(Words words) {
  Taken taken;
  Program program{"amiroctl", "a program", "1", "", "begin with go"};
  program.root().add_option("--bus", taken.bus, "which one").type_name("NAME");
  program.add_verb("go", Program::About::itself, [&taken](Verb verb) {
    verb.describe("goes", "Verbs", "  amiroctl go 5cm/s");
    verb.add_option("words", taken.words, "how fast");
  });
  words.insert(words.begin(), "amiroctl");
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  test::Captured said{STDERR_FILENO};
  taken.outcome = program.run(static_cast<int>(words.size()), pointers.data());
  taken.said = said.text();
  return taken;
}

TEST_CASE("arguments: a negative number without a zero is a number, and no option") {
  for (const auto& [typed, word] : std::vector<std::pair<std::string, std::string>>{{"-.1m/s", "-0.1m/s"},
                                                                                    {"-.05m/s", "-0.05m/s"},
                                                                                    {"-.9m/s", "-0.9m/s"},
                                                                                    {"-.9", "-0.9"},
                                                                                    {"-0.5m/s", "-0.5m/s"}}) {
    CAPTURE(typed);
    const Taken found = take({"go", typed});
    CHECK(found.outcome == Program::Outcome::done);
    CHECK(found.words == Words{word});
    CHECK(found.said.empty());
  }
  CHECK(take({"go", "-.x"}).outcome == Program::Outcome::refused);
}

TEST_CASE("arguments: the verb stands behind the options of the program, and their values") {
  for (const Words& words : {Words{"--bus", "go", "go", "1"}, Words{"--bus=go", "go", "1"},
                             Words{"go", "--bus", "go", "1"}, Words{"go", "1", "--bus=go"}}) {
    CAPTURE(words);
    const Taken found = take(words);
    CHECK(found.outcome == Program::Outcome::done);
    CHECK(found.bus == "go");
    CHECK(found.words == Words{"1"});
  }
}

TEST_CASE("arguments: an option at the end has no value, and words without a verb do nothing") {
  const Taken without_value = take({"--bus"});
  CHECK(without_value.outcome == Program::Outcome::refused);
  CHECK(without_value.said == "amiroctl: missing value for --bus\n          usage: --bus NAME\n");
  const Taken behind_verb = take({"go", "--bus"});
  CHECK(behind_verb.outcome == Program::Outcome::refused);
  CHECK(behind_verb.said == "amiroctl: go: missing value for --bus\n          usage: --bus NAME\n");
  const Taken without_verb = take({"--bus", "go"});
  CHECK(without_verb.outcome == Program::Outcome::refused);
  CHECK(without_verb.said == "amiroctl: missing VERB\n          begin with go\n");
}

}  // namespace tool_shared_arguments_test
