#include "cli/config.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include <fmt/format.h>

#include "ocm/base/decimal.hpp"

#include "cli/session.hpp"
#include "generator/spec/names.hpp"

namespace ocm::cli {
namespace {

constexpr std::size_t max_config_bytes = 100'000;

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

void skip_blanks(std::string_view& text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
}

bool is_key_char(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || base::is_digit(c) || c == '-' || c == '_' ||
         c == '.';
}

std::string take_key(std::string_view& text) {
  std::size_t size = 0;
  while (size < text.size() && is_key_char(text[size])) ++size;
  std::string key{text.substr(0, size)};
  text.remove_prefix(size);
  skip_blanks(text);
  return key;
}

/// Reads one line. `what` and `remedy` are set where it is wrong.
class LineReader {
 public:
  LineReader(std::string_view text, std::size_t number) : text_(text), number_(number) { skip_blanks(text_); }

  void read(std::string& table, Config& config) {
    if (text_.empty() || text_.front() == '#') return;
    if (text_.front() == '[') return read_table(table, config);
    Setting setting{table, take_key(text_), {}, number_};
    if (setting.key.empty() || !take('='))
      return complain(config, "not of the form key = value", "bus = \"can0\"");
    if (take('[')) {
      while (!take(']')) {
        if (!read_value(setting, config)) return;
        if (!take(',') && (text_.empty() || text_.front() != ']'))
          return complain(config, "the array does not end on its line", "[\"gyro\", \"odom\"]");
      }
    } else if (!read_value(setting, config)) {
      return;
    }
    if (at_end(config)) config.settings.push_back(std::move(setting));
  }

 private:
  void complain(Config& config, std::string what, std::string remedy) {
    config.problems.push_back({number_, std::move(what), std::move(remedy)});
  }

  bool take(char c) {
    if (text_.empty() || text_.front() != c) return false;
    text_.remove_prefix(1);
    skip_blanks(text_);
    return true;
  }

  bool at_end(Config& config) {
    if (text_.empty() || text_.front() == '#') return true;
    complain(config, fmt::format("\"{}\" behind the value", text_), "a comment begins with #");
    return false;
  }

  void read_table(std::string& table, Config& config) {
    take('[');
    table = take_key(text_);
    if (table.empty() || !take(']')) return complain(config, "not of the form [verb]", "[listen]");
    at_end(config);
  }

  bool read_value(Setting& setting, Config& config) {
    if (!text_.empty() && (text_.front() == '"' || text_.front() == '\''))
      return read_string(setting, config);
    std::size_t size = 0;
    while (size < text_.size() && !is_blank(text_[size]) && text_[size] != ',' && text_[size] != ']' &&
           text_[size] != '#')
      ++size;
    const std::string word{text_.substr(0, size)};
    if (word != "true" && word != "false" && !base::parse_decimal(word)) {
      complain(config, word.empty() ? "no value" : word + " is neither a number nor true or false",
               fmt::format("a text stands in quotes: {} = \"{}\"", setting.key, word));
      return false;
    }
    setting.values.push_back(word);
    text_.remove_prefix(size);
    skip_blanks(text_);
    return true;
  }

  /// In double quotes \" and \\ stand for themselves; in single ones nothing is special.
  bool read_string(Setting& setting, Config& config) {
    const char quote = text_.front();
    std::string value;
    for (std::size_t i = 1; i < text_.size(); ++i) {
      if (text_[i] == quote) {
        setting.values.push_back(std::move(value));
        text_.remove_prefix(i + 1);
        skip_blanks(text_);
        return true;
      }
      if (text_[i] == '\\' && quote == '"' && i + 1 < text_.size() &&
          (text_[i + 1] == '"' || text_[i + 1] == '\\'))
        ++i;
      value += text_[i];
    }
    complain(config, "the text does not end on its line", fmt::format("a {} at its end", quote));
    return false;
  }

