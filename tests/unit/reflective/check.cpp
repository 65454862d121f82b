#include "ocm/reflective/check.hpp"

#include <algorithm>
#include <functional>
#include <limits>
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
static_assert(fits(guard::tables, Room{6, 3, 3, 1, 1, 0}));  // nothing to spare

// One whose bus is judged by what no configuration streams: the compiler refuses to look behind the last one.
constexpr std::array<Condition, 6> with_gyro = [] {
  auto conditions = guard::conditions;
  conditions[guard::bad_bus] = {.name = "gyro", .topic = topic_index(amiro::catalogue, "gyro"), .limit = 1};
  return conditions;
}();
constexpr Operator unseen() {
  Operator op = guard::tables;
  op.conditions = with_gyro;
  return op;
}
static_assert(first_mistake(unseen()).kind == Mistake::not_watched);

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
  // The catalogue's.
  std::vector<protocol::Topic> topics{amiro::catalogue.topics.begin(), amiro::catalogue.topics.end()};
  std::vector<protocol::FrameLayout> frames;
  std::vector<protocol::Field> fields;
  protocol::Catalogue catalogue = amiro::catalogue;

  /// A field to be spoilt, of one topic.
  protocol::Field& field_of(std::uint16_t topic, std::size_t frame = 0, std::size_t index = 0) {
    frames.assign(topics[topic].frames.begin(), topics[topic].frames.end());
    fields.assign(frames[frame].fields.begin(), frames[frame].fields.end());
    frames[frame].fields = fields;
    topics[topic].frames = frames;
    return fields[index];
  }
  /// In which it is a message that is only sent.
  void be_message(std::uint16_t topic) { topics[topic].kind = protocol::Kind::message; }

  std::vector<Finding> findings() {
    catalogue.topics = topics;
    if (op.catalogue != nullptr && op.catalogue == guard::tables.catalogue) op.catalogue = &catalogue;
    if (!entry.empty()) entry[0].raw = raw;
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

// A finding without an index is of the first one.
static_assert(Finding{}.where == 0 && Finding{}.other == 0);

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

/// What is spoilt, and the only thing that is said then; or nothing.
struct Spoilt {
  const char* what;
  std::function<void(Tables&)> spoil;
  Finding said{};
};
void judge(const std::vector<Spoilt>& table) {
  for (const Spoilt& each : table) {
    Tables t;
    each.spoil(t);
    const auto all = t.findings();
    CAPTURE(each.what, all.size());
    const bool fine = each.said.kind == Mistake::no_mistake;
    REQUIRE(all.size() == (fine ? 0U : 1U));
    if (fine) continue;
    CHECK(describe(all[0].kind) == describe(each.said.kind));
    CHECK(all[0].part == each.said.part);
    CHECK(all[0].configuration == each.said.configuration);
    CHECK(all[0].where == each.said.where);
    CHECK(all[0].other == each.said.other);
  }
}

TEST_CASE("check: times and names, and where what is wrong stands") {
  const Finding bad_time{.kind = Mistake::bad_time};
  judge({
      {"the shortest time to settle", [](Tables& t) { t.op.settle = 1ns; }},
      {"none", [](Tables& t) { t.op.settle = 0ns; }, bad_time},
      {"no retry", [](Tables& t) { t.op.retry = 0ns; }},
      {"a retry before", [](Tables& t) { t.op.retry = -1ns; }, bad_time},
      {"no reaction", [](Tables& t) { t.op.reaction = 0ns; }},
      {"a reaction before", [](Tables& t) { t.op.reaction = -1ns; }, bad_time},
      {"no handling", [](Tables& t) { t.op.handling = 0ns; }},
      {"a handling before", [](Tables& t) { t.op.handling = -1ns; }, bad_time},
      {"initial", [](Tables& t) { t.op.initial = 3; }, {.kind = Mistake::no_configuration}},
      {"names of configurations",
       [](Tables& t) { t.configurations[2].name = "idle"; },
       {.kind = Mistake::name_twice, .part = Part::configuration, .where = 2, .other = 0}},
      {"names of conditions",
       [](Tables& t) { t.conditions[4].name = t.conditions[1].name; },
       {.kind = Mistake::name_twice, .part = Part::condition, .where = 4, .other = 1}},
      {"names of monitors",
       [](Tables& t) { t.monitors[2].name = t.monitors[0].name; },
       {.kind = Mistake::name_twice, .part = Part::monitor, .where = 2, .other = 0}},
      {"two without a name", [](Tables& t) { t.conditions[4].name = t.conditions[1].name = ""; }},
      // What needs sound tables is looked at only if they are: nothing leads to a fourth configuration.
      {"what is looked at later",
       [](Tables& t) {
         t.op.settle = 0ns;
         t.configurations.push_back({"alone", {}, {}, {}, {}});
       },
       bad_time},
  });
}

TEST_CASE("check: from 1 to 64 configurations, in a row in which the last way is found first") {
  std::vector<Configuration> configurations(64);
  std::vector<Transition> transitions;
  for (std::uint16_t c = 63; c > 0; --c) transitions.push_back({"on", static_cast<std::uint16_t>(c - 1), c});
  transitions.push_back({"round", 63, 0});
  const auto said = [&](std::size_t count) {
    Operator op = guard::tables;
    op.fall_back = op.initial = 0;
    op.conditions = {};
    op.monitors = {};
    op.configurations = std::span{configurations}.first(std::min<std::size_t>(count, configurations.size()));
    op.transitions = count >= 64 ? std::span<const Transition>{transitions} : std::span<const Transition>{};
    std::vector<Mistake> all;
    check(op, [&](const Finding& finding) { all.push_back(finding.kind); });
    return all;
  };
  CHECK(said(64).empty());
  CHECK(said(1).empty());
  CHECK(said(0) == std::vector{Mistake::no_configuration});
  configurations.resize(65);
  CHECK(said(65) == std::vector{Mistake::no_configuration});
}

TEST_CASE("check: streams, limits and set points, at their ends") {
  static constexpr std::array<std::int64_t, 1> ahead{50'000};
  const auto& motor = amiro::catalogue.topics[guard::motors].frames[0].fields[0];
  const auto in_driving = [](Mistake kind, Part part, std::size_t where) {
    return Finding{.kind = kind, .part = part, .configuration = guard::driving, .where = where};
  };
  const auto outside = in_driving(Mistake::limit_outside_spec, Part::limit, 0);
  const auto bad_period = in_driving(Mistake::bad_period, Part::stream, 2);
  const auto set = [](Tables& t, std::int64_t value) {
    t.limits.clear();
    t.raw = {value};
  };
  judge({
      {"a stream of no period", [](Tables& t) { t.streams[2].period = 0ns; }, bad_period},
      {"of one that is negative", [](Tables& t) { t.streams[2].period = -1ms; }, bad_period},
      {"a topic behind the last",
       [](Tables& t) { t.streams[2].topic = static_cast<std::uint16_t>(t.topics.size()); },
       in_driving(Mistake::no_such_topic, Part::stream, 2)},
      // A plain message is not asked for, so that any period is one.
      {"a message",
       [](Tables& t) {
         t.be_message(guard::odometry);
         t.streams[1].period = 1500ns;
       }},
      {"a message of no period",
       [](Tables& t) {
         t.be_message(guard::odometry);
         t.streams[1].period = 0ns;
       },
       in_driving(Mistake::bad_period, Part::stream, 1)},

      {"all that the field has",
       [&](Tables& t) { t.limits[0].min = motor.raw_min, t.limits[0].max = motor.raw_max; }},
      {"less", [&](Tables& t) { t.limits[0].min = motor.raw_min - 1; }, outside},
      {"more", [&](Tables& t) { t.limits[0].max = motor.raw_max + 1; }, outside},
      {"one value", [](Tables& t) { t.limits[0].min = t.limits[0].max = 0; }},
      {"at once", [](Tables& t) { t.limits[0].per_second = 0; }},
      {"slower than not at all", [](Tables& t) { t.limits[0].per_second = -1; }, outside},
      {"of no topic", [](Tables& t) { t.limits[0].topic = static_cast<std::uint16_t>(t.topics.size()); },
       in_driving(Mistake::no_such_topic, Part::limit, 0)},
      {"of a float", [](Tables& t) { t.field_of(guard::motors).number = protocol::Number::float32; },
       in_driving(Mistake::no_such_field, Part::limit, 0)},
      {"the second one",
       [](Tables& t) {
         t.entry.clear();
         t.limits.push_back({guard::motors, 1, 2, 1, 0});
       },
       in_driving(Mistake::limit_outside_spec, Part::limit, 1)},

      {"a set point of no topic",
       [](Tables& t) { t.entry[0].topic = static_cast<std::uint16_t>(t.topics.size()); },
       in_driving(Mistake::no_such_topic, Part::entry, 0)},
      {"repeated before", [](Tables& t) { t.entry[0].repeat = -1ns; },
       in_driving(Mistake::bad_time, Part::entry, 0)},
      {"the least", [&](Tables& t) { set(t, motor.raw_min); }},
      {"the most", [&](Tables& t) { set(t, motor.raw_max); }},
      {"less than the least", [&](Tables& t) { set(t, motor.raw_min - 1); },
       in_driving(Mistake::set_point_outside_spec, Part::entry, 0)},
      {"more than the most", [&](Tables& t) { set(t, motor.raw_max + 1); },
       in_driving(Mistake::set_point_outside_spec, Part::entry, 0)},
      {"any float",
       [&](Tables& t) {
         set(t, motor.raw_max + 1);
         t.field_of(guard::motors).number = protocol::Number::float32;
       }},
      {"a value that is not given is 0, which is beyond the limit",
       [](Tables& t) {
         t.raw = {};
         t.limits[0].min = 1;
       },
       in_driving(Mistake::set_point_beyond_limit, Part::entry, 0)},
      {"beyond the second limit",
       [](Tables& t) {
         t.limits.push_back({guard::motors, 1, 1, 2, 0});
       },
       in_driving(Mistake::set_point_beyond_limit, Part::entry, 0)},
      {"the second set point",
       [](Tables& t) {
         t.limits[0].max = 49'999;
         t.entry.push_back({guard::motors, ahead});
       },
       in_driving(Mistake::set_point_beyond_limit, Part::entry, 1)},
  });
}

TEST_CASE("check: adaptations, at their ends") {
  static constexpr Finding bad{
      .kind = Mistake::bad_adaptation, .part = Part::adaptation, .configuration = guard::driving, .where = 0};
  // Of a stream: its own period, the shortest one and the longest.
  const auto follows = [](std::uint16_t stream, base::Duration shortest, base::Duration longest,
                          base::Duration grain) {
    return Adaptation{.stream = stream,
                      .topic = guard::odometry,
                      .from = 0,
                      .to = 1,
                      .at_from = longest,
                      .at_to = shortest,
                      .grain = grain};
  };
  struct Bounds {
    base::Duration own, shortest, longest, grain;
    bool fine;
  };
  const auto second = std::chrono::seconds{1};
  for (const Bounds& each : std::initializer_list<Bounds>{
           {50ms, 50ms, 60ms, 1ms, true},
           {60ms, 50ms, 60ms, 1ms, true},
           {49ms, 50ms, 60ms, 1ms, false},
           {61ms, 50ms, 60ms, 1ms, false},
           {1ms, 0ms, 60ms, 1ms, false},
           {50ms, 50ms, 50ms, 1ms, true},
           {50ms, 50ms, 60ms, 0ms, false},
           {50ms, 50ms, 60ms, 11ms, false},
           // What a request can carry: 65'535 us, ms or s, each in whole ones.
           {60ms, 60ms, 65'535us, 1us, true},
           {60ms, 60ms, 65'536us, 1us, false},
           {60ms, 60ms, 65'535ms, 1ms, true},
           {60ms, 60ms, 65'536ms, 1ms, false},
           {second, second, 65'535s, second, true},
           {second, second, 65'536s, second, false},
           {second, 500ms, 65'600'500ms, second, false},
           {65'001us, 65'000'500ns, 65'010'500ns, 1us, false},
       }) {
    Tables t;
    t.streams[1].period = each.own;
    t.adaptations = {follows(1, each.shortest, each.longest, each.grain)};
    // The first mistake that it is looked at for: `every` is a grain at least.
    t.adaptations[0].every = std::max<base::Duration>(each.grain, 1s);
    CAPTURE(each.own.count(), each.shortest.count(), each.longest.count(), each.grain.count());
    CHECK(t.findings().empty() == each.fine);
    if (!each.fine) CHECK(t.only() == Mistake::bad_adaptation);
  }
  const auto with = [&](const std::function<void(Tables&)>& spoil) {
    return [&follows, spoil](Tables& t) {
      t.adaptations = {follows(0, 50ms, 100ms, 1ms)};
      spoil(t);
    };
  };
  judge({
      {"as it is", with([](Tables&) {})},
      {"in no range", with([](Tables& t) { t.adaptations[0].to = 0; }), bad},
      {"in one that is turned round", with([](Tables& t) { t.adaptations[0].to = -1; }), bad},
      {"every grain", with([](Tables& t) { t.adaptations[0].every = 1ms; })},
      {"more often", with([](Tables& t) { t.adaptations[0].every = 999'999ns; }), bad},
      {"of a message", with([](Tables& t) { t.be_message(guard::ring); }), bad},
      {"of a field behind the last", with([](Tables& t) {
         t.adaptations[0].field =
             static_cast<std::uint16_t>(amiro::catalogue.topics[guard::odometry].frames[0].fields.size());
       }),
       bad},
      {"of a topic behind the last",
       with([](Tables& t) { t.adaptations[0].topic = static_cast<std::uint16_t>(t.topics.size()); }), bad},
      {"two streams", with([&](Tables& t) { t.adaptations.push_back(follows(1, 100ms, 100ms, 1ms)); })},
      {"the second one",
       with([&](Tables& t) { t.adaptations.push_back(follows(1, 101ms, 102ms, 1ms)); }),
       {.kind = bad.kind, .part = bad.part, .configuration = bad.configuration, .where = 1}},
  });
  Tables unknown;  // the stream's topic is said to be unknown, and its adaptation is looked at all the same
  unknown.adaptations = {follows(1, 100ms, 100ms, 1ms)};
  unknown.streams[1].topic = static_cast<std::uint16_t>(unknown.topics.size());
  const auto both = unknown.findings();
  REQUIRE(both.size() == 2);
  CHECK((both[0].kind == Mistake::no_such_topic && both[1].kind == Mistake::bad_adaptation));
}

TEST_CASE("check: what each kind of condition compares with, at its ends") {
  constexpr std::int64_t least = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
  const auto nowhere = static_cast<std::uint16_t>(amiro::catalogue.topics.size());
  const auto frames = static_cast<std::uint16_t>(amiro::catalogue.topics[guard::ring].frames.size());
  const auto fields =
      static_cast<std::uint16_t>(amiro::catalogue.topics[guard::odometry].frames[0].fields.size());
  const auto ring = guard::ring;
  struct Case {
    Condition condition;
    Mistake said = Mistake::no_mistake;
  };
  using enum Watched;
  const Mistake bad = Mistake::bad_condition;
  const Case cases[] = {
      {{.watched = field, .topic = ring, .limit = most}},
      {{.watched = field, .topic = ring, .limit = least}},
      {{.watched = field, .topic = ring, .limit = most - 1, .hysteresis = 1}},
      {{.watched = field, .topic = ring, .limit = most, .hysteresis = 1}, bad},
      {{.watched = field, .topic = ring, .limit = least, .hysteresis = 1}, bad},
      {{.watched = field, .topic = ring, .hysteresis = -1}, bad},
      {{.watched = field, .topic = nowhere}, Mistake::no_such_topic},
      {{.watched = field, .topic = guard::motors}, Mistake::not_a_stream},
      {{.watched = field, .topic = ring, .frame = frames}, Mistake::no_such_field},
      {{.watched = field, .topic = ring, .frame = static_cast<std::uint16_t>(frames - 1)}},
      {{.watched = field, .topic = guard::odometry, .field = fields}, Mistake::no_such_field},
      {{.watched = field, .topic = guard::odometry, .field = static_cast<std::uint16_t>(fields - 1)}},
      {{.watched = age, .topic = ring, .limit = 1}},
      {{.watched = age, .topic = ring, .limit = 0}, bad},
      {{.watched = age, .topic = ring, .limit = 2, .hysteresis = 1}, bad},
      {{.watched = age, .is = Is::below, .topic = ring, .limit = 1}, bad},
      {{.watched = age, .topic = nowhere, .limit = 1}, Mistake::no_such_topic},
      {{.watched = gap, .topic = ring, .limit = 1}},
      {{.watched = gap, .topic = ring, .limit = 0}, bad},
      {{.watched = gap, .topic = ring, .limit = 2, .hysteresis = 1}, bad},
      {{.watched = gap, .is = Is::equal, .topic = ring, .limit = 1}, bad},
      {{.watched = gap, .topic = nowhere, .limit = 1}, Mistake::no_such_topic},
      {{.watched = rate, .topic = ring, .window = 1ns}},
      {{.watched = rate, .is = Is::below, .topic = ring, .window = 1ns}},
      {{.watched = rate, .is = Is::equal, .topic = ring, .window = 1ns}, bad},
      {{.watched = rate, .topic = ring, .window = 0ns}, bad},
      {{.watched = rate, .topic = nowhere, .window = 1ns}, Mistake::no_such_topic},
      {{.watched = bus_load, .window = 1ns}},
      {{.watched = bus_load, .is = Is::below, .window = 1ns}},
      {{.watched = bus_load, .is = Is::other, .window = 1ns}, bad},
      {{.watched = bus_load, .window = 0ns}, bad},
      {{.watched = refusals}},
      {{.watched = refusals, .is = Is::below}, bad},
      {{.watched = bus_state, .is = Is::equal}},
      {{.watched = bus_state, .is = Is::other}},
      {{.watched = bus_state, .is = Is::below}},
      {{.watched = bus_state, .is = Is::any_bit}, bad},
  };
  for (std::size_t i = 0; i < std::size(cases); ++i) {
    Tables t;
    t.conditions.push_back(cases[i].condition);
    const auto all = t.findings();
    CAPTURE(i, name(cases[i].condition.watched), all.size());
    if (cases[i].said == Mistake::no_mistake) {
      CHECK(all.empty());
      continue;
    }
    REQUIRE(all.size() == 1);
    CHECK(describe(all[0].kind) == describe(cases[i].said));
    CHECK((all[0].part == Part::condition && all[0].where == guard::conditions.size()));
  }
}

TEST_CASE("check: and, or and not look at no topic") {
  // The first of all conditions is of the ring, which idle does not stream; that of the bus is of no topic.
  constexpr std::array<Term, 2> inverted{{{.condition = guard::bad_bus}, {.op = Op::negation}}};
  constexpr std::array<Term, 3> either{
      {{.condition = guard::bad_bus}, {.condition = guard::bad_bus}, {.op = Op::any}}};
  constexpr std::array<Term, 1> near{{{.condition = guard::near}}};
  CHECK(sees(guard::tables, guard::idle, {{}, inverted, {}}));
  CHECK(sees(guard::tables, guard::idle, {{}, either, {}}));
  CHECK_FALSE(sees(guard::tables, guard::idle, {{}, near, {}}));
}

TEST_CASE("check: monitors and transitions, and where they stand") {
  judge({
      {"as long as nothing", [](Tables& t) { t.monitors[1].lasting = 0ns; }},
      {"less",
       [](Tables& t) { t.monitors[1].lasting = -1ns; },
       {.kind = Mistake::bad_expression, .part = Part::monitor, .where = 1}},
      {"of a condition that is not there",
       [](Tables& t) { t.terms[3].condition = static_cast<std::uint16_t>(t.conditions.size()); },
       {.kind = Mistake::bad_expression, .part = Part::monitor, .where = 0}},
      {"which transition",
       [](Tables& t) { t.transitions[4].to = 3; },
       {.kind = Mistake::bad_transition, .part = Part::transition, .where = 4}},
      // From any configuration: one in which it sees what it needs is enough, none is not.
      {"seen in one", [](Tables& t) { t.transitions[0].from = any_configuration; }},
      {"seen in none",
       [](Tables& t) {
         t.conditions[guard::bad_bus] = {
             .name = "gyro", .topic = topic_index(amiro::catalogue, "gyro"), .limit = 1};
       },
       {.kind = Mistake::not_watched, .part = Part::transition, .configuration = none, .where = 2}},
      {"at once, from anywhere that both leave",
       [](Tables& t) {
         t.transitions[2].precedence = 1;
         t.transitions.push_back({"bus", any_configuration, guard::idle, 2, 1});
       },
       {.kind = Mistake::both_fire,
        .part = Part::transition,
        .configuration = guard::driving,
        .where = 2,
        .other = 6}},
      {"at once, and where",
       [](Tables& t) {
         t.transitions[2] = {"bus", guard::driving, guard::idle, 2};
       },
       {.kind = Mistake::both_fire,
        .part = Part::transition,
        .configuration = guard::driving,
        .where = 0,
        .other = 2}},
  });
}

TEST_CASE("check: the streams of all other configurations are stopped at the start, messages are not") {
  const std::array<Stream, 3> three{{{0, 50ms}, {1, 50ms}, {2, 50ms}}};
  const std::array<Stream, 2> again{{{2, 100ms}, {3, 50ms}}};
  const std::array<Adaptation, 1> adaptation{{{.stream = 0}}};
  std::vector<Configuration> configurations{
      {"none", {}, {}, {}, {}}, {"three", three, {}, {}, {}}, {"two", again, {}, {}, {}}};
  std::vector<protocol::Topic> topics(4);
  protocol::Catalogue catalogue{"four", 1'000'000, {}, topics};
  Operator op;
  op.catalogue = &catalogue;
  op.configurations = configurations;
  CHECK(fits(op, Room{.streams = 4}));
  CHECK_FALSE(fits(op, Room{.streams = 3}));
  topics[3].kind = protocol::Kind::message;
  CHECK(fits(op, Room{.streams = 3}));
  topics[3].kind = protocol::Kind::sensor;
  op.initial = 1;  // one other is elsewhere
  CHECK(fits(op, Room{.streams = 3}));
  op.initial = 3;  // a mistake, of which this says nothing
  CHECK(fits(op, Room{.streams = 3}));
  configurations[2].adaptations = adaptation;
  CHECK(fits(op, Room{.streams = 3, .adaptations = 1}));
  CHECK_FALSE(fits(op, Room{.streams = 3, .adaptations = 0}));
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

/// Whether two conditions, each the only one of its monitor, can be true at once; the second one inverted.
bool together(const Operator& op, const Condition& a, const Condition& b, bool inverted = false) {
  const std::array<Condition, 2> conditions{a, b};
  const std::array<Term, 3> terms{{{.condition = 0}, {.condition = 1}, {.op = Op::negation}}};
  Operator changed = op;
  changed.conditions = conditions;
  return reflective::detail::both_can_be_true(changed, {{}, std::span{terms}.first(1), {}},
                                              {{}, std::span{terms}.subspan(1, inverted ? 2 : 1), {}});
}

TEST_CASE("check: what is known of one value says nothing of another") {
  const Operator& op = guard::tables;
  using enum Watched;
  const auto over = [](Condition c) { return c.is = Is::above, c.limit = 5, c; };
  const auto under = [](Condition c) { return c.is = Is::below, c.limit = 3, c; };
  const auto excluded = [&](const Condition& a, const Condition& b) {
    return !together(op, over(a), under(b)) && !together(op, under(a), over(b));
  };
  const Condition here{.topic = guard::ring, .frame = 1};
  CHECK(excluded(here, here));
  CHECK_FALSE(excluded(here, {.topic = guard::ring, .frame = 2}));
  CHECK_FALSE(excluded(here, {.topic = guard::odometry, .frame = 1}));
  CHECK_FALSE(excluded({.topic = guard::odometry}, {.topic = guard::odometry, .field = 1}));
  CHECK_FALSE(excluded(here, {.watched = rate, .topic = guard::ring, .frame = 1, .window = 1s}));
  const Condition rated{.watched = rate, .topic = guard::ring, .window = 1s};
  CHECK(excluded(rated, rated));
  CHECK_FALSE(excluded(rated, {.watched = rate, .topic = guard::ring, .window = 2s}));
  CHECK_FALSE(excluded(rated, {.watched = rate, .topic = guard::power, .window = 1s}));
  CHECK(excluded({.watched = bus_load, .window = 1s}, {.watched = bus_load, .window = 1s}));
  CHECK(excluded({.watched = bus_state}, {.watched = bus_state}));
  CHECK_FALSE(excluded({.watched = bus_state}, {.watched = bus_load, .window = 1s}));
  // Of ages only what is not above can be below.
  for (const Watched timed : {age, gap}) {
    const Condition old{.watched = timed, .topic = guard::ring, .limit = 5};
    const auto younger = [&](std::int64_t limit) {
      Condition c = old;
      return c.limit = limit, c;
    };
    CHECK_FALSE(together(op, old, younger(5), true));
    CHECK_FALSE(together(op, old, younger(4), true));
    CHECK(together(op, old, younger(6), true));  // 5
    CHECK(together(op, old, younger(6)));
    Condition other = younger(4);
    other.topic = guard::power;
    CHECK(together(op, old, other, true));
    other = younger(4);
    other.watched = timed == age ? gap : age;
    CHECK(together(op, old, other, true));
  }
}

TEST_CASE("check: an age or a gap is true from its limit on, up to the last one that there is") {
  for (const Watched timed : {Watched::age, Watched::gap}) {
    const Condition longest{
        .watched = timed, .topic = guard::ring, .limit = std::numeric_limits<std::int64_t>::max()};
    CHECK(together(guard::tables, longest, longest));
    CHECK_FALSE(together(guard::tables, longest, longest, true));
  }
}

TEST_CASE("check: raw numbers of floats and of 64 bits without sign are in no order") {
  Tables t;
  protocol::Field& field = t.field_of(guard::ring);
  t.catalogue.topics = t.topics;
  t.op.catalogue = &t.catalogue;
  const Condition over{.topic = guard::ring, .limit = 5},
      same{.is = Is::equal, .topic = guard::ring, .limit = 3},
      under{.is = Is::below, .topic = guard::ring, .limit = 3};
  struct Case {
    protocol::Number number;
    std::uint8_t width;
    bool is_signed, ordered;
  };
  using enum protocol::Number;
  for (const Case& each :
       {Case{integer, 63, false, true}, Case{integer, 64, false, false}, Case{integer, 64, true, true},
        Case{float32, 32, true, false}, Case{float64, 64, true, false}}) {
    field.number = each.number;
    field.position.width = each.width;
    field.is_signed = each.is_signed;
    CAPTURE(static_cast<int>(each.number), int{each.width}, each.is_signed);
    CHECK_FALSE(together(t.op, over, under));  // both are of the ordered one
    CHECK_FALSE(together(t.op, under, over));
    CHECK(together(t.op, over, same) != each.ordered);
    CHECK(together(t.op, same, over) != each.ordered);
  }
}

TEST_CASE("check: of more than 12 conditions nothing is known") {
  std::vector<Condition> conditions;
  std::vector<Term> terms;
  for (std::uint16_t c = 0; c < 13; ++c) {
    conditions.push_back(
        {.topic = guard::ring, .frame = c == 0 ? std::uint16_t{1} : std::uint16_t{2}, .limit = c});
    terms.push_back({.condition = c});
    if (c > 0) terms.push_back({.op = Op::all});
  }
  // The last one is of the first one's value, and excludes it.
  const auto possible = [&](std::size_t count) {
    std::vector<Condition> changed{conditions.begin(),
                                   conditions.begin() + static_cast<std::ptrdiff_t>(count)};
    changed.push_back({.is = Is::below, .topic = guard::ring, .frame = 1});
    const std::array<Term, 1> last{{{.condition = static_cast<std::uint16_t>(count)}}};
    Operator op = guard::tables;
    op.conditions = changed;
    return reflective::detail::both_can_be_true(op, {{}, std::span{terms}.first(2 * count - 1), {}},
                                                {{}, last, {}});
  };
  CHECK_FALSE(possible(1));
  CHECK_FALSE(possible(11));
  CHECK(possible(12));
}

TEST_CASE("check: what of one value can be true at once, with hysteresis and at the ends of all numbers") {
  constexpr std::int64_t least = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
  std::mt19937 engine{6};
  const auto below = [&engine](unsigned n) { return static_cast<std::int64_t>(engine() % n); };
  int possible = 0;
  const int runs = explored(4000);
  for (int run = 0; run < runs; ++run) {
    const std::int64_t from = run % 3 == 0 ? 0 : run % 3 == 1 ? least : most - 11;
    const bool timed = from == 0 && run % 2 == 0;
    std::vector<Condition> conditions;
    std::vector<bool> wanted;
    std::vector<Term> terms;
    bool one_exclusion = false;  // with two it may not see that a range is used up
    bool beyond = false;  // more than the most, or less than the least: it does not see that this is nothing
    for (std::uint16_t i = 0; i < 3; ++i) {
      Condition c{.name = "c", .topic = guard::ring, .limit = from + below(12)};
      wanted.push_back(below(2) == 0);
      if (timed) {
        c.watched = Watched::age;
      } else {
        c.is = static_cast<Is>(below(one_exclusion ? 2 : 4));
        one_exclusion = one_exclusion || c.is == Is::equal || c.is == Is::other;
        if (c.is == Is::above || c.is == Is::below)
          c.hysteresis =
              std::min({below(4), most - std::max(c.limit, most - 9), std::min(c.limit, least + 9) - least});
      }
      beyond = beyond || (wanted[i] && c.hysteresis == 0 && c.limit == (c.is == Is::above ? most : least));
      conditions.push_back(c);
      terms.push_back({.condition = i});
      if (!wanted[i]) terms.push_back({.op = Op::negation});
      if (i == 1) terms.push_back({.op = Op::all});
    }
    const std::size_t first = terms.size() - (wanted[2] ? 1 : 2);
    Operator op = guard::tables;
    op.conditions = conditions;
    // A condition is true from its limit on, with what came before up to its hysteresis beyond it.
    const auto allows = [](const Condition& c, bool value, std::int64_t raw) {
      return reflective::holds(c, raw, false) == value || reflective::holds(c, raw, true) == value;
    };
    bool found = false;
    for (std::int64_t i = from == least ? 0 : -20; i <= (from > 0 ? 11 : 32) && !found; ++i) {
      found = true;
      for (std::size_t c = 0; c < 3; ++c) found = found && allows(conditions[c], wanted[c], from + i);
    }
    CAPTURE(run, from, timed, found);
    const bool said = reflective::detail::both_can_be_true(op, {{}, std::span{terms}.first(first), {}},
                                                           {{}, std::span{terms}.subspan(first), {}});
    if (found) REQUIRE(said);
    if (!beyond) REQUIRE(said == found);
    possible += found ? 1 : 0;
  }
  CHECK(possible > runs / 5);
  CHECK(possible < runs - runs / 5);
  const Condition middle{.is = Is::equal, .topic = guard::ring, .limit = 3};
  CHECK_FALSE(together(guard::tables, {.is = Is::above, .topic = guard::ring, .limit = most}, middle));
  CHECK_FALSE(together(guard::tables, {.is = Is::below, .topic = guard::ring, .limit = least}, middle));
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
