#include "cli/serve/robots_alone.hpp"

#include <poll.h>
#include <span>
#include <utility>

#include "cli/serve/fleet_player.hpp"
#include "cli/serve/foxglove.hpp"
#include "cli/serve/log_start.hpp"
#include "cli/shared/clock.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::serve {

int serve_robots(PageServer& server) {
  while (interrupted() == 0 && !server.is_over()) {
    pollfd input{server.orders().descriptor(), POLLIN, 0};
    if (wait_for_input(std::span{&input, 1}, bus_interval))
      for (const Order& order : server.orders().take())
        if (order.kind == Order::Kind::publish)
          server.viewers().tell(
              order.viewer,
              foxglove::status(foxglove::Level::error, "there is no bus: serve live robots has both"));
    server.publish_bus(unix_time());
    server.wake();
  }
  server.close();
  return exit_code_after_interrupt(exit_success);
}

int serve_robots_of_log(PageServer& server, fleet::LineReplay replay) {
  FleetPlayer player{std::move(replay), server.name(), server.viewers(), server.fleet_channels(),
                     server.channels().of(State::playback)};
  LogStart start;
  remark(LogStart::waits);
  auto before = Clock::now();
  auto next_bus = before;
  while (interrupted() == 0 && !server.is_over()) {
    pollfd input{server.orders().descriptor(), POLLIN, 0};
    const bool asked = wait_for_input(std::span{&input, 1}, play_step);
    const auto now = Clock::now();
    const base::Duration passed = now - std::exchange(before, now);
    const auto channels = server.fleet_channels();
    const bool is_seen = server.viewers().wanted(channels.fleet) || server.viewers().wanted(channels.map);
    if (start.plays(is_seen, server.viewers().count(), now)) player.pass(passed);
    if (asked)
      for (const Order& order : server.orders().take()) {
        if (order.kind == Order::Kind::playback) start.begin();
        player.obey(order);
      }
    player.publish(now);
    if (now >= next_bus) {
      server.publish_bus(unix_time());
      next_bus = now + bus_interval;
    }
    server.wake();
  }
  server.close();
  return exit_code_after_interrupt(exit_success);
}

}  // namespace ocm::cli::serve
