// When frames contradict the spec, and in which words that is said.
#include "cli/watch/contradictions.hpp"

#include <string>
#include <string_view>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

#include "tests/tool/captured.hpp"
#include "tests/tool/clock/world.hpp"

namespace tool_clock_contradictions_test {

using namespace ocm;
using cli::Contradictions;
using cli::Seen;

std::string said(const Contradictions& found, Seen where, std::string_view beginning = {}) {
  const test::World world{1};  // a message asks whether a signal came
  test::Captured err{STDERR_FILENO};
  cli::tell_contradictions(found, amiro::catalogue, where, beginning);
  return err.text();
}

TEST_CASE("contradictions: a tenth of the frames is enough, and nothing is said of fewer") {
  CHECK(said({0, 0, 0, {}}, Seen::live).empty());
  CHECK(said({10, 0, 0, {}}, Seen::live).empty());
  CHECK(said({11, 1, 0, {}}, Seen::live).empty());
  CHECK(said({21, 1, 1, measure::WrongLength{0x605, 2, 4}}, Seen::live).empty());
  const std::string rest =
      "the others may be of another robot, too, and mean something else. --spec FILE names its topics\n";
  CHECK(said({10, 1, 0, {}}, Seen::live) ==
        "1 of 10 frames contradicts the spec of AMiRo (1 of no topic): " + rest);
  CHECK(said({10, 0, 1, measure::WrongLength{0x605, 1, 4}}, Seen::in_log, "can1: ") ==
        "can1: 1 of 10 frames contradicts the spec of AMiRo (1 of wrong length, such as 605 with 1 byte in "
        "place of 4): " +
            rest);
  CHECK(said({20, 1, 1, measure::WrongLength{0x605, 2, 4}}, Seen::live) ==
        "2 of 20 frames contradict the spec of AMiRo (1 of no topic, 1 of wrong length, such as 605 with 2 "
        "bytes in place of 4): " +
            rest);
}

TEST_CASE("contradictions: where nine of ten frames are of no topic, or none fits, it is another robot") {
  const std::string robot = "another robot? --spec FILE names the topics of another robot\n";
  CHECK(said({1, 1, 0, {}}, Seen::live) == "1 of 1 frame is of no topic of AMiRo: " + robot);
  CHECK(said({10, 9, 0, {}}, Seen::live, "can0: ") ==
        "can0: 9 of 10 frames are of no topic of AMiRo: " + robot);
  CHECK(said({10, 9, 1, measure::WrongLength{0x605, 2, 4}}, Seen::in_log) ==
        "9 of 10 frames are of no topic of AMiRo: a log of another bus? --spec FILE names the topics of "
        "another robot\n");
  CHECK_THAT(said({10, 8, 0, {}}, Seen::live),
             Catch::StartsWith("8 of 10 frames contradict the spec of AMiRo (8 of no topic): the others "));
  CHECK(said({20, 18, 0, {}}, Seen::live) == "18 of 20 frames are of no topic of AMiRo: " + robot);
  CHECK_THAT(said({20, 17, 0, {}}, Seen::live), Catch::StartsWith("17 of 20 frames contradict "));
  CHECK(said({10, 5, 5, measure::WrongLength{0x605, 2, 4}}, Seen::live) ==
        "10 of 10 frames contradict the spec of AMiRo (5 of no topic, 5 of wrong length, such as 605 with 2 "
        "bytes in place of 4): another robot? --spec FILE names its topics\n");
}

}  // namespace tool_clock_contradictions_test
