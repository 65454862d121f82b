/// Tables of operators whose robots have any topics, by hand or by chance. Tests only.
#pragma once

#include <array>
#include <random>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/reflective/check.hpp"
#include "ocm/reflective/proof.hpp"

namespace ocm::test {

using namespace ocm::reflective;
using namespace std::chrono_literals;
using Ns = std::int64_t;
inline constexpr std::uint32_t random_bit_rate = 1'000'000;

/// The tables of one operator with its robot's catalogue, all in one place.
struct Tables {
  std::array<protocol::Field, 1> field{};
  std::vector<std::vector<protocol::FrameLayout>> frames;
  std::vector<protocol::Topic> topics;
  std::array<protocol::Board, 1> boards{{{"board", "none"}}};
  protocol::Catalogue catalogue;
  std::vector<std::vector<Stream>> streams;
  std::vector<std::vector<SetPoint>> entries;
  std::vector<Configuration> configurations;
  std::vector<Condition> conditions;
  std::vector<std::vector<Term>> terms;
  std::vector<Monitor> monitors;
  std::vector<Transition> transitions;
  std::vector<Ns> on_board;  ///< what a sample of each topic takes there
  std::vector<Sampling> sampling;
  Operator op;

  Tables() {
    field[0].name = "value";
    field[0].position = {0, 8};
    field[0].raw_max = 255;
  }
  Tables(const Tables&) = delete;
  Tables& operator=(const Tables&) = delete;

  void add_topic(protocol::Kind kind, std::vector<std::uint16_t> lengths, Ns jitter = 0) {
    std::vector<protocol::FrameLayout> layouts;
    for (const std::uint16_t length : lengths) {
      protocol::FrameLayout layout;
      layout.id = protocol::TopicId{static_cast<std::uint8_t>(1 + 10 * topics.size() + layouts.size())};
      layout.length = length;
      if (layouts.empty()) layout.fields = field;
      layouts.push_back(layout);
    }
    frames.push_back(layouts);
    protocol::Topic topic;
    topic.id = layouts[0].id;
    topic.kind = kind;
    topic.jitter = base::Duration{jitter};
    topics.push_back(topic);
  }
  /// Once all is there: the views.
  void close() {
    for (std::size_t t = 0; t < topics.size(); ++t) topics[t].frames = frames[t];
    catalogue = {"random", random_bit_rate, boards, topics};
    configurations.resize(streams.size());
    for (std::size_t c = 0; c < streams.size(); ++c) configurations[c] = {{}, streams[c], {}, entries[c], {}};
    monitors.resize(terms.size());
    for (std::size_t m = 0; m < terms.size(); ++m) monitors[m].terms = terms[m];
    on_board.resize(topics.size());
    sampling.clear();
    const auto count = static_cast<std::uint16_t>(streams.size());
    for (std::uint16_t to = 0; to < count; ++to)
      for (std::uint16_t topic = 0; topic < topics.size(); ++topic) {
        sampling.push_back({none, to, topic, on_board[topic]});
        for (std::uint16_t from = 0; from < count; ++from)
          sampling.push_back({from, to, topic, on_board[topic]});
      }
    op.catalogue = &catalogue;
    op.configurations = configurations;
    op.conditions = conditions;
    op.monitors = monitors;
    op.transitions = transitions;
  }
};

class Chance {
 public:
  explicit Chance(std::uint32_t seed) : random_(seed) {}
  Ns up_to(Ns most) { return std::uniform_int_distribution<Ns>{0, most}(random_); }
  /// Often one of the ends.
  Ns extreme(Ns most) {
    const Ns choice = up_to(3);
    return choice == 0 ? 0 : choice == 1 ? up_to(most) : most;
  }
  bool one_in(Ns n) { return up_to(n - 1) == 0; }

