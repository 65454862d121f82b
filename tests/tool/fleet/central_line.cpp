// What a verb makes of the robots on a central's line: which of them are meant, how long each is waited for,
// and the words with which it ends. Another program has the line, and is played.
#include "cli/fleet/central_line.hpp"

#include <array>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "ocm/host/descriptor.hpp"

#include "cli/fleet/keeper.hpp"
#include "cli/fleet/pause_seen.hpp"
#include "cli/shared/local_link.hpp"
#include "cli/shared/messages.hpp"
#include "tests/tool/captured.hpp"
#include "tests/tool/played_server.hpp"
#include "tests/unit/host/host_testing.hpp"

namespace fleet_central_line_test {

using namespace std::chrono_literals;
using namespace ocm;
using namespace ocm::test;
using cli::fleet::CentralLine;
using cli::fleet::LineOptions;
using cli::fleet::Need;
using cli::fleet::RobotNow;
using Words = std::vector<std::string>;

/// A verb catches signals: what comes of them is as before at the end.
class Handlers {
 public:
  Handlers() {
    for (std::size_t i = 0; i < signals.size(); ++i) ::sigaction(signals[i], nullptr, &before_[i]);
  }
  ~Handlers() {
    for (std::size_t i = 0; i < signals.size(); ++i) ::sigaction(signals[i], &before_[i], nullptr);
  }
  Handlers(const Handlers&) = delete;
  Handlers& operator=(const Handlers&) = delete;

 private:
  static constexpr std::array<int, 4> signals{SIGINT, SIGTERM, SIGHUP, SIGQUIT};
  std::array<struct sigaction, 4> before_{};
};

/// A program `robots` has the line. It answers as its list says, ahead of what is asked, and then has ended.
class Bench {
 public:
  LineOptions options;

  explicit Bench(Words answers, const std::string& greeting = "ok\nrobots")
      : server_(socket(), greeted(std::move(answers), greeting), PlayedServer::Says::ahead) {}
  /// All that it was asked, once the verb has left the line.
  const Words& heard() { return server_.end(); }

 private:
  std::string socket() {
    std::filesystem::create_directories(folder_.path() + "/ocm");
    options.path = folder_.path() + "/dongle";
    return cli::local_socket("line", cli::digits_of_path(options.path));
  }
  static Words greeted(Words answers, const std::string& greeting) {
    answers.insert(answers.begin(), greeting);
    return answers;
  }

