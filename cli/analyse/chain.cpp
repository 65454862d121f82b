#include "cli/analyse/chain.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>

#include <fmt/format.h>

#include "ocm/analysis/task_response.hpp"

#include "cli/output/csv_cell.hpp"
#include "cli/shared/json.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::analyse {
namespace {

using analysis::Explained;

/// One processor or bus of the chain, whose jitters grow while the chain is bounded.
struct Place {
  bool is_bus = false;
  std::vector<std::string> names;
  std::vector<analysis::Task> tasks;
  BusModel bus;
};

Place place_of(const std::string& name, const std::string& path, const BusOptions& options,
               const protocol::Catalogue& catalogue, const spec::Model* model,
               const std::vector<Rate>& rates) {
  Place place;
  if (name != "robot" && is_task_set(path)) {
    for (TaskEntry& entry : read_tasks(path).entries) {
      place.names.push_back(std::move(entry.name));
      place.tasks.push_back(entry.task);
    }
    return place;
  }
  BusOptions how = options;
  if (name == "robot") how.lengths = Lengths::exact;
  const BusSet set = name == "robot" ? robot_bus(catalogue, model, rates) : read_bus(path);
  place.is_bus = true;
  place.bus = model_of(set, at_rates_of(set, how));
  for (const BusEntry& entry : set.entries) place.names.push_back(entry.name);
  return place;
}

std::string why(const ChainStudy& study) {
  const auto& bound = study.bound;
  const std::string hop = bound.hop < study.entries.size() ? study.entries[bound.hop].name : "";
  if (bound.latency == analysis::unbounded)
    return fmt::format("{}{}{}", bound.reason == analysis::Reason::too_long ? "" : "no bound: ",
                       hop.empty() ? "" : hop + ": ", analysis::describe(bound.reason));
  const auto& slowest = study.hops[bound.hop];
  std::string text =
      fmt::format("{} takes the longest: {}", hop, time_text(slowest.waits + slowest.responds));
  if (slowest.waits > 0) text += fmt::format(", {} of it until it looks", time_text(slowest.waits));
  if (study.deadline != analysis::unbounded)
    text = fmt::format("{} {} its deadline; {}", time_text(std::abs(study.deadline - bound.age)),
                       bound.ok() ? "before" : "after", text);
  return text;
}

}  // namespace

ChainStudy study_chain(const std::string& file, std::int64_t deadline, const BusOptions& options,
                       const protocol::Catalogue& catalogue, const spec::Model* model,
                       const std::vector<Rate>& rates) {
  ChainStudy study;
  study.entries = read_chain(file);
  study.deadline = deadline;
  const auto is_on_robot = [](const HopEntry& entry) { return entry.set == "robot"; };
  if (!rates.empty() && std::none_of(study.entries.begin(), study.entries.end(), is_on_robot))
    stop_at({{rates.front().place, fmt::format("no hop of {} is on the robot's bus, which it changes", file),
              "the period in the set's file, or a hop of the set 'robot'"}},
            file);
  std::map<std::string, Place> places;
  std::vector<std::size_t> members;
  std::vector<Mistake> mistakes;
  const auto folder = std::filesystem::path{file}.parent_path();
  for (const HopEntry& entry : study.entries) {
    analysis::Hop hop;
    hop.activation = entry.sampled ? analysis::Activation::sampled : analysis::Activation::triggered;
    hop.period = entry.period;
    hop.best = entry.best;
    std::size_t member = 0;
    if (!entry.set.empty()) {
      if (!places.contains(entry.set))
        places.emplace(entry.set,
                       place_of(entry.set, (folder / entry.set).string(), options, catalogue, model, rates));
      const Place& place = places.at(entry.set);
      member = static_cast<std::size_t>(std::find(place.names.begin(), place.names.end(), entry.name) -
                                        place.names.begin());
      if (member == place.names.size()) {
        mistakes.push_back({fmt::format("{}:{}", file, entry.line),
                            fmt::format("'{}' is not in {}", entry.name, entry.set),
                            "a name as that set has it; a topic's frame is topic.frame"});
      } else {
        hop.period = place.is_bus ? place.bus.messages[member].period : place.tasks[member].period;
        hop.jitter = place.is_bus ? place.bus.messages[member].jitter : place.tasks[member].jitter;
      }
    }
    members.push_back(member);
    study.hops.push_back(hop);
  }
  stop_at(mistakes, file);

  const auto analysis = std::make_unique<analysis::CanResponse<most_messages>>();
  study.bound = analysis::bound_chain(study.hops, deadline, [&](std::size_t i, std::int64_t jitter) {
    const HopEntry& entry = study.entries[i];
    if (entry.set.empty()) {
      // Given, not analysed: its response time counts from its activation, whenever that is.
      Explained given;
      const auto response = analysis::Checked{entry.response} + (entry.sampled ? 0 : jitter);
      given.response = response.value_or(analysis::unbounded);
      given.reason = response.ok() ? analysis::Reason::schedulable : analysis::Reason::too_long;
      return given;
    }
    Place& place = places.at(entry.set);
    if (!place.is_bus) {
      place.tasks[members[i]].jitter = jitter;
      return analysis::response_time(place.tasks, members[i]);
    }
    place.bus.messages[members[i]].jitter = jitter;
    return analysis->analyse(place.bus.messages, place.bus.bus, options.test)[members[i]];
  });
  return study;
}

