#include "cli/operate/cautions.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "ocm/reflective/check.hpp"

#include "generator/spec/node_reader.hpp"

namespace ocm::cli::operate {
namespace {

using Parts = OperatorFile::Parts;

/// It holds for a time, ends by itself, and is no drive: a behaviour of a board.
bool is_behaviour(const protocol::Topic& topic) {
  return topic.kind == protocol::Kind::actuator && topic.role == protocol::Role::none &&
         topic.timeout.count() != 0;
}

class Permissions {
 public:
  explicit Permissions(const OperatorFile& file) : file_(file), tables_(file.tables) {
    const auto& topics = tables_.catalogue->topics;
    for (std::uint16_t t = 0; t < topics.size(); ++t)
      if (is_behaviour(topics[t])) behaviours_.push_back(t);
  }

  std::vector<spec::Problem> judge() const {
    std::vector<spec::Problem> found;
    for (std::size_t c = 0; c < file_.parts.size(); ++c) {
      const std::size_t limit = limit_of_drive(file_.parts[c]);
      if (limit == file_.parts[c].limits.size()) continue;
      begins(c, limit, found);
      goes_on(c, limit, found);
    }
    return found;
  }

 private:
  [[nodiscard]] const protocol::Topic& topic(std::uint16_t index) const { return tables_.topic(index); }
  [[nodiscard]] std::string name(std::size_t configuration) const {
    return spec::quoted(file_.parts[configuration].of.text);
  }
  [[nodiscard]] std::string names(const std::vector<std::uint16_t>& topics) const {
    std::string text;
    for (const std::uint16_t each : topics)
      text += fmt::format("{}{}", text.empty() ? "" : ", ", topic(each).name);
    return text;
  }

  [[nodiscard]] std::size_t limit_of_drive(const Parts& parts) const {
    const auto found = std::find_if(parts.limits.begin(), parts.limits.end(), [&](const auto& limit) {
      return topic(limit.topic).role == protocol::Role::drive;
    });
    return static_cast<std::size_t>(found - parts.limits.begin());
  }
  static bool is_limited(const Parts& parts, std::uint16_t topic) {
    return std::any_of(parts.limits.begin(), parts.limits.end(),
                       [topic](const auto& limit) { return limit.topic == topic; });
  }
  static const reflective::SetPoint* entry_of(const Parts& parts, std::uint16_t topic) {
    const auto found = std::find_if(parts.entry.begin(), parts.entry.end(),
                                    [topic](const auto& entry) { return entry.topic == topic; });
    return found == parts.entry.end() ? nullptr : &*found;
  }
  static bool rests(const reflective::SetPoint& set_point) {
    return std::all_of(set_point.raw.begin(), set_point.raw.end(), [](auto raw) { return raw == 0; });
  }
  /// The verbs of other programs that may begin it.
  [[nodiscard]] std::vector<std::string> who(const Parts& parts, std::uint16_t behaviour) const {
    const auto* const own = entry_of(parts, behaviour);
    if (own != nullptr && own->repeat.count() > 0) return {};  // what it repeats no other may command
    const std::string_view verb = topic(behaviour).name == "travel" ? "travel" : "behave";
    std::vector<std::string> all{std::string{verb}, "replay", "run", "set"};
    if (!parts.commanders) return all;
    std::erase_if(all, [&](const std::string& each) {
      return std::find(parts.commanders->begin(), parts.commanders->end(), each) == parts.commanders->end();
    });
    return all;
  }
  [[nodiscard]] bool may_begin(const Parts& parts, std::uint16_t behaviour) const {
    const auto* const own = entry_of(parts, behaviour);
    return (own != nullptr && !rests(*own)) || !who(parts, behaviour).empty();
  }

  void begins(std::size_t c, std::size_t limit, std::vector<spec::Problem>& found) const {
    const Parts& parts = file_.parts[c];
    std::vector<std::uint16_t> free;
    std::vector<std::string> verbs;
    bool by_itself = false;
    for (const std::uint16_t each : behaviours_) {
      const auto* const own = entry_of(parts, each);
      const bool commanded = own != nullptr && !rests(*own);
      if (is_limited(parts, each) || !may_begin(parts, each)) continue;
      free.push_back(each);
      by_itself = by_itself || commanded;
      for (const auto& verb : who(parts, each))
        if (std::find(verbs.begin(), verbs.end(), verb) == verbs.end()) verbs.push_back(verb);
    }
    if (free.empty()) return;
    std::string by;
    if (by_itself) by = "\"entry\"";
    for (const auto& verb : verbs) by += (by.empty() ? "" : ", ") + verb;
    found.push_back(
        {parts.limit_places[limit],
         fmt::format("in {} the limits of {} do not hold for what boards do by themselves: {} (by {})",
                     name(c), topic(parts.limits[limit].topic).name, names(free), by),
         fmt::format(
             R"(limit it too, such as {{"field": "{}.{}", "min": "0m/s", "max": "0m/s"}}, or leave those )"
             R"(verbs out of "commanders")",
             topic(free.front()).name, topic(free.front()).frames[0].fields.back().name)});
  }

