#include "cli/stats/report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "ocm/base/text.hpp"
#include "ocm/can/text.hpp"
#include "ocm/client/counted.hpp"
#include "ocm/log/complaints.hpp"

#include "cli/output/csv_cell.hpp"
#include "cli/shared/folding.hpp"
#include "cli/shared/json.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli::stats {
namespace {

using measure::BusFigures;
using measure::PeriodFrom;
using measure::Timing;
using measure::TopicFigures;

std::string time(double ns) {
  return to_text(ns, Unit::time);
}
std::string time(std::int64_t ns) {
  return time(static_cast<double>(ns));
}

bool is_shown(const protocol::Topic* topic, const Shown& shown) {
  return shown.empty() || std::find(shown.begin(), shown.end(), topic) != shown.end();
}
bool is_shown(const TopicFigures& topic, const Shown& shown) {
  return is_shown(topic.topic, shown);
}

std::string_view name(PeriodFrom from) {
  constexpr std::string_view names[]{"", "request", "spec", "measured"};
  return names[static_cast<std::size_t>(from)];
}

bool has_lateness(const Timing& timing) {
  return timing.distances != 0 && !timing.faster &&
         (timing.period_from == PeriodFrom::request || timing.period_from == PeriodFrom::spec);
}

/// "high", or "high 40, low 2": samples by what they were sent at.
std::string priorities(const TopicFigures& topic) {
  const auto kinds =
      std::count_if(topic.by_priority.begin(), topic.by_priority.end(), [](auto n) { return n != 0; });
  std::string text;
  for (std::size_t i = 0; i < topic.by_priority.size(); ++i) {
    if (topic.by_priority[i] == 0) continue;
    if (!text.empty()) text += ", ";
    text += protocol::name(static_cast<protocol::Priority>(i));
    if (kinds > 1) text += fmt::format(" {}", topic.by_priority[i]);
  }
  return text.empty() ? "-" : text;
}

std::string period(const Timing& timing) {
  if (timing.period_from == PeriodFrom::nothing) return "-";
  const std::string text = time(timing.period_ns);
  return timing.period_from == PeriodFrom::request ? text
                                                   : fmt::format("{} ({})", text, name(timing.period_from));
}

/// What can be left out of a table that is too wide, the least important first: what is missing, the gaps,
/// the load and the faults stay.
constexpr std::array<std::size_t, 7> dispensable{1, 7, 6, 5, 4, 2, 3};
constexpr std::size_t gap_column = 9;

std::string gap(const Timing& timing, base::Time first) {
  if (timing.gap_ns == 0) return "-";
  return fmt::format("{} at {}", time(timing.gap_ns), time((timing.gap_from - first).count()));
}

constexpr std::array head{"TOPIC",  "PRIORITY", "SAMPLES", "RATE",        "PERIOD", "MEAN",
                          "JITTER", "LATE",     "MISSING", "LONGEST GAP", "LOAD",   "FAULTS"};
using Row = std::array<std::string, head.size()>;

Row row(const TopicFigures& topic, base::Time first) {
  const Timing& timing = topic.timing;
  const bool measured = timing.distances != 0;
  std::string faults;
  const auto fault = [&faults](std::uint64_t count, std::string_view what) {
    if (count == 0) return;
    if (!faults.empty()) faults += ", ";
    faults += fmt::format("{} {}", count, what);
  };
  fault(topic.incomplete, "incomplete");
  fault(topic.wrong_dlc, "of wrong length");
  fault(topic.bad_requests, topic.bad_requests == 1 ? "bad request" : "bad requests");
  fault(topic.refused, topic.refused == 1 ? "request refused" : "requests refused");
  fault(timing.backwards, "back in time");
  return {std::string{topic.topic->name},
          priorities(topic),
          fmt::format("{}", timing.count),
          measured ? to_text(timing.rate_hz, Unit::hertz) : "-",
          period(timing),
          measured ? time(timing.mean_ns) : "-",
          measured ? time(timing.jitter_ns) : "-",
          has_lateness(timing) ? time(timing.lateness_ns) : "-",
          timing.period_from == PeriodFrom::nothing ? "-" : fmt::format("{}", timing.missing),
          gap(timing, first),
          std::isnan(topic.load) ? "-" : to_text(topic.load * 100, Unit::percent),
          faults};
}

std::string id_text(const measure::Stranger& stranger) {
  std::string text{can::to_text(can::Frame{stranger.id, 0, {}, stranger.format}).view()};
  // "655#" and "655#R": a remote frame is another than the data frame of its identifier.
  return text.ends_with('#') ? text.substr(0, text.size() - 1) : text;
}

std::string strangers(const BusFigures& figures) {
  constexpr std::size_t most = 5;
  auto sorted = figures.strangers;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.count > b.count; });
  std::string text;
  for (std::size_t i = 0; i < std::min(sorted.size(), most); ++i)
    text += fmt::format("{}{} {}", i == 0 ? "" : ", ", id_text(sorted[i]), sorted[i].count);
  return sorted.size() > most ? text + ", ..." : text;
}

