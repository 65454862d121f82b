/// One straight piece: turn, then drive; and where the robot came to.
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "ocm/cognitive/explorer.hpp"

#include "cli/fleet/central_line.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verbs.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli {
namespace {

using namespace std::chrono_literals;
using cognitive::Robot;

struct GotoOptions {
  fleet::LineOptions line;
  std::string robot;
  std::string angle;
  std::string distance;
  base::Duration timeout = 60s;
  bool no_wait = false;
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
    fail({fmt::format("goto: {} {}: no {}", what, original, what),
          fmt::format("write a whole number of {}, {} to {}, such as 90", unit, field.min, field.max)},
         exit_usage);
  return static_cast<std::int16_t>(value);
}

std::string place(const mapper::link::Update& at) {
  return fmt::format("x {} cm, y {} cm, heading {} deg", at.x, at.y, at.heading);
}

/// Says where it came to; whether that is where it was sent.
bool arrived(const std::string& name, const Robot& robot, const std::optional<mapper::link::Update>& before,
             const mapper::link::SetPoint& wanted) {
  if (!robot.update || !before) {
    fmt::print("{}: idle; it does not say where\n", name);
    return true;
  }
  fmt::print("{}: {}\n", name, place(*robot.update));
  const auto target = cognitive::end_of(cognitive::pose_of(*before), wanted);
  const float off_cm =
      100 * cognitive::distance_m(target, cognitive::place(cognitive::pose_of(*robot.update)));
  const float off_deg = static_cast<float>(
      std::abs(std::remainder(robot.update->heading - before->heading - wanted.angle, 360.0)));
  constexpr float near_cm = 8, near_deg = 8;
  if (off_cm <= near_cm && (off_deg <= near_deg || wanted.angle == 0)) return true;
  remark(
      fmt::format("goto: {} stopped {:.0f} cm and {:.0f} deg away from there: is something in front of it?",
                  name, off_cm, off_deg));
  return false;
}

void run(const GotoOptions& options, int& exit_code) {
  const mapper::link::SetPoint wanted{
      number("ANGLE", options.angle, "deg", mapper::link::SetPoint::fields[0]),
      number("DISTANCE", options.distance, "cm", mapper::link::SetPoint::fields[1])};
  fleet::CentralLine line{"goto", options.line};
  const unsigned index = line.connect_one(options.robot);
  const std::string name = line.name(index);
  const auto& robot = line.fleet().robot(index);
  // A paused robot does not say where it is, but drives.
  (void)line.wait(2s, [&] { return robot.update.has_value() || robot.paused; });
  const auto before = robot.update;
  if (!line.server().fleet().go(index, wanted, fleet::CentralLine::now()))
    fail({"goto: the central's queue is full", "try again"});
  if (options.no_wait) return line.flush(2s);
  const bool done = line.run(options.timeout, [&] { return robot.idle || robot.lost; });
  if (interrupted() != 0) {
    (void)line.server().fleet().go(index, {0, 0}, fleet::CentralLine::now());
    throw Exit{exit_code_after_interrupt(exit_failure)};
  }
  if (robot.lost)
    fail({fmt::format("goto: {} is lost: {}", name,
                      robot.linked ? "it has said nothing for its deadline" : "its link is gone"),
          "a robot without a link stops; it can be connected again once it is near enough"});
  if (!done) {
    (void)line.server().fleet().go(index, {0, 0}, fleet::CentralLine::now());
    fail({fmt::format("goto: {} has not arrived after {}; it is told to stop", name,
                      words::to_text(options.timeout)),
          "give it more time: --timeout 120s"});
  }
  // The update behind the idle has the place.
  const base::Time then = robot.updated;
  (void)line.wait(500ms, [&] { return robot.updated != then || robot.paused; });
  if (!arrived(name, robot, before, wanted)) exit_code = exit_failure;
}

}  // namespace

void add_goto(Verb app, Session&, int& exit_code) {
  auto verb = app.add_verb("goto", "turn a mapper and drive it a piece", mapper_group,
                           "  amiroctl goto AVR 90 50          to the left, then 50 cm\n"
                           "  amiroctl goto AVR -45 0          turn to the right\n"
                           "  amiroctl goto AVR 0 0            stop\n"
                           "  amiroctl goto AVR 0 100 --no-wait");
  const auto options = std::make_shared<GotoOptions>();
  verb.add_option("robot", options->robot, "its name, address or index").required().type_name("ROBOT");
  verb.add_option("angle", options->angle, "degrees to the left of where it looks now")
      .required()
      .type_name("ANGLE");
  verb.add_option("distance", options->distance, "cm, then").required().type_name("DISTANCE");
  verb.add_flag("--no-wait", options->no_wait, "do not wait until it is there");
  add_duration(verb, "--timeout", options->timeout, "then it is told to stop");
  fleet::add_line_options(verb, options->line);
  verb.callback([options, &exit_code] { run(*options, exit_code); });
}

}  // namespace ocm::cli
