#include "cli/shared/buses.hpp"

#include <utility>
#include <vector>

#include "ocm/transport/interfaces.hpp"
#include "ocm/transport/slcan.hpp"
#include "ocm/transport/socketcan.hpp"
#include "ocm/transport/virtual_bus.hpp"

#include "cli/shared/messages.hpp"

namespace ocm::cli {
namespace {

using AnyBus = transport::Outcome<std::unique_ptr<transport::Bus>>;

template <class Opened>
AnyBus any(Opened opened) {
  if (!opened) return std::move(opened.error);
  return std::unique_ptr<transport::Bus>{std::move(opened.value)};
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
      return any(transport::VirtualBus::open(name.address));
    case BusName::Kind::serial: {
      auto opened = transport::Slcan::open(name.address);
      if (opened && !(*opened)->answers())
        remark("the adapter answers no command: dropped frames cannot be counted");
      return any(std::move(opened));
    }
    case BusName::Kind::interface:
      break;
  }
  return any(transport::SocketCan::open(name.address));
}

std::string only_bus() {
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

}  // namespace ocm::cli