/// "500", or "500 and 2000" where frames of CAN FD are in the load at the second.
std::string kbit_per_second(const BusFigures& figures) {
  const auto [nominal, data] = figures.bit_rates;
  std::string text = fmt::format("{}", nominal / 1000.0);
  if (figures.fd_frames != 0 && data != 0) text += fmt::format(" and {}", data / 1000.0);
  return text;
}

/// "Driving (20 ms), Wheels (20 ms)": the first of them.
std::string names_of(const std::vector<const protocol::Topic*>& messages, std::size_t most) {
  const std::size_t named = std::min(messages.size(), most);
  std::string text;
  for (std::size_t i = 0; i < named; ++i)
    text += fmt::format("{}{} ({})", i == 0 ? "" : ", ", messages[i]->name, time(messages[i]->cycle.count()));
  if (named < messages.size()) text += fmt::format(" and {} more", messages.size() - named);
  return text;
}

/// What a bus carried, and what went wrong on it.
std::vector<std::string> summary(const Bus& bus) {
  const BusFigures& figures = bus.figures;
  const auto& counters = figures.counters;
  std::vector<std::string> lines;
  std::string load = "for its load: --bitrate 500k";
  if (figures.bit_rates.nominal != 0)
    load = fmt::format("load {} at {} kbit/s, {} in the worst 100 ms, until {}",
                       to_text(figures.load * 100, Unit::percent), kbit_per_second(figures),
                       to_text(figures.worst_load * 100, Unit::percent),
                       time((figures.worst_until - figures.first).count()));
  lines.push_back(
      fmt::format("{}: {} in {} ({}); {}",
                  bus.name.empty() ? "a bus without a name" : log::Complaints::printable(bus.name),
                  client::counted(counters.frames - counters.errors, "frame"), time(figures.span().count()),
                  to_text(figures.rate_hz, Unit::hertz), load));
  std::string faults;
  const auto fault = [&faults](std::uint64_t count, std::string_view what) {
    if (count == 0) return;
    faults += fmt::format("{}{}", faults.empty() ? "" : ", ", client::counted(count, what));
  };
  fault(counters.errors, "error frame");
  fault(figures.overflows, "overflow* of the CAN controller");
  fault(bus.drops, "frame* lost");
  fault(figures.fd_frames - figures.not_in_load, "CAN FD frame");
  fault(figures.not_in_load, figures.bit_rates.nominal == 0
                                 ? "CAN FD frame"
                                 : "CAN FD frame*, not in the load without --data-bitrate");
  fault(counters.remote, "remote frame");
  fault(counters.transport, "frame* of the transport protocol of J1939");
  const auto lost = figures.transport.lost();
  fault(lost,
        lost == 1 ? "message* of it that was not put together" : "message* of it that were not put together");
  fault(figures.transport.stray + figures.transport.malformed, "frame* of it of no message");
  fault(counters.unselected, "frame* whose selector chooses no field");
  fault(counters.unknown + counters.fd, "frame* that no topic or message has");
  if (counters.unknown + counters.fd != 0) faults += fmt::format(" ({})", strangers(figures));
  if (!faults.empty()) lines.push_back("  " + faults);
  return lines;
}

/// null: the bit rate is not known.
Json percent(double share) {
  return std::isnan(share) ? Json(nullptr) : Json(share * 100);
}

