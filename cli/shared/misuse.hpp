/// What is wrong with the words of a command line, with the known word that was probably meant.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/shared/arguments.hpp"

namespace ocm::cli {

/// Of a command line that was refused because of its words, not of the value of one: unknown and missing
/// words, and options that exclude or need each other. `beginning` is the remedy if there is no verb at all.
[[nodiscard]] Misuse misuse_of_words(Verb program, const std::string& beginning);

/// Of an unknown option that is typed before the verb: one of the program, such as a misspelt --bus. Nothing:
/// there is none. `words` are those of the command line, without the program's name.
[[nodiscard]] std::optional<Misuse> misuse_before_verb(Verb program, const std::vector<std::string>& words);

/// Of a command line that ends, or goes on with another option, where the value of this one is expected.
[[nodiscard]] Misuse missing_value(Verb program, const std::string& option_name);

/// An empty word or value, as a variable of a shell leaves that is not set: verbs would take it for none.
/// Behind `--` all words are as they are meant.
[[nodiscard]] std::optional<Misuse> empty_word(const std::vector<std::string>& words);

/// Prints it with the verb that was called.
void refuse(Verb program, const Misuse& misuse);

}  // namespace ocm::cli
