#include "ocm/cognitive/map.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/cognitive/agreement.hpp"

#include "unit/base/random.hpp"
#include "unit/cognitive/testing/room.hpp"

namespace cognitive_map_test {

using namespace ocm::cognitive;
using ocm::mapper::link::Handshake;
using ocm::mapper::link::Update;
using ocm::motion::Pose;
using ocm::test::Random;
using ocm::test::Room;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

MapOptions cells_of_10_cm() {
  MapOptions options;
  options.resolution_m = 0.10F;
  options.beam.half_width_rad = 0.0F;
  return options;
}
/// The robot stands in the middle of cell 0, 0.
constexpr Pose middle{0.05F, 0.05F, 0.0F};

TEST_CASE("map: one beam by hand") {
  Map map{cells_of_10_cm()};
  // Forward 50 cm: the beam ends at x = 0.55. It frees up to 4 cm before that: cells 0 to 5, but 5 is hit,
  // too.
  REQUIRE(map.take({middle, {}}, {0, 0, 0, 0, 50, 0, 0, 0}));
  CHECK(map.log_odds({3, 0}) == Approx(-0.2F));
  CHECK(map.log_odds({4, 0}) == Approx(-0.2F));
  // 0.5 m is beyond sharp: 0.9 - 0.45 * 0.1 / 0.4.
  CHECK(map.log_odds({5, 0}) == Approx(0.9F - 0.1125F).margin(1e-4));
  CHECK(map.log_odds({6, 0}) == 0.0F);
  CHECK(map.log_odds({4, 1}) == 0.0F);
  // To the left nothing was seen: free for 60 cm, weighing less.
  CHECK(map.log_odds({0, 5}) == Approx(-0.1F));
  CHECK(map.log_odds({0, 7}) == 0.0F);
  CHECK(map.counters().hits == 1);
  CHECK(map.counters().nothing == 3);
  CHECK(map.state({6, 0}) == CellState::unknown);
  CHECK(map.state({4, 0}) == CellState::unknown);  // said once
  REQUIRE(map.take({middle, {}}, {0, 0, 0, 0, 50, 0, 0, 0}));
  CHECK(map.state({4, 0}) == CellState::free);
}

TEST_CASE("map: the tower's place, its servo and the robot's heading are in it") {
  Handshake handshake;
  handshake.width = 16;
  handshake.length = 22;
  handshake.axle_offset = -4;  // the axle is behind the centre
  handshake.tower_offset = 6;
  handshake.sensor2 = 90;
  handshake.sensor3 = 180;
  handshake.sensor4 = 270;
  const Shape shape = shape_of(handshake);
  CHECK(shape.tower.ahead_of_axle_m == Approx(0.10F));
  CHECK(shape.centre_m == Approx(0.04F));
  CHECK(shape.radius_m() == Approx(std::hypot(0.08F, 0.15F)));
  // Heading 90 degrees, servo 30: sensor 4 looks to 270 + 30 + 90 = 30 degrees of the world, from 10 cm
  // ahead.
  Map map{cells_of_10_cm()};
  const float c = std::cos(0.5235988F), s = std::sin(0.5235988F);
  const ocm::motion::Point seen{0.05F + 0.32F * c, 0.05F + 0.10F + 0.32F * s};
  map.take({{0.05F, 0.05F, ocm::motion::pi / 2}, shape}, {0, 0, 90, 30, 0, 0, 0, 32});
  const Cell cell = map.raster().cell(seen);
  CHECK(map.log_odds(cell) > 0.3F);
  CHECK(map.counters().hits == 1);
}

TEST_CASE("map: a handshake that cannot be is not believed, a short one is completed") {
  Handshake wild;
  wild.width = 3000;
  wild.length = -5;
  wild.axle_offset = -32768;
  wild.tower_offset = 32767;
  wild.sensor1 = 32767;
  const Shape shape = shape_of(wild);
  CHECK(shape.width_m == Shape{}.width_m);
  CHECK(shape.length_m == Shape{}.length_m);
  CHECK(shape.tower.ahead_of_axle_m == 0.0F);
  CHECK(std::abs(shape.tower.sensor_heading_deg[0]) < 360.0F);
  Handshake old;
  old.given = 2;
  old.width = 12;
  old.length = 14;
  CHECK(shape_of(old).width_m == Approx(0.12F));
  CHECK(shape_of(old).tower.sensor_heading_deg[1] == 90.0F);
  // What was not given says nothing, whatever stands there.
  old.given = 3;
  old.tower_offset = 50;
  CHECK(shape_of(old).tower.ahead_of_axle_m == Shape{}.tower.ahead_of_axle_m);
  old.given = 4;
  CHECK(shape_of(old).tower.ahead_of_axle_m == Approx(0.5F));
}

TEST_CASE("map: what of a handshake is believed, at its ends, and by how many of its fields were given") {
  const auto shape = [](auto change) {
    Handshake handshake{.width = 10,
                        .length = 20,
                        .axle_offset = -4,
                        .tower_offset = 6,
                        .sensor1 = 361,
                        .sensor2 = 91,
                        .sensor3 = 181,
                        .sensor4 = 271,
                        .sensor_out = 3};
    change(handshake);
    return shape_of(handshake);
  };
  const auto width = [&](int cm) {
    return shape([cm](Handshake& h) { h.width = static_cast<std::int16_t>(cm); }).width_m;
  };
  const auto length = [&](int cm) {
    return shape([cm](Handshake& h) { h.length = static_cast<std::int16_t>(cm); }).length_m;
  };
  for (const auto& of : {std::function<float(int)>{width}, std::function<float(int)>{length}}) {
    CHECK(of(1) == Approx(0.01F));
    CHECK(of(100) == Approx(1.0F));
    for (const int wrong : {0, -1, 101}) CHECK(of(wrong) == of(-5));
  }
  CHECK(width(0) == Shape{}.width_m);
  CHECK(length(0) == Shape{}.length_m);
  const auto centre = [&](int cm) {
    return shape([cm](Handshake& h) { h.axle_offset = static_cast<std::int16_t>(cm), h.tower_offset = 0; });
  };
  for (const int cm : {-100, -1, 1, 100}) {
    CHECK(centre(cm).centre_m == Approx(-static_cast<float>(cm) / 100));
    CHECK(centre(cm).tower.ahead_of_axle_m == Approx(-static_cast<float>(cm) / 100));
  }
  for (const int cm : {-101, 101}) {
    CHECK(centre(cm).centre_m == 0.0F);
    CHECK(centre(cm).tower.ahead_of_axle_m == Shape{}.tower.ahead_of_axle_m);
  }
  const auto ahead = [&](int cm) {
    return shape([cm](Handshake& h) { h.tower_offset = static_cast<std::int16_t>(cm); })
        .tower.ahead_of_axle_m;
  };
  CHECK(ahead(100) == Approx(1.04F));
  CHECK(ahead(-100) == Approx(-0.96F));
  for (const int cm : {-101, 101}) CHECK(ahead(cm) == Shape{}.tower.ahead_of_axle_m);
  const auto out = [&](int cm) {
    return shape([cm](Handshake& h) { h.sensor_out = static_cast<std::int16_t>(cm); }).tower.sensor_out_m;
  };
  CHECK(out(0)[3] == 0.0F);
  CHECK(out(100)[0] == Approx(1.0F));
  // So many were given: width, length, axle, tower, then, all at once, where the sensors look, and at last
  // how far out.
  const Shape usual;
  for (int given = 0; given <= 11; ++given) {
    CAPTURE(given);
    const Shape it = shape([given](Handshake& h) { h.given = static_cast<std::uint8_t>(given); });
    CHECK(it.width_m == Approx(given >= 1 ? 0.10F : usual.width_m));
    CHECK(it.length_m == Approx(given >= 2 ? 0.20F : usual.length_m));
    CHECK(it.centre_m == Approx(given >= 3 ? 0.04F : usual.centre_m));
    CHECK(it.tower.ahead_of_axle_m == Approx(given >= 4 ? 0.10F : usual.tower.ahead_of_axle_m));
    for (std::size_t i = 0; i < 4; ++i) {
      CHECK(it.tower.sensor_heading_deg[i] ==
            Approx(given >= 8 ? 90.0F * static_cast<float>(i) + 1 : usual.tower.sensor_heading_deg[i]));
      CHECK(it.tower.sensor_out_m[i] == Approx(given >= 11 ? 0.03F : usual.tower.sensor_out_m[i]));
    }
  }
}

TEST_CASE("map: where a robot stands is free, within its inner circle around the middle of its body") {
  MapOptions options;
  options.resolution_m = 0.05F;
  for (const bool is_long : {true, false}) {
    Map map{options};
    Shape shape;
    shape.width_m = is_long ? 0.30F : 0.50F;
    shape.length_m = is_long ? 0.50F : 0.30F;
    shape.centre_m = 0.10F;
    // It looks to the left of the map: its middle is 10 cm above its axle.
    map.take({{1.025F, 2.025F, ocm::motion::pi / 2}, shape}, {0, 0, 0, 0, 9, 9, 9, 9});
    int stands = 0;
    for (int y = 0; y < 100; ++y)
      for (int x = 0; x < 100; ++x) {
        const auto p = map.raster().middle({x, y});
        const double far = std::hypot(p.x_m - 1.025, p.y_m - 2.125);
        if (std::abs(far - 0.15) < 1e-4 || map.log_odds({x, y}) > 0) continue;  // what is seen so near
        CHECK((map.log_odds({x, y}) < 0) == (far < 0.15));
        stands += far < 0.15 ? 1 : 0;
      }
    CHECK(stands > 15);
  }
}

TEST_CASE("map: the border of a robot's inner circle belongs to it, and bounds of odds to what they bound") {
  MapOptions wide;
  wide.resolution_m = 0.25F;  // lengths that a float holds exactly
  Map stands{wide};
  Shape shape;
  shape.width_m = shape.length_m = 0.25F;
  shape.tower.sensor_out_m.fill(5.0F);  // what it sees is elsewhere
  // Between two cells: the middle of each is 12.5 cm away.
  REQUIRE(stands.take({{0.0F, 0.125F, 0.0F}, shape}, {0, 0, 0, 0, 9, 9, 9, 9}));
  for (const int x : {-1, 0}) CHECK(stands.log_odds({x, 0}) == Approx(-0.2F));
  for (const int x : {-2, 1}) CHECK(stands.log_odds({x, 0}) == 0.0F);
  MapOptions options = cells_of_10_cm();
  options.occupied_from = options.beam.hit;
  options.free_below = options.beam.pass;
  Map map{options};
  REQUIRE(map.take({middle, {}}, {0, 0, 0, 0, 36, 0, 0, 0}));
  CHECK(map.state({4, 0}) == CellState::occupied);
  CHECK(map.state({2, 0}) == CellState::free);
  // What is as near as distances are unsure says nothing of the way there.
  options.beam.unsure_m = 0.10F;
  Map unsure{options};
  REQUIRE(unsure.take({middle, {}}, {0, 0, 0, 0, 10, 10, 10, 10}));
  CHECK(unsure.log_odds({0, 0}) == Approx(-0.2F));  // because it stands there
  CHECK(unsure.counters().hits == 4);
}

TEST_CASE("map: one sharp look is enough for a wall; a beam frees what its width touches") {
  Map map{cells_of_10_cm()};
  map.take({middle, {}}, {0, 0, 0, 0, 36, 0, 0, 0});
  CHECK(map.state({4, 0}) == CellState::occupied);
  MapOptions options;  // half as wide as long, in hundredths: 1.75
  options.resolution_m = 0.01F;
  Map fine{options};
  Shape point;
  point.width_m = point.length_m = 0.0F;
  fine.take({{0.005F, 0.005F, 0.0F}, point}, {0, 0, 0, 0, 0, 0, 0, 0});
  for (const int y : {-1, 0, 1}) CHECK(fine.log_odds({55, y}) == Approx(-0.1F));
  for (const int y : {-2, 2}) CHECK(fine.log_odds({55, y}) == 0.0F);
  CHECK(fine.log_odds({20, 1}) == 0.0F);
  CHECK(fine.log_odds({59, 0}) == Approx(-0.1F));
  CHECK(fine.log_odds({61, 0}) == 0.0F);
}

TEST_CASE("map: a beam is as wide as it is across, whichever way the tower looks") {
  MapOptions options;
  options.resolution_m = 0.01F;
  options.beam.half_width_rad = 0.2F;
  Map map{options};
  map.take({{0.005F, 0.005F, 0.0F}, {}}, {0, 0, 0, 45, 0, 0, 0, 0});
  // At 50 cm, by 45 degrees: 35.4, 35.4 cm. By 11.46 more or less: 27.6, 41.7 and 41.7, 27.6 cm.
  CHECK(map.log_odds({35, 35}) == Approx(-0.1F));
  CHECK(map.log_odds({28, 42}) == Approx(-0.1F));
  CHECK(map.log_odds({42, 28}) == Approx(-0.1F));
  CHECK(map.log_odds({26, 44}) == 0.0F);
  CHECK(map.log_odds({44, 26}) == 0.0F);
}

TEST_CASE("map: what is seen is a robot within its circle and 5 cm, and at 80 cm it is seen still") {
  const auto on_robot = [](Pose pose) {
    Map map;
    const std::array others{Body{pose, {}}};
    map.take({{1.0F, 2.0F, 0.0F}, {}}, {0, 0, 0, 0, 50, 0, 0, 0}, others);
    CHECK(map.counters().on_robots + map.counters().hits == 1);
    return map.counters().on_robots == 1;
  };
  // The beam ends at 1.5, 2.0; the circle is that of 15 by 20 cm.
  const float radius = std::hypot(0.075F, 0.10F) + 0.05F;
  for (const Pose sign : {Pose{1, 0, 0}, Pose{-1, 0, 0}, Pose{0, 1, 0}, Pose{0, -1, 0}}) {
    CHECK(on_robot({1.5F + sign.x_m * (radius - 0.002F), 2.0F + sign.y_m * (radius - 0.002F), 0}));
    CHECK_FALSE(on_robot({1.5F + sign.x_m * (radius + 0.002F), 2.0F + sign.y_m * (radius + 0.002F), 0}));
  }
  Map map{cells_of_10_cm()};
  map.take({middle, {}}, {0, 0, 0, 0, 80, 0, 10, -1});
  CHECK(map.counters().hits == 2);
  CHECK(map.counters().near == 0);
  CHECK(map.log_odds({8, 0}) == Approx(0.45F).margin(1e-4));
}

TEST_CASE(
    "map: a distance begins at the sensor's face, which the handshake has in front of the tower's axis") {
  const auto wall_at = [](const Handshake& handshake) {
    MapOptions options;
    options.resolution_m = 0.01F;
    Map map{options};
    map.take({{0.005F, 0.005F, 0.0F}, shape_of(handshake)}, {0, 0, 0, 0, 40, 0, 0, 0});
    int x = 0;
    while (x < 100 && map.log_odds({x, 0}) <= 0.0F) ++x;
    return x;
  };
  Handshake handshake{.sensor2 = 90, .sensor3 = 180, .sensor4 = 270, .sensor_out = 3};
  CHECK(wall_at(handshake) == 43);
  handshake.given = 10;  // of a robot that does not say it
  CHECK(wall_at(handshake) == 40);
  handshake.given = 11;
  for (const int wrong : {-3, 101, 32767}) {
    handshake.sensor_out = static_cast<std::int16_t>(wrong);
    CHECK(wall_at(handshake) == 40);
  }
}

TEST_CASE("map: near things: under 10 cm nothing is freed, and little is said") {
  MapOptions options = cells_of_10_cm();
  options.beam.unsure_m = 0.0F;
  Map map{options};
  map.take({{0.05F, 0.05F, 0.0F}, {}}, {0, 0, 0, 0, 9, 0, 0, 0});
  CHECK(map.counters().near == 1);
  CHECK(map.log_odds({1, 0}) == Approx(0.3F));
}

TEST_CASE("map: one centimetre is seen, and near; none, and less than none, is nothing") {
  Map map{cells_of_10_cm()};
  map.take({middle, {}}, {0, 0, 0, 0, 1, 0, -1, 9});
  CHECK(map.counters() == MapCounters{.updates = 1, .nothing = 2, .near = 2});
}

TEST_CASE("map: beyond the range of the sensor is nothing") {
  Map map{cells_of_10_cm()};
  map.take({middle, {}}, {0, 0, 0, 0, 81, 255, 0, 0});
  CHECK(map.counters().hits == 0);
  CHECK(map.counters().nothing == 4);
  CHECK(map.log_odds({8, 0}) == 0.0F);
}

TEST_CASE("map: another robot is no wall, and where robots stand it is free") {
  Map map{cells_of_10_cm()};
  const std::array others{Body{{0.60F, 0.05F, 0.0F}, {}}};
  map.take({middle, {}}, {0, 0, 0, 0, 50, 0, 0, 0}, others);
  CHECK(map.counters().on_robots == 1);
  CHECK(map.log_odds({5, 0}) <= 0.0F);
  // A wall that was seen there before is taken back when a robot stands on it.
  Map wrong{cells_of_10_cm()};
  for (int i = 0; i < 20; ++i) wrong.take({middle, {}}, {0, 0, 0, 0, 55, 0, 0, 0});
  REQUIRE(wrong.state({6, 0}) == CellState::occupied);
  for (int i = 0; i < 40; ++i) wrong.take({{0.65F, 0.05F, 0.0F}, {}}, {0, 0, 0, 0, 0, 0, 0, 0});
  CHECK(wrong.state({6, 0}) == CellState::free);
}

TEST_CASE("map: log odds are bounded, so that the world may change") {
  Map map{cells_of_10_cm()};
  for (int i = 0; i < 1000; ++i) map.take({middle, {}}, {0, 0, 0, 0, 36, 0, 0, 0});
  CHECK(map.log_odds({4, 0}) == 4.0F);
  CHECK(map.log_odds({2, 0}) == -3.0F);
  CHECK(map.probability({4, 0}) == Approx(0.982F).margin(0.001));
  CHECK(map.probability({50, 50}) == 0.5F);
  int updates = 0;
  while (map.state({4, 0}) != CellState::free && updates < 100) {
    map.take({middle, {}}, {0, 0, 0, 0, 70, 0, 0, 0});
    ++updates;
  }
  CHECK(updates < 30);
}

TEST_CASE("map: poses that are no place are refused and counted") {
  Map map;
  for (const Pose& pose : {Pose{nan, 0, 0}, Pose{0, nan, 0}, Pose{0, 0, nan}, Pose{infinity, 0, 0},
                           Pose{0, -infinity, 0}, Pose{1e30F, 0, 0}, Pose{0, 1000.5F, 0}})
    CHECK_FALSE(map.take({pose, {}}, {0, 0, 0, 0, 50, 50, 50, 50}));
  CHECK(map.counters().refused_poses == 7);
  CHECK(map.counters().updates == 0);
  CHECK(map.box().empty());
  // At the border of the world: what lies beyond it is not stored.
  CHECK(map.take({{1000.0F, 1000.0F, 0.0F}, {}}, {0, 0, 0, 0, 50, 50, 50, 50}));
  CHECK(map.counters().outside > 0);
  // Others without a place are ignored.
  const std::array others{Body{{nan, nan, nan}, {}}};
  CHECK(map.take({{0, 0, 0}, {}}, {0, 0, 0, 0, 50, 0, 0, 0}, others));
}

TEST_CASE("map: a beam that begins or ends beyond the border of the world is counted, and frees nothing") {
  const Pose border{1000.0F, 0.05F, 0.0F};
  Map ends{cells_of_10_cm()};
  REQUIRE(ends.take({border, {}}, {0, 0, 0, 0, 50, 0, 0, 0}));
  CHECK(ends.counters() == MapCounters{.updates = 1, .hits = 1, .nothing = 3, .outside = 1});
  CHECK(ends.log_odds(ends.raster().cell({1000.35F, 0.05F})) == 0.0F);
  CHECK(ends.log_odds(ends.raster().cell({1000.5F, 0.05F})) == 0.0F);
  CHECK(ends.log_odds(ends.raster().cell({999.65F, 0.05F})) == Approx(-0.1F));
  // From a tower ahead of the border each beam begins beyond it, the one backwards, too.
  Shape shape;
  shape.tower.ahead_of_axle_m = 0.2F;
  Map begins{cells_of_10_cm()};
  REQUIRE(begins.take({border, shape}, {}));
  CHECK(begins.counters() == MapCounters{.updates = 1, .nothing = 4, .outside = 4});
  CHECK(begins.log_odds(begins.raster().cell({999.65F, 0.05F})) == 0.0F);
}

TEST_CASE("map: as it is delivered there is room for 75 by 75 metres, and not for 90 by 90") {
  for (const float side : {75.0F, 90.0F}) {
    Map map;
    REQUIRE(map.take({{0, 0, 0}, {}}, {}));
    REQUIRE(map.take({{side, side, 0}, {}}, {}));
    CHECK((map.counters().outside == 0) == (side < 80.0F));
  }
}

TEST_CASE("map: its size is bounded") {
  MapOptions options;
  options.most_cells = 10'000;
  Map map{options};
  Random random{3};
  for (int i = 0; i < 2000; ++i) {
    const auto far = [&] { return static_cast<float>(random.within(-90'000, 90'000)) / 100.0F; };
    (void)map.take({{far(), far(), far()}, {}}, ocm::test::PerfectRobot{{}}.update({}, {}));
  }
  CHECK(map.box().cells() <= 10'000);
  CHECK(map.counters().outside > 0);
}

TEST_CASE("map: random rooms, a sensor without noise: their walls are found, and no others") {
  Random random{4};
  const auto metres = [&](int low_cm, int high_cm) {
    return static_cast<float>(random.within(low_cm, high_cm)) / 100;
  };
  for (int run = 0; run < 20; ++run) {
    CAPTURE(run);
    const float x = metres(80, 140), y = metres(80, 140);
    Room room{ocm::test::rectangle(0, 0, x, y)};
    const float at = metres(30, 50);  // an inner wall from below
    room.walls.push_back({{x / 2, 0}, {x / 2 + metres(-10, 10), at}});
    Map map;
    std::vector<ocm::motion::Point> places;
    for (int stand = 0; stand < 30; ++stand) {
      const ocm::motion::Point p{metres(15, static_cast<int>(x * 100) - 15),
                                 metres(15, static_cast<int>(y * 100) - 15)};
      if (room.distance(p) < 0.14F) continue;
      places.push_back(p);
      // Its frame begins where it stands; the tower turns to and fro once.
      const Pose pose{p.x_m, p.y_m, metres(-314, 314)};
      std::vector<ocm::test::PerfectRobot> all{ocm::test::PerfectRobot{pose}};
      for (int i = 0; i < 46; ++i) {
        all[0].step(room, all);
        REQUIRE(map.take({pose, {}}, all[0].update(room, all)));
      }
    }
    const Agreement found = agreement(map, room.walls, places);
    CHECK(found.precision >= 0.99);
    CHECK(found.recall >= 0.90);
    CHECK(found.explored >= 0.95);
  }
}

}  // namespace cognitive_map_test
