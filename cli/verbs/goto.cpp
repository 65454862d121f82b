/// Turn, then drive straight on; whether the robot heard it, and where it came to.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "cli/fleet/central_line.hpp"
#include "cli/fleet/line_time.hpp"
#include "cli/fleet/link_watch.hpp"
#include "cli/fleet/pause_seen.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli {
namespace {

using namespace std::chrono_literals;
using fleet::RobotNow;
using mapper::server::Progress;

struct GotoOptions {
  fleet::LineOptions line;
  std::string robot;
  std::string angle;
  std::string distance;
  base::Duration timeout = 60s;
  bool no_wait = false;
  bool call_back = false;
};

/// A whole number with or without its unit: 90, 90deg.
std::int16_t number(std::string_view what, std::string text, std::string_view unit,
                    const mapper::link::Field<mapper::link::SetPoint>& field) {
  const std::string original = text;
  if (text.ends_with(unit)) text.resize(text.size() - unit.size());
  char* end = nullptr;
  errno = 0;
  const long value = std::strtol(text.c_str(), &end, 10);
  const bool whole = !text.empty() && text.find_first_of(" \t") == std::string::npos && *end == '\0';
  if (!whole || errno != 0 || value < field.min || value > field.max)
    fail({fmt::format("goto: invalid {} '{}'", what, original),
          fmt::format("expected a whole number of {}, {} to {}, such as 90", unit, field.min, field.max)},
         exit_usage);
  return static_cast<std::int16_t>(value);
}

std::string place(const mapper::link::Update& at) {
  return fmt::format("x {} cm, y {} cm, heading {} deg", at.x, at.y, at.heading);
}

/// In which the robot is said nothing, so that it may have been stopped for that: it obeys a program that
/// runs.
constexpr base::Duration longest_stop = 1s;

/// Says where it came to, and why that is elsewhere. `stood_still`: for so long this program did not run.
int report(const std::string& name, const RobotNow& robot, base::Duration stood_still) {
  if (robot.update) fmt::print("{}: {}\n", name, place(*robot.update));
  if (robot.progress != Progress::ended) return exit_success;
  const std::string why =
      stood_still >= longest_stop
          ? fmt::format(": this program did not run for {} meanwhile; give the command again",
                        words::to_text(std::chrono::duration_cast<std::chrono::milliseconds>(stood_still)))
      : robot.blocked ? ": is something in front of it?"
                      : "";
  remark(fmt::format("goto: {} heard it, but stopped {:.0f} cm and {:.0f} deg away from there{}", name,
                     robot.off_cm, robot.off_deg, why));
  return exit_failure;
}

/// It was stopped, as far as could be, and did not come to an end by itself.
[[noreturn]] void give_up(const GotoOptions& options, const std::string& name, const RobotNow& robot,
                          Progress progress, unsigned times_said, bool halted) {
  const std::string_view end = halted ? "it was stopped" : "it may still drive";
  if (robot.lost)
    fail({fmt::format("goto: {} is lost: {}", name,
                      robot.linked ? fmt::format("it has said nothing for its deadline; {}", end)
                                   : "its link is gone"),
          "a robot without a link stops; it can be connected again once it is near enough"});
  if (progress == Progress::none)
    fail({fmt::format("goto: the link to {} was gone for a while; a robot without a link stops", name),
          "say it again"});
  if (progress == Progress::heard)
    fail({fmt::format("goto: {} has not arrived after {}; {}", name, words::to_text(options.timeout), end),
          "give it more time: --timeout 120s"});
  if (progress == Progress::stopping)
    fail({fmt::format("goto: nothing shows within {} that {} has heard the stop",
                      words::to_text(options.timeout), name),
          "bring the central nearer, or switch the robot off"});
  if (!robot.update)
    fail({fmt::format("goto: {} does not say where it is, so it was not sent anywhere", name),
          "switch it off and on: its program may hang"});
  fail({fmt::format("goto: {} has not heard it after {} (said {}; {} % of its sentences come whole); {}",
                    name, words::to_text(options.timeout), counted(times_said, "time"),
                    robot.quality_per_mille / 10, end),
        "bring the central nearer, or give it more time: --timeout 120s"});
}

/// Its link has become bad, and it has been stopped for that: until it is back.
[[noreturn]] void come_back(const GotoOptions& options, fleet::CentralLine& line, fleet::LinkWatch& watch,
                            unsigned index, bool paused) {
  const std::string words = fleet::words_of_link(line.robot(index));
  const std::string name = line.name(index);
  remark(fmt::format("goto: {}; it is called back", words));
  (void)line.run(options.timeout, [&] {
    (void)watch.step(line.end(), line.robot(index), true);
    return watch.over() || !watch.called();
  });
  const bool halted = line.halt({index});
  if (paused)
    for (int times = 0; times < 3; ++times) line.end().pause(index);
  const RobotNow robot = line.robot(index);
  if (robot.update) fmt::print("{}: {}\n", name, place(*robot.update));
  if (interrupted() != 0) throw Exit{exit_code_after_interrupt(exit_failure)};
  fail({fmt::format("goto: {}: it was called back{}", words,
                    !halted                                            ? ", and may still drive"
                    : watch.phase() == fleet::LinkWatch::Phase::failed ? ", and has not come"
                                                                       : ""),
        "bring the central nearer; or drop --call-back: then only a message says so"});
}

void run(const GotoOptions& options, int& exit_code) {
  const mapper::link::SetPoint wanted{
      number("ANGLE", options.angle, "deg", mapper::link::SetPoint::fields[0]),
      number("DISTANCE", options.distance, "cm", mapper::link::SetPoint::fields[1])};
  constexpr int longest = mapper::server::longest_leg_cm;
  if (options.no_wait && std::abs(wanted.distance) > longest)
    fail({fmt::format("goto: --no-wait with {} cm: nothing would stop the robot", wanted.distance),
          fmt::format("drop --no-wait, or drive at most {} cm", longest)},
         exit_usage);
  if (options.no_wait && options.call_back)
    fail({"goto: --no-wait with --call-back: no program would watch the link", "drop one of them"},
         exit_usage);
  fleet::CentralLine line{"goto", options.line};
  const unsigned index = line.connect_one(options.robot);
  const std::string name = line.name(index);
  const bool is_stop = wanted == mapper::link::SetPoint{};
  // A stop is said at once; it ends no pause.
  const bool paused = !is_stop && fleet::seems_paused(line, index);
  fleet::LinkWatch watch;
  if (watch.step(line.end(), line.robot(index), false)) {
    if (options.call_back && !is_stop)
      fail({fmt::format("goto: {}, so it was not sent", fleet::words_of_link(line.robot(index))),
            "bring the central nearer; or drop --call-back: then only a message says so"});
    fleet::warn_of_link("goto", line.robot(index));
  }
  if (const auto refused = line.end().go(index, wanted))
    fail({fmt::format("goto: {}", refused->what), refused->remedy});
  base::Time looked = fleet::line_time();
  base::Duration stood_still{};
  (void)line.run(options.timeout, [&] {
    const RobotNow robot = line.robot(index);
    const base::Time now = fleet::line_time();
    stood_still = std::max(stood_still, now - looked);
    looked = now;
    if (watch.step(line.end(), robot, options.call_back && !is_stop) && !watch.called())
      fleet::warn_of_link("goto", robot);
    if (watch.called() || (options.no_wait && robot.progress == Progress::heard)) return true;
    return is_final(robot.progress) || robot.lost || !line.end().is_ours(index);
  });
  if (watch.called()) come_back(options, line, watch, index, paused);
  const RobotNow last = line.robot(index);
  if (!line.end().is_ours(index))
    fail({fmt::format("goto: another program has stopped {} or sent it: {}", name, last.by),
          "`amiroctl robots` shows what it does now"},
         exit_code_after_interrupt(exit_failure));
  const Progress progress = last.progress;
  const unsigned times_said = last.times_said;
  const bool left_to_drive = options.no_wait && progress == Progress::heard && interrupted() == 0;
  const bool arrived = progress != Progress::none && is_final(progress);
  if (left_to_drive) line.end().leave(index);
  const bool halted = arrived || left_to_drive || line.halt({index});
  if (paused && !arrived) fleet::pause_unseen(line, index);
  if (interrupted() != 0) throw Exit{exit_code_after_interrupt(exit_failure)};
  if (!arrived && !left_to_drive) give_up(options, name, line.robot(index), progress, times_said, halted);
  if (arrived) {
    // The update behind the idle has the place.
    (void)line.wait(2s, [&] {
      const RobotNow robot = line.robot(index);
      return robot.located || robot.lost;
    });
    exit_code = report(name, line.robot(index), stood_still);
  }
  if (paused && !fleet::pause_until_seen(line, index, true))
    remark(fmt::format("goto: {} was paused, and sends updates now", name));
}

}  // namespace

void declare_goto(Verb verb, Session&, int& exit_code) {
  verb.describe("turn a mapper, then drive it a given distance", mapper_group,
                "  amiroctl goto AVR 90 50          to the left, then 50 cm\n"
                "  amiroctl goto AVR -45 0          turn to the right\n"
                "  amiroctl goto AVR 0 0            stop\n"
                "  amiroctl goto AVR 0 50 --no-wait");
  const auto options = std::make_shared<GotoOptions>();
  verb.add_option("robot", options->robot, "its name, address or index").required().type_name("ROBOT");
  verb.add_option("angle", options->angle, "degrees to the left of where it looks now")
      .required()
      .type_name("ANGLE");
  verb.add_option("distance", options->distance, "cm, then").required().type_name("DISTANCE");
  verb.add_flag("--no-wait", options->no_wait, "wait until it has heard, not until it is there");
  verb.add_flag("--call-back", options->call_back,
                "if its link gets bad: stop it, and send it back towards where it began");
  add_lasting(verb, "--timeout", options->timeout, "then it is stopped");
  fleet::add_line_options(verb, options->line);
  verb.callback([options, &exit_code] { run(*options, exit_code); });
}

}  // namespace ocm::cli
