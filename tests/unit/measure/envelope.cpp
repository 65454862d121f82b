#include "ocm/measure/envelope.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <random>

#include <catch2/catch.hpp>

namespace measure_envelope_test {

using namespace std::chrono_literals;
using namespace ocm::measure;
using ocm::base::Time;

TEST_CASE("envelope: few points stay as they are") {
  Envelope envelope;
  for (int i = 0; i < 1000; ++i) envelope.add(Time{i * 1ms}, 0, i % 7);
  const auto points = envelope.points();
  REQUIRE(points.size() == 1000);
  for (int i = 0; i < 1000; ++i) {
    const auto& point = points[static_cast<std::size_t>(i)];
    CHECK(point.time == Time{i * 1ms});
    CHECK(point.y == i % 7);
    CHECK(point.begins == (i == 0));
  }
}

TEST_CASE("envelope: of a million points the peak is left, and a few thousand") {
  Envelope envelope;
  for (int i = 0; i < 1'000'000; ++i) {
    double y = std::sin(i / 1e5);
    if (i == 123'456) y = 100;
    if (i == 654'321) y = -100;
    envelope.add(Time{i * 1ms}, 0, y);
  }
  CHECK(envelope.count() == 1'000'000);
  const auto points = envelope.points();
  CHECK(points.size() <= 4 * Envelope::columns);  // x is the same: first, last, lowest, highest
  CHECK(points.size() >= 2 * Envelope::columns / 2);
  CHECK(points.front().number == 0);
  CHECK(points.back().number == 999'999);
  bool high = false, low = false;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].y == 100) high = points[i].time == Time{123'456ms};
    if (points[i].y == -100) low = points[i].time == Time{654'321ms};
    if (i > 0) CHECK(points[i - 1].number < points[i].number);
    CHECK(points[i].begins == (i == 0));
  }
  CHECK(high);
  CHECK(low);
}

TEST_CASE("envelope: every column keeps its extremes in both directions") {
  std::mt19937 random{3};
  Envelope envelope;
  struct All {
    double x, y;
    std::size_t column;
  };
  std::vector<All> all;
  // 2^21 ns in columns of 2^10 ns.
  for (std::int64_t t = 0; t < 1 << 21; t += 1 + static_cast<std::int64_t>(random() % 60)) {
    const double x = static_cast<double>(random() % 10'000), y = static_cast<double>(random() % 10'000);
    envelope.add(Time{std::chrono::nanoseconds{t}}, x, y);
    all.push_back({x, y, static_cast<std::size_t>(t >> 10)});
  }
  std::vector<double> most_x(2048, -1), least_x(2048, 1e9), most_y(2048, -1), least_y(2048, 1e9);
  const auto note = [&](const All& a) {
    most_x[a.column] = std::max(most_x[a.column], a.x);
    least_x[a.column] = std::min(least_x[a.column], a.x);
    most_y[a.column] = std::max(most_y[a.column], a.y);
    least_y[a.column] = std::min(least_y[a.column], a.y);
  };
  for (const All& a : all) note(a);
  const auto expected = std::tuple{most_x, least_x, most_y, least_y};
  for (auto* each : {&most_x, &most_y}) std::fill(each->begin(), each->end(), -1);
  for (auto* each : {&least_x, &least_y}) std::fill(each->begin(), each->end(), 1e9);
  for (const auto& point : envelope.points()) {
    const auto& as_added = all[static_cast<std::size_t>(point.number)];
    CHECK(as_added.x == point.x);
    note({point.x, point.y, as_added.column});
  }
  CHECK((expected == std::tuple{most_x, least_x, most_y, least_y}));
  CHECK(envelope.points().size() < all.size() / 5);
}

TEST_CASE("envelope: what is no number hides no peak") {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  Envelope envelope;
  for (int i = 0; i < 64 * 4096; ++i)  // each column begins with none
    envelope.add(Time{i * 1ms}, 0, i % 64 == 0 ? none : i == 100'001 ? 5 : i == 200'001 ? -5 : 0);
  const auto points = envelope.points();
  const auto has = [&](double y) {
    return std::any_of(points.begin(), points.end(), [y](const auto& point) { return point.y == y; });
  };
  CHECK(has(5));
  CHECK(has(-5));
}

TEST_CASE("envelope: a pause parts the curve, jitter and one lost sample do not") {
  Envelope envelope;
  for (const int ms : {0, 100, 190, 300, 500, 600, 2000, 2010, 2020, 2030})
    envelope.add(Time{ms * 1ms}, 0, 0);
  std::vector<std::uint64_t> begins;
  for (const auto& point : envelope.points())
    if (point.begins) begins.push_back(point.number);
  CHECK(begins == std::vector<std::uint64_t>{0, 6});
}

/// The numbers of the points that are left.
std::vector<std::uint64_t> left_of(const Envelope& envelope) {
  std::vector<std::uint64_t> numbers;
  for (const Point& point : envelope.points()) numbers.push_back(point.number);
  return numbers;
}

TEST_CASE("envelope: a curve that begins long after 1970 is as fine as any") {
  Envelope early, late;
  for (std::size_t i = 0; i < Envelope::columns; ++i) {
    const auto at = std::chrono::nanoseconds{static_cast<std::int64_t>(i)};
    early.add(Time{at}, 0, 0);
    late.add(Time{1'000'000s + at}, 0, 0);
  }
  CHECK(early.points().size() == Envelope::columns);
  CHECK(late.points().size() == Envelope::columns);
}

TEST_CASE("envelope: of a column the first and the last, and of equal extremes the first") {
  Envelope flat;
  for (const int ns : {0, 0, 0, 1}) flat.add(Time{ns * 1ns}, 0, 0);
  CHECK(left_of(flat) == std::vector<std::uint64_t>{0, 2, 3});
  Envelope peaks;
  for (const double y : {0, 5, 1, 5, -5, 0, -5, 0}) peaks.add(Time{0ns}, 0, y);
  CHECK(left_of(peaks) == std::vector<std::uint64_t>{0, 1, 4, 7});
  Envelope sideways;
  for (const double x : {0, 5, 1, 5, -5, 0, -5, 0}) sideways.add(Time{0ns}, x, 0);
  CHECK(left_of(sideways) == std::vector<std::uint64_t>{0, 1, 4, 7});
}

TEST_CASE("envelope: a pause is more than five of the distances that are usual") {
  const auto parts_at = [](std::initializer_list<int> distances) {
    Envelope envelope;
    Time time{};
    envelope.add(time, 0, 0);
    for (const int ns : distances) envelope.add(time += std::chrono::nanoseconds{ns}, 0, 0);
    return envelope.points().back().begins;
  };
  CHECK_FALSE(parts_at({100, 504}));
  CHECK(parts_at({100, 505}));
  // The average moves by an eighth of what a distance is off it: 110, then 120.
  CHECK_FALSE(parts_at({100, 180, 554}));
  CHECK(parts_at({100, 180, 555}));
  CHECK(parts_at({100, 20, 455}));
  CHECK_FALSE(parts_at({100, 20, 454}));
  CHECK_FALSE(parts_at({1'000'000}));  // nothing is usual yet
  CHECK(parts_at({1, 10}));
}

TEST_CASE("envelope: a slower period behind a pause is a curve again") {
  Envelope envelope;
  for (int i = 0; i < 10; ++i) envelope.add(Time{i * 10ms}, 0, 0);
  for (int i = 1; i < 10; ++i) envelope.add(Time{i * 1s}, 0, 0);
  std::size_t pieces = 0;
  for (const auto& point : envelope.points()) pieces += point.begins ? 1 : 0;
  CHECK(pieces == 2);
}

TEST_CASE("envelope: times that go back or leap stay in order of arrival") {
  Envelope envelope;
  envelope.add(Time{10s}, 0, 1);
  envelope.add(Time{9s}, 0, 2);
  envelope.add(Time{Time::max() - Time{}}, 0, 3);
  const auto points = envelope.points();
  REQUIRE(points.size() == 3);
  CHECK(points[1].y == 2);
  CHECK(points[2].y == 3);
}

TEST_CASE("envelope: nothing is nothing") {
  CHECK(Envelope{}.points().empty());
  CHECK(Envelope{}.count() == 0);
  const Point none;
  CHECK(none.x == 0);
  CHECK(none.y == 0);
  CHECK_FALSE(none.begins);
  CHECK(none.number == 0);
}

}  // namespace measure_envelope_test
