#include "cli/operate/mistakes.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "ocm/reflective/check.hpp"

#include "cli/words/value.hpp"
#include "generator/spec/node_reader.hpp"

namespace ocm::cli::operate {
namespace {

using reflective::none;
using reflective::Op;

class Judge {
 public:
  Judge(const OperatorFile& file, std::string_view file_name, std::vector<spec::Problem>& problems)
      : file_(file), file_name_(file_name), problems_(problems) {}

  void operator()(const reflective::Finding& finding) {
    problems_.push_back({place_of(finding), what(finding), remedy(finding)});
  }

 private:
  using Mistake = reflective::Mistake;
  using Part = reflective::Part;

  [[nodiscard]] std::string place_of(const reflective::Finding& f) const {
    switch (f.part) {
      case Part::whole:
        break;
      case Part::configuration:
        return file_.parts[f.where].of.place;
      case Part::stream:
        return file_.parts[f.configuration].stream_places[f.where];
      case Part::limit:
        return file_.parts[f.configuration].limit_places[f.where];
      case Part::entry:
        return file_.parts[f.configuration].entry_places[f.where];
      case Part::adaptation:
        return file_.parts[f.configuration].adaptation_places[f.where];
      case Part::condition:
        return file_.condition_items[f.where].place;
      case Part::monitor:
        return file_.monitor_items[f.where].place;
      case Part::transition:
        return file_.transition_items[f.where].place;
    }
    return std::string{file_name_} + ":1: /";
  }
  [[nodiscard]] std::string named(std::size_t configuration) const {
    return spec::quoted(file_.parts[configuration].of.text);
  }
  [[nodiscard]] std::string line_of(std::size_t transition) const {
    const std::string& place = file_.transition_items[transition].place;
    const auto from = file_name_.size() + 1;
    return "line " + place.substr(from, place.find(':', from) - from);
  }

  [[nodiscard]] std::string what(const reflective::Finding& f) const {
    switch (f.kind) {
      case Mistake::unreachable:
        return "nothing leads to " + named(f.where) + " from the initial configuration";
      case Mistake::no_way_to_fall_back:
        return "nothing leads from " + named(f.where) + " to the fall-back";
      case Mistake::both_fire:
        return "in " + named(f.configuration) + " it can fire at once with the transition of " +
               line_of(f.other) + ", which leads to " + named(file_.transitions[f.other].to);
      case Mistake::not_watched:
        return not_watched(f);
      default:
        return std::string{reflective::describe(f.kind)};
    }
  }
  /// Names a topic of the transition's monitor that its configuration does not stream. Where it leads from
  /// any: one that none of those streams, if there is one.
  [[nodiscard]] std::string not_watched(const reflective::Finding& f) const {
    const auto& tables = file_.tables;
    const bool any = f.configuration == none;
    std::vector<std::size_t> left;
    for (std::size_t c = 0; any && c < tables.configurations.size(); ++c)
      if (tables.leaves(tables.transitions[f.where], c)) left.push_back(c);
    const auto streams = [](const auto& configuration, std::uint16_t topic) {
      return std::any_of(configuration.streams.begin(), configuration.streams.end(),
                         [topic](const auto& stream) { return stream.topic == topic; });
    };
    for (const reflective::Term& term : tables.monitors[tables.transitions[f.where].monitor].terms) {
      if (term.op != Op::condition) continue;
      const std::uint16_t topic = tables.conditions[term.condition].topic;
      if (topic == none) continue;
      const bool streamed =
          any ? std::any_of(left.begin(), left.end(),
                            [&](std::size_t c) { return streams(tables.configurations[c], topic); })
              : streams(tables.configurations[f.configuration], topic);
      if (!streamed)
        return "its monitor looks at " + spec::quoted(tables.topic(topic).name) + ", which " +
               (any ? std::string{"no configuration that it leads from asks for"}
                    : named(f.configuration) + " does not ask for");
    }
    return "its monitor looks at topics that no one configuration asks for together";
  }
  [[nodiscard]] std::string remedy(const reflective::Finding& f) const {
    const auto& tables = file_.tables;
    switch (f.kind) {
      case Mistake::no_configuration:
        return "1 to 64 configurations, one of them initial, one the fall-back";
      case Mistake::bad_time:
        return "a \"settle\" above 0";
      case Mistake::name_twice:
        return "names that differ";
      case Mistake::stream_twice:
        return "leave one of the two out";
      case Mistake::bad_period:
        return "a period above 0 that a request can carry, such as \"50ms\"";
      case Mistake::limit_outside_spec:
      case Mistake::set_point_outside_spec:
        return takes_of(f);
      case Mistake::set_point_beyond_limit:
        return "a value within \"limits\" of " + named(f.configuration) + ", or a wider limit";
      case Mistake::bad_adaptation:
        return "\"from\" less than \"to\", \"period\" between \"at_from\" and \"at_to\", those a whole "
               "number of "
               "\"grain\" apart, and \"every\" not shorter than it";
      case Mistake::bad_condition:
        return "a limit above 0 and a window above 0";
      case Mistake::bad_expression:
        return "fewer conditions in one monitor";
      case Mistake::bad_transition:
        return "two different configurations";
      case Mistake::not_watched:
        return "add the stream, or limit \"from\" to configurations that have it";
      case Mistake::both_fire:
        return "give one of them another \"precedence\": the lower goes first";
      case Mistake::unreachable:
        return "add a transition to it, or leave it out";
      case Mistake::no_way_to_fall_back:
        return "add a transition to " + named(tables.fall_back) + ", such as one \"on_request\"";
      default:
        return "see docs/operator.md";
    }
  }
  [[nodiscard]] std::string takes_of(const reflective::Finding& f) const {
    const auto& parts = file_.parts[f.configuration];
    const std::uint16_t topic =
        f.part == Part::limit ? parts.limits[f.where].topic : parts.entry[f.where].topic;
    const auto& fields = file_.tables.topic(topic).frames[0].fields;
    if (f.part == Part::limit)
      return words::detail::takes(fields[parts.limits[f.where].field]) + ", min not above max";
    for (std::size_t i = 0; i < fields.size(); ++i)
      if (parts.entry[f.where].raw[i] < fields[i].raw_min || parts.entry[f.where].raw[i] > fields[i].raw_max)
        return words::detail::takes(fields[i]);
    return "values within the spec";
  }

  const OperatorFile& file_;
  std::string_view file_name_;
  std::vector<spec::Problem>& problems_;
};

}  // namespace

void report_mistakes(const OperatorFile& file, std::string_view file_name,
                     std::vector<spec::Problem>& problems) {
  Judge judge{file, file_name, problems};
  reflective::check(file.tables, judge);
}

}  // namespace ocm::cli::operate
