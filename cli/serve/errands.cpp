#include "cli/serve/errands.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "ocm/cognitive/explorer.hpp"

namespace ocm::cli::serve {
namespace {

using namespace std::chrono_literals;
using fleet::LineEnd;
using fleet::RobotNow;
using foxglove::Level;
using mapper::server::Progress;
using Kind = FleetOrder::Kind;

constexpr float near_m = 0.03F;           // a set point is in whole centimetres and degrees
constexpr float longest_m = 3.0F;         // of one set point
constexpr unsigned most_pieces = 50;      // of a way, none of which was blocked
constexpr base::Duration to_stop = 20s;   // any leg has ended by then
constexpr base::Duration to_say_it = 5s;  // where it stands, behind a stop

float way_m(const RobotNow& robot, motion::Point to) {
  return cognitive::distance_m(cognitive::place(robot.pose()), to);
}

}  // namespace

bool Errands::end(const Errand& errand, Level level, const std::string& words) const {
  tell_(errand.viewer, level, words);
  return true;
}

std::optional<unsigned> Errands::find(const LineEnd& line, ViewerId viewer, const std::string& name) const {
  std::optional<unsigned> found;
  unsigned count = 0;
  std::string names;
  for (const mapper::server::Peer& peer : line.peers()) {
    if (std::to_string(peer.index) == name) return peer.index;
    names += (names.empty() ? "" : ", ") + peer.name;
    if (peer.name != name && peer.address != name) continue;
    found = peer.index;
    ++count;
  }
  if (count == 1) return found;
  tell_(viewer, Level::error,
        count == 0
            ? fmt::format("the central has no robot '{}'; it has {}", name, names.empty() ? "none" : names)
            : fmt::format("{} robots are called '{}': name one by its index", count, name));
  return std::nullopt;
}

void Errands::take(LineEnd& line, ViewerId viewer, const FleetOrder& order, bool owner_explores,
                   base::Time now) {
  const auto index = find(line, viewer, order.robot);
  if (!index) return;
  const RobotNow robot = look_(*index);
  Errand errand{.viewer = viewer, .since = now};
  switch (order.kind) {
    case Kind::look:
      return;
    case Kind::stop:
      errands_.erase(*index);
      if (const auto refused = line.go(*index, {})) tell_(viewer, Level::error, refused->what);
      return;
    case Kind::pause:
    case Kind::go_on:
      errand.pauses = order.kind == Kind::pause;
      if (!robot.linked) return void(end(errand, Level::error, robot.name + " has no link"));
      errand.pausing.emplace(robot, errand.pauses, now);
      errands_.insert_or_assign(*index, errand);
      return;
    case Kind::call_back:
      errand.target = cognitive::place(robot.origin);
      return go(line, robot, errand, owner_explores);
    case Kind::go:
      errand.target = order.place;
      if (!robot.origin_known)
        return void(
            end(errand, Level::error,
                fmt::format("where {} was switched on is not known, so it is not on the map: start serve "
                            "with --start {}=X,Y,DEG",
                            robot.name, robot.name)));
      return go(line, robot, errand, owner_explores);
  }
}

void Errands::go(LineEnd& line, const RobotNow& robot, Errand errand, bool owner_explores) {
  if (!robot.linked || robot.lost)
    return void(end(errand, Level::error, fmt::format("{} has no link, or says nothing", robot.name)));
  if (!robot.update)
    return void(end(errand, Level::error,
                    fmt::format("{} does not say where it is, so it was not sent", robot.name)));
  const bool by_itself = owner_explores && !robot.held;
  if (robot.busy() && !line.is_ours(robot.index) && !by_itself)
    return void(
        end(errand, Level::error, fmt::format("{} is driven by {}; stop it first", robot.name, robot.by)));
  if (robot.located && !robot.busy()) {
    if (!send(line, errand, robot)) errands_.insert_or_assign(robot.index, errand);
    return;
  }
  if (const auto refused = line.go(robot.index, {})) return void(end(errand, Level::error, refused->what));
  errands_.insert_or_assign(robot.index, errand);
}

bool Errands::send(LineEnd& line, Errand& errand, const RobotNow& robot) {
  if (way_m(robot, *errand.target) < near_m)
    return end(errand, Level::info, fmt::format("{} is there", robot.name));
  if (++errand.pieces > most_pieces)
    return end(errand, Level::error, fmt::format("{} does not get there", robot.name));
  const auto refused = line.go(robot.index, cognitive::set_point_to(robot.pose(), *errand.target, longest_m));
  if (refused) return end(errand, Level::error, fmt::format("{}; {}", refused->what, refused->remedy));
  senders_[robot.index] = errand.viewer;
  errand.phase = Phase::sent;
  return false;
}

bool Errands::drive(LineEnd& line, Errand& errand, const RobotNow& robot, base::Time now) {
  if (robot.lost || !robot.linked)
    return end(errand, Level::error, fmt::format("{} is lost; a robot without a link stops", robot.name));
  if (!line.is_ours(robot.index))
    return end(errand, Level::warning, fmt::format("{} was stopped or sent by {}", robot.name, robot.by));
  if (errand.phase != Phase::sent) {
    if (robot.located && is_final(robot.progress)) return send(line, errand, robot);
    if (now - errand.since < (errand.phase == Phase::stopping ? to_stop : to_say_it)) return false;
    return end(errand, Level::error,
               fmt::format("nothing shows that {} stands, so it was not sent", robot.name));
  }
  switch (robot.progress) {
    case Progress::waiting:
    case Progress::said:
    case Progress::heard:
      return false;
    case Progress::reached:
      errand.phase = Phase::between;
      errand.since = now;
      return false;
    case Progress::ended:
      return end(errand, Level::warning,
                 fmt::format("{} stopped {:.0f} cm away from there{}", robot.name,
                             100 * way_m(robot, *errand.target),
                             robot.blocked ? ": is something in front of it?" : ""));
    case Progress::none:
      return end(
          errand, Level::error,
          fmt::format("the link to {} was gone for a while; a robot without a link stops", robot.name));
    case Progress::stopping:
    case Progress::stopped:
      return end(errand, Level::warning, fmt::format("{} was stopped", robot.name));
  }
  return true;
}

bool Errands::pause(LineEnd& line, Errand& errand, const RobotNow& robot, base::Time now) {
  switch (errand.pausing->step(line, now)) {
    case fleet::Pausing::Seen::not_yet:
      return false;
    case fleet::Pausing::Seen::obeys:
      return end(errand, Level::info,
                 fmt::format("{} {}", robot.name, errand.pauses ? "is paused" : "goes on"));
    case fleet::Pausing::Seen::lost:
      return end(errand, Level::error, fmt::format("{} is lost", robot.name));
    case fleet::Pausing::Seen::never:
      return end(
          errand, Level::error,
          fmt::format("nothing shows that {} {}", robot.name, errand.pauses ? "is paused" : "goes on"));
  }
  return true;
}

void Errands::step(LineEnd& line, base::Time now) {
  for (auto each = errands_.begin(); each != errands_.end();) {
    auto& [index, errand] = *each;
    const RobotNow robot = look_(index);
    const bool over = errand.pausing ? pause(line, errand, robot, now) : drive(line, errand, robot, now);
    each = over ? errands_.erase(each) : std::next(each);
  }
}

void Errands::gone(LineEnd& line, ViewerId viewer) {
  std::erase_if(errands_, [viewer](const auto& each) { return each.second.viewer == viewer; });
  std::erase_if(senders_, [&](const auto& each) {
    const auto& [index, sender] = each;
    if (sender != viewer) return false;
    if (line.is_ours(index) && look_(index).busy()) (void)line.go(index, {});  // a stop is always taken
    return true;
  });
}

std::vector<ViewerId> Errands::driving(const LineEnd& line) const {
  std::vector<ViewerId> viewers;
  const auto add = [&viewers](ViewerId viewer) {
    if (std::find(viewers.begin(), viewers.end(), viewer) == viewers.end()) viewers.push_back(viewer);
  };
  for (const auto& [index, errand] : errands_)
    if (errand.target) add(errand.viewer);
  for (const auto& [index, sender] : senders_)
    if (line.is_ours(index) && look_(index).busy()) add(sender);
  return viewers;
}

std::optional<motion::Point> Errands::target(unsigned robot) const {
  const auto at = errands_.find(robot);
  return at == errands_.end() ? std::nullopt : at->second.target;
}

}  // namespace ocm::cli::serve
