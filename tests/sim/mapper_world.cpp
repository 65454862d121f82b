#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/mapper/app/models.hpp"

#include "sim/amiro/arena.hpp"
#include "sim/mapper/parts.hpp"
#include "sim/mapper/world.hpp"

namespace sim_mapper_world_test {

using namespace ocm::sim;
using namespace ocm::sim::mapper;
using namespace std::chrono_literals;
namespace base = ocm::base;
namespace motion = ocm::motion;
namespace sensing = ocm::sensing;

base::Time at(base::Duration since_start) {
  return base::Time{} + since_start;
}

WorldModel open_world(std::vector<Start> starts = {{"AVR", RobotKind::avr, {}}}) {
  WorldModel model;
  model.starts = std::move(starts);
  return model;
}

WorldModel room(std::vector<Start> starts) {
  WorldModel model = open_world(std::move(starts));
  add_rectangle(model.walls, {-1, -0.8}, {1, 0.8});
  add_rectangle(model.walls, {0.3, 0.2}, {0.5, 0.4});
  model.walls.push_back({{-0.5, -0.8}, {-0.2, 0.1}});  // with the room's wall a wedge
  model.walls.push_back({{0.4, -0.8}, {1, -0.6}});     // and a narrow one
  return model;
}

/// A robot without any error but those that its model shows.
RobotModel ideal(RobotModel model = avr_model) {
  model.motor.spread = 0;
  model.slip = {.turning = 0, .straight = 0, .friction = 0.5, .variation = 0, .variation_s = 1};
  model.wheel_errors = {0, 0};
  model.body.centre_ahead_m = 0;
  return model;
}

/// Steps of one robot by hand, without World.
struct Bench {
  WorldModel world = open_world();
  Robot robot;
  std::vector<Disc> discs{};
  std::int64_t ms = 0;

  explicit Bench(const RobotModel& model) : robot(world.starts[0], model, 1, 0) {}
  void run(double seconds) {
    discs = {robot.disc()};
    for (const std::int64_t until = ms + std::lround(seconds * 1000); ms < until; ++ms)
      robot.move({world, discs, 0, 1}, ms);
  }
};

double nearest_wall(const WorldModel& world, const Disc& disc) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Segment& wall : world.walls)
    nearest = std::min(nearest, length(disc.centre - nearest_point(wall, disc.centre)));
  return nearest;
}

constexpr motion::Efforts ahead{1, 1};
constexpr motion::Efforts turn_left{-1, 1};

TEST_CASE("mapper: a straight way is as long as its wheels make it") {
  Bench bench{ideal()};
  bench.robot.drive(ahead);
  bench.run(10);
  // 66 ticks/s of 2 pi 33/198 mm, less the lag of 20 ms.
  const double speed = 66 * 2 * pi * 0.033 / 198;
  CHECK(bench.robot.pose().x_m == Approx(speed * (10 - 0.02)).margin(1.5e-4));
  CHECK(bench.robot.pose().y_m == 0);
  CHECK(bench.robot.pose().heading_rad == 0);
  CHECK(bench.robot.ticks().left == 658);  // floor(66 * 9.98)
  CHECK(bench.robot.ticks() == ocm::mapper::app::WheelTicks{658, 658});
}

TEST_CASE("mapper: wheels say 2.5 % too much of a straight way, and 10 % of a turn") {
  RobotModel model = ideal();
  model.slip.straight = 0.025;
  model.slip.turning = 0.10;
  Bench straight{model};
  straight.robot.drive(ahead);
  straight.run(10);
  CHECK(straight.robot.pose().x_m == Approx(66 * 9.98 * 2 * pi * 0.033 / 198 / 1.025).epsilon(1e-3));

  Bench turn{model};
  turn.robot.drive(turn_left);
  turn.run(5);
  const double by_wheels = 2 * 66 * 4.98 * 2 * pi * 0.033 / 198 / 0.15;
  CHECK(turn.robot.pose().heading_rad == Approx(by_wheels / 1.10).epsilon(1e-3));
  CHECK(turn.robot.pose().x_m == Approx(0).margin(1e-12));  // on the spot
  CHECK(turn.robot.pose().y_m == Approx(0).margin(1e-12));
  CHECK(turn.robot.turn_rad_per_s() == Approx(2 * 66 * 2 * pi * 0.033 / 198 / 0.15 / 1.10).epsilon(1e-3));
}

TEST_CASE("mapper: the wheels of the AVR robot say 10 % too much of a turn, the Arduino robot's 15 %") {
  for (const auto& [of, turning] : {std::pair{&avr_model, 0.10}, {&arduino_model, 0.15}}) {
    RobotModel model = *of;
    model.motor.spread = 0;
    model.slip.variation = 0;
    model.wheel_errors = {0, 0};
    Bench bench{model};
    bench.robot.drive(turn_left);
    bench.run(1);
    const double by_wheels =
        (bench.robot.right_m_per_s() - bench.robot.left_m_per_s()) / model.drive.wheelbase_m;
    CHECK(by_wheels / bench.robot.turn_rad_per_s() == Approx(1 + turning).epsilon(1e-6));
    CHECK(bench.robot.wheels_say_per_m() == Approx(1.025).epsilon(1e-6));
  }
}

