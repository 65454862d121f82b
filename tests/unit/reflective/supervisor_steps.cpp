/// What a supervisor reads of samples, and what it does when, step by step: whole lists of actions, and when
/// the next step is due.
#include <bit>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/reflective/check.hpp"
#include "ocm/reflective/supervisor.hpp"

namespace reflective_supervisor_steps_test {

using namespace ocm;
using namespace ocm::reflective;
using namespace std::chrono_literals;
using Kind = Event::Kind;
using protocol::Priority;

// --- a robot whose topics have all that there is ---------------------------------------------------------------

constexpr protocol::Field field(std::uint16_t first_bit, std::uint8_t width, bool is_signed = false,
                                protocol::Number number = protocol::Number::integer) {
  protocol::Field result;
  result.position = {first_bit, width};
  result.is_signed = is_signed;
  result.number = number;
  result.raw_min = -1'000;
  result.raw_max = 1'000;
  return result;
}
constexpr protocol::Field real_fields[] = {field(0, 8), field(8, 32, false, protocol::Number::float32)};
constexpr protocol::Field first_fields[] = {field(0, 8), field(8, 8)};  // the second one is beyond its frame
constexpr protocol::Field second_fields[] = {field(0, 16)};
constexpr protocol::Field news_fields[] = {field(80, 8)};
constexpr protocol::Field wide_fields[] = {field(0, 64)};
constexpr protocol::Field motor_fields[] = {field(0, 8), field(8, 16, true)};
constexpr protocol::FrameLayout frame(std::uint8_t id, std::uint16_t length,
                                      std::span<const protocol::Field> fields) {
  protocol::FrameLayout result;
  result.id = protocol::TopicId{id};
  result.length = length;
  result.fields = fields;
  return result;
}
constexpr protocol::FrameLayout real_frames[] = {frame(0x11, 5, real_fields)};
constexpr protocol::FrameLayout pair_frames[] = {frame(0x12, 1, first_fields), frame(0x13, 2, second_fields)};
constexpr protocol::FrameLayout news_frames[] = {frame(0, 12, news_fields)};
constexpr protocol::FrameLayout wide_frames[] = {frame(0x14, 8, wide_fields)};
constexpr protocol::FrameLayout motor_frames[] = {frame(0x21, 3, motor_fields)};
enum : std::uint16_t { real, pair, news, wide, motor };
constexpr protocol::Topic topic(std::string_view name, protocol::Kind kind,
                                std::span<const protocol::FrameLayout> frames) {
  protocol::Topic result;
  result.name = name;
  result.id = frames[0].id;
  result.kind = kind;
  result.frames = frames;
  return result;
}
constexpr protocol::Topic topics[] = {
    topic("real", protocol::Kind::sensor, real_frames), topic("pair", protocol::Kind::sensor, pair_frames),
    topic("news", protocol::Kind::message, news_frames), topic("wide", protocol::Kind::sensor, wide_frames),
    topic("motor", protocol::Kind::actuator, motor_frames)};
constexpr protocol::Catalogue catalogue{"all there is", 1'000'000, {}, topics};

/// Its tables, to be changed before it starts.
struct Robot {
  std::vector<Stream> all{{real, 100ms}, {pair, 100ms}, {news, 100ms}, {wide, 100ms}};
  std::vector<Configuration> configurations{{"all", all, {}, {}, {}}};
  std::vector<Condition> conditions;
  std::vector<std::vector<Term>> terms;
  std::vector<Monitor> monitors;
  std::vector<Transition> transitions;
  Operator op;
  std::optional<Supervisor<Room{}>> supervisor;
  base::Time now{1s};
  std::vector<std::string> actions;

  Robot() {
    op.catalogue = &catalogue;
    op.settle = 50ms;
  }
  void start() {
    op.configurations = configurations;
    op.conditions = conditions;
    op.monitors = monitors;
    op.transitions = transitions;
    now = base::Time{1s};
    supervisor.emplace(op);
    write(supervisor->start(now));
  }
  /// At so long after the start.
  const std::vector<std::string>& at(base::Duration after, const Event& event = {}) {
    now = base::Time{1s} + after;
    write(supervisor->step(event, now));
    return actions;
  }
  const std::vector<std::string>& sample(base::Duration after, std::uint16_t topic,
                                         std::span<const std::uint8_t> bytes) {
    return at(after, {.kind = Kind::sample, .topic = topic, .bytes = bytes});
  }
  /// When the next step is due, after the start; -1: never.
  [[nodiscard]] double next_ms() const {
    if (supervisor->next() == base::never) return -1;
    return std::chrono::duration<double, std::milli>{supervisor->next() - base::Time{1s}}.count();
  }
  /// What is known of each condition.
  [[nodiscard]] std::string known() const {
    std::string text;
    for (std::size_t c = 0; c < conditions.size(); ++c)
      text += supervisor->condition(c) == Truth::yes  ? 'y'
              : supervisor->condition(c) == Truth::no ? 'n'
                                                      : '?';
    return text;
  }

