#include "cli/serve/fleet_watch.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <functional>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "ocm/transport/pty.hpp"

#include "cli/fleet/line_time.hpp"
#include "cli/fleet/picture.hpp"
#include "cli/shared/clock.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/json.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::serve {
namespace {

using namespace std::chrono_literals;
using fleet::CentralLine;
using fleet::RobotNow;
using foxglove::Level;

constexpr base::Duration state_interval = 200ms;
constexpr base::Duration first_retry = 500ms, longest_retry = 16s;

cognitive::FleetOptions fleet_options(const fleet::Known& known) {
  cognitive::FleetOptions fleet;
  if (known.central) fleet.central = *known.central;
  if (known.range_m > 0) fleet.range_m = static_cast<float>(known.range_m);
  return fleet;
}

}  // namespace

FleetWatch::FleetWatch(const FleetOptions& options, Viewers& viewers, FleetChannels channels, Orders& orders)
    : options_(options),
      known_(fleet::known_of("serve", options.world, options.starts)),
      viewers_(&viewers),
      channels_(channels),
      orders_(&orders),
      errands_([this](ViewerId viewer, Level level,
                      const std::string& words) { viewers_->tell(viewer, foxglove::status(level, words)); },
               [this](unsigned index) { return robot(index); }),
      keeper_(options.call_back, [this](const std::string& words) { say(Level::warning, words); }),
      drawn_(cognitive::Fleet::most_robots) {
  if (!options_.waits) open();
}

void FleetWatch::open() {
  line_ = std::make_unique<CentralLine>("serve", options_.line, fleet::Need::any, fleet_options(known_));
  source_ = line_->end().path();
}

FleetWatch::~FleetWatch() {
  stops_ = true;
  if (thread_.joinable()) thread_.join();
}

