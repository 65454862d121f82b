/// What a config file says, line by line, without its meaning. toml++ reads it, in config_file.cpp alone.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "cli/shared/option_value.hpp"

namespace ocm::cli {

struct Setting {
  std::string table;                ///< "listen", "analyse.bus"; empty: every verb
  std::string key;                  ///< "idle-timeout"
  std::vector<OptionValue> values;  ///< several of an array
  std::size_t line = 0;
};

struct ConfigProblem {
  std::size_t line = 0;
  std::string what;
  std::string remedy;
};

/// A table without a key: it sets nothing, and may be misspelt all the same.
struct EmptyTable {
  std::string name;
  std::size_t line = 0;
};

struct ConfigFile {
  std::vector<Setting> settings;
  std::vector<EmptyTable> empty_tables;
  std::vector<ConfigProblem> problems;
};

/// Strings, numbers, true, false, and arrays of them. Any text is a problem at worst: what is no TOML is the
/// only one.
[[nodiscard]] ConfigFile parse_config(std::string_view text);

}  // namespace ocm::cli
