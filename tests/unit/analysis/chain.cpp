#include "ocm/analysis/chain.hpp"

#include <algorithm>
#include <array>
#include <random>
#include <span>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/analysis/can_response.hpp"

namespace analysis_chain_test {

using namespace ocm::analysis;
using enum Activation;

constexpr Explained in(std::int64_t response) {
  return {.response = response, .deadline = unbounded, .reason = Reason::schedulable};
}

// By hand. Sensor each 100, over after 10 at most and 4 at least; frame 20, 12 at least; operator each 50,
// response 5; frame; motor task 3.
constexpr std::array<Hop, 5> hops{{
    {.activation = sampled, .period = 100, .best = 4},
    {.best = 12},
    {.activation = sampled, .period = 50, .best = 1},
    {.best = 12},
    {.best = 3},
}};
constexpr std::array<std::int64_t, 5> alone{10, 20, 5, 20, 3};
struct Solved {
  std::array<Hop, 5> chain;
  ChainBound bound;
};
constexpr Solved solve(std::int64_t deadline) {
  Solved solved{hops, {}};
  solved.bound = bound_chain(solved.chain, deadline, [](std::size_t i, std::int64_t jitter) {
    return in(alone[i] + jitter);  // R has J in it, as those of tasks and messages have
  });
  return solved;
}
constexpr Solved by_hand = solve(208);
static_assert(by_hand.bound.latency == 10 + 20 + (50 + 5) + 20 + 3);
static_assert(by_hand.bound.shortest == 4 + 12 + 1 + 12 + 3);
static_assert(by_hand.bound.age == 108 + 100);
static_assert(by_hand.bound.ok() && by_hand.bound.hop == 2);
static_assert(solve(207).bound.reason == Reason::misses_deadline);
// Jitter: of the sensor 6, then with the frame's own 8; the operator starts again with its own 4.
static_assert(by_hand.chain[1].inherited == 6 && by_hand.chain[1].hands_on == 6 + 8);
static_assert(by_hand.chain[2].inherited == 0 && by_hand.chain[2].hands_on == 4);
static_assert(by_hand.chain[4].inherited == 4 + 8 && by_hand.chain[4].hands_on == 12);
static_assert(by_hand.chain[2].waits == 50 && by_hand.chain[2].until == 85);

// All jitter is known after one pass, and that none grows any more after two: so many, and no more, are made.
constexpr ChainBound solve_in(int passes) {
  auto chain = hops;
  return bound_chain(
      chain, 208, [](std::size_t i, std::int64_t jitter) { return in(alone[i] + jitter); }, passes);
}
static_assert(solve_in(2).ok() && solve_in(2).latency == by_hand.bound.latency);
static_assert(solve_in(1).reason == Reason::too_long && solve_in(1).hop == no_index);
static_assert(solve_in(1).latency == unbounded && solve_in(1).age == unbounded);

// No hop is faster than it is slow, whatever is said of its best.
static_assert([] {
  std::array<Hop, 1> chain{{{.activation = sampled, .period = 100, .best = 50}}};
  const ChainBound bound = bound_chain(chain, 120, [](std::size_t, std::int64_t) { return in(20); });
  return bound.ok() && bound.latency == 20 && bound.shortest == 20 && chain[0].hands_on == 0;
}());

// The same with a sensor that may be released 7 late and an operator 9 late: each is over so much later, and
// of the sensor's own jitter all is handed on, of the operator's own, too, but nothing of what came before
// it.
constexpr Solved solve_with_jitter() {
  Solved solved{hops, {}};
  solved.chain[0].jitter = 7;
  solved.chain[2].jitter = 9;
  solved.bound = bound_chain(solved.chain, unbounded,
                             [](std::size_t i, std::int64_t jitter) { return in(alone[i] + jitter); });
  return solved;
}
constexpr Solved jittery = solve_with_jitter();
static_assert(jittery.chain[0].inherited == 7 && jittery.chain[0].responds == 10 + 7);
static_assert(jittery.chain[0].hands_on == 10 + 7 - 4);
static_assert(jittery.chain[1].inherited == 13 && jittery.chain[1].responds == 20);
static_assert(jittery.chain[1].hands_on == 13 + 20 - 12);
static_assert(jittery.chain[2].inherited == 9 && jittery.chain[2].responds == 5 + 9);
static_assert(jittery.chain[2].hands_on == 5 + 9 - 1);
static_assert(jittery.chain[3].inherited == 13 && jittery.chain[3].hands_on == 13 + 20 - 12);
static_assert(jittery.bound.latency == 17 + 20 + (50 + 14) + 20 + 3);
static_assert(jittery.bound.shortest == by_hand.bound.shortest);

/// Plays a chain many times: each hop takes anything from its best to its worst, each grid has any phase.
std::int64_t longest_played(const std::vector<Hop>& chain, const std::vector<std::int64_t>& worst, bool age,
                            std::mt19937& random) {
  const auto up_to = [&](std::int64_t most) {
    const auto choice = random() % 3;
    if (choice == 0) return most;
    return choice == 1 ? std::int64_t{0}
                       : static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(most + 1));
  };
  std::vector<std::int64_t> phases;
  for (const Hop& hop : chain)
    phases.push_back(hop.activation == sampled ? static_cast<std::int64_t>(random()) % hop.period : 0);
  std::int64_t longest = 0;
  for (std::int64_t release = 10'000; release < 20'000; release += chain[0].period) {
    std::int64_t now = release;
    for (std::size_t i = 0; i < chain.size(); ++i) {
      if (chain[i].activation == sampled && i > 0) {
        // The first of its releases that is not before the value.
        const std::int64_t since = now - phases[i];
        now = phases[i] + (since + chain[i].period - 1) / chain[i].period * chain[i].period;
      }
      now += chain[i].best + up_to(worst[i] - chain[i].best);
    }
    longest = std::max(longest, now - release);
  }
  // What happened just after the sensor looked is seen at its next release.
  return age ? longest + chain[0].period - 1 : longest;
}

