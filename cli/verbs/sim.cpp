/// A simulated robot: its three boards, compiled for this machine or as images in QEMU, in a simulated world,
/// on a virtual bus or on a CAN interface. Or mappers, which are in cli/sim/.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <poll.h>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "ocm/can/bus.hpp"
#include "ocm/simulation/virtual_bus_server.hpp"

#include "cli/interrupt.hpp"
#include "cli/verbs/commanding.hpp"
#include "cli/verbs/verbs.hpp"
#include "sim/amiro/robot.hpp"
#include "sim/clock.hpp"
#include "sim/mapper/serve.hpp"
#include "sim/qemu/robot.hpp"

namespace ocm::cli {
namespace {

constexpr std::array<std::string_view, 3> board_names{amiro::DiWheelDrive::name, amiro::PowerManagement::name,
                                                      amiro::LightRing::name};

/// A board's connection to whatever bus there is. A board that is switched off sends nothing.
struct Port {
  std::function<base::Result<bool>(const can::Frame&)> hand_over;
  bool on = true;
  base::Result<bool> send(const can::Frame& frame) {
    if (!on) return base::Error::closed;
    return hand_over(frame);
  }
};

/// One for each board, in the order of `board_names`.
using Ports = std::array<Port, board_names.size()>;

/// Frames that wait in a board before its sensors are held up.
constexpr std::size_t board_queue = 32;

struct SimOptions {
  sim::WorldOptions world;
  std::vector<std::string> without;
  bool qemu = false;
  std::string images;
  std::uint32_t bit_rate = amiro::bit_rate;
  double bus_errors = 0;  ///< bits a second that nodes see wrong, on average
  double speed = 1;
};

/// Interference on the wire: single bits at random, at no moment more likely than at another.
class Interference {
 public:
  Interference(double bits_per_second, std::uint64_t seed)
      : random_(seed), seconds_(bits_per_second > 0 ? bits_per_second : 1), on_(bits_per_second > 0) {
    if (on_) step();
  }
  /// Disturbs what lies within a second from `now`: always ahead of what the bus has done.
  void disturb(simulation::Arbiter& bus, base::Time now) {
    for (; on_ && next_ <= now + std::chrono::seconds{1}; step())
      bus.disturb({bus.clock().boundary_from(next_), flag_bits_(random_)});
  }

 private:
  void step() { next_ += base::Duration{static_cast<std::int64_t>(seconds_(random_) * 1e9) + 1}; }

  std::mt19937_64 random_;
  std::exponential_distribution<> seconds_;
  std::uniform_int_distribution<unsigned> flag_bits_{simulation::shortest_flag_bits,
                                                     simulation::longest_flag_bits};
  bool on_;
  base::Time next_{};
};

/// The boards as the bus's loop sees them.
class Robot {
 public:
  Robot() = default;
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;
  virtual ~Robot() = default;

  virtual void receive(const can::Frame& frame, base::Time now) = 0;
  virtual void advance(base::Time now) = 0;
  /// When a board has something to do by itself.
  [[nodiscard]] virtual base::Time next_event() const = 0;
  /// Frames wait for the bus.
  [[nodiscard]] virtual bool waiting() const = 0;
  /// All boards listen.
  [[nodiscard]] virtual bool ready() const { return true; }
  /// Readable when a board has something to say.
  [[nodiscard]] virtual std::vector<int> descriptors() const { return {}; }
  virtual void print_summary() const = 0;
};

/// The boards compiled for this machine.
class HostRobot final : public Robot {
 public:
  HostRobot(const SimOptions& options, Ports& ports) : robot_{options.world, ports[0], ports[1], ports[2]} {}
  void receive(const can::Frame& frame, base::Time now) override { robot_.receive(frame, now); }
  void advance(base::Time now) override { robot_.advance(now); }
  [[nodiscard]] base::Time next_event() const override { return robot_.next_event(); }
  [[nodiscard]] bool waiting() const override { return robot_.waiting(); }
  void print_summary() const override {
    print(board_names[0], robot_.di_wheel_drive().counters());
    print(board_names[1], robot_.power_management().counters());
    print(board_names[2], robot_.light_ring().counters());
  }

 private:
  static void print(std::string_view board, const protocol::Counters& counters) {
    std::string text;
    protocol::for_each(counters, [&text](std::string_view name, std::uint32_t value) {
      if (value != 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, value);
    });
    remark(fmt::format("{:<17} {}", board, text.empty() ? "nothing came" : text));
  }

