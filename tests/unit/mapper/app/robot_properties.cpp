// What holds for a mapper whatever operators, links and parts do.
#include <cmath>
#include <random>
#include <span>
#include <string>
#include <string_view>

#include <catch2/catch.hpp>

#include "ocm/mapper/app/robot.hpp"
#include "ocm/mapper/link/sentence_reader.hpp"

#include "unit/base/explore.hpp"
#include "unit/mapper/app/app_testing.hpp"

namespace mapper_app_robot_properties_test {

using namespace app_testing;

const auto random_runs = static_cast<std::uint32_t>(ocm::test::explored(40));

/// An operator without sense, on a link that comes and goes, with parts that fail now and then.
template <class Bench>
class Chaos {
 public:
  Chaos(Bench& bench, std::uint32_t seed) : bench_(&bench), random_(seed) {}

  void step() {
    if (one_in(700)) bench_->link(!bench_->parts.link);
    if (one_in(2000)) bench_->parts.link = !bench_->parts.link;  // without a report
    if (one_in(3000)) bench_->parts.gyro_missing = !bench_->parts.gyro_missing;
    if (one_in(3000)) bench_->parts.compass_missing = !bench_->parts.compass_missing;
    if (one_in(3000)) bench_->parts.infrared_missing[random_() % 4] ^= true;
    if (one_in(3000)) bench_->parts.room = one_in(2) ? 10'000 : random_() % 20;
    if (one_in(5000)) wall_ = one_in(2) ? 200.0F : 5.0F + static_cast<float>(random_() % 60);
    if (one_in(60)) bench_->say(sentence());
    if (one_in(500)) bench_->robot.receive(static_cast<std::uint8_t>(random_()));
  }
  /// What an interrupt of the robot's may be.
  void interrupt() {
    if (one_in(30)) bench_->link(!bench_->parts.link);
    if (one_in(6)) bench_->say(sentence());
  }
  [[nodiscard]] float wall() const { return wall_; }
  bool one_in(std::uint32_t n) { return random_() % n == 0; }

