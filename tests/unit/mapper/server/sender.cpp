#include "ocm/mapper/server/sender.hpp"

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <vector>

#include <catch2/catch.hpp>

namespace mapper_server_sender_test {

using namespace std::chrono_literals;
using namespace ocm::mapper::server;
using ocm::base::Duration;
using ocm::base::Time;
using ocm::mapper::link::Kind;
using ocm::mapper::link::SetPoint;
using ocm::mapper::link::Update;

constexpr Time second{1s};

/// A sender whose words go out at once.
struct Bench {
  Sender sender;
  Time now = second;
  std::vector<SetPoint> said{};
  unsigned unpauses = 0;

  void speak() {
    for (auto word = sender.next(now); word.kind != Kind::none; word = sender.next(now)) {
      if (word.kind == Kind::unpause) ++unpauses;
      if (word.kind == Kind::set_point) said.push_back(word.set_point);
      sender.out(now);
    }
  }
  void pass(Duration time) {
    for (const Time end = now + time; now < end;) now += 50ms, speak();
  }
  void idle() { (void)sender.hear_idle(now), speak(); }
  void at(int x, int y, int heading) {
    Update update{};
    update.x = static_cast<std::int16_t>(x);
    update.y = static_cast<std::int16_t>(y);
    update.heading = static_cast<std::int16_t>(heading);
    sender.hear_update(update, now), speak();
  }
  /// It stands there, and says so.
  void stands(int x, int y, int heading) { idle(), at(x, y, heading); }
  void go(int angle, int distance) {
    sender.go({static_cast<std::int16_t>(angle), static_cast<std::int16_t>(distance)}, now), speak();
  }
};

static_assert(is_final(Progress::none) && is_final(Progress::reached) && is_final(Progress::ended));
static_assert(is_final(Progress::stopped) && !is_final(Progress::stopping));
static_assert(!is_final(Progress::waiting) && !is_final(Progress::said) && !is_final(Progress::heard));

TEST_CASE("sender: a set point that is heard is said once, and reached where the robot then stands") {
  Bench bench;
  bench.stands(0, 0, 0);
  bench.go(90, 50);
  CHECK(bench.said == std::vector<SetPoint>{{90, 50}});
  CHECK(bench.sender.progress() == Progress::said);
  bench.pass(600ms);
  bench.at(0, 0, 20);
  CHECK(bench.sender.progress() == Progress::heard);
  bench.pass(8s);
  bench.at(0, 49, 89);
  CHECK(bench.sender.progress() == Progress::heard);  // it may still drive
  bench.stands(0, 49, 89);
  CHECK(bench.sender.progress() == Progress::reached);
  CHECK(bench.said.size() == 1);
}

TEST_CASE("sender: not heard is said again, from where the robot stands, and never while it may drive") {
  Bench bench;
  bench.stands(10, 20, 30);
  bench.go(45, 40);
  bench.pass(5s);
  CHECK(bench.said.size() == 1);  // silence: it may drive
  for (int i = 0; i < 5; ++i) {
    bench.at(10, 20, 30);
    CHECK(bench.said.size() == 1U + static_cast<unsigned>(i));
    bench.idle();
    CHECK(bench.said.size() ==
          1U + static_cast<unsigned>(i));  // how it stands, the update behind the idle says
    bench.at(10, 20, 30);
    CHECK(bench.said.back() == SetPoint{45, 40});
    bench.pass(1s);
  }
  CHECK(bench.sender.progress() == Progress::said);
  CHECK(bench.sender.times_said() == 6);
  // Its compass has turned it meanwhile by some degrees: the aim is where it was.
  bench.stands(10, 20, 33);
  CHECK(bench.said.back() == SetPoint{42, 40});
}

TEST_CASE("sender: an idle that was under way when the word went out proves nothing") {
  Bench bench;
  bench.stands(0, 0, 0);
  bench.go(0, 50);
  bench.pass(200ms);
  bench.stands(0, 0, 0);
  CHECK(bench.said.size() == 1);
  CHECK_FALSE(bench.sender.standing());
}

TEST_CASE("sender: the first idle that counts comes when the settling time is over") {
  Bench bench;
  bench.stands(0, 0, 0);
  bench.go(90, 50);
  const Time quiet = bench.now;
  CHECK_FALSE(bench.sender.hear_idle(quiet + SenderOptions{}.settle - 1ns));
  CHECK(bench.sender.hear_idle(quiet + SenderOptions{}.settle));
}

TEST_CASE("sender: heard, and stopped by something on the way") {
  Bench bench;
  bench.stands(0, 0, 0);
  bench.go(0, 50);
  bench.pass(3s);
  bench.stands(20, 1, 1);
  CHECK(bench.sender.progress() == Progress::ended);
  CHECK(bench.sender.blocked());
  CHECK(bench.sender.off_cm() == Approx(30).margin(0.1));
  CHECK(bench.said.size() == 1);
  bench.go(0, 10);  // and what is asked for next is not blamed for it
  CHECK(bench.said.size() == 2);
  CHECK_FALSE(bench.sender.blocked());
}

TEST_CASE("sender: two copies that add up are driven back, and nothing is blamed for it") {
  Bench bench;
  bench.stands(0, 0, 0);
  bench.go(0, 40);
  bench.pass(2s);
  bench.stands(70, 0, 0);
  CHECK(bench.said.back() == SetPoint{0, -30});
  bench.pass(2s);
  bench.stands(40, 0, 0);
  CHECK(bench.sender.progress() == Progress::reached);
}

TEST_CASE("sender: a robot that is not known to stand is listened to, then stopped first") {
  Bench bench;
  bench.go(90, 50);
  bench.at(5, 5, 0);
  bench.pass(1100ms);
  CHECK(bench.said.empty());
  bench.pass(200ms);
  CHECK(bench.said == std::vector<SetPoint>{{0, 0}});
  bench.stands(7, 5, 0);
  CHECK(bench.said.back() == SetPoint{90, 50});
  bench.pass(9s);
  bench.stands(7, 55, 90);
  CHECK(bench.sender.progress() == Progress::reached);
}

TEST_CASE("sender: a stop goes before all, is repeated with a bounded period, and ends with an idle only") {
  Bench bench;
  bench.stands(0, 0, 0);
  bench.go(0, 50);
  bench.pass(1s);
  bench.sender.stop(bench.now);
  bench.speak();
  CHECK(bench.said.back() == SetPoint{});
  const std::size_t before = bench.said.size();
  bench.pass(60s);
  CHECK(bench.said.size() - before >= 60 * 1000 / 850);  // period and jitter, in steps of 50 ms
  CHECK(bench.said.size() - before <= 10 + 60 * 1000 / 700);
  bench.at(30, 0, 0);
  CHECK(bench.sender.progress() == Progress::stopping);
  bench.idle();
  CHECK(bench.sender.progress() == Progress::stopped);
}

TEST_CASE("sender: a stop overtakes a set point that waits for the central, and follows it at once") {
  Sender sender;
  Time now = second;
  (void)sender.hear_idle(now);
  sender.hear_update({}, now);
  sender.go({0, 50}, now);
  CHECK(sender.next(now).set_point == SetPoint{0, 50});
  sender.stop(now);
  now += 2s;
  (void)sender.hear_idle(now);  // of before the set point
  CHECK(sender.next(now).kind == Kind::none);
  sender.out(now);
  CHECK(sender.next(now).set_point == SetPoint{});
  CHECK(sender.progress() == Progress::stopping);
}

TEST_CASE("sender: robots that share the radio do not keep step") {
  std::vector<Time> first, other;
  for (auto* times : {&first, &other}) {
    Sender sender{{}, times == &first ? 0U : 1U};
    sender.stop(second);
    for (Time now = second; now < second + 5s; now += 5ms)
      if (sender.next(now).kind != Kind::none) times->push_back(now), sender.out(now);
  }
  CHECK(first.size() > 10);
  CHECK(first != other);
}

TEST_CASE("sender: no leg is longer than its bound, whatever was asked for") {
  Bench bench;
  bench.stands(0, 0, 90);
  bench.go(-90, 32767);
  float x = 0;
  for (int i = 0; i < 1000 && bench.sender.progress() != Progress::reached; ++i) {
    CHECK(std::abs(bench.said.back().distance) <= longest_leg_cm);
    x += static_cast<float>(bench.said.back().distance);
    bench.pass(2s);
    bench.stands(static_cast<int>(x), 0, 0);
  }
  CHECK(x == Approx(32767).margin(8));
  CHECK(bench.sender.progress() == Progress::reached);
  CHECK(bench.said.size() == (32767 + longest_leg_cm - 1) / longest_leg_cm);
}

TEST_CASE("sender: the legs of a way are equal, aim at its end, and lead backwards, too") {
  Bench bench;
  bench.stands(0, 0, 0);
  bench.go(180, -100);
  CHECK(bench.said.back() == SetPoint{180, -50});
  bench.pass(9s);
  bench.stands(49, 3, 179);
  CHECK(bench.said.back() == SetPoint{-2, -51});
  bench.pass(9s);
  bench.stands(100, 1, -177);
  CHECK(bench.sender.progress() == Progress::reached);
}

TEST_CASE("sender: a short leg is not reached where it began") {
  Bench bench;
  bench.stands(0, 0, 0);
  bench.go(0, 5);
  bench.pass(1s);
  bench.stands(0, 0, 0);
  CHECK(bench.said.size() == 2);
  bench.go(5, 0);
  bench.pass(1s);
  bench.stands(0, 0, 0);
  CHECK(bench.sender.progress() == Progress::said);
  bench.pass(1s);
  bench.stands(0, 0, 4);
  CHECK(bench.sender.progress() == Progress::reached);
}

TEST_CASE("sender: what the place where a robot stands proves of its leg, at the ends of what counts") {
  struct Case {
    SetPoint wanted;
    Update stands;  ///< x, y and heading; it began at 0, 0, 0
    Progress progress;
    bool blocked = false;
    SetPoint again{};  ///< what is said to it then
  };
  using enum Progress;
  const auto place = [](int x, int y, int heading) {
    Update update{};
    update.x = static_cast<std::int16_t>(x), update.y = static_cast<std::int16_t>(y);
    update.heading = static_cast<std::int16_t>(heading);
    return update;
  };
  const Case cases[] = {
      // There: within 8 cm and 8 degrees.
      {{0, 50}, place(42, 0, 0), reached},
      {{0, 50}, place(50, 8, 0), reached},
      {{0, 50}, place(50, 0, 8), reached},
      {{0, 50}, place(50, 0, -8), reached},
      // On its way, headed there: something is in front of it.
      {{0, 50}, place(41, 0, 0), ended, true},
      {{0, 50}, place(2, 0, 0), ended, true},
      {{0, 50}, place(50, 0, 9), ended, true},
      {{0, 50}, place(50, 0, 15), ended, true},
      {{0, 12}, place(6, 8, 0), ended, true},  // 10 cm and 10 cm: 8 more than the way
      {{0, 12}, place(6, 9, 0), said, false, {0, 6}},
      // Not heard: less than 2 cm away.
      {{0, 50}, place(1, 0, 0), said, false, {0, 49}},
      {{0, 50}, place(-1, 0, 0), said, false, {0, 51}},
      {{0, 50}, place(0, 0, 14), said, false, {-14, 50}},
      // Elsewhere: from there to the aim, straight if that is ahead of it.
      {{0, 50}, place(-2, 0, 0), said, false, {0, 52}},
      {{0, 50}, place(50, 0, 16), said, false, {-16, 0}},
      {{0, 60}, place(30, 0, 16), said, false, {-16, 30}},
      {{0, 60}, place(30, 10, 16), said, false, {-34, 32}},
      {{0, 60}, place(30, 12, 16), said, false, {-16, 30}},
      {{0, 60}, place(23, 13, 16), said, false, {-35, 39}},  // 19.4 degrees aside
      {{0, 60}, place(28, 12, 16), said, false, {-16, 32}},  // 20.6
      {{0, 60}, place(50, 3, 16), said, false, {-33, 10}},   // 10.4 cm left
      {{0, 60}, place(51, 3, 16), said, false, {-16, 9}},    // 9.5
      {{0, 30}, place(20, 14, 0), said, false, {0, 10}},
      // Backwards the same, the other way round.
      {{0, -50}, place(-42, 0, 0), reached},
      {{0, -50}, place(-41, 0, 0), ended, true},
      {{0, -50}, place(2, 0, 0), said, false, {0, -52}},
      // Turns: within 8 degrees; heard from 15 degrees or half of it on.
      {{90, 0}, place(0, 0, 82), reached},
      {{90, 0}, place(0, 0, 81), said, false, {9, 0}},
      {{90, 0}, place(0, 0, 14), said, false, {76, 0}},
      {{5, 0}, place(0, 0, 3), reached},
      {{5, 0}, place(0, 0, 2), said, false, {3, 0}},
      {{4, 0}, place(0, 0, 2), reached},
      {{4, 0}, place(0, 0, 1), said, false, {3, 0}},
      {{5, 0}, place(4, 0, 3), reached},  // 4 cm aside is there, if half of the turn is done
      {{6, 0}, place(4, 0, 3), reached},
      {{4, 0}, place(4, 0, 2), said, false, {2, 0}},
      // Short ways: half of one is not near enough, and what a robot itself takes for there is.
      {{0, 2}, place(0, 0, 0), said, false, {0, 2}},
      {{0, 2}, place(1, 0, 0), reached},
      {{0, 2}, place(4, 0, 0), reached},
      {{0, 3}, place(1, 0, 0), said, false, {0, 2}},
      {{0, 3}, place(2, 0, 0), reached},
      {{0, 2}, place(2, 3, 0), reached},  // heard, and 3 cm away
      {{0, 2}, place(1, 3, 0), said, false, {0, 1}},
      {{0, 2}, place(6, 0, 0), said, false, {0, -4}},
      {{0, 3}, place(2, 4, 0), ended, true},  // no shorter one is said to be blocked
  };
  for (std::size_t i = 0; i < std::size(cases); ++i) {
    const Case& each = cases[i];
    CAPTURE(i, each.wanted.angle, each.wanted.distance, each.stands.x, each.stands.y, each.stands.heading);
    Bench bench;
    bench.stands(0, 0, 0);
    bench.go(each.wanted.angle, each.wanted.distance);
    REQUIRE(bench.said == std::vector<SetPoint>{each.wanted});
    bench.pass(9s);
    bench.stands(each.stands.x, each.stands.y, each.stands.heading);
    CHECK(static_cast<int>(bench.sender.progress()) == static_cast<int>(each.progress));
    CHECK(bench.sender.blocked() == each.blocked);
    REQUIRE(bench.said.size() == (each.progress == said ? 2 : 1));
    if (each.progress == said) CHECK(bench.said.back() == each.again);
  }
}

TEST_CASE("sender: the legs of a way are as few as their bound permits") {
  struct Case {
    int way, leg;
  };
  for (const Case& each : {Case{1, 1}, Case{60, 60}, Case{61, 30}, Case{120, 60}, Case{121, 40},
                           Case{-60, -60}, Case{-61, -30}, Case{-121, -40}}) {
    Bench bench;
    bench.stands(0, 0, 0);
    bench.go(0, each.way);
    CHECK(bench.said.back() == SetPoint{0, static_cast<std::int16_t>(each.leg)});
  }
}

TEST_CASE("sender: after three corrections that lead elsewhere it is given up, and nothing is blamed") {
  Bench bench;
  bench.stands(0, 0, 0);
  bench.go(90, 0);
  for (int i = 1; i <= 3; ++i) {
    bench.pass(9s);
    bench.stands(0, 0, 90 + 40 * (i % 2 == 0 ? 1 : -1));
    CHECK(bench.sender.progress() == Progress::said);
    CHECK(bench.said.size() == 1U + static_cast<unsigned>(i));
  }
  bench.pass(9s);
  bench.stands(0, 0, 130);
  CHECK(bench.sender.progress() == Progress::ended);
  CHECK_FALSE(bench.sender.blocked());
  CHECK(bench.sender.off_deg() == Approx(40));
  bench.go(90, 0);  // the next has three of its own
  bench.pass(9s);
  bench.stands(0, 0, 180);
  CHECK(bench.sender.progress() == Progress::said);
  CHECK(bench.said.back() == SetPoint{40, 0});
}

TEST_CASE("sender: each leg of a way has three corrections of its own") {
  Bench bench;
  bench.stands(0, 0, 0);
  bench.go(0, 120);
  CHECK(bench.said.back() == SetPoint{0, 60});
  const auto stands = [&bench](int x, int heading) {
    bench.pass(9s);
    bench.stands(x, 0, heading);
  };
  stands(5, 40);
  CHECK(bench.said.back() == SetPoint{-40, 58});
  stands(10, 40);
  CHECK(bench.said.back() == SetPoint{-40, 55});
  stands(15, 40);
  CHECK(bench.said.back() == SetPoint{-40, 53});
  stands(68, 0);  // the end of the first leg
  CHECK(bench.said.back() == SetPoint{0, 52});
  stands(75, 40);
  CHECK(bench.sender.progress() == Progress::said);
  CHECK(bench.said.back() == SetPoint{-40, 45});
}

TEST_CASE("sender: when a stop is said again, and when a robot that was not heard of is stopped") {
  Sender sender{{.period = 300ms, .slow_period = 700ms, .quick = 2, .jitter = 0ms}};
  sender.stop(second);
  std::vector<int> times;
  for (int ms = 0; ms < 3000; ++ms) {
    const Time now = second + ms * 1ms;
    if (sender.next(now).kind == Kind::none) continue;
    times.push_back(ms);
    sender.out(now);
  }
  CHECK(times == std::vector{0, 300, 1000, 1700, 2400});
  Sender waits;
  waits.go({0, 20}, second);
  CHECK(waits.next(second + 1199ms).kind == Kind::none);
  CHECK(waits.next(second + 1200ms).set_point == SetPoint{});
  // One that stands and says no update is unpaused after three seconds.
  Sender unseen;
  unseen.go({0, 20}, second);
  REQUIRE(unseen.hear_idle(second + 1s));
  CHECK(unseen.next(second + 4s - 1ns).kind == Kind::none);
  CHECK(unseen.next(second + 4s).kind == Kind::unpause);
  // It counts from the question, if the robot has stood for longer.
  Sender stood;
  REQUIRE(stood.hear_idle(second));
  stood.go({0, 20}, second + 10s);
  CHECK(stood.next(second + 13s - 1ns).kind == Kind::none);
  CHECK(stood.next(second + 13s).kind == Kind::unpause);
}

TEST_CASE("sender: a robot that says idle but not where it is, is unpaused") {
  Bench bench;
  bench.go(0, 20);
  for (int i = 0; i < 4; ++i) bench.pass(1s), bench.idle();
  CHECK(bench.said.empty());
  CHECK(bench.unpauses > 0);
  bench.at(0, 0, 0);
  CHECK(bench.said == std::vector<SetPoint>{{0, 20}});
}

TEST_CASE("sender: a handshake makes void what was asked for") {
  Bench bench;
  bench.stands(0, 0, 0);
  bench.go(0, 20);
  bench.sender.restart();
  CHECK(bench.sender.progress() == Progress::none);
  bench.pass(5s);
  CHECK(bench.said.size() == 1);
  CHECK_FALSE(bench.sender.standing());
  bench.go(0, 20);
  bench.sender.restart();
  CHECK(bench.sender.progress() == Progress::waiting);
  bench.stands(0, 0, 0);
  CHECK(bench.said.back() == SetPoint{0, 20});
}

TEST_CASE("sender: a stop is said ten times quickly, then slowly, with up to 100 ms on top") {
  Sender sender{{.jitter = 0ms}};
  sender.stop(second);
  std::vector<int> times;
  for (int ms = 0; ms < 5000; ++ms) {
    const Time now = second + ms * 1ms;
    if (sender.next(now).kind == Kind::none) continue;
    times.push_back(ms);
    sender.out(now);
  }
  CHECK(times == std::vector{0, 300, 600, 900, 1200, 1500, 1800, 2100, 2400, 2700, 3400, 4100, 4800});
  int least = 500, most = 0;
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    Sender one{{}, seed};
    one.stop(second);
    REQUIRE(one.next(second).kind == Kind::set_point);
    one.out(second);
    int ms = 300;
    while (ms < 500 && one.next(second + ms * 1ms).kind == Kind::none) ++ms;
    least = ms < least ? ms : least;
    most = ms > most ? ms : most;
  }
  CHECK(least < 310);
  CHECK(most > 390);
  CHECK(most <= 400);
}

