/// A simulated robot: the three boards' own code in a simulated world, on a virtual bus or on a CAN
/// interface.
#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <poll.h>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "ocm/can/bus.hpp"
#include "ocm/transport/virtual_bus_server.hpp"

#include "cli/interrupt.hpp"
#include "cli/verbs/commanding.hpp"
#include "cli/verbs/verbs.hpp"
#include "firmware/sim/robot.hpp"

namespace ocm::cli {
namespace {

/// A board's connection to whatever bus there is. A board that is switched off sends nothing.
struct Port {
  std::function<base::Result<bool>(const can::Frame&)> hand_over;
  bool on = true;
  base::Result<bool> send(const can::Frame& frame) {
    if (!on) return base::Error::closed;
    return hand_over(frame);
  }
};

using Robot = firmware::sim::SimulatedRobot<Port>;

/// Frames that wait in a board before its sensors are held up.
constexpr std::size_t board_queue = 32;

struct SimOptions {
  firmware::sim::WorldOptions world;
  std::vector<std::string> without;
  std::uint32_t bit_rate = amiro::bit_rate;
  double speed = 1;
};

/// Virtual time: `speed` times as fast as the clock, from zero on.
class SimulatedClock {
 public:
  explicit SimulatedClock(double speed) : speed_(speed), start_(std::chrono::steady_clock::now()) {}
  [[nodiscard]] base::Time now() const {
    const auto elapsed = std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start_);
    return base::Time{base::Duration{static_cast<std::int64_t>(elapsed.count() * speed_)}};
  }
  /// Real time until `when`, at least zero and at most 200 ms, so that a signal is seen soon.
  [[nodiscard]] base::Duration until(base::Time when) const {
    constexpr base::Duration longest{200'000'000};
    const base::Time present = now();
    if (when <= present) return base::Duration{0};
    if (when - present > base::Duration{std::chrono::hours{1}}) return longest;
    const double left = static_cast<double>((when - present).count()) / speed_;
    return std::min(longest, base::Duration{static_cast<std::int64_t>(left) + 1});
  }

 private:
  double speed_;
  std::chrono::steady_clock::time_point start_;
};

void print_counters(std::string_view board, const protocol::Counters& counters) {
  std::string text;
  protocol::for_each(counters, [&text](std::string_view name, std::uint32_t value) {
    if (value != 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, value);
  });
  remark(fmt::format("{:<17} {}", board, text.empty() ? "nothing came" : text));
}

void print_summary(const Robot& robot) {
  print_counters(amiro::DiWheelDrive::name, robot.di_wheel_drive().counters());
  print_counters(amiro::PowerManagement::name, robot.power_management().counters());
  print_counters(amiro::LightRing::name, robot.light_ring().counters());
}

struct Ports {
  Port di_wheel_drive, power_management, light_ring;

