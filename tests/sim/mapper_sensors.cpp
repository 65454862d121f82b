#include <cmath>
#include <vector>

#include <catch2/catch.hpp>

#include "sim/mapper/sensors.hpp"
#include "sim/mapper/world_model.hpp"

namespace sim_mapper_sensors_test {

using namespace ocm::sim;
using namespace ocm::sim::mapper;
namespace sensing = ocm::sensing;

struct Statistics {
  double mean = 0;
  double spread = 0;
};

template <class Read>
Statistics statistics(int n, const Read& read) {
  double sum = 0, squares = 0;
  for (int i = 0; i < n; ++i) {
    const double value = read(static_cast<std::uint64_t>(i));
    sum += value;
    squares += value * value;
  }
  const double mean = sum / n;
  return {mean, std::sqrt(squares / n - mean * mean)};
}

constexpr double pi_2 = pi / 2;

/// Without noise, bias and the robot's own field.
constexpr GyroModel quiet_gyro = [] {
  GyroModel gyro;
  gyro.noise_deg_per_s = gyro.driving_noise_deg_per_s = gyro.bias_deg_per_s = gyro.wander_deg_per_s = 0;
  return gyro;
}();
constexpr CompassModel quiet_compass = [] {
  CompassModel compass;
  compass.noise_gauss = compass.own_field_gauss = 0;
  return compass;
}();
constexpr InfraredModel quiet_infrared = [] {
  InfraredModel infrared;
  infrared.noise_v = infrared.offset_spread_v = infrared.slope_spread = 0;
  return infrared;
}();

double quiet_gyro_deg_per_s(double rate_deg_per_s) {
  return gyro_reading(quiet_gyro, {1, 0}, {0, rate_deg_per_s * degree, true}) / degree;
}

TEST_CASE("a gyro says too little, and not by a constant factor") {
  CHECK(quiet_gyro_deg_per_s(0) == 0);
  // 48 * (1 - 0.05 * 48/72), within half a digit.
  CHECK(quiet_gyro_deg_per_s(48) == Approx(46.4).margin(0.005));
  CHECK(quiet_gyro_deg_per_s(-48) == Approx(-46.4).margin(0.005));
  CHECK(quiet_gyro_deg_per_s(24) == Approx(24 * (1 - 0.05 / 2)).margin(0.005));
  const double slow = quiet_gyro_deg_per_s(5) / 5;
  const double fast = quiet_gyro_deg_per_s(100) / 100;
  CHECK(slow < 1);
  CHECK(fast < slow - 0.02);
}

TEST_CASE("a gyro ends at its range and comes in digits") {
  CHECK(quiet_gyro_deg_per_s(1000) == Approx(245).margin(0.01));
  CHECK(quiet_gyro_deg_per_s(-1000) == Approx(-245).margin(0.01));
  CHECK(quiet_gyro_deg_per_s(0.004) == 0);
  CHECK(quiet_gyro_deg_per_s(0.006) == Approx(0.00875));
}

TEST_CASE("a gyro's noise is that of the data sheet at rest, and greater while it drives") {
  const GyroModel model;
  const Noise noise{5, 0};
  const auto read = [&](bool driving) {
    return statistics(20'000, [&](std::uint64_t i) {
      return gyro_reading(model, noise, {i, 0, driving}) / degree;
    });
  };
  CHECK(read(false).spread == Approx(0.10).epsilon(0.05));
  CHECK(read(true).spread == Approx(0.30).epsilon(0.05));
  // Its mean is its bias, which hardly wanders in these 48 s.
  CHECK(read(false).mean == Approx(gyro_bias_deg_per_s(model, noise, 0)).margin(0.1));
}

TEST_CASE("biases differ from robot to robot, and wander by degrees a minute") {
  const GyroModel model;
  const auto biases = statistics(2000, [&](std::uint64_t seed) {
    return gyro_bias_deg_per_s(model, Noise{seed, 0}, 0);
  });
  CHECK(std::abs(biases.mean) < 0.4);  // 5 * 3.3/sqrt(2000)
  CHECK(biases.spread == Approx(3.3).epsilon(0.1));
  // What a minute without knowing adds up to: 0.03 deg/s * 60 s = 1.8 degrees, of the size of 1 to 3.
  const auto drift_deg = statistics(2000, [&](std::uint64_t seed) {
    double angle = 0;
    for (int s = 0; s < 60; ++s)
      angle += gyro_bias_deg_per_s(model, Noise{seed, 0}, s) - gyro_bias_deg_per_s(model, Noise{seed, 0}, 0);
    return angle;
  });
  CHECK(drift_deg.spread > 1.0);
  CHECK(drift_deg.spread < 3.0);
}

