#include "sim/serve/messages.hpp"

#include <chrono>
#include <deque>
#include <poll.h>
#include <string_view>

#include <fmt/format.h>

#include "ocm/client/counted.hpp"
#include "ocm/simulation/virtual_bus_server.hpp"

#include "sim/serve/bus_report.hpp"
#include "sim/serve/clock.hpp"
#include "sim/serve/interference.hpp"
#include "sim/serve/round.hpp"

namespace ocm::sim {
namespace {

/// Frames that may wait for a full CAN interface; beyond that they are dropped and counted.
constexpr std::size_t longest_wait = 1000;

constexpr std::string_view of_unknown_sender = "unknown sender";

void wait_for(int descriptor, base::Duration wait) {
  pollfd input{descriptor, POLLIN, 0};
  const timespec limit{0, static_cast<long>(wait.count())};
  ::ppoll(&input, 1, &limit, nullptr);
}

std::string names(const std::vector<const protocol::Topic*>& messages) {
  std::string text;
  for (const auto* message : messages) text += fmt::format("{}{}", text.empty() ? "" : ", ", message->name);
  return text;
}

std::string messages_of(const MessagePlayer& player) {
  return client::counted(player.size(), "message");
}

std::string_view name_of(const protocol::Catalogue& catalogue) {
  return catalogue.robot.empty() ? std::string_view{"bus"} : catalogue.robot;
}

}  // namespace

MessageNodes::MessageNodes(const protocol::Catalogue& catalogue, const PlayOptions& options,
                           simulation::Arbiter& wire)
    : player_(catalogue, options), wire_(&wire), nodes_(catalogue.boards.size() + 1) {
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const bool known = i < catalogue.boards.size();
    nodes_[i].name = known ? catalogue.boards[i].name : of_unknown_sender;
    const auto sent = player_.sent_by(known ? static_cast<std::uint8_t>(i) : protocol::no_board);
    // Room for two of each message: one that still waits when the next is due.
    if (sent != 0) nodes_[i].id = wire.attach({simulation::QueueOrder::by_identifier, 2 * sent});
  }
}

void MessageNodes::advance(base::Time now) {
  player_.advance(now, [this](const PlayedMessage& message, const can::AnyFrame& frame, base::Time due) {
    Node& node = message.board + std::size_t{1} < nodes_.size() ? nodes_[message.board] : nodes_.back();
    const auto taken = wire_->send_any(node.id, frame, due);
    ++(taken && *taken ? node.handed_over : node.refused);
  });
}

void MessageNodes::summarise(const Shell& shell) const {
  for (const Node& node : nodes_) {
    if (node.handed_over == 0 && node.refused == 0) continue;
    shell.report(fmt::format("{:<17} sent {}{}", node.name, node.handed_over,
                             node.refused == 0 ? "" : fmt::format(", {} found the bus full", node.refused)));
  }
}

void report_left_out(const MessagePlayer& player, const Shell& shell, const host::Failure& no_fd) {
  const auto& left = player.left_out();
  if (!left.switched_off.empty())
    shell.report(fmt::format("not sent, since switched off: {}", names(left.switched_off)));
  if (!left.without_period.empty())
    shell.report(fmt::format("not sent, since the spec states no period: {} (--sporadic 1s sends them too)",
                             names(left.without_period)));
  if (!left.no_fd.empty())
    shell.report(fmt::format("not sent, since {}: {}; {}", no_fd.what, names(left.no_fd), no_fd.remedy));
  if (!left.too_long.empty())
    shell.report(fmt::format("not sent, since no frame holds them: {}", names(left.too_long)));
}

Ending nothing_to_play(const MessagePlayer& player, const protocol::Catalogue& catalogue,
                       const host::Failure& no_fd) {
  if (player.size() != 0) return {};
  const auto& left = player.left_out();
  if (!left.no_fd.empty())
    return Ending{{fmt::format("sim: no message of '{}' can be sent: {}", name_of(catalogue), no_fd.what),
                   no_fd.remedy}};
  if (catalogue.topics.empty())
    return Ending{{fmt::format("sim: '{}' has no message", name_of(catalogue)), "give a spec with messages"},
                  true};
  if (left.without_period.empty() && !left.switched_off.empty())
    return Ending{{fmt::format("sim: no message of '{}' is left to send", name_of(catalogue)),
                   "switch fewer nodes off"},
                  true};
  if (left.without_period.empty())
    return Ending{{fmt::format("sim: no message of '{}' fits into a frame", name_of(catalogue)),
                   "give a spec with messages of at most 8 bytes, or 64 in CAN FD"},
                  true};
  return Ending{
      {fmt::format("sim: no message of '{}' has a period that could be played", name_of(catalogue)),
       "add --sporadic 1s to send all about once a second, or state periods (DBC: GenMsgCycleTime)"},
      true};
}

