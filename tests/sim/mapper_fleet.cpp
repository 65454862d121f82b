/// The whole fleet in virtual time, spoken to as a server does: over the central's line.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/mapper/link/demultiplexer.hpp"

#include "sim/mapper/fleet.hpp"

namespace sim_mapper_fleet_test {

using namespace ocm;
using namespace std::chrono_literals;
namespace plant = ocm::sim::mapper;
using plant::Fleet;
using plant::FleetOptions;
using plant::RobotKind;
using plant::Start;
using plant::World;
using plant::WorldModel;
using sim::degree;
using sim::pi;
using sim::Pose;
using sim::Vector;

WorldModel room(std::vector<Start> starts, double half_m = 1.5) {
  WorldModel model;
  model.name = "room";
  const Vector corners[] = {{-half_m, -half_m}, {half_m, -half_m}, {half_m, half_m}, {-half_m, half_m}};
  for (std::size_t i = 0; i < 4; ++i) model.walls.push_back({corners[i], corners[(i + 1) % 4]});
  model.starts = std::move(starts);
  return model;
}
/// A server that writes down what it hears, by robot.
struct Server {
  explicit Server(WorldModel model, std::uint64_t seed = 1, double loss_everywhere = 0)
      : world(std::move(model), {.seed = seed}), fleet(world, options(world, seed, loss_everywhere)) {}

  static FleetOptions options(const World& world, std::uint64_t seed, double loss_everywhere) {
    FleetOptions options = Fleet::options_for(world, seed);
    options.radio.loss_everywhere = loss_everywhere;
    return options;
  }
  void run(base::Duration time) {
    for (const base::Time end = fleet.now() + time; fleet.now() < end;) {
      fleet.advance_to(std::min(end, fleet.now() + 50ms));
      hear(fleet.read());
    }
  }
  void hear(const std::string& text) {
    log += text;
    for (const char c : text) {
      const auto heard = ears.feed(static_cast<std::uint8_t>(c));
      if (heard.kind == mapper::link::Kind::none) continue;
      ++kinds[{heard.robot, heard.kind}];
      if (const auto update = ears.ear(heard.robot).sentence().as<mapper::link::Update>())
        last[heard.robot] = *update;
    }
  }
  /// Until it has come so many times, at most `limit`.
  bool wait_for(std::uint8_t robot, mapper::link::Kind kind, int times, base::Duration limit = 60s) {
    for (const base::Time end = fleet.now() + limit; fleet.now() < end; run(50ms))
      if (count(robot, kind) >= times) return true;
    return false;
  }
  int count(std::uint8_t robot, mapper::link::Kind kind) { return kinds[{robot, kind}]; }
  void type(std::string_view text) { fleet.write(text); }
  /// All robots found, connected and confirmed.
  void begin() {
    type("start\n");
    run(1s);
    type("stop\n");
    for (std::size_t i = 0; i < fleet.size(); ++i) {
      type("*conn " + std::to_string(i) + "\n");
      REQUIRE(wait_for(static_cast<std::uint8_t>(i), mapper::link::Kind::handshake, 1, 10s));
      type("{S,CON}\n");
    }
    run(1s);
  }

