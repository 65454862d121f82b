#include "cli/serve/fleet_player.hpp"

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

namespace serve_fleet_player_test {

using namespace std::chrono_literals;
using namespace ocm;
using namespace ocm::cli::serve;
using cli::Clock;
using cli::fleet::ReadLineLog;
using Json = nlohmann::json;

constexpr Clock::time_point start{1h};
constexpr std::uint32_t robots_channel = 0, map_channel = 1, bar_channel = 2;
constexpr int text = -1;

/// A robot goes 1 cm each 200 ms, for 10 s; another one beside it may stand there.
ReadLineLog drive(bool with_another = false) {
  const base::Time begin{1000h};
  ReadLineLog log;
  const auto says = [&](base::Duration at, const std::string& robot, const std::string& what) {
    log.said.push_back({begin + at, "[" + robot + "]:" + (robot == "0" ? "A" : "B") + ":" + what + "\n"});
  };
  says(0s, "0", "{H,20,20,1,3,0,90,180,270,5000,0,3}");
  if (with_another) says(0s, "1", "{H,20,20,1,3,0,90,180,270,5000,0,3}");
  for (int i = 1; i <= 50; ++i) says(i * 200ms, "0", "{U," + std::to_string(i) + ",0,0,0,40,40,40,40}");
  return log;
}

struct Desk {
  explicit Desk(ReadLineLog log = drive())
      : player{cli::fleet::LineReplay{std::move(log), {}},
               "drive.txt",
               viewers,
               {robots_channel, map_channel},
               bar_channel} {}

  void subscribe(std::initializer_list<std::uint32_t> channels) {
    for (const std::uint32_t channel : channels)
      REQUIRE(viewers.subscribe(viewer, {channel, channel}).empty());
  }
  void ask(std::string payload, Order::Kind kind = Order::Kind::playback) {
    Order order{kind, viewer};
    order.payload = std::move(payload);
    player.obey(order);
  }
  /// All that came for the viewer since, with its channel.
  std::vector<std::pair<int, Json>> said() {
    std::vector<std::pair<int, Json>> all;
    while (const auto message = viewers.next(viewer, base::Time{}))
      all.emplace_back(message->binary ? message->head[1] : text, Json::parse(*message->payload));
    return all;
  }
  /// The channels of what is published then, in order.
  std::vector<int> channels_at(base::Duration time) {
    player.publish(start + time);
    std::vector<int> channels;
    for (const auto& [channel, json] : said()) channels.push_back(channel);
    return channels;
  }
  /// The time bar, as it is published once something was asked.
  Json bar() {
    player.publish(start);
    const auto all = said();
    REQUIRE_FALSE(all.empty());
    REQUIRE(all[0].first == static_cast<int>(bar_channel));
    return all[0].second;
  }

