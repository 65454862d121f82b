/// The options of a command: what they say, as values, and how a line of a script has them among its words.
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/client/command.hpp"
#include "ocm/protocol/identifier.hpp"

#include "cli/words/quantity.hpp"
#include "cli/words/suggestion.hpp"
#include "cli/words/value.hpp"
#include "cli/words/word_error.hpp"

namespace ocm::cli::words {

/// What a command's options say, as values.
struct CommandOptions {
  std::optional<protocol::Priority> priority;  ///< none: the topic's own
  std::optional<base::Duration> lasting;       ///< of drive; none: until something else is commanded
  std::optional<base::Duration> every{};       ///< of set: sent again and again
  bool force = false;                          ///< of set: also beyond a range that is only stated
};

/// The value of --priority: a name, "normal" as the thesis also calls medium [Thesis 4.2.1], or its number in
/// the identifier, which the thesis's menus ask for [Thesis, figure 6.2]. The error's `what` goes on after
/// the text:
/// "'top' is ", "not a priority".
[[nodiscard]] inline base::Result<protocol::Priority, WordError> read_priority(std::string_view text) {
  if (const auto priority = protocol::parse_priority(text)) return *priority;
  if (text == "normal") return protocol::Priority::medium;
  if (text.size() == 1 && text[0] >= '0' && text[0] <= '3')
    return static_cast<protocol::Priority>(text[0] - '0');
  return WordError{0, "not a priority", "write urgent, high, medium or low, or 0 to 3"};
}

/// The value of --for. The error is as that of read_priority.
[[nodiscard]] inline base::Result<base::Duration, WordError> read_lasting(std::string_view text) {
  const auto lasting = parse_duration(text);
  if (lasting && lasting->count() > 0) return *lasting;
  return WordError{0, instead_of_time(text, "not a time above zero"), "write 2s, 500ms or 1min"};
}

/// The value of --every. The error is as that of read_priority.
[[nodiscard]] inline base::Result<base::Duration, WordError> read_every(std::string_view text) {
  const auto every = parse_duration(text);
  if (every && *every >= client::shortest_repeat) return *every;
  return WordError{0, instead_of_time(text, "not a time of 100us or more"), "write 10ms, 1s or 500us"};
}

/// The words of a command; the first is the verb.
using Line = std::span<const std::string_view>;

/// A line without its options, and what they say.
struct SplitLine {
  std::vector<std::string_view> words;
  std::vector<std::size_t> places;  ///< of `words` in the line
  CommandOptions options;
  /// Which words of the line are options.
  struct {
    std::size_t priority = 0;
    std::size_t lasting = 0;
    std::size_t set = 0;          ///< of the last one that goes with set only
    std::string_view set_option;  ///< its name
  } at;
};

/// As a line of a script has them: anywhere among the words, as `--for 2s` or `--for=2s`. `suggest` calls
/// what finds the option that is near to a mistyped one, or has other words.
template <class Suggest>
[[nodiscard]] base::Result<SplitLine, WordError> split_options(Line line, Suggest&& suggest) {
  SplitLine out;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (!line[i].starts_with("--")) {
      out.words.push_back(line[i]);
      out.places.push_back(i);
      continue;
    }
    const auto equals = line[i].find('=');
    const std::string_view name = line[i].substr(0, equals);
    if (line[i] == "--force") {
      out.options.force = true;
      out.at.set = i;
      out.at.set_option = name;
      continue;
    }
    constexpr std::string_view known[] = {"--priority", "--for", "--every", "--force"};
    constexpr std::string_view examples[] = {"--priority high", "--for 2s", "--every 10ms"};
    const std::size_t option = static_cast<std::size_t>(std::find(known, known + 3, name) - known);
    if (name == "--wait" || name == "--no-confirm" || name == "--dry-run")
      return WordError{i, "a line takes no " + std::string{name},
                       "leave it out: it is an option of the verb alone"};
    if (option == std::size(examples))
      return WordError{i, "unknown option " + detail::quoted(line[i].substr(0, equals)),
                       suggest([&] { return suggestion(name, known); })};
    if (equals == std::string_view::npos && i + 1 == line.size())
      return WordError{i, "missing value for " + std::string{name}, "write " + std::string{examples[option]}};
    const std::string_view text = equals == std::string_view::npos ? line[++i] : line[i].substr(equals + 1);
    const auto wrong = [&](WordError error) {
      return WordError{i, detail::quoted(text) + " is " + error.what, std::move(error.remedy)};
    };
    if (name == "--priority") {
      const auto priority = read_priority(text);
      if (!priority) return wrong(priority.error);
      out.options.priority = *priority;
      out.at.priority = i;
    } else if (name == "--for") {
      const auto lasting = read_lasting(text);
      if (!lasting) return wrong(lasting.error);
      out.options.lasting = *lasting;
      out.at.lasting = i;
    } else {
      const auto every = read_every(text);
      if (!every) return wrong(every.error);
      out.options.every = *every;
      out.at.set = i;
      out.at.set_option = name;
    }
  }
  return out;
}

}  // namespace ocm::cli::words
