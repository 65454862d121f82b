#include "ocm/reflective/check.hpp"

#include <algorithm>
#include <random>
#include <span>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/base/explore.hpp"
#include "unit/reflective/guard.hpp"

namespace reflective_check_test {

using namespace ocm;
using namespace ocm::reflective;
using namespace ocm::test;
using namespace std::chrono_literals;

// The table of an operator that is compiled in.
static_assert(first_mistake(guard::tables).kind == Mistake::no_mistake);
static_assert(fits(guard::tables, Room{}));
static_assert(!fits(guard::tables, Room{.conditions = 5}));
static_assert(!fits(guard::tables, Room{.monitors = 2}));
static_assert(!fits(guard::tables, Room{.streams = 2}));
static_assert(!fits(guard::tables, Room{.entry = 0}));
static_assert(!fits(guard::tables, Room{.limits = 0}));

/// The guard's tables, to be spoilt.
struct Tables {
  std::vector<Stream> streams{guard::driving_streams.begin(), guard::driving_streams.end()};
  std::vector<Limit> limits{guard::slow.begin(), guard::slow.end()};
  std::vector<std::int64_t> raw{0, 0};
  std::vector<SetPoint> entry{{guard::motors, {}}};
  std::vector<Adaptation> adaptations{};
  std::vector<Configuration> configurations{guard::configurations.begin(), guard::configurations.end()};
  std::vector<Condition> conditions{guard::conditions.begin(), guard::conditions.end()};
  std::vector<Term> terms{guard::near_or_silent.begin(), guard::near_or_silent.end()};
  std::vector<Monitor> monitors{guard::monitors.begin(), guard::monitors.end()};
  std::vector<Transition> transitions{guard::transitions.begin(), guard::transitions.end()};
  Operator op = guard::tables;

