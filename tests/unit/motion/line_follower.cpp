#include "ocm/motion/line_follower.hpp"

#include <limits>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"
#include "unit/motion/near.hpp"

namespace motion_line_follower_test {

using namespace ocm::motion;
using ocm::test::near;
using ocm::test::Random;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float dt_s = 0.02F;
constexpr LineFollowerModel model{
    .ahead_m = 0.04F, .apart_m = 0.008F, .spot_radius_m = 0.004F, .half_line_m = 0.01F, .wheelbase_m = 0.07F};
static_assert(near(greatest_offset_m(model), 0.018F));

/// A floor of 1000 counts with a black line this far to the left of the middle.
constexpr FloorView over(float offset_m, std::uint16_t floor = 1000) {
  const auto at = [offset_m, floor](float place_m) {
    const float inside = model.half_line_m + model.spot_radius_m - magnitude(place_m - offset_m);
    const float dark = clamp(inside / (2.0F * model.spot_radius_m), 0.0F, 1.0F);
    return static_cast<std::uint16_t>(static_cast<float>(floor) * (1.0F - 0.95F * dark));
  };
  return {at(model.apart_m / 2.0F), at(-model.apart_m / 2.0F), at(0.032F), at(-0.032F)};
}

// In the middle nothing is to be done; to one side and the other the same, with its sign.
static_assert(line_offset(over(0.0F), model).seen && line_offset(over(0.0F), model).offset_m == 0.0F);
static_assert(near(line_offset(over(0.006F), model).offset_m, 0.006F, 0.001F));
static_assert(near(line_offset(over(-0.006F), model).offset_m, -0.006F, 0.001F));
static_assert(near(line_offset(over(0.015F), model).offset_m, 0.015F, 0.002F));
static_assert(!line_offset(over(0.019F), model).seen);
// The floor's brightness does not matter, as long as there is a floor.
static_assert(near(line_offset(over(0.008F, 5000), model).offset_m,
                   line_offset(over(0.008F, 500), model).offset_m, 2e-4F));
static_assert(!line_offset(over(0.008F, 100), model).seen, "held up");
static_assert(line_offset(over(0.0F, 200), model).seen && !line_offset(over(0.0F, 199), model).seen);
static_assert(!line_offset({1000, 950, 1000, 1000}, model).seen, "a smudge");
// 0.15 of what is on the line in full, nine tenths of the floor: 865 of 1000 counts.
static_assert(line_offset({864, 1000, 1000, 1000}, model).seen &&
              !line_offset({866, 866, 1000, 1000}, model).seen);
static_assert(line_offset({1000, 864, 1000, 1000}, model).seen, "either of the two is enough");
// The floor is what the brighter of the side sensors sees: the other may be on a mark.
static_assert(line_offset({500, 1000, 1000, 100}, model).offset_m ==
              line_offset({500, 1000, 100, 1000}, model).offset_m);
// In the middle of a grey line both are as dark: no offset, and a count more on one side is none to speak of.
static_assert(line_offset({400, 400, 1000, 1000}, model).offset_m == 0.0F);
static_assert(near(line_offset({400, 404, 1000, 1000}, model).offset_m, 0.0F, 3e-4F) &&
              line_offset({400, 404, 1000, 1000}, model).offset_m > 0.0F &&
              line_offset({404, 400, 1000, 1000}, model).offset_m < 0.0F);
static_assert(near(line_offset({460, 1000, 1000, 1000}, model).offset_m, 0.002F + 1.4F * 0.008F, 1e-5F),
              "the far one sees the floor");
// Black: a tenth brighter is at the end of the flat middle, and a tenth of a spot more.
static_assert(near(line_offset({100, 190, 1000, 1000}, model).offset_m, 0.002F + 0.0008F, 1e-5F));
static_assert(near(line_offset({100, 145, 1000, 1000}, model).offset_m, 0.001F + 0.0004F, 1e-5F));
// A line that is no wider than what the two see has no flat middle: half a spot brighter is half a spot off.
constexpr LineFollowerModel thin{
    .ahead_m = 0.04F, .apart_m = 0.008F, .spot_radius_m = 0.004F, .half_line_m = 0.005F};
static_assert(near(line_offset({100, 550, 1000, 1000}, thin).offset_m, 0.004F));
static_assert(near(line_offset({550, 100, 1000, 1000}, thin).offset_m, -0.004F));
static_assert(!line_offset({}, model).seen && !line_offset({1000, 1000, 1000, 1000}, model).seen);
// What is brighter than the floor is floor, and what is darker than the line is line.
static_assert(near(line_offset({550, 1500, 1000, 1000}, model).offset_m,
                   line_offset({550, 1000, 1000, 1000}, model).offset_m));
static_assert(near(line_offset({0, 550, 1000, 1000}, model).offset_m,
                   line_offset({100, 550, 1000, 1000}, model).offset_m));

constexpr LineFollowerStep step(LineFollower state, float offset_m, float speed_m_s = 0.2F) {
  return control(state, over(offset_m), speed_m_s, dt_s, model);
}

// It sets off on a ramp, 0.5 m/s2, and steers to the side where the line is.
static_assert(near(step({}, 0.0F).command.speed_m_s, 0.01F) && step({}, 0.0F).command.turn_rad_s == 0.0F);
static_assert(step({}, 0.01F).command.turn_rad_s > 0.0F && step({}, -0.01F).command.turn_rad_s < 0.0F);
// The circle through a point 40 mm ahead and 10 mm to the left has a radius of 85 mm.
constexpr LineFollowerStep curve = step({.speed_m_s = 0.05F, .begun = true}, 0.01F);
static_assert(near(curve.command.speed_m_s / curve.command.turn_rad_s, 0.085F, 0.01F));
constexpr float curve_offset_m = curve.state.last_offset_m;
static_assert(near(curve.command.speed_m_s / curve.command.turn_rad_s,
                   (0.04F * 0.04F + curve_offset_m * curve_offset_m) / (2.0F * curve_offset_m)));
// Far off it is slow at once, and never as slow as to stand.
static_assert(step({.speed_m_s = 0.2F, .begun = true}, 0.015F).command.speed_m_s < 0.1F);
static_assert(step({.speed_m_s = 0.2F, .begun = true}, 0.0165F).command.speed_m_s > 0.05F);

// All of the speed in the middle, three tenths where the line is being lost; between, in proportion.
constexpr float speed_at(float offset_m, const LineFollowerModel& with = model) {
  return control({.speed_m_s = 0.5F, .begun = true}, over(offset_m), 0.2F, dt_s, with).command.speed_m_s;
}
static_assert(speed_at(0.0F) == 0.2F);
constexpr float half_way_m = line_offset(over(0.009F), model).offset_m;
static_assert(near(half_way_m, 0.009F, 1e-3F));
static_assert(near(speed_at(0.009F), 0.2F * (1.0F - 0.7F * half_way_m / 0.018F)));
// It gets no slower beyond where the line is being lost: the thin one at 13 mm, and here it is at 14.8.
static_assert(near(
    control({.speed_m_s = 0.5F, .begun = true}, {864, 1000, 1000, 1000}, 0.2F, dt_s, thin).command.speed_m_s,
    0.3F * 0.2F));
static_assert(step({}, 0.0F, 0.0F).command == Twist{} && step({}, 0.0F, 0.0F).state.rejected == 0,
              "no speed is one, too");

// Never seen: it does not set off.
static_assert(step({}, 0.05F).lost && step({}, 0.05F).command == Twist{});
// Lost: it looks where it was.
constexpr LineFollower was_left = step({}, 0.015F).state;
static_assert(!step(was_left, 0.05F).lost && step(was_left, 0.05F).command.turn_rad_s > 0.0F);
static_assert(step(was_left, 0.05F).command.speed_m_s == 0.0F);
constexpr LineFollower was_right = step({}, -0.015F).state;
static_assert(step(was_right, 0.05F).command.turn_rad_s < 0.0F);
static_assert(step(was_left, 0.05F).command.turn_rad_s == 2.0F &&
              step(was_right, 0.05F).command.turn_rad_s == -2.0F);
static_assert(step(step({}, 0.0F).state, 0.05F).command.turn_rad_s == 2.0F,
              "gone from the middle: to the left");
// The time of the search is in it: after half a second of half a second it still looks.
constexpr bool given_up_after(int steps) {
  LineFollowerModel quick = model;
  quick.search_s = 0.5F;
  LineFollowerStep next{was_left, {}, false};
  for (int i = 0; i < steps; ++i) next = control(next.state, over(0.05F), 0.2F, 0.25F, quick);
  return next.lost && next.command == Twist{};
}
static_assert(!given_up_after(2) && given_up_after(3));

// No numbers, no motion; and it is counted.
static_assert(step({}, 0.0F, nan).command == Twist{} && step({}, 0.0F, nan).state.rejected == 1);
static_assert(step({}, 0.0F, -0.1F).state.rejected == 1);
static_assert(control({}, over(0.0F), 0.1F, 0.0F, model).state.rejected == 1);
static_assert(!step({}, 0.0F, nan).lost, "it is not given up");
// Then it sets off again on the ramp.
static_assert(near(step(step({.speed_m_s = 0.2F, .begun = true}, 0.0F, nan).state, 0.0F).command.speed_m_s,
                   0.01F));
static_assert(near(step(step({.speed_m_s = 0.2F, .begun = true}, 0.05F).state, 0.0F).command.speed_m_s,
                   0.01F),
              "and so it does behind a search");

// What begins has seen nothing, and a view without counts is dark.
constexpr LineFollower fresh{};
static_assert(fresh.last_offset_m == 0.0F && fresh.lost_s == 0.0F && fresh.speed_m_s == 0.0F &&
              !fresh.begun && fresh.rejected == 0 && !LineFollowerStep{}.lost);
constexpr FloorView dark{};
static_assert(dark.front_left == 0 && dark.front_right == 0 && dark.side_left == 0 && dark.side_right == 0);
static_assert(greatest_offset_m({}) == 0.01F, "of a line of 2 cm, where nothing is known of the sensors");
static_assert(LineFollowerModel{}.ahead_m == 0.0F && LineFollowerModel{}.wheelbase_m == 0.0F);

TEST_CASE("the offset grows with the offset, without a jump, and has its sign") {
  float before = line_offset(over(-0.0165F), model).offset_m;
  for (float offset = -0.0165F; offset < 0.0165F; offset += 0.0001F) {
    const LineSeen line = line_offset(over(offset), model);
    CAPTURE(offset, line.offset_m);
    REQUIRE(line.seen);
    CHECK(near(line.offset_m, offset, 0.003F));
    CHECK(line.offset_m > before - 0.0003F);
    before = line.offset_m;
  }
}

TEST_CASE("a line that is gone is searched for a second, and then given up") {
  LineFollower state = step({}, 0.015F).state;
  int steps = 0;
  for (; steps < 1000; ++steps) {
    const LineFollowerStep next = step(state, 0.05F);
    state = next.state;
    if (next.lost) break;
  }
  CHECK(near(static_cast<float>(steps) * dt_s, model.search_s, 0.03F));
  state = step({}, 0.015F).state;  // found again, the time starts again
  for (int i = 0; i < 500; ++i) {
    const LineFollowerStep next = step(state, i % 40 == 0 ? 0.015F : 0.05F);
    state = next.state;
    REQUIRE_FALSE(next.lost);
  }
}

TEST_CASE("any counts leave the command within its bounds") {
  Random random{3};
  LineFollower state;
  for (int i = 0; i < 20'000; ++i) {
    const auto any = [&random] {
      return static_cast<std::uint16_t>(random.below(65'536) >> random.below(16));
    };
    const LineFollowerStep next = control(state, {any(), any(), any(), any()}, 0.2F, dt_s, model);
    REQUIRE(next.command.speed_m_s >= 0.0F);
    REQUIRE(next.command.speed_m_s <= 0.2F);
    // Of the tightest circle that can be asked for.
    REQUIRE(
        magnitude(next.command.turn_rad_s) <=
        (next.command.speed_m_s > 0.0F ? next.command.speed_m_s / model.ahead_m : model.search_turn_rad_s) +
            1e-3F);
    state = next.state;
  }
}

}  // namespace motion_line_follower_test
