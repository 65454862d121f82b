#include <algorithm>

#include <fmt/format.h>

#include "ocm/client/counted.hpp"

#include "cli/operate/study.hpp"
#include "cli/shared/json.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli::operate {
namespace {

using reflective::none;

std::string percent(std::int64_t per_mille) {
  return per_mille == analysis::unbounded ? std::string{"no bound"}
                                          : fmt::format("{}.{} %", per_mille / 10, per_mille % 10);
}

/// The condition that a bound of a transition is of, as it stands in the monitor; empty: a request.
std::string watched(const Study& study, std::uint16_t transition, const reflective::Latency& latency) {
  const auto& tables = study.file->tables;
  if (latency.condition == none) return {};
  const auto terms = tables.monitors[tables.transitions[transition].monitor].terms;
  const auto term = std::find_if(terms.begin(), terms.end(), [&](const reflective::Term& each) {
    return each.op == reflective::Op::condition && each.condition == latency.condition;
  });
  return term_text(tables, terms, static_cast<std::size_t>(term - terms.begin()));
}

Json nanoseconds(std::int64_t ns) {
  return ns == analysis::unbounded ? Json(nullptr) : Json(ns);
}

std::string in_quotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '\n') {
      out += "\\n";
      continue;
    }
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

std::string names_of(const Study& study, const std::vector<std::uint16_t>& topics) {
  std::string text;
  for (const std::uint16_t topic : topics)
    text += fmt::format("{}{}", text.empty() ? "" : ", ", study.file->tables.topic(topic).name);
  return text;
}

/// The sum, one part a line.
std::string lines_of(const reflective::Latency& latency) {
  std::string text = sum_of(latency);
  for (const std::string_view sign : {" = ", " + "})
    for (std::size_t at = text.find(sign); at != std::string::npos; at = text.find(sign, at)) text[at] = '\n';
  return text;
}

/// What counts without being typed, and what cannot be counted; empty: neither.
std::string others_of(const Study& study) {
  std::string text;
  for (const auto& parts : study.file->parts) {
    std::string what;
    for (const auto& each : parts.expected)
      what += fmt::format("{}{} every {}", what.empty() ? "" : ", ",
                          study.file->tables.topic(each.topic).name, words::to_text(each.period));
    if (!what.empty()) text += fmt::format("  {}: {}\n", parts.of.text, what);
    if (!parts.uncounted.empty())
      text += fmt::format("  {}: NOT COUNTED, as no period of theirs is known: set points of {}\n",
                          parts.of.text, names_of(study, parts.uncounted));
  }
  if (text.empty()) return text;
  return "\nothers: what programs may command there, and messages of the spec, besides \"others\" of the "
         "file\n" +
         text;
}

/// When each stream is back after a reset of its board.
std::string recoveries_of(const Study& study) {
  const auto& tables = study.file->tables;
  const auto is_topic = [&](const StreamBound& stream) { return !tables.topic(stream.topic).is_message(); };
  if (std::none_of(study.configurations.begin(), study.configurations.end(), [&](const auto& each) {
        return std::any_of(each.streams.begin(), each.streams.end(), is_topic);
      }))
    return {};
  std::string text =
      "\nrecoveries: from a board that takes requests again after a reset to the end of the first sample, at "
      "most\n";
  if (tables.retry.count() <= 0)
    return text + "  never: without \"retry\" a silent stream is not asked for again\n";
  for (std::size_t c = 0; c < study.configurations.size(); ++c)
    for (const StreamBound& stream : study.configurations[c].streams) {
      if (!is_topic(stream)) continue;
      text += fmt::format("  {}: {}\n", tables.configurations[c].name, tables.topic(stream.topic).name);
      text += fmt::format("      {}\n", sum_of(stream.recovery));
    }
  return text;
}

}  // namespace

