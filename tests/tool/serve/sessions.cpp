#include "cli/serve/sessions.hpp"

#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

namespace serve_sessions_test {

using namespace ocm::cli::serve;
using namespace std::string_literals;

/// A server of the AMiRo's topics, and what it says to a viewer.
struct Server {
  explicit Server(bool commands, bool playback = false)
      : sessions{{"AMiRo", "s", commands, playback}, amiro::catalogue, channels, viewers, orders} {}

  ViewerId open(bool token) {
    const ViewerId viewer = viewers.add();
    sessions.opened(viewer, token);
    return viewer;
  }
  std::vector<std::string> said(ViewerId viewer) {
    std::vector<std::string> texts;
    while (const auto message = viewers.next(viewer, ocm::base::Time{})) texts.push_back(*message->payload);
    return texts;
  }
  bool says(ViewerId viewer, std::string_view words) {
    for (const std::string& text : said(viewer))
      if (text.find(words) != std::string::npos) return true;
    return false;
  }

  Channels channels{amiro::catalogue, std::vector{"sim"s}};
  Viewers viewers{channels.all().size()};
  Orders orders;
  Sessions sessions;
};

const std::string advertise_motors =
    R"({"op":"advertise","channels":[{"id":1,"topic":"/motors","encoding":"json","schemaName":""}]})";
const std::string drive_message = "\x01\x01\0\0\0{\"x\":0.1}"s;

TEST_CASE("sessions: who connects gets server and channels") {
  Server server{false};
  const ViewerId viewer = server.open(false);
  const auto said = server.said(viewer);
  REQUIRE(said.size() == 2);
  CHECK(said[0].find(R"("op":"serverInfo")") != std::string::npos);
  CHECK(said[0].find("clientPublish") == std::string::npos);
  CHECK(said[1].find(R"("topic":"/gyroscope")") != std::string::npos);
  CHECK(said[1].find(R"("topic":"/ocm/robot")") != std::string::npos);
}

TEST_CASE("sessions: what is said to all meanwhile comes behind server and channels") {
  Server server{false};
  const ViewerId viewer = server.viewers.add();
  server.viewers.tell(0, "to all");
  server.sessions.opened(viewer, false);
  const auto said = server.said(viewer);
  REQUIRE(said.size() == 3);
  CHECK(said[0].find(R"("op":"serverInfo")") != std::string::npos);
  CHECK(said[1].find(R"("op":"advertise")") != std::string::npos);
  CHECK(said[2] == "to all");
}

TEST_CASE("sessions: no command without the token, nor without a server that takes any") {
  for (const auto& [server_takes, token] : {std::pair{false, true}, {true, false}, {false, false}}) {
    Server server{server_takes};
    const ViewerId viewer = server.open(token);
    CHECK_FALSE(server.says(viewer, "clientPublish"));
    server.sessions.text(viewer, advertise_motors);
    CHECK(server.says(viewer, "may only look"));
    server.sessions.binary(viewer, drive_message);
    CHECK(server.says(viewer, "was not advertised"));
    server.sessions.text(
        viewer, R"({"op":"setParameters","parameters":[{"name":"/gyroscope/period_ms","value":5}]})");
    CHECK(server.says(viewer, "may only look"));
    CHECK(server.orders.take().empty());
  }
  Server server{true};
  const ViewerId viewer = server.open(true);
  CHECK(server.says(viewer, "clientPublish"));
  server.sessions.text(viewer, advertise_motors);
  server.sessions.binary(viewer, drive_message);
  server.sessions.text(
      viewer,
      R"({"op":"setParameters","parameters":[{"name":"/gyroscope/period_ms","value":5},{"name":"/x","value":1}]})");
  CHECK(server.says(viewer, "there is no parameter /x"));
  const auto orders = server.orders.take();
  REQUIRE(orders.size() == 2);
  CHECK(orders[0].kind == Order::Kind::publish);
  CHECK(orders[0].viewer == viewer);
  CHECK(orders[0].topic == "/motors");
  CHECK(orders[0].payload == R"({"x":0.1})");
  CHECK(orders[1].kind == Order::Kind::parameter);
  CHECK(orders[1].value == 5);
}

TEST_CASE("sessions: a log's time bar is for all, and for nothing else") {
  Server server{false, true};
  const ViewerId viewer = server.open(false);
  CHECK(server.says(viewer, "clientPublish"));
  server.sessions.text(
      viewer,
      R"({"op":"advertise","channels":[{"id":3,"topic":"/ocm/playback","encoding":"json","schemaName":""}]})");
  server.sessions.text(viewer, advertise_motors);
  CHECK(server.says(viewer, "may only look"));
  server.sessions.binary(viewer, "\x01\x03\0\0\0{\"at_s\":1}"s);
  const auto orders = server.orders.take();
  REQUIRE(orders.size() == 1);
  CHECK(orders[0].kind == Order::Kind::playback);
}

TEST_CASE("sessions: a flood of orders is bounded, and who has gone is known all the same") {
  Server server{true};
  const ViewerId viewer = server.open(true);
  server.said(viewer);
  server.sessions.text(viewer, advertise_motors);
  for (std::size_t i = 0; i < Orders::most + 10; ++i) server.sessions.binary(viewer, drive_message);
  CHECK(server.says(viewer, "too many commands"));
  server.sessions.gone(viewer);
  const auto orders = server.orders.take();
  CHECK(orders.size() == Orders::most + 1);
  CHECK(orders.back().kind == Order::Kind::gone);
  for (int id = 2; id < 80; ++id) {
    const ViewerId other = id == 2 ? server.open(true) : viewer + 1;
    server.sessions.text(other, R"({"op":"advertise","channels":[{"id":)" + std::to_string(id) +
                                    R"(,"topic":"/motors","encoding":"json","schemaName":""}]})");
  }
  CHECK(server.says(viewer + 1, "64 channels of a viewer are the most"));
}

TEST_CASE("sessions: the flood of a viewer keeps no other one's stop out") {
  Server server{true};
  const ViewerId flooder = server.open(true);
  const ViewerId other = server.open(true);
  for (const ViewerId viewer : {flooder, other}) server.sessions.text(viewer, advertise_motors);
  for (std::size_t i = 0; i < 2 * Orders::most; ++i) server.sessions.binary(flooder, drive_message);
  server.said(other);
  server.sessions.binary(other, drive_message);
  CHECK(server.said(other).empty());
  server.sessions.binary(other, drive_message);  // it has one there already
  CHECK(server.says(other, "too many commands"));
  const auto orders = server.orders.take();
  REQUIRE(orders.size() == Orders::most + 1);
  CHECK(orders.back().viewer == other);
  CHECK(server.orders.take().empty());
}

TEST_CASE("sessions: an error answers what is no request") {
  Server server{true};
  const ViewerId viewer = server.open(true);
  server.said(viewer);
  server.sessions.text(viewer, "{");
  CHECK(server.says(viewer, "no JSON"));
  server.sessions.binary(viewer, "");
  CHECK(server.says(viewer, "a binary message"));
  server.sessions.text(viewer, R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":9999}]})");
  CHECK(server.says(viewer, "there is no channel 9999"));
}

TEST_CASE("sessions: what the bus has shown is asked of who knows it") {
  Server server{true};
  const ViewerId viewer = server.open(true);
  const std::uint32_t state = server.channels.of(State::robot);
  server.sessions.text(viewer,
                       R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":2},{"id":2,"channelId":)" +
                           std::to_string(state) + R"(},{"id":3,"channelId":9999}]})");
  server.sessions.text(viewer,
                       R"({"op":"getParameters","parameterNames":["/gyroscope/period_ms"],"id":"r"})");
  server.sessions.text(viewer, R"({"op":"subscribeParameterUpdates","parameterNames":["/a","/b"]})");
  server.sessions.text(viewer, R"({"op":"unsubscribeParameterUpdates","parameterNames":["/a"]})");
  const auto orders = server.orders.take();
  REQUIRE(orders.size() == 4);
  CHECK(orders[0].kind == Order::Kind::newest);
  CHECK(orders[0].channels == std::vector<std::uint32_t>{2});  // states are there already
  CHECK(orders[1].kind == Order::Kind::get_parameters);
  CHECK(orders[1].names == std::vector<std::string>{"/gyroscope/period_ms"});
  CHECK(orders[1].payload == "r");
  CHECK(orders[2].kind == Order::Kind::subscribe_parameters);
  CHECK(orders[2].names.size() == 2);
  CHECK(orders[3].kind == Order::Kind::unsubscribe_parameters);
}

TEST_CASE("sessions: orders for robots behind a central have a way of their own") {
  Channels channels{amiro::catalogue, std::vector{"sim"s}, true};
  Viewers viewers{channels.all().size()};
  Orders orders, fleet;
  Sessions sessions{{"AMiRo", "s", true, false, &fleet}, amiro::catalogue, channels, viewers, orders};
  const ViewerId viewer = viewers.add();
  sessions.opened(viewer, true);
  sessions.text(
      viewer,
      R"({"op":"advertise","channels":[{"id":1,"topic":"/ocm/fleet","encoding":"json","schemaName":""}]})");
  sessions.binary(viewer, "\x01\x01\0\0\0{\"order\":\"look\"}"s);
  CHECK(orders.take().empty());
  const auto taken = fleet.take();
  REQUIRE(taken.size() == 1);
  CHECK(taken[0].payload == R"({"order":"look"})");
  // All else is for the bus.
  sessions.text(
      viewer,
      R"({"op":"advertise","channels":[{"id":2,"topic":"/motors","encoding":"json","schemaName":""}]})");
  sessions.binary(viewer, "\x01\x02\0\0\0{\"x\":0.1}"s);
  CHECK(fleet.take().empty());
  const auto of_bus = orders.take();
  REQUIRE(of_bus.size() == 1);
  CHECK(of_bus[0].topic == "/motors");
  sessions.gone(viewer);
  CHECK(orders.take().back().kind == Order::Kind::gone);
  CHECK(fleet.take().back().kind == Order::Kind::gone);
  // Without the token nothing reaches it.
  const ViewerId other = viewers.add();
  sessions.opened(other, false);
  sessions.text(
      other,
      R"({"op":"advertise","channels":[{"id":1,"topic":"/ocm/fleet","encoding":"json","schemaName":""}]})");
  sessions.binary(other, "\x01\x01\0\0\0{\"order\":\"look\"}"s);
  CHECK(fleet.take().empty());
  CHECK(channels.all()[channels.of(State::map)].topic == "/ocm/map");
  CHECK(channels.all()[channels.of(State::fleet)].topic == "/ocm/fleet");
}

TEST_CASE("sessions: without robots behind a central, orders for them go the way of all others") {
  Server server{true};
  const ViewerId viewer = server.open(true);
  server.sessions.text(
      viewer,
      R"({"op":"advertise","channels":[{"id":1,"topic":"/ocm/fleet","encoding":"json","schemaName":""}]})");
  server.sessions.binary(viewer, "\x01\x01\0\0\0{\"order\":\"look\"}"s);
  const auto orders = server.orders.take();
  REQUIRE(orders.size() == 1);
  CHECK(orders[0].kind == Order::Kind::publish);
  CHECK(orders[0].topic == "/ocm/fleet");
}

TEST_CASE("sessions: channels of a viewer, up to 64, each once and in JSON") {
  Server server{true};
  const ViewerId viewer = server.open(true);
  server.said(viewer);
  const auto advertise = [&](int id, const std::string& encoding = "json") {
    server.sessions.text(viewer, R"({"op":"advertise","channels":[{"id":)" + std::to_string(id) +
                                     R"(,"topic":"/motors","encoding":")" + encoding + R"("}]})");
    return server.said(viewer);
  };
  CHECK(server.says(viewer, "x") == false);
  CHECK(advertise(1, "protobuf").at(0).find("/motors: encoding 'protobuf': only json is taken") !=
        std::string::npos);
  for (int id = 1; id <= 64; ++id) CHECK(advertise(id).empty());
  CHECK(advertise(65).at(0).find("64 channels of a viewer are the most") != std::string::npos);
  server.sessions.text(viewer, R"({"op":"unadvertise","channelIds":[64,99]})");
  CHECK(server.says(viewer, "channel 99 was not advertised"));
  CHECK(advertise(63).at(0).find("channel 63 was advertised already") != std::string::npos);
  CHECK(advertise(65).empty());
  server.sessions.binary(viewer, "\x01\x40\0\0\0{}"s);
  CHECK(server.says(viewer, "channel 64 was not advertised"));
  CHECK(server.orders.take().empty());
}

TEST_CASE("sessions: the server offers a viewer what it may do") {
  const auto can = [](bool commands, bool playback, bool token) {
    Server server{commands, playback};
    const std::string info = server.said(server.open(token)).at(0);
    return std::pair{info.find("clientPublish") != std::string::npos,
                     info.find("parameters") != std::string::npos};
  };
  CHECK(can(true, false, true) == std::pair{true, true});
  CHECK(can(true, false, false) == std::pair{false, false});
  CHECK(can(false, false, true) == std::pair{false, false});
  CHECK(can(false, true, false) == std::pair{true, false});  // a log is wound, and has no periods
}

TEST_CASE("sessions: who sets parameters gets them back where it asks for that") {
  Server server{true};
  const ViewerId viewer = server.open(true);
  server.said(viewer);
  const std::string set = R"({"op":"setParameters","parameters":[{"name":"/gyroscope/period_ms","value":5}])";
  server.sessions.text(viewer, set + "}");
  CHECK(server.said(viewer).empty());
  server.sessions.text(viewer, set + R"(,"id":"q"})");
  CHECK(server.said(viewer).empty());  // what has become of them is seen on the bus
  const auto orders = server.orders.take();
  REQUIRE(orders.size() == 3);
  CHECK(orders[0].topic == "/gyroscope/period_ms");
  CHECK(orders[0].viewer == viewer);
  CHECK(orders[2].kind == Order::Kind::confirm_parameters);
  CHECK(orders[2].viewer == viewer);
  CHECK(orders[2].payload == "q");
  CHECK(orders[2].names == std::vector<std::string>{"/gyroscope/period_ms"});

  server.sessions.text(viewer, R"({"op":"setParameters","parameters":[{"name":"/x","value":5}],"id":"r"})");
  const auto said = server.said(viewer);
  REQUIRE(said.size() == 2);
  CHECK(said[0].find("there is no parameter /x") != std::string::npos);
  CHECK(said[1].find(R"("parameters":[])") != std::string::npos);
  CHECK(said[1].find(R"("id":"r")") != std::string::npos);
  CHECK(server.orders.take().empty());
}

TEST_CASE("sessions: subscriptions end, and who has gone is heard no more") {
  Server server{true};
  const ViewerId viewer = server.open(true);
  server.said(viewer);
  server.sessions.text(viewer, R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":2}]})");
  CHECK(server.viewers.wanted(2));
  server.sessions.text(viewer, R"({"op":"unsubscribe","subscriptionIds":[1,7]})");
  CHECK_FALSE(server.viewers.wanted(2));
  CHECK(server.says(viewer, "there is no subscription 7"));
  // Of states alone the bus is not asked.
  static_cast<void>(server.orders.take());
  server.sessions.text(viewer, R"({"op":"subscribe","subscriptions":[{"id":2,"channelId":)" +
                                   std::to_string(server.channels.of(State::bus)) + "}]}");
  CHECK(server.orders.take().empty());
  server.sessions.gone(viewer);
  CHECK(server.orders.take().size() == 1);
  server.sessions.text(viewer, "{");
  server.sessions.binary(viewer, "");
  CHECK(server.said(viewer).empty());
}

}  // namespace serve_sessions_test
