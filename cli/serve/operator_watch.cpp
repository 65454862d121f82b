#include "cli/serve/operator_watch.hpp"

#include <chrono>
#include <csignal>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "cli/output/json_text.hpp"
#include "cli/shared/operator_link.hpp"

namespace ocm::cli::serve {
namespace {

constexpr std::chrono::milliseconds turn{500};

}  // namespace

OperatorWatch::OperatorWatch(std::string bus) : bus_(std::move(bus)) {
  sigset_t all;  // signals are for the thread that has the bus
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::thread{[this] { run(); }};
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

OperatorWatch::~OperatorWatch() {
  {
    const std::lock_guard lock{mutex_};
    stops_ = true;
  }
  ends_.notify_one();
  thread_.join();
}

std::string OperatorWatch::newest() const {
  const std::lock_guard lock{mutex_};
  return newest_;
}

OperatorWatch::Presence OperatorWatch::presence() const {
  const std::lock_guard lock{mutex_};
  return presence_;
}

bool OperatorWatch::pause() {
  std::unique_lock lock{mutex_};
  return !ends_.wait_for(lock, turn, [this] { return stops_; });
}

void OperatorWatch::run() {
  std::unique_ptr<OperatorLink> link;
  do {
    Presence presence = Presence::runs;
    if (link == nullptr) {
      auto found = connect_operator(bus_, "serve");
      if (found) link = std::move(*found);
      presence = !found ? Presence::silent : link == nullptr ? Presence::none : Presence::runs;
    }
    std::string text = R"({"running":false})";
    if (link != nullptr) {
      const OperatorAnswer status = link->ask("status json");
      const OperatorAnswer why = status.kind == OperatorAnswer::Kind::ok ? link->ask("why json") : status;
      if (status.kind == OperatorAnswer::Kind::ok && why.kind == OperatorAnswer::Kind::ok) {
        text = fmt::format(R"({{"running":true,"who":{},"status":{},"why":{}}})", json_string(link->who()),
                           status.text, why.text);
      } else {
        link.reset();
        presence = Presence::silent;  // until the next look
      }
    }
    const std::lock_guard lock{mutex_};
    presence_ = presence;
    newest_ = std::move(text);
  } while (pause());
}

}  // namespace ocm::cli::serve