std::string to_json(const ChainStudy& study) {
  const bool bounded = study.bound.latency != analysis::unbounded;
  Json hops = Json::array();
  for (std::size_t i = 0; i < study.hops.size(); ++i) {
    const auto& hop = study.hops[i];
    hops.push_back({{"name", study.entries[i].name},
                    {"activation", study.entries[i].sampled ? "sampled" : "triggered"},
                    {"waits_ns", bounded ? Json(hop.waits) : Json(nullptr)},
                    {"responds_ns", bounded ? Json(hop.responds) : Json(nullptr)},
                    {"until_ns", bounded ? Json(hop.until) : Json(nullptr)}});
  }
  const Json object{
      {"latency_ns", bounded ? Json(study.bound.latency) : Json(nullptr)},
      {"shortest_ns", bounded ? Json(study.bound.shortest) : Json(nullptr)},
      {"age_ns", bounded ? Json(study.bound.age) : Json(nullptr)},
      {"deadline_ns", study.deadline != analysis::unbounded ? Json(study.deadline) : Json(nullptr)},
      {"schedulable", study.bound.ok()},
      {"hops", hops},
      {"why", why(study)}};
  return object.lines();
}

std::string to_csv(const ChainStudy& study) {
  const bool bounded = study.bound.latency != analysis::unbounded;
  const auto cell = [bounded](std::int64_t ns) { return bounded ? fmt::format("{}", ns) : std::string{}; };
  std::string text = "hop,activation,waits_ns,responds_ns,until_ns\n";
  for (std::size_t i = 0; i < study.hops.size(); ++i) {
    const auto& hop = study.hops[i];
    text += fmt::format("{},{},{},{},{}\n", csv_cell(study.entries[i].name),
                        study.entries[i].sampled ? "sampled" : "triggered", cell(hop.waits),
                        cell(hop.responds), cell(hop.until));
  }
  return text;
}

std::string to_table(const ChainStudy& study) {
  const bool bounded = study.bound.latency != analysis::unbounded;
  std::size_t width = 3;
  std::size_t set_width = 3;
  for (const auto& entry : study.entries) {
    width = std::max(width, entry.name.size());
    set_width = std::max(set_width, entry.set.size());
  }
  constexpr auto line = "{:<{}}  {:<{}}  {:<10}  {:>12}  {:>12}  {:>12}  {:>12}\n";
  std::string text = fmt::format(fmt::runtime(line), "HOP", width, "SET", set_width, "ACTIVATION", "JITTER",
                                 "WAITS", "RESPONDS", "UNTIL");
  for (std::size_t i = 0; i < study.hops.size(); ++i) {
    const auto& hop = study.hops[i];
    const auto& entry = study.entries[i];
    text += fmt::format(fmt::runtime(line), entry.name, width, entry.set.empty() ? "-" : entry.set, set_width,
                        entry.sampled ? "sampled" : "triggered", bounded ? time_text(hop.inherited) : "-",
                        bounded ? time_text(hop.waits) : "-", bounded ? time_text(hop.responds) : "-",
                        bounded ? time_text(hop.until) : "-");
  }
  text += "\n";
  if (bounded)
    text += fmt::format(
        "From the sensor's release to the end of the last hop: {} to {}. From an event to the end of "
        "the reaction: {} at most.\n",
        time_text(study.bound.shortest), time_text(study.bound.latency), time_text(study.bound.age));
  return text + "  " + why(study) + "\n";
}

}  // namespace ocm::cli::analyse
