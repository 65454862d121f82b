#include "cli/shared/config.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <optional>
#include <poll.h>
#include <set>
#include <string_view>
#include <unistd.h>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "ocm/host/descriptor.hpp"

#include "cli/shared/config_check.hpp"
#include "cli/shared/config_file.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/option_value.hpp"
#include "cli/words/suggestion.hpp"

namespace ocm::cli {
namespace {

constexpr std::size_t max_config_bytes = 100'000;

/// The program and the verb that was called, from the outermost on.
std::vector<Verb> called(Verb program) {
  std::vector<Verb> verbs{program};
  while (const Verb inner = verbs.back().called()) verbs.push_back(inner);
  return verbs;
}

[[noreturn]] void leave(const std::string& file, const std::vector<ConfigProblem>& problems) {
  for (const auto& problem : problems)
    complain({fmt::format("{}:{}: {}", file, problem.line, problem.what), problem.remedy});
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
      // A name of an earlier version may mean something else in other verbs by now.
      const bool may_be_another = option.is_former("--" + key);
      // --wait, or --wait 2s: true is the option without a value, as in the file.
      const bool bare = option.most_values() > 0 && option.least_values() == 0;
      const std::string_view truth{value};
      if (bare && truth == "false") {
        option.decline();
        break;
      }
      if (bare && truth == "true") {
        if (const auto misuse = option.give(key, {}))
          fail({fmt::format("{}={}", name, misuse->what), misuse->remedy + ", or unset it"}, exit_usage);
        break;
      }
      // `refuse` gives the value to the option, to have its words; what is not for it must not reach it.
      if (may_be_another && refuse_text(option.accepted(), value)) break;
      const auto refusal = refuse(option, std::string{value});
      if (refusal) fail({fmt::format("{}={}", name, refusal->what), refusal->remedy}, exit_usage);
      if (const auto misuse = option.give(key, {value}); misuse && !may_be_another)
        fail({fmt::format("{}={}", name, misuse->what), misuse->remedy + ", or unset it"}, exit_usage);
      break;
    }
  }
}

/// A variable that sets nothing is most often a misspelt one.
void remark_unknown_environment(Verb program, const std::vector<Verb>& called) {
  constexpr std::string_view prefix = "AMIROCTL_";
  const auto variable_of = [&](const std::string& key) {
    return environment_name(key).substr(prefix.size());
  };
  std::set<std::string> known{"CONFIG"};
  for (const Verb verb : called)
    for (const Option& option : verb.options())
      if (can_be_set(option))
        for (const std::string& key : option.long_names()) known.insert(variable_of(key));
  bool all_known = false;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view variable{*entry};
    if (!variable.starts_with(prefix)) continue;
    const std::string name{variable.substr(prefix.size(), variable.find('=') - prefix.size())};
    if (known.count(name) == 0 && !std::exchange(all_known, true))  // other verbs are declared for this only
      for (const Settable& each : all_settable(program)) known.insert(variable_of(each.key));
    if (known.count(name) != 0) continue;
    const std::string_view near = words::nearest(name, known);
    remark(fmt::format("{}{} in the environment sets no option{}", prefix, name,
                       near.empty() ? "" : fmt::format("; did you mean {}{}?", prefix, near)));
  }
}

void apply_setting(Verb verb, const Setting& setting, const std::string& file) {
  for (Option option : verb.options()) {
    const auto names = option.long_names();
    if (!can_be_set(option) || std::find(names.begin(), names.end(), setting.key) == names.end()) continue;
    if (option.is_decided()) continue;
    // Only above all tables: another verb takes it.
    if (const auto refusal = refuse(option, setting.values)) {
      if (option.is_former("--" + setting.key)) continue;  // it has another meaning in that verb by now
      leave(file, {{setting.line, fmt::format("{} {}", setting.key, refusal->what),
                    refusal->remedy + "; what is for another verb, write in its table"}});
    }
    std::vector<std::string> values;
    for (const OptionValue& value : setting.values) values.push_back(value.text);
    if (option.most_values() > 0 && setting.values.front().kind == ValueKind::truth) {
      if (values.front() == "false") {
        option.decline();
        continue;
      }
      values.clear();
    }
    if (const auto misuse = option.give(setting.key, values))
      leave(file, {{setting.line, fmt::format("{} {}", setting.key, misuse->what), misuse->remedy}});
  }
}

/// Whether something comes that can be read, or the end. A pipe to which no program writes has neither.
bool comes(int descriptor) {
  constexpr int patience_ms = 2000;
  pollfd file{descriptor, POLLIN, 0};
  return ::poll(&file, 1, patience_ms) > 0;
}

/// At most one byte more than a config file has; what is wrong, if anything is.
std::optional<std::string> read_into(std::string& text, int descriptor) {
  text.resize(max_config_bytes + 1);
  std::size_t size = 0;
  while (size < text.size()) {
    if (!comes(descriptor)) return "it is a pipe, and no program writes to it";
    const ssize_t count = ::read(descriptor, text.data() + size, text.size() - size);
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count < 0) return "it cannot be read";
    if (count == 0) break;
    size += static_cast<std::size_t>(count);
  }
  text.resize(size);
  return std::nullopt;
}

std::string read_file(const std::string& file, bool must_exist) {
  std::error_code error;
  const bool exists = std::filesystem::exists(file, error);
  if (!exists && !must_exist) return {};
  std::string text;
  // Without waiting for a writer: a pipe may never have one.
  const host::Descriptor in{::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  std::optional<std::string> problem;
  if (!in)
    problem = exists ? "it cannot be read" : "there is no such file";
  else
    problem = read_into(text, in.get());
  if (problem)
    fail({fmt::format("{}: {}", file, *problem), "--config names the config file; without it " +
                                                     default_config_file() + " is read where there is one"},
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
  remark_unknown_environment(program, verbs);
  for (const Verb each : verbs) apply_environment(each);
  const std::string path = file.empty() ? default_config_file() : file;
  if (path.empty()) return;
  ConfigFile config = parse_config(read_file(path, !file.empty()));
  if (config.settings.empty() && config.empty_tables.empty() && config.problems.empty()) return;
  const auto settable = all_settable(program);
  for (const EmptyTable& table : config.empty_tables) check_table(program, table, config.problems);
  for (const Setting& setting : config.settings) check_setting(program, setting, settable, config.problems);
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