  explicit Ports(const std::vector<std::string>& without) {
    for (const auto& board : without) port(board).on = false;
  }
  Port& port(const std::string& board) {
    if (board == amiro::DiWheelDrive::name) return di_wheel_drive;
    if (board == amiro::PowerManagement::name) return power_management;
    if (board == amiro::LightRing::name) return light_ring;
    fail({"sim: no board '" + board + "'", "one of: di_wheel_drive, power_management, light_ring"},
         exit_usage);
  }
};

/// The boards on a real CAN interface: the kernel is the bus.
void simulate_on(transport::Bus& bus, const SimOptions& options) {
  Ports ports{options.without};
  for (Port* port : {&ports.di_wheel_drive, &ports.power_management, &ports.light_ring})
    port->hand_over = [&bus](const can::Frame& frame) { return bus.send(frame); };
  Robot robot{options.world, ports.di_wheel_drive, ports.power_management, ports.light_ring};
  const SimulatedClock clock{1};
  StateWatch watch;
  while (interrupted() == 0) {
    robot.advance(clock.now());
    const base::Duration wait =
        robot.waiting() ? base::Duration{std::chrono::milliseconds{1}} : clock.until(robot.next_event());
    const auto received = bus.receive(wait);
    if (received && received->frame.format != can::Format::error) robot.receive(received->frame, clock.now());
    if (!received && received.error == base::Error::closed) fail(bus.failure());
    watch.look(bus);
  }
  print_summary(robot);
}

/// The boards and any number of programs on a virtual bus.
void serve(const std::string& bus_name, const SimOptions& options) {
  transport::VirtualBusOptions bus_options;
  if (bus_name.starts_with("sim:")) bus_options.path = bus_name.substr(4);
  bus_options.name = amiro::catalogue.robot;
  bus_options.bit_rate = options.bit_rate;
  bus_options.to_unix_time = std::chrono::system_clock::now().time_since_epoch();
  bus_options.report = [](std::string_view sentence) { remark(sentence); };
  auto opened = transport::VirtualBusServer::open(bus_options);
  if (!opened) fail(opened.error);
  auto& server = **opened;
  auto& arbiter = server.arbiter();

  const SimulatedClock clock{options.speed};
  Ports ports{options.without};
  for (Port* port : {&ports.di_wheel_drive, &ports.power_management, &ports.light_ring}) {
    // A board has three mailboxes that go by identifier; its driver puts the lowest ones there.
    const auto node = arbiter.attach({simulation::QueueOrder::by_identifier, board_queue});
    port->hand_over = [&arbiter, node](const can::Frame& frame) { return arbiter.send(node, frame); };
  }
  Robot robot{options.world, ports.di_wheel_drive, ports.power_management, ports.light_ring};
  remark(fmt::format("simulated {} on --bus {} ({}), {} bit/s; Ctrl-C ends it", amiro::catalogue.robot,
                     bus_name.empty() ? "sim" : bus_name, server.path(), options.bit_rate));

  const auto hear = [&robot](const simulation::Delivery& delivery) {
    robot.receive(delivery.frame, delivery.time);
  };
  while (interrupted() == 0) {
    const base::Time now = clock.now();
    // Whatever falls due until now, in the order in which it does.
    for (;;) {
      const base::Time next = std::min(server.next_event(), robot.next_event());
      if (next > now) break;
      server.advance(next, hear);
      robot.advance(next);
    }
    server.poll(now, hear);
    pollfd input{server.descriptor(), POLLIN, 0};
    const base::Duration wait = clock.until(std::min(server.next_event(), robot.next_event()));
    const timespec limit{0, static_cast<long>(wait.count())};
    ::ppoll(&input, 1, &limit, nullptr);
  }
  print_summary(robot);
  const auto& bus = arbiter.totals();
  const auto& clients = server.counters();
  remark(fmt::format(
      "bus               {} frames, {} clients, {} turned away, {} misbehaved, {} frames lost by slow ones",
      bus.frames, clients.welcomed, clients.turned_away, clients.misbehaved, clients.overruns));
}

}  // namespace

void add_sim(CLI::App& app, Session& session, int& exit_code) {
  auto* verb = add_verb(app, "sim", "a simulated robot, on a virtual bus or on a CAN interface", play_group,
                        "  amiroctl sim                       a virtual bus for this user, as --bus sim\n"
                        "  amiroctl sim --bus vcan0           the three boards on a CAN interface\n"
                        "  amiroctl sim --seed 7 --speed 10\n"
                        "  amiroctl sim --without light_ring  a board that is switched off");
  const auto options = std::make_shared<SimOptions>();
  verb->add_option("--seed", options->world.seed, "of all noise; equal seeds give equal robots")
      ->type_name("N");
  verb->add_flag("--frozen", options->world.frozen,
                 "time stands still in the world: nothing moves, nothing is noisy");
  verb->add_option("--without", options->without, "switch a board off")->type_name("BOARD")->delimiter(',');
  verb->add_option("--speed", options->speed, "how many times faster than real time")
      ->check(CLI::Range(0.001, 1000.0))
      ->type_name("N");
  verb->add_option("--bitrate", options->bit_rate, "of the virtual bus, bit/s")
      ->check(CLI::Range(1'000U, 1'000'000'000U))
      ->type_name("N");
  verb->callback([options, &session, &exit_code] {
    catch_interrupts();
    if (!session.spec_file.empty()) remark("the simulated robot is the AMiRo, whatever --spec says");
    if (!session.bus_name.empty() && session.bus_name != "sim" && !session.bus_name.starts_with("sim:")) {
      const auto bus = session.open_bus();
      simulate_on(*bus, *options);
    } else {
      serve(session.bus_name, *options);
    }
    exit_code = exit_code_after_interrupt(exit_success);
  });
}

}  // namespace ocm::cli
