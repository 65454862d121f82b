#include "ocm/mapper/app/tower.hpp"

#include <limits>

#include <catch2/catch.hpp>

namespace mapper_app_tower_test {

using namespace ocm;
using mapper::app::distance_cm;
using mapper::app::Distances;
using mapper::app::in_the_way;
using motion::Movement;

constexpr auto curve = sensing::typical_ir_curve;

TEST_CASE("mapper tower: volts are whole centimetres, to the nearest", "[mapper_tower]") {
  for (const int cm : {10, 11, 25, 40, 79, 80})
    CHECK(distance_cm(sensing::ir_volts(static_cast<float>(cm)), curve) == cm);
  CHECK(distance_cm(sensing::ir_volts(20.4F), curve) == 20);
  CHECK(distance_cm(sensing::ir_volts(20.6F), curve) == 21);
  CHECK(distance_cm(sensing::ir_volts(90.0F), curve) == 0);  // nothing seen
  CHECK(distance_cm(base::Error::not_sampled, curve) == 0);
  CHECK(distance_cm(std::numeric_limits<float>::quiet_NaN(), curve) == 0);
}

// [T2 table 4.4]
TEST_CASE("mapper tower: an update in centimetres and degrees, to the nearest", "[mapper_tower]") {
  const auto update =
      mapper::app::update({1.234F, -0.456F, motion::radians(-89.6F)}, 30, Distances{1, 2, 3, 4});
  REQUIRE(update.ok());
  CHECK(*update == mapper::link::Update{123, -46, -90, 30, 1, 2, 3, 4});
  CHECK(mapper::link::write(*update)->view() == "{U,123,-46,-90,30,1,2,3,4}\n");
  CHECK(mapper::app::update({0, 0, motion::pi}, 0, {})->heading == 180);
}

TEST_CASE("mapper tower: a place that no sentence holds is refused, not clipped", "[mapper_tower]") {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  for (const motion::Pose pose : {motion::Pose{328, 0, 0}, motion::Pose{0, -1e9F, 0}, motion::Pose{nan, 0, 0},
                                  motion::Pose{0, nan, 0}, motion::Pose{0, 0, nan}})
    CHECK(mapper::app::update(pose, 0, {}).error == base::Error::out_of_range);
  CHECK(mapper::app::update({327, -327, 0}, 0, {})->x == 32700);
  CHECK(mapper::app::update({327, -327, 0}, 0, {})->y == -32700);
}

/// Forward, left, backward, right.
constexpr Distances wall_ahead{12, 0, 0, 0};
constexpr Distances wall_to_the_right{0, 0, 0, 12};
constexpr Distances wall_behind{0, 0, 12, 0};
constexpr Distances wall_to_the_left{0, 12, 0, 0};

// [T2 listing 8.2]
TEST_CASE("mapper tower: what is in the way, by where the tower looks", "[mapper_tower]") {
  constexpr auto ahead = [](int servo, const Distances& seen) {
    return in_the_way(Movement::straight, false, servo, seen, 15);
  };
  CHECK(ahead(0, wall_ahead));
  CHECK(ahead(30, wall_ahead));
  CHECK_FALSE(ahead(31, wall_ahead));
  CHECK_FALSE(ahead(90, wall_ahead));
  CHECK(ahead(60, wall_to_the_right));
  CHECK(ahead(90, wall_to_the_right));
  CHECK_FALSE(ahead(59, wall_to_the_right));
  CHECK_FALSE(ahead(0, wall_behind));
  CHECK_FALSE(ahead(90, wall_to_the_left));
  CHECK_FALSE(ahead(0, Distances{15, 0, 0, 0}));
  CHECK(ahead(0, Distances{14, 0, 0, 0}));
  CHECK_FALSE(ahead(0, Distances{}));
}

TEST_CASE("mapper tower: driving back, it is what is behind", "[mapper_tower]") {
  constexpr auto behind = [](int servo, const Distances& seen) {
    return in_the_way(Movement::straight, true, servo, seen, 15);
  };
  CHECK(behind(0, wall_behind));
  CHECK(behind(90, wall_to_the_left));
  CHECK_FALSE(behind(0, wall_ahead));
  CHECK_FALSE(behind(90, wall_to_the_right));
}

TEST_CASE("mapper tower: who stands or rotates hits nothing", "[mapper_tower]") {
  for (const Movement movement : {Movement::standing, Movement::rotating})
    CHECK_FALSE(in_the_way(movement, false, 0, wall_ahead, 15));
}

}  // namespace mapper_app_tower_test
