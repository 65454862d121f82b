#include "cli/shared/interrupt.hpp"

#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <initializer_list>
#include <poll.h>
#include <unistd.h>

namespace ocm::cli {
namespace {
// Read by all threads: what a signal handler may share with another thread than its own is lock-free.
std::atomic<int> noted_signal{0};
std::atomic<int> noted_signals{0};
static_assert(std::atomic<int>::is_always_lock_free);
void note(int signal) {
  noted_signal = signal;
  ++noted_signals;
}

void catch_signal(int signal) {
  struct sigaction action {};
  action.sa_handler = note;
  sigemptyset(&action.sa_mask);
  action.sa_flags = 0;  // no SA_RESTART: a blocking wait must return
  sigaction(signal, &action, nullptr);
}

/// Waits until something can be written, or a write will say why not. false: a signal came, and for a second
/// nothing was taken.
bool takes_more(int descriptor) {
  constexpr int most_tenths = 10;
  for (int tenths = 0; tenths < most_tenths;) {
    pollfd entry{descriptor, POLLOUT, 0};
    const int ready = ::poll(&entry, 1, 100);
    if (ready > 0 || (ready < 0 && errno != EINTR)) return true;
    if (noted_signal != 0) ++tenths;
  }
  return false;
}
}  // namespace

void catch_interrupts() {
  catch_signal(SIGINT);
  catch_signal(SIGTERM);
}

void catch_hangups() {
  for (const int signal : {SIGHUP, SIGQUIT}) {
    struct sigaction before {};
    if (sigaction(signal, nullptr, &before) == 0 && before.sa_handler != SIG_IGN) catch_signal(signal);
  }
}

void catch_broken_pipe() {
  catch_signal(SIGPIPE);
}

WithoutBrokenPipe::WithoutBrokenPipe() {
  struct sigaction now {};
  sigset_t pipe, before;
  sigemptyset(&pipe);
  sigaddset(&pipe, SIGPIPE);
  blocked_ = sigaction(SIGPIPE, nullptr, &now) == 0 && now.sa_handler == SIG_DFL &&
             pthread_sigmask(SIG_BLOCK, &pipe, &before) == 0 && sigismember(&before, SIGPIPE) == 0;
}

WithoutBrokenPipe::~WithoutBrokenPipe() {
  if (!blocked_) return;
  sigset_t pipe;
  sigemptyset(&pipe);
  sigaddset(&pipe, SIGPIPE);
  const timespec at_once{};
  sigtimedwait(&pipe, nullptr, &at_once);  // the one that the write may have raised
  pthread_sigmask(SIG_UNBLOCK, &pipe, nullptr);
}

int interrupted() noexcept {
  return noted_signal;
}

int interruptions() noexcept {
  return noted_signals;
}

int exit_code_after_interrupt(int code) noexcept {
  return noted_signal != 0 ? 128 + noted_signal : code;
}

Written write_all(int descriptor, std::string_view text, Signals signals) {
  Written written;
  while (written.bytes < text.size()) {
    // A pipe that takes something takes so much without waiting.
    const bool in_pages = signals == Signals::blocked || noted_signal != 0;
    if (in_pages && !takes_more(descriptor)) return {written.bytes, EINTR};
    const std::string_view piece = text.substr(written.bytes, in_pages ? PIPE_BUF : std::string_view::npos);
    const ssize_t count = ::write(descriptor, piece.data(), piece.size());
    if (count >= 0) {
      written.bytes += static_cast<std::size_t>(count);
    } else if (errno == EAGAIN) {
      if (!takes_more(descriptor)) return {written.bytes, EINTR};
    } else if (errno != EINTR) {
      return {written.bytes, errno};
    }
  }
  return written;
}

}  // namespace ocm::cli
