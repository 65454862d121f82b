#include "ocm/analysis/can_response.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <random>
#include <vector>

#include <catch2/catch.hpp>

namespace analysis_can_response_test {

using namespace ocm::analysis;

// [Davis, Burns, Bril, Lukkien 2007, table 1] 125 kbit/s, 7 bytes each; in microseconds, one bit is 8.
constexpr std::array<Message, 3> davis{{
    {.cost = 1'000, .period = 2'500, .deadline = 2'500},
    {.cost = 1'000, .period = 3'500, .deadline = 3'250},
    {.cost = 1'000, .period = 3'500, .deadline = 3'250},
}};
constexpr auto davis_exact = can_response_times(davis, {.bit = 8});
static_assert(davis_exact[0].response == 2'000 && davis_exact[0].ok());
static_assert(davis_exact[1].response == 3'000 && davis_exact[1].ok());
static_assert(davis_exact[2].response == 3'500);
// The first instance ends in time, the second is pushed beyond its deadline.
static_assert(davis_exact[2].reason == Reason::misses_deadline);
static_assert(davis_exact[2].instance == 1 && davis_exact[2].instances == 2);
static_assert(davis_exact[2].slack() == -250);
static_assert(davis_exact[2].blocked_by == no_index && davis_exact[1].blocked_by == 2);
static_assert(can_response_times(davis, {.bit = 8}, CanTest::sufficient)[2].response == 7'000);

// Its own frame before it counts only where it is longer than what blocks it.
static_assert(can_response_times(davis, {.bit = 8}, CanTest::sufficient)[0].blocked_by == 1);
static_assert(can_response_times(davis, {.bit = 8}, CanTest::sufficient)[2].blocked_by == 2);

// tau_bit: the third is released again in the very bit in which the message would start.
constexpr std::array<Message, 3> tau{{
    {.cost = 20, .period = 70},
    {.cost = 20, .period = 80},
    {.cost = 35, .period = 200},
}};
static_assert(can_response_times(tau)[0].response == 55);
static_assert(can_response_times(tau)[1].response == 75);
static_assert(can_response_times(tau)[2].response == 75);
constexpr std::array<Message, 2> trap{{{.cost = 20, .period = 20}, {.cost = 15, .period = 100}}};
static_assert(can_response_times(trap)[1].reason == Reason::overloaded);

// Deadline monotonic is not optimal on CAN: the swap is in can_assignment.cpp.
constexpr std::array<Message, 3> opa{{
    {.cost = 125, .period = 280, .deadline = 275},
    {.cost = 125, .period = 360, .deadline = 345},
    {.cost = 95, .period = 550, .deadline = 425},
}};
static_assert(can_response_times(opa)[0].response == 250);
static_assert(can_response_times(opa)[1].response == 345);
static_assert(can_response_times(opa)[2].response == 515);
static_assert(can_response_times(opa)[2].reason == Reason::misses_deadline);

// What the numbers are made of.
static_assert(can_response_times(opa)[0].blocking == 125 && can_response_times(opa)[0].blocked_by == 1);
static_assert(can_response_times(opa)[2].largest == 0);
static_assert([] {
  const Explained third = can_response_times(opa)[2];
  const auto q = static_cast<std::int64_t>(third.instance);
  return third.response ==
         opa[2].jitter + third.blocking + (q + 1) * opa[2].cost + third.interference - q * opa[2].period;
}());

// Jitter delays the message itself, and brings releases of others together.
constexpr std::array<Message, 2> late{
    {{.cost = 10, .period = 100, .jitter = 95}, {.cost = 10, .period = 100}}};
static_assert(can_response_times(late)[0].response == 95 + 10 + 10);
static_assert(can_response_times(late)[1].response == 10 + 10 + 10);

// While the long frame is sent, the short one is released many times: w = 100 + ceil((w + 1) / 3) = 151.
constexpr std::array<Message, 3> long_frame{
    {{.cost = 1, .period = 3}, {.cost = 100, .period = 1'000}, {.cost = 1, .period = 1'000}}};
static_assert(can_response_times(long_frame)[2].response == 151 + 1);

// Errors: a burst of one costs an error frame of 31 bits and the longest frame once more.
static_assert(can_response_times(tau, {.bit = 1, .errors = {.burst = 1}})[0].response == 55 + 31 + 20);
static_assert(can_response_times(tau, {.bit = 1, .errors = {.burst = 2}})[0].response == 55 + 2 * (31 + 20));
static_assert(can_response_times(tau, {.bit = 1, .errors = {.burst = 1, .every = 51}})[0].reason ==
              Reason::overloaded);
static_assert(can_response_times(tau, {.bit = 1, .errors = {.burst = 0, .every = 51}})[0].reason ==
              Reason::bad_input);

// U = 1 ends with the hyperperiod where nothing else is there; never with blocking.
constexpr std::array<Message, 2> full{{{.cost = 10, .period = 20}, {.cost = 10, .period = 20}}};
static_assert(can_response_times(full)[1].response == 20);
static_assert(can_response_times(full)[0].response == 20);
constexpr std::array<Message, 3> over{
    {{.cost = 10, .period = 20}, {.cost = 10, .period = 20}, {.cost = 1, .period = 1'000'000}}};
static_assert(can_response_times(over)[0].response == 20);
static_assert(can_response_times(over)[1].reason == Reason::overloaded);
// Each asks for four thousand million times what there is: the sum of that has no room in 63 bits.
constexpr Message all_of_it{.cost = 0xFFFF'FFFF, .period = 1};
static_assert(can_response_times(std::array<Message, 3>{all_of_it, all_of_it, all_of_it})[2].reason ==
              Reason::overloaded);
static_assert(can_response_times(over)[2].reason == Reason::overloaded);

// Of those above, the one that asks for the most is named, also where its frame is long and fills the bus 8
// times.
static_assert(can_response_times(std::array<Message, 3>{{{.cost = 1LL << 31, .period = 1LL << 28},
                                                         {.cost = 5, .period = 1},
                                                         {.cost = 1, .period = 1'000}}})[2]
                  .largest == 0);

/// The formulas as they stand in the paper, from scratch for each message: slow, and on other paths. The
/// response of each instance.
std::vector<std::int64_t> by_the_paper(const std::vector<Message>& set, std::size_t m, const CanBus& bus) {
  const auto ceil = [](std::int64_t a, std::int64_t b) { return (a + b - 1) / b; };
  std::int64_t blocking = 0;
  std::int64_t longest = 0;
  for (std::size_t k = 0; k < set.size(); ++k)
    (k > m ? blocking : longest) = std::max(k > m ? blocking : longest, set[k].cost);
  const auto errors = [&](std::int64_t t) {
    if (bus.errors.burst == 0) return std::int64_t{0};
    const std::int64_t more = bus.errors.every > 0 ? ceil(t, bus.errors.every) - 1 : 0;
    return (bus.errors.burst + more) * (31 * bus.bit + longest);
  };
  std::int64_t busy = 0;
  for (std::int64_t next = set[m].cost; next != busy;) {
    busy = next;
    next = blocking + errors(busy);
    for (std::size_t k = 0; k <= m; ++k) next += ceil(busy + set[k].jitter, set[k].period) * set[k].cost;
  }
  std::vector<std::int64_t> responses;
  for (std::int64_t q = 0; q < ceil(busy + set[m].jitter, set[m].period); ++q) {
    std::int64_t window = -1;
    for (std::int64_t next = blocking + q * set[m].cost; next != window;) {
      window = next;
      next = blocking + q * set[m].cost + errors(window + set[m].cost);
      for (std::size_t k = 0; k < m; ++k)
        next += ceil(window + set[k].jitter + bus.bit, set[k].period) * set[k].cost;
    }
    responses.push_back(set[m].jitter + window - q * set[m].period + set[m].cost);
  }
  return responses;
}

TEST_CASE("the sweep over levels says what the formulas say of each message and instance alone") {
  std::mt19937 random{2007};
  const auto below = [&](std::int64_t end) {
    return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(end));
  };
  CanResponse<40> analysis;
  int several = 0;
  int with_errors = 0;
  int falls = 0;  // B becomes so much less that the level below begins before the one above
  for (int round = 0; round < 4'000; ++round) {
    std::vector<Message> set(1 + random() % (round % 8 == 0 ? 40 : 8));
    CanBus bus{.bit = 1 + below(3)};
    if (round % 4 == 1) bus.errors = {.burst = 1 + below(2), .every = below(2) * (700 + below(5'000))};
    const std::int64_t scale = 130 * static_cast<std::int64_t>(set.size()) * (1 + below(3));
    double load = bus.errors.every > 0 ? 230.0 / static_cast<double>(bus.errors.every) : 0;
    for (Message& m : set) {
      m.cost = round % 3 == 0 ? 3 + below(130) : 47 + below(90);
      m.period = scale / 3 + below(2 * scale);
      if (random() % 2 == 0) m.jitter = below(2 * m.period);
      load += static_cast<double>(m.cost) / static_cast<double>(m.period);
    }
    if (load > 0.995) continue;
    std::vector<std::vector<std::int64_t>> observed(set.size());
    const auto results = analysis.analyse(set, bus, CanTest::exact, {},
                                          [&](std::size_t m, std::int64_t q, std::int64_t response) {
                                            REQUIRE(observed[m].size() == static_cast<std::size_t>(q));
                                            observed[m].push_back(response);
                                          });
    for (std::size_t m = 0; m < set.size(); ++m) {
      CAPTURE(round, m);
      const auto expected = by_the_paper(set, m, bus);
      const auto worst = std::max_element(expected.begin(), expected.end());
      REQUIRE(observed[m] == expected);
      REQUIRE(results[m].response == *worst);
      REQUIRE(results[m].instance == static_cast<std::size_t>(worst - expected.begin()));
      REQUIRE(results[m].instances == expected.size());
      REQUIRE((results[m].reason == Reason::schedulable) == (results[m].response <= set[m].period));
      several += results[m].instances > 1 ? 1 : 0;
      with_errors += bus.errors.every > 0 ? 1 : 0;
      if (m > 0) {
        REQUIRE(results[m].largest < m);
        falls += results[m - 1].blocking > results[m].blocking + set[m - 1].cost ? 1 : 0;
      }
    }
  }
  CHECK(several > 1'000);
  CHECK(with_errors > 1'000);
  CHECK(falls > 100);
}

TEST_CASE("who delays a message most is named for its worst instance, the most urgent of equals") {
  std::mt19937 random{2011};
  CanResponse<12> analysis;
  int in_between = 0;
  for (int round = 0; round < 2'000; ++round) {
    std::vector<Message> set(2 + random() % 11);
    for (Message& m : set) {
      m.cost = 47 + 10 * static_cast<std::int64_t>(random() % 9);
      m.period = 70 * static_cast<std::int64_t>(set.size()) + static_cast<std::int64_t>(random() % 900);
    }
    const auto results = analysis.analyse(set, {});
    for (std::size_t m = 0; m < set.size(); ++m) {
      const Explained& result = results[m];
      if (!result.bounded()) continue;
      const auto before = static_cast<std::int64_t>(result.instance) * set[m].cost;
      const std::int64_t window = result.blocking + before + result.interference;
      std::int64_t most = 0;
      std::int64_t sum = 0;
      std::size_t who = no_index;
      for (std::size_t k = 0; k < m; ++k) {
        const std::int64_t share = (window + 1 + set[k].period - 1) / set[k].period * set[k].cost;
        sum += share;
        if (share > most) who = k;
        most = std::max(most, share);
      }
      CAPTURE(round, m);
      REQUIRE(sum == result.interference);
      REQUIRE(result.largest == who);
      REQUIRE(result.largest_share == most);
      in_between += result.instance + 1 < result.instances ? 1 : 0;
    }
  }
  CHECK(in_between > 500);
}

TEST_CASE("a bit that is shorter than a tick: all that comes at 0 still goes first") {
  const auto results = can_response_times(
      std::array<Message, 3>{{{.cost = 135, .period = 9'000}, {.cost = 55, .period = 9'000}, {55, 9'000}}},
      {.bit = 0});
  CHECK(results[0].response == 190);
  CHECK(results[1].response == 245);
  CHECK(results[2].response == 245);
  // The last one begins before the others do: nothing blocks it.
  const auto falls = can_response_times(
      std::array<Message, 3>{{{.cost = 55, .period = 9'000}, {.cost = 60, .period = 9'000}, {135, 9'000}}},
      {.bit = 0});
  CHECK(falls[2].response == 250);
  CHECK(
      can_response_times(std::array<Message, 1>{{{.cost = 135, .period = 9'000}}}, {.bit = 0})[0].response ==
      135);
}

TEST_CASE("CAN: numbers that mean nothing are named, and nothing is computed from them") {
  for (const Message bad :
       {Message{.period = 10}, Message{.cost = 0, .period = 10}, Message{.cost = 1, .period = 0},
        Message{.cost = -5, .period = 10}, Message{.cost = 5, .period = -10},
        Message{.cost = 5, .period = 10, .deadline = 0}, Message{.cost = 5, .period = 10, .jitter = -1}}) {
    const auto results = can_response_times(std::array<Message, 2>{{{.cost = 1, .period = 10}, bad}});
    for (const Explained& result : results) {
      CHECK(result.reason == Reason::bad_input);
      CHECK(result.largest == 1);
      CHECK_FALSE(result.bounded());
    }
  }
  CanResponse<1> small;
  CHECK(small.analyse(davis, {})[0].reason == Reason::bad_input);
  CHECK(small.analyse({}, {}).empty());
  CHECK(can_response_times(davis, {.bit = -1})[0].reason == Reason::bad_input);
  // No frame is shorter than a bit.
  const auto shorter = can_response_times(
      std::array<Message, 2>{{{.cost = 9, .period = 90}, {.cost = 7, .period = 90}}}, {.bit = 8});
  CHECK(shorter[0].reason == Reason::bad_input);
  CHECK(shorter[0].largest == 1);
}

TEST_CASE("CAN: huge and tiny numbers end with a reason") {
  constexpr std::int64_t huge = unbounded - 1;
  CHECK(can_response_times(std::array<Message, 1>{{{.cost = 1, .period = huge}}})[0].response == 1);
  CHECK(can_response_times(std::array<Message, 1>{{{.cost = huge, .period = huge}}})[0].response == huge);
  CHECK(can_response_times(
            std::array<Message, 2>{{{.cost = huge, .period = huge}, {.cost = huge, .period = huge}}})[1]
            .reason == Reason::overloaded);
  const auto jitter = can_response_times(
      std::array<Message, 2>{{{.cost = 5, .period = 6, .jitter = huge}, {.cost = 1, .period = huge}}});
  CHECK(jitter[1].reason == Reason::too_long);
  CHECK_FALSE(jitter[1].bounded());
  CHECK(can_response_times(std::array<Message, 2>{{{.cost = 1, .period = 1}, {.cost = 1, .period = 1}}})[1]
            .reason == Reason::overloaded);
  // 2^33 of 2^34 - 2^29, twice: 1.03.
  constexpr Message half{.cost = 8'589'934'592, .period = 16'642'998'272};
  CHECK(can_response_times(std::array<Message, 2>{half, half})[1].reason == Reason::overloaded);
  // 1 - U is 2 parts in 10^12: the busy period has no end worth waiting for.
  const std::array<Message, 3> close{{{.cost = 499'999'999'999, .period = 1'000'000'000'000},
                                      {.cost = 499'999'999'999, .period = 1'000'000'000'000},
                                      {.cost = 1'000'000, .period = 1'000'000'000'000'000'000}}};
  CanResponse<3> analysis;
  CHECK(analysis.analyse(close, {}, CanTest::exact, {.terms = 1'000})[2].reason == Reason::too_long);
}

TEST_CASE("what is said of a set is the same whatever was analysed before") {
  CanResponse<3> analysis;
  const auto as_alone = [&](const std::array<Message, 3>& set, const CanBus& bus) {
    REQUIRE(analysis.analyse(davis, {.bit = 8})[2].bounded());
    const auto again = analysis.analyse(set, bus);
    const auto alone = can_response_times(set, bus);
    for (std::size_t m = 0; m < set.size(); ++m) {
      CAPTURE(m);
      CHECK(again[m] == alone[m]);
    }
  };
  as_alone(over, {.bit = 1});
  as_alone(tau, {.bit = 1, .errors = {.burst = 1}});  // its longest frame is not that of before
  auto too_much = over;
  too_much[0].cost = 30;  // by itself
  as_alone(too_much, {.bit = 1});
  auto bad = davis;
  bad[1].period = 0;
  as_alone(bad, {.bit = 8});
}

TEST_CASE("2048 messages, one of them overloading the bus: all below it are found overloaded") {
  std::vector<Message> set(2048, Message{.cost = 130, .period = 300'000});
  const auto analysis = std::make_unique<CanResponse<2048>>();
  CHECK(analysis->analyse(set, {})[2047].response == 2048 * 130);
  CHECK(analysis->analyse(set, {})[0].response == 260);
  // Each level goes on where the one above it has ended: it takes fewer terms than there are messages.
  CHECK(analysis->analyse(set, {}, CanTest::exact, {.terms = 1'000})[2047].response == 2048 * 130);
  set[1'000].period = 200;
  const auto results = analysis->analyse(set, {});
  CHECK(results[999].bounded());
  CHECK(results[2047].reason == Reason::overloaded);
  CHECK(results[2047].largest == 1'000);
}

TEST_CASE("the sufficient test is never below the exact one, and says so only where it applies") {
  constexpr auto exact = can_response_times(tau);
  constexpr auto sufficient = can_response_times(tau, {}, CanTest::sufficient);
  for (std::size_t m = 0; m < tau.size(); ++m) CHECK(sufficient[m].response >= exact[m].response);
  // D > T: what the test shows is that it meets T.
  const auto late_deadline = can_response_times(
      std::array<Message, 1>{{{.cost = 30, .period = 50, .deadline = 90}}}, {}, CanTest::sufficient)[0];
  CHECK(late_deadline.response == 60);
  CHECK(late_deadline.deadline == 50);
  CHECK(late_deadline.reason == Reason::misses_deadline);
  CHECK(late_deadline.blocked_by == 0);
}

TEST_CASE("the sufficient test with errors is its equation, level by level") {
  std::mt19937 random{16};
  CanResponse<8> analysis;
  int compared = 0;
  for (int round = 0; round < 4'000; ++round) {
    std::vector<Message> set(2 + random() % 6);
    for (Message& m : set) {
      m.cost = 10 + static_cast<std::int64_t>(random() % 120);
      m.period = 2'000 + static_cast<std::int64_t>(random() % 3'000);
    }
    const CanBus bus{.bit = 1,
                     .errors = {.burst = 1, .every = 250 + static_cast<std::int64_t>(random() % 700)}};
    const auto results = analysis.analyse(set, bus, CanTest::sufficient);
    std::int64_t longest = 0;
    for (std::size_t m = 0; m < set.size(); ++m) {
      longest = std::max(longest, set[m].cost);
      if (!results[m].bounded()) continue;
      std::int64_t base = set[m].cost;
      for (std::size_t k = m + 1; k < set.size(); ++k) base = std::max(base, set[k].cost);
      std::int64_t window = -1;
      for (std::int64_t next = base; next != window;) {
        window = next;
        next = base + error_delay(bus, longest, window + set[m].cost).value();
        for (std::size_t k = 0; k < m; ++k)
          next += (window + bus.bit + set[k].period - 1) / set[k].period * set[k].cost;
      }
      CAPTURE(round, m);
      REQUIRE(results[m].response == window + set[m].cost);
      ++compared;
    }
  }
  CHECK(compared > 10'000);
}

}  // namespace analysis_can_response_test
