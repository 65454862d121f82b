// The controller's tasks and levels: with the cooperative port, and on a processor in virtual time whose
// levels preempt.
#include <optional>

#include <catch2/catch.hpp>

#include "ocm/protocol/request.hpp"
#include "ocm/simulation/cpu.hpp"

#include "unit/controller/fixture.hpp"

namespace controller_controller_ports_test {

using namespace fixture;
using scheduling::Level;
using scheduling::Release;

using WithTasks = controller::Controller<amiro::DiWheelDrive, Mailboxes, scheduling::Cooperative, 2>;

/// A controller whose levels run on a virtual processor. What a job does is done when it is taken; then its
/// level is busy for `busy`.
struct OnCpu {
  simulation::Cpu cpu;
  Mailboxes bus;
  controller::Controller<amiro::DiWheelDrive, Mailboxes, simulation::Cpu, 1> controller{bus, cpu};
  std::vector<std::pair<Level, base::Time>> ran;

  OnCpu() {
    cpu.attach([this] { controller.expire(); },
               [this](Level level) -> std::optional<simulation::Cpu::Job> {
                 ran.emplace_back(level, cpu.now());
                 controller.run(level);
                 return std::nullopt;
               });
    controller.serve<amiro::Gyroscope>([] {
      return base::Result<amiro::Gyroscope>{amiro::Gyroscope{1, 2, 3}};
    });
    controller.serve<amiro::Magnetometer>([] {
      return base::Result<amiro::Magnetometer>{amiro::Magnetometer{{1}, {2}, {3}}};
    });
  }
  void say(std::string_view text, base::Duration when) {
    cpu.at(at(when), [this, text] { controller.receive(frame(text), cpu.now()); });
  }
};

TEST_CASE("a board's own tasks run on their grid, and before samples of the same level and moment") {
  Mailboxes bus;
  WithTasks controller{bus, at(1s)};
  std::vector<std::string> order;
  std::vector<base::Time> grid;
  controller.serve<amiro::Gyroscope>([&] {
    order.emplace_back("sample");
    return base::Result<amiro::Gyroscope>{amiro::Gyroscope{}};
  });
  controller.every<0>(50ms, Level::medium, [&] { order.emplace_back("task"); });
  controller.every<1>(20ms, Level::urgent,
                      [&](const Release& release) { grid.push_back(release.scheduled); });
  controller.receive(frame("208#01320000"), at(1s));  // every 50 ms, medium
  for (base::Time now = at(1s); now <= at(1100ms); now = controller.next_event()) controller.poll(now);
  CHECK(order == std::vector<std::string>{"task", "sample", "task", "sample", "task", "sample"});
  CHECK(grid ==
        std::vector<base::Time>{at(1000ms), at(1020ms), at(1040ms), at(1060ms), at(1080ms), at(1100ms)});
}

TEST_CASE("a task that is not served in time is counted as its own, not among the topics") {
  Mailboxes bus;
  WithTasks controller{bus};
  int calls = 0;
  controller.every<0>(10ms, Level::low, [&] { ++calls; });
  controller.poll(at(0ms));
  controller.poll(at(45ms));
  CHECK(calls == 2);
  CHECK(controller.task_overload(0) == scheduling::Overload{3, 1, 0});
  CHECK(controller.task_overload(1) == scheduling::Overload{});
  CHECK(controller.counters().missed == 0);
  CHECK(controller.counters().late == 0);
}

TEST_CASE("what the second task could not keep up with is the second's") {
  Mailboxes bus;
  WithTasks controller{bus};
  int calls = 0;
  controller.every<1>(10ms, Level::low, [&] { ++calls; });
  controller.poll(at(0ms));
  controller.poll(at(45ms));
  CHECK(calls == 2);
  CHECK(controller.task_overload(1) == scheduling::Overload{3, 1, 0});
  CHECK(controller.task_overload(0) == scheduling::Overload{});
}

TEST_CASE("overload of the first sensor is in the sum, too") {
  Board board;
  board.controller.serve<amiro::Odometry>([] { return base::Result<amiro::Odometry>{amiro::Odometry{}}; });
  board.receive("203#010A0000", 0s);  // every 10 ms
  board.controller.poll(at(35ms));
  CHECK(board.controller.overload(0) == scheduling::Overload{2, 1, 0});
  CHECK(board.controller.counters().missed == 2);
  CHECK(board.controller.counters().late == 1);
}

TEST_CASE("a frame says how late it is: what could not be kept up with until then is counted") {
  Board board;
  board.receive("208#010A0000", 0s);  // every 10 ms
  CHECK(board.controller.counters().missed == 0);
  board.controller.receive(frame("21F#02"), at(35ms));  // of another board
  CHECK(board.controller.counters().missed == 2);       // 10 and 20; the one at 30 can still be taken
  CHECK(board.controller.next_event() == at(10ms));
}

TEST_CASE("overload is counted for each topic, and in sum") {
  Board board;
  board.receive("208#010A0000", 0s);  // every 10 ms
  board.receive("205#01640000", 0s);  // every 100 ms
  board.controller.poll(at(35ms));
  constexpr std::size_t magnetometer = 2, gyroscope = 3;  // in DiWheelDrive::sensors
  CHECK(board.controller.overload(gyroscope).missed == 2);
  CHECK(board.controller.overload(magnetometer).missed == 0);
  CHECK(board.controller.counters().missed == 2);
  CHECK(board.controller.active(gyroscope));
  board.receive("208#00", 40ms);
  CHECK_FALSE(board.controller.active(gyroscope));
  CHECK(board.controller.active(magnetometer));
}

TEST_CASE("a request's level is the context that serves it, and the next request moves it") {
  OnCpu board;
  board.say("308#010A0000", 1ms);
  board.say("008#010A0000", 15ms);
  board.cpu.run_until(at(30ms));
  const std::vector<std::pair<Level, base::Time>> expected{
      {Level::low, at(1ms)}, {Level::low, at(11ms)}, {Level::urgent, at(15ms)}, {Level::urgent, at(25ms)}};
  CHECK(board.ran == expected);
  CHECK(texts(board.bus)[0].starts_with("708"));
  CHECK(texts(board.bus)[3].starts_with("408"));
  CHECK(board.cpu.misuses() == 0);
}

TEST_CASE("the timer is armed for watchdogs, and they run at urgent") {
  OnCpu board;
  std::vector<base::Time> rested;
  board.controller.accept<amiro::Motors>([&](const amiro::Motors& motors) {
    if (motors == amiro::Motors{}) rested.push_back(board.cpu.now());
  });
  for (const auto when : {0ms, 100ms, 200ms}) board.say("201#50C3000000000000", when);
  board.cpu.run_until(at(5s));
  CHECK(rested == std::vector<base::Time>{at(700ms)});
  CHECK(board.ran == std::vector<std::pair<Level, base::Time>>{{Level::urgent, at(700ms)}});
  CHECK(board.controller.counters().timeouts == 1);
  CHECK(board.cpu.misuses() == 0);
}

TEST_CASE("room on the bus wakes the level whose frames wait, and no other") {
  OnCpu board;
  board.bus.room = 1;
  board.say("305#02", 0ms);
  board.cpu.run_until(at(1ms));
  CHECK(board.controller.waiting());
  board.ran.clear();
  board.bus.room = 9;
  board.controller.writable();
  board.cpu.run_until(at(2ms));
  CHECK(board.ran == std::vector<std::pair<Level, base::Time>>{{Level::low, at(1ms)}});
  CHECK(texts(board.bus) == std::vector<std::string>{"705#01000000", "706#02000000", "707#03000000"});
  CHECK_FALSE(board.controller.waiting());
  CHECK(board.cpu.misuses() == 0);
}

}  // namespace controller_controller_ports_test
