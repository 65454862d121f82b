/// Twister sets of messages, the simulated bus that plays them, and the formulas of the paper as they stand
/// there: what the property tests of the analysis of messages have in common. Tests only.
#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/analysis/message_set.hpp"
#include "ocm/can/worst_bits.hpp"
#include "ocm/simulation/arbiter.hpp"

namespace ocm::test {

using Twister = std::mt19937;

inline const can::WorstBits& worst_bits() {
  static const auto table = std::make_unique<const can::WorstBits>();
  return *table;
}

struct RandomSet {
  std::vector<analysis::Message> messages;
  std::vector<can::Frame> frames;  ///< the longest of each identifier
};

/// U between 0.3 and 0.99; D from half of T to twice as much; every second set with jitter.
inline RandomSet random_set(Twister& random) {
  RandomSet set;
  const std::size_t count = 1 + random() % 8;
  const double load = std::uniform_real_distribution{0.3, 0.99}(random);
  std::vector<double> parts(count);
  double sum = 0;
  for (double& part : parts) sum += part = std::exponential_distribution{1.0}(random) + 0.05;
  const bool late = random() % 2 == 0;
  const bool equal_lengths = random() % 4 == 0;
  std::uint32_t id = random() % 64;
  const auto dlc = static_cast<std::uint8_t>(random() % 9);
  for (const double part : parts) {
    const auto own = equal_lengths ? dlc : static_cast<std::uint8_t>(random() % 9);
    set.frames.push_back(worst_bits().witness(id, can::Format::base, own));
    analysis::Message m;
    m.cost = worst_bits().bits(id, can::Format::base, own);
    m.period = static_cast<std::int64_t>(static_cast<double>(m.cost) * sum / (part * load)) + 1;
    // Few different periods: releases coincide then, and one bit matters.
    if (random() % 2 == 0) m.period = (m.period + 49) / 50 * 50;
    m.deadline = m.period / 2 + static_cast<std::int64_t>(random()) % (3 * m.period / 2);
    if (late) m.jitter = static_cast<std::int64_t>(random()) % (m.period + m.period / 2);
    m.key = id;
    set.messages.push_back(m);
    id += 1 + static_cast<std::uint32_t>(random() % 200);
  }
  return set;
}

struct Release {
  std::int64_t at = 0;       ///< handed over, in bits
  std::int64_t planned = 0;  ///< what the response time counts from
  std::size_t message = 0;
};

/// Long enough after the epoch for releases that were planned before it.
inline constexpr std::int64_t critical_start = 1'000'000;

/// All that is as urgent as m is released at once, each as late as its jitter allows and from then on as
/// early, one bit after the longest frame below it.
inline std::vector<Release> critical_releases(const RandomSet& set, std::size_t m, std::int64_t horizon) {
  std::vector<Release> releases;
  for (std::size_t k = 0; k <= m; ++k) {
    const analysis::Message& message = set.messages[k];
    for (std::int64_t planned = -message.jitter; planned < horizon; planned += message.period)
      releases.push_back({critical_start + std::max<std::int64_t>(planned, 0), critical_start + planned, k});
  }
  std::size_t below = m;
  for (std::size_t k = m + 1; k < set.messages.size(); ++k)
    if (below == m || set.messages[k].cost > set.messages[below].cost) below = k;
  if (below != m) releases.push_back({critical_start - 1, critical_start - 1, below});
  return releases;
}

/// Phases and jitters at random.
inline std::vector<Release> random_releases(const RandomSet& set, Twister& random, std::int64_t horizon) {
  std::vector<Release> releases;
  for (std::size_t k = 0; k < set.messages.size(); ++k) {
    const analysis::Message& message = set.messages[k];
    std::int64_t planned = critical_start + static_cast<std::int64_t>(random()) % message.period;
    std::int64_t last = 0;  // one's own never overtake each other
    while (planned < critical_start + horizon) {
      const std::int64_t late =
          random() % 2 == 0 ? 0 : static_cast<std::int64_t>(random()) % (message.jitter + 1);
      last = std::max(last, planned + late);
      releases.push_back({last, planned, k});
      planned += message.period + (random() % 16 == 0 ? static_cast<std::int64_t>(random()) % 50 : 0);
    }
  }
  return releases;
}

/// Plays releases, each message in a node of its own: what a run may have besides them.
struct Play {
  Twister* contents = nullptr;  ///< the longest frames, or any
  std::vector<simulation::Disturbance> disturbances{};
  std::function<void(const simulation::Delivery&)> watch{};  ///< sees every frame that is complete
};

/// Each message's longest response in bits.
inline std::vector<std::int64_t> play(const RandomSet& set, std::vector<Release> releases,
                                      const Play& options = {}) {
  constexpr std::int64_t bit_ns = 1'000;
  std::stable_sort(releases.begin(), releases.end(),
                   [](const Release& a, const Release& b) { return a.at < b.at; });
  simulation::Arbiter bus{1'000'000'000 / bit_ns};
  std::vector<simulation::NodeId> nodes;
  for (std::size_t i = 0; i < set.frames.size(); ++i)
    nodes.push_back(bus.attach({simulation::QueueOrder::fifo, releases.size() + 1}));
  for (const auto& disturbance : options.disturbances) bus.disturb(disturbance);
  std::vector<std::deque<std::int64_t>> planned(nodes.size());
  std::vector<std::int64_t> longest(nodes.size(), 0);
  const auto deliver = [&](const simulation::Delivery& delivery) {
    if (!delivery.sent) return;
    const std::size_t m = delivery.from.index;
    const auto over = static_cast<std::int64_t>(delivery.end + can::intermission_bits);
    longest[m] = std::max(longest[m], over - planned[m].front());
    planned[m].pop_front();
    if (options.watch) options.watch(delivery);
  };
  const auto time = [](std::int64_t bits) { return base::Time{base::Duration{bits * bit_ns}}; };
  for (const Release& release : releases) {
    bus.advance(time(release.at), deliver);
    can::Frame frame = set.frames[release.message];
    Twister* const contents = options.contents;
    for (std::size_t i = 0; contents != nullptr && i < frame.dlc; ++i)
      if ((*contents)() % 8 == 0) frame.data[i] = static_cast<std::uint8_t>((*contents)());
    planned[release.message].push_back(release.planned);
    REQUIRE(*bus.send(nodes[release.message], frame));
  }
  bus.advance(time(std::int64_t{1} << 40), deliver);
  for (const auto& left : planned) REQUIRE(left.empty());
  return longest;
}

/// What the formulas of the paper take into account. Each of these left out is an analysis that is wrong.
struct Formulas {
  bool tau_bit = true;
  bool blocking = true;
  bool later_instances = true;
  analysis::ErrorModel errors{};
  std::int64_t error_frame = analysis::error_frame_bits;
  bool repetition = true;        ///< of what an error hits
  bool longest_repeated = true;  ///< an error can hit any frame of the level, not the message's own only
};

/// R of message m. The load of its level, with that of errors, is below 1.
inline std::int64_t by_the_paper(const std::vector<analysis::Message>& set, std::size_t m,
                                 const Formulas& with = {}) {
  const auto ceiling = [](std::int64_t a, std::int64_t b) { return (a + b - 1) / b; };
  std::int64_t blocking = 0;
  for (std::size_t k = m + 1; k < set.size() && with.blocking; ++k)
    blocking = std::max(blocking, set[k].cost);
  std::int64_t longest = set[m].cost;
  for (std::size_t k = 0; k < m && with.longest_repeated; ++k) longest = std::max(longest, set[k].cost);
  const auto errors = [&](std::int64_t t) {
    const std::int64_t later = with.errors.every == 0 ? 0 : ceiling(t, with.errors.every) - 1;
    return (with.errors.burst + later) * (with.error_frame + (with.repetition ? longest : 0));
  };

  std::int64_t busy = 0;
  for (std::int64_t next = set[m].cost; next != busy;) {
    busy = next;
    next = errors(busy) + blocking;
    for (std::size_t k = 0; k <= m; ++k) next += ceiling(busy + set[k].jitter, set[k].period) * set[k].cost;
  }
  const std::int64_t instances = with.later_instances ? ceiling(busy + set[m].jitter, set[m].period) : 1;
  std::int64_t worst = 0;
  for (std::int64_t q = 0; q < instances; ++q) {
    const std::int64_t base = blocking + q * set[m].cost;
    std::int64_t window = -1;
    for (std::int64_t next = base; next != window;) {
      window = next;
      next = errors(window + set[m].cost) + base;
      for (std::size_t k = 0; k < m; ++k)
        next += ceiling(window + set[k].jitter + (with.tau_bit ? 1 : 0), set[k].period) * set[k].cost;
    }
    worst = std::max(worst, set[m].jitter + window - q * set[m].period + set[m].cost);
  }
  return worst;
}

}  // namespace ocm::test
