#include "cli/operate/control.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "ocm/host/local_socket.hpp"

#include "cli/shared/operator_link.hpp"

namespace ocm::cli::operate {
namespace {

constexpr host::LocalService service{"an operator", "an operator", host::Cause::other, false};
constexpr std::size_t longest_request = 4096;

bool watch(const host::Descriptor& events, int descriptor, void* who) {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.ptr = who;
  return ::epoll_ctl(events.get(), EPOLL_CTL_ADD, descriptor, &event) == 0;
}

}  // namespace

std::string yes(std::string_view text) {
  return fmt::format("ok\n{}", text);
}

std::string wait() {
  return "wait";
}

std::string no(std::string_view what, std::string_view remedy) {
  return fmt::format("no\n{}\n{}", what, remedy);
}

transport::Outcome<std::unique_ptr<Control>> Control::open(std::string_view bus) {
  auto listener = host::LocalListener::open(operator_path(bus), std::chrono::seconds{1}, service);
  if (!listener) return std::move(listener.error);
  host::Descriptor events{::epoll_create1(EPOLL_CLOEXEC)};
  if (!events || !watch(events, listener->descriptor(), nullptr))
    return host::LocalListener::failure(listener->path(), errno, service);
  return std::unique_ptr<Control>{new Control{std::move(*listener), std::move(events)}};
}

void Control::begin(std::string name, Take take) {
  name_ = std::move(name);
  take_ = std::move(take);
}

void Control::serve() {
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
      std::erase_if(connections_, [&](const auto& each) { return each.get() == connection; });
    }
  }
}

void Control::accept() {
  host::Descriptor socket{::accept4(listener_.descriptor(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC)};
  if (!socket) return;
  const auto peer = host::peer_of(socket.get());
  if (connections_.size() == most_callers || !peer || peer->uid != ::geteuid()) {
    ++turned_away_;
    return;
  }
  auto connection = std::make_unique<Connection>();
  connection->socket = std::move(socket);
  connection->caller.process = peer->pid;
  if (!watch(events_, connection->socket.get(), connection.get())) return;
  connections_.push_back(std::move(connection));
}

bool Control::take(Connection& connection) {
  std::array<char, longest_request> request{};
  const auto size = ::recv(connection.socket.get(), request.data(), request.size(), 0);
  if (size < 0) return errno == EAGAIN || errno == EINTR;
  if (size == 0) return false;  // it has ended
  const auto answered =
      answer(connection.caller, std::string_view{request.data(), static_cast<std::size_t>(size)});
  if (!answered.empty() &&
      ::send(connection.socket.get(), answered.data(), answered.size(), MSG_NOSIGNAL) >= 0)
    return true;
  ++turned_away_;
  return false;
}

std::string Control::answer(Caller& caller, std::string_view request) {
  if (request.starts_with(operator_hello)) {
    caller.verb = request.substr(operator_hello.size(), 32);
    return yes(name_);
  }
  if (caller.verb.empty()) return {};
  return take_(caller, request);
}

}  // namespace ocm::cli::operate