  TemporaryDirectory folder_;
  Environment runtime_{"XDG_RUNTIME_DIR", folder_.path().c_str()};
  Handlers handlers_;
  PlayedServer server_;
};

/// Linked, and stands.
RobotNow robot(unsigned index, const char* name) {
  RobotNow out;
  out.index = index;
  out.address = fmt::format("C0000000000{}", index);
  out.name = name;
  out.linked = true;
  out.last = mapper::link::Kind::idle;
  return out;
}
/// The answer that has these robots; `state`: "idle" or "waits", and lines of what failed.
std::string rows(const std::vector<RobotNow>& robots, const std::string& state = "idle\n") {
  std::string text = "ok\n" + state;
  for (const RobotNow& each : robots) text += to_row(each) + "\n";
  return text;
}
const std::string done = "ok\n";

TEST_CASE("central line: the list of robots is waited for, however long the one that has the line takes") {
  Bench bench{
      {rows({}), done, rows({}, "waits\n"), rows({}, "waits\n"), rows({}, "waits\n"), rows({robot(0, "A")})}};
  bench.options.scan = 0ms;
  {
    CentralLine line{"goto", bench.options};
    const auto& peers = line.scan();
    REQUIRE(peers.size() == 1);
    CHECK(peers[0].name == "A");
  }
  CHECK(bench.heard() ==
        Words{"hello 1 goto", "robots 0", "scan 0", "robots 0", "robots 0", "robots 0", "robots 0"});
}

TEST_CASE("central line: a list that does not come ends the verb") {
  const Bench bench{{rows({}), done, rows({}, "idle\nfailed the central does not answer\n")}};
  const auto left = leaving([&] {
    CentralLine line{"goto", bench.options};
    static_cast<void>(line.scan());
  });
  CHECK(left.code == cli::exit_failure);
  CHECK(left.text == fmt::format("amiroctl: goto: robots (process {}): the central does not answer\n"
                                 "          is it a central? Unplug the dongle and plug it in again, or "
                                 "restart the simulation\n",
                                 ::getpid()));
}

TEST_CASE("central line: a robot has time for its first word, whether parts of it have come or not") {
  for (const unsigned torn : {0U, 1U}) {
    CAPTURE(torn);
    RobotNow silent = robot(0, "A");
    silent.last = mapper::link::Kind::none;
    silent.torn = torn;
    Bench bench{{rows({silent}), done, rows({silent}), rows({silent}), rows({robot(0, "A")})}};
    {
      CentralLine line{"goto", bench.options};
      CHECK(line.connect_one("A") == 0);
      CHECK(line.unreached() == 0);
    }
    CHECK(bench.heard() ==
          Words{"hello 1 goto", "robots 0", "connect 0", "robots 0", "robots 0", "robots 0"});
  }
}

TEST_CASE("central line: a robot is named by its name, its address or its index, in this order") {
  const std::vector<RobotNow> robots{robot(0, "A"), robot(1, "A"), robot(2, "1")};
  struct Row {
    const char* name;
    unsigned index;
  };
  for (const Row& row : {Row{"1", 2}, Row{"C00000000001", 1}, Row{"0", 0}, Row{"2", 2}}) {
    CAPTURE(row.name);
    Bench bench{{rows(robots), done, rows(robots)}};
    {
      CentralLine line{"goto", bench.options};
      CHECK(line.connect_one(row.name) == row.index);
    }
    CHECK(bench.heard() ==
          Words{"hello 1 goto", "robots 0", fmt::format("connect {}", row.index), "robots 0"});
  }
  const Bench bench{{rows(robots)}};
  const auto left = leaving([&] {
    CentralLine line{"goto", bench.options};
    static_cast<void>(line.connect_one("A"));
  });
  CHECK(left.code == cli::exit_usage);
  CHECK(left.text ==
        "amiroctl: goto: 2 robots are called 'A'\n"
        "          name one by its index or address: A (index 0, address C00000000000), A (index 1, address "
        "C00000000001)\n");
}

TEST_CASE("central line: robots that are not there are looked for, and the verb ends with those that are") {
  struct Row {
    std::vector<RobotNow> robots;
    Words names;
    const char* words;
    Words asked;
  };
  const Row cases[] = {
      {{robot(0, "A"), robot(1, "B")},
       {"A", "C"},
       "the central finds no robot 'C'\n          it finds A (index 0, address C00000000000), B (index 1, "
       "address C00000000001)\n",
       {"scan 200"}},
      {{},
       {"C"},
       "the central finds no robot 'C'\n          it finds none at all: is the robot switched on, and "
       "near?\n",
       {"scan 0", "scan 200"}},
      {{},
       {},
       "the central finds no robot\n          is one switched on, and near? --scan 10s looks for longer\n",
       {"scan 0", "scan 200"}},
  };
  for (const Row& row : cases) {
    CAPTURE(row.words);
    Words answers{rows(row.robots)}, asked{"hello 1 pause", "robots 0"};
    for (const std::string& scan : row.asked) {
      answers.insert(answers.end(), {done, rows(row.robots)});
      asked.insert(asked.end(), {scan, "robots 0"});
    }
    Bench bench{answers};
    bench.options.scan = 200ms;
    const auto left = leaving([&] {
      CentralLine line{"pause", bench.options};
      static_cast<void>(line.connect(row.names));
    });
    CHECK(left.code == cli::exit_failure);
    CHECK(left.text == std::string{"amiroctl: pause: "} + row.words);
    CHECK(bench.heard() == asked);
  }
}

TEST_CASE("central line: one of several robots that cannot be reached is said, one alone ends the verb") {
  const std::vector<RobotNow> before{robot(0, "A"), robot(1, "B")};
  std::vector<RobotNow> after = before;
  after[1].linked = false;
  const std::string failed = rows(after, "idle\nfailed the central refuses B: no link to 1\n");
  for (const Words& names : {Words{}, Words{"all"}, Words{"A", "B", "A"}}) {
    CAPTURE(names);
    Bench bench{{rows(before), done, done, failed}};
    Captured err{STDERR_FILENO};
    {
      CentralLine line{"pause", bench.options};
      CHECK(line.connect(names) == std::vector<unsigned>{0});
      CHECK(line.unreached() == 1);
    }
    CHECK(err.text() == "pause: the central refuses B: no link to 1\n");
    CHECK(bench.heard() == Words{"hello 1 pause", "robots 0", "connect 0", "connect 1", "robots 0"});
  }
  const Bench bench{{rows(before), done, failed}};
  const auto left = leaving([&] {
    CentralLine line{"pause", bench.options};
    static_cast<void>(line.connect({"B"}));
  });
  CHECK(left.code == cli::exit_failure);
  CHECK(
      left.text ==
      "amiroctl: pause: the central refuses B: no link to 1\n          is it near enough? `amiroctl robots` "
      "lists robots\n");
}

TEST_CASE("central line: what had failed before a verb looks for robots, or links them, is not its failure") {
  const std::vector<RobotNow> robots{robot(0, "A")};
  const std::string before = rows(robots, "idle\nfailed no link to B came\n");
  {
    Bench bench{{before, done, rows(robots)}};
    bench.options.scan = 0ms;
    CentralLine line{"robots", bench.options};
    CHECK(line.scan().size() == 1);
  }
  for (const Words& names : {Words{"A"}, Words{}}) {
    CAPTURE(names);
    const Bench bench{{before, done, rows(robots)}};
    const auto left = leaving([&] {
      CentralLine line{"pause", bench.options};
      CHECK(line.connect(names) == std::vector<unsigned>{0});
    });
    CHECK_FALSE(left.code);
    CHECK(left.text.empty());
  }
}

TEST_CASE("central line: a list that has changed since, or no link at all, ends the verb") {
  RobotNow other = robot(0, "A"), unlinked = robot(0, "A");
  other.address = "C0000000000F";
  unlinked.linked = false;
  struct Row {
    RobotNow after;
    const char* words;
  };
  for (const Row& row :
       {Row{other,
            "another program has looked for robots, and the list has changed\n          say it again\n"},
        Row{unlinked, "no robot could be connected\n          are they near enough?\n"}}) {
    CAPTURE(row.words);
    const Bench bench{{rows({robot(0, "A")}), done, rows({row.after})}};
    const auto left = leaving([&] {
      CentralLine line{"goto", bench.options};
      static_cast<void>(line.connect_one("A"));
    });
    CHECK(left.code == cli::exit_failure);
    CHECK(left.text == std::string{"amiroctl: goto: "} + row.words);
  }
}

TEST_CASE("central line: a verb that needs it for itself, or is to record it, says who has it") {
  {
    const Bench bench{{}};
    const auto left = leaving([&] { const CentralLine line{"map", bench.options, Need::own}; });
    CHECK(left.code == cli::exit_failure);
    CHECK(left.text == fmt::format("amiroctl: map: robots (process {}) has the central's line\n"
                                   "          map needs it for itself: end that one first\n",
                                   ::getpid()));
  }
  Bench bench{{rows({})}};
  bench.options.record = "room.line";
  const auto left = leaving([&] { const CentralLine line{"goto", bench.options}; });
  CHECK(left.code == cli::exit_usage);
  CHECK(left.text == fmt::format("amiroctl: goto: --record: robots (process {}) has the central's line\n"
                                 "          record there: central --own --record FILE, or map --record "
                                 "FILE\n",
                                 ::getpid()));
}

TEST_CASE("central line: it is joined where a program has it and does not end, or refuses that in words") {
  {
    Bench bench{{rows({robot(0, "A")})}};
    {
      const auto line = cli::fleet::join_line("map", bench.options);
      REQUIRE(line);
      CHECK(line->path() == fmt::format("robots (process {})", ::getpid()));
      CHECK(line->robot(0).name == "A");
    }
    CHECK(bench.heard() == Words{"hello 1 map", "robots 0"});
  }
  {
    Bench ends{{}, "wait\n"};
    CHECK_FALSE(cli::fleet::join_line("map", ends.options));
    CHECK(ends.heard() == Words{"hello 1 map"});
  }
  {
    const Bench full{{}, "no\nit takes no more programs\nend one"};
    const auto left = leaving([&] { static_cast<void>(cli::fleet::join_line("map", full.options)); });
    CHECK(left.code == cli::exit_failure);
    CHECK(left.text == "amiroctl: map: it takes no more programs\n          end one\n");
  }
  const TemporaryDirectory folder;
  const Environment runtime{"XDG_RUNTIME_DIR", folder.path().c_str()};
  LineOptions options;
  options.path = folder.file("dongle");
  CHECK_FALSE(cli::fleet::join_line("map", options));
}

TEST_CASE("central line: where no other program could join it is said, and the line is had all the same") {
  const TemporaryDirectory folder;
  const Environment runtime{"XDG_RUNTIME_DIR", folder.path().c_str()};
  const Handlers handlers;
  const std::string directory = folder.file("ocm");
  std::ofstream{directory} << "no directory\n";
  host::Descriptor dongle{::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)};
  REQUIRE(dongle);
  REQUIRE(::grantpt(dongle.get()) == 0);
  REQUIRE(::unlockpt(dongle.get()) == 0);
  LineOptions options;
  options.path = ::ptsname(dongle.get());
  options.dongle.kind = "ours";
  bool is_own = false;
  const auto left = leaving([&] {
    CentralLine line{"robots", options};
    is_own = line.own() != nullptr && line.joined() == nullptr;
    dongle.reset();  // or its last answer is waited for
  });
  CHECK(is_own);
  CHECK_FALSE(left.code);
  CHECK_THAT(left.text, Catch::StartsWith(fmt::format(
                            "robots: no other program can join: '{}' is not a directory\n", directory)));
}

