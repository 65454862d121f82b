// The topics that words name, and which sensor is to be asked where nothing came.
#include "cli/watch/chosen_topics.hpp"

#include <initializer_list>
#include <string>
#include <string_view>
#include <unistd.h>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

#include "tests/tool/captured.hpp"
#include "tests/tool/clock/world.hpp"

namespace tool_clock_chosen_topics_test {

using namespace ocm;
using Strings = std::vector<std::string>;

/// What is said of these topics.
std::string told(std::initializer_list<std::string_view> names) {
  std::vector<const protocol::Topic*> topics;
  for (const std::string_view name : names) {
    CAPTURE(name);
    topics.push_back(amiro::catalogue.find(name));
    REQUIRE(topics.back() != nullptr);
  }
  const test::World world{1};
  test::Captured err{STDERR_FILENO};
  cli::tell_to_ask(amiro::catalogue, topics);
  return err.text();
}

std::string ask(const std::string& name) {
  return "a sensor is silent until it is asked, as by `amiroctl publish " + name + " 500ms`\n";
}

TEST_CASE(
    "chosen topics: of sensors that are silent until they are asked the first is named, and no other topic") {
  CHECK(told({}) == ask("odometry"));  // of all
  CHECK(told({"gyroscope"}) == ask("gyroscope"));
  CHECK(told({"gyroscope", "accelerometer"}) == ask("gyroscope"));
  CHECK(told({"accelerometer", "gyroscope"}) == ask("accelerometer"));
  CHECK(told({"motors"}).empty());
  CHECK(told({"motors", "led_1"}).empty());
  CHECK(told({"motors", "gyroscope", "odometry"}) == ask("gyroscope"));
  // A board sends these by itself.
  CHECK(told({"di_wheel_drive_status"}).empty());
  CHECK(told({"di_wheel_drive_refusal"}).empty());
  CHECK(told({"di_wheel_drive_refusal", "di_wheel_drive_status", "gyroscope"}) == ask("gyroscope"));
}

TEST_CASE("chosen topics: where a spec has no sensor nothing is said") {
  const protocol::Catalogue none{"car", 500'000, {}, {}};
  const test::World world{1};
  test::Captured err{STDERR_FILENO};
  cli::tell_to_ask(none, {});
  CHECK(err.text().empty());
}

Strings chosen(const Strings& words) {
  Strings names;
  for (const auto* const topic : cli::chosen_topics("listen", amiro::catalogue, words))
    names.emplace_back(topic->name);
  return names;
}

TEST_CASE("chosen topics: in the order of the words, which are names, aliases and groups") {
  CHECK(chosen({}).empty());
  CHECK(chosen({"odom", "gyroscope"}) == Strings{"odometry", "gyroscope"});
  CHECK(chosen({"gyroscope", "odom"}) == Strings{"gyroscope", "odometry"});
  CHECK(chosen({"led", "gyro"}) ==
        Strings{"led_1", "led_2", "led_3", "led_4", "led_5", "led_6", "led_7", "led_8", "gyroscope"});
}

TEST_CASE("chosen topics: a word that is none leaves, and a file's name is called one") {
  const test::World world{1};
  const auto file = test::leaving([] { static_cast<void>(chosen({"gyro", "drive.log"})); });
  CHECK(file.code == cli::exit_usage);
  CHECK(file.text ==
        "amiroctl: listen: no topic 'drive.log', which names a file\n"
        "          decode, stats and plot read logs, record -o drive.log writes one; `amiroctl list` shows "
        "the topics\n");
  const auto other = test::leaving([] { static_cast<void>(chosen({"gyroscop"})); });
  CHECK(other.code == cli::exit_usage);
  CHECK_THAT(other.text, Catch::StartsWith("amiroctl: listen: no topic 'gyroscop'\n          "));
  CHECK_THAT(other.text, Catch::Contains("did you mean 'gyroscope'?\n"));
}

}  // namespace tool_clock_chosen_topics_test
