// What frames begin of what boards do by themselves. [docs/behaviours.md]
#include "cli/shared/begun_behaviours.hpp"

#include <initializer_list>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "ocm/can/text.hpp"
#include "ocm/client/command.hpp"
#include "ocm/topics/amiro.hpp"

namespace tool_begun_behaviours_test {

using namespace ocm;

/// "travel 20B#0000000000000000\n" of each that is left.
std::string left(std::initializer_list<const char*> frames) {
  cli::BegunBehaviours begun{amiro::catalogue};
  for (const char* frame : frames) begun.sent(*can::parse_frame(frame));
  std::string text;
  for (const auto& each : begun.all())
    text += fmt::format("{} {}\n", each.topic->name, can::to_text(each.end).view());
  return text;
}

TEST_CASE("behaviours that frames have begun, and what ends them", "[shared]") {
  const std::string travel = "travel 20B#0000000000000000\n";
  CHECK(left({}).empty());
  CHECK(left({"20B#50C300000000E803"}) == travel);
  CHECK(left({"20B#50C300000000E803", "20B#A086010000000100"}) == travel);
  CHECK(left({"10B#50C300000000E803"}) == "travel 10B#0000000000000000\n");  // at its priority
  CHECK(left({"20B#50C300000000E803", "20B#0000000000000000"}).empty());
  CHECK(left({"20B#50C300000000E803", "10B#0000000000000000"}).empty());
  // Neither motors, nor a light, nor what is too short, nor a request, nor an extended identifier.
  CHECK(left({"201#A086010000000000", "23C#010203", "20B#50C300", "608#000000000000",
              "0000020B#50C300000000E803"})
            .empty());
}

TEST_CASE("a frame begins a behaviour, or not", "[shared]") {
  const cli::BegunBehaviours begun{amiro::catalogue};
  const auto begins = [&begun](const char* frame) { return begun.is_begun_by(*can::parse_frame(frame)); };
  CHECK(begins("20B#50C300000000E803"));
  CHECK(begins("10B#0000000000000100"));
  for (const char* other : {"20B#0000000000000000", "201#A086010000000000", "23C#010203", "20B#50C300",
                            "608#000000000000", "0000020B#50C300000000E803"})
    CHECK_FALSE(begins(other));
}

TEST_CASE("behaviours that frames have begun, in words", "[shared]") {
  cli::BegunBehaviours begun{amiro::catalogue};
  CHECK(begun.names().empty());
  begun.sent(*can::parse_frame("20B#50C300000000E803"));
  CHECK(begun.names() == "travel was");
  const auto* const follow = amiro::catalogue.find("follow");
  REQUIRE(follow != nullptr);
  begun.sent(client::set_point(*follow, std::vector<std::int64_t>(follow->frames[0].fields.size(), 1)));
  CHECK(begun.names() == "travel, follow were");
  begun.clear();
  CHECK(begun.names().empty());
}

}  // namespace tool_begun_behaviours_test