TEST_CASE("mapper: what its wheels say of a metre is what driving a measured way finds") {
  for (const RobotModel& of : {avr_model, arduino_model}) {
    RobotModel model = of;
    model.motor.spread = 0;
    model.slip.variation = 0;
    model.wheel_errors.radius_spread = 0.05;
    Bench bench{model};
    bench.robot.drive(ahead);
    bench.run(1);
    const Vector before = bench.robot.pose().position();
    bench.run(0.001);
    const double way_m = length(bench.robot.pose().position() - before);
    const double said_m = model.drive.m_per_tick() * bench.robot.left().ticks_per_s() * step_s;
    CHECK(bench.robot.wheels_say_per_m() == Approx(said_m / way_m).epsilon(1e-4));
  }
}

TEST_CASE("mapper: less friction is more slip") {
  RobotModel model = ideal();
  model.slip.turning = 0.10;
  const auto turned = [&](double friction) {
    Bench bench{model};
    bench.world.friction = friction;
    bench.robot.drive(turn_left);
    bench.run(5);
    return bench.robot.pose().heading_rad;
  };
  const double grip = Bench{ideal()}.robot.pose().heading_rad + 2 * 66 * 4.98 * 2 * pi * 0.033 / 198 / 0.15;
  CHECK(grip / turned(0.5) == Approx(1.10).epsilon(1e-3));
  CHECK(grip / turned(1.0) == Approx(1.05).epsilon(1e-3));
  CHECK(grip / turned(0.25) == Approx(1.20).epsilon(1e-3));
}

TEST_CASE("mapper: with one wheel it turns about the other, each way") {
  const double way_m = 66 * 2 * pi * 0.033 / 198 * (2 - 0.02);
  struct Case {
    motion::Efforts efforts;
    double left_m, right_m;
  };
  for (const Case& each :
       {Case{{0, 1}, 0, way_m}, Case{{1, 0}, way_m, 0}, Case{{0, -1}, 0, -way_m}, Case{{-1, 0}, -way_m, 0}}) {
    Bench bench{ideal()};
    bench.robot.drive(each.efforts);
    bench.run(2);
    const Pose expected = arc({}, (each.left_m + each.right_m) / 2, (each.right_m - each.left_m) / 0.15);
    CHECK(bench.robot.pose().x_m == Approx(expected.x_m).margin(2e-4));
    CHECK(bench.robot.pose().y_m == Approx(expected.y_m).margin(2e-4));
    CHECK(bench.robot.pose().heading_rad == Approx(expected.heading_rad).margin(2e-3));
    CHECK(bench.robot.left_m_per_s() == Approx(each.left_m == 0 ? 0 : each.left_m / 1.98).epsilon(1e-3));
    CHECK(bench.robot.right_m_per_s() == Approx(each.right_m == 0 ? 0 : each.right_m / 1.98).epsilon(1e-3));
  }
}

TEST_CASE("mapper: what its middle gets on by in a step is bounded, and the bound is near") {
  for (const RobotModel& of : {avr_model, arduino_model}) {
    RobotModel model = of;
    model.motor.spread = 0;
    model.slip = {.turning = 0, .straight = 0, .friction = 0.5, .variation = 0, .variation_s = 1};
    double longest_m = 0;
    for (const motion::Efforts efforts : {motion::Efforts{1, 1}, {1, -1}, {0, 1}, {1, 0.5F}}) {
      Bench bench{model};
      bench.robot.drive(efforts);
      for (int ms = 0; ms < 2000; ++ms) {
        const Vector before = bench.robot.disc().centre;
        bench.run(0.001);
        longest_m = std::max(longest_m, length(bench.robot.disc().centre - before));
      }
      CHECK(longest_m <= bench.robot.most_step_m());
      CHECK(bench.robot.most_step_m() < 2 * (longest_m + 1e-5));
    }
  }
}

