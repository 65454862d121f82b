#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "sim/amiro/world.hpp"

namespace sim_sensors_test {

using namespace ocm::sim;
using ocm::firmware::boards::Axes;

/// The `n`th sample of a part that sees this motion.
Sample sample(const Motion& motion, std::uint64_t n = 0, bool noisy = true, std::uint64_t seed = 1) {
  return {motion, n, Noise{seed, 0}, noisy};
}
Motion looking(double heading_rad) {
  Motion motion;
  motion.pose.heading_rad = heading_rad;
  return motion;
}
Motion at(double x, double y, double heading_rad = 0) {
  Motion motion;
  motion.pose = {x, y, heading_rad};
  return motion;
}

struct Statistics {
  double mean = 0;
  double deviation = 0;
};
template <class F>
Statistics statistics(int n, F value) {
  double sum = 0, squares = 0;
  for (int i = 0; i < n; ++i) {
    const double v = value(static_cast<std::uint64_t>(i));
    sum += v;
    squares += v * v;
  }
  const double mean = sum / n;
  return {mean, std::sqrt(squares / n - mean * mean)};
}

constexpr int many = 20'000;

TEST_CASE("gyroscope: bias and noise are the model's") {
  const GyroscopeModel model;
  const double bias_digits = model.bias(sample({}), 2) / 0.0175;
  const double noise_digits = model.noise_deg_per_s / 0.0175;
  const auto z = statistics(many, [&](std::uint64_t i) { return model.read(sample({}, i)).z; });
  CHECK(z.mean == Approx(bias_digits).margin(5 * noise_digits / std::sqrt(many)));
  // Rounding to whole digits adds 1/12 to the variance.
  CHECK(z.deviation == Approx(std::sqrt(noise_digits * noise_digits + 1.0 / 12)).epsilon(0.03));

  // Over many robots the bias spreads as the model says.
  const auto bias =
      statistics(many, [&](std::uint64_t seed) { return model.bias(sample({}, 0, true, seed), 2); });
  CHECK(bias.mean == Approx(0).margin(0.02));
  CHECK(bias.deviation == Approx(model.bias_deg_per_s).epsilon(0.03));
}

TEST_CASE("gyroscope: scale, sign and range") {
  GyroscopeModel model;
  model.bias_deg_per_s = 0;
  Motion motion;
  motion.turn_rad_per_s = 17.5 * degree;
  CHECK(model.read(sample(motion, 0, false)) == ocm::firmware::boards::AngularRate{0, 0, 1000});
  motion.turn_rad_per_s = 499.99 * degree;
  CHECK(model.read(sample(motion, 0, false)).z == 28571);
  motion.turn_rad_per_s = 10'000 * degree;  // 32767 * 0.0175 is far below
  CHECK(model.read(sample(motion, 0, false)).z == 28571);
  motion.turn_rad_per_s = -10'000 * degree;
  CHECK(model.read(sample(motion, 0, false)).z == -28571);
}

TEST_CASE("accelerometer: gravity, motion, noise, range") {
  AccelerometerModel model;
  const auto z = statistics(many, [&](std::uint64_t i) { return model.read(sample({}, i)).z; });
  // The part has 512 digits a g; rounding to them adds 1/12 to the variance.
  CHECK(z.deviation / 2 ==
        Approx(std::sqrt(model.noise_g * 512 * model.noise_g * 512 + 1.0 / 12)).epsilon(0.03));
  for (std::uint64_t i = 0; i < 100; ++i)
    CHECK(model.read(sample({}, i)).z % 2 == 0);  // as in the thesis's log
  CHECK(std::abs(z.mean - 1024) < 6 * model.offset_g * 1024);

  model.offset_g = 0;
  CHECK(model.read(sample({}, 0, false)) == ocm::firmware::boards::SpecificForce{0, 0, 1024});
  Motion motion;
  motion.acceleration_m_per_s2 = {9.80665 / 2, -9.80665 / 4};
  CHECK(model.read(sample(motion, 0, false)) == ocm::firmware::boards::SpecificForce{512, -256, 1024});
  motion.acceleration_m_per_s2 = {1e5, -1e5};  // into a wall at full speed
  CHECK(model.read(sample(motion, 0, false)) == ocm::firmware::boards::SpecificForce{4094, -4096, 1024});
}

TEST_CASE("magnetometer: heading by atan2 once the hard iron is taken off") {
  const MagnetometerModel model;
  const Arena arena;
  for (int heading = -180; heading < 180; heading += 15) {
    double x = 0, y = 0;
    constexpr int n = 100;
    for (int i = 0; i < n; ++i) {
      const auto field = model.read(arena, sample(looking(heading * degree), static_cast<std::uint64_t>(i)));
      REQUIRE(field.x % 2560 == 0);
      x += field.x * 1e-6 / n;
      y += field.y * 1e-6 / n;
    }
    x -= model.hard_iron_gauss.x;
    y -= model.hard_iron_gauss.y;
    // North turns clockwise on the robot while the robot turns counter-clockwise.
    const double error = std::remainder(arena.north_rad - std::atan2(y, x) - heading * degree, 2 * pi);
    CHECK(std::abs(error) < 0.5 * degree);
    CHECK(std::hypot(x, y) == Approx(0.2).epsilon(0.01));
  }
}

TEST_CASE("magnetometer: the thesis's reading at the start, and the converter's ends") {
  MagnetometerModel model;
  const Arena arena;
  CHECK(model.read(arena, sample(looking(0), 0, false)) ==
        ocm::firmware::boards::MagneticField{53'760, -939'520, 1'523'200});
  model.hard_iron_gauss = {100, -100, 0};
  const auto field = model.read(arena, sample(looking(0), 0, false));
  CHECK(field.x == 2047 * 2560);
  CHECK(field.y == -2048 * 2560);
}

/// Each channel's noise, and each pair's, of a part that is read `many` times: read(sample) gives the
/// channels' values.
template <std::size_t N, class Read>
void check_noise(double spread, const Read& read) {
  std::array<double, N> mean{};
  std::vector<std::array<double, N>> all;
  for (std::uint64_t i = 0; i < many; ++i) {
    all.push_back(read(i));
    for (std::size_t a = 0; a < N; ++a) mean[a] += all.back()[a] / many;
  }
  for (std::size_t a = 0; a < N; ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      double both = 0;
      for (const auto& values : all) both += (values[a] - mean[a]) * (values[b] - mean[b]) / many;
      CAPTURE(a, b);
      if (a == b)
        CHECK(std::sqrt(both) == Approx(spread).epsilon(0.05));
      else
        CHECK(std::abs(both) < 6 * spread * spread / std::sqrt(many));
    }
}

TEST_CASE("each axis and each sensor of a part is as noisy as the model says, and by itself") {
  const GyroscopeModel gyroscope;
  check_noise<3>(std::hypot(gyroscope.noise_deg_per_s / 0.0175, std::sqrt(1.0 / 12)), [&](std::uint64_t i) {
    const auto r = gyroscope.read(sample({}, i));
    return std::array<double, 3>{1.0 * r.x, 1.0 * r.y, 1.0 * r.z};
  });
  const AccelerometerModel accelerometer;
  check_noise<3>(2 * std::hypot(accelerometer.noise_g * 512, std::sqrt(1.0 / 12)), [&](std::uint64_t i) {
    const auto r = accelerometer.read(sample({}, i));
    return std::array<double, 3>{1.0 * r.x, 1.0 * r.y, 1.0 * r.z};
  });
  MagnetometerModel magnetometer;
  magnetometer.hard_iron_gauss = {};
  check_noise<3>(2560 * std::hypot(0.002 / 2560e-6, std::sqrt(1.0 / 12)), [&](std::uint64_t i) {
    const auto r = magnetometer.read(Arena{}, sample({}, i));
    return std::array<double, 3>{1.0 * r.x, 1.0 * r.y, 1.0 * r.z};
  });
  const double counts = std::hypot(count_noise, std::sqrt(1.0 / 12));
  check_noise<8>(counts, [&](std::uint64_t i) {
    const auto r = RingModel{}.read({}, sample({}, i));
    std::array<double, 8> values{};
    std::copy(r.begin(), r.end(), values.begin());
    return values;
  });
  check_noise<4>(counts, [&](std::uint64_t i) {
    const auto r = FloorModel{}.read(Arena{}, sample({}, i));
    std::array<double, 4> values{};
    std::copy(r.begin(), r.end(), values.begin());
    return values;
  });
}

TEST_CASE("each reading has the noise that was drawn for it on it, as large as the model says") {
  GyroscopeModel gyroscope;
  gyroscope.noise_deg_per_s = 10;
  AccelerometerModel accelerometer;
  accelerometer.noise_g = 0.1;
  MagnetometerModel magnetometer;
  magnetometer.hard_iron_gauss = {};
  magnetometer.noise_gauss = 0.5;
  for (std::uint64_t n = 0; n < 20; ++n) {
    CAPTURE(n);
    const Sample noisy = sample({}, n), quiet = sample({}, n, false);
    const auto drawn = [&noisy](int channel) { return noisy.normal(static_cast<std::uint8_t>(channel)); };
    const auto check = [&drawn](int channel, double added, double size, double rounding) {
      CHECK(added == Approx(size * drawn(channel)).margin(rounding));
    };
    const auto turn = gyroscope.read(noisy), still = gyroscope.read(quiet);
    check(0, (turn.x - still.x) * 0.0175, 10, 0.02);
    check(1, (turn.y - still.y) * 0.0175, 10, 0.02);
    check(2, (turn.z - still.z) * 0.0175, 10, 0.02);
    const auto force = accelerometer.read(noisy), weight = accelerometer.read(quiet);
    check(0, (force.x - weight.x) / 1024.0, 0.1, 0.002);
    check(1, (force.y - weight.y) / 1024.0, 0.1, 0.002);
    check(2, (force.z - weight.z) / 1024.0, 0.1, 0.002);
    const auto field = magnetometer.read(Arena{}, noisy), north = magnetometer.read(Arena{}, quiet);
    check(0, (field.x - north.x) * 1e-6, 0.5, 0.0026);
    check(1, (field.y - north.y) * 1e-6, 0.5, 0.0026);
    check(2, (field.z - north.z) * 1e-6, 0.5, 0.0026);
    const auto ring = RingModel{}.read({}, noisy), dark = RingModel{}.read({}, quiet);
    for (int i = 0; i < 8; ++i) {
      const auto at = static_cast<std::size_t>(i);
      check(i, 1.0 * ring[at] - dark[at], count_noise, 1.01);
    }
    const auto floor = FloorModel{}.read(Arena{}, noisy), bright = FloorModel{}.read(Arena{}, quiet);
    for (int i = 0; i < 4; ++i) {
      const auto at = static_cast<std::size_t>(i);
      check(i, 1.0 * floor[at] - bright[at], count_noise, 1.01);
    }
  }
}

TEST_CASE("each axis has a bias and an offset of its own, of the model's size") {
  for (const auto part : {0, 1}) {
    std::array<double, 3> squares{};
    double pairs = 0;
    constexpr int n = 4000;
    for (std::uint64_t seed = 1; seed <= n; ++seed) {
      GyroscopeModel gyroscope;
      gyroscope.noise_deg_per_s = 0;
      AccelerometerModel accelerometer;
      accelerometer.noise_g = 0;
      const auto g = gyroscope.read(sample({}, 0, true, seed));
      const auto a = accelerometer.read(sample({}, 0, true, seed));
      const std::array<double, 3> off =
          part == 0
              ? std::array<double, 3>{g.x * 0.0175 / 0.5, g.y * 0.0175 / 0.5, g.z * 0.0175 / 0.5}
              : std::array<double, 3>{a.x / 1024.0 / 0.02, a.y / 1024.0 / 0.02, (a.z - 1024) / 1024.0 / 0.02};
      for (std::size_t i = 0; i < 3; ++i) squares[i] += off[i] * off[i] / n;
      pairs += (off[0] * off[1] + off[1] * off[2] + off[0] * off[2]) / n;
    }
    for (const double square : squares) CHECK(std::sqrt(square) == Approx(1).epsilon(0.06));
    CHECK(std::abs(pairs) < 9 / std::sqrt(n));
  }
}

TEST_CASE(
    "the default arena is 2.4 m by 1.6 m, with two boxes, none of them nearer than 0.25 m to the line") {
  const Arena arena = default_arena();
  CHECK(arena.walls.size() == 12);
  const auto until_wall = [&](Vector from, double heading_deg) {
    double least = 99;
    for (const Segment& wall : arena.walls)
      least = std::min(least, distance_along(from, direction(heading_deg * degree), wall));
    return least;
  };
  CHECK(until_wall({0.5, 0}, 0) == Approx(0.7));
  CHECK(until_wall({-0.5, 0}, 180) == Approx(0.7));
  CHECK(until_wall({0.5, 0}, 90) == Approx(0.8));
  CHECK(until_wall({0.5, 0}, -90) == Approx(0.8));
  CHECK(until_wall({0.5, 0.01}, 180) == Approx(0.4));  // the box in the middle, from each side
  CHECK(until_wall({-0.5, 0.01}, 0) == Approx(0.4));
  CHECK(until_wall({0.01, 0.5}, -90) == Approx(0.4));
  CHECK(until_wall({0.01, -0.5}, 90) == Approx(0.4));
  CHECK(until_wall({0.5, 0.6}, 0) == Approx(0.45));  // that in the corner
  CHECK(until_wall({1.15, 0.6}, 180) == Approx(0.05));
  CHECK(until_wall({1.0, 0}, 90) == Approx(0.5));
  CHECK(until_wall({1.0, 0.79}, -90) == Approx(0.14));
  for (const Segment& wall : arena.walls)
    for (int i = 0; i <= 20; ++i)
      CHECK(arena.line.distance(wall.a + (wall.b - wall.a) * (i / 20.0)) > 0.25 - 1e-9);
  CHECK(arena.line.distance(default_start.position()) < 1e-12);
  CHECK(default_start.heading_rad == 0);
}

TEST_CASE("infrared: the counts grow as the wall comes near, up to the converter's end") {
  RingModel ring;
  const std::vector<Segment> walls{{{1, -2}, {1, 2}}};
  unsigned before = 0;
  for (double gap = 0.5; gap >= 0; gap -= 0.001) {  // sensors 4 and 5 look ahead, 22.5 degrees to either side
    const auto counts = ring.read(walls, sample(at(1 - gap - ring.radius_m, 0), 0, false));
    REQUIRE(counts[3] >= before);
    CHECK(counts[3] - 2350 == Approx(counts[4] - 2318).margin(1).epsilon(1e-9));
    before = counts[3];
  }
  CHECK(before > 30'000);

  // Nothing behind: the offset.
  const auto counts = ring.read(walls, sample(at(0.9, 0), 0, false));
  CHECK(counts[0] == 2289);
  CHECK(counts[7] == 2269);
}

TEST_CASE("infrared: the law that was measured") {
  CHECK(reflected_counts(0.010, 0) == Approx(9426.9).margin(0.1));
  CHECK(reflected_counts(0.050, 0) == Approx(377.08).margin(0.01));
  CHECK(reflected_counts(0.050, 45 * degree) == Approx(377.08 * std::cos(1.236518540376969 * 45 * degree)));
  CHECK(reflected_counts(std::numeric_limits<double>::infinity(), 0) == 0);
  CHECK(reflected_counts(0, 0) > 65535);
}

TEST_CASE("infrared: each sensor looks where the board has it") {
  const RingModel ring;
  // Sensor, direction seen from above, counter-clockwise from ahead. [AMiRo-OS 1.0, Constants.h]
  const double degrees[] = {157.5, 112.5, 67.5, 22.5, -22.5, -67.5, -112.5, -157.5};
  for (std::size_t i = 0; i < 8; ++i) {
    const Vector place = direction(degrees[i] * degree) * (ring.radius_m + 0.03);
    std::vector<Segment> post;
    add_rectangle(post, place - Vector{0.004, 0.004}, place + Vector{0.004, 0.004});
    const auto counts = ring.read(post, sample({}, 0, false));
    for (std::size_t k = 0; k < 8; ++k) {
      const double above = counts[k] - ring.offset_counts[k];
      if (k == i)
        CHECK(above > 900);
      else
        CHECK(above < 300);
    }
  }
}

TEST_CASE("infrared: a sensor sees along each of its rays, up to 70 degrees to either side, and no further") {
  const RingModel ring;
  for (std::size_t i = 0; i < 8; ++i)
    for (int off_axis = -80; off_axis <= 80; off_axis += 10) {
      CAPTURE(i, off_axis);
      const Vector ray = direction(ring.angle(i) + off_axis * degree);
      const Vector place = direction(ring.angle(i)) * ring.radius_m + ray * 0.03;
      const Vector across = Vector{-ray.y, ray.x} * 0.001;  // no other ray of the sensor meets it
      const std::vector<Segment> post{{place - across, place + across}};
      const double seen = std::abs(off_axis) > 70 ? 0 : reflected_counts(0.03, off_axis * degree);
      CHECK(ring.read(post, sample({}, 0, false))[i] == Approx(ring.offset_counts[i] + seen).margin(0.6));
    }
}

TEST_CASE("infrared: a wall hides what is behind it, noise is the model's") {
  const RingModel ring;
  const std::vector<Segment> one{{{0.15, -1}, {0.15, 1}}};
  std::vector<Segment> both = one;
  both.push_back({{0.2, -1}, {0.2, 1}});
  CHECK(ring.read(one, sample({}, 9)) == ring.read(both, sample({}, 9)));

  const auto counts = statistics(many, [&](std::uint64_t i) { return ring.read({}, sample({}, i))[2]; });
  CHECK(counts.mean == Approx(2420).margin(0.5));
  CHECK(counts.deviation == Approx(4.57).epsilon(0.03));
}

TEST_CASE("infrared: a converter counts from 0 to 65535") {
  const auto ends = [](double offset_counts) {
    RingModel ring;
    ring.offset_counts.fill(offset_counts);
    std::uint16_t least = 65535, most = 0;
    for (std::uint64_t i = 0; i < 100; ++i)
      for (const std::uint16_t counts : ring.read({}, sample({}, i))) {
        least = std::min(least, counts);
        most = std::max(most, counts);
      }
    return std::pair{least, most};
  };
  const auto [least, little] = ends(0);
  CHECK(least == 0);
  CHECK(little < 50);  // no more than noise
  const auto [much, most] = ends(65535);
  CHECK(much > 65'535 - 50);
  CHECK(most == 65535);

  const FloorModel floor;
  Arena arena;
  arena.floor_reflectance = arena.line_reflectance = 0;
  std::uint16_t darkest = 65535;
  for (std::uint64_t i = 0; i < 100; ++i)
    for (const std::uint16_t counts : floor.read(arena, sample({}, i))) darkest = std::min(darkest, counts);
  CHECK(darkest == 0);
  arena.floor_reflectance = arena.line_reflectance = 100;  // more than there can be
  const auto brightest = floor.read(arena, sample({}));
  for (std::size_t i = 0; i < 4; ++i) CHECK(brightest[i] == 65535 - floor.offset_counts[i]);  // it comes off
}

TEST_CASE("floor: dark on the line, bright beside it") {
  const FloorModel floor;
  const Arena arena;
  // On the lower straight, looking along it: the front sensors are 3.5 mm off its middle, the others 32 mm.
  const auto along = floor.read(arena, sample(at(0, -0.4), 0, false));
  CHECK(along[0] == Approx(0.05 * 9426.9).margin(1));
  CHECK(along[3] == along[0]);
  CHECK(along[1] == Approx(0.8 * 9426.9).margin(1));
  CHECK(along[2] == along[1]);

  // 32 mm to the left of the line only the right wheel's sensor is on it; to the right the left wheel's.
  const auto left = floor.read(arena, sample(at(0, -0.4 + 0.032), 0, false));
  CHECK(left[1] < 500);
  CHECK(left[0] > 7000);
  CHECK(left[2] > 7000);
  const auto right = floor.read(arena, sample(at(0, -0.4 - 0.032), 0, false));
  CHECK(right[2] < 500);
  CHECK(right[1] > 7000);

  // Across the line the counts fall and rise without a jump.
  double before = floor.read(arena, sample(at(0, -0.5), 0, false))[0];
  for (double y = -0.5; y < -0.3; y += 0.0005) {
    const double now = floor.read(arena, sample(at(0, y), 0, false))[0];
    REQUIRE(std::abs(now - before) < 500);
    before = now;
  }
}

TEST_CASE("floor: the line is closed") {
  const Arena arena;
  for (int i = 0; i < 360; ++i) {
    const Vector turn = direction(i * degree) * 0.4;
    const Vector place = turn + Vector{turn.x >= 0 ? 0.4 : -0.4, 0};
    CHECK(arena.line.distance(place) < 1e-12);
  }
  CHECK(arena.reflectance({0.2, 0.4}, 0.004) == Approx(0.05));
  CHECK(arena.reflectance({0.2, 0.2}, 0.004) == Approx(0.8));
}

TEST_CASE("no number wraps") {
  CHECK(digits<std::int16_t>(1e300, -32768, 32767) == 32767);
  CHECK(digits<std::int16_t>(-1e300, -32768, 32767) == -32768);
  CHECK(digits<std::uint16_t>(-3, 0, 65535) == 0);
  CHECK(digits<std::uint16_t>(65535.6, 0, 65535) == 65535);
  CHECK(digits<std::int16_t>(std::nan(""), -32768, 32767) == -32768);
  CHECK(digits<std::int16_t>(-0.5, -10, 10) == 0);
}

}  // namespace sim_sensors_test
