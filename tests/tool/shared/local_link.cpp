// Both ends of a local socket: a server that is asked in words, and a program that asks; each against one
// that is played, which is silent, ends, or says what it should not.
#include "cli/shared/local_link.hpp"

#include <chrono>
#include <fcntl.h>
#include <filesystem>
#include <memory>
#include <string>
#include <sys/file.h>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "cli/shared/local_server.hpp"
#include "tests/tool/local_client.hpp"
#include "tests/tool/played_server.hpp"

namespace tool_shared_local_link_test {

using namespace std::chrono_literals;
using namespace ocm;
using cli::LocalAnswer;
using cli::LocalCaller;
using cli::LocalLink;
using cli::LocalServer;
using test::LocalClient;
using test::PlayedServer;

constexpr host::LocalService service{"a thing", "a server of it", host::Cause::other, false};
constexpr std::string_view remedy = "was it stopped (Ctrl-Z; `fg` lets it go on), or has it ended?";

class Folder {
 public:
  Folder() {
    std::filesystem::create_directories(path_);
    std::filesystem::permissions(path_, std::filesystem::perms::owner_all);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / fmt::format("ocm-local-link-{}", ::getpid());
};

/// Connected to it, as a verb `goto` would be.
std::unique_ptr<LocalLink> connected(const std::string& path) {
  auto link = LocalLink::connect(path, "the thing", "goto", 30s);
  REQUIRE(link);
  REQUIRE(*link);
  return std::move(*link);
}

TEST_CASE("local link: where none serves there is none") {
  const Folder folder;
  const auto none = LocalLink::connect(folder.file("none.sock"), "the thing", "goto");
  REQUIRE(none);
  CHECK(*none == nullptr);
  { PlayedServer{folder.file("dead.sock"), {}}; }
  const auto dead = LocalLink::connect(folder.file("dead.sock"), "the thing", "goto");
  REQUIRE(dead);
  CHECK(*dead == nullptr);
  const auto too_long = LocalLink::connect(folder.file(std::string(200, 'x')), "the thing", "goto");
  REQUIRE(too_long);
  CHECK(*too_long == nullptr);
}

TEST_CASE("local link: a greeting, and each kind of answer") {
  const Folder folder;
  PlayedServer server{folder.file("a.sock"),
                      {"ok\nguard", "ok", "ok\ntwo\nlines", "wait", "no\nit is full\nempty it",
                       "no\nit is full", "what\nis this"}};
  auto link = connected(folder.file("a.sock"));
  CHECK(link->greeting() == "guard");
  CHECK(link->process() == fmt::format(" (process {})", ::getpid()));
  CHECK(link->who() == "the thing" + link->process());
  const auto ask = [&](std::string_view request) { return link->ask(request, 30s); };
  auto answer = ask("one");
  CHECK((answer.kind == LocalAnswer::Kind::ok && answer.text.empty()));
  answer = ask("two");
  CHECK((answer.kind == LocalAnswer::Kind::ok && answer.text == "two\nlines"));
  answer = ask("three");
  CHECK((answer.kind == LocalAnswer::Kind::wait && answer.text.empty()));
  answer = ask("four");
  CHECK((answer.kind == LocalAnswer::Kind::no && answer.failure.what == "it is full" &&
         answer.failure.remedy == "empty it"));
  answer = ask("five");
  CHECK((answer.kind == LocalAnswer::Kind::no && answer.failure.what == "it is full" &&
         answer.failure.remedy.empty()));
  answer = ask("six");  // of a newer program
  CHECK((answer.kind == LocalAnswer::Kind::no && answer.failure.what == "is this"));
  CHECK_FALSE(link->over());
  CHECK(server.end() ==
        std::vector<std::string>{"hello 1 goto", "one", "two", "three", "four", "five", "six"});
}

TEST_CASE("local link: an answer of one byte is one") {
  const Folder folder;
  PlayedServer server{folder.file("a.sock"), {"ok\nguard", "?"}};
  auto link = connected(folder.file("a.sock"));
  const auto answer = link->ask("status", 30s);
  CHECK(answer.kind == LocalAnswer::Kind::no);
  CHECK(answer.failure.what.empty());
  CHECK_FALSE(link->over());
}

TEST_CASE("local link: the longest answer comes whole") {
  const Folder folder;
  const std::string rows(cli::longest_local_message - 3, 'x');
  PlayedServer server{folder.file("a.sock"), {"ok\nguard", "ok\n" + rows}};
  auto link = connected(folder.file("a.sock"));
  const auto answer = link->ask("rows", 30s);
  CHECK(answer.kind == LocalAnswer::Kind::ok);
  CHECK((answer.text == rows && rows.size() > 50'000));
}

TEST_CASE("local link: one that has ended, and asks no more") {
  const Folder folder;
  PlayedServer server{folder.file("a.sock"), {"ok\nguard"}};
  auto link = connected(folder.file("a.sock"));
  server.end();
  link->set_who("operator guard");
  for (int times = 0; times < 2; ++times) {
    const auto answer = link->ask("status", 30s);
    CHECK(answer.kind == LocalAnswer::Kind::silent);
    CHECK(answer.failure.what == "operator guard has ended");
    CHECK(answer.failure.remedy == remedy);
    CHECK(link->over());
  }
}

TEST_CASE("local link: after a silence there is no other answer") {
  const Folder folder;
  PlayedServer server{folder.file("a.sock"), {"ok\nguard", ""}};
  {
    auto link = connected(folder.file("a.sock"));
    CHECK(link->ask("status", 10ms).failure.what == "the thing" + link->process() + " does not answer");
    CHECK(link->over());
    CHECK(link->ask("send 123#", 10ms).kind == LocalAnswer::Kind::silent);
  }
  CHECK(server.end() == std::vector<std::string>{"hello 1 goto", "status"});
}

TEST_CASE("local link: an answer is waited for 300 ms where nothing else is said") {
  const Folder folder;
  PlayedServer server{folder.file("a.sock"), {"ok\nguard", ""}};
  auto link = connected(folder.file("a.sock"));
  const auto begin = std::chrono::steady_clock::now();
  CHECK(link->ask("status").kind == LocalAnswer::Kind::silent);
  CHECK(std::chrono::steady_clock::now() - begin >= 300ms);
}

TEST_CASE("local link: one that does not greet, or turns this program away") {
  const Folder folder;
  {
    PlayedServer silent{folder.file("silent.sock"), {""}};
    const auto link = LocalLink::connect(folder.file("silent.sock"), "the thing", "goto", 10ms);
    REQUIRE_FALSE(link);
    CHECK(link.error.what == fmt::format("the thing (process {}) does not answer", ::getpid()));
  }
  PlayedServer full{folder.file("full.sock"), {"no\n64 programs are connected already\nend some"}};
  const auto link = LocalLink::connect(folder.file("full.sock"), "the thing", "goto", 30s);
  REQUIRE_FALSE(link);
  CHECK(link.error.what == "64 programs are connected already");
  CHECK(link.error.remedy == "end some");
}

TEST_CASE("local link: one whose queue is full of programs that it does not take is said") {
  const Folder folder;
  const PlayedServer stopped{folder.file("stopped.sock"), {}};  // it has room for two
  for (int i = 0; i < 3; ++i)
    static_cast<void>(LocalLink::connect(folder.file("stopped.sock"), "the thing", "goto", 1ms));
  const auto link = LocalLink::connect(folder.file("stopped.sock"), "the thing", "goto", 30s);
  REQUIRE_FALSE(link);
  CHECK(link.error.what == "the thing takes no more programs");
  CHECK(link.error.remedy == "is it stopped? `fg` lets it go on");
}

TEST_CASE("local link: names of sockets") {
  const Folder folder;
  CHECK(cli::local_socket_in("/run", "operator", "can0") == "/run/operator-can0.sock");
  const std::string digits = cli::digits_of_path(folder.file("line"));
  CHECK(digits.size() == 8);
  CHECK(digits.find_first_not_of("0123456789abcdef") == std::string::npos);
  CHECK(digits != cli::digits_of_path(folder.file("other")));
  std::filesystem::create_symlink(folder.file("line"), folder.file("link"));
  CHECK(cli::digits_of_path("/") == fmt::format("{:08x}", (0x811C9DC5U ^ '/') * 0x01000193U));
  { PlayedServer{folder.file("line"), {}}; }  // a link to a file that is there
  CHECK(cli::digits_of_path(folder.file("link")) == digits);
}

/// A server with a desk that says what it has done.
struct Bench {
  Folder folder;
  std::unique_ptr<LocalServer> server;
  std::vector<std::string> done;

  Bench() {
    auto opened = LocalServer::open(folder.file("b.sock"), service);
    REQUIRE(opened);
    server = std::move(*opened);
    server->begin({{},
                   [this](LocalCaller& caller) {
                     done.push_back("greets " + caller.verb);
                     return cli::answers::yes("bench");
                   },
                   [this](LocalCaller& caller, std::string_view request) {
                     done.push_back(fmt::format("{} of {}", request, caller.verb));
                     return request == "wait" ? cli::answers::wait() : cli::answers::yes();
                   },
                   [this](LocalCaller& caller) { done.push_back("gone " + caller.verb); }});
  }
  [[nodiscard]] std::unique_ptr<LocalClient> comes(const std::string& hello = {}) const {
    auto client = std::make_unique<LocalClient>(SOCK_SEQPACKET, folder.file("b.sock"));
    if (!hello.empty()) client->say(hello);
    return client;
  }
  std::string answer(const LocalClient& client) {
    for (int looks = 0; looks < 3; ++looks) server->serve();
    return client.heard();
  }
  [[nodiscard]] std::vector<std::string> greeted() const {
    std::vector<std::string> all;
    server->for_each([&](const LocalCaller& caller) { all.push_back(caller.who()); });
    return all;
  }
};

TEST_CASE("local server: who greets is answered, and is known until it ends") {
  Bench bench;
  auto client = bench.comes("hello 1 goto");
  CHECK(bench.answer(*client) == "ok\nbench");
  CHECK(bench.greeted() == std::vector<std::string>{fmt::format("goto (process {})", ::getpid())});
  client->say("status");
  CHECK(bench.answer(*client) == "ok\n");
  client->say("wait");
  CHECK(bench.answer(*client) == "wait");
  const auto silent = bench.comes();
  CHECK(bench.answer(*silent).empty());
  CHECK(bench.greeted().size() == 1);
  client.reset();
  bench.server->serve();
  CHECK(bench.greeted().empty());
  CHECK(bench.done == std::vector<std::string>{"greets goto", "status of goto", "wait of goto", "gone goto"});
  CHECK(bench.server->turned_away() == 0);
}

TEST_CASE("local server: who does not keep to the protocol is turned away, and counted") {
  std::uint64_t away = 0;
  Bench bench;
  const std::string verb(40, 'v');
  for (const std::string& hello :
       {std::string{"status"}, std::string{"hello 2 goto"}, std::string{"hello 1 "},
        std::string{"hello 1 go to"}, std::string{"hello 1 \x7F"},
        "hello 1 " + std::string(LocalServer::longest_request, 'x')}) {
    CAPTURE(hello.substr(0, 20));
    const auto client = bench.comes(hello);
    CHECK(bench.answer(*client).empty());
    CHECK(bench.server->turned_away() == ++away);
  }
  CHECK(bench.done.empty());
  auto client = bench.comes("hello 1 " + verb);
  CHECK(bench.answer(*client) == "ok\nbench");
  CHECK(bench.done.back() == "greets " + verb.substr(0, 32));
  client->say(std::string(LocalServer::longest_request, 'x'));
  CHECK(bench.answer(*client) == "ok\n");
  client->say("hello 1 again");  // one greeting
  CHECK(bench.answer(*client).empty());
  CHECK(bench.server->turned_away() == ++away);
  CHECK(bench.done.back() == "gone " + verb.substr(0, 32));
  client = bench.comes("hello 1 !~");  // the first and the last of what is printed
  CHECK(bench.answer(*client) == "ok\nbench");
  // One that has left meanwhile: its request is out of date.
  client = bench.comes("hello 1 goto");
  CHECK(bench.answer(*client) == "ok\nbench");
  client->say("drive");
  client.reset();
  bench.server->serve();
  CHECK(bench.done.back() == "gone goto");
  CHECK(bench.server->turned_away() == ++away);
}

TEST_CASE("local server: it takes so many, and makes room for those that greet") {
  Bench bench;
  std::vector<std::unique_ptr<LocalClient>> clients;
  clients.push_back(bench.comes());  // says nothing
  while (clients.size() < LocalServer::most_callers) {
    clients.push_back(bench.comes("hello 1 goto"));
    CHECK(bench.answer(*clients.back()) == "ok\nbench");
  }
  CHECK(bench.server->turned_away() == 0);
  clients.push_back(bench.comes("hello 1 late"));
  CHECK(bench.answer(*clients.back()) == "ok\nbench");
  CHECK(bench.server->turned_away() == 1);
  CHECK(bench.greeted().size() == LocalServer::most_callers);
  const auto more = bench.comes();
  CHECK(bench.answer(*more) == "no\n64 programs are connected already\nend those that are not needed");
  CHECK(bench.server->turned_away() == 2);
}

TEST_CASE("local server: one round takes so many requests, and leaves the rest to the next") {
  Bench bench;
  auto client = bench.comes("hello 1 goto");
  CHECK(bench.answer(*client) == "ok\nbench");
  for (int i = 0; i < 100; ++i) client->say("status");
  bench.done.clear();
  bench.server->serve();
  CHECK(bench.done.size() == LocalServer::most_requests);
  for (int i = 0; i < 3; ++i) bench.server->serve();
  CHECK(bench.done.size() == 100);
}

TEST_CASE("local server: a path that is taken, and one that was removed") {
  Bench bench;
  const auto second = LocalServer::open(bench.folder.file("b.sock"), service);
  REQUIRE_FALSE(second);
  CHECK(bench.server->is_found());
  const auto client = bench.comes("hello 1 goto");
  CHECK(bench.answer(*client) == "ok\nbench");
  std::filesystem::remove(bench.folder.file("b.sock"));
  CHECK_FALSE(bench.server->is_found());
  REQUIRE(bench.server->return_to_path());
  CHECK(bench.server->is_found());
  const auto after = bench.comes("hello 1 after");
  CHECK(bench.answer(*after) == "ok\nbench");
  client->say("status");
  CHECK(bench.answer(*client) == "ok\n");
}

TEST_CASE("local server: another one that starts is waited for, and not by one that has begun") {
  Bench bench;
  const host::Descriptor other{::open(bench.folder.file("").c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  REQUIRE(::flock(other.get(), LOCK_EX) == 0);
  std::filesystem::remove(bench.folder.file("b.sock"));
  const auto back = bench.server->return_to_path();
  REQUIRE_FALSE(back);
  CHECK_THAT(back.error.what, Catch::Contains("holds the lock of the directory"));
  CHECK_FALSE(bench.server->is_found());
  const auto begin = std::chrono::steady_clock::now();
  const auto second = LocalServer::open(bench.folder.file("c.sock"), service);  // waits a second
  REQUIRE_FALSE(second);
  CHECK_THAT(second.error.what, Catch::Contains("holds the lock of the directory"));
  CHECK(std::chrono::steady_clock::now() - begin >= 1s);
  REQUIRE(::flock(other.get(), LOCK_UN) == 0);
  REQUIRE(bench.server->return_to_path());
  CHECK(bench.server->is_found());
}

}  // namespace tool_shared_local_link_test
