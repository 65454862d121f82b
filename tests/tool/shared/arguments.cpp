// What a command line comes to, before any verb reads its words.
#include "cli/shared/arguments.hpp"

#include <cstdint>
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

TEST_CASE("arguments: a whole number is not negative, and has the room of its option") {
  const char* const whole = "not a whole number\n          write a whole number, such as 10\n";
  const auto typed = [](const std::string& text, auto& number) {
    Program program{"amiroctl", "a program", "1", "", "begin with go"};
    program.add_verb("go", Program::About::itself, [&](Verb verb) {
      verb.describe("goes", "Verbs", "  amiroctl go --times 2");
      verb.add_option("--times", number, "how often");
    });
    std::vector<std::string> words{"amiroctl", "go", "--times=" + text};
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    test::Captured said{STDERR_FILENO};
    static_cast<void>(program.run(static_cast<int>(words.size()), pointers.data()));
    return said.text();
  };
  std::uint64_t wide = 0;
  std::uint32_t narrow = 0;
  for (const char* const text :
       {"-1", "-0", " -1", " 1", "-18446744073709551615", "x", "1x", "1.5", "0x", "0xg"}) {
    CAPTURE(text);
    CHECK_THAT(typed(text, wide), Catch::Contains(whole));
    CHECK_THAT(typed(text, narrow), Catch::Contains(whole));
  }
  CHECK_THAT(typed("18446744073709551616", wide),
             Catch::Contains("too large\n          the greatest is 18446744073709551615\n"));
  CHECK_THAT(typed("99999999999999999999", wide), Catch::Contains("too large"));
  CHECK_THAT(typed("4294967296", narrow),
             Catch::Contains("too large\n          the greatest is 4294967295\n"));
  CHECK_THAT(typed("0x10000000000000000", wide), Catch::Contains("too large"));
  CHECK(typed("0xFFFFFFFFFFFFFFFF", wide).empty());
  CHECK(wide == 18'446'744'073'709'551'615U);
  CHECK(typed("+12", wide).empty());
  CHECK(wide == 12);
  CHECK(typed("18446744073709551615", wide).empty());
  CHECK(wide == 18'446'744'073'709'551'615U);
  CHECK(typed("4294967295", narrow).empty());
  CHECK(narrow == 4'294'967'295U);
  CHECK(typed("0010", wide).empty());
  CHECK(wide == 10);
  CHECK(typed("0", narrow).empty());
  CHECK(narrow == 0);
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

TEST_CASE(
    "arguments: of an option that may stand without a value a config file has the value, whatever it is") {
  for (const std::string text : {"off", "no", "0", "-1", "LINK"}) {
    CAPTURE(text);
    Program program{"amiroctl", "a program", "1", "", "begin with go"};
    std::string link;
    const cli::Option option =
        program.root().add_option("--pty", link, "a pseudo terminal").expected(0, 1).type_name("[LINK]");
    CHECK_FALSE(option.give("pty", {text}).has_value());
    CHECK(option.count() == 1);
    CHECK(option.texts() == Words{text});
    CHECK(link == text);
  }
}

}  // namespace tool_shared_arguments_test
