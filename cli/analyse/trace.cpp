#include "cli/analyse/trace.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "ocm/can/fd_bits.hpp"
#include "ocm/client/command.hpp"
#include "ocm/client/frame_index.hpp"
#include "ocm/client/refusal_reader.hpp"
#include "ocm/client/sample.hpp"
#include "ocm/measure/bus_load.hpp"
#include "ocm/protocol/request.hpp"

#include "cli/analyse/report.hpp"
#include "cli/logs/opened_log.hpp"
#include "cli/output/csv_cell.hpp"
#include "cli/shared/filters.hpp"
#include "cli/shared/json.hpp"
#include "cli/shared/messages.hpp"
#include "cli/words/topics.hpp"

namespace ocm::cli::analyse {
namespace {

constexpr std::int64_t resolution = time_resolution;

struct Arrival {
  std::int64_t time = 0;
  can::FdBits bits;  ///< with its stuff bits and the intermission
  std::uint8_t length = 0;
  can::Frame frame;  ///< of CAN FD without its data
};

struct Log {
  std::vector<Arrival> arrivals;
  std::size_t errors = 0;
  std::vector<std::string> remarks;
};

/// What could not be read, as mistakes at their places. A last line that is cut off is none: what is before
/// it is what the bus carried until its writer was killed.
std::vector<Mistake> mistakes_of(const log::Reader& reader, const std::string& file) {
  std::vector<Mistake> mistakes;
  for (const log::Complaint& complaint : reader.complaints().first()) {
    if (complaint.cause == log::Cause::cut_line) continue;
    mistakes.push_back(
        {fmt::format("{}:{}{}", file, complaint.place.is_line ? "" : "byte ", complaint.place.number),
         fmt::format("no frame of a log: {}: {}", log::describe(complaint.cause), complaint.detail),
         "(1436509052.249713) can0 605#00D20000, as candump -l writes it, or another format of "
         "amiroctl convert"});
  }
  return mistakes;
}

Arrival arrival_of(const log::Entry& entry, std::int64_t time) {
  if (const auto frame = entry.classic())
    return {time, {measure::bits_on_bus(*frame), 0}, frame->dlc, *frame};
  can::FdBits bits = can::fd_frame_bits(entry.frame());
  bits.nominal += can::intermission_bits;
  can::Frame head;
  head.id = entry.id;
  head.format = entry.format;
  return {time, bits, entry.length, head};
}

Log read_log(const std::string& file, const protocol::Catalogue& catalogue) {
  logs::OpenedLog opened{file, {}, catalogue};
  log::Reader& reader = opened.reader();
  Log log;
  std::size_t others = 0;
  std::size_t backwards = 0;
  std::optional<std::uint16_t> interface;
  std::array<log::Entry, log::batch> entries;
  while (const std::size_t count = reader.read(entries)) {
    for (const log::Entry& entry : std::span{entries}.first(count)) {
      if (!interface) interface = entry.interface;
      if (entry.interface != *interface) {
        ++others;
      } else if (entry.format == can::Format::error) {
        ++log.errors;
      } else {
        const std::int64_t time = entry.time.time_since_epoch().count();
        if (!log.arrivals.empty() && time < log.arrivals.back().time) ++backwards;
        log.arrivals.push_back(arrival_of(entry, time));
      }
    }
  }
  std::vector<Mistake> mistakes = mistakes_of(reader, file);
  if (mistakes.empty() && opened.ended_early()) {
    opened.complain();
    throw Exit{exit_failure};
  }
  if (mistakes.empty() && log.arrivals.empty())
    mistakes.push_back({file, "no frame", "a log as candump -l writes it"});
  stop_at(mistakes, file);
  if (reader.complaints().count(log::Cause::cut_line) > 0)
    log.remarks.emplace_back("The log's last line is cut off (its writer was ended): it was passed over.");
  if (others > 0)
    log.remarks.push_back(fmt::format("Only the frames of {}: {} of other interfaces were passed over.",
                                      reader.interfaces().name(*interface), others));
  if (backwards > 0) {
    log.remarks.push_back(fmt::format("{} {} older than the one before: sorted by time.",
                                      counted(backwards, "frame"), backwards == 1 ? "is" : "are"));
    std::stable_sort(log.arrivals.begin(), log.arrivals.end(),
                     [](const Arrival& a, const Arrival& b) { return a.time < b.time; });
  }
  return log;
}

/// The releases of what is not sent by its sender's clock, by the identifier. A period of 0 is the set's.
struct Pace {
  Grid grid = Grid::of_sender;
  std::int64_t period = 0;
};
using Paces = std::map<std::uint32_t, Pace>;

/// How far apart the set points of an actuator come.
class Distances {
 public:
  void add(std::int64_t time, bool rests) {
    if (last_) {
      constexpr std::int64_t period = client::hold_period.count();
      const std::int64_t distance = time - last_->time;
      if (shortest_ == 0 || distance < shortest_) shortest_ = distance;
      const bool pause = last_->rests || distance > period + period / 4;
      if (!pause) ++(distance >= period - period / 4 ? held_ : other_);
    }
    last_ = Last{time, rests};
  }
  /// 0: there was one set point.
  [[nodiscard]] std::int64_t shortest() const { return shortest_; }
  /// Another period than that of a drive is not known well enough to lay a grid by.
  [[nodiscard]] Pace pace() const {
    return held_ > other_ ? Pace{Grid::of_run, client::hold_period.count()} : Pace{Grid::none, 0};
  }

