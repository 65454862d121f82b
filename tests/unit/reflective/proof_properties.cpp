/// Random operators and robots in virtual time: what is measured is never above what was proved.
#include <algorithm>
#include <array>

#include <catch2/catch.hpp>

#include "ocm/reflective/check.hpp"
#include "ocm/reflective/proof.hpp"

#include "unit/base/explore.hpp"
#include "unit/reflective/random_operator.hpp"
#include "unit/reflective/virtual_robot.hpp"

namespace reflective_proof_properties_test {

using namespace ocm;
using namespace ocm::reflective;
using namespace ocm::test;
using namespace std::chrono_literals;
constexpr std::uint32_t bit_rate = random_bit_rate;

// --- a bound that is reached -------------------------------------------------------------------------------

/// Two streams, as in proof.cpp, and a long one that gets in the way whenever that is worst: it is released
/// just before the sample and, since its period is what lies between, again just before the set point.
struct Worst {
  static constexpr Ns on_board = 1'500'000;
  static constexpr std::array<Sampling, 3> sampling{
      {{none, 0, 0, on_board}, {none, 1, 0, on_board}, {0, 1, 0, on_board}}};
  Tables t;
  Ns total = 0;
  Ns measured = 0;

  Worst(bool falls_silent, Ns lasting) {
    t.add_topic(protocol::Kind::sensor, {1}, 2'000'000);
    t.add_topic(protocol::Kind::sensor, {8});
    t.add_topic(protocol::Kind::actuator, {1});
    t.streams = {{{0, 20ms, protocol::Priority::high}, {1, 3ms, protocol::Priority::low}},
                 {{0, 20ms, protocol::Priority::high}}};
    t.entries = {{}, {{2, {}, protocol::Priority::urgent, 0ns}}};
    // (R - J - S) + reaction, with the timers and what else must pass, is a multiple of 3 ms.
    if (falls_silent)
      t.conditions = {
          {.watched = Watched::age, .topic = 0, .limit = 60'000'000 + (lasting > 0 ? 400'000 : 200'000)}};
    else
      t.conditions = {{.topic = 0, .limit = 100}};
    t.terms = {{{.condition = 0}}};
    t.transitions = {{"event", 0, 1, 0, 0}, {"asked", 1, 0, by_request, 0}};
    t.close();
    t.monitors[0].lasting = base::Duration{lasting};
    t.op.fall_back = 1;
    t.op.reaction = 2'800'001ns;  // the set point comes just after the long frame
    t.op.handling = 4ms;
    t.op.settle = 15ms;
    REQUIRE(first_mistake(t.op).kind == Mistake::no_mistake);
    Proof<64> proof{t.op, bit_rate, sampling};
    proof.check([](const Doubt& doubt) {
      FAIL("doubt " << static_cast<int>(doubt.kind) << " needs " << doubt.needs);
    });
    total = proof.latency(0, 0).total();

    VirtualRobot robot{t.op, bit_rate};
    constexpr Ns sample = 500'000'000;  // about when
    Ns event = -1;
    // Samples of the long one are looked at in no time, or else they would be the timers' steps.
    robot.reaction = [&](std::uint16_t topic) { return topic == 1 ? 0 : t.op.reaction.count(); };
    // The phase of both: the watched one is taken at once, the long one when it is worst.
    Ns watched_at = -1;
    robot.handling = [&](std::uint16_t topic) -> Ns {
      if (topic == 0) watched_at = robot.now();
      if (topic != 1) return 0;
      // A sample that is 2 ms late comes 20 k + 2 ms after the first; one that is not, for the age, 20 k.
      const Ns worst = watched_at + 20'000'000 * 30 + (falls_silent ? 0 : 2'000'000) + on_board - 1;
      return (worst - robot.now()) % 3'000'000;
    };
    robot.jitter = [&](std::uint16_t topic, Ns) -> Ns {
      return topic == 0 && event >= 0 && !falls_silent ? 2'000'000 : 0;
    };
    // What is read from the 30th on takes its time: the last one before the silence, or that shows the value.
    robot.sampling = [&](std::uint16_t topic) {
      return topic == 0 && robot.now() >= watched_at + 20'000'000 * 30 ? on_board : 0;
    };
    robot.sampled = [&](std::uint16_t topic, Ns now) {
      if (topic != 0 || event >= 0 || now < sample) return;
      // The last one before the 30th.
      const Ns last = watched_at + 20'000'000 * (falls_silent ? 30 : 29);
      if (now != last) return;
      event = now;
      robot.watch();
      if (falls_silent)
        robot.silent[0] = true;
      else
        robot.values[0] = 200;
    };
    robot.start();
    robot.run(2'000'000'000);
    REQUIRE(robot.acted);
    REQUIRE(event >= 0);
    measured = robot.acted->at - event;
  }
};

/// A bound that is a microsecond too small.
constexpr Ns planted(Ns bound) {
  return bound - 1'000;
}

TEST_CASE("proof properties: the bound is reached, so one that is a microsecond too small is caught") {
  // The blocking frames begin a nanosecond before what they block.
  SECTION("a value") {
    const Worst worst{false, 0};
    CHECK(worst.total == 20'000'000 + 2'000'000 + Worst::on_board + 200'000 + 2'800'001 + 200'000);
    CHECK(worst.measured <= worst.total);
    CHECK_FALSE(worst.measured <= planted(worst.total));
  }
  SECTION("a stream that falls silent") {
    const Worst worst{true, 0};
    CHECK(worst.measured <= worst.total);
    CHECK_FALSE(worst.measured <= planted(worst.total));
  }
  SECTION("and lasts") {
    const Worst worst{true, 30'000'000};
    CHECK(worst.measured <= worst.total);
    CHECK_FALSE(worst.measured <= planted(worst.total));
  }
}

// --- random ones ---------------------------------------------------------------------------------------------

struct Campaign {
  int operators = 0, refused = 0, acted = 0, fell_back = 0, entering = 0;
  double closest = 0;
  int sampled_long = 0;  ///< without what its board takes the bound would have been too small

