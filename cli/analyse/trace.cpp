#include "cli/analyse/trace.hpp"

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "ocm/can/fd_bits.hpp"
#include "ocm/client/command.hpp"
#include "ocm/client/frame_index.hpp"
#include "ocm/protocol/identifier.hpp"

#include "cli/analyse/arrivals.hpp"
#include "cli/analyse/report.hpp"
#include "cli/analyse/seen_set.hpp"
#include "cli/output/csv_cell.hpp"
#include "cli/shared/filters.hpp"
#include "cli/shared/json.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::analyse {
namespace {

constexpr std::int64_t resolution = time_resolution;

/// A log beside the set that it is held against.
class Comparison {
 public:
  /// All must outlive it. `by_topics`: the set is of the catalogue's topics, and not of a file.
  Comparison(const Arrivals& log, const BusSet& set, const Paces& paces, const BusOptions& options,
             const protocol::Catalogue& catalogue, bool by_topics)
      : log_(&log),
        set_(&set),
        options_(&options),
        by_topics_(by_topics),
        has_packets_(by_topics &&
                     std::any_of(catalogue.topics.begin(), catalogue.topics.end(), goes_in_packets)),
        index_(catalogue),
        meters_(set.entries.size()) {
    for (std::size_t i = 0; i < set.entries.size(); ++i) {
      const BusEntry& entry = set.entries[i];
      const auto key = can::arbitration_key(entry.head);
      rows_[key] = i;
      named_[entry.name] = i;
      const auto paced = paces.find(key);
      paces_.push_back(paced != paces.end() ? paced->second
                                            : Pace{entry.sporadic ? Grid::none : Grid::of_sender, 0});
      if (paces_.back().period == 0) paces_.back().period = entry.period;
    }
  }

  void take_all() {
    const Arrival* before = nullptr;
    for (const Arrival& arrival : log_->all) {
      if (before != nullptr) {
        const std::int64_t needs = time_of(arrival);
        busy_ += needs;
        if (arrival.time - before->time + resolution < needs) ++too_close_;
      }
      before = &arrival;
      take(arrival);
    }
  }

  /// What the bus carried beside the set.
  void add_remarks(std::vector<std::string>& remarks) const {
    remarks.insert(remarks.end(), log_->remarks.begin(), log_->remarks.end());
    if (requests_ > 0)
      remarks.push_back(
          fmt::format("{} from the operator, not in the set: each can delay a frame by its own "
                      "length.",
                      counted(requests_, "request")));
    if (packets_ > 0)
      remarks.push_back(
          fmt::format("{} of J1939's transport protocol, not in the set: each can delay a frame by its own "
                      "length.",
                      counted(packets_, "packet")));
  }

  /// What was measured, and what of it contradicts an assumption of the study.
  void finish(TraceStudy& trace) const {
    trace.frames = log_->all.size();
    trace.span = log_->all.back().time - log_->all.front().time;
    if (trace.span > 0) trace.load = static_cast<double>(busy_) / static_cast<double>(trace.span);
    for (std::size_t i = 0; i < set_->entries.size(); ++i) {
      trace.measured.push_back(measured(i, trace.study.rows[i].result));
      note_row(set_->entries[i], trace.measured.back(), trace.study.rows[i].result, trace.broken);
    }
    note_bus(trace);
  }

 private:
  /// Nanoseconds on the bus, rounded down: what was measured is at least that.
  [[nodiscard]] std::int64_t time_of(const Arrival& arrival) const {
    const std::int64_t data_rate =
        options_->data_bit_rate != 0 ? options_->data_bit_rate : spec::max_data_bit_rate;
    return std::int64_t{arrival.bits.nominal} * 1'000'000'000 / options_->bit_rate +
           std::int64_t{arrival.bits.data} * 1'000'000'000 / data_rate;
  }

  /// The number of its message; that of the entries: it is of none.
  [[nodiscard]] std::size_t row_of(const can::Frame& frame) const {
    if (const auto row = rows_.find(can::arbitration_key(frame)); row != rows_.end()) return row->second;
    const auto subject = by_topics_ ? index_.subject(frame.id, frame.format) : client::Subject{};
    if (!subject.frame || !subject.topic->is_message()) return set_->entries.size();
    const auto row = named_.find(subject.topic->name);
    return row == named_.end() ? set_->entries.size() : row->second;
  }