void FleetWatch::run(std::function<void()> woken) {
  woken_ = std::move(woken);
  sigset_t all;  // signals are for the main thread
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::thread{[this] { main(); }};
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

bool FleetWatch::is_there() const {
  const std::string& path = options_.line.path;
  return path.empty() ? transport::is_served(transport::central_line()) : ::access(path.c_str(), F_OK) == 0;
}

void FleetWatch::main() {
  const auto over = [this] { return stops_ || interrupted() != 0; };
  base::Duration wait = first_retry;
  while (!over()) {
    try {
      if (line_ == nullptr) open();
      begin();
      wait = first_retry;
      (void)line_->run(std::nullopt, [&] {
        step();
        return stops_.load();
      });
      // Not those that other programs drive: OwnLine waits for these.
      std::vector<unsigned> robots;
      for (const auto& peer : line_->end().peers()) robots.push_back(peer.index);
      (void)line_->halt(robots);
      line_.reset();
    } catch (const Exit&) {  // it is said on stderr
      if (over() || options_.waits) return;
      gone_ = "the central's line is gone, or the program that had it has ended: waiting for it";
      say(Level::error, gone_);
      errands_.forget();
      robots_ = 0;
      line_.reset();
      publish(fleet::line_time());
      for (base::Duration waited{}; !over() && (waited < wait || !is_there()); waited += 50ms) {
        sleep_for(50ms);
        for (const Order& order : orders_->take())
          if (order.kind != Order::Kind::gone)
            viewers_->tell(order.viewer, foxglove::status(Level::error, gone_));
      }
      wait = std::min(2 * wait, longest_retry);
    }
  }
}

void FleetWatch::say(Level level, const std::string& words) {
  remark("serve: " + words);
  viewers_->tell(0, foxglove::status(level, words));
}

void FleetWatch::begin() {
  source_ = line_->end().path();
  if (!std::exchange(gone_, {}).empty())
    say(Level::info, line_->own() != nullptr ? fmt::format("it has {} itself now", source_)
                                             : fmt::format("it has joined {}", source_));
  owner_draws_ = false;
  if (line_->joined() != nullptr) {
    (void)map_of_owner();  // who looks on is not waited for
    return;
  }
  placed_.clear();  // a line that was opened again has another fleet
  place();
  link_all(*line_, [this](const std::string& words) { say(Level::warning, words); });
  auto& owner = line_->own()->owner();
  owner.on_draw([this](std::string_view form) {
    if (drawing_.counters().drawn == 0) return std::string{};
    fleet::MapPicture picture{.title = "map by serve", .subtitle = {}, .robots = {}, .walls = known_.walls};
    for (const auto& peer : line_->end().peers())
      picture.robots.push_back({peer.name, drawing_.path(peer.index), {}});
    return fleet::to_form(drawing_.map(), picture, form);
  });
}

/// Where robots began, those among them that were found later: programs that join ask for it, and by it the
/// fleet judges how far away a robot is.
void FleetWatch::place() {
  if (line_->own() == nullptr) return;
  for (const auto& peer : line_->end().peers()) {
    // Once: where a robot begins again the fleet moves its origin itself.
    if (std::exchange(placed_[peer.index], peer.name) == peer.name) continue;
    for (const fleet::Start& start : known_.starts)
      if (start.name == peer.name) line_->own()->server().fleet().set_origin(peer.index, start.pose);
  }
}

/// Of a program that has the line and does not know where its robots began this one may.
RobotNow FleetWatch::robot(unsigned index) const {
  RobotNow robot = line_->robot(index);
  if (robot.origin_known) return robot;
  const auto start = std::find_if(known_.starts.begin(), known_.starts.end(),
                                  [&](const fleet::Start& each) { return each.name == robot.name; });
  if (start != known_.starts.end()) robot.origin = cognitive::placed(start->pose, robot.origin);
  robot.origin_known = start != known_.starts.end() || robots_ == 1;
  return robot;
}

void FleetWatch::step() {
  const base::Time now = fleet::line_time();
  robots_ = line_->end().peers().size();
  for (const Order& order : orders_->take()) obey(order);
  place();
  errands_.step(line_->end(), now);
  for (const ViewerId viewer : attendance_.silent(errands_.driving(line_->end()), *viewers_, now)) {
    errands_.gone(line_->end(), viewer);
    say(Level::warning, "the page that sent a robot does not answer: what it sent is stopped");
  }
  if (!owner_draws_) draw();
  for (const std::string& words : line_->end().take_failed()) say(Level::warning, words);
  if (scans_ && line_->end().idle()) {
    scans_ = false;
    for (const auto& peer : line_->end().peers())
      if (!line_->robot(peer.index).linked) line_->end().connect(peer.index);
  }
  if (now >= next_state_) {
    next_state_ = now + state_interval;
    keeper_.look(line_->end());
    publish(now);
  }
  if (now >= next_map_) {
    publish_map(now);
    next_map_ = now + map_interval(map_.size());
  }
}

void FleetWatch::obey(const Order& order) {
  if (order.kind == Order::Kind::gone) return errands_.gone(line_->end(), order.viewer);
  const auto parsed = fleet_order_of(order.payload);
  if (!parsed) return viewers_->tell(order.viewer, foxglove::status(Level::error, parsed.error));
  if (parsed->kind == FleetOrder::Kind::look) {
    if (scans_) return;
    line_->end().scan(options_.line.scan.value_or(3s));
    scans_ = true;
    return;
  }
  errands_.take(line_->end(), order.viewer, *parsed, owner_draws_, fleet::line_time());
}

void FleetWatch::draw() {
  std::vector<RobotNow> robots;
  for (const auto& peer : line_->end().peers()) {
    RobotNow each = robot(peer.index);
    if (each.update && each.origin_known) robots.push_back(std::move(each));
  }
  for (const RobotNow& each : robots) {
    if (std::exchange(drawn_[each.index], each.updated) == each.updated) continue;
    std::vector<cognitive::Body> others;
    for (const RobotNow& other : robots)
      if (other.index != each.index) others.push_back({other.pose(), other.shape()});
    drawing_.take(each.index, {each.pose(), each.shape()}, *each.update, others);
  }
}

void FleetWatch::publish(base::Time now) {
  Json robots = Json::array();
  Json unplaced = Json::array();
  if (line_ != nullptr)
    for (const auto& peer : line_->end().peers()) {
      const RobotNow each = robot(peer.index);
      if (!each.origin_known) unplaced.push_back(each.name);
      robots.push_back(fleet_robot(each, now, errands_.target(peer.index)));
    }
  Json state = fleet_state(source_, std::move(robots), std::move(unplaced));
  state["own"] = line_ != nullptr && line_->own() != nullptr;
  state["gone"] = gone_;
  state["scans"] = scans_;
  if (owner_draws_) state["map_by"] = source_;
  viewers_->publish_state(channels_.fleet, now_ns(), state.line());
  if (woken_) woken_();
}

std::string FleetWatch::map_of_owner() {
  transport::Failure none;
  auto* const joined = line_->joined();
  if (joined == nullptr) return {};
  const auto text = joined->map("grid", none);
  owner_draws_ = text.has_value();
  return text.value_or(std::string{});
}

void FleetWatch::publish_map(base::Time) {
  if (!viewers_->wanted(channels_.map)) return;
  std::string grid = map_of_owner();
  if (!owner_draws_ && drawing_.counters().drawn != 0) grid = fleet::to_grid(drawing_.map());
  if (!grid.starts_with('{') || grid == map_) return;
  map_ = std::move(grid);
  const std::uint64_t time = now_ns();
  viewers_->publish_state(channels_.map, time, map_message(map_, time));
  if (woken_) woken_();
}

}  // namespace ocm::cli::serve
