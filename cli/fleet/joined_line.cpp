#include "cli/fleet/joined_line.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "cli/shared/clock.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::fleet {
namespace {

using namespace std::chrono_literals;

/// An owner that has the processor answers within some milliseconds; each 50 ms it looks.
constexpr base::Duration patience = 3s;
constexpr base::Duration between_looks = 50ms;

bool starts(std::string_view& line, std::string_view word) {
  if (!line.starts_with(word)) return false;
  line.remove_prefix(word.size());
  return true;
}
template <class Number>
std::optional<Number> number(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

JoinedLine::JoinedLine(std::string_view verb, std::unique_ptr<LocalLink> owner)
    : verb_(verb), owner_(std::move(owner)) {
  refresh();
}

LocalAnswer JoinedLine::ask(std::string_view request, std::optional<unsigned> ordered) {
  auto answer = owner_->ask(request, patience);
  if (answer.kind != LocalAnswer::Kind::silent) return answer;
  std::vector<std::string> driving;
  std::vector<std::string> stops;
  for (const auto& [index, robot] : robots_)
    if ((robot.busy() && is_ours(index)) || index == ordered) {
      driving.push_back(robot.name);
      stops.push_back(fmt::format("amiroctl goto {} 0 0", robot.name));
    }
  const bool several = driving.size() > 1;
  fail({fmt::format("{}: {}", verb_, answer.failure.what),
        driving.empty()
            ? answer.failure.remedy
            : fmt::format("{} may still drive: at the latest {} after {} cm; to stop {}: {}",
                          fmt::join(driving, ", "), several ? "each stops" : "it stops",
                          mapper::server::longest_leg_cm, several ? "them" : "it", fmt::join(stops, "; "))});
}

void JoinedLine::tell(std::string_view request) {
  const auto answer = ask(request);
  if (answer.kind == LocalAnswer::Kind::no)
    fail({fmt::format("{}: {}: {}", verb_, owner_->who(), answer.failure.what), answer.failure.remedy});
}

LineEnd::Refused JoinedLine::order(unsigned robot, std::string_view request) {
  auto answer = ask(request, robot);
  if (answer.kind == LocalAnswer::Kind::no) return std::move(answer.failure);
  if (const auto order = number<std::uint64_t>(answer.text)) orders_[robot] = *order;
  refresh(robot);  // or what is known is of before
  return std::nullopt;
}

void JoinedLine::refresh(std::optional<unsigned> ordered) {
  std::vector<mapper::server::Peer> peers;
  std::map<unsigned, RobotNow> robots;
  const auto strange = [this](std::string_view line) {
    fail({fmt::format("{}: {} says '{}', which this program does not know", verb_, owner_->who(),
                      line.substr(0, 60)),
          "are they of the same version? `amiroctl --version`"});
  };
  unsigned from = 0;
  for (bool more = true; more;) {
    const auto answer = ask(fmt::format("robots {}", from), ordered);
    if (answer.kind != LocalAnswer::Kind::ok) strange(answer.failure.what);
    more = false;
    for (std::string_view text = answer.text; !text.empty();) {
      std::string_view line = text.substr(0, text.find('\n'));
      text.remove_prefix(std::min(text.size(), line.size() + 1));
      if (line == "idle" || line == "waits") {
        idle_ = line == "idle";
      } else if (starts(line, "failed ")) {
        failed_.emplace_back(line);
      } else if (starts(line, "more ")) {
        const auto next = number<unsigned>(line);
        if (!next || *next <= from) strange("more");
        from = *next;
        more = true;
      } else {
        const auto row = parse_row(line);
        if (!row) strange(line);
        peers.push_back({row->index, row->address, row->name, row->linked});
        robots[row->index] = *row;
      }
    }
  }
  peers_ = std::move(peers);
  robots_ = std::move(robots);
}

void JoinedLine::exchange() {
  sleep_for(between_looks);
  refresh();
}

void JoinedLine::scan(base::Duration time) {
  tell(fmt::format("scan {}", time / 1ms));
  idle_ = false;
}
void JoinedLine::connect(unsigned robot) {
  tell(fmt::format("connect {}", robot));
  idle_ = false;
}

LineEnd::Refused JoinedLine::go(unsigned robot, const mapper::link::SetPoint& to) {
  return order(robot, to == mapper::link::SetPoint{}
                          ? fmt::format("stop {}", robot)
                          : fmt::format("go {} {} {}", robot, to.angle, to.distance));
}
LineEnd::Refused JoinedLine::calibrate(unsigned robot, bool only_ask) {
  if (!only_ask) return order(robot, fmt::format("calibrate {}", robot));
  auto answer = ask(fmt::format("compass {}", robot));
  if (answer.kind == LocalAnswer::Kind::no) return std::move(answer.failure);
  refresh();
  return std::nullopt;
}
void JoinedLine::pause(unsigned robot) {
  tell(fmt::format("pause {}", robot));
}
void JoinedLine::unpause(unsigned robot) {
  tell(fmt::format("unpause {}", robot));
}
void JoinedLine::ping(unsigned robot) {
  tell(fmt::format("ping {}", robot));
}
void JoinedLine::ask_who(unsigned robot) {
  tell(fmt::format("who {}", robot));
}
void JoinedLine::leave(unsigned robot) {
  tell(fmt::format("leave {}", robot));
}

RobotNow JoinedLine::robot(unsigned index) const {
  const auto at = robots_.find(index);
  if (at != robots_.end()) return at->second;
  RobotNow gone;  // it is not on the list any more
  gone.index = index;
  gone.name = fmt::format("robot {}", index);
  gone.lost = true;
  return gone;
}

bool JoinedLine::is_ours(unsigned robot) const {
  const auto order = orders_.find(robot);
  const auto now = robots_.find(robot);
  return order != orders_.end() && now != robots_.end() && now->second.order == order->second;
}

std::optional<std::string> JoinedLine::map(std::string_view form, transport::Failure& failure) {
  std::string text;
  for (std::string request = fmt::format("map {}", form);;) {
    auto answer = owner_->ask(request, patience);
    if (answer.kind != LocalAnswer::Kind::ok) {
      failure = std::move(answer.failure);
      return std::nullopt;
    }
    const std::size_t line = answer.text.find('\n');
    const auto size = number<std::size_t>(std::string_view{answer.text}.substr(0, line));
    if (!size || line == std::string::npos) {
      failure = {fmt::format("{} sends no map that could be read", owner_->who()), "is it of this version?"};
      return std::nullopt;
    }
    const std::size_t before = text.size();
    text.append(answer.text, line + 1);
    if (text.size() >= *size || text.size() == before) return text;
    request = fmt::format("more {}", text.size());
  }
}

}  // namespace ocm::cli::fleet
