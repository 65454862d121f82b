#include "cli/fleet/line_replay.hpp"

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

namespace fleet_line_replay_test {

using namespace std::chrono_literals;
using namespace ocm;
using cli::fleet::Known;
using cli::fleet::LineReplay;
using cli::fleet::ReadLineLog;
using cli::fleet::RobotNow;

constexpr base::Time begin{1000h};
const std::string handshake = "{H,20,20,1,3,0,90,180,270,5000,0,3}\n";

std::string update(int x, int y, int heading) {
  return "{U," + std::to_string(x) + "," + std::to_string(y) + "," + std::to_string(heading) +
         ",0,40,40,40,40}\n";
}

/// A log of robots 0, A, and 1, B, who say what is put.
struct Log {
  base::Duration at{};
  ReadLineLog read{};
  void says(std::string text) { read.said.push_back({begin + at, std::move(text)}); }
  void robot(int index, const std::string& text, base::Duration pause = 200ms) {
    says("[" + std::to_string(index) + "]:" + (index == 0 ? "A" : "B") + ":" + text);
    at += pause;
  }
};

Known known() {
  Known known;
  known.starts = {{"A", {1, 2, 0}}, {"B", {3, 2, 0}}};
  return known;
}

TEST_CASE("line replay: robots are where they were, and it can be wound") {
  Log log;
  log.says("found 2\n0:C0000000000A:A\n1:C0000000000B:B\nend of list\nconnecting 0\nconnected 0\n");
  log.at = 1s;
  log.robot(0, handshake);
  for (int i = 0; i <= 10; ++i) log.robot(0, update(i * 5, 0, 0));
  log.robot(1, handshake);
  log.robot(1, update(0, 7, 90));
  LineReplay replay{log.read, known()};
  CHECK(replay.playing().at == 0s);
  CHECK(replay.playing().length == log.at - 200ms);
  auto robots = replay.robots();
  REQUIRE(robots.size() == 2);
  CHECK(robots[0].name == "A");
  CHECK(robots[0].address == "C0000000000A");
  CHECK(robots[0].linked);
  CHECK_FALSE(robots[1].linked);
  CHECK_FALSE(robots[0].update);
  replay.go_to(2s);
  robots = replay.robots();
  REQUIRE(robots[0].update);
  CHECK(robots[0].update->x == 20);
  CHECK(robots[0].pose().x_m == Approx(1.2F));
  CHECK(robots[0].pose().y_m == Approx(2));
  const auto drawn = replay.drawing().counters().drawn;
  CHECK(drawn == 5);
  replay.go_to(1h);
  CHECK(replay.playing().ended);
  robots = replay.robots();
  CHECK(robots[0].pose().x_m == Approx(1.5F));
  CHECK(robots[1].pose().y_m == Approx(2.07F));
  CHECK(replay.drawing().counters().drawn == 12);
  replay.go_to(2s);  // back: as it was
  CHECK(replay.robots()[0].update->x == 20);
  CHECK(replay.drawing().counters().drawn == drawn);
  // It goes on by its clock, so many times as fast.
  replay.faster(4);
  replay.play(100ms);
  CHECK(replay.playing().at == 2400ms);
  CHECK(replay.robots()[0].update->x == 30);
}

TEST_CASE("line replay: who says its handshake again goes on, or has begun again") {
  Log log;
  log.robot(0, handshake);
  log.robot(0, update(0, 0, 0));
  log.robot(0, update(30, 0, 0));
  log.robot(0, handshake);  // it was asked
  log.robot(0, handshake);
  log.robot(0, update(34, 0, 0));
  LineReplay replay{log.read, known()};
  replay.go_to(1h);
  CHECK(replay.robots()[0].pose().x_m == Approx(1.34F));
  log.robot(0, handshake);  // it was switched off and on, where it stood
  log.robot(0, update(0, 0, 0));
  log.robot(0, update(10, 0, 0));
  LineReplay again{log.read, known()};
  again.go_to(1h);
  CHECK(again.robots()[0].pose().x_m == Approx(1.44F));
}

TEST_CASE("line replay: where robots began must be known, but for a robot alone; links end") {
  Log log;
  log.robot(0, handshake);
  log.robot(0, update(0, 0, 0));
  LineReplay alone{log.read, {}};
  alone.go_to(1h);
  CHECK(alone.robots()[0].origin_known);
  CHECK(alone.drawing().counters().drawn == 1);
  log.robot(1, update(0, 0, 0));
  log.says("lost 0\n");
  LineReplay two{log.read, {}};
  two.go_to(1h);
  CHECK_FALSE(two.robots()[0].origin_known);
  CHECK_FALSE(two.robots()[0].linked);
  CHECK(two.robots()[1].linked);
  CHECK(two.drawing().counters().drawn == 0);
  Log moment;
  moment.robot(0, update(0, 0, 0), 0s);
  CHECK(LineReplay{moment.read, {}}.robots()[0].origin_known);
  moment.robot(1, update(0, 0, 0), 0s);
  CHECK_FALSE(LineReplay{moment.read, {}}.robots()[0].origin_known);
}

TEST_CASE(
    "line replay: a beam ends at another robot where that has said its place, and its beginning is known") {
  Known both = known();
  both.starts[1].pose = {1.45F, 2, 0};  // in front of A, where its beam of 40 cm ends
  Known first = both;
  first.starts.pop_back();
  const auto on_robots = [](const Log& log, const Known& known) {
    LineReplay replay{log.read, known};
    replay.go_to(1h);
    CHECK(replay.drawing().map().counters().hits > 0);
    return replay.drawing().map().counters().on_robots;
  };
  Log log;
  log.says("found 2\n0:C0000000000A:A\n1:C0000000000B:B\nend of list\n");
  log.robot(0, handshake);
  log.robot(0, update(0, 0, 0));
  CHECK(on_robots(log, both) == 0);
  Log there = log, anywhere = log;
  there.robot(1, update(0, 0, 0));
  there.robot(0, update(0, 0, 0));
  CHECK(on_robots(there, both) > 0);
  anywhere.robot(1, update(145, 200, 0));
  anywhere.robot(0, update(0, 0, 0));
  CHECK(on_robots(anywhere, first) == 0);
}

TEST_CASE("line replay: a robot moves while its updates show it, or it does not say that it stands") {
  const auto state = [](const Log& log) {
    LineReplay replay{log.read, known()};
    replay.go_to(1h);
    return std::string{cli::fleet::state_of(replay.robots()[0])};
  };
  const std::string idle = "{S,IDL}\n";
  Log log;
  log.robot(0, handshake);
  log.robot(0, update(0, 0, 0));
  CHECK(state(log) == "idle");
  log.robot(0, idle);
  for (int i = 0; i < 5; ++i) log.robot(0, update(1, 0, 359));  // as its numbers are rounded
  CHECK(state(log) == "idle");
  log.robot(0, update(4, 0, 0));
  CHECK(state(log) == "moving");
  log.robot(0, idle);
  CHECK(state(log) == "idle");
  log.robot(0, update(4, 0, 0), 1s);
  log.robot(0, update(4, 0, 3));  // it turns
  CHECK(state(log) == "moving");
  log.robot(0, idle);
  // Against an obstacle it stays where it is, and does not stand.
  for (int i = 0; i < 11; ++i) log.robot(0, update(4, 0, 3));
  CHECK(state(log) == "idle");  // one idle may be lost
  for (int i = 0; i < 2; ++i) log.robot(0, update(4, 0, 3));
  CHECK(state(log) == "moving");
  // Before it stood it drove; backwards all of it is as it was.
  LineReplay replay{log.read, known()};
  replay.go_to(1h);
  replay.go_to(1700ms);
  CHECK(cli::fleet::state_of(replay.robots()[0]) == "moving");
  replay.go_to(1200ms);
  CHECK(cli::fleet::state_of(replay.robots()[0]) == "idle");
}

TEST_CASE("line replay: what is shown of robots does not hang on how far each step goes") {
  Log log;
  log.robot(0,
            "{H,20,20,1,3,0,90,180,270,100,0,3}\n");  // lost after 100 ms of silence, so between its pieces
  for (const int x : {0, 30, 0}) log.robot(0, update(x, 0, 0));
  LineReplay whole{log.read, known()}, steps{log.read, known()};
  for (base::Duration at{}; !steps.playing().ended; at += 50ms) {
    steps.go_to(at);
    whole.go_to({});
    whole.go_to(at);
    CHECK(cli::fleet::to_row(whole.robots()[0]) == cli::fleet::to_row(steps.robots()[0]));
  }
}

TEST_CASE("line replay: pieces that end anywhere, noise, and nothing at all") {
  Log log;
  const std::string all = "[0]:A:" + update(5, 6, 7) + "[0]:A:" + update(8, 9, 10);
  for (const char c : all) log.says(std::string{c});
  log.says("\x80\xff[[999]:x:{U,[1]:");
  LineReplay replay{log.read, {}};
  replay.go_to(1h);
  REQUIRE(replay.robots()[0].update);
  CHECK(replay.robots()[0].update->x == 8);
  LineReplay nothing{ReadLineLog{}, {}};
  nothing.play(1s);
  CHECK(nothing.robots().empty());
}

TEST_CASE(
    "line replay: a robot that stands beside its beginning, or is silent for two of its words, stands") {
  const auto state = [](const Log& log) {
    LineReplay replay{log.read, known()};
    replay.go_to(1h);
    return std::string{cli::fleet::state_of(replay.robots()[0])};
  };
  Log log;
  log.robot(0, handshake);
  log.robot(0, update(0, 40, 0));
  log.robot(0, "{S,IDL}\n");
  log.robot(0, update(0, 40, 0));
  CHECK(state(log) == "idle");
  for (int i = 0; i < 11; ++i) log.robot(0, update(0, 40, 0));  // the last one 2.4 s behind what it said
  CHECK(state(log) == "idle");
  log.robot(0, update(0, 40, 0));
  CHECK(state(log) == "moving");
}

TEST_CASE(
    "line replay: an update that comes at once with its idle does not show that it moves, the next one "
    "does") {
  const auto state = [](const Log& log) {
    LineReplay replay{log.read, known()};
    replay.go_to(1h);
    return std::string{cli::fleet::state_of(replay.robots()[0])};
  };
  Log log;
  log.robot(0, handshake);
  log.robot(0, update(0, 0, 0));
  log.robot(0, "{S,IDL}\n" + update(40, 0, 0));
  CHECK(state(log) == "idle");
  log.robot(0, update(40, 0, 0));
  CHECK(state(log) == "moving");
}

TEST_CASE("line replay: no beam of a robot ends at the robot itself") {
  Log log;
  log.robot(0, handshake);
  log.robot(0, "{U,0,0,0,0,8,40,40,40}\n");
  LineReplay replay{log.read, known()};
  replay.go_to(1h);
  CHECK(replay.drawing().map().counters().near == 1);
  CHECK(replay.drawing().map().counters().on_robots == 0);
}

TEST_CASE("line replay: half-way to its beginning it goes on; what was before it began again is forgotten") {
  Log half;
  half.robot(0, handshake);
  half.robot(0, update(0, 0, 0));
  half.robot(0, update(10, 0, 0));
  half.robot(0, handshake);
  half.robot(0, update(5, 0, 0));
  LineReplay first{half.read, known()};
  first.go_to(1h);
  CHECK(first.robots()[0].pose().x_m == Approx(1.05F));

  Log again;
  again.robot(0, handshake);
  again.robot(0, update(0, 0, 0));
  again.robot(0, update(34, 0, 0));
  again.robot(0, handshake);  // switched off and on, where it stood
  for (const int x : {0, 20, 34}) again.robot(0, update(x, 0, 0));
  LineReplay second{again.read, known()};
  second.go_to(1h);
  CHECK(second.robots()[0].pose().x_m == Approx(1.68F));
}

TEST_CASE("line replay: a robot has a number below 128") {
  Log log;
  log.says("found 1\n128:C0000000000A:A\nend of list\nconnecting 128\nconnected 128\n");
  for (const std::string& text : {handshake, update(5, 6, 7), std::string{"{S,IDL}\n"}}) {
    log.at += 200ms;
    log.says("[128]:A:" + text);
  }
  log.says("lost 128\n");
  LineReplay none{log.read, {}};
  none.go_to(1h);
  CHECK(none.robots().empty());
  log.says("[127]:B:" + update(5, 6, 7));
  LineReplay last{log.read, {}};
  last.go_to(1h);
  REQUIRE(last.robots().size() == 1);
  CHECK(last.robots()[0].index == 127);
}

}  // namespace fleet_line_replay_test