Json to_object(const TopicFigures& topic) {
  const Timing& timing = topic.timing;
  const bool measured = timing.distances != 0;
  const bool periodic = timing.period_from != PeriodFrom::nothing;
  Json by_priority = Json::object();
  for (std::size_t i = 0; i < topic.by_priority.size(); ++i)
    if (topic.by_priority[i] != 0)
      by_priority[std::string{protocol::name(static_cast<protocol::Priority>(i))}] = topic.by_priority[i];
  const auto if_measured = [measured](auto value) { return measured ? Json(value) : Json(nullptr); };
  return {
      {"topic", topic.topic->name},
      {"count", timing.count},
      {"by_priority", by_priority},
      {"rate_hz", if_measured(timing.rate_hz)},
      {"period_ns", periodic ? Json(timing.period_ns) : Json(nullptr)},
      {"period_from", periodic ? Json(name(timing.period_from)) : Json(nullptr)},
      {"mean_ns", if_measured(timing.mean_ns)},
      {"jitter_ns", if_measured(timing.jitter_ns)},
      {"spread_ns", if_measured(timing.spread_ns)},
      {"lateness_ns", has_lateness(timing) ? Json(timing.lateness_ns) : Json(nullptr)},
      {"gap_ns", timing.gap_ns != 0 ? Json(timing.gap_ns) : Json(nullptr)},
      {"gap_from_ns", timing.gap_ns != 0 ? Json(fmt::format("{}", timing.gap_from.time_since_epoch().count()))
                                         : Json(nullptr)},
      {"missing", periodic ? Json(timing.missing) : Json(nullptr)},
      {"incomplete", topic.incomplete},
      {"wrong_length", topic.wrong_dlc},
      {"requests", topic.requests},
      {"bad_requests", topic.bad_requests},
      {"refused_requests", topic.refused},
      {"backwards", timing.backwards},
      {"load_percent", percent(topic.load)}};
}

Json to_object(const Bus& bus, const Shown& shown) {
  const BusFigures& figures = bus.figures;
  const auto& counters = figures.counters;
  Json unknown = Json::array();
  for (const auto& stranger : figures.strangers)
    unknown.push_back({{"id", id_text(stranger)}, {"count", stranger.count}});
  Json topics = Json::array();
  for (const auto& topic : figures.topics)
    if (is_shown(topic, shown)) topics.push_back(to_object(topic));
  return {{"bus", bus.name},
          {"first_ns", fmt::format("{}", figures.first.time_since_epoch().count())},
          {"last_ns", fmt::format("{}", figures.last.time_since_epoch().count())},
          {"frames", counters.frames - counters.errors},
          {"rate_hz", figures.rate_hz},
          {"bit_rate", figures.bit_rates.nominal != 0 ? Json(figures.bit_rates.nominal) : Json(nullptr)},
          {"data_bit_rate", figures.bit_rates.data != 0 ? Json(figures.bit_rates.data) : Json(nullptr)},
          {"load_percent", percent(figures.load)},
          {"request_load_percent", percent(figures.request_load)},
          {"unknown_load_percent", percent(figures.stranger_load)},
          {"worst_100ms_load_percent", percent(figures.worst_load)},
          {"worst_100ms_until_ns", fmt::format("{}", figures.worst_until.time_since_epoch().count())},
          {"commands", counters.commands},
          {"errors", counters.errors},
          {"overflows", figures.overflows},
          {"drops", bus.drops},
          {"incomplete", counters.incomplete},
          {"wrong_length", counters.wrong_dlc},
          {"fd_frames", figures.fd_frames},
          {"fd_frames_not_in_load", figures.not_in_load},
          {"remote", counters.remote},
          {"transport", counters.transport},
          {"transport_lost", figures.transport.lost()},
          {"transport_stray", figures.transport.stray + figures.transport.malformed},
          {"unselected", counters.unselected},
          {"unknown", counters.unknown + counters.fd},
          {"unknown_ids", unknown},
          {"topics", topics}};
}

std::vector<const protocol::Topic*> never_came(const Report& report, const Shown& shown) {
  std::vector<const protocol::Topic*> out;
  for (const auto* message : report.never_came)
    if (is_shown(message, shown)) out.push_back(message);
  return out;
}

/// Each line on its own, so that a colour ends with the line.
void add_folded(std::vector<std::string>& lines, const std::string& line, std::size_t columns,
                std::string_view colour = "") {
  const std::string text = folded(line, columns, 4);
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view part = rest.substr(0, rest.find('\n'));
    lines.push_back(colour.empty() ? std::string{part} : fmt::format("{}{}\x1b[0m", colour, part));
    rest.remove_prefix(std::min(part.size() + 1, rest.size()));
  }
}

}  // namespace

