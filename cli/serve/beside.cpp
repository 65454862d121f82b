#include "cli/serve/beside.hpp"

#include <csignal>
#include <utility>

#include "cli/shared/messages.hpp"

namespace ocm::cli::serve {

PageBeside::PageBeside(Session& session, ServeOptions options) {
  options.over = [this] { return stops_.load(); };
  sigset_t all;  // signals are for the verb's thread
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::thread{[this, &session, options = std::move(options)]() mutable {
    try {
      (void)run(session, std::move(options));
    } catch (const Exit&) {  // it is said on stderr
    }
    ended_ = true;
  }};
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

PageBeside::~PageBeside() {
  stops_ = true;
  thread_.join();
}

bool PageBeside::end() {
  stops_ = true;
  return ended_;
}

}  // namespace ocm::cli::serve