 private:
  std::mt19937 random_;
};

/// A fall-back that stops something, and one to three others, each with a monitor of some of its streams.
/// False: one that the proof refuses.
inline bool make(Tables& t, Chance& random, bool asks_again = false) {
  const auto sensors = static_cast<std::uint16_t>(1 + random.up_to(3));
  for (std::uint16_t s = 0; s < sensors; ++s) {
    std::vector<std::uint16_t> lengths{static_cast<std::uint16_t>(1 + random.up_to(7))};
    for (Ns more = random.up_to(2); more > 0; --more)
      lengths.push_back(static_cast<std::uint16_t>(random.up_to(8)));
    t.add_topic(protocol::Kind::sensor, lengths, random.one_in(2) ? 0 : random.up_to(2'000'000));
    t.on_board.push_back(random.one_in(2) ? 0 : random.up_to(3'000'000));
  }
  const std::uint16_t motor = sensors;
  t.add_topic(protocol::Kind::actuator, {static_cast<std::uint16_t>(1 + random.up_to(7))});
  t.op.reaction = base::Duration{random.up_to(3'000'000)};
  t.op.handling = base::Duration{random.up_to(1'000'000)};
  if (asks_again)
    t.op.retry = (1 + random.up_to(9)) * 50ms;
  else if (random.one_in(2))
    t.op.retry = 200ms;

  constexpr Ns periods[] = {5, 10, 12, 20, 35, 50};
  const auto count = static_cast<std::uint16_t>(2 + random.up_to(2));
  for (std::uint16_t c = 0; c < count; ++c) {
    t.streams.emplace_back();
    for (std::uint16_t s = 0; s < sensors; ++s)
      if (random.one_in(2) || (c > 0 && s == sensors - 1 && t.streams[c].empty()))
        t.streams[c].push_back(
            {s, periods[random.up_to(5)] * 1ms, static_cast<protocol::Priority>(random.up_to(3))});
    t.entries.emplace_back();
    if (c == 0 || random.one_in(3))
      t.entries[c].push_back(
          {motor, {}, static_cast<protocol::Priority>(random.up_to(3)), random.one_in(3) ? 100ms : 0ms});
    t.transitions.push_back({"asked", any_configuration, c, by_request, 0});
  }
  for (std::uint16_t s = 0; s < sensors; ++s) {
    t.conditions.push_back({.topic = s, .limit = 100, .hysteresis = random.up_to(50)});
    t.conditions.push_back({.watched = Watched::age, .topic = s, .limit = 1});
  }
  for (std::uint16_t c = 1; c < count; ++c) {
    t.terms.emplace_back();
    for (const Stream& stream : t.streams[c]) {
      if (!t.terms.back().empty() && random.one_in(2)) continue;
      const auto kind = static_cast<std::uint16_t>(random.up_to(1));
      t.terms.back().push_back({.condition = static_cast<std::uint16_t>(2 * stream.topic + kind)});
      if (t.terms.back().size() > 1) t.terms.back().push_back({.op = Op::any});
    }
    t.transitions.push_back({"event", c, 0, static_cast<std::uint16_t>(c - 1), 0});
  }
  t.close();
  for (Monitor& monitor : t.monitors)
    if (random.one_in(2)) monitor.lasting = base::Duration{random.up_to(40'000'000)};

  // As tight as the proof lets it be.
  t.op.settle = 30ms;
  Ns settle = 0;
  Proof<128> proof{t.op, random_bit_rate, t.sampling};
  for (std::uint16_t from = 0; from < count; ++from)
    for (std::uint16_t to = 0; to < count; ++to)
      if (from != to) settle = std::max(settle, proof.settling(from, to));
  if (settle > 30'000'000) return false;
  if (random.one_in(2)) t.op.settle = base::Duration{settle + settle / 4};
  for (std::uint16_t c = 0; c < t.conditions.size(); c += 2) t.conditions[c + 1].limit = 1;
  std::vector<Ns> limits(t.conditions.size(), 1);
  Proof<128>{t.op, random_bit_rate, t.sampling}.check([&](const Doubt& doubt) {
    if (doubt.kind == Doubt::Kind::restless && t.conditions[doubt.condition].watched == Watched::age)
      limits[doubt.condition] = std::max(limits[doubt.condition], doubt.needs + 1);
  });
  for (std::size_t c = 1; c < t.conditions.size(); c += 2) t.conditions[c].limit = limits[c];
  bool fine = first_mistake(t.op).kind == Mistake::no_mistake;
  REQUIRE(fine);
  Proof<128>{t.op, random_bit_rate, t.sampling}.check([&](const Doubt&) { fine = false; });
  return fine;
}

}  // namespace ocm::test
