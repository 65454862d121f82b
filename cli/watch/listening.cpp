#include "cli/watch/listening.hpp"

#include <algorithm>
#include <chrono>

#include "cli/shared/clock.hpp"

namespace ocm::cli {

Over listen(transport::Bus& bus, const ListenLimits& limits, const TakeEntries& take, const TakeLost& lost,
            const std::function<void()>& each_second) {
  log::Interfaces interfaces;
  const std::uint16_t interface = interfaces.number(bus.name());
  Live live{bus};
  const auto end = limits.duration ? time_after(Clock::now(), *limits.duration) : Clock::time_point::max();
  auto tick = each_second ? Clock::now() + std::chrono::seconds{1} : Clock::time_point::max();
  std::uint64_t taken = 0;
  std::uint64_t told = 0;
  for (;;) {
    const Over over = live.receive_any(std::min(end, tick), [&](const transport::ReceivedAny& received) {
      const log::Entry entry{received.time, received.frame, interface};
      take({&entry, 1}, interfaces);
      return ++taken != limits.count;
    });
    if (const auto missed = bus.counters().lost; missed != told) {
      lost(bus.name(), missed - told);
      told = missed;
    }
    if (over != Over::time) return over;
    const auto now = Clock::now();
    if (now >= end) return Over::time;
    if (now >= tick) {
      each_second();
      tick += std::chrono::seconds{1};
      // After a stop of this program: not at once again.
      if (tick - now <= std::chrono::milliseconds{500}) tick = now + std::chrono::seconds{1};
    }
  }
}

}  // namespace ocm::cli
