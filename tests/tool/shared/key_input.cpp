// Keys as they are pressed on a terminal of the test's own: of a sequence that is cut, the beginning waits.
#include "cli/shared/key_input.hpp"

#include <array>
#include <fcntl.h>
#include <string>
#include <termios.h>
#include <unistd.h>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/host/descriptor.hpp"

#include "tests/tool/pseudo_terminal.hpp"

namespace tool_shared_key_input_test {

using namespace ocm;
using cli::KeyInput;
using test::PseudoTerminal;

/// A descriptor as the standard input, as long as it lives.
class AsInput {
 public:
  explicit AsInput(int descriptor) : before_(::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3)) {
    REQUIRE(::dup2(descriptor, STDIN_FILENO) == STDIN_FILENO);
  }
  ~AsInput() {
    if (!before_ || ::dup2(before_.get(), STDIN_FILENO) < 0) ::close(STDIN_FILENO);
  }
  AsInput(const AsInput&) = delete;
  AsInput& operator=(const AsInput&) = delete;

 private:
  host::Descriptor before_;
};

std::string pressed(KeyInput& keys) {
  const auto text = keys.read();
  REQUIRE(text.has_value());
  return std::string{*text};
}

termios settings_of(const PseudoTerminal& terminal) {
  termios now{};
  REQUIRE(::tcgetattr(terminal.descriptor(), &now) == 0);
  return now;
}

TEST_CASE("key input: keys come one by one, and the terminal is set back") {
  const PseudoTerminal terminal;
  const AsInput input{terminal.descriptor()};
  const auto modes = [&terminal] { return settings_of(terminal).c_lflag & tcflag_t{ICANON | ECHO | ISIG}; };
  const termios before = settings_of(terminal);
  REQUIRE(modes() == tcflag_t{ICANON | ECHO | ISIG});
  {
    KeyInput keys;
    CHECK(keys.is_terminal());
    CHECK(modes() == tcflag_t{ISIG});
    CHECK(settings_of(terminal).c_cc[VMIN] == 0);  // a read waits for no key, and no time
    CHECK(settings_of(terminal).c_cc[VTIME] == 0);
    CHECK(pressed(keys).empty());
    terminal.press("q+");
    CHECK(pressed(keys) == "q+");
    CHECK(pressed(keys).empty());
    // As a shell gives it back to a program that was stopped.
    REQUIRE(::tcsetattr(terminal.descriptor(), TCSANOW, &before) == 0);
    CHECK(pressed(keys).empty());
    CHECK(modes() == tcflag_t{ISIG});
    terminal.press("x");
    CHECK(pressed(keys) == "x");
  }
  CHECK(modes() == tcflag_t{ICANON | ECHO | ISIG});
  CHECK(settings_of(terminal).c_cc[VMIN] == before.c_cc[VMIN]);
  CHECK(settings_of(terminal).c_cc[VTIME] == before.c_cc[VTIME]);
}

TEST_CASE("key input: the terminal waits for no key and for no time, whatever it did before") {
  const PseudoTerminal terminal;
  const AsInput input{terminal.descriptor()};
  termios before = settings_of(terminal);
  before.c_cc[VMIN] = 3;
  before.c_cc[VTIME] = 7;
  REQUIRE(::tcsetattr(terminal.descriptor(), TCSANOW, &before) == 0);
  {
    const KeyInput keys;
    CHECK(int{settings_of(terminal).c_cc[VMIN]} == 0);
    CHECK(int{settings_of(terminal).c_cc[VTIME]} == 0);
  }
  CHECK(int{settings_of(terminal).c_cc[VMIN]} == 3);
  CHECK(int{settings_of(terminal).c_cc[VTIME]} == 7);
}

TEST_CASE("key input: a pipe is no terminal") {
  std::array<int, 2> ends{};
  REQUIRE(::pipe2(ends.data(), O_CLOEXEC) == 0);
  const host::Descriptor out{ends[0]}, in{ends[1]};
  const AsInput input{out.get()};
  CHECK_FALSE(KeyInput{}.is_terminal());
}