  /// Begun where it was permitted, and longer than a drive that no program repeats.
  void goes_on(std::size_t c, std::size_t limit, std::vector<spec::Problem>& found) const {
    const Parts& parts = file_.parts[c];
    const auto& drive = topic(parts.limits[limit].topic);
    for (const std::uint16_t each : behaviours_) {
      if (topic(each).timeout <= drive.timeout) continue;
      if (const auto* const own = entry_of(parts, each); own != nullptr && rests(*own)) continue;
      for (std::size_t from = 0; from < file_.parts.size(); ++from) {
        if (from == c || !leads(from, c) || !may_begin(file_.parts[from], each)) continue;
        if (is_limited(parts, each) && is_limited(file_.parts[from], each)) continue;
        found.push_back(
            {parts.limit_places[limit],
             fmt::format("a {} that was begun in {} goes on in {}, where the limits of {} do not hold for it",
                         topic(each).name, name(from), name(c), drive.name),
             fmt::format(R"("entry": [{{"topic": "{}"}}] in {} ends it)", topic(each).name, name(c))});
        break;
      }
    }
  }
  [[nodiscard]] bool leads(std::size_t from, std::size_t to) const {
    return std::any_of(tables_.transitions.begin(), tables_.transitions.end(),
                       [&](const auto& t) { return t.to == to && tables_.leaves(t, from); });
  }

  const OperatorFile& file_;
  const reflective::Operator& tables_;
  std::vector<std::uint16_t> behaviours_;
};

/// What is not known fires nothing: values of a stream that has fallen silent lead nowhere.
class Silences {
 public:
  explicit Silences(const OperatorFile& file) : file_(file), tables_(file.tables) {}

  void judge(std::vector<spec::Problem>& found) const {
    for (std::size_t c = 0; c < file_.parts.size(); ++c) {
      if (c == tables_.fall_back) continue;
      const auto values = watched_by(c, [](Watched watched) { return watched == Watched::field; });
      const auto silences = watched_by(c, [](Watched watched) {
        return watched == Watched::age || watched == Watched::gap || watched == Watched::rate;
      });
      if (values.empty() || !silences.empty()) continue;
      const auto name_of = [this](std::size_t configuration) {
        return spec::quoted(file_.parts[configuration].of.text);
      };
      const auto silent = tables_.topic(values.front()).name;
      found.push_back(
          {file_.parts[c].of.place,
           fmt::format("nothing leads from {} to {} when {} falls silent: what is not known fires no monitor",
                       name_of(c), name_of(tables_.fall_back), silent),
           fmt::format(
               R"({{"age": "{}", "above": ...}}, some periods, beside the other conditions with "any")",
               silent)});
    }
  }

 private:
  using Watched = reflective::Watched;

  /// Topics of such conditions in what leads from a configuration to the fall-back.
  template <class Is>
  [[nodiscard]] std::vector<std::uint16_t> watched_by(std::size_t configuration, const Is& is) const {
    std::vector<std::uint16_t> topics;
    for (const auto& transition : tables_.transitions) {
      if (transition.to != tables_.fall_back || !tables_.leaves(transition, configuration)) continue;
      if (transition.monitor == reflective::by_request) continue;
      // What the configuration does not ask for it does not miss.
      if (!reflective::sees(tables_, configuration, tables_.monitors[transition.monitor])) continue;
      for (const auto& term : tables_.monitors[transition.monitor].terms)
        if (term.op == reflective::Op::condition && is(tables_.conditions[term.condition].watched))
          topics.push_back(tables_.conditions[term.condition].topic);
    }
    return topics;
  }

  const OperatorFile& file_;
  const reflective::Operator& tables_;
};

}  // namespace

std::vector<spec::Problem> cautions(const OperatorFile& file) {
  auto found = Permissions{file}.judge();
  Silences{file}.judge(found);
  return found;
}

}  // namespace ocm::cli::operate
