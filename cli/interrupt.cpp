#include "cli/interrupt.hpp"

#include <csignal>
#include <initializer_list>

namespace ocm::cli {
namespace {
volatile std::sig_atomic_t noted_signal = 0;
void note(int signal) {
  noted_signal = signal;
}

void catch_signal(int signal) {
  struct sigaction action {};
  action.sa_handler = note;
  sigemptyset(&action.sa_mask);
  action.sa_flags = 0;  // no SA_RESTART: a blocking wait must return
  sigaction(signal, &action, nullptr);
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

int interrupted() noexcept {
  return noted_signal;
}

int exit_code_after_interrupt(int code) noexcept {
  return noted_signal != 0 ? 128 + noted_signal : code;
}

}  // namespace ocm::cli
