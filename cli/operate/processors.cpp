#include "cli/operate/processors.hpp"

#include <algorithm>
#include <string_view>

#include "ocm/analysis/task_response.hpp"
#include "ocm/analysis/task_sets.hpp"
#include "ocm/topics/amiro.hpp"

namespace ocm::cli::operate {
namespace {

using reflective::none;
using reflective::Operator;

struct Known {
  std::string_view name;
  bool own = false;
  analysis::Task task;
};

template <class... Tasks>
std::vector<Known> known(analysis::TaskList<Tasks...>) {
  return {Known{Tasks::name, Tasks::own, Tasks::task}...};
}

/// The tasks of a board by its name; empty: not measured.
std::vector<Known> tasks_of(std::string_view board) {
  std::vector<Known> found;
  analysis::task_sets::for_each_set([&](std::string_view name, auto list) {
    if (name == board) found = known(list);
  });
  return found;
}

base::Duration shortest(const reflective::Configuration& configuration, std::size_t stream) {
  for (const auto& adaptation : configuration.adaptations)
    if (adaptation.stream == stream) return adaptation.shortest();
  return configuration.streams[stream].period;
}

/// How often a stream's period may change at most; none: never.
std::optional<base::Duration> adapted_every(const reflective::Configuration& configuration,
                                            std::size_t stream) {
  for (const auto& adaptation : configuration.adaptations)
    if (adaptation.stream == stream) return adaptation.every;
  return {};
}

class Processor {
 public:
  Processor(const Operator& tables, std::uint8_t board) : tables_(tables), board_(board) {
    const auto& catalogue = *tables.catalogue;
    known_ = tasks_of(catalogue.boards[board].name);
    for (const Known& each : known_) {
      const protocol::Topic* const topic = catalogue.find(each.name);
      if (each.own || (topic != nullptr && topic->role == protocol::Role::refusal))
        tasks_.push_back(each.task);
    }
  }

  void add(const reflective::Configuration& configuration, bool old) {
    for (std::size_t s = 0; s < configuration.streams.size(); ++s) {
      const reflective::Stream& stream = configuration.streams[s];
      const protocol::Topic& topic = tables_.topic(stream.topic);
      const auto measured = std::find_if(known_.begin(), known_.end(),
                                         [&](const Known& each) { return each.name == topic.name; });
      if (topic.is_message() || topic.board != board_ || measured == known_.end()) continue;
      analysis::Task task = measured->task;
      task.period = shortest(configuration, s).count();
      task.deadline =
          topic.deadline.count() == 0 ? task.period : std::min(task.period, topic.deadline.count());
      task.level = static_cast<std::uint32_t>(stream.priority);
      streams_.push_back({stream.topic, s, old, {}});
      places_.push_back(tasks_.size());
      tasks_.push_back(task);
      if (const auto every = adapted_every(configuration, s)) {
        task.period = every->count();
        tasks_.push_back(task);
      }
    }
  }

  void solve(std::vector<ProcessorBound>& into) {
    for (std::size_t i = 0; i < streams_.size(); ++i) {
      streams_[i].time = analysis::response_time(tasks_, places_[i]);
      into.push_back(streams_[i]);
    }
  }

 private:
  const Operator& tables_;
  std::uint8_t board_;
  std::vector<Known> known_;
  std::vector<analysis::Task> tasks_;
  std::vector<ProcessorBound> streams_;
  std::vector<std::size_t> places_;  ///< of those in tasks_
};

}  // namespace

bool is_measured(const Operator& tables, std::uint16_t topic) {
  if (tables.catalogue->robot != amiro::catalogue.robot || tables.topic(topic).is_message()) return false;
  const auto tasks = tasks_of(tables.catalogue->boards[tables.topic(topic).board].name);
  return std::any_of(tasks.begin(), tasks.end(),
                     [&](const Known& each) { return each.name == tables.topic(topic).name; });
}

std::vector<ProcessorBound> on_processors(const Operator& tables, std::uint16_t from, std::uint16_t to) {
  std::vector<ProcessorBound> all;
  if (tables.catalogue->robot != amiro::catalogue.robot) return all;
  for (std::uint8_t board = 0; board < tables.catalogue->boards.size(); ++board) {
    Processor processor{tables, board};
    const auto& target = tables.configurations[to];
    processor.add(target, false);
    if (from != none) {
      // What goes on as it is runs once.
      const auto& source = tables.configurations[from];
      std::vector<reflective::Stream> leaving;
      for (std::size_t s = 0; s < source.streams.size(); ++s) {
        auto stream = source.streams[s];
        stream.period = shortest(source, s);
        if (std::find(target.streams.begin(), target.streams.end(), stream) == target.streams.end())
          leaving.push_back(stream);
      }
      processor.add({.streams = leaving}, true);
    }
    processor.solve(all);
  }
  return all;
}

}  // namespace ocm::cli::operate