TEST_CASE("a bias goes from minute to minute in a straight line") {
  const GyroModel model;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Noise noise{seed, 0};
    const auto at = [&](double time_s) { return gyro_bias_deg_per_s(model, noise, time_s); };
    for (const double minute : {0.0, 60.0, 600.0}) {
      CHECK(at(minute + 30) == Approx((at(minute) + at(minute + 60)) / 2).epsilon(1e-9));
      CHECK(at(minute + 15) == Approx((3 * at(minute) + at(minute + 60)) / 4).epsilon(1e-9));
      CHECK(at(minute) != at(minute + 60));
    }
  }
  // And a reading has that of its time: sample 24958 of 2404 us is at 59.999 s.
  GyroModel quiet = model;
  quiet.noise_deg_per_s = 0;
  const Noise noise{3, 0};
  CHECK(gyro_reading(quiet, noise, {24'958, 0, false}) / degree ==
        Approx(gyro_bias_deg_per_s(model, noise, 60)).margin(0.00875));
}

TEST_CASE("a compass's axes, and those of its own field, are noisy each by itself") {
  const CompassModel model;
  double own = 0, noise_of_both = 0, squares = 0;
  constexpr int n = 5000;
  for (std::uint64_t i = 0; i < n; ++i) {
    const Vector field = own_field(model, {i, 1});
    own += field.x * field.y / (0.05 * 0.05) / n;
    const Noise noise{7, 1};
    const Vector bias = own_field(model, noise);
    const sensing::Field read = compass_reading(model, noise, {i, {0, 0}, 0});
    noise_of_both += (read.x - bias.x) * (read.y - bias.y) / (0.002 * 0.002) / n;
    squares += std::pow(read.y - bias.y, 2) / n;
  }
  CHECK(std::abs(own) < 5 / std::sqrt(n));
  CHECK(std::abs(noise_of_both) < 5 / std::sqrt(n));
  CHECK(std::sqrt(squares) == Approx(0.002).epsilon(0.1));
}

TEST_CASE("the noise of a compass does not come again after 256 samples") {
  const CompassModel model;
  const Noise noise{7, 1};
  int different = 0;
  for (std::uint64_t i = 0; i < 100; ++i)
    different += compass_reading(model, noise, {i, {0, 0}, 0}).x !=
                 compass_reading(model, noise, {i + 256, {0, 0}, 0}).x;
  CHECK(different > 30);
}

TEST_CASE("a compass has the field in its robot's frame") {
  const auto read = [](Vector field, double heading) {
    return compass_reading(quiet_compass, {1, 1}, {0, field, heading});
  };
  const auto along = [](float is, double should) {
    CHECK(is == Approx(should).margin(0.0005));
  };                                                   // half a count
  const sensing::Field ahead = read({0, 0.14}, pi_2);  // looks north
  along(ahead.x, 0.14);
  along(ahead.y, 0);
  const sensing::Field left = read({0, 0.14}, 0);  // looks east: north is to the left
  along(left.x, 0);
  along(left.y, 0.14);
  const sensing::Field right = read({0, 0.14}, pi);  // looks west
  along(right.y, -0.14);
  CHECK(read({9, 0}, 0).x == Approx(2047 / 1090.0));
  CHECK(read({-9, 0}, 0).x == Approx(-2048 / 1090.0));
}

TEST_CASE("a compass is a degree or so uncertain in Trondheim's field, about its own robot's") {
  const CompassModel model;
  const Noise noise{9, 1};
  const Vector own = own_field(model, noise);
  const auto heading_deg = statistics(5000, [&](std::uint64_t i) {
    const sensing::Field field = compass_reading(model, noise, {i, {0.14, 0}, 0});
    return std::atan2(field.y - own.y, field.x - own.x) / degree;
  });
  CHECK(std::abs(heading_deg.mean) < 0.1);
  CHECK(heading_deg.spread == Approx(0.82).epsilon(0.1));  // 2 mG / 140 mG
  const auto strength = statistics(2000, [&](std::uint64_t seed) { return own_field(model, {seed, 1}).x; });
  CHECK(strength.spread == Approx(0.05).epsilon(0.1));
}

TEST_CASE("an anomaly is strongest in its middle, and ends without a step or a kink") {
  const Anomaly anomaly{{1, 2}, 0.5, {0.1, -0.2}};
  CHECK(anomaly.field_at({1, 2}) == Vector{0.1, -0.2});
  // Half way: (1 - 1/4)^2 = 0.5625.
  CHECK(anomaly.field_at({1.25, 2}).x == Approx(0.05625));
  CHECK(anomaly.field_at({1, 1.75}).y == Approx(-0.1125));
  CHECK(anomaly.field_at({1.5, 2}) == Vector{});
  CHECK(anomaly.field_at({40, 2}) == Vector{});
  double before = 0.1;
  for (double d = 0; d <= 0.6; d += 0.001) {
    const double now = anomaly.field_at({1 + d, 2}).x;
    CHECK(now <= before);
    CHECK(before - now < 0.0004);  // the steepest slope is 0.1/0.5 * 16/(9*sqrt(3))... below 0.4/m * 1 mm
    before = now;
  }
  WorldModel world;
  world.anomalies = {anomaly};
  CHECK(world.field_at({1, 2}).x == Approx(0.1));
  CHECK(world.field_at({1, 2}).y == Approx(0.14 - 0.2));
  CHECK(world.field_at({9, 9}).y == Approx(0.14));
}

TEST_CASE("a ray meets a disc where geometry says") {
  const Disc disc{{3, 0}, 1};
  CHECK(distance_along({0, 0}, {1, 0}, disc) == Approx(2));
  CHECK(std::isinf(distance_along({0, 0}, {-1, 0}, disc)));
  CHECK(std::isinf(distance_along({0, 1.001}, {1, 0}, disc)));
  CHECK(distance_along({0, 0.6}, {1, 0}, disc) == Approx(3 - 0.8));  // 3-4-5
  CHECK(distance_along({3, 0.5}, {1, 0}, disc) == 0);
}

TEST_CASE("a distance sensor follows its curve, in steps of the converter") {
  const auto volts = [](double metres, std::size_t sensor = 0) {
    return infrared_reading(quiet_infrared, {1, 2}, {0, {metres, metres, metres, metres}}, sensor);
  };
  constexpr double half_step = 5.0 / 1023 / 2;
  CHECK(volts(0.10) == Approx(2.3).margin(half_step));  // [data sheet]
  CHECK(volts(0.80) == Approx(0.4).margin(half_step));
  // 1.9/(1/10 - 1/80) = 21.71 V cm; at 20 cm 2.3 - 21.71/20.
  CHECK(volts(0.20) == Approx(2.3 - 1.0857).margin(half_step));
  CHECK(volts(0.20, 3) == volts(0.20));
  // Nearer than 5 cm like at 80.
  CHECK(volts(0.049) == Approx(0.4).margin(half_step));
  CHECK(volts(0) == Approx(0.4).margin(half_step));
  CHECK(volts(0.051) > 3.0F);
  // Nothing there: below what is useful.
  CHECK(sensing::ir_distance(volts(std::numeric_limits<double>::infinity())).range ==
        sensing::IrRange::nothing);
  CHECK(sensing::ir_distance(volts(0.9)).range == sensing::IrRange::nothing);
  CHECK(sensing::ir_distance(volts(0.35)).distance_cm == Approx(35).margin(0.3));
}

TEST_CASE("distance sensors are a couple of centimetres uncertain, and each has its own small error") {
  const InfraredModel model;
  const Noise noise{4, 2};
  const auto at = [&](double metres) {
    return statistics(5000, [&](std::uint64_t i) {
      return sensing::ir_distance(infrared_reading(model, noise, {i, {metres}}, 0)).distance_cm;
    });
  };
  CHECK(at(0.20).spread == Approx(0.37).epsilon(0.1));  // 0.02 V * d^2 / 21.71 V cm
  CHECK(at(0.40).spread == Approx(1.47).epsilon(0.1));
  const auto biases = statistics(2000, [&](std::uint64_t seed) {
    return infrared_reading(quiet_infrared, {seed, 2}, {0, {0.4}}, 0) -
           infrared_reading(model, {seed, 2}, {0, {0.4}}, 0);
  });
  // Noise 20 mV, offset 10 mV, 2 % of 0.543 V: 25 mV together.
  CHECK(biases.spread == Approx(0.0249).epsilon(0.1));
}

TEST_CASE("each distance sensor of a tower has its own noise and errors, and a range of its converter") {
  const InfraredModel model;
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t b = 0; b < a; ++b) {
      double together = 0, errors = 0;
      constexpr int n = 2000;
      for (std::uint64_t i = 0; i < n; ++i) {
        const auto off = [&](std::uint64_t seed, std::uint64_t number, std::size_t sensor) {
          const InfraredSample sample{number, {0.4, 0.4, 0.4, 0.4}};
          return double{infrared_reading(model, {seed, 2}, sample, sensor)} -
                 double{infrared_reading(quiet_infrared, {seed, 2}, sample, sensor)};
        };
        const double first = off(5, i, a) - off(5, i + 1, a), second = off(5, i, b) - off(5, i + 1, b);
        together += first * second / (2 * 0.02 * 0.02) / n;
        errors += off(i, 0, a) * off(i, 0, b) / (0.025 * 0.025) / n;
      }
      CHECK(std::abs(together) < 0.15);
      CHECK(std::abs(errors) < 0.15);
    }
  InfraredModel loud = quiet_infrared;
  loud.offset_spread_v = 100;
  bool low = false, high = false;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const float volts = infrared_reading(loud, {seed, 2}, {0, {0.4}}, 0);
    CHECK((volts >= 0 && volts <= 5.0F));
    low = low || volts == 0;
    high = high || volts == 5.0F;
  }
  CHECK((low && high));
}

TEST_CASE("slow noise goes through its places in straight lines") {
  const Noise noise{2, 7};
  CHECK(slow_noise(noise, 3, 1) == noise.normal(3, 1));
  CHECK(slow_noise(noise, 3.25, 1) == Approx(0.75 * noise.normal(3, 1) + 0.25 * noise.normal(4, 1)));
  CHECK(slow_noise(noise, 3.999999, 1) == Approx(noise.normal(4, 1)).margin(1e-4));
}

}  // namespace sim_mapper_sensors_test