 private:
  struct Last {
    std::int64_t time;
    bool rests;
  };
  std::optional<Last> last_;
  std::int64_t shortest_ = 0;
  std::size_t held_ = 0;   ///< in a run, about as drives are repeated
  std::size_t other_ = 0;  ///< in a run, shorter ones
};

/// What a log says of the topics of a catalogue: which are sent, at which priority, and for which periods
/// they were asked.
class SeenTopics {
 public:
  explicit SeenTopics(const protocol::Catalogue& catalogue)
      : catalogue_(&catalogue), index_(catalogue), receiver_(catalogue), refusals_(catalogue) {}

  void take(const Arrival& arrival) {
    if (arrival.frame.format != can::Format::base && arrival.frame.format != can::Format::base_remote) return;
    const auto id = protocol::Identifier::decode(arrival.frame.id);
    const auto reception = receiver_.take({base::Time{base::Duration{arrival.time}}, arrival.frame});
    if (const auto refused = refusals_.take(reception)) {
      // It was never asked: the newest requests that this refusal can be of.
      const std::int64_t wait = client::RefusalReader::longest_wait(*reception.topic).count();
      auto& asked = seen_[refused->topic].asked;
      for (std::uint32_t i = 0; i < refused->count && !asked.empty(); ++i)
        if (arrival.time - asked.back().time <= wait) asked.pop_back();
    }
    if (const auto* topic = index_.requested(id)) {
      const auto request = protocol::decode_request(arrival.frame);
      const bool publishes = request && request->mode == protocol::Mode::publish;
      const auto period = arrival.frame.dlc == 1 ? topic->period : request.value.period;
      seen_[topic].asked.push_back({arrival.time, publishes ? period.duration().count() : 0});
    } else if (const auto frame = index_.find(id)) {
      Seen& its = seen_[frame.topic];
      its.priority = id.priority;
      its.sent = true;
      if (frame.frame != 0) return;
      its.distances.add(arrival.time, client::is_rest(arrival.frame));
      its.key = can::arbitration_key(arrival.frame);
    }
  }

  /// Of each topic, off where it is not in the log; remarks on those for which no rate is given.
  [[nodiscard]] std::vector<Rate> rates(std::span<const Rate> given, Paces& paces,
                                        std::vector<std::string>& remarks) const {
    std::vector<Rate> rates;
    std::vector<std::string> unsaid;
    for (const auto& topic : catalogue_->topics) {
      if (topic.is_message()) continue;
      const auto its = seen_.find(&topic);
      const bool is_given = std::any_of(given.begin(), given.end(), [&](const Rate& rate) {
        return words::find_topic(*catalogue_, rate.name) == &topic || words::is_in_group(topic, rate.name);
      });
      rates.push_back(its == seen_.end() ? Rate{}
                                         : rate(topic, its->second, paces, is_given ? unsaid : remarks));
      rates.back().name = topic.name;
      rates.back().place = "the log";
      rates.back().off = its == seen_.end() || !its->second.sent;
    }
    return rates;
  }