  void take(const Arrival& arrival) {
    const can::Frame& frame = arrival.frame;
    const std::size_t row = row_of(frame);
    if (row < set_->entries.size()) {
      const Pace& pace = paces_[row];
      meters_[row].add(arrival.time, arrival.length, time_of(arrival), pace.period, pace.grid,
                       pace.grid == Grid::of_run && client::is_rest(frame));
    } else if (has_packets_ && is_packet(frame.id, frame.format)) {
      ++packets_;
    } else if (by_topics_ && !can::is_extended(frame.format) &&
               index_.requested(protocol::Identifier::decode(frame.id)) != nullptr) {
      ++requests_;
    } else {
      Stranger& stranger = strangers_[can::arbitration_key(frame)];
      stranger.id = frame.id;
      ++stranger.count;
    }
  }

  [[nodiscard]] Measured measured(std::size_t row, const analysis::Explained& bound) const {
    Measured m = meters_[row].finish();
    const std::int64_t period = set_->entries[row].period;
    // A tenth of a percent is more than two quartz clocks differ by.
    m.other_period = m.count > 2 && m.mean < period - period / 1000 - resolution;
    m.exceeds = m.count > 1 && !m.other_period && bound.bounded() && m.response > bound.response + resolution;
    return m;
  }

  static void note_row(const BusEntry& entry, const Measured& m, const analysis::Explained& bound,
                       std::vector<std::string>& broken) {
    if (m.greatest_length > entry.head.length)
      broken.push_back(fmt::format("length: {} came with {}, {} {} assumed", entry.name,
                                   counted(m.greatest_length, "byte"), entry.head.length,
                                   entry.head.length == 1 ? "was" : "were"));
    if (m.other_period)
      broken.push_back(
          fmt::format("period: {} came every {} on average, every {} was assumed; --rates NAME=PERIOD says "
                      "what was meant",
                      entry.name, time_text(m.mean), time_text(entry.period)));
    else if (m.exceeds)
      broken.push_back(fmt::format(
          "jitter: {} came up to {} behind its period, {} were assumed for its release, and with what the "
          "bus does {} at most: its sender releases it later than assumed, or sends something less urgent "
          "first, or the times in the log are those of a busy host",
          entry.name, time_text(m.lateness), time_text(entry.jitter), time_text(bound.response)));
  }

  void note_bus(TraceStudy& trace) const {
    auto& broken = trace.broken;
    for (const auto& [key, stranger] : strangers_)
      broken.push_back(fmt::format("set: {} of 0x{:X}, which is not in the set",
                                   counted(stranger.count, "frame"), stranger.id));
    const auto allowed = static_cast<std::size_t>(
        options_->error_burst + (options_->error_every > 0 ? trace.span / options_->error_every : 0));
    if (log_->errors > allowed)
      broken.push_back(fmt::format("errors: {}, {} {} assumed", counted(log_->errors, "error frame"), allowed,
                                   allowed == 1 ? "was" : "were"));
    if (too_close_ > 0)
      broken.push_back(
          fmt::format("bit rate: {} came sooner after the one before than {} bit/s allow: the bit rate is "
                      "higher, or the times are those of a host and not of a CAN controller",
                      counted(too_close_, "frame"), options_->bit_rate));
    if (trace.load > trace.study.utilisation() + 1e-3)
      broken.push_back(fmt::format("load: {:.2f} % measured, {:.2f} % at most were assumed", trace.load * 100,
                                   trace.study.utilisation() * 100));
  }

  struct Stranger {
    std::uint32_t id = 0;
    std::size_t count = 0;
  };

  const Arrivals* log_;
  const BusSet* set_;
  const BusOptions* options_;
  bool by_topics_;
  bool has_packets_;
  client::FrameIndex index_;
  std::vector<Meter> meters_;  ///< one an entry of the set, as `paces_`
  std::vector<Pace> paces_;
  std::map<std::uint32_t, std::size_t> rows_;  ///< by the key of arbitration
  /// A message of J1939 comes from any source, at any priority.
  std::map<std::string_view, std::size_t> named_;
  std::map<std::uint32_t, Stranger> strangers_;
  std::int64_t busy_ = 0;  ///< nanoseconds, behind the first frame
  std::size_t requests_ = 0;
  std::size_t packets_ = 0;
  std::size_t too_close_ = 0;
};

}  // namespace

bool TraceStudy::passes() const {
  return broken.empty() && study.passes() &&
         std::none_of(measured.begin(), measured.end(), [](const Measured& m) { return m.exceeds; });
}

