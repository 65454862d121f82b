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

bool suits(const Accepted& accepted, ValueKind kind) {
  return kind == accepted.kind || (kind == ValueKind::number && accepted.number_too);
}

}  // namespace

Accepted accepted_words(std::vector<std::string> words) {
  std::string expected = alternatives(words);
  return {ValueKind::text, false, std::move(expected), std::move(words), {}};
}

Accepted accepted_whole(std::uint64_t least, std::uint64_t most, std::string expected) {
  const auto holds = [least, most](const std::string& text) {
    if (text.empty() || text.front() == '-') return false;
    char* end = nullptr;
    errno = 0;
    const std::uint64_t number = std::strtoull(text.c_str(), &end, 0);
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
  const std::string_view near = words::nearest(text, words);
  return Refusal{fmt::format("invalid value '{}'", text),
                 (near.empty() ? std::string{} : fmt::format("did you mean {}? ", near)) + "expected " +
                     described(accepted.expected)};
}

std::optional<Refusal> refuse_value(const Accepted& accepted, const OptionValue& value) {
  if (suits(accepted, value.kind)) {
    auto refusal = refuse_text(accepted, value.text);
    if (refusal && value.kind != ValueKind::text) refusal->what = "invalid value " + value.text;
    return refusal;
  }
  const bool in_quotes = value.kind == ValueKind::text;
  return Refusal{in_quotes ? fmt::format("invalid value '{}'", value.text) : "invalid value " + value.text,
                 fmt::format("expected {}, {} quotes", described(accepted.expected),
                             accepted.kind == ValueKind::text ? "in" : "without")};
}

}  // namespace ocm::cli
