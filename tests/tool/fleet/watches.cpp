// What watches robots behind a central: their links, their pauses, and that they stand at the end.
#include <chrono>
#include <cstdint>
#include <string>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "cli/fleet/keeper.hpp"
#include "cli/fleet/link_watch.hpp"
#include "cli/fleet/pausing.hpp"
#include "tests/tool/captured.hpp"
#include "tests/tool/fleet/played_line.hpp"

namespace fleet_watches_test {

using namespace std::chrono_literals;
using namespace ocm;
using namespace ocm::cli::fleet;
using cognitive::Advice;
using mapper::server::Calibrator;
using mapper::server::Progress;
using test::PlayedLine;
using Phase = LinkWatch::Phase;

/// Stands at 0, 0, and has a link that is well.
RobotNow& standing(PlayedLine& line) {
  auto& robot = line.add(3, "A");
  robot.linked = robot.located = robot.confirmed = true;
  robot.quality_per_mille = 987;
  robot.update = mapper::link::Update{};
  return robot;
}
void drives(RobotNow& robot, std::int16_t x, std::int16_t y, std::int16_t heading) {
  robot.update = mapper::link::Update{x, y, heading};
  robot.progress = Progress::said;
  robot.located = false;
}
void stands(RobotNow& robot) {
  robot.progress = Progress::stopped;
  robot.located = true;
}

TEST_CASE(
    "link watch: a robot that drives with a bad link is stopped, sent home and stopped where the link is "
    "well") {
  PlayedLine line;
  auto& robot = standing(line);
  LinkWatch watch;
  const auto step = [&] { return watch.step(line, robot, true); };
  CHECK_FALSE(step());
  CHECK(watch.phase() == Phase::well);
  drives(robot, 200, 0, 0);
  CHECK_FALSE(step());
  robot.advice = Advice::bad_link;
  CHECK(step());
  CHECK(watch.phase() == Phase::stopping);
  CHECK(watch.called());
  CHECK_FALSE(watch.over());
  CHECK(line.take_told() == "go 3 0 0\n");
  CHECK_FALSE(step());  // said once; it has not stopped yet
  CHECK(line.take_told().empty());
  robot.progress = Progress::stopped;  // not known yet where
  CHECK_FALSE(step());
  CHECK(watch.phase() == Phase::stopping);
  robot.located = true;
  CHECK_FALSE(step());
  CHECK(watch.phase() == Phase::returning);
  CHECK(line.take_told() == "go 3 180 200\n");
  drives(robot, 120, 0, 180);
  CHECK_FALSE(step());
  CHECK(watch.phase() == Phase::returning);
  robot.advice = Advice::stay;
  CHECK_FALSE(step());
  CHECK(watch.phase() == Phase::settling);
  CHECK(line.take_told() == "go 3 0 0\n");
  CHECK_FALSE(step());
  CHECK(watch.phase() == Phase::settling);
  stands(robot);
  CHECK_FALSE(step());
  CHECK(watch.phase() == Phase::back);
  CHECK(watch.over());
  CHECK_FALSE(step());
  CHECK(watch.phase() == Phase::well);
  CHECK_FALSE(watch.called());
}

TEST_CASE("link watch: it comes as far back as one leg is long, or all the way with a link that stays bad") {
  PlayedLine line;
  auto& robot = standing(line);
  LinkWatch watch;
  CHECK_FALSE(watch.step(line, robot, true));
  drives(robot, 0, 500, 90);
  robot.advice = Advice::far_away;
  CHECK(watch.step(line, robot, true));
  stands(robot);
  CHECK_FALSE(watch.step(line, robot, true));
  CHECK(line.take_told() == "go 3 0 0\ngo 3 180 300\n");
  robot.progress = Progress::heard;
  CHECK_FALSE(watch.step(line, robot, true));
  CHECK(watch.phase() == Phase::returning);
  robot.progress = Progress::ended;
  CHECK_FALSE(watch.step(line, robot, true));
  CHECK(watch.phase() == Phase::back);
  CHECK_FALSE(watch.step(line, robot, true));  // still bad: it is not called again
  CHECK(watch.phase() == Phase::back);
  CHECK(line.take_told().empty());
}

TEST_CASE("link watch: near its home it stays, and home is where it stood last with a good link") {
  for (const int x : {5, 7}) {
    PlayedLine line;
    auto& robot = standing(line);
    robot.update->x = 100;
    LinkWatch watch;
    CHECK_FALSE(watch.step(line, robot, true));
    drives(robot, 150, 0, 0);
    CHECK_FALSE(watch.step(line, robot, true));  // not while it drives
    robot.update->x = static_cast<std::int16_t>(100 + x);
    robot.advice = Advice::bad_link;
    CHECK(watch.step(line, robot, true));
    stands(robot);
    CHECK_FALSE(watch.step(line, robot, true));
    CHECK(watch.phase() == (x == 5 ? Phase::back : Phase::returning));
    CHECK(line.take_told() == (x == 5 ? "go 3 0 0\n" : "go 3 0 0\ngo 3 180 7\n"));
  }
  // It was never seen to stand: home is the first place that was seen.
  PlayedLine line;
  auto& robot = standing(line);
  drives(robot, 30, 0, 0);
  LinkWatch watch;
  CHECK_FALSE(watch.step(line, robot, true));
  robot.update->x = 80;
  CHECK_FALSE(watch.step(line, robot, true));
  robot.advice = Advice::bad_link;
  CHECK(watch.step(line, robot, true));
  stands(robot);
  CHECK_FALSE(watch.step(line, robot, true));
  CHECK(line.take_told() == "go 3 0 0\ngo 3 180 50\n");
}

TEST_CASE(
    "link watch: home is no place in the middle of a drive, or where it has stopped and is not located") {
  struct Row {
    const char* what;
    bool located;
    Progress progress;
  };
  for (const Row& row : {Row{"drives", true, Progress::said}, Row{"stopped", false, Progress::stopped}}) {
    CAPTURE(row.what);
    PlayedLine line;
    auto& robot = standing(line);
    LinkWatch watch;
    CHECK_FALSE(watch.step(line, robot, true));
    robot.update->x = 50;
    robot.located = row.located;
    robot.progress = row.progress;
    CHECK_FALSE(watch.step(line, robot, true));
    drives(robot, 100, 0, 0);
    robot.advice = Advice::bad_link;
    CHECK(watch.step(line, robot, true));
    stands(robot);
    CHECK_FALSE(watch.step(line, robot, true));
    CHECK(line.take_told() == "go 3 0 0\ngo 3 180 100\n");
  }
}

TEST_CASE(
    "link watch: six centimetres are not near its home, and where it stands next with a good link is its "
    "home") {
  {
    PlayedLine line;
    auto& robot = standing(line);
    LinkWatch watch;
    CHECK_FALSE(watch.step(line, robot, true));
    drives(robot, 6, 0, 0);
    robot.advice = Advice::bad_link;
    CHECK(watch.step(line, robot, true));
    stands(robot);
    CHECK_FALSE(watch.step(line, robot, true));
    CHECK(watch.phase() == Phase::returning);
    CHECK(line.take_told() == "go 3 0 0\ngo 3 180 6\n");
  }
  PlayedLine line;
  auto& robot = standing(line);
  LinkWatch watch;
  for (const std::int16_t x : {std::int16_t{0}, std::int16_t{50}}) {
    robot.update->x = x;
    CHECK_FALSE(watch.step(line, robot, true));
  }
  drives(robot, 100, 0, 0);
  robot.advice = Advice::bad_link;
  CHECK(watch.step(line, robot, true));
  stands(robot);
  CHECK_FALSE(watch.step(line, robot, true));
  CHECK(line.take_told() == "go 3 0 0\ngo 3 180 50\n");
}

TEST_CASE("link watch: it calls back only what drives, what it may, and what it can") {
  struct Row {
    const char* what;
    bool call_back;
    std::function<void(PlayedLine&, RobotNow&)> change;
    Phase phase;
  };
  const Row rows[] = {
      {"drives", true, [](PlayedLine&, RobotNow&) {}, Phase::stopping},
      {"not to be called", false, [](PlayedLine&, RobotNow&) {}, Phase::bad},
      {"stands", true, [](PlayedLine&, RobotNow& robot) { stands(robot); }, Phase::bad},
      {"is being stopped", true, [](PlayedLine&, RobotNow& robot) { robot.progress = Progress::stopping; },
       Phase::bad},
      {"calibrates its compass", true,
       [](PlayedLine&, RobotNow& robot) {
         stands(robot);
         robot.compass = Calibrator::Phase::turning;
       },
       Phase::stopping},
      {"another program drives it", true, [](PlayedLine& line, RobotNow&) { line.refuses = true; },
       Phase::failed},
  };
  for (const Row& row : rows) {
    CAPTURE(row.what);
    PlayedLine line;
    auto& robot = standing(line);
    LinkWatch watch;
    CHECK_FALSE(watch.step(line, robot, row.call_back));
    drives(robot, 100, 0, 0);
    row.change(line, robot);
    robot.advice = Advice::bad_link;
    CHECK(watch.step(line, robot, row.call_back));
    CHECK(watch.phase() == row.phase);
    CHECK_FALSE(watch.step(line, robot, row.call_back));
    robot.advice = Advice::stay;
    robot.progress = Progress::none;
    robot.compass = Calibrator::Phase::none;
    CHECK_FALSE(watch.step(line, robot, row.call_back));
    if (row.phase == Phase::bad || row.phase == Phase::failed) CHECK(watch.phase() == Phase::well);
  }
}

TEST_CASE("link watch: a robot that is lost or sent by another program is called no more") {
  const std::function<void(PlayedLine&, RobotNow&)> changes[] = {
      [](PlayedLine&, RobotNow& robot) { robot.lost = true; },
      [](PlayedLine&, RobotNow& robot) { robot.linked = false; },
      [](PlayedLine& line, RobotNow&) { line.of_others[3] = true; },
  };
  for (const auto& change : changes) {
    PlayedLine line;
    auto& robot = standing(line);
    LinkWatch watch;
    CHECK_FALSE(watch.step(line, robot, true));
    drives(robot, 100, 0, 0);
    robot.advice = Advice::bad_link;
    CHECK(watch.step(line, robot, true));
    change(line, robot);
    CHECK_FALSE(watch.step(line, robot, true));
    CHECK(watch.phase() == Phase::failed);
    CHECK(watch.over());
  }
  // Without a link it has no bad one.
  PlayedLine line;
  auto& robot = standing(line);
  robot.linked = false;
  robot.advice = Advice::bad_link;
  LinkWatch watch;
  CHECK_FALSE(watch.step(line, robot, true));
  CHECK(watch.phase() == Phase::well);
}

TEST_CASE("link watch: its words") {
  RobotNow robot;
  robot.name = "A";
  robot.quality_per_mille = 629;
  robot.advice = Advice::bad_link;
  CHECK(words_of_link(robot) == "the link to A is bad: 62 % of its sentences come whole");
  robot.advice = Advice::far_away;
  CHECK(words_of_link(robot) == "A is almost out of the radio's range");
  test::Captured err{STDERR_FILENO};
  warn_of_link("goto", robot);  // without a link it has no bad one
  robot.linked = true;
  warn_of_link("goto", robot);
  robot.advice = Advice::stay;
  warn_of_link("goto", robot);
  CHECK(err.text() == "goto: A is almost out of the radio's range; bring the central or the robot nearer\n");
}

TEST_CASE("keeper: says which robots are linked, lost and back, and whose links are bad") {
  PlayedLine line;
  std::string said;
  Keeper keeper{true, [&](const std::string& words) { said += words + "\n"; }};
  const auto look = [&] {
    keeper.look(line);
    return std::exchange(said, {});
  };
  auto& robot = standing(line);
  robot.linked = false;
  robot.lost = true;
  auto& other = line.add(4, "B");
  CHECK(look() == "A is lost\n");
  robot.linked = true;
  robot.lost = false;
  CHECK(look() == "A is linked\n");
  CHECK(look().empty());
  robot.lost = true;
  CHECK(look() == "A is lost\n");
  CHECK(look().empty());
  robot.lost = false;
  other.linked = true;
  CHECK(look() == "A is back\nB is linked\n");
  // At rest it is not called back.
  robot.advice = Advice::far_away;
  CHECK(look() == "A is almost out of the radio's range; bring the central or the robot nearer\n");
  robot.advice = Advice::stay;
  CHECK(look().empty());
  drives(robot, 100, 0, 0);
  robot.advice = Advice::bad_link;
  robot.quality_per_mille = 500;
  CHECK(look() == "the link to A is bad: 50 % of its sentences come whole; it is called back\n");
  stands(robot);
  CHECK(look().empty());
  robot.progress = Progress::reached;
  CHECK(look().empty());
  robot.advice = Advice::stay;
  CHECK(look() == "the link to A is well again\n");
}

TEST_CASE("pausing: it is said again each half second until updates stay away and the robot still speaks") {
  PlayedLine line;
  auto& robot = standing(line);
  robot.updated = base::Time{1s};
  const base::Time begin{10s};
  Pausing pausing{robot, true, begin};
  const auto step = [&](base::Duration after) { return pausing.step(line, begin + after); };
  CHECK(step(0ms) == Pausing::Seen::not_yet);
  CHECK(line.take_told() == "pause 3\nping 3\n");
  robot.updated = base::Time{10s + 100ms};  // it has not heard it
  CHECK(step(499ms) == Pausing::Seen::not_yet);
  CHECK(line.take_told().empty());
  CHECK(step(500ms) == Pausing::Seen::not_yet);
  CHECK(line.take_told() == "pause 3\nping 3\n");
  ++robot.pieces;  // a part of an update
  CHECK(step(700ms) == Pausing::Seen::not_yet);
  for (int word = 1; word <= 2; ++word) {
    robot.heard = base::Time{11s + word * 1ms};
    CHECK(step(800ms + word * 100ms) == Pausing::Seen::not_yet);
  }
  CHECK(step(700ms + 1499ms) == Pausing::Seen::not_yet);
  CHECK(step(700ms + 1500ms) == Pausing::Seen::obeys);
}

TEST_CASE("pausing: a robot that sends no update from the first word on is believed after a while, too") {
  PlayedLine line;
  auto& robot = standing(line);
  const base::Time begin{10s};
  Pausing pausing{robot, true, begin};
  for (int word = 1; word <= 2; ++word) {
    robot.heard = begin + word * 100ms;
    CHECK(pausing.step(line, begin + word * 100ms) == Pausing::Seen::not_yet);
  }
  // The first word may have been lost: its silence counts from the second on.
  CHECK(pausing.step(line, begin + 500ms + 1499ms) == Pausing::Seen::not_yet);
  CHECK(pausing.step(line, begin + 500ms + 1500ms) == Pausing::Seen::obeys);
}

TEST_CASE("pausing: one word is too few, and a robot that is lost or never obeys is said so") {
  PlayedLine line;
  auto& robot = standing(line);
  const base::Time begin{10s};
  {
    Pausing pausing{robot, true, begin};
    robot.heard = base::Time{11s};
    CHECK(pausing.step(line, begin) == Pausing::Seen::not_yet);
    CHECK(pausing.step(line, begin + 9999ms) == Pausing::Seen::not_yet);
    CHECK(pausing.step(line, begin + 10s) == Pausing::Seen::never);
  }
  {
    Pausing pausing{robot, true, begin};
    CHECK(pausing.step(line, begin + 1ms) == Pausing::Seen::not_yet);
    robot.lost = true;
    CHECK(pausing.step(line, begin + 2ms) == Pausing::Seen::lost);
    robot.lost = false;
  }
  // Its end is seen by the first update, and what was said before is not.
  line.take_told();
  Pausing ends{robot, false, begin};
  ++robot.pieces;
  robot.heard = base::Time{12s};
  CHECK(ends.step(line, begin + 3s) == Pausing::Seen::not_yet);
  CHECK(line.take_told() == "unpause 3\n");
  robot.updated = base::Time{13s};
  CHECK(ends.step(line, begin + 3100ms) == Pausing::Seen::obeys);
}

TEST_CASE("halt: what may drive is stopped and waited for, whatever else stands or is another program's") {
  PlayedLine line;
  const auto put = [&](unsigned index, const char* name, Progress progress) -> RobotNow& {
    auto& robot = line.add(index, name);
    robot.linked = true;
    robot.progress = progress;
    return robot;
  };
  put(0, "drives", Progress::said);
  put(1, "never_sent", Progress::none);
  put(2, "stopped", Progress::stopped);
  put(3, "stands", Progress::ended).standing = true;
  put(4, "no_link", Progress::said).linked = false;
  put(5, "not_meant", Progress::said);
  put(6, "reached", Progress::reached);
  put(7, "taken", Progress::heard);
  const std::vector<unsigned> all{0, 1, 2, 3, 4, 5, 6, 7};
  int exchanged = 0;
  line.next = [&] {
    ++exchanged;
    if (exchanged == 1) line.of_others[7] = true;
    if (exchanged == 3) line.robots[0].progress = Progress::stopped;
    if (exchanged == 5) line.robots[6].standing = true;
  };
  CHECK(halt(line, "test", all, [](unsigned index) { return index != 5; }));
  CHECK(line.take_told() == "go 0 0 0\ngo 6 0 0\ngo 7 0 0\n");
  CHECK(exchanged == 5);
  CHECK(halt(line, "test", {1, 2, 3, 4}, [](unsigned) { return true; }));
  CHECK(line.take_told().empty());
  CHECK(exchanged == 5);
}

TEST_CASE(
    "pausing: neither an update nor what was said before it counts as a word of a robot that is paused") {
  PlayedLine line;
  auto& robot = standing(line);
  const base::Time begin{10s};
  Pausing pausing{robot, true, begin};
  const auto step = [&](base::Duration after) { return pausing.step(line, begin + after); };
  for (const base::Duration word : {100ms, 200ms}) {
    robot.heard = begin + word;
    CHECK(step(word) == Pausing::Seen::not_yet);
  }
  robot.updated = robot.heard = begin + 600ms;  // it has not heard it
  CHECK(step(600ms) == Pausing::Seen::not_yet);
  robot.heard = begin + 800ms;
  CHECK(step(800ms) == Pausing::Seen::not_yet);
  CHECK(step(600ms + 1500ms) == Pausing::Seen::not_yet);  // one word
  robot.heard = begin + 2200ms;
  CHECK(step(2200ms) == Pausing::Seen::obeys);
}

}  // namespace fleet_watches_test
