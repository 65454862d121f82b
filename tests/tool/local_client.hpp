/// A program that asks another one on its local socket (cli/shared/local_server.hpp), or hears something on
/// one of its own; waits for nothing.
#pragma once

#include <algorithm>
#include <string>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <catch2/catch.hpp>

namespace ocm::test {

class LocalClient {
 public:
  /// SOCK_SEQPACKET: connected to the path; SOCK_DGRAM: on the path.
  LocalClient(int kind, const std::string& path)
      : descriptor_(::socket(AF_UNIX, kind | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    REQUIRE(path.size() < sizeof address.sun_path);
    std::copy(path.begin(), path.end(), std::begin(address.sun_path));
    const auto* const at = reinterpret_cast<const sockaddr*>(&address);
    REQUIRE((kind == SOCK_DGRAM ? ::bind : ::connect)(descriptor_, at, sizeof address) == 0);
  }
  ~LocalClient() { ::close(descriptor_); }
  LocalClient(const LocalClient&) = delete;
  LocalClient& operator=(const LocalClient&) = delete;

  void say(const std::string& text) const {
    REQUIRE(::send(descriptor_, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size()));
  }
  /// Empty: there is nothing yet.
  [[nodiscard]] std::string heard() const {
    std::string text(70'000, '\0');
    const auto size = ::recv(descriptor_, text.data(), text.size(), 0);
    text.resize(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
    return text;
  }

 private:
  int descriptor_;
};

}  // namespace ocm::test
