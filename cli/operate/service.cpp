#include "cli/operate/service.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "ocm/host/descriptor.hpp"

namespace ocm::cli::operate {
namespace {

std::string_view variable(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr ? std::string_view{value} : std::string_view{};
}

}  // namespace

Service::Service() : socket_(variable("NOTIFY_SOCKET")) {
  // What it starts is no part of the service.
  ::unsetenv("NOTIFY_SOCKET");
  const auto text = variable("WATCHDOG_USEC");
  std::int64_t us = 0;
  static_cast<void>(std::from_chars(text.data(), text.data() + text.size(), us));  // no number: 0 stays
  const auto process = variable("WATCHDOG_PID");
  if (us < 2 || socket_.empty()) return;
  if (!process.empty() && process != std::to_string(::getpid())) return;
  every_ = base::Duration{std::min<std::int64_t>(us, INT64_MAX / 1000) * 1000 / 2};
  next_ = Clock::now();
}

void Service::tell(std::string_view what, std::string_view text) const {
  sockaddr_un address{};
  if (socket_.size() < 2 || socket_.size() > sizeof address.sun_path) return;
  address.sun_family = AF_UNIX;
  std::copy(socket_.begin(), socket_.end(), std::begin(address.sun_path));
  if (socket_.front() == '@') address.sun_path[0] = '\0';  // an abstract one
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + socket_.size());
  const host::Descriptor socket{::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
  if (!socket) return;
  std::string message{what};
  message += text;
  // Who does not read it misses it: the robot comes first.
  static_cast<void>(::sendto(socket.get(), message.data(), message.size(), MSG_NOSIGNAL,
                             reinterpret_cast<const sockaddr*>(&address), size));
}

}  // namespace ocm::cli::operate
