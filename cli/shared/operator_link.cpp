#include "cli/shared/operator_link.hpp"

#include <fmt/format.h>

#include "cli/shared/buses.hpp"

namespace ocm::cli {

std::string operator_path(std::string_view bus) {
  const BusName name = parse_bus_name(bus);
  std::string key;
  switch (name.kind) {
    case BusName::Kind::interface:
      key = name.address;
      break;
    case BusName::Kind::simulated:
      key = name.address.empty() ? "sim" : "sim-" + digits_of_path(name.address);
      break;
    case BusName::Kind::serial:
      key = "slcan-" + digits_of_path(name.address.substr(0, name.address.find('@')));
      break;
  }
  return local_socket("operator", key);
}

transport::Outcome<std::unique_ptr<OperatorLink>> connect_operator(std::string_view bus,
                                                                   std::string_view verb) {
  auto link = LocalLink::connect(operator_path(bus), fmt::format("the operator on {}", bus), verb);
  if (link && *link) (*link)->set_who(fmt::format("operator {}{}", (*link)->greeting(), (*link)->process()));
  return link;
}

}  // namespace ocm::cli
