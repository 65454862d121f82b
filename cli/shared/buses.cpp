#include "cli/shared/buses.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "ocm/transport/interfaces.hpp"
#include "ocm/transport/pty.hpp"
#include "ocm/transport/slcan.hpp"
#include "ocm/transport/socketcan.hpp"
#include "ocm/transport/virtual_bus.hpp"

#include "cli/shared/messages.hpp"
#include "cli/words/suggestion.hpp"

namespace ocm::cli {
namespace {

using AnyBus = transport::Outcome<std::unique_ptr<transport::Bus>>;

template <class Opened>
AnyBus any(Opened opened) {
  if (!opened) return std::move(opened.error);
  return std::unique_ptr<transport::Bus>{std::move(opened.value)};
}

/// Whether this user has mappers here, simulated or behind `amiroctl central`.
bool mappers_run() {
  if (transport::is_served(transport::central_line())) return true;
  std::error_code error;
  for (const auto& line : std::filesystem::directory_iterator{transport::robot_lines(), error})
    if (line.is_symlink(error) && transport::is_served(line.path().string())) return true;
  return false;
}

constexpr const char* instead_of_mappers =
    "mappers take `amiroctl robots`, `goto`, `pause` and `map`; an AMiRo with a bus is `amiroctl sim`, which "
    "may run "
    "beside them";

AnyBus open_simulated(const std::string& path) {
  auto opened = transport::VirtualBus::open(path);
  if (!opened && opened.error.cause == host::Cause::simulator_missing && !path.empty())
    return transport::Failure{opened.error.what,
                              fmt::format("start one with `amiroctl sim --bus sim:{}`", path)};
  if (!opened && opened.error.cause == host::Cause::simulator_missing && path.empty() && mappers_run())
    return transport::Failure{opened.error.what + "; mappers run, but have no CAN bus", instead_of_mappers};
  return any(std::move(opened));
}

AnyBus open_interface(const std::string& name) {
  auto opened = transport::SocketCan::open(name);
  if (opened) return any(std::move(opened));
  if (name.find(',') != std::string::npos)
    return transport::Failure{fmt::format("'{}' are several buses", name),
                              "only record takes several: name one"};
  if (name == "slcan")
    return transport::Failure{opened.error.what, "name the adapter's line: slcan:/dev/ttyACM0"};
  // "simm" and "scan:/dev/ttyACM0" are no interfaces, and one bus is always there under its name.
  const std::string kind = name.substr(0, name.find(':'));
  const bool has_address = kind.size() != name.size();
  const std::string_view near =
      words::nearest(kind, has_address ? std::vector<std::string_view>{"sim", "slcan"}
                                       : std::vector<std::string_view>{"sim"});
  if (!near.empty())
    return transport::Failure{opened.error.what,
                              fmt::format("did you mean '{}{}'?", near, name.substr(kind.size()))};
  return std::move(opened.error);
}

}  // namespace

BusName parse_bus_name(std::string_view name) {
  using Kind = BusName::Kind;
  if (name == "sim") return {Kind::simulated, ""};
  if (name.starts_with("sim:")) return {Kind::simulated, std::string{name.substr(4)}};
  if (name.starts_with("slcan:")) return {Kind::serial, std::string{name.substr(6)}};
  return {Kind::interface, std::string{name}};
}

AnyBus open_bus(const BusName& name) {
  switch (name.kind) {
    case BusName::Kind::simulated:
      return open_simulated(name.address);
    case BusName::Kind::serial: {
      auto opened = transport::Slcan::open(name.address);
      if (opened && !(*opened)->answers())
        remark("the adapter answers no command: dropped frames cannot be counted");
      return any(std::move(opened));
    }
    case BusName::Kind::interface:
      break;
  }
  return open_interface(name.address);
}

void expect_answer(std::string_view name) {
  const BusName parsed = parse_bus_name(name);
  if (parsed.kind != BusName::Kind::simulated) return;
  // What is connected cannot ask; a new client is greeted.
  if (const auto greeted = transport::VirtualBus::open(parsed.address); !greeted) fail(greeted.error);
}

std::string only_bus() {
  std::vector<std::string> found;
  for (const auto& interface : transport::can_interfaces())
    if (interface.up) found.push_back(interface.name);
  if (transport::VirtualBus::running()) found.emplace_back("sim");
  if (found.empty() && mappers_run())
    fail({"no bus: mappers run, but have no CAN bus, and no CAN interface is up", instead_of_mappers});
  if (found.empty())
    fail({"no bus: no CAN interface is up and no simulator runs",
          "start a simulated robot with `amiroctl sim`, the messages of a DBC file with `amiroctl sim --spec "
          "FILE`, or bring an interface up: "
          "sudo ip link set can0 up type can bitrate 500000"});
  if (found.size() > 1) {
    std::string names = found[0];
    for (std::size_t i = 1; i < found.size(); ++i) names += ", " + found[i];
    fail({"several buses: " + names, "choose one with --bus NAME or AMIROCTL_BUS=NAME"}, exit_usage);
  }
  return found[0];
}

}  // namespace ocm::cli
