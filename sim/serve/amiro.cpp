#include "sim/serve/amiro.hpp"

#include <algorithm>
#include <chrono>
#include <deque>
#include <memory>
#include <optional>
#include <poll.h>

#include <fmt/format.h>

#include "ocm/client/counted.hpp"
#include "ocm/simulation/virtual_bus_server.hpp"

#include "sim/serve/boards.hpp"
#include "sim/serve/bus_report.hpp"
#include "sim/serve/clock.hpp"
#include "sim/serve/interference.hpp"
#include "sim/serve/messages.hpp"
#include "sim/serve/round.hpp"
#include "sim/serve/turns.hpp"

namespace ocm::sim {
namespace {

/// Frames that wait in a board before its sensors are held up.
constexpr std::size_t board_queue = 32;

/// Until something is readable, or `wait` is over.
void wait_for(int bus, const Boards& boards, base::Duration wait) {
  std::vector<pollfd> inputs{{bus, POLLIN, 0}};
  for (const int descriptor : boards.descriptors()) inputs.push_back({descriptor, POLLIN, 0});
  const timespec limit{0, static_cast<long>(wait.count())};
  ::ppoll(inputs.data(), inputs.size(), &limit, nullptr);
}

/// A failure when there is no such board.
std::optional<transport::Failure> switch_off(const std::vector<std::string>& without, Ports& ports) {
  for (const auto& board : without) {
    const auto found = std::find(board_names.begin(), board_names.end(), board);
    if (found == board_names.end())
      return transport::Failure{"sim: no board '" + board + "'",
                                fmt::format("one of: {}", fmt::join(board_names, ", "))};
    ports[static_cast<std::size_t>(found - board_names.begin())].on = false;
  }
  return std::nullopt;
}

transport::Outcome<std::unique_ptr<Boards>> make_boards(const AmiroOptions& options, Ports& ports,
                                                        const SimulatedClock& clock) {
  if (options.qemu)
    return boards_in_qemu(options.world, ports, options.images, [&clock] { return clock.now(); });
  return boards_of_the_host(options.world, ports);
}

/// Boards in QEMU start like others, in their time; who waits for the simulator waits for them.
Ending wait_until_ready(Boards& boards, const SimulatedClock& clock, const Shell& shell) {
  const base::Time patience = clock.now() + std::chrono::seconds{30};
  while (!boards.ready() && !shell.stop()) {
    if (!boards.advance(clock.now())) return Ending{boards.failure()};
    wait_for(-1, boards, std::chrono::milliseconds{20});
    if (clock.now() > patience)
      return Ending{
          {"sim: a board in QEMU does not start", "are these images of the boards? See docs/verbs/sim.md"}};
  }
  return {};
}

void show(const Boards& boards, const Shell& shell) {
  if (shell.watch) shell.watch([&boards] { return seen(boards.world(), amiro::catalogue.robot); });
}

}  // namespace

Ending serve_amiro(transport::Bus& bus, const AmiroOptions& options, const Shell& shell) {
  Ports ports;
  std::deque<can::Frame> sent;  // by a board, for the others: a bus does not give back what it was given
  for (Port& port : ports) {
    port.hand_over = [&bus, &sent](const can::Frame& frame) {
      const auto taken = bus.send(frame);
      if (taken && *taken) sent.push_back(frame);
      return taken;
    };
  }
  if (const auto problem = switch_off(options.without, ports)) return Ending{*problem, true};
  const SimulatedClock clock{1};
  const auto made = make_boards(options, ports, clock);
  if (!made) return Ending{made.error};
  Boards& boards = **made;
  if (auto started = wait_until_ready(boards, clock, shell); !started.well()) return started;
  while (!shell.stop()) {
    if (!boards.advance(clock.now())) return Ending{boards.failure()};
    show(boards, shell);
    const bool heard = !sent.empty();
    for (; !sent.empty(); sent.pop_front()) boards.receive(sent.front(), clock.now());
    auto received = bus.receive(base::Duration{0});
    if (!heard && !received && received.error == base::Error::timed_out) {
      wait_for(bus.descriptor(), boards,
               boards.waiting() ? base::Duration{std::chrono::milliseconds{1}}
                                : shell.limited(clock.until(boards.next_event())));
      received = bus.receive(base::Duration{0});
    }
    if (received && received->frame.format != can::Format::error)
      boards.receive(received->frame, clock.now());
    if (!received && received.error == base::Error::closed) return Ending{bus.failure()};
  }
  boards.summarise(shell);
  return {};
}

Ending serve_amiro(const std::string& path, const AmiroOptions& options, const Shell& shell) {
  simulation::VirtualBusOptions bus_options;
  bus_options.path = path;
  bus_options.name = amiro::catalogue.robot;
  bus_options.bit_rate = options.bit_rate;
  bus_options.data_bit_rate = options.data_bit_rate;
  bus_options.to_unix_time = std::chrono::system_clock::now().time_since_epoch();
  bus_options.report = shell.report;
  auto opened = simulation::VirtualBusServer::open(bus_options);
  if (!opened) return Ending{opened.error};
  auto& server = **opened;
  auto& arbiter = server.arbiter();

  const SimulatedClock clock{options.speed};
  Ports ports;
  for (Port& port : ports) {
    // A board has three mailboxes that go by identifier; its driver puts the lowest ones there.
    const auto node = arbiter.attach({simulation::QueueOrder::by_identifier, board_queue});
    port.hand_over = [&arbiter, node](const can::Frame& frame) { return arbiter.send(node, frame); };
  }
  if (const auto problem = switch_off(options.without, ports)) return Ending{*problem, true};
  const auto made = make_boards(options, ports, clock);
  if (!made) return Ending{made.error};
  Boards& boards = **made;
  if (auto started = wait_until_ready(boards, clock, shell); !started.well()) return started;
  const protocol::Catalogue none;
  MessageNodes messages{options.messages != nullptr ? *options.messages : none,
                        {.seed = options.world.seed, .sporadic = options.sporadic},
                        arbiter};
  report_left_out(messages.player(), shell);
  shell.report(fmt::format("simulated {}{} on --bus {} ({}), {} bit/s; Ctrl-C ends it",
                           amiro::catalogue.robot, options.qemu ? " with its boards in QEMU" : "",
                           path.empty() ? "sim" : "sim:" + path, server.path(), options.bit_rate));

  Turns turns{amiro::catalogue};
  const auto hear = [&boards, &turns](const simulation::Delivery& delivery) {
    if (delivery.fd != nullptr) return;  // no frame of the robot's; the simulated boards bear it
    turns.take(delivery);
    boards.receive(delivery.frame, delivery.time);
  };
  Interference interference{options.bus_errors, options.world.seed};
  const auto next_event = [&server, &messages, &boards] {
    return std::min({server.next_event(), messages.next_event(), boards.next_event()});
  };
  Lateness lateness{shell.report};
  while (!shell.stop()) {
    const base::Time now = clock.now();
    Round round{now};
    // Whatever falls due until now, in the order in which it does.
    for (base::Time next = next_event(); round.takes(next); next = next_event()) {
      interference.disturb(arbiter, next);
      server.advance(next, hear);
      messages.advance(next);
      if (!boards.advance(next)) return Ending{boards.failure()};
    }
    if (options.qemu && !boards.advance(round.reached())) return Ending{boards.failure()};
    interference.disturb(arbiter, round.reached());
    server.poll(round.reached(), hear);
    lateness.note(round, clock);
    show(boards, shell);
    wait_for(server.descriptor(), boards, shell.limited(clock.until(next_event())));
  }
  server.end();  // counts what slow clients lost by it
  boards.summarise(shell);
  messages.summarise(shell);
  lateness.sum_up();
  report_bus(server, options.bus_errors > 0, shell);
  turns.each([&shell](const protocol::Topic& topic, std::uint64_t count) {
    shell.report(fmt::format("{:<17} was commanded by two senders, in turns: {}", topic.name,
                             client::counted(count, "time")));
  });
  return {};
}

}  // namespace ocm::sim
