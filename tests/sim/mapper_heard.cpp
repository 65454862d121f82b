// Words to a mapper over a radio that loses up to 60 % of its packets, in virtual time: the robot's own
// application, dongle, radio, central and server. No stop is lost, no success is false, no obstacle is blamed
// that is not there, and a robot whose server falls silent stands within the bound of
// docs/decisions/0026.
#include <chrono>
#include <cmath>
#include <cstdint>

#include <catch2/catch.hpp>

#include "ocm/cognitive/server.hpp"

#include "sim/mapper/fleet.hpp"
#include "unit/base/explore.hpp"
#include "unit/base/random.hpp"

namespace sim_mapper_heard_test {

using namespace std::chrono_literals;
namespace cognitive = ocm::cognitive;
namespace sim = ocm::sim::mapper;
using ocm::base::Duration;
using ocm::base::Time;
using ocm::mapper::link::SetPoint;
using ocm::mapper::server::Progress;
using ocm::sim::Vector;
using ocm::test::explored;
using ocm::test::Random;

/// A hall without anything in it.
sim::WorldModel hall(sim::RobotKind kind, double side_m = 40) {
  sim::WorldModel model;
  model.name = "hall";
  model.walls = {{{-side_m, -side_m}, {side_m, -side_m}},
                 {{side_m, -side_m}, {side_m, side_m}},
                 {{side_m, side_m}, {-side_m, side_m}},
                 {{-side_m, side_m}, {-side_m, -side_m}}};
  model.central = {{0, 0}, 100, 0.5};
  model.starts = {{"it", kind, {0, 0, 0}}};
  return model;
}

struct Air {
  sim::World world;
  sim::Fleet robots;
  cognitive::Server server;
  Time now{};
  bool hangs = false;  ///< the server

  Air(const sim::WorldModel& model, std::uint64_t seed, double loss, bool packed, bool repeats = false)
      : world(model, {.seed = seed}),
        robots(world, options(world, seed, loss, repeats)),
        server(fleet(packed)) {}

  static sim::FleetOptions options(const sim::World& world, std::uint64_t seed, double loss, bool repeats) {
    auto options = sim::Fleet::options_for(world, seed);
    options.radio.loss_everywhere = loss;
    options.radio.repeats = repeats;
    return options;
  }
  static cognitive::FleetOptions fleet(bool packed) {
    cognitive::FleetOptions options;
    options.packed = packed;
    options.deadline = 1h;
    return options;
  }

