#include "cli/serve/played_log.hpp"

#include <chrono>
#include <cstdint>
#include <poll.h>
#include <span>
#include <utility>

#include "cli/serve/commands.hpp"
#include "cli/serve/foxglove.hpp"
#include "cli/serve/log_start.hpp"
#include "cli/shared/clock.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::serve {
namespace {

constexpr base::Duration time_bar_interval = std::chrono::milliseconds{100};

}  // namespace

int serve_log(PageServer& server, bus_model::LogFeed& log) {
  const bus_model::LogFeed::Take taken = [&server](const log::Entry& entry,
                                                   const log::Interfaces& interfaces) {
    server.take(entry, interfaces);
  };
  LogStart start;
  remark(LogStart::waits);
  bool paused = false;
  std::uint64_t jumps = 0;
  const auto jump = [&](base::Duration at) {
    ++jumps;
    server.winds();
    if (log.is_behind(at)) {
      server.forget();
      log.rewind();
    }
    log.go_to(at, taken);
    // First that it was wound, so that a viewer forgets what was before, then what is there.
    server.publish_playback(log.playing(), paused, jumps);
    server.wound();
  };
  const auto obey = [&](const Order& order) {
    if (order.kind != Order::Kind::playback) return;
    const auto request = playback_of(order.payload);
    if (!request)
      return server.viewers().tell(order.viewer, foxglove::status(foxglove::Level::error, request.error));
    start.begin();
    if (request->paused >= 0) paused = request->paused == 1;
    if (request->speed > 0) log.faster(request->speed / log.playing().speed);
    if (request->at) jump(*request->at);
  };
  auto before = Clock::now();
  auto next_bus = before;
  auto next_boards = before;
  auto next_playback = before;
  while (interrupted() == 0 && !server.is_over()) {
    pollfd input{server.orders().descriptor(), POLLIN, 0};
    const bool asked = wait_for_input(std::span{&input, 1}, play_step);
    const auto now = Clock::now();
    const base::Duration passed = now - std::exchange(before, now);
    if (start.plays(server.is_looked_at(), server.viewers().count(), now) && !paused) log.play(passed, taken);
    server.until(log.now());
    if (asked) {
      for (const Order& order : server.orders().take()) {
        server.answer(order, unix_time());
        obey(order);
      }
      next_playback = next_bus = now;
    }
    if (now >= next_playback) {
      server.publish_playback(log.playing(), paused, jumps);
      next_playback = now + time_bar_interval;
    }
    if (now >= next_bus) {
      server.publish_bus(log.now());
      next_bus = now + bus_interval;
    }
    if (now >= next_boards) {
      server.publish_boards({}, log.now());
      server.publish_bounds(log.now());
      next_boards = now + boards_interval;
    }
    server.wake();
  }
  server.close();
  return exit_code_after_interrupt(exit_success);
}

}  // namespace ocm::cli::serve
