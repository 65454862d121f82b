#include "cli/serve/bounds.hpp"

#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "ocm/protocol/request.hpp"
#include "ocm/topics/amiro.hpp"

#include "tool/bus_model/bus.hpp"

namespace serve_bounds_test {

using namespace std::chrono_literals;
using namespace ocm;
using cli::bus_model::Row;
using cli::serve::Bounds;
using Json = nlohmann::json;

constexpr std::uint32_t motors = 0x201, gyroscope = 0x608;

/// A row of which a sample came.
Row row(std::string_view name, std::optional<base::Duration> period,
        protocol::Priority priority = protocol::Priority::medium) {
  Row row;
  row.topic = amiro::catalogue.find(name);
  REQUIRE(row.topic != nullptr);
  row.name = name;
  row.count = 1;
  row.period = period;
  row.newest.priority = priority;
  return row;
}

struct Desk {
  explicit Desk(std::uint32_t bit_rate = 500'000) : bounds{amiro::catalogue, bit_rate} {}
  Json state() const { return Json::parse(bounds.state()); }
  Json rows() const { return state()["rows"]; }
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const Json& row : rows()) names.push_back(row["name"]);
    return names;
  }
  void take(base::Duration at, std::uint32_t id, std::initializer_list<int> bytes) {
    bounds.take(test::entry(at, id, bytes));
  }
  Bounds bounds;
};

TEST_CASE("bounds: what is sent at a period, and what is held, has one") {
  Desk desk;
  CHECK(desk.rows() == Json::array());
  std::vector<Row> rows{row("motors", {}), row("gyroscope", 50ms), row("led_1", 100ms),
                        row("accelerometer", {})};
  Row nothing_came = row("magnetometer", 20ms);
  nothing_came.count = 0;
  Row unknown = row("odometry", 20ms);
  unknown.topic = nullptr;
  rows.push_back(nothing_came);
  rows.push_back(unknown);
  desk.bounds.assume(rows);
  CHECK(desk.names() == std::vector<std::string>{"motors", "gyroscope"});
  const Json state = desk.rows();
  CHECK(state[0]["period_ms"] == 100);
  CHECK(state[1]["period_ms"] == 50);
  CHECK(state[1]["deadline_ms"] == 50);
  // At 500 kbit/s, of which a bit takes 2 us: 8 bytes are 135 bits at most, with those that are stuffed and
  // the three between frames; 6 bytes 115. Either waits for the other, behind its own jitter. [Davis, Burns,
  // Bril, Lukkien 2007, equation 1]
  for (std::size_t i = 0; i < 2; ++i) {
    const protocol::Topic& topic = *amiro::catalogue.find(i == 0 ? "motors" : "gyroscope");
    const double frames_ms =
        state[i]["bound_ms"].get<double>() - static_cast<double>(topic.jitter.count()) / 1e6;
    CHECK(frames_ms <= 0.27 + 0.23);
    CHECK(frames_ms > 0.27 + 0.23 - 0.1);
  }
  CHECK(desk.state()["about"].get<std::string>().starts_with("At 500000 bit/s, with the periods"));
}

TEST_CASE("bounds: a frame is as long as the bus is slow") {
  const auto bound = [](std::uint32_t bit_rate) {
    Desk desk{bit_rate};
    desk.bounds.assume(std::vector{row("gyroscope", 50ms)});
    return desk.rows()[0]["bound_ms"].get<double>() -
           static_cast<double>(amiro::catalogue.find("gyroscope")->jitter.count()) / 1e6;
  };
  CHECK(bound(125'000) == Approx(4 * bound(500'000)));
  Desk unknown{0};
  unknown.bounds.assume(std::vector{row("gyroscope", 50ms)});
  CHECK(unknown.rows().empty());
}

