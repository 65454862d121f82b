/// The robots behind a central: who is there, where, in which state, and how good its link is.
#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "cli/fleet/central_line.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/json.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verbs.hpp"

namespace ocm::cli {
namespace {

using cognitive::Robot;
using mapper::server::Peer;

struct RobotsOptions {
  fleet::LineOptions line;
  base::Duration listen = std::chrono::milliseconds{1500};
  bool json = false;
  bool list = false;
};

std::string_view state_of(const Robot& robot) {
  if (!robot.linked) return "no link";
  if (robot.lost) return "silent";
  if (robot.paused || (robot.idle && !robot.update))
    return "paused";  // by any program: it only reports that it is idle
  if (!robot.confirmed) return "connected";
  return robot.idle ? "idle" : "moving";
}

std::string pose_of(const Robot& robot) {
  if (!robot.update) return "-";
  return fmt::format("{} {} {}", robot.update->x, robot.update->y, robot.update->heading);
}

Json to_json(const fleet::CentralLine& line, const Peer& peer) {
  const Robot& robot = line.fleet().robot(peer.index);
  Json out{
      {"robot", peer.name}, {"index", peer.index}, {"address", peer.address}, {"state", state_of(robot)}};
  out["linked"] = robot.linked;
  out["confirmed"] = robot.confirmed;
  out["idle"] = robot.idle;
  out["quality"] = robot.linked ? Json(line.fleet().quality_per_mille(peer.index) / 1000.0) : Json();
  out["pose"] = Json();
  if (robot.update)
    out["pose"] = {
        {"x_cm", robot.update->x}, {"y_cm", robot.update->y}, {"heading_deg", robot.update->heading}};
  out["body"] = Json();
  if (robot.handshake)
    out["body"] = {{"width_cm", robot.handshake->width},
                   {"length_cm", robot.handshake->length},
                   {"axle_offset_cm", robot.handshake->axle_offset},
                   {"tower_offset_cm", robot.handshake->tower_offset},
                   {"sensor_out_cm", robot.handshake->sensor_out},
                   {"deadline_ms", robot.handshake->deadline},
                   {"packed", mapper::link::offers_packed(*robot.handshake)}};
  return out;
}

void print_table(const fleet::CentralLine& line, const std::vector<Peer>& peers) {
  std::size_t width = 5;
  for (const Peer& peer : peers) width = std::max(width, peer.name.size());
  fmt::print("{:<{}}  {:<5}  {:<12}  {:<9}  {:>16}  {:>7}\n", "ROBOT", width, "INDEX", "ADDRESS", "STATE",
             "X Y DEG [cm]", "QUALITY");
  for (const Peer& peer : peers) {
    const Robot& robot = line.fleet().robot(peer.index);
    fmt::print("{:<{}}  {:<5}  {:<12}  {:<9}  {:>16}  {:>7}\n", peer.name, width, peer.index, peer.address,
               state_of(robot), pose_of(robot),
               robot.linked ? fmt::format("{} %", line.fleet().quality_per_mille(peer.index) / 10) : "-");
  }
}

void run(const RobotsOptions& options, int& exit_code) {
  fleet::CentralLine line{"robots", options.line};
  if (options.list)
    (void)line.scan();
  else
    line.introduce(line.connect({}));
  if (!options.list) (void)line.wait(options.listen, [] { return false; });
  const std::vector<Peer> peers = line.server().client().peers();
  if (options.json)
    for (const Peer& peer : peers) fmt::print("{}\n", to_json(line, peer).line());
  else
    print_table(line, peers);
  if (peers.empty()) exit_code = exit_failure;
}

}  // namespace

void add_robots(Verb app, Session&, int& exit_code) {
  auto verb = app.add_verb("robots", "mappers behind a central: where they are, and how their links are",
                           mapper_group,
                           "  amiroctl robots\n"
                           "  amiroctl robots --json | jq -r .robot\n"
                           "  amiroctl robots --list                     without a link to any of them\n"
                           "  amiroctl robots --central /dev/ttyACM0");
  const auto options = std::make_shared<RobotsOptions>();
  verb.add_flag("--json", options->json, "an object a robot");
  verb.add_flag("--list", options->list, "those that advertise; connect to none");
  add_duration(verb, "--listen,--watch", options->listen, "how long to listen once all are connected")
      .formerly("--watch");
  fleet::add_line_options(verb, options->line);
  verb.callback([options, &exit_code] { run(*options, exit_code); });
}

}  // namespace ocm::cli