TEST_CASE("sender: a turn is heard from half of it or 15 degrees on, a way from 2 cm on") {
  struct Case {
    SetPoint wanted;
    int x, heading;  ///< where the robot is then
    bool heard;
  };
  for (const Case& each :
       {Case{{90, 0}, 0, 14, false}, Case{{90, 0}, 0, 15, true}, Case{{-90, 0}, 0, -15, true},
        Case{{20, 0}, 0, 9, false}, Case{{20, 0}, 0, 10, true}, Case{{5, 0}, 0, 2, false},
        Case{{5, 0}, 0, 3, true}, Case{{4, 0}, 0, 4, false}, Case{{0, 50}, 0, 90, false},
        Case{{0, 50}, 1, 0, false}, Case{{0, 50}, 2, 0, true}}) {
    CAPTURE(each.wanted.angle, each.wanted.distance, each.x, each.heading);
    Bench bench;
    bench.stands(0, 0, 0);
    bench.go(each.wanted.angle, each.wanted.distance);
    bench.pass(1s);
    bench.at(each.x, 0, each.heading);
    CHECK((bench.sender.progress() == Progress::heard) == each.heard);
  }
}

TEST_CASE("sender: after a handshake neither a place nor a word that was on its way counts") {
  Sender stood;
  REQUIRE(stood.hear_idle(second));
  stood.hear_update({}, second);
  REQUIRE(stood.placed());
  stood.restart();
  CHECK_FALSE(stood.standing());
  CHECK_FALSE(stood.placed());
  // A set point that the central has not sent yet.
  Sender asked;
  REQUIRE(asked.hear_idle(second));
  asked.hear_update({}, second);
  asked.go({0, 20}, second);
  REQUIRE(asked.next(second).set_point == SetPoint{0, 20});
  CHECK_FALSE(asked.hear_idle(second + 5s));
  asked.restart();
  asked.go({0, 30}, second + 5s);
  const auto word = asked.next(second + 6200ms);
  CHECK(word.kind == Kind::set_point);
  CHECK(word.set_point == SetPoint{});
  CHECK(asked.hear_idle(second + 6200ms));
}

