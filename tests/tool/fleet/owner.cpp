// The program that has a central's line, and others that join it, word for word: what they ask, what is
// answered, and what robots hear. The central and its robots are played in virtual time.
#include "cli/fleet/owner.hpp"

#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <regex>
#include <sstream>
#include <string>
#include <string_view>
#include <unistd.h>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "cli/shared/local_link.hpp"
#include "tests/tool/golden.hpp"
#include "tests/tool/local_client.hpp"
#include "tests/unit/cognitive/testing/virtual_central.hpp"

namespace fleet_owner_test {

using namespace std::chrono_literals;
using namespace ocm;
using namespace ocm::test;
using cli::LocalServer;
using cli::fleet::Owner;

constexpr host::LocalService service{"a central's line", "a program with a central's line",
                                     host::Cause::other, false};

class Bench {
 public:
  VirtualCentral central;
  cognitive::Server server;
  base::Time now{10s};
  std::unique_ptr<Owner> owner;

  Bench() {
    folder_ = std::filesystem::temp_directory_path() / fmt::format("ocm-owner-{}", ::getpid());
    std::filesystem::create_directories(folder_);
    std::filesystem::permissions(folder_, std::filesystem::perms::owner_all);
    path_ = (folder_ / "line.sock").string();
    auto opened = LocalServer::open(path_, service);
    REQUIRE(opened);
    owner = std::make_unique<Owner>("map", server, std::move(*opened));
  }
  ~Bench() { std::filesystem::remove_all(folder_); }
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  void pass(base::Duration time) {
    for (const base::Time end = now + time; now < end;) {
      now += 10ms;
      central.advance(now);
      server.expire(now);
      central.write(server.take());
      server.feed(std::exchange(central.to_server, {}), now);
      while (auto event = server.next_event())
        if (event->kind == mapper::server::CentralEvent::Kind::failed) owner->failed(event->words);
      owner->serve(now);
      central.write(server.take());
    }
  }
  /// What a program asks, and the answer.
  std::string ask(const std::string& who, const std::string& text) {
    auto& client = clients_[who];
    if (!client) {
      client = std::make_unique<LocalClient>(SOCK_SEQPACKET, path_);
      client->say("hello 1 " + who);
      note(who, "joins", answer(*client));
    }
    client->say(text);
    return note(who, text, answer(*client));
  }
  void leaves(const std::string& who) {
    clients_.erase(who);
    note(who, "has left", "");
  }
  void own(const std::string& what, const std::optional<transport::Failure>& failure) {
    note("map", what, failure ? failure->what + "\n" + failure->remedy : "done");
  }
  void known() {
    std::string text;
    for (const unsigned index : owner->driven_by_others()) text += fmt::format("driven {}\n", index);
    for (unsigned index = 0; index < 3; ++index)
      if (owner->held(index)) text += fmt::format("held {} by {}\n", index, owner->holder(index));
    for (const auto& name : owner->at_work(now)) text += "at work " + name + "\n";
    note("map", "knows",
         text + fmt::format("joined {}, turned away {}", owner->joined(), owner->turned_away()));
  }
  /// All of it, without what differs from one run of the test to the next, and rounded where it is a float.
  std::string text() {
    for (const auto& robot : central.robots) {
      text_ += "--- " + robot.name + " heard\n";
      for (const auto& line : robot.heard) text_ += line;
    }
    text_ = std::regex_replace(text_, std::regex{fmt::format("process {}", ::getpid())}, "process 1");
    return std::regex_replace(text_, std::regex{"(off_cm|off_deg)=(-?[0-9]+)[-.0-9e]*"}, "$1=$2");
  }

 private:
  std::string answer(const LocalClient& client) {
    for (int looks = 0; looks < 3; ++looks) {
      owner->serve(now);
      if (auto text = client.heard(); !text.empty()) return text;
    }
    return {};
  }
  std::string note(const std::string& who, const std::string& what, const std::string& answer) {
    text_ +=
        fmt::format("{:.2f} {}: {}\n", static_cast<double>(now.time_since_epoch() / 10ms) / 100, who, what);
    if (!answer.empty()) text_ += answer + (answer.ends_with('\n') ? "" : "\n");
    return answer;
  }

