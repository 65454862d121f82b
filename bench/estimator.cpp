// One step of the mapper's pose estimator on this machine, in ns: readings of a robot that drives, turns
// and stands in turn, each step from the state of the last.
#include <cmath>
#include <cstdio>
#include <vector>

#include "ocm/motion/pose_estimator.hpp"

#include "bench/best_of.hpp"
#include "tests/unit/base/random.hpp"

namespace {

using namespace ocm::motion;

constexpr float dt_s = 0.030F;

/// One tick is 1 mm, the wheels stand 100 mm apart.
constexpr EstimatorModel both{
    .drive = {0.1F / two_pi, 0.1F, 100.0F},
    .heading = {.gyro_variance_rad2_per_s = 0.001F, .wheel_variance_rad2_per_s = 0.0004F},
    .most_ticks = 100,
    .compass_variance_rad2 = 10.0F};

std::vector<EstimatorReadings> make_readings(std::size_t count) {
  ocm::test::Random random{1};
  const auto noise = [&] { return static_cast<float>(random.within(-100, 100)) * 1e-4F; };
  std::vector<EstimatorReadings> readings(count);
  EstimatorReadings now;
  for (std::size_t i = 0; i < count; ++i) {
    constexpr Movement movements[] = {Movement::straight, Movement::rotating, Movement::standing};
    now.movement = movements[i / 50 % 3];
    const auto ticks = static_cast<std::uint32_t>(random.within(15, 25));
    if (now.movement == Movement::straight) now.left_ticks += ticks;
    if (now.movement == Movement::rotating) now.left_ticks -= ticks;
    if (now.movement != Movement::standing) now.right_ticks += ticks;
    now.gyro_rad_s = (now.movement == Movement::rotating ? 1.3F : 0.0F) + noise();
    now.compass_rad = noise();
    readings[i] = now;
  }
  return readings;
}

/// ns a step. false: the pose went astray.
bool measure(const char* what, const EstimatorModel& model, const std::vector<EstimatorReadings>& readings) {
  Estimate state;
  const double us = ocm::bench::best_of(200, [&] {
    state = {};
    for (const auto& reading : readings) state = estimate(state, reading, dt_s, model);
  });
  std::printf("%-16s best %5.1f ns a step\n", what, us * 1e3 / static_cast<double>(readings.size()));
  return std::isfinite(state.pose.x_m) && state.pose.x_m != 0.0F && state.rejected == EstimatorCounters{};
}

}  // namespace

int main() {
  const auto readings = make_readings(20'000);
  const bool done = measure("wheels and gyro", both, readings) &&
                    measure("gyro, compass", gyro_and_compass(both), readings);
  if (!done) std::fputs("estimator: the pose went astray\n", stderr);
  return done ? 0 : 1;
}