  Viewers viewers{3};
  FleetPlayer player;
  ViewerId viewer = viewers.add();
};

using Numbers = std::vector<int>;

TEST_CASE("fleet player: the bar ten times a second, robots five times, and each second a map that is new") {
  Desk desk;
  desk.subscribe({robots_channel, map_channel, bar_channel});
  desk.player.pass(1s);
  CHECK(desk.channels_at(0ms) == Numbers{2, 0, 1});
  CHECK(desk.channels_at(99ms).empty());
  CHECK(desk.channels_at(100ms) == Numbers{2});
  CHECK(desk.channels_at(199ms).empty());
  CHECK(desk.channels_at(200ms) == Numbers{2, 0});
  desk.player.pass(5s);
  CHECK(desk.channels_at(999ms) == Numbers{2, 0});
  CHECK(desk.channels_at(1s) == Numbers{1});
  CHECK(desk.channels_at(2s) == Numbers{2, 0});  // the same map is not said again
}

TEST_CASE("fleet player: no map is made for viewers that do not look at it") {
  Desk desk;
  desk.player.pass(1s);
  desk.player.publish(start);
  desk.subscribe({map_channel});
  CHECK(desk.said().empty());
  CHECK(desk.channels_at(1s) == Numbers{1});
}

TEST_CASE("fleet player: a log goes on as fast as its bar says, also slower than it was, or pauses") {
  Desk desk;
  desk.subscribe({bar_channel});
  desk.player.pass(1s);
  const Json first = desk.bar();
  CHECK(first ==
        Json{{"at_s", 1}, {"length_s", 10}, {"speed", 1}, {"paused", false}, {"ended", false}, {"jumps", 0}});
  desk.ask(R"({"speed":4})");
  CHECK(desk.bar()["speed"] == 4);
  desk.player.pass(500ms);
  desk.ask(R"({"speed":0.5})");
  const Json slow = desk.bar();
  CHECK(slow["speed"] == 0.5);
  CHECK(slow["at_s"] == 3);
  desk.ask(R"({"speed":1})");
  CHECK(desk.bar()["speed"] == 1);
  desk.ask(R"({"paused":true})");
  desk.player.pass(1s);
  desk.ask(R"({"speed":2})");  // and stays so
  const Json paused = desk.bar();
  CHECK(paused["paused"] == true);
  CHECK(paused["at_s"] == 3);
  CHECK(paused["speed"] == 2);
  desk.ask(R"({"paused":false})");
  desk.player.pass(1s);
  desk.ask("{}");
  const Json on = desk.bar();
  CHECK(on["paused"] == false);
  CHECK(on["at_s"] == 5);
  CHECK(on["jumps"] == 0);
  desk.player.pass(1h);
  desk.ask("{}");
  CHECK(desk.bar()["ended"] == true);
}

TEST_CASE("fleet player: behind a jump all is said again at once, the bar first") {
  Desk desk;
  desk.subscribe({robots_channel, map_channel, bar_channel});
  desk.player.pass(1s);
  CHECK(desk.channels_at(0ms).size() == 3);
  desk.ask(R"({"at_s":8})");
  desk.player.publish(start);
  const auto said = desk.said();
  REQUIRE(said.size() == 3);
  CHECK(said[0].second["jumps"] == 1);
  CHECK(said[0].second["at_s"] == 8);
  const Json& robots = said[1].second;
  CHECK(robots["line"] == "drive.txt");
  CHECK(robots["unplaced"] == Json::array());
  REQUIRE(robots["robots"].size() == 1);
  CHECK(robots["robots"][0]["robot"] == "A");
  CHECK(robots["robots"][0]["at"]["x_m"].get<double>() == Approx(0.4));
  CHECK(robots["robots"][0]["age_s"] == 0);
  CHECK(robots["robots"][0]["target"].is_null());
  CHECK(said[2].second["frame_id"] == "map");
  desk.ask(R"({"at_s":8})");  // who forgets what was before is given the same map again
  CHECK(desk.channels_at(0ms) == Numbers{2, 0, 1});
  desk.ask(R"({"speed":2})");  // no jump: the bar alone
  CHECK(desk.channels_at(0ms) == Numbers{2});
}

TEST_CASE("fleet player: what is no request is answered, and what is not for a log does nothing") {
  Desk desk;
  desk.subscribe({bar_channel});
  const ViewerId other = desk.viewers.add();
  desk.ask(R"({"speed":0})");
  const auto said = desk.said();
  REQUIRE(said.size() == 1);
  CHECK(said[0].first == text);
  CHECK(said[0].second["level"] == 2);
  CHECK(said[0].second["message"] == "a time bar takes at_s in seconds, speed from 1/64 to 1024, and paused");
  CHECK_FALSE(desk.viewers.has_next(other));
  desk.ask(R"({"speed":8,"paused":true})", Order::Kind::publish);
  const Json bar = desk.bar();
  CHECK(bar["speed"] == 1);
  CHECK(bar["paused"] == false);
}

TEST_CASE("fleet player: of several robots it is said which are not on the map") {
  Desk desk{drive(true)};
  desk.subscribe({robots_channel});
  desk.player.pass(2s);
  desk.player.publish(start);
  const auto said = desk.said();
  REQUIRE(said.size() == 1);
  CHECK(said[0].second["unplaced"] == Json{"A", "B"});
  CHECK(said[0].second["robots"].size() == 2);
  CHECK(said[0].second["robots"][0]["at"].is_null());
  CHECK(said[0].second["robots"][0]["age_s"] == 0);
  CHECK(said[0].second["robots"][1]["age_s"].is_null());
}

}  // namespace serve_fleet_player_test
