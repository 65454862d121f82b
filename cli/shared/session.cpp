#include "cli/shared/session.hpp"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>

#include "ocm/can/text.hpp"
#include "ocm/topics/amiro.hpp"
#include "ocm/transport/interfaces.hpp"
#include "ocm/transport/slcan.hpp"
#include "ocm/transport/socketcan.hpp"
#include "ocm/transport/virtual_bus.hpp"

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
  transport::Outcome<std::unique_ptr<transport::Bus>> bus;
  const auto take = [&bus](auto opened) {
    if (opened)
      bus.value = std::move(opened.value);
    else
      bus.error = std::move(opened.error);
  };
  if (name == "sim")
    take(transport::VirtualBus::open());
  else if (name.starts_with("sim:"))
    take(transport::VirtualBus::open(std::string{name.substr(4)}));
  else if (name.starts_with("slcan:")) {
    auto opened = transport::Slcan::open(name.substr(6));
    if (opened && !(*opened)->answers())
      remark("the adapter answers no command: what it drops, nobody knows");
    take(std::move(opened));
  } else
    take(transport::SocketCan::open(name));
  if (!bus) fail(bus.error);
  return std::move(bus.value);
}

std::unique_ptr<transport::Bus> Session::open_bus() {
  const bool chosen = !bus_name.empty();
  if (!chosen) bus_name = only_bus();
  auto bus = open_bus(bus_name);
  remark(fmt::format("bus: {}{}", bus->name(), chosen ? "" : " (the only one there is; --bus chooses)"));
  return bus;
}

std::string Session::only_bus() {
  std::vector<std::string> found;
  for (const auto& interface : transport::can_interfaces())
    if (interface.up) found.push_back(interface.name);
  if (transport::VirtualBus::running()) found.emplace_back("sim");
  if (found.empty())
    fail({"no bus: no CAN interface is up and no simulator runs",
          "start a simulated robot with `amiroctl sim`, or bring an interface up: "
          "sudo ip link set can0 up type can bitrate 500000"});
  if (found.size() > 1) {
    std::string names = found[0];
    for (std::size_t i = 1; i < found.size(); ++i) names += ", " + found[i];
    fail({"several buses: " + names, "choose one with --bus NAME or AMIROCTL_BUS=NAME"}, exit_usage);
  }
  return found[0];
}

bool Session::colour() const {
  const char* never = std::getenv("NO_COLOR");
  return !no_colour_ && (never == nullptr || *never == '\0') && isatty(STDOUT_FILENO) != 0;
}

void StateWatch::look(const transport::Bus& bus) {
  if (bus.state() == state_) return;
  state_ = bus.state();
  if (state_ == transport::BusState::down)
    remark(fmt::format("{} went down; waiting for it to come back", bus.name()));
  if (state_ == transport::BusState::up) remark(fmt::format("{} is up again", bus.name()));
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
