// Robots behind a central on the page, on a line that another program has, which is played.
#include "cli/serve/fleet_watch.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <mutex>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "ocm/host/descriptor.hpp"

#include "cli/fleet/robot_now.hpp"
#include "cli/shared/local_link.hpp"
#include "tool/captured.hpp"
#include "tool/thread_signals.hpp"
#include "unit/host/host_testing.hpp"

namespace serve_fleet_watch_test {

using namespace std::chrono_literals;
using namespace ocm;
using namespace ocm::cli::serve;
using cli::fleet::RobotNow;
using mapper::server::Progress;
using Json = nlohmann::json;
using Strings = std::vector<std::string>;

/// A program that has a central's line, for others that join it, one after the other. It has its robots do
/// at once what is ordered.
class Owner {
 public:
  Owner(const std::string& path, std::vector<RobotNow> robots)
      : robots_(std::move(robots)), listener_(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    REQUIRE(path.size() < sizeof address.sun_path);
    std::copy(path.begin(), path.end(), std::begin(address.sun_path));
    REQUIRE(::bind(listener_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
    REQUIRE(::listen(listener_.get(), 4) == 0);
    serves_ = std::thread{[this] { serve(); }};
  }
  ~Owner() {
    hang_up();
    ::shutdown(listener_.get(), SHUT_RDWR);  // no more are taken
    serves_.join();
  }
  Owner(const Owner&) = delete;
  Owner& operator=(const Owner&) = delete;

  /// Who has joined is left alone.
  void hang_up() {
    const std::lock_guard lock{mutex_};
    if (caller_ >= 0) ::shutdown(caller_, SHUT_RDWR);
  }
  /// Whether it has done all that it was asked.
  void set_idle(bool idle) {
    const std::lock_guard lock{mutex_};
    idle_ = idle;
  }
  /// What was asked but for its robots, in order.
  [[nodiscard]] Strings heard() {
    const std::lock_guard lock{mutex_};
    return heard_;
  }

 private:
  void serve() {
    for (;;) {
      const host::Descriptor caller{::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC)};
      if (!caller) return;
      is_caller(caller.get());
      std::string request(1000, '\0');
      for (ssize_t size = 0; (size = ::recv(caller.get(), request.data(), request.size(), 0)) > 0;) {
        const std::string answer = answer_to(request.substr(0, static_cast<std::size_t>(size)));
        static_cast<void>(::send(caller.get(), answer.data(), answer.size(), MSG_NOSIGNAL));
      }
      is_caller(-1);
    }
  }
  void is_caller(int descriptor) {
    const std::lock_guard lock{mutex_};
    caller_ = descriptor;
  }
  std::string answer_to(const std::string& request) {
    const std::lock_guard lock{mutex_};
    if (request.starts_with("robots ")) {
      std::string answer = idle_ ? "ok\nidle\n" : "ok\nwaits\n";
      for (const RobotNow& robot : robots_) answer += to_row(robot) + "\n";
      return answer;
    }
    heard_.push_back(request);
    if (request.starts_with("hello ")) return "ok\nplayed";
    if (request.starts_with("map ")) return "no\nit draws none\nask another one";
    const bool goes = request.starts_with("go ");
    if (!goes && !request.starts_with("stop ")) return "ok\n";
    robots_[0].order = ++orders_;
    robots_[0].progress = goes ? Progress::said : Progress::stopped;
    return "ok\n" + std::to_string(orders_);
  }

  std::mutex mutex_;
  std::vector<RobotNow> robots_;
  Strings heard_;
  bool idle_ = true;
  std::uint64_t orders_ = 0;
  int caller_ = -1;
  host::Descriptor listener_;
  std::thread serves_;
};

/// Linked, and 50 cm from where it began, where it looks ahead.
RobotNow linked(unsigned index, const std::string& name) {
  RobotNow robot;
  robot.index = index;
  robot.name = name;
  robot.address = "C" + std::to_string(index);
  robot.linked = robot.confirmed = robot.idle = robot.located = true;
  robot.quality_per_mille = 1000;
  robot.update.emplace();
  robot.update->x = 50;
  return robot;
}

/// A user's own folder, with a line in it.
struct Folder : test::TemporaryDirectory {
  Folder() {
    REQUIRE(::mkdir(file("ocm").c_str(), 0700) == 0);
    put_line();
  }
  [[nodiscard]] std::string line() const { return file("line"); }
  void put_line() const { std::ofstream{line()} << "a line\n"; }
};

/// A viewer of the robots of such a line.
struct Desk {
  Desk(std::vector<RobotNow> robots, Strings starts)
      : owner(cli::local_socket("line", cli::digits_of_path(folder.line())), std::move(robots)),
        watch(options(std::move(starts)), viewers, {0, 1}, orders) {
    REQUIRE(viewers.subscribe(viewer, {0, 0}).empty());
    watch.run([this] { woken.notify_one(); });
  }
  FleetOptions options(Strings starts) const {
    FleetOptions all;
    all.line.path = folder.line();
    all.starts = std::move(starts);
    return all;
  }
  void ask(std::string payload, Order::Kind kind = Order::Kind::publish) {
    Order order{kind, viewer};
    order.payload = std::move(payload);
    REQUIRE(orders.put(std::move(order)));
  }
  /// Takes what comes until it is so; whether it is within 20 s.
  bool until(const std::function<bool()>& is) {
    const auto end = std::chrono::steady_clock::now() + 20s;
    while (!is()) {
      viewers.hear(viewer);  // it answers whether it is there
      if (const auto message = viewers.next(viewer, base::Time{})) {
        if (!message->binary) {
          told.push_back(Json::parse(*message->payload)["message"]);
        } else if (message->head[1] == 0) {  // robots, and no map
          state = Json::parse(*message->payload);
          ++states;
        }
        continue;
      }
      if (std::chrono::steady_clock::now() >= end) return false;
      std::unique_lock lock{mutex};
      woken.wait_for(lock, 20ms);
    }
    return true;
  }
  [[nodiscard]] std::size_t robots() const { return state.contains("robots") ? state["robots"].size() : 0; }
  [[nodiscard]] bool is_told(std::string_view words) const {
    return std::any_of(told.begin(), told.end(),
                       [words](const std::string& each) { return each.find(words) != std::string::npos; });
  }
  [[nodiscard]] std::ptrdiff_t times_heard(const std::string& request) {
    const Strings all = owner.heard();
    return std::count(all.begin(), all.end(), request);
  }
  [[nodiscard]] bool has_heard(const std::string& request) { return times_heard(request) != 0; }

