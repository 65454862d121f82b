#include "cli/serve/page_server.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unistd.h>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "ocm/topics/amiro.hpp"

#include "generator/spec/model.hpp"
#include "tool/bus_model/bus.hpp"
#include "tool/captured.hpp"

namespace serve_page_server_test {

using namespace std::chrono_literals;
using namespace ocm;
using namespace ocm::cli::serve;
using Json = nlohmann::json;
using Strings = std::vector<std::string>;

constexpr std::uint32_t gyroscope = 0x608, ask_gyroscope = 0x208, motors = 0x201;

/// What is said of frames that a test writes down, to a viewer of some channels.
struct Desk {
  explicit Desk(Strings names = {"can0"})
      : server{amiro::catalogue, model, {}, {"drive.log", false, false}, names, 500'000} {
    for (const std::string& name : names) interfaces.number(name);
  }

  std::uint32_t channel(std::string_view topic) {
    for (const foxglove::Channel& each : server.channels().all())
      if (each.topic == topic) return each.id;
    FAIL("there is no channel " << topic);
    return 0;
  }
  void subscribe(const Strings& topics) {
    for (const std::string& topic : topics)
      REQUIRE(server.viewers().subscribe(viewer, {channel(topic), channel(topic)}).empty());
  }
  /// All that came since: "TOPIC SECONDS", of states without the time. `newest` is the last one.
  Strings said() {
    Strings all;
    while (const auto message = server.viewers().next(viewer, base::Time{})) {
      std::uint64_t time_ns = 0;
      for (std::size_t i = 8; i-- > 0;) time_ns = time_ns << 8 | message->head[5 + i];
      const auto since =
          base::Duration{static_cast<std::int64_t>(time_ns)} - test::morning.time_since_epoch();
      const std::string& topic = server.channels().topic(message->head[1]);
      all.push_back(topic + (topic.starts_with("/ocm/") ? "" : " " + std::to_string(since / 1s)));
      newest = Json::parse(*message->payload);
    }
    return all;
  }
  /// A state as it is published.
  Json state() {
    REQUIRE(said().size() == 1);
    return newest;
  }
  void take(base::Duration at, std::uint32_t id, std::initializer_list<int> bytes,
            std::uint16_t interface = 0) {
    log::Entry entry = test::entry(at, id, bytes);
    entry.interface = interface;
    server.take(entry, interfaces);
  }
  void turns(base::Duration at) { take(at, gyroscope, {1, 2, 3, 4, 5, 6}); }
  /// Both frames of a pose: so many times 0.256 m along x.
  void stands(base::Duration at, int x) {
    take(at, 0x602, {0, 0, 0, 0, 0, 0, 0, 0});
    take(at, 0x603, {x * 1000 & 0xFF, x * 1000 >> 8, 0, 0, 0, 0, 0, 0});
  }
  /// The newest of these, as who has just subscribed to them gets it.
  void ask_newest(const Strings& topics) {
    Order order{Order::Kind::newest, viewer};
    for (const std::string& topic : topics) order.channels.push_back(channel(topic));
    server.answer(order, test::morning + 4s);
  }
  Json boards() {
    server.publish_boards({}, test::morning + 4s);
    return state();
  }
  /// The row of the gyroscope among response times.
  Json bounds() {
    server.publish_bounds(test::morning + 4s);
    const Json rows = state()["rows"];
    for (const Json& row : rows)
      if (row["name"] == "gyroscope") return row;
    return {};
  }
  Json measured() {
    const Json row = bounds();
    REQUIRE(row.contains("measured_ms"));
    return row["measured_ms"];
  }

