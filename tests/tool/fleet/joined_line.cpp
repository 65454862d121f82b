// What a program that has joined makes of the answers of the one that has the line.
#include "cli/fleet/joined_line.hpp"

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "cli/shared/messages.hpp"
#include "tests/tool/captured.hpp"
#include "tests/tool/fleet/played_owner.hpp"

namespace fleet_joined_line_test {

using namespace std::chrono_literals;
using namespace ocm;
using namespace ocm::test;
using cli::fleet::JoinedLine;
using cli::fleet::RobotNow;
using mapper::server::Progress;

/// `order` is the number of its last one.
std::string row(unsigned index, const char* name, std::uint64_t order = 0,
                Progress progress = Progress::none) {
  RobotNow robot;
  robot.index = index;
  robot.name = name;
  robot.linked = true;
  robot.order = order;
  robot.progress = progress;
  return to_row(robot) + "\n";
}

TEST_CASE("joined line: robots come in as many answers as it takes") {
  PlayedOwner owner{
      {"ok\nmap", "ok\nidle\n" + row(0, "A") + "more 5\n", "ok\nwaits\nfailed no link to 5\n" + row(5, "B")}};
  JoinedLine line = PlayedOwner::joined();
  REQUIRE(line.peers().size() == 2);
  CHECK(line.peers()[1].index == 5);
  CHECK(line.robot(0).name == "A");
  CHECK(line.robot(5).linked);
  const RobotNow gone = line.robot(1);  // it is not on the list
  CHECK(gone.lost);
  CHECK(gone.index == 1);
  CHECK(gone.name == "robot 1");
  CHECK_FALSE(line.idle());
  CHECK(line.take_failed() == std::vector<std::string>{"no link to 5"});
  CHECK(owner.heard() == std::vector<std::string>{"hello 1 goto", "robots 0", "robots 5"});
}

TEST_CASE("joined line: between two looks it leaves the owner alone for 50 ms") {
  PlayedOwner owner{{"ok\nmap", "ok\nidle\n", "ok\nidle\n" + row(3, "A")}};
  JoinedLine line = PlayedOwner::joined();
  CHECK(line.peers().empty());
  const auto begin = std::chrono::steady_clock::now();
  line.exchange();
  CHECK(std::chrono::steady_clock::now() - begin >= 50ms);
  REQUIRE(line.peers().size() == 1);
  CHECK(line.peers()[0].index == 3);
  CHECK(owner.heard() == std::vector<std::string>{"hello 1 goto", "robots 0", "robots 0"});
}

TEST_CASE("joined line: an owner that does not answer at once, as on a busy machine, is waited for") {
  const PlayedOwner owner{{"ok\nmap", "ok\nidle\n" + row(3, "A")}, PlayedServer::Says::late};
  const JoinedLine line = PlayedOwner::joined();
  REQUIRE(line.peers().size() == 1);
  CHECK(line.peers()[0].index == 3);
}

TEST_CASE("joined line: an owner that goes round in circles, or says what is not known, ends the command") {
  for (const char* const answer :
       {"ok\nidle\nmore 0\n", "ok\nmore x\n", "ok\nmore -1\n", "ok\nmore\n", "ok\nrow\n"}) {
    CAPTURE(answer);
    const PlayedOwner owner{{"ok\nmap", answer}};
    const auto left = leaving([] { static_cast<void>(PlayedOwner::joined().idle()); });
    CHECK(left.code == cli::exit_failure);
    CHECK_THAT(left.text, Catch::Contains(", which this program does not know"));
  }
}

TEST_CASE("joined line: of a word that is not known the first 60 characters are said") {
  const std::string beginning(60, 'r');
  const PlayedOwner owner{{"ok\nmap", "ok\nidle\n" + beginning + "est\n"}};
  const auto left = leaving([] { static_cast<void>(PlayedOwner::joined().idle()); });
  CHECK(left.code == cli::exit_failure);
  CHECK_THAT(left.text,
             Catch::StartsWith("amiroctl: goto: the owner (process ") &&
                 Catch::Contains(") says '" + beginning + "', which this program does not know\n") &&
                 Catch::Contains("are they of the same version? `amiroctl --version`"));
}

TEST_CASE("joined line: what it asks of the owner, word for word") {
  std::vector<std::string> answers{"ok\nmap", "ok\nidle\n" + row(3, "A")};
  answers.insert(answers.end(), 7, "ok\n");
  for (const unsigned order : {1U, 2U, 3U, 4U}) {
    answers.push_back(fmt::format("ok\n{}", order));
    answers.push_back("ok\nidle\n" + row(3, "A", order == 2 ? 7U : order));  // then another program sends it
  }
  PlayedOwner owner{answers};
  JoinedLine line = PlayedOwner::joined();
  CHECK(line.idle());
  line.scan(1500ms);
  CHECK_FALSE(line.idle());
  line.connect(3);
  CHECK_FALSE(line.idle());
  line.pause(3);
  line.unpause(3);
  line.ping(3);
  line.ask_who(3);
  line.leave(3);
  CHECK_FALSE(line.is_ours(3));
  CHECK_FALSE(line.go(3, {-90, 50}));
  CHECK(line.idle());
  CHECK(line.is_ours(3));
  CHECK_FALSE(line.go(3, {}));
  CHECK_FALSE(line.is_ours(3));
  CHECK_FALSE(line.calibrate(3, false));
  CHECK(line.is_ours(3));
  CHECK_FALSE(line.calibrate(3, true));  // to ask is no order
  CHECK_FALSE(line.is_ours(3));
  CHECK_FALSE(line.is_ours(4));
  CHECK(owner.heard() == std::vector<std::string>{"hello 1 goto", "robots 0", "scan 1500", "connect 3",
                                                  "pause 3", "unpause 3", "ping 3", "who 3", "leave 3",
                                                  "go 3 -90 50", "robots 0", "stop 3", "robots 0",
                                                  "calibrate 3", "robots 0", "compass 3", "robots 0"});
}

TEST_CASE("joined line: an order that is refused is handed back, all else ends the command") {
  const PlayedOwner owner{{"ok\nmap", "ok\nidle\n" + row(3, "A"), "no\nA is driven by another\nwait",
                           "no\nthe central has too many requests to do\nask again"}};
  std::optional<transport::Failure> refused;
  const auto left = leaving([&] {
    JoinedLine line = PlayedOwner::joined();
    refused = line.go(3, {0, 10});
    CHECK_FALSE(line.is_ours(3));
    line.connect(3);
  });
  REQUIRE(refused);
  CHECK(refused->what == "A is driven by another");
  CHECK(refused->remedy == "wait");
  CHECK(left.code == cli::exit_failure);
  CHECK_THAT(left.text, Catch::StartsWith("amiroctl: goto: the owner (process ") &&
                            Catch::EndsWith("): the central has too many requests to do\n"
                                            "          ask again\n"));
}

TEST_CASE("joined line: without the owner those are named that may drive because of this program") {
  struct Row {
    const char* what;
    std::string robots;
    bool drives;
  };
  const Row rows[] = {
      {"B drives", row(0, "A", 5, Progress::said) + row(1, "B", 7, Progress::heard), true},
      {"B has stopped", row(0, "A", 5, Progress::said) + row(1, "B", 7, Progress::stopped), false},
      {"another program has sent B since", row(0, "A") + row(1, "B", 8, Progress::said), false},
  };
  for (const Row& each : rows) {
    CAPTURE(each.what);
    const PlayedOwner owner{{"ok\nmap", "ok\nidle\n" + row(1, "B"), "ok\n7", "ok\nidle\n" + each.robots}};
    const auto left = leaving([] {
      JoinedLine line = PlayedOwner::joined();
      CHECK_FALSE(line.go(1, {90, 50}));
      line.exchange();
    });
    CHECK(left.code == cli::exit_failure);
    CHECK_THAT(left.text,
               Catch::StartsWith("amiroctl: goto: the owner (process ") && Catch::Contains(") has ended\n"));
    CHECK_THAT(left.text, Catch::EndsWith(
                              each.drives ? "\n          B may still drive: at the latest it stops after 60 "
                                            "cm; to stop it: amiroctl goto B 0 0\n"
                                          : "\n          was it stopped (Ctrl-Z; `fg` lets it go on), or has "
                                            "it ended?\n"));
  }
  // A map sends several.
  {
    const PlayedOwner of_two{
        {"ok\nmap", "ok\nidle\n" + row(0, "A") + row(1, "B"), "ok\n5",
         "ok\nidle\n" + row(0, "A", 5, Progress::said) + row(1, "B"), "ok\n7",
         "ok\nidle\n" + row(0, "A", 5, Progress::said) + row(1, "B", 7, Progress::heard)}};
    const auto both = leaving([] {
      JoinedLine line = PlayedOwner::joined();
      CHECK_FALSE(line.go(0, {90, 50}));
      CHECK_FALSE(line.go(1, {90, 50}));
      line.exchange();
    });
    CHECK_THAT(both.text,
               Catch::EndsWith("\n          A, B may still drive: at the latest each stops after 60 cm; to "
                               "stop them: amiroctl goto A 0 0; amiroctl goto B 0 0\n"));
  }
  // It may have had the order, to which it said nothing any more.
  const PlayedOwner owner{{"ok\nmap", "ok\nidle\n" + row(0, "A") + row(1, "B")}};
  const auto left = leaving([] { static_cast<void>(PlayedOwner::joined().go(1, {90, 50})); });
  CHECK(left.code == cli::exit_failure);
  CHECK_THAT(left.text, Catch::Contains("\n          B may still drive: "));
}

TEST_CASE("joined line: a map comes in as many pieces as it takes, or as there are") {
  struct Row {
    std::vector<std::string> answers;
    std::string map;
    std::vector<std::string> asked;
  };
  const Row rows[] = {
      {{"ok\n10\nabcdefghij"}, "abcdefghij", {"map svg"}},
      {{"ok\n10\nabcd", "ok\n10\nefg\n", "ok\n10\nij"}, "abcdefg\nij", {"map svg", "more 4", "more 8"}},
      {{"ok\n0\n"}, "", {"map svg"}},                               // none yet
      {{"ok\n10\nabc", "ok\n10\n"}, "abc", {"map svg", "more 3"}},  // no more comes
  };
  for (const Row& each : rows) {
    CAPTURE(each.map);
    std::vector<std::string> answers{"ok\nmap", "ok\nidle\n"}, asked{"hello 1 goto", "robots 0"};
    answers.insert(answers.end(), each.answers.begin(), each.answers.end());
    asked.insert(asked.end(), each.asked.begin(), each.asked.end());
    PlayedOwner owner{answers};
    JoinedLine line = PlayedOwner::joined();
    transport::Failure failure;
    const auto map = line.map("svg", failure);
    REQUIRE(map);
    CHECK(*map == each.map);
    CHECK(failure.what.empty());
    CHECK(owner.heard() == asked);
  }
}

TEST_CASE("joined line: without a map it is said why, and whether the owner is there still") {
  struct Row {
    std::vector<std::string> answers;
    const char* why;
    const char* remedy;
    bool over;
  };
  const Row rows[] = {
      {{"no\nrobots draws no map\nend it"}, "robots draws no map", "end it", false},
      {{"ok\nten\nabc"}, ") sends no map that could be read", "is it of this version?", false},
      {{"ok\n10"}, ") sends no map that could be read", "is it of this version?", false},
      {{}, ") has ended", "was it stopped (Ctrl-Z; `fg` lets it go on), or has it ended?", true},
  };
  for (const Row& each : rows) {
    CAPTURE(each.why);
    std::vector<std::string> answers{"ok\nmap", "ok\nidle\n"};
    answers.insert(answers.end(), each.answers.begin(), each.answers.end());
    const PlayedOwner owner{answers};
    JoinedLine line = PlayedOwner::joined();
    transport::Failure failure;
    CHECK_FALSE(line.map("svg", failure));
    CHECK_THAT(failure.what, Catch::EndsWith(each.why));
    CHECK(failure.remedy == each.remedy);
    CHECK(line.over() == each.over);
  }
}

}  // namespace fleet_joined_line_test