  test::Captured errors{STDERR_FILENO};
  Folder folder;
  test::Environment runtime{"XDG_RUNTIME_DIR", folder.path().c_str()};
  Owner owner;
  Viewers viewers{2};
  Orders orders;
  ViewerId viewer = viewers.add();
  Json state = Json::object();
  std::size_t states = 0;  ///< that came
  Strings told;
  std::mutex mutex;
  std::condition_variable woken;
  FleetWatch watch;
};

TEST_CASE("fleet watch: robots are where the starts say that they began, and do what a viewer asks") {
  RobotNow second = linked(1, "B");
  second.linked = false;
  Desk desk{{linked(0, "A"), second}, {"A=1,2,90"}};
  REQUIRE(desk.until([&] { return desk.robots() == 2; }));
  CHECK(desk.state["line"].get<std::string>().starts_with("played (process "));
  CHECK(desk.state["own"] == false);
  CHECK(desk.state["gone"] == "");
  CHECK(desk.state["scans"] == false);
  CHECK(desk.state["map_by"] == "");
  CHECK(desk.state["unplaced"] == Json::array({"B"}));
  const Json first = desk.state["robots"][0];
  CHECK(first["at"]["x_m"].get<double>() == Approx(1).margin(1e-6));
  CHECK(first["at"]["y_m"].get<double>() == Approx(2.5));
  CHECK(first["target"].is_null());
  CHECK(desk.state["robots"][1]["at"].is_null());

  desk.ask(R"({"robot":"A"})");
  CHECK(desk.until([&] { return desk.is_told("expected a robot with a place or an order"); }));
  desk.ask(R"({"order":"look"})");
  CHECK(desk.until([&] { return desk.has_heard("scan 3000"); }));
  CHECK(desk.until([&] { return desk.has_heard("connect 1"); }));
  CHECK_FALSE(desk.has_heard("connect 0"));          // it is linked
  desk.ask(R"({"robot":"A","x_m":1,"y_m":3.005})");  // 50.5 cm ahead
  CHECK(desk.until([&] { return desk.has_heard("go 0 0 50"); }));
  CHECK(desk.until([&] { return !desk.state["robots"][0]["target"].is_null(); }));
  CHECK(desk.state["robots"][0]["target"]["x_m"] == 1);
  CHECK(desk.state["robots"][0]["target"]["y_m"].get<double>() == Approx(3.005));
  CHECK_FALSE(desk.has_heard("stop 0"));
  desk.ask("", Order::Kind::gone);
  CHECK(desk.until([&] { return desk.has_heard("stop 0"); }));
}

TEST_CASE("fleet watch: one robot alone began where its map begins") {
  Desk desk{{linked(0, "A")}, {}};
  REQUIRE(desk.until([&] { return desk.robots() == 1; }));
  CHECK(desk.state["unplaced"] == Json::array());
  CHECK(desk.state["robots"][0]["at"]["x_m"].get<double>() == Approx(0.5));
  CHECK(desk.state["robots"][0]["at"]["y_m"].get<double>() == Approx(0).margin(1e-6));
}

TEST_CASE("fleet watch: a line that is gone is waited for, and joined again when it is there") {
  Desk desk{{linked(0, "A"), linked(1, "B")}, {}};
  REQUIRE(desk.until([&] { return desk.robots() == 2; }));
  constexpr const char* gone =
      "the central's line is gone, or the program that had it has ended: waiting for it";
  std::filesystem::remove(desk.folder.line());
  desk.owner.hang_up();
  REQUIRE(desk.until([&] { return desk.state["gone"] != ""; }));
  CHECK(desk.state["gone"] == gone);
  CHECK(desk.robots() == 0);
  CHECK(desk.state["unplaced"] == Json::array());
  CHECK(desk.is_told(gone));
  desk.told.clear();
  desk.ask(R"({"robot":"A","order":"stop"})");
  CHECK(desk.until([&] { return desk.is_told(gone); }));
  CHECK_FALSE(desk.has_heard("stop 0"));
  desk.folder.put_line();
  REQUIRE(desk.until([&] { return desk.robots() == 2; }));
  CHECK(desk.state["gone"] == "");
  CHECK(desk.is_told("it has joined played (process "));
}

TEST_CASE("fleet watch: robots are said five times a second, and a map is asked for once a second") {
  const auto begin = std::chrono::steady_clock::now();
  Desk desk{{linked(0, "A")}, {}};
  REQUIRE(desk.viewers.subscribe(desk.viewer, {1, 1}).empty());
  REQUIRE(desk.until([&] { return desk.states == 2; }));
  const auto maps = desk.times_heard("map grid");
  const auto passed = std::chrono::steady_clock::now() - begin;
  CHECK(passed >= 200ms);
  CHECK(maps >= 1);  // as it joins
  CHECK(maps <= 2 + passed / 1s);
}

TEST_CASE("fleet watch: one look at a time, which is said while it lasts, and links behind it") {
  RobotNow second = linked(1, "B");
  second.linked = false;
  Desk desk{{linked(0, "A"), second}, {}};
  REQUIRE(desk.until([&] { return desk.robots() == 2; }));
  desk.owner.set_idle(false);
  for (int i = 0; i < 2; ++i) desk.ask(R"({"order":"look"})");
  REQUIRE(desk.until([&] { return desk.state["scans"] == true; }));
  CHECK(desk.times_heard("scan 3000") == 1);
  CHECK_FALSE(desk.has_heard("connect 1"));
  desk.owner.set_idle(true);
  CHECK(desk.until([&] { return desk.has_heard("connect 1"); }));
}

TEST_CASE("fleet watch: signals are not for its thread") {
  const auto before = test::kept_away();
  Desk desk{{linked(0, "A")}, {}};
  REQUIRE(desk.until([&] { return desk.robots() == 1; }));  // it runs
  const auto all = test::kept_away();
  CHECK(std::count_if(all.begin(), all.end(), [&](const auto& each) {
          return !before.contains(each.first) && test::keeps_all_away(each.second);
        }) == 1);
}

}  // namespace serve_fleet_watch_test
