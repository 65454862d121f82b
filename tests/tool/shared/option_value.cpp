// What an option takes, as a config file or the environment has it.
#include "cli/shared/option_value.hpp"

#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

namespace option_value_test {

using namespace ocm::cli;

std::string refused(const std::optional<Refusal>& refusal) {
  return refusal ? refusal->what + "; " + refusal->remedy : "taken";
}

TEST_CASE("option values: a whole number within bounds, both included") {
  const Accepted accepted = accepted_whole(2, 10, "2 to 10");
  for (const char* const text : {"2", "10", "0x0a", "+3"}) {
    CAPTURE(text);
    CHECK(refused(refuse_text(accepted, text)) == "taken");
  }
  for (const std::string text : {"1", "11", "", "-5", "2.5", "3x", "x", "18446744073709551618"}) {
    CAPTURE(text);
    CHECK(refused(refuse_text(accepted, text)) == text + ": invalid value; write 2 to 10");
  }
  // One that was too long leaves nothing behind for the next.
  CHECK(refused(refuse_text(accepted, "5")) == "taken");
  CHECK(refused(refuse_text(accepted_whole(0, UINT64_MAX, "any"), "18446744073709551615")) == "taken");
  CHECK(refused(refuse_text(accepted_whole(0, UINT64_MAX, "any"), "18446744073709551616")) != "taken");
}

TEST_CASE("option values: zeros before a number, and its sign, count for nothing") {
  for (const auto& [text, number] :
       std::vector<std::pair<std::string, std::string>>{{"10", "10"},
                                                        {"010", "10"},
                                                        {"+10", "10"},
                                                        {"+010", "10"},
                                                        {"0", "0"},
                                                        {"000", "0"},
                                                        {"+0", "0"},
                                                        // What has more than digits stays as it is.
                                                        {"", ""},
                                                        {"+", "+"},
                                                        {"++1", "++1"},
                                                        {"-010", "-010"},
                                                        {"0x0A", "0x0A"},
                                                        {"01.5", "01.5"}}) {
    CAPTURE(text);
    CHECK(without_leading_zeros(text) == number);
  }
  const Accepted accepted = accepted_whole(0, 10, "0 to 10");
  CHECK(refused(refuse_text(accepted, "010")) == "taken");
  CHECK(refused(refuse_text(accepted, "011")) == "011: invalid value; write 0 to 10");
  for (const std::string text : {"+", "++1", "0x", "/1", ":1"}) {
    CAPTURE(text);
    CHECK(refused(refuse_text(accepted, text)) == text + ": invalid value; write 0 to 10");
  }
}

TEST_CASE("option values: a number within bounds, both included") {
  const Accepted accepted = accepted_number(0.5, 4, "0.5 to 4");
  for (const char* const text : {"0.5", "4", "1e0"}) {
    CAPTURE(text);
    CHECK(refused(refuse_text(accepted, text)) == "taken");
  }
  for (const std::string text : {"0.49", "4.01", "", "1x", "nan", "x"}) {
    CAPTURE(text);
    CHECK(refused(refuse_text(accepted, text)) == text + ": invalid value; write 0.5 to 4");
  }
}

TEST_CASE("option values: one of some words, and which was meant") {
  CHECK(accepted_words({"urgent"}).expected == "urgent");
  CHECK(accepted_words({"low", "high"}).expected == "low or high");
  CHECK(accepted_words({"urgent", "high", "low"}).expected == "urgent, high or low");
  const Accepted accepted = accepted_words({"urgent", "high", "low"});
  CHECK(refused(refuse_text(accepted, "urgent")) == "taken");
  CHECK(refused(refuse_text(accepted, "low")) == "taken");
  CHECK(refused(refuse_text(accepted, "hihg")) == "hihg: unknown value; did you mean 'high'?");
  CHECK(refused(refuse_text(accepted, "7")) == "7: unknown value; one of: urgent, high, low");
}

TEST_CASE("option values: how a value is written in a config file counts there") {
  const Accepted text{ValueKind::text, false, "", {}, {}}, rate{ValueKind::text, true, "a rate", {}, {}};
  const Accepted number = accepted_whole(1, 3, "1 to 3"), truth = accepted_truth();
  CHECK(refused(refuse_value(text, {"can0", ValueKind::text})) == "taken");
  CHECK(refused(refuse_value(text, {"5", ValueKind::number})) == "5: not a text; write a text, in quotes");
  CHECK(refused(refuse_value(rate, {"500k", ValueKind::text})) == "taken");
  CHECK(refused(refuse_value(rate, {"125000", ValueKind::number})) == "taken");
  CHECK(refused(refuse_value(rate, {"true", ValueKind::truth})) ==
        "true: not a text; write a rate, in quotes");
  CHECK(refused(refuse_value(number, {"3", ValueKind::number})) == "taken");
  CHECK(refused(refuse_value(number, {"4", ValueKind::number})) == "4: invalid value; write 1 to 3");
  CHECK(refused(refuse_value(number, {"3", ValueKind::text})) ==
        "'3': not a number; write 1 to 3, without quotes");
  CHECK(refused(refuse_value(truth, {"true", ValueKind::truth})) == "taken");
  CHECK(refused(refuse_value(truth, {"1", ValueKind::number})) ==
        "1: neither true nor false; write true or false, without quotes");
  CHECK(quotes(text) == ", in quotes");
  CHECK(quotes(truth) == ", without quotes");
}

}  // namespace option_value_test
