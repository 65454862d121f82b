#include "ocm/reflective/supervisor.hpp"

#include <map>
#include <optional>
#include <set>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/reflective/check.hpp"

#include "unit/reflective/guard.hpp"

namespace reflective_supervisor_test {

using namespace ocm;
using namespace ocm::reflective;
using namespace ocm::test;
using namespace std::chrono_literals;
using Kind = Event::Kind;

constexpr Room room{.conditions = 6, .monitors = 3, .streams = 3, .entry = 1, .limits = 1, .adaptations = 1};
static_assert(fits(guard::tables, room));

// What is not said.
static_assert(Room{}.conditions == 64 && Room{}.monitors == 32 && Room{}.streams == 32);
static_assert(Room{}.entry == 16 && Room{}.limits == 16 && Room{}.adaptations == 8);
static_assert(Event{}.value == 0);
static_assert(SupervisorCounters{} == SupervisorCounters{0, 0, 0, 0, 0, 0, 0, 0});
// A switch and a refusal, set points, and of each stream a stop and a request.
static_assert(Room{}.actions() == 82 && Room{.streams = 3, .entry = 1}.actions() == 9);

// All of it is a constant expression: a guard that stops the motors before an obstacle.
constexpr bool stops_before_an_obstacle() {
  Supervisor<room> supervisor{guard::tables};
  base::Time now{1s};
  static_cast<void>(supervisor.start(now));
  static_cast<void>(supervisor.step({.kind = Kind::request, .value = guard::driving}, now + 60ms));
  const guard::RingSample obstacle{9'000};
  static_cast<void>(
      supervisor.step({.kind = Kind::sample, .topic = guard::ring, .bytes = obstacle.bytes}, now + 100ms));
  const auto actions = supervisor.step({}, supervisor.next());
  return supervisor.configuration() == guard::stopped && actions[0].kind == Action::Kind::switched &&
         actions[1].kind == Action::Kind::command && actions[1].frame.data == can::Payload{};
}
static_assert(stops_before_an_obstacle());

const guard::RingSample obstacle{9'000};
const guard::RingSample middle{2'850};
const guard::RingSample nothing{2'300};

struct Run {
  Supervisor<room> supervisor{guard::tables};
  base::Time now{1s};
  std::vector<Action> actions;

  explicit Run() { take(supervisor.start(now)); }
  void take(std::span<const Action> list) { actions.assign(list.begin(), list.end()); }
  void step(base::Duration after, const Event& event = {}) {
    now += after;
    take(supervisor.step(event, now));
  }
  void ring(base::Duration after, const guard::RingSample& sample) {
    step(after, {.kind = Kind::sample, .topic = guard::ring, .bytes = sample.bytes});
  }
  void ask(base::Duration after, std::int64_t configuration) {
    step(after, {.kind = Kind::request, .value = configuration});
  }
  /// Ticks as often as it says, until `until`.
  void pass(base::Time until) {
    while (supervisor.next() <= until) step(supervisor.next() - now);
    now = until;
  }
  [[nodiscard]] std::vector<Action::Kind> kinds() const {
    std::vector<Action::Kind> all;
    for (const Action& action : actions) all.push_back(action.kind);
    return all;
  }
};
using enum Action::Kind;

TEST_CASE("supervisor: it starts in the initial configuration, asks for its streams and stops all others") {
  const Run run;
  CHECK(run.supervisor.configuration() == guard::idle);
  CHECK(run.supervisor.transition() == none);
  REQUIRE(run.kinds() == std::vector{switched, command, unsubscribe, unsubscribe, subscribe});
  CHECK(run.actions[0].from == none);
  CHECK(run.actions[1].topic == guard::motors);
  // Of `driving` and `stopped`, each once: a run that was killed may have left them.
  CHECK(run.actions[2].topic == guard::ring);
  CHECK(run.actions[3].frame == protocol::stop(amiro::Odometry::id));
  CHECK(run.actions[4].frame == *protocol::publish_every(amiro::PowerStatus::id, 1000ms));
}

TEST_CASE("supervisor: started again it does no more than at its start") {
  Run run;
  const auto kinds = run.kinds();
  run.take(run.supervisor.start(run.now + 1s));
  CHECK(run.kinds() == kinds);
}

TEST_CASE("supervisor: a switch commands first, then stops, then asks; what goes on is left alone") {
  Run run;
  run.ask(60ms, guard::driving);
  // No set point on entry; power goes on.
  REQUIRE(run.kinds() == std::vector{switched, subscribe, subscribe});
  CHECK(run.actions[1].frame ==
        *protocol::publish_every(amiro::ProximityRing::id, 50ms, protocol::Priority::high));
  run.ring(60ms, obstacle);
  REQUIRE(run.kinds() == std::vector{switched, command, unsubscribe, subscribe});
  CHECK(run.actions[0].transition == 0);
  CHECK(run.actions[2].frame == protocol::stop(amiro::Odometry::id));
  CHECK(run.actions[3].period == 100ms);
}

TEST_CASE("supervisor: a change waits until the last one is over, and is not forgotten") {
  Run run;
  run.ask(60ms, guard::driving);
  run.ring(10ms, obstacle);
  CHECK(run.supervisor.configuration() == guard::driving);
  CHECK(run.supervisor.next() == run.supervisor.since() + 50ms);
  run.step(39'999'999ns);
  CHECK(run.supervisor.configuration() == guard::driving);
  run.step(1ns);
  CHECK(run.supervisor.configuration() == guard::stopped);
}

TEST_CASE("supervisor: what was true when it switched can be asked for as long as it stays there") {
  Run run;
  const auto held = [&run] {
    std::vector<std::size_t> all;
    for (std::size_t c = 0; c < guard::tables.conditions.size(); ++c)
      if (run.supervisor.held(c) == Truth::yes) all.push_back(c);
    return all;
  };
  run.ask(60ms, guard::driving);
  CHECK(held().empty());
  run.ring(60ms, obstacle);
  REQUIRE(run.supervisor.configuration() == guard::stopped);
  const auto& transition = guard::tables.transitions[run.supervisor.transition()];
  const auto because = held();
  CHECK(because == std::vector<std::size_t>{guard::near, guard::near_right});
  CHECK(guard::tables.monitors[transition.monitor].terms[0].condition == because[0]);
  run.ring(60ms, nothing);  // true no more, and still why
  CHECK(held() == because);
}

TEST_CASE("supervisor: while it is held, monitors lead to the fall-back only, and requests anywhere") {
  Run run;
  run.supervisor.hold(true);
  run.ask(60ms, guard::driving);
  CHECK(run.supervisor.configuration() == guard::driving);
  run.ring(60ms, obstacle);
  CHECK(run.supervisor.configuration() == guard::stopped);  // which is the fall-back
  for (int i = 0; i < 5; ++i) run.ring(100ms, nothing);
  CHECK(run.supervisor.monitor(1) == Truth::yes);  // clear
  CHECK(run.supervisor.configuration() == guard::stopped);
  CHECK(run.supervisor.on_hold());
  CHECK(run.supervisor.next() > run.now);  // what is held back is not due
  run.supervisor.hold(false);
  run.step(1ns);
  CHECK(run.supervisor.configuration() == guard::driving);
}

TEST_CASE("supervisor: what leads from here, and what was asked for and waits") {
  Run run;
  CHECK(run.supervisor.leads_to(guard::idle));
  CHECK(run.supervisor.leads_to(guard::driving));
  run.ask(60ms, guard::driving);
  CHECK(run.supervisor.requested() == none);
  CHECK(run.supervisor.heard(0) == run.now);
  run.ring(10ms, nothing);
  CHECK(run.supervisor.heard(0) == run.now);
  run.ask(10ms, guard::idle);
  CHECK(run.supervisor.requested() == guard::idle);
  run.step(50ms);
  CHECK(run.supervisor.configuration() == guard::idle);
  CHECK(run.supervisor.requested() == none);
}

TEST_CASE("supervisor: rest is sent as it is, and the next set point comes up from it") {
  Run run;
  run.ask(60ms, guard::driving);
  std::int64_t raw[] = {100'000, 0};
  run.supervisor.permit(guard::motors, raw, run.now);
  raw[0] = 100'000;
  run.supervisor.permit(guard::motors, raw, run.now + 100ms);
  CHECK(raw[0] == 20'000);
  run.supervisor.commanded(guard::motors, guard::rest, run.now + 110ms);
  raw[0] = 100'000;
  run.supervisor.permit(guard::motors, raw, run.now + 160ms);
  CHECK(raw[0] == 10'000);
}

TEST_CASE("supervisor: hysteresis, and a monitor that must last") {
  Run run;
  run.ask(60ms, guard::driving);
  run.ring(60ms, middle);
  CHECK(run.supervisor.configuration() == guard::driving);  // neither near nor far
  run.ring(1ms, obstacle);
  CHECK(run.supervisor.configuration() == guard::stopped);
  run.ring(60ms, nothing);
  run.ring(200ms, middle);  // a break
  run.ring(10ms, nothing);
  run.ring(100ms, nothing);
  run.ring(199'999'999ns, nothing);
  CHECK(run.supervisor.configuration() == guard::stopped);
  run.step(1ns);
  CHECK(run.supervisor.configuration() == guard::driving);
}

TEST_CASE("supervisor: values of a stream that has fallen silent count no more") {
  Run run;
  run.ask(60ms, guard::stopped);
  run.ring(60ms, nothing);
  CHECK(run.supervisor.condition(guard::clear) == Truth::yes);
  run.pass(run.now + 299'999'999ns);
  CHECK(run.supervisor.condition(guard::clear) == Truth::yes);
  run.step(1ns);  // when it would have lasted long enough
  CHECK(run.supervisor.condition(guard::clear) == Truth::unknown);
  CHECK(run.supervisor.configuration() == guard::stopped);
}

TEST_CASE("supervisor: a silent stream is noticed, and asked for again, bounded") {
  Run run;
  run.ask(60ms, guard::driving);
  run.ring(60ms, nothing);
  const base::Time last = run.now;
  run.pass(last + 249'999'999ns);
  CHECK(run.supervisor.configuration() == guard::driving);
  run.pass(last + 250ms);
  CHECK(run.supervisor.configuration() == guard::stopped);
  const base::Time entered = run.now;
  CHECK(run.supervisor.counters().asked_again == 0);
  // Power, which goes on, is silent too: after three periods; the ring a second after it was asked for.
  std::vector<base::Time> again;
  while (run.now < entered + 4s) {
    run.step(run.supervisor.next() - run.now);
    for (const Action& action : run.actions)
      if (action.kind == Action::Kind::again && action.topic == guard::ring) again.push_back(run.now);
  }
  CHECK(again == std::vector{entered + 1s, entered + 2s, entered + 3s, entered + 4s});
}

TEST_CASE("supervisor: a sample is as old as it was on the bus, not as it was read") {
  Run run;
  run.ask(60ms, guard::driving);
  run.ring(100ms, nothing);
  // The operator did not run for 200 ms; what came 20 ms after the last one is 180 ms old.
  run.now += 200ms;
  run.take(run.supervisor.step(
      {.kind = Kind::sample, .topic = guard::ring, .bytes = nothing.bytes, .age = 180ms}, run.now));
  CHECK(run.supervisor.heard(0) == run.now - 180ms);
  CHECK(run.supervisor.configuration() == guard::driving);
  run.pass(run.now + 69ms);
  CHECK(run.supervisor.configuration() == guard::driving);
  run.pass(run.now + 1ms);
  CHECK(run.supervisor.configuration() == guard::stopped);
  // One that is older than the last adds nothing, and none is of the future.
  run.ring(0ms, nothing);
  const auto heard = run.supervisor.heard(0);
  run.take(run.supervisor.step(
      {.kind = Kind::sample, .topic = guard::ring, .bytes = nothing.bytes, .age = 1s}, run.now));
  CHECK(run.supervisor.heard(0) == heard);
  run.take(run.supervisor.step(
      {.kind = Kind::sample, .topic = guard::ring, .bytes = nothing.bytes, .age = -1s}, run.now));
  CHECK(run.supervisor.heard(0) == run.now);
}

TEST_CASE("supervisor: set points are repeated") {
  Run run;
  run.ask(60ms, guard::stopped);
  const base::Time entered = run.now;
  int count = 0;
  while (run.supervisor.next() <= entered + 1s) {
    run.step(run.supervisor.next() - run.now);
    for (const Action& action : run.actions) count += action.kind == command ? 1 : 0;
  }
  CHECK(count == 10);
}

TEST_CASE("supervisor: requests that lead nowhere are refused, and counted") {
  Run run;
  for (const std::int64_t asked : {-1, 3, 99}) {
    run.ask(60ms, asked);
    CHECK(run.kinds() == std::vector{refused});
    CHECK(run.actions[0].to == none);
  }
  run.ask(60ms, guard::stopped);
  run.ask(60ms, guard::driving);  // only the monitor leads there
  CHECK(run.kinds() == std::vector{refused});
  CHECK(run.supervisor.counters().requests_refused == 4);
  run.ask(0ms, guard::idle);
  run.ask(1ms, guard::driving);
  run.ask(1ms, guard::stopped);
  CHECK(run.supervisor.counters().requests_replaced == 1);
  run.pass(run.now + 60ms);
  CHECK(run.supervisor.configuration() == guard::stopped);
}

TEST_CASE("supervisor: a request that waits is dropped where another transition comes first") {
  Run run;
  run.ask(60ms, guard::driving);
  run.ring(10ms, obstacle);
  run.ask(10ms, guard::idle);
  CHECK(run.supervisor.requested() == guard::idle);
  CHECK(run.supervisor.counters().requests_dropped == 0);
  run.pass(run.now + 60ms);
  CHECK(run.supervisor.configuration() == guard::stopped);  // which has precedence
  CHECK(run.supervisor.requested() == none);
  CHECK(run.supervisor.counters().requests_dropped == 1);
  run.ask(60ms, guard::idle);
  CHECK(run.supervisor.configuration() == guard::idle);
  CHECK(run.supervisor.counters().requests_dropped == 1);
}

TEST_CASE("supervisor: a request for where it is replaces one that waits") {
  Run run;
  run.ask(60ms, guard::stopped);
  run.ask(1ms, guard::idle);
  run.ask(1ms, guard::stopped);
  CHECK(run.supervisor.counters().requests_replaced == 1);
  run.pass(run.now + 60ms);
  CHECK(run.supervisor.configuration() == guard::stopped);
}

TEST_CASE("supervisor: set points of others are held within the limits") {
  Run run;
  run.ask(60ms, guard::driving);
  std::int64_t raw[] = {1'000'000, 0};
  CHECK(run.supervisor.permit(guard::motors, raw, run.now) == 1);
  raw[0] = 1'000'000;
  run.supervisor.permit(guard::motors, raw, run.now + 100ms);
  CHECK(raw[0] == 20'000);
  CHECK(run.supervisor.counters().limited == 2);
}

TEST_CASE("supervisor: a set point that the bus did not take is as if it had not been asked for") {
  Run run;
  run.ask(60ms, guard::driving);
  std::int64_t raw[] = {1'000'000, 0};
  run.supervisor.permit(guard::motors, raw, run.now);
  for (int i = 1; i <= 5; ++i) {
    raw[0] = 1'000'000;
    run.supervisor.permit(guard::motors, raw, run.now + i * 100ms);
    CHECK(raw[0] == 20'000);
    run.supervisor.not_sent();
  }
  raw[0] = 1'000'000;
  run.supervisor.permit(guard::motors, raw, run.now + 600ms);
  CHECK(raw[0] == 20'000);  // not 120'000
  run.supervisor.commanded(guard::motors, guard::rest, run.now + 610ms);
  run.supervisor.not_sent();
  raw[0] = 1'000'000;
  run.supervisor.permit(guard::motors, raw, run.now + 700ms);
  CHECK(raw[0] == 40'000);
}

TEST_CASE("supervisor: an adaptation follows a value, within its bounds and not too often") {
  const auto& field = amiro::catalogue.topics[guard::ring].frames[0].fields[0];
  std::vector<Adaptation> adaptations{{.stream = 1,
                                       .topic = guard::ring,
                                       .from = 0,
                                       .to = 3'800,
                                       .at_from = 200ms,
                                       .at_to = 50ms,
                                       .grain = 50ms,
                                       .every = 500ms}};
  std::vector<Configuration> configurations{guard::configurations.begin(), guard::configurations.end()};
  configurations[guard::driving].adaptations = adaptations;
  Operator op = guard::tables;
  op.configurations = configurations;
  REQUIRE(first_mistake(op).kind == Mistake::no_mistake);
  REQUIRE(field.position.width >= 15);
  Run run;
  run.supervisor = Supervisor<room>{op};
  run.take(run.supervisor.start(run.now));
  run.ask(60ms, guard::driving);
  run.ring(60ms, middle);  // 2'850: 87.5 ms, which is 50 in grains: not before 500 ms
  CHECK(run.supervisor.period(1) == 100ms);
  const base::Time entered = run.supervisor.since();
  for (int i = 0; run.now < entered + 480ms; ++i) run.ring(10ms, middle);
  CHECK(run.supervisor.period(1) == 100ms);
  CHECK(run.supervisor.next() <= entered + 500ms);
  run.step(entered + 500ms - run.now);
  REQUIRE(run.kinds() == std::vector{subscribe});
  CHECK(run.actions[0].frame == *protocol::publish_every(amiro::Odometry::id, 50ms));
  CHECK(run.supervisor.counters().adapted == 1);
}

TEST_CASE("supervisor: rates are counted in windows, gaps last until two samples come in time") {
  std::vector<Condition> conditions{
      {.name = "slow",
       .watched = Watched::rate,
       .is = Is::below,
       .topic = guard::ring,
       .limit = 3,
       .window = 100ms},
      {.name = "gap", .watched = Watched::gap, .topic = guard::ring, .limit = 60'000'000},
      {.name = "refusals", .watched = Watched::refusals, .limit = 1},
      {.name = "load", .watched = Watched::bus_load, .limit = 800, .hysteresis = 200, .window = 1s}};
  Operator op = guard::tables;
  op.conditions = conditions;
  op.monitors = {};
  op.transitions = op.transitions.subspan(3);
  op.initial = guard::driving;
  Run run;
  run.supervisor = Supervisor<room>{op};
  run.take(run.supervisor.start(run.now));
  CHECK(run.supervisor.condition(0) == Truth::unknown);
  for (int i = 0; i < 3; ++i) run.ring(30ms, nothing);
  CHECK(run.supervisor.condition(0) == Truth::unknown);
  run.step(10ms);
  CHECK(run.supervisor.condition(0) == Truth::no);
  CHECK(run.supervisor.condition(1) == Truth::no);
  run.ring(50ms, nothing);  // 60 ms after the last one
  CHECK(run.supervisor.condition(1) == Truth::yes);
  run.step(50ms);
  CHECK(run.supervisor.condition(0) == Truth::yes);
  run.ring(9'999'999ns, nothing);
  CHECK(run.supervisor.condition(1) == Truth::no);
  run.step(500ms);  // whole windows without any
  CHECK(run.supervisor.condition(0) == Truth::yes);

  run.step(0ms, {.kind = Kind::refusal});
  CHECK(run.supervisor.condition(2) == Truth::no);
  run.step(0ms, {.kind = Kind::refusal});
  CHECK(run.supervisor.condition(2) == Truth::yes);
  run.step(0ms, {.kind = Kind::bus_load, .value = 801});
  CHECK(run.supervisor.condition(3) == Truth::yes);
  run.step(0ms, {.kind = Kind::bus_load, .value = 601});
  CHECK(run.supervisor.condition(3) == Truth::yes);
  run.step(0ms, {.kind = Kind::bus_load, .value = 600});
  CHECK(run.supervisor.condition(3) == Truth::no);
  run.ask(60ms, guard::idle);
  CHECK(run.supervisor.condition(2) == Truth::no);  // it counts from zero
  CHECK(run.supervisor.condition(1) == Truth::unknown);
}

TEST_CASE("supervisor: a rate is 0 in a window without samples, and starts at 0 in each") {
  std::vector<Condition> conditions{{.name = "two at most",
                                     .watched = Watched::rate,
                                     .is = Is::below,
                                     .topic = guard::ring,
                                     .limit = 3,
                                     .window = 100ms},
                                    {.name = "none",
                                     .watched = Watched::rate,
                                     .is = Is::below,
                                     .topic = guard::ring,
                                     .limit = 1,
                                     .window = 100ms}};
  Operator op = guard::tables;
  op.conditions = conditions;
  op.monitors = {};
  op.transitions = op.transitions.subspan(3);
  op.initial = guard::driving;
  Run run;
  run.supervisor = Supervisor<room>{op};
  run.take(run.supervisor.start(run.now));
  for (int window = 0; window < 2; ++window) {
    for (int i = 0; i < 2; ++i) run.ring(30ms, nothing);
    run.step(40ms);
    CHECK(run.supervisor.condition(0) == Truth::yes);
    CHECK(run.supervisor.condition(1) == Truth::no);
  }
  run.step(250ms);  // two whole windows
  CHECK(run.supervisor.condition(1) == Truth::yes);
  run.ask(10ms, guard::idle);  // without the ring
  run.step(500ms);
  CHECK(run.supervisor.condition(0) == Truth::unknown);
}

TEST_CASE("supervisor: a rate may have a window of a nanosecond") {
  std::vector<Condition> conditions{
      {.name = "any", .watched = Watched::rate, .topic = guard::ring, .window = 1ns}};
  Operator op = guard::tables;
  op.conditions = conditions;
  op.monitors = {};
  op.transitions = op.transitions.subspan(3);
  op.initial = guard::driving;
  Run run;
  run.supervisor = Supervisor<room>{op};
  run.take(run.supervisor.start(run.now));
  run.ring(10ns, nothing);
  CHECK(run.supervisor.condition(0) == Truth::no);
  run.step(1ns);
  CHECK(run.supervisor.condition(0) == Truth::yes);
}

TEST_CASE("supervisor: refusals count from zero in each configuration") {
  std::vector<Condition> conditions{{.name = "any", .watched = Watched::refusals, .limit = 0},
                                    {.name = "two", .watched = Watched::refusals, .limit = 1}};
  Operator op = guard::tables;
  op.conditions = conditions;
  op.monitors = {};
  op.transitions = op.transitions.subspan(3);
  Run run;
  run.supervisor = Supervisor<room>{op};
  run.take(run.supervisor.start(run.now));
  for (const auto next : {guard::driving, guard::idle}) {
    CHECK(run.supervisor.condition(0) == Truth::no);
    run.step(1ms, {.kind = Kind::refusal});
    CHECK(run.supervisor.condition(0) == Truth::yes);
    CHECK(run.supervisor.condition(1) == Truth::no);
    run.step(1ms, {.kind = Kind::refusal});
    CHECK(run.supervisor.condition(1) == Truth::yes);
    run.ask(60ms, next);
  }
}

/// What the tables mean, written down once more without them: the configuration after an event, given what is
/// known. Each combination of configuration and event is looked at in each of the states that sequences lead
/// to.
struct Model {
  std::uint16_t at = guard::idle;
  base::Time entered;
  std::optional<int> ring;  ///< 0 nothing, 1 middle, 2 obstacle
  bool near = false;        ///< middle is where its hysteresis ends
  base::Time heard{};       ///< the ring, or asked for it
  base::Time clear_since = base::never;
  bool bad = false;
  std::optional<std::uint16_t> asked;

  void go(std::uint16_t to, base::Time now) {
    at = to;
    entered = now;
    asked.reset();
    ring.reset();  // it has another period in each, so it is asked for: what is known is old
    near = false;
    clear_since = base::never;
    heard = now;
  }
  void step(int event, base::Time now) {
    if (event < 3) {
      ring = event;
      near = event == 2;
      heard = now;
    }
    const base::Duration stale = at == guard::driving ? 150ms : 300ms;
    if (at != guard::idle && now >= heard + stale) ring.reset();
    if (!ring) near = false;
    if (event == 3) bad = true;
    if (event == 4) bad = false;
    if (event >= 5 && event <= 7) {
      const auto to = static_cast<std::uint16_t>(event - 5);
      if (to == at)
        asked.reset();
      else if (to != guard::driving || at == guard::idle)
        asked = to;
    }
    if (!(ring && *ring == 0))
      clear_since = base::never;
    else if (clear_since == base::never)
      clear_since = now;
    if (now < entered + 50ms) return;
    const bool obstacle_now = at == guard::driving && (near || now >= heard + 250ms);
    if (obstacle_now || (bad && at != guard::stopped))
      go(guard::stopped, now);
    else if (at == guard::stopped && clear_since != base::never && now >= clear_since + 300ms)
      go(guard::driving, now);
    else if (asked)
      go(*asked, now);
  }
};

/// All sequences of so many events, with 20 or 200 ms before each; 100 ms are neither within a change nor
/// silent.
class Explorer {
 public:
  std::size_t steps = 0;
  std::map<std::pair<int, int>, int> seen;  ///< configuration, event

  void explore(const Supervisor<room>& supervisor, const Model& model, const std::set<std::uint16_t>& streams,
               base::Time now, int depth) {
    if (depth == 0) return;
    for (const base::Duration after : {20ms, 310ms}) {
      for (int event = 0; event < 9; ++event) {
        Supervisor<room> next = supervisor;
        Model expected = model;
        std::set<std::uint16_t> running = streams;
        const base::Time then = now + after;
        const std::uint16_t before = next.configuration();
        const auto actions = next.step(event_of(event), then);
        expected.step(event, then);
        ++steps;
        ++seen[{before, event}];
        if (next.configuration() != expected.at)
          FAIL("from " << before << " with event " << event << " to " << next.configuration() << ", not "
                       << expected.at);
        for (const Action& action : actions) {
          if (action.kind == subscribe || action.kind == again) running.insert(action.topic);
          if (action.kind == unsubscribe) running.erase(action.topic);
        }
        std::set<std::uint16_t> wanted;
        for (const Stream& stream : guard::tables.configurations[next.configuration()].streams)
          wanted.insert(stream.topic);
        if (running != wanted)
          FAIL("streams that run are not those of configuration " << next.configuration());
        if (next.next() <= then) FAIL("due at once");
        explore(next, expected, running, then, depth - 1);
      }
    }
  }

 private:
  static Event event_of(int event) {
    switch (event) {
      case 0:
        return {.kind = Kind::sample, .topic = guard::ring, .bytes = nothing.bytes};
      case 1:
        return {.kind = Kind::sample, .topic = guard::ring, .bytes = middle.bytes};
      case 2:
        return {.kind = Kind::sample, .topic = guard::ring, .bytes = obstacle.bytes};
      case 3:
        return {.kind = Kind::bus_state, .value = static_cast<std::int64_t>(BusState::off)};
      case 4:
        return {.kind = Kind::bus_state, .value = static_cast<std::int64_t>(BusState::active)};
      case 8:
        return {};
      default:
        return {.kind = Kind::request, .value = event - 5};
    }
  }
};

TEST_CASE("supervisor: every event in every state of four events, against a model without tables") {
  Supervisor<room> supervisor{guard::tables};
  const base::Time start{1s};
  static_cast<void>(supervisor.start(start));
  Model model;
  model.entered = start;
  Explorer explorer;
  explorer.explore(supervisor, model, {guard::power}, start, 4);
  CHECK(explorer.steps == 18 + 18 * 18 + 18 * 18 * 18 + 18 * 18 * 18 * 18);
  CHECK(explorer.seen.size() == 3 * 9);
}

}  // namespace reflective_supervisor_test