std::string to_table(const Study& study) {
  const auto& tables = study.file->tables;
  std::string text = fmt::format("operator {}: {}, {}, {}, at {} bit/s\n", tables.name,
                                 client::counted(tables.configurations.size(), "configuration"),
                                 client::counted(tables.monitors.size(), "monitor"),
                                 client::counted(tables.transitions.size(), "transition"), study.bit_rate);
  std::size_t width = std::string_view{"the start"}.size();
  for (const auto& configuration : tables.configurations) width = std::max(width, configuration.name.size());

  text +=
      "\nconfigurations: load of the bus, and the latest end of each sample, on its board and on the bus, "
      "against its deadline\n";
  for (std::size_t c = 0; c < study.configurations.size(); ++c) {
    const auto& bound = study.configurations[c];
    const auto role = c == tables.initial && c == tables.fall_back ? " (initial, fall-back)"
                      : c == tables.initial                        ? " (initial)"
                      : c == tables.fall_back                      ? " (fall-back)"
                                                                   : "";
    text +=
        fmt::format("  {:<{}}  {:>7}{}\n", tables.configurations[c].name, width, percent(bound.load), role);
    for (const StreamBound& stream : bound.streams) {
      const bool bounded = stream.response != analysis::unbounded;
      text += fmt::format("    {} every {} at {} priority: {}{}{}{}\n", tables.topic(stream.topic).name,
                          words::to_text(stream.period), name(stream.priority), milliseconds(stream.response),
                          stream.on_board == 0 || !bounded
                              ? std::string{}
                              : fmt::format(" ({} of it on its board)", milliseconds(stream.on_board)),
                          bounded ? " of " : ", its deadline is ", milliseconds(stream.deadline));
    }
  }

  text += others_of(study);
  text += fmt::format(
      "\nchanges: over before the next one may begin, {} later (settle). Asynchronous, unchanged streams go "
      "on;\n"
      "load while old and new streams overlap [Real, Crespo 2004, Real-Time Systems 26(2)]\n",
      words::to_text(tables.settle));
  for (const ChangeBound& change : study.changes)
    text += fmt::format(
        "  {:<{}} -> {:<{}}  {:>7}  over after {}\n",
        change.from == none ? std::string_view{"the start"} : tables.configurations[change.from].name, width,
        tables.configurations[change.to].name, width, percent(change.load), milliseconds(change.over_after));

  text += "\nreactions: from the event to the end of the last set point on the bus, at most\n";
  if (!study.unmeasured.empty())
    text += fmt::format("  NOT COUNTED, as the tasks of its board are not known: the sampling of {}\n",
                        names_of(study, study.unmeasured));
  for (const ReactionBound& reaction : study.reactions) {
    const auto& transition = tables.transitions[reaction.transition];
    text += fmt::format("  {}: {} -> {}\n", transition.cause, tables.configurations[reaction.from].name,
                        tables.configurations[transition.to].name);
    if (!reaction.seen) {
      text += "    never: this configuration does not ask for what the monitor looks at\n";
      continue;
    }
    const std::string_view end = reaction.commands ? "" : " (to the decision: nothing is commanded on entry)";
    const auto bound = [&](const reflective::Latency& latency) {
      if (const auto what = watched(study, reaction.transition, latency); !what.empty())
        text += fmt::format("    {}\n", what);
      text += fmt::format("      {}{}\n", sum_of(latency), end);
    };
    for (const reflective::Latency& latency : reaction.conditions) bound(latency);
    if (reaction.conditions.empty()) bound(reaction.latency);
    if (reaction.latency.bounded)
      text +=
          fmt::format("      {} while a change is under way\n", milliseconds(reaction.latency.at_worst()));
  }
  text += recoveries_of(study);
  for (const auto& caution : study.cautions)
    text += fmt::format("\nCAUTION: {}: {}\n  {}\n", caution.place, caution.what, caution.remedy);
  text += study.passes() ? "\nin time\n"
                         : fmt::format("\nNOT IN TIME: {}\n", client::counted(study.doubts.size(), "reason"));
  return text;
}

namespace {

Json name_of(const reflective::Operator& tables, std::uint16_t configuration) {
  return configuration == none ? Json(nullptr) : Json(tables.configurations[configuration].name);
}

/// What a bound is made of, each part in nanoseconds.
template <typename Bound>
Json parts_of(const Bound& bound) {
  Json parts = Json::object();
  for (const auto& part : bound.parts()) parts[part.name] = part.time;
  return parts;
}

Json json_of(const StreamBound& stream, const reflective::Operator& tables) {
  Json recovery;
  if (stream.recovery.bounded)
    recovery = {{"at_most_ns", nanoseconds(stream.recovery.total())},
                {"while_changing_ns", nanoseconds(stream.recovery.at_worst())},
                {"parts_ns", parts_of(stream.recovery)}};
  return {{"topic", tables.topic(stream.topic).name},
          {"period_ns", stream.period.count()},
          {"priority", name(stream.priority)},
          {"response_ns", nanoseconds(stream.response)},
          {"on_board_ns", stream.on_board == 0 ? Json(nullptr) : nanoseconds(stream.on_board)},
          {"deadline_ns", stream.deadline},
          {"recovery", recovery}};
}

Json json_of_configuration(const Study& study, std::size_t number) {
  const auto& tables = study.file->tables;
  const auto& parts = study.file->parts[number];
  Json streams = Json::array(), others = Json::array(), uncounted = Json::array();
  for (const StreamBound& stream : study.configurations[number].streams)
    streams.push_back(json_of(stream, tables));
  for (const auto& each : parts.expected)
    others.push_back({{"topic", tables.topic(each.topic).name},
                      {"period_ns", each.period.count()},
                      {"priority", name(each.priority)}});
  for (const std::uint16_t topic : parts.uncounted) uncounted.push_back(tables.topic(topic).name);
  return {{"name", tables.configurations[number].name},
          {"load_per_mille", nanoseconds(study.configurations[number].load)},
          {"streams", streams},
          {"others", others},
          {"not_counted", uncounted}};
}

Json json_of(const ReactionBound& reaction, const Study& study) {
  const auto& tables = study.file->tables;
  const auto& transition = tables.transitions[reaction.transition];
  const auto with_parts = [&](Json& of, const reflective::Latency& latency) {
    if (!latency.bounded) return;
    of["parts_ns"] = parts_of(latency);
    if (latency.condition != none) of["condition"] = watched(study, reaction.transition, latency);
  };
  Json object{{"cause", transition.cause},
              {"from", name_of(tables, reaction.from)},
              {"to", name_of(tables, transition.to)},
              {"on_request", transition.monitor == reflective::by_request},
              {"seen", reaction.seen},
              {"commands", reaction.commands},
              {"at_most_ns", nanoseconds(reaction.latency.total())},
              {"while_changing_ns", nanoseconds(reaction.latency.at_worst())}};
  with_parts(object, reaction.latency);
  Json conditions = Json::array();
  for (const reflective::Latency& latency : reaction.conditions) {
    Json each{{"at_most_ns", nanoseconds(latency.total())}};
    with_parts(each, latency);
    conditions.push_back(each);
  }
  if (!reaction.conditions.empty()) object["conditions"] = conditions;
  return object;
}

Json json_of(const std::vector<spec::Problem>& problems) {
  Json list = Json::array();
  for (const auto& each : problems)
    list.push_back({{"place", each.place}, {"what", each.what}, {"remedy", each.remedy}});
  return list;
}

}  // namespace

