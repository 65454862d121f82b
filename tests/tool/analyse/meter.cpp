#include "cli/analyse/meter.hpp"

#include <initializer_list>

#include <catch2/catch.hpp>

namespace analyse_meter_test {

using namespace ocm::cli::analyse;

constexpr std::int64_t ms = 1'000'000;

/// Frames of 1 ms, by the times of their ends in ms, with a period of 100.
Measured measured(Grid grid, std::initializer_list<std::int64_t> times) {
  Meter meter;
  for (const std::int64_t time : times) meter.add(time * ms, 8, ms, 100 * ms, grid);
  return meter.finish();
}

TEST_CASE("meter: how far behind the grid of its sender a frame came") {
  const Measured late = measured(Grid::of_sender, {0, 100, 230, 300, 400});
  CHECK(late.lateness == 30 * ms);
  CHECK(late.response == 31 * ms);
  CHECK(late.count == 5);
  // The first one was late, which the second shows; one is lost, and then comes a pause.
  CHECK(measured(Grid::of_sender, {20, 100, 300, 820, 920}).lateness == 20 * ms);
}

TEST_CASE("meter: two and a half periods without a frame are a pause, behind which the grid begins again") {
  CHECK(measured(Grid::of_sender, {0, 100, 349, 449}).lateness == 49 * ms);  // one is lost, and the next late
  CHECK(measured(Grid::of_sender, {0, 100, 350, 450}).lateness == 0);
}

TEST_CASE("meter: clocks may drift apart: the grid begins again every hundred frames") {
  Meter meter;
  for (std::int64_t i = 0; i < 250; ++i) meter.add(i * 1001 * ms / 10, 8, ms, 100 * ms);
  CHECK(meter.finish().lateness == 99 * ms / 10);
}

TEST_CASE("meter: a grid counts for a hundred frames, be it the first one or one that begins later") {
  Meter meter;
  for (std::int64_t i = 0; i < 150; ++i) meter.add(i * 100 * ms, 8, ms, 100 * ms);
  CHECK(meter.finish().lateness == 0);
  meter.add(15'020 * ms, 8, ms, 100 * ms);  // 50 frames behind the beginning of the second grid
  CHECK(meter.finish().lateness == 20 * ms);
  // Behind a pause, of two clocks that drift apart.
  Meter paused;
  for (std::int64_t i = 0; i < 60; ++i) paused.add(i * 100 * ms, 8, ms, 100 * ms);
  for (std::int64_t i = 0; i < 150; ++i) paused.add(7'000 * ms + i * 1001 * ms / 10, 8, ms, 100 * ms);
  CHECK(paused.finish().lateness == 99 * ms / 10);
}

TEST_CASE("meter: a response is at least what a frame is late, and the shortest frame") {
  Meter meter;
  meter.add(0, 2, 3 * ms, 100 * ms);
  const Measured one = meter.finish();
  CHECK(one.count == 1);
  CHECK(one.response == 3 * ms);
  CHECK((one.shortest == 0 && one.longest == 0 && one.mean == 0));
  meter.add(100 * ms, 8, 1 * ms, 100 * ms);
  meter.add(220 * ms, 4, 2 * ms, 100 * ms);
  const Measured three = meter.finish();
  CHECK(three.response == 20 * ms + 1 * ms);
  CHECK(three.greatest_length == 8);
  CHECK(three.shortest == 100 * ms);
  CHECK(three.mean == 110 * ms);
  CHECK(three.longest == 120 * ms);
}

TEST_CASE("meter: a set point that is changed begins another grid") {
  CHECK(measured(Grid::of_run, {0, 100, 140, 240, 341}).lateness == 1 * ms);
  CHECK(measured(Grid::of_run, {0, 100, 230, 300}).lateness == 30 * ms);  // a late one shows all the same
  // One and a half periods without a set point are a pause.
  CHECK(measured(Grid::of_run, {0, 100, 250, 350}).lateness == 0);
  CHECK(measured(Grid::of_run, {0, 100, 249, 300}).lateness == 49 * ms);
}

TEST_CASE("meter: behind rest a run begins, whenever it is") {
  Meter meter;
  const auto add = [&meter](std::int64_t time, bool rests) {
    meter.add(time * ms, 8, ms, 100 * ms, Grid::of_run, rests);
  };
  add(0, false);
  add(100, false);
  add(160, true);
  add(280, false);  // neither early nor a pause
  add(380, false);
  CHECK(meter.finish().lateness == 0);
  add(500, false);
  CHECK(meter.finish().lateness == 20 * ms);
}

TEST_CASE("meter: what is sent on events is behind nothing") {
  const Measured event = measured(Grid::none, {0, 100, 230, 240, 900});
  CHECK(event.lateness == 0);
  CHECK(event.response == 1 * ms);
  CHECK(event.shortest == 10 * ms);
  CHECK(event.longest == 660 * ms);
}

}  // namespace analyse_meter_test
