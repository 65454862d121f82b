#include "cli/shared/operator_link.hpp"

#include <unistd.h>
#include <vector>

#include <fmt/format.h>

#include "ocm/host/user_directory.hpp"

#include "cli/shared/buses.hpp"

namespace ocm::cli {

namespace {

/// Where programs of this user meet that have another environment, as those of cron, sudo and the system's
/// services do: /run/user/UID, which systemd gives to a login, and what host/user_directory.hpp takes
/// without.
std::vector<std::string> other_directories() {
  const std::string user = std::to_string(::geteuid());
  std::vector<std::string> others{"/run/user/" + user + "/ocm", "/tmp/ocm-" + user};
  std::erase(others, host::user_directory());
  return others;
}

/// The name of its socket.
std::string key_of(const BusName& name) {
  switch (name.kind) {
    case BusName::Kind::interface:
      return name.address;
    case BusName::Kind::simulated:
      return name.address.empty() ? "sim" : "sim-" + digits_of_path(name.address);
    case BusName::Kind::serial:
      return "slcan-" + digits_of_path(name.address.substr(0, name.address.find('@')));
  }
  return {};
}

transport::Outcome<std::unique_ptr<OperatorLink>> connect_on(const std::string& path, std::string_view bus,
                                                             std::string_view verb) {
  auto link = LocalLink::connect(path, fmt::format("the operator on {}", bus), verb);
  if (link && *link) (*link)->set_who(fmt::format("operator {}{}", (*link)->greeting(), (*link)->process()));
  return link;
}

}  // namespace

std::string operator_path(std::string_view bus) {
  return local_socket("operator", key_of(parse_bus_name(bus)));
}

transport::Outcome<std::unique_ptr<OperatorLink>> connect_operator(std::string_view bus,
                                                                   std::string_view verb) {
  auto link = connect_on(operator_path(bus), bus, verb);
  return link && *link == nullptr ? connect_operator_elsewhere(bus, verb) : std::move(link);
}

transport::Outcome<std::unique_ptr<OperatorLink>> connect_operator_elsewhere(std::string_view bus,
                                                                             std::string_view verb) {
  const BusName name = parse_bus_name(bus);
  // The simulator without a path is another one in each environment; all other buses are the same.
  if (name.kind == BusName::Kind::simulated && name.address.empty()) return std::unique_ptr<OperatorLink>{};
  for (const auto& directory : other_directories()) {
    auto link = connect_on(local_socket_in(directory, "operator", key_of(name)), bus, verb);
    if (!link || *link != nullptr) return link;
  }
  return std::unique_ptr<OperatorLink>{};
}

}  // namespace ocm::cli
