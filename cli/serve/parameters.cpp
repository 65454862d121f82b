#include "cli/serve/parameters.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "cli/serve/foxglove.hpp"

namespace ocm::cli::serve {
namespace {

constexpr std::string_view period_suffix = "/period_ms";

}  // namespace

std::string parameter_of(const protocol::Topic& sensor) {
  return fmt::format("/{}{}", sensor.name, period_suffix);
}

const protocol::Topic* sensor_of(const protocol::Catalogue& catalogue, std::string_view parameter) {
  if (!parameter.starts_with('/') || !parameter.ends_with(period_suffix)) return nullptr;
  parameter.remove_prefix(1);
  if (parameter.size() < period_suffix.size()) return nullptr;
  parameter.remove_suffix(period_suffix.size());
  const protocol::Topic* const topic = catalogue.find(parameter);
  return topic != nullptr && topic->kind == protocol::Kind::sensor ? topic : nullptr;
}

std::optional<double> Parameters::value(const protocol::Topic& sensor, Rows rows) const {
  for (const bus_model::Row& row : rows) {
    if (row.topic != &sensor) continue;
    if (!row.period) return 0;
    return std::round(static_cast<double>(row.period->count()) / 1e3) / 1e3;  // whole microseconds
  }
  return std::nullopt;
}

void Parameters::answer(const Order& order, Rows rows) {
  std::vector<foxglove::Parameter> parameters;
  if (order.names.empty())
    for (const protocol::Topic& topic : catalogue_->topics)
      if (topic.kind == protocol::Kind::sensor)
        parameters.push_back({parameter_of(topic), value(topic, rows)});
  for (const std::string& name : order.names)
    if (const protocol::Topic* const sensor = sensor_of(*catalogue_, name))
      parameters.push_back({name, value(*sensor, rows)});
  viewers_->tell(order.viewer, foxglove::parameter_values(parameters, order.payload));
}

void Parameters::take(const Order& order, Rows rows) {
  switch (order.kind) {
    case Order::Kind::get_parameters:
      return answer(order, rows);
    case Order::Kind::subscribe_parameters: {
      answer(order, rows);
      auto& names = subscribers_[order.viewer];
      for (const std::string& name : order.names)
        if (const protocol::Topic* const sensor = sensor_of(*catalogue_, name)) {
          names.insert(name);
          known_.try_emplace(name, value(*sensor, rows));
        }
      if (names.empty()) subscribers_.erase(order.viewer);
      return;
    }
    case Order::Kind::unsubscribe_parameters: {
      const auto at = subscribers_.find(order.viewer);
      if (at == subscribers_.end()) return;
      for (const std::string& name : order.names) at->second.erase(name);
      if (at->second.empty()) subscribers_.erase(at);
      return;
    }
    case Order::Kind::confirm_parameters:
      if (confirmations_.size() >= Orders::most) return answer(order, rows);
      confirmations_.push_back({order});
      return;
    case Order::Kind::gone:
      subscribers_.erase(order.viewer);
      std::erase_if(confirmations_,
                    [&](const Confirmation& each) { return each.order.viewer == order.viewer; });
      return;
    default:
      return;
  }
}

void Parameters::update(Rows rows) {
  std::erase_if(confirmations_, [&](Confirmation& each) {
    if (each.seen) answer(each.order, rows);
    return std::exchange(each.seen, true);
  });
  std::vector<foxglove::Parameter> changed;
  for (auto& [name, known] : known_) {
    const protocol::Topic* const sensor = sensor_of(*catalogue_, name);
    if (auto now = value(*sensor, rows); now != known) changed.push_back({name, known = now});
  }
  if (changed.empty()) return;
  for (const auto& [viewer, names] : subscribers_) {
    std::vector<foxglove::Parameter> wanted;
    for (const foxglove::Parameter& each : changed)
      if (names.contains(each.name)) wanted.push_back(each);
    if (!wanted.empty()) viewers_->tell(viewer, foxglove::parameter_values(wanted, {}));
  }
}

}  // namespace ocm::cli::serve
