#include "ocm/analysis/can_offsets.hpp"

#include <algorithm>
#include <array>
#include <deque>
#include <random>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/analysis/can_response.hpp"
#include "ocm/simulation/arbiter.hpp"

namespace analysis_can_offsets_test {

using namespace ocm;
using namespace ocm::analysis;

template <std::size_t N>
constexpr std::array<std::int64_t, N> responses(const std::array<Message, N>& set,
                                                std::int64_t most_releases = 10'000, const CanBus& bus = {}) {
  CanOffsets<N, 3> analysis;
  const auto found = analysis.analyse(set, bus, {}, most_releases);
  std::array<std::int64_t, N> result{};
  for (std::size_t i = 0; i < N; ++i) result[i] = found[i].response;
  return result;
}

// By hand: three of one node 50 apart never meet each other; the fourth, of another node, meets one of them.
constexpr std::array<Message, 4> spread{{
    {.cost = 20, .period = 150, .offset = 0},
    {.cost = 20, .period = 150, .offset = 50},
    {.cost = 20, .period = 150, .offset = 100},
    {.cost = 20, .period = 150, .node = 1},
}};
static_assert(responses(spread) == std::array<std::int64_t, 4>{40, 60, 60, 40});
// Without offsets, or where the pattern is said to be too long: all at once.
static_assert(responses(spread, 2) == std::array<std::int64_t, 4>{40, 60, 80, 80});
static_assert(can_response_times(spread)[3].response == 80);
// With 50 of jitter two of them can come together.
static_assert([] {
  auto late = spread;
  late[0].jitter = 50;
  return responses(late)[3];
}() == 60);

// An error costs an error frame of 31 bits and the longest frame once more: two of the three meet the fourth.
static_assert(responses(spread, 10'000, {.bit = 1, .errors = {.burst = 1}}) ==
              std::array<std::int64_t, 4>{91, 111, 131, 111});

struct Release {
  std::int64_t at = 0;
  std::int64_t planned = 0;
  std::size_t message = 0;
};

TEST_CASE("with a node of its own for each message it is the exact analysis; with offsets never more") {
  std::mt19937 random{1994};
  CanResponse<3> exact;
  CanOffsets<3, 3> offsets;
  int less = 0;
  for (int round = 0; round < 500; ++round) {
    std::vector<Message> set(3);
    for (std::size_t i = 0; i < 3; ++i) {
      set[i] = {.cost = 50 + static_cast<std::int64_t>(random() % 80),
                .period = 100 * (3 + static_cast<std::int64_t>(random() % 6)),
                .jitter = static_cast<std::int64_t>(random() % 2 * (random() % 300)),
                .offset = static_cast<std::int64_t>(random() % 900),
                .node = static_cast<std::uint16_t>(i)};
    }
    const auto one = exact.analyse(set, {});
    const auto apart = offsets.analyse(set, {});
    for (std::size_t m = 0; m < 3; ++m) {
      CAPTURE(round, m);
      REQUIRE(apart[m].response == one[m].response);
      REQUIRE(apart[m].reason == one[m].reason);
      REQUIRE(apart[m].blocking == one[m].blocking);
      REQUIRE(apart[m].blocked_by == one[m].blocked_by);
      REQUIRE(apart[m].interference == one[m].interference);
      REQUIRE(apart[m].instance == one[m].instance);
      REQUIRE(apart[m].instances == one[m].instances);
    }
    for (Message& m : set) m.node = 0;
    const auto together = offsets.analyse(set, {});
    for (std::size_t m = 0; m < 3; ++m) {
      REQUIRE(together[m].response <= one[m].response);
      less += together[m].response < one[m].response ? 1 : 0;
    }
  }
  CHECK(less > 30);
}

TEST_CASE("offsets: with a node of its own for each message it is the exact analysis, with errors, too") {
  std::mt19937 random{2007};
  CanResponse<3> exact;
  CanOffsets<3, 3> offsets;
  int bounded = 0;
  int several = 0;
  for (int round = 0; round < 300; ++round) {
    std::array<Message, 3> set;
    for (std::size_t i = 0; i < 3; ++i)
      set[i] = {.cost = 50 + static_cast<std::int64_t>(random() % 80),
                .period = 100 * (6 + static_cast<std::int64_t>(random() % 6)),
                .jitter = static_cast<std::int64_t>(random() % 2 * (random() % 300)),
                .node = static_cast<std::uint16_t>(i)};
    const bool again = random() % 2 == 0;
    const std::int64_t every = again ? 1'000 + static_cast<std::int64_t>(random() % 1'000) : 0;
    const CanBus bus{.bit = 2,
                     .errors = {.burst = 1 + static_cast<std::int64_t>(random() % 2), .every = every}};
    const auto one = exact.analyse(set, bus);
    const auto apart = offsets.analyse(set, bus);
    for (std::size_t m = 0; m < 3; ++m) {
      CAPTURE(round, m, every);
      REQUIRE(apart[m].response == one[m].response);
      REQUIRE(apart[m].reason == one[m].reason);
      if (!one[m].bounded()) continue;
      REQUIRE(apart[m].interference == one[m].interference);
      REQUIRE(apart[m].instance == one[m].instance);
      REQUIRE(apart[m].instances == one[m].instances);
      ++bounded;
      several += one[m].instances > 1 ? 1 : 0;
    }
  }
  CHECK(bounded > 600);
  CHECK(several > 30);
}

TEST_CASE("offsets: simulated never exceeds predicted, whatever the phases of the nodes' clocks") {
  std::mt19937 random{2012};
  CanOffsets<8, 2> analysis;
  const std::array<std::int64_t, 4> periods{500, 1'000, 1'500, 3'000};
  int reached = 0;
  int messages = 0;
  for (int round = 0; round < 400; ++round) {
    std::vector<Message> set(3 + random() % 4);
    std::vector<can::Frame> frames;
    for (Message& m : set) {
      const can::Frame frame{.id = static_cast<std::uint32_t>(16 * frames.size()),
                             .dlc = static_cast<std::uint8_t>(random() % 9)};
      m = {.cost = can::frame_bits(frame) + can::intermission_bits,
           .period = periods[random() % 4],
           .offset = static_cast<std::int64_t>(random() % 20) * 50,
           .node = static_cast<std::uint16_t>(random() % 2)};
      if (random() % 3 == 0) m.jitter = static_cast<std::int64_t>(random() % 400);
      frames.push_back(frame);
    }
    const auto results = analysis.analyse(set, {});
    std::vector<std::int64_t> worst(set.size(), 0);
    for (int run = 0; run < 30; ++run) {
      std::vector<Release> releases;
      const std::array<std::int64_t, 2> phase{10'000, 10'000 + static_cast<std::int64_t>(random() % 3'000)};
      const bool all_late = random() % 2 == 0;
      for (std::size_t k = 0; k < set.size(); ++k) {
        std::int64_t last = 0;
        for (std::int64_t planned = phase[set[k].node] + set[k].offset; planned < 25'000;
             planned += set[k].period) {
          const auto late = all_late ? set[k].jitter * static_cast<std::int64_t>(random() % 2)
                                     : static_cast<std::int64_t>(random()) % (set[k].jitter + 1);
          last = std::max(last, planned + late);
          releases.push_back({last, planned, k});
        }
      }
      std::stable_sort(releases.begin(), releases.end(),
                       [](const Release& a, const Release& b) { return a.at < b.at; });
      simulation::Arbiter bus{1'000'000};
      const std::array nodes{bus.attach({simulation::QueueOrder::by_identifier, 1'000}),
                             bus.attach({simulation::QueueOrder::by_identifier, 1'000})};
      std::vector<std::deque<std::int64_t>> planned(set.size());
      const auto deliver = [&](const simulation::Delivery& delivery) {
        const std::size_t m = delivery.frame.id / 16;
        const auto over = static_cast<std::int64_t>(delivery.end + can::intermission_bits);
        worst[m] = std::max(worst[m], over - planned[m].front());
        planned[m].pop_front();
      };
      for (const Release& release : releases) {
        bus.advance(base::Time{base::Duration{release.at * 1'000}}, deliver);
        planned[release.message].push_back(release.planned);
        REQUIRE(*bus.send(nodes[set[release.message].node], frames[release.message]));
      }
      bus.advance(base::Time{base::Duration{std::int64_t{1} << 50}}, deliver);
    }
    for (std::size_t m = 0; m < set.size(); ++m) {
      CAPTURE(round, m);
      REQUIRE(worst[m] <= results[m].response);
      reached += results[m].bounded() && 100 * worst[m] >= 80 * results[m].response ? 1 : 0;
      ++messages;
    }
  }
  CHECK(reached > messages / 4);
}

TEST_CASE("offsets: a pattern of ten thousand releases is looked at, of one more it is not") {
  // The second comes five ticks after one of the first, so that the third meets only one of the two.
  std::array<Message, 3> set{{{.cost = 2, .period = 10},
                              {.cost = 2, .period = 99'990, .offset = 5},
                              {.cost = 1, .period = 99'990, .node = 1}}};
  CanOffsets<3, 2> analysis;
  CHECK(analysis.analyse(set, {})[2].response == 2 + 1);  // 9'999 releases of the first, one of the second
  set[1].period = 100'000;
  CHECK(analysis.analyse(set, {})[2].response == 2 + 2 + 1);  // 10'000 and one
}

TEST_CASE("offsets: what cannot be bounded has a reason") {
  CanOffsets<4, 2> analysis;
  auto set = spread;
  set[3].node = 2;
  CHECK(analysis.analyse(set, {})[0].reason == Reason::bad_input);
  CHECK(analysis.analyse(set, {})[0].largest == 3);
  set = spread;
  set[0].node = 2;
  CHECK(analysis.analyse(set, {})[0].reason == Reason::bad_input);
  CHECK(analysis.analyse(set, {})[3].largest == 0);
  CHECK(analysis.analyse(spread, {.bit = -1})[0].reason == Reason::bad_input);
  CanOffsets<3, 2> small;
  CHECK(small.analyse(spread, {}).size() == 3);
  CHECK(small.analyse(spread, {})[0].reason == Reason::bad_input);
  set = spread;
  set[1].offset = -1;
  CHECK(analysis.analyse(set, {})[0].reason == Reason::bad_input);
  set = spread;
  set[3].period = 30;
  CHECK(analysis.analyse(set, {})[3].reason == Reason::overloaded);
  CHECK(analysis.analyse(set, {})[2].bounded());
  for (Message& m : set) m.period = unbounded - 7;
  CHECK(analysis.analyse(set, {})[3].response == 80);
  CHECK(analysis.analyse(spread, {}, {.terms = 3})[3].reason == Reason::too_long);
  // Without patterns, too.
  CHECK(analysis.analyse(spread, {}, {.terms = 3}, 0)[3].reason == Reason::too_long);
  CHECK(analysis.analyse(spread, {}, {}, 0)[3].response == 80);
  // A bus that is full to the last bit has no room for a frame below, nor for an error.
  constexpr std::array<Message, 3> full{
      {{.cost = 5, .period = 10}, {.cost = 5, .period = 10}, {.cost = 1, .period = 1'000}}};
  CHECK(analysis.analyse(std::span{full}.first(2), {.bit = 1})[1].response == 10);
  CHECK(analysis.analyse(std::span{full}.first(2), {.bit = 1, .errors = {.burst = 3}})[1].reason ==
        Reason::overloaded);
  CHECK(analysis.analyse(full, {.bit = 1})[1].reason == Reason::overloaded);
}

}  // namespace analysis_can_offsets_test
