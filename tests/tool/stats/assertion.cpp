#include "cli/stats/assertion.hpp"

#include <limits>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/protocol/example_topics.hpp"

namespace stats_assertion_test {

using namespace ocm;
using namespace ocm::cli::stats;

/// A bus on which each quantity has a value of its own.
Bus bus() {
  Bus bus;
  bus.name = "can0";
  bus.drops = 13;
  auto& figures = bus.figures;
  figures.first = base::Time{base::Duration{1'000'000'000}};
  figures.last = base::Time{base::Duration{3'000'000'000}};
  figures.bit_rates.nominal = 500'000;
  figures.rate_hz = 90;
  figures.load = 0.25;
  figures.worst_load = 0.5;
  figures.counters.frames = 100;
  figures.counters.errors = 7;
  figures.counters.unknown = 2;
  figures.counters.fd = 1;  // of CAN FD, which no topic has either
  figures.counters.incomplete = 4;
  figures.counters.wrong_dlc = 5;
  measure::TopicFigures scale;
  scale.topic = &test::catalogue.topics[0];
  scale.incomplete = 2;
  scale.wrong_dlc = 6;
  scale.load = 0.125;
  auto& timing = scale.timing;
  timing.count = 20;
  timing.distances = 19;
  timing.rate_hz = 9.5;
  timing.mean_ns = 105e6;
  timing.jitter_ns = 1'500;
  timing.spread_ns = 8'000'000;
  timing.lateness_ns = 3'000'000;
  timing.gap_ns = 400'000'000;
  timing.missing = 1;
  timing.period_from = measure::PeriodFrom::request;
  figures.topics.push_back(scale);
  return bus;
}
Assertion assertion(const std::string& text) {
  auto parsed = Assertion::parse(text, test::catalogue);
  CAPTURE(text);
  REQUIRE(parsed);
  return std::move(*parsed);
}
std::string said(const std::string& text, const std::vector<Bus>& buses = {bus()}) {
  return assertion(text).check(buses).said;
}
bool holds(const std::string& text, const std::vector<Bus>& buses = {bus()}) {
  return assertion(text).check(buses).holds;
}

TEST_CASE("assertions: each quantity") {
  for (const char* text :
       {"scale.rate==9.5",     "scale.count==20",     "scale.period==105ms", "scale.jitter==1500ns",
        "scale.spread==8ms",   "scale.lateness==3ms", "scale.gap==400ms",    "scale.missing==1",
        "scale.incomplete==2", "scale.wrong==6",      "scale.load==12.5%",   "bus.rate==90Hz",
        "bus.incomplete==4",   "bus.wrong==5",        "bus.load==25%",       "bus.peak==50%",
        "bus.frames==93",      "bus.errors==7",       "bus.drops==13",       "bus.unknown==3"}) {
    CAPTURE(text);
    CHECK(holds(text));
  }
}

TEST_CASE("assertions: each relation, at the limit and beside it") {
  const auto row = [](const std::string& relation) {
    std::string all;
    for (const char* limit : {"19", "20", "21"}) all += holds("scale.count" + relation + limit) ? 'y' : 'n';
    return all;
  };
  CHECK(row("<") == "nny");
  CHECK(row("<=") == "nyy");
  CHECK(row(">") == "ynn");
  CHECK(row(">=") == "yyn");
  CHECK(row("=") == "nyn");
  CHECK(row("==") == "nyn");
  CHECK(row("!=") == "yny");
  CHECK(row(" <= ") == "nyy");
  CHECK(holds("  scale.count  ==  20  "));
}

TEST_CASE("assertions: what was not measured does not hold, whatever is asked") {
  Bus silent = bus();
  silent.figures.topics.clear();
  for (const char* text : {"scale.rate>0", "scale.period>=0ms", "scale.jitter<1s", "scale.gap<1s",
                           "scale.missing==0", "scale.load<1%", "scale.incomplete==0", "scale.wrong==0"}) {
    CAPTURE(text);
    CHECK_FALSE(holds(text, {silent}));
    CHECK(said(text, {silent}) == std::string{text} + ": nothing was measured");
  }
  CHECK(holds("scale.count==0", {silent}));
  CHECK_FALSE(holds("bus.errors==0", {}));

  Bus unknown = bus();  // no bit rate, and nothing says when a sample was due
  unknown.figures.bit_rates.nominal = 0;
  unknown.figures.topics[0].load = std::numeric_limits<double>::quiet_NaN();
  unknown.figures.topics[0].timing.period_from = measure::PeriodFrom::nothing;
  for (const char* text :
       {"bus.load<100%", "bus.peak<100%", "scale.load<100%", "scale.lateness<1h", "scale.missing<9"}) {
    CAPTURE(text);
    CHECK_FALSE(assertion(text).check(std::vector{unknown}).measured);
  }
  unknown.figures.topics[0].timing.period_from = measure::PeriodFrom::measured;
  CHECK_FALSE(holds("scale.lateness<1h", {unknown}));
  CHECK(holds("scale.missing<9", {unknown}));
  unknown.figures.topics[0].timing.period_from = measure::PeriodFrom::spec;
  CHECK(holds("scale.lateness<1h", {unknown}));

  Bus moment = bus();  // one frame lasts no time
  moment.figures.last = moment.figures.first;
  CHECK_FALSE(holds("bus.rate>0", {moment}));
  CHECK_FALSE(holds("bus.load>=0%", {moment}));
  moment.figures.topics[0].timing.distances = 0;
  CHECK_FALSE(holds("scale.rate>0", {moment}));
  CHECK(holds("scale.gap==400ms", {moment}));  // to the end of the log
  moment.figures.topics[0].timing.gap_ns = 0;
  CHECK_FALSE(holds("scale.gap>=0", {moment}));
}

TEST_CASE("assertions: a topic is measured where a sample came, came in part, or is missing") {
  for (const unsigned count : {0U, 1U, 2U})
    for (const unsigned missing : {0U, 1U, 2U})
      for (const unsigned incomplete : {0U, 1U, 2U}) {
        CAPTURE(count, missing, incomplete);
        Bus one = bus();
        auto& topic = one.figures.topics[0];
        topic.timing.count = count;
        topic.timing.missing = missing;
        topic.incomplete = incomplete;
        CHECK(holds("scale.wrong==6", {one}) == (count > 0 || missing > 0 || incomplete > 0));
      }
}

TEST_CASE("assertions: of several buses the first on which it does not hold is named") {
  Bus first = bus(), second = bus(), third = bus();
  second.name = "can1";
  second.figures.topics[0].timing.count = 5;
  third.name = "can2";
  CHECK_FALSE(holds("scale.count==20", {first, second, third}));
  CHECK(said("scale.count==20", {first, second, third}) == "scale.count==20: it is 5 on can1");
  CHECK(said("scale.count==21", {first}) == "scale.count==21: it is 20");
  CHECK(said("bus.errors==8", {second, third}) == "bus.errors==8: it is 7 on can1");
  first.figures.topics.clear();
  CHECK(holds("scale.count==20", {first, third}));
  // On none of them.
  third.figures.topics.clear();
  CHECK(said("scale.rate>0", {first, third}) == "scale.rate>0: nothing was measured on any bus");
  CHECK(said("scale.count>0", {first, third}) == "scale.count>0: it is 0 on any bus");
  CHECK(holds("scale.count==0", {first, third}));
}

TEST_CASE("assertions: what is measured is said in six digits") {
  Bus one = bus();
  auto& timing = one.figures.topics[0].timing;
  timing.rate_hz = 9.87654321;
  timing.mean_ns = 101'234'567;
  timing.spread_ns = 1'234'567'890;
  one.figures.load = 0.123456789;
  CHECK(said("scale.rate<1", {one}) == "scale.rate<1: it is 9.87654 Hz");
  CHECK(said("scale.period<1ms", {one}) == "scale.period<1ms: it is 101.235 ms");
  CHECK(said("scale.spread<1ms", {one}) == "scale.spread<1ms: it is 1.23457 s");
  CHECK(said("bus.load<1%", {one}) == "bus.load<1%: it is 12.346 %");
}

TEST_CASE("assertions: numbers with their units, in as many digits as asked for") {
  CHECK(to_text(12.4, Unit::none, 4) == "12");
  CHECK(to_text(9.51234, Unit::hertz, 4) == "9.512 Hz");
  CHECK(to_text(12.3456, Unit::percent, 4) == "12.3 %");
  CHECK(to_text(999, Unit::time, 4) == "999 ns");
  CHECK(to_text(1e3, Unit::time, 4) == "1 us");
  CHECK(to_text(999'900, Unit::time, 4) == "999.9 us");
  CHECK(to_text(1e6, Unit::time, 4) == "1 ms");
  CHECK(to_text(1e9, Unit::time, 4) == "1.000 s");
  CHECK(to_text(9.9e9, Unit::time, 4) == "9.900 s");
  CHECK(to_text(1e10, Unit::time, 4) == "10.0 s");
}

TEST_CASE("assertions: what is none") {
  for (const char* text :
       {"scale.rate", "rate>1", "scale.rat>1", "bus.jitter<1ms", "scale.peak<1%", "scale.rate>fast",
        "scale.rate>1ms", "scale.gap>1", "scale.gap>1Hz", "scale.load<1", "scale.count>1ms", "scale.rate!1",
        "scale.rate=>1", "scale.rate>", "scale.rate>=", ">1", ".rate>", ""}) {
    CAPTURE(text);
    CHECK_FALSE(Assertion::is_well_formed(text));
  }
  for (const char* text : {"scale.gap<=0", "scale.load<=0", "scale.rate>1Hz", "stranger.rate>1"}) {
    CAPTURE(text);
    CHECK(Assertion::is_well_formed(text));
  }
  CHECK_FALSE(Assertion::parse("stranger.rate>1", test::catalogue));
}

}  // namespace stats_assertion_test
