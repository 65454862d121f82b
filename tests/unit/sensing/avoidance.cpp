#include "ocm/sensing/avoidance.hpp"

#include <limits>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"
#include "unit/motion/near.hpp"

namespace sensing_avoidance_test {

using namespace ocm::sensing;
using ocm::motion::Twist;
using ocm::test::near;
using ocm::test::Random;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float dt_s = 0.05F;
constexpr AvoidanceModel model{};
constexpr RingDistances nothing{200, 200, 200, 200, 200, 200, 200, 200};

/// With something at so many mm before these sensors.
template <class... Sensors>
constexpr RingDistances near_to(std::uint16_t mm, Sensors... sensors) {
  RingDistances ring = nothing;
  ((ring[static_cast<std::size_t>(sensors)] = mm), ...);
  return ring;
}
constexpr Avoidance at_speed{.speed_m_s = 0.2F};

// Nothing near: straight on, on a ramp of 0.5 m/s2.
static_assert(near(avoid({}, nothing, 0.2F, dt_s, model).command.speed_m_s, 0.025F));
static_assert(avoid(at_speed, nothing, 0.2F, dt_s, model).command == Twist{0.2F, 0.0F});
// 100 mm ahead leave 55 mm: 0.11 m/s at 2/s, at once.
static_assert(near(avoid(at_speed, near_to(100, 3, 4), 0.2F, dt_s, model).command.speed_m_s, 0.11F));
static_assert(avoid(at_speed, near_to(100, 3, 4), 0.2F, dt_s, model).command.turn_rad_s == 0.0F);
// Something to the left turns it to the right, and the other way round; behind it nothing matters.
static_assert(avoid(at_speed, near_to(100, 2), 0.2F, dt_s, model).command.turn_rad_s < 0.0F);
static_assert(avoid(at_speed, near_to(100, 5), 0.2F, dt_s, model).command.turn_rad_s > 0.0F);
static_assert(avoid(at_speed, near_to(5, 0, 1, 6, 7), 0.2F, dt_s, model).command == Twist{0.2F, 0.0F});
// Too near: on the spot, towards the freer side.
constexpr AvoidanceStep blocked = avoid(at_speed, near_to(60, 2, 3, 4), 0.2F, dt_s, model);
static_assert(blocked.command == Twist{0.0F, -2.0F} && blocked.state.turning == -1);
static_assert(avoid(at_speed, near_to(60, 3, 4, 5), 0.2F, dt_s, model).command == Twist{0.0F, 2.0F});
// It keeps to that side, whatever it sees meanwhile, until there is room.
static_assert(avoid(blocked.state, near_to(100, 3, 4, 5), 0.2F, dt_s, model).command == Twist{0.0F, -2.0F});
static_assert(avoid(blocked.state, near_to(110, 3, 4), 0.2F, dt_s, model).state.turning == -1);
static_assert(avoid(blocked.state, near_to(111, 3, 4), 0.2F, dt_s, model).state.turning == 0);
// All but touched beside: it stands where it would turn too late.
static_assert(avoid(at_speed, near_to(15, 2), 0.2F, dt_s, model).command.speed_m_s == 0.0F);

// By how much: 100 mm at one side, of 200 that are seen, is half of the turn; 50 mm beside leave 35 mm.
static_assert(near(avoid(at_speed, near_to(100, 2), 0.2F, dt_s, model).command.turn_rad_s, -1.0F));
static_assert(near(avoid(at_speed, near_to(100, 5), 0.2F, dt_s, model).command.turn_rad_s, 1.0F));
static_assert(near(avoid(at_speed, near_to(50, 2), 0.2F, dt_s, model).command.speed_m_s, 0.07F));
static_assert(near(avoid(at_speed, near_to(50, 5), 0.2F, dt_s, model).command.speed_m_s, 0.07F));
static_assert(avoid(at_speed, near_to(75, 3, 4), 0.2F, dt_s, model).state.turning == 0 &&
              avoid(at_speed, near_to(74, 3), 0.2F, dt_s, model).state.turning == -1 &&
              avoid(at_speed, near_to(74, 4), 0.2F, dt_s, model).state.turning == 1);
// Which side is freer is a matter of all four sensors of it; of two that are as free it is the left one.
constexpr std::int8_t side_with(std::size_t sensor) {
  RingDistances ring = near_to(60, 3, 4);
  ring[sensor] = 50;
  return avoid(at_speed, ring, 0.2F, dt_s, model).state.turning;
}
static_assert(side_with(0) == -1 && side_with(1) == -1 && side_with(2) == -1 && side_with(3) == -1);
static_assert(side_with(4) == 1 && side_with(5) == 1 && side_with(6) == 1 && side_with(7) == 1);
static_assert(avoid(at_speed, near_to(60, 3, 4), 0.2F, dt_s, model).state.turning == 1);
// Behind a turn, and behind a step without numbers, it sets off on the ramp.
constexpr Avoidance free_again = avoid(blocked.state, nothing, 0.2F, dt_s, model).state;
static_assert(near(free_again.speed_m_s, 0.025F) && free_again.turning == 0);
static_assert(near(
    avoid(avoid(at_speed, nothing, nan, dt_s, model).state, nothing, 0.2F, dt_s, model).command.speed_m_s,
    0.025F));
static_assert(avoid(at_speed, nothing, 0.0F, dt_s, model).state.rejected == 0, "no speed is one, too");
static_assert(Avoidance{}.speed_m_s == 0.0F && Avoidance{}.turning == 0 && Avoidance{}.rejected == 0);

// At rest, and without numbers.
static_assert(avoid(at_speed, nothing, 0.0F, dt_s, model).command == Twist{});
static_assert(avoid(blocked.state, near_to(60, 3), 0.0F, dt_s, model).command == Twist{});
static_assert(avoid(at_speed, nothing, nan, dt_s, model).command == Twist{});
static_assert(avoid(at_speed, nothing, -0.1F, dt_s, model).state.rejected == 1);
static_assert(avoid(at_speed, nothing, 0.2F, 0.0F, model).state.rejected == 1);

static_assert(near(most_delay_s(model), 0.18394F, 1e-4F));

TEST_CASE(
    "a robot that stops for a wall does not touch it, up to the longest delay; with three times that it "
    "does") {
  const auto nearest_mm = [](float delay_s) {
    constexpr float step_s = 0.001F;
    constexpr std::size_t most = 1000;
    std::array<float, most> speeds{};  // of the last steps
    const auto delay = static_cast<std::size_t>(delay_s / step_s);
    AvoidanceModel straight = model;
    straight.turn_below_m = 0.0F;
    Avoidance state{.speed_m_s = 0.2F};
    speeds.fill(0.2F);
    float distance_m = 0.4F;
    float nearest_m = distance_m;
    for (std::size_t i = 0; i < 10'000; ++i) {
      const float seen_mm = distance_m * 1000.0F;
      const auto mm = static_cast<std::uint16_t>(seen_mm > 200.0F ? 200.0F : seen_mm < 0.0F ? 0.0F : seen_mm);
      const AvoidanceStep step = avoid(state, near_to(mm, 3, 4), 0.2F, step_s, straight);
      state = step.state;
      speeds[i % most] = step.command.speed_m_s;
      distance_m -= speeds[(i + most - delay) % most] * step_s;
      if (distance_m < nearest_m) nearest_m = distance_m;
    }
    return nearest_m * 1000.0F;
  };
  CHECK(nearest_mm(most_delay_s(model)) > 40.0F);
  CHECK(nearest_mm(3.0F * most_delay_s(model)) < 20.0F);
}

TEST_CASE("any distances leave the command within its bounds, and no way ahead is never taken") {
  Random random{4};
  Avoidance state;
  for (int i = 0; i < 50'000; ++i) {
    RingDistances ring;
    for (auto& distance : ring) distance = static_cast<std::uint16_t>(random.below(201));
    const AvoidanceStep step = avoid(state, ring, 0.2F, dt_s, model);
    REQUIRE(step.command.speed_m_s >= 0.0F);
    REQUIRE(step.command.speed_m_s <= 0.2F);
    REQUIRE(ocm::motion::magnitude(step.command.turn_rad_s) <= 2.0F);
    if (ring[3] <= 45 || ring[4] <= 45 || ring[2] <= 15 || ring[5] <= 15)
      REQUIRE(step.command.speed_m_s == 0.0F);
    state = step.state;
  }
}

}  // namespace sensing_avoidance_test
