#include "cli/operate/background.hpp"

#include <csignal>
#include <utility>

namespace ocm::cli::operate {

Background::Background(std::size_t most) : most_(most) {
  // Signals are for the thread that receives: its waits end with them.
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, &before);
  thread_ = std::thread{[this] { run(); }};
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

Background::~Background() {
  finish();
}

bool Background::post(std::function<void()> work) {
  {
    const std::lock_guard lock{mutex_};
    if (work_.size() >= most_) return false;
    work_.push_back(std::move(work));
  }
  more_.notify_one();
  return true;
}

void Background::finish() {
  {
    const std::lock_guard lock{mutex_};
    ends_ = true;
  }
  more_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void Background::run() {
  for (;;) {
    std::function<void()> work;
    {
      std::unique_lock lock{mutex_};
      more_.wait(lock, [this] { return ends_ || !work_.empty(); });
      if (work_.empty()) return;
      work = std::move(work_.front());
      work_.pop_front();
    }
    work();
  }
}

}  // namespace ocm::cli::operate