  sim::SimulatedRobot<Port> robot_;
};

/// Where `scripts/build firmware` and an installation put the images, seen from this program.
std::string default_images() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  for (const char* place : {"firmware", "../firmware", "../share/ocm/firmware"}) {
    const auto folder = program.parent_path() / place;
    if (std::filesystem::exists(folder / "light_ring_qemu_m3.elf", error)) return folder.lexically_normal();
  }
  return (program.parent_path() / "firmware").lexically_normal();
}

/// The boards as images in QEMU.
class EmulatedRobot final : public Robot {
 public:
  EmulatedRobot(const SimOptions& options, Ports& ports, std::function<base::Time()> clock)
      : ports_(&ports), robot_(start(options, std::move(clock))) {}
  void receive(const can::Frame& frame, base::Time now) override { robot_->receive(frame, now); }
  void advance(base::Time now) override {
    const auto send = [this](std::size_t board, const can::Frame& frame) {
      const auto taken = (*ports_)[board].send(frame);
      return !taken || *taken;  // what a bus will never take is gone
    };
    if (!robot_->advance(now, send)) fail(robot_->failure());
  }
  [[nodiscard]] base::Time next_event() const override { return base::never; }
  [[nodiscard]] bool waiting() const override {
    return robot_->waiting(0) || robot_->waiting(1) || robot_->waiting(2);
  }
  [[nodiscard]] bool ready() const override { return robot_->ready(); }
  [[nodiscard]] std::vector<int> descriptors() const override {
    const auto all = robot_->descriptors();
    return {all.begin(), all.end()};
  }
  void print_summary() const override {
    for (std::size_t i = 0; i < sim::QemuRobot::boards; ++i) {
      const auto& counters = robot_->counters(i);
      remark(fmt::format("{:<17} sent {}, heard {}, lost on its line {}, garbage {}, exchanges with parts {}",
                         robot_->name(i), counters.sent, counters.heard, counters.deaf, counters.garbage,
                         counters.exchanges));
      for (const std::string& text : robot_->violations(i).texts())
        remark(fmt::format("{:<17} against a data sheet: {}", robot_->name(i), text));
    }
  }

 private:
  static std::unique_ptr<sim::QemuRobot> start(const SimOptions& options, std::function<base::Time()> clock) {
    auto started = sim::QemuRobot::start(
        options.world, options.images.empty() ? default_images() : options.images, std::move(clock));
    if (!started) fail(started.error);
    return std::move(*started);
  }

