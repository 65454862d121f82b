#include "cli/serve/scenes.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "ocm/topics/amiro.hpp"

namespace serve_scenes_test {

using namespace ocm;
using namespace ocm::cli::serve;
using namespace std::chrono_literals;
using Json = nlohmann::json;

/// A ring as the spec's, with round figures.
spec::Model model_with_ring() {
  spec::Model model;
  spec::TopicModel ring;
  ring.name = "proximity_ring";
  ring.geometry = spec::RingGeometry{{5, -2}, {2, 0}, {-5, -1}};  // 0.05 2 -0.5
  model.topics.push_back(ring);
  return model;
}

const protocol::Topic& topic_of(protocol::Role role) {
  for (const protocol::Topic& topic : amiro::catalogue.topics)
    if (topic.role == role) return topic;
  FAIL("the catalogue has no such role");
  return amiro::catalogue.topics[0];
}

/// Takes samples, and keeps what is made of them, by topic.
struct Shown {
  explicit Shown(std::vector<std::string> interfaces = {"can0"})
      : scenes(amiro::catalogue, model, interfaces, first) {}

  void take(const protocol::Topic& topic, const std::vector<std::uint8_t>& bytes, std::size_t interface = 0) {
    const client::Sample sample{&topic, protocol::default_priority, base::Time{1'700'000'000s + 5ns}, bytes};
    scenes.take(
        sample, interface, [this](std::uint32_t) { return wanted; },
        [this](const Scenes::Message& message) {
          const auto& channel = scenes.channels().at(message.channel - first);
          CHECK(channel.id == message.channel);
          newest[channel.topic] = Json::parse(message.payload);
        });
  }

  static constexpr std::uint32_t first = 40;
  spec::Model model = model_with_ring();
  Scenes scenes;
  bool wanted = true;
  std::map<std::string, Json> newest;
};

/// Of a ring: each sensor's counts, in frames of eight bytes.
std::vector<std::uint8_t> counts(const std::vector<unsigned>& each) {
  std::vector<std::uint8_t> bytes(8 * each.size());
  for (std::size_t i = 0; i < each.size(); ++i) {
    bytes[8 * i] = static_cast<std::uint8_t>(each[i]);
    bytes[8 * i + 1] = static_cast<std::uint8_t>(each[i] >> 8);
  }
  return bytes;
}

TEST_CASE("serve: a pose is one of Foxglove's, and a transform of the robot's frame") {
  Shown shown;
  // x 1000 and y -1000 times 0.256 mm, and a quarter turn: 6136 times 0.256 mrad.
  std::vector<std::uint8_t> bytes(16);
  const std::vector<std::uint8_t> pose{0xE8, 0x03, 0x00, 0x18, 0xFC, 0xFF, 0xF8, 0x17};
  std::copy(pose.begin(), pose.end(), bytes.begin() + 8);
  shown.take(topic_of(protocol::Role::pose), bytes);
  REQUIRE(shown.newest.contains("/odometry/pose"));
  const Json& in_frame = shown.newest["/odometry/pose"];
  CHECK(in_frame["timestamp"] == Json{{"sec", 1'700'000'000}, {"nsec", 5}});
  CHECK(in_frame["frame_id"] == "odom");
  CHECK(in_frame["pose"]["position"]["x"].get<double>() == Approx(0.256));
  CHECK(in_frame["pose"]["position"]["y"].get<double>() == Approx(-0.256));
  CHECK(in_frame["pose"]["orientation"]["z"].get<double>() == Approx(std::sin(6136 * 0.000256 / 2)));
  CHECK(in_frame["pose"]["orientation"]["w"].get<double>() == Approx(std::cos(6136 * 0.000256 / 2)));
  const Json& transform = shown.newest["/odometry/transform"];
  CHECK(transform["parent_frame_id"] == "odom");
  CHECK(transform["child_frame_id"] == "base_link");
  CHECK(transform["translation"] == in_frame["pose"]["position"]);
  CHECK(transform["rotation"] == in_frame["pose"]["orientation"]);
}

/// The offsets of the spec, which are what the sensors see where nothing is.
std::vector<unsigned> offsets() {
  std::vector<unsigned> all;
  for (const protocol::FrameLayout& frame : topic_of(protocol::Role::ring).frames)
    for (const protocol::Field& field : frame.values())
      if (field.is_derived() && !field.uncertainty)
        all.push_back(static_cast<unsigned>(field.law->offset.as_double()));
  REQUIRE(all.size() == 8);
  return all;
}
std::vector<unsigned> above(std::vector<unsigned> counts, unsigned each) {
  for (unsigned& count : counts) count += each;
  return counts;
}

TEST_CASE("serve: a ring is a scan around the robot's frame") {
  Shown shown;
  const protocol::Topic& ring = topic_of(protocol::Role::ring);
  shown.take(ring, counts(offsets()));  // nothing in sight
  std::vector<unsigned> seen = offsets();
  seen[2] += 100;  // by 0.9427 / d^2: 0.0971 m
  seen[3] += 20;   // 0.217 m, beyond the range
  seen[4] -= 100;  // below the offset
  shown.take(ring, counts(seen));
  const Json& scan = shown.newest["/proximity_ring/scan"];
  CHECK(scan["frame_id"] == "base_link");
  CHECK(scan["start_angle"].get<double>() == Approx(2));
  CHECK(scan["end_angle"].get<double>() == Approx(2 - 7 * 0.5));
  REQUIRE(scan["ranges"].size() == 8);
  for (std::size_t i = 0; i < 8; ++i)
    CHECK(scan["ranges"][i].get<double>() ==
          Approx(i == 2 ? 0.14709 : 0).margin(1e-4));  // from the robot's middle
  CHECK(scan["intensities"][2].get<double>() == Approx(100));
  CHECK(scan["intensities"][4].get<double>() == Approx(0));
}

TEST_CASE("serve: a ring of one sensor ends where it begins") {
  protocol::Topic ring = topic_of(protocol::Role::ring);
  ring.frames = ring.frames.first(1);
  const protocol::Catalogue catalogue{"one", 500'000, amiro::catalogue.boards, {&ring, 1}};
  Scenes scenes{catalogue, model_with_ring(), std::vector<std::string>{"can0"}, 0};
  const std::vector<std::uint8_t> bytes = counts({offsets()[0]});
  std::vector<Json> scans;
  scenes.take(
      client::Sample{&ring, protocol::default_priority, base::Time{1s}, bytes}, 0,
      [](std::uint32_t) { return true; },
      [&](const Scenes::Message& message) { scans.push_back(Json::parse(message.payload)); });
  REQUIRE(scans.size() == 1);
  CHECK(scans[0]["start_angle"].get<double>() == Approx(2));
  CHECK(scans[0]["end_angle"].get<double>() == Approx(2));
  CHECK(scans[0]["ranges"].size() == 1);
}

TEST_CASE("serve: offsets are the least of averages, are learnt unseen, and are forgotten with the log") {
  Shown shown;
  const protocol::Topic& ring = topic_of(protocol::Role::ring);
  shown.wanted = false;
  for (int i = 0; i < 8; ++i) shown.take(ring, counts(offsets()));
  CHECK(shown.newest.empty());
  shown.wanted = true;
  const auto range = [&](unsigned all) {
    shown.take(ring, counts(above(offsets(), all)));
    return shown.newest["/proximity_ring/scan"]["ranges"][0];
  };
  CHECK(range(100).get<double>() == Approx(0.14709).margin(1e-4));
  CHECK(range(0U - 100) == 0);  // noise of one sample moves no offset far:
  CHECK(range(100).get<double>() == Approx(0.05 + 0.1).margin(0.012));  // of eight it is an eighth
  shown.scenes.forget();
  CHECK(range(100).is_null());  // of a log from its beginning
}

TEST_CASE("serve: what was before a ring from the beginning is no offset") {
  Shown shown;
  const protocol::Topic& ring = topic_of(protocol::Role::ring);
  std::vector<unsigned> seen = offsets();
  seen[1] += 23;   // what an obstacle at the end of the range adds, 0.9427 / 0.2^2 = 23.6, is an offset still
  seen[2] += 24;   // not known
  seen[3] += 150;  // as much as offsets differ, 2420 - 2269 = 151: not known
  seen[4] += 152;  // more than that is an obstacle, 0.0788 m by the spec's offset
  seen[5] += 48'000;  // the robot touches it: 0.0044 m
  const auto take = [&] {
    shown.take(ring, counts(seen));
    return shown.newest["/proximity_ring/scan"]["ranges"];
  };
  for (int i = 0; i < 20; ++i) {  // however long it stays there
    const Json ranges = take();
    CHECK(ranges[0] == 0);
    CHECK(ranges[1] == 0);
    CHECK(ranges[2].is_null());
    CHECK(ranges[3].is_null());
    CHECK(ranges[4].get<double>() == Approx(0.05 + 0.0788).margin(1e-4));
    CHECK(ranges[5].get<double>() == Approx(0.05 + 0.0044).margin(1e-4));
  }
  CHECK(shown.newest["/proximity_ring/scan"]["intensities"][5].get<double>() == Approx(48'000));
  const std::vector<unsigned> before = seen;
  seen = offsets();
  for (int i = 0; i < 8; ++i) take();  // it has gone: the eight samples of an average are all without it
  seen = before;
  const Json ranges = take();
  CHECK(ranges[2].get<double>() == Approx(0.05 + 0.1982).margin(1e-4));
  CHECK(ranges[3].get<double>() == Approx(0.05 + 0.0793).margin(1e-4));
  CHECK(ranges[5].get<double>() == Approx(0.05 + 0.0044).margin(1e-4));
}

TEST_CASE("serve: what came last on a scene's channel") {
  Shown shown;
  shown.wanted = false;
  for (std::uint32_t channel = Shown::first - 1; channel < Shown::first + 4; ++channel)
    CHECK_FALSE(shown.scenes.newest(channel));
  shown.take(topic_of(protocol::Role::ring), counts(offsets()));
  shown.take(topic_of(protocol::Role::pose), std::vector<std::uint8_t>(16));
  std::size_t count = 0;
  for (const auto& channel : shown.scenes.channels()) {
    const auto newest = shown.scenes.newest(channel.id);
    REQUIRE(newest);
    CHECK(newest->channel == channel.id);
    CHECK(newest->time == base::Time{1'700'000'000s + 5ns});
    const Json json = Json::parse(newest->payload);
    CHECK(json.contains("ranges") == (channel.schema_name == "foxglove.LaserScan"));
    CHECK(json.contains("parent_frame_id") == (channel.schema_name == "foxglove.FrameTransform"));
    ++count;
  }
  CHECK(count == 3);
  shown.scenes.forget();
  for (const auto& channel : shown.scenes.channels()) CHECK_FALSE(shown.scenes.newest(channel.id));
}

TEST_CASE("serve: what has no role, and interfaces") {
  Shown shown{{"can0", "can1"}};
  std::vector<std::string> names;
  for (const auto& channel : shown.scenes.channels()) names.push_back(channel.topic);
  CHECK(names == std::vector<std::string>{"/can0/odometry/pose", "/can0/odometry/transform",
                                          "/can0/proximity_ring/scan", "/can1/odometry/pose",
                                          "/can1/odometry/transform", "/can1/proximity_ring/scan"});
  shown.take(topic_of(protocol::Role::pose), std::vector<std::uint8_t>(16), 1);
  CHECK(shown.newest["/can1/odometry/transform"]["child_frame_id"] == "can1/base_link");
  CHECK_FALSE(shown.newest.contains("/can0/odometry/transform"));
  shown.take(topic_of(protocol::Role::pose), std::vector<std::uint8_t>(16), 2);  // that has no channels
  shown.take(*amiro::catalogue.find("gyroscope"), std::vector<std::uint8_t>(8));
  CHECK(shown.newest.size() == 2);
  // Without a geometry nothing is known of a ring.
  const Scenes plain{amiro::catalogue, {}, std::vector<std::string>{"x"}, 0};
  CHECK(plain.channels().size() == 2);
}

TEST_CASE("serve: the law of a ring") {
  const protocol::Law law{{1, 0}, {}, {}, {1, -3}, {2, -1}};  // 1 / d^2, to 0.2
  CHECK(*distance_m(100, law) == Approx(0.1));
  CHECK(*distance_m(25, law) == Approx(0.2));
  CHECK_FALSE(distance_m(24, law));
  CHECK_FALSE(distance_m(0, law));
  CHECK_FALSE(distance_m(-5, law));
}

TEST_CASE("serve: of several poses the first is the robot's, and the others have frames of their own") {
  std::vector<protocol::Topic> topics(2, topic_of(protocol::Role::pose));
  topics[1].name = "second";
  const protocol::Catalogue catalogue{"two", 500'000, amiro::catalogue.boards, topics};
  Scenes scenes{catalogue, {}, std::vector<std::string>{"can0"}, 0};
  std::map<std::string, std::string> frames;
  for (const protocol::Topic& topic : topics) {
    const std::vector<std::uint8_t> bytes(16);
    scenes.take(
        client::Sample{&topic, protocol::default_priority, base::Time{-3s}, bytes}, 0,
        [](std::uint32_t) { return true; },
        [&](const Scenes::Message& message) {
          const Json json = Json::parse(message.payload);
          CHECK(json["timestamp"] == Json{{"sec", 0}, {"nsec", 0}});  // none is before 1970
          if (json.contains("child_frame_id"))
            frames[scenes.channels()[message.channel].topic] = json["child_frame_id"];
        });
  }
  CHECK(frames == std::map<std::string, std::string>{{"/odometry/transform", "base_link"},
                                                     {"/second/transform", "second/base_link"}});
}

TEST_CASE("serve: each sensor of a ring has the law that the spec has for it") {
  const auto sensors = sensors_of(topic_of(protocol::Role::ring));
  CHECK(sensors.size() == 8);
  CHECK(law_of(topic_of(protocol::Role::ring)) != nullptr);
  CHECK(law_of(topic_of(protocol::Role::pose)) == nullptr);
  const protocol::Law law{{1, 0}, {100, 0}, {}, {1, -3}, {2, -1}};  // to 0.2 m: 25 counts
  SightSensor sensor{law, 60};
  Sight sight = sensor.take(126);  // beyond what an obstacle at the end of the range adds
  CHECK(sight.kind == Sight::Kind::unknown);
  CHECK(sight.counts_above == 26);
  sight = sensor.take(1000);
  CHECK(sight.kind == Sight::Kind::obstacle);
  CHECK(sight.metres == Approx(std::sqrt(1.0 / 900)));
  SightSensor other{law, 60};
  CHECK(other.take(125).kind == Sight::Kind::nothing);  // it is its offset
  CHECK(other.take(125 + 25).metres == Approx(0.2));
}

}  // namespace serve_scenes_test