  spec::Model model;
  PageServer server;
  log::Interfaces interfaces;
  ViewerId viewer = server.viewers().add();
  Json newest;
};

TEST_CASE("page server: while a log is wound nothing is shown, and behind it what came last") {
  Desk desk;
  desk.subscribe({"/gyroscope", "/odometry/pose"});
  desk.turns(1s);
  desk.stands(2s, 1);
  CHECK(desk.said() == Strings{"/gyroscope 1", "/odometry/pose 2"});
  desk.server.winds();
  for (int i = 3; i < 7; ++i) {
    desk.turns(i * 1s);
    desk.stands(i * 1s, i);
  }
  CHECK(desk.said().empty());
  desk.server.wound();
  CHECK(desk.said() == Strings{"/gyroscope 6", "/odometry/pose 6"});
  CHECK(desk.newest["pose"]["position"]["x"].get<double>() == Approx(6 * 0.256));
  desk.stands(7s, 7);  // at once again
  desk.turns(8s);
  CHECK(desk.said() == Strings{"/odometry/pose 7", "/gyroscope 8"});
}

TEST_CASE("page server: what came last is given to who has subscribed, of its interface, and of a scene") {
  Desk desk{{"can0", "can1"}};
  const Strings topics{"/can0/gyroscope", "/can1/gyroscope", "/can1/odometry/pose",
                       "/can1/odometry/transform", "/can0/odometry/pose"};
  desk.turns(1s);
  desk.take(2s, gyroscope, {7, 0, 0, 0, 0, 0}, 1);
  desk.take(3s, 0x602, {0, 0, 0, 0, 0, 0, 0, 0}, 1);
  desk.take(3s, 0x603, {0, 0, 0, 0, 0, 0, 0, 0}, 1);
  desk.subscribe(topics);
  CHECK(desk.said().empty());
  desk.ask_newest(topics);
  CHECK(desk.said() == Strings{"/can0/gyroscope 1", "/can1/gyroscope 2", "/can1/odometry/pose 3",
                               "/can1/odometry/transform 3"});
  desk.ask_newest({"/can1/gyroscope"});
  CHECK(desk.said().size() == 1);
  CHECK(desk.newest["x"].get<double>() == Approx(7 * 0.0175));
  desk.ask_newest({"/ocm/robot"});  // the server's own are not asked for
  CHECK(desk.said().empty());
}

TEST_CASE("page server: of a log from its beginning nothing is known that is behind it") {
  Desk desk;
  desk.subscribe({"/odometry", "/ocm/boards", "/ocm/bounds"});
  const Json before = desk.boards();
  // The wheels' board says its status, that of the power management is asked for, and two programs drive.
  desk.take(0s, 0x71B, {2, 1, 0, 4, 0, 0, 0, 0});
  desk.take(0s, 0x71C, {42, 2, 5, 2, 0, 0, 5, 0});
  for (const protocol::Topic& topic : amiro::catalogue.topics)
    if (topic.name == "power_management_status")
      desk.server.take({test::morning, protocol::once(topic.id, topic.priority)}, desk.interfaces);
  for (int i = 0; i < 10; ++i) desk.take(i * 20ms, motors, {i % 2 == 0 ? 1 : 2, 0, 0, 0, 0, 0, 0, 0});
  desk.take(1s, ask_gyroscope, {1, 50, 0, 0});
  desk.turns(1s);
  CHECK(desk.measured().is_null());
  desk.turns(1050ms);
  desk.turns(1103ms);
  CHECK(desk.measured().get<double>() > 3);
  desk.stands(2s, 1);
  desk.take(3s, 0x602, {0, 0, 0, 0, 0, 0, 0, 0});  // half of a sample
  CHECK(desk.said() == Strings{"/odometry 2"});
  const Json there = desk.boards();
  CHECK(there["boards"][0]["answers"] == true);
  CHECK(there["boards"][1]["asked"] == true);
  Strings found;
  for (const Json& finding : there["findings"]) found.push_back(finding["what"]);
  CHECK(std::any_of(found.begin(), found.end(),
                    [](const std::string& what) { return what.starts_with("two programs command motors"); }));

  desk.server.forget();
  CHECK(desk.boards() == before);
  desk.subscribe({"/gyroscope", "/odometry/pose"});
  desk.ask_newest({"/gyroscope", "/odometry/pose"});
  CHECK(desk.said().empty());
  desk.take(0s, 0x603, {0, 0, 0, 0, 0, 0, 0, 0});  // the other half of another
  CHECK(desk.said().empty());
  CHECK(desk.bounds().is_null());
  // With the same periods as before, response times are measured from the beginning.
  desk.take(1s, ask_gyroscope, {1, 50, 0, 0});
  desk.turns(1s);
  CHECK(desk.said() == Strings{"/gyroscope 1"});
  CHECK(desk.measured().is_null());
}

TEST_CASE("page server: response times of before a log is read again are not those of then") {
  Desk desk;
  desk.subscribe({"/ocm/bounds"});
  for (const bool again : {false, true}) {
    if (again) desk.server.forget();
    desk.take(1s, ask_gyroscope, {1, 50, 0, 0});
    desk.turns(1s);
    CHECK(desk.measured().is_null());
    desk.turns(1050ms);
    desk.turns(1103ms);
    CHECK(desk.measured().get<double>() > 3);
  }
}

TEST_CASE("page server: response times are those of the first interface") {
  Desk desk{{"can0", "can1"}};
  desk.subscribe({"/ocm/bounds"});
  desk.take(1s, ask_gyroscope, {1, 50, 0, 0});
  desk.turns(1s);
  CHECK(desk.bounds()["period_ms"] == 50);
  for (int i = 0; i < 5; ++i) desk.take(1s + i * 70ms, gyroscope, {1, 2, 3, 4, 5, 6}, 1);
  CHECK(desk.measured().is_null());
}

TEST_CASE("page server: the bit rate is what was asked for, else the bus's, else the spec's") {
  const auto rate = [](std::optional<std::uint32_t> asked, std::uint32_t of_bus) {
    const spec::Model model;
    ServeOptions options;
    options.bit_rate = asked;
    PageServer server{amiro::catalogue, model, std::move(options), {"can0", true, false}, {"can0"}, of_bus};
    const ViewerId viewer = server.viewers().add();
    REQUIRE(server.viewers().subscribe(viewer, {1, server.channels().of(State::bounds)}).empty());
    server.publish_bounds(test::morning);
    const auto state = server.viewers().next(viewer, base::Time{});
    REQUIRE(state);
    const std::string about = Json::parse(*state->payload)["about"];
    return about.substr(0, about.find(','));
  };
  CHECK(rate({}, 0) == "At 500000 bit/s");
  CHECK(rate({}, 125'000) == "At 125000 bit/s");
  CHECK(rate(250'000U, 125'000) == "At 250000 bit/s");
}

TEST_CASE("page server: a log is looked at by who has subscribed to something of it") {
  Desk desk;
  CHECK_FALSE(desk.server.is_looked_at());
  desk.subscribe({"/ocm/robot", "/ocm/bus", "/ocm/playback"});
  CHECK_FALSE(desk.server.is_looked_at());
  desk.subscribe({"/odometry/transform"});
  CHECK(desk.server.is_looked_at());
  Desk other;
  other.subscribe({"/gyroscope"});
  CHECK(other.server.is_looked_at());
}

#ifdef OCM_HAS_WEBSOCKETS

TEST_CASE("page server: figures of the bus, and frames that it has lost since it counts them") {
  Desk desk;
  test::Captured address{STDOUT_FILENO};
  desk.server.open();
  CHECK(address.text().starts_with("http://127.0.0.1:"));
  desk.subscribe({"/ocm/bus"});
  const auto bus = [&] {
    desk.server.publish_bus(test::morning + 4s);
    const Json state = desk.state();
    CHECK(state["viewers"] == 1);
    CHECK(state["lost"] == 0);
    CHECK(state["refused"] == 0);
    REQUIRE(state["buses"].size() == 1);
    CHECK(state["buses"][0]["name"] == "can0");
    return state["buses"][0];
  };
  CHECK(bus()["lost"] == 0);
  for (const auto& [counted, lost] : {std::pair{3U, 3}, {3U, 3}, {5U, 5}}) {
    desk.server.lost_so_far("can0", counted);
    CHECK(bus()["lost"] == lost);
  }
  desk.turns(1s);
  CHECK(bus()["frames"] == 1);
  desk.server.forget();
  CHECK(bus()["frames"] == 0);  // the bus is there all the same
  desk.server.close();
}

TEST_CASE("page server: its address has a token where commands take one, or looking, and what is shown") {
  const auto address = [](bool commands, bool to_view, std::string shows) {
    const spec::Model model;
    ServeOptions options;
    options.commands = commands;
    options.web.token_to_view = to_view;
    options.shows = std::move(shows);
    PageServer server{amiro::catalogue,         model,    std::move(options),
                      {"can0", true, commands}, {"can0"}, 500'000};
    CHECK(server.takes_commands() == commands);
    test::Captured out{STDOUT_FILENO};
    server.open();
    server.close();
    return out.text();
  };
  CHECK_THAT(address(false, false, ""), Catch::Matches("http://127\\.0\\.0\\.1:[0-9]+/\n"));
  CHECK_THAT(address(true, false, ""), Catch::Matches("http://127\\.0\\.0\\.1:[0-9]+/#[0-9a-f]{32}\n"));
  CHECK_THAT(address(false, true, ""), Catch::Matches("http://127\\.0\\.0\\.1:[0-9]+/#[0-9a-f]{32}\n"));
  CHECK_THAT(address(true, true, "map"), Catch::Matches("http://127\\.0\\.0\\.1:[0-9]+/#[0-9a-f]{32}&map\n"));
}

TEST_CASE("page server: at its end it says how much was lost of viewers that were too slow") {
  for (const int lost : {0, 1, 2, 3}) {
    Desk desk;
    test::Captured address{STDOUT_FILENO};
    desk.server.open();
    address.text();
    for (int i = 0; i < 64 + lost; ++i) desk.server.viewers().tell(desk.viewer, "a text");
    while (desk.server.viewers().next(desk.viewer, base::Time{})) {
    }
    test::Captured errors{STDERR_FILENO};
    desk.server.close();
    CHECK(errors.text() == (lost == 0
                                ? std::string{}
                                : "serve: viewers that were too slow have lost " + std::to_string(lost) +
                                      (lost == 1 ? " message\n" : " messages\n")));
  }
}

TEST_CASE("page server: what a robot is, and what is said to all") {
  Desk desk;
  test::Captured address{STDOUT_FILENO};
  desk.server.open();
  address.text();
  desk.subscribe({"/ocm/robot", "/ocm/playback"});
  const Json robot = desk.state();
  CHECK(robot["robot"] == "AMiRo");
  CHECK(robot["source"] == "drive.log");
  CHECK(robot["live"] == false);
  desk.server.publish_playback({1500ms, 3min, 2, false}, true, 4);
  CHECK(desk.state() ==
        Json::parse(R"({"at_s":1.5,"length_s":180,"speed":2,"paused":true,"ended":false,"jumps":4})"));
  test::Captured errors{STDERR_FILENO};
  desk.server.say("something has happened");
  CHECK(errors.text() == "serve: something has happened\n");
  const auto told = desk.server.viewers().next(desk.viewer, base::Time{});
  REQUIRE(told);
  CHECK(*told->payload == R"({"op":"status","level":0,"message":"something has happened"})");
  desk.server.close();
}

#endif

}  // namespace serve_page_server_test
