#include "ocm/mapper/app/state.hpp"

#include <array>
#include <string>
#include <string_view>

#include <catch2/catch.hpp>

namespace mapper_app_state_test {

using namespace ocm;
using namespace std::chrono_literals;
using mapper::app::Event;
using mapper::app::Lights;
using mapper::app::lights;
using mapper::app::State;
using mapper::app::Step;

using S = State;
using E = Event;

constexpr std::array states{S::advertising, S::connected, S::confirmed,           S::paused,
                            S::calibrating, S::returning, S::initialisation_fault};
constexpr std::array events{E::link_up,      E::link_down,     E::confirm,    E::pause,      E::unpause,
                            E::set_point,    E::stop,          E::format,     E::ping,       E::who,
                            E::calibrate,    E::compass,       E::calibrated, E::return_due, E::returned,
                            E::parts_failed, E::parts_answered};
static_assert(states.size() == mapper::app::state_count && events.size() == mapper::app::event_count);

/// What is done, a letter each: refused, motors off, zero the pose, drop the link's queues, drive, idle is
/// said, the ping, or who it is or how its compass is, is answered.
std::string done(const Step& step) {
  std::string result;
  const auto add = [&result](bool is, char letter) {
    if (is) result += letter;
  };
  add(step.refused, 'R');
  add(step.motors_off, 'M');
  add(step.reset, 'Z');
  add(step.drop, 'D');
  add(step.drive, 'U');
  add(step.idle, 'I');
  add(step.answer, 'A');
  return result;
}

struct Cell {
  S next;
  std::string_view done;
};
/// By hand from [T2 §6.3, §4.4, §6.2 "Pause", §8.1], each row in the order of `events`. What is no row's
/// business changes nothing; what an operator says where it means nothing is refused.
constexpr S adv = S::advertising, con = S::connected, run = S::confirmed, pau = S::paused,
            cal = S::calibrating, ret = S::returning, bad = S::initialisation_fault;
// clang-format off
constexpr Cell table[7][17] = {
    // up          down         CON         PAU         UNP         U           U,0,0        BIN TXT     ping        WHO         calibrate    compass     calibrated   due        returned    failed     answered
    {{con, ""},  {adv, ""},   {adv, "R"}, {adv, "R"}, {adv, "R"}, {adv, "R"}, {adv, "R"},  {adv, "R"}, {adv, "R"}, {adv, "R"}, {adv, "R"},  {adv, "R"}, {adv, ""},   {ret, ""}, {adv, ""},  {bad, ""}, {adv, ""}},
    {{con, ""},  {adv, "MD"}, {run, "Z"}, {con, "R"}, {con, "R"}, {con, "R"}, {con, "R"},  {con, ""},  {con, "A"}, {con, ""},  {con, "R"},  {con, "A"}, {con, ""},   {con, ""}, {con, ""},  {con, ""}, {con, ""}},
    {{run, ""},  {adv, "MD"}, {run, ""},  {pau, "I"}, {run, ""},  {run, "U"}, {run, "MI"}, {run, ""},  {run, "A"}, {run, "A"}, {cal, "MA"}, {run, "A"}, {run, ""},   {run, ""}, {run, ""},  {run, ""}, {run, ""}},
    {{pau, ""},  {adv, "MD"}, {pau, ""},  {pau, "I"}, {run, ""},  {pau, "U"}, {pau, "MI"}, {pau, ""},  {pau, "A"}, {pau, "A"}, {pau, "R"},  {pau, "A"}, {pau, ""},   {pau, ""}, {pau, ""},  {pau, ""}, {pau, ""}},
    {{cal, ""},  {adv, "MD"}, {cal, ""},  {cal, "R"}, {cal, "R"}, {cal, "R"}, {run, "MI"}, {cal, ""},  {cal, "A"}, {cal, "A"}, {cal, "R"},  {cal, "A"}, {run, "MI"}, {cal, ""}, {cal, ""},  {cal, ""}, {cal, ""}},
    {{con, "M"}, {ret, ""},   {ret, "R"}, {ret, "R"}, {ret, "R"}, {ret, "R"}, {ret, "R"},  {ret, "R"}, {ret, "R"}, {ret, "R"}, {ret, "R"},  {ret, "R"}, {ret, ""},   {ret, ""}, {adv, "M"}, {ret, ""}, {ret, ""}},
    {{bad, ""},  {bad, ""},   {bad, "R"}, {bad, "R"}, {bad, "R"}, {bad, "R"}, {bad, "R"},  {bad, "R"}, {bad, "R"}, {bad, "R"}, {bad, "R"},  {bad, "R"}, {bad, ""},   {bad, ""}, {bad, ""},  {bad, ""}, {adv, ""}},
};
// clang-format on

TEST_CASE("mapper state: every event in every state", "[mapper_state]") {
  for (std::size_t s = 0; s < states.size(); ++s) {
    for (std::size_t e = 0; e < events.size(); ++e) {
      CAPTURE(name(states[s]), e);
      const Step step = mapper::app::step(states[s], events[e]);
      CHECK(name(step.state) == name(table[s][e].next));
      CHECK(done(step) == table[s][e].done);
    }
  }
}

TEST_CASE("mapper state: what must hold whatever the table says", "[mapper_state]") {
  for (const S state : states) {
    for (const E event : events) {
      CAPTURE(name(state), static_cast<int>(event));
      const Step step = mapper::app::step(state, event);
      // Who may not drive any more has his motors switched off in the same step.
      if (may_drive(state) && !may_drive(step.state)) CHECK(step.motors_off);
      // Only a confirmation lets an operator's robot drive.
      if (obeys(step.state) && !has_link(state)) CHECK(false);
      if (step.reset) CHECK((state == S::connected && step.state == S::confirmed));
      if (step.refused) CHECK(step == Step{.state = state, .refused = true});
      // A link that dies takes everything with it, and only a link that dies.
      CHECK(step.drop == (event == E::link_down && has_link(state)));
      if (event == E::link_down) CHECK_FALSE(has_link(step.state));
    }
  }
}

TEST_CASE("mapper state: from every state with a link one event leads to the next operator",
          "[mapper_state]") {
  for (const S state : states) {
    if (!has_link(state)) continue;
    S at = mapper::app::step(state, E::link_down).state;
    at = mapper::app::step(at, E::link_up).state;
    CHECK(at == S::connected);
    CHECK(mapper::app::step(at, E::confirm).state == S::confirmed);
  }
}

constexpr Lights dark{};
constexpr Lights green{.green = true};
constexpr Lights yellow{.yellow = true};
constexpr Lights both{.green = true, .yellow = true};

// [T2 §6.3]
TEST_CASE("mapper state: lamps", "[mapper_state]") {
  SECTION("advertising: green flashes every two seconds") {
    CHECK(lights(S::advertising, {.in_state = 0s}) == green);
    CHECK(lights(S::advertising, {.in_state = 199ms}) == green);
    CHECK(lights(S::advertising, {.in_state = 200ms}) == dark);
    CHECK(lights(S::advertising, {.in_state = 1999ms}) == dark);
    CHECK(lights(S::advertising, {.in_state = 2s}) == green);
    CHECK(lights(S::advertising, {.in_state = 24h + 100ms}) == green);
  }
  SECTION("connected: green, and yellow at each handshake") {
    CHECK(lights(S::connected, {.in_state = 500ms}) == green);
    CHECK(lights(S::connected, {.in_state = 500ms, .handshake = true}) == both);
  }
  SECTION("confirmed: green, and yellow while the compass corrects at rest") {
    CHECK(lights(S::confirmed, {.in_state = 500ms}) == green);
    CHECK(lights(S::confirmed, {.in_state = 500ms, .handshake = true}) == green);
    CHECK(lights(S::confirmed, {.in_state = 500ms, .compass_at_rest = true}) == both);
  }
  SECTION("paused: both") {
    CHECK(lights(S::paused, {.in_state = 500ms}) == both);
  }
  SECTION("initialisation fault: yellow alone, which no other state shows for long") {
    for (const auto time : {0ms, 500ms, 100'000ms})
      CHECK(lights(S::initialisation_fault, {.in_state = time}) == yellow);
  }
  SECTION("calibrating: green, yellow flickers; returning: one after the other") {
    CHECK(lights(S::calibrating, {.in_state = 100ms}) == both);
    CHECK(lights(S::calibrating, {.in_state = 300ms}) == green);
    CHECK(lights(S::returning, {.in_state = 300ms}) == green);
    CHECK(lights(S::returning, {.in_state = 800ms}) == yellow);
    CHECK(lights(S::calibrating, {.in_state = 199ms}) == both);
    CHECK(lights(S::calibrating, {.in_state = 200ms}) == green);
    CHECK(lights(S::calibrating, {.in_state = 399ms}) == green);
    CHECK(lights(S::calibrating, {.in_state = 400ms}) == both);
    CHECK(lights(S::returning, {.in_state = 499ms}) == green);
    CHECK(lights(S::returning, {.in_state = 500ms}) == yellow);
    CHECK(lights(S::returning, {.in_state = 999ms}) == yellow);
    CHECK(lights(S::returning, {.in_state = 1s}) == green);
  }
}

}  // namespace mapper_app_state_test
