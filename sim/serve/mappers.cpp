#include "sim/serve/mappers.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <poll.h>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "ocm/client/counted.hpp"
#include "ocm/host/system_time.hpp"
#include "ocm/transport/pty.hpp"

#include "sim/mapper/fleet.hpp"
#include "sim/serve/clock.hpp"
#include "sim/serve/round.hpp"
#include "sim/worlds/reader.hpp"

namespace ocm::sim {
namespace {

namespace plant = mapper;
using namespace std::chrono_literals;

/// What a program has not read yet; more is lost, and counted.
constexpr std::size_t max_unread = 65'536;
/// A program that opens a line is seen that soon.
constexpr base::Duration look_period = 20ms;

struct ChosenWorld {
  plant::WorldModel model;
  Ending problems;
};

ChosenWorld read_world(const MapperOptions& options) {
  ChosenWorld chosen;
  const std::string name = options.world.empty() ? "square" : options.world;
  auto loaded = worlds::find(name);
  for (const auto& problem : loaded.problems)
    chosen.problems.failures.push_back({"sim: " + worlds::in_words(problem), problem.remedy});
  if (!loaded.world) return chosen;
  chosen.model = std::move(*loaded.world);
  const std::size_t robots = options.robots == 0 ? chosen.model.starts.size() : options.robots;
  auto starts = plant::starts_for(chosen.model, robots);
  if (!starts || starts->empty()) {
    chosen.problems = Ending{{fmt::format("sim: no room for {} robots in '{}'", robots, name),
                              chosen.model.starts.empty() ? "the world has no start: give it one (robots)"
                                                          : "take fewer, or a larger world with --world"}};
    return chosen;
  }
  chosen.model.starts = std::move(*starts);
  if (chosen.model.starts.size() > plant::Fleet::max_robots)
    chosen.problems = Ending{{fmt::format("sim: {} robots", chosen.model.starts.size()),
                              fmt::format("at most {}", plant::Fleet::max_robots)},
                             true};
  return chosen;
}

/// Parts of a sentence that say what was lost: only those that are not 0.
class Losses {
 public:
  /// A noun has a star behind it where its plural has an s.
  Losses& add(std::uint64_t count, std::string_view what) {
    if (count == 0) return *this;
    const bool noun = what.find('*') != std::string_view::npos;
    text_ += ", " + (noun ? ocm::client::counted(count, what) : fmt::format("{} {}", count, what));
    return *this;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

template <class Robot>
void report_robot(Robot& robot, const std::string& link, const Shell& shell) {
  const ocm::mapper::app::Counters counters = robot.application().counters();
  Losses lost;
  lost.add(counters.unsent, "sentence* for a link that was gone")
      .add(counters.output_full, "byte* that its line had no room for")
      .add(counters.input_full + counters.input_dropped + counters.input_unlinked, "byte* to it lost")
      .add(counters.damaged.total(), "damaged sentence*")
      .add(counters.refused, "sentence* refused")
      .add(counters.orders_lost, "order* replaced");
  shell.report(fmt::format(
      "{:<10} links {}, handshakes {}, updates {}, idles {}, set points {}, arrived {}, stops {}{}",
      robot.body().name(), counters.links, counters.handshakes, counters.updates, counters.idles,
      counters.set_points, counters.arrived, counters.collisions, lost.text()));
  if (!link.empty()) shell.report(fmt::format("{:<10} {}", "", link));
}

void wait(const std::vector<pollfd>& inputs, base::Duration limit) {
  std::vector<pollfd> copy = inputs;
  const timespec time = host::to_timespec(limit);
  ::ppoll(copy.data(), copy.size(), &time, nullptr);
}

// --- behind a central ---

/// The pseudo terminal in place of the central's serial line.
class CentralLine {
 public:
  explicit CentralLine(transport::Pty pty) : pty_(std::move(pty)) {}
  [[nodiscard]] const std::string& name() const { return pty_.name(); }
  /// What the server says.
  [[nodiscard]] std::string_view read() {
    attached_ = pty_.attached();
    return {room_.data(), attached_ ? pty_.read(room_) : 0};
  }
  void write(std::string text) {
    if (!attached_) {
      unheard_ += unread_.size() + text.size();
      unread_.clear();
      return;
    }
    if (unread_.size() + text.size() > max_unread)
      unread_lost_ += text.size();
    else
      unread_ += text;
    unread_.erase(0, pty_.write(unread_));
  }
  [[nodiscard]] std::vector<pollfd> inputs() const {
    if (!attached_) return {};
    return {{pty_.descriptor(), static_cast<short>(POLLIN | (unread_.empty() ? 0 : POLLOUT)), 0}};
  }
  [[nodiscard]] bool attached() const { return attached_; }
  [[nodiscard]] std::uint64_t unheard() const { return unheard_; }
  [[nodiscard]] std::uint64_t unread_lost() const { return unread_lost_; }

 private:
  transport::Pty pty_;
  bool attached_ = false;
  std::string unread_;
  std::uint64_t unheard_ = 0;      ///< bytes while no program was there
  std::uint64_t unread_lost_ = 0;  ///< bytes that one did not read
  std::array<char, 4096> room_{};
};

std::string way_text(const simulation::WayCounters& way) {
  return fmt::format("{}{}", way.taken,
                     Losses{}
                         .add(way.lost, "lost in the air")
                         .add(way.repeated, "repeated")
                         .add(way.dropped, "dropped with a link")
                         .text());
}
void summarise(plant::Fleet& fleet, const CentralLine& line, const Shell& shell) {
  for (std::size_t i = 0; i < fleet.size(); ++i) {
    const simulation::RadioCounters& radio = fleet.radio().counters(i);
    const auto& dongle = fleet.dongle(i);
    report_robot(
        fleet.robot(i),
        fmt::format("packets to it {}; from it {}{}", way_text(radio.to_robot), way_text(radio.to_central),
                    Losses{}
                        .add(dongle.outbox().refused, "that its dongle had no room for")
                        .add(dongle.outbox().dropped, "that waited for a link that died")
                        .add(dongle.counters().dropped, "byte* that went with a link")
                        .add(dongle.counters().refused, "byte* too many for its UART")
                        .add(radio.robot_timeouts, "time-out* of the link")
                        .add(radio.refused + radio.failed, "attempt* to connect that failed")
                        .text()),
        shell);
  }
  const ocm::mapper::link::CentralCounters& central = fleet.central().counters();
  const std::string lost = Losses{}
                               .add(central.refused_commands, "command* refused")
                               .add(central.unsent_bytes, "byte* for links that were gone or full")
                               .add(central.dropped_packets, "packet* dropped with a link")
                               .add(central.unlisted, "robot* beyond the list")
                               .add(line.unheard(), "byte* sent with no server connected")
                               .add(line.unread_lost(), "byte* that the program did not read")
                               .text();
  shell.report(fmt::format("{:<10} {}", "central", lost.empty() ? "nothing was lost" : lost.substr(2)));
}

Ending serve_fleet(plant::World& world, const MapperOptions& options, const Shell& shell) {
  auto opened = transport::Pty::open(transport::central_line());
  if (!opened) return Ending{opened.error};
  CentralLine line{std::move(*opened)};
  plant::FleetOptions fleet_options = plant::Fleet::options_for(world, options.seed);
  fleet_options.radio.loss_everywhere = options.radio_loss;
  fleet_options.radio.repeats = options.repeats;
  if (options.radio_range > 0) fleet_options.radio.range_m = options.radio_range;
  fleet_options.calibrated = !options.uncalibrated;
  if (options.links != 0) fleet_options.radio.links = options.links;
  const auto fleet = std::make_unique<plant::Fleet>(world, fleet_options);
  shell.report(fmt::format("simulated {} in '{}', their central on {}; Ctrl-C ends it",
                           client::counted(fleet->size(), "mapper"), world.model().name, line.name()));
  const SimulatedClock clock{options.speed};
  Lateness lateness{shell.report};
  while (!shell.stop()) {
    Round round{clock.now()};
    for (base::Time next = fleet->next_event(); round.takes(next); next = fleet->next_event())
      fleet->advance_to(next);
    fleet->advance_to(round.reached());
    lateness.note(round, clock);
    fleet->write(line.read());
    line.write(fleet->read());
    if (shell.watch) shell.watch([&world] { return seen(world); });
    wait(line.inputs(), std::min(clock.until(fleet->next_event()), look_period));
  }
  summarise(*fleet, line, shell);
  lateness.sum_up();
  return {};
}

// --- each on a line of its own ---

/// A robot's link, when it is a pseudo terminal: there is one while a program has it open.
class OwnLine {
 public:
  explicit OwnLine(transport::Pty pty) : pty_(std::move(pty)) {}
  /// Whether that has changed.
  [[nodiscard]] bool look() {
    const bool was = attached_;
    attached_ = pty_.attached();
    return was != attached_;
  }
  [[nodiscard]] std::span<const std::uint8_t> read() {
    const std::size_t size = attached_ ? pty_.read(room_) : 0;
    return {reinterpret_cast<const std::uint8_t*>(room_.data()), size};
  }
  [[nodiscard]] pollfd input() const { return {attached_ ? pty_.descriptor() : -1, POLLIN, 0}; }

  // As plant::RobotLink
  [[nodiscard]] bool linked() const { return attached_; }
  [[nodiscard]] std::size_t write(std::span<const std::uint8_t> bytes, base::Time) {
    return attached_ ? pty_.write({reinterpret_cast<const char*>(bytes.data()), bytes.size()}) : bytes.size();
  }

 private:
  transport::Pty pty_;
  bool attached_ = false;
  std::array<char, 4096> room_{};
};
static_assert(plant::RobotLink<OwnLine>);
using LinedRobot = plant::RunningRobot<OwnLine>;

Ending serve_lines(plant::World& world, const MapperOptions& options, const Shell& shell) {
  std::vector<std::unique_ptr<OwnLine>> lines;
  std::vector<std::unique_ptr<LinedRobot>> robots;
  for (std::size_t i = 0; i < world.size(); ++i) {
    auto opened =
        transport::Pty::open(transport::robot_lines() + "/" + transport::line_name(world.robot(i).name()));
    if (!opened) return Ending{opened.error};
    if (!options.uncalibrated) plant::calibrate(world.robot(i));
    lines.push_back(std::make_unique<OwnLine>(std::move(*opened)));
    robots.push_back(std::make_unique<LinedRobot>(world.robot(i), *lines.back(), world.time()));
  }
  shell.report(fmt::format("simulated {} in '{}', each on its line in {}; Ctrl-C ends it",
                           client::counted(robots.size(), "mapper"), world.model().name,
                           transport::robot_lines()));
  const SimulatedClock clock{options.speed};
  const auto next_event = [&robots] {
    base::Time next = base::never;
    for (const auto& robot : robots) next = std::min(next, robot->next_event());
    return next;
  };
  const auto happen = [&](base::Time now) {
    world.advance_to(now);
    for (const auto& robot : robots) robot->advance_to(now);
  };
  Lateness lateness{shell.report};
  while (!shell.stop()) {
    Round round{clock.now()};
    for (base::Time next = next_event(); round.takes(next); next = next_event()) happen(next);
    const base::Time now = round.reached();
    lateness.note(round, clock);
    std::vector<pollfd> inputs;
    for (std::size_t i = 0; i < robots.size(); ++i) {
      if (lines[i]->look()) robots[i]->link_changed(now);
      robots[i]->receive(lines[i]->read(), now);
      inputs.push_back(lines[i]->input());
    }
    happen(now);
    if (shell.watch) shell.watch([&world] { return seen(world); });
    wait(inputs, std::min(clock.until(next_event()), look_period));
  }
  for (const auto& robot : robots) report_robot(*robot, "", shell);
  lateness.sum_up();
  return {};
}

}  // namespace

Ending serve_mappers(const MapperOptions& options, const Shell& shell) {
  ChosenWorld chosen = read_world(options);
  if (!chosen.problems.well()) return chosen.problems;
  plant::World world{std::move(chosen.model), {.seed = options.seed}};
  if (auto problem = transport::make_line_folders()) return Ending{*problem};
  return options.lines ? serve_lines(world, options, shell) : serve_fleet(world, options, shell);
}

}  // namespace ocm::sim
