#include "cli/shared/config_file.hpp"

#include <toml++/toml.h>
#include <utility>

#include <fmt/format.h>

namespace ocm::cli {
namespace {

class Reader {
 public:
  explicit Reader(ConfigFile& file) : file_(file) {}

  void read(const toml::table& table, const std::string& name) {
    for (const auto& [key, node] : table) {
      // An empty name, which TOML has in quotes, is none of ours, and not that of the tables above all.
      const std::string own = key.str().empty() ? "\"\"" : std::string{key.str()};
      const std::string inner = name.empty() ? own : fmt::format("{}.{}", name, own);
      if (const auto* deeper = node.as_table()) {
        if (deeper->empty()) file_.empty_tables.push_back({inner, key.source().begin.line});
        read(*deeper, inner);
        continue;
      }
      Setting setting{name, own, {}, key.source().begin.line};
      if (read(node, setting)) file_.settings.push_back(std::move(setting));
    }
  }

 private:
  bool read(const toml::node& node, Setting& setting) {
    const auto* array = node.as_array();
    if (array == nullptr) return read_value(node, setting);
    for (const toml::node& item : *array)
      if (!read_value(item, setting)) return false;
    return true;
  }

  bool read_value(const toml::node& node, Setting& setting) {
    if (const auto* text = node.as_string())
      setting.values.push_back({text->get(), ValueKind::text});
    else if (const auto* truth = node.as_boolean())
      setting.values.push_back({truth->get() ? "true" : "false", ValueKind::truth});
    else if (const auto* whole = node.as_integer())
      setting.values.push_back({fmt::format("{}", whole->get()), ValueKind::number});
    else if (const auto* real = node.as_floating_point())
      setting.values.push_back({fmt::format("{}", real->get()), ValueKind::number});
    else
      return refuse(node, setting);
    return true;
  }

  bool refuse(const toml::node& node, const Setting& setting) {
    const char* what = node.is_array()   ? "an array within an array"
                       : node.is_table() ? "a table"
                                         : "a date or a time";
    file_.problems.push_back({node.source().begin.line,
                              fmt::format("{}: {} cannot be a value", setting.key, what),
                              "a text in quotes, a number, true, false, or an array of them"});
    return false;
  }

  ConfigFile& file_;
};

/// The first line with more points outside of texts than any option needs, from 1; 0: there is none. toml++
/// follows each part of a dotted key one call deeper, and has no limit of its own.
std::size_t too_deep(std::string_view text) {
  constexpr int most = 1000;
  std::size_t line = 1;
  int points = 0;
  char quote = 0;
  for (const char c : text) {
    if (c == '\n') {
      ++line;
      points = 0;
      quote = 0;
    } else if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '.' && ++points > most) {
      return line;
    }
  }
  return 0;
}

}  // namespace

ConfigFile parse_config(std::string_view text) {
  ConfigFile file;
  if (const auto line = too_deep(text); line != 0) {
    file.problems.push_back({line, "tables within tables, more than 1000 deep",
                             "the deepest that there is has two parts: [analyse.bus]"});
    return file;
  }
  try {
    Reader{file}.read(toml::parse(text), "");
  } catch (const toml::parse_error& error) {
    file.problems.push_back({error.source().begin.line, std::string{error.description()},
                             "a line is key = value or [verb], a text is written in quotes: bus = \"can0\""});
  }
  return file;
}

}  // namespace ocm::cli
