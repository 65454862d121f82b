/// A frame from its text, for tests: frame("208#01F40100").
#pragma once

#include <string_view>

#include <catch2/catch.hpp>

#include "ocm/can/frame.hpp"
#include "ocm/can/text.hpp"

namespace ocm::test {

inline can::Frame frame(std::string_view text) {
  const auto parsed = can::parse_frame(text);
  REQUIRE(parsed.ok());
  return *parsed;
}

}  // namespace ocm::test