  void advance(Duration time) {
    for (const Time end = now + time; now < end;) {
      now += 10ms;
      robots.advance_to(now);
      if (hangs) continue;
      server.feed(robots.read(), now);
      server.expire(now);
      robots.write(server.take());
      while (server.next_event()) {
      }
    }
  }
  template <class Done>
  bool until(Duration most, Done done) {
    for (const Time end = now + most; now < end && !done();) advance(50ms);
    return done();
  }
  /// A link, and a robot that is heard.
  bool begin() {
    server.client().scan(2s);
    const auto& peers = server.client().peers();
    if (!until(20s, [&] { return !peers.empty(); })) return false;
    return until(120s, [this] {
      if (!robot().linked && server.client().idle()) server.client().connect(0);
      return robot().confirmed && robot().update;
    });
  }
  const cognitive::Robot& robot() const { return server.fleet().robot(0); }
  Progress progress() const { return server.fleet().sender(0).progress(); }
  ocm::sim::Pose truth() const { return world.robot(0).pose(); }
  bool drives() { return robots.robot(0).application().busy(); }
  std::uint32_t heard() { return robots.robot(0).application().counters().set_points; }
};

double degrees(double radians) {
  return radians * 180 / ocm::sim::pi;
}

TEST_CASE(
    "mapper heard: 1000 random runs at 0 to 60 % loss: no stop is lost, no success false, no obstacle "
    "blamed") {
  const int runs = explored(1000);
  int reached = 0, stopped = 0, still_drive = 0;
  for (int run = 0; run < runs; ++run) {
    CAPTURE(run);
    Random random{static_cast<std::uint64_t>(run) + 1};
    const double loss = random.within(0, 600) / 1000.0;
    const bool packed = random.below(2) == 0, repeats = random.below(4) == 0;
    const auto kind = random.below(2) == 0 ? sim::RobotKind::avr : sim::RobotKind::arduino;
    CAPTURE(loss, packed, repeats);
    Air air{hall(kind), static_cast<std::uint64_t>(run) + 1, loss, packed, repeats};
    REQUIRE(air.begin());
    const auto angle = static_cast<std::int16_t>(random.within(-180, 180));
    auto distance = static_cast<std::int16_t>(random.below(4) == 0 ? 0 : random.within(-30, 90));
    if (angle == 0 && distance == 0) distance = 10;  // which would be a stop
    CAPTURE(angle, distance);
    const auto start = air.truth();
    REQUIRE(air.server.fleet().go(0, {angle, distance}, air.now));
    const bool interrupted = random.below(2) == 0;
    if (interrupted) {
      air.advance(std::chrono::milliseconds{random.within(0, 9000)});
      REQUIRE(air.server.fleet().stop(0, air.now));
      air.advance(3s);
      still_drive += air.drives() ? 1 : 0;
      const bool proved = air.until(60s, [&] { return air.progress() == Progress::stopped; });
      CHECK(proved);
      if (!proved) continue;
      // Proved is true, and stays so.
      const auto there = air.truth();
      CHECK_FALSE(air.drives());
      air.advance(3s);
      CHECK_FALSE(air.drives());
      CHECK(std::hypot(air.truth().x_m - there.x_m, air.truth().y_m - there.y_m) < 0.03);
      ++stopped;
      continue;
    }
    const bool ended = air.until(180s, [&] { return is_final(air.progress()); });
    CHECK(ended);
    if (!ended) continue;
    CHECK_FALSE(air.server.fleet().sender(0).blocked());
    CHECK(air.progress() == Progress::reached);
    ++reached;
    CHECK_FALSE(air.drives());
    // What is nearer than its own tolerance, it need not be sent.
    if (std::abs(angle) > 2 || std::abs(distance) > 1) CHECK(air.heard() > 0);
    // Where it truly is: its own estimate drifts by a few per cent.
    const double heading = start.heading_rad + angle * ocm::sim::pi / 180;
    const double x = start.x_m + distance / 100.0 * std::cos(heading),
                 y = start.y_m + distance / 100.0 * std::sin(heading);
    CHECK(std::hypot(air.truth().x_m - x, air.truth().y_m - y) < 0.20);
    if (distance == 0)
      CHECK(std::abs(degrees(std::remainder(air.truth().heading_rad - heading, 2 * ocm::sim::pi))) < 20);
  }
  CHECK(reached + stopped == runs);
  CHECK(still_drive <= runs / 100);  // three seconds after the stop: some nine words, each lost by itself
}

TEST_CASE(
    "mapper heard: a wall in front of the robot is reported, and distinguished from what was not heard") {
  const int runs = explored(40);
  for (int run = 0; run < runs; ++run) {
    CAPTURE(run);
    Random random{static_cast<std::uint64_t>(run) + 1};
    // Between the tower's looks ahead it drives on: from half a metre it sees the wall in time.
    Air air{hall(sim::RobotKind::avr, 0.8), static_cast<std::uint64_t>(run) + 1,
            random.within(0, 600) / 1000.0, true};
    REQUIRE(air.begin());
    REQUIRE(air.server.fleet().go(0, {static_cast<std::int16_t>(90 * random.within(-1, 2)), 200}, air.now));
    REQUIRE(air.until(600s, [&] { return is_final(air.progress()); }));
    CHECK(air.progress() == Progress::ended);
    CHECK(air.server.fleet().sender(0).blocked());
    CHECK(air.heard() > 0);
  }
}

// docs/decisions/0026: a turn of up to 180 degrees and longest_leg_cm.
TEST_CASE("mapper heard: a robot whose server hangs, whenever that is, stands within 20 s and a leg") {
  const int runs = explored(100);
  double longest_s = 0, farthest_m = 0;
  for (int run = 0; run < runs; ++run) {
    CAPTURE(run);
    Random random{static_cast<std::uint64_t>(run) + 1};
    const auto kind = random.below(2) == 0 ? sim::RobotKind::avr : sim::RobotKind::arduino;
    Air air{hall(kind), static_cast<std::uint64_t>(run) + 1, random.within(0, 600) / 1000.0,
            random.below(2) == 0};
    REQUIRE(air.begin());
    REQUIRE(air.server.fleet().go(0, {static_cast<std::int16_t>(random.within(-180, 180)), 3000}, air.now));
    air.advance(std::chrono::milliseconds{random.within(0, 60'000)});
    air.hangs = true;
    const auto there = air.truth();
    const Time since = air.now;
    air.advance(200ms);  // what is in the air is heard
    (void)air.until(60s, [&] { return !air.drives(); });
    longest_s = std::max(longest_s, static_cast<double>((air.now - since).count()) / 1e9);
    farthest_m = std::max(farthest_m, std::hypot(air.truth().x_m - there.x_m, air.truth().y_m - there.y_m));
    air.advance(5s);
    CHECK_FALSE(air.drives());
  }
  CHECK(longest_s < 20);
  CHECK(farthest_m < 0.70);
}

}  // namespace sim_mapper_heard_test
