/// What an option takes as its value, declared where the option is: so that a value from a config file or the
/// environment can be judged before any verb reads it.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ocm::cli {

/// How a value is written in a config file: in quotes, as a number, or true and false.
enum class ValueKind : std::uint8_t { text, number, truth };

struct OptionValue {
  std::string text;
  ValueKind kind = ValueKind::text;
};

struct Accepted {
  ValueKind kind = ValueKind::text;
  bool number_too = false;                        ///< a text that may also be a number: "500k", 125000
  std::string expected;                           ///< "a time such as 500ms, 2s or 1.5s"
  std::vector<std::string> words;                 ///< all that there are, for "did you mean"; empty: no list
  std::function<bool(const std::string&)> holds;  ///< empty: any
};

/// What is wrong with a value, from the value on, and what is accepted instead: "hihg: unknown value".
struct Refusal {
  std::string what;
  std::string remedy;
};

/// "10" of "010" and of "+010", which would else be read as octal, as in C++. Anything but digits stays as it
/// is.
[[nodiscard]] std::string without_leading_zeros(const std::string& text);

/// One of a list of words.
[[nodiscard]] Accepted accepted_words(std::vector<std::string> words);
/// A number within bounds, which `expected` says in words.
[[nodiscard]] Accepted accepted_whole(std::uint64_t least, std::uint64_t most, std::string expected);
[[nodiscard]] Accepted accepted_number(double least, double most, std::string expected);
/// true or false.
[[nodiscard]] Accepted accepted_truth();

/// Whether a config file may have a value that is written so.
[[nodiscard]] bool suits(const Accepted& accepted, ValueKind kind);
/// ", in quotes" or ", without quotes": behind the remedy for a value that is not written so.
[[nodiscard]] std::string_view quotes(const Accepted& accepted);
/// A value as an option's text, from the environment: quotes do not matter there.
[[nodiscard]] std::optional<Refusal> refuse_text(const Accepted& accepted, const std::string& text);
/// A value of a config file.
[[nodiscard]] std::optional<Refusal> refuse_value(const Accepted& accepted, const OptionValue& value);

}  // namespace ocm::cli
