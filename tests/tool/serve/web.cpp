#include "cli/serve/web.hpp"

#ifdef OCM_HAS_WEBSOCKETS

#include <arpa/inet.h>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <memory>
#include <poll.h>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <tuple>
#include <unistd.h>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

#include "cli/serve/assets.hpp"
#include "cli/serve/sessions.hpp"
#include "tool/thread_signals.hpp"
#include "unit/host/host_testing.hpp"

namespace ocm::cli::serve {

/// The page is no part of this program: two files stand for it, the second longer than what is sent at once.
std::span<const Asset> assets() noexcept {
  static constexpr auto letters = [] {
    std::array<char, 40'000> all{};
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<char>('a' + i / 7 % 26);
    return all;
  }();
  static constexpr std::array<Asset, 2> files{
      {{"index.html", "<p>a page</p>"}, {"long.css", {letters.data(), letters.size()}}}};
  return files;
}

}  // namespace ocm::cli::serve

namespace serve_web_test {

using namespace ocm::cli::serve;
using namespace std::string_literals;

/// A connection to a server on this machine.
class Client {
 public:
  explicit Client(std::uint16_t port, in_addr_t host = INADDR_LOOPBACK) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(host);
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
  /// What came so far is not looked at again.
  void forget() { heard_.clear(); }
  /// Whether the server hangs up, whatever it says before; one that is kept is let be for 10 s.
  [[nodiscard]] bool hangs_up() const {
    pollfd waits{socket_, POLLIN, 0};
    char piece[4096];
    ssize_t size = 1;
    while (size > 0 && ::poll(&waits, 1, 5'000) == 1) size = ::recv(socket_, piece, sizeof piece, 0);
    return size <= 0;
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

TEST_CASE("web: what is refused of HEAD has no body, as nothing of HEAD has") {
  Server server;
  Client client{port_of(server.place)};
  client.say("HEAD /none HTTP/1.1\r\nHost: " + server.place + "\r\n\r\n");
  const std::string all = client.hear("no such page");  // until the server hangs up
  CHECK_THAT(all, Catch::StartsWith("HTTP/1.1 404") && Catch::EndsWith("\r\n\r\n"));
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

TEST_CASE("web: each time that it is woken it sends what has come since") {
  Server server;
  Client client{port_of(server.place)};
  server.greets(client);
  for (const char* const text : {"the first words", "the second words", "the third words"}) {
    server.viewers.tell(1, text);
    (*server.web)->wake();
    REQUIRE(client.hear(text).find(text) != std::string::npos);
  }
}

TEST_CASE("web: more than is sent in one turn goes out all the same") {
  Server server;
  Client client{port_of(server.place)};
  server.greets(client);
  for (int i = 0; i < 60; ++i) server.viewers.tell(1, "text " + std::to_string(i));
  (*server.web)->wake();
  const std::string heard = client.hear("text 59");
  for (int i = 0; i < 60; ++i) CHECK(heard.find("text " + std::to_string(i)) != std::string::npos);
}

TEST_CASE(
    "web: files go out whole, one after the other on a connection, and of HEAD only what is said of them") {
  Server server;
  const auto ask = [&](const Client& client, const std::string& what) {
    client.say(what + " HTTP/1.1\r\nHost: " + server.place + "\r\n\r\n");
  };
  Client client{port_of(server.place)};
  for (const char* const path : {"/", "/index.html"}) {
    ask(client, "HEAD "s + path);
    const std::string head = client.hear("\r\n\r\n");
    CHECK(head.starts_with("HTTP/1.1 200 "));
    CHECK(head.find("text/html; charset=utf-8\r\n") != std::string::npos);
    ask(client, "GET "s + path);
    const std::string page = client.hear("</p>");
    CHECK(page.starts_with(head + "HTTP/1.1 200 "));  // nothing is between the two
    CHECK(page.find("text/html; charset=utf-8\r\n", head.size()) != std::string::npos);
    CHECK(page.ends_with("\r\n\r\n<p>a page</p>"));
    client.forget();
  }
  ask(client, "GET /long.css");
  const std::string long_one{assets()[1].content};
  const std::string all = client.hear(long_one);
  CHECK(all.starts_with("HTTP/1.1 200 "));
  CHECK(all.find("text/css; charset=utf-8\r\n") != std::string::npos);
  CHECK(all.ends_with("\r\n\r\n" + long_one));
  CHECK((*server.web)->refused() == 0);
}

TEST_CASE("web: the connection of what is refused is closed at once, and so is one that asks for it") {
  Server server;
  const std::string rest = " HTTP/1.1\r\nHost: " + server.place + "\r\n";
  for (const std::string& method : {"GET"s, "HEAD"s}) {
    INFO(method);
    const Client refused{port_of(server.place)};
    refused.say(method + " /none" + rest + "\r\n");
    CHECK(refused.hangs_up());
    const Client last{port_of(server.place)};
    last.say(method + " /" + rest + "Connection: close\r\n\r\n");
    CHECK(last.hangs_up());
  }
}

TEST_CASE("web: where no port is named it is one that any program may have") {
  Server server;
  CHECK(port_of(server.place) >= 1024);
}

TEST_CASE("web: by which names a request may mean this server") {
  Server server;
  const auto answer = [&](const std::string& host) {
    Client client{port_of(server.place)};
    client.say("GET / HTTP/1.1\r\nHost: " + host + "\r\n\r\n");
    return client.hear("\n\r\n").substr(0, 13);
  };
  for (const char* const host :
       {"127.0.0.1", "127.0.0.1:1", "127.0.0.1:12345", "localhost", "[::1]", "[::1]:80"})
    CHECK(answer(host) == "HTTP/1.1 200 ");
  for (const char* const host :
       {"127.0.0.1:80x", "127.0.0.1:123456", "[::1]x", "evil.example", "evil.example:80"})
    CHECK(answer(host) == "HTTP/1.1 403 ");
}

/// Says to each viewer whether it may command, and that it has heard what it says.
struct Noting final : Listener {
  explicit Noting(Viewers& all) : viewers(&all) {}
  void opened(ViewerId viewer, bool commands) override {
    viewers->tell(viewer, commands ? "it may command" : "it may look");
  }
  void gone(ViewerId) override {}
  void text(ViewerId viewer, std::string_view message) override {
    viewers->tell(viewer, "a text: " + std::string{message});
  }
  void binary(ViewerId viewer, std::string_view message) override {
    viewers->tell(viewer, "bytes: " + std::string{message});
  }
  Viewers* viewers;
};

TEST_CASE("web: the address that it listens on is its name, too, and another one is not") {
  Viewers viewers{1};
  Noting noting{viewers};
  WebOptions options;
  options.address = "127.0.0.2";
  const auto web = Web::open(options, viewers, noting);
  REQUIRE(web);
  const std::string place = place_of(**web);
  CHECK(place.starts_with("127.0.0.2:"));
  const auto answer = [&](const std::string& host) {
    Client client{port_of(place), INADDR_LOOPBACK + 1};
    client.say("GET / HTTP/1.1\r\nHost: " + host + "\r\n\r\n");
    return client.hear("\n\r\n").substr(0, 13);
  };
  for (const std::string& host : {"127.0.0.2"s, place, "localhost"s, "127.0.0.1"s})
    CHECK(answer(host) == "HTTP/1.1 200 ");
  CHECK(answer("127.0.0.3") == "HTTP/1.1 403 ");
}

TEST_CASE("web: why it cannot serve, and what is to be done") {
  Viewers viewers{1};
  Noting noting{viewers};
  const auto why = [&](const WebOptions& options) {
    const auto web = Web::open(options, viewers, noting);
    return web ? "it serves"s : web.error.what + "\n" + web.error.remedy;
  };
  WebOptions options;
  options.address = "127.0.0.x";
  CHECK(why(options) ==
        "--address 127.0.0.x: not an address\n"
        "write the address of an interface of this machine, such as 192.168.1.20");
  options.address = "192.0.2.1";  // of no machine [RFC 5737]
  CHECK(why(options) ==
        "cannot listen on 192.0.2.1 port 0: Cannot assign requested address\n"
        "--address takes an address of this machine, --port a port from 1024 on");
  const Server other;
  options = {};
  options.port = port_of(other.place);
  CHECK(why(options) == "cannot listen on 127.0.0.1 port " + std::to_string(options.port) +
                            ": Address already in use\n"
                            "another program listens there: --port takes another port, 0 any that is free");

  const ocm::test::TemporaryDirectory folder;
  const std::string none = folder.file("none.pem"), empty = folder.file("empty.pem");
  std::ofstream{empty} << "no certificate\n";
  options = {};
  options.certificate = none;
  options.key = empty;
  CHECK(why(options) ==
        "--certificate " + none + ": No such file or directory\nname a PEM file that can be read");
  options.certificate = empty;
  options.key = none;
  CHECK(why(options) == "--key " + none + ": No such file or directory\nname a PEM file that can be read");
}

TEST_CASE("web: who shows the token may command, and to who shows another one it is said") {
  constexpr const char* other = "the token of this address is not that of this server, so you only look";
  constexpr const char* none = "this server takes no commands: it was started without --allow-commands";
  const auto said = [](const std::string& token, const std::string& shown) {
    Viewers viewers{1};
    Noting noting{viewers};
    WebOptions options;
    options.token = token;
    const auto web = Web::open(options, viewers, noting);
    REQUIRE(web);
    const std::string place = place_of(**web);
    Client client{port_of(place)};
    client.say("GET /" + shown + upgrade(place).substr(5));
    client.hear("it may ");
    client.say(frame(1, "here"));
    return client.hear("a text: here");
  };
  for (const auto& [token, shown, may, why] :
       {std::tuple{"0123456789", "?token=0123456789", "it may command", ""},
        {"0123456789", "", "it may look", ""},
        {"0123456789", "?token=0123456788", "it may look", other},
        {"0123456789", "?token=1123456789", "it may look", other},
        {"0123456789", "?token=012345678", "it may look", other},
        {"0123456789", "?token=01234567890", "it may look", other},
        {"", "?token=0123456789", "it may look", none},
        {"", "", "it may look", ""}}) {
    INFO(token << " " << shown);
    const std::string all = said(token, shown);
    CHECK(all.find(may) != std::string::npos);
    CHECK((all.find("only look") != std::string::npos) == (std::string{why} == other));
    CHECK((all.find("takes no commands") != std::string::npos) == (std::string{why} == none));
    CHECK(all.find(why) != std::string::npos);
  }
}

TEST_CASE("web: pieces of a message are put together, and one that is no text ends the connection") {
  Viewers viewers{1};
  Noting noting{viewers};
  const auto web = Web::open({}, viewers, noting);
  REQUIRE(web);
  const std::string place = place_of(**web);
  Client client{port_of(place)};
  client.say(upgrade(place));
  client.hear("it may look");
  std::string first = frame(1, "one ");
  first[0] = '\x01';  // and more follows
  client.say(first);
  client.say(frame(0, "two"));
  CHECK(client.hear("a text: one two").find("a text: one two") != std::string::npos);
  client.say(frame(2, "three"));
  CHECK(client.hear("bytes: three").find("bytes: three") != std::string::npos);
  client.forget();
  client.say(frame(1, "\xFF\xFE"));
  CHECK(client.hear("\x88").find("a text") == std::string::npos);  // it hangs up [RFC 6455 8.1]
}

TEST_CASE("web: signals are not for the thread that serves") {
  const auto before = ocm::test::kept_away();
  Server server;
  Client client{port_of(server.place)};
  server.greets(client);
  std::size_t others = 0;
  for (const auto& [thread, signals] : ocm::test::kept_away()) {
    if (const auto known = before.find(thread); known != before.end()) {
      CHECK(signals == known->second);
    } else {
      CHECK(ocm::test::keeps_all_away(signals));
      ++others;
    }
  }
  CHECK(others == 1);
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
