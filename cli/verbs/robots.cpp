/// The robots behind a central: who is there, where, in which state, and how good its link is.
#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "cli/fleet/central_line.hpp"
#include "cli/fleet/link_watch.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/json.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verb.hpp"

namespace ocm::cli {
namespace {

using fleet::RobotNow;
using mapper::server::Peer;

struct RobotsOptions {
  fleet::LineOptions line;
  base::Duration listen = std::chrono::milliseconds{1500};
  bool json = false;
  bool list = false;
};

std::string pose_of(const RobotNow& robot) {
  if (!robot.update) return "-";
  return fmt::format("{} {} {}", robot.update->x, robot.update->y, robot.update->heading);
}

void print_table(const fleet::CentralLine& line, const std::vector<Peer>& peers) {
  std::size_t width = 5;
  for (const Peer& peer : peers) width = std::max(width, peer.name.size());
  fmt::print("{:<{}}  {:<5}  {:<12}  {:<9}  {:>16}  {:>7}\n", "ROBOT", width, "INDEX", "ADDRESS", "STATE",
             "X Y [cm] DEG", "QUALITY");
  for (const Peer& peer : peers) {
    const RobotNow robot = line.robot(peer.index);
    fmt::print("{:<{}}  {:<5}  {:<12}  {:<9}  {:>16}  {:>7}\n", peer.name, width, peer.index, peer.address,
               fleet::state_of(robot), pose_of(robot),
               robot.linked ? fmt::format("{} %", robot.quality_per_mille / 10) : "-");
  }
}

void run(const RobotsOptions& options) {
  fleet::CentralLine line{"robots", options.line};
  if (options.list)
    (void)line.scan();
  else
    line.introduce(line.connect({}));
  if (!options.list) (void)line.wait(options.listen, [] { return false; });
  const std::vector<Peer> peers = line.end().peers();
  if (options.json)
    for (const Peer& peer : peers) fmt::print("{}\n", fleet::to_json(line.robot(peer.index)).line());
  else
    print_table(line, peers);
  for (const Peer& peer : peers) fleet::warn_of_link("robots", line.robot(peer.index));
  if (peers.empty())
    fail({"robots: the central finds no robot", "is one switched on, and near? --scan 10s looks for longer"});
}

}  // namespace

void declare_robots(Verb verb, Session&, int&) {
  verb.describe("mappers behind a central: where they are, and how their links are", mapper_group,
                "  amiroctl robots\n"
                "  amiroctl robots --json | jq -r .robot\n"
                "  amiroctl robots --list                     without a new link to any of them\n"
                "  amiroctl robots --central /dev/ttyACM0");
  const auto options = std::make_shared<RobotsOptions>();
  verb.add_flag("--json", options->json, "an object a robot");
  verb.add_flag("--list", options->list, "those that advertise; makes no new link");
  add_lasting(verb, "--listen,--watch", options->listen, "how long to listen once all are connected")
      .formerly("--watch");
  fleet::add_line_options(verb, options->line);
  verb.callback([options] { run(*options); });
}

}  // namespace ocm::cli
