#include "ocm/mapper/server/calibrator.hpp"

#include <chrono>
#include <vector>

#include <catch2/catch.hpp>

namespace mapper_server_calibrator_test {

using namespace std::chrono_literals;
using ocm::base::Duration;
using ocm::base::Time;
using ocm::mapper::link::Calibration;
using ocm::mapper::server::Calibrator;
using Phase = Calibrator::Phase;

/// A calibrator, and what it says.
struct Bench {
  Calibrator calibrator;
  Time now{1s};
  std::vector<int> said{};

  void speak() {
    while (const auto word = calibrator.next(now)) said.push_back(word->number);
  }
  void begin(bool only_ask = false) { calibrator.begin(now, only_ask), speak(); }
  void pass(Duration time) {
    for (const Time end = now + time; now < end;) now += 50ms, speak();
  }
  void hear(Calibration sentence) { calibrator.hear(sentence, now), speak(); }
  [[nodiscard]] Phase phase() const { return calibrator.phase(); }
};

constexpr Calibration knows(int number, int verdict = Calibration::none) {
  return {.number = static_cast<std::int16_t>(number), .verdict = static_cast<std::int16_t>(verdict)};
}
constexpr Calibration good(int number, std::int16_t use = Calibration::stored) {
  return {static_cast<std::int16_t>(number), Calibration::good, 41, -57, 152, 1, use};
}

TEST_CASE("calibrator: asks, orders the next number, waits, and has the result") {
  Bench bench;
  CHECK(bench.phase() == Phase::none);
  bench.begin();
  CHECK(bench.said == std::vector{0});
  bench.hear(knows(4, Calibration::disturbed));
  CHECK(bench.said == std::vector{0, 5});
  CHECK(bench.phase() == Phase::ordering);
  CHECK(bench.calibrator.may_turn());
  for (int second = 0; second < 8; ++second) {
    bench.hear(knows(5, Calibration::turning));
    bench.pass(1s);
  }
  CHECK(bench.phase() == Phase::turning);
  CHECK(bench.said == std::vector{0, 5});  // a robot that is heard is not asked
  bench.hear(good(5));
  CHECK(bench.phase() == Phase::done);
  CHECK(bench.calibrator.result() == good(5));
  CHECK_FALSE(bench.calibrator.may_turn());
  bench.pass(5s);
  CHECK(bench.said.size() == 2);
}

TEST_CASE("calibrator: each word is said until it is answered, and copies of a word are the same word") {
  Bench bench;
  bench.begin();
  bench.pass(2100ms);
  CHECK(bench.said == std::vector{0, 0, 0, 0});
  bench.hear(knows(0));
  bench.said.clear();
  bench.pass(2800ms);
  CHECK(bench.said == std::vector{1, 1, 1, 1});
  bench.hear(knows(0));  // of before the order
  CHECK(bench.phase() == Phase::ordering);
  bench.hear(knows(1, Calibration::turning));
  bench.said.clear();
  bench.pass(1400ms);
  CHECK(bench.said.empty());
  bench.pass(900ms);  // nothing of it for more than a second: the end may be lost
  CHECK(bench.said == std::vector{1, 1});
  bench.hear(knows(1, Calibration::weak));
  CHECK(bench.phase() == Phase::done);
  CHECK(bench.calibrator.result().verdict == Calibration::weak);
}

TEST_CASE("calibrator: all of the turn unheard: the result is enough") {
  Bench bench;
  bench.begin();
  bench.hear(knows(9999));
  CHECK(bench.said == std::vector{0, 1});  // after the last number comes the first, not 0, which only asks
  bench.pass(10s);
  bench.hear(good(1));
  CHECK(bench.phase() == Phase::done);
}

TEST_CASE("calibrator: one that another program has begun will do") {
  Bench bench;
  bench.begin();
  bench.hear(knows(3, Calibration::turning));
  CHECK(bench.phase() == Phase::turning);
  bench.hear(good(3));
  CHECK(bench.phase() == Phase::done);
  CHECK(bench.said == std::vector{0});
}

TEST_CASE("calibrator: a result that is not stored yet is asked for again, for a while") {
  for (const bool stores : {true, false}) {
    Bench bench;
    bench.begin();
    bench.hear(knows(0));
    bench.hear(good(1, Calibration::until_off));
    CHECK(bench.phase() == Phase::storing);
    CHECK_FALSE(bench.calibrator.may_turn());
    bench.pass(400ms);
    CHECK(bench.said == std::vector{0, 1, 1});
    bench.hear(good(1, stores ? Calibration::stored : Calibration::until_off));
    CHECK((bench.phase() == Phase::done) == stores);
    for (int i = 0; i < 5; ++i) {
      bench.pass(1s);
      bench.hear(good(1, Calibration::until_off));
    }
    CHECK(bench.phase() == Phase::done);
    CHECK(bench.calibrator.result().use == (stores ? Calibration::stored : Calibration::until_off));
  }
  Bench silent;  // and one that says nothing more is not waited for without end
  silent.begin();
  silent.hear(knows(0));
  silent.hear(good(1, Calibration::until_off));
  silent.pass(10s);
  CHECK(silent.phase() == Phase::done);
}

TEST_CASE("calibrator: only to ask begins nothing") {
  Bench bench;
  bench.begin(true);
  bench.hear(good(7, Calibration::until_off));
  CHECK(bench.phase() == Phase::done);
  CHECK(bench.calibrator.result() == good(7, Calibration::until_off));
  CHECK(bench.said == std::vector{0});
}

TEST_CASE("calibrator: void after a handshake, a lost link or a stop") {
  Bench bench;
  bench.begin();
  bench.hear(knows(0));
  bench.calibrator.restart();
  bench.pass(5s);
  bench.hear(good(1));
  CHECK(bench.phase() == Phase::none);
  CHECK(bench.said == std::vector{0, 1});
}

TEST_CASE("calibrator: begun again it knows nothing of before") {
  Bench bench;
  bench.begin();
  bench.hear(knows(0));
  bench.hear(good(1));
  REQUIRE(bench.phase() == Phase::done);
  REQUIRE(bench.calibrator.times_said() == 2);
  bench.begin();
  CHECK(bench.phase() == Phase::asking);
  CHECK(bench.calibrator.times_said() == 1);
  CHECK(bench.calibrator.result() == Calibration{});
  bench.hear(good(1));
  CHECK(bench.said == std::vector{0, 1, 0, 2});
}

/// At which milliseconds behind `from` something is said.
std::vector<int> times_of(Calibrator& calibrator, Time from, int until_ms) {
  std::vector<int> times;
  for (int ms = 0; ms < until_ms; ++ms)
    if (calibrator.next(from + ms * 1ms)) times.push_back(ms);
  return times;
}

TEST_CASE("calibrator: when each word is said, to the millisecond") {
  Calibrator calibrator;
  calibrator.begin(Time{1s});
  CHECK(times_of(calibrator, Time{1s}, 1500) == std::vector{0, 700, 1400});
  calibrator.hear(knows(0), Time{3s});
  CHECK(times_of(calibrator, Time{3s}, 1500) == std::vector{0, 700, 1400});
  calibrator.hear(knows(1, Calibration::turning), Time{5s});
  CHECK(times_of(calibrator, Time{5s}, 2300) == std::vector{1500, 2200});
  calibrator.hear(good(1, Calibration::until_off), Time{8s});
  CHECK(times_of(calibrator, Time{8s}, 1100) == std::vector{350, 1050});
  CHECK(calibrator.times_said() == 3 + 3 + 2 + 2);
}

TEST_CASE("calibrator: a result may be stored for four seconds, and one that is silent has four more") {
  Calibrator answers;
  answers.begin(Time{1s});
  answers.hear(knows(0), Time{1s});
  answers.hear(good(1, Calibration::until_off), Time{2s});
  answers.hear(good(1, Calibration::until_off), Time{6s} - 1ns);
  CHECK(answers.phase() == Phase::storing);
  Calibrator silent = answers;
  answers.hear(good(1, Calibration::until_off), Time{6s});
  CHECK(answers.phase() == Phase::done);
  (void)silent.next(Time{10s} - 1ns);
  CHECK(silent.phase() == Phase::storing);
  (void)silent.next(Time{10s});
  CHECK(silent.phase() == Phase::done);
  CHECK(silent.result() == good(1, Calibration::until_off));
}

}  // namespace mapper_server_calibrator_test