  void run(std::uint32_t seed) {
    Chance random{seed};
    Tables t;
    if (!make(t, random)) {
      ++refused;
      return;
    }
    ++operators;
    VirtualRobot robot{t.op, bit_rate};
    robot.handling = [&](std::uint16_t) { return random.extreme(t.op.handling.count()); };
    robot.jitter = [&](std::uint16_t topic, Ns) { return random.extreme(t.topics[topic].jitter.count()); };
    robot.sampling = [&](std::uint16_t topic) { return random.extreme(t.on_board[topic]); };
    robot.reaction = [&](std::uint16_t) { return random.extreme(t.op.reaction.count()); };
    robot.stepped = [&](Ns) {
      if (robot.supervisor().configuration() >= t.configurations.size())
        FAIL("in no configuration, seed " << seed);
      if (robot.supervisor().next() <= base::Time{base::Duration{robot.now()}})
        FAIL("due at once, seed " << seed);
    };
    const auto count = static_cast<Ns>(t.configurations.size());
    for (Ns when = 20'000'000; when < 500'000'000; when += random.up_to(150'000'000))
      robot.request(when, static_cast<std::uint16_t>(random.up_to(count - 1)));
    const auto last = static_cast<std::uint16_t>(1 + random.up_to(count - 2));
    const Ns asked = 500'000'000;
    robot.request(asked, last);

    // Something happens to a topic that the monitor of the last one looks at, at any time or as soon as it
    // has just been looked at; or it happened long before.
    const Term& term = t.terms[last - 1U][0];
    const std::uint16_t topic = t.conditions[term.condition].topic;
    const bool is_age = t.conditions[term.condition].watched == Watched::age;
    Ns event = -1;
    const auto happen = [&] {
      if (event >= 0) return;
      event = robot.now();
      robot.watch();
      if (is_age)
        robot.silent[topic] = true;
      else
        robot.values[topic] = 200;
    };
    const Ns from = random.one_in(4) ? random.up_to(asked) : asked + random.up_to(200'000'000);
    const bool after_sample = random.one_in(2);
    robot.sampled = [&](std::uint16_t sampled, Ns now) {
      if (after_sample && sampled == topic && now >= from) happen();
    };
    robot.at(after_sample ? from + 300'000'000 : from, happen);
    robot.start();
    robot.run(2'000'000'000);

    // In the fall-back, or where it was asked to before anything had happened and nothing looks at the topic.
    if (robot.supervisor().configuration() == 0) ++fell_back;
    if (!robot.acted) return;
    ++acted;
    const Latency latency =
        Proof<128>{t.op, bit_rate, t.sampling}.latency(robot.acted->transition, robot.acted->from);
    if (!latency.bounded) FAIL("no bound, seed " << seed);
    const Ns settled = robot.acted->entered + t.op.settle.count();
    if (event < settled) ++entering;
    const Ns measured = robot.acted->at - std::max(event, settled);
    const Ns at_worst = robot.acted->at - std::max(event, robot.acted->entered);
    if (measured > latency.total() || at_worst > latency.at_worst())
      FAIL("seed " << seed << ": " << measured << " and not " << latency.total() << "; from entry "
                   << at_worst);
    if (measured > latency.total() - latency.sampling) ++sampled_long;
    closest = std::max(closest, static_cast<double>(measured) / static_cast<double>(latency.total()));
  }
};

TEST_CASE("proof properties: 10000 random operators and robots are never later than proved") {
  Campaign campaign;
  std::uint32_t seed = 1;
  const int operators = test::explored(10'000);
  for (; campaign.operators < operators; ++seed) campaign.run(seed);
  INFO("refused " << campaign.refused << ", acted " << campaign.acted << ", entering " << campaign.entering);
  INFO("fell back " << campaign.fell_back << ", closest " << campaign.closest);
  CHECK(campaign.acted > operators / 2);
  CHECK(campaign.entering > operators / 20);
  CHECK(campaign.fell_back == campaign.operators);
  CHECK(campaign.closest > 0.99);
  INFO("later than without sampling " << campaign.sampled_long);
  CHECK(campaign.sampled_long > operators / 500);
}

}  // namespace reflective_proof_properties_test
