#include "ocm/analysis/can_assignment.hpp"

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include <catch2/catch.hpp>

namespace analysis_can_assignment_test {

using namespace ocm;
using namespace ocm::analysis;
using protocol::Direction;
using protocol::Priority;
using protocol::TopicId;

// Deadline monotonic order misses; the last two change places. [Davis et al. 2007, table 4]
constexpr std::array<Message, 3> opa{{
    {.cost = 125, .period = 280, .deadline = 275},
    {.cost = 125, .period = 360, .deadline = 345},
    {.cost = 95, .period = 550, .deadline = 425},
}};
constexpr auto best = [] {
  CanResponse<3> analysis;
  auto set = opa;
  const std::size_t stuck = assign_priorities<3>(set, {}, analysis);
  const auto results = can_response_times(set);
  return std::array<std::int64_t, 6>{static_cast<std::int64_t>(stuck == no_index),
                                     set[1].period,
                                     set[2].period,
                                     results[0].response,
                                     results[1].response,
                                     results[2].response};
}();
static_assert(best == std::array<std::int64_t, 6>{1, 550, 360, 250, 345, 345});

// Where any order does, the result is by D - J: the second comes first, late as it may be offered.
constexpr bool by_deadline_less_jitter = [] {
  CanResponse<2> analysis;
  std::array<Message, 2> set{{{.cost = 1, .period = 1'000, .deadline = 900},
                              {.cost = 1, .period = 2'000, .deadline = 1'000, .jitter = 500}}};
  return assign_priorities<2>(set, {}, analysis) == no_index && set[0].period == 2'000;
}();
static_assert(by_deadline_less_jitter);

bool all_meet(const std::vector<Message>& set) {
  CanResponse<8> analysis;
  const auto results = analysis.analyse(set, {});
  return std::all_of(results.begin(), results.end(), [](const Explained& r) { return r.ok(); });
}

Message random_message(std::mt19937& random, std::int64_t scale) {
  Message m;
  m.cost = 47 + static_cast<std::int64_t>(random() % 90);
  m.period = scale + static_cast<std::int64_t>(random()) % (3 * scale);
  m.deadline = m.period / 2 + static_cast<std::int64_t>(random()) % m.period;
  if (random() % 3 == 0) m.jitter = static_cast<std::int64_t>(random()) % 100;
  return m;
}

TEST_CASE("Audsley's order works exactly where one of all orders does") {
  std::mt19937 random{1991};
  CanResponse<8> analysis;
  int found = 0;
  int beyond_monotonic = 0;
  for (int round = 0; round < 1'500; ++round) {
    std::vector<Message> set;
    for (int i = 0; i < 5; ++i) {
      set.push_back(random_message(random, 250));
      set.back().key = static_cast<std::uint32_t>(i);
    }
    auto order = set;
    std::sort(order.begin(), order.end(),
              [](const Message& a, const Message& b) { return a.due() - a.jitter < b.due() - b.jitter; });
    const bool monotonic = all_meet(order);
    std::sort(order.begin(), order.end(), [](const Message& a, const Message& b) { return a.key < b.key; });
    bool any = false;
    do {
      any = all_meet(order);
    } while (!any && std::next_permutation(order.begin(), order.end(),
                                           [](const Message& a, const Message& b) { return a.key < b.key; }));
    auto assigned = set;
    const std::size_t stuck = assign_priorities<8>(assigned, {}, analysis);
    CAPTURE(round);
    REQUIRE((stuck == no_index) == any);
    if (stuck == no_index) REQUIRE(all_meet(assigned));
    std::sort(assigned.begin(), assigned.end(),
              [](const Message& a, const Message& b) { return a.key < b.key; });
    for (std::size_t i = 0; i < set.size(); ++i) REQUIRE(assigned[i].key == i);
    found += any ? 1 : 0;
    beyond_monotonic += any && !monotonic ? 1 : 0;
  }
  CHECK(found > 200);
  CHECK(found < 1'400);
  CHECK(beyond_monotonic > 0);
}

TEST_CASE(
    "in the layout, priorities are found exactly where one of all choices works, and the least urgent") {
  std::mt19937 random{2018};
  CanResponse<8> analysis;
  int found = 0;
  int used_several = 0;
  for (int round = 0; round < 600; ++round) {
    std::vector<TopicMessage> set;
    for (std::uint8_t i = 0; i < 4; ++i)
      set.push_back({random_message(random, 200), random() % 4 == 0 ? Direction::command : Direction::sensor,
                     TopicId{static_cast<std::uint8_t>(random() % 60 * 4 + i)}, Priority::urgent});
    bool any = false;
    unsigned least = 0;
    for (unsigned choice = 0; choice < 256; ++choice) {
      auto chosen = set;
      unsigned urgency = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        chosen[i].priority = static_cast<Priority>(choice >> 2 * i & 3);
        urgency += 3 - (choice >> 2 * i & 3);
      }
      std::sort(chosen.begin(), chosen.end(),
                [](const TopicMessage& a, const TopicMessage& b) { return a.identifier() < b.identifier(); });
      std::vector<Message> messages;
      for (const TopicMessage& m : chosen) messages.push_back(m.message);
      if (!all_meet(messages)) continue;
      least = any ? std::min(least, urgency) : urgency;
      any = true;
    }
    const std::size_t stuck = assign_in_layout<8>(set, {}, analysis);
    CAPTURE(round);
    REQUIRE((stuck == no_index) == any);
    if (any) {
      unsigned urgency = 0;
      for (const TopicMessage& m : set) urgency += 3 - static_cast<unsigned>(m.priority);
      REQUIRE(urgency == least);
      REQUIRE(std::is_sorted(set.begin(), set.end(), [](const TopicMessage& a, const TopicMessage& b) {
        return a.message.key < b.message.key;
      }));
      ++found;
      used_several += urgency > 0 ? 1 : 0;
    } else {
      REQUIRE(set[stuck].priority == Priority::urgent);
    }
  }
  CHECK(found > 100);
  CHECK(used_several > 20);
}

TEST_CASE("no order for what cannot be analysed") {
  CanResponse<2> analysis;
  std::array<Message, 3> three = opa;
  CHECK(assign_priorities<2>(three, {}, analysis) == 2);
  std::array<Message, 2> bad{{{.cost = 1, .period = 0}, {.cost = 1, .period = 5}}};
  CHECK(assign_priorities<2>(bad, {}, analysis) == 1);
  std::array<TopicMessage, 1> bad_topic{{{.message = {.cost = 1, .period = 0}}}};
  CHECK(assign_in_layout<2>(bad_topic, {}, analysis) == 0);
  CHECK(assign_in_layout<2>({}, {}, analysis) == no_index);
}

}  // namespace analysis_can_assignment_test