 private:
  static std::string text(const Action& action) {
    char line[64];
    using enum Action::Kind;
    const auto place = [](std::uint16_t index) { return index == none ? -1 : int{index}; };
    if (!action.sends()) {
      std::snprintf(line, sizeof line, "%s %d>%d by %d", action.kind == switched ? "switched" : "refused",
                    place(action.from), place(action.to), place(action.transition));
      return line;
    }
    const char* const kind = action.kind == command       ? "command"
                             : action.kind == unsubscribe ? "stop"
                             : action.kind == subscribe   ? "ask"
                                                          : "again";
    std::string out = std::string{kind} + " " + std::string{topics[action.topic].name};
    if (action.period.count() != 0) out += " " + std::to_string(action.period / 1ms) + "ms";
    std::snprintf(line, sizeof line, " %03X#", action.frame.id);
    out += line;
    for (std::size_t i = 0; i < action.frame.dlc; ++i) {
      std::snprintf(line, sizeof line, "%02X", action.frame.data[i]);
      out += line;
    }
    return out;
  }
  void write(std::span<const Action> list) {
    actions.clear();
    for (const Action& action : list) actions.push_back(text(action));
  }
};
using Lines = std::vector<std::string>;
using Bytes = std::vector<std::uint8_t>;

/// A sample of `real`: a byte and a float.
Bytes real_sample(std::uint8_t byte, float value) {
  Bytes bytes{byte};
  for (unsigned i = 0; i < 4; ++i)
    bytes.push_back(static_cast<std::uint8_t>(std::bit_cast<std::uint32_t>(value) >> (8 * i)));
  return bytes;
}

// --- what samples say ------------------------------------------------------------------------------------------

TEST_CASE("supervisor steps: values of floats, of 64 bits, of several frames, of messages, and of none") {
  Robot robot;
  const auto float_bits = [](float value) { return std::int64_t{std::bit_cast<std::uint32_t>(value)}; };
  const auto limit = [&](float value) { return ordered(real_fields[1], float_bits(value)); };
  const std::int64_t half = ordered(wide_fields[0], std::numeric_limits<std::int64_t>::min());  // 2^63
  robot.conditions = {{.topic = real, .field = 1, .limit = limit(1.5F)},
                      {.is = Is::below, .topic = real, .field = 1, .limit = limit(-2.0F)},
                      {.is = Is::equal, .topic = real, .field = 1, .limit = float_bits(-2.0F)},
                      {.topic = pair, .frame = 1, .limit = 300},
                      {.topic = pair, .field = 1},
                      {.topic = news, .limit = 7},
                      {.topic = wide, .limit = half},
                      {.is = Is::other, .topic = wide, .limit = 5},
                      {.topic = real, .limit = 9}};
  robot.start();
  CHECK(robot.known() == "?????????");
  struct Case {
    std::uint16_t topic;
    Bytes bytes;
    std::string known;
    std::uint32_t not_numbers = 0;
  };
  const Bytes zeros(8);
  const auto two_frames = [](std::size_t size, std::uint8_t high) {
    Bytes bytes(16);
    bytes[1] = 0xFF;
    bytes[9] = high;
    bytes.resize(size);
    return bytes;
  };
  Bytes letter(12);
  letter[10] = 8;
  const Case cases[] = {
      {real, real_sample(10, 1.75F), "ynn?????y"},
      {real, real_sample(9, -1.75F), "nnn?????n"},
      {real, real_sample(9, -2.0F), "nny?????n"},
      {real, real_sample(9, -2.25F), "nyn?????n"},
      {real, real_sample(9, std::numeric_limits<float>::infinity()), "ynn?????n"},
      // What is not a number is not known, of each condition that looks at it.
      {real, real_sample(10, std::numeric_limits<float>::quiet_NaN()),
       "???"
       "?????y",
       3},
      // One that is too short for a field is without it.
      {real,
       {10, 0, 0, 0},
       "???"
       "?????y",
       3},
      {real, {}, "?????????", 3},
      {pair, two_frames(16, 2), "???y?????", 3},
      {pair, two_frames(16, 1), "???n?????", 3},
      {pair, two_frames(10, 2), "???y?????", 3},
      {pair, two_frames(9, 2), "?????????", 3},
      {pair, two_frames(8, 2), "?????????", 3},
      {pair, two_frames(7, 2), "?????????", 3},
      {news, letter, "?????y???", 3},
      {news, {letter.begin(), letter.begin() + 11}, "?????y???", 3},
      {news, {letter.begin(), letter.begin() + 10}, "?????????", 3},
      {news, Bytes(12), "?????n???", 3},
      {wide, {5, 0, 0, 0, 0, 0, 0, 0}, "?????nnn?", 3},
      {wide, {0, 0, 0, 0, 0, 0, 0, 0x80}, "?????nny?", 3},
      {wide, {1, 0, 0, 0, 0, 0, 0, 0x80}, "?????nyy?", 3},
      {wide, {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}, "?????nyy?", 3},
  };
  for (std::size_t i = 0; i < std::size(cases); ++i) {
    CAPTURE(i);
    robot.sample(1ms, cases[i].topic, cases[i].bytes);
    CHECK(robot.known() == cases[i].known);
    CHECK(robot.supervisor->counters().not_a_number == cases[i].not_numbers);
  }
  // Three periods later they count no more, those of messages either.
  robot.at(300ms);
  CHECK(robot.known() == "?????nyy?");
  robot.at(301ms);
  CHECK(robot.known() == "?????????");
}

TEST_CASE("supervisor steps: samples are counted in windows that follow one another") {
  Robot robot;
  robot.all = {{real, 100ms}};
  robot.configurations[0].streams = robot.all;
  robot.conditions = {{.watched = Watched::rate, .topic = real, .limit = 2, .window = 100ms}};
  robot.start();
  const auto samples = [&](std::initializer_list<int> times) {
    for (const int each : times) robot.sample(each * 1ms, real, {});
  };
  const auto at = [&](int ms) {
    robot.at(ms * 1ms);
    return robot.known();
  };
  CHECK(robot.next_ms() == 100);
  samples({10, 20, 99});
  CHECK(at(99) == "?");
  CHECK(at(100) == "y");
  CHECK(robot.next_ms() == 200);
  samples({110});
  CHECK(at(250) == "n");
  CHECK(robot.next_ms() == 300);
  samples({260, 270, 280});
  CHECK(at(300) == "y");
  CHECK(at(520) == "n");  // the last whole one had none
  CHECK(robot.next_ms() == 600);
  samples({530, 540, 550});
  samples({600, 610, 620});  // the first of them ends the window before it
  CHECK(robot.known() == "y");
  CHECK(at(699) == "y");
  samples({702});
  CHECK(robot.known() == "y");
  CHECK(at(800) == "n");
}

TEST_CASE(
    "supervisor steps: a sample of what is not streamed here, which another program asked for, says "
    "nothing") {
  Robot robot;
  const std::vector<Stream> none_of_it{{pair, 100ms}};
  robot.configurations[0].streams = none_of_it;
  robot.conditions = {{.topic = real, .limit = 9}, {.topic = pair, .limit = 9}};
  robot.start();
  robot.sample(10ms, real, real_sample(10, 0.0F));
  CHECK(robot.known() == "??");
  robot.sample(20ms, pair, Bytes{10, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  CHECK(robot.known() == "?y");
}

TEST_CASE(
    "supervisor steps: what was known of a stream that goes on stays known, of one asked for again it does "
    "not") {
  Robot robot;
  const std::vector<Stream> same{{real, 100ms}}, urgent{{real, 100ms, Priority::urgent}},
      faster{{real, 50ms}}, none_of_it{{pair, 100ms}};
  robot.all = {{real, 100ms}};
  robot.configurations = {{"all", robot.all, {}, {}, {}},
                          {"same", same, {}, {}, {}},
                          {"urgent", urgent, {}, {}, {}},
                          {"faster", faster, {}, {}, {}},
                          {"none", none_of_it, {}, {}, {}}};
  robot.conditions = {{.topic = real, .limit = 9},
                      {.watched = Watched::age, .topic = real, .limit = 250'000'000},
                      {.watched = Watched::gap, .topic = real, .limit = 50'000'000},
                      {.watched = Watched::rate, .topic = real, .limit = 0, .window = 60ms},
                      {.watched = Watched::refusals},
                      {.watched = Watched::bus_state, .limit = 1}};
  for (std::uint16_t c = 0; c < 5; ++c) robot.transitions.push_back({"asked", any_configuration, c});
  struct Case {
    std::int64_t to;
    Lines actions;
    std::string known, later;
    double next_ms;
  };
  for (const Case& each : {
           // The age is that of the sample at 60 ms; the window began at 60.
           Case{1, {"switched 0>1 by 1"}, "ynyyny", "ynyyny", 120},
           Case{2, {"switched 0>2 by 2", "ask real 100ms 011#01640000"}, "????ny", "?nn?ny", 120},
           Case{3, {"switched 0>3 by 3", "ask real 50ms 211#01320000"}, "????ny", "?nn?ny", 120},
           Case{4,
                {"switched 0>4 by 4", "stop real 211#00", "ask pair 100ms 212#01640000"},
                "????ny",
                "????ny",
                -1},
       }) {
    CAPTURE(each.to);
    robot.start();
    robot.sample(10ms, real, real_sample(10, 0));
    robot.at(20ms, {.kind = Kind::refusal});
    robot.at(30ms, {.kind = Kind::bus_state, .value = 2});
    robot.sample(60ms, real, real_sample(10, 0));
    CHECK(robot.known() == "ynyyyy");
    CHECK(robot.at(70ms, {.kind = Kind::request, .value = each.to}) == each.actions);
    CHECK(robot.known() == each.known);
    robot.at(71ms);
    CHECK(robot.known() == each.later);
    // What is asked for again is watched from then on: the gap until 120, the window until 130.
    CHECK(robot.next_ms() == each.next_ms);
    CHECK(robot.supervisor->since() == base::Time{1s} + 70ms);
    CHECK(robot.supervisor->transition() == each.to);
    // A change is over at 120 ms.
    robot.at(119ms, {.kind = Kind::request, .value = 0});
    CHECK(robot.supervisor->configuration() == each.to);
    CHECK(robot.next_ms() == 120);
    robot.at(120ms);
    CHECK(robot.supervisor->configuration() == 0);
  }
}

// --- what it does when -----------------------------------------------------------------------------------------

TEST_CASE(
    "supervisor steps: of what fires at once the lowest precedence goes first, and a monitor before a "
    "request") {
  for (int run = 0; run < 27 * 6; ++run) {
    const int precedence[] = {run % 3, run / 3 % 3, run / 9 % 3};
    if (precedence[0] == precedence[1]) continue;  // which no check lets pass
    Robot robot;
    robot.configurations.assign(4, {{}, {}, {}, {}, {}});
    robot.conditions = {{.watched = Watched::bus_state}};
    robot.terms = {{{.condition = 0}}};
    robot.monitors.assign(2, {{}, robot.terms[0], {}});
    // To 1 and 2 by monitors, to 3 by request, in each order.
    std::vector<Transition> all;
    for (std::uint16_t i = 0; i < 3; ++i)
      all.push_back({{},
                     0,
                     static_cast<std::uint16_t>(i + 1),
                     i < 2 ? i : by_request,
                     static_cast<std::uint8_t>(precedence[i])});
    std::vector<int> order{0, 1, 2};
    for (int i = run / 27; i > 0; --i) std::next_permutation(order.begin(), order.end());
    for (const int i : order) robot.transitions.push_back(all[static_cast<std::size_t>(i)]);
    robot.start();
    robot.at(1ms, {.kind = Kind::request, .value = 3});
    robot.at(2ms, {.kind = Kind::bus_state, .value = 1});
    CHECK(robot.next_ms() == 50);
    robot.at(50ms);
    const int monitor = precedence[0] < precedence[1] ? 0 : 1;
    CAPTURE(precedence[0], precedence[1], precedence[2]);
    REQUIRE(robot.supervisor->configuration() == (precedence[2] < precedence[monitor] ? 3 : monitor + 1));
  }
}

TEST_CASE(
    "supervisor steps: a silent stream is asked for again after three periods, `retry` and the change") {
  struct Case {
    base::Duration retry, settle;
    std::vector<int> again_ms;
  };
  for (const Case& each : {Case{500ms, 50ms, {500, 1000, 1500}}, Case{200ms, 50ms, {300, 500, 700}},
                           Case{200ms, 600ms, {600, 800, 1000}}, Case{0ms, 50ms, {}}}) {
    Robot robot;
    robot.all = {{real, 100ms, Priority::low}, {news, 100ms}};  // a message is not asked for
    robot.configurations[0].streams = robot.all;
    robot.op.retry = each.retry;
    robot.op.settle = each.settle;
    robot.start();
    CHECK(robot.actions == Lines{"switched -1>0 by -1", "ask real 100ms 311#01640000"});
    std::uint32_t count = 0;
    for (const int due : each.again_ms) {
      CHECK(robot.next_ms() == due);
      CHECK(robot.at((due - 1) * 1ms).empty());
      CHECK(robot.at(due * 1ms) == Lines{"again real 100ms 311#01640000"});
      CHECK(robot.supervisor->counters().asked_again == ++count);
    }
    if (each.again_ms.empty()) CHECK(robot.next_ms() == -1);
    if (each.retry != 200ms) continue;
    // A sample: three periods from it on.
    robot.sample(1'010ms, real, {});
    CHECK(robot.next_ms() == 1'310);
    CHECK(robot.at(1'309ms).empty());
    CHECK(robot.at(1'310ms).size() == 1);
  }
}

TEST_CASE(
    "supervisor steps: set points of an entry, their repetition, and where those of others start from") {
  Robot robot;
  const std::int64_t whole[] = {20, -2}, half[] = {7};
  const std::vector<SetPoint> entry{{motor, half}, {motor, whole, Priority::low, 30ms}};
  const std::vector<Limit> limits{{motor, 0, -100, 100, 1'000}};
  robot.configurations = {{"all", {}, limits, entry, {}}};
  robot.start();
  CHECK(robot.actions ==
        Lines{"switched -1>0 by -1", "command motor 021#070000", "command motor 321#14FEFF"});
  std::int64_t raw[] = {100, 0};
  CHECK(robot.supervisor->permit(motor, raw, robot.now + 10ms) == 1);
  CHECK(raw[0] == 30);  // from 20
  CHECK(robot.supervisor->counters() == SupervisorCounters{.limited = 1});
  CHECK(robot.next_ms() == 30);
  CHECK(robot.at(29ms).empty());
  CHECK(robot.at(31ms) == Lines{"command motor 321#14FEFF"});
  CHECK(robot.next_ms() == 61);
  raw[0] = 100;
  robot.supervisor->permit(motor, raw, robot.now + 5ms);
  CHECK(raw[0] == 25);
}

TEST_CASE("supervisor steps: a nanosecond is time: between two set points, and before it asks again") {
  Robot robot;
  const std::vector<SetPoint> entry{{motor, {}, Priority::low, 1ns}};
  robot.configurations[0].entry = entry;
  robot.start();
  CHECK(robot.supervisor->next() == robot.now + 1ns);

  Robot asking;
  asking.all = {{real, 100ms}};
  asking.configurations[0].streams = asking.all;
  asking.op.retry = 1ns;
  asking.start();
  CHECK(asking.next_ms() == 300);
}

TEST_CASE("supervisor steps: a period follows a value, not more often than it may, and from a new value on") {
  Robot robot;
  const std::vector<Adaptation> adaptations{{.stream = 1,
                                             .topic = real,
                                             .from = 0,
                                             .to = 100,
                                             .at_from = 200ms,
                                             .at_to = 50ms,
                                             .grain = 50ms,
                                             .every = 200ms}};
  robot.all = {{real, 1s}, {pair, 100ms, Priority::high}};
  robot.configurations = {{"all", robot.all, {}, {}, adaptations}, {"same", robot.all, {}, {}, {}}};
  robot.transitions = {{"asked", 0, 1}, {"asked", 1, 0}};
  robot.op.retry = 5s;
  robot.start();
  const auto value = [&](base::Duration after, std::uint8_t byte) {
    return robot.sample(after, real, real_sample(byte, 0));
  };
  CHECK(value(10ms, 100).empty());  // 50 ms, but not yet
  CHECK(robot.next_ms() == 200);
  CHECK(robot.at(199ms).empty());
  CHECK(robot.at(200ms) == Lines{"ask pair 50ms 112#01320000"});
  CHECK(robot.supervisor->period(1) == 50ms);
  CHECK(robot.next_ms() == 5'000);  // only the real one's and the pair's silence
  CHECK(value(210ms, 0).empty());
  CHECK(robot.next_ms() == 400);
  CHECK(value(220ms, 100).empty());  // as it is
  CHECK(robot.next_ms() == 5'000);
  CHECK(robot.at(450ms).empty());
  CHECK(value(460ms, 34) == Lines{"ask pair 100ms 112#01640000"});  // 149 ms
  CHECK(robot.sample(470ms, real, {}).empty());                     // without the field: as it is
  CHECK(robot.supervisor->counters().adapted == 2);
  CHECK(value(700ms, 100) == Lines{"ask pair 50ms 112#01320000"});
  // Where its period is another one it is asked for again, and nothing is known of the value.
  CHECK(robot.at(710ms, {.kind = Kind::request, .value = 1}) ==
        Lines{"switched 0>1 by 0", "ask pair 100ms 112#01640000"});
  CHECK(value(720ms, 100).empty());
  CHECK(robot.at(770ms, {.kind = Kind::request, .value = 0}) == Lines{"switched 1>0 by 1"});
  CHECK(robot.at(1'100ms).empty());
  CHECK(value(1'110ms, 100) == Lines{"ask pair 50ms 112#01320000"});
  // A silent one is asked for at the period that it has.
  CHECK(robot.at(7s) == Lines{"again real 1000ms 211#01E80300", "again pair 50ms 112#01320000"});
}

TEST_CASE("supervisor steps: a change before it is over, and one that lasts, are due when they may begin") {
  Robot robot;
  robot.configurations.assign(3, {{}, {}, {}, {}, {}});
  robot.conditions = {{.watched = Watched::bus_state},
                      {.watched = Watched::bus_load, .limit = 500, .window = 1s}};
  robot.terms = {{{.condition = 0}}, {{.condition = 1}}};
  robot.monitors = {{"state", robot.terms[0], 30ms}, {"load", robot.terms[1], 100ms}};
  robot.transitions = {{"state", 0, 1, 0}, {"load", 1, 2, 1}, {"asked", any_configuration, 0}};
  robot.op.fall_back = 2;
  robot.start();
  CHECK(robot.next_ms() == -1);
  robot.at(10ms, {.kind = Kind::bus_state, .value = 1});
  CHECK(robot.next_ms() == 50);  // 40, but for the start
  robot.at(20ms, {.kind = Kind::bus_state, .value = 0});
  CHECK(robot.next_ms() == -1);
  robot.at(30ms, {.kind = Kind::bus_state, .value = 1});
  CHECK(robot.next_ms() == 60);
  CHECK(robot.at(59ms).empty());
  CHECK(robot.at(60ms) == Lines{"switched 0>1 by 0"});
  CHECK(robot.next_ms() == -1);
  // Nothing leads to where it is from there; from 1 the load leads on, after a request that comes before.
  robot.at(70ms, {.kind = Kind::bus_load, .value = 501});
  CHECK(robot.next_ms() == 170);
  robot.at(80ms, {.kind = Kind::request, .value = 0});
  CHECK(robot.next_ms() == 110);
  CHECK(robot.supervisor->requested() == 0);
  // A request for where it is takes back the one that waits, and is none if nothing does.
  robot.at(90ms, {.kind = Kind::request, .value = 1});
  CHECK(robot.supervisor->counters().requests_replaced == 1);
  robot.at(91ms, {.kind = Kind::request, .value = 1});
  CHECK(robot.supervisor->counters().requests_replaced == 1);
  CHECK(robot.at(92ms, {.kind = Kind::request, .value = 2}) == Lines{"refused 1>2 by -1"});
  CHECK(robot.at(93ms, {.kind = Kind::request, .value = 3}) == Lines{"refused 1>-1 by -1"});
  // What is held back is not due; the way to the fall-back is not held back.
  robot.supervisor->hold(true);
  robot.at(94ms);
  CHECK(robot.next_ms() == 170);
  CHECK(robot.at(170ms) == Lines{"switched 1>2 by 1"});
  CHECK(robot.at(230ms, {.kind = Kind::request, .value = 0}) == Lines{"switched 2>0 by 2"});
  CHECK(robot.next_ms() == -1);
  robot.supervisor->hold(false);
  CHECK(robot.at(231ms).empty());
  CHECK(robot.next_ms() == 280);
  CHECK(robot.at(280ms) == Lines{"switched 0>1 by 0"});
  CHECK(robot.supervisor->counters() ==
        SupervisorCounters{.switches = 4, .requests_refused = 2, .requests_replaced = 1});
}

}  // namespace reflective_supervisor_steps_test
