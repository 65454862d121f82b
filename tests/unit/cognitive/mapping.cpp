#include "ocm/cognitive/mapping.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/cognitive/agreement.hpp"
#include "ocm/mapper/link/sentence_reader.hpp"

#include "unit/base/random.hpp"
#include "unit/cognitive/testing/room.hpp"

namespace cognitive_mapping_test {

using namespace std::chrono_literals;
using namespace ocm::cognitive;
using ocm::base::Time;
using ocm::mapper::link::Kind;
using ocm::test::PerfectRobot;
using ocm::test::Random;
using ocm::test::Room;

/// Perfect robots in a room, a fleet that hears them, and what is made of it.
struct Expedition {
  Room room;
  std::vector<PerfectRobot> robots;
  Fleet fleet;
  Mapping mapping;
  Time now{1s};
  float nearest_m = 1e9F;  ///< two robots were to each other

  Expedition(Room there, std::vector<PerfectRobot> who, const FleetOptions& fleet_options = {},
             const MappingOptions& options = {})
      : room(std::move(there)), robots(std::move(who)), fleet(fleet_options), mapping(fleet, options) {
    for (std::size_t i = 0; i < robots.size(); ++i) {
      fleet.linked(i, "R", now);
      fleet.set_origin(i, robots[i].start());
    }
  }
  void say(std::size_t i, std::string_view words) {
    fleet.feed("[" + std::to_string(i) + "]:R:" + std::string{words}, now,
               [this](std::size_t robot, Kind kind) { mapping.heard(robot, kind); });
  }
  void step() {
    now += 200ms;
    for (std::size_t i = 0; i < robots.size(); ++i) {
      robots[i].step(room, robots);
      say(i, ocm::mapper::link::write(robots[i].update(room, robots))->view());
      if (robots[i].idle()) say(i, "{S,IDL}\n");
      for (std::size_t k = 0; k < i; ++k)
        nearest_m = std::min(nearest_m, distance_m(place(robots[i].pose()), place(robots[k].pose())));
    }
    mapping.step(now);
    while (const auto saying = fleet.take()) {
      fleet.out(saying->robot, now);
      ocm::mapper::link::Reader reader{ocm::mapper::link::Direction::to_robot};
      for (const char c : saying->words)
        if (reader.feed(c) == Kind::set_point)
          robots[saying->robot].go(*reader.sentence().as<ocm::mapper::link::SetPoint>());
    }
  }
  /// Seconds until nothing was left to do; `most` when it did not end.
  double run(double most = 1800) {
    int steps = 0;
    while (!mapping.done() && 0.2 * steps < most) step(), ++steps;
    return 0.2 * steps;
  }
  Agreement result() const {
    std::vector<ocm::motion::Point> inside;
    for (const PerfectRobot& robot : robots) inside.push_back(place(robot.start()));
    return agreement(mapping.map(), room.walls, inside);
  }
};

/// 4.38 m2 with two walls inside, as thesis 2 built one.
Room labyrinth() {
  Room room{ocm::test::rectangle(0, 0, 2.4F, 1.83F)};
  room.walls.push_back({{0.8F, 0.0F}, {0.8F, 1.1F}});
  room.walls.push_back({{1.6F, 1.83F}, {1.6F, 0.7F}});
  room.walls.push_back({{1.6F, 0.7F}, {2.0F, 0.7F}});
  return room;
}

TEST_CASE("mapping: one robot draws a labyrinth, and ends") {
  Expedition expedition{labyrinth(), {PerfectRobot{{0.4F, 0.4F, 0.0F}}}};
  CHECK(expedition.run() < 600);
  const Agreement result = expedition.result();
  CHECK(result.precision > 0.98);
  CHECK(result.recall > 0.97);
  CHECK(result.explored > 0.98);
  CHECK(expedition.robots[0].bumps() == 0);
  CHECK(expedition.mapping.counters().orders > 0);
  CHECK(expedition.mapping.counters().orders == expedition.mapping.explorer().counters().pieces);
}

TEST_CASE("mapping: two robots draw one map, in less time, and keep apart") {
  Expedition alone{labyrinth(), {PerfectRobot{{0.4F, 0.4F, 0.0F}}}};
  Expedition both{labyrinth(), {PerfectRobot{{0.4F, 0.4F, 0.0F}}, PerfectRobot{{2.0F, 1.4F, 3.0F}}}};
  const double one = alone.run(), two = both.run();
  CHECK(two < 0.75 * one);
  const Agreement result = both.result();
  CHECK(result.precision > 0.98);
  CHECK(result.recall > 0.97);
  CHECK(result.explored > 0.98);
  CHECK(both.nearest_m > 0.25F);
  CHECK(both.robots[0].bumps() + both.robots[1].bumps() == 0);
}

TEST_CASE("mapping: random rooms are explored, whatever stands in them") {
  Random random{11};
  const auto metres = [&](int low_cm, int high_cm) {
    return static_cast<float>(random.within(low_cm, high_cm)) / 100;
  };
  for (int run = 0; run < 8; ++run) {
    CAPTURE(run);
    const float x = metres(120, 260), y = metres(120, 260);
    Room room{ocm::test::rectangle(0, 0, x, y)};
    const ocm::motion::Pose start{metres(25, 60), metres(25, 60), metres(-314, 314)};
    for (int i = 0; i < 3; ++i) {
      const ocm::cognitive::Wall wall{{metres(0, 260), metres(0, 260)}, {metres(0, 260), metres(0, 260)}};
      if (distance_m(wall, place(start)) > 0.35F) room.walls.push_back(wall);
    }
    Expedition expedition{room, {PerfectRobot{start}}};
    REQUIRE(expedition.run(1800) < 1800);
    CHECK(expedition.result().precision > 0.97);
    // The end of a wall without thickness is not seen from ahead: it may be met, but not for ever.
    CHECK(expedition.robots[0].bumps() <= 6);
  }
}

TEST_CASE("mapping: what is seen while the robot turns is not drawn") {
  Expedition expedition{labyrinth(), {PerfectRobot{{0.4F, 0.4F, 0.0F}}}};
  expedition.say(0, "{U,0,0,0,0,30,0,0,0}\n");
  CHECK(expedition.mapping.counters().drawn == 1);
  expedition.say(0, "{U,0,0,10,0,30,0,0,0}\n");
  CHECK(expedition.mapping.counters().turning == 1);
  expedition.say(0, "{U,0,0,12,0,30,0,0,0}\n");
  CHECK(expedition.mapping.counters().drawn == 2);
  // Across 180 degrees it is a small turn, too.
  expedition.say(0, "{U,0,0,178,0,30,0,0,0}\n");
  expedition.say(0, "{U,0,0,-179,0,30,0,0,0}\n");
  CHECK(expedition.mapping.counters().drawn == 3);
}

TEST_CASE("mapping: as it is delivered, up to six degrees between two updates are drawn") {
  Expedition expedition{labyrinth(), {PerfectRobot{{0.4F, 0.4F, 0.0F}}}};
  for (const char* const heading : {"0", "6", "13"})
    expedition.say(0, "{U,0,0," + std::string{heading} + ",0,30,0,0,0}\n");
  CHECK(expedition.mapping.counters().drawn == 2);
  CHECK(expedition.mapping.counters().turning == 1);
}

TEST_CASE("mapping: without robots it is not done, and neither is a robot that was not asked") {
  Fleet fleet;
  Mapping mapping{fleet};
  mapping.step(Time{1s});
  CHECK_FALSE(mapping.done());
  fleet.feed("[0]:R:{U,0,0,0,0,0,0,0,0}\n", Time{1s},
             [&](std::size_t robot, Kind kind) { mapping.heard(robot, kind); });
  CHECK_FALSE(mapping.done());
  mapping.heard(Fleet::most_robots, Kind::update);
  CHECK(mapping.path(0).size() == 1);
}

TEST_CASE("mapping: at the end of a piece a robot is sent on at once") {
  MappingOptions options;
  options.explorer.longest_m = 0.08F;  // two steps
  Expedition expedition{labyrinth(), {PerfectRobot{{0.4F, 0.4F, 0.0F}}}, {}, options};
  int since = 1000, least = 1000;  // steps from one order to the next
  for (int i = 0; i < 3000 && least > 4; ++i) {
    const auto before = expedition.mapping.counters().orders;
    expedition.step();
    ++since;
    if (expedition.mapping.counters().orders == before) continue;
    least = std::min(least, since);
    since = 0;
  }
  CHECK(least <= 4);
}

TEST_CASE("mapping: where the map does not show yet what a robot sees, it is not asked") {
  Fleet fleet;
  Mapping mapping{fleet};
  fleet.feed("[0]:R:{S,IDL}\n{U,0,0,0,0,0,0,0,0}\n", Time{1s});  // heard by the fleet alone
  REQUIRE(fleet.robot(0).located);
  mapping.step(Time{1s});
  CHECK(mapping.path(0).empty());
  CHECK_FALSE(mapping.done());
  mapping.heard(0, Kind::update);
  mapping.step(Time{1s});
  CHECK(mapping.path(0).size() == 1);
  CHECK((mapping.done() || mapping.explorer().goal(0)));
}

TEST_CASE("mapping: where a robot sees another one is no wall, and what it sees beside itself is one") {
  Expedition expedition{Room{}, {PerfectRobot{{0, 0, 0}}, PerfectRobot{{0.5F, 0, 0}}}};
  expedition.say(1, "{U,0,0,0,0,0,0,0,0}\n");
  expedition.say(0, "{U,0,0,0,0,40,15,0,0}\n");
  CHECK(expedition.mapping.map().counters().on_robots == 1);
  CHECK(expedition.mapping.map().counters().hits == 1);
}

TEST_CASE("mapping: a robot that has nothing to do is asked again after a second") {
  Expedition expedition{Room{ocm::test::rectangle(0, 0, 1, 1)}, {PerfectRobot{{0.5F, 0.5F, 0.0F}}}};
  REQUIRE(expedition.run(300) < 300);
  expedition.mapping.hold(0, true);
  expedition.mapping.hold(0, false);
  for (int i = 0; i < 4; ++i) {
    expedition.step();
    CHECK_FALSE(expedition.mapping.done());
  }
  expedition.step();
  CHECK(expedition.mapping.done());
}

TEST_CASE("mapping: a robot that looks is asked when its look ends, be that before a second is over") {
  MappingOptions options;
  options.explorer.view_m = 1.0F;  // all of the border is seen from where it stands
  options.explorer.look = 400ms;
  Expedition expedition{Room{}, {PerfectRobot{{0, 0, 0}}}, {}, options};
  for (int times = 0; times < 4; ++times)
    for (int servo = 0; servo <= 90; servo += 2)
      expedition.say(0, "{U,0,0,0," + std::to_string(servo) + ",0,0,0,0}\n");
  const auto& explorer = expedition.mapping.explorer();
  expedition.say(0, "{S,IDL}\n");
  expedition.mapping.step(expedition.now);
  CHECK(explorer.counters() == ExplorerCounters{});  // where it stands, the next update says
  expedition.say(0, "{U,0,0,0,0,0,0,0,0}\n");
  expedition.mapping.step(expedition.now);
  CHECK(explorer.counters() == ExplorerCounters{.goals = 1});
  expedition.now += 399ms;
  expedition.mapping.step(expedition.now);
  CHECK(explorer.counters().reached == 0);
  expedition.now += 1ms;
  expedition.mapping.step(expedition.now);
  CHECK(explorer.counters().reached == 1);
}

TEST_CASE("mapping: a robot far from the central is called back at once, and does not go there again") {
  FleetOptions options;
  options.range_m = 2.0F;  // from 1.8 m on
  options.central = {0.3F, 0.3F};
  MappingOptions mapping;
  mapping.explorer.home = options.central;
  Expedition expedition{
      Room{ocm::test::rectangle(0, 0, 4.0F, 0.6F)}, {PerfectRobot{{0.3F, 0.3F, 0.0F}}}, options, mapping};
  float farthest = 0.0F;
  for (int i = 0; i < 6000 && !expedition.mapping.done(); ++i) {
    expedition.step();
    farthest = std::max(farthest, expedition.robots[0].pose().x_m);
  }
  CHECK(expedition.mapping.done());
  CHECK(expedition.mapping.explorer().counters().calls >= 1);
  CHECK(expedition.fleet.counters().calls >= 1);
  CHECK(farthest < 2.3F);
  CHECK(expedition.mapping.explorer().range_m() < 2.0F);
}

TEST_CASE("mapping: who is called back does not finish its piece first") {
  FleetOptions options;
  options.range_m = 1.0F;
  Expedition expedition{Room{ocm::test::rectangle(-1, -1, 4, 1)}, {PerfectRobot{{0, 0, 0}}}, options};
  for (int cm = 0; cm <= 80; cm += 4)  // drives, without a word of being idle
    for (int servo = 0; servo <= 90; servo += 2)
      expedition.say(0, "{U," + std::to_string(cm) + ",0,0," + std::to_string(servo) + ",0,0,0,0}\n");
  expedition.mapping.step(expedition.now);
  CHECK_FALSE(expedition.fleet.take());
  expedition.say(0, "{U,95,0,0,0,0,0,0,0}\n");
  expedition.mapping.step(expedition.now);
  const auto saying = expedition.fleet.take();
  REQUIRE(saying);
  CHECK(saying->words.starts_with("{U,"));
  expedition.mapping.step(expedition.now);
  CHECK_FALSE(expedition.fleet.take());  // once
}

TEST_CASE("mapping: to a robot that is lost nothing is said; when it is back it is called back at once") {
  FleetOptions options;
  options.range_m = 1.0F;
  Expedition expedition{Room{ocm::test::rectangle(-1, -1, 4, 1)}, {PerfectRobot{{0, 0, 0}}}, options};
  expedition.say(0, "{U,95,0,0,0,0,0,0,0}\n");  // drives, too far away
  expedition.fleet.unlinked(0);
  expedition.mapping.step(expedition.now);
  CHECK_FALSE(expedition.fleet.take());
  expedition.say(0, "{U,95,0,0,0,0,0,0,0}\n");
  expedition.mapping.step(expedition.now);
  const auto saying = expedition.fleet.take();
  REQUIRE(saying);
  CHECK(saying->words == "{U,0,0}\n");
}

TEST_CASE("mapping: to a robot that is silent for too long nothing is said, though its link is there") {
  FleetOptions options;
  options.range_m = 1.0F;
  Expedition expedition{Room{ocm::test::rectangle(-1, -1, 4, 1)}, {PerfectRobot{{0, 0, 0}}}, options};
  expedition.say(0, "{U,95,0,0,0,0,0,0,0}\n");  // drives, too far away
  expedition.now += 6s;
  expedition.fleet.expire(expedition.now);
  REQUIRE(expedition.fleet.robot(0).lost);
  REQUIRE(expedition.fleet.robot(0).linked);
  expedition.mapping.step(expedition.now);
  CHECK_FALSE(expedition.fleet.take());
}

TEST_CASE("mapping: a handshake that answers another program's question changes nothing") {
  Expedition expedition{labyrinth(), {PerfectRobot{{0.4F, 0.4F, 0.0F}}}};
  const std::string handshake = "{H,15,20,-4,6,0,90,180,270,2000,0}\n";
  expedition.say(0, handshake);
  for (int i = 0; i < 200 && !expedition.mapping.explorer().goal(0); ++i) expedition.step();
  REQUIRE(expedition.mapping.explorer().goal(0));
  REQUIRE(expedition.fleet.ask_who(0, expedition.now));
  expedition.say(0, handshake);
  CHECK(expedition.mapping.explorer().goal(0));
  expedition.now += 10s;
  expedition.say(0, handshake);  // unasked: it has begun again
  CHECK_FALSE(expedition.mapping.explorer().goal(0));
}

TEST_CASE("mapping: a robot that is held is left alone, and the others go on") {
  Expedition expedition{labyrinth(), {PerfectRobot{{0.4F, 0.4F, 0.0F}}, PerfectRobot{{2.0F, 1.4F, 3.0F}}}};
  for (int i = 0; i < 50; ++i) expedition.step();
  expedition.mapping.hold(1, true);
  CHECK_FALSE(expedition.mapping.explorer().goal(1));
  for (int i = 0; i < 50 && !expedition.robots[1].idle(); ++i) expedition.step();  // its last piece ends
  const auto stood = expedition.robots[1].pose();
  const auto drawn = expedition.mapping.counters().drawn;
  for (int i = 0; i < 9000; ++i) expedition.step();
  CHECK(distance_m(place(expedition.robots[1].pose()), place(stood)) < 0.001F);
  CHECK(expedition.mapping.counters().drawn > drawn);
  CHECK(expedition.result().explored > 0.8);  // by the other
  CHECK_FALSE(expedition.mapping.done());     // it may have something left to do
  expedition.mapping.hold(1, false);
  expedition.mapping.hold(Fleet::most_robots, true);  // there is no such robot
  CHECK(expedition.run() < 1800);
  CHECK(expedition.result().explored > 0.97);
}

TEST_CASE("mapping: robots that do not take part are neither drawn nor sent") {
  MappingOptions options;
  options.robots = {0};
  Expedition expedition{
      labyrinth(), {PerfectRobot{{0.4F, 0.4F, 0.0F}}, PerfectRobot{{2.0F, 1.4F, 3.0F}}}, {}, options};
  CHECK(expedition.run() < 1800);
  CHECK(expedition.mapping.path(1).empty());
  CHECK(distance_m(place(expedition.robots[1].pose()), {2.0F, 1.4F}) < 0.001F);
  CHECK(expedition.mapping.path(0).size() > 10);
}

TEST_CASE("mapping: a robot that is lost keeps no other waiting, and goes on when it is back") {
  Expedition expedition{labyrinth(), {PerfectRobot{{0.4F, 0.4F, 0.0F}}, PerfectRobot{{2.0F, 1.4F, 3.0F}}}};
  for (int i = 0; i < 50; ++i) expedition.step();
  expedition.fleet.unlinked(1);
  expedition.mapping.step(expedition.now);
  CHECK_FALSE(expedition.mapping.explorer().goal(1));
  for (int i = 0; i < 50; ++i) expedition.step();  // it speaks again
  CHECK_FALSE(expedition.fleet.robot(1).lost);
  CHECK(expedition.run() < 1800);
  CHECK(expedition.result().explored > 0.97);
}

TEST_CASE("mapping: a robot that waits for another is asked again before all is done") {
  Expedition expedition{Room{ocm::test::rectangle(0, 0, 3.0F, 0.34F)},
                        {PerfectRobot{{0.3F, 0.17F, 0.0F}}, PerfectRobot{{0.8F, 0.17F, 0.0F}}}};
  const auto& explorer = expedition.mapping.explorer();
  for (int i = 0; i < 300 && explorer.counters().blocked == 0; ++i) expedition.step();
  REQUIRE(explorer.counters().blocked > 0);  // the first one waits
  expedition.fleet.unlinked(1);
  expedition.mapping.step(expedition.now);
  CHECK_FALSE(expedition.mapping.done());
  expedition.now += 1s;
  expedition.mapping.step(expedition.now);
  // It goes on, or has nothing left to do: it does not wait for one that is lost.
  CHECK((expedition.mapping.done() || expedition.mapping.explorer().goal(0)));
}

TEST_CASE("mapping: a robot that was called back and gets no better link is done after a while") {
  FleetOptions options;
  options.range_m = 1.0F;
  options.central = {5.0F, 0.0F};  // far from home, where it is: it cannot come nearer
  MappingOptions mapping;
  mapping.patience = 10s;
  Expedition expedition{
      Room{ocm::test::rectangle(-1, -1, 4, 1)}, {PerfectRobot{{0, 0, 0}}}, options, mapping};
  expedition.say(0, "{U,0,0,0,0,0,0,0,0}\n");
  expedition.say(0, "{S,IDL}\n");
  expedition.say(0, "{U,0,0,0,0,0,0,0,0}\n");
  expedition.mapping.step(expedition.now);
  CHECK_FALSE(expedition.mapping.done());
  expedition.now += 9999ms;
  expedition.mapping.step(expedition.now);
  CHECK_FALSE(expedition.mapping.done());
  expedition.now += 1ms;
  expedition.mapping.step(expedition.now);
  CHECK(expedition.mapping.done());
}

TEST_CASE("mapping: who was called back has two minutes, and again when it was held meanwhile") {
  FleetOptions options;
  options.range_m = 1.0F;
  options.central = {5.0F, 0.0F};
  Expedition expedition{Room{ocm::test::rectangle(-1, -1, 4, 1)}, {PerfectRobot{{0, 0, 0}}}, options};
  expedition.say(0, "{U,0,0,0,0,0,0,0,0}\n");
  expedition.say(0, "{S,IDL}\n");
  expedition.say(0, "{U,0,0,0,0,0,0,0,0}\n");
  expedition.mapping.step(expedition.now);
  CHECK_FALSE(expedition.mapping.done());
  expedition.now += 60s;
  expedition.mapping.hold(0, true);
  expedition.mapping.hold(0, false);
  expedition.mapping.step(expedition.now);
  expedition.now += 119900ms;
  expedition.mapping.step(expedition.now);
  CHECK_FALSE(expedition.mapping.done());
  expedition.now += 200ms;
  expedition.mapping.step(expedition.now);
  CHECK(expedition.mapping.done());
}

}  // namespace cognitive_mapping_test
