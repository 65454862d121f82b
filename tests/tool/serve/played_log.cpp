#include "cli/serve/played_log.hpp"

#ifdef OCM_HAS_WEBSOCKETS

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <system_error>
#include <unistd.h>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "ocm/topics/amiro.hpp"

#include "generator/spec/model.hpp"
#include "tool/captured.hpp"

namespace serve_played_log_test {

using namespace std::chrono_literals;
using namespace ocm;
using namespace ocm::cli::serve;
using Json = nlohmann::json;

/// Of the gyroscope, each tenth of a second for 30 s, whose x counts up.
class File {
 public:
  File() {
    std::ofstream file{path_};
    for (int i = 0; i <= 300; ++i)
      file << fmt::format("({}.{}00000) can0 608#{:02X}{:02X}00000000\n", 1000 + i / 10, i % 10, i % 256,
                          i / 256);
  }
  ~File() {
    std::error_code none;
    std::filesystem::remove(path_, none);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_ =
      (std::filesystem::temp_directory_path() / fmt::format("ocm-played-{}.log", ::getpid())).string();
};

/// A page of it, and a viewer that asks before a turn of the server, and sees what became of it before the
/// next one.
struct Page {
  using Said = std::map<std::string, std::vector<Json>>;

  Page() {
    test::Captured address{STDOUT_FILENO};
    server.open();
  }
  ServeOptions options() {
    ServeOptions all;
    all.over = [this] { return !turn(); };
    return all;
  }
  std::uint32_t channel(std::string_view topic) {
    for (const foxglove::Channel& each : server.channels().all())
      if (each.topic == topic) return each.id;
    FAIL("there is no channel " << topic);
    return 0;
  }
  void subscribe(std::initializer_list<std::string_view> topics) {
    for (const std::string_view topic : topics)
      REQUIRE(server.viewers().subscribe(viewer, {channel(topic), channel(topic)}).empty());
  }
  void ask(std::string payload, Order::Kind kind = Order::Kind::playback) {
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
  /// Until `each`, which comes before a turn of the server, says that it was enough.
  void serve(std::function<bool()> each) {
    turn = std::move(each);
    test::Captured errors{STDERR_FILENO};
    const int code = serve_log(server, log);
    CHECK(code == 0);
    CHECK(errors.text() == "serve: the log plays from the moment that the page is opened\n");
  }

  File file;
  cli::bus_model::LogFeed log{file.path(), {}, amiro::catalogue};
  spec::Model model;
  std::function<bool()> turn = [] { return false; };
  PageServer server{amiro::catalogue, model,  options(), {"drive.log", false, false},
                    log.interfaces(), 500'000};
  ViewerId viewer = server.viewers().add();
};

TEST_CASE("played log: a time bar winds it, and it goes on as fast as that says, or pauses") {
  Page page;
  page.subscribe({"/ocm/playback"});
  int turn = 0;
  page.serve([&] {
    Page::Said said = page.said();
    std::vector<Json>& gyroscope = said["/gyroscope"];
    INFO("before turn " << turn);
    if (turn == 0) {
      CHECK(said["/ocm/playback"].empty());
      page.ask(R"({"speed":0.5,"paused":true})");
      return ++turn != 0;
    }
    if (turn != 7) REQUIRE_FALSE(said["/ocm/playback"].empty());
    const Json bar = said["/ocm/playback"].empty() ? Json{} : said["/ocm/playback"].back();
    switch (turn++) {
      case 1:
        CHECK(bar ==
              Json::parse(R"({"at_s":0,"length_s":30,"speed":0.5,"paused":true,"ended":false,"jumps":0})"));
        page.ask(R"({"speed":16})");
        return true;
      case 2:
        CHECK(bar["speed"] == 16);
        CHECK(bar["paused"] == true);
        CHECK(bar["at_s"] == 0);
        page.subscribe({"/gyroscope"});
        page.ask(R"({"at_s":20})");
        return true;
      case 3:
        CHECK(bar["at_s"] == 20);
        CHECK(bar["jumps"] == 1);
        CHECK(bar["speed"] == 16);
        REQUIRE(gyroscope.size() == 1);  // of all that it passed over the newest
        CHECK(gyroscope[0]["x"].get<double>() == Approx(200 * 0.0175));
        page.ask(R"({"at_s":5})");  // back
        return true;
      case 4:
        CHECK(bar["at_s"] == 5);
        CHECK(bar["jumps"] == 2);
        REQUIRE(gyroscope.size() == 1);
        CHECK(gyroscope[0]["x"].get<double>() == Approx(50 * 0.0175));
        page.ask(R"({"speed":8,"paused":false})", Order::Kind::publish);  // that is not for a log
        return true;
      case 5:
        CHECK(bar["speed"] == 16);
        CHECK(bar["paused"] == true);
        page.ask(R"({"paused":false})");
        return true;
      case 6:
        CHECK(bar["paused"] == false);
        CHECK(bar["at_s"] == 5);
        return true;  // nothing is asked: it is played for 20 ms of the clock
      case 7:
        REQUIRE(gyroscope.size() >= 3);
        for (std::size_t i = 0; i < 3; ++i)
          CHECK(gyroscope[i]["x"].get<double>() == Approx((51 + static_cast<double>(i)) * 0.0175));
        page.ask(R"({"paused":true})");
        return true;
      case 8:
        CHECK(bar["paused"] == true);
        CHECK(bar["at_s"].get<double>() >= 5.32);
        CHECK(bar["jumps"] == 2);
        page.ask(R"({"speed":0})");
        return true;
      case 9:
        REQUIRE(said[""].size() == 1);
        CHECK(said[""][0]["level"] == 2);
        CHECK(said[""][0]["message"] ==
              "a time bar takes at_s in seconds, speed from 1/64 to 1024, and paused");
        CHECK(bar["speed"] == 16);
        page.ask(R"({"at_s":1000})");
        return true;
      case 10:
        CHECK(bar["at_s"] == 30);
        CHECK(bar["ended"] == true);
        return false;
      default:
        return false;
    }
  });
  CHECK(turn == 11);
}

TEST_CASE(
    "played log: who looks at it while it is paused is given what came last, and periods are answered") {
  Page page;
  int turn = 0;
  page.serve([&] {
    Page::Said said = page.said();
    if (turn == 0) page.ask(R"({"at_s":20,"paused":true})");
    if (turn == 1) {
      page.subscribe({"/gyroscope"});
      Order newest{Order::Kind::newest, page.viewer};
      newest.channels = {page.channel("/gyroscope")};
      CHECK(page.server.orders().put(std::move(newest)));
      Order periods{Order::Kind::get_parameters, page.viewer};
      periods.names = {"/gyroscope/period_ms"};
      periods.payload = "r";
      CHECK(page.server.orders().put(std::move(periods)));
    }
    if (turn == 2) {
      REQUIRE(said["/gyroscope"].size() == 1);
      CHECK(said["/gyroscope"][0]["x"].get<double>() == Approx(200 * 0.0175));
      REQUIRE(said[""].size() == 1);
      CHECK(said[""][0]["op"] == "parameterValues");
      CHECK(said[""][0]["id"] == "r");
      CHECK(said[""][0]["parameters"][0]["name"] == "/gyroscope/period_ms");
    }
    return turn++ != 2;
  });
  CHECK(turn == 3);
}

TEST_CASE("played log: it plays from the moment that a viewer looks at it") {
  Page page;
  int turn = 0;
  page.serve([&] {
    Page::Said said = page.said();
    if (turn == 1) page.subscribe({"/gyroscope"});
    if (turn == 2) {
      REQUIRE_FALSE(said["/gyroscope"].empty());
      CHECK(said["/gyroscope"][0]["x"] == 0);
    }
    return turn++ != 2;
  });
  CHECK(turn == 3);
}

TEST_CASE("played log: the bar ten times a second, the bus four times, and boards and response times once") {
  Page page;
  page.subscribe({"/ocm/playback", "/ocm/bus", "/ocm/boards", "/ocm/bounds"});
  std::map<std::string, std::int64_t> count;
  int turn = 0;
  const auto begin = std::chrono::steady_clock::now();
  page.serve([&] {
    for (const auto& [topic, states] : page.said()) count[topic] += static_cast<std::int64_t>(states.size());
    return turn++ != 7;  // of 20 ms each
  });
  const auto passed = std::chrono::steady_clock::now() - begin;
  CHECK(count["/ocm/playback"] >= 2);
  CHECK(count["/ocm/playback"] <= 1 + passed / 100ms);
  CHECK(count["/ocm/bus"] >= 1);
  CHECK(count["/ocm/bus"] <= 1 + passed / 250ms);
  for (const char* const seldom : {"/ocm/boards", "/ocm/bounds"}) {
    INFO(seldom);
    CHECK(count[seldom] >= 1);
    CHECK(count[seldom] <= 1 + passed / 1s);
  }
}

TEST_CASE("played log: behind whatever is asked the bar and figures of the bus come in the same turn") {
  Page page;
  page.subscribe({"/ocm/playback", "/ocm/bus"});
  int turn = 0;
  page.serve([&] {
    Page::Said said = page.said();
    INFO("before turn " << turn);
    if (turn != 0) {
      CHECK(said["/ocm/playback"].size() == 1);
      CHECK(said["/ocm/bus"].size() == 1);
    }
    page.ask("{}");
    return turn++ != 3;
  });
  CHECK(turn == 4);
}

}  // namespace serve_played_log_test

#endif