Ending serve_messages(const std::string& path, const protocol::Catalogue& catalogue,
                      const MessagesOptions& options, const Shell& shell) {
  if (auto nothing = nothing_to_play(MessagePlayer{catalogue, options.play}, catalogue); !nothing.well())
    return nothing;
  simulation::VirtualBusOptions bus_options;
  bus_options.path = path;
  bus_options.name = name_of(catalogue);
  bus_options.bit_rate = options.bit_rate;
  bus_options.data_bit_rate = options.data_bit_rate;
  bus_options.to_unix_time = std::chrono::system_clock::now().time_since_epoch();
  bus_options.report = shell.report;
  auto opened = simulation::VirtualBusServer::open(bus_options);
  if (!opened) return Ending{opened.error};
  auto& server = **opened;
  auto& wire = server.arbiter();
  MessageNodes nodes{catalogue, options.play, wire};
  report_left_out(nodes.player(), shell);
  shell.report(fmt::format("simulated {} of {} on --bus {} ({}), {} bit/s; Ctrl-C ends it",
                           messages_of(nodes.player()), name_of(catalogue),
                           path.empty() ? "sim" : "sim:" + path, server.path(), options.bit_rate));
  const SimulatedClock clock{options.speed};
  const auto hear = [](const simulation::Delivery&) {};
  Interference interference{options.bus_errors, options.play.seed};
  Lateness lateness{shell.report};
  const auto next_event = [&server, &nodes] { return std::min(server.next_event(), nodes.next_event()); };
  while (!shell.stop()) {
    const base::Time now = clock.now();
    Round round{now};
    for (base::Time next = next_event(); round.takes(next); next = next_event()) {
      interference.disturb(wire, next);
      server.advance(next, hear);
      nodes.advance(next);
    }
    interference.disturb(wire, round.reached());
    server.poll(round.reached(), hear);
    lateness.note(round, clock);
    wait_for(server.descriptor(), clock.until(next_event()));
  }
  server.end();  // counts what slow clients lost by it
  nodes.summarise(shell);
  lateness.sum_up();
  report_bus(server, options.bus_errors > 0, shell);
  return {};
}

Ending serve_messages(transport::Bus& bus, const protocol::Catalogue& catalogue,
                      const MessagesOptions& options, const Shell& shell) {
  const host::Failure no_fd = bus.fd_obstacle();
  PlayOptions play = options.play;
  play.fd = no_fd.what.empty();
  MessagePlayer player{catalogue, play};
  if (auto nothing = nothing_to_play(player, catalogue, no_fd); !nothing.well()) return nothing;
  report_left_out(player, shell, no_fd);
  shell.report(fmt::format("simulated {} of {} on {}; Ctrl-C ends it", messages_of(player),
                           name_of(catalogue), bus.name()));
  const SimulatedClock clock{1};
  std::deque<can::AnyFrame> waiting;
  std::uint64_t sent = 0;
  std::uint64_t dropped = 0;
  Lateness lateness{shell.report};
  while (!shell.stop()) {
    Round round{clock.now()};
    while (round.takes(player.next_event()))
      player.advance(round.reached(), [&](const PlayedMessage&, const can::AnyFrame& frame, base::Time) {
        if (waiting.size() < longest_wait)
          waiting.push_back(frame);
        else
          ++dropped;
      });
    lateness.note(round, clock);
    while (!waiting.empty()) {
      const auto taken = bus.send_any(waiting.front());
      if (!taken && taken.error == base::Error::closed) return Ending{bus.failure()};
      if (taken && !*taken) break;
      ++(taken ? sent : dropped);
      waiting.pop_front();
    }
    while (bus.receive_any(base::Duration{0})) {
    }
    if (bus.state() == transport::BusState::closed) return Ending{bus.failure()};
    wait_for(bus.descriptor(), waiting.empty() ? clock.until(player.next_event())
                                               : base::Duration{std::chrono::milliseconds{1}});
  }
  shell.report(fmt::format("bus               {} frames sent, {} dropped: the bus was full", sent,
                           dropped + waiting.size()));
  lateness.sum_up();
  return {};
}

}  // namespace ocm::sim
