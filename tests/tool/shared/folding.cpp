#include "cli/shared/folding.hpp"

#include <algorithm>
#include <string>

#include <catch2/catch.hpp>

namespace tool_shared_folding_test {

using namespace ocm::cli;

TEST_CASE("what a text takes on a terminal", "[folding]") {
  CHECK(extent("").all == 0);
  CHECK(extent("").words == 0);
  CHECK(extent("  ").words == 0);
  CHECK(extent("a b  ").all == 5);
  CHECK(extent("a b  ").words == 3);
  CHECK(extent("\x1b[31ma b \x1b[0m").all == 4);
  CHECK(extent("\x1b[31ma b \x1b[0m").words == 3);
  CHECK(extent("\xc2\xb5s").all == 2);
  CHECK(extent("a\x1b[").all == 1);
}

TEST_CASE("a line is broken at blanks, and only where it does not fit", "[folding]") {
  CHECK(folded("load 12.5 % at 500 kbit/s", 25, 4) == "load 12.5 % at 500 kbit/s");
  CHECK(folded("load 12.5 % at 500 kbit/s", 24, 4) == "load 12.5 % at 500\n    kbit/s");
  CHECK(folded("  load 12.5 % at 500 kbit/s", 24, 4) == "  load 12.5 % at 500\n    kbit/s");
  CHECK(folded("in 123456.789 s, the last", 20, 4) == "in 123456.789 s, the\n    last");
  CHECK(folded("in 12345678901234567890 s", 20, 4) == "in\n12345678901234567890\n    s");
  CHECK(folded("in 123456789012345678901 s", 20, 4) == "in\n123456789012345678901\n    s");
  CHECK(folded("publish|once|stop|drive|set", 20, 4) == "publish|once|stop|\n    drive|set");
  CHECK(folded("12345678 publish|onceabc", 20, 4) == "12345678\n    publish|onceabc");  // it just fits a line
  CHECK(folded("12345678 publish|onceabcd", 20, 4) == "12345678 publish|\n    onceabcd");
  CHECK(folded("one two", 3, 4) == "one\ntwo");
  CHECK(folded("", 0, 0) == "");
  CHECK(folded("a", 0, 0) == "a");
}

TEST_CASE("a help's descriptions stay below each other where there is room", "[folding]") {
  const std::string line = "  --json                      an object, for programs that read it";
  CHECK(folded_help(line, 200) == line);
  CHECK(folded_help("  --json  an object", 19) == "  --json  an object");  // it just fits
  CHECK(folded_help(line, 56) ==
        "  --json                      an object, for programs\n"
        "                              that read it");
  CHECK(folded_help(line, 40) ==
        "  --json\n"
        "      an object, for programs that read\n"
        "      it");
  CHECK(folded_help("  --spec FILE (AMIROCTL_SPEC) topics of another robot", 54) ==
        "  --spec FILE (AMIROCTL_SPEC) topics of another robot");
  CHECK(folded_help("  --spec FILE (AMIROCTL_SPEC) topics of a robot, as JSON", 54) ==
        "  --spec FILE (AMIROCTL_SPEC) topics of a robot, as\n"
        "                              JSON");
  CHECK(folded_help("                              the second line of an option", 40) ==
        "      the second line of an option");
  CHECK(folded_help("Usage: amiroctl publish TOPIC [PERIOD] [OPTION ...]", 40) ==
        "Usage: amiroctl publish TOPIC [PERIOD]\n"
        "  [OPTION ...]");
}

TEST_CASE("a help's description goes below where beside it there are fewer than 24 columns", "[folding]") {
  const std::string line = "  --json                      an object, for programs that read it";
  CHECK(folded_help(line, 54) ==
        "  --json                      an object, for programs\n"
        "                              that read it");
  CHECK(folded_help(line, 53) ==
        "  --json\n"
        "      an object, for programs that read it");
  const std::string second = "                              the second line of an option of some verb";
  CHECK(folded_help(second, 54) ==
        "                              the second line of an\n"
        "                              option of some verb");
  CHECK(folded_help(second, 53) == "      the second line of an option of some verb");
  // Below a lead as wide as the column lines stay below each other; below a narrower one they are moved in.
  const std::string words = "the second line of an option of some verb";
  CHECK(folded_help(std::string(28, ' ') + words, 54) ==
        std::string(28, ' ') + "the second line of an\n" + std::string(28, ' ') + "option of some verb");
  CHECK(folded_help(std::string(27, ' ') + words, 54) ==
        std::string(27, ' ') + "the second line of an\n" + std::string(29, ' ') + "option of some verb");
  // What is described is long itself, and without a lead.
  CHECK(folded_help("amiroctl publish TOPIC PERIOD  asks a board for a sensor's samples", 36) ==
        "amiroctl publish TOPIC PERIOD\n"
        "    asks a board for a sensor's\n"
        "    samples");
  CHECK(folded_help("  amiroctl publish TOPIC [PERIOD] [OPTION ...]  asks a board", 30) ==
        "  amiroctl publish TOPIC\n"
        "    [PERIOD] [OPTION ...]\n"
        "      asks a board");
}

TEST_CASE("a line of a help that just fits stays as it is, whatever room its description has", "[folding]") {
  for (const std::string& line :
       {std::string{"  --json                      an object"}, std::string(30, ' ') + "of an option",
        std::string{"Usage: amiroctl list"}}) {
    CAPTURE(line);
    CHECK(folded_help(line, line.size()) == line);
    CHECK(folded_help(line, line.size() - 1) != line);
  }
}

TEST_CASE("only an option that fills its column has one blank before its description", "[folding]") {
  // Of other lines the words behind the column belong to what is described.
  CHECK(folded_help("  a word that is as long as it is said to be in a help", 40) ==
        "  a word that is as long as it is said\n"
        "    to be in a help");
  CHECK(folded_help("  --spec FILE (AMIROCTL_SPE topics of another robot, as JSON", 54) ==
        "  --spec FILE (AMIROCTL_SPE topics of another robot,\n"
        "    as JSON");
  // Nor is a description that ends with the column an option that fills it.
  CHECK(folded_help("  --all  what it is for, a wo ", 28) ==
        "  --all\n"
        "      what it is for, a wo ");
  // One that is longer than its column has two.
  CHECK(folded_help("  --an-option-with-a-very-long-name  what it is for, said in some words", 60) ==
        "  --an-option-with-a-very-long-name\n"
        "      what it is for, said in some words");
}

TEST_CASE("whatever the width, words stay whole and in order, and lines are no longer than they must be",
          "[folding]") {
  const std::string text = "  a load of 12.5 % at 500 kbit/s, an_identifier_that_is_long and some more words";
  for (std::size_t columns = 1; columns < 100; ++columns)
    for (const std::size_t indent : {std::size_t{0}, std::size_t{4}, std::size_t{12}}) {
      CAPTURE(columns, indent);
      std::string words, line;
      std::size_t lines = 0;
      for (const char c : folded(text, columns, indent) + "\n") {
        if (c != '\n') {
          line += c;
          continue;
        }
        const bool is_one_word =
            line.find(' ', std::min(line.find_first_not_of(' '), line.size())) == std::string::npos;
        CHECK((extent(line).all <= columns || is_one_word));
        CHECK(extent(line).all == extent(line).words);  // no blanks at its end
        if (lines++ > 0 && indent + 16 <= columns && extent(line).all < columns)
          CHECK(line.find_first_not_of(' ') <= indent);
        words += (words.empty() ? "" : " ") + line.substr(line.find_first_not_of(' '));
        line.clear();
      }
      CHECK(words == text.substr(2));
    }
}

}  // namespace tool_shared_folding_test