  /// One that says no priority leaves that of the log; the period that it gives a drive is meant.
  void complete(Rate& given, Paces& paces) const {
    const protocol::Topic* const topic = words::find_topic(*catalogue_, given.name);
    const auto its = seen_.find(topic);
    if (topic == nullptr || its == seen_.end()) return;
    if (!given.has_priority) {
      given.has_priority = its->second.sent;
      given.priority = its->second.priority;
    }
    if (topic->role == protocol::Role::drive && !given.off)
      paces[its->second.key] = {Grid::of_run, given.period.count()};
  }

 private:
  struct Asked {
    std::int64_t time = 0;
    std::int64_t period = 0;  ///< 0: none, or none that can be read
  };
  struct Seen {
    bool sent = false;
    protocol::Priority priority = protocol::default_priority;
    std::vector<Asked> asked;
    std::uint32_t key = 0;
    Distances distances;
  };

  static Rate rate(const protocol::Topic& topic, const Seen& its, Paces& paces,
                   std::vector<std::string>& remarks) {
    const std::int64_t asked = shortest_asked(topic, its.asked, remarks);
    Rate rate;
    if (!its.sent) return rate;
    rate.has_priority = true;
    rate.priority = its.priority;
    rate.period = asked != 0 ? base::Duration{asked} : topic.period.duration();
    if (topic.kind != protocol::Kind::actuator) return rate;
    const std::int64_t shortest = its.distances.shortest();
    rate.period = base::Duration{shortest > 0 ? shortest : 1'000'000'000};
    const std::string counts = time_text(rate.period.count());
    remarks.push_back(
        shortest > 0
            ? fmt::format("{} has no period of its own: the shortest distance in the log, {}, counts.",
                          topic.name, counts)
            : fmt::format("{} has no period of its own, and came once: {} counts.", topic.name, counts));
    const bool drives = topic.role == protocol::Role::drive;
    paces[its.key] = drives ? its.distances.pace() : Pace{Grid::none, 0};
    return rate;
  }

  /// 0: it was not asked for a period.
  static std::int64_t shortest_asked(const protocol::Topic& topic, std::span<const Asked> all,
                                     std::vector<std::string>& remarks) {
    std::int64_t shortest = 0;
    for (const Asked& each : all) {
      if (each.period == 0) continue;
      if (shortest != 0 && shortest != each.period)
        remarks.push_back(fmt::format("{} was asked for every {} and every {}: the shorter one counts.",
                                      topic.name, time_text(shortest), time_text(each.period)));
      if (shortest == 0 || each.period < shortest) shortest = each.period;
    }
    return shortest;
  }

  const protocol::Catalogue* catalogue_;
  client::FrameIndex index_;
  client::Receiver receiver_;
  client::RefusalReader refusals_;
  std::map<const protocol::Topic*, Seen> seen_;
};

/// The topics that are in the log, with the periods that requests in it ask for, and all messages: they are
/// sent unasked, and one that is missing is a finding.
BusSet set_of(const Log& log, const protocol::Catalogue& catalogue, const spec::Model* model,
              std::vector<Rate> given, Paces& paces) {
  SeenTopics seen{catalogue};
  for (const Arrival& arrival : log.arrivals) seen.take(arrival);
  std::vector<std::string> remarks;
  std::vector<Rate> all = seen.rates(given, paces, remarks);
  for (Rate& rate : given) {
    seen.complete(rate, paces);
    all.push_back(std::move(rate));
  }
  const bool any = std::any_of(all.begin(), all.end(), [](const Rate& rate) { return !rate.off; }) ||
                   std::any_of(catalogue.topics.begin(), catalogue.topics.end(),
                               [](const protocol::Topic& topic) { return topic.is_message(); });
  if (!any) fail({"the log has no frame of any topic", "--set FILE.csv gives the messages of another bus"});
  BusSet set = robot_bus(catalogue, model, all);
  set.remarks = std::move(remarks);
  return set;
}

}  // namespace

bool TraceStudy::passes() const {
  return broken.empty() && study.passes() &&
         std::none_of(measured.begin(), measured.end(), [](const Measured& m) { return m.exceeds; });
}

TraceStudy study_trace(const std::string& log_file, const std::string& set_file, const BusOptions& how,
                       const protocol::Catalogue& catalogue, const spec::Model* model,
                       std::vector<Rate> rates) {
  const Log log = read_log(log_file, catalogue);
  BusSet set;
  Paces paces;
  if (set_file.empty()) {
    set = set_of(log, catalogue, model, std::move(rates), paces);
  } else {
    set = read_bus(set_file, rates);
  }
  const BusOptions options = at_rates_of(set, how);
  // Rounded down: what was measured is at least that.
  const auto takes = [&options](const can::FdBits& bits) {
    const std::int64_t data_rate =
        options.data_bit_rate != 0 ? options.data_bit_rate : spec::max_data_bit_rate;
    return std::int64_t{bits.nominal} * 1'000'000'000 / options.bit_rate +
           std::int64_t{bits.data} * 1'000'000'000 / data_rate;
  };
  TraceStudy trace;
  trace.study = study_bus(set, options);
  trace.study.remarks.insert(trace.study.remarks.end(), log.remarks.begin(), log.remarks.end());
  trace.frames = log.arrivals.size();
  trace.span = log.arrivals.back().time - log.arrivals.front().time;

  std::map<std::uint32_t, std::size_t> rows;
  std::vector<Pace> pace_of_row(set.entries.size());
  for (std::size_t i = 0; i < set.entries.size(); ++i) {
    const BusEntry& entry = set.entries[i];
    const auto key = can::arbitration_key(entry.head);
    rows[key] = i;
    const auto paced = paces.find(key);
    Pace& pace = pace_of_row[i];
    pace = paced != paces.end() ? paced->second : Pace{entry.sporadic ? Grid::none : Grid::of_sender, 0};
    if (pace.period == 0) pace.period = entry.period;
  }
  std::vector<Meter> meters(set.entries.size());
  std::map<std::uint32_t, std::pair<can::Frame, std::size_t>> strangers;
  std::int64_t busy = 0;
  const client::FrameIndex index{catalogue};
  std::map<std::string_view, std::size_t> named;  // a message of J1939 comes from any source, at any priority
  for (std::size_t i = 0; i < set.entries.size(); ++i) named[set.entries[i].name] = i;
  const auto row_of = [&](const can::Frame& frame) {
    if (const auto row = rows.find(can::arbitration_key(frame)); row != rows.end()) return row->second;
    const client::Subject subject =
        set_file.empty() ? index.subject(frame.id, frame.format) : client::Subject{};
    if (!subject.frame || !subject.topic->is_message()) return set.entries.size();
    const auto row = named.find(subject.topic->name);
    return row == named.end() ? set.entries.size() : row->second;
  };
  std::size_t requests = 0;
  std::size_t packets = 0;
  const bool has_packets = std::any_of(catalogue.topics.begin(), catalogue.topics.end(), goes_in_packets);
  std::size_t too_close = 0;
  std::int64_t before = 0;
  for (std::size_t n = 0; n < log.arrivals.size(); ++n) {
    const Arrival& arrival = log.arrivals[n];
    if (n > 0) {
      const std::int64_t needs = takes(arrival.bits);
      busy += needs;
      if (arrival.time - before + resolution < needs) ++too_close;
    }
    before = arrival.time;
    const std::size_t row = row_of(arrival.frame);
    if (row < set.entries.size()) {
      const Pace& pace = pace_of_row[row];
      meters[row].add(arrival.time, arrival.length, takes(arrival.bits), pace.period, pace.grid,
                      pace.grid == Grid::of_run && client::is_rest(arrival.frame));
    } else if (set_file.empty() && has_packets && is_packet(arrival.frame.id, arrival.frame.format)) {
      ++packets;
    } else if (set_file.empty() && !can::is_extended(arrival.frame.format) &&
               index.requested(protocol::Identifier::decode(arrival.frame.id)) != nullptr) {
      ++requests;
    } else {
      auto& [frame, count] = strangers[can::arbitration_key(arrival.frame)];
      frame = arrival.frame;
      ++count;
    }
  }
  if (requests > 0)
    trace.study.remarks.push_back(
        fmt::format("{} request{} from the operator, not in the set: each can delay a frame by its "
                    "own length.",
                    requests, requests == 1 ? "" : "s"));
  if (packets > 0)
    trace.study.remarks.push_back(
        fmt::format("{} of J1939's transport protocol, not in the set: each can delay a frame by its own "
                    "length.",
                    counted(packets, "packet")));
  if (trace.span > 0) trace.load = static_cast<double>(busy) / static_cast<double>(trace.span);

  // What the log contradicts.
  auto& broken = trace.broken;
  for (std::size_t i = 0; i < set.entries.size(); ++i) {
    const BusEntry& entry = set.entries[i];
    const auto& result = trace.study.rows[i].result;
    trace.measured.push_back(meters[i].finish());
    Measured& m = trace.measured.back();
    if (m.greatest_length > entry.head.length)
      broken.push_back(fmt::format("length: {} came with {}, {} {} assumed", entry.name,
                                   counted(m.greatest_length, "byte"), entry.head.length,
                                   entry.head.length == 1 ? "was" : "were"));
    // A tenth of a percent is more than two quartz clocks differ by.
    m.other_period = m.count > 2 && m.mean < entry.period - entry.period / 1000 - resolution;
    m.exceeds =
        m.count > 1 && !m.other_period && result.bounded() && m.response > result.response + resolution;
    if (m.other_period)
      broken.push_back(
          fmt::format("period: {} came every {} on average, every {} was assumed; --rates NAME=PERIOD says "
                      "what was meant",
                      entry.name, time_text(m.mean), time_text(entry.period)));
    else if (m.exceeds)
      broken.push_back(fmt::format(
          "jitter: {} came up to {} behind its period, {} were assumed for its release, and with what the "
          "bus does {} at "
          "most: its sender releases it later than assumed, or sends something less urgent first, or the "
          "times in the "
          "log are those of a busy host",
          entry.name, time_text(m.lateness), time_text(entry.jitter), time_text(result.response)));
  }
  for (const auto& [key, stranger] : strangers)
    broken.push_back(fmt::format("set: {} of 0x{:X}, which is not in the set",
                                 counted(stranger.second, "frame"), stranger.first.id));
  const auto allowed = static_cast<std::size_t>(
      options.error_burst + (options.error_every > 0 ? trace.span / options.error_every : 0));
  if (log.errors > allowed)
    broken.push_back(fmt::format("errors: {}, {} {} assumed", counted(log.errors, "error frame"), allowed,
                                 allowed == 1 ? "was" : "were"));
  if (too_close > 0)
    broken.push_back(
        fmt::format("bit rate: {} came sooner after the one before than {} bit/s allow: the bit rate "
                    "is higher, or the times are those of a host and not of a CAN controller",
                    counted(too_close, "frame"), options.bit_rate));
  if (trace.load > trace.study.utilisation() + 1e-3)
    broken.push_back(fmt::format("load: {:.2f} % measured, {:.2f} % at most were assumed", trace.load * 100,
                                 trace.study.utilisation() * 100));
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
  text +=
      fmt::format("\n{} frames in {}; load {:.2f} % measured, {:.2f} % at most ({})\n", trace.frames,
                  time_text(trace.span), trace.load * 100, trace.study.utilisation() * 100, trace.study.head);
  text += trace.broken.empty() ? "The log contradicts no assumption.\n"
                               : "Assumptions that the log contradicts:\n";
  for (const std::string& broken : trace.broken) text += "  - " + broken + "\n";
  for (const std::string& remark : trace.study.remarks) text += remark + "\n";
  return text;
}

}  // namespace ocm::cli::analyse