TEST_CASE("mapper: each part has a new sample once in its period, and only then") {
  World world{open_world()};
  const Robot& robot = world.robot(0);
  struct Watched {
    base::Duration period;
    std::vector<int> changed{}, expected{};
    double before = 0;
  };
  Watched gyro{2404us}, compass{13'334us}, infrared{38'300us};
  const auto look = [&](int ms) {
    // Two values of each that are noisy by themselves: that both stay by accident does not happen here.
    const std::pair<Watched*, double> all[] = {
        {&gyro, 1.0 * robot.gyro().value},
        {&compass, 1e3 * robot.field().value.x + robot.field().value.y},
        {&infrared, 1e3 * robot.infrared(0).value + 10 * robot.infrared(1).value + robot.infrared(2).value}};
    for (const auto& [part, value] : all) {
      if (ms > 0 && value != part->before) part->changed.push_back(ms);
      if (ms > 0 && (ms * 1ms) / part->period != ((ms - 1) * 1ms) / part->period)
        part->expected.push_back(ms);
      part->before = value;
    }
  };
  for (int ms = 0; ms <= 1000; ++ms) {
    world.advance_to(at(ms * 1ms));
    look(ms);
  }
  for (const Watched* part : {&gyro, &compass, &infrared}) {
    // A few samples are the same digits as the last ones.
    std::size_t late = 0;
    for (const int ms : part->changed)
      late += std::count(part->expected.begin(), part->expected.end(), ms) == 0 ? 1 : 0;
    CHECK(late == 0);
    CHECK(part->changed.size() <= part->expected.size());
    CHECK(part->changed.size() * 10 >= part->expected.size() * 8);
  }
  CHECK(infrared.changed.front() == 39);
  CHECK(compass.changed.front() == 14);
}

TEST_CASE("mapper: before it moves its gyro has the noise of rest") {
  RobotModel model = ideal();
  model.gyro.bias_deg_per_s = model.gyro.wander_deg_per_s = 0;
  const WorldModel world = open_world();
  double squares = 0;
  constexpr int robots = 2000;
  for (int i = 0; i < robots; ++i) {
    const Robot robot{world.starts[0], model, static_cast<std::uint64_t>(i), 0};
    squares += std::pow(robot.gyro().value / degree, 2);
  }
  CHECK(std::sqrt(squares / robots) == Approx(0.10).epsilon(0.08));
}

TEST_CASE("mapper: wheels differ from what is believed of them as the model says, radius and base") {
  const WorldModel world = open_world();
  double radius = 0, radii = 0, base_of = 0, bases = 0, both = 0;
  constexpr int robots = 400;
  for (int i = 0; i < robots; ++i) {
    RobotModel model = ideal();
    model.wheel_errors = {0.002, 0.005};
    Bench bench{model};
    bench.robot = Robot{world.starts[0], model, static_cast<std::uint64_t>(i + 1), 0};
    bench.robot.drive(turn_left);
    bench.run(0.5);
    const double left =
        bench.robot.left_m_per_s() / bench.robot.left().ticks_per_s() / avr_model.drive.m_per_tick() - 1;
    const double right =
        bench.robot.right_m_per_s() / bench.robot.right().ticks_per_s() / avr_model.drive.m_per_tick() - 1;
    const double wheelbase =
        (bench.robot.right_m_per_s() - bench.robot.left_m_per_s()) / bench.robot.turn_rad_per_s();
    radius += left / robots;
    radii += left * left / robots;
    both += left * right / robots;
    base_of += (wheelbase / 0.15F - 1) / robots;
    bases += std::pow(wheelbase / 0.15F - 1, 2) / robots;
  }
  CHECK(std::abs(radius) < 0.0005);  // 5 * 0.002/20
  CHECK(std::sqrt(radii) == Approx(0.002).epsilon(0.15));
  CHECK(std::abs(both) < 5 * 0.002 * 0.002 / 20);  // each has its own
  CHECK(std::abs(base_of) < 0.00125);
  CHECK(std::sqrt(bases) == Approx(0.005).epsilon(0.15));
}

TEST_CASE("mapper: slip changes from place to place, by a quarter and in half a second") {
  RobotModel model = ideal();
  model.slip = {.turning = 0.10, .straight = 0, .friction = 0.5, .variation = 0.25, .variation_s = 0.5};
  double sum = 0, squares = 0, bends = 0;
  int places = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Bench bench{model};
    bench.robot = Robot{bench.world.starts[0], model, seed, 0};
    bench.robot.drive(turn_left);
    bench.run(1);
    const auto slip = [&] {
      return (bench.robot.right_m_per_s() - bench.robot.left_m_per_s()) / 0.15F /
                 bench.robot.turn_rad_per_s() -
             1;
    };
    for (int place = 0; place < 20; ++place) {  // a straight line within half a second
      bench.run(0.001);
      const double first = slip();
      bench.run(0.249);
      const double middle = slip();
      bench.run(0.249);
      bends = std::max(bends, std::abs(middle - (first + slip()) / 2));
      bench.run(0.001);
      sum += first / 0.10, squares += std::pow(first / 0.10 - 1, 2), ++places;
    }
  }
  CHECK(sum / places == Approx(1).margin(0.05));
  CHECK(std::sqrt(squares / places) == Approx(0.25).epsilon(0.1));
  CHECK(bends < 0.001);
}

