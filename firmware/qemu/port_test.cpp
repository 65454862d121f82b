// The port's promises, asked of the kernel itself in QEMU. Exit code 0: all kept; otherwise the first broken
// one is named on stderr.
#include "firmware/chibios/port.hpp"

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include "ocm/base/time.hpp"
#include "ocm/scheduling/resource.hpp"

#include "firmware/qemu/machine.hpp"

namespace {

using namespace std::chrono_literals;
namespace base = ocm::base;
namespace chibios = ocm::firmware::chibios;
using chibios::Level;

void require(bool holds, const char* what) {
  if (!holds) ocm::firmware::qemu::leave(what, 1);
}

/// Busy, not asleep: the time of a preempted job goes on.
void spin(chibios::Port& port, base::Duration time) {
  const base::Time end = port.now() + time;
  while (port.now() < end) {
  }
}

/// A controller for the runtime: notes who runs in which order.
struct Controller {
  chibios::Port& port;
  std::array<char, 16> trace{};
  std::size_t traced = 0;
  std::array<int, 4> runs{};
  base::Time expired{};
  int expiries = 0;
  void (*job)(Controller&, Level) = nullptr;
  chibios::Signal finished{};

  void note(char c) {
    const chibios::Lock lock;
    if (traced < trace.size()) trace[traced++] = c;
  }
  void pend(Level level) {
    const auto lock = port.lock();
    port.pend(level);
  }
  void arm(base::Time when) {
    const auto lock = port.lock();
    port.arm(when);
  }
  void expire() {
    expired = port.now();
    ++expiries;
    pend(Level::urgent);
  }
  void run(Level level) {
    ++runs[static_cast<std::size_t>(level)];
    if (job != nullptr) job(*this, level);
  }
  void receive(const ocm::can::Frame&, base::Time) {}
  void writable() {}
  void bus_lost() {}
};

/// The test itself is the receiver's thread: it is above all levels, as a receiver of requests is.
struct Script {
  Controller& controller;
  chibios::BusEvent wait(ocm::can::Frame&);
};

chibios::Mutex mutex;

void clock_goes_on(chibios::Port& port) {
  base::Time last = port.now();
  for (int i = 0; i < 1000; ++i) {
    const base::Time now = port.now();
    require(now >= last, "now() went back");
    require(now.time_since_epoch() % chibios::tick == base::Duration{0}, "now() is not whole ticks");
    last = now;
  }
}

/// 300 ms are four turns of a counter of 16 bits; TIM2 itself has 32. Once asleep, once busy.
void clock_survives_a_turn(chibios::Port& port) {
  const base::Time start = port.now();
  const std::uint32_t counter = OCM_TIM2_CNT;
  static_cast<void>(chibios::Signal{}.wait(300ms));
  while (OCM_TIM2_CNT - counter < 600'000) {  // busy, by the counter alone
  }
  const auto passed = std::chrono::microseconds{static_cast<std::uint32_t>(OCM_TIM2_CNT - counter)};
  const base::Duration error = port.now() - start - passed;
  require(error < 1ms && error > -1ms, "now() lost a turn of the counter");
  require(passed >= 600ms, "a wait that was too short");
}

void timer_is_never_early(Controller& c) {
  for (const base::Duration wait : {1us, 9us, 10us, 100us, 5'000us, 50'000us, 200'000us}) {
    const base::Time when = c.port.now() + wait;
    c.expiries = 0;
    c.arm(when);
    static_cast<void>(chibios::Signal{}.wait(wait + 20ms));
    require(c.expiries == 1, "an armed timer went off other than once");
    require(c.expired >= when, "an armed timer was early");
    require(c.expired < when + 20ms, "an armed timer was far too late");
  }
  c.expiries = 0;
  c.arm(c.port.now() - 1s);
  static_cast<void>(chibios::Signal{}.wait(20ms));
  require(c.expiries == 1, "a time that has passed did not go off");

  c.expiries = 0;
  c.arm(c.port.now() + 10ms);
  c.arm(base::never);
  static_cast<void>(chibios::Signal{}.wait(30ms));
  require(c.expiries == 0, "never did not disarm");

  c.arm(c.port.now() + 10ms);
  c.arm(c.port.now() + 40ms);
  static_cast<void>(chibios::Signal{}.wait(25ms));
  require(c.expiries == 0, "arming again did not replace");
  static_cast<void>(chibios::Signal{}.wait(40ms));
  require(c.expiries == 1, "the time that was armed again did not come");
}

void levels_preempt(Controller& c) {
  c.traced = 0;
  c.job = [](Controller& self, Level level) {
    const auto digit = static_cast<char>('0' + static_cast<int>(level));
    self.note(digit);
    if (level == Level::low && self.runs[3] == 1) {
      self.pend(Level::urgent);  // preempts here and now
      self.note('a');
      self.pend(Level::low);  // is running: once more afterwards
      self.pend(Level::low);
      self.note('b');
    }
    if (level == Level::low && self.runs[3] == 2) self.finished.raise();
  };
  c.runs = {};
  {
    const auto lock = c.port.lock();  // no level runs before all are pended
    for (const Level level : {Level::low, Level::medium, Level::high, Level::urgent}) c.port.pend(level);
  }
  require(c.finished.wait(1s), "levels did not finish");
  constexpr std::array<char, 8> expected{'0', '1', '2', '3', '0', 'a', 'b', '3'};
  for (std::size_t i = 0; i < expected.size(); ++i)
    require(c.trace[i] == expected[i], "levels ran in another order than their priorities'");
  require(c.traced == expected.size(), "a level ran more often than it was pended");
  c.job = nullptr;
}

/// Low has the mutex, urgent claims it, medium has much to do: with inheritance low finishes first.
void holder_inherits(Controller& c) {
  c.traced = 0;
  c.job = [](Controller& self, Level level) {
    switch (level) {
      case Level::low:
        mutex.lock();
        self.pend(Level::urgent);
        self.pend(Level::medium);
        self.note('l');
        spin(self.port, 2ms);
        self.note('L');
        mutex.unlock();
        self.finished.raise();
        break;
      case Level::medium:
        self.note('m');
        spin(self.port, 5ms);
        self.note('M');
        break;
      case Level::urgent:
        mutex.lock();
        self.note('u');
        mutex.unlock();
        break;
      default:
        break;
    }
  };
  c.pend(Level::low);
  require(c.finished.wait(1s), "the holder did not finish");
  constexpr std::array<char, 5> expected{'l', 'L', 'u', 'm', 'M'};
  for (std::size_t i = 0; i < expected.size(); ++i)
    require(c.trace[i] == expected[i], "a level in between held up the one that waited for the mutex");
  c.job = nullptr;
}

void idle_time_is_measured(Controller& c) {
  const base::Time start = c.port.now();
  const base::Duration idle_start = c.port.idle();
  static_cast<void>(chibios::Signal{}.wait(100ms));
  const base::Time middle = c.port.now();
  const base::Duration idle_middle = c.port.idle();
  require(idle_middle - idle_start > (middle - start) / 2, "sleeping was not counted as idle");
  require(idle_middle - idle_start <= middle - start, "more idle than time passed");
  spin(c.port, 50ms);
  require(c.port.idle() - idle_middle < 5ms, "work was counted as idle");
}

chibios::BusEvent Script::wait(ocm::can::Frame&) {
  clock_goes_on(controller.port);
  clock_survives_a_turn(controller.port);
  timer_is_never_early(controller);
  levels_preempt(controller);
  holder_inherits(controller);
  idle_time_is_measured(controller);
  ocm::firmware::qemu::leave("all kept", 0);
}

}  // namespace

int main() {
  ocm::firmware::qemu::start_machine();
  static chibios::Port port;
  static Controller controller{port};
  static Script script{controller};
  static chibios::Runtime runtime{port, controller, script};
  runtime.run([](base::Time) {});
}
