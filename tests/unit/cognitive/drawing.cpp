#include "ocm/cognitive/drawing.hpp"

#include <array>

#include <catch2/catch.hpp>

namespace cognitive_drawing_test {

using namespace ocm::cognitive;
using ocm::mapper::link::Update;
using ocm::motion::Point;
using ocm::motion::Pose;

/// At the origin of the map, with something 30 cm ahead of the first sensor and nothing elsewhere.
Update update(std::int16_t heading_deg = 0) {
  return {0, 0, heading_deg, 0, 30, 0, 0, 0};
}
Body body(float x_m = 0, float y_m = 0) {
  return {Pose{x_m, y_m, 0}, Shape{}};
}

TEST_CASE("drawing: an update is drawn, and where the robot was is known") {
  Drawing drawing;
  CHECK(drawing.map().state(drawing.map().raster().cell({0, 0})) == CellState::unknown);
  drawing.take(3, body(), update(), {});
  CHECK(drawing.counters().drawn == 1);
  drawing.take(3, body(), update(), {});
  CHECK(drawing.counters().drawn == 2);
  CHECK(drawing.map().state(drawing.map().raster().cell({0, 0})) == CellState::free);
  CHECK(drawing.path(3).size() == 1);  // a point each 2 cm
  drawing.take(3, body(0.01F), update(), {});
  CHECK(drawing.path(3).size() == 1);
  drawing.take(3, body(0.03F), update(), {});
  CHECK(drawing.path(3) == std::vector<Point>{{0, 0}, {0.03F, 0}});
  CHECK(drawing.path(4).empty());
  drawing.take(5, body(), update(), {});
  drawing.take(5, body(0.02F), update(), {});
  CHECK(drawing.path(5).size() == 2);
}

TEST_CASE("drawing: while a robot turns fast nothing is drawn, and it is counted") {
  Drawing drawing{MapOptions{}, 6};
  drawing.take(0, body(), update(0), {});
  drawing.take(0, body(), update(6), {});
  CHECK(drawing.counters().turning == 0);
  drawing.take(0, body(), update(13), {});
  CHECK(drawing.counters().turning == 1);
  drawing.take(0, body(), update(17), {});  // from there on, it turns slowly
  CHECK(drawing.counters().drawn == 3);
  drawing.take(0, body(), update(-179), {});
  CHECK(drawing.counters().turning == 2);
  drawing.take(0, body(), update(178), {});  // across the seam
  CHECK(drawing.counters().turning == 2);
  // Another robot, and one that was switched on again, begin anywhere.
  drawing.take(1, body(), update(90), {});
  drawing.restart(0);
  drawing.take(0, body(), update(0), {});
  CHECK(drawing.counters().turning == 2);
}

TEST_CASE("drawing: a turn across 180 degrees is as large as any other") {
  for (const bool left : {true, false}) {
    CAPTURE(left);
    const auto heading = [left](int deg) { return update(static_cast<std::int16_t>(left ? deg : -deg)); };
    Drawing drawing{MapOptions{}, 6};
    drawing.take(0, body(), heading(177), {});
    drawing.take(0, body(), heading(-177), {});
    CHECK(drawing.counters().drawn == 2);
    CHECK(drawing.counters().turning == 0);
    drawing.take(1, body(), heading(177), {});
    drawing.take(1, body(), heading(-176), {});
    CHECK(drawing.counters().drawn == 3);
    CHECK(drawing.counters().turning == 1);
  }
}

TEST_CASE("drawing: as it is delivered, up to six degrees between two updates are drawn") {
  Drawing drawing;
  drawing.take(0, body(), update(0), {});
  drawing.take(0, body(), update(6), {});
  CHECK(drawing.counters().drawn == 2);
  drawing.take(0, body(), update(13), {});
  CHECK(drawing.counters().drawn == 2);
  CHECK(drawing.counters().turning == 1);
}

TEST_CASE("drawing: what is seen where another robot stands is no wall") {
  Drawing drawing;
  const std::array others{body(0.35F)};
  for (int i = 0; i < 5; ++i) drawing.take(0, body(), update(), others);
  CHECK(drawing.map().counters().on_robots > 0);
  CHECK(drawing.map().counters().hits == 0);
}

TEST_CASE("drawing: a pose that is no place is refused") {
  Drawing drawing;
  drawing.take(0, body(5000), update(), {});
  CHECK(drawing.counters().drawn == 0);
  CHECK(drawing.map().counters().refused_poses == 1);
}

}  // namespace cognitive_drawing_test
