/// Options that no command line has to repeat: from the environment, else from a file. An option on the
/// command line goes before AMIROCTL_OPTION in the environment, and that before the file.
///
/// The file is TOML; a key is an option's long name. What stands before the first
/// table is for every verb that has the option, [listen] for that verb alone:
///
///     bus = "can0"
///     priority = "high"
///
///     [listen]
///     pretty = true
#pragma once

#include <string>

#include "cli/shared/arguments.hpp"

namespace ocm::cli {

/// $XDG_CONFIG_HOME/amiroctl/config.toml, or ~/.config/amiroctl/config.toml; empty without a home.
[[nodiscard]] std::string default_config_file();

/// Gives to the options of `program` and of the verb that was called what the environment and the file say,
/// where the command line said nothing. The file of `file` must be there; without a name the default one need
/// not. Leaves with exit_usage and file, line and remedy when the file is wrong.
void apply_config(Verb app, const std::string& file);

}  // namespace ocm::cli
