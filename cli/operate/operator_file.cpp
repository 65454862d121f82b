#include "cli/operate/operator_file.hpp"

#include <utility>

#include "ocm/reflective/check.hpp"
#include "ocm/reflective/monitor.hpp"

#include "cli/operate/configuration_reader.hpp"
#include "cli/operate/mistakes.hpp"
#include "cli/operate/monitor_reader.hpp"
#include "cli/operate/value_reader.hpp"
#include "generator/spec/file.hpp"
#include "generator/spec/json.hpp"
#include "generator/spec/schema.hpp"

namespace ocm::cli::operate {
namespace {

using reflective::none;
using spec::At;
using spec::Kind;

constexpr spec::Document document{.what = "an operator",
                                  .members =
                                      "name, initial, fall_back, settle, reaction, handling, "
                                      "configurations, monitors and transitions",
                                  .schema = "operator.schema.json",
                                  .levels = 16};
constexpr std::size_t max_operator_bytes = 1'000'000;

class OperatorReader : private ValueReader {
 public:
  explicit OperatorReader(const Reading& reading)
      : ValueReader(reading), reading_(reading), file_(reading.file) {}

  void read(const spec::Node& node) {
    const At root{&node, ""};
    if (!is_object(root, "an object with " + std::string{document.members})) return;
    check_keys(root, {"$schema", "name", "description", "initial", "fall_back", "settle", "retry", "reaction",
                      "handling", "others", "configurations", "monitors", "transitions"});
    if (const auto at = require(root, "name", "what it is called")) file_.name = name(*at);
    if (const auto at = root.member("description")) file_.description = line(*at);
    file_.settle_place = place(root);
    reflective::Operator& op = file_.tables;
    op.settle = time(root, "settle", "when a change of configuration is over, such as \"50ms\"");
    if (const auto at = root.member("settle")) file_.settle_place = place(*at);
    op.reaction =
        time(root, "reaction", "the longest time from a frame to the operator's own, such as \"5ms\"");
    op.handling =
        time(root, "handling", "the longest time in which a board takes a request, such as \"1ms\"");
    if (const auto at = root.member("retry")) op.retry = duration(*at).value_or(op.retry);
    if (const auto at = root.member("others")) read_others(*at, reading_);
    if (const auto at = require(root, "configurations", "a list of at least one"))
      read_configurations(*at, reading_);
    count_others(reading_);
    if (const auto at = root.member("monitors")) read_monitors(*at, reading_);
    if (const auto at = root.member("transitions")) read_transitions(*at);
    if (const auto at = require(root, "initial", "the configuration in which it begins"))
      op.initial = configuration(*at);
    if (const auto at = require(root, "fall_back", "the configuration that everything leads to"))
      op.fall_back = configuration(*at);
  }

 private:
  [[nodiscard]] std::uint16_t configuration(const At& at) {
    const auto text = word(at, "the name of a configuration");
    if (!text) return none;
    std::vector<std::string> names;
    for (std::size_t c = 0; c < file_.parts.size(); ++c) {
      names.push_back(file_.parts[c].of.text);
      if (names.back() == *text) return static_cast<std::uint16_t>(c);
    }
    unknown(at, "configuration", *text, names);
    return none;
  }

