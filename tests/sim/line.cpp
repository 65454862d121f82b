#include "sim/amiro/line.hpp"

#include <cmath>
#include <limits>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"

namespace sim_line_test {

using namespace ocm::sim;
using ocm::test::Random;

TEST_CASE("line: a quarter circle to the left") {
  const LinePiece quarter{{1, 0, 0}, pi / 2 * 0.5, 2};  // around (1, 0.5)
  CHECK(quarter.end().x_m == Approx(1.5));
  CHECK(quarter.end().y_m == Approx(0.5));
  CHECK(quarter.end().heading_rad == Approx(pi / 2));
  CHECK(quarter.distance({1, 0.5}) == Approx(0.5));                 // its middle
  CHECK(quarter.distance({1.4, 0.5}) == Approx(0.1));               // inside
  CHECK(quarter.distance({1.6, 0.5}) == Approx(0.1));               // outside
  CHECK(quarter.distance({0.9, 0}) == Approx(0.1));                 // before it
  CHECK(quarter.distance({1.5, 0.7}) == Approx(0.2));               // behind it
  CHECK(quarter.distance({1, 1}) == Approx(std::hypot(0.5, 0.5)));  // the other side of the circle
}

TEST_CASE("line: places beside any piece are as far from it as they were set") {
  Random random{7};
  const auto within = [&random](double low, double high) {
    return low + (high - low) * random.below(1'000'001) / 1e6;
  };
  for (int i = 0; i < 2000; ++i) {
    const double curvature = i % 4 == 0 ? 0 : within(-8, 8);
    const double longest = curvature == 0 ? 1 : std::min(1.0, 2 * pi / std::abs(curvature));
    const LinePiece piece{{within(-1, 1), within(-1, 1), within(-9, 9)}, within(0.01, longest), curvature};
    const double beside = within(-0.1, 0.1);
    const Pose at = piece.at(within(0, piece.length_m));
    CAPTURE(i, curvature, beside);
    // A circle that is nearly closed is nearer elsewhere only for places beyond its middle.
    CHECK(piece.distance(at.place_of({0, beside})) == Approx(std::abs(beside)).margin(1e-9));
  }
}

TEST_CASE("line: pieces go on where the last one ended, and none is infinitely far away") {
  Line line;
  CHECK(line.distance({0, 0}) == std::numeric_limits<double>::infinity());
  line.go_on(1, 0);
  line.go_on(pi, -1);
  CHECK(line.pieces.back().end().x_m == Approx(1));
  CHECK(line.pieces.back().end().y_m == Approx(-2));
  CHECK(line.distance({0.5, 0.1}) == Approx(0.1));
  CHECK(line.distance({2.1, -1}) == Approx(0.1));

  const Line closed = stadium(0.4, 0.3);
  CHECK(closed.pieces.back().end().x_m == Approx(closed.pieces.front().start.x_m));
  CHECK(closed.pieces.back().end().y_m == Approx(closed.pieces.front().start.y_m));
}

}  // namespace sim_line_test