  std::vector<Finding> findings() {
    entry[0].raw = raw;
    auto& driving = configurations[guard::driving];
    driving.streams = streams;
    driving.limits = limits;
    driving.entry = entry;
    driving.adaptations = adaptations;
    monitors[0].terms = terms;
    op.configurations = configurations;
    op.conditions = conditions;
    op.monitors = monitors;
    op.transitions = transitions;
    std::vector<Finding> all;
    check(op, [&](const Finding& finding) { all.push_back(finding); });
    return all;
  }
  /// The only mistake.
  Mistake only() {
    const auto all = findings();
    REQUIRE(all.size() == 1);
    CHECK(first_mistake(op).kind == all[0].kind);
    CHECK_FALSE(describe(all[0].kind).empty());
    return all[0].kind;
  }
};

TEST_CASE("check: the guard is without mistakes") {
  CHECK(Tables{}.findings().empty());
}

TEST_CASE("check: what is wrong with a configuration") {
  Tables t;
  SECTION("no catalogue") {
    t.op.catalogue = nullptr;
    CHECK(t.only() == Mistake::no_catalogue);
  }
  SECTION("fall-back") {
    t.op.fall_back = 3;
    CHECK(t.only() == Mistake::no_configuration);
  }
  SECTION("settle") {
    t.op.settle = 0ms;
    CHECK(t.only() == Mistake::bad_time);
  }
  SECTION("names") {
    t.configurations[1].name = "idle";
    CHECK(t.only() == Mistake::name_twice);
  }
  SECTION("stream of a topic that is not there") {
    t.streams[1].topic = 999;
    CHECK(t.only() == Mistake::no_such_topic);
  }
  SECTION("stream of an actuator") {
    t.streams[1].topic = guard::motors;
    CHECK(t.only() == Mistake::not_a_stream);
  }
  SECTION("stream twice") {
    t.streams.push_back({guard::power, 500ms});
    CHECK(t.only() == Mistake::stream_twice);
  }
  SECTION("period") {
    t.streams[1].period = 1500ns;
    CHECK(t.only() == Mistake::bad_period);
  }
  SECTION("limit outside the spec") {
    t.limits[0].max = INT64_MAX;
    CHECK(t.only() == Mistake::limit_outside_spec);
  }
  SECTION("limit that nothing is within") {
    t.limits[0] = {guard::motors, 0, 1, -1, 0};
    const auto all = t.findings();
    REQUIRE_FALSE(all.empty());
    CHECK(all[0].kind == Mistake::limit_outside_spec);
    CHECK((all[0].part == Part::limit && all[0].configuration == guard::driving && all[0].where == 0));
  }
  SECTION("limit of a sensor") {
    t.limits[0].topic = guard::ring;
    CHECK(t.only() == Mistake::not_an_actuator);
  }
  SECTION("limit of no field") {
    t.limits[0].field = 2;
    CHECK(t.only() == Mistake::no_such_field);
  }
  SECTION("set point outside the spec") {
    t.limits.clear();
    t.raw[1] = INT64_MAX;
    CHECK(t.only() == Mistake::set_point_outside_spec);
  }
  SECTION("set point at its limit, and beyond it") {
    for (const std::int64_t fine : {-100'000, 100'000}) {
      t.raw[0] = fine;
      CHECK(t.findings().empty());
    }
    t.raw[0] = 100'001;
    CHECK(t.only() == Mistake::set_point_beyond_limit);
    t.raw[0] = -100'001;
    CHECK(t.only() == Mistake::set_point_beyond_limit);
  }
  SECTION("the limit of another actuator") {
    static constexpr std::array<std::int64_t, 1> red{255};
    t.entry.push_back({topic_index(amiro::catalogue, "led_1"), red});
    t.limits[0] = {guard::motors, 0, -100, 100, 0};
    CHECK(t.findings().empty());
  }
  SECTION("set point with too many values") {
    t.raw.push_back(0);
    CHECK(t.only() == Mistake::no_such_field);
  }
  SECTION("set point of a sensor") {
    t.entry[0].topic = guard::ring;
    CHECK(t.only() == Mistake::not_an_actuator);
  }
}

TEST_CASE("check: adaptations") {
  Tables t;
  t.adaptations = {
      {.stream = 0, .topic = guard::odometry, .from = 0, .to = 10, .at_from = 100ms, .at_to = 50ms}};
  CHECK(t.findings().empty());
  Adaptation& a = t.adaptations[0];
  a.at_from = 95ms, a.grain = 15ms;  // three grains, of which neither end is a whole number
  CHECK(t.findings().empty());
  a.at_from = 100ms, a.grain = Adaptation{}.grain;
  SECTION("no stream") {
    a.stream = 3;
  }
  SECTION("no field") {
    a.field = 99;
  }
  SECTION("no width") {
    a.to = 0;
  }
  SECTION("the stream's own period is outside") {
    a.at_to = 60ms;
  }
  SECTION("not in grains") {
    a.grain = 7ms;
  }
  SECTION("not on the wire") {
    a.grain = 500ns;
    a.every = 1s;
  }
  SECTION("too often") {
    a.every = 1us;
  }
  SECTION("twice") {
    t.adaptations.push_back(a);
  }
  CHECK(t.only() == Mistake::bad_adaptation);
}

TEST_CASE("check: conditions, expressions, transitions") {
  Tables t;
  SECTION("an age below") {
    t.conditions[guard::silent].is = Is::below;
    CHECK(t.only() == Mistake::bad_condition);
  }
  SECTION("a rate without window") {
    t.conditions[guard::silent] = {.name = "r", .watched = Watched::rate, .topic = guard::ring};
    CHECK(t.only() == Mistake::bad_condition);
  }
  SECTION("hysteresis that overflows") {
    t.conditions[guard::near].limit = INT64_MIN;
    CHECK(t.only() == Mistake::bad_condition);
  }
  SECTION("a field that is not there") {
    t.conditions[guard::near].frame = 8;
    CHECK(t.only() == Mistake::no_such_field);
  }
  SECTION("a field that only some frames have") {
    const Condition& near = t.conditions[guard::near];
    const auto copy = [](const auto& span) { return std::vector(span.begin(), span.end()); };
    protocol::Catalogue catalogue = *t.op.catalogue;
    auto topics = copy(catalogue.topics);
    auto frames = copy(topics[near.topic].frames);
    auto fields = copy(frames[near.frame].fields);
    fields[near.field].selector = 1;
    frames[near.frame].fields = fields;
    topics[near.topic].frames = frames;
    catalogue.topics = topics;
    t.op.catalogue = &catalogue;
    const auto of_conditions = t.findings();  // two conditions look at it
    REQUIRE(of_conditions.size() == 2);
    CHECK(of_conditions[0].kind == Mistake::field_of_some_frames);
    CHECK(of_conditions[1].kind == Mistake::field_of_some_frames);
    t.adaptations = {{.stream = 0,
                      .topic = near.topic,
                      .frame = near.frame,
                      .field = near.field,
                      .to = 100,
                      .at_from = 100ms,
                      .at_to = 50ms}};
    const auto adaptation_is_bad = [&t] {
      const auto all = t.findings();
      return std::any_of(all.begin(), all.end(),
                         [](const Finding& f) { return f.kind == Mistake::bad_adaptation; });
    };
    CHECK(adaptation_is_bad());
    t.op.catalogue = guard::tables.catalogue;
    CHECK_FALSE(adaptation_is_bad());
  }
  SECTION("operands") {
    t.terms.pop_back();
    CHECK(t.only() == Mistake::bad_expression);
  }
  SECTION("where it comes from") {
    t.transitions[0].to = guard::driving;
    CHECK(t.only() == Mistake::bad_transition);
  }
  SECTION("from and to what is not there") {
    t.transitions[3].from = 3;
    CHECK(t.only() == Mistake::bad_transition);
    t.transitions[3].from = guard::idle;
    t.transitions[5].to = 3;
    CHECK(t.only() == Mistake::bad_transition);
  }
  SECTION("no monitor") {
    t.transitions[0].monitor = 3;
    CHECK(t.only() == Mistake::bad_transition);
  }
  SECTION("not streamed where it is needed") {
    t.transitions[1].from = guard::idle;
    t.transitions[1].precedence = 1;
    const auto all = t.findings();
    REQUIRE(all.size() == 1);
    CHECK(all[0].kind == Mistake::not_watched);
    CHECK((all[0].part == Part::transition && all[0].where == 1));
  }
}

TEST_CASE("check: ways to and from each configuration") {
  Tables t;
  t.configurations.push_back({"alone", {}, {}, {}, {}});
  SECTION("nothing leads there") {
    CHECK(t.only() == Mistake::unreachable);
  }
  SECTION("nothing leads to the fall-back") {
    t.transitions = {{"asked", guard::idle, guard::driving, by_request},
                     {"asked", guard::driving, guard::stopped, by_request},
                     {"asked", guard::idle, 3, by_request}};
    CHECK(t.only() == Mistake::no_way_to_fall_back);
    CHECK(t.findings()[0].where == 3);
  }
}

TEST_CASE("check: transitions that can fire at once") {
  Tables t;
  // From driving: to idle when the bus is bad, which it can be before an obstacle.
  t.transitions[2] = {"bus", guard::driving, guard::idle, 2};
  SECTION("of different things") {
    CHECK(t.only() == Mistake::both_fire);
    CHECK((t.findings()[0].where == 0 && t.findings()[0].other == 2));
    t.transitions[2].precedence = 1;
    CHECK(t.findings().empty());
  }
  SECTION("of one value: near and clear exclude one another, with their hysteresis") {
    t.terms = {{.condition = guard::near}};
    t.transitions[2] = {"clear", guard::driving, guard::idle, 1};
    CHECK(t.findings().empty());
    t.conditions[guard::near].hysteresis = 201;  // it still holds at 2'800, where clear begins
    CHECK(t.findings().empty());
    t.conditions[guard::near].hysteresis = 202;
    CHECK(t.only() == Mistake::both_fire);
  }
  SECTION("by not") {
    t.terms = {
        {.condition = guard::near}, {.condition = guard::bad_bus}, {.op = Op::negation}, {.op = Op::all}};
    CHECK(t.findings().empty());
  }
  SECTION("by bits") {
    t.conditions[guard::near] = {.name = "a", .is = Is::any_bit, .topic = guard::ring, .limit = 3};
    t.conditions[guard::clear] = {.name = "b", .is = Is::equal, .topic = guard::ring, .limit = 4};
    t.terms = {{.condition = guard::near}};
    t.transitions[2] = {"clear", guard::driving, guard::idle, 1};
    CHECK(t.findings().empty());
    t.conditions[guard::clear].limit = 5;
    CHECK(t.only() == Mistake::both_fire);
  }
}

/// Of a raw number, without hysteresis.
bool holds(const Condition& condition, std::int64_t raw) {
  switch (condition.is) {
    case Is::above:
      return raw > condition.limit;
    case Is::below:
      return raw < condition.limit;
    case Is::equal:
      return raw == condition.limit;
    case Is::other:
      return raw != condition.limit;
    case Is::any_bit:
      return (raw & condition.limit) != 0;
  }
  return false;
}

TEST_CASE("check: what of one value can be true at once, against every value") {
  std::mt19937 engine{4};
  const auto below = [&engine](unsigned n) { return static_cast<int>(engine() % n); };
  int exact = 0, possible = 0;
  const int runs = explored(4000);
  for (int run = 0; run < runs; ++run) {
    const bool bits_alone = run % 2 == 0;
    std::vector<Condition> conditions;
    std::vector<bool> wanted;
    std::vector<Term> terms;
    for (std::uint16_t i = 0; i < 3; ++i) {
      const Is is = bits_alone ? Is::any_bit : static_cast<Is>(below(5));
      conditions.push_back({.name = "c",
                            .is = is,
                            .topic = guard::ring,
                            .limit = is == Is::any_bit ? 1 + below(7) : below(8)});
      wanted.push_back(below(2) == 0);
      terms.push_back({.condition = i});
      if (!wanted[i]) terms.push_back({.op = Op::negation});
      if (i == 1) terms.push_back({.op = Op::all});
    }
    const std::size_t first = terms.size() - (wanted[2] ? 1 : 2);
    Monitor one = guard::monitors[0], other = guard::monitors[0];
    one.terms = std::span{terms}.first(first);
    other.terms = std::span{terms}.subspan(first);
    Operator op = guard::tables;
    op.conditions = conditions;

    bool found = false;
    for (std::int64_t raw = 0; raw < 32 && !found; ++raw) {
      found = true;
      for (std::size_t i = 0; i < 3; ++i) found = found && holds(conditions[i], raw) == wanted[i];
    }
    CAPTURE(run, conditions[0].limit, conditions[1].limit, conditions[2].limit);
    const bool said = reflective::detail::both_can_be_true(op, one, other);
    if (found) REQUIRE(said);  // else two transitions fire at once, and nothing says so
    if (bits_alone) REQUIRE(said == found);
    exact += said == found ? 1 : 0;
    possible += found ? 1 : 0;
  }
  CHECK(possible > runs / 5);
  CHECK(possible < runs - runs / 5);
  CHECK(exact > runs - runs / 10);  // what it cannot tell apart it calls possible
}

}  // namespace reflective_check_test
