#include "cli/serve/web.hpp"

#ifdef OCM_HAS_WEBSOCKETS

#include <arpa/inet.h>
#include <poll.h>
#include <string>
#include <sys/socket.h>
#include <unistd.h>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

#include "cli/serve/assets.hpp"
#include "cli/serve/sessions.hpp"

namespace ocm::cli::serve {

/// The page is no part of this program.
std::span<const Asset> assets() noexcept {
  return {};
}

}  // namespace ocm::cli::serve

namespace serve_web_test {

using namespace ocm::cli::serve;
using namespace std::string_literals;

/// A connection to a server on this machine.
class Client {
 public:
  explicit Client(std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    REQUIRE(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  ~Client() { ::close(socket_); }

  void say(std::string_view text) const {
    REQUIRE(::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size()));
  }
  /// All that came until it holds the words, or until nothing came for 20 s.
  std::string hear(std::string_view words) {
    pollfd waits{socket_, POLLIN, 0};
    while (heard_.find(words) == std::string::npos && ::poll(&waits, 1, 20'000) == 1) {
      char piece[4096];
      const ssize_t size = ::recv(socket_, piece, sizeof piece, 0);
      if (size <= 0) break;
      heard_.append(piece, static_cast<std::size_t>(size));
    }
    return heard_;
  }

 private:
  int socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  std::string heard_;
};

TEST_CASE("web: who connects is greeted at once, though nothing happens that wakes the server") {
  Channels channels{amiro::catalogue, std::vector{"sim"s}};
  Viewers viewers{channels.all().size()};
  Orders orders;
  Sessions sessions{{"AMiRo", "s", false, false}, amiro::catalogue, channels, viewers, orders};
  const auto web = Web::open({}, viewers, sessions);
  REQUIRE(web);
  const std::string url = (*web)->url();
  const std::string host = url.substr("http://"s.size(), url.size() - "http://"s.size() - 1);
  Client client{static_cast<std::uint16_t>(std::stoi(host.substr(host.find(':') + 1)))};
  client.say("GET / HTTP/1.1\r\nHost: " + host +
             "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
             "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
             "Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n\r\n");
  const std::string heard = client.hear(R"("topic":"/gyroscope")");
  CHECK(heard.starts_with("HTTP/1.1 101 "));
  CHECK(heard.find("s3pPLMBiTxaQ9kYGzzhZRbK+xOo=") != std::string::npos);  // [RFC 6455 1.3]
  CHECK(heard.find(R"("op":"serverInfo")") != std::string::npos);
  CHECK(heard.find(R"("topic":"/gyroscope")") != std::string::npos);
}

}  // namespace serve_web_test

#endif
