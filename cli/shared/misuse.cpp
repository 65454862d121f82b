#include "cli/shared/misuse.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "cli/shared/messages.hpp"
#include "cli/shared/usage.hpp"
#include "cli/words/quantity.hpp"
#include "cli/words/suggestion.hpp"
#include "generator/spec/edit_distance.hpp"

namespace ocm::cli {
namespace {

Verb innermost(Verb verb) {
  while (const Verb inner = verb.called()) verb = inner;
  return verb;
}

/// "did you mean 'listen'?", or where the known ones are listed.
std::string remedy_for(const std::string& typed, const std::vector<std::string>& known,
                       const std::string& listed) {
  const std::string_view near = words::nearest(typed, known);
  return near.empty() ? listed : fmt::format("did you mean '{}'?", near);
}

/// Those of the verb, and of those that it is a verb of, which may be meant.
std::vector<std::string> options_of(Verb verb, std::string_view typed) {
  std::vector<std::string> names;
  for (; verb; verb = verb.parent())
    for (const Option& option : verb.options())
      for (const std::string& name : option.long_names())
        if (!option.is_hidden() && !option.is_former("--" + name)) names.push_back("--" + name);
  // Which every verb has: of other short words it is the nearest by accident.
  if (spec::edit_distance(typed, "--help", 1) > 1) std::erase(names, "--help");
  return names;
}

/// How long something lasts, by the names that verbs have for it: the one that this verb has.
std::string_view same_time(std::string_view typed, const std::vector<std::string>& known) {
  constexpr std::array<std::string_view, 3> names{"--duration", "--timeout", "--for"};
  if (std::find(names.begin(), names.end(), typed) == names.end()) return {};
  for (const std::string_view name : names)
    if (std::find(known.begin(), known.end(), name) != known.end()) return name;
  return {};
}

std::string help_of(Verb program, Verb verb) {
  const std::string path = verb.path();
  return fmt::format("{}{}{} --help", program.name(), path.empty() ? "" : " ", path);
}

Misuse unknown_word(Verb program, Verb verb, const std::string& word) {
  if (word.size() > 1 && word.front() == '-') {
    const std::string name = word.substr(0, word.find('='));
    const auto known = options_of(verb, name);
    const std::string_view same = same_time(name, known);
    return {fmt::format("unknown option '{}'", name),
            !same.empty()
                ? fmt::format("did you mean '{}'?", same)
                : remedy_for(name, known, fmt::format("`{}` lists the options", help_of(program, verb)))};
  }
  if (verb.verbs().empty()) {
    std::vector<std::string> typed;
    for (const Option& option : verb.options())
      if (const auto texts = option.texts(); option.is_positional())
        typed.insert(typed.end(), texts.begin(), texts.end());
    typed.push_back(word);
    const std::string whole = words::any_apart(typed, [](std::string_view number, std::string_view unit) {
      return words::written_apart(number, unit);
    });
    return {fmt::format("unexpected argument '{}'", word),
            whole.empty() ? "usage: " + usage(verb) : "write it as one word, " + whole};
  }
  std::vector<std::string> known;
  for (const Verb each : verb.verbs_for_all()) known.push_back(each.name());
  if (verb == program) known.emplace_back("help");
  return {fmt::format("unknown verb '{}'", word),
          remedy_for(word, known, fmt::format("`{}` lists the verbs", help_of(program, verb)))};
}

/// Options that exclude each other, or of which one needs another.
std::optional<Misuse> conflict(Verb verb) {
  for (const Verb group : verb.choices()) {
    std::vector<std::string> given;
    for (const Option& option : group.options())
      if (option.count() != 0) given.push_back(written(option));
    if (given.size() > 1)
      return Misuse{fmt::format("{} and {} exclude each other", given[0], given[1]), "use one of them"};
  }
  for (const Option& option : verb.options()) {
    if (option.count() == 0) continue;
    for (const Option& other : option.excluded())
      if (other.count() != 0)
        return Misuse{fmt::format("{} and {} exclude each other", written(option), written(other)),
                      "use one of them"};
    for (const Option& other : option.needed())
      if (other.count() == 0)
        return Misuse{fmt::format("{} needs {}", option.name(), other.name()),
                      fmt::format("add {}, or drop {}", other.name(), option.name())};
  }
  return {};
}

}  // namespace

Misuse misuse_of_words(Verb program, const std::string& beginning) {
  const Verb verb = innermost(program);
  if (const auto words = program.left_over(); !words.empty())
    return unknown_word(program, verb, words.front());
  if (verb == program) return {"missing VERB", beginning};
  for (const Option& option : verb.options())
    if (option.is_required() && option.count() == 0)
      return {"missing " + written(option), "usage: " + usage(verb)};
  if (!verb.verbs().empty()) return {"missing VERB", "usage: " + usage(verb)};
  for (Verb each = verb; each; each = each.parent())
    if (const auto found = conflict(each)) return *found;
  return {"these words do not go together", "usage: " + usage(verb)};
}

std::optional<Misuse> misuse_before_verb(Verb program, const std::vector<std::string>& words) {
  const Verb verb = program.called();
  const auto left = program.left_over();
  if (!verb || left.empty() || left.front().size() < 2 || left.front().front() != '-') return {};
  for (const std::string& word : words) {
    if (word == left.front()) return unknown_word(program, program, word);
    if (verb.is_named(word)) return {};
  }
  return {};
}

std::optional<Misuse> empty_word(const std::vector<std::string>& words) {
  const auto misuse = [](std::string what) {
    return Misuse{"an empty " + what, "is a variable of the shell not set?"};
  };
  std::string_view before;
  for (const std::string_view word : words) {
    if (word == "--") return {};
    if (word.empty() && before.size() > 1 && before.front() == '-')
      return misuse(fmt::format("value for {}", before));
    if (word.empty()) return misuse(before.empty() ? "word" : fmt::format("word behind '{}'", before));
    if (word.starts_with("--") && word.find('=') == word.size() - 1)
      return misuse(fmt::format("value for {}", word.substr(0, word.size() - 1)));
    before = word;
  }
  return {};
}

Misuse missing_value(Verb program, const std::string& option_name) {
  for (Verb verb = innermost(program); verb; verb = verb.parent())
    for (const Option& option : verb.options())
      if (option.is_named(option_name))
        return {"missing value for " + option_name,
                fmt::format("usage: {} {}", option_name, value_of(option))};
  return {"missing value for " + option_name, ""};
}

void refuse(Verb program, const Misuse& misuse) {
  const std::string path = innermost(program).path();
  complain({path.empty() ? misuse.what : path + ": " + misuse.what, misuse.remedy});
}

}  // namespace ocm::cli
