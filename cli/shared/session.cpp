#include "cli/shared/session.hpp"

#include <cstdio>
#include <cstdlib>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "ocm/topics/amiro.hpp"

#include "cli/shared/buses.hpp"
#include "cli/shared/config.hpp"
#include "cli/shared/memory.hpp"
#include "generator/robot_spec.hpp"
#include "generator/spec/spec.hpp"

namespace ocm::cli {

Session::Session() = default;
Session::~Session() = default;

void Session::add_options(Verb app) {
  app.add_option(
         "--bus", bus_name,
         "CAN interface (can0, vcan0, ...), slcan:/dev/ttyACM0@500k (a serial adapter) or sim; default: "
         "the only interface that is up or sim")
      .environment("AMIROCTL_BUS")
      .type_name("NAME");
  app.add_option("--spec", spec_file, "topics of another robot, as JSON; default: the AMiRo's, compiled in")
      .environment("AMIROCTL_SPEC")
      .type_name("FILE");
  app.add_option("--config", config_file,
                 "configuration file (TOML); default: ~/.config/amiroctl/config.toml")
      .environment("AMIROCTL_CONFIG")
      .type_name("FILE");
  app.after_parsing([this, app] { apply_config(app, config_file); });
  app.add_flag("--no-color,--no-colour", no_colour_, "never colour the output (also: NO_COLOR)");
}

const protocol::Catalogue& Session::catalogue() {
  return spec_file.empty() ? amiro::catalogue : spec().catalogue();
}

const spec::Spec& Session::spec() {
  if (spec_ == nullptr) {
    const EndsWithoutMemory ends;
    auto loaded = spec_file.empty() ? spec::parse(generate::robot_spec_text(), generate::robot_spec_name)
                                    : spec::load(spec_file);
    for (const auto& problem : loaded.problems)
      fmt::print(stderr, "amiroctl: {}: {}\n          {}\n", problem.place, problem.what, problem.remedy);
    if (loaded.spec == nullptr) throw Exit{exit_failure};
    spec_ = std::move(loaded.spec);
  }
  return *spec_;
}

std::unique_ptr<transport::Bus> Session::open_bus(std::string_view name) {
  auto bus = cli::open_bus(parse_bus_name(name));
  if (!bus) fail(bus.error);
  return std::move(*bus);
}

std::unique_ptr<transport::Bus> Session::open_bus() {
  const bool chosen = !bus_name.empty();
  if (!chosen) bus_name = only_bus();
  auto bus = open_bus(bus_name);
  remark(fmt::format("bus: {}{}", bus->name(), chosen ? "" : " (the only one there is; --bus chooses)"));
  return bus;
}

bool Session::colour() const {
  const char* never = std::getenv("NO_COLOR");
  return !no_colour_ && (never == nullptr || *never == '\0') && isatty(STDOUT_FILENO) != 0;
}

}  // namespace ocm::cli
