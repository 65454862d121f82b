#include "cli/serve/live_bus.hpp"

#ifdef OCM_HAS_WEBSOCKETS

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <unistd.h>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "ocm/topics/amiro.hpp"

#include "cli/command/operated_bus.hpp"
#include "cli/shared/operator_link.hpp"
#include "generator/spec/model.hpp"
#include "tool/captured.hpp"
#include "tool/serve/played_operator.hpp"

namespace serve_live_bus_test {

using namespace ocm;
using namespace ocm::cli::serve;
using Json = nlohmann::json;

/// Of a name that no operator's bus has.
const std::string quiet = "quiet" + std::to_string(::getpid());

/// On which no frame comes; some have never reached its reader.
class QuietBus final : public transport::Bus {
 public:
  explicit QuietBus(std::uint64_t lost) { counters_.lost = lost; }

  [[nodiscard]] std::string_view name() const override { return quiet; }
  base::Result<bool> send(const can::Frame&) override { return true; }
  base::Result<can::Received> receive(base::Duration) override { return base::Error::timed_out; }
  transport::Outcome<void> subscribe(std::span<const can::Filter>) override { return {}; }
  [[nodiscard]] int descriptor() const override { return -1; }
  [[nodiscard]] const transport::BusCounters& counters() const override { return counters_; }
  [[nodiscard]] const transport::Failure& failure() const override { return failure_; }

