// What a program that has joined makes of the answers of the one that has the line.
#include "cli/fleet/joined_line.hpp"

#include <chrono>
#include <filesystem>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "cli/shared/messages.hpp"
#include "tests/tool/captured.hpp"
#include "tests/tool/played_server.hpp"

namespace fleet_joined_line_test {

using namespace std::chrono_literals;
using namespace ocm;
using namespace ocm::test;
using cli::LocalLink;
using cli::fleet::JoinedLine;
using cli::fleet::RobotNow;

std::string row(unsigned index, const char* name) {
  RobotNow robot;
  robot.index = index;
  robot.name = name;
  robot.linked = true;
  return to_row(robot) + "\n";
}

/// The program that has the line, with a socket that goes with it.
class Owner {
 public:
  explicit Owner(std::vector<std::string> answers)
      : server_(path(), std::move(answers), PlayedServer::Says::ahead) {}
  ~Owner() { std::filesystem::remove(path()); }
  Owner(const Owner&) = delete;
  Owner& operator=(const Owner&) = delete;

  [[nodiscard]] static JoinedLine joined() {
    auto link = LocalLink::connect(path(), "the owner", "goto", 30s);
    REQUIRE(link);
    REQUIRE(*link);
    return JoinedLine{"goto", std::move(*link)};
  }
  const std::vector<std::string>& heard() { return server_.end(); }

 private:
  static std::string path() {
    return (std::filesystem::temp_directory_path() / fmt::format("ocm-joined-{}.sock", ::getpid())).string();
  }

  PlayedServer server_;
};

TEST_CASE("joined line: robots come in as many answers as it takes") {
  Owner owner{
      {"ok\nmap", "ok\nidle\n" + row(0, "A") + "more 5\n", "ok\nwaits\nfailed no link to 5\n" + row(5, "B")}};
  JoinedLine line = Owner::joined();
  REQUIRE(line.peers().size() == 2);
  CHECK(line.peers()[1].index == 5);
  CHECK(line.robot(0).name == "A");
  CHECK(line.robot(5).linked);
  CHECK(line.robot(1).lost);
  CHECK_FALSE(line.idle());
  CHECK(line.take_failed() == std::vector<std::string>{"no link to 5"});
  CHECK(owner.heard() == std::vector<std::string>{"hello 1 goto", "robots 0", "robots 5"});
}

TEST_CASE("joined line: between two looks it leaves the owner alone for 50 ms") {
  Owner owner{{"ok\nmap", "ok\nidle\n", "ok\nidle\n" + row(3, "A")}};
  JoinedLine line = Owner::joined();
  CHECK(line.peers().empty());
  const auto begin = std::chrono::steady_clock::now();
  line.exchange();
  CHECK(std::chrono::steady_clock::now() - begin >= 50ms);
  REQUIRE(line.peers().size() == 1);
  CHECK(line.peers()[0].index == 3);
  CHECK(owner.heard() == std::vector<std::string>{"hello 1 goto", "robots 0", "robots 0"});
}

TEST_CASE("joined line: an owner that goes round in circles, or says what is not known, ends the command") {
  for (const char* const answer :
       {"ok\nidle\nmore 0\n", "ok\nmore x\n", "ok\nmore -1\n", "ok\nmore\n", "ok\nrow\n"}) {
    CAPTURE(answer);
    const Owner owner{{"ok\nmap", answer}};
    const auto left = leaving([] { static_cast<void>(Owner::joined().idle()); });
    CHECK(left.code == cli::exit_failure);
    CHECK_THAT(left.text, Catch::Contains(", which this program does not know"));
  }
}

}  // namespace fleet_joined_line_test