TEST_CASE("sender: an idle that answers a pause proves nothing of a set point") {
  Sender sender;
  REQUIRE(sender.hear_idle(second));
  sender.hear_update({}, second);
  sender.go({0, 20}, second);
  REQUIRE(sender.next(second).kind == Kind::set_point);
  sender.out(second);
  sender.disturbed(second + 5s);
  CHECK_FALSE(sender.hear_idle(second + 5s + SenderOptions{}.settle - 1ns));
  CHECK(sender.hear_idle(second + 5s + SenderOptions{}.settle));
}

TEST_CASE("sender: a stop is said once at least, asked for twice it is one, and nowhere to go is one") {
  Sender sender;
  sender.stop(second);
  CHECK(sender.hear_idle(second));  // it was not said yet
  CHECK(sender.next(second).kind == Kind::set_point);
  CHECK(sender.next(second).kind == Kind::none);
  CHECK(sender.progress() == Progress::stopped);
  Sender twice;
  twice.stop(second);
  REQUIRE(twice.next(second).kind == Kind::set_point);
  twice.out(second);
  twice.stop(second + 100ms);
  CHECK(twice.next(second + 100ms).kind == Kind::none);
  CHECK(twice.times_said() == 1);
  Sender nowhere;
  nowhere.go({0, 0}, second);
  CHECK(nowhere.progress() == Progress::stopping);
  CHECK(nowhere.next(second).set_point == SetPoint{});
}

}  // namespace mapper_server_sender_test
