#include "cli/serve/live_bus.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "cli/command/operated_bus.hpp"
#include "cli/serve/control.hpp"
#include "cli/serve/operator_watch.hpp"
#include "cli/shared/clock.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/live.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/outgoing.hpp"
#include "cli/shared/remedies.hpp"

namespace ocm::cli::serve {
namespace {

using Presence = OperatorWatch::Presence;

/// Frames that viewers hear of together. To wake the thread of the web is most of what a frame costs, and a
/// page is drawn 60 times a second at most.
class Batch {
 public:
  explicit Batch(PageServer& server) : server_(&server) {}

  void add() {
    if (++frames_ >= most) send();
  }
  void send() {
    if (std::exchange(frames_, 0) != 0) due_ = Clock::now() + interval;
    server_->wake();
  }
  void send_if_due() {
    if (frames_ != 0 && Clock::now() >= due_) send();
  }
  /// When it goes; nothing: it is empty. At once where the last one is long ago.
  [[nodiscard]] std::optional<Clock::time_point> due() const {
    return frames_ != 0 ? std::optional{due_} : std::nullopt;
  }

 private:
  static constexpr unsigned most = 64;
  static constexpr base::Duration interval = std::chrono::milliseconds{20};

  PageServer* server_;
  unsigned frames_ = 0;
  Clock::time_point due_{};
};

/// Until the bus is gone, a signal comes, it is over, or (enough) an operator has come or gone. The motors
/// rest behind it; `exit_code` says failure where that has not left.
Over serve_frames(PageServer& server, transport::Bus& bus, const log::Interfaces& interfaces,
                  const OperatorWatch& watch, const std::function<bool()>& operator_changed, int& exit_code) {
  FrameClock clock;
  Control control{bus, server.catalogue(), server.viewers(),
                  [&](const can::AnyFrame& frame) {
                    log::Entry entry{clock.now(), frame, 0};
                    entry.direction = log::Direction::sent;
                    server.take(entry, interfaces);
                  },
                  [&]() -> std::string {
                    if (operator_changed()) return "an operator has just started, or ended: say it again";
                    if (watch.presence() == Presence::silent && dynamic_cast<OperatedBus*>(&bus) == nullptr)
                      return "an operator guards the robot, and does not answer: end it, or start it again";
                    return {};
                  }};
  Batch batch{server};
  Live live{bus, [&] { batch.send_if_due(); }, {server.orders().descriptor(), [&] {
                                                  for (const Order& order : server.orders().take()) {
                                                    server.answer(order, clock.now());
                                                    control.carry_out(order);
                                                  }
                                                  batch.send();
                                                }}};
  auto next_bus = Clock::now();
  auto next_boards = next_bus;
  Over over = Over::time;
  while (over == Over::time && !server.is_over()) {
    auto until = std::min(next_bus, next_boards);
    if (const auto next = control.next()) until = std::min(until, *next);
    if (const auto due = batch.due()) until = std::min(until, *due);
    over = live.receive_any(until, [&](const transport::ReceivedAny& received) {
      clock.take(received.time);
      // First: what has left before it is known then.
      if (const auto classic = received.frame.classic()) control.heard({received.time, *classic});
      server.take({received.time, received.frame, 0}, interfaces);
      batch.add();
      // What is due is done between two frames, too, however many come.
      if (const auto next = control.next(); next && *next <= Clock::now()) control.advance();
      const auto due = batch.due();
      return !due || *due >= until;
    });
    if (over == Over::enough) {  // the batch is due earlier than what was waited for
      over = Over::time;
      continue;
    }
    control.advance();
    const auto now = Clock::now();
    server.lost_so_far(bus.name(), bus.counters().lost);
    if (now >= next_bus) {
      server.until(clock.now());
      server.publish_bus(clock.now());
      server.publish_parameters(clock.now());
      server.publish_operator(watch);
      next_bus = now + bus_interval;
      if (over == Over::time && operator_changed()) over = Over::enough;
    }
    if (now >= next_boards) {
      server.publish_boards(bus.counters(), clock.now());
      server.publish_bounds(clock.now());
      next_boards = now + boards_interval;
    }
    batch.send();
  }
  if (const std::string unsent = control.rest(); !unsent.empty()) {
    complain({unsent, why_none_leaves(bus)});
    exit_code = exit_failure;
  }
  return over;
}

}  // namespace

int serve_bus(PageServer& server, Session& session, std::unique_ptr<transport::Bus> bus) {
  log::Interfaces interfaces;
  interfaces.number(bus->name());
  const OperatorWatch watch{std::string{bus->name()}};
  auto* operated = dynamic_cast<OperatedBus*>(bus.get());
  int exit_code = exit_success;
  for (;;) {
    // Set points go through an operator from the moment that there is one, and until there is none.
    const auto changed = [&] {
      if (!server.takes_commands()) return false;
      return operated != nullptr ? operated->over() || watch.presence() == Presence::none
                                 : watch.presence() == Presence::runs;
    };
    const Over over = serve_frames(server, *bus, interfaces, watch, changed, exit_code);
    if (over != Over::enough) {
      server.close();
      if (over == Over::gone && interrupted() == 0) fail(bus->failure());
      return exit_code != exit_success ? exit_code : exit_code_after_interrupt(exit_success);
    }
    if (operated != nullptr) bus = std::exchange(operated, nullptr)->release();
    auto link = connect_operator(bus->name(), "serve");
    if (link && *link != nullptr) {
      server.say(fmt::format("{} guards the robot: set points go through it", (*link)->who()));
      auto guarded =
          std::make_unique<OperatedBus>(std::move(bus), std::move(*link), session.catalogue(), "serve");
      operated = guarded.get();
      bus = std::move(guarded);
    } else if (link) {
      server.say("no operator runs any more: what viewers command goes to the bus itself");
    }
  }
}

}  // namespace ocm::cli::serve
