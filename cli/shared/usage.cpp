#include "cli/shared/usage.hpp"

#include <algorithm>

namespace ocm::cli {

std::string positional(const Option& option) {
  if (const std::string words = option.usage(); !words.empty()) return words;
  std::string word = option.type();
  if (word.starts_with('[')) return word;
  if (word.empty() || word == "TEXT") word = option.name();
  return option.is_required() ? word : "[" + word + "]";
}

std::string value_of(const Option& option) {
  const std::string type = option.type();  // "T", "N:0.001 to 1000", "WHICH:{sensors,commands}"
  const auto open = type.find('{');
  if (open == std::string::npos) return type.substr(0, type.find(':'));
  std::string words = type.substr(open + 1, type.find('}', open) - open - 1);
  std::replace(words.begin(), words.end(), ',', '|');
  return words;
}

std::string written(const Option& option) {
  if (!option.is_positional()) return option.name();
  const std::string words = positional(option);
  return words.ends_with(" ...") ? words.substr(0, words.size() - 4) : words;
}

std::string usage(Verb verb) {
  if (!verb.parent()) return verb.name() + " [OPTION ...] VERB ...";
  Verb root = verb;
  while (root.parent()) root = root.parent();
  std::string text = root.name() + " " + verb.path();
  std::string inner;
  for (const Verb each : verb.verbs()) inner += (inner.empty() ? " " : "|") + each.name();
  if (!inner.empty()) return text + inner + " ...";
  const auto options = verb.options();
  for (const Option& option : options)
    if (option.is_positional()) text += " " + positional(option);
  const bool any = std::any_of(options.begin(), options.end(), [](const Option& o) { return o.is_option(); });
  return any ? text + " [OPTION ...]" : text;
}

}  // namespace ocm::cli
