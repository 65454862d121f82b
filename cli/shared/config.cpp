#include "cli/shared/config.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include <fmt/format.h>

#include "ocm/base/decimal.hpp"

#include "cli/shared/messages.hpp"
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

void apply_config(Verb program, const std::string& file) {
  const auto verbs = called(program);
  for (const Verb each : verbs) apply_environment(each);
  const std::string path = file.empty() ? default_config_file() : file;
  if (path.empty()) return;
  Config config = parse_config(read_file(path, !file.empty()));
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