TEST_CASE("mapper: stopped, it rolls out, and then rests") {
  Bench bench{ideal()};
  bench.robot.drive(ahead);
  bench.run(1);
  const double x = bench.robot.pose().x_m;
  bench.robot.drive({});
  CHECK_FALSE(bench.robot.at_rest());
  bench.run(1);
  CHECK(bench.robot.at_rest());
  CHECK(bench.robot.pose().x_m - x == Approx(66 * 0.12 * 2 * pi * 0.033 / 198).epsilon(0.05));
  CHECK(bench.robot.turn_rad_per_s() == 0);
}

TEST_CASE("mapper: the Arduino robot's tower is behind its axle, and swings around it") {
  WorldModel model = open_world({{"Arduino", RobotKind::arduino, {}}});
  World world{model};
  CHECK(world.robot(0).disc().centre.x == Approx(-0.04));
  world.robot(0).drive(turn_left);
  world.advance_to(at(1s));
  const Robot& robot = world.robot(0);
  CHECK(length(robot.disc().centre - robot.pose().position()) == Approx(0.04));
}

TEST_CASE("mapper: its distances are those of geometry") {
  WorldModel model = open_world({{"AVR", RobotKind::avr, {0, 0, 0}}});
  // Ahead at 0.35 m, left at 0.25 m, nothing behind, right a robot.
  model.walls = {{{0.40, -1}, {0.40, 1}}, {{-1, 0.28}, {1, 0.28}}};
  model.starts.push_back(
      {"Other", RobotKind::avr, {0.03, -0.5, 0}});  // disc around (0.02, -0.5): beside the tower
  World world{model};
  world.advance_to(at(200ms));
  const auto seen_cm = [&](std::size_t sensor) {
    return static_cast<double>(sensing::ir_distance(world.robot(0).infrared(sensor).value).distance_cm);
  };
  CHECK(seen_cm(0) == Approx(35).margin(6));
  CHECK(seen_cm(1) == Approx(25).margin(3));
  CHECK(sensing::ir_distance(world.robot(0).infrared(2).value).range == sensing::IrRange::nothing);
  CHECK(seen_cm(3) == Approx(50 - 10 - 3).margin(6));
  // Half way round: the forward sensor at 45 degrees; the wall on the left is nearer, (0.28 - 0.0212)/sin 45
  // off.
  world.robot(0).turn_tower(45);
  world.advance_to(at(700ms));
  CHECK(seen_cm(0) == Approx(100 * (0.28 * std::sqrt(2.0) - 0.03)).margin(5));
  // All the way: what was on the left is where the forward sensor looks.
  world.robot(0).turn_tower(90);
  world.advance_to(at(1200ms));
  CHECK(seen_cm(0) == Approx(25).margin(3));
}

TEST_CASE("mapper: a distance is that of the last measurement, not of now") {
  WorldModel model = open_world({{"AVR", RobotKind::avr, {0, 0, 0}}});
  model.walls = {{{0.40, -1}, {0.40, 1}}};
  World world{model};
  world.robot(0).turn_tower(90);
  int changes = 0;
  float before = world.robot(0).infrared(0).value;
  for (int ms = 1; ms <= 383; ++ms) {
    world.advance_to(at(ms * 1ms));
    const float now = world.robot(0).infrared(0).value;
    changes += now != before;
    before = now;
  }
  CHECK(changes >= 8);
  CHECK(changes <= 10);
}

TEST_CASE("mapper: applications believe what the models are, but for their errors") {
  const auto same = [](const RobotModel& is, const ocm::mapper::app::RobotModel& believed) {
    CHECK(is.drive.wheel_radius_m == believed.estimator.drive.wheel_radius_m);
    CHECK(is.drive.wheelbase_m == believed.estimator.drive.wheelbase_m);
    CHECK(is.drive.ticks_per_turn == believed.estimator.drive.ticks_per_turn);
    // What it says of its measures, from the middle of its body.
    CHECK(believed.handshake.axle_offset == std::lround(-is.body.centre_ahead_m * 100));
    CHECK(believed.handshake.tower_offset - believed.handshake.axle_offset ==
          std::lround(is.tower.ahead_of_axle_m * 100));
    CHECK(believed.handshake.width == std::lround(is.body.radius_m * 200));
  };
  same(avr_model, ocm::mapper::app::avr_robot);
  same(arduino_model, ocm::mapper::app::arduino_robot);
}

TEST_CASE("mapper: absent parts say so") {
  World world{open_world()};
  Robot& robot = world.robot(0);
  CHECK(robot.gyro().ok());
  CHECK(robot.field().ok());
  CHECK(robot.infrared(3).ok());
  CHECK(robot.infrared(4).error == base::Error::out_of_range);
  robot.set_absent(Part::gyro, true);
  robot.set_absent(Part::compass, true);
  robot.set_absent(Part::infrared, true);
  CHECK(robot.gyro().error == base::Error::not_sampled);
  CHECK(robot.field().error == base::Error::not_sampled);
  CHECK(robot.infrared(0).error == base::Error::not_sampled);
  robot.set_absent(Part::gyro, false);
  CHECK(robot.gyro().ok());
}

