#include "ocm/mapper/app/history.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/motion/near.hpp"

namespace mapper_app_history_test {

using namespace ocm;
using mapper::app::History;
using mapper::app::towards;
using motion::Point;
using ocm::test::near;

template <std::size_t N>
std::vector<Point> taken(History<N> history) {
  std::vector<Point> result;
  for (; history.last(); history.drop_last()) result.push_back(*history.last());
  return result;
}

TEST_CASE("mapper history: the way back is the way that it came, the last place first", "[mapper_history]") {
  History<8> history;
  CHECK(history.last().error == base::Error::no_answer);
  for (const Point place : {Point{0, 0}, Point{1, 0}, Point{1, 1}, Point{0, 1}}) history.leave(place);
  CHECK(taken(history) == std::vector<Point>{{0, 1}, {1, 1}, {1, 0}, {0, 0}});
  history.clear();
  CHECK(history.last().error == base::Error::no_answer);
}

TEST_CASE("mapper history: the same place twice is one place", "[mapper_history]") {
  History<8> history;
  for (const Point place : {Point{1, 1}, Point{1, 1}, Point{1.015F, 1}, Point{1, 0.985F}})
    history.leave(place);
  CHECK(taken(history) == std::vector<Point>{{1, 1}});
}

TEST_CASE("mapper history: what is 2 cm away is another place", "[mapper_history]") {
  History<8> history;
  history.leave({0, 0});
  history.leave({0.019F, 0});
  CHECK(history.size() == 1);
  history.leave({0.02F, 0});
  CHECK(history.size() == 2);
}

TEST_CASE("mapper history: places along a line are one stretch, a bend is a place", "[mapper_history]") {
  History<8> history;
  for (int i = 0; i <= 20; ++i) history.leave({0.1F * static_cast<float>(i), 0});
  CHECK(history.size() == 2);
  history.leave({2.0F, 0.5F});
  CHECK(taken(history) == std::vector<Point>{{2.0F, 0.5F}, {2, 0}, {0, 0}});
  SECTION("and so is a turn on the spot and back") {
    history.leave({2.0F, 0.2F});
    CHECK(history.size() == 4);
  }
}

TEST_CASE("mapper history: the stretch before a place that was driven back to is not made longer",
          "[mapper_history]") {
  History<8> history;
  for (const Point place : {Point{0, 0}, Point{1, 0}, Point{1, 1}}) history.leave(place);
  history.drop_last();
  history.leave({2, 0});
  CHECK(history.size() == 3);
  history.leave({3, 0});  // but the new one is
  CHECK(taken(history) == std::vector<Point>{{3, 0}, {1, 0}, {0, 0}});
}

TEST_CASE("mapper history: a gentle bend in small steps is never straightened", "[mapper_history]") {
  // A quarter of a circle of 1 m in 100 steps: each step is as good as straight, all of them are not.
  History<32> history;
  std::vector<Point> way;
  for (int i = 0; i <= 100; ++i) {
    const float angle = motion::pi / 2 * static_cast<float>(i) / 100.0F;
    way.push_back({std::sin(angle), 1 - std::cos(angle)});
    history.leave(way.back());
  }
  const std::vector<Point> back = taken(history);
  CHECK(back.size() > 4);
  CHECK(back.size() < 20);
  for (const Point& place : way) {
    float nearest = 1e9F;
    for (std::size_t i = 1; i < back.size(); ++i) {
      const float dx = back[i].x_m - back[i - 1].x_m;
      const float dy = back[i].y_m - back[i - 1].y_m;
      const float along = motion::clamp(
          ((place.x_m - back[i - 1].x_m) * dx + (place.y_m - back[i - 1].y_m) * dy) / (dx * dx + dy * dy), 0,
          1);
      nearest = std::min(nearest, std::hypot(back[i - 1].x_m + along * dx - place.x_m,
                                             back[i - 1].y_m + along * dy - place.y_m));
    }
    CHECK(nearest < History<32>::same_m);
  }
}

TEST_CASE("mapper history: without room the oldest is forgotten, and counted", "[mapper_history]") {
  History<4> history;
  for (int i = 0; i < 10; ++i) history.leave({static_cast<float>(i), static_cast<float>(i % 2)});
  CHECK(history.size() == 4);
  CHECK(history.forgotten() == 6);
  CHECK(taken(history).back() == Point{6, 0});
  history.clear();
  CHECK(history.forgotten() == 6);
}

TEST_CASE("mapper history: a place that is none is not kept", "[mapper_history]") {
  History<4> history;
  history.leave({std::numeric_limits<float>::quiet_NaN(), 0});
  history.leave({0, std::numeric_limits<float>::infinity()});
  CHECK(history.size() == 0);
  history.drop_last();
  CHECK(history.size() == 0);
}

TEST_CASE("mapper history: random ways: no place of the way is further from the way back than it may be",
          "[mapper_history]") {
  std::mt19937 random{7};
  std::normal_distribution<float> bend{0, 0.15F};
  std::uniform_real_distribution<float> length{0.005F, 0.3F};
  for (int run = 0; run < 200; ++run) {
    History<64> history;
    std::vector<Point> way;
    Point at{};
    float heading = 0;
    for (int i = 0; i < 50; ++i) {
      way.push_back(at);
      history.leave(at);
      heading += bend(random);
      const float d = length(random);
      at = {at.x_m + d * std::cos(heading), at.y_m + d * std::sin(heading)};
    }
    const std::vector<Point> back = taken(history);
    float worst = 0;
    for (const Point& place : way) {
      float nearest = std::hypot(back[0].x_m - place.x_m, back[0].y_m - place.y_m);
      for (std::size_t i = 1; i < back.size(); ++i) {
        const float dx = back[i].x_m - back[i - 1].x_m;
        const float dy = back[i].y_m - back[i - 1].y_m;
        const float along = motion::clamp(
            ((place.x_m - back[i - 1].x_m) * dx + (place.y_m - back[i - 1].y_m) * dy) / (dx * dx + dy * dy),
            0, 1);
        nearest = std::min(nearest, std::hypot(back[i - 1].x_m + along * dx - place.x_m,
                                               back[i - 1].y_m + along * dy - place.y_m));
      }
      worst = std::max(worst, nearest);
    }
    CHECK(worst < 2 * History<64>::same_m);  // off the line, and the same place as the next
  }
}

TEST_CASE("mapper history: the set point towards a place, by hand", "[mapper_history]") {
  CHECK(near(towards({0, 0, 0}, {1, 0}).distance_m, 1.0F));
  CHECK(near(towards({0, 0, 0}, {1, 0}).turn_rad, 0.0F));
  CHECK(near(towards({0, 0, 0}, {0, 2}).turn_rad, motion::pi / 2));
  CHECK(near(towards({1, 1, motion::pi / 2}, {1, 0}).turn_rad, motion::pi, 1e-5F));
  CHECK(near(towards({0, 0, motion::radians(170)}, {-1, -0.17632698F}).turn_rad, motion::radians(20), 1e-5F));
  CHECK(towards({1, 2, 3}, {1, 2}) == motion::SetPoint{});
}

}  // namespace mapper_app_history_test
