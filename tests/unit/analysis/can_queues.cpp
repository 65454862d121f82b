#include "ocm/analysis/can_queues.hpp"

#include <algorithm>
#include <array>
#include <deque>
#include <iostream>
#include <numeric>
#include <random>
#include <tuple>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/analysis/can_response.hpp"
#include "ocm/simulation/arbiter.hpp"

#include "unit/base/explore.hpp"

namespace analysis_can_queues_test {

using namespace ocm;
using namespace ocm::analysis;
using Kind = NodeQueue::Kind;

constexpr NodeQueue by_priority{};
constexpr NodeQueue fifo{.kind = Kind::fifo};

template <std::size_t N, std::size_t nodes>
constexpr std::array<Explained, N> respond(const std::array<Message, N>& set,
                                           const std::array<NodeQueue, nodes>& queues,
                                           const CanBus& bus = {}) {
  CanQueues<N> analysis;
  const auto found = analysis.analyse(set, queues, bus);
  std::array<Explained, N> results{};
  for (std::size_t i = 0; i < N; ++i) results[i] = found[i];
  return results;
}

// By hand. Node 0 has a and c, node 1 has b. As a FIFO, c can go before a at c's own priority, so that b and
// a frame below can go before it, too: a = 10 (d) + 10 (c) + 10 (b) + 10.
constexpr std::array<Message, 4> example{{
    {.cost = 10, .period = 100, .node = 0},
    {.cost = 10, .period = 100, .node = 1},
    {.cost = 10, .period = 100, .node = 0},
    {.cost = 10, .period = 100, .node = 1},
}};
static_assert(respond(example, std::array{by_priority, by_priority})[0].response == 20);
static_assert(respond(example, std::array{fifo, by_priority})[0].response == 40);
static_assert(respond(example, std::array{fifo, by_priority})[0].interference == 20);
static_assert(respond(example, std::array{fifo, by_priority})[2].response == 40);
// b now meets an a that can come 30 late: still once.
static_assert(respond(example, std::array{fifo, by_priority})[1].response == 30);
// One mailbox is a queue of one frame that is not taken back; with two, c alone cannot fill them.
static_assert(respond(example, std::array{NodeQueue{Kind::mailboxes, 1}, by_priority})[0].response == 40);
static_assert(respond(example, std::array{NodeQueue{Kind::mailboxes, 2}, by_priority})[0].response == 20);
static_assert(respond(example, std::array{NodeQueue{Kind::mailboxes, 2}, by_priority})[3] ==
              respond(example, std::array{by_priority, by_priority})[3]);

// Of two that delay it as much, the more urgent one is named.
static_assert(respond(example, std::array{by_priority, by_priority})[2].largest == 0);
// An error costs 31 bits and a frame of 10 once more, and one every 80 bits until the end of a's own frame:
// that is 132, after the second error, and a second b.
static_assert(respond(example, std::array{fifo, by_priority}, {.bit = 1, .errors = {.burst = 1}})[0]
                  .response == 40 + 41);
constexpr CanBus disturbed_often{.bit = 1, .errors = {.burst = 1, .every = 80}};
static_assert(respond(example, std::array{fifo, by_priority}, disturbed_often)[0].response == 132);
static_assert(respond(example, std::array{by_priority, by_priority}, disturbed_often)[0].response == 61);
static_assert(respond(example, std::array{by_priority, by_priority}, disturbed_often)[2].response == 142);
static_assert(respond(example, std::array{by_priority, by_priority}, disturbed_often)[2].instances == 2);
// What is queued when a busy period ends begins the next one: it is not looked at.
constexpr std::array<Message, 1> back_to_back{{{.cost = 5, .period = 5}}};
static_assert(respond(back_to_back, std::array{fifo})[0].response == 5);
static_assert(respond(back_to_back, std::array{fifo})[0].instances == 1);

// A later instance can be the worst, in a queue of one as by priority: Davis et al. 2007, table 3, with all
// times doubled.
constexpr std::array<Message, 3> later{{{.cost = 2, .period = 5, .node = 1},
                                        {.cost = 2, .period = 7, .node = 1},
                                        {.cost = 2, .period = 7, .node = 0}}};
static_assert(respond(later, std::array{by_priority, by_priority})[2].response == 7);
static_assert(respond(later, std::array{by_priority, by_priority})[2].instance == 1);
static_assert(respond(later, std::array{fifo, by_priority})[2].response == 7);
static_assert(respond(later, std::array{fifo, by_priority})[2].instance == 1);

static_assert(pending_bound({.period = 100}, {.response = 100}) == 1);
static_assert(pending_bound({.period = 100}, {.response = 101}) == 2);
static_assert(queue_bound(example, respond(example, std::array{fifo, by_priority}), 0) == 2);
static_assert(queue_bound(example, std::array<Explained, 4>{}, 0) == 0);

std::vector<Message> random_set(std::mt19937& random, std::vector<can::Frame>& frames, std::size_t nodes) {
  const double load = std::uniform_real_distribution{0.2, 0.9}(random);
  std::vector<Message> set(2 + random() % 6);
  frames.clear();
  std::uint32_t id = random() % 16;
  for (Message& m : set) {
    // All bits recessive or dominant in turn: any content will do, the simulator counts its bits.
    can::Frame frame{.id = id, .dlc = static_cast<std::uint8_t>(random() % 9)};
    for (std::size_t i = 0; i < frame.dlc; ++i) frame.data[i] = random() % 2 == 0 ? 0x55 : 0x00;
    frames.push_back(frame);
    m.cost = can::frame_bits(frame) + can::intermission_bits;
    m.period = static_cast<std::int64_t>(static_cast<double>(m.cost) * static_cast<double>(set.size()) /
                                         load * std::uniform_real_distribution{0.7, 2.0}(random)) +
               1;
    if (random() % 3 == 0) m.jitter = static_cast<std::int64_t>(random()) % m.period;
    m.node = static_cast<std::uint16_t>(random() % nodes);
    id += 1 + static_cast<std::uint32_t>(random() % 100);
  }
  return set;
}

struct Release {
  std::int64_t at = 0;
  std::int64_t planned = 0;
  std::size_t message = 0;
};

/// A node on the simulated bus: mailboxes are the arbiter's queue by identifier, kept at so many frames with
/// the one on the bus, and refilled by priority when one is sent.
struct Node {
  simulation::NodeId id;
  NodeQueue queue;
  std::vector<std::size_t> software{};  ///< messages that wait for a mailbox
  std::size_t in_mailboxes = 0;
  std::size_t waiting = 0;
  std::size_t longest = 0;
};

struct Played {
  std::vector<std::int64_t> responses;
  std::vector<std::size_t> queues;
};

Played play(const std::vector<Message>& set, const std::vector<can::Frame>& frames,
            const std::vector<NodeQueue>& queues, std::vector<Release> releases) {
  std::stable_sort(releases.begin(), releases.end(),
                   [](const Release& a, const Release& b) { return a.at < b.at; });
  simulation::Arbiter bus{1'000'000};
  std::vector<Node> nodes;
  for (const NodeQueue& queue : queues)
    nodes.push_back({bus.attach({queue.kind == Kind::fifo ? simulation::QueueOrder::fifo
                                                          : simulation::QueueOrder::by_identifier,
                                 releases.size() + 1}),
                     queue});
  std::vector<std::deque<std::int64_t>> planned(set.size());
  Played played{std::vector<std::int64_t>(set.size(), 0), {}};
  const auto hand_over = [&](Node& node, std::size_t m) { REQUIRE(*bus.send(node.id, frames[m])); };
  const auto deliver = [&](const simulation::Delivery& delivery) {
    std::size_t m = 0;
    while (frames[m].id != delivery.frame.id) ++m;
    Node& node = nodes[set[m].node];
    const auto over = static_cast<std::int64_t>(delivery.end + can::intermission_bits);
    played.responses[m] = std::max(played.responses[m], over - planned[m].front());
    planned[m].pop_front();
    --node.waiting;
    if (node.queue.kind != Kind::mailboxes) return;
    --node.in_mailboxes;
    if (node.software.empty()) return;
    const auto next = std::min_element(node.software.begin(), node.software.end());
    ++node.in_mailboxes;
    hand_over(node, *next);
    node.software.erase(next);
  };
  for (const Release& release : releases) {
    bus.advance(base::Time{base::Duration{release.at * 1'000}}, deliver);
    Node& node = nodes[set[release.message].node];
    planned[release.message].push_back(release.planned);
    node.longest = std::max(node.longest, ++node.waiting);
    if (node.queue.kind == Kind::mailboxes && node.in_mailboxes == node.queue.mailboxes) {
      node.software.push_back(release.message);
    } else {
      ++node.in_mailboxes;
      hand_over(node, release.message);
    }
  }
  bus.advance(base::Time{base::Duration{std::int64_t{1} << 50}}, deliver);
  for (const Node& node : nodes) played.queues.push_back(node.longest);
  return played;
}

/// Every second run begins with all at once, in any order and some one bit late, which is where it is worst.
std::vector<Release> random_releases(std::mt19937& random, const std::vector<Message>& set) {
  const bool together = random() % 2 == 0;
  std::vector<Release> releases;
  for (std::size_t k = 0; k < set.size(); ++k) {
    std::int64_t phase = static_cast<std::int64_t>(random()) % set[k].period;
    if (together) phase = static_cast<std::int64_t>(random()) % 3 - set[k].jitter;
    std::int64_t last = 0;
    for (std::int64_t planned = 1'000'000 + phase; planned < 1'000'000 + 6'000; planned += set[k].period) {
      std::int64_t at = planned;
      if (together)
        at = std::max<std::int64_t>(at, 1'000'000 + static_cast<std::int64_t>(random()) % 3);
      else if (random() % 2 == 0)
        at += static_cast<std::int64_t>(random()) % (set[k].jitter + 1);
      at = std::clamp(at, planned, planned + set[k].jitter);
      last = std::max(last, at);
      releases.push_back({last, planned, k});
    }
  }
  // What comes at once is queued in any order.
  std::vector<std::size_t> order(set.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), random);
  std::sort(releases.begin(), releases.end(), [&](const Release& a, const Release& b) {
    return std::tuple{a.at, order[a.message], a.planned} < std::tuple{b.at, order[b.message], b.planned};
  });
  return releases;
}

TEST_CASE("queues: a bus that is full to the last bit has no room for a frame below, nor for an error") {
  constexpr std::array<Message, 3> full{
      {{.cost = 5, .period = 10}, {.cost = 5, .period = 10}, {.cost = 1, .period = 1'000}}};
  constexpr std::array queues{by_priority};
  constexpr CanBus calm{.bit = 1}, disturbed{.bit = 1, .errors = {.burst = 3}};
  CanQueues<3> analysis;
  const auto second = [&](std::size_t messages, const CanBus& bus) {
    return analysis.analyse(std::span{full}.first(messages), queues, bus)[1];
  };
  CHECK(second(2, calm).response == 10);
  CHECK(second(2, disturbed).reason == Reason::overloaded);
  CHECK(second(3, calm).reason == Reason::overloaded);
}

TEST_CASE("queues: what errors may cost is an error frame and the longest frame again, each time") {
  // Half of the bus, and every 80 ticks an error: 31 bits and the frame of 10 once more are 51 % of it.
  constexpr std::array<Message, 1> half{{{.cost = 10, .period = 20}}};
  constexpr std::array queues{by_priority};
  CanQueues<1> analysis;
  const auto reason = [&](std::int64_t every) {
    return analysis.analyse(half, queues, {.bit = 1, .errors = {.burst = 1, .every = every}})[0].reason;
  };
  CHECK(reason(80) == Reason::overloaded);
  CHECK(reason(83) != Reason::overloaded);
}

TEST_CASE("queues: a FIFO is looked at each time that something is queued in it") {
  // [Davis, Burns, Bril, Lukkien 2007, table 1]: the last one's second instance is pushed farther than its
  // first.
  constexpr std::array<Message, 3> davis{{{.cost = 1'000, .period = 2'500, .node = 0},
                                          {.cost = 1'000, .period = 3'500, .node = 1},
                                          {.cost = 1'000, .period = 3'500, .node = 2}}};
  const Explained last = respond(davis, std::array{by_priority, by_priority, fifo})[2];
  CHECK(last.response == 3'500);
  CHECK(last.instance == 1);
  CHECK(last.instances > 1);
}

TEST_CASE("queues: a busy bus is analysed to its end, unless the caller allows less work") {
  // 1/3 + 1/4 of the bus above one frame as long as thousands of theirs.
  constexpr std::array<Message, 3> busy{
      {{.cost = 1, .period = 3}, {.cost = 1, .period = 4}, {.cost = 4'164, .period = 10'000}}};
  constexpr std::array queues{by_priority};
  CanQueues<3> analysis;
  CHECK(analysis.analyse(busy, queues, {})[2].ok());
  CHECK(analysis.analyse(busy, queues, {}, {.terms = 200})[2].reason == Reason::too_long);
}

TEST_CASE("where every queue is by priority, it is the exact analysis") {
  std::mt19937 random{2011};
  CanQueues<8> queues;
  CanResponse<8> exact;
  std::vector<can::Frame> frames;
  const std::array nodes{by_priority, by_priority, by_priority};
  for (int round = 0; round < 500; ++round) {
    const auto set = random_set(random, frames, nodes.size());
    const auto one = queues.analyse(set, nodes, {.bit = 1, .errors = {.burst = round % 2}});
    const auto other = exact.analyse(set, {.bit = 1, .errors = {.burst = round % 2}});
    for (std::size_t m = 0; m < set.size(); ++m) {
      CAPTURE(round, m);
      REQUIRE(one[m].response == other[m].response);
      REQUIRE(one[m].reason == other[m].reason);
      REQUIRE(one[m].interference >= other[m].interference);
      REQUIRE(one[m].blocked_by == other[m].blocked_by);
      REQUIRE(one[m].blocking == other[m].blocking);
      if (!one[m].bounded()) continue;
      REQUIRE(one[m].instance == other[m].instance);
      REQUIRE(one[m].instances == other[m].instances);
      REQUIRE(one[m].largest == other[m].largest);
      REQUIRE(one[m].largest_share == other[m].largest_share);
    }
  }
}

TEST_CASE(
    "FIFOs and mailboxes: simulated never exceeds predicted, nor do queues; priorities alone do not hold") {
  std::mt19937 random{2012};
  CanQueues<8> analysis;
  CanResponse<8> by_priorities;
  std::vector<can::Frame> frames;
  int bounded = 0;
  int close = 0;
  int beyond_priorities[3] = {};
  int full_queues = 0;
  const int rounds = test::explored(2'000);
  for (int round = 0; round < rounds; ++round) {
    const auto kind = static_cast<Kind>(1 + round % 2);
    const std::vector<NodeQueue> nodes{{kind, 1 + random() % 3},
                                       random() % 2 == 0 ? by_priority : NodeQueue{kind, 1 + random() % 2}};
    const auto set = random_set(random, frames, nodes.size());
    const auto results = analysis.analyse(set, nodes, {});
    const auto without = by_priorities.analyse(set, {});
    std::vector<std::int64_t> worst(set.size(), 0);
    for (int run = 0; run < 4; ++run) {
      std::vector<Release> releases = random_releases(random, set);
      const Played played = play(set, frames, nodes, std::move(releases));
      for (std::size_t m = 0; m < set.size(); ++m) {
        CAPTURE(round, m, static_cast<int>(kind));
        REQUIRE(played.responses[m] <= results[m].response);
        worst[m] = std::max(worst[m], played.responses[m]);
      }
      for (std::uint16_t node = 0; node < nodes.size(); ++node) {
        const std::int64_t most = queue_bound(set, results, node);
        if (most == 0) continue;
        CAPTURE(round, node);
        REQUIRE(static_cast<std::int64_t>(played.queues[node]) <= most);
        full_queues += static_cast<std::int64_t>(played.queues[node]) == most ? 1 : 0;
      }
    }
    for (std::size_t m = 0; m < set.size(); ++m) {
      // In a FIFO the least urgent are better off: they go before what is queued later.
      if (nodes[set[m].node].kind != Kind::fifo) REQUIRE(results[m].response >= without[m].response);
      bounded += results[m].bounded() ? 1 : 0;
      close += results[m].bounded() && results[m].response * 3 <= worst[m] * 4 ? 1 : 0;
      beyond_priorities[static_cast<int>(kind)] += worst[m] > without[m].response ? 1 : 0;
    }
  }
  std::cout << "  within 4/3 of what was simulated: " << close << " of " << bounded
            << " messages; beyond the analysis by priority: " << beyond_priorities[1] << " in FIFOs, "
            << beyond_priorities[2] << " behind mailboxes\n";
  CHECK(bounded > 3 * rounds);
  CHECK(full_queues > rounds * 5 / 6);
  CHECK(beyond_priorities[1] > rounds / 60);
  CHECK(beyond_priorities[2] > rounds / 60);
}

TEST_CASE("queues: what cannot be bounded has a reason") {
  CanQueues<4> analysis;
  const std::array nodes{fifo, fifo};
  auto set = example;
  set[3].period = 10;
  const auto results = analysis.analyse(set, nodes, {});
  for (const Explained& result : results) {
    CHECK_FALSE(result.bounded());
    CHECK_FALSE(result.ok());
  }
  CHECK(results[3].reason == Reason::overloaded);
  set[3].node = 2;
  CHECK(analysis.analyse(set, nodes, {})[0].reason == Reason::bad_input);
  CHECK(analysis.analyse(set, nodes, {})[0].largest == 3);
  CHECK(analysis.analyse(set, nodes, {})[3].deadline == set[3].due());
  const std::array no_mailbox{NodeQueue{Kind::mailboxes, 0}, fifo};
  CHECK(analysis.analyse(example, no_mailbox, {})[0].reason == Reason::bad_input);
  CHECK(analysis.analyse(example, no_mailbox, {})[3].largest == 0);
  set = example;
  set[0].node = 2;  // the first one counts, too
  CHECK(analysis.analyse(set, nodes, {})[0].reason == Reason::bad_input);
  CHECK(analysis.analyse(set, nodes, {})[3].largest == 0);
  CHECK(analysis.analyse(example, nodes, {.bit = -1})[0].reason == Reason::bad_input);
  CanQueues<2> small;
  CHECK(small.analyse(example, nodes, {})[0].reason == Reason::bad_input);
}

}  // namespace analysis_can_queues_test
