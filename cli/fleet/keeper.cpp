#include "cli/fleet/keeper.hpp"

#include <array>
#include <chrono>
#include <map>

#include <fmt/format.h>

#include "ocm/client/diagnosis.hpp"

#include "cli/fleet/line_time.hpp"
#include "cli/fleet/link_watch.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::fleet {
namespace {

using namespace std::chrono_literals;

/// Links to all that there are; one that cannot be reached is reported.
void link_all(CentralLine& line) {
  const auto peers = line.scan();
  if (peers.empty()) remark("central: no robots yet: `amiroctl robots --scan 3s` looks again");
  for (const mapper::server::Peer& peer : peers) line.end().connect(peer.index);
  (void)line.wait(60s, [&line] { return line.end().idle(); });
  for (const std::string& words : line.end().take_failed()) remark(fmt::format("central: {}", words));
}

class Keeper {
 public:
  Keeper(CentralLine& line, bool call_back) : line_(line), call_back_(call_back) {}

  void look() {
    for (const mapper::server::Peer& peer : line_.end().peers()) {
      const RobotNow robot = line_.robot(peer.index);
      Kept& kept = kept_[peer.index];
      if (robot.linked && !kept.linked) remark(fmt::format("central: {} is linked", robot.name));
      if (robot.lost != kept.lost && (robot.lost || kept.linked))
        remark(fmt::format("central: {} is {}", robot.name, robot.lost ? "lost" : "back"));
      kept.linked = kept.linked || robot.linked;
      kept.lost = robot.lost;
      const bool before = kept.watch.called();
      if (kept.watch.step(line_.end(), robot, call_back_)) {
        if (kept.watch.called())
          remark(fmt::format("central: {}; it is called back", words_of_link(robot)));
        else
          warn_of_link("central", robot);
      }
      if (before && kept.watch.phase() == LinkWatch::Phase::well)
        remark(fmt::format("central: the link to {} is well again", robot.name));
    }
  }

 private:
  struct Kept {
    LinkWatch watch{};
    bool linked = false;
    bool lost = false;
  };
  CentralLine& line_;
  bool call_back_;
  std::map<unsigned, Kept> kept_;
};

}  // namespace

int keep_line(const LineOptions& options, bool call_back) {
  CentralLine line{"central", options, Need::own};
  link_all(line);
  remark(fmt::format("central: has {}; robots, goto and others join it; Ctrl-C ends it", line.end().path()));
  Keeper keeper{line, call_back};
  base::Time next{};
  (void)line.run(std::nullopt, [&] {
    const base::Time now = line_time();
    if (now < next) return false;
    next = now + 100ms;
    keeper.look();
    return false;
  });
  const Owner& owner = line.own()->owner();
  std::string text = fmt::format("central: {} joined", client::count(owner.joined(), "program*"));
  add_count(text, owner.turned_away(), "turned away");
  remark(text);
  return exit_code_after_interrupt(exit_success);
}

}  // namespace ocm::cli::fleet