TEST_CASE("mapper: with its link it is all that an application asks for") {
  World world{open_world()};
  std::size_t sent = 0;
  bool linked = false;
  WorldParts parts{world.robot(0), [&] { return linked; },
                   [&](std::span<const std::uint8_t> bytes) {
                     sent += bytes.size();
                     return bytes.size() / 2;
                   }};
  static_assert(ocm::mapper::app::RobotParts<decltype(parts)>);
  CHECK_FALSE(parts.linked());
  linked = true;
  CHECK(parts.linked());
  CHECK(parts.send(std::vector<std::uint8_t>(10)) == 5);
  CHECK(sent == 10);
  parts.drive(ahead);
  parts.turn_tower(30);
  parts.show({true, false});
  world.advance_to(at(1s));
  CHECK(parts.ticks().left > 50);
  CHECK(parts.ticks() == world.robot(0).ticks());
  CHECK(parts.gyro().value == world.robot(0).gyro().value);
  CHECK(parts.field().value == world.robot(0).field().value);
  CHECK(parts.infrared(1).value == world.robot(0).infrared(1).value);
  CHECK(world.robot(0).tower_deg() == 30);
  CHECK(world.robot(0).lights() == ocm::mapper::app::Lights{true, false});
}

TEST_CASE("mapper world: what came near while a robot rested is in its way") {
  for (const double gap : {0.3, 0.6, 1.0, 1.5}) {
    World world{
        open_world({{"one", RobotKind::avr, {}}, {"two", RobotKind::avr, {gap + 0.2, 0, ocm::motion::pi}}})};
    double deepest = -1;
    base::Duration now{};
    const auto drive = [&](std::size_t robot, base::Duration most) {
      world.robot(robot).drive({0.6F, 0.6F});
      for (const base::Duration end = now + most; now < end && !world.robot(robot).touching();) {
        world.advance_to(at(now += 1ms));
        const Disc one = world.robot(0).disc(), two = world.robot(1).disc();
        deepest = std::max(deepest, one.radius_m + two.radius_m - length(one.centre - two.centre));
      }
      world.robot(robot).drive({});
      world.advance_to(at(now += 1s));
    };
    drive(0, 100ms);  // and knows then how far everything is
    drive(1, 60s);
    drive(0, 4s);
    CHECK(deepest > -1e-3);  // they did meet
    CHECK(deepest < 1e-6);
  }
}

TEST_CASE("mapper world: whatever robots do, none is ever inside a wall or another") {
  const std::vector<Start> starts{{"one", RobotKind::avr, {-0.8, 0, 0}},
                                  {"two", RobotKind::arduino, {0, -0.5, 1}},
                                  {"three", RobotKind::arduino, {0, 0.5, 2}},
                                  {"four", RobotKind::avr, {0.75, 0, 3}}};
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    World world{room(starts), {.seed = seed}};
    const Noise noise{seed, 99};
    bool touched = false, touched_another = false;
    double deepest = 0, longest_step_m = 0, allowed_step_m = 0;
    std::vector<Vector> before;
    for (std::size_t i = 0; i < world.size(); ++i) {
      before.push_back(world.robot(i).disc().centre);
      allowed_step_m = std::max(allowed_step_m, world.robot(i).most_step_m());
    }
    for (int ms = 0; ms < 20'000; ++ms) {
      if (ms % 700 == 0)  // mostly ahead, at all that is in the way
        for (std::size_t i = 0; i < world.size(); ++i) {
          const auto number = static_cast<std::uint64_t>(ms);
          const auto channel = static_cast<std::uint8_t>(2 * i);
          world.robot(i).drive(
              {static_cast<float>(0.6 + noise.normal(number, channel)),
               static_cast<float>(0.6 + noise.normal(number, static_cast<std::uint8_t>(channel + 1)))});
        }
      world.advance_to(at((ms + 1) * 1ms));
      for (std::size_t i = 0; i < world.size(); ++i) {
        const Disc disc = world.robot(i).disc();
        longest_step_m = std::max(longest_step_m, length(disc.centre - before[i]));
        before[i] = disc.centre;
        deepest = std::max(deepest, disc.radius_m - nearest_wall(world.model(), disc));
        for (std::size_t j = 0; j < i; ++j) {
          const Disc other = world.robot(j).disc();
          const double depth = disc.radius_m + other.radius_m - length(disc.centre - other.centre);
          deepest = std::max(deepest, depth);
          touched_another = touched_another || depth > -1e-6;
        }
        touched = touched || world.robot(i).touching();
        REQUIRE(std::abs(disc.centre.x) < 1);
        REQUIRE(std::abs(disc.centre.y) < 0.8);
      }
    }
    CHECK(touched);
    CHECK(deepest < 1e-8);
    CHECK(longest_step_m <= allowed_step_m);
    if (seed == 1) CHECK(touched_another);
  }
}

