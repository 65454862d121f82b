#include "cli/operate/answers.hpp"

#include <chrono>
#include <ctime>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "cli/words/quantity.hpp"

namespace ocm::cli::operate {

using reflective::none;
using reflective::Truth;

namespace {

std::string_view name_of(Truth truth) {
  constexpr std::string_view names[] = {"unknown", "no", "yes"};
  return names[static_cast<std::size_t>(truth)];
}

std::string rounded(base::Duration duration) {
  return words::to_text(std::chrono::duration_cast<std::chrono::milliseconds>(duration));
}

/// A sample that has just come is not "0s" old.
std::string age(base::Duration duration) {
  return duration < std::chrono::milliseconds{1} ? "under 1ms" : rounded(duration);
}

/// 10:15:04.212, by the clock on the wall here.
std::string time_of_day(base::Time wall) {
  const std::int64_t ms = wall.time_since_epoch().count() / 1'000'000;
  const auto seconds = static_cast<std::time_t>(ms / 1000);
  std::tm parts{};
  localtime_r(&seconds, &parts);
  return fmt::format("{:02}:{:02}:{:02}.{:03}", parts.tm_hour, parts.tm_min, parts.tm_sec, ms % 1000);
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace

std::string Answers::status(base::Time now) const {
  const auto& tables = file.tables;
  const auto& here = tables.configurations[supervisor.configuration()];
  std::string text = fmt::format(
      "operator {} is in {} since {}{}\n", tables.name, here.name, rounded(now - supervisor.since()),
      supervisor.on_hold() ? ", on hold: monitors lead to the fall-back only" : "");
  if (supervisor.requested() != none)
    text += fmt::format("  {} was asked for, and waits until the last change is over\n",
                        tables.configurations[supervisor.requested()].name);
  for (std::size_t s = 0; s < here.streams.size(); ++s)
    text += fmt::format("  {:<20} every {:<8} last {} ago\n", tables.topic(here.streams[s].topic).name,
                        words::to_text(supervisor.period(s)), age(now - supervisor.heard(s)));
  for (std::size_t m = 0; m < tables.monitors.size(); ++m)
    text += fmt::format("  monitor {:<12} {}\n", tables.monitors[m].name, name_of(supervisor.monitor(m)));
  text += fmt::format("  set points: {} passed on, {} of them limited; {} refused\n", commands.passed,
                      commands.limited, commands.refused);
  if (commands.beyond != 0)
    text += fmt::format("  {} of them more often, or more urgent, than the proof counts\n", commands.beyond);
  if (lines_lost != 0) text += fmt::format("  event lines not printed: {}\n", lines_lost);
  return text;
}

Json Answers::status_json(base::Time now) const {
  const auto& tables = file.tables;
  const auto& here = tables.configurations[supervisor.configuration()];
  Json streams = Json::array();
  for (std::size_t s = 0; s < here.streams.size(); ++s)
    streams.push_back({{"topic", tables.topic(here.streams[s].topic).name},
                       {"period_ns", supervisor.period(s).count()},
                       {"age_ns", (now - supervisor.heard(s)).count()}});
  Json monitors = Json::object();
  for (std::size_t m = 0; m < tables.monitors.size(); ++m)
    monitors[tables.monitors[m].name] = name_of(supervisor.monitor(m));
  Json requested;
  if (supervisor.requested() != none) requested = tables.configurations[supervisor.requested()].name;
  return {{"operator", tables.name},
          {"configuration", here.name},
          {"for_ns", (now - supervisor.since()).count()},
          {"on_hold", supervisor.on_hold()},
          {"requested", requested},
          {"streams", streams},
          {"monitors", monitors},
          {"set_points",
           {{"passed", commands.passed},
            {"limited", commands.limited},
            {"refused", commands.refused},
            {"beyond_proof", commands.beyond}}},
          {"lines_not_printed", lines_lost}};
}

std::string Answers::why() const {
  const auto& tables = file.tables;
  std::string text;
  for (const auto& change : changes) {
    if (change.from == none) {
      text +=
          fmt::format("{}  started in {}\n", time_of_day(change.wall), tables.configurations[change.to].name);
      continue;
    }
    text +=
        fmt::format("{}  {} -> {}: {}{}\n", time_of_day(change.wall), tables.configurations[change.from].name,
                    tables.configurations[change.to].name, change.cause,
                    change.conditions.empty() ? "" : fmt::format(" ({})", joined(change.conditions)));
  }
  text += fmt::format("it leaves {}\n", tables.configurations[supervisor.configuration()].name);
  for (const auto& transition : tables.transitions) {
    if (!tables.leaves(transition, supervisor.configuration())) continue;
    const auto to = tables.configurations[transition.to].name;
    if (transition.monitor == reflective::by_request) {
      text += fmt::format("  to {} when it is asked: amiroctl operator switch {}\n", to, to);
      continue;
    }
    const auto& monitor = tables.monitors[transition.monitor];
    std::vector<std::string> conditions;
    for (std::size_t t = 0; t < monitor.terms.size(); ++t)
      if (const auto& term = monitor.terms[t]; term.op == reflective::Op::condition) {
        const Truth is = supervisor.condition(term.condition);
        conditions.push_back(fmt::format("{}: {}", term_text(tables, monitor.terms, t),
                                         name_of(reflective::negated(monitor.terms, t) ? !is : is)));
      }
    text += fmt::format("  to {} by {}{}, now {} ({})\n", to, monitor.name,
                        monitor.lasting.count() > 0 ? " for " + words::to_text(monitor.lasting) : "",
                        name_of(supervisor.monitor(transition.monitor)), joined(conditions));
  }
  return text;
}

Json Answers::why_json() const {
  const auto& tables = file.tables;
  Json past = Json::array();
  for (const auto& change : changes) {
    Json from;
    if (change.from != none) from = tables.configurations[change.from].name;
    past.push_back({{"time_ns", std::to_string(change.wall.time_since_epoch().count())},
                    {"from", from},
                    {"to", tables.configurations[change.to].name},
                    {"cause", change.cause},
                    {"conditions", change.conditions}});
  }
  Json ways = Json::array();
  for (const auto& transition : tables.transitions) {
    if (!tables.leaves(transition, supervisor.configuration())) continue;
    Json way{{"to", tables.configurations[transition.to].name}, {"cause", transition.cause}};
    if (transition.monitor == reflective::by_request) {
      way["on_request"] = true;
    } else {
      const auto& monitor = tables.monitors[transition.monitor];
      way["monitor"] = monitor.name;
      way["is"] = name_of(supervisor.monitor(transition.monitor));
      Json conditions = Json::object();
      for (const auto& term : monitor.terms)
        if (term.op == reflective::Op::condition)
          conditions[tables.conditions[term.condition].name] = name_of(supervisor.condition(term.condition));
      way["conditions"] = conditions;
    }
    ways.push_back(way);
  }
  return {{"operator", tables.name},
          {"configuration", tables.configurations[supervisor.configuration()].name},
          {"changes", past},
          {"leaves", ways}};
}

std::string Answers::ways() const {
  const auto configurations = file.tables.configurations;
  const std::uint16_t here = supervisor.configuration();
  std::string text = fmt::format("{}\n", configurations[here].name);
  for (std::uint16_t i = 0; i < configurations.size(); ++i)
    if (i != here && supervisor.leads_to(i)) text += fmt::format("{}\n", configurations[i].name);
  return text;
}

}  // namespace ocm::cli::operate
