/// Boards that are reset: their streams are back on the bus never later than proved, and as late as that if
/// all is as bad as it may be.
#include <algorithm>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/reflective/check.hpp"
#include "ocm/reflective/proof.hpp"

#include "unit/base/explore.hpp"
#include "unit/reflective/random_operator.hpp"
#include "unit/reflective/virtual_robot.hpp"

namespace reflective_proof_recovery_test {

using namespace ocm;
using namespace ocm::reflective;
using namespace ocm::test;
using namespace std::chrono_literals;
constexpr std::uint32_t bit_rate = random_bit_rate;

/// A bound that is a microsecond too small.
constexpr Ns planted(Ns bound) {
  return bound - 1'000;
}

// --- a bound that is reached -------------------------------------------------------------------------------

/// One stream of two frames, and a long frame of another program that goes on the bus just before each frame
/// that matters: the last sample, the request, and the first sample.
struct Worst {
  static constexpr Ns on_board = 1'500'000;
  static constexpr Ns long_frame = 135'000;
  static constexpr std::array<Sampling, 1> sampling{{{none, 0, 0, on_board}}};
  Tables t;
  std::array<analysis::Message, 1> others{{{.cost = long_frame, .period = 1'000'000, .key = ~0U}}};
  Recovery bound;
  Ns measured = -1;