TEST_CASE("central line: only who is linked, speaks and has not said its handshake is asked for it, once") {
  RobotNow strange = robot(0, "A"), known = robot(1, "B"), silent = robot(2, "C"), unlinked = robot(3, "D");
  known.handshake = mapper::link::Handshake{20, 18, -3, 4, 0, 90, 180, 270, 5000, 20225, 3};
  silent.last = mapper::link::Kind::none;
  unlinked.linked = false;
  const std::string before = rows({strange, known, silent, unlinked});
  strange.handshake = known.handshake;
  Bench bench{{before, done, rows({strange, known, silent, unlinked})}};
  {
    CentralLine line{"map", bench.options};
    line.introduce({0, 1, 2, 3});
    CHECK(line.robot(0).handshake);
  }
  CHECK(bench.heard() == Words{"hello 1 map", "robots 0", "who 0", "robots 0"});
}

TEST_CASE("keeper: all robots that the central finds in three seconds are linked, and what fails is said") {
  const std::vector<RobotNow> robots{robot(0, "A"), robot(5, "B")};
  struct Row {
    Words answers;
    std::string said;
    Words asked;
  };
  const Row cases[] = {
      {{rows(robots), done, done, rows(robots, "waits\n"), rows(robots, "waits\n"), rows(robots, "waits\n"),
        rows(robots, "idle\nfailed no link to B came\n")},
       "no link to B came\n",
       {"connect 0", "connect 5", "robots 0", "robots 0", "robots 0", "robots 0"}},
      {{rows({})}, "no robots yet: `amiroctl robots --scan 3s` looks again\n", {}},
  };
  for (const Row& row : cases) {
    CAPTURE(row.said);
    Words answers{rows({}), done}, asked{"hello 1 central", "robots 0", "scan 3000", "robots 0"};
    answers.insert(answers.end(), row.answers.begin(), row.answers.end());
    asked.insert(asked.end(), row.asked.begin(), row.asked.end());
    Bench bench{answers};
    std::string said;
    {
      CentralLine line{"central", bench.options};
      cli::fleet::link_all(line, [&](const std::string& words) { said += words + "\n"; });
    }
    CHECK(said == row.said);
    CHECK(bench.heard() == asked);
  }
}

