#include "cli/shared/config.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include <fmt/format.h>

#include "cli/shared/config_file.hpp"
#include "cli/shared/messages.hpp"
#include "generator/spec/names.hpp"

namespace ocm::cli {
namespace {

constexpr std::size_t max_config_bytes = 100'000;

bool can_be_set(const Option& option) {
  static const std::set<std::string> never{"help", "version", "config", "words", "all"};
  const auto names = option.long_names();
  return option.is_option() && !names.empty() && never.count(names.front()) == 0;
}

/// The program and the verb that was called, from the outermost on.
std::vector<Verb> called(Verb program) {
  std::vector<Verb> verbs{program};
  while (const Verb inner = verbs.back().called()) verbs.push_back(inner);
  return verbs;
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

void collect_keys(Verb verb, bool inner_too, std::set<std::string>& keys) {
  for (const Option& option : verb.options())
    if (can_be_set(option))
      for (auto& name : option.long_names()) keys.insert(std::move(name));
  if (!inner_too) return;
  for (const Verb inner : verb.verbs()) collect_keys(inner, true, keys);
}

std::set<std::string> verb_names(Verb program) {
  std::set<std::string> names;
  for (const Verb verb : program.verbs()) names.insert(verb.name());
  return names;
}

std::string suggestion(const std::string& typed, const std::set<std::string>& known) {
  const std::string near = spec::nearest_name(typed, known);
  return near.empty() ? "a key is the long name of an option, without --; `amiroctl VERB --help` lists them"
                      : fmt::format("did you mean {}?", near);
}

/// What is wrong with the names of a setting, if anything is.
void check_names(Verb program, const Setting& setting, std::vector<ConfigProblem>& problems) {
  const Verb table = find_table(program, setting.table);
  if (!table) {
    problems.push_back({setting.line, fmt::format("[{}] is no verb", setting.table),
                        suggestion(setting.table, verb_names(program))});
    return;
  }
  std::set<std::string> keys;
  collect_keys(table, setting.table.empty(), keys);
  if (keys.count(setting.key) == 0)
    problems.push_back(
        {setting.line, fmt::format("unknown key {}", setting.key), suggestion(setting.key, keys)});
}

[[noreturn]] void leave(const std::string& file, const std::vector<ConfigProblem>& problems) {
  for (const auto& problem : problems)
    fmt::print(stderr, "amiroctl: {}:{}: {}\n          {}\n", file, problem.line, problem.what,
               problem.remedy);
  throw Exit{exit_usage};
}

std::string environment_name(const std::string& key) {
  std::string name = "AMIROCTL_";
  for (const char c : key)
    name += c == '-' ? '_' : c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return name;
}

void apply_environment(Verb verb) {
  for (Option option : verb.options()) {
    if (!can_be_set(option) || option.is_decided()) continue;
    for (const std::string& key : option.long_names()) {
      const std::string name = environment_name(key);
      const char* value = std::getenv(name.c_str());
      if (value == nullptr || *value == '\0') continue;
      try {
        option.give(key, {value});
      } catch (const BadValue& error) {
        fail({fmt::format("{}={}: {}", name, value, error.what()), "see `amiroctl VERB --help`, or unset it"},
             exit_usage);
      }
      break;
    }
  }
}

void apply_setting(Verb verb, const Setting& setting, const std::string& file) {
  for (Option option : verb.options()) {
    const auto names = option.long_names();
    if (!can_be_set(option) || std::find(names.begin(), names.end(), setting.key) == names.end()) continue;
    if (option.is_decided()) continue;
    try {
      option.give(setting.key, setting.values);
    } catch (const BadValue& error) {
      leave(file,
            {{setting.line, fmt::format("{}: {}", setting.key, error.what()), "see `amiroctl VERB --help`"}});
    }
  }
}

std::string read_file(const std::string& file, bool must_exist) {
  std::error_code error;
  const bool exists = std::filesystem::exists(file, error);
  if (!exists && !must_exist) return {};
  std::ifstream in{file, std::ios::binary};
  std::string text(max_config_bytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (in.bad() || (text.empty() && !in.eof()))
    fail({fmt::format("{}: {}", file, exists ? "it cannot be read" : "there is no such file"),
          "--config names the config file; without it " + default_config_file() +
              " is read where there is one"},
         exit_usage);
  if (text.size() > max_config_bytes)
    fail({fmt::format("{}: larger than {} bytes", file, max_config_bytes), "a config file is smaller"},
         exit_usage);
  return text;
}

}  // namespace

std::string default_config_file() {
  const auto from = [](const char* name) {
    const char* value = std::getenv(name);
    return std::string{value == nullptr ? "" : value};
  };
  std::string folder = from("XDG_CONFIG_HOME");
  if (folder.empty() && !from("HOME").empty()) folder = from("HOME") + "/.config";
  return folder.empty() ? folder : folder + "/amiroctl/config.toml";
}

void apply_config(Verb program, const std::string& file) {
  const auto verbs = called(program);
  for (const Verb each : verbs) apply_environment(each);
  const std::string path = file.empty() ? default_config_file() : file;
  if (path.empty()) return;
  ConfigFile config = parse_config(read_file(path, !file.empty()));
  for (const Setting& setting : config.settings) check_names(program, setting, config.problems);
  if (!config.problems.empty()) {
    std::stable_sort(config.problems.begin(), config.problems.end(),
                     [](const auto& a, const auto& b) { return a.line < b.line; });
    leave(path, config.problems);
  }
  // Of a verb's own table before what is for all; the later of two equal keys finds the option decided.
  for (const bool own : {true, false})
    for (const Setting& setting : config.settings)
      for (const Verb each : verbs)
        if (setting.table.empty() != own && (!own || find_table(program, setting.table) == each))
          apply_setting(each, setting, path);
}

}  // namespace ocm::cli