  /// retry: of a request that is lost just before the board is back; else it is back at once.
  explicit Worst(base::Duration retry) {
    t.add_topic(protocol::Kind::sensor, {1, 2}, 2'000'000);
    t.streams = {{{0, 20ms, protocol::Priority::high}}};
    t.entries = {{}};
    t.close();
    t.op.others = others;
    t.op.reaction = 3ms;
    t.op.handling = 4ms;
    t.op.settle = 30ms;
    t.op.retry = retry;
    REQUIRE(first_mistake(t.op).kind == Mistake::no_mistake);
    Proof<64> proof{t.op, bit_rate, sampling};
    proof.check([](const Doubt& doubt) { FAIL("doubt " << static_cast<int>(doubt.kind)); });
    bound = proof.recovery(0, 0);
    REQUIRE(bound.bounded);
    const bool lost = bound.retry != 0;

    VirtualRobot robot{t.op, bit_rate};
    Ns reset = -1;
    Ns up = -1;
    bool asked = false;
    bool bad = false;  // from the reset on all is as late as it may be
    const auto in_the_way = [&](Ns handed_over) {
      robot.at(handed_over - 1, [&] { robot.other(others[0].key, others[0].cost); });
    };
    robot.reaction = [&](std::uint16_t topic) {
      if (!bad) return Ns{0};
      const Ns late = t.op.reaction.count();
      // To a timer: the request, handed over then.
      if (topic == none && measured < 0 && !asked) in_the_way(robot.now() + late);
      asked = asked || topic == none;
      return late;
    };
    robot.handling = [&](std::uint16_t) { return bad ? t.op.handling.count() : 0; };
    robot.jitter = [&](std::uint16_t, Ns) { return bad ? t.topics[0].jitter.count() : 0; };
    const auto is_last = [&] { return reset < 0 && robot.now() > 500'000'000; };
    robot.sampling = [&](std::uint16_t) {
      if (!bad && (lost || !is_last())) return Ns{0};
      in_the_way(robot.now() + on_board);
      return on_board;
    };
    robot.sampled = [&](std::uint16_t, Ns now) {
      if (!is_last()) return;
      reset = now;
      up = lost ? base::never.time_since_epoch().count() : now;
      bad = !lost;
      robot.reset(up);
    };
    robot.asked_again = [&](Ns now) {
      if (!lost || bad) return;
      bad = true;  // the first request begins now, and the board is back a nanosecond later
      up = now + 1;
      robot.back(up);
    };
    robot.came = [&](std::uint16_t, Ns read, Ns now) {
      if (up >= 0 && read >= up && read > reset && measured < 0) measured = now - up;
    };
    robot.start();
    robot.run(3'000'000'000);
    REQUIRE(measured >= 0);
  }
};

TEST_CASE("proof recovery: the bound is reached, so one that is a microsecond too small is caught") {
  SECTION("a board that is back at once") {
    const Worst worst{50ms};
    CHECK(worst.bound.silence == 60'000'000);
    CHECK(worst.bound.last == Worst::on_board + 135'000 + 65'000 + 75'000 + 3'000'000);
    CHECK(worst.measured <= worst.bound.total());
    CHECK_FALSE(worst.measured <= planted(worst.bound.total()));
  }
  SECTION("a board that just did not take the last request") {
    const Worst worst{500ms};
    CHECK(worst.bound.retry == 500'000'000);
    CHECK(worst.bound.silence == 0);
    CHECK(worst.measured <= worst.bound.total());
    CHECK_FALSE(worst.measured <= planted(worst.bound.total()));
  }
}

// --- random ones -------------------------------------------------------------------------------------------

struct Campaign {
  int operators = 0, recovered = 0, by_retry = 0, entering = 0, lost = 0, of_one_board = 0;
  double closest = 0;

  void run(std::uint32_t seed) {
    Chance random{seed};
    Tables t;
    if (!make(t, random, true)) return;
    ++operators;
    VirtualRobot robot{t.op, bit_rate};
    robot.handling = [&](std::uint16_t) { return random.extreme(t.op.handling.count()); };
    robot.jitter = [&](std::uint16_t topic, Ns) { return random.extreme(t.topics[topic].jitter.count()); };
    robot.sampling = [&](std::uint16_t topic) { return random.extreme(t.on_board[topic]); };
    robot.reaction = [&](std::uint16_t) { return random.extreme(t.op.reaction.count()); };
    const auto count = static_cast<Ns>(t.configurations.size());
    Ns change = 0;
    for (Ns when = 20'000'000; when < 800'000'000; when += random.up_to(150'000'000)) {
      robot.request(when, static_cast<std::uint16_t>(random.up_to(count - 1)));
      if (change < 400'000'000) change = when;
    }

    // Once, back at once or later; or just when a request has begun, which is lost then. Half of the time in
    // a change, so that some requests of one configuration are heard, and others not. All boards or one.
    const Ns reset = random.one_in(2) ? std::max<Ns>(change, 400'000'000) + random.up_to(10'000'000)
                                      : 400'000'000 + random.up_to(400'000'000);
    std::vector<bool> its_topics(t.topics.size(), true);
    const bool one_board = random.one_in(2);
    if (one_board)
      for (std::size_t topic = 0; topic < its_topics.size(); ++topic) its_topics[topic] = random.one_in(2);
    const bool at_request = random.one_in(3);
    const Ns away = random.one_in(3) ? 0 : random.up_to(700'000'000);
    Ns up = base::never.time_since_epoch().count();
    robot.at(reset, [&] {
      if (!at_request) up = reset + away;
      robot.reset(up, its_topics);
    });
    if (at_request)
      robot.at(reset + 1'500'000'000, [&] {
        if (up > robot.now()) robot.back(up = robot.now(), its_topics);
      });
    robot.asked_again = [&](Ns now) {
      if (!at_request || now < reset || up <= now) return;
      up = now + 1 + (random.one_in(2) ? 0 : random.up_to(1'000'000));
      robot.back(up, its_topics);
    };
    robot.lost = [&](std::uint16_t, Ns) { ++lost; };

    std::vector<bool> is_back(t.topics.size());
    for (std::size_t topic = 0; topic < is_back.size(); ++topic) is_back[topic] = !its_topics[topic];
    Proof<128> proof{t.op, bit_rate, t.sampling};
    const auto judge = [&](std::uint16_t topic, Ns now, bool came) {
      const auto here = robot.supervisor().configuration();
      const auto& streams = t.streams[here];
      if (std::none_of(streams.begin(), streams.end(), [&](const Stream& s) { return s.topic == topic; }))
        return;
      const Recovery bound = proof.recovery(here, topic);
      if (!bound.bounded) FAIL("no bound, seed " << seed);
      const Ns settled = robot.entered() + t.op.settle.count();
      const Ns measured = now - std::max(up, settled);
      const Ns at_worst = now - std::max(up, robot.entered());
      if (measured > bound.total() || at_worst > bound.at_worst())
        FAIL("seed " << seed << ": topic " << topic << " after " << measured << ", and not " << bound.total()
                     << "; from entry " << at_worst);
      if (!came) return;
      ++recovered;
      if (up < settled) ++entering;
      if (one_board && up < settled) ++of_one_board;
      if (bound.retry != 0) ++by_retry;
      closest = std::max(closest, static_cast<double>(measured) / static_cast<double>(bound.total()));
    };
    robot.came = [&](std::uint16_t topic, Ns read, Ns now) {
      if (read < up || is_back[topic]) return;
      is_back[topic] = true;
      judge(topic, now, true);
    };
    robot.start();
    const auto all_are_back = [&] {
      const auto& streams = t.streams[robot.supervisor().configuration()];
      return std::all_of(streams.begin(), streams.end(), [&](const Stream& s) { return is_back[s.topic]; });
    };
    for (Ns until = 900'000'000; until <= 4'000'000'000; until += 100'000'000) {
      robot.run(until);
      if (up <= until && all_are_back()) break;
    }
    for (std::uint16_t topic = 0; topic < is_back.size(); ++topic)
      if (!is_back[topic]) judge(topic, robot.now(), false);
  }
};

TEST_CASE("proof recovery: 10000 random operators have their streams back not later than proved") {
  const int operators = test::explored(10'000);
  Campaign campaign;
  for (std::uint32_t seed = 1; campaign.operators < operators; ++seed) campaign.run(seed);
  INFO("recovered " << campaign.recovered << ", by retry " << campaign.by_retry << ", entering "
                    << campaign.entering << ", of one board " << campaign.of_one_board << ", lost "
                    << campaign.lost << ", closest " << campaign.closest);
  CHECK(campaign.recovered > operators);
  CHECK(campaign.by_retry > operators / 10);
  CHECK(campaign.by_retry < campaign.recovered - operators / 10);
  CHECK(campaign.entering > operators / 100);
  CHECK(campaign.of_one_board > operators / 100);
  CHECK(campaign.lost > operators / 10);
  CHECK(campaign.closest > 0.99);
}

}  // namespace reflective_proof_recovery_test
