#include "cli/fleet/robot_now.hpp"

#include <chrono>
#include <cstdint>
#include <string>

#include <catch2/catch.hpp>

#include "ocm/mapper/link/packed.hpp"

namespace fleet_robot_now_test {

using namespace std::chrono_literals;
using namespace ocm;
using cli::fleet::parse_row;
using cli::fleet::RobotNow;
using cli::fleet::state_of;
using cli::fleet::to_row;
using mapper::server::Calibrator;
using mapper::server::Progress;

RobotNow some_robot() {
  RobotNow robot;
  robot.name = "Arduino 2";
  robot.linked = robot.confirmed = robot.located = robot.paused = robot.held = robot.blocked = true;
  robot.handshake = mapper::link::Handshake{20, 18, -3, 4, 0, 90, 180, 270, 5000, 20225, 3};
  robot.update = mapper::link::Update{-120, 7, -179, 45, 0, 12, 255, 80};
  robot.updated = base::Time{123'456'789'012ns};
  robot.heard = base::Time{123'456'789'013ns};
  robot.last = mapper::link::Kind::update;
  robot.advice = cognitive::Advice::bad_link;
  robot.index = 127;
  robot.address = "C00000000001";
  robot.quality_per_mille = 637;
  robot.pieces = 4'000'000'000;
  robot.torn = 17;
  robot.progress = Progress::ended;
  robot.times_said = 4;
  robot.off_cm = 20.46F;
  robot.off_deg = 0.1F;
  robot.compass = Calibrator::Phase::turning;
  robot.compass_asked = 3;
  robot.calibration = {7, 2, 41, -57, 152, 1, 2};
  robot.order = 18'446'744'073'709'551'615U;
  robot.by = "goto (process 1234)";
  robot.origin = {-1.5F, 0.25F, 0.1F};
  robot.origin_known = true;
  return robot;
}

TEST_CASE("robot now: a row says all of a robot") {
  const RobotNow robot = some_robot();
  const auto again = parse_row(to_row(robot));
  REQUIRE(again);
  CHECK(to_row(*again) == to_row(robot));
  CHECK(again->name == robot.name);
  CHECK(again->address == robot.address);
  CHECK((again->linked && again->confirmed && again->located && again->paused && again->held &&
         again->blocked));
  CHECK_FALSE((again->idle || again->lost || again->standing));
  CHECK(again->handshake == robot.handshake);
  CHECK(again->update == robot.update);
  CHECK(again->updated == robot.updated);
  CHECK(again->heard == robot.heard);
  CHECK(again->last == robot.last);
  CHECK(again->advice == robot.advice);
  CHECK(again->quality_per_mille == 637);
  CHECK(again->pieces == robot.pieces);
  CHECK(again->progress == Progress::ended);
  CHECK(again->off_cm == robot.off_cm);  // rounded once, where it is printed
  CHECK(again->compass == Calibrator::Phase::turning);
  CHECK(again->calibration == robot.calibration);
  CHECK(again->origin == robot.origin);
  CHECK(again->origin_known);
  CHECK(again->order == robot.order);
  CHECK(again->by == robot.by);
  // And of one that has said nothing.
  const auto nothing = parse_row(to_row(RobotNow{}));
  REQUIRE(nothing);
  CHECK_FALSE((nothing->handshake || nothing->update || nothing->origin_known));
}

TEST_CASE("robot now: each of what is said in a word or a flag is its own") {
  using Flag = bool RobotNow::*;
  for (const Flag flag :
       {Flag{&RobotNow::linked}, Flag{&RobotNow::confirmed}, Flag{&RobotNow::idle}, Flag{&RobotNow::located},
        Flag{&RobotNow::paused}, Flag{&RobotNow::lost}, Flag{&RobotNow::held}, Flag{&RobotNow::standing},
        Flag{&RobotNow::blocked}, Flag{&RobotNow::origin_known}}) {
    RobotNow robot;
    robot.*flag = true;
    const auto again = parse_row(to_row(robot));
    REQUIRE(again);
    CHECK((*again).*flag);
    CHECK(to_row(*again) == to_row(robot));
  }
  for (unsigned kind = 0; kind <= static_cast<unsigned>(mapper::link::Kind::pong); ++kind) {
    RobotNow robot;
    robot.last = static_cast<mapper::link::Kind>(kind);
    const auto again = parse_row(to_row(robot));
    REQUIRE(again);
    CHECK(again->last == robot.last);
  }
  for (unsigned word = 0; word <= static_cast<unsigned>(Progress::stopped); ++word) {
    RobotNow robot;
    robot.progress = static_cast<Progress>(word);
    CHECK(parse_row(to_row(robot))->progress == robot.progress);
  }
  for (unsigned word = 0; word <= static_cast<unsigned>(Calibrator::Phase::done); ++word) {
    RobotNow robot;
    robot.compass = static_cast<Calibrator::Phase>(word);
    CHECK(parse_row(to_row(robot))->compass == robot.compass);
  }
}

TEST_CASE("robot now: what was asked of it is not over while it drives or turns") {
  RobotNow robot;
  for (const Progress progress : {Progress::none, Progress::reached, Progress::ended, Progress::stopped}) {
    robot.progress = progress;
    CHECK_FALSE(robot.busy());
  }
  for (const Progress progress : {Progress::waiting, Progress::said, Progress::heard, Progress::stopping}) {
    robot.progress = progress;
    CHECK(robot.busy());
  }
  using Phase = Calibrator::Phase;
  robot.progress = Progress::stopped;
  for (const Phase phase : {Phase::asking, Phase::ordering, Phase::turning, Phase::storing}) {
    robot.compass = phase;
    CHECK(robot.busy());
    CHECK(robot.may_turn() == (phase == Phase::ordering || phase == Phase::turning));
  }
  for (const Phase phase : {Phase::none, Phase::done}) {
    robot.compass = phase;
    CHECK_FALSE(robot.busy());
    CHECK_FALSE(robot.may_turn());
  }
}

TEST_CASE("robot now: what other programs read of it") {
  CHECK(cli::fleet::to_json(some_robot()).line() ==
        R"({"robot":"Arduino 2","index":127,"address":"C00000000001","state":"held","linked":true,)"
        R"("confirmed":true,"idle":false,"held":true,"quality":0.637,"call_back":"bad_link",)"
        R"("pose":{"x_cm":-120,"y_cm":7,"heading_deg":-179},"body":{"width_cm":20,"length_cm":18,)"
        R"("axle_offset_cm":-3,"tower_offset_cm":4,"sensor_out_cm":3,"deadline_ms":5000,)"
        R"("packed":true}})");
  RobotNow robot;
  robot.name = "A";
  robot.quality_per_mille = 500;
  CHECK(cli::fleet::to_json(robot).line() ==
        R"({"robot":"A","index":0,"address":"","state":"no link","linked":false,"confirmed":false,)"
        R"("idle":false,"held":false,"quality":null,"call_back":null,"pose":null,"body":null})");
}

TEST_CASE("robot now: what a name holds does not divide rows") {
  RobotNow robot = some_robot();
  robot.name = "a\tlinked=0\nidle";
  const std::string row = to_row(robot);
  CHECK(row.find('\n') == std::string::npos);
  const auto again = parse_row(row);
  REQUIRE(again);
  CHECK(again->name == "a_linked=0_idle");
  CHECK(again->linked);
}

TEST_CASE("robot now: what is no row") {
  for (const char* row : {"",
                          "index=0",
                          "name=A",
                          "index=0\tname",
                          "index=128\tname=A",
                          "index=-1\tname=A",
                          "index=0\tname=A\tlinked=2",
                          "index=0\tname=A\tlinked=",
                          "index=0\tname=A\tupdate=1,2,3",
                          "index=0\tname=A\tupdate=0,0,0,0,0,0,0,0,0",
                          "index=0\tname=A\tupdate=0,0,361,0,0,0,0,0",
                          "index=0\tname=A\tupdate=0,0,0,0,0,0,0,256",
                          "index=0\tname=A\tquality=-1",
                          "index=0\tname=A\tquality=1001",
                          "index=0\tname=A\tprogress=Said",
                          "index=0\tname=A\tprogress=",
                          "index=0\tname=A\toff_cm=nan",
                          "index=0\tname=A\toff_cm=inf",
                          "index=0\tname=A\tupdated=",
                          "index=0\tname=A\tupdated=1.5",
                          "index=0\tname=A\theard=9223372036854775808",
                          "index=0\tname=A\tlast=unknown_kind",
                          "index=0\tname=A\torder=-1",
                          "index=0\tname=A\tcalibration=0,9,0,0,0,0,0",
                          "index=0\tname=A\torigin=1,2",
                          "index=0\tname=A\torigin=1,2,3,4",
                          "index=0\tname=A\torigin=1,2,inf",
                          "index=0 name=A"}) {
    CAPTURE(row);
    CHECK_FALSE(parse_row(row));
  }
  // An older program says less: of all else nothing is known.
  const auto older = parse_row("index=5\tname=A");
  REQUIRE(older);
  CHECK(to_row(*older) ==
        "index=5\taddress=\tname=A\tlinked=0\tconfirmed=0\tidle=0\tlocated=0\tpaused=0\tlost=0\theld=0"
        "\tupdated=0\theard=0\tlast=none\tadvice=stay\tquality=0\tpieces=0\ttorn=0\tprogress=none\tsaid=0"
        "\tstanding=0\tblocked=0\toff_cm=0\toff_deg=0\tcompass=none\tasked=0"
        "\tcalibration=0,0,0,0,0,0,0\torder=0\tby=\torigin=0,0,0\torigin_known=0");
  // A newer program says more.
  const auto newer = parse_row("name=A\tindex=5\tcolour=blue");
  REQUIRE(newer);
  CHECK(newer->index == 5);
}

TEST_CASE("robot now: its state in a word") {
  RobotNow robot;
  CHECK(state_of(robot) == "no link");
  robot.linked = true;
  CHECK(state_of(robot) == "connected");
  robot.confirmed = robot.idle = true;
  CHECK(state_of(robot) == "paused");
  robot.update.emplace();
  CHECK(state_of(robot) == "idle");
  robot.idle = false;
  CHECK(state_of(robot) == "moving");
  robot.held = true;
  CHECK(state_of(robot) == "held");
  robot.lost = true;
  CHECK(state_of(robot) == "silent");
}

TEST_CASE("robot now: what it has said of its compass, and how often it was asked") {
  cognitive::Fleet fleet;
  const base::Time now{1s};
  fleet.linked(0, "A", now);
  CHECK(fleet.calibrate(0, now, true));
  const mapper::server::Peer peer{0, "C0", "A", true};
  const RobotNow before = cli::fleet::robot_now(fleet, peer);
  CHECK(before.compass == Calibrator::Phase::asking);
  CHECK(before.compass_asked == 1);
  CHECK(before.calibration == mapper::link::Calibration{});
  fleet.feed("[0]:A:{C,7,2,41,-57,152,1,2}\n", now);
  const RobotNow after = cli::fleet::robot_now(fleet, peer);
  CHECK(after.compass == Calibrator::Phase::done);
  CHECK(after.calibration == mapper::link::Calibration{7, 2, 41, -57, 152, 1, 2});
}

TEST_CASE("robot now: pieces are torn sentences, and what is left over of others") {
  cognitive::Fleet fleet;
  const base::Time now{1s};
  fleet.linked(0, "A", now);
  fleet.feed("[0]:A:{U,1,2}\n[0]:A:3,4,5}\n", now);
  const RobotNow robot = cli::fleet::robot_now(fleet, {0, "C0", "A", true});
  const auto& text = fleet.ear(0).text();
  CHECK(text.faults().total() > 0);
  CHECK(text.stray() > 0);
  CHECK(robot.torn == text.faults().total());
  CHECK(robot.pieces == text.faults().total() + text.stray());
}

TEST_CASE("robot now: packed updates that never came are pieces, and tear no sentence") {
  cognitive::Fleet fleet;
  const base::Time now{1s};
  fleet.linked(0, "A", now);
  for (const std::uint8_t sequence : {std::uint8_t{0}, std::uint8_t{5}}) {
    const mapper::link::Packet packet = *mapper::link::pack({sequence, {}});
    std::string said = "[0]:A:";
    for (const std::uint8_t byte : packet.bytes()) said += static_cast<char>(byte);
    fleet.feed(said, now);
  }
  const auto& ear = fleet.ear(0);
  CHECK(ear.packed().faults().total() == 4);
  const RobotNow robot = cli::fleet::robot_now(fleet, {0, "C0", "A", true});
  CHECK(robot.torn == 0);
  CHECK(robot.pieces == ear.text().stray() + 4);
}

}  // namespace fleet_robot_now_test
