#include "cli/serve/robots_alone.hpp"

#ifdef OCM_HAS_WEBSOCKETS

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <unistd.h>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "cli/fleet/line_replay.hpp"
#include "generator/spec/model.hpp"
#include "tool/captured.hpp"

namespace serve_robots_alone_test {

using namespace std::chrono_literals;
using namespace ocm;
using namespace ocm::cli::serve;
using Json = nlohmann::json;

/// A page of robots without a bus, live or of a log, and a viewer that asks before a turn of the server, and
/// sees what became of it before the next one. Of a live line's robots the page itself knows nothing: that is
/// for a thread of its own, which is not there.
struct Page {
  using Said = std::map<std::string, std::vector<Json>>;

  explicit Page(bool live) : server{nothing, model, options(!live), {"room.line", live, live}, {}, 0} {
    test::Captured address{STDOUT_FILENO};
    server.open();
  }
  ServeOptions options(bool with_robots) {
    ServeOptions all;
    all.over = [this] { return !turn(); };
    if (with_robots) all.fleet.emplace();
    return all;
  }
  void subscribe(std::string_view topic) {
    for (const foxglove::Channel& each : server.channels().all())
      if (each.topic == topic) REQUIRE(server.viewers().subscribe(viewer, {each.id, each.id}).empty());
  }
  void ask(Order::Kind kind, std::string payload) {
    Order order{kind, viewer};
    order.payload = std::move(payload);
    REQUIRE(server.orders().put(std::move(order)));
  }
  /// All that came since, by topic; texts are of none.
  Said said() {
    Said all;
    while (const auto message = server.viewers().next(viewer, base::Time{})) {
      const std::string topic = message->binary ? server.channels().topic(message->head[1]) : std::string{};
      all[topic].push_back(Json::parse(*message->payload));
    }
    return all;
  }

  const protocol::Catalogue nothing{"mappers", 0, {}, {}};
  spec::Model model;
  std::function<bool()> turn = [] { return false; };
  PageServer server;
  ViewerId viewer = server.viewers().add();
};

TEST_CASE("robots alone: there is no bus to be commanded, and figures of the server are there all the same") {
  Page page{true};
  page.subscribe("/ocm/bus");
  page.ask(Order::Kind::publish, R"({"x":0.1})");
  page.ask(Order::Kind::get_parameters, {});  // which are a bus's: nothing is said
  bool first = true;
  page.turn = [&] { return std::exchange(first, false); };
  CHECK(serve_robots(page.server) == 0);
  Page::Said said = page.said();
  REQUIRE(said[""].size() == 1);
  CHECK(said[""][0]["level"] == 2);
  CHECK(said[""][0]["message"] == "there is no bus: serve live robots has both");
  REQUIRE(said["/ocm/bus"].size() == 1);
  CHECK(said["/ocm/bus"][0] == Json::parse(R"({"buses":[],"viewers":1,"lost":0,"refused":0})"));
}

/// A robot goes 1 cm each 200 ms, for 10 s.
cli::fleet::ReadLineLog drive() {
  const base::Time begin{1000h};
  cli::fleet::ReadLineLog log;
  log.said.push_back({begin, "[0]:A:{H,20,20,1,3,0,90,180,270,5000,0,3}\n"});
  for (int i = 1; i <= 50; ++i)
    log.said.push_back({begin + i * 200ms, "[0]:A:{U," + std::to_string(i) + ",0,0,0,40,40,40,40}\n"});
  return log;
}

TEST_CASE("robots alone: a log waits until a viewer looks at its robots, or winds it") {
  Page page{false};
  page.subscribe("/ocm/playback");
  page.subscribe("/ocm/bus");
  int turn = 0;
  const auto begin = std::chrono::steady_clock::now();
  Page::Said all;
  page.turn = [&] {
    for (auto& [topic, states] : page.said())
      for (const Json& state : states) all[topic].push_back(state);
    const Json bar = all["/ocm/playback"].empty() ? Json{} : all["/ocm/playback"].back();
    INFO("before turn " << turn);
    switch (turn++) {
      case 1:
        CHECK(bar["at_s"] == 0);
        CHECK(bar["length_s"] == 10);
        page.ask(Order::Kind::playback, R"({"at_s":5})");
        break;
      case 2:
        CHECK(bar["at_s"] == 5);
        CHECK(bar["jumps"] == 1);
        break;
      case 3:  // it was played for 20 ms of the clock
        page.ask(Order::Kind::playback, "{}");
        break;
      case 4:
        CHECK(bar["at_s"].get<double>() >= 5.02);
        return false;
      default:
        break;
    }
    return true;
  };
  test::Captured errors{STDERR_FILENO};
  const int code = serve_robots_of_log(page.server, cli::fleet::LineReplay{drive(), {}});
  CHECK(errors.text() == "serve: the log plays from the moment that the page is opened\n");
  CHECK(code == 0);
  CHECK(turn == 5);
  REQUIRE_FALSE(all["/ocm/bus"].empty());
  const auto passed = std::chrono::steady_clock::now() - begin;
  CHECK(static_cast<std::int64_t>(all["/ocm/bus"].size()) <= 1 + passed / 250ms);

  Page other{false};
  other.subscribe("/ocm/fleet");
  turn = 0;
  other.turn = [&] {
    if (turn == 1) other.subscribe("/ocm/playback");
    if (turn == 2) other.ask(Order::Kind::playback, "{}");
    return ++turn <= 3;
  };
  test::Captured quiet{STDERR_FILENO};
  const int other_code = serve_robots_of_log(other.server, cli::fleet::LineReplay{drive(), {}});
  CHECK(other_code == 0);
  Page::Said said = other.said();
  REQUIRE_FALSE(said["/ocm/playback"].empty());
  CHECK(said["/ocm/playback"].back()["at_s"].get<double>() > 0);  // a viewer looks at its robots
  CHECK_FALSE(said["/ocm/fleet"].empty());
}

}  // namespace serve_robots_alone_test

#endif