  std::string_view text_;
  std::size_t number_;
};

/// Options of an application without those of its verbs, and the group that each is in.
template <class F>
void for_each_option(CLI::App& app, F&& f) {
  for (CLI::Option* option : app.get_options()) f(*option, app);
  for (CLI::App* group : app.get_subcommands([](const CLI::App* each) { return each->get_name().empty(); }))
    for_each_option(*group, f);
}

bool can_be_set(const CLI::Option& option) {
  static const std::set<std::string> never{"help", "version", "config", "words", "all"};
  return option.nonpositional() && !option.get_lnames().empty() &&
         never.count(option.get_lnames().front()) == 0;
}

/// The command line, or what was applied before, has it or another in its place.
bool is_decided(const CLI::Option& option, const CLI::App& owner) {
  if (option.count() > 0) return true;
  for (const CLI::Option* other : option.get_excludes())
    if (other->count() > 0) return true;
  if (!owner.get_name().empty()) return false;
  for (const CLI::Option* other : owner.get_options())
    if (other->count() > 0) return true;
  return false;
}

/// Throws CLI::ParseError when the option does not take the values.
void give(CLI::Option& option, const std::string& key, const std::vector<std::string>& values) {
  if (option.get_items_expected_max() == 0)
    option.add_result(option.get_flag_value(key, values.empty() ? "" : values.front()));
  else
    option.add_result(values);
  option.run_callback();
}

/// The robot's options and those of the verb that was called, from the outermost on.
std::vector<CLI::App*> called(CLI::App& app) {
  std::vector<CLI::App*> apps{&app};
  for (auto inner = app.get_subcommands(); !inner.empty(); inner = apps.back()->get_subcommands()) {
    const auto verb =
        std::find_if(inner.begin(), inner.end(), [](CLI::App* each) { return !each->get_name().empty(); });
    if (verb == inner.end()) break;
    apps.push_back(*verb);
  }
  return apps;
}

CLI::App* find_table(CLI::App& app, std::string_view table) {
  CLI::App* found = &app;
  while (!table.empty() && found != nullptr) {
    const std::string name{table.substr(0, table.find('.'))};
    CLI::App* inner = nullptr;
    for (CLI::App* each : found->get_subcommands([](const CLI::App*) { return true; }))
      if (!each->get_name().empty() && each->check_name(name)) inner = each;
    found = inner;
    table.remove_prefix(std::min(name.size() + 1, table.size()));
  }
  return found;
}

void collect_keys(CLI::App& app, bool verbs_too, std::set<std::string>& keys) {
  for_each_option(app, [&](CLI::Option& option, CLI::App&) {
    if (can_be_set(option)) keys.insert(option.get_lnames().begin(), option.get_lnames().end());
  });
  if (!verbs_too) return;
  for (CLI::App* verb : app.get_subcommands([](const CLI::App* each) { return !each->get_name().empty(); }))
    collect_keys(*verb, true, keys);
}

std::set<std::string> verb_names(CLI::App& app) {
  std::set<std::string> names;
  for (CLI::App* verb : app.get_subcommands([](const CLI::App* each) { return !each->get_name().empty(); }))
    names.insert(verb->get_name());
  return names;
}

std::string suggestion(const std::string& typed, const std::set<std::string>& known) {
  const std::string near = spec::nearest_name(typed, known);
  return near.empty() ? "a key is the long name of an option, without --; `amiroctl VERB --help` lists them"
                      : fmt::format("did you mean {}?", near);
}

/// What is wrong with the names of a setting, if anything is.
void check_names(CLI::App& app, const Setting& setting, std::vector<ConfigProblem>& problems) {
  CLI::App* table = find_table(app, setting.table);
  if (table == nullptr) {
    problems.push_back({setting.line, fmt::format("[{}] is no verb", setting.table),
                        suggestion(setting.table, verb_names(app))});
    return;
  }
  std::set<std::string> keys;
  collect_keys(*table, setting.table.empty(), keys);
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

void apply_environment(CLI::App& verb) {
  for_each_option(verb, [](CLI::Option& option, const CLI::App& owner) {
    if (!can_be_set(option) || is_decided(option, owner)) return;
    for (const std::string& key : option.get_lnames()) {
      const std::string name = environment_name(key);
      const char* value = std::getenv(name.c_str());
      if (value == nullptr || *value == '\0') continue;
      try {
        give(option, key, {value});
      } catch (const CLI::ParseError& error) {
        fail({fmt::format("{}={}: {}", name, value, error.what()), "see `amiroctl VERB --help`, or unset it"},
             exit_usage);
      }
      return;
    }
  });
}

void apply_setting(CLI::App& verb, const Setting& setting, const std::string& file) {
  for_each_option(verb, [&](CLI::Option& option, const CLI::App& owner) {
    const auto& names = option.get_lnames();
    if (!can_be_set(option) || std::find(names.begin(), names.end(), setting.key) == names.end()) return;
    if (is_decided(option, owner)) return;
    try {
      give(option, setting.key, setting.values);
    } catch (const CLI::ParseError& error) {
      leave(file,
            {{setting.line, fmt::format("{}: {}", setting.key, error.what()), "see `amiroctl VERB --help`"}});
    }
  });
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

Config parse_config(std::string_view text) {
  Config config;
  std::string table;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    LineReader{text.substr(0, end), number}.read(table, config);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return config;
}

std::string default_config_file() {
  const auto from = [](const char* name) {
    const char* value = std::getenv(name);
    return std::string{value == nullptr ? "" : value};
  };
  std::string folder = from("XDG_CONFIG_HOME");
  if (folder.empty() && !from("HOME").empty()) folder = from("HOME") + "/.config";
  return folder.empty() ? folder : folder + "/amiroctl/config.toml";
}

void apply_config(CLI::App& app, const std::string& file) {
  const auto apps = called(app);
  for (CLI::App* each : apps) apply_environment(*each);
  const std::string path = file.empty() ? default_config_file() : file;
  if (path.empty()) return;
  Config config = parse_config(read_file(path, !file.empty()));
  for (const Setting& setting : config.settings) check_names(app, setting, config.problems);
  if (!config.problems.empty()) {
    std::stable_sort(config.problems.begin(), config.problems.end(),
                     [](const auto& a, const auto& b) { return a.line < b.line; });
    leave(path, config.problems);
  }
  // Of a verb's own table before what is for all; the later of two equal keys finds the option decided.
  for (const bool own : {true, false})
    for (const Setting& setting : config.settings)
      for (CLI::App* each : apps)
        if (setting.table.empty() != own && (!own || find_table(app, setting.table) == each))
          apply_setting(*each, setting, path);
}

}  // namespace ocm::cli
