#include "cli/serve/bounds.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "ocm/client/command.hpp"
#include "ocm/measure/bus_load.hpp"
#include "ocm/protocol/identifier.hpp"

#include "cli/analyse/set.hpp"
#include "cli/shared/json.hpp"

namespace ocm::cli::serve {

Bounds::Bounds(const protocol::Catalogue& catalogue, std::uint32_t bit_rate)
    : catalogue_(&catalogue), bit_rate_(bit_rate) {}

void Bounds::assume(std::span<const bus_model::Row> rows) {
  if (bit_rate_ == 0) return;
  std::vector<Stream> now;
  for (const bus_model::Row& row : rows) {
    if (row.topic == nullptr || row.topic->is_message() || row.count == 0) continue;
    const bool drives = row.topic->role == protocol::Role::drive;
    // A light is set now and then; a sensor that was asked for once has no period.
    if (row.topic->kind == protocol::Kind::actuator ? !drives : !row.period) continue;
    now.push_back({row.topic,
                   row.topic->kind == protocol::Kind::sensor ? row.newest.priority : row.topic->priority,
                   drives ? client::hold_period.count() : row.period->count()});
  }
  if (now == streams_) return;
  streams_ = std::move(now);
  set_ = {};
  study_ = {};
  meters_.clear();
  rows_.clear();
  if (streams_.empty()) return;
  std::vector<analyse::Rate> rates;
  for (const protocol::Topic& topic : catalogue_->topics) {
    analyse::Rate rate;
    rate.name = topic.name;
    const auto stream = std::find_if(streams_.begin(), streams_.end(),
                                     [&](const Stream& each) { return each.topic == &topic; });
    rate.off = stream == streams_.end();
    if (!rate.off) {
      rate.period = base::Duration{stream->period};
      rate.has_priority = true;
      rate.priority = stream->priority;
    }
    if (!topic.is_message()) rates.push_back(std::move(rate));
  }
  set_ = analyse::robot_bus(*catalogue_, nullptr, rates);
  analyse::BusOptions options;
  options.bit_rate = bit_rate_;
  options.lengths = analyse::Lengths::exact;
  study_ = analyse::study_bus(set_, analyse::at_rates_of(set_, options));
  meters_.resize(set_.entries.size());
  for (std::size_t i = 0; i < set_.entries.size(); ++i) rows_[can::arbitration_key(set_.entries[i].head)] = i;
}

void Bounds::take(const log::Entry& entry) {
  if (rows_.empty()) return;
  const auto frame = entry.classic();
  if (!frame || frame->format == can::Format::error) return;
  const auto row = rows_.find(can::arbitration_key(*frame));
  if (row == rows_.end()) return;
  // Rounded down: what was measured is at least that.
  const std::int64_t takes = std::int64_t{measure::bits_on_bus(*frame)} * 1'000'000'000 / bit_rate_;
  // Of the robot's set points only those of drives are in the set.
  const bool held = protocol::Identifier::decode(frame->id).direction == protocol::Direction::command;
  meters_[row->second].add(
      entry.time.time_since_epoch().count(), frame->dlc, takes, set_.entries[row->second].period,
      held ? analyse::Grid::of_run : analyse::Grid::of_sender, held && client::is_rest(*frame));
}

std::string Bounds::state() const {
  const auto ms = [](std::int64_t ns) { return static_cast<double>(ns) / 1e6; };
  Json rows = Json::array();
  for (std::size_t i = 0; i < meters_.size(); ++i) {
    const analyse::BusEntry& entry = set_.entries[i];
    const auto& result = study_.rows[i].result;
    const analyse::Measured measured = meters_[i].finish();
    const bool bounded = result.bounded();
    rows.push_back({{"name", entry.name},
                    {"period_ms", ms(entry.period)},
                    {"deadline_ms", ms(entry.deadline_at(entry.period))},
                    {"bound_ms", bounded ? Json(ms(result.response)) : Json()},
                    {"measured_ms", measured.count > 1 ? Json(ms(measured.response)) : Json()},
                    {"exceeds", measured.count > 1 && bounded &&
                                    measured.response > result.response + analyse::time_resolution}});
  }
  return Json{
      {"rows", std::move(rows)},
      {"about",
       fmt::format("At {} bit/s, with the periods that were asked for. Measured: how far behind the grid of "
                   "its period a frame came, at most, by the clock that stamps frames here; a program that "
                   "stamps them late makes it greater than it was on the bus.",
                   bit_rate_)}}
      .line();
}

}  // namespace ocm::cli::serve