  World world;
  Fleet fleet;
  mapper::link::Demultiplexer<128> ears;
  std::map<std::pair<std::uint8_t, mapper::link::Kind>, int> kinds;
  std::map<std::uint8_t, mapper::link::Update> last;
  std::string log;
};

TEST_CASE("fleet: start, list, conn, confirm, a set point, updates and idle") {
  Server server{room({{"AVR", RobotKind::avr, {0, -0.5, 0}}})};
  server.type("start\n");
  server.run(2s);
  server.type("list\n");
  server.run(100ms);
  CHECK(server.log == "scanning\n0:C00000000000:AVR\nend of list\n");
  server.type("conn 0\n");
  REQUIRE(server.wait_for(0, mapper::link::Kind::handshake, 3, 10s));  // each second until it is confirmed
  CHECK(server.count(0, mapper::link::Kind::update) == 0);
  server.type("{S,CON}\n");
  REQUIRE(server.wait_for(0, mapper::link::Kind::update, 5, 3s));
  const int handshakes = server.count(0, mapper::link::Kind::handshake);
  server.type("{U,90,50}\n");
  const int idles = server.count(0, mapper::link::Kind::idle);
  REQUIRE(server.wait_for(0, mapper::link::Kind::idle, idles + 1));
  CHECK(server.count(0, mapper::link::Kind::handshake) == handshakes);
  // Half a metre to the left, and both know it.
  const Pose& pose = server.fleet.robot(0).pose();
  CHECK(std::abs(pose.x_m) < 0.1);
  CHECK(std::abs(pose.y_m) < 0.1);
  CHECK(std::abs(pose.heading_rad / degree - 90) < 10);
  server.run(1s);
  CHECK(std::abs(server.last[0].x) <= 10);
  CHECK(std::abs(server.last[0].y - 50) <= 10);
  CHECK(std::abs(server.last[0].heading - 90) <= 5);
  CHECK(server.ears.ear(0).quality().per_mille() == 1000);
  CHECK(server.fleet.radio().counters(0).to_central.lost == 0);
}

TEST_CASE("fleet: a calibration finds a robot's own field, and the earth's where there is a compass") {
  World world{room({{"one", RobotKind::avr, {}}, {"two", RobotKind::avr, {0.5, 0, 0}}})};
  plant::Robot& one = world.robot(0);
  plant::calibrate(one);
  REQUIRE(one.stored().ok());
  CHECK(one.stored()->offset == one.own_field());
  CHECK(one.stored()->field == Approx(0.14).margin(0.015));  // six times its noise
  const sensing::CompassFit kept{{0.1F, 0.2F}, 0.3F, 0.4F};
  one.store(kept);
  plant::calibrate(one);  // its memory keeps one
  CHECK(*one.stored() == kept);
  plant::Robot& two = world.robot(1);
  two.set_absent(plant::Part::compass, true);
  plant::calibrate(two);
  REQUIRE(two.stored().ok());
  CHECK(two.stored()->offset == two.own_field());
  CHECK(two.stored()->field == 0);
}

TEST_CASE("fleet: its radio is the world's, with a link for each robot") {
  WorldModel model = room({{"one", RobotKind::avr, {}},
                           {"two", RobotKind::avr, {0.5, 0, 0}},
                           {"three", RobotKind::avr, {1, 0, 0}}});
  model.central = {.place = {1, 2}, .range_m = 5, .loss_at_range = 0.25};
  const World world{model};
  const FleetOptions options = Fleet::options_for(world, 77);
  CHECK(options.radio.range_m == 5);
  CHECK(options.radio.loss_at_range == 0.25);
  CHECK(options.radio.links == 3);
  CHECK(options.radio.seed == 77);
  CHECK(options.calibrated);
}

TEST_CASE(
    "fleet: what is out of the dongle's range is not found, what drives there is lost, and robots out of it "
    "drive on") {
  WorldModel model = room({{"near", RobotKind::avr, {0, 0, 0}}, {"far", RobotKind::avr, {0, 4, 0}}}, 20);
  model.central = {.place = {-1, 0}, .range_m = 2, .loss_at_range = 0};
  Server server{model};
  server.type("start\n");
  server.run(3s);
  server.type("list\n");
  server.run(100ms);
  CHECK(server.log.find(":near\n") != std::string::npos);
  CHECK(server.log.find(":far\n") == std::string::npos);
  server.type("stop\nconn 0\n");
  REQUIRE(server.wait_for(0, mapper::link::Kind::handshake, 1, 10s));
  server.type("{S,CON}\n{U,0,200}\n");
  server.run(40s);
  CHECK(server.fleet.robot(0).pose().x_m > 1.2);  // beyond the range, 2 m from (-1, 0)
  CHECK(server.world.distance_to_central(0) > 2.2);
  const int updates = server.count(0, mapper::link::Kind::update);
  server.run(10s);
  CHECK(server.count(0, mapper::link::Kind::update) == updates);
}

TEST_CASE("fleet: time goes on to where it is asked for, and never back") {
  Server server{room({{"AVR", RobotKind::avr, {}}})};
  const base::Time begin = server.fleet.now();
  server.fleet.advance_to(begin + 1234567us);
  CHECK(server.fleet.now() == begin + 1234567us);
  CHECK(server.world.time() == begin + 1234ms);
  server.fleet.advance_to(begin + 1s);
  CHECK(server.fleet.now() == begin + 1234567us);
  CHECK(server.fleet.next_event() > server.fleet.now());
}

TEST_CASE("fleet: it says packed updates to a server that asks") {
  Server server{room({{"AVR", RobotKind::avr, {}}})};
  server.type("start\n");
  server.run(1s);
  server.type("conn 0\n");
  REQUIRE(server.wait_for(0, mapper::link::Kind::handshake, 1, 10s));
  server.type("{S,BIN}\n{S,CON}\n");
  server.run(5s);
  CHECK(server.ears.ear(0).packed().heard() > 15);
  CHECK(server.ears.ear(0).packed().faults().total() == 0);
}

TEST_CASE("fleet: two robots of different make, at once, each to its own place") {
  Server server{room({{"AVR", RobotKind::avr, {-0.7, 0, 0}}, {"Arduino", RobotKind::arduino, {0.7, 0, pi}}})};
  server.begin();
  server.type("*switch 0\n{U,90,40}\n*switch 1\n{U,90,40}\n");
  const int idles[] = {server.count(0, mapper::link::Kind::idle), server.count(1, mapper::link::Kind::idle)};
  REQUIRE(server.wait_for(0, mapper::link::Kind::idle, idles[0] + 1));
  REQUIRE(server.wait_for(1, mapper::link::Kind::idle, idles[1] + 1));
  server.run(20s);
  CHECK(std::abs(server.fleet.robot(0).pose().y_m - 0.4) < 0.1);
  CHECK(std::abs(server.fleet.robot(1).pose().y_m + 0.4) < 0.1);
  CHECK(server.log.find("[0]:AVR:{U,") != std::string::npos);
  CHECK(server.log.find("[1]:Arduino:{U,") != std::string::npos);
}

TEST_CASE("fleet: a robot that drives out of range stops there; back in range, nothing old is heard") {
  WorldModel model = room({{"AVR", RobotKind::avr, {}}}, 20);
  model.central.range_m = 1;
  std::uint64_t dropped = 0;  // whether a packet waits when the link dies is chance
  for (std::uint64_t seed = 1; seed <= 4 || (dropped == 0 && seed <= 64); ++seed) {
    CAPTURE(seed);
    Server server{model, seed};
    server.begin();
    server.type("{U,0,1000}\n");
    server.run(60s);
    CHECK(server.log.find("lost 0\n") != std::string::npos);
    const double stopped = server.fleet.robot(0).pose().x_m;
    CHECK(stopped > 1);     // it was lost beyond the range
    CHECK(stopped < 1.75);  // and stopped within the time-out: 4 s at most 0.1 m/s, and the way to roll out
    server.run(10s);
    CHECK(server.fleet.robot(0).pose().x_m - stopped < 0.001);
    CHECK(server.fleet.robot(0).application().state() == mapper::app::State::advertising);
    dropped += server.fleet.dongle(0).outbox().dropped + server.fleet.dongle(0).counters().dropped;
    CHECK(server.ears.ear(0).quality().per_mille() < 1000);
  }
  CHECK(dropped > 0);
}

TEST_CASE("fleet: in the very moment in which its link ends a robot knows, and its motors are off") {
  WorldModel model = room({{"AVR", RobotKind::avr, {}}}, 20);
  model.central.loss_at_range = 0;
  for (int i = 1; i <= 4; ++i) {  // wherever in the period of its communication that is
    CAPTURE(i);
    Server server{model, static_cast<std::uint64_t>(i)};
    server.begin();
    server.type("{U,0,1000}\n");
    server.run(3s + i * 13ms);
    CHECK(server.fleet.robot(0).application().busy());
    CHECK(server.fleet.robot(0).application().state() == mapper::app::State::confirmed);
    server.type("*drop 0\n");
    const base::Time end = server.fleet.now() + 10s;
    while (server.fleet.dongle(0).linked() && server.fleet.now() < end)
      server.fleet.advance_to(server.fleet.next_event());
    REQUIRE_FALSE(server.fleet.dongle(0).linked());
    CHECK(server.fleet.robot(0).application().state() == mapper::app::State::advertising);
    CHECK_FALSE(server.world.robot(0).left().powered());
    CHECK_FALSE(server.world.robot(0).right().powered());
  }
}

TEST_CASE("fleet: equal seeds give equal talks, other seeds others") {
  const auto talk = [](std::uint64_t seed) {
    Server server{
        room({{"AVR", RobotKind::avr, {-0.7, 0, 0}}, {"Arduino", RobotKind::arduino, {0.7, 0, pi}}}), seed,
        0.1};
    server.begin();
    server.type("*switch 0\n{U,45,40}\n");
    server.run(10s);
    return server.log;
  };
  const std::string first = talk(1);
  CHECK(first == talk(1));
  CHECK(first != talk(2));
}

TEST_CASE("fleet: how time is cut makes no difference") {
  const auto talk = [](base::Duration step) {
    World world{room({{"AVR", RobotKind::avr, {}}}), {.seed = 3}};
    Fleet fleet{world, Fleet::options_for(world, 3)};
    std::string log;
    const auto run = [&](base::Duration until) {
      while (fleet.now() < base::Time{until}) {
        fleet.advance_to(std::min(base::Time{until}, fleet.now() + step));
        log += fleet.read();
      }
    };
    fleet.write("start\n");
    run(1s);
    fleet.write("conn 0\n");
    run(6s);
    fleet.write("{S,CON}\n{U,-60,30}\n");
    run(15s);
    return log + std::to_string(fleet.robot(0).pose().x_m);
  };
  const std::string one = talk(20s);
  CHECK(one == talk(7ms));
  CHECK(one == talk(333us));
  CHECK(one.find("{U,") != std::string::npos);
}

TEST_CASE("fleet: a hundred robots, all with a link") {
  WorldModel model = room({{"AVR", RobotKind::avr, {}}}, 5);
  const auto starts = plant::starts_for(model, 100);
  REQUIRE(starts);
  model.starts = *starts;
  Server server{std::move(model)};
  server.type("start\n");
  server.run(1s);
  server.type("stop\n");
  for (std::size_t i = 0; i < 100; ++i) {
    server.type("*conn " + std::to_string(i) + "\n");
    server.run(200ms);
  }
  CHECK(server.fleet.central().links() == 100);
  server.run(2s);
  for (std::uint8_t i = 0; i < 100; ++i) CHECK(server.count(i, mapper::link::Kind::handshake) > 0);
}

TEST_CASE("fleet: of more than 128 robots the rest has no application") {
  WorldModel model = room({{"AVR", RobotKind::avr, {}}}, 5);
  const auto starts = plant::starts_for(model, 129);
  REQUIRE(starts);
  model.starts = *starts;
  World world{model, {.seed = 1}};
  const Fleet fleet{world, Fleet::options_for(world, 1)};
  CHECK(world.size() == 129);
  CHECK(fleet.size() == 128);
  CHECK(world.robot(127).stored().ok());  // their compasses are calibrated with them
  CHECK_FALSE(world.robot(128).stored().ok());
}

}  // namespace sim_mapper_fleet_test
