#include "cli/fleet/line_replay.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ocm/mapper/server/sender.hpp"

namespace ocm::cli::fleet {
namespace {

using mapper::link::Kind;
using mapper::link::PrefixFilter;
using Word = mapper::server::CentralLine;  // of the central
using mapper::server::Peer;

/// How far it is from one place to another, and how much it has turned, in cm and degrees together.
double way(const mapper::link::Update& from, const mapper::link::Update& to) {
  return std::hypot(to.x - from.x, to.y - from.y) +
         std::abs(std::remainder(to.heading - from.heading, 360.0));
}
/// Whether the robot is rather where it was than at its beginning.
bool goes_on(const mapper::link::Update& update, const mapper::link::Update& before) {
  return way(before, update) <= way({}, update);
}

}  // namespace

LineReplay::LineReplay(ReadLineLog log, Known known) : log_(std::move(log)), known_(std::move(known)) {
  if (log_.said.empty()) return;
  first_ = log_.said.front().time;
  playing_.length = log_.said.back().time - first_;
  go_to(playing_.length);
  alone_ = state_.peers.size() <= 1;
  begin_again();
  go_to({});
}

void LineReplay::begin_again() {
  state_ = State();
  next_ = 0;
}

void LineReplay::play(base::Duration time) {
  go_to(playing_.after(time));
}

void LineReplay::go_to(base::Duration at) {
  at = std::clamp(at, base::Duration{0}, playing_.length);
  if (at < playing_.at) begin_again();
  playing_.at = at;
  playing_.ended = at >= playing_.length;
  while (next_ < log_.said.size() && log_.said[next_].time <= now()) take(log_.said[next_++]);
  expire(now());
}

void LineReplay::expire(base::Time time) {
  state_.fleet.expire(time);
  while (state_.fleet.take()) {  // it says nothing: the robots of a log do not hear
  }
}

void LineReplay::take(const Said& said) {
  expire(said.time);  // who is lost by then, however far one step of the replay goes
  for (const char c : said.text)
    state_.stream.feed(
        c, [&](char byte) { take_byte(byte, said.time); },
        [&](const Word& line) { take_line(line, said.time); });
  while (state_.fleet.take()) {
  }
}

Peer& LineReplay::peer(unsigned index, std::string_view name) {
  Peer& peer = state_.peers[index];
  if (peer.name == name) return peer;
  peer = {index, {}, std::string{name}};
  const auto start = std::find_if(known_.starts.begin(), known_.starts.end(),
                                  [&](const Start& each) { return each.name == name; });
  state_.placed[index] = start != known_.starts.end() || alone_;
  if (start != known_.starts.end()) state_.fleet.set_origin(index, start->pose);
  return peer;
}

void LineReplay::take_line(const Word& line, base::Time now) {
  const auto at = state_.peers.find(line.index);
  switch (line.kind) {
    case Word::Kind::listed:
      if (line.index < cognitive::Fleet::most_robots) peer(line.index, line.text).address = line.address;
      return;
    case Word::Kind::connected:
      if (at != state_.peers.end()) state_.fleet.linked(line.index, at->second.name, now);
      return;
    case Word::Kind::closed:
    case Word::Kind::lost:
      state_.fleet.unlinked(line.index);
      return;
    default:
      return;
  }
}

void LineReplay::take_byte(char c, base::Time now) {
  switch (state_.names.feed(c)) {
    case PrefixFilter::Step::prefix:
      if (c == '[') state_.prefix.clear();
      state_.prefix += c;
      break;
    case PrefixFilter::Step::source: {
      const unsigned index = state_.names.source();
      const std::string_view name = std::string_view{state_.prefix}.substr(state_.prefix.rfind(':') + 1);
      if (index >= cognitive::Fleet::most_robots) break;
      (void)peer(index, name);
      if (state_.fleet.robot(index).name != name) state_.fleet.linked(index, name, now);
      break;
    }
    default:
      break;
  }
  const std::size_t source = state_.names.source();
  const motion::Pose origin =
      source < cognitive::Fleet::most_robots ? state_.fleet.robot(source).origin : motion::Pose{};
  const auto update = source < cognitive::Fleet::most_robots ? state_.fleet.robot(source).update
                                                             : std::optional<mapper::link::Update>{};
  state_.fleet.feed({&c, 1}, now, [&](std::size_t robot, Kind kind) {
    const auto index = static_cast<unsigned>(robot);
    if (kind == Kind::idle) state_.stood[index] = {now, state_.fleet.robot(robot).update};
    if (kind == Kind::handshake) state_.stood[index] = {now, {}};
    if (kind == Kind::handshake && update) state_.before.try_emplace(index, Before{origin, *update});
    if (kind != Kind::update) return;
    if (const auto before = state_.before.find(index); before != state_.before.end()) {
      if (goes_on(*state_.fleet.robot(robot).update, before->second.update))
        state_.fleet.set_origin(robot, before->second.origin);
      state_.before.erase(before);
    }
    draw(index);
  });
}

RobotNow LineReplay::robot(const Peer& peer) const {
  RobotNow now = robot_now(state_.fleet, peer);
  const auto placed = state_.placed.find(peer.index);
  now.origin_known = placed != state_.placed.end() && placed->second;
  // The fleet knows that a robot drives because it sends it; in a log only the robot says so.
  if (moves(now)) now.idle = now.located = false;
  return now;
}

/// Its updates show it elsewhere than where it stood, or go on while it does not say that it stands.
bool LineReplay::moves(const RobotNow& robot) const {
  const auto stood = state_.stood.find(robot.index);
  if (stood == state_.stood.end() || !robot.update || robot.updated <= stood->second.at) return false;
  constexpr double more_than_rounding = 2;
  if (stood->second.where && way(*stood->second.where, *robot.update) > more_than_rounding) return true;
  const base::Duration one_idle_lost = 2 * mapper::server::SenderOptions{}.listen;
  return robot.updated - stood->second.at > one_idle_lost;
}

std::vector<RobotNow> LineReplay::robots() const {
  std::vector<RobotNow> robots;
  for (const auto& [index, peer] : state_.peers) robots.push_back(robot(peer));
  return robots;
}

void LineReplay::draw(unsigned index) {
  const auto known = state_.peers.find(index);
  if (known == state_.peers.end()) return;
  const RobotNow now = robot(known->second);
  if (!now.origin_known || !now.update) return;
  std::vector<cognitive::Body> others;
  for (const auto& [other, peer] : state_.peers) {
    if (other == index) continue;
    const RobotNow each = robot(peer);
    if (each.origin_known && each.update) others.push_back({each.pose(), each.shape()});
  }
  state_.drawing.take(index, {now.pose(), now.shape()}, *now.update, others);
}

}  // namespace ocm::cli::fleet