std::string to_json(const Study& study) {
  const auto& tables = study.file->tables;
  Json configurations = Json::array(), changes = Json::array(), reactions = Json::array(),
       unmeasured = Json::array();
  for (std::size_t c = 0; c < study.configurations.size(); ++c)
    configurations.push_back(json_of_configuration(study, c));
  for (const ChangeBound& change : study.changes)
    changes.push_back({{"from", name_of(tables, change.from)},
                       {"to", name_of(tables, change.to)},
                       {"over_after_ns", nanoseconds(change.over_after)},
                       {"load_per_mille", nanoseconds(change.load)}});
  for (const ReactionBound& reaction : study.reactions) reactions.push_back(json_of(reaction, study));
  for (const std::uint16_t topic : study.unmeasured) unmeasured.push_back(tables.topic(topic).name);
  const Json object{{"operator", tables.name},
                    {"bit_rate", study.bit_rate},
                    {"initial", name_of(tables, tables.initial)},
                    {"fall_back", name_of(tables, tables.fall_back)},
                    {"settle_ns", tables.settle.count()},
                    {"configurations", configurations},
                    {"changes", changes},
                    {"reactions", reactions},
                    {"sampling_not_counted", unmeasured},
                    {"in_time", study.passes()},
                    {"doubts", json_of(study.doubts)},
                    {"cautions", json_of(study.cautions)}};
  return object.lines();
}

std::string to_dot(const Study& study) {
  const auto& tables = study.file->tables;
  std::string text = fmt::format(
      "digraph {} {{\n  rankdir=LR;\n  node [fontname=\"DejaVu Sans\", fontsize=11, shape=box, "
      "style=rounded];\n"
      "  edge [fontname=\"DejaVu Sans\", fontsize=9];\n  start [shape=point, label=\"\"];\n",
      in_quotes(tables.name));
  for (std::size_t c = 0; c < study.configurations.size(); ++c) {
    const auto& configuration = tables.configurations[c];
    std::string label = std::string{configuration.name};
    label += fmt::format("\n{} of the bus", percent(study.configurations[c].load));
    for (const auto& stream : configuration.streams)
      label += fmt::format("\n{} {}", tables.topic(stream.topic).name, words::to_text(stream.period));
    text += fmt::format("  c{} [label={}{}];\n", c, in_quotes(label),
                        c == tables.fall_back ? ", peripheries=2" : "");
  }
  text += fmt::format("  start -> c{};\n", tables.initial);
  for (const ReactionBound& reaction : study.reactions) {
    if (!reaction.seen) continue;
    const auto& transition = tables.transitions[reaction.transition];
    const bool asked = transition.monitor == reflective::by_request;
    text += fmt::format("  c{} -> c{} [label={}{}];\n", reaction.from, transition.to,
                        in_quotes(fmt::format("{}\n{}", transition.cause, lines_of(reaction.latency))),
                        asked ? ", style=dashed" : "");
  }
  if (!study.unmeasured.empty())
    text +=
        fmt::format("  label={};\n  fontname=\"DejaVu Sans\";\n  fontsize=9;\n",
                    in_quotes(fmt::format("sampling not counted: {}", names_of(study, study.unmeasured))));
  return text + "}\n";
}

}  // namespace ocm::cli::operate