TEST_CASE("bounds: of a bus that is too slow for what it carries none is proved, and none is exceeded") {
  Desk desk{10'000};
  desk.bounds.assume(std::vector{row("gyroscope", 10ms), row("accelerometer", 10ms)});
  for (int i = 0; i < 3; ++i) desk.take(i * 13ms, gyroscope, {1, 2, 3, 4, 5, 6});
  const Json state = desk.rows();
  REQUIRE(state.size() == 2);
  const Json& last = state[0]["name"] == "gyroscope" ? state[0] : state[1];
  CHECK(state[1]["bound_ms"].is_null());
  CHECK(state[1]["exceeds"] == false);
  CHECK(last["measured_ms"].get<double>() > 6);
}

TEST_CASE("bounds: a sensor has the priority that it was asked for with, and an actuator its own") {
  Desk desk;
  desk.bounds.assume(std::vector{row("motors", {}, protocol::Priority::low), row("accelerometer", 50ms),
                                 row("gyroscope", 50ms, protocol::Priority::urgent)});
  CHECK(desk.names() == std::vector<std::string>{"motors", "gyroscope", "accelerometer"});
}

TEST_CASE("bounds: what was measured is how far behind its grid a frame came, and the frame itself") {
  Desk desk;
  desk.bounds.assume(std::vector{row("gyroscope", 50ms)});
  const auto measured = [&] { return desk.rows()[0]["measured_ms"]; };
  desk.take(0ms, gyroscope, {1, 2, 3, 4, 5, 6});
  CHECK(measured().is_null());  // one alone is behind nothing
  desk.take(50ms, gyroscope, {1, 2, 3, 4, 5, 6});
  CHECK(measured().get<double>() > 0.18);  // 6 bytes of which no bit is stuffed take 92 bits, and 3 more
  CHECK(measured().get<double>() < 0.23);
  CHECK(desk.rows()[0]["exceeds"] == false);
  desk.take(103ms, gyroscope, {1, 2, 3, 4, 5, 6});
  CHECK(measured().get<double>() > 3.18);
  CHECK(measured().get<double>() < 3.23);
  CHECK(desk.rows()[0]["exceeds"] == true);
  // The same again changes nothing; other rates begin again.
  desk.bounds.assume(std::vector{row("gyroscope", 50ms)});
  CHECK(desk.rows()[0]["exceeds"] == true);
  desk.bounds.assume(std::vector{row("gyroscope", 100ms)});
  CHECK(measured().is_null());
  CHECK(desk.rows()[0]["period_ms"] == 100);
  desk.bounds.assume({});
  CHECK(desk.rows().empty());
  desk.take(200ms, gyroscope, {1, 2, 3, 4, 5, 6});
}

TEST_CASE("bounds: what is a microsecond beyond its bound is not, as the times of frames are no finer") {
  const auto measured = [](base::Duration late) {
    Desk desk;
    desk.bounds.assume(std::vector{row("gyroscope", 50ms)});
    desk.take(0ms, gyroscope, {1, 2, 3, 4, 5, 6});
    desk.take(50ms + late, gyroscope, {1, 2, 3, 4, 5, 6});
    return Json(desk.rows()[0]);
  };
  const auto ns = [](const Json& ms) { return base::Duration{std::llround(ms.get<double>() * 1e6)}; };
  const Json in_time = measured(0ns);
  const base::Duration most = ns(in_time["bound_ms"]) - ns(in_time["measured_ms"]) + 1us;
  CHECK(ns(measured(most)["measured_ms"]) == ns(in_time["bound_ms"]) + 1us);
  CHECK(measured(most)["exceeds"] == false);
  CHECK(measured(most + 1ns)["exceeds"] == true);
}

TEST_CASE("bounds: other frames, and those of other kinds, are of no row") {
  Desk desk;
  desk.bounds.assume(std::vector{row("gyroscope", 50ms)});
  for (int i = 0; i < 4; ++i) {
    desk.take(i * 7ms, gyroscope - 1, {1, 2, 3, 4, 5, 6});
    desk.bounds.take(test::entry(i * 7ms, gyroscope, {1, 2, 3, 4, 5, 6, 7, 8}, can::Format::error));
    desk.bounds.take(test::entry(i * 7ms, gyroscope, {1, 2, 3, 4, 5, 6}, can::Format::extended));
    can::AnyFrame fd;
    fd.id = gyroscope;
    fd.length = 6;
    fd.flags = can::frame_flag::fd;
    desk.bounds.take(log::Entry{test::morning + i * 7ms, fd});
  }
  CHECK(desk.rows()[0]["measured_ms"].is_null());
}

TEST_CASE("bounds: a set point that is changed early begins a grid, and one of rest ends it") {
  Desk desk;
  desk.bounds.assume(std::vector{row("motors", {})});
  const auto measured = [&] { return desk.rows()[0]["measured_ms"].get<double>(); };
  desk.take(0ms, motors, {1, 0, 0, 0, 0, 0, 0, 0});
  desk.take(40ms, motors, {2, 0, 0, 0, 0, 0, 0, 0});
  desk.take(140ms, motors, {2, 0, 0, 0, 0, 0, 0, 0});
  CHECK(measured() < 0.28);
  desk.take(180ms, motors, {0, 0, 0, 0, 0, 0, 0, 0});
  desk.take(310ms, motors, {1, 0, 0, 0, 0, 0, 0, 0});  // 130 ms behind rest
  CHECK(measured() < 0.28);
  desk.take(440ms, motors, {1, 0, 0, 0, 0, 0, 0, 0});
  CHECK(measured() > 30.0);
}

}  // namespace serve_bounds_test
