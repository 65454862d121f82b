// What the dispatcher costs on a Cortex-M3, in instructions: on QEMU's mps2-an385 with -icount shift=0, where
// an instruction takes a nanosecond of the timer's time. The port is the least that a real one does: a
// variable as clock, a store as timer, PRIMASK as lock.
#include "ocm/scheduling/dispatcher.hpp"

#include <cstdint>
#include <cstdio>

using namespace ocm;
using scheduling::Level;

namespace {

struct Guard {
  std::uint32_t mask;
  Guard() noexcept { __asm volatile("mrs %0, primask\n\tcpsid i" : "=r"(mask)::"memory"); }
  ~Guard() { __asm volatile("msr primask, %0" ::"r"(mask) : "memory"); }
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;
};
struct Port {
  base::Time now() const noexcept { return time; }
  void arm(base::Time when) noexcept { armed = when; }
  void pend(Level level) noexcept { *pended = 1U << static_cast<unsigned>(level); }
  Guard lock() noexcept { return {}; }
  base::Time time{};
  base::Time armed{};
  volatile std::uint32_t* pended = &pending;
  volatile std::uint32_t pending = 0;
};

/// CMSDK timer 0 of the board: counts down at 25 MHz, that is once in 40 instructions. [Arm DAI 0385, table
/// 4]
struct Timer {
  volatile std::uint32_t control, value, reload, interrupt;
};
Timer& timer = *reinterpret_cast<Timer*>(0x4000'0000);

constexpr std::uint32_t rounds = 1000;

/// Instructions of one call, the loop's own subtracted.
template <class F>
std::uint32_t cost(F call) {
  const std::uint32_t begin = timer.value;
  for (std::uint32_t i = 0; i < rounds; ++i) {
    call();
    __asm volatile("" ::: "memory");
  }
  return (begin - timer.value) * 40 / rounds - 3;
}

template <std::size_t N>
[[gnu::noinline]] void measure() {
  Port port;
  scheduling::Dispatcher<N, Port> dispatcher{port};
  constexpr base::Duration period{1'000'000};
  for (std::size_t i = 0; i < N; ++i)
    dispatcher.start(i, base::Duration{3'600'000'000'000}, Level::low, port.now() + period);
  // The last stream is due every millisecond, and is the last that a search comes to.
  dispatcher.start(N - 1, period, Level::high, port.now());
  const auto nothing = [](const scheduling::Release&) { return scheduling::Outcome::done; };
  const auto on_time = cost([&] {
    dispatcher.run(Level::high, nothing);
    port.time += period;
  });
  const auto timer_cost = cost([&] { dispatcher.expire(); });
  const auto late = cost([&] {
    port.time += 7 * period;
    dispatcher.run(Level::high, nothing);
  });
  const auto idle = cost([&] { dispatcher.run(Level::urgent, nothing); });
  const auto request = cost([&] { dispatcher.start(0, period, Level::medium, port.now()); });
  const auto stop = cost([&] { dispatcher.stop(0); });
  std::printf("| %2u | %4u | %4u | %4u | %4u | %3u | %3u | %4u |\n", static_cast<unsigned>(N),
              static_cast<unsigned>(timer_cost), static_cast<unsigned>(on_time), static_cast<unsigned>(late),
              static_cast<unsigned>(idle), static_cast<unsigned>(request), static_cast<unsigned>(stop),
              static_cast<unsigned>(sizeof(scheduling::Dispatcher<N, Port>)));
}

}  // namespace

int main() {
  timer.reload = 0xFFFF'FFFF;
  timer.value = 0xFFFF'FFFF;
  timer.control = 1;
  std::printf(
      "| streams | expire | run, a release | run, 6 skipped | run, nothing due | start | stop | bytes |\n");
  std::printf("|---|---|---|---|---|---|---|---|\n");
  measure<1>();
  measure<4>();
  measure<9>();
  measure<17>();
  measure<32>();
}