TEST_CASE("no chain that is played takes longer than was said, and the bound is nearly reached") {
  std::mt19937 random{1994};
  int near = 0;
  constexpr int rounds = 400;
  for (int round = 0; round < rounds; ++round) {
    std::vector<Hop> chain(1 + random() % 5);
    std::vector<std::int64_t> worst;
    for (std::size_t i = 0; i < chain.size(); ++i) {
      chain[i].activation = i == 0 || random() % 2 == 0 ? sampled : triggered;
      chain[i].period = 20 + static_cast<std::int64_t>(random() % 80);
      chain[i].best = static_cast<std::int64_t>(random() % 10);
      worst.push_back(chain[i].best + static_cast<std::int64_t>(random() % 15));
    }
    const ChainBound bound =
        bound_chain(chain, 1'000, [&](std::size_t i, std::int64_t jitter) { return in(worst[i] + jitter); });
    REQUIRE(bound.reason != Reason::bad_input);
    std::int64_t latency = 0;
    std::int64_t age = 0;
    for (int run = 0; run < 40; ++run) {
      latency = std::max(latency, longest_played(chain, worst, false, random));
      age = std::max(age, longest_played(chain, worst, true, random));
    }
    CAPTURE(round);
    REQUIRE(latency <= bound.latency);
    REQUIRE(age <= bound.age);
    near += 100 * latency >= 85 * bound.latency ? 1 : 0;
  }
  CHECK(near > rounds * 3 / 4);
}

TEST_CASE("frames of a chain delay each other on one bus, with the jitter that each has inherited") {
  // A command frame, a sensor frame and one of another node; the sensor's task varies by 200.
  std::array<Message, 3> bus{
      {{.cost = 130, .period = 1'000}, {.cost = 130, .period = 1'000}, {.cost = 130, .period = 5'000}}};
  CanResponse<3> analysis;
  std::array<Hop, 4> chain{{{.activation = sampled, .period = 1'000}, {.best = 50}, {}, {.best = 50}}};
  const auto respond = [&](std::size_t i, std::int64_t jitter) {
    if (i == 0) return in(200);
    if (i == 2) return in(300 + jitter);  // an operator that answers each sample
    const std::size_t message = i == 1 ? 1 : 0;
    bus[message].jitter = jitter;
    return analysis.analyse(bus, {})[message];
  };
  const ChainBound bound = bound_chain(chain, 3'000, respond);
  REQUIRE(bound.ok());
  CHECK(chain[1].inherited == 200);
  CHECK(bus[1].jitter == 200);
  // The sensor's frame: 130 from below, its own, and twice 130 by the command, whose jitter, at the end of
  // the chain, brings two of them together: known in the second pass only.
  CHECK(chain[1].responds == 520);
  CHECK(chain[2].inherited == 200 + 520 - 50);
  CHECK(chain[3].inherited == 200 + 520 - 50 + 300);
  CHECK(bus[0].jitter == chain[3].inherited);
  CHECK(bound.latency == 200 + 520 + 300 + chain[3].responds);
  // What was said holds for the set as it is now.
  CHECK(analysis.analyse(bus, {})[1].response == 200 + 520);
}

TEST_CASE("chains: what cannot be bounded has a reason and a hop") {
  const auto overloaded = [](std::size_t i, std::int64_t) {
    return i == 1 ? Explained{.reason = Reason::overloaded} : in(5);
  };
  std::array<Hop, 2> chain{{{.activation = sampled, .period = 10}, {}}};
  CHECK(bound_chain(chain, 100, overloaded).reason == Reason::overloaded);
  CHECK(bound_chain(chain, 100, overloaded).hop == 1);
  CHECK(bound_chain({}, 100, overloaded).reason == Reason::bad_input);

  // Each pass makes the first hop slower by what the second has inherited.
  std::int64_t seen = 0;
  const auto circle = [&](std::size_t i, std::int64_t jitter) {
    if (i == 1) seen = jitter;
    return in(i == 0 ? 10 + seen : 5 + jitter);
  };
  CHECK(bound_chain(chain, 100, circle).reason == Reason::too_long);
  const auto huge = [](std::size_t, std::int64_t) { return in(unbounded - 1); };
  CHECK(bound_chain(chain, 100, huge).reason == Reason::too_long);
  // A sum that 63 bits do not hold is the fault of the hop at which it is one; of the age, of none.
  std::array<Hop, 2> sampling{{{.activation = sampled, .period = 10}, {.activation = sampled, .period = 10}}};
  CHECK(bound_chain(sampling, 100, huge).reason == Reason::too_long);
  CHECK(bound_chain(sampling, 100, huge).hop == 1);
  const ChainBound old = bound_chain(std::span{sampling}.first(1), unbounded, huge);
  CHECK((old.reason == Reason::too_long && old.hop == no_index && old.age == unbounded));

  // A hop that takes no time is the longest if it is all there is; of equal ones the first.
  std::array<Hop, 2> quick{{{.activation = sampled, .period = 10}, {}}};
  const ChainBound none = bound_chain(quick, 10, [](std::size_t, std::int64_t jitter) { return in(jitter); });
  CHECK((none.ok() && none.hop == 0 && none.latency == 0 && none.age == 10));

  std::array<Hop, 1> event{{{.activation = triggered}}};
  CHECK(bound_chain(event, 100, circle).reason == Reason::bad_input);
  std::array<Hop, 1> fastest{{{.activation = sampled, .period = 1}}};
  CHECK(bound_chain(fastest, 1, [](std::size_t, std::int64_t jitter) { return in(jitter); }).ok());
  std::array<Hop, 1> timeless{{{.activation = sampled}}};
  const ChainBound refused = bound_chain(timeless, 100, circle);
  CHECK(refused.reason == Reason::bad_input);
  CHECK(refused.hop == 0);
  // Of the later hops, too: the first at fault is named.
  std::array<Hop, 3> wrong{{{.activation = sampled, .period = 10}, {.best = -1}, {.jitter = -1}}};
  CHECK(bound_chain(wrong, 100, circle).reason == Reason::bad_input);
  CHECK(bound_chain(wrong, 100, circle).hop == 1);
  wrong[1].best = 0;
  CHECK(bound_chain(wrong, 100, circle).hop == 2);
}

}  // namespace analysis_chain_test
