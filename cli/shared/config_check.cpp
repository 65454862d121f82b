#include "cli/shared/config_check.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "cli/words/suggestion.hpp"

namespace ocm::cli {
namespace {

void collect_settable(Verb verb, const std::string& table, std::vector<Settable>& settable) {
  for (const Option& option : verb.options())
    if (can_be_set(option))
      for (auto& key : option.long_names()) settable.push_back({table, option, std::move(key)});
  for (const Verb inner : verb.verbs())
    collect_settable(inner, table.empty() ? inner.name() : table + "." + inner.name(), settable);
}

std::string table_name(Verb table) {
  std::string name;
  for (; table && table.parent(); table = table.parent())
    name = table.name() + (name.empty() ? "" : "." + name);
  return name;
}

std::set<std::string> verb_names(Verb program) {
  std::set<std::string> names;
  for (const Verb verb : program.verbs()) names.insert(verb.name());
  return names;
}

std::string suggestion(const std::string& typed, const std::set<std::string>& known) {
  const std::string_view near = words::nearest(typed, known);
  return near.empty() ? "a key is the long name of an option, without --; `amiroctl VERB --help` lists them"
                      : fmt::format("did you mean {}?", near);
}

/// Of a key that is no option of its table: the tables in which it is one, or the key that was meant.
ConfigProblem misplaced(const Setting& setting, const std::string& table,
                        const std::vector<Settable>& settable) {
  std::set<std::string> keys;
  std::string tables;
  bool for_all = false;
  for (const Settable& each : settable) {
    if (each.table == table || table.empty()) keys.insert(each.key);
    if (each.key != setting.key) continue;
    for_all = for_all || each.table.empty();
    tables += (tables.empty() ? "[" : ", [") + each.table + "]";
  }
  if (for_all)
    return {setting.line, fmt::format("{} has no effect in [{}]", setting.key, setting.table),
            "it is for all verbs: write it above the first table"};
  if (!tables.empty())
    return {setting.line, fmt::format("{} has no effect in [{}]", setting.key, setting.table),
            fmt::format("write it above the first table, or in {}", tables)};
  return {setting.line, fmt::format("unknown key {}", setting.key), suggestion(setting.key, keys)};
}

ConfigProblem no_verb(Verb program, const std::string& table, std::size_t line) {
  return {line, fmt::format("[{}] is not a verb", table), suggestion(table, verb_names(program))};
}

}  // namespace

bool can_be_set(const Option& option) {
  static const std::set<std::string> never{"help", "version", "config", "words", "all"};
  const auto names = option.long_names();
  return option.is_option() && !names.empty() && never.count(names.front()) == 0;
}

Verb find_table(Verb program, std::string_view table) {
  Verb found = program;
  while (!table.empty() && found) {
    const std::string name{table.substr(0, table.find('.'))};
    Verb inner;
    for (const Verb each : found.verbs())
      if (each.is_named(name)) inner = each;
    found = inner;
    table.remove_prefix(std::min(name.size() + 1, table.size()));
  }
  return found;
}

std::vector<Settable> all_settable(Verb program) {
  std::vector<Settable> settable;
  collect_settable(program, "", settable);
  return settable;
}

void check_table(Verb program, const EmptyTable& table, std::vector<ConfigProblem>& problems) {
  if (!find_table(program, table.name)) problems.push_back(no_verb(program, table.name, table.line));
}

std::optional<Refusal> refuse(const Option& option, const std::vector<OptionValue>& values) {
  if (values.empty()) return Refusal{"an array without a value", "leave the line out"};
  if (option.most_values() <= 1 && values.size() > 1)
    return Refusal{fmt::format("{} values", values.size()), "expected one"};
  const bool bare = option.most_values() > 0 && option.least_values() == 0;  // --loop, or --loop 3
  if (bare && values.front().kind == ValueKind::truth) return std::nullopt;
  for (const OptionValue& value : values)
    if (auto refusal = refuse_value(option.accepted(), value)) return refusal;
  return std::nullopt;
}

void check_setting(Verb program, const Setting& setting, const std::vector<Settable>& settable,
                   std::vector<ConfigProblem>& problems) {
  const Verb verb = find_table(program, setting.table);
  if (!verb) {
    problems.push_back(no_verb(program, setting.table, setting.line));
    return;
  }
  const std::string table = table_name(verb);
  std::optional<Refusal> first;
  bool found = false, taken = false;
  for (const Settable& each : settable) {
    if (each.key != setting.key || (!setting.table.empty() && each.table != table)) continue;
    const auto refusal = refuse(each.option, setting.values);
    if (!found) first = refusal;
    found = true;
    taken = taken || !refusal;
  }
  if (!found)
    problems.push_back(misplaced(setting, table, settable));
  else if (!taken)
    problems.push_back({setting.line, fmt::format("{}: {}", setting.key, first->what), first->remedy});
}

}  // namespace ocm::cli