TEST_CASE(
    "pause seen: a robot that sends updates, or parts of them, is not paused, however old the last is") {
  RobotNow before = robot(0, "A");
  before.updated = base::Time{5s};
  before.heard = base::Time{7s};
  RobotNow updates = before, parts = before;
  updates.updated = base::Time{6s};
  ++parts.pieces;
  for (const RobotNow& after : {updates, parts}) {
    CAPTURE(after.pieces);
    const Bench bench{{rows({before}), rows({before}), rows({after})}};
    CentralLine line{"goto", bench.options};
    CHECK_FALSE(cli::fleet::seems_paused(line, 0));
  }
}

TEST_CASE("pause seen: the end of a pause is seen by an update, and a robot that is lost does not obey") {
  RobotNow before = robot(0, "A");
  before.updated = base::Time{5s};
  RobotNow updates = before, lost = before;
  updates.updated = base::Time{6s};
  lost.lost = true;
  for (const RobotNow& after : {updates, lost}) {
    CAPTURE(after.lost);
    Bench bench{{rows({before}), done, rows({after}), done}};  // on a busy machine it is said once more
    {
      CentralLine line{"unpause", bench.options};
      CHECK(cli::fleet::pause_until_seen(line, 0, false) == !after.lost);
    }
    REQUIRE(bench.heard().size() >= 3);
    CHECK(bench.heard()[2] == "unpause 0");
  }
}

TEST_CASE("pause seen: where none looks whether it is heard a pause is said three times") {
  Bench bench{{rows({robot(5, "A")}), done, done, done}};
  {
    CentralLine line{"goto", bench.options};
    cli::fleet::pause_unseen(line, 5);
  }
  CHECK(bench.heard() == Words{"hello 1 goto", "robots 0", "pause 5", "pause 5", "pause 5"});
}

}  // namespace fleet_central_line_test
