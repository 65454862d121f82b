#include "cli/fleet/keeper.hpp"

#include <chrono>

#include <fmt/format.h>

#include "cli/fleet/line_time.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::fleet {

using namespace std::chrono_literals;

void link_all(CentralLine& line, const std::function<void(const std::string&)>& say) {
  const auto peers = line.scan();
  if (peers.empty()) say("no robots yet: `amiroctl robots --scan 3s` looks again");
  for (const mapper::server::Peer& peer : peers) line.end().connect(peer.index);
  (void)line.wait(static_cast<int>(peers.size()) * 60s, [&line] { return line.end().idle(); });
  for (const std::string& words : line.end().take_failed()) say(words);
}

void Keeper::look(LineEnd& line) {
  for (const mapper::server::Peer& peer : line.peers()) {
    const RobotNow robot = line.robot(peer.index);
    Kept& kept = kept_[peer.index];
    if (robot.linked && !kept.linked) say_(fmt::format("{} is linked", robot.name));
    if (robot.lost != kept.lost && (robot.lost || kept.linked))
      say_(fmt::format("{} is {}", robot.name, robot.lost ? "lost" : "back"));
    kept.linked = kept.linked || robot.linked;
    kept.lost = robot.lost;
    const bool before = kept.watch.called();
    if (kept.watch.step(line, robot, call_back_))
      say_(fmt::format("{}; {}", words_of_link(robot),
                       kept.watch.called() ? "it is called back" : "bring the central or the robot nearer"));
    if (before && kept.watch.phase() == LinkWatch::Phase::well)
      say_(fmt::format("the link to {} is well again", robot.name));
  }
}

int keep_line(const LineOptions& options, bool call_back) {
  const auto say = [](const std::string& words) { remark("central: " + words); };
  CentralLine line{"central", options, Need::own};
  link_all(line, say);
  say(fmt::format("has {}; robots, goto and others join it; Ctrl-C ends it", line.end().path()));
  Keeper keeper{call_back, say};
  base::Time next{};
  (void)line.run(std::nullopt, [&] {
    const base::Time now = line_time();
    if (now < next) return false;
    next = now + 100ms;
    keeper.look(line.end());
    return false;
  });
  const Owner& owner = line.own()->owner();
  std::string text = fmt::format("{} joined", counted(owner.joined(), "program"));
  add_count(text, owner.turned_away(), "turned away");
  say(text);
  return exit_code_after_interrupt(exit_success);
}

}  // namespace ocm::cli::fleet
