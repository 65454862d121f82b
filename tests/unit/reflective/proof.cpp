#include "ocm/reflective/proof.hpp"

#include <vector>

#include <catch2/catch.hpp>

#include "unit/reflective/guard.hpp"

namespace reflective_proof_test {

using namespace ocm;
using namespace ocm::reflective;
using namespace ocm::test;
using namespace std::chrono_literals;

// Two frames by hand, at 1 Mbit/s and with the closed bounds for lengths: a tick of 1000 ns is a bit.
constexpr std::array<protocol::Field, 1> byte{
    {{.name = "value", .position = {0, 8}, .unit = {}, .raw_min = 0, .raw_max = 255, .values = {}}}};
constexpr protocol::FrameLayout layout(std::uint8_t id, std::uint16_t length, bool has_field) {
  protocol::FrameLayout result;
  result.id = protocol::TopicId{id};
  result.length = length;
  if (has_field) result.fields = byte;
  return result;
}
constexpr std::array<protocol::FrameLayout, 1> watched_frames{layout(1, 1, true)};
constexpr std::array<protocol::FrameLayout, 1> long_frames{layout(2, 8, false)};
constexpr std::array<protocol::FrameLayout, 1> motor_frames{layout(3, 1, true)};
constexpr protocol::Topic topic(std::string_view name, std::uint8_t id, protocol::Kind kind,
                                std::span<const protocol::FrameLayout> frames, base::Duration jitter) {
  protocol::Topic result;
  result.name = name;
  result.id = protocol::TopicId{id};
  result.kind = kind;
  result.frames = frames;
  result.jitter = jitter;
  return result;
}
constexpr std::array<protocol::Topic, 3> topics{{
    topic("watched", 1, protocol::Kind::sensor, watched_frames, 2ms),
    topic("long", 2, protocol::Kind::sensor, long_frames, 0ms),
    topic("motor", 3, protocol::Kind::actuator, motor_frames, 0ms),
}};
constexpr std::array<protocol::Board, 1> boards{{{"board", "none"}}};
constexpr protocol::Catalogue catalogue{"two frames", 1'000'000, boards, topics};

constexpr std::array<Stream, 2> streams{
    {{0, 20ms, protocol::Priority::high}, {1, 50ms, protocol::Priority::low}}};
constexpr std::array<Stream, 1> after{{{0, 20ms, protocol::Priority::high}}};
constexpr std::array<SetPoint, 1> stop{{{2, {}, protocol::Priority::urgent, 0ns}}};
constexpr std::array<Configuration, 2> configurations{
    {{"moving", streams, {}, {}, {}}, {"still", after, {}, stop, {}}}};
constexpr std::array<Condition, 3> conditions{{
    {.name = "high", .topic = 0, .limit = 100},
    {.name = "silent", .watched = Watched::age, .topic = 0, .limit = 60'000'000},
    {.name = "slow", .watched = Watched::rate, .is = Is::below, .topic = 0, .limit = 2, .window = 100ms},
}};
constexpr std::array<Term, 1> when_high{{{.condition = 0}}};
constexpr std::array<Term, 3> when_either{{{.condition = 0}, {.condition = 1}, {.op = Op::any}}};
constexpr std::array<Term, 1> when_slow{{{.condition = 2}}};
constexpr std::array<Monitor, 3> monitors{
    {{"high", when_high, {}}, {"either", when_either, 30ms}, {"slow", when_slow, {}}}};
constexpr std::array<Transition, 4> transitions{
    {{"high", 0, 1, 0, 0}, {"either", 0, 1, 1, 1}, {"slow", 0, 1, 2, 2}, {"asked", 1, 0, by_request, 0}}};
constexpr Operator make() {
  Operator op;
  op.catalogue = &catalogue;
  op.configurations = configurations;
  op.conditions = conditions;
  op.monitors = monitors;
  op.transitions = transitions;
  op.fall_back = 1;
  op.settle = 10ms;
  op.reaction = 3ms;
  op.handling = 1ms;
  return op;
}
constexpr Operator tables = make();
static_assert(first_mistake(tables).kind == Mistake::no_mistake);

// Lengths with intermission: 1 byte 65 bits, 8 bytes 135, a stop 65, a request of 4 bytes 95.
constexpr Latency latency(std::size_t transition) {
  return Proof<16>{tables, 1'000'000}.latency(transition, 0);
}
constexpr Latency high = latency(0);
static_assert(high.bounded && high.period == 20'000'000 && high.jitter == 2'000'000 &&
              high.reading == 3'000'000);
static_assert(high.bus == (135 + 65) * 1000);      // behind the long one
static_assert(high.command == (135 + 65) * 1000);  // so is the set point
static_assert(high.total() == 20'000'000 + 2'000'000 + 200'000 + 3'000'000 + 200'000);
static_assert(high.at_worst() == high.total() + 10'000'000);
constexpr Latency either = latency(1);
static_assert(either.condition == 1 && either.limit == 60'000'000 && either.period == 0);
static_assert(either.lasting == 30'000'000 && either.timer == 2 * 3'000'000);
static_assert(either.total() ==
              200'000 + 3'000'000 + 60'000'000 + 3'000'000 + 30'000'000 + 3'000'000 + 200'000);
constexpr Latency slow = latency(2);
static_assert(slow.window == 200'000'000 && slow.timer == 3'000'000);
static_assert(Proof<16>{tables, 1'000'000}.latency(3, 1).total() == 3'000'000);  // asked; commands nothing
// Of a monitor with several conditions each has its own.
static_assert(Proof<16>{tables, 1'000'000}.latency(1, 0, 0).total() == high.total() + 33'000'000);
static_assert(Proof<16>{tables, 1'000'000}.latency(1, 0, 1).total() == either.total());
static_assert(Proof<16>{tables, 1'000'000}.response(0, 0) == high.jitter + high.bus);
static_assert(Proof<16>{tables, 1'000'000}.response(1, 1) == analysis::unbounded);  // does not stream it
// What a sample takes on its board is a term of its own, and jitter on the bus.
constexpr std::array<Sampling, 2> on_board{{{none, 0, 0, 1'500'000}, {0, 1, 0, 1'700'000}}};
constexpr Latency sampled(std::size_t transition) {
  return Proof<16>{tables, 1'000'000, on_board}.latency(transition, 0);
}
static_assert(sampled(0).sampling == 1'500'000 && sampled(0).jitter == high.jitter &&
              sampled(0).bus == high.bus);
static_assert(sampled(0).total() == high.total() + 1'500'000);
static_assert(sampled(1).total() == either.total() + 1'500'000);
static_assert(sampled(2).total() == slow.total() + 1'500'000);
static_assert(Proof<16>{tables, 1'000'000, on_board}.response(0, 0) == high.jitter + 1'500'000 + high.bus);
static_assert(Proof<16>{tables, 1'000'000, on_board}.response(1, 0) ==
              Proof<16>{tables, 1'000'000}.response(1, 0));  // of another configuration
static_assert(Proof<16>{tables, 1'000'000}.load(0, 1) > Proof<16>{tables, 1'000'000}.load(0));
static_assert(!Proof<16>{tables, 1'000'000}.latency(0, 1).bounded);  // does not leave from there

// After a reset of the board. A request goes behind the long one and the other request. A sample of the
// watched one, at high priority, goes behind the long one and the other request; its own next one is much
// later.
constexpr Recovery recovery(std::uint16_t configuration, std::uint16_t topic, base::Duration retry) {
  Operator op = tables;
  op.retry = retry;
  return Proof<32>{op, 1'000'000}.recovery(configuration, topic);
}
constexpr Recovery by_silence = recovery(0, 0, 63'295us);
static_assert(by_silence.bounded && by_silence.silence == 60'000'000 && by_silence.last == 3'295'000 &&
              by_silence.retry == 0);
static_assert(by_silence.request == (135 + 2 * 95) * 1000);
static_assert(by_silence.total() == 63'295'000 + 3'000'000 + 325'000 + 1'000'000 + 2'000'000 + 295'000);
static_assert(by_silence.at_worst() == by_silence.total() + 10'000'000);
constexpr Recovery by_retry = recovery(0, 0, 63'296us);
static_assert(by_retry.retry == 63'296'000 && by_retry.silence == 0 && by_retry.last == 0);
static_assert(by_retry.total() == by_silence.total() + 1'000);
static_assert(!recovery(0, 0, 0ms).bounded && recovery(0, 0, 0ms).total() == analysis::unbounded);
static_assert(!recovery(1, 1, 1s).bounded);  // does not stream it
// A retry that is so short that the next request may be there counts it, and two frames of other grids.
static_assert(recovery(0, 0, 6'845us).bus == (135 + 95 + 65) * 1000);
static_assert(recovery(0, 0, 6'844us).bus == (135 + 2 * 95 + 3 * 65) * 1000);

// From moving to still: the set point and the stop; then what the long one, which may have been released just
// before, needs behind them and the watched one, which goes on.
constexpr std::int64_t settling = Proof<32>{tables, 1'000'000}.settling(0, 1);
static_assert(settling == 3'000'000 + (135 + 65 + 65) * 1000 + 1'000'000 + (65 + 65 + 65 + 135) * 1000);

constexpr bool is_in_time(const Operator& op, std::uint32_t bit_rate) {
  bool fine = true;
  Proof<32>{op, bit_rate}.check([&](const Doubt&) { fine = false; });
  return fine;
}
static_assert(is_in_time(tables, 1'000'000));
// So is one that is left from anywhere.
constexpr std::array<Transition, 2> from_anywhere{{{"high", 0, 1, 0, 0}, {"asked", any_configuration, 0}}};
constexpr Operator left_from_anywhere() {
  Operator op = tables;
  op.transitions = from_anywhere;
  return op;
}
static_assert(is_in_time(left_from_anywhere(), 1'000'000));

std::vector<Doubt> doubts(const Operator& op, std::uint32_t bit_rate = 1'000'000) {
  std::vector<Doubt> all;
  Proof<32>{op, bit_rate}.check([&](const Doubt& doubt) { all.push_back(doubt); });
  return all;
}

static_assert(Sampling{}.time == 0 && Doubt{}.sampling == 0 && Doubt{}.needs == 0);

TEST_CASE("proof: a change on a bus that is nearly full has a bound all the same") {
  // 90 of 100 us are another's: what waits, about 0.5 ms, comes to its end after some 5 ms, in 50 steps.
  const std::array<analysis::Message, 1> busy{
      {{.cost = 90'000, .period = 100'000, .deadline = analysis::unbounded}}};
  Operator op = tables;
  op.others = busy;
  const std::int64_t nearly_full = Proof<32>{op, 1'000'000}.settling(0, 1);
  CHECK(nearly_full != analysis::unbounded);
  CHECK(nearly_full > settling + 2'000'000);
  CHECK(nearly_full < 20'000'000);
}

TEST_CASE("proof: a change that takes longer than it may, to the nanosecond") {
  Operator op = tables;
  op.settle = base::Duration{settling};
  CHECK(doubts(op).empty());
  op.settle -= 1ns;
  const auto all = doubts(op);
  REQUIRE(all.size() == 1);
  CHECK(all[0].kind == Doubt::Kind::unsettled);
  CHECK(all[0].needs == settling);
  CHECK((all[0].from == 0 && all[0].configuration == 1));
}

TEST_CASE("proof: a change need not be in time where no transition makes it") {
  Operator op = tables;
  op.settle = base::Duration{settling - 1};
  op.transitions = std::span{transitions}.first(3);  // there, and not back
  const auto there = doubts(op);
  REQUIRE(there.size() == 1);
  CHECK((there[0].from == 0 && there[0].configuration == 1));
  op.transitions = std::span{transitions}.last(1);  // back, and not there
  CHECK(doubts(op).empty());
}

TEST_CASE("proof: a change of nothing but messages takes as long as the last one that is left") {
  std::vector<protocol::Topic> all{topics.begin(), topics.end()};
  all[0].kind = protocol::Kind::message;
  const protocol::Catalogue sent_only{"two frames", 1'000'000, boards, all};
  const std::vector<Configuration> both{{"heard", after, {}, {}, {}}, {"none", {}, {}, {}, {}}};
  const std::vector<Transition> asked{{"there", 0, 1}, {"back", 1, 0}};
  Operator op = tables;
  op.catalogue = &sent_only;
  op.configurations = both;
  op.transitions = asked;
  op.monitors = {};
  op.conditions = {};
  Proof<32> proof{op, 1'000'000};
  // Nothing is stopped or asked for: reaction, handling, and a frame that is 2 ms late.
  CHECK(proof.settling(0, 1) == 3'000'000 + 1'000'000 + 2'000'000 + 65'000);
  CHECK(proof.settling(1, 0) == 3'000'000 + 1'000'000);
}

TEST_CASE("proof: a change of a period, by hand, and one of a stream that goes on") {
  std::vector<Stream> slower{{0, 40ms, protocol::Priority::high}};
  std::vector<Configuration> changed{configurations.begin(), configurations.end()};
  changed[1].streams = slower;
  Operator op = tables;
  op.configurations = changed;
  Proof<32> proof{op, 1'000'000};
  // The set point, the stop and the request, behind the long one. Then the watched one, 2 ms late, behind the
  // long one, these three, and two of a grid that begins again just then.
  const std::int64_t queue = (135 + 65 + 65 + 95) * 1000;
  CHECK(proof.settling(0, 1) == 3'000'000 + queue + 1'000'000 + 2'000'000 + queue + 3 * 65'000);
  // The set point is handed over first: it waits for the long one alone.
  CHECK(proof.latency(0, 0).command == (135 + 65) * 1000);
  // Back again: no set point, and two requests.
  CHECK(proof.settling(1, 0) ==
        3'000'000 + (135 + 2 * 95) * 1000 + 1'000'000 + 2'000'000 + (135 + 2 * 95 + 3 * 65) * 1000);
  // One with neither stop nor set point, whose stream goes on: nothing old, and one request.
  changed[1].entry = {};
  slower[0].period = 20ms;
  CHECK(proof.settling(1, 0) == 3'000'000 + (135 + 95) * 1000 + 1'000'000);
}

TEST_CASE("proof: how soon it notices what the bus itself says") {
  const std::array<protocol::FrameLayout, 1> refused{layout(4, 1, true)};
  std::vector<protocol::Topic> all{topics.begin(), topics.end()};
  all.push_back(topic("refused", 4, protocol::Kind::sensor, refused, 0ms));
  all.back().role = protocol::Role::refusal;
  all.back().priority = protocol::Priority::high;
  const protocol::Catalogue with_refusals{"three frames", 1'000'000, boards, all};
  std::vector<Condition> of_bus{{.name = "refusals", .watched = Watched::refusals},
                                {.name = "load", .watched = Watched::bus_load, .limit = 700, .window = 100ms},
                                {.name = "state", .watched = Watched::bus_state},
                                {.name = "gap", .watched = Watched::gap, .topic = 0, .limit = 60'000'000}};
  std::vector<std::vector<Term>> terms;
  std::vector<Monitor> each;
  std::vector<Transition> away;
  for (std::uint16_t c = 0; c < of_bus.size(); ++c) terms.push_back({{.condition = c}});
  for (std::uint16_t c = 0; c < of_bus.size(); ++c) {
    each.push_back({of_bus[c].name, terms[c], {}});
    away.push_back({"away", 0, 1, c, static_cast<std::uint8_t>(c)});
  }
  away.push_back({"asked", 1, 0});
  Operator op = tables;
  op.catalogue = &with_refusals;
  op.conditions = of_bus;
  op.monitors = each;
  op.transitions = away;
  op.retry = 500ms;
  REQUIRE(first_mistake(op).kind == Mistake::no_mistake);
  Proof<32> proof{op, 1'000'000};
  // Two requests may be refused just then, after whatever goes before their refusals.
  const Latency refusal = proof.latency(0, 0);
  CHECK((refusal.bounded && refusal.bus > 2 * 65'000 && refusal.bus < 1'000'000 + 10'000'000));
  CHECK(refusal.total() == refusal.bus + 3'000'000 + refusal.command);
  CHECK(refusal.command == proof.latency(2, 0).command);
  const Latency load = proof.latency(1, 0);
  CHECK(load.total() == 200'000'000 + 3'000'000 + load.command);
  const Latency state = proof.latency(2, 0);
  CHECK(state.total() == 3'000'000 + state.command);
  const Latency gap = proof.latency(3, 0);
  CHECK(gap.jitter == 0);
  CHECK(gap.total() == gap.bus + 3'000'000 + 60'000'000 + 3'000'000 + gap.command);
}

TEST_CASE("proof: a fault on the bus costs an error frame and what it hit") {
  // The set point and what may go before it take 200 us; one fault: 31 bits, and the longer of both again.
  Proof<16> proof{tables, 1'000'000, {}, {.burst = 1}};
  CHECK(proof.latency(0, 0).command == (135 + 65 + 31 + 65) * 1000);
  CHECK(proof.latency(0, 0).bus == (135 + 65 + 31 + 65) * 1000);
}

TEST_CASE("proof: what cannot be asked for is not asked for again") {
  std::vector<protocol::Topic> all{topics.begin(), topics.end()};
  all[0].kind = protocol::Kind::message;
  const protocol::Catalogue sent_only{"two frames", 1'000'000, boards, all};
  Operator op = tables;
  op.catalogue = &sent_only;
  op.retry = 500ms;
  CHECK_FALSE(Proof<32>{op, 1'000'000}.recovery(0, 0).bounded);
  CHECK(Proof<32>{op, 1'000'000}.recovery(0, 1).bounded);
  op.retry = -1ns;
  CHECK_FALSE(Proof<32>{op, 1'000'000}.recovery(0, 1).bounded);
}

TEST_CASE("proof: what others send must be in time, too, in each configuration and each change") {
  const std::vector<analysis::Message> others{
      {.cost = 65'000, .period = 5'000'000, .deadline = 199'999, .key = 0}};
  Operator op = tables;
  op.others = others;
  const auto all = doubts(op);  // behind the long one it takes 200 us
  std::vector<std::pair<std::uint16_t, std::uint16_t>> where;
  for (const Doubt& doubt : all) {
    CHECK((doubt.kind == Doubt::Kind::late && doubt.topic == none && doubt.why.response == 200'000));
    CHECK(doubt.sampling == 0);
    where.emplace_back(doubt.from, doubt.configuration);
  }
  CHECK(where == std::vector<std::pair<std::uint16_t, std::uint16_t>>{{none, 0}, {none, 0}, {0, 1}, {1, 0}});
}

TEST_CASE("proof: a change of more messages than it has room for is named") {
  // Two streams alone; at the start two requests more, in the change a set point and a stop.
  std::vector<Doubt> all;
  Proof<3>{tables, 1'000'000}.check([&](const Doubt& doubt) { all.push_back(doubt); });
  REQUIRE(all.size() == 2);
  CHECK((all[0].kind == Doubt::Kind::too_many && all[0].from == none && all[0].configuration == 0));
  CHECK((all[1].kind == Doubt::Kind::too_many && all[1].from == 0 && all[1].configuration == 1));
  CHECK(Proof<3>{tables, 1'000'000}.settling(0, 1) == analysis::unbounded);
  CHECK(Proof<3>{tables, 1'000'000}.load(0, 1) == analysis::unbounded);
  CHECK(Proof<1>{tables, 1'000'000}.load(0) == analysis::unbounded);
  CHECK(Proof<1>{tables, 1'000'000}.response(0, 0) == analysis::unbounded);
  CHECK(Proof<4>{tables, 1'000'000}.settling(0, 1) == settling);
  CHECK_FALSE((Proof<3>{tables, 1'000'000}.latency(0, 0).bounded));
}

TEST_CASE("proof: configurations fit, but not the change between them") {
  std::vector<Stream> slow_one{{0, 10ms, protocol::Priority::high}};
  std::vector<Stream> fast{{1, 360us, protocol::Priority::low}};
  std::vector<Configuration> both{{"a", slow_one, {}, {}, {}}, {"b", fast, {}, {}, {}}};
  std::vector<Transition> asked{{"there", 0, 1}, {"back", 1, 0}};
  Operator op = tables;
  op.configurations = both;
  op.transitions = asked;
  op.monitors = {};
  op.conditions = {};
  op.settle = 20ms;
  // Alone 135 bits. In the change a stop, a request and the other's frame go before it: 65 + 95 + 65.
  CHECK(doubts(op).empty());
  fast[0].period = 359us;
  const auto all = doubts(op);
  REQUIRE(all.size() == 2);  // there and back
  CHECK((all[0].kind == Doubt::Kind::late && all[0].from == 0 && all[0].configuration == 1 &&
         all[0].topic == 1));
  CHECK(all[0].why.response == 360'000);
  CHECK((all[1].kind == Doubt::Kind::late && all[1].from == 1 && all[1].configuration == 0 &&
         all[1].topic == 1));
}

TEST_CASE("proof: an age that a healthy stream reaches") {
  std::vector<Condition> changed{conditions.begin(), conditions.end()};
  Operator op = tables;
  op.conditions = changed;
  const std::int64_t least = 20'000'000 + 2'000'000 + 200'000 + 3'000'000;
  changed[1].limit = least + 1;
  CHECK(doubts(op).empty());
  changed[1].limit = least;
  const auto all = doubts(op);
  REQUIRE(all.size() == 1);
  CHECK(all[0].kind == Doubt::Kind::restless);
  CHECK((all[0].condition == 1 && all[0].configuration == 0 && all[0].needs == least));
  // It counts from the entry of a configuration, too, of which the first sample may come when that is over.
  op.settle = 25ms;
  changed[1].limit = least + 5'000'000;
  const auto at_entry = doubts(op);
  REQUIRE(at_entry.size() == 1);  // and not in the other configuration, where nothing is long
  CHECK(at_entry[0].needs == least + 5'000'000);
  changed[1].limit += 1;
  CHECK(doubts(op).empty());
}

TEST_CASE("proof: a gap that a healthy stream reaches") {
  std::vector<Condition> changed{conditions.begin(), conditions.end()};
  changed[1].watched = Watched::gap;
  Operator op = tables;
  op.conditions = changed;
  const std::int64_t least = 20'000'000 + 2'000'000 + 200'000 + 3'000'000;
  changed[1].limit = least + 1;
  CHECK(doubts(op).empty());
  changed[1].limit = least;
  CHECK(doubts(op).size() == 1);
}

TEST_CASE("proof: what a sample takes on its board counts in ages and deadlines") {
  std::vector<Sampling> slow_board{{none, 0, 0, 5'000'000}};
  const auto doubts_of = [&](const Operator& op) {
    std::vector<Doubt> all;
    Proof<32>{op, 1'000'000, slow_board}.check([&](const Doubt& doubt) { all.push_back(doubt); });
    return all;
  };
  std::vector<Condition> changed{conditions.begin(), conditions.end()};
  Operator op = tables;
  op.conditions = changed;
  const std::int64_t least = 20'000'000 + 2'000'000 + 5'000'000 + 200'000 + 3'000'000;
  changed[1].limit = least + 1;
  CHECK(doubts_of(op).empty());
  changed[1].limit = least;
  auto all = doubts_of(op);
  REQUIRE(all.size() == 1);
  CHECK((all[0].kind == Doubt::Kind::restless && all[0].condition == 1 && all[0].needs == least));

  // 2 ms late, 200 us on the bus, 20 ms until the next one. At the start a request may go before it, too.
  const auto late = [&](std::int64_t time) {
    slow_board[0].time = time;
    std::size_t count = 0;
    for (const Doubt& doubt : doubts_of(tables)) {
      CHECK((doubt.kind == Doubt::Kind::late && doubt.topic == 0 && doubt.configuration == 0));
      CHECK((doubt.sampling == time && doubt.why.response >= 20'000'001));
      ++count;
    }
    return count;
  };
  CHECK(late(17'800'000 - 2 * 95'000) == 0);
  CHECK(late(17'800'000) == 1);
  CHECK(late(17'800'001) == 2);
}

TEST_CASE("proof: what its board cannot serve has no bound, and delays no other") {
  const std::array<Sampling, 1> never{{{none, 0, 0, analysis::unbounded}}};
  Proof<32> proof{tables, 1'000'000, never};
  CHECK_FALSE(proof.latency(0, 0).bounded);
  CHECK(proof.response(0, 0) == analysis::unbounded);
  CHECK(proof.response(0, 1) == Proof<32>{tables, 1'000'000}.response(0, 1));
  std::vector<Doubt> all;
  proof.check([&](const Doubt& doubt) { all.push_back(doubt); });
  REQUIRE(all.size() == 2);  // and the start
  for (const Doubt& doubt : all)
    CHECK((doubt.kind == Doubt::Kind::late && doubt.topic == 0 && doubt.sampling == analysis::unbounded));
}

TEST_CASE("proof: in a change the samples that its boards take longest count") {
  // An old stream's sample is handed over so much later.
  const std::array<Sampling, 1> longer{{{0, 1, 1, 1'000'000}}};
  Proof<32> proof{tables, 1'000'000, longer};
  CHECK(proof.settling(0, 1) == settling + 1'000'000);
  CHECK(proof.latency(0, 0).total() == high.total());
}

TEST_CASE("proof: values that would be stale before the next ones come") {
  Operator op = tables;
  op.reaction = 38ms;  // 60 ms is 3 periods
  op.settle = 100ms;
  std::size_t stale = 0;
  for (const Doubt& doubt : doubts(op))
    stale += doubt.kind == Doubt::Kind::restless && doubt.condition == 0 ? 1U : 0U;
  CHECK(stale == 2);
  // Of one that follows a value three of the shortest, while samples come at the longest.
  std::vector<Adaptation> adaptations{
      {.stream = 0, .topic = 0, .from = 0, .to = 100, .at_from = 30ms, .at_to = 15ms}};
  std::vector<Configuration> changed{configurations.begin(), configurations.end()};
  changed[0].adaptations = adaptations;
  op.configurations = changed;
  op.reaction = 3ms;
  const auto values = [&] {
    std::vector<std::int64_t> needs;
    for (const Doubt& doubt : doubts(op))
      if (doubt.kind == Doubt::Kind::restless && doubt.condition == 0) needs.push_back(doubt.needs);
    return needs;
  };
  CHECK(values().empty());
  adaptations[0].at_to = 11ms;
  REQUIRE(values().size() == 1);
  CHECK(values()[0] > 30'000'000 + 2'000'000 + 3'000'000);
}

TEST_CASE("proof: more messages than it has room for are no proof") {
  std::vector<Doubt> all;
  Proof<2>{tables, 1'000'000}.check([&](const Doubt& doubt) { all.push_back(doubt); });
  REQUIRE_FALSE(all.empty());
  CHECK(all.back().kind == Doubt::Kind::too_many);
  CHECK_FALSE((Proof<2>{tables, 1'000'000}.latency(0, 0).bounded));
}

TEST_CASE("proof: what others send delays both ways") {
  std::vector<analysis::Message> others{{.cost = 135'000, .period = 5'000'000, .key = 0}};
  Operator op = tables;
  op.others = others;
  Proof<32> proof{op, 1'000'000};
  CHECK(proof.latency(0, 0).bus == 200'000 + 135'000);
  CHECK(proof.latency(0, 0).command == 200'000 + 135'000);
  others[0].key = can::arbitration_key({.id = 1});  // more urgent than any set point of the operator
  CHECK(proof.latency(0, 0).command == 200'000 + 135'000);
  others[0].key = ~0U;  // less urgent than all: it blocks no longer than the long one
  CHECK(proof.latency(0, 0).total() == high.total());
}

TEST_CASE("proof: what may be queued before the set point counts") {
  Operator op = tables;
  op.retry = 500ms;
  // Both streams of the configuration may be asked for again just then: 95 bits each.
  CHECK(Proof<32>{op, 1'000'000}.latency(0, 0).command == (135 + 65 + 2 * 95) * 1000);
}

TEST_CASE(
    "proof: an adapted stream counts at its shortest period on the bus, at its longest for what it shows") {
  std::vector<Adaptation> adaptations{
      {.stream = 0, .topic = 0, .from = 0, .to = 100, .at_from = 30ms, .at_to = 10ms}};
  std::vector<Configuration> changed{configurations.begin(), configurations.end()};
  changed[0].adaptations = adaptations;
  Operator op = tables;
  op.configurations = changed;
  REQUIRE(first_mistake(op).kind == Mistake::no_mistake);
  Proof<32> proof{op, 1'000'000};
  CHECK(proof.latency(0, 0).period == 30'000'000);
  op.retry = 50ms;
  CHECK(proof.recovery(0, 0).silence == 90'000'000);
  CHECK(proof.recovery(0, 0).bus > recovery(0, 0, 50ms).bus);  // its grid may begin again just before
  op.retry = 0ms;
  const std::int64_t adapted = proof.load(0);
  CHECK(adapted > Proof<32>{tables, 1'000'000}.load(0));
}

TEST_CASE("proof: what else is on the bus in a configuration counts there, and once in a change") {
  const std::array<analysis::Message, 1> more{{{.cost = 200'000, .period = 100'000'000, .key = 1}}};  // 0.2 %
  std::vector<Configuration> changed{guard::configurations.begin(), guard::configurations.end()};
  changed[guard::idle].others = more;
  changed[guard::driving].others = more;
  Operator op = guard::tables;
  op.configurations = changed;
  Proof<256> with{op, amiro::bit_rate};
  Proof<256> without{guard::tables, amiro::bit_rate};
  CHECK(with.load(guard::driving) == without.load(guard::driving) + 2);
  CHECK(with.load(guard::stopped) == without.load(guard::stopped));
  for (const auto& [from, to] : {std::pair{guard::idle, guard::driving}, {guard::driving, guard::stopped}})
    CHECK(with.load(from, to) == without.load(from, to) + 2);
  CHECK(with.load(none, guard::idle) == without.load(none, guard::idle) + 2);
  CHECK(with.response(guard::driving, guard::ring) ==
        without.response(guard::driving, guard::ring) + 200'000);
}

TEST_CASE("proof: the guard of the AMiRo, at 500 kbit/s") {
  Proof<256> proof{guard::tables, amiro::bit_rate};
  std::vector<Doubt> all;
  proof.check([&](const Doubt& doubt) { all.push_back(doubt); });
  CHECK(all.empty());
  const Latency obstacle = proof.latency(0, guard::driving);
  CHECK(obstacle.bounded);
  // The age of 250 ms takes longer than the value.
  CHECK(obstacle.condition == guard::silent);
  CHECK(obstacle.limit == 250'000'000);
  CHECK(obstacle.command > 0);
  CHECK(obstacle.total() < 300'000'000);
}

}  // namespace reflective_proof_test
