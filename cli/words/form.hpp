/// The words that each command takes: what its usage shows, and how many there may be.
#pragma once

#include <string_view>

namespace ocm::cli::words {

/// The words behind a verb, as its usage shows them: those in brackets may be missing, and ... is any number
/// more.
struct Form {
  std::string_view verb;
  std::string_view words;
};
inline constexpr Form forms[] = {{"publish", "TOPIC [PERIOD]"},
                                 {"once", "TOPIC"},
                                 {"stop", "[TOPIC|all]"},
                                 {"drive", "X|stop [Z]"},
                                 {"led", "N|all COLOUR|off"},
                                 {"set", "ACTUATOR|MESSAGE [FIELD=VALUE ...]"},
                                 {"send", "FRAME"}};

/// The words of a verb's form; empty if no command has the name.
[[nodiscard]] constexpr std::string_view form_of(std::string_view verb) noexcept {
  for (const auto& form : forms)
    if (form.verb == verb) return form.words;
  return {};
}

}  // namespace ocm::cli::words