 private:
  transport::BusCounters counters_;
  transport::Failure failure_;
};

TEST_CASE("live bus: what is lost of a bus is in its figures from the first moment") {
  const spec::Model model;
  ServeOptions options;
  options.over = [looks = 0]() mutable { return looks++ != 0; };  // it looks once
  PageServer server{amiro::catalogue, model, std::move(options), {quiet, true, false}, {quiet}, 500'000};
  test::Captured address{STDOUT_FILENO};
  server.open();
  CHECK(address.text().starts_with("http://127.0.0.1:"));
  const ViewerId viewer = server.viewers().add();
  const Channels& channels = server.channels();
  for (const State state : {State::bus, State::boards, State::bounds, State::operator_})
    REQUIRE(
        server.viewers().subscribe(viewer, {static_cast<std::uint32_t>(state), channels.of(state)}).empty());
  cli::Session session;
  CHECK(serve_bus(server, session, std::make_unique<QuietBus>(3)) == 0);
  std::map<State, Json> said;
  while (const auto message = server.viewers().next(viewer, base::Time{}))
    said[static_cast<State>(message->head[1])] = Json::parse(*message->payload);
  REQUIRE(said.size() == 4);
  CHECK(said[State::bus]["buses"][0]["name"] == quiet);
  CHECK(said[State::bus]["buses"][0]["lost"] == 3);
  CHECK(said[State::bus]["viewers"] == 1);
  CHECK(said[State::boards]["boards"].size() == 3);
  REQUIRE(said[State::boards]["findings"].size() == 1);
  CHECK(said[State::boards]["findings"][0]["what"] == "3 frames lost on the way to this program");
  CHECK(said[State::bounds]["rows"] == Json::array());
  CHECK(said[State::operator_]["running"] == false);
}

TEST_CASE("live bus: figures of the bus come four times a second, and boards and response times once") {
  using std::chrono::milliseconds, std::chrono::seconds;
  const spec::Model model;
  std::function<bool()> over;
  ServeOptions options;
  options.over = [&over] { return over(); };
  PageServer server{amiro::catalogue, model, std::move(options), {quiet, true, false}, {quiet}, 500'000};
  test::Captured address{STDOUT_FILENO};
  server.open();
  address.text();
  const ViewerId viewer = server.viewers().add();
  for (const State state : {State::bus, State::boards, State::bounds, State::operator_})
    REQUIRE(server.viewers()
                .subscribe(viewer, {static_cast<std::uint32_t>(state), server.channels().of(state)})
                .empty());
  std::map<State, std::int64_t> count;
  over = [&, looks = 0]() mutable {  // it looks twice
    while (const auto message = server.viewers().next(viewer, base::Time{}))
      ++count[static_cast<State>(message->head[1])];
    return looks++ == 2;
  };
  const auto begin = std::chrono::steady_clock::now();
  cli::Session session;
  CHECK(serve_bus(server, session, std::make_unique<QuietBus>(0)) == 0);
  const auto passed = std::chrono::steady_clock::now() - begin;
  CHECK(passed >= milliseconds{250});
  for (const State often : {State::bus, State::operator_}) CHECK(count[often] == 2);
  for (const State seldom : {State::boards, State::bounds}) {
    CHECK(count[seldom] >= 1);
    CHECK(count[seldom] <= 1 + passed / seconds{1});
  }
}

/// Keeps what is sent, and has a frame of the gyroscope come behind each.
class TakingBus final : public transport::Bus {
 public:
  explicit TakingBus(std::vector<can::Frame>& sent) : sent_(&sent) {}

  [[nodiscard]] std::string_view name() const override { return quiet; }
  base::Result<bool> send(const can::Frame& frame) override {
    sent_->push_back(frame);
    comes_ = true;
    return true;
  }
  base::Result<can::Received> receive(base::Duration) override {
    if (!std::exchange(comes_, false)) return base::Error::timed_out;
    can::Frame frame;
    frame.id = 0x608;
    frame.dlc = 6;
    frame.data[0] = 4;
    return can::Received{base::Time{std::chrono::hours{500'000}}, frame};
  }
  transport::Outcome<void> subscribe(std::span<const can::Filter>) override { return {}; }
  [[nodiscard]] int descriptor() const override { return -1; }
  [[nodiscard]] const transport::BusCounters& counters() const override { return counters_; }
  [[nodiscard]] const transport::Failure& failure() const override { return failure_; }

 private:
  std::vector<can::Frame>* sent_;
  bool comes_ = false;
  transport::BusCounters counters_;
  transport::Failure failure_;
};

TEST_CASE("live bus: what a viewer commands goes to the bus, and what comes from there to viewers") {
  const spec::Model model;
  ServeOptions options;
  options.commands = true;
  std::vector<can::Frame> sent;
  const auto begin = std::chrono::steady_clock::now();
  options.over = [&, looks = 0]() mutable {  // one look behind the one in which it has left
    looks += sent.empty() ? 0 : 1;
    return looks == 2 || std::chrono::steady_clock::now() - begin > std::chrono::seconds{20};
  };
  PageServer server{amiro::catalogue, model, std::move(options), {quiet, true, true}, {quiet}, 500'000};
  test::Captured address{STDOUT_FILENO};
  server.open();
  address.text();
  const ViewerId viewer = server.viewers().add();
  for (const foxglove::Channel& channel : server.channels().all())
    if (channel.topic == "/led_1" || channel.topic == "/gyroscope" || channel.topic == "/ocm/bus")
      REQUIRE(server.viewers().subscribe(viewer, {channel.id, channel.id}).empty());
  REQUIRE(server.orders().put({Order::Kind::publish, viewer, "/led_1", R"({"red":7})"}));
  REQUIRE(server.orders().put({Order::Kind::publish, viewer, "/motors", R"({"x":"fast"})"}));
  cli::Session session;
  CHECK(serve_bus(server, session, std::make_unique<TakingBus>(sent)) == 0);
  REQUIRE(sent.size() == 1);
  CHECK(sent[0].data[0] == 7);
  std::map<std::string, Json> said;
  while (const auto message = server.viewers().next(viewer, base::Time{}))
    said[message->binary ? server.channels().topic(message->head[1]) : std::string{}] =
        Json::parse(*message->payload);
  CHECK(said["/led_1"] == Json{{"red", 7}, {"green", 0}, {"blue", 0}});
  CHECK(said["/gyroscope"]["x"].get<double>() == Approx(4 * 0.0175));
  CHECK(said["/ocm/bus"]["buses"][0]["name"] == quiet);
  CHECK(said[""]["message"].get<std::string>().starts_with("/motors: "));
}

/// What was said to a viewer.
struct Told {
  void take(Viewers& viewers, ViewerId viewer) {
    while (const auto message = viewers.next(viewer, base::Time{}))
      if (!message->binary) all.push_back(Json::parse(*message->payload)["message"]);
  }
  [[nodiscard]] bool has(std::string_view words) const {
    return std::any_of(all.begin(), all.end(),
                       [words](const std::string& each) { return each.find(words) != std::string::npos; });
  }
  std::vector<std::string> all;
};

TEST_CASE("live bus: an operator that was silent is gone through again, and one that has ended no longer") {
  test::PlayedOperator guard{quiet};
  auto link = cli::connect_operator(quiet, "serve");
  REQUIRE(link);
  REQUIRE(*link != nullptr);
  CHECK((*link)->ask("end").kind == cli::OperatorAnswer::Kind::silent);
  REQUIRE((*link)->over());

  std::vector<can::Frame> sent;
  auto bus = std::make_unique<cli::OperatedBus>(std::make_unique<TakingBus>(sent), std::move(*link),
                                                amiro::catalogue, "serve");
  const spec::Model model;
  std::function<bool()> over;
  ServeOptions options;
  options.commands = true;
  options.over = [&over] { return over(); };
  PageServer server{amiro::catalogue, model, std::move(options), {quiet, true, true}, {quiet}, 500'000};
  test::Captured address{STDOUT_FILENO};
  server.open();
  address.text();
  const ViewerId viewer = server.viewers().add();
  Told told;
  bool has_ended = false;
  const auto begin = std::chrono::steady_clock::now();
  over = [&] {
    told.take(server.viewers(), viewer);
    if (!has_ended && told.has("guards the robot")) {
      has_ended = true;
      guard.end();
      // Which is seen by who asks it.
      CHECK(server.orders().put({Order::Kind::publish, viewer, "/led_1", R"({"red":7})"}));
    }
    return told.has("no operator runs any more") ||
           std::chrono::steady_clock::now() - begin > std::chrono::seconds{20};
  };
  cli::Session session;
  test::Captured errors{STDERR_FILENO};
  const int code = serve_bus(server, session, std::move(bus));
  const std::string said = errors.text();
  CHECK(code == 0);
  REQUIRE(told.all.size() >= 2);
  CHECK_THAT(told.all.front(), Catch::Matches("operator guard \\(process [0-9]+\\) guards the robot: set "
                                              "points go through it"));
  CHECK(told.all.back() == "no operator runs any more: what viewers command goes to the bus itself");
  for (const std::string& each : {told.all.front(), told.all.back()})
    CHECK(said.find("serve: " + each + "\n") != std::string::npos);
  CHECK(sent.empty());
}

TEST_CASE("live bus: while an operator does not answer, viewers command nothing") {
  const test::PlayedOperator guard{quiet, {{"hello ", "no\nit is asked too much\nwait"}}};
  const spec::Model model;
  std::function<bool()> over;
  ServeOptions options;
  options.commands = true;
  options.over = [&over] { return over(); };
  PageServer server{amiro::catalogue, model, std::move(options), {quiet, true, true}, {quiet}, 500'000};
  test::Captured address{STDOUT_FILENO};
  server.open();
  address.text();
  const ViewerId viewer = server.viewers().add();
  Told told;
  std::vector<can::Frame> sent;
  std::size_t orders = 0;
  const auto begin = std::chrono::steady_clock::now();
  over = [&] {  // it may not know of the operator yet
    told.take(server.viewers(), viewer);
    if (!told.all.empty() || std::chrono::steady_clock::now() - begin > std::chrono::seconds{20}) return true;
    CHECK(server.orders().put({Order::Kind::publish, viewer, "/led_1", R"({"red":7})"}));
    ++orders;
    return false;
  };
  cli::Session session;
  const int code = serve_bus(server, session, std::make_unique<TakingBus>(sent));
  CHECK(code == 0);
  REQUIRE_FALSE(told.all.empty());
  for (const std::string& each : told.all)
    CHECK(each == "an operator guards the robot, and does not answer: end it, or start it again");
  CHECK(sent.size() + told.all.size() == orders);
}

/// Takes no frame; it may be gone for good.
class FullBus final : public transport::Bus {
 public:
  explicit FullBus(const bool& gone) : gone_(&gone) {}

  [[nodiscard]] std::string_view name() const override { return quiet; }
  base::Result<bool> send(const can::Frame&) override { return false; }
  base::Result<can::Received> receive(base::Duration) override { return base::Error::timed_out; }
  transport::Outcome<void> subscribe(std::span<const can::Filter>) override { return {}; }
  [[nodiscard]] int descriptor() const override { return -1; }
  [[nodiscard]] const transport::BusCounters& counters() const override { return counters_; }
  [[nodiscard]] transport::BusState state() const override {
    return *gone_ ? transport::BusState::closed : transport::BusState::up;
  }
  [[nodiscard]] const transport::Failure& failure() const override { return failure_; }

 private:
  const bool* gone_;
  transport::BusCounters counters_;
  transport::Failure failure_;
};

TEST_CASE("live bus: what has not left at the end is said, and the exit code says it, too") {
  const spec::Model model;
  std::function<bool()> over;
  ServeOptions options;
  options.commands = true;
  options.over = [&over] { return over(); };
  PageServer server{amiro::catalogue, model, std::move(options), {quiet, true, true}, {quiet}, 500'000};
  test::Captured address{STDOUT_FILENO};
  server.open();
  address.text();
  const ViewerId viewer = server.viewers().add();
  Told told;
  bool gone = false;
  const auto begin = std::chrono::steady_clock::now();
  over = [&] {
    told.take(server.viewers(), viewer);
    gone = told.has("the bus takes no frame: ") ||
           std::chrono::steady_clock::now() - begin > std::chrono::seconds{20};
    return gone;  // or the rest of the motors would be waited for
  };
  REQUIRE(server.orders().put({Order::Kind::publish, viewer, "/motors", R"({"x":0.1})"}));
  cli::Session session;
  test::Captured errors{STDERR_FILENO};
  const int code = serve_bus(server, session, std::make_unique<FullBus>(gone));
  CHECK(code == 1);
  CHECK_THAT(errors.text(),
             Catch::Contains("serve: 1 frame did not leave " + quiet +
                             ", and may leave later; THE ROBOT MAY STILL MOVE") &&
                 Catch::Contains("no node acknowledges the frames: is a board powered and connected"));
}

}  // namespace serve_live_bus_test

#endif
