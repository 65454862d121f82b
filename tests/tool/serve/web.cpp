#include "cli/serve/web.hpp"

#ifdef OCM_HAS_WEBSOCKETS

#include <arpa/inet.h>
#include <chrono>
#include <cstdint>
#include <memory>
#include <poll.h>
#include <string>
#include <string_view>
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

/// Where a server listens: "127.0.0.1:8484".
std::string place_of(const Web& web) {
  const std::string url = web.url();
  return url.substr("http://"s.size(), url.size() - "http://"s.size() - 1);
}
std::uint16_t port_of(const std::string& place) {
  return static_cast<std::uint16_t>(std::stoi(place.substr(place.find(':') + 1)));
}
constexpr std::string_view subprotocol = "Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n";
/// What a client says to become a viewer.
std::string upgrade(const std::string& place, std::string_view lines = subprotocol,
                    std::string_view version = "13") {
  return "GET / HTTP/1.1\r\nHost: " + place +
         "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: " + std::string{version} +
         "\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" + std::string{lines} + "\r\n";
}
/// Of a client, with 0 for its mask. [RFC 6455 5.2]
std::string frame(unsigned opcode, std::string_view payload) {
  std::string text(1, static_cast<char>(0x80U | opcode));
  text += static_cast<char>(0x80U | payload.size());
  text.append(4, '\0');
  text += payload;
  return text;
}

/// A server of the robot's channels.
struct Server {
  Server() : web(Web::open({}, viewers, sessions)) {
    REQUIRE(web);
    place = place_of(**web);
  }
  /// Becomes a viewer, and has all that one is greeted with.
  void greets(Client& client) const {
    client.say(upgrade(place));
    REQUIRE(client.hear("/ocm/playback").find("/ocm/playback") != std::string::npos);
  }

  Channels channels{amiro::catalogue, std::vector{"sim"s}};
  Viewers viewers{channels.all().size()};
  Orders orders;
  Sessions sessions{{"AMiRo", "s", false, false}, amiro::catalogue, channels, viewers, orders};
  ocm::transport::Outcome<std::unique_ptr<Web>> web;
  std::string place;
};

TEST_CASE("web: who connects is greeted at once, though nothing happens that wakes the server") {
  Server server;
  Client client{port_of(server.place)};
  client.say(upgrade(server.place));
  const std::string heard = client.hear(R"("topic":"/gyroscope")");
  CHECK(heard.starts_with("HTTP/1.1 101 "));
  CHECK(heard.find("s3pPLMBiTxaQ9kYGzzhZRbK+xOo=") != std::string::npos);  // [RFC 6455 1.3]
  CHECK(heard.find(R"("op":"serverInfo")") != std::string::npos);
  CHECK(heard.find(R"("topic":"/gyroscope")") != std::string::npos);
}

/// Has each viewer asked whether it is there before anything is said to it, and answers what it says.
struct Asking final : Listener {
  explicit Asking(Viewers& all) : viewers(&all) {}
  void opened(ViewerId viewer, bool) override { viewers->ask(viewer); }
  void gone(ViewerId) override {}
  void text(ViewerId viewer, std::string_view message) override {
    viewers->tell(viewer, "heard " + std::string{message});
  }
  void binary(ViewerId, std::string_view) override {}
  Viewers* viewers;
};

TEST_CASE("web: a ping may be the first that a viewer is sent, and its answer counts as a word of it") {
  Viewers viewers{1};
  Asking asking{viewers};
  const auto web = Web::open({}, viewers, asking);
  REQUIRE(web);
  const std::string place = place_of(**web);
  Client client{port_of(place)};
  client.say(upgrade(place));
  const std::string ping = "\x89\x01"s;  // and one byte
  REQUIRE(client.hear(ping).find(ping) != std::string::npos);
  CHECK(viewers.heard(1) == 0);
  client.say(frame(10, std::string(1, '\0')));
  client.say(frame(1, "here"));
  CHECK(client.hear("heard here").ends_with("\x81\x0Aheard here"));
  CHECK(viewers.heard(1) == 2);
}

TEST_CASE("web: a viewer that hangs up has gone, and so has one that is there at the end") {
  Server server;
  std::vector<std::unique_ptr<Client>> clients;
  for (int i = 0; i < 2; ++i) {
    clients.push_back(std::make_unique<Client>(port_of(server.place)));
    server.greets(*clients.back());
  }
  CHECK(server.viewers.count() == 2);
  clients[0].reset();
  pollfd waits{server.orders.descriptor(), POLLIN, 0};
  REQUIRE(::poll(&waits, 1, 20'000) == 1);
  auto orders = server.orders.take();
  REQUIRE(orders.size() == 1);
  CHECK(orders[0].kind == Order::Kind::gone);
  CHECK(orders[0].viewer == 1);
  (*server.web).reset();
  orders = server.orders.take();
  REQUIRE(orders.size() == 1);
  CHECK(orders[0].kind == Order::Kind::gone);
  CHECK(orders[0].viewer == 2);
  CHECK(server.viewers.count() == 0);
}

TEST_CASE("web: whatever is refused is counted") {
  Server server;
  CHECK((*server.web)->refused() == 0);
  const auto answer = [&](const std::string& request, std::string_view words) {
    Client client{port_of(server.place)};
    client.say(request);
    return client.hear(words);
  };
  CHECK_THAT(answer(upgrade(server.place, subprotocol, "8"), "version 13"),
             Catch::Contains(" 400 Bad Request\r\n"));
  CHECK((*server.web)->refused() == 1);
  static_cast<void>(answer(upgrade(server.place, ""), "offer the subprotocol"));
  CHECK((*server.web)->refused() == 2);
  const std::string of_other = std::string{subprotocol} + "Origin: http://evil.example\r\n";
  CHECK_THAT(answer(upgrade(server.place, of_other), "may not connect"),
             Catch::Contains(" 403 Forbidden\r\n"));
  CHECK((*server.web)->refused() == 3);
  CHECK_THAT(answer("GET /none HTTP/1.1\r\nHost: " + server.place + "\r\n\r\n", "no such page"),
             Catch::StartsWith("HTTP/1.1 404"));
  CHECK((*server.web)->refused() == 4);
  CHECK(server.viewers.count() == 0);
}

TEST_CASE(
    "web: what has come goes out before the end, which a viewer that reads nothing holds up for 0.1 s") {
  bool came = false;  // of several, for one that has no processor for 0.1 s
  for (int tries = 0; tries < 20 && !came; ++tries) {
    Server server;
    Client client{port_of(server.place)};
    server.greets(client);
    server.viewers.tell(1, "the last words");
    (*server.web).reset();
    came = client.hear("the last words").find("the last words") != std::string::npos;
  }
  CHECK(came);

  Server other;
  Client idle{port_of(other.place)};
  other.greets(idle);
  for (int i = 0; i < 64; ++i) other.viewers.tell(1, std::string(1U << 18, 'x'));  // more than a socket takes
  const auto begin = std::chrono::steady_clock::now();
  (*other.web).reset();
  CHECK(std::chrono::steady_clock::now() - begin >= std::chrono::milliseconds{100});
  CHECK(other.viewers.count() == 0);
}

}  // namespace serve_web_test

#endif
