// What options of several verbs take: bit rates, times, priorities.
#include "cli/shared/values.hpp"

#include <string>

#include <catch2/catch.hpp>

namespace tool_shared_values_test {

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