 private:
  std::string sentence() {
    constexpr std::string_view words[] = {"{S,CON}\n", "{S,CON}\n", "{S,PAU}\n", "{S,UNP}\n",
                                          "{S,BIN}\n", "{S,TXT}\n", "{U,0,0}\n", "{}\n",
                                          "{U,1",      "0,30}\n",   "{S,CON",    "{C,0}\n"};
    const std::uint32_t which = random_() % 16;
    if (which < std::size(words)) return std::string{words[which]};
    if (one_in(20)) return "{C," + std::to_string(random_() % 10'000) + "}\n";
    const int angle = static_cast<int>(random_() % 721) - 360;
    const int distance = static_cast<int>(random_() % 100) - 50;
    return "{U," + std::to_string(angle) + "," + std::to_string(distance) + "}\n";
  }

  Bench* bench_;
  std::mt19937 random_;
  float wall_ = 200.0F;
};

template <class Bench>
void survives(std::uint32_t seeds, int time_ms) {
  std::uint64_t driven = 0;
  std::uint32_t returns = 0;
  for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
    RobotModel model = seed % 2 == 0 ? mapper::app::avr_robot : mapper::app::arduino_robot;
    model.times.return_after = seed % 3 == 0 ? 500ms : 0ms;
    model.measuring.samples = 16;
    model.times.calibration_limit = 3s;
    Bench bench{model};
    Chaos<Bench> chaos{bench, seed};
    if constexpr (requires { bench.port.between; }) {
      // Between two critical sections there may be an interrupt, and then whatever is more urgent.
      bench.port.between = [&bench, &chaos, inside = false]() mutable {
        if (inside || !chaos.one_in(40)) return;
        inside = true;
        chaos.interrupt();
        if (bench.port.running == scheduling::level_count) {
          inside = false;
          return;
        }
        bench.now += 1ms;
        bench.parts.step();
        bench.port.advance(bench.now);
        if (bench.port.armed() <= bench.now) bench.robot.expire();
        inside = false;
        bench.work();
      };
    }
    bench.parts.distance = [&chaos](float) { return chaos.wall(); };
    // Idle is no lie at the moment when it is said.
    std::uint64_t lies = 0;
    bench.parts.on_send = [&](std::span<const std::uint8_t> bytes) {
      const bool idle = bytes.size() == 8 && bytes[3] == 'I';
      lies += idle && bench.robot.busy() && !bench.is(State::paused) ? 1 : 0;
    };
    CAPTURE(seed);
    for (int ms = 0; ms < time_ms; ++ms) {
      chaos.step();
      [[maybe_unused]] const State before = bench.robot.state();
      [[maybe_unused]] const bool was_linked = bench.parts.link;
      bench.heard();
      bench.step();
      const State after = bench.robot.state();

      // Motors turn only in a state that lets them.
      if (!mapper::app::may_drive(after)) REQUIRE(bench.parts.efforts == motion::Efforts{});
      REQUIRE(std::fabs(bench.parts.efforts.left) <= 1.0F);
      REQUIRE(std::fabs(bench.parts.efforts.right) <= 1.0F);
      driven += bench.parts.efforts != motion::Efforts{} ? 1 : 0;
      // Nothing is said without a link, no update but to an operator who confirmed and does not pause. (Where
      // links come and go within a step, this says nothing.)
      if constexpr (!requires { bench.port.between; }) {
        if (!was_linked) REQUIRE(bench.parts.sent.empty());
        const auto in = [&](State state) { return before == state || after == state; };
        if (bench.heard("{U") > 0) REQUIRE(in(State::confirmed));
        if (bench.heard("{H") > 0) REQUIRE(in(State::connected));
      }
      // The tower is where it can be.
      REQUIRE(bench.parts.servo_deg >= 0);
      REQUIRE(bench.parts.servo_deg <= 90);
      REQUIRE(motion::is_finite(bench.robot.pose()));
    }
    const auto counters = bench.robot.counters();
    CHECK(counters.links >= counters.links_lost);
    CHECK(counters.links <= counters.links_lost + 1);
    CHECK(counters.arrived <= counters.set_points);
    CHECK(counters.overload == scheduling::Overload{});
    CHECK(counters.control_skipped == 0);
    CHECK(lies == 0);
    returns += counters.returns;

    if constexpr (requires { bench.port.between; }) bench.port.between = nullptr;
    // And with sense again it is as good as new.
    bench.parts.gyro_missing = bench.parts.compass_missing = false;
    bench.parts.infrared_missing = {};
    bench.parts.room = 10'000;
    bench.parts.distance = [](float) { return 200.0F; };
    bench.link(false);
    bench.run_for(90s);  // home, if it has to
    bench.link(true);
    bench.run_for(300ms);
    bench.say("\n{S,CON}\n");
    bench.run_for(50ms);
    REQUIRE(bench.is(State::confirmed));
    const motion::Pose from = bench.parts.pose;
    REQUIRE(bench.drive("{U,0,20}\n"));
    bench.run_for(500ms);
    CHECK(std::hypot(bench.parts.pose.x_m - from.x_m, bench.parts.pose.y_m - from.y_m) > 0.17F);
    CHECK(std::hypot(bench.parts.pose.x_m - from.x_m, bench.parts.pose.y_m - from.y_m) < 0.23F);
  }
  CHECK(driven > 2000 * seeds);
  CHECK(returns > seeds / 3);
}

TEST_CASE("mapper: random operators, links and faults", "[mapper][properties]") {
  survives<Bench>(random_runs, 60'000);
}
TEST_CASE("mapper: the same with levels that preempt each other anywhere", "[mapper][properties]") {
  survives<BasicBench<Preemptive>>(random_runs, 60'000);
}

/// A robot that turns by 20 degrees; at the `nth` end of a critical section of the pose controller since then
/// comes another set point. How many there were when the robot stood; 0: the second one came before.
int turn_twice(int nth, bool& idle_was_no_lie) {
  BasicBench<Preemptive> bench;
  bench.confirm();
  bench.say("{U,20,0}\n");
  bench.run_for(50ms);
  bench.heard();
  int ends = 0;
  bool came = false;
  bench.port.between = [&, inside = false]() mutable {
    if (inside || bench.port.running != static_cast<std::size_t>(scheduling::Level::medium)) return;
    inside = true;
    if (ends++ == nth) {
      bench.heard();
      bench.preempt("{U,30,0}\n");
      came = true;
    }
    inside = false;
  };
  REQUIRE(bench.run_until([&] { return came || !bench.robot.busy(); }, 10s));
  if (!came) return ends;
  bench.run_for(200ms);
  idle_was_no_lie = bench.heard("IDL") == 0 && bench.robot.busy();
  return 0;
}

TEST_CASE("mapper: a set point that comes in the moment of the arrival is not called done",
          "[mapper][properties]") {
  bool good = true;
  const int all = turn_twice(1'000'000, good);
  REQUIRE(all > 100);
  for (int nth = all - 12; nth < all; ++nth) {
    CAPTURE(all, nth);
    CHECK(turn_twice(nth, good) == 0);
    CHECK(good);
  }
}

TEST_CASE("mapper: stopped in the middle of a control step, it is stopped", "[mapper][properties]") {
  for (int nth = 0; nth < 10; ++nth) {
    BasicBench<Preemptive> bench;
    bench.confirm();
    bench.say("{U,0,100}\n");
    bench.run_for(2s);
    int ends = 0;
    bench.port.between = [&bench, &ends, nth, inside = false]() mutable {
      if (inside || bench.port.running != static_cast<std::size_t>(scheduling::Level::medium)) return;
      inside = true;
      if (ends++ == nth) bench.preempt("{U,0,0}\n");
      inside = false;
    };
    REQUIRE(bench.run_until([&] { return ends > nth; }, 1s));
    CAPTURE(nth);
    CHECK_FALSE(bench.robot.busy());
    bench.each_step = [&] { REQUIRE(bench.parts.efforts == motion::Efforts{}); };
    bench.run_for(200ms);
    CHECK(bench.heard("{S,IDL}\n") == 1);
  }
}

TEST_CASE("mapper: a link that dies in the moment of its confirmation leaves the place as it was",
          "[mapper][properties]") {
  int refused = 0;
  for (int nth = 0; nth < 20; ++nth) {
    CAPTURE(nth);
    BasicBench<Preemptive> bench;
    bench.confirm();
    bench.say("{U,0,50}\n");
    bench.run_for(50ms);
    REQUIRE(bench.run_until([&] { return !bench.robot.busy(); }, 30s));
    bench.link(false);
    bench.run_for(200ms);
    bench.link(true);
    bench.run_for(300ms);
    REQUIRE(bench.is(State::connected));
    const motion::Pose before = bench.robot.pose();
    REQUIRE(before.x_m > 0.4F);
    const auto refusals = bench.robot.counters().refused;
    int ends = 0;
    bench.port.between = [&bench, &ends, nth, inside = false]() mutable {
      if (inside || bench.port.running != static_cast<std::size_t>(scheduling::Level::high)) return;
      inside = true;
      if (ends++ == nth) bench.link(false);
      inside = false;
    };
    bench.say("{S,CON}\n");
    bench.run_for(100ms);
    bench.port.between = nullptr;
    if (bench.robot.counters().refused == refusals) continue;  // it was confirmed, or never heard
    ++refused;
    CHECK(std::fabs(bench.robot.pose().x_m - before.x_m) < 0.01F);
  }
  CHECK(refused > 0);
}

}  // namespace mapper_app_robot_properties_test
