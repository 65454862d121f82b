#include "ocm/sensing/homing.hpp"

#include <cmath>
#include <limits>

#include <catch2/catch.hpp>

#include "ocm/sensing/avoidance.hpp"

namespace sensing_homing_test {

using namespace ocm::sensing;

constexpr HomingModel model{};
constexpr std::uint16_t none = ring_range_mm;
constexpr RingDistances nothing{none, none, none, none, none, none, none, none};
/// A flat wall straight ahead, so far from the robot's edge.
constexpr RingDistances wall_ahead(float distance_m) {
  RingDistances ring = nothing;
  ring[3] = ring[4] =
      static_cast<std::uint16_t>((distance_m + model.behind_m) * model.seen_part * 1000.0F + 0.5F);
  return ring;
}
constexpr HomingStep step(const RingDistances& ring, Homing state = {}, float most = 0.1F) {
  return home(state, ring, 0.05F, most, 0.05F, model);
}

static_assert(most_delay_s(model) >= most_delay_s(AvoidanceModel{}));

// Nothing in sight: straight on, faster and faster up to what is asked.
static_assert(step(nothing).command.speed_m_s == 0.025F && step(nothing).command.turn_rad_s == 0.0F);
static_assert(step(nothing, {.speed_m_s = 0.1F}).command.speed_m_s == 0.1F);
static_assert(step(nothing, step(nothing).state).command.speed_m_s == 0.05F);
// Ahead: towards it, in proportion; away from it where it is too near; no nearer than is kept.
static_assert(step(wall_ahead(0.08F), {.speed_m_s = 0.1F}).command.speed_m_s < 0.0315F);
static_assert(step(wall_ahead(0.08F), {.speed_m_s = 0.1F}).command.speed_m_s > 0.0285F);
static_assert(step(wall_ahead(0.03F)).command.speed_m_s < -0.018F);
// From full speed to rest at once, and from there backwards as fast as from rest.
static_assert(step(wall_ahead(0.005F), {.speed_m_s = 0.1F}).command.speed_m_s == -0.025F);
static_assert(step(wall_ahead(0.005F), {.speed_m_s = -0.025F}).command.speed_m_s < -0.04F);
static_assert(step(wall_ahead(0.051F)).state.arrived && !step(wall_ahead(0.056F)).state.arrived);
static_assert(step(wall_ahead(0.051F)).command.speed_m_s == 0.0F);
// Beside and behind: on the spot, to its side.
constexpr RingDistances at(std::size_t sensor) {
  RingDistances ring = nothing;
  ring[sensor] = 60;
  return ring;
}
static_assert(step(at(2)).command.turn_rad_s > 1.0F && step(at(2)).command.speed_m_s == 0.0F);
static_assert(step(at(5)).command.turn_rad_s < -1.0F && step(at(5)).command.speed_m_s == 0.0F);
static_assert(step(at(0)).command.turn_rad_s == model.most_turn_rad_s);
static_assert(step(at(7)).command.turn_rad_s == -model.most_turn_rad_s);
// The nearer counts for more.
constexpr RingDistances between{none, none, 60, none, none, 120, none, none};
static_assert(step(between).command.turn_rad_s > 0.0F);

// By how much, with the length that is within 12 %: of sensor 3 alone 0.3827 / (0.9239 + 0.3827 / 2), of both
// sides of `between` (1/60^2 - 1/120^2) * 0.9239 / (that + (1/60^2 + 1/120^2) * 0.3827 / 2); twice that a
// second.
constexpr bool turns_by(const RingDistances& ring, float rad_s) {
  const float off = step(ring).command.turn_rad_s - rad_s;
  return off < 2e-3F && off > -2e-3F;
}
static_assert(turns_by(at(3), 0.6863F) && turns_by(at(4), -0.6863F) && turns_by(between, 1.4868F));
static_assert(turns_by(at(2), 1.5F) && turns_by(at(5), -1.5F) && turns_by(at(1), 1.5F) &&
              turns_by(at(6), -1.5F));
static_assert(step(at(3), {.speed_m_s = 0.1F}).command.speed_m_s < 0.01F, "it drives, too: 3.3 mm are left");
// A sensor that says 0 says nothing.
constexpr RingDistances silent{0, 0, none, none, none, none, 0, none};
static_assert(step(silent).command.speed_m_s == 0.025F && step(silent).command.turn_rad_s == 0.0F);
// A wall that is gone is looked for; one that was arrived at and is behind now is another.
static_assert(!step(nothing, {.arrived = true}).state.arrived);
static_assert(step(nothing, {.arrived = true}).command.speed_m_s == 0.025F);
// What was beyond for a while and is within again begins from zero.
static_assert(step(wall_ahead(0.05F), {.beyond_s = 0.45F, .arrived = true}).state.beyond_s == 0.0F);
static_assert(step(wall_ahead(0.08F), {.beyond_s = 0.25F, .arrived = true}).state.arrived);
static_assert(!step(wall_ahead(0.08F), {.beyond_s = 0.5F, .arrived = true}).state.arrived);
static_assert(!step(wall_ahead(0.08F), {.beyond_s = 0.25F}).state.arrived, "only who had arrived stays so");
// The longest delay is that of the quicker of both loops.
static_assert(most_delay_s(model) > 0.1839F && most_delay_s(model) < 0.184F);
static_assert(most_delay_s(HomingModel{.gain_per_s = 4.0F}) > 0.0919F &&
              most_delay_s(HomingModel{.gain_per_s = 4.0F}) < 0.092F);
static_assert(!Homing{}.arrived && Homing{}.speed_m_s == 0.0F && Homing{}.beyond_s == 0.0F &&
              Homing{}.rejected == 0);

TEST_CASE("home: having arrived it moves no wheel before it is well off for half a second") {
  Homing state = step(wall_ahead(0.05F)).state;
  REQUIRE(state.arrived);
  for (int i = 0; i < 100; ++i) {
    const HomingStep next = step(wall_ahead(0.05F + (i % 2 == 0 ? 0.012F : 0.02F)), state);
    CHECK(next.state.arrived);
    CHECK(next.command.speed_m_s == 0.0F);
    state = next.state;
  }
  state = step(wall_ahead(0.05F), state).state;
  int steps = 0;
  while (state.arrived && steps < 100) state = step(wall_ahead(0.08F), state).state, ++steps;
  CHECK(steps >= 10);
  CHECK(steps <= 11);  // tenths and twentieths are no binary fractions
}

TEST_CASE("home: rest for what is no speed and no time, and both are counted") {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK(home({}, nothing, 0.05F, nan, 0.05F, model).state.rejected == 1);
  CHECK(home({}, nothing, nan, 0.1F, 0.05F, model).state.rejected == 1);
  CHECK(home({}, nothing, 0.05F, -0.1F, 0.05F, model).state.rejected == 1);
  const HomingStep rest = home({.speed_m_s = 0.1F}, nothing, 0.05F, 0.1F, 0.0F, model);
  CHECK(rest.state.rejected == 1);
  CHECK(rest.command.speed_m_s == 0.0F);
  CHECK(step(at(2), {}, 0.0F).command.turn_rad_s == 0.0F);
}

}  // namespace sensing_homing_test
