#include "cli/shared/local_server.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <span>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "ocm/host/local_socket.hpp"

#include "cli/shared/local_link.hpp"

namespace ocm::cli {
namespace {

bool watch(const host::Descriptor& events, int descriptor, void* who) {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.ptr = who;
  return ::epoll_ctl(events.get(), EPOLL_CTL_ADD, descriptor, &event) == 0;
}

}  // namespace

std::string LocalCaller::who() const {
  return fmt::format("{} (process {})", verb, process);
}

std::string answers::yes(std::string_view text) {
  return fmt::format("ok\n{}", text);
}

std::string answers::wait() {
  return "wait";
}

std::string answers::no(std::string_view what, std::string_view remedy) {
  return fmt::format("no\n{}\n{}", what, remedy);
}

transport::Outcome<std::unique_ptr<LocalServer>> LocalServer::open(const std::string& path,
                                                                   const host::LocalService& what) {
  auto listener = host::LocalListener::open(path, std::chrono::seconds{1}, what);
  if (!listener) return std::move(listener.error);
  host::Descriptor events{::epoll_create1(EPOLL_CLOEXEC)};
  if (!events || !watch(events, listener->descriptor(), nullptr))
    return host::LocalListener::failure(listener->path(), errno, what);
  return std::unique_ptr<LocalServer>{new LocalServer{std::move(*listener), std::move(events), what}};
}

transport::Outcome<void> LocalServer::return_to_path() {
  auto listener = host::LocalListener::open(listener_.path(), base::Duration{}, what_);
  if (!listener) return std::move(listener.error);
  if (!watch(events_, listener->descriptor(), nullptr))
    return host::LocalListener::failure(listener->path(), errno, what_);
  listener_ = std::move(*listener);
  return {};
}

void LocalServer::serve() {
  std::array<epoll_event, 16> found{};
  int requests = 0;
  while (requests < most_requests) {
    const int count = ::epoll_wait(events_.get(), found.data(), static_cast<int>(found.size()), 0);
    if (count <= 0) return;
    for (const auto& event : std::span{found}.first(static_cast<std::size_t>(count))) {
      ++requests;
      if (event.data.ptr == nullptr) {
        accept();
        continue;
      }
      auto* const connection = static_cast<Connection*>(event.data.ptr);
      if (take(*connection)) continue;
      const auto at = std::find_if(connections_.begin(), connections_.end(),
                                   [&](const auto& each) { return each.get() == connection; });
      const auto ended = std::move(*at);
      connections_.erase(at);
      if (!ended->caller->verb.empty() && desk_.gone) desk_.gone(*ended->caller);
    }
  }
}

void LocalServer::accept() {
  host::Descriptor socket{::accept4(listener_.descriptor(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC)};
  if (!socket) return;
  const auto peer = host::peer_of(socket.get());
  if (connections_.size() == most_callers || !peer || peer->uid != ::geteuid()) {
    ++turned_away_;
    return;
  }
  auto connection = std::make_unique<Connection>();
  connection->socket = std::move(socket);
  connection->caller = desk_.make ? desk_.make() : std::make_unique<LocalCaller>();
  connection->caller->process = peer->pid;
  if (!watch(events_, connection->socket.get(), connection.get())) return;
  connections_.push_back(std::move(connection));
}

bool LocalServer::take(Connection& connection) {
  std::array<char, longest_request> request{};
  const auto size = ::recv(connection.socket.get(), request.data(), request.size(), MSG_TRUNC);
  if (size < 0) return errno == EAGAIN || errno == EINTR;
  if (size == 0) return false;  // it has ended
  // Of a longer message the rest is gone: it has no beginning that could be meant.
  const auto answered =
      static_cast<std::size_t>(size) > request.size()
          ? std::string{}
          : answer(*connection.caller, std::string_view{request.data(), static_cast<std::size_t>(size)});
  if (!answered.empty() &&
      ::send(connection.socket.get(), answered.data(), answered.size(), MSG_NOSIGNAL) >= 0)
    return true;
  ++turned_away_;
  return false;
}

std::string LocalServer::answer(LocalCaller& caller, std::string_view request) {
  if (request.starts_with(local_hello)) {
    constexpr std::size_t longest_verb = 32;
    const auto verb = request.substr(local_hello.size(), longest_verb);
    const bool printed = std::all_of(verb.begin(), verb.end(), [](char c) { return c > ' ' && c <= '~'; });
    if (verb.empty() || !printed || !caller.verb.empty()) return {};
    caller.verb = verb;
    return desk_.greet(caller);
  }
  if (caller.verb.empty()) return {};
  return desk_.take(caller, request);
}

}  // namespace ocm::cli
