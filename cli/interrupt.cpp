#include "cli/interrupt.hpp"

#include <csignal>

namespace ocm::cli {
namespace {
volatile std::sig_atomic_t noted_signal = 0;
void note(int signal) {
  noted_signal = signal;
}
}  // namespace

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = note;
  sigemptyset(&action.sa_mask);
  action.sa_flags = 0;  // no SA_RESTART: a blocking wait must return
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

int interrupted() noexcept {
  return noted_signal;
}

int exit_code_after_interrupt(int code) noexcept {
  return noted_signal != 0 ? 128 + noted_signal : code;
}

}  // namespace ocm::cli
