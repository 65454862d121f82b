// The analysis of messages against the simulated bus, which shares with it neither the length of a frame nor
// a response time: the simulator counts the bits of each content, the analysis takes the longest there is.
//
// For each message of a random set the critical instant is played: all that is more urgent is released at
// once, each as late as its jitter allows and from then on as early, one bit after the longest frame below
// it. And phases, jitters and contents at random. What is simulated must never exceed what is predicted;
// at the critical instant it must be within a bit of it. OCM_EXPLORE=20 plays 100,000 of them.
#include <algorithm>
#include <iostream>

#include <catch2/catch.hpp>

#include "ocm/analysis/can_response.hpp"

#include "unit/analysis/random_bus.hpp"
#include "unit/base/explore.hpp"

namespace analysis_can_response_properties_test {

using namespace ocm;
using namespace ocm::analysis;
using test::RandomSet;
using test::Twister;

TEST_CASE(
    "CAN: simulated never exceeds predicted; at the critical instant it is reached; mutants are caught") {
  Twister random{2007};
  CanResponse<8> analysis;
  int messages = 0;
  int reached = 0;
  int sets_without_jitter = 0;
  int messages_without_jitter = 0;
  int reached_without_jitter = 0;
  int caught[3] = {};
  const int rounds = test::explored(5'000);
  for (int round = 0; round < rounds; ++round) {
    const RandomSet set = test::random_set(random);
    const auto results = analysis.analyse(set.messages, {});
    const bool jitter =
        std::any_of(set.messages.begin(), set.messages.end(), [](const Message& m) { return m.jitter != 0; });
    sets_without_jitter += jitter ? 0 : 1;
    std::int64_t horizon = 20'000;
    for (std::size_t m = 0; m < set.messages.size(); ++m) {
      const Explained& result = results[m];
      CAPTURE(round, m);
      REQUIRE(result.bounded());
      const std::int64_t busy = static_cast<std::int64_t>(result.instances) * set.messages[m].period;
      const std::int64_t simulated = test::play(set, test::critical_releases(set, m, busy + 1))[m];
      REQUIRE(simulated <= result.response);
      ++messages;
      const bool close = result.response - simulated <= 1;
      reached += close ? 1 : 0;
      messages_without_jitter += jitter ? 0 : 1;
      reached_without_jitter += !jitter && close ? 1 : 0;
      REQUIRE(simulated <= test::by_the_paper(set.messages, m));
      caught[0] += simulated > test::by_the_paper(set.messages, m, {.tau_bit = false}) ? 1 : 0;
      caught[1] += simulated > test::by_the_paper(set.messages, m, {.blocking = false}) ? 1 : 0;
      caught[2] += simulated > test::by_the_paper(set.messages, m, {.later_instances = false}) ? 1 : 0;
      horizon = std::min<std::int64_t>(std::max(horizon, 2 * result.response), 100'000);
    }
    const auto longest = test::play(set, test::random_releases(set, random, horizon), {.contents = &random});
    for (std::size_t m = 0; m < set.messages.size(); ++m) {
      CAPTURE(round, m);
      REQUIRE(longest[m] <= results[m].response);
    }
  }
  std::cout << "  reached within one bit: " << reached_without_jitter << " of " << messages_without_jitter
            << " messages without jitter, " << reached << " of " << messages
            << " in all; caught without tau_bit " << caught[0] << ", without B " << caught[1]
            << ", first instance only " << caught[2] << '\n';
  CHECK(sets_without_jitter > rounds / 4);
  CHECK(reached_without_jitter > messages_without_jitter * 95 / 100);
  CHECK(reached > messages * 95 / 100);
  for (const int times : caught) CHECK(times > 0);
}

}  // namespace analysis_can_response_properties_test
