// What people read on stderr, and the counts in it.
#include "cli/shared/messages.hpp"

#include <string>

#include <catch2/catch.hpp>

namespace messages_test {

using namespace ocm::cli;

TEST_CASE("messages: characters that command a terminal are written out, each of them") {
  CHECK(printable("a\tb\nc d") == "a\tb\nc d");
  CHECK(printable(std::string{"\0\x01\x1b\x1f ~\x7f", 7}) == "\\x00\\x01\\x1b\\x1f ~\\x7f");
  // U+0080 and U+009F are controls, U+00A0 and what comes behind is none.
  CHECK(printable("\u0080\u009f\u00a0\u00e4\u20ac\U0001f600") == "\\x80\\x9f\u00a0\u00e4\u20ac\U0001f600");
  // Bytes that are no UTF-8: a character that is cut off, and one that cannot begin.
  CHECK(printable("\xe2\x82") == "\\xe2\\x82");
  CHECK(printable("x\x9b") == "x\\x9b");
}

TEST_CASE("messages: each line is broken between words, below what it goes on with") {
  const std::string error =
      "amiroctl: di_wheel_drive refuses magnetometer: not_schedulable\n          `amiroctl publish mag` with "
      "2ms";
  CHECK(folded_message(error, 200) == error);
  CHECK(folded_message(error, 40) ==
        "amiroctl: di_wheel_drive refuses\n          magnetometer: not_schedulable\n"
        "          `amiroctl publish mag` with\n          2ms");
  CHECK(folded_message("bus: sim (the only one)", 12) ==
        "bus: sim\n(the only\none)");  // no room beside blanks
  CHECK(folded_message("  left: 3 frames were lost", 22) == "  left: 3 frames were\n      lost");
  CHECK(folded_message("a_word_that_is_longer", 10) == "a_word_that_is_longer");
  CHECK(folded_message("", 10).empty());
  CHECK(folded_message("a\n\nb\n", 10) == "a\n\nb\n");
}

TEST_CASE("messages: counts, and only those of something") {
  CHECK(counted(0, "frame") == "0 frames");
  CHECK(counted(1, "frame") == "1 frame");
  CHECK(counted(2, "frame") == "2 frames");
  std::string text = "sent";
  add_count(text, 0, "lost");
  add_count(text, 0, "error", "left out");
  CHECK(text == "sent");
  add_count(text, 1, "lost");
  add_count(text, 2, "error", "left out");
  add_count(text, 1, "gap", "");
  CHECK(text == "sent, 1 lost, 2 errors left out, 1 gap");
}

}  // namespace messages_test
