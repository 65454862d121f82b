#include "cli/shared/folding.hpp"

#include <catch2/catch.hpp>

namespace tool_output_folding_test {

using namespace ocm::cli;

TEST_CASE("what a text takes on a terminal", "[folding]") {
  CHECK(extent("").all == 0);
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
  CHECK(folded("one two", 3, 4) == "one\ntwo");
  CHECK(folded("", 0, 0) == "");
  CHECK(folded("a", 0, 0) == "a");
}

TEST_CASE("a help's descriptions stay below each other where there is room", "[folding]") {
  const std::string line = "  --json                      an object, for programs that read it";
  CHECK(folded_help(line, 200) == line);
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

}  // namespace tool_output_folding_test
