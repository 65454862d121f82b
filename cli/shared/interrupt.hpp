/// Ctrl-C and SIGTERM end a command cleanly: they interrupt a wait, and the verb sees here that it is over.
#pragma once

#include <cstddef>
#include <string_view>

namespace ocm::cli {

/// From now on SIGINT and SIGTERM are noted instead of killing.
void catch_interrupts();
/// SIGHUP (the terminal is closed) and SIGQUIT too, for a verb that has something to finish. A signal that
/// is ignored (nohup) stays so.
void catch_hangups();
/// SIGPIPE too, for a verb that must not be killed between two frames: a write says EPIPE, and the verb ends
/// as after any other signal.
void catch_broken_pipe();
/// As long as it lives no SIGPIPE kills this thread, unless it is caught: what is written is a message, and
/// the command does not depend on its reader.
class WithoutBrokenPipe {
 public:
  WithoutBrokenPipe();
  ~WithoutBrokenPipe();
  WithoutBrokenPipe(const WithoutBrokenPipe&) = delete;
  WithoutBrokenPipe& operator=(const WithoutBrokenPipe&) = delete;

 private:
  bool blocked_ = false;
};
/// The signal that came last, or 0.
[[nodiscard]] int interrupted() noexcept;
/// How many came: what still has to be finished after the first, a second one cuts short.
[[nodiscard]] int interruptions() noexcept;
/// 128 + signal when one came, else `code`.
[[nodiscard]] int exit_code_after_interrupt(int code) noexcept;

/// How far a write came.
struct Written {
  std::size_t bytes = 0;
  int error = 0;  ///< errno where not all was written; EINTR: a signal came, and the rest was not taken
};
/// Whether signals end the writes of this thread.
enum class Signals : bool { reach, blocked };
/// Writes all of `text`, and waits for a reader behind a pipe. After a signal for a second at most,
/// while nothing is taken: a reader that has stopped does not keep the command from ending. Where signals
/// are blocked a pipe is written page by page, so that no write outlasts one.
[[nodiscard]] Written write_all(int descriptor, std::string_view text, Signals signals = Signals::reach);

}  // namespace ocm::cli
