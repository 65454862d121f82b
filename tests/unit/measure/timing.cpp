#include "ocm/measure/timing.hpp"

#include <chrono>
#include <initializer_list>
#include <random>

#include <catch2/catch.hpp>

namespace measure_timing_test {

using namespace std::chrono_literals;
using namespace ocm::measure;
using ocm::base::Duration;
using ocm::base::Time;

constexpr Time at(Duration since) {
  return Time{since};
}

Stream stream_of(std::initializer_list<int> milliseconds, Duration asked) {
  Stream stream{50ms};
  stream.asked(at(std::chrono::milliseconds{*milliseconds.begin()}), asked);
  for (const int ms : milliseconds) stream.sample(at(std::chrono::milliseconds{ms}));
  return stream;
}

TEST_CASE("timing: a perfect stream") {
  const Timing timing = stream_of({0, 500, 1000, 1500, 2000}, 500ms).timing(at(2s));
  CHECK(timing.count == 5);
  CHECK(timing.distances == 4);
  CHECK(timing.rate_hz == 2.0);
  CHECK(timing.mean_ns == 5e8);
  CHECK(timing.jitter_ns == 0.0);
  CHECK(timing.spread_ns == 0);
  CHECK(timing.lateness_ns == 0);
  CHECK(timing.gap_ns == 500'000'000);
  CHECK(timing.gap_from == at(0s));  // of equal ones the first
  CHECK(timing.missing == 0);
  CHECK(timing.period_ns == 500'000'000);
  CHECK(timing.period_from == PeriodFrom::request);
}

TEST_CASE("timing: of a stream that has had no sample there is nothing to say") {
  for (const Timing& timing : {Timing{}, Stream{}.timing(at(1s)), Stream{50ms}.timing(at(1s))}) {
    CHECK(timing.count == 0);
    CHECK(timing.distances == 0);
    CHECK(timing.rate_hz == 0.0);
    CHECK(timing.mean_ns == 0.0);
    CHECK(timing.jitter_ns == 0.0);
    CHECK(timing.spread_ns == 0);
    CHECK(timing.lateness_ns == 0);
    CHECK(timing.gap_ns == 0);
    CHECK(timing.missing == 0);
    CHECK(timing.backwards == 0);
    CHECK(timing.period_ns == 0);
    CHECK(timing.period_from == PeriodFrom::nothing);
    CHECK_FALSE(timing.faster);
    CHECK_FALSE(timing.due);
  }
}

TEST_CASE(
    "timing: two samples have a rate, however close they are, and no period unless there is a usual one") {
  Stream stream;
  stream.sample(at(0ns));
  stream.sample(at(1ns));
  const Timing timing = stream.timing(at(1ns));
  CHECK(timing.distances == 1);
  CHECK(timing.mean_ns == 1.0);
  CHECK(timing.rate_hz == 1e9);
  CHECK(timing.period_from == PeriodFrom::nothing);
  CHECK_FALSE(timing.due);
}

TEST_CASE("timing: a period of a nanosecond is one") {
  Stream stream{1ns, Usual::stated};
  stream.sample(at(0ns));
  stream.sample(at(3ns));
  const Timing timing = stream.timing(at(6ns));
  CHECK(timing.period_from == PeriodFrom::spec);
  CHECK(timing.period_ns == 1);
  CHECK(timing.missing == 2 + 2);
  Stream measured{50ms};
  measured.sample(at(0ns));
  measured.sample(at(1ns));
  CHECK(measured.timing(at(1ns)).period_from == PeriodFrom::measured);
  CHECK(measured.timing(at(1ns)).period_ns == 1);
}

TEST_CASE("timing: samples are due from the request on, until one to stop") {
  Stream stream{50ms};
  CHECK_FALSE(stream.timing(at(1s)).due);
  stream.asked(at(1s), 100ms);
  CHECK(stream.timing(at(9s)).due);
  CHECK(stream.timing(at(9s)).since == at(1s));
  stream.sample(at(1100ms));
  CHECK(stream.timing(at(9s)).due);
  CHECK(stream.timing(at(9s)).since == at(1100ms));
  stream.stopped(at(1150ms));
  CHECK_FALSE(stream.timing(at(9s)).due);
  stream.sample(at(2s));  // asked for once
  CHECK_FALSE(stream.timing(at(9s)).due);
  // Without a request, once they have come so.
  Stream unasked{50ms};
  unasked.sample(at(0ms));
  unasked.sample(at(50ms));
  CHECK(unasked.timing(at(60ms)).due);
}

TEST_CASE("timing: jitter, spread and lateness by hand") {
  // Distances 100, 103, 97, 100 ms: mean 100, squares 0 + 9 + 9 + 0, deviation sqrt(18 / 4) = 2.12132 ms.
  // Off the grid: 0, 0, 3, 0, 0.
  const Timing timing = stream_of({0, 100, 203, 300, 400}, 100ms).timing(at(400ms));
  CHECK(timing.mean_ns == 1e8);
  CHECK(timing.jitter_ns == Approx(2.1213203e6));
  CHECK(timing.spread_ns == 6'000'000);
  CHECK(timing.lateness_ns == 3'000'000);
  CHECK(timing.gap_ns == 103'000'000);
  CHECK(timing.gap_from == at(100ms));
}

TEST_CASE("timing: drift off the grid adds up, jitter about it does not") {
  const Timing slow = stream_of({0, 101, 202, 303, 404}, 100ms).timing(at(404ms));
  CHECK(slow.jitter_ns == 0.0);
  CHECK(slow.lateness_ns == 4'000'000);
}

TEST_CASE("timing: lateness looks at a hundred samples at a time") {
  Stream stream{50ms};
  stream.asked(at(0ns), 100ms);
  for (int i = 0; i < 1000; ++i) stream.sample(at(i * 100'010us));  // 100 ppm slow
  const Timing timing = stream.timing(at(1000 * 100ms));
  CHECK(timing.lateness_ns == 99 * 10'000);
  CHECK(timing.missing == 0);
}

TEST_CASE("timing: a sample behind a missing one is one of the hundred") {
  Stream stream{50ms};
  stream.asked(at(0ns), 100ms);
  for (int i = 0; i < 500; ++i) stream.sample(at(i * 200'010us));  // each second one, 10 us later each
  const Timing timing = stream.timing(at(499 * 200'010us));
  CHECK(timing.missing == 499);
  CHECK(timing.lateness_ns == 99 * 10'000);
}

TEST_CASE("timing: samples in time are among the hundred, too") {
  Stream stream{50ms};
  stream.asked(at(0ns), 100ms);
  for (int i = 0; i <= 60; ++i) stream.sample(at(i * 100ms));
  for (int i = 1; i <= 60; ++i) stream.sample(at(6s + i * 100'010us));
  // 60 distances in time and 39 late ones before the next hundred begin.
  CHECK(stream.timing(at(12'001ms)).lateness_ns == 39 * 10'000);
}

TEST_CASE("timing: missing samples") {
  SECTION("one, and three in a row") {
    const Timing timing = stream_of({0, 100, 300, 400, 800, 900}, 100ms).timing(at(900ms));
    CHECK(timing.missing == 4);
    CHECK(timing.gap_ns == 400'000'000);
    CHECK(timing.gap_from == at(400ms));
    CHECK(timing.lateness_ns == 0);
  }
  SECTION("late is not missing: the next one makes up for it") {
    const Timing timing = stream_of({0, 100, 260, 300, 400}, 100ms).timing(at(400ms));
    CHECK(timing.missing == 0);
    CHECK(timing.lateness_ns == 60'000'000);
  }
  SECTION("late by just half a period") {
    const Timing timing = stream_of({0, 100, 250, 300, 400}, 100ms).timing(at(400ms));
    CHECK(timing.missing == 0);
    CHECK(timing.lateness_ns == 50'000'000);
  }
  SECTION("late by several, in a burst") {
    // And 20 ms late once more behind it, which is less.
    const Timing timing = stream_of({0, 100, 390, 391, 400, 500, 620}, 100ms).timing(at(620ms));
    CHECK(timing.missing == 0);
    CHECK(timing.lateness_ns == 190'000'000);
  }
  SECTION("late and missing: two came for three") {
    const Timing timing = stream_of({0, 100, 390, 400, 500}, 100ms).timing(at(500ms));
    CHECK(timing.missing == 1);
    CHECK(timing.lateness_ns == 90'000'000);
  }
  SECTION("one that comes early makes up for nothing") {
    // Off the grid: 0, 0, -70, -100, -100 ms.
    const Timing timing = stream_of({0, 100, 130, 200, 300}, 100ms).timing(at(300ms));
    CHECK(timing.missing == 0);
    CHECK(timing.lateness_ns == 100'000'000);
  }
  SECTION("all at once have no rate") {
    const Timing timing = stream_of({0, 0, 0}, 100ms).timing(at(0ms));
    CHECK(timing.mean_ns == 0.0);
    CHECK(timing.rate_hz == 0.0);
  }
  SECTION("behind a pause the grid is another") {
    const Timing timing = stream_of({0, 100, 450, 550}, 100ms).timing(at(550ms));
    CHECK(timing.missing == 3);
    CHECK(timing.lateness_ns == 0);
    const Timing shorter = stream_of({0, 100, 420, 520}, 100ms).timing(at(520ms));
    CHECK(shorter.missing == 2);
    CHECK(shorter.lateness_ns == 0);
  }
  SECTION("one that is late at the end is missing so far") {
    CHECK(stream_of({0, 100, 260}, 100ms).timing(at(260ms)).missing == 1);
  }
}

TEST_CASE("timing: samples that all have the same time have no period, and nothing of theirs is missing") {
  Stream stream{50ms};
  for (int i = 0; i < 3; ++i) stream.sample(at(1s));
  const Timing timing = stream.timing(at(2s));
  CHECK(timing.period_from == PeriodFrom::nothing);
  CHECK(timing.period_ns == 0);
  CHECK(timing.missing == 0);
  CHECK(timing.gap_ns == 1'000'000'000);
}

TEST_CASE("timing: silence at the end, where samples are due") {
  Stream stream = stream_of({0, 100, 200}, 100ms);
  CHECK(stream.timing(at(349'999'999ns)).missing == 0);
  CHECK(stream.timing(at(350ms)).missing == 1);
  const Timing timing = stream.timing(at(1200ms));
  CHECK(timing.missing == 9);
  CHECK(timing.gap_ns == 1'000'000'000);
  CHECK(timing.gap_from == at(200ms));
  CHECK(timing.rate_hz == 10.0);

  stream.stopped(at(210ms));
  const Timing stopped = stream.timing(at(1200ms));
  CHECK(stopped.missing == 0);
  CHECK(stopped.gap_ns == 100'000'000);
  CHECK(stopped.period_from == PeriodFrom::request);
  CHECK(stopped.period_ns == 100'000'000);
}

Stream stated(Duration distance, int samples) {
  Stream stream{10ms, Usual::stated};
  for (int i = 0; i < samples; ++i) stream.sample(at(i * distance));
  return stream;
}

TEST_CASE("timing: a stated period is the period, however samples come") {
  // Each second one is missing: a period that is only looked for would be 20 ms.
  const Timing half = stated(20ms, 301).timing(at(6s));
  CHECK(half.period_from == PeriodFrom::spec);
  CHECK(half.period_ns == 10'000'000);
  CHECK(half.missing == 300);
  CHECK(half.mean_ns == 2e7);
  CHECK_FALSE(half.faster);
  const Timing on_time = stated(10ms, 100).timing(at(990ms));
  CHECK(on_time.missing == 0);
  CHECK(on_time.lateness_ns == 0);
  // One sample, or few: what comes after them was due.
  CHECK(stated(10ms, 1).timing(at(100ms)).missing == 9);
  CHECK(stated(10ms, 2).timing(at(110ms)).missing == 9);
  CHECK(stated(10ms, 2).timing(at(110ms)).due);
}

TEST_CASE("timing: before the first sample nothing is due, stated or not") {
  const Timing none = stated(10ms, 0).timing(at(5s));
  CHECK_FALSE(none.due);
  CHECK(none.missing == 0);
  CHECK(none.gap_ns == 0);
  CHECK(none.period_from == PeriodFrom::spec);
  CHECK(none.period_ns == 10'000'000);
}

TEST_CASE("timing: samples that come more often than stated have no lateness") {
  const Timing events = stated(5ms, 100).timing(at(500ms));
  CHECK(events.faster);
  CHECK(events.lateness_ns == 0);
  CHECK(events.missing == 0);
  CHECK(events.period_ns == 10'000'000);
  CHECK_FALSE(stated(8ms, 100).timing(at(800ms)).faster);  // within a quarter: a clock that runs fast
  CHECK_FALSE(stated(7'500us, 100).timing(at(750ms)).faster);
  CHECK(stated(7'499'999ns, 100).timing(at(750ms)).faster);
}

TEST_CASE("timing: asked, and nothing ever comes") {
  Stream stream{50ms};
  stream.asked(at(1s), 100ms);
  const Timing timing = stream.timing(at(2s));
  CHECK(timing.count == 0);
  CHECK(timing.missing == 9);
  CHECK(timing.gap_ns == 1'000'000'000);
}

TEST_CASE("timing: asked, and the first sample comes late") {
  Stream stream{50ms};
  stream.asked(at(1s), 100ms);
  stream.sample(at(1430ms));
  stream.sample(at(1530ms));
  const Timing timing = stream.timing(at(1530ms));
  CHECK(timing.missing == 3);
  CHECK(timing.gap_ns == 430'000'000);
  CHECK(timing.gap_from == at(1s));
  CHECK(timing.distances == 1);
  CHECK(timing.lateness_ns == 0);
}

TEST_CASE("timing: the distance across a request is in no figure") {
  Stream stream = stream_of({0, 100, 200}, 100ms);
  stream.stopped(at(250ms));
  stream.asked(at(60s), 20ms);
  for (int i = 0; i <= 3; ++i) stream.sample(at(60s + i * 20ms));
  const Timing timing = stream.timing(at(60s + 60ms));
  CHECK(timing.count == 7);
  CHECK(timing.distances == 5);
  CHECK(timing.mean_ns == Approx(52e6));  // (2 * 100 + 3 * 20) / 5
  CHECK(timing.jitter_ns == 0.0);         // within each stretch none
  CHECK(timing.spread_ns == 0);
  CHECK(timing.missing == 0);
  CHECK(timing.gap_ns == 100'000'000);
  CHECK(timing.period_ns == 20'000'000);
}

TEST_CASE("timing: who fell silent before he was asked again was silent all the same") {
  Stream stream = stream_of({0, 100}, 100ms);
  stream.asked(at(1100ms), 100ms);
  stream.sample(at(1101ms));
  const Timing timing = stream.timing(at(1101ms));
  CHECK(timing.missing == 9);
  CHECK(timing.gap_ns == 1'000'000'000);
  CHECK(timing.distances == 1);
}

TEST_CASE("timing: who fell silent before he was stopped was silent all the same") {
  Stream stream = stream_of({0, 100}, 100ms);
  stream.stopped(at(1100ms));
  const Timing timing = stream.timing(at(5s));
  CHECK(timing.missing == 9);
  CHECK(timing.gap_ns == 1'000'000'000);
}

TEST_CASE("timing: what comes behind a stop all the same has no period, and nothing of it is missing") {
  Stream stream = stream_of({0, 100}, 100ms);
  stream.stopped(at(150ms));
  Stream unasked{50ms};
  unasked.stopped(at(0s));
  for (Stream* each : {&stream, &unasked}) {
    for (const auto time : {1s, 2s, 3s}) each->sample(at(time));
    CHECK(each->timing(at(9s)).missing == 0);
    CHECK_FALSE(each->timing(at(9s)).due);
  }
  CHECK(stream.timing(at(9s)).period_from == PeriodFrom::request);
  CHECK(unasked.timing(at(9s)).period_from == PeriodFrom::nothing);
}

TEST_CASE("timing: a request begins another grid: lateness does not add up across it") {
  Stream stream = stream_of({0, 100, 203}, 100ms);
  stream.asked(at(250ms), 100ms);
  for (const int ms : {300, 400, 503}) stream.sample(at(std::chrono::milliseconds{ms}));
  CHECK(stream.timing(at(503ms)).lateness_ns == 3'000'000);
}

TEST_CASE("timing: without a request the period is the spec's or the measured one") {
  SECTION("the spec's") {
    Stream stream{50ms};
    for (const int ms : {0, 51, 99, 150, 250, 300}) stream.sample(at(std::chrono::milliseconds{ms}));
    const Timing timing = stream.timing(at(300ms));
    CHECK(timing.period_from == PeriodFrom::spec);
    CHECK(timing.period_ns == 50'000'000);
    CHECK(timing.missing == 1);
    CHECK(timing.lateness_ns == 2'000'000);
  }
  SECTION("the spec's up to a quarter beside it, and the middle one of few distances") {
    for (const int distance : {38, 62}) {
      Stream stream{50ms};
      for (int i = 0; i < 20; ++i) stream.sample(at(i * std::chrono::milliseconds{distance}));
      CHECK(stream.timing(at(1s)).period_from == PeriodFrom::spec);
    }
    for (const int distance : {37, 63}) {
      Stream stream{50ms};
      for (int i = 0; i < 20; ++i) stream.sample(at(i * std::chrono::milliseconds{distance}));
      const Timing timing = stream.timing(at(1s));
      CHECK(timing.period_from == PeriodFrom::measured);
      CHECK(timing.period_ns == distance * 1'000'000);
    }
    for (const Duration distance : {Duration{37'500us}, Duration{62'500us}}) {
      Stream stream{50ms};
      for (int i = 0; i < 20; ++i) stream.sample(at(i * distance));
      CHECK(stream.timing(at(19 * distance)).period_from == PeriodFrom::spec);
    }
    Stream few{50ms};
    for (const int ms : {0, 200, 220, 1220}) few.sample(at(std::chrono::milliseconds{ms}));  // 200, 20, 1000
    CHECK(few.timing(at(1220ms)).period_ns == 200'000'000);
    Stream two{50ms};
    for (const int ms : {0, 200, 220}) two.sample(at(std::chrono::milliseconds{ms}));  // 200, 20: the shorter
    CHECK(two.timing(at(220ms)).period_ns == 20'000'000);
  }
  SECTION("measured by the middle one of the first nine") {
    Stream stream{100ms};
    Time time = at(0ns);
    stream.sample(time);
    for (const int distance : {20, 20, 20, 20, 30, 30, 30, 30, 30, 20})
      stream.sample(time += std::chrono::milliseconds{distance});
    CHECK(stream.timing(time).period_ns == 30'000'000);
  }
  SECTION("measured") {
    Stream stream{50ms};
    for (const int ms : {0, 20, 41, 60, 100, 120, 140, 160, 180, 200, 300, 320})
      stream.sample(at(std::chrono::milliseconds{ms}));
    const Timing timing = stream.timing(at(320ms));
    CHECK(timing.period_from == PeriodFrom::measured);
    CHECK(timing.period_ns == 20'000'000);
    CHECK(timing.missing == 1 + 4);
    CHECK(timing.lateness_ns == 0);
  }
  SECTION("a single sample says nothing") {
    Stream stream{50ms};
    stream.sample(at(0ns));
    const Timing timing = stream.timing(at(10s));
    CHECK(timing.period_from == PeriodFrom::nothing);
    CHECK(timing.distances == 0);
    CHECK(timing.gap_ns == 0);
  }
  SECTION("set points have none") {
    Stream stream{0ms};
    for (const int ms : {0, 100, 200, 900}) stream.sample(at(std::chrono::milliseconds{ms}));
    const Timing timing = stream.timing(at(5s));
    CHECK(timing.period_from == PeriodFrom::nothing);
    CHECK(timing.missing == 0);
    CHECK(timing.gap_ns == 700'000'000);
    CHECK(timing.distances == 3);
  }
  SECTION("who is asked for one sample at a time has none") {
    Stream stream{50ms};
    for (int i = 0; i < 20; ++i) {
      stream.stopped(at(i * 50ms));
      stream.sample(at(i * 50ms + 1ms));
    }
    const Timing timing = stream.timing(at(5s));
    CHECK(timing.count == 20);
    CHECK(timing.distances == 0);
    CHECK(timing.missing == 0);
    CHECK(timing.period_from == PeriodFrom::nothing);
  }
}

TEST_CASE("timing: times that go back are counted, and what follows is compared with them") {
  Stream stream{0ms};
  for (const int ms : {100, 200, 50, 150}) stream.sample(at(std::chrono::milliseconds{ms}));
  const Timing timing = stream.timing(at(200ms));
  CHECK(timing.backwards == 1);
  CHECK(timing.distances == 2);
  CHECK(timing.mean_ns == 1e8);
}

TEST_CASE("timing: what was left out is missing, and what is a little late is not") {
  std::mt19937 random{5};
  for (int run = 0; run < 200; ++run) {
    Stream stream{50ms};
    stream.asked(at(0ns), 10ms);
    std::uint64_t left_out = 0;
    Duration latest{0}, earliest{0}, end{0};
    bool first = true;
    for (int i = 0; i < 90; ++i) {
      if (!first && i < 89 && random() % 4 == 0) {
        ++left_out;
        continue;
      }
      const Duration late{first ? 0 : static_cast<std::int64_t>(random() % 2'000'000)};
      end = i * Duration{10ms} + late;
      stream.sample(at(end));
      latest = std::max(latest, late);
      earliest = std::min(earliest, late);
      first = false;
    }
    const Timing timing = stream.timing(at(end));
    CHECK(timing.missing == left_out);
    CHECK(timing.lateness_ns <= (latest - earliest).count());
    CHECK(timing.count + timing.missing == 90);
  }
}

}  // namespace measure_timing_test
