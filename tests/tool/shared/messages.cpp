// What people read on stderr, and the counts in it.
#include "cli/shared/messages.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <fcntl.h>
#include <string>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "cli/shared/unhurried_messages.hpp"
#include "tests/tool/piped_stderr.hpp"

namespace messages_test {

using namespace ocm::cli;
using ocm::test::PipedStderr;

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

TEST_CASE("messages: only counts of something") {
  std::string text = "sent";
  add_count(text, 0, "lost");
  add_count(text, 0, "error", "left out");
  CHECK(text == "sent");
  add_count(text, 1, "lost");
  add_count(text, 2, "error", "left out");
  add_count(text, 1, "gap", "");
  CHECK(text == "sent, 1 lost, 2 errors left out, 1 gap");
}

TEST_CASE("messages: unhurried ones wait for no reader, and come in their order") {
  const PipedStderr pipe;
  std::chrono::steady_clock::time_point too_late;
  {
    const UnhurriedMessages unhurried;
    remark("at once");
    CHECK(pipe.read() == "at once\n");
    pipe.fill();
    remark("first");
    complain({"second", "a remedy"});
    CHECK(pipe.read().empty());
    UnhurriedMessages::write();
    CHECK(pipe.read() == "first\namiroctl: second\n          a remedy\n");
    pipe.fill();
    remark("before the next");
    CHECK(pipe.read().empty());
    remark(std::string(1000, 'x'));
    CHECK(pipe.read() == "before the next\n" + std::string(1000, 'x') + "\n");
    // More than there is room for: the first ones, and how many more there were.
    pipe.fill();
    for (int i = 0; i < 1003; ++i) remark(i == 999 ? "the last" : "one of many");
    std::string all = pipe.read();
    for (int reads = 0; reads < 100; ++reads) {
      UnhurriedMessages::write();
      all += pipe.read();
    }
    CHECK(all.size() == 999 * 12 + std::string{"the last\n3 messages lost: stderr took none\n"}.size());
    CHECK_THAT(all, Catch::EndsWith("one of many\nthe last\n3 messages lost: stderr took none\n"));
    pipe.fill();
    remark("too late");
    too_late = std::chrono::steady_clock::now();
  }  // waits a second for a reader
  CHECK(std::chrono::steady_clock::now() - too_late >= std::chrono::seconds{1});
  CHECK(pipe.read().empty());
  remark("as usual");
  CHECK(pipe.read() == "as usual\n");
}

TEST_CASE("messages: a line has its end, also where it ends with one of the pieces in which it is written") {
  const PipedStderr pipe;
  const UnhurriedMessages unhurried;
  for (const std::size_t size : {0UL, 1UL, 255UL, 256UL, 257UL, 511UL, 512UL, 513UL, 4096UL}) {
    CAPTURE(size);
    const std::string line(size, 'x');
    remark(line);
    CHECK(pipe.read() == line + "\n");
  }
}

TEST_CASE("messages: held ones are counted, and written when they are held no more") {
  const PipedStderr pipe;
  {
    const HeldMessages held;
    CHECK(HeldMessages::newest().empty());
    remark("one");
    remark("two");
    CHECK(HeldMessages::count() == 2);
    CHECK(HeldMessages::newest() == "two");
    CHECK(pipe.read().empty());
  }
  CHECK(pipe.read() == "one\ntwo\n");
  CHECK(HeldMessages::count() == 0);
}

TEST_CASE("messages: of several parts that wait for no reader the last one ends that") {
  const PipedStderr pipe;
  {
    const UnhurriedMessages outer;
    pipe.fill();
    {
      const UnhurriedMessages inner;
      remark("for later");
    }
    CHECK(pipe.read().empty());
    UnhurriedMessages::write();
    CHECK(pipe.read() == "for later\n");
    pipe.fill();
    remark("for later, too");
    CHECK(pipe.read().empty());
  }
  CHECK(pipe.read() == "for later, too\n");
}

TEST_CASE("messages: held ones stay held behind a part that waits for no reader") {
  const PipedStderr pipe;
  {
    const HeldMessages held;
    {
      const UnhurriedMessages unhurried;
      remark("one");
      UnhurriedMessages::write();
    }
    CHECK(pipe.read().empty());
    CHECK(HeldMessages::count() == 1);
    remark("two");
    CHECK(HeldMessages::newest() == "two");
  }
  CHECK(pipe.read() == "one\ntwo\n");
}

TEST_CASE("messages: what is written now is as much as is taken, and why no more") {
  const PipedStderr pipe;
  const std::string line(1000, 'x'), much(1 << 20, 'x');
  Written written = write_now(STDERR_FILENO, line);
  CHECK(written.bytes == line.size());
  CHECK(written.error == 0);
  CHECK(pipe.read() == line);
  written = write_now(STDERR_FILENO, much);
  CHECK(written.bytes >= 4096);
  CHECK(written.bytes < much.size());
  CHECK(written.error == 0);
  CHECK(pipe.read().size() == written.bytes);
  pipe.fill();
  written = write_now(STDERR_FILENO, line);
  CHECK(written.bytes == 0);
  CHECK(written.error == 0);
  std::array<int, 2> ends{};
  REQUIRE(::pipe2(ends.data(), O_CLOEXEC) == 0);
  ::close(ends[0]);
  {
    const WithoutBrokenPipe without;
    written = write_now(ends[1], line);
  }
  CHECK(written.bytes == 0);
  CHECK(written.error == EPIPE);
  ::close(ends[1]);
}

}  // namespace messages_test
