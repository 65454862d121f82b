/// What is wrong with a config file: names that no option has, values that the option does not take. The
/// whole file is judged, whatever verb was called, before anything is set.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/shared/arguments.hpp"
#include "cli/shared/config_file.hpp"

namespace ocm::cli {

/// An option, and the table of the file that sets it: "" for that of the program, "analyse.bus".
struct Settable {
  std::string table;
  Option option;
  std::string key;
};

/// Whether a config file or the environment may set it.
[[nodiscard]] bool can_be_set(const Option& option);
/// Every option that can be set, under each of its names.
[[nodiscard]] std::vector<Settable> all_settable(Verb program);
/// The verb of a table, "analyse.bus"; the program for "".
[[nodiscard]] Verb find_table(Verb program, std::string_view table);

/// What is wrong with a table that sets nothing: that it is of no verb.
void check_table(Verb program, const EmptyTable& table, std::vector<ConfigProblem>& problems);

/// Why an option does not take a text, from the environment, in the words of the command line.
[[nodiscard]] std::optional<Refusal> refuse(const Option& option, const std::string& text);
/// Why an option does not take the values of a setting, in the words of the command line.
[[nodiscard]] std::optional<Refusal> refuse(const Option& option, const std::vector<OptionValue>& values);
/// What is wrong with a setting, if anything is. Above all tables it is for every verb that has the option,
/// and some verb must take its value.
void check_setting(Verb program, const Setting& setting, const std::vector<Settable>& settable,
                   std::vector<ConfigProblem>& problems);

}  // namespace ocm::cli
