#include "cli/stats/figures.hpp"

namespace ocm::cli::stats {

Collector::Part& Collector::find(std::string_view name) {
  if (last_ != nullptr && last_->name == name) return *last_;
  for (Part& part : parts_)
    if (part.name == name) return *(last_ = &part);
  return *(last_ =
               &parts_.emplace_back(Part{std::string{name}, measure::BusStatistics{*catalogue_, rates_}, 0}));
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

std::vector<Bus> Collector::buses(std::optional<base::Time> now) const {
  std::vector<Bus> buses;
  for (const Part& part : parts_) buses.push_back({part.name, part.statistics.figures(now), part.drops});
  return buses;
}

}  // namespace ocm::cli::stats
