#include "cli/words/script.hpp"

#include <fstream>
#include <iterator>

#include <catch2/catch.hpp>

#include "ocm/can/text.hpp"
#include "ocm/topics/amiro.hpp"

namespace tool_words_script_test {

using namespace ocm;
using namespace ocm::cli::words;
using namespace std::chrono_literals;

TEST_CASE("steps, comments, colours and frames") {
  const auto script = parse_script(
      "# the first line\n"
      "\n"
      "  1s   publish gyro 500ms   # asks\r\n"
      "\t1.5s led 1 #643278 # colours are no comments\n"
      "2s send 205#00",
      amiro::catalogue);
  REQUIRE(script.errors.empty());
  REQUIRE(script.steps.size() == 3);
  CHECK(script.steps[0].at == 1s);
  CHECK(script.steps[0].line == 3);
  CHECK(script.steps[0].text == "publish gyro 500ms");
  CHECK(can::to_text(script.steps[1].command.frames[0]) == "23C#643278");
  CHECK(script.steps[2].text == "send 205#00");
  // The byte order mark of some editors.
  CHECK(parse_script("\xEF\xBB\xBF"
                     "1s stop",
                     amiro::catalogue)
            .errors.empty());
  CHECK(parse_script("1s stop\n\xEF\xBB\xBF"
                     "1s stop",
                     amiro::catalogue)
            .errors.size() == 1);
}

TEST_CASE("what is between quotation marks is one word") {
  const auto whole = parse_script(
      "1s \"publish\" gy\"ro\" 500ms   # \"asks\r\n"
      "#\" a comment\n"
      "2s send 205#\"00\"",
      amiro::catalogue);
  REQUIRE(whole.errors.empty());
  REQUIRE(whole.steps.size() == 2);
  CHECK(whole.steps[0].text == "\"publish\" gy\"ro\" 500ms");
  CHECK(whole.steps[1].text == "send 205#\"00\"");
  CHECK(can::to_text(whole.steps[1].command.frames[0]) == "205#00");

  const auto blank = parse_script("1s publish \"gyro 500ms\"\n2s send 205#\"00\n", amiro::catalogue);
  REQUIRE(blank.errors.size() == 2);
  CHECK(blank.errors[0].column == 12);
  CHECK_THAT(blank.errors[0].what, Catch::Contains("'gyro 500ms'"));
  CHECK(blank.errors[1].column == 13);
  CHECK_THAT(blank.errors[1].what, Catch::Contains("quotation mark"));
}

TEST_CASE("every error is reported, with line and column") {
  const auto script = parse_script(
      "1s publish gyr 500ms\n"
      "soon publish gyro\n"
      "2s led 1\n"
      "3s\n"
      "-1s stop\n"
      "4s   drive 5cm/s --for ever\n"
      "5s stop\n"
      "1s stop\n",
      amiro::catalogue);
  struct Row {
    std::size_t line, column;
    const char* what;
  };
  const Row rows[] = {{1, 12, "no topic 'gyr'"},           {2, 1, "'soon' is not a time"},
                      {3, 9, "missing COLOUR|off"},        {4, 3, "no command"},
                      {5, 1, "'-1s' is not a time"},       {6, 24, "not a time above zero"},
                      {8, 1, "lies before the step at 5s"}};
  REQUIRE(script.errors.size() == std::size(rows));
  for (std::size_t i = 0; i < std::size(rows); ++i) {
    CAPTURE(i);
    CHECK(script.errors[i].line == rows[i].line);
    CHECK(script.errors[i].column == rows[i].column);
    CHECK_THAT(script.errors[i].what, Catch::Contains(rows[i].what));
  }
}

TEST_CASE("an empty script is an error") {
  for (const char* text : {"", "\n\n", "# only words\n"}) {
    CAPTURE(text);
    CHECK(parse_script(text, amiro::catalogue).errors.size() == 1);
  }
}

TEST_CASE("the standalone demo is what the thesis lists, with its misprints mended") {  // thesis 6.3,
                                                                                        // figures 6.4 and 6.5
  std::ifstream file{OCM_SOURCE_DIR "/examples/standalone.script"};
  const std::string text{std::istreambuf_iterator<char>{file}, {}};
  const auto script = parse_script(text, amiro::catalogue);
  REQUIRE(script.errors.empty());
  struct Row {
    base::Duration at;
    const char* frame;
  };
  const Row rows[] = {{1s, "209#01F40100"},
                      {5s, "21F#01E80300"},
                      {10s, "21E#02"},
                      {15s, "208#01881300"},
                      {16s, "21F#00"},
                      {17s, "205#01200300"},
                      {18s, "209#00"},
                      {21s, "203#01840300"},
                      {23s, "201#50C3000000000000"},
                      {25s, "23C#FFFFFF"},
                      {27s, "201#0000000000000000"},
                      {30s, "203#00"},
                      {31s, "208#00"},
                      {32s, "21E#02"},
                      {33s, "204#01D00700"},
                      {35s, "205#00"},
                      {38s, "204#00"},
                      {40s, "23D#FFFFFF"},
                      {40s, "23F#FFFFFF"},
                      {40s, "241#FFFFFF"},
                      {40s, "243#FFFFFF"}};
  REQUIRE(script.steps.size() == std::size(rows));
  for (std::size_t i = 0; i < std::size(rows); ++i) {
    CAPTURE(i);
    CHECK(script.steps[i].at == rows[i].at);
    REQUIRE(script.steps[i].command.frames.size() == 1);
    CHECK(can::to_text(script.steps[i].command.frames[0]) == std::string_view{rows[i].frame});
  }
}

TEST_CASE("a script names what was probably meant for as many errors as are shown") {
  std::string text;
  for (std::size_t i = 0; i <= most_explained; ++i) text += "0s publsh gyro\n";
  const auto script = parse_script(text, amiro::catalogue);
  REQUIRE(script.errors.size() == most_explained + 1);
  CHECK(script.errors.front().remedy == "did you mean 'publish'?");
  CHECK(script.errors[most_explained - 1].remedy == "did you mean 'publish'?");
  CHECK(script.errors.back().what == "unknown command 'publsh'");
  CHECK(script.errors.back().remedy == "correct the errors before this one first");
}

}  // namespace tool_words_script_test