TraceStudy study_trace(const std::string& log_file, const std::string& set_file, const BusOptions& how,
                       const protocol::Catalogue& catalogue, const spec::Model* model,
                       std::vector<Rate> rates) {
  const Arrivals log = read_arrivals(log_file, catalogue);
  const bool by_topics = set_file.empty();
  Paces paces;
  const BusSet set =
      by_topics ? seen_set(log, catalogue, model, std::move(rates), paces) : read_bus(set_file, rates);
  const BusOptions options = at_rates_of(set, how);
  TraceStudy trace;
  trace.study = study_bus(set, options);
  Comparison comparison{log, set, paces, options, catalogue, by_topics};
  comparison.take_all();
  comparison.add_remarks(trace.study.remarks);
  comparison.finish(trace);
  return trace;
}

std::string to_json(const TraceStudy& trace) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < trace.measured.size(); ++i) {
    const Row& row = trace.study.rows[i];
    const Measured& m = trace.measured[i];
    rows.push_back({{"name", row.name},
                    {"count", m.count},
                    {"period_ns", row.period},
                    {"shortest_ns", m.shortest},
                    {"mean_ns", m.mean},
                    {"longest_ns", m.longest},
                    {"lateness_ns", m.other_period ? Json(nullptr) : Json(m.lateness)},
                    {"measured_ns", m.other_period ? Json(nullptr) : Json(m.response)},
                    {"response_ns", row.result.bounded() ? Json(row.result.response) : Json(nullptr)},
                    {"deadline_ns", row.result.deadline},
                    {"schedulable", row.result.ok()},
                    {"within", !m.exceeds && !m.other_period}});
  }
  const Json object{{"utilisation", trace.study.utilisation()},
                    {"measured_utilisation", trace.load},
                    {"span_ns", trace.span},
                    {"frames", trace.frames},
                    {"messages", rows},
                    {"broken", trace.broken}};
  return object.lines();
}

std::string to_csv(const TraceStudy& trace) {
  std::string text =
      "name,count,period_ns,shortest_ns,mean_ns,longest_ns,lateness_ns,measured_ns,response_ns,within\n";
  for (std::size_t i = 0; i < trace.measured.size(); ++i) {
    const Row& row = trace.study.rows[i];
    const Measured& m = trace.measured[i];
    text += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", csv_cell(row.name), m.count, row.period,
                        m.shortest, m.mean, m.longest, m.other_period ? "" : std::to_string(m.lateness),
                        m.other_period ? "" : std::to_string(m.response),
                        row.result.bounded() ? std::to_string(row.result.response) : "",
                        !m.exceeds && !m.other_period);
  }
  return text;
}

std::string to_table(const TraceStudy& trace) {
  std::size_t width = 7;
  for (const Row& row : trace.study.rows) width = std::max(width, row.name.size());
  constexpr auto line = "{:<{}}  {:>7}  {:>10}  {:>12}  {:>12}  {:>12}  {:>12}  {:>12}  {}\n";
  std::string text = fmt::format(fmt::runtime(line), "MESSAGE", width, "FRAMES", "T", "SHORTEST", "MEAN",
                                 "LONGEST", "MEASURED", "R", "VERDICT");
  for (std::size_t i = 0; i < trace.measured.size(); ++i) {
    const Row& row = trace.study.rows[i];
    const Measured& m = trace.measured[i];
    const bool enough = m.count > 1;
    text += fmt::format(fmt::runtime(line), row.name, width, m.count, time_text(row.period),
                        enough ? time_text(m.shortest) : "-", enough ? time_text(m.mean) : "-",
                        enough ? time_text(m.longest) : "-",
                        m.count > 0 && !m.other_period ? time_text(m.response) : "-",
                        row.result.bounded() ? time_text(row.result.response) : "none",
                        m.exceeds          ? "BEYOND ITS BOUND"
                        : m.other_period   ? "OTHER PERIOD"
                        : !row.result.ok() ? "may miss"
                        : m.count == 0     ? "never came"
                                           : "ok");
  }
  text += fmt::format("\n{} in {}; load {:.2f} % measured, {:.2f} % at most ({})\n",
                      counted(trace.frames, "frame"), time_text(trace.span), trace.load * 100,
                      trace.study.utilisation() * 100, trace.study.head);
  text += trace.broken.empty() ? "The log contradicts no assumption.\n"
                               : "Assumptions that the log contradicts:\n";
  for (const std::string& broken : trace.broken) text += "  - " + broken + "\n";
  for (const std::string& remark : trace.study.remarks) text += remark + "\n";
  return text;
}

}  // namespace ocm::cli::analyse
