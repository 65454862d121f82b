// What is left of the signals behind a message without a reader, and in which pieces is written.
#include "cli/shared/interrupt.hpp"

#include <array>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstddef>
#include <fcntl.h>
#include <string>
#include <unistd.h>
#include <vector>

#include <catch2/catch.hpp>

#include "tool/written_pieces.hpp"

namespace tool_shared_interrupt_test {

using namespace ocm;

/// What becomes of SIGPIPE, as long as it lives.
class BrokenPipe {
 public:
  explicit BrokenPipe(void (*handler)(int)) {
    struct sigaction action {};
    action.sa_handler = handler;
    sigemptyset(&action.sa_mask);
    REQUIRE(sigaction(SIGPIPE, &action, &before_) == 0);
  }
  ~BrokenPipe() { sigaction(SIGPIPE, &before_, nullptr); }
  BrokenPipe(const BrokenPipe&) = delete;
  BrokenPipe& operator=(const BrokenPipe&) = delete;

 private:
  struct sigaction before_ {};
};

bool is_blocked() {
  sigset_t blocked;
  sigemptyset(&blocked);
  REQUIRE(pthread_sigmask(SIG_BLOCK, nullptr, &blocked) == 0);
  return sigismember(&blocked, SIGPIPE) == 1;
}
bool one_waits() {
  sigset_t waiting;
  sigemptyset(&waiting);
  REQUIRE(sigpending(&waiting) == 0);
  return sigismember(&waiting, SIGPIPE) == 1;
}

TEST_CASE("interrupt: a message without a reader kills nothing, and what follows it is as before") {
  const BrokenPipe as_usual{SIG_DFL};
  REQUIRE_FALSE(is_blocked());
  std::array<int, 2> ends{};
  REQUIRE(::pipe2(ends.data(), O_CLOEXEC) == 0);
  ::close(ends[0]);
  {
    const cli::WithoutBrokenPipe message;
    CHECK(is_blocked());
    const ssize_t size = ::write(ends[1], "x", 1);
    const int error = errno;
    CHECK(size == -1);
    CHECK(error == EPIPE);
    CHECK(one_waits());
    {
      const cli::WithoutBrokenPipe within;
      CHECK(is_blocked());
    }
    CHECK(is_blocked());  // up to the end of the outer one
  }
  CHECK_FALSE(is_blocked());
  CHECK_FALSE(one_waits());
  ::close(ends[1]);
}

TEST_CASE("interrupt: where a broken pipe kills nothing, no signal is blocked for a message") {
  const BrokenPipe ignored{SIG_IGN};
  const cli::WithoutBrokenPipe message;
  CHECK_FALSE(is_blocked());
}

/// In which pieces a text is written.
std::vector<std::size_t> pieces(const std::string& text, cli::Signals signals) {
  const test::WrittenPieces pieces;
  const cli::Written written = cli::write_all(pieces.descriptor(), text, signals);
  CHECK(written.bytes == text.size());
  CHECK(written.error == 0);
  return pieces.sizes(text.size() + 1);
}

TEST_CASE("interrupt: where signals are blocked a text is written page by page, and else at once") {
  REQUIRE(cli::interrupted() == 0);
  const std::string text(10'000, 'x');
  CHECK(pieces(text, cli::Signals::reach) == std::vector<std::size_t>{10'000});
  CHECK(pieces(text, cli::Signals::blocked) ==
        std::vector<std::size_t>{PIPE_BUF, PIPE_BUF, 10'000 - 2 * PIPE_BUF});
}

}  // namespace tool_shared_interrupt_test
