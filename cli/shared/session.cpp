#include "cli/shared/session.hpp"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "ocm/can/text.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/shared/buses.hpp"
#include "cli/shared/config.hpp"
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
                 "options that stand on no command line, as TOML; default: ~/.config/amiroctl/config.toml")
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

void send_patiently(transport::Bus& bus, const can::Frame& frame, base::Duration patience) {
  const auto give_up = std::chrono::steady_clock::now() + patience;
  for (;;) {
    const auto taken = bus.send(frame);
    if (taken.error == base::Error::closed) fail(bus.failure());
    if (!taken)
      fail({fmt::format("{} cannot be sent: {}", can::to_text(frame).view(), base::describe(taken.error)),
            "only data and remote frames with a valid identifier and up to 8 bytes can"});
    if (*taken) return;
    if (std::chrono::steady_clock::now() >= give_up && bus.state() == transport::BusState::down)
      fail({fmt::format("{} is down: {} was not sent", bus.name(), can::to_text(frame).view()),
            fmt::format("bring it up: sudo ip link set {} up", bus.name())});
    if (std::chrono::steady_clock::now() >= give_up)
      fail({fmt::format("the transmit queue of {} stays full: {} was not sent", bus.name(),
                        can::to_text(frame).view()),
            "nobody acknowledges frames: is a board powered and connected, and is the bit rate the same?"});
    // A full queue of a CAN interface cannot be waited for (ENOBUFS is not signalled by poll): try again.
    std::this_thread::sleep_for(std::chrono::milliseconds{1});
  }
}

}  // namespace ocm::cli
