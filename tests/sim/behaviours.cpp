#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/protocol/message.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/boards/power_management/costs.hpp"
#include "sim/amiro/robot.hpp"
#include "unit/base/explore.hpp"
#include "unit/base/random.hpp"

namespace sim_behaviours_test {

using namespace ocm;
using namespace std::chrono_literals;
using ocm::test::Random;
using sim::pi;
using Active = amiro::Behaviour::Active;
using Ended = amiro::Behaviour::Ended;

// The way from an obstacle to the wheels' control in docs/behaviours.md, and the least periods of the ring
// there.
static_assert(firmware::boards::reaction.hops[0].responds == 14'126'000);
static_assert(firmware::boards::reaction.bound.age == 74'874'000);
constexpr base::Error ring_every(base::Duration period, scheduling::Level level) {
  using Board = amiro::PowerManagement;
  analysis::BoardAdmission<Board, amiro::bit_rate, firmware::boards::power_management::Costs> admission;
  return admission.admit(Board::sensors::index<amiro::ProximityRing>, period, level);
}
static_assert(ring_every(23'400us, scheduling::Level::medium) == base::Error::not_schedulable);
static_assert(ring_every(23'500us, scheduling::Level::medium) == base::Error::none);
static_assert(ring_every(14'800us, scheduling::Level::urgent) == base::Error::not_schedulable);
static_assert(ring_every(14'900us, scheduling::Level::urgent) == base::Error::none);

/// The three boards on a bus without length: what one sends the others hear at once.
struct Setup {
  struct Port {
    base::Result<bool> send(const can::Frame& frame) {
      if (room) sent.push_back(frame);
      return room;
    }
    bool room = true;
    std::vector<can::Frame> sent;
  };

  explicit Setup(sim::WorldOptions options) : robot(std::move(options), ports[0], ports[1], ports[2]) {}

  void say(const can::Frame& frame) {
    robot.receive(frame, now);
    robot.advance(now);
    carry();
  }
  template <class Topic>
  void command(const Topic& set_point) {
    say(protocol::command(set_point));
  }
  /// What is on the way from board to board.
  void carry() {
    for (Port& port : ports) {
      const std::vector<can::Frame> frames = std::exchange(port.sent, {});
      for (const can::Frame& frame : frames) {
        if (protocol::Identifier::decode(frame.id).direction == protocol::Direction::command) {
          ++commands;
          robot.receive(frame, now);
        } else if (frame.id % 256 == amiro::Behaviour::id.value) {
          report = amiro::Behaviour::decode(frame.data);
        }
      }
    }
    robot.advance(now);
  }
  /// Lets time pass; `look` sees the world at each event, and ends it with false.
  template <class Look>
  void pass(base::Duration time, Look look) {
    const base::Time end = now + time;
    while (robot.next_event() <= end) {
      now = std::max(now, robot.next_event());
      robot.advance(now);
      carry();
      if (!look()) return;
    }
    now = end;
    robot.advance(now);
    carry();
  }
  void pass(base::Duration time) {
    pass(time, [] { return true; });
  }
  [[nodiscard]] bool stands() const {
    return std::abs(world().wheels().left) < 1e-4 && std::abs(world().wheels().right) < 1e-4;
  }
  [[nodiscard]] const sim::World& world() const { return robot.world(); }

  std::array<Port, 3> ports;
  sim::SimulatedRobot<Port> robot;
  base::Time now{};
  amiro::Behaviour report{};
  int commands = 0;  ///< from board to board
};

const can::Frame publish_behaviour =
    protocol::encode({amiro::Behaviour::id, protocol::Mode::publish, *protocol::Period::from(20ms),
                      protocol::Priority::medium});

double within(Random& random, double low, double high) {
  return low + (high - low) * random.below(1'000'001) / 1e6;
}

amiro::Travel travel(double distance_m, double angle_rad, double speed_m_per_s) {
  amiro::Travel travel;
  travel.set_distance_m(distance_m);
  travel.set_angle_rad(angle_rad);
  travel.set_speed_m_per_s(speed_m_per_s);
  return travel;
}

/// A world without walls and without a line nearby.
sim::WorldOptions open_floor(std::uint64_t seed) {
  sim::WorldOptions options;
  options.seed = seed;
  options.arena.walls.clear();
  options.start = {0, 0, 0.3};
  return options;
}

TEST_CASE("travel ends within a millimetre and a half and a degree") {
  const int worlds = test::at_full_speed ? 1000 : test::explored(20, 5);
  double worst_m = 0;
  double worst_rad = 0;
  for (int i = 0; i < worlds; ++i) {
    CAPTURE(i);
    Random random{static_cast<std::uint64_t>(i)};
    Setup setup{open_floor(random())};
    setup.say(publish_behaviour);
    const double distance_m = within(random, -1, 1);
    const double angle_rad = i % 3 == 0 ? 0 : within(random, -7, 7);
    const double speed = within(random, 0.02, 0.3);
    setup.command(travel(distance_m, angle_rad, speed));
    setup.pass(20ms);
    REQUIRE(setup.report.active == Active::travel);
    setup.pass(600s, [&] { return setup.report.active == Active::travel; });
    CHECK(setup.report.ended == Ended::arrived);
    setup.pass(1s);
    const sim::Pose pose = setup.world().pose();
    const sim::Vector wanted = setup.world().options().start.place_of({distance_m, 0});
    const double off_m = sim::length(pose.position() - wanted);
    const double off_rad = std::abs(pose.heading_rad - 0.3 - angle_rad);
    CHECK(off_m < 0.0015);
    CHECK(off_rad < 1 * sim::degree);
    worst_m = std::max(worst_m, off_m);
    worst_rad = std::max(worst_rad, off_rad);
    CHECK(setup.stands());
  }
  INFO("worst: " << worst_m << " m, " << worst_rad << " rad");
  CHECK(worst_m > 1e-5);  // a robot that is exactly right knows the truth
}

TEST_CASE("a set point of the motors ends a travel, and so do its own zeros and a stop") {
  Setup setup{open_floor(1)};
  setup.say(publish_behaviour);
  const auto begin = [&] {
    setup.command(travel(1, 0, 0.1));
    setup.pass(1s);
    REQUIRE(setup.report.active == Active::travel);
    REQUIRE(setup.world().wheels().left > 0.09);
  };
  begin();
  CHECK(setup.report.ended == Ended::nothing);
  CHECK(std::abs(setup.report.distance_m() - 0.91) < 0.02);

  setup.command(amiro::Motors{});
  setup.pass(500ms);
  CHECK(setup.report.active == Active::none);
  CHECK(setup.report.ended == Ended::stopped);
  CHECK(setup.stands());

  begin();
  amiro::Motors motors;
  motors.set_z_rad_per_s(1);
  setup.command(motors);
  setup.pass(400ms);
  CHECK(setup.report.ended == Ended::replaced);
  CHECK(setup.world().wheels().left < 0);
  setup.pass(1s);  // the motors' own watchdog
  CHECK(setup.stands());

  begin();
  setup.command(amiro::Travel{});
  setup.pass(500ms);
  CHECK(setup.report.ended == Ended::stopped);
  CHECK(setup.stands());

  begin();  // another one in its place
  setup.command(travel(-0.1, 0, 0.2));
  setup.pass(3s);
  CHECK(setup.report.ended == Ended::arrived);

  setup.command(amiro::Travel{});  // nothing to end: how the last one ended stays
  setup.command(amiro::Motors{});
  setup.pass(100ms);
  CHECK(setup.report.ended == Ended::arrived);
}

TEST_CASE("a travel without encoders ends, and the wheels stand") {
  Setup setup{open_floor(1)};
  setup.say(publish_behaviour);
  setup.command(travel(1, 0, 0.1));
  setup.pass(1s);
  setup.robot.world().set_absent(sim::Part::encoders, true);
  setup.pass(500ms);
  CHECK(setup.report.ended == Ended::no_sample);
  CHECK(setup.stands());
  setup.command(travel(1, 0, 0.1));
  setup.pass(500ms);
  CHECK(setup.report.ended == Ended::no_sample);
}

TEST_CASE("a travel that the board cannot make is refused, and nothing moves") {
  Setup setup{open_floor(1)};
  setup.say(publish_behaviour);
  amiro::Travel far = travel(1, 0, 0.1);
  far.distance = 1'000'001;
  amiro::Travel fast = travel(1, 0, 0.3);
  ++fast.speed;
  int refused = 0;
  for (const amiro::Travel& impossible : {travel(1, 0, 0), travel(10, 0, 0.02), far, fast}) {
    setup.command(impossible);
    setup.pass(100ms);
    CHECK(setup.report.active == Active::none);
    CHECK(setup.robot.di_wheel_drive().counters().failed == static_cast<std::uint32_t>(++refused));
  }
  CHECK(setup.world().motion().pose == setup.world().options().start);
}

/// An open line of straights and of arcs of at least this radius, 3 m long unless it has curled up before,
/// which nowhere comes near itself.
sim::Line random_line(Random& random, double least_radius_m) {
  constexpr double apart_m = 0.15;
  constexpr double step_m = 0.01;
  sim::Line line;
  std::vector<sim::Vector> places;
  for (int tries = 0; tries < 300 && static_cast<double>(places.size()) * step_m < 3; ++tries) {
    const double curvature = tries % 3 == 0 ? 0 : within(random, -1, 1) / least_radius_m;
    sim::Line longer = line;
    longer.go_on(within(random, 0.05, 0.5),
                 tries % 3 == 1 ? std::copysign(1 / least_radius_m, curvature) : curvature);
    std::vector<sim::Vector> more = places;
    bool clear = true;
    const sim::LinePiece& piece = longer.pieces.back();
    for (double way = 0; way < piece.length_m && clear; way += step_m) {
      const sim::Vector place = piece.at(way).position();
      const auto near =
          static_cast<std::size_t>(apart_m * pi / step_m);  // half around a circle of that width
      for (std::size_t i = 0; i + near < more.size() && clear; ++i)
        clear = sim::length(place - more[i]) > apart_m;
      more.push_back(place);
    }
    if (!clear) continue;
    line = longer;
    places = more;
  }
  return line;
}

TEST_CASE("follow stays on a line whose curves its speed allows, and stops where it ends") {
  constexpr double ahead_m = firmware::boards::di_wheel_drive::line_model.ahead_m;
  const int worlds = test::at_full_speed ? 1000 : test::explored(20, 5);
  double worst_m = 0;
  double lines_m = 0;
  for (int i = 0; i < worlds; ++i) {
    Random random{static_cast<std::uint64_t>(i)};
    const double speed = within(random, 0.02, 0.2);
    CAPTURE(i, speed);
    sim::WorldOptions options = open_floor(random());
    options.arena.line = random_line(random, firmware::boards::di_wheel_drive::least_radius_m(speed));
    for (const sim::LinePiece& piece : options.arena.line.pieces) lines_m += piece.length_m;
    // On the line, up to 5 mm beside it and 10 degrees off.
    options.start = {0, within(random, -0.005, 0.005), within(random, -10, 10) * sim::degree};
    const sim::Vector goal = options.arena.line.pieces.back().end().position();
    Setup setup{options};
    setup.say(publish_behaviour);
    amiro::Follow follow;
    follow.set_speed_m_per_s(speed);
    bool at_end = false;
    for (int repeats = 0; repeats < 3000 && !at_end; ++repeats) {
      setup.command(follow);
      setup.pass(100ms, [&] {
        const sim::Vector front = setup.world().pose().place_of({ahead_m, 0});
        at_end = at_end || sim::length(front - goal) < 0.03;
        if (!at_end) worst_m = std::max(worst_m, setup.world().options().arena.line.distance(front));
        return true;
      });
      if (setup.report.active != Active::follow) break;
    }
    CHECK(at_end);
    if (!at_end) continue;
    for (int repeats = 0; repeats < 100 && setup.report.active == Active::follow; ++repeats) {
      setup.command(follow);
      setup.pass(100ms);
    }
    CHECK(setup.report.ended == Ended::line_lost);
  }
  CHECK(lines_m / worlds > 2);
  CHECK(worst_m < 0.014);  // it is lost 17 mm off
}

/// A room of random size with boxes in it, and the robot somewhere in it, with nothing nearer than 50 mm.
sim::WorldOptions random_room(Random& random) {
  sim::WorldOptions options;
  options.seed = random();
  options.arena.walls.clear();
  const sim::Vector corner{within(random, 0.3, 1.5), within(random, 0.3, 1.5)};
  sim::add_rectangle(options.arena.walls, corner * -1, corner);
  for (std::uint32_t boxes = random.below(8); boxes > 0; --boxes) {
    // Turned by any angle: corners and walls at any slant.
    const sim::Pose middle{within(random, -corner.x, corner.x), within(random, -corner.y, corner.y),
                           within(random, 0, 2 * pi)};
    const double width = within(random, 0.02, 0.3);
    const double depth = within(random, 0.02, 0.3);
    const std::array corners{middle.place_of({width, depth}), middle.place_of({-width, depth}),
                             middle.place_of({-width, -depth}), middle.place_of({width, -depth})};
    for (std::size_t i = 0; i < 4; ++i) options.arena.walls.push_back({corners[i], corners[(i + 1) % 4]});
  }
  const auto clearance = [&options](sim::Vector place) {
    double least = 1e9;
    for (const sim::Segment& wall : options.arena.walls)
      least = std::min(least, sim::length(place - sim::nearest_point(wall, place)));
    return least;
  };
  do {
    options.start = {within(random, -corner.x, corner.x), within(random, -corner.y, corner.y),
                     within(random, 0, 2 * pi)};
  } while (clearance(options.start.position()) < options.drive.robot_radius_m + 0.05);
  return options;
}

amiro::Avoid avoid(double speed_m_per_s) {
  amiro::Avoid avoid;
  avoid.set_speed_m_per_s(speed_m_per_s);
  return avoid;
}

TEST_CASE("avoid never touches a wall, and gets about") {
  const int worlds = test::at_full_speed ? 1000 : test::explored(20, 5);
  int far = 0;
  for (int i = 0; i < worlds; ++i) {
    Random random{static_cast<std::uint64_t>(i)};
    Setup setup{random_room(random)};
    const double speed = within(random, 0.03, 0.2);
    CAPTURE(i, speed);
    bool touched = false;
    double way_m = 0;
    sim::Pose before = setup.world().pose();
    for (int repeats = 0; repeats < 300 && !touched; ++repeats) {
      setup.command(avoid(speed));
      setup.pass(100ms, [&] {
        touched = touched || setup.world().touching();
        return true;
      });
      way_m += sim::length(setup.world().pose().position() - before.position());
      before = setup.world().pose();
    }
    CHECK_FALSE(touched);
    far += way_m > 0.3 * 30 * speed ? 1 : 0;
  }
  CHECK(far > worlds * 3 / 4);
}

amiro::Home home(double speed_m_per_s, double distance_m) {
  amiro::Home home;
  home.set_speed_m_per_s(speed_m_per_s);
  home.set_distance_m(distance_m);
  return home;
}

TEST_CASE("home never touches a wall, and rests at its distance from the nearest one") {
  const int worlds = test::at_full_speed ? 1000 : test::explored(20, 5);
  int resting = 0;
  int near = 0;
  double worst_m = 0;
  for (int i = 0; i < worlds; ++i) {
    Random random{static_cast<std::uint64_t>(i)};
    const sim::WorldOptions options = random_room(random);
    Setup setup{options};
    const double speed = within(random, 0.03, 0.2);
    const double distance_m = within(random, 0.03, 0.12);
    CAPTURE(i, speed, distance_m);
    bool touched = false;
    int still = 0;  // tenths of a second
    for (int repeats = 0; repeats < 600 && !touched && still < 20; ++repeats) {
      setup.command(home(speed, distance_m));
      setup.pass(100ms, [&] {
        touched = touched || setup.world().touching();
        return true;
      });
      still = setup.stands() ? still + 1 : 0;
    }
    CHECK_FALSE(touched);
    if (still < 20) continue;
    ++resting;
    double nearest_m = 1e9;
    const sim::Vector place = setup.world().pose().position();
    for (const sim::Segment& wall : options.arena.walls)
      nearest_m = std::min(nearest_m, sim::length(place - sim::nearest_point(wall, place)));
    const double off_m = std::abs(nearest_m - options.drive.robot_radius_m - distance_m);
    worst_m = std::max(worst_m, off_m);
    near += off_m < 0.01 ? 1 : 0;
    CHECK(off_m < 0.025);
  }
  WARN(resting << " of " << worlds << " rest, " << near << " within 10 mm, at most " << worst_m << " m off");
  CHECK(resting >= worlds * 95 / 100);
  CHECK(near >= worlds * 7 / 10);
}

TEST_CASE("home and avoid end each other; home is refused too near, without speed and without offsets") {
  Setup setup{open_floor(1)};
  setup.command(home(0.1, 0.05));
  setup.pass(400ms);
  CHECK(setup.world().wheels().left > 0.09);  // nothing in sight: straight on
  setup.command(avoid(0.05));
  setup.pass(400ms);
  CHECK(setup.world().wheels().left < 0.06);
  setup.command(amiro::Home{});  // of what is no more
  setup.pass(100ms);
  CHECK_FALSE(setup.stands());
  setup.command(amiro::Avoid{});
  setup.pass(450ms);
  CHECK(setup.stands());

  auto& board = setup.robot.power_management();
  setup.command(home(0.1, 0.029));
  setup.command(home(0, 0.05));
  amiro::Home far = home(0.1, 0.12);
  ++far.distance;
  setup.command(far);
  CHECK(board.counters().failed == 3);
  REQUIRE(setup.robot.world().calibrate_ring(true).ok());
  setup.command(home(0.1, 0.05));
  CHECK(board.counters().failed == 4);
  setup.pass(500ms);
  CHECK(setup.stands());
}

TEST_CASE("avoid ends with zero, with silence, and with a stop of both boards: the wheels stand at once") {
  Setup setup{open_floor(1)};
  const auto begin = [&] {
    setup.command(avoid(0.1));
    setup.pass(400ms);
    REQUIRE(setup.world().wheels().left > 0.09);
  };
  begin();
  setup.command(amiro::Avoid{});
  setup.pass(50ms + 400ms);  // a period until it is sent, and the wheels' lag
  CHECK(setup.stands());
  const int commands = setup.commands;
  setup.pass(1s);
  CHECK(setup.commands == commands);  // rest was commanded once

  begin();
  setup.pass(100ms + 50ms + 400ms);  // its watchdog, 500 ms after the command
  CHECK(setup.stands());
  CHECK(setup.robot.power_management().counters().timeouts == 1);

  begin();
  setup.command(amiro::Motors{});  // of the wheels' board alone: the ring's commands on
  setup.pass(60ms);
  CHECK_FALSE(setup.stands());
}

TEST_CASE("avoid without the ring stands, says so once, and goes on when it is back") {
  Setup setup{open_floor(1)};
  const auto go_on = [&](base::Duration time) {
    for (; time > 0ms; time -= 100ms) {
      setup.command(avoid(0.1));
      setup.pass(100ms);
    }
  };
  go_on(1s);
  setup.robot.world().set_absent(sim::Part::ring, true);
  go_on(1s);
  CHECK(setup.stands());
  CHECK(setup.robot.power_management().counters().failed == 1);
  setup.robot.world().set_absent(sim::Part::ring, false);
  go_on(1s);
  CHECK_FALSE(setup.stands());
  CHECK(setup.robot.power_management().counters().failed == 1);
  // Begun again without it, it says so again.
  setup.robot.world().set_absent(sim::Part::ring, true);
  for (const unsigned failed : {2U, 3U}) {
    go_on(1s);
    CHECK(setup.stands());
    CHECK(setup.robot.power_management().counters().failed == failed);
    setup.command(amiro::Avoid{});
    setup.pass(200ms);
  }
  // One that takes the other's place says so, too.
  go_on(200ms);
  amiro::Home home;
  home.set_distance_m(0.06);
  home.set_speed_m_per_s(0.1);
  setup.command(home);
  setup.pass(200ms);
  CHECK(setup.robot.power_management().counters().failed == 5);
}

TEST_CASE("avoid is refused beyond its range and without the ring's offsets") {
  Setup setup{open_floor(1)};
  amiro::Avoid fast = avoid(0.2);
  ++fast.speed;
  setup.command(fast);
  CHECK(setup.robot.power_management().counters().failed == 1);
  REQUIRE(setup.robot.world().calibrate_ring(true).ok());
  setup.command(avoid(0.1));
  CHECK(setup.robot.power_management().counters().failed == 2);
  setup.pass(500ms);
  CHECK(setup.stands());
  CHECK(setup.commands == 0);
}

TEST_CASE(
    "what commands the motors last is followed: avoid ends a travel, and a travel goes on after avoid") {
  Setup setup{open_floor(1)};
  setup.say(publish_behaviour);
  setup.command(travel(1, 0, 0.1));
  setup.pass(500ms);
  setup.command(avoid(0.05));
  setup.pass(200ms);
  CHECK(setup.report.ended == Ended::replaced);
  setup.command(amiro::Avoid{});
  setup.pass(100ms);
  setup.command(travel(0.1, 0, 0.1));
  setup.pass(5s);
  CHECK(setup.report.ended == Ended::arrived);
}

TEST_CASE("a bus without room gets the newest set point of avoid when it has some") {
  Setup setup{open_floor(1)};
  setup.command(avoid(0.1));
  setup.pass(300ms);
  setup.ports[1].room = false;
  setup.command(avoid(0.1));
  setup.pass(120ms);
  CHECK(setup.robot.waiting());
  const int before = setup.commands;
  setup.command(amiro::Avoid{});  // meanwhile
  setup.pass(10ms);
  CHECK(setup.commands == before);
  setup.ports[1].room = true;
  setup.robot.advance(setup.now);
  setup.carry();
  CHECK(setup.commands == before + 1);
  setup.pass(500ms);
  CHECK(setup.stands());
  CHECK(setup.commands == before + 1);
}

TEST_CASE("a behaviour without steps ends as late; one with steps and none at all do not") {
  using firmware::boards::di_wheel_drive::longest_without_step;
  using firmware::boards::di_wheel_drive::Orders;
  Orders orders;
  CHECK_FALSE(orders.pass(1h));
  orders.travel(travel(1, 0, 0.1));
  for (int i = 0; i < 100; ++i) {
    CHECK_FALSE(orders.pass(longest_without_step));
    CHECK(orders.take(orders.order().number, 7, 8, Ended::nothing));
  }
  CHECK(orders.report().distance == 7);
  CHECK_FALSE(orders.pass(longest_without_step));
  const std::uint32_t number = orders.order().number;
  CHECK(orders.pass(1ms));
  CHECK(orders.report().active == Active::none);
  CHECK(orders.report().ended == Ended::late);
  // A step of it that comes after all moves no wheel and changes no report.
  CHECK_FALSE(orders.take(number, 1, 1, Ended::arrived));
  CHECK(orders.report().ended == Ended::late);
}

}  // namespace sim_behaviours_test
