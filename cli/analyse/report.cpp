#include "cli/analyse/report.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include <fmt/format.h>

#include "ocm/base/utf8.hpp"
#include "ocm/client/counted.hpp"

#include "cli/output/csv_cell.hpp"
#include "cli/shared/json.hpp"

namespace ocm::cli::analyse {
namespace {

bool is_bus(const Study& study) {
  return study.kind == Study::Kind::bus;
}

std::string verdict_of(const analysis::Explained& result) {
  switch (result.reason) {
    case analysis::Reason::schedulable:
      return "ok";
    case analysis::Reason::misses_deadline:
      return "MISSES";
    case analysis::Reason::overloaded:
      return "OVERLOADED";
    default:
      return "NO BOUND";
  }
}

}  // namespace

std::string to_json(const Study& study) {
  Json rows = Json::array();
  for (const Row& row : study.rows) {
    Json one{{"name", row.name},
             {"response_ns", row.result.bounded() ? Json(row.result.response) : Json(nullptr)},
             {"deadline_ns", row.result.deadline},
             {"schedulable", row.result.ok()},
             {"instances_ns", row.instances},
             {"why", row.why},
             {is_bus(study) ? "id" : "priority", row.rank}};
    if (is_bus(study)) {
      one["period_ns"] = row.period;
      one["sporadic"] = row.sporadic;
      one["bits"] = row.bits;
      one["data_bits"] = row.data_bits;
    }
    rows.push_back(one);
  }
  Json object{{"utilisation", study.utilisation()}, {is_bus(study) ? "messages" : "tasks", rows}};
  if (is_bus(study)) {
    Json left_out = Json::array();
    for (const LeftOut& each : study.left_out)
      left_out.push_back(
          {{"name", each.name}, {"reason", key_of(each.reason)}, {"why", text_of(each.reason)}});
    object["left_out"] = left_out;
  }
  for (const auto& queue : study.queues)
    object["queues"].push_back(
        {{"node", queue.node}, {"frames", queue.frames > 0 ? Json(queue.frames) : Json(nullptr)}});
  for (const auto& test : study.tests)
    object["utilisation_tests"].push_back({{"name", test.key},
                                           {"value", test.value},
                                           {"bound", test.bound},
                                           {"proven", test.proven},
                                           {"verdict", test.verdict}});
  return object.lines();
}

std::string to_csv(const Study& study) {
  std::string text = fmt::format(
      "name,{},cost_ns,period_ns,deadline_ns,jitter_ns,blocking_ns,interference_ns,response_ns,slack_ns,"
      "schedulable,why\n",
      is_bus(study) ? "id" : "priority");
  for (const Row& row : study.rows) {
    const auto& r = row.result;
    text += fmt::format("{},{},{},{},{},{},", csv_cell(row.name), row.rank, row.cost, row.period, r.deadline,
                        row.jitter);
    text += r.bounded() ? fmt::format("{},{},{},{}", r.blocking, r.interference, r.response, r.slack())
                        : std::string{",,,"};
    text += fmt::format(",{},{}\n", r.ok(), csv_cell(row.why));
  }
  return text;
}

std::string left_out_text(const std::vector<LeftOut>& left_out) {
  if (left_out.empty()) return {};
  std::string text = fmt::format("Not counted: {}, with what they send on top of these bounds.\n",
                                 client::counted(left_out.size(), "message"));
  for (const auto reason : {LeftOut::Reason::no_period, LeftOut::Reason::no_distance, LeftOut::Reason::events,
                            LeftOut::Reason::transport_protocol, LeftOut::Reason::too_long}) {
    std::string names;
    std::size_t count = 0;
    for (const LeftOut& each : left_out) {
      if (each.reason != reason) continue;
      names += (count++ == 0 ? "" : ", ") + each.name;
    }
    if (count > 0) text += fmt::format("  {} ({}): {}\n", text_of(reason), count, names);
  }
  return text;
}

std::string to_table(const Study& study, const Advice& advice, bool colour) {
  const bool bus = is_bus(study);
  const bool rooms = !advice.rooms.empty();
  std::vector<std::vector<std::string>> cells;
  std::vector<std::string> head{bus ? "MESSAGE" : "TASK", bus ? "ID" : "PRIORITY"};
  if (bus) head.emplace_back("LENGTH");
  for (const char* name : {"C", "T", "D", "J", "B", "R", "SLACK", "VERDICT"}) head.emplace_back(name);
  if (rooms) head.emplace_back("LEAST T");
  if (rooms && !bus) head.emplace_back("MOST C");
  cells.push_back(head);
  for (std::size_t i = 0; i < study.rows.size(); ++i) {
    const Row& row = study.rows[i];
    const auto& r = row.result;
    std::vector<std::string> line{row.name, row.rank};
    if (bus) line.push_back(row.size);
    line.insert(line.end(), {time_text(row.cost), time_text(row.period) + (row.sporadic ? "+" : ""),
                             time_text(r.deadline), row.jitter == 0 ? "-" : time_text(row.jitter),
                             r.blocking == 0 || !r.bounded() ? "-" : time_text(r.blocking),
                             r.bounded() ? time_text(r.response) : "none",
                             r.bounded() ? time_text(r.slack()) : "-", verdict_of(r)});
    if (rooms)
      line.push_back(advice.rooms[i].shortest_period == 0 ? "-" : time_text(advice.rooms[i].shortest_period));
    if (rooms && !bus)
      line.push_back(advice.rooms[i].greatest_cost == 0 ? "-" : time_text(advice.rooms[i].greatest_cost));
    cells.push_back(std::move(line));
  }
  std::vector<std::size_t> widths(head.size());
  for (const auto& line : cells)
    for (std::size_t i = 0; i < line.size(); ++i) widths[i] = std::max(widths[i], base::columns(line[i]));

  std::string text;
  for (std::size_t n = 0; n < cells.size(); ++n) {
    const bool bad = n > 0 && !study.rows[n - 1].result.ok();
    std::string shown;
    for (std::size_t i = 0; i < cells[n].size(); ++i) {
      const bool left = i == 0 || (bus && i == 1) || head[i] == "VERDICT";
      const std::string blank(widths[i] - base::columns(cells[n][i]), ' ');
      if (i > 0) shown += "  ";
      shown += left ? cells[n][i] + blank : blank + cells[n][i];
    }
    shown.erase(shown.find_last_not_of(' ') + 1);
    text += colour && bad ? "\x1b[31m" + shown + "\x1b[0m\n" : shown + "\n";
  }

  const auto ppm = study.load.parts_per_million();
  const auto missing =
      std::count_if(study.rows.begin(), study.rows.end(), [](const Row& row) { return !row.result.ok(); });
  text +=
      fmt::format("\n{}: {}.{:02} % of the {} ({})\n",
                  missing == 0 ? "All meet their deadlines"
                               : fmt::format("{} of {} may miss {} deadline{}", missing, study.rows.size(),
                                             missing == 1 ? "its" : "their", missing == 1 ? "" : "s"),
                  ppm / 10'000, ppm % 10'000 / 100, bus ? "bus" : "processor", study.head);
  for (const Row& row : study.rows)
    if (!row.result.ok()) text += fmt::format("  {}: {}\n", row.name, row.why);
  if (missing == 0 && !study.rows.empty()) {
    const auto tightest =
        std::min_element(study.rows.begin(), study.rows.end(), [](const Row& a, const Row& b) {
          return static_cast<double>(a.result.slack()) / static_cast<double>(a.result.deadline) <
                 static_cast<double>(b.result.slack()) / static_cast<double>(b.result.deadline);
        });
    text += fmt::format("  The tightest is {}: {}\n", tightest->name, tightest->why);
  }
  if (!advice.changes.empty()) {
    text += missing == 0 ? "There is room:\n" : "Any one of these would make all meet their deadlines:\n";
    for (const std::string& change : advice.changes) text += "  - " + change + "\n";
  } else if (missing != 0) {
    text += "No single period, cost, bit rate or order was found that would make all meet their deadlines.\n";
  }
  if (rooms)
    text +=
        bus ? "LEAST T: the shortest period of that message, others as they are, with which all meet their "
              "deadlines.\n"
            : "LEAST T, MOST C: the shortest period and the greatest cost of that task, others as they are, "
              "with which all meet their deadlines.\n";
  if (std::any_of(study.rows.begin(), study.rows.end(), [](const Row& row) { return row.sporadic; }))
    text += "T with a +: the shortest distance of two that are sent on events; they may come less often.\n";
  for (const auto& queue : study.queues)
    text += queue.frames > 0 ? fmt::format("{} has {} waiting or on the bus at most.\n", queue.node,
                                           client::counted(static_cast<std::uint64_t>(queue.frames), "frame"))
                             : fmt::format("There is no bound on how many frames of {} wait.\n", queue.node);
  if (!study.tests.empty())
    text += "Tests of the utilisation alone (sufficient, not necessary; R above is exact):\n";
  for (const auto& test : study.tests)
    text += fmt::format("  {}: {:.4f}, bound {:.4f}: {}\n", test.title, test.value, test.bound, test.verdict);
  text += left_out_text(study.left_out);
  for (const std::string& remark : study.remarks) text += remark + "\n";
  return text;
}

}  // namespace ocm::cli::analyse
