#include "sim/physics/noise.hpp"

#include <cmath>

#include <catch2/catch.hpp>

namespace sim_noise_test {

using ocm::sim::Noise;

TEST_CASE("noise is a function of seed, part, sample and channel") {
  constexpr Noise noise{7, 2};
  static_assert(noise.normal(5, 1) == Noise{7, 2}.normal(5, 1));
  static_assert(noise.normal(5, 1) != noise.normal(6, 1));
  static_assert(noise.normal(5, 1) != noise.normal(5, 2));
  static_assert(noise.normal(5, 1) != noise.normal(6, 0));  // no channel is another one's future
  static_assert(noise.normal(5, 1) != Noise{7, 3}.normal(5, 1));
  static_assert(noise.normal(5, 1) != Noise{8, 2}.normal(5, 1));
}

TEST_CASE("noise has mean 0, variance 1, and no memory") {
  constexpr int n = 100'000;
  constexpr Noise noise{1, 0};
  double sum = 0, squares = 0, neighbours = 0, channels = 0, fourth = 0;
  int beyond_two = 0;
  for (unsigned i = 0; i < n; ++i) {
    const double z = noise.normal(i, 0);
    sum += z;
    squares += z * z;
    fourth += z * z * z * z;
    neighbours += z * noise.normal(i + 1, 0);
    channels += z * noise.normal(i, 1);
    beyond_two += std::abs(z) > 2;
  }
  // Five standard errors each: 1/sqrt(n) of a mean and of a correlation, sqrt(1.9/n) of a variance.
  CHECK(std::abs(sum / n) < 5 / std::sqrt(n));
  CHECK(std::abs(squares / n - 1) < 5 * std::sqrt(1.9 / n));
  CHECK(std::abs(neighbours / n) < 5 / std::sqrt(n));
  CHECK(std::abs(channels / n) < 5 / std::sqrt(n));
  // The sum of twelve uniform numbers has kurtosis 3 - 1.2/12.
  CHECK(fourth / n == Approx(2.9).margin(0.15));
  CHECK(beyond_two / double{n} == Approx(0.0455).margin(0.004));  // that of the normal distribution
}

}  // namespace sim_noise_test