TEST_CASE("mapper world: two robots that drive at each other meet, and neither enters the other") {
  for (double gap = 0.25; gap < 1; gap += 0.11) {
    World world{
        open_world({{"one", RobotKind::arduino, {0, 0, 0}}, {"two", RobotKind::arduino, {gap, 0.01, pi}}})};
    world.robot(0).drive(ahead);
    world.robot(1).drive(ahead);
    double nearest = gap;
    for (int ms = 1; ms < 8000; ++ms) {
      world.advance_to(at(ms * 1ms));
      nearest = std::min(nearest, length(world.robot(0).disc().centre - world.robot(1).disc().centre));
    }
    CHECK(nearest > 0.2 - 1e-8);
    CHECK(nearest < 0.25);  // they came near
  }
}

TEST_CASE("mapper world: a robot that pushes against a wall stands, and its wheels go on") {
  WorldModel model = open_world();
  model.walls = {{{0.3, -1}, {0.3, 1}}};
  World world{model};
  world.robot(0).drive(ahead);
  world.advance_to(at(10s));
  CHECK(world.robot(0).touching());
  CHECK(world.robot(0).disc().centre.x == Approx(0.2).margin(1e-6));
  const auto ticks = world.robot(0).ticks().left;
  world.advance_to(at(12s));
  CHECK(world.robot(0).disc().centre.x == Approx(0.2).margin(1e-6));
  CHECK(world.robot(0).ticks().left - ticks > 120);
  world.robot(0).drive({-1, -1});
  world.advance_to(at(14s));
  CHECK_FALSE(world.robot(0).touching());
  CHECK(world.robot(0).disc().centre.x < 0.1);
}

TEST_CASE("mapper world: a robot stops at another, slides off, and pushes it nowhere") {
  World world{open_world({{"one", RobotKind::avr, {0, 0, 0}}, {"two", RobotKind::avr, {0.5, 0, 0}}})};
  world.robot(0).drive(ahead);
  world.advance_to(at(6s));
  CHECK(world.robot(0).touching());
  CHECK(world.robot(1).pose() == Pose{0.5, 0, 0});
  CHECK(length(world.robot(1).disc().centre - world.robot(0).disc().centre) == Approx(0.2).margin(1e-6));
}

/// All that a robot's parts tell over a drive, read at every `period`.
std::vector<double> told(std::uint64_t seed, base::Duration period, bool disturbed = false) {
  World world{room({{"one", RobotKind::avr, {-0.8, 0, 0}}, {"two", RobotKind::arduino, {0, -0.5, 1}}}),
              {.seed = seed}};
  std::vector<double> all;
  for (base::Duration now{}; now <= 6s; now += period) {
    world.advance_to(at(now));
    if (now == 0s) world.robot(0).drive(ahead);
    if (now == 3s) world.robot(0).drive({0.5F, -1});
    if (now == 3s) world.robot(0).turn_tower(70);
    if (disturbed)  // another reader reads and breaks other parts
      for (int i = 0; i < 3; ++i) {
        (void)world.robot(0).field();
        (void)world.robot(0).infrared(2);
        (void)world.robot(1).gyro();
        world.robot(1).set_absent(Part::infrared, i % 2 == 0);
      }
    if (now % 500ms != 0s) continue;
    const Robot& robot = world.robot(0);
    all.insert(all.end(), {robot.pose().x_m, robot.pose().y_m, robot.pose().heading_rad, robot.gyro().value,
                           robot.field().value.x, robot.field().value.y, robot.infrared(0).value,
                           robot.infrared(3).value, static_cast<double>(robot.ticks().left)});
  }
  return all;
}

TEST_CASE("mapper world: equal seeds, equal runs; others differ") {
  CHECK(told(1, 100ms) == told(1, 100ms));
  CHECK(told(1, 100ms) != told(2, 100ms));
}

TEST_CASE("mapper world: how often time is handed in and who reads what changes nothing") {
  CHECK(told(1, 500ms) == told(1, 1ms));
  CHECK(told(1, 500ms) == told(1, 250us));
  CHECK(told(1, 100ms, true) == told(1, 100ms));
}

TEST_CASE("mapper world: two robots of one world have errors of their own") {
  World world{open_world({{"one", RobotKind::avr, {0, 0, 0}}, {"two", RobotKind::avr, {0, 1, 0}}})};
  CHECK(world.robot(0).own_field() != world.robot(1).own_field());
  CHECK(world.robot(0).left().full_ticks_per_s() != world.robot(1).left().full_ticks_per_s());
  CHECK(world.robot(0).left().full_ticks_per_s() != world.robot(0).right().full_ticks_per_s());
}

