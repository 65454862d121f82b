// A terminal has shown the ^C that a person pressed: it is taken off the line before the next message.
#include "cli/shared/messages.hpp"

#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <optional>
#include <string>
#include <string_view>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "ocm/host/descriptor.hpp"

#include "tests/tool/clock/world.hpp"
#include "tests/tool/pseudo_terminal.hpp"

namespace tool_clock_messages_test {

using namespace ocm;
using namespace ocm::test;

/// Standard error, as long as it lives: a terminal where a line can be erased.
class OnTerminal {
 public:
  OnTerminal() : before_(::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3)) {
    if (const char* const term = std::getenv("TERM"); term != nullptr) term_ = term;
    ::setenv("TERM", "xterm", 1);
    REQUIRE(::dup2(terminal_.descriptor(), STDERR_FILENO) == STDERR_FILENO);
  }
  ~OnTerminal() {
    ::dup2(before_.get(), STDERR_FILENO);
    if (term_)
      ::setenv("TERM", term_->c_str(), 1);
    else
      ::unsetenv("TERM");
  }
  OnTerminal(const OnTerminal&) = delete;
  OnTerminal& operator=(const OnTerminal&) = delete;
  [[nodiscard]] std::string shown(std::string_view end) const { return terminal_.shown(end); }

 private:
  PseudoTerminal terminal_;
  host::Descriptor before_;
  std::optional<std::string> term_;
};

TEST_CASE("messages: behind a Ctrl-C a line is erased once, and behind another signal none") {
  World world{1};
  const OnTerminal terminal;
  cli::remark("before");
  CHECK(terminal.shown("before\r\n") == "before\r\n");
  world.interrupt(world.now(), SIGTERM);
  cli::remark("at its end");
  CHECK(terminal.shown("at its end\r\n") == "at its end\r\n");
  world.interrupt(world.now(), SIGINT);
  for (const char* const word : {"one", "two", "three"}) cli::remark(word);
  std::string text = terminal.shown("three\r\n");
  // Not even once where a test before this one has pressed Ctrl-C on a terminal.
  constexpr std::string_view erased = "\r\x1b[K";
  if (text.starts_with(erased)) text.erase(0, erased.size());
  CHECK(text == "one\r\ntwo\r\nthree\r\n");
}

}  // namespace tool_clock_messages_test
