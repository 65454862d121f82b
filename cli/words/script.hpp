/// A script: one command a line, each at its time from the start.
///
///     # a comment: a '#' at the start of a line, or one with blanks around it
///     1s   publish accelerometer 500ms
///     25s  led 1 white
///     30s  set Inverter State="Limp home"
///
/// The whole text is read, and every error told, before anything is sent.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/words/command.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli::words {

struct Step {
  base::Duration at{};  ///< from the start of the script
  Command command;
  std::size_t line = 0;  ///< from 1
  std::string text;      ///< the command's words, for telling what is done
};

struct ScriptError {
  std::size_t line = 0;    ///< from 1
  std::size_t column = 0;  ///< from 1, in bytes
  std::string what;
  std::string remedy;
  friend bool operator==(const ScriptError&, const ScriptError&) = default;
};

struct Script {
  std::vector<Step> steps;
  std::vector<ScriptError> errors;  ///< when there is one, do not run the steps
};

/// Errors with a suggestion of what was meant; the remedy of the others is to correct these first. More than
/// fits on a screen is not read.
inline constexpr std::size_t most_explained = 20;

namespace detail {

/// A line's words, between blanks; what is between quotation marks belongs together, without them.
struct SplitLine {
  std::vector<std::string_view> words;    ///< of the line, or of `unquoted`
  std::vector<std::size_t> columns;       ///< from 1, in bytes
  std::size_t end = 0;                    ///< of the last word, from 0
  std::optional<std::size_t> open_quote;  ///< column of a quotation mark without a second one
  std::deque<std::string> unquoted;

  explicit SplitLine(std::string_view line) {
    for (std::size_t i = 0; i < line.size();) {
      if (line[i] == ' ' || line[i] == '\t') {
        ++i;
        continue;
      }
      const std::size_t begin = i;
      if (words.empty() && line[begin] == '#') return;
      bool quotes = false;
      for (; i < line.size() && line[i] != ' ' && line[i] != '\t'; ++i) {
        if (line[i] != '"') continue;
        const std::size_t second = line.find('"', i + 1);
        if (second == std::string_view::npos) {
          open_quote = i + 1;
          return;
        }
        quotes = true;
        i = second;
      }
      const std::string_view word = line.substr(begin, i - begin);
      // '#' opens a comment as a word of its own or, above, as a line's first character; within a word it is
      // a frame or a colour.
      if (word == "#") return;
      columns.push_back(begin + 1);
      end = i;
      if (!quotes) {
        words.push_back(word);
        continue;
      }
      auto& text = unquoted.emplace_back(word);
      std::erase(text, '"');
      words.push_back(text);
    }
  }
  SplitLine(const SplitLine&) = delete;
  SplitLine& operator=(const SplitLine&) = delete;
};

}  // namespace detail

/// Steps are in the order of their times; equal times are carried out in the order of the lines.
[[nodiscard]] inline Script parse_script(std::string_view text, const protocol::Catalogue& catalogue) {
  CommandParser parser{catalogue};
  Script script;
  std::size_t line_number = 0;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // the byte order mark of some editors
  while (!text.empty()) {
    const auto newline = text.find('\n');
    std::string_view line = text.substr(0, newline);
    text = newline == std::string_view::npos ? std::string_view{} : text.substr(newline + 1);
    ++line_number;
    if (line.ends_with('\r')) line.remove_suffix(1);

    const detail::SplitLine split{line};
    const auto& words = split.words;
    auto columns = split.columns;
    if (split.open_quote) {
      script.errors.push_back({line_number, *split.open_quote,
                               "the quotation mark that begins here has no end",
                               "put a second one behind what belongs together: State=\"Limp home\""});
      continue;
    }
    if (words.empty()) continue;

    const auto at = parse_duration(words[0]);
    if (!at || at->count() < 0) {
      script.errors.push_back({line_number, columns[0],
                               detail::quoted(words[0]) + " is not a time from the start",
                               "begin the line with one, such as 1s, 500ms or 0s"});
      continue;
    }
    if (!script.steps.empty() && *at < script.steps.back().at) {
      script.errors.push_back(
          {line_number, columns[0],
           std::string{words[0]} + " lies before the step at " + to_text(script.steps.back().at),
           "put the steps in the order of their times"});
      continue;
    }
    columns.push_back(line.size() + 1);  // behind the last word: where something is missing
    parser.set_suggesting(script.errors.size() < most_explained);
    auto command = parser.parse_line(Line{words}.subspan(1));
    if (!command) {
      const std::size_t word = std::min(command.error.word + 1, columns.size() - 1);
      script.errors.push_back({line_number, columns[word], command.error.what, command.error.remedy});
      continue;
    }
    const std::size_t begin = columns[1] - 1;  // without a second word there is no command
    const std::size_t end = split.end;
    script.steps.push_back(
        {*at, std::move(*command), line_number, std::string{line.substr(begin, end - begin)}});
  }
  if (script.steps.empty() && script.errors.empty())
    script.errors.push_back({line_number == 0 ? 1 : line_number, 1, "the script has no steps",
                             "write lines such as: 1s publish gyro 500ms"});
  return script;
}

}  // namespace ocm::cli::words