TEST_CASE("mapper world: at rest, years pass at once, and samples go on") {
  World world{open_world()};
  constexpr int days = 3650;
  const float before = world.robot(0).gyro().value;
  world.advance_to(at(days * 24h));
  CHECK(world.time() == at(days * 24h));
  CHECK(world.robot(0).gyro().value != before);
  CHECK(world.robot(0).pose() == Pose{});
  world.advance_to(at(1h));  // backwards: nothing
  CHECK(world.time() == at(days * 24h));
  world.robot(0).drive(ahead);
  world.advance_to(at(days * 24h + 1s));
  CHECK(world.robot(0).pose().x_m > 0.05);
}

TEST_CASE("mapper world: how far a robot is from the server's dongle") {
  WorldModel model = open_world({{"one", RobotKind::avr, {3, 0, 0}}});
  model.central.place = {0, 4};
  World world{model};
  CHECK(world.distance_to_central(0) == Approx(5));
}

TEST_CASE("mapper world: starts for more robots than the file has are apart, in the room, and named apart") {
  const WorldModel model =
      room({{"AVR", RobotKind::avr, {-0.8, -0.5, 0.3}}, {"robot_3", RobotKind::avr, {0, 0.5, 0}}});
  CHECK(starts_for(model, 1)->size() == 1);
  const auto starts = starts_for(model, 8);
  REQUIRE(starts);
  REQUIRE(starts->size() == 8);
  CHECK(starts->at(0).name == "AVR");
  for (const Start& start : *starts) {
    CHECK(room_m(start, model.walls, *starts) > 0);
    CHECK(std::abs(start.pose.x_m) < 1);
    CHECK(std::abs(start.pose.y_m) < 0.8);
    for (const Start& other : *starts) CHECK((&start == &other || start.name != other.name));
  }
  CHECK_FALSE(starts_for(model, 1000));
  CHECK_FALSE(starts_for(WorldModel{}, 1));
  CHECK(starts_for(open_world(), 1000));
}

TEST_CASE("mapper world: more starts are put on a grid around the last one, row by row, ring by ring") {
  const WorldModel model =
      open_world({{"first", RobotKind::avr, {5, 5, 1}}, {"last", RobotKind::avr, {1, 2, 0.5}}});
  const auto starts = starts_for(model, 11);
  REQUIRE(starts);
  REQUIRE(starts->size() == 11);
  CHECK(starts->at(0).name == "first");
  std::size_t next = 2;
  for (int row = -1; row <= 1; ++row)
    for (int column = -1; column <= 1; ++column) {
      if (row == 0 && column == 0) continue;
      const Start& start = starts->at(next++);
      CHECK(start.name == "robot_" + std::to_string(next));
      CHECK(start.kind == RobotKind::avr);
      CHECK(start.pose.x_m == Approx(1 + 0.25 * column));
      CHECK(start.pose.y_m == Approx(2 + 0.25 * row));
      CHECK(start.pose.heading_rad == 0.5);
    }
  CHECK(starts->at(10).pose.x_m == Approx(1 - 0.5));  // the next ring
  CHECK(starts->at(10).pose.y_m == Approx(2 - 0.5));
  CHECK(starts_for(model, 2)->size() == 2);
  CHECK(starts_for(model, 1)->at(0).name == "first");
  // A name that is taken gets another one.
  const auto named = starts_for(open_world({{"robot_2", RobotKind::avr, {}}}), 2);
  REQUIRE(named);
  CHECK(named->at(1).name == "robot_2_");
}

TEST_CASE(
    "mapper world: a start has a quarter of a radius around it, to walls and to others; beyond a wall there "
    "is none") {
  // A corridor along x, as wide as one robot with its room: two to each side of the wall at the end.
  const auto corridor = [](double end_m) {
    WorldModel model = open_world({{"one", RobotKind::avr, {0, 0, 0}}});
    const double centre_m = avr_model.body.centre_ahead_m;
    model.walls = {{{-9, -0.15}, {9, -0.15}},
                   {{-9, 0.15}, {9, 0.15}},
                   {{centre_m - 0.2, -1}, {centre_m - 0.2, 1}},
                   {{centre_m + end_m, -1}, {centre_m + end_m, 1}}};
    return model;
  };
  CHECK(starts_for(corridor(0.25 + 0.1 + 0.026), 2));
  CHECK_FALSE(starts_for(corridor(0.25 + 0.1 + 0.024), 2));
  CHECK(starts_for(corridor(0.50 + 0.1 + 0.026), 3));
  CHECK_FALSE(starts_for(corridor(0.50 + 0.1 + 0.024), 3));
  // Room: to a wall, to another, and inside of one.
  const std::vector<Start> two{{"a", RobotKind::avr, {0, 0, 0}}, {"b", RobotKind::avr, {0.5, 0, 0}}};
  CHECK(room_m(two[0], {}, two) == Approx(0.3));
  CHECK(room_m(two[0], {{{-0.01, 0.17}, {9, 0.17}}}, two) == Approx(0.07));
  CHECK(room_m(two[0], {{{-0.01, 0.05}, {9, 0.05}}}, two) == Approx(-0.05));
  const std::vector<Start> alone{two[0]};
  CHECK(std::isinf(room_m(alone[0], {}, alone)));
  const std::vector<Start> other{{"c", RobotKind::arduino, {0, 1, pi / 2}}};  // its disc is behind its axle
  CHECK(room_m(two[0], {}, other) == Approx(std::hypot(0.01, 0.96) - 0.2));
}

