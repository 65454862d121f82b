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

/// As the command line says it, of names without --.
std::string suggestion(std::string_view typed, const std::set<std::string>& known, Verb verb,
                       std::string_view listed) {
  typed.remove_prefix(std::min(typed.find_first_not_of('-'), typed.size()));
  const std::string_view near = words::nearest(typed, known);
  const std::string path = verb.path();
  return near.empty()
             ? fmt::format("`amiroctl{}{} --help` lists the {}", path.empty() ? "" : " ", path, listed)
             : fmt::format("did you mean '{}'?", near);
}

/// What the command line says of a text that it refuses, too. A remedy of its own is none here.
std::optional<Refusal> as_on_the_command_line(const Option& option, const std::string& text,
                                              const Refusal& refusal) {
  const auto misuse = option.misuse_of(text);
  if (!misuse) return refusal;
  return Refusal{misuse->what,
                 misuse->remedy.find("--") == std::string::npos ? misuse->remedy : refusal.remedy};
}

/// Of a key that is no option of its table: the tables in which it is one, or the key that was meant.
ConfigProblem misplaced(const Setting& setting, Verb verb, const std::string& table,
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
  return {setting.line, fmt::format("unknown option '{}'", setting.key),
          suggestion(setting.key, keys, verb, "options")};
}

ConfigProblem no_verb(Verb program, const std::string& table, std::size_t line) {
  // The verbs of the deepest table that is one.
  Verb verb = program;
  std::string_view rest = table;
  std::string word;
  for (Verb inner = program; inner && !rest.empty();) {
    verb = inner;
    word = rest.substr(0, rest.find('.'));
    rest.remove_prefix(std::min(word.size() + 1, rest.size()));
    inner = find_table(verb, word);
  }
  std::set<std::string> names;
  for (const Verb each : verb.verbs()) names.insert(each.name());
  return {line, fmt::format("[{}]: unknown verb '{}'", table, word), suggestion(word, names, verb, "verbs")};
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

std::optional<Refusal> refuse(const Option& option, const std::string& text) {
  const auto refusal = refuse_text(option.accepted(), text);
  return refusal ? as_on_the_command_line(option, text, *refusal) : std::nullopt;
}

std::optional<Refusal> refuse(const Option& option, const std::vector<OptionValue>& values) {
  if (values.empty()) return Refusal{"is an array without a value", "leave the line out"};
  if (option.most_values() <= 1 && values.size() > 1)
    return Refusal{"is given more than once", "give it once"};
  const bool bare = option.most_values() > 0 && option.least_values() == 0;  // --loop, or --loop 3
  if (bare && values.front().kind == ValueKind::truth) return std::nullopt;
  for (const OptionValue& value : values)
    if (value.kind == ValueKind::text && value.text.empty())
      return Refusal{"is empty", "give it a value, or leave the line out"};
  for (const OptionValue& value : values)
    if (const auto refusal = refuse_value(option.accepted(), value)) {
      auto told = as_on_the_command_line(option, value.text, *refusal);
      if (!suits(option.accepted(), value.kind) && !told->remedy.ends_with("quotes"))
        told->remedy += quotes(option.accepted());
      return told;
    }
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
    problems.push_back(misplaced(setting, verb, table, settable));
  else if (!taken)
    problems.push_back({setting.line, fmt::format("{} {}", setting.key, first->what), first->remedy});
}

}  // namespace ocm::cli
