/// Mappers hold their tower and their updates, and go on again.
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "cli/fleet/central_line.hpp"
#include "cli/fleet/link_watch.hpp"
#include "cli/fleet/pause_seen.hpp"
#include "cli/verbs/verb.hpp"

namespace ocm::cli {
namespace {

struct PauseOptions {
  fleet::LineOptions line;
  std::vector<std::string> robots;
};

void run(std::string_view verb, const PauseOptions& options, bool paused, int& exit_code) {
  fleet::CentralLine line{verb, options.line};
  for (const unsigned index : line.connect(options.robots)) {
    const std::string name = line.name(index);
    fleet::warn_of_link(verb, line.robot(index));
    if (fleet::pause_until_seen(line, index, paused)) {
      fmt::print("{}: {}\n", name, paused ? "paused" : "goes on");
      continue;
    }
    remark(line.robot(index).lost
               ? fmt::format("{}: {} is lost", verb, name)
               : fmt::format("{}: {} {}", verb, name, paused ? "sends updates still" : "sends no updates"));
    exit_code = exit_failure;
  }
  if (line.unreached() != 0) {  // connect() has said why
    remark(fmt::format("{}: {} not reached", verb, counted(line.unreached(), "robot")));
    exit_code = exit_failure;
  }
}

void declare(Verb verb, std::string_view description, std::string_view examples, bool paused,
             int& exit_code) {
  verb.describe(description, mapper_group, examples);
  const auto options = std::make_shared<PauseOptions>();
  verb.add_option("robot", options->robots, "names, addresses or indexes; all: each of them")
      .required()
      .type_name("ROBOT ...");
  fleet::add_line_options(verb, options->line);
  verb.callback(
      [options, paused, name = verb.name(), &exit_code] { run(name, *options, paused, exit_code); });
}

}  // namespace

void declare_pause(Verb verb, Session&, int& exit_code) {
  declare(verb, "hold a mapper's tower and its updates",
          "  amiroctl pause AVR\n"
          "  amiroctl pause all\n"
          "  amiroctl pause AVR && amiroctl goto AVR 0 50   it drives all the same",
          true, exit_code);
}

void declare_unpause(Verb verb, Session&, int& exit_code) {
  declare(verb, "let a mapper's tower and its updates go on",
          "  amiroctl unpause AVR\n"
          "  amiroctl unpause all",
          false, exit_code);
}

}  // namespace ocm::cli