TEST_CASE(
    "mapper world: a turn to the left is positive for gyro and ticks, and turns the field to the right") {
  World world{open_world()};
  Robot& robot = world.robot(0);
  world.advance_to(at(100ms));
  const double bias = static_cast<double>(robot.gyro().value);
  const double before = static_cast<double>(sensing::field_angle(robot.field().value, robot.own_field()));
  CHECK(before == Approx(pi / 2).margin(5 * degree));  // looks along x, north is to the left
  robot.drive(turn_left);
  world.advance_to(at(1100ms));
  CHECK(robot.gyro().value - bias > 40 * degree);
  CHECK(static_cast<std::int32_t>(robot.ticks().left) < -50);
  CHECK(static_cast<std::int32_t>(robot.ticks().right) > 50);
  const double turned = robot.pose().heading_rad;
  CHECK(turned > 40 * degree);
  const double after = static_cast<double>(sensing::field_angle(robot.field().value, robot.own_field()));
  CHECK(before - after == Approx(turned).margin(5 * degree));
}

TEST_CASE("mapper world: a compass is led astray by an anomaly, and right again beyond") {
  WorldModel model = open_world();
  model.anomalies = {{{0.5, 0}, 0.3, {0.14, 0}}};
  World world{model};
  Robot& robot = world.robot(0);
  const auto north_deg = [&] {
    const double angle = static_cast<double>(sensing::field_angle(robot.field().value, robot.own_field()));
    return (angle + robot.pose().heading_rad) / degree;
  };
  robot.drive(ahead);
  double least = 90;
  for (int ms = 0; ms < 15'000; ms += 100) {
    world.advance_to(at(ms * 1ms));
    least = std::min(least, north_deg());
  }
  CHECK(least == Approx(45).margin(8));  // as strong as the earth's, at right angles
  CHECK(robot.pose().x_m > 0.85);
  CHECK(north_deg() == Approx(90).margin(5));
}

TEST_CASE("mapper world: what a simulated second costs", "[.measure]") {
  const auto cost = [](std::size_t robots, bool moving) {
    WorldModel model;
    add_rectangle(model.walls, {-5, -5}, {5, 5});
    for (int i = 0; i < 8; ++i) add_rectangle(model.walls, {-4 + i * 1.0, 2}, {-3.8 + i * 1.0, 2.2});
    model.starts = {{"AVR", RobotKind::avr, {-3, -3, 0.5}}};
    model.starts = *starts_for(model, robots);
    World world{model};
    if (moving)
      for (std::size_t i = 0; i < robots; ++i) world.robot(i).drive({1.0F, i % 3 == 0 ? 0.5F : 1.0F});
    double sum = 0;
    const std::clock_t start = std::clock();
    const int seconds = static_cast<int>(2000 / robots);
    for (int ms = 10; ms <= seconds * 1000; ms += 10) {
      world.advance_to(at(ms * 1ms));
      for (std::size_t i = 0; i < robots; ++i) {
        if (moving && ms % 200 == 0) world.robot(i).turn_tower(ms % 90);
        if (ms % 30 == 0)  // as an application reads
          sum += static_cast<double>(world.robot(i).gyro().value + world.robot(i).field().value.x) +
                 world.robot(i).ticks().left;
        if (ms % 200 == 0)
          for (std::size_t sensor = 0; sensor < 4; ++sensor)
            sum += static_cast<double>(world.robot(i).infrared(sensor).value);
      }
    }
    CHECK(std::isfinite(sum));
    const double cpu_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    std::printf("%3zu robots, 36 walls, %s: %.0f us a robot and second\n", robots,
                moving ? "driving" : "resting", cpu_s * 1e6 / (static_cast<double>(robots) * seconds));
  };
  for (const bool moving : {true, false})
    for (const std::size_t robots : {std::size_t{1}, std::size_t{10}, std::size_t{100}}) cost(robots, moving);
}

}  // namespace sim_mapper_world_test
