#include "cli/words/topics.hpp"

#include <algorithm>
#include <array>
#include <string>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

namespace tool_words_topics_test {

using namespace ocm;
using namespace ocm::cli::words;
using protocol::Kind;

constexpr protocol::FrameLayout layout(protocol::Address::By by, bool extended, std::uint32_t number) {
  protocol::FrameLayout layout;
  layout.length = 8;
  layout.address = {by, extended, number};
  return layout;
}
using By = protocol::Address::By;
constexpr std::array layouts{layout(By::identifier, true, 0x100),  layout(By::identifier, false, 0x100),
                             layout(By::identifier, true, 0x1234), layout(By::identifier, true, 0x1234),
                             layout(By::pgn, true, 0x18FEF100),    layout(By::identifier, false, 0xFF),
                             layout(By::identifier, false, 0x7E)};

constexpr protocol::Topic topic(std::string_view name, Kind kind, std::uint8_t id,
                                std::span<const protocol::FrameLayout> frames = {}) {
  protocol::Topic topic;
  topic.name = name;
  topic.kind = kind;
  topic.id = protocol::TopicId{id};
  topic.frames = frames;
  return topic;
}
constexpr protocol::Topic message(std::string_view name, std::size_t which) {
  return topic(name, Kind::message, 0, {&layouts[which], 1});
}
constexpr std::array topics{topic("first", Kind::sensor, 0x00),
                            topic("last", Kind::sensor, 0xFF),
                            topic("lamp", Kind::actuator, 0x10),
                            message("long", 0),
                            message("short", 1),
                            message("one", 2),
                            message("other", 3),
                            message("group", 4),
                            message("hidden", 5),
                            message("low", 6)};
constexpr protocol::Catalogue catalogue{"any", 500'000, {}, topics};

std::string found(std::string_view word) {
  const auto* const topic = find_topic(catalogue, word);
  return topic == nullptr ? "" : std::string{topic->name};
}

TEST_CASE("topics are found by name, and by number with its 0x") {
  CHECK(found("lamp") == "lamp");
  CHECK(found("0x10") == "lamp");
  CHECK(found("0X10") == "lamp");
  CHECK(found("0x0") == "first");
  CHECK(found("0xff") == "last");  // before the message of this identifier
  CHECK(found("0x7E") == "low");
  CHECK(found("10").empty());
  CHECK(found("0x").empty());
  CHECK(found("0xG").empty());
  CHECK(found("0x11").empty());
  CHECK(find_topic(amiro::catalogue, "gyro")->name == "gyroscope");
}

TEST_CASE("messages are found by identifier, those of 11 bits first, and then the first of them") {
  CHECK(found("0x100") == "short");
  CHECK(found("0x1234") == "one");
  CHECK(found("0x18FEF100").empty());  // one of many identifiers of its group
  CHECK(found("0x1235").empty());
}

TEST_CASE("an empty word is no group, although topics may be in none") {
  protocol::Topic light = topics[2];
  CHECK_FALSE(is_in_group(light, ""));
  light.group = "lights";
  CHECK(is_in_group(light, "lights"));
  CHECK_FALSE(is_in_group(light, "light"));
  CHECK_FALSE(is_in_group(light, ""));
}

TEST_CASE("topics of one kind, by names and aliases") {
  const auto has = [](const std::vector<std::string_view>& words, std::string_view word) {
    return std::find(words.begin(), words.end(), word) != words.end();
  };
  const auto all = topic_words(amiro::catalogue);
  for (const char* const word : {"gyroscope", "gyro", "motors"}) CHECK(has(all, word));
  const auto sensors = topic_words(amiro::catalogue, Kind::sensor);
  CHECK(has(sensors, "gyro"));
  CHECK_FALSE(has(sensors, "motors"));
  CHECK(topic_words(catalogue, Kind::actuator) == std::vector<std::string_view>{"lamp"});
}

TEST_CASE("a field is said to be one, of at most three topics") {
  CHECK(whose_field(amiro::catalogue, "sensor_4") ==
        "it is a field of floor_proximity: floor_proximity.sensor_4");
  CHECK(whose_field(amiro::catalogue, "proximity") ==
        "it is a field of proximity_ring: proximity_ring.sensor_1.proximity");
  CHECK(whose_field(amiro::catalogue, "y") ==
        "it is a field of odometry, gyroscope, accelerometer: odometry.pose.y");
  CHECK(whose_field(amiro::catalogue, "x") ==
        "it is a field of odometry, gyroscope, accelerometer and 1 more: odometry.velocity.x");
  CHECK(whose_field(amiro::catalogue, "red") == "it is a field of led_1, led_2, led_3 and 5 more: led_1.red");
  CHECK(whose_field(amiro::catalogue, "colour").empty());
}

TEST_CASE("a number without its 0x is one in hexadecimal, or in decimal") {
  CHECK(topic_suggestion(amiro::catalogue, "gyro.z") ==
        "the topic is 'gyroscope'; listen and decode show one of its fields with --field gyro.z");
  CHECK(topic_suggestion(amiro::catalogue, "odom.pose.x") ==
        "the topic is 'odometry'; listen and decode show one of its fields with --field odom.pose.x");
  CHECK_THAT(topic_suggestion(amiro::catalogue, "gyro.nonsense.z"), Catch::StartsWith("one of: "));
  CHECK_THAT(topic_suggestion(amiro::catalogue, "gyro.z", Kind::actuator), Catch::StartsWith("one of: "));
  CHECK_THAT(topic_suggestion(amiro::catalogue, "gyro.nothing"), Catch::StartsWith("one of: "));
  CHECK(topic_suggestion(amiro::catalogue, "1f") == "did you mean '0x1F' (proximity_ring)?");
  CHECK(topic_suggestion(amiro::catalogue, "30") == "did you mean '0x1E' (power_status)?");
  CHECK(topic_suggestion(amiro::catalogue, "1") == "did you mean '0x01' (motors)?");
  CHECK_THAT(topic_suggestion(amiro::catalogue, "1", Kind::sensor), Catch::StartsWith("one of: odometry, "));
  CHECK(topic_suggestion(catalogue, "0") == "did you mean '0x00' (first)?");
  CHECK(topic_suggestion(catalogue, "ff") == "did you mean '0xFF' (last)?");
  CHECK(topic_suggestion(catalogue, "255") == "did you mean '0xFF' (last)?");
  CHECK(topic_suggestion(catalogue, "100") == "it is the identifier of a request to first");
  for (const char* const beyond : {"256", "800"})
    CHECK_THAT(topic_suggestion(catalogue, beyond), Catch::StartsWith("one of: first, last, lamp"));
}

TEST_CASE("what is no topic may be a field, a near name, or one of a spec that has none") {
  CHECK(topic_suggestion(amiro::catalogue, "sensor_4") ==
        "it is a field of floor_proximity: floor_proximity.sensor_4");
  CHECK(topic_suggestion(amiro::catalogue, "gyr", Kind::sensor) == "did you mean 'gyro'?");
  CHECK(topic_suggestion(catalogue, "lapm") == "did you mean 'lamp'?");
  CHECK_THAT(topic_suggestion(catalogue, "lapm", Kind::sensor), Catch::StartsWith("one of: first, last"));
  CHECK(topic_suggestion({"bare", 500'000, {}, {}}, "x") ==
        "the spec has none: --spec or AMIROCTL_SPEC names another");
}

}  // namespace tool_words_topics_test
