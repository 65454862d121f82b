#include "sim/mapper/serve.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <poll.h>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "ocm/host/system_time.hpp"
#include "ocm/transport/pty.hpp"

#include "cli/interrupt.hpp"
#include "cli/session.hpp"
#include "sim/clock.hpp"
#include "sim/mapper/fleet.hpp"
#include "sim/worlds/reader.hpp"

namespace ocm::cli {
namespace {

namespace plant = sim::mapper;
using namespace std::chrono_literals;

/// What a program has not read yet; more is lost, and counted.
constexpr std::size_t max_unread = 65'536;
/// A program that opens a line is seen that soon.
constexpr base::Duration look_period = 20ms;

plant::WorldModel read_world(const MapperOptions& options) {
  const std::string name = options.world.empty() ? "square" : options.world;
  std::error_code error;
  const bool is_file = std::filesystem::exists(name, error) && !std::filesystem::is_directory(name, error);
  const auto built_in = sim::worlds::built_in(name);
  if (!is_file && !built_in)
    fail({fmt::format("sim: there is no world '{}'", name),
          fmt::format("give a file, or one of those built in: {}",
                      fmt::join(sim::worlds::built_in_names(), ", "))});
  auto loaded = is_file ? sim::worlds::load(name) : sim::worlds::parse(*built_in, name);
  for (const auto& problem : loaded.problems)
    fmt::print(stderr, "amiroctl: {}: {}\n          {}\n", problem.place, problem.what, problem.remedy);
  if (!loaded.world) throw Exit{exit_failure};
  plant::WorldModel model = std::move(*loaded.world);
  const std::size_t robots = options.robots == 0 ? model.starts.size() : options.robots;
  auto starts = plant::starts_for(model, robots);
  if (!starts || starts->empty())
    fail({fmt::format("sim: no room for {} robots in '{}'", robots, name),
          model.starts.empty() ? "the world has no start: give it one (robots)"
                               : "take fewer, or a larger world with --world"});
  model.starts = std::move(*starts);
  return model;
}

/// Parts of a sentence that say what was lost: only those that are not 0.
class Losses {
 public:
  Losses& add(std::uint64_t count, std::string_view what) {
    if (count != 0) text_ += fmt::format(", {} {}", count, what);
    return *this;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

template <class Robot>
void print_robot(Robot& robot, const std::string& link) {
  const ocm::mapper::app::Counters counters = robot.application().counters();
  Losses lost;
  lost.add(counters.unsent, "sentences for a link that was gone")
      .add(counters.output_full, "bytes that its line had no room for")
      .add(counters.input_full + counters.input_dropped + counters.input_unlinked, "bytes to it lost")
      .add(counters.damaged.total(), "damaged sentences")
      .add(counters.refused, "sentences refused")
      .add(counters.orders_lost, "orders replaced");
  remark(fmt::format(
      "{:<10} links {}, handshakes {}, updates {}, idles {}, set points {}, arrived {}, stops {}{}",
      robot.body().name(), counters.links, counters.handshakes, counters.updates, counters.idles,
      counters.set_points, counters.arrived, counters.collisions, lost.text()));
  if (!link.empty()) remark(fmt::format("{:<10} {}", "", link));
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
  CentralLine() {
    if (auto problem = transport::make_line_folders()) fail(*problem);
    auto opened = transport::Pty::open(transport::central_line());
    if (!opened) fail(opened.error);
    pty_ = std::move(*opened);
  }
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
                         .add(way.dropped, "dropped with their link")
                         .text());
}
void print_summary(plant::Fleet& fleet, const CentralLine& line) {
  for (std::size_t i = 0; i < fleet.size(); ++i) {
    const simulation::RadioCounters& radio = fleet.radio().counters(i);
    const auto& dongle = fleet.dongle(i);
    print_robot(
        fleet.robot(i),
        fmt::format("packets to it {}; from it {}{}", way_text(radio.to_robot), way_text(radio.to_central),
                    Losses{}
                        .add(dongle.outbox().refused, "that its dongle had no room for")
                        .add(dongle.outbox().dropped, "that waited for a link that died")
                        .add(dongle.counters().dropped, "bytes that went with a link")
                        .add(dongle.counters().refused, "bytes too many for its UART")
                        .add(radio.robot_timeouts, "time-outs of the link")
                        .add(radio.refused + radio.failed, "attempts to connect that failed")
                        .text()));
  }
  const ocm::mapper::link::CentralCounters& central = fleet.central().counters();
  const std::string lost = Losses{}
                               .add(central.refused_commands, "commands refused")
                               .add(central.unsent_bytes, "bytes for links that were gone or full")
                               .add(central.dropped_packets, "packets dropped with their link")
                               .add(central.unlisted, "robots beyond the list")
                               .add(line.unheard(), "bytes said to nobody")
                               .add(line.unread_lost(), "bytes that the program did not read")
                               .text();
  remark(fmt::format("{:<10} {}", "central", lost.empty() ? "nothing was lost" : lost.substr(2)));
}

void simulate_fleet(plant::World& world, const MapperOptions& options) {
  plant::FleetOptions fleet_options = plant::Fleet::options_for(world, options.seed);
  fleet_options.radio.loss_everywhere = options.radio_loss;
  fleet_options.radio.repeats = options.repeats;
  if (options.radio_range > 0) fleet_options.radio.range_m = options.radio_range;
  if (options.links != 0) fleet_options.radio.links = options.links;
  CentralLine line;
  const auto fleet = std::make_unique<plant::Fleet>(world, fleet_options);
  remark(fmt::format("simulated {} mapper{} in '{}', their central on {}; Ctrl-C ends it", fleet->size(),
                     fleet->size() == 1 ? "" : "s", world.model().name, line.name()));
  const SimulatedClock clock{options.speed};
  while (interrupted() == 0) {
    fleet->advance_to(clock.now());
    fleet->write(line.read());
    line.write(fleet->read());
    wait(line.inputs(), std::min(clock.until(fleet->next_event()), look_period));
  }
  print_summary(*fleet, line);
}

// --- each on a line of its own ---

/// A robot's link, when it is a pseudo terminal: there is one while a program has it open.
class OwnLine {
 public:
  explicit OwnLine(const std::string& name) {
    auto opened = transport::Pty::open(transport::robot_lines() + "/" + name);
    if (!opened) fail(opened.error);
    pty_ = std::move(*opened);
  }
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

void simulate_lines(plant::World& world, const MapperOptions& options) {
  if (auto problem = transport::make_line_folders()) fail(*problem);
  std::vector<std::unique_ptr<OwnLine>> lines;
  std::vector<std::unique_ptr<LinedRobot>> robots;
  for (std::size_t i = 0; i < world.size(); ++i) {
    std::string name = world.robot(i).name();
    std::replace(name.begin(), name.end(), '/', '_');
    lines.push_back(std::make_unique<OwnLine>(name));
    robots.push_back(std::make_unique<LinedRobot>(world.robot(i), *lines.back(), world.time()));
  }
  remark(fmt::format("simulated {} mapper{} in '{}', each on its line in {}; Ctrl-C ends it", robots.size(),
                     robots.size() == 1 ? "" : "s", world.model().name, transport::robot_lines()));
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
  while (interrupted() == 0) {
    const base::Time now = clock.now();
    for (base::Time next = next_event(); next <= now; next = next_event()) happen(next);
    std::vector<pollfd> inputs;
    for (std::size_t i = 0; i < robots.size(); ++i) {
      if (lines[i]->look()) robots[i]->link_changed(now);
      robots[i]->receive(lines[i]->read(), now);
      inputs.push_back(lines[i]->input());
    }
    happen(now);
    wait(inputs, std::min(clock.until(next_event()), look_period));
  }
  for (const auto& robot : robots) print_robot(*robot, "");
}

}  // namespace

void simulate_mappers(const MapperOptions& options) {
  plant::WorldModel model = read_world(options);
  if (model.starts.size() > plant::Fleet::max_robots)
    fail({fmt::format("sim: {} robots", model.starts.size()),
          fmt::format("at most {}", plant::Fleet::max_robots)},
         exit_usage);
  plant::World world{std::move(model), {.seed = options.seed}};
  if (options.lines)
    simulate_lines(world, options);
  else
    simulate_fleet(world, options);
}

}  // namespace ocm::cli
