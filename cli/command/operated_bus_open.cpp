// The bus that a verb sends its commands to, through the operator that runs on it.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "cli/command/operated_bus.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/unhurried_messages.hpp"

namespace ocm::cli {

namespace {

std::unique_ptr<transport::Bus> with_operator(std::unique_ptr<transport::Bus> bus,
                                              const protocol::Catalogue& catalogue, std::string_view verb) {
  const auto& topics = catalogue.topics;
  const bool moves = std::any_of(topics.begin(), topics.end(), [](const protocol::Topic& topic) {
    return topic.kind == protocol::Kind::actuator;
  });
  auto link = connect_operator(bus->name(), verb);
  if (!link)
    fail({fmt::format("{}: {}", verb, link.error.what),
          (moves ? "`amiroctl stop` reaches the robot past it; " : "") + link.error.remedy});
  if (*link == nullptr) return bus;
  remark(fmt::format("{}: {} {}", verb, (*link)->who(),
                     moves ? "guards the robot: set points go through it"
                           : "watches the bus; messages do not go through it"));
  return std::make_unique<OperatedBus>(std::move(bus), std::move(*link), catalogue, std::string{verb});
}

}  // namespace

std::unique_ptr<transport::Bus> open_to_command(Session& session, std::string_view verb) {
  never_wait_for_messages();
  const protocol::Catalogue& catalogue = session.catalogue_on_bus(true);
  return with_operator(session.open_bus(), catalogue, verb);
}

std::unique_ptr<transport::Bus> open_to_command(Session& session, std::string_view verb,
                                                std::string_view bus) {
  never_wait_for_messages();
  return with_operator(Session::open_bus(bus), session.catalogue_on(std::string{bus}), verb);
}

}  // namespace ocm::cli
