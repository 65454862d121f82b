// What options of several verbs take: bit rates, times, priorities.
#include "cli/shared/values.hpp"

#include <cstdint>
#include <optional>
#include <string>

#include <catch2/catch.hpp>

namespace tool_shared_values_test {

using namespace ocm;
using namespace ocm::cli;

bool takes(const Accepted& accepted, const std::string& text) {
  return !refuse_text(accepted, text);
}

TEST_CASE("values: a bit rate is a whole number of bits a second, up to a million") {
  for (const char* const text :
       {"1", "999999", "1000000", "1M", "0.5M", "1000k", "500k", "500K", "83.333k", "0.001k"}) {
    CAPTURE(text);
    CHECK(takes(accepted_bit_rate(), text));
  }
  for (const char* const text : {"", "0", "-1", "1000001", "1000.001k", "1.5", "0.9", "83.3333k", "0.9999k",
                                 "1m", "1G", "500kk", "k", "M", "fast"}) {
    CAPTURE(text);
    CHECK_FALSE(takes(accepted_bit_rate(), text));
  }
}

/// What is said of the texts of an option, and how a config file may have them.
std::string said_of(const Option& option, const std::string& text) {
  const auto misuse = option.misuse_of(text);
  const bool as_text = !refuse_value(option.accepted(), {text, ValueKind::text});
  if (as_text != !misuse) return "a config file and the command line differ";
  return misuse ? misuse->what + "; " + misuse->remedy : "taken";
}

TEST_CASE("values: the bit rates that options have read, and how a config file may write them") {
  Program program{"amiroctl", "a program", "1", "", ""};
  std::optional<std::uint32_t> usual, data;
  std::uint32_t simulated = 0;
  const Option of_usual = add_bit_rate(program.root(), "--usual", usual, "classic CAN");
  const Option of_data = add_data_bit_rate(program.root(), "--data", data, "CAN FD");
  const Option of_simulated = add_simulated_bit_rate(program.root(), "--simulated", simulated, "virtual");
  struct Row {
    const char* text;
    std::uint32_t rate;
  };
  for (const Row& row :
       {Row{"1", 1}, Row{"1k", 1000}, Row{"83.333k", 83'333}, Row{"0.5M", 500'000}, Row{"1M", 1'000'000}}) {
    CAPTURE(row.text);
    CHECK(said_of(of_usual, row.text) == "taken");
    CHECK(usual == row.rate);
  }
  CHECK(said_of(of_usual, "1000001") ==
        "1000001: no bit rate of CAN; 1 to 1000000 bits a second, such as 500k or 125000");
  for (const Row& row :
       {Row{"1", 1}, Row{"2M", 2'000'000}, Row{"5000000", 5'000'000}, Row{"16M", 16'000'000}}) {
    CAPTURE(row.text);
    CHECK(said_of(of_data, row.text) == "taken");
    CHECK(data == row.rate);
  }
  CHECK(said_of(of_data, "16000001") ==
        "16000001: no bit rate of the data of CAN FD; 1 to 16000000 bits a second, such as 2M or 5000000");
  for (const Row& row :
       {Row{"1000", 1000}, Row{"1k", 1000}, Row{"2.5M", 2'500'000}, Row{"1000M", 1'000'000'000}}) {
    CAPTURE(row.text);
    CHECK(said_of(of_simulated, row.text) == "taken");
    CHECK(simulated == row.rate);
  }
  for (const std::string text : {"999", "1000000001", "1001M"}) {
    CAPTURE(text);
    CHECK(said_of(of_simulated, text) ==
          text +
              ": no bit rate of a simulated bus; 1000 to 1000000000 bits a second, such as 500k or 125000");
  }
  // With and without quotes.
  for (const Option& option : {of_usual, of_data, of_simulated}) {
    CAPTURE(option.name());
    CHECK_FALSE(refuse_value(option.accepted(), {"125000", ValueKind::number}).has_value());
    CHECK(refuse_value(option.accepted(), {"true", ValueKind::truth}).has_value());
  }
}

TEST_CASE("values: a time is zero or more, or above it, or long enough for frames to follow each other") {
  for (const char* const text : {"500ms", "2s", "1.5s", "1min", "100us"}) {
    CAPTURE(text);
    CHECK(takes(accepted_duration(), text));
    CHECK(takes(accepted_lasting(), text));
    CHECK(takes(accepted_every(), text));
  }
  for (const char* const text : {"", "5", "-1s", "soon", "2m/s"}) {
    CAPTURE(text);
    CHECK_FALSE(takes(accepted_duration(), text));
    CHECK_FALSE(takes(accepted_lasting(), text));
    CHECK_FALSE(takes(accepted_every(), text));
  }
  CHECK(takes(accepted_duration(), "0s"));
  CHECK_FALSE(takes(accepted_lasting(), "0s"));
  CHECK(takes(accepted_lasting(), "1ns"));
  CHECK_FALSE(takes(accepted_every(), "99us"));
}

TEST_CASE("values: of a mistyped word of three letters or more the near one is named") {
  Program program{"amiroctl", "a program", "1", "", ""};
  std::optional<protocol::Priority> priority;
  const Option option = add_priority(program.root(), "--priority", priority, "of a request");
  CHECK(said_of(option, "low") == "taken");
  CHECK(priority == protocol::Priority::low);
  CHECK(said_of(option, "lov") == "lov: not a priority; did you mean 'low'?");
  CHECK(said_of(option, "lo") == "lo: not a priority; write urgent, high, medium or low, or 0 to 3");
  CHECK(said_of(option, "4") == "4: not a priority; write urgent, high, medium or low, or 0 to 3");
  CHECK(priority == protocol::Priority::low);  // what is refused changes nothing
}

TEST_CASE("values: a priority by its name or number") {
  for (const char* const text : {"urgent", "high", "medium", "normal", "low", "0", "1", "2", "3"}) {
    CAPTURE(text);
    CHECK(takes(accepted_priority(), text));
  }
  for (const char* const text : {"", "4", "-1", "lowest"}) {
    CAPTURE(text);
    CHECK_FALSE(takes(accepted_priority(), text));
  }
}

}  // namespace tool_shared_values_test