std::vector<std::string> to_table(const Report& report, const Shown& shown, bool colour,
                                  std::size_t columns) {
  std::vector<std::string> lines;
  for (const Bus& bus : report.buses) {
    if (!lines.empty()) lines.emplace_back();
    std::vector<Row> rows(1);
    std::copy(head.begin(), head.end(), rows[0].begin());
    std::vector<bool> bad{false};
    for (const auto& topic : bus.figures.topics) {
      if (!is_shown(topic, shown)) continue;
      rows.push_back(row(topic, bus.figures.first));
      bad.push_back(topic.timing.missing + topic.incomplete + topic.wrong_dlc != 0);
    }
    std::array<std::size_t, head.size()> widths{};
    for (const Row& row : rows)
      for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
    std::size_t blanks = 2;  // between two columns
    const auto total = [&widths, &blanks] {
      std::size_t sum = 0;
      for (const std::size_t width : widths) sum += width == 0 ? 0 : width + blanks;
      return sum - blanks;
    };
    for (const std::size_t i : dispensable)
      if (total() > columns) widths[i] = 0;
    if (total() > columns) {  // when the gap was is not as important as how long
      widths[gap_column] = 0;
      for (Row& row : rows) {
        std::string& text = row[gap_column];
        text = &row == rows.data() ? "GAP" : text.substr(0, text.find(" at "));
        widths[gap_column] = std::max(widths[gap_column], text.size());
      }
    }
    if (total() > columns) blanks = 1;
    if (const std::size_t over = total(); over > columns)  // but a few letters name a topic
      widths[0] -= std::min(over - columns, widths[0] - std::min<std::size_t>(widths[0], 6));
    for (std::size_t n = 0; n < rows.size(); ++n) {
      std::string line;
      for (std::size_t i = 0; i < head.size(); ++i) {
        if (widths[i] == 0) continue;
        rows[n][i].resize(std::min(rows[n][i].size(), widths[i]));
        const bool words = i <= 1 || i + 1 == head.size();
        line.append(i == 0 ? 0 : blanks, ' ');
        line += words ? fmt::format("{:<{}}", rows[n][i], widths[i])
                      : fmt::format("{:>{}}", rows[n][i], widths[i]);
      }
      line.erase(line.find_last_not_of(' ') + 1);
      add_folded(lines, line, columns, colour && bad[n] ? "\x1b[33m" : "");
    }
    for (const std::string& line : summary(bus)) add_folded(lines, line, columns);
  }
  if (const std::string text = never_came_text(report, shown); !text.empty())
    add_folded(lines, text, columns, colour ? "\x1b[33m" : "");
  return lines;
}

std::string never_came_text(const Report& report, const Shown& shown) {
  constexpr std::size_t most = 10;
  const auto missing = never_came(report, shown);
  return missing.empty() ? std::string{}
                         : "never came: " + names_of(missing, shown.empty() ? most : missing.size());
}

std::string to_json(const Report& report, const Shown& shown, std::span<const Assertion> assertions) {
  Json out{{"robot", report.robot},
           {"source", report.source},
           {"buses", Json::array()},
           {"never_came", Json::array()}};
  for (const Bus& bus : report.buses) out["buses"].push_back(to_object(bus, shown));
  for (const auto* message : never_came(report, shown))
    out["never_came"].push_back({{"topic", message->name}, {"period_ns", message->cycle.count()}});
  if (!assertions.empty()) out["assertions"] = Json::array();
  for (const Assertion& assertion : assertions) {
    const auto verdict = assertion.check(report.buses);
    out["assertions"].push_back({{"assert", assertion.text()},
                                 {"holds", verdict.holds},
                                 {"measured", verdict.measured ? Json(*verdict.measured) : Json(nullptr)}});
  }
  return out.line() + "\n";
}

std::string to_csv(const Report& report, const Shown& shown) {
  std::string text =
      "bus,topic,priority,count,rate_hz,period_ns,period_from,mean_ns,jitter_ns,spread_ns,lateness_ns,gap_ns,"
      "gap_from_ns,missing,incomplete,wrong_length,requests,load_percent\n";
  for (const Bus& bus : report.buses)
    for (const auto& topic : bus.figures.topics) {
      if (!is_shown(topic, shown)) continue;
      // As in JSON, so that a figure has one text.
      auto object = to_object(topic);
      text += csv_cell(bus.name);
      for (const char* key : {"topic", "priority", "count", "rate_hz", "period_ns", "period_from", "mean_ns",
                              "jitter_ns", "spread_ns", "lateness_ns", "gap_ns", "gap_from_ns", "missing",
                              "incomplete", "wrong_length", "requests", "load_percent"}) {
        text += ',';
        if (key == std::string_view{"priority"})
          text += csv_cell(priorities(topic));
        else if (object[key].is_text())
          text += object[key].text();
        else if (!object[key].is_null())
          text += object[key].line();
      }
      text += '\n';
    }
  return text;
}

}  // namespace ocm::cli::stats
