#include "cli/shared/option_value.hpp"

#include <cerrno>
#include <cstdlib>
#include <utility>

#include <fmt/format.h>

#include "cli/words/suggestion.hpp"

namespace ocm::cli {
namespace {

/// "urgent, high, medium or low".
std::string alternatives(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  return text;
}

std::string described(const std::string& expected) {
  return expected.empty() ? "a text" : expected;
}

std::string_view not_of(ValueKind kind) {
  return kind == ValueKind::text     ? "not a text"
         : kind == ValueKind::number ? "not a number"
                                     : "neither true nor false";
}

}  // namespace

bool suits(const Accepted& accepted, ValueKind kind) {
  return kind == accepted.kind || (kind == ValueKind::number && accepted.number_too);
}

std::string_view quotes(const Accepted& accepted) {
  return accepted.kind == ValueKind::text ? ", in quotes" : ", without quotes";
}

Accepted accepted_words(std::vector<std::string> words) {
  std::string expected = alternatives(words);
  return {ValueKind::text, false, std::move(expected), std::move(words), {}};
}

std::string without_leading_zeros(const std::string& text) {
  const std::size_t begin = text.starts_with('+') ? 1 : 0;
  if (begin == text.size() || text.find_first_not_of("0123456789", begin) != std::string::npos) return text;
  const auto first = text.find_first_not_of('0', begin);
  return first == std::string::npos ? "0" : text.substr(first);
}

Accepted accepted_whole(std::uint64_t least, std::uint64_t most, std::string expected) {
  const auto holds = [least, most](const std::string& text) {
    if (text.empty() || (text.front() != '+' && (text.front() < '0' || text.front() > '9'))) return false;
    const std::string digits = without_leading_zeros(text);
    char* end = nullptr;
    errno = 0;
    const std::uint64_t number = std::strtoull(digits.c_str(), &end, 0);
    return errno == 0 && *end == '\0' && number >= least && number <= most;
  };
  return {ValueKind::number, false, std::move(expected), {}, holds};
}

Accepted accepted_number(double least, double most, std::string expected) {
  const auto holds = [least, most](const std::string& text) {
    char* end = nullptr;
    const double number = std::strtod(text.c_str(), &end);
    return !text.empty() && *end == '\0' && number >= least && number <= most;
  };
  return {ValueKind::number, false, std::move(expected), {}, holds};
}

Accepted accepted_truth() {
  return {ValueKind::truth, false, "true or false", {}, {}};
}

std::optional<Refusal> refuse_text(const Accepted& accepted, const std::string& text) {
  const auto& words = accepted.words;
  bool good = !accepted.holds || accepted.holds(text);
  if (!words.empty()) {
    good = false;
    for (const std::string& word : words) good = good || word == text;
  }
  if (good) return std::nullopt;
  if (!words.empty())
    return Refusal{text + ": unknown value",
                   words::suggestion(text, std::vector<std::string_view>(words.begin(), words.end()))};
  return Refusal{text + ": invalid value", "write " + described(accepted.expected)};
}

std::optional<Refusal> refuse_value(const Accepted& accepted, const OptionValue& value) {
  if (suits(accepted, value.kind)) return refuse_text(accepted, value.text);
  const char* const quote = value.kind == ValueKind::text ? "'" : "";
  return Refusal{fmt::format("{0}{1}{0}: {2}", quote, value.text, not_of(accepted.kind)),
                 fmt::format("write {}{}", described(accepted.expected), quotes(accepted))};
}

}  // namespace ocm::cli