  std::filesystem::path folder_;
  std::string path_;
  std::map<std::string, std::unique_ptr<LocalClient>> clients_;
  std::string text_;
};

TEST_CASE("owner: what programs on one line are answered, and robots hear, is as it was") {
  Bench bench;
  for (const char* const name : {"AVR", "Arduino", "Third"}) bench.central.add(name);
  bench.central.robots[2].reachable = false;
  const auto ask = [&](const char* who, const char* text) { static_cast<void>(bench.ask(who, text)); };
  const auto pass = [&](base::Duration time) { bench.pass(time); };
  ask("goto", "robots");
  ask("goto", "scan 300");
  ask("goto", "robots");
  ask("robots", "robots");
  pass(1s);
  ask("goto", "robots");
  for (const char* const request : {"connect 0", "connect 1", "connect 2"}) ask("goto", request);
  pass(8s);
  ask("robots", "robots");  // what failed is not its request
  ask("goto", "robots");
  ask("goto", "robots 1");
  ask("goto", "json");
  ask("goto", "json 1");
  ask("goto", "jump");
  bench.known();
  // One drives it, another may stop it, and not send it.
  ask("goto", "go 0 90 100");
  ask("other", "go 0 0 10");
  ask("other", "calibrate 0");
  bench.own("go 0", bench.owner->go(0, {0, 10}, bench.now));
  ask("goto", "go 0 90 120");
  pass(50ms);
  bench.known();
  ask("goto", "robots");
  ask("other", "stop 0");
  ask("goto", "go 0 0 10");
  pass(4s);
  ask("other", "robots");
  ask("goto", "go 0 -90 50");
  pass(3s);
  ask("goto", "robots");
  ask("other", "go 0 0 10");  // that is over
  pass(3s);
  // This program's own.
  bench.own("go 1", bench.owner->go(1, {10, 20}, bench.now));
  ask("goto", "go 1 0 30");
  ask("goto", "calibrate 1");
  bench.owner->leave(1);
  ask("goto", "go 1 0 30");
  bench.own("calibrate 1", bench.owner->calibrate(1, false, bench.now));
  ask("goto", "leave 1");
  bench.own("compass 1", bench.owner->calibrate(1, true, bench.now));
  bench.known();
  for (int i = 0; i < 4; ++i) {
    pass(1s);
    ask("goto", "robots 1");
  }
  bench.own("stop 1", bench.owner->go(1, {}, bench.now));
  pass(3s);
  ask("goto", "calibrate 1");
  ask("goto", "compass 0");
  ask("other", "go 1 0 10");
  pass(200ms);
  ask("goto", "robots");
  // Held by hand; it matters where this program explores.
  ask("pause", "pause 0");
  ask("pause", "ping 0");
  ask("pause", "who 0");
  pass(500ms);
  ask("pause", "json");
  bench.owner->explores();
  ask("pause", "json");
  bench.known();
  ask("pause", "unpause 0");
  ask("pause", "json");
  // Who says nothing for 2 s, or has ended, drives no longer.
  pass(3s);
  ask("goto", "stop 1");
  pass(3s);
  ask("goto", "go 0 0 200");
  ask("silent", "go 1 45 200");
  bench.central.robots[0].update.x = bench.central.robots[1].update.x = -500;  // not where they should be
  pass(1s);
  bench.leaves("goto");
  pass(20ms);
  ask("robots", "robots");
  pass(980ms);
  ask("robots", "robots");
  pass(20ms);
  ask("robots", "robots");
  bench.known();
  pass(5s);
  ask("robots", "robots");
  ask("other", "go 1 0 30");
  ask("other", "leave 1");
  bench.leaves("other");
  pass(1s);
  ask("robots", "robots");
  // A map, in pages.
  ask("page", "map svg");
  bench.owner->on_draw(
      [](std::string_view form) { return form == "pgm" ? std::string{} : std::string(form) + " drawn\n"; });
  ask("page", "map svg");
  ask("page", "map pgm");
  ask("page", "more 0");
  bench.known();
  bench.owner->end_drawing();
  ask("page", "map svg");
  // It is about to end.
  bench.owner->close();
  ask("late", "robots");
  bench.known();
  is_as_in("tests/tool/fleet/golden/owner.txt", bench.text());
}

TEST_CASE("owner: a large map comes in pages, each of which says how large it is") {
  Bench bench;
  std::string whole;
  for (int i = 0; whole.size() < 100'000; ++i) whole += fmt::format("{} ", i);
  bench.owner->on_draw([&](std::string_view) { return whole; });
  std::string read, answer = bench.ask("page", "map svg");
  int pages = 0;
  for (;; ++pages) {
    const std::string head = fmt::format("ok\n{}\n", whole.size());
    REQUIRE(answer.starts_with(head));
    CHECK(answer.size() - head.size() <= 48'000);
    read += answer.substr(head.size());
    if (read.size() == whole.size() || pages == 5) break;
    whole[0] = 'x';  // it is as it was when it was asked for
    answer = bench.ask("page", fmt::format("more {}", read.size()));
  }
  CHECK(pages == 2);
  whole[0] = '0';
  CHECK(read == whole);
  CHECK(bench.ask("page", "more 999999") == fmt::format("ok\n{}\n", whole.size()));
}

TEST_CASE("owner: of what failed for a program that does not ask the first 16 are kept, once each") {
  Bench bench;
  static_cast<void>(bench.ask("a", "scan 1000"));
  static_cast<void>(bench.ask("b", "robots"));
  for (int i = 0; i < 20; ++i) bench.owner->failed(fmt::format("{}", i));
  std::string expected = "ok\nwaits\n";
  for (int i = 0; i < 16; ++i) expected += fmt::format("failed {}\n", i);
  CHECK(bench.ask("a", "robots") == expected);
  CHECK(bench.ask("a", "robots") == "ok\nwaits\n");
  CHECK(bench.ask("b", "robots") == "ok\nidle\n");
  // A central that is full says so.
  std::string full;
  for (int i = 0; i < 1000 && full.empty(); ++i)
    if (const auto answer = bench.ask("a", "connect 0"); answer != "ok\n") full = answer;
  CHECK(full == "no\nthe central has too many requests to do\nask again");
}

TEST_CASE("owner: alone it serves no other program, and knows its robots") {
  cognitive::Server server;
  Owner owner{"map", server, nullptr};
  owner.serve(base::Time{1s});
  owner.failed("x");
  CHECK_FALSE(owner.go(5, {10, 20}, base::Time{1s}));
  const auto robot = owner.robot(5);
  CHECK(robot.name == "robot 5");
  CHECK(robot.index == 5);
  CHECK(robot.order == 1);
  CHECK(robot.by == fmt::format("map (process {})", ::getpid()));
  CHECK_FALSE(owner.driven_by_other(5));
  for (const unsigned index : {unsigned{cognitive::Fleet::most_robots}, 1000U}) {
    CHECK_FALSE(owner.driven_by_other(index));
    CHECK(owner.holder(index).empty());
  }
  CHECK(owner.at_work(base::Time{1s}).empty());
  CHECK(owner.descriptor() == -1);
  CHECK(owner.turned_away() == 0);
  CHECK_FALSE(*owner.renew());
}

TEST_CASE("owner: a robot that its program has left may be sent by any other, while it drives") {
  Bench bench;
  bench.central.add("AVR");
  static_cast<void>(bench.ask("goto", "scan 300"));
  bench.pass(1s);
  static_cast<void>(bench.ask("goto", "connect 0"));
  bench.pass(8s);
  CHECK(bench.ask("goto", "go 0 0 100") == "ok\n1");
  CHECK(bench.ask("other", "go 0 0 10").starts_with("no\nAVR is driven by goto"));
  CHECK(bench.ask("goto", "leave 0") == "ok\n");
  CHECK(bench.ask("other", "go 0 0 10") == "ok\n2");
  CHECK(bench.owner->go(0, {0, 10}, bench.now));  // that one drives it now: refused
}

TEST_CASE("owner: a robot whose program has ended is being stopped, and may be sent by any other at once") {
  Bench bench;
  bench.central.add("AVR");
  static_cast<void>(bench.ask("goto", "scan 300"));
  bench.pass(1s);
  static_cast<void>(bench.ask("goto", "connect 0"));
  bench.pass(8s);
  CHECK(bench.ask("goto", "go 0 0 100") == "ok\n1");
  bench.leaves("goto");
  bench.pass(20ms);
  const auto robot = bench.owner->robot(0);
  CHECK(robot.order == 2);
  CHECK(robot.by == fmt::format("map (process {0}): goto (process {0}) has ended", ::getpid()));
  CHECK(robot.busy());
  CHECK(bench.ask("other", "go 0 0 10") == "ok\n3");
}

TEST_CASE("owner: who joined is at work for two seconds behind its last word") {
  Bench bench;
  static_cast<void>(bench.ask("goto", "robots"));
  CHECK(bench.owner->at_work(bench.now + 2s).size() == 1);
  CHECK(bench.owner->at_work(bench.now + 2s + 1ns).empty());
}

/// As many robots as a program has room for, of names so long, each of which has said where it is, and is
/// sent.
void fill(Bench& bench, const std::vector<std::size_t>& letters) {
  auto& server = bench.server;
  constexpr unsigned most = cognitive::Fleet::most_robots;
  std::string list = fmt::format("found {}\n", most);
  for (unsigned index = 0; index < most; ++index)
    list += fmt::format("{}:C000000000{:02X}:{}\n", index, index, std::string(letters.at(index), 'N'));
  CHECK(server.client().scan(0s));
  server.expire(bench.now);
  server.feed("found 0\n" + list + "end of list\n", bench.now);
  REQUIRE(server.client().peers().size() == most);
  for (unsigned index = 0; index < most; ++index) {
    server.fleet().feed(fmt::format("[{}]:A:{{H,15,20,0,3,0,90,180,270,2000,0}}\n"
                                    "[{}]:A:{{U,-177,-61,-68,49,10,20,30,40}}\n",
                                    index, index),
                        bench.now);
    CHECK_FALSE(bench.owner->go(index, {90, 50}, bench.now));
  }
}

TEST_CASE("owner: robots that find no room in an answer come in the next one") {
  Bench bench;
  constexpr unsigned most = cognitive::Fleet::most_robots;
  const std::string name(50, 'N');
  fill(bench, std::vector<std::size_t>(most, name.size()));
  unsigned next = 0;
  int answers = 0;
  for (bool more = true; more && answers < 5; ++answers) {
    const std::string answer = bench.ask("robots", fmt::format("robots {}", next));
    CHECK(answer.size() < cli::longest_local_message - 1'900);  // with room for what is said besides
    std::istringstream lines{answer};
    std::string line;
    REQUIRE(std::getline(lines, line));
    CHECK(line == "ok");
    REQUIRE(std::getline(lines, line));
    CHECK(line == "idle");
    more = false;
    while (std::getline(lines, line)) {
      CHECK_FALSE(more);  // that is the last line
      more = line == fmt::format("more {}", next);
      if (more) continue;
      const auto robot = cli::fleet::parse_row(line);
      REQUIRE(robot);
      CHECK(robot->index == next);
      CHECK(robot->name == name);
      ++next;
    }
  }
  CHECK(next == most);
  CHECK(answers == 2);
}

TEST_CASE("owner: an answer has rows up to 2000 bytes below the longest message, and that one is full") {
  constexpr std::size_t room = cli::longest_local_message - 2'000;
  std::vector<std::size_t> letters(cognitive::Fleet::most_robots, 45);
  unsigned rows = 0;  // that find room
  std::size_t left = room;
  {
    Bench bench;
    fill(bench, letters);
    std::size_t size = std::string_view{"idle\n"}.size();
    for (; rows < letters.size(); ++rows) {
      const std::size_t row = cli::fleet::to_row(bench.owner->robot(rows)).size();
      if (size + row > room) break;
      left = room - size - row;  // the line end of the last one has room besides
      size += row + 1;
    }
  }
  REQUIRE(rows < letters.size());
  for (unsigned index = 0; index < rows; ++index)
    letters[index] += left / rows + (index < left % rows ? 1U : 0U);
  for (const bool full : {true, false}) {  // as it is, and one byte too long
    CAPTURE(full);
    if (!full) ++letters[0];
    Bench bench;
    fill(bench, letters);
    const std::string answer = bench.ask("robots", "robots");
    CHECK(answer.ends_with(fmt::format("\nmore {}\n", full ? rows : rows - 1)));
    if (full) CHECK(answer.find("more ") == std::string_view{"ok\n"}.size() + room + 1);
  }
}

/// A radio on which 130 robots are seen.
struct Crowd {
  void say(std::string_view text) { said += text; }
  void start_scan() {}
  void stop_scan() {}
  void connect(const mapper::link::Address&) {}
  void disconnect(const mapper::link::Address&) {}
  void restart() {}
  std::string said;
};

TEST_CASE("owner: a central that lists more robots than a program has room for is refused in words") {
  Bench bench;
  Crowd radio;
  const auto central = std::make_unique<mapper::link::Central<130, 1, 8>>();
  std::string words;
  static_cast<void>(bench.ask("robots", "scan 300"));
  for (int i = 0; i < 200; ++i) {
    bench.now += 10ms;
    for (int robot = 0; central->scanning() && robot < 130; ++robot)
      central->found({0xC0, 0, 0, 0, 0, static_cast<std::uint8_t>(robot)}, fmt::format("R{}", robot), radio);
    bench.server.expire(bench.now);
    for (const char c : bench.server.take()) central->feed(c, radio);
    bench.server.feed(std::exchange(radio.said, {}), bench.now);
    while (const auto event = bench.server.next_event())
      if (event->kind == mapper::server::CentralEvent::Kind::failed) words = event->words;
    bench.owner->serve(bench.now);
  }
  CHECK(words == "the central lists robot 128, and 128 is the most");
  CHECK(bench.server.client().peers().empty());
}

}  // namespace fleet_owner_test