  void read_transitions(const At& at) {
    if (!is_list(at, "a list of transitions")) return;
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const At item = at.item(i);
      if (!is_object(item, R"({"from": "driving", "to": "stopped", "when": "obstacle"})")) continue;
      check_keys(item, {"from", "to", "when", "on_request", "cause", "precedence"});
      reflective::Transition transition;
      if (const auto to = require(item, "to", "a configuration")) transition.to = configuration(*to);
      std::string cause;
      const auto when = item.member("when");
      const auto on_request = item.member("on_request");
      const bool requested =
          on_request && is_kind(*on_request, Kind::boolean, "true") && on_request->node->truth;
      if (requested == when.has_value())
        tell(item, requested ? "both \"when\" and \"on_request\"" : "neither \"when\" nor \"on_request\"",
             "\"when\": a monitor, or \"on_request\": true");
      if (when) {
        transition.monitor = monitor(*when);
        cause = when->node->text;
      } else {
        cause = "on request";
      }
      if (const auto text = item.member("cause")) cause = line(*text, false);
      if (const auto of = item.member("precedence"))
        transition.precedence = static_cast<std::uint8_t>(integer(*of, 0, 255).value_or(0));
      const auto add = [&] {
        file_.transitions.push_back(transition);
        file_.transition_items.push_back({cause, place(item)});
      };
      const auto from = item.member("from");
      if (from && from->node->is(Kind::array)) {
        for (std::size_t k = 0; k < from->node->items.size(); ++k) {
          transition.from = configuration(from->item(k));
          add();
        }
        if (from->node->items.empty()) tell(*from, "an empty list", "configurations, or no \"from\" for any");
        continue;
      }
      if (from) transition.from = configuration(*from);
      add();
    }
  }
  [[nodiscard]] std::uint16_t monitor(const At& at) {
    const auto text = word(at, "the name of a monitor");
    if (!text) return none;
    std::vector<std::string> names;
    for (std::size_t m = 0; m < file_.monitor_items.size(); ++m) {
      names.push_back(file_.monitor_items[m].text);
      if (names.back() == *text) return static_cast<std::uint16_t>(m);
    }
    unknown(at, "monitor", *text, names);
    return none;
  }

  const Reading& reading_;
  OperatorFile& file_;
};

/// Once all is there: the views.
void close(OperatorFile& file, const protocol::Catalogue& catalogue) {
  for (const OperatorFile::Parts& parts : file.parts)
    file.configurations.push_back(
        {parts.of.text, parts.streams, parts.limits, parts.entry, parts.adaptations, parts.others});
  for (std::size_t c = 0; c < file.conditions.size(); ++c)
    file.conditions[c].name = file.condition_items[c].text;
  for (std::size_t m = 0; m < file.monitors.size(); ++m) {
    file.monitors[m].name = file.monitor_items[m].text;
    file.monitors[m].terms = file.terms[m];
  }
  for (std::size_t t = 0; t < file.transitions.size(); ++t)
    file.transitions[t].cause = file.transition_items[t].text;
  file.tables.name = file.name;
  file.tables.catalogue = &catalogue;
  file.tables.configurations = file.configurations;
  file.tables.conditions = file.conditions;
  file.tables.monitors = file.monitors;
  file.tables.transitions = file.transitions;
  file.tables.others = file.others;
}

}  // namespace

Loaded parse(std::string_view text, std::string_view file_name, const protocol::Catalogue& catalogue,
             std::uint32_t bit_rate) {
  static const spec::Schema schema{schema_text(), document};
  Loaded loaded;
  auto& problems = loaded.problems;
  const spec::Node root = spec::parse_json(text, file_name, problems, document);
  if (!spec::has_document(problems)) return loaded;
  auto file = std::make_unique<OperatorFile>();
  OperatorReader{{file_name, problems, catalogue, bit_rate, *file}}.read(root);
  schema.validate(root, file_name, problems);
  if (problems.empty()) {
    close(*file, catalogue);
    report_mistakes(*file, file_name, problems);
    if (problems.empty() && !reflective::fits(file->tables, room))
      problems.push_back({std::string{file_name} + ":1: /", "it is too large",
                          "at most " + std::to_string(room.conditions) + " conditions, " +
                              std::to_string(room.monitors) + " monitors, and in a configuration " +
                              std::to_string(room.streams) + " streams, " + std::to_string(room.entry) +
                              " set points, " + std::to_string(room.limits) + " limits and " +
                              std::to_string(room.adaptations) + " adaptations"});
  }
  spec::sort_by_line(problems, file_name);
  if (problems.empty()) loaded.file = std::move(file);
  return loaded;
}

Loaded load(const std::string& file, const protocol::Catalogue& catalogue, std::uint32_t bit_rate) {
  Loaded loaded;
  const auto text = spec::read_document(file, "an operator", "examples/guard.operator.json", loaded.problems,
                                        max_operator_bytes);
  return text ? parse(*text, file, catalogue, bit_rate) : std::move(loaded);
}

std::string term_text(const reflective::Operator& tables, std::span<const reflective::Term> terms,
                      std::size_t index) {
  const std::string_view negation = reflective::negated(terms, index) ? "not " : "";
  return std::string{negation}.append(tables.conditions[terms[index].condition].name);
}

}  // namespace ocm::cli::operate
