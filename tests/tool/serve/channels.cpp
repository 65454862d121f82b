#include "cli/serve/channels.hpp"

#include <chrono>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

#include "tool/bus_model/bus.hpp"

namespace serve_channels_test {

using namespace std::chrono_literals;
using namespace std::string_literals;
using namespace ocm;
using namespace ocm::cli::serve;
using client::Meaning;
using Strings = std::vector<std::string>;

/// The example's four topics: scale, of two frames, and three lamps.
const protocol::Catalogue& example = test::catalogue;

Strings topics_of(const Channels& channels) {
  Strings topics;
  for (const foxglove::Channel& channel : channels.all()) {
    CHECK(channel.id == topics.size());
    CHECK(channels.topic(channel.id) == channel.topic);
    topics.push_back(channel.topic);
  }
  return topics;
}

TEST_CASE("channels: one a topic, and behind them the server's own") {
  const Channels channels{example, Strings{"can0"}};
  CHECK(topics_of(channels) == Strings{"/scale", "/lamp_1", "/lamp_2", "/lamp_3", "/ocm/robot", "/ocm/bus",
                                       "/ocm/boards", "/ocm/bounds", "/ocm/operator", "/ocm/playback"});
  CHECK(channels.all()[1].schema_name == "example.lamp_1");
  CHECK(channels.all()[4].schema_name == "ocm.robot");
  CHECK(channels.all()[4].schema == R"({"type":"object"})");
  CHECK(channels.of(State::robot) == 4);
  CHECK(channels.of(State::playback) == 9);
  CHECK(channels.interfaces().size() == 1);
}

TEST_CASE("channels: of several interfaces each topic has one on each") {
  Channels channels{example, Strings{"can0", "can1"}, true};
  CHECK(topics_of(channels) == Strings{"/can0/scale", "/can0/lamp_1", "/can0/lamp_2", "/can0/lamp_3",
                                       "/can1/scale", "/can1/lamp_1", "/can1/lamp_2", "/can1/lamp_3",
                                       "/ocm/robot", "/ocm/bus", "/ocm/boards", "/ocm/bounds",
                                       "/ocm/operator", "/ocm/playback", "/ocm/fleet", "/ocm/map"});
  CHECK(channels.all()[15].schema_name == "foxglove.Grid");
  CHECK(channels.of(1, 2) == 6);
  CHECK(channels.topic_of(6) == 2);
  CHECK(channels.interface_of(6) == "can1");
  CHECK(channels.interface_of(3) == "can0");
  CHECK(channels.of(State::map) == 15);
  // Those of who adds some are no states.
  channels.add({{16, "/pose", "foxglove.PoseInFrame", "{}"}});
  for (std::uint32_t channel = 0; channel < 17; ++channel)
    CHECK(channels.is_state(channel) == (channel >= 8 && channel < 16));
  CHECK_FALSE(Channels(example, Strings{"can0"}).is_state(10));
}

TEST_CASE("channels: there is a bound of them, and one interface always has some") {
  const auto interfaces_with_channels = [](std::size_t topics, std::size_t interfaces) {
    const std::vector<protocol::Topic> many(topics, example.topics[1]);
    const protocol::Catalogue catalogue{"many", 250'000, {}, many};
    return Channels{catalogue, Strings(interfaces, "can")}.interfaces().size();
  };
  CHECK(interfaces_with_channels(5'000, 4) == 4);
  CHECK(interfaces_with_channels(5'000, 5) == 4);
  CHECK(interfaces_with_channels(5'001, 5) == 3);
  CHECK(interfaces_with_channels(20'001, 2) == 1);
  CHECK(interfaces_with_channels(0, 3) == 1);
}

/// What is published of frames, for a viewer that has subscribed to some channels.
struct Desk {
  explicit Desk(Strings interfaces = {"can0"}) : channels{example, interfaces} {}

  void subscribe(std::uint32_t channel) { REQUIRE(viewers.subscribe(viewer, {channel, channel}).empty()); }
  /// All that came, "CHANNEL SECONDS FIELDS".
  Strings said() {
    Strings all;
    while (const auto message = viewers.next(viewer, base::Time{})) {
      std::uint64_t time_ns = 0;
      for (int i = 7; i >= 0; --i) time_ns = time_ns << 8 | message->head[static_cast<std::size_t>(5 + i)];
      const auto since =
          base::Duration{static_cast<std::int64_t>(time_ns)} - test::morning.time_since_epoch();
      all.push_back(std::to_string(message->head[1]) + " " + std::to_string(since / 1s) + " " +
                    *message->payload);
    }
    return all;
  }
  Meaning take(const log::Entry& entry, std::string_view interface = "can0") {
    return publisher.take(entry, interface).meaning;
  }
  Meaning lamp(base::Duration at, int level, std::string_view interface = "can0") {
    return take(test::entry(at, 0x230, {level}), interface);
  }
  /// Both frames of the scale: 100 g, and a quarter for each unit.
  void weigh(base::Duration at, std::uint8_t quarters, std::string_view interface = "can0") {
    CHECK(take(test::entry(at, 0x510, {0, 0, 0, quarters}), interface) == Meaning::part);
    CHECK(take(test::entry(at, 0x521, {7}), interface) == Meaning::sample);
  }

  Channels channels;
  Viewers viewers{channels.all().size()};
  Publisher publisher{example, channels, viewers};
  ViewerId viewer = viewers.add();
};

TEST_CASE("publisher: samples and set points go to who has subscribed to their channel") {
  Desk desk;
  desk.subscribe(0);
  desk.subscribe(1);
  desk.weigh(1s, 4);
  CHECK(desk.lamp(2s, 9) == Meaning::set_point);
  CHECK(desk.take(test::entry(3s, 0x231, {9})) ==
        Meaning::set_point);  // lamp_2: no viewer has subscribed to it
  CHECK(desk.take(test::entry(3s, 0x7FF, {9})) == Meaning::unknown);
  CHECK(desk.said() == Strings{R"(0 1 {"weight":{"weight":101},"state":{"state":7}})", R"(1 2 {"level":9})"});
  const auto counters = desk.publisher.counters();
  CHECK(counters.frames == 5);
  CHECK(counters.samples == 1);
  CHECK(counters.unknown == 1);
}

TEST_CASE("publisher: each interface has channels and samples of its own") {
  Desk desk{{"can0", "can1"}};
  desk.subscribe(0);
  desk.subscribe(5);
  // The two frames of a sample come from one bus.
  CHECK(desk.take(test::entry(1s, 0x510, {0, 0, 0, 4}), "can0") == Meaning::part);
  CHECK(desk.take(test::entry(1s, 0x521, {7}), "can1") != Meaning::sample);
  CHECK(desk.take(test::entry(1s, 0x521, {7}), "can0") == Meaning::sample);
  CHECK(desk.lamp(2s, 1, "can0") == Meaning::set_point);
  CHECK(desk.lamp(3s, 2, "can1") == Meaning::set_point);
  for (int i = 0; i < 2; ++i) CHECK(desk.lamp(4s, 3, "can2") == Meaning::unknown);  // it has no channels
  CHECK(desk.lamp(5s, 4, "can1") == Meaning::set_point);
  const auto said = desk.said();
  REQUIRE(said.size() == 3);
  CHECK(said[0].starts_with("0 1 "));
  CHECK(said[1] == R"(5 3 {"level":2})");
  CHECK(said[2] == R"(5 5 {"level":4})");
  CHECK(desk.publisher.counters().frames == 6);
  CHECK(desk.publisher.counters().commands == 3);
}

TEST_CASE("publisher: what is counted is that of all interfaces") {
  Desk desk{{"can0", "can1"}};
  can::AnyFrame fd;
  fd.id = 0x123;
  fd.length = 12;
  fd.flags = can::frame_flag::fd;
  for (int i = 1; i <= 2; ++i) {
    const std::string interface = "can" + std::to_string(i - 1);
    for (int k = 0; k < i; ++k) {
      desk.weigh(1s, 4, interface);
      CHECK(desk.lamp(2s, 1, interface) == Meaning::set_point);
      CHECK(desk.take(test::entry(3s, 0x7FF, {9}), interface) == Meaning::unknown);
      CHECK(desk.take(log::Entry{test::morning + 4s, fd}, interface) == Meaning::unknown);
      desk.take(test::entry(5s, 0x510, {}, can::Format::base_remote), interface);
      desk.take(test::entry(5s, 0x510, {1, 2, 3}), interface);     // of three bytes
      desk.take(test::entry(6s, 0x510, {0, 0, 0, 1}), interface);  // its second frame does not come
      desk.take(test::entry(7s, 0, {0, 0, 0, 0, 0, 0, 0, 0}, can::Format::error), interface);
      desk.weigh(8s, 4, interface);
    }
  }
  const auto sum = desk.publisher.counters();
  CHECK(sum.frames == 33);
  CHECK(sum.samples == 6);
  CHECK(sum.commands == 3);
  CHECK(sum.unknown == 3);
  CHECK(sum.remote == 3);
  CHECK(sum.fd == 3);
  CHECK(sum.wrong_dlc == 3);
  CHECK(sum.incomplete == 3);
  CHECK(sum.errors == 3);
  CHECK(sum.transport == 0);
}

TEST_CASE("publisher: while a log is wound only the newest of each channel counts") {
  Desk desk;
  desk.subscribe(0);
  desk.subscribe(1);
  desk.subscribe(3);
  desk.publisher.hold_back();
  desk.lamp(1s, 1);
  desk.weigh(2s, 4);
  desk.lamp(3s, 3);
  CHECK(desk.said().empty());
  desk.publisher.go_on();
  const auto said = desk.said();
  REQUIRE(said.size() == 2);  // of lamp_3 nothing came
  CHECK(said[0].starts_with("0 2 "));
  CHECK(said[1] == R"(1 3 {"level":3})");
  desk.lamp(4s, 4);  // at once again
  CHECK(desk.said() == Strings{R"(1 4 {"level":4})"});
  desk.publisher.hold_back();  // what was before is not said again
  desk.publisher.go_on();
  CHECK(desk.said().empty());
}

TEST_CASE("publisher: of a log from its beginning no half of a sample is left") {
  Desk desk;
  desk.subscribe(0);
  CHECK(desk.take(test::entry(1s, 0x510, {0, 0, 0, 4})) == Meaning::part);
  desk.publisher.forget();
  CHECK(desk.take(test::entry(2s, 0x521, {7})) != Meaning::sample);
  CHECK(desk.said().empty());
}

TEST_CASE("publisher: the text of a sample is what its channel has") {
  Desk desk;
  desk.subscribe(0);
  desk.weigh(0s, 8);
  const std::vector<std::uint8_t> bytes{0, 0, 0, 8, 0, 0, 0, 0, 7, 0, 0, 0, 0, 0, 0, 0};
  const client::Sample sample{&example.topics[0], protocol::Priority::high, test::morning, bytes};
  CHECK("0 0 " + desk.publisher.text_of(sample) == desk.said().at(0));
}

TEST_CASE("publisher: packets of J1939 are counted of all interfaces") {
  protocol::FrameLayout layout;
  layout.length = 9;
  layout.address = {protocol::Address::By::pgn, true, 0x18FEEC00};
  protocol::Topic topic;
  topic.name = "VI";
  topic.kind = protocol::Kind::message;
  topic.board = protocol::no_board;
  topic.frames = {&layout, 1};
  const std::vector<protocol::Topic> topics{topic};
  const protocol::Catalogue truck{"truck", 250'000, {}, topics};
  const Channels channels{truck, Strings{"can0", "can1"}};
  Viewers viewers{channels.all().size()};
  Publisher publisher{truck, channels, viewers};
  for (const char* const interface : {"can0", "can1", "can1"})
    CHECK(
        publisher
            .take(test::entry(0s, 0x1CECFF00, {0x20, 9, 0, 2, 0xFF, 0xEC, 0xFE, 0x00}, can::Format::extended),
                  interface)
            .meaning == Meaning::transport);
  CHECK(publisher.counters().transport == 3);
}

}  // namespace serve_channels_test