  Ports* ports_;
  std::unique_ptr<sim::QemuRobot> robot_;
};

/// Until something is readable, or `wait` is over.
void wait_for(int bus, const Robot& robot, base::Duration wait) {
  std::vector<pollfd> inputs{{bus, POLLIN, 0}};
  for (const int descriptor : robot.descriptors()) inputs.push_back({descriptor, POLLIN, 0});
  const timespec limit{0, static_cast<long>(wait.count())};
  ::ppoll(inputs.data(), inputs.size(), &limit, nullptr);
}

std::unique_ptr<Robot> make_robot(const SimOptions& options, Ports& ports, const SimulatedClock& clock) {
  for (const auto& board : options.without) {
    const auto found = std::find(board_names.begin(), board_names.end(), board);
    if (found == board_names.end())
      fail({"sim: no board '" + board + "'", fmt::format("one of: {}", fmt::join(board_names, ", "))},
           exit_usage);
    ports[static_cast<std::size_t>(found - board_names.begin())].on = false;
  }
  if (options.qemu) return std::make_unique<EmulatedRobot>(options, ports, [&clock] { return clock.now(); });
  return std::make_unique<HostRobot>(options, ports);
}

/// Boards in QEMU start like others, in their time; who waits for the simulator waits for them.
void wait_until_ready(Robot& robot, const SimulatedClock& clock) {
  const base::Time patience = clock.now() + std::chrono::seconds{30};
  while (!robot.ready() && interrupted() == 0) {
    robot.advance(clock.now());
    wait_for(-1, robot, std::chrono::milliseconds{20});
    if (clock.now() > patience)
      fail({"sim: a board in QEMU does not start", "are these images of the boards? See docs/verbs/sim.md"});
  }
}

/// The boards on a real CAN interface: the kernel is the bus.
void simulate_on(transport::Bus& bus, const SimOptions& options) {
  Ports ports;
  for (Port& port : ports) port.hand_over = [&bus](const can::Frame& frame) { return bus.send(frame); };
  const SimulatedClock clock{1};
  const auto robot = make_robot(options, ports, clock);
  wait_until_ready(*robot, clock);
  StateWatch watch;
  while (interrupted() == 0) {
    robot->advance(clock.now());
    auto received = bus.receive(base::Duration{0});
    if (!received && received.error == base::Error::timed_out) {
      wait_for(
          bus.descriptor(), *robot,
          robot->waiting() ? base::Duration{std::chrono::milliseconds{1}} : clock.until(robot->next_event()));
      received = bus.receive(base::Duration{0});
    }
    if (received && received->frame.format != can::Format::error)
      robot->receive(received->frame, clock.now());
    if (!received && received.error == base::Error::closed) fail(bus.failure());
    watch.look(bus);
  }
  robot->print_summary();
}

/// The boards and any number of programs on a virtual bus.
void serve(const std::string& bus_name, const SimOptions& options) {
  simulation::VirtualBusOptions bus_options;
  if (bus_name.starts_with("sim:")) bus_options.path = bus_name.substr(4);
  bus_options.name = amiro::catalogue.robot;
  bus_options.bit_rate = options.bit_rate;
  bus_options.to_unix_time = std::chrono::system_clock::now().time_since_epoch();
  bus_options.report = [](std::string_view sentence) { remark(sentence); };
  auto opened = simulation::VirtualBusServer::open(bus_options);
  if (!opened) fail(opened.error);
  auto& server = **opened;
  auto& arbiter = server.arbiter();

  const SimulatedClock clock{options.speed};
  Ports ports;
  for (Port& port : ports) {
    // A board has three mailboxes that go by identifier; its driver puts the lowest ones there.
    const auto node = arbiter.attach({simulation::QueueOrder::by_identifier, board_queue});
    port.hand_over = [&arbiter, node](const can::Frame& frame) { return arbiter.send(node, frame); };
  }
  const auto robot = make_robot(options, ports, clock);
  wait_until_ready(*robot, clock);
  remark(fmt::format("simulated {}{} on --bus {} ({}), {} bit/s; Ctrl-C ends it", amiro::catalogue.robot,
                     options.qemu ? " with its boards in QEMU" : "", bus_name.empty() ? "sim" : bus_name,
                     server.path(), options.bit_rate));

  const auto hear = [&robot](const simulation::Delivery& delivery) {
    robot->receive(delivery.frame, delivery.time);
  };
  Interference interference{options.bus_errors, options.world.seed};
  while (interrupted() == 0) {
    const base::Time now = clock.now();
    interference.disturb(arbiter, now);
    // Whatever falls due until now, in the order in which it does.
    for (;;) {
      const base::Time next = std::min(server.next_event(), robot->next_event());
      if (next > now) break;
      server.advance(next, hear);
      robot->advance(next);
    }
    if (options.qemu) robot->advance(now);
    server.poll(now, hear);
    wait_for(server.descriptor(), *robot, clock.until(std::min(server.next_event(), robot->next_event())));
  }
  robot->print_summary();
  const auto& bus = arbiter.totals();
  const auto& clients = server.counters();
  remark(fmt::format(
      "bus               {} frames, {} clients, {} turned away, {} misbehaved, {} frames lost by slow ones",
      bus.frames, clients.welcomed, clients.turned_away, clients.misbehaved, clients.overruns));
  if (options.bus_errors > 0)
    remark(fmt::format("                  {} error frames, {} frames repeated", bus.errors, bus.repetitions));
}

// --- mappers ---

constexpr std::array<const char*, 5> mapper_options{"--lines", "--radio-loss", "--radio-range",
                                                    "--radio-repeats", "--links"};

void add_mappers(CLI::App& verb, MapperOptions& options) {
  verb.add_option("--robots", options.robots, "so many mappers instead of the AMiRo, and their central")
      ->check(CLI::Range(1U, 128U))
      ->type_name("N");
  verb.add_option("--world", options.world,
                  "where the mappers are: a file, or square (default), labyrinth, range")
      ->type_name("FILE");
  verb.add_flag("--lines", options.lines, "no central: each mapper on a serial line of its own");
  verb.add_option("--radio-loss", options.radio_loss, "share of packets lost wherever a robot is")
      ->check(CLI::Range(0.0, 1.0))
      ->type_name("0..1");
  verb.add_option("--radio-range", options.radio_range,
                  "how far the central's radio reaches; default: the world's")
      ->check(CLI::Range(0.01, 10'000.0))
      ->type_name("METRES");
  verb.add_flag("--radio-repeats", options.repeats, "the radio repeats what was lost, as Bluetooth does");
  verb.add_option("--links", options.links, "robots that the central can have a link with; default: all")
      ->check(CLI::Range(1U, 128U))
      ->type_name("N");
}
bool wants_mappers(const CLI::App& verb) {
  if (verb.count("--robots") != 0 || verb.count("--world") != 0) return true;
  for (const char* option : mapper_options)
    if (verb.count(option) != 0)
      fail({fmt::format("sim: {} without --robots", option), "add --robots N, or leave it out"}, exit_usage);
  return false;
}
/// What is meant for the AMiRo's boards and their bus.
void refuse_boards_options(const CLI::App& verb, const Session& session) {
  for (const char* option : {"--bus-errors", "--boards", "--images", "--without", "--frozen", "--bitrate"})
    if (verb.count(option) != 0)
      fail({fmt::format("sim: {} with mappers", option), "they have no bus and no boards: leave one out"},
           exit_usage);
  const char* environment = std::getenv("AMIROCTL_BUS");
  if (!session.bus_name.empty() && session.bus_name != (environment != nullptr ? environment : ""))
    fail({"sim: --bus with mappers", "they have no bus: leave one out"}, exit_usage);
  if (verb.count("--lines") != 0)
    for (const char* option : {"--radio-loss", "--radio-range", "--radio-repeats", "--links"})
      if (verb.count(option) != 0)
        fail({fmt::format("sim: {} with --lines", option),
              "without a central there is no radio: leave one out"},
             exit_usage);
}

}  // namespace

void add_sim(CLI::App& app, Session& session, int& exit_code) {
  auto* verb = add_verb(app, "sim", "a simulated robot, on a virtual bus or on a CAN interface", play_group,
                        "  amiroctl sim                       a virtual bus for this user, as --bus sim\n"
                        "  amiroctl sim --bus vcan0           the three boards on a CAN interface\n"
                        "  amiroctl sim --seed 7 --speed 10\n"
                        "  amiroctl sim --without light_ring  a board that is switched off\n"
                        "  amiroctl sim --bus-errors 20       interference: 20 broken bits a second\n"
                        "  amiroctl sim --boards qemu         the boards' firmware, emulated\n"
                        "  amiroctl sim --robots 2            mappers in a room, and their central\n"
                        "  amiroctl sim --world labyrinth --radio-loss 0.1");
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
  verb->add_option("--bus-errors", options->bus_errors,
                   "on the virtual bus: bits a second that interference breaks, on average")
      ->check(CLI::Range(0.0, 100'000.0))
      ->type_name("N");
  const auto boards = std::make_shared<std::string>("host");
  verb->add_option("--boards", *boards,
                   "host: the boards' code compiled for this machine; qemu: their images, emulated")
      ->check(CLI::IsMember({"host", "qemu"}))
      ->type_name("host|qemu");
  verb->add_option("--images", options->images,
                   "folder of the images for QEMU (that of scripts/build firmware)")
      ->type_name("FOLDER");
  const auto mappers = std::make_shared<MapperOptions>();
  add_mappers(*verb, *mappers);
  verb->callback([options, boards, mappers, verb, &session, &exit_code] {
    if (wants_mappers(*verb)) {
      refuse_boards_options(*verb, session);
      catch_interrupts();
      catch_hangups();  // the lines' links must go with it
      mappers->seed = options->world.seed;
      mappers->speed = options->speed;
      simulate_mappers(*mappers);
      exit_code = exit_code_after_interrupt(exit_success);
      return;
    }
    options->qemu = *boards == "qemu";
    if (options->qemu && options->speed != 1)
      fail({"sim: --speed with --boards qemu", "leave one out: emulated boards run in real time"},
           exit_usage);
    if (!options->qemu && !options->images.empty())
      fail({"sim: --images without --boards qemu", "add --boards qemu, or leave --images out"}, exit_usage);
    catch_interrupts();
    if (!session.spec_file.empty()) remark("the simulated robot is the AMiRo, whatever --spec says");
    if (!session.bus_name.empty() && session.bus_name != "sim" && !session.bus_name.starts_with("sim:")) {
      if (options->bus_errors > 0)
        fail({"sim: --bus-errors with --bus " + session.bus_name,
              "leave one out: a real bus has errors of its own"},
             exit_usage);
      const auto bus = session.open_bus();
      simulate_on(*bus, *options);
    } else {
      serve(session.bus_name, *options);
    }
    exit_code = exit_code_after_interrupt(exit_success);
  });
}

}  // namespace ocm::cli
