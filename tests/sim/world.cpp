#include "sim/amiro/world.hpp"

#include <cmath>
#include <tuple>
#include <vector>

#include <catch2/catch.hpp>

#include "firmware/boards/di_wheel_drive/odometry.hpp"

namespace sim_world_test {

using namespace ocm::sim;
using namespace std::chrono_literals;
using ocm::base::Duration;
using ocm::base::Error;
using ocm::base::Time;
namespace boards = ocm::firmware::boards;

constexpr Time start{};

/// Everything that there is to read.
auto readings(const World& world) {
  return std::make_tuple(world.gyroscope(), world.accelerometer(), world.magnetometer(), world.floor(),
                         world.ring(), world.encoders(), world.gauge(), world.motion());
}

/// A drive with stops, arcs and a wall in it, seen every 100 ms; `between` may do what it likes at 1 ms.
template <class F>
std::vector<decltype(readings(std::declval<World&>()))> journey(World& world, F between) {
  std::vector<decltype(readings(world))> seen;
  Time now = world.time();
  for (int i = 0; i < 60; ++i) {
    if (i == 3) world.set_wheels({0.3, 0.25});
    if (i == 20) world.set_wheels({});
    if (i == 35) world.set_wheels({-0.9, -0.9});
    if (i == 50) world.set_light(3, {255, 0, 10});
    between(world, now);
    now += 100ms;
    world.advance_to(now);
    seen.push_back(readings(world));
  }
  return seen;
}
const auto nothing = [](World&, Time) {};

TEST_CASE("the same seed gives the same world, another seed another one") {
  World a, b;
  WorldOptions other;
  other.seed = 2;
  World c{other};
  const auto first = journey(a, nothing);
  CHECK(first == journey(b, nothing));
  const auto third = journey(c, nothing);
  CHECK(std::get<0>(first.back()) != std::get<0>(third.back()));  // the gyroscope's noise differs,
  CHECK(std::get<7>(first.back()) == std::get<7>(third.back()));  // the truth does not
}

TEST_CASE("reading, and how often time is handed in, changes nothing") {
  World calm, busy;
  const auto expected = journey(calm, nothing);
  CHECK(expected == journey(busy, [](World& world, Time now) {
          for (Time t = now; t < now + 100ms; t += 700us) {
            world.advance_to(t);
            if (t.time_since_epoch() / 700us % 2 == 0) (void)world.ring();
            (void)world.gyroscope();
            world.advance_to(t - 5ms);  // a time that has passed is no time
          }
        }));
}

TEST_CASE("one part's absence does not touch the others") {
  World whole, broken;
  const auto expected = journey(whole, nothing);
  broken.set_absent(Part::gyroscope, true);
  const auto seen = journey(broken, nothing);
  CHECK(std::get<0>(seen.back()).error == Error::not_sampled);
  CHECK(std::get<1>(seen.back()) == std::get<1>(expected.back()));
  CHECK(std::get<4>(seen.back()) == std::get<4>(expected.back()));
  broken.set_absent(Part::gyroscope, false);
  CHECK(broken.gyroscope() == std::get<0>(expected.back()));
}

TEST_CASE("an absent part delivers no sample") {
  World world;
  for (std::size_t part = 0; part < part_count; ++part) world.set_absent(static_cast<Part>(part), true);
  CHECK(world.gyroscope().error == Error::not_sampled);
  CHECK(world.accelerometer().error == Error::not_sampled);
  CHECK(world.magnetometer().error == Error::not_sampled);
  CHECK(world.floor().error == Error::not_sampled);
  CHECK(world.ring().error == Error::not_sampled);
  CHECK(world.encoders().error == Error::not_sampled);
  CHECK(world.gauge().error == Error::not_sampled);
  CHECK(world.batteries().error == Error::not_sampled);
  CHECK(world.ring_light().error == Error::not_sampled);
}

TEST_CASE("a part repeats its newest sample until it has a new one") {
  WorldOptions options;
  options.magnetometer.noise_gauss = 0;
  World world{options};
  world.set_wheels({-0.5, 0.5});  // turning: the field on the robot changes all the time
  world.advance_to(start + 94ms);
  const auto first = world.magnetometer();  // sample 7, at 93.338 ms
  CHECK(world.sample(Part::magnetometer).number == 7);
  world.advance_to(start + 106ms);
  CHECK(world.magnetometer() == first);  // sample 8 comes at 106.672 ms
  world.advance_to(start + 107ms);
  CHECK(world.sample(Part::magnetometer).number == 8);
  CHECK(world.magnetometer() != first);
}

TEST_CASE("each part has as many samples as its period has gone by") {
  World world;
  const auto numbers = [&world] {
    std::vector<std::uint64_t> all;
    for (const Part part :
         {Part::gyroscope, Part::accelerometer, Part::magnetometer, Part::floor, Part::ring})
      all.push_back(world.sample(part).number);
    return all;
  };
  CHECK(numbers() == std::vector<std::uint64_t>{0, 0, 0, 0, 0});
  for (const int ms : {1, 2, 3, 4, 13, 14, 100, 5000}) {
    world.advance_to(start + ms * 1ms);
    const auto of = [ms](std::int64_t period_us) {
      return static_cast<std::uint64_t>(ms * 1000 / period_us);
    };
    CHECK(numbers() == std::vector<std::uint64_t>{of(1250), of(1000), of(13'334), of(4000), of(4000)});
  }
}

TEST_CASE("a calibration takes what is seen for the offset, is forgotten, and needs its part") {
  WorldOptions options;
  options.frozen = true;
  World world{options};
  const auto seen = *world.floor();
  CHECK(seen[1] > 7000);
  const auto raw = *world.raw_floor();
  const boards::FloorCounts nothing_below{2310, 2294, 2351, 2278};
  for (std::size_t i = 0; i < 4; ++i) CHECK(raw[i] - seen[i] == nothing_below[i]);
  REQUIRE(world.calibrate_floor(false).ok());
  CHECK(*world.floor() == boards::FloorCounts{});
  REQUIRE(world.calibrate_floor(true).ok());
  CHECK(world.floor() == world.raw_floor());
  const auto offset = world.ring_offset();
  CHECK(offset == boards::RingCounts{2289, 2302, 2420, 2350, 2318, 2272, 2382, 2269});
  CHECK(world.ring_offset(7) == 2269);
  REQUIRE(world.calibrate_ring(true).ok());
  CHECK(world.ring_offset() == boards::RingCounts{});
  REQUIRE(world.calibrate_ring(false).ok());
  CHECK(world.ring_offset() == *world.ring());
  world.set_absent(Part::floor, true);
  world.set_absent(Part::ring, true);
  CHECK(world.calibrate_floor(false).error == Error::not_sampled);
  CHECK(world.calibrate_ring(false).error == Error::not_sampled);
  CHECK(world.ring_offset()[2] != 0);
  CHECK(world.calibrate_floor(true).ok());  // which needs none
  CHECK(world.calibrate_ring(true).ok());
}

TEST_CASE("the gauge looks once a second, and a robot at rest loses nothing by passing at once") {
  World world;
  world.set_wheels({0.2, 0.2});
  world.advance_to(start + 999ms);
  CHECK(world.gauge()->power_mw == -930);  // as at the start
  world.advance_to(start + 1000ms);
  const auto driving = world.gauge()->power_mw;
  CHECK(driving < -930 - 300);  // 2 * 0.2 of 1 W, less the lag
  CHECK(driving > -930 - 400);
  world.advance_to(start + 1999ms);
  CHECK(world.gauge()->power_mw == driving);
  world.set_wheels({});
  world.advance_to(start + 3s);
  world.advance_to(start + 10s + 300ms);
  CHECK(world.gauge()->power_mw == -930);
  CHECK(world.time() == start + 10s + 300ms);
  world.set_light(0, {255, 0, 0});
  world.advance_to(start + 11s);
  CHECK(world.gauge()->power_mw == -930 - 46);  // 0.7 s of 66 mW
}

TEST_CASE("duties are parts of the greatest speed, and a wheel that is asked for more keeps to it") {
  World world;
  world.set_duty(0.25, -0.5);
  world.advance_to(start + 1s);
  CHECK(world.wheels().left == Approx(0.25));
  CHECK(world.wheels().right == Approx(-0.5));
  world.set_duty(7, -7);
  world.advance_to(start + 2s);
  CHECK(world.wheels() == boards::WheelSpeeds{1, -1});
}

TEST_CASE("each part has noise of its own") {
  const World world;
  for (std::size_t a = 0; a < part_count; ++a)
    for (std::size_t b = 0; b < a; ++b)
      CHECK(world.sample(static_cast<Part>(a)).noise.normal(0, 0) !=
            world.sample(static_cast<Part>(b)).noise.normal(0, 0));
}

TEST_CASE("a frozen world gives the same for ever") {
  WorldOptions options;
  options.frozen = true;
  World world{options};
  const auto before = readings(world);
  world.set_wheels({0.5, 0.4});
  world.advance_to(start + 1h);
  CHECK(readings(world) == before);
  // Without noise. Sensor 3 sees the box 0.2605 m away by a ray 10 degrees off its axis:
  // 0.9427 / 0.2605^2 * cos(12.365 degrees).
  CHECK(world.ring()->at(2) == 2420 + 14);
}

TEST_CASE("the world may start at any time") {
  WorldOptions options;
  options.start_time = start + 1000h;
  World late{options}, early;
  late.advance_to(start + 1000h + 1234ms);
  early.advance_to(start + 1234ms);
  CHECK(readings(late) == readings(early));
  CHECK(late.time() == start + 1000h + 1234ms);
}

TEST_CASE("without slip odometry and truth agree, at a wall they part") {
  WorldOptions options;
  options.start = {};
  options.arena.walls.clear();
  for (const auto& [forward, turn] :
       {std::pair{0.1, 0.0}, {0.2, 0.5}, {0.05, -1.0}, {-0.1, 0.3}, {0.0, 2.0}}) {
    World world{options};
    boards::di_wheel_drive::Odometry odometry;
    world.set_wheels(boards::di_wheel_drive::wheel_speeds(forward, turn));
    Time now = start;
    for (int i = 0; i < 400; ++i) {  // 20 s, the last of them at rest
      if (i == 380) world.set_wheels({});
      odometry.update(*world.encoders());
      now += boards::di_wheel_drive::odometry_period;
      world.advance_to(now);
    }
    odometry.update(*world.encoders());
    const auto& believed = odometry.state();
    const Pose& true_pose = world.pose();
    // One tick of each wheel is 0.12 mm and 3.6 mrad; the lever arm is the way that was driven.
    CHECK(std::abs(std::remainder(believed.heading_rad - true_pose.heading_rad, 2 * pi)) < 0.0037);
    CHECK(std::hypot(believed.x_m - true_pose.x_m, believed.y_m - true_pose.y_m) < 0.003);
    CHECK(believed.heading_rad >= 0);
    CHECK(believed.heading_rad < 2 * pi);
    CHECK(believed.forward_m_per_s == 0);
  }

  options.arena.walls = {{{0.3, -1}, {0.3, 1}}};
  World world{options};
  boards::di_wheel_drive::Odometry odometry;
  odometry.update(*world.encoders());
  world.set_wheels({0.1, 0.1});
  for (Time now = start + 50ms; now <= start + 10s; now += 50ms) {
    world.advance_to(now);
    odometry.update(*world.encoders());
  }
  CHECK(world.pose().x_m == Approx(0.25));
  CHECK(odometry.state().x_m == Approx(0.995).margin(0.001));
  CHECK(odometry.state().forward_m_per_s == Approx(0.1).margin(0.0025));
}

TEST_CASE("odometry: the totals wrap around, and a gap loses only its own way") {
  boards::di_wheel_drive::Odometry odometry;
  odometry.update({INT32_MAX - 4, INT32_MAX - 4});
  odometry.update({INT32_MIN + 5, INT32_MIN + 5});  // ten ticks on
  CHECK(odometry.state().x_m == Approx(10 * boards::di_wheel_drive::metres_per_tick));
  odometry.interrupt();
  CHECK(odometry.state().forward_m_per_s == 0);
  odometry.update({1000, 1000});
  odometry.update({1001, 1001});
  CHECK(odometry.state().x_m == Approx(11 * boards::di_wheel_drive::metres_per_tick));
}

TEST_CASE("odometry: a look that came after several periods is no higher speed") {
  boards::di_wheel_drive::Odometry odometry;
  odometry.update({0, 0});
  odometry.update({10, 10});
  const double speed = odometry.state().forward_m_per_s;
  odometry.update({40, 40}, 3);
  CHECK(odometry.state().forward_m_per_s == Approx(speed));
  CHECK(odometry.state().x_m == Approx(40 * boards::di_wheel_drive::metres_per_tick));
}

TEST_CASE("driving and lights drain the batteries") {
  World idle, driving, bright;
  driving.set_wheels({0.02, -0.02});
  for (std::size_t i = 0; i < 8; ++i) bright.set_light(i, {255, 255, 255});
  bright.set_light(8, {1, 2, 3});  // there is none
  for (World* world : {&idle, &driving, &bright}) world->advance_to(start + 60s);
  CHECK(idle.gauge()->power_mw == -930);
  CHECK(driving.gauge()->power_mw == -930 - 40);
  CHECK(bright.gauge()->power_mw == -930 - 24 * 66);
  CHECK(idle.battery().energy_uj() == 14'688'000'000 / 10 * 9 - 60 * 930'000);
  CHECK(driving.battery().energy_uj() < idle.battery().energy_uj());
  CHECK(bright.light(3) == boards::Colour{255, 255, 255});
}

TEST_CASE("charging, then unplugged: flags and percent") {
  WorldOptions options;
  options.state_of_charge = 0.10;
  options.plugged = true;
  World world{options};
  CHECK(world.gauge()->charging);
  world.advance_to(start + 3h);
  CHECK(world.gauge()->state_of_charge_percent == 100);
  CHECK(world.gauge()->plugged);
  CHECK_FALSE(world.gauge()->charging);
  world.set_plugged(false);
  world.advance_to(start + 5h);
  CHECK_FALSE(world.gauge()->plugged);
  CHECK(world.gauge()->state_of_charge_percent == 54);  // 2 h at 930 mW are 1.86 of 4.08 Wh
}

TEST_CASE("empty batteries stop the motors") {
  WorldOptions options;
  options.state_of_charge = 0.00001;  // 0.15 J
  World world{options};
  world.set_wheels({0.05, -0.05});
  world.advance_to(start + 2s);
  CHECK(world.battery().empty());
  CHECK(world.wheels() == boards::WheelSpeeds{});
}

TEST_CASE("a day at rest is passed at once") {
  World world;
  world.set_wheels({0.01, 0.01});
  world.advance_to(start + 1s);
  world.set_wheels({});
  world.advance_to(start + 24h);  // 86.4 million steps
  CHECK(world.time() == start + 24h);
  CHECK(world.gauge()->state_of_charge_percent == 0);
}

}  // namespace sim_world_test