TEST_CASE("key input: the beginning of a sequence waits for its end") {
  const PseudoTerminal terminal;
  const AsInput input{terminal.descriptor()};
  KeyInput keys;
  const std::string longest = "\x1b[" + std::string(14, '1');
  const std::vector<std::pair<std::string, std::string>> cut = {
      {"\x1b", "[A"},  {"\x1b[", "A"},  {"\x1bO", "D"}, {"\x1b[1;2", "q"},
      {"\x1b[3", "~"}, {"\x1b[?", "@"}, {longest, "~"}};
  for (const auto& [begin, end] : cut) {
    CAPTURE(begin.size(), end);
    terminal.press(begin);
    CHECK(pressed(keys).empty());
    terminal.press(end);
    CHECK(pressed(keys) == begin + end);
    CHECK(pressed(keys).empty());
  }
  // What is before it does not wait.
  terminal.press("ab\x1b[");
  CHECK(pressed(keys) == "ab");
  terminal.press("B+");
  CHECK(pressed(keys) == "\x1b[B+");
}

TEST_CASE("key input: what is no beginning of a sequence comes at once") {
  const PseudoTerminal terminal;
  const AsInput input{terminal.descriptor()};
  KeyInput keys;
  for (const std::string& text :
       {std::string{"a"}, std::string{"\x1b[A"}, std::string{"\x1bOD"}, std::string{"\x1bx"},
        std::string{"\x1b[@"}, std::string{"\x1b[3~"}, "\x1b[" + std::string(15, '1')}) {
    CAPTURE(text.size());
    terminal.press(text);
    CHECK(pressed(keys) == text);
    CHECK(pressed(keys).empty());
  }
}

TEST_CASE("key input: an end that does not come is waited for in six looks") {
  const PseudoTerminal terminal;
  const AsInput input{terminal.descriptor()};
  KeyInput keys;
  for (int times = 0; times < 2; ++times) {
    terminal.press("\x1b[");
    for (int looks = 0; looks < 6; ++looks) CHECK(pressed(keys).empty());  // the first one has taken it
    CHECK(pressed(keys) == "\x1b[");
    CHECK(pressed(keys).empty());
  }
  // They are counted from what came last.
  terminal.press("\x1b[");
  for (int looks = 0; looks < 4; ++looks) CHECK(pressed(keys).empty());
  terminal.press("1");
  for (int looks = 0; looks < 6; ++looks) CHECK(pressed(keys).empty());
  CHECK(pressed(keys) == "\x1b[1");
}

TEST_CASE("key input: of many keys at once none is lost, and none is cut") {
  const PseudoTerminal terminal;
  const AsInput input{terminal.descriptor()};
  KeyInput keys;
  std::string all, came;
  for (int i = 0; i < 40; ++i) all += i % 2 == 0 ? "\x1b[A" : "\x1b[D";
  terminal.press(all);
  for (int looks = 0; looks < 10 && came.size() < all.size(); ++looks) {
    const std::string some = pressed(keys);
    CHECK(some.size() % 3 == 0);
    came += some;
  }
  CHECK(came == all);
}

TEST_CASE("key input: what is kept has its room, and what is read behind it the rest") {
  const PseudoTerminal terminal;
  const AsInput input{terminal.descriptor()};
  KeyInput keys;
  const std::string key = "\x1b[" + std::string(12, '1') + "~";  // of 64 bytes four are the beginning of one
  std::string all, came;
  for (int i = 0; i < 20; ++i) all += key;
  terminal.press(all);
  for (int looks = 0; looks < 10 && came.size() < all.size(); ++looks) {
    const std::string some = pressed(keys);
    CHECK(some.size() % key.size() == 0);
    came += some;
  }
  CHECK(came == all);
}

TEST_CASE("key input: a terminal that is gone is said") {
  PseudoTerminal terminal;
  const AsInput input{terminal.descriptor()};
  KeyInput keys;
  CHECK(pressed(keys).empty());
  terminal.close();
  CHECK_FALSE(keys.read().has_value());
}

}  // namespace tool_shared_key_input_test
