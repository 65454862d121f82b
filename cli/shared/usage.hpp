/// How a verb is typed, in one line: for its help, its manual page and the message that a word is missing.
#pragma once

#include <string>

#include "cli/shared/arguments.hpp"

namespace ocm::cli {

/// "amiroctl publish TOPIC [PERIOD] [OPTION ...]"
[[nodiscard]] std::string usage(Verb verb);

/// A positional as usages write it: "FILE", "[VERB]", "X|stop [Z]".
[[nodiscard]] std::string positional(const Option& option);

/// The value of an option: "T", "generic|exact".
[[nodiscard]] std::string value_of(const Option& option);

/// An option or a positional, as messages name it: "--count", "FILE".
[[nodiscard]] std::string written(const Option& option);

}  // namespace ocm::cli
