#include "cli/stats/figures.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace ocm::cli::stats {
namespace {

void forget_loads(measure::BusFigures& figures) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  figures.bit_rates = {};
  figures.load = figures.request_load = figures.stranger_load = figures.worst_load = unknown;
  for (auto& topic : figures.topics) topic.load = unknown;
}

}  // namespace

Collector::Part& Collector::find(std::string_view name) {
  if (last_ != nullptr && last_->name == name) return *last_;
  for (Part& part : parts_)
    if (part.name == name) return *(last_ = &part);
  measure::BitRates rates = rates_of_(name);
  const bool has_rate = rates.nominal != 0;
  rates.nominal = std::max(rates.nominal, 1U);
  measure::BusStatistics statistics{*catalogue_, rates, client::Transport::together, name};
  return *(last_ = &parts_.emplace_back(Part{std::string{name}, std::move(statistics), 0, has_rate}));
}

void Collector::take(std::span<const log::Entry> entries, const log::Interfaces& interfaces) {
  for (const log::Entry& entry : entries) {
    auto& statistics = find(interfaces.name(entry.interface)).statistics;
    if (const auto frame = entry.classic())
      statistics.take({entry.time, *frame});
    else
      statistics.take_fd(entry.frame(), entry.time);
  }
}

bool Collector::any() const noexcept {
  for (const Part& part : parts_)
    if (part.statistics.any()) return true;
  return false;
}

std::vector<const protocol::Topic*> Collector::never_came(const std::vector<Bus>& buses) const {
  base::Duration longest{};
  std::vector<bool> came(catalogue_->topics.size());
  for (const Bus& bus : buses) {
    longest = std::max(longest, bus.figures.span());
    for (const auto& topic : bus.figures.topics)
      came[static_cast<std::size_t>(topic.topic - catalogue_->topics.data())] = true;
  }
  std::vector<const protocol::Topic*> out;
  for (std::size_t i = 0; i < came.size(); ++i) {
    const protocol::Topic& topic = catalogue_->topics[i];
    if (!came[i] && topic.is_message() && topic.cycle.count() > 0 && topic.cycle <= longest)
      out.push_back(&topic);
  }
  return out;
}

std::vector<Bus> Collector::buses(std::optional<base::Time> now) const {
  std::vector<Bus> buses;
  for (const Part& part : parts_) {
    buses.push_back({part.name, part.statistics.figures(now), part.drops});
    if (!part.has_rate) forget_loads(buses.back().figures);
  }
  return buses;
}

}  // namespace ocm::cli::stats
