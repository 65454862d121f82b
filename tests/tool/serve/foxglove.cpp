#include "cli/serve/foxglove.hpp"

#include <string>

#include <catch2/catch.hpp>

namespace serve_foxglove_test {

using namespace ocm::cli::serve::foxglove;
using Op = Request::Op;

TEST_CASE("foxglove: what the server says") {
  CHECK(server_info({"AMiRo, sim", "s1", false, false}) ==
        R"({"op":"serverInfo","name":"AMiRo, sim","capabilities":[],"metadata":{},"sessionId":"s1"})");
  CHECK(
      server_info({"A", "s", true, true}) ==
      R"({"op":"serverInfo","name":"A","capabilities":["clientPublish","parameters","parametersSubscribe"],)"
      R"("supportedEncodings":["json"],"metadata":{},"sessionId":"s"})");
  const Channel channel{7, "/gyroscope", "AMiRo.gyroscope", R"({"type":"object"})"};
  CHECK(
      advertise({&channel, 1}) ==
      R"({"op":"advertise","channels":[{"id":7,"topic":"/gyroscope","encoding":"json",)"
      R"("schemaName":"AMiRo.gyroscope","schemaEncoding":"jsonschema","schema":"{\"type\":\"object\"}"}]})");
  CHECK(status(Level::warning, "slow", "loss") ==
        R"({"op":"status","level":1,"message":"slow","id":"loss"})");
  CHECK(status(Level::error, "no") == R"({"op":"status","level":2,"message":"no"})");
  const Parameter parameters[] = {{"/gyroscope/period_ms", 50.0}, {"/odometry/period_ms", {}}};
  CHECK(
      parameter_values(parameters, "r") ==
      R"({"op":"parameterValues","parameters":[{"name":"/gyroscope/period_ms","value":50.0,"type":"float64"},)"
      R"({"name":"/odometry/period_ms"}],"id":"r"})");
  CHECK(message_head(0x04030201, 0x0807060504030201) == MessageHead{1, 1, 2, 3, 4, 1, 2, 3, 4, 5, 6, 7, 8});
}

TEST_CASE("foxglove: what a client asks") {
  const auto subscribe =
      parse(R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":3},{"id":4294967295,"channelId":1}]})");
  REQUIRE(subscribe);
  CHECK(subscribe->op == Op::subscribe);
  REQUIRE(subscribe->subscriptions.size() == 2);
  CHECK(subscribe->subscriptions[1].id == 4294967295U);
  CHECK(subscribe->subscriptions[1].channel == 1);
  const auto unsubscribe = parse(R"({"op":"unsubscribe","subscriptionIds":[1,2]})");
  REQUIRE(unsubscribe);
  CHECK(unsubscribe->ids == std::vector<std::uint32_t>{1, 2});
  const auto advertised = parse(
      R"({"op":"advertise","channels":[{"id":2,"topic":"/motors","encoding":"json","schemaName":""}]})");
  REQUIRE(advertised);
  CHECK(advertised->channels[0].topic == "/motors");
  const auto set = parse(
      R"({"op":"setParameters","parameters":[{"name":"/gyroscope/period_ms","value":2.5e1}],"id":"x"})");
  REQUIRE(set);
  CHECK(set->parameters[0].value == 25.0);
  CHECK(set->request == "x");
  CHECK(parse(R"({"op":"getParameters","parameterNames":["a"]})")->names[0] == "a");
}

TEST_CASE("foxglove: what is no request is refused in words") {
  for (const char* const text :
       {"", "{", "[]", "null", R"({"op":1})", R"({"op":"subscribe"})",
        R"({"op":"subscribe","subscriptions":{}})",
        R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":0}]})",
        R"({"op":"subscribe","subscriptions":[{"id":1.5,"channelId":0}]})",
        R"({"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":0}]})",
        R"({"op":"subscribe","subscriptions":[3]})", R"({"op":"unsubscribe","subscriptionIds":["1"]})",
        R"({"op":"setParameters","parameters":[{"name":"a","value":"b"}]})", R"({"op":"fly"})"}) {
    INFO(text);
    const auto request = parse(text);
    CHECK_FALSE(request);
    CHECK_FALSE(request.error.empty());
  }
  CHECK(parse(R"({"op":"fly"})").error == "'fly' is nothing that this server does");
  std::string deep(100, '[');
  CHECK_FALSE(parse(deep));
  // What the parser takes for the end of the text is none.
  CHECK(parse(std::string{R"({"op":"getParameters","parameterNames":[]})"} + '\0').error ==
        "no JSON: a NUL character");
}

TEST_CASE("foxglove: what is missing of a request is named") {
  const auto why = [](const char* text) { return parse(text).error; };
  CHECK(why(R"({"id":"x"})") == "no text 'op', which says what is asked");
  CHECK(why(R"({"op":"subscribe","subscriptionIds":[1]})") == "subscribe without its list 'subscriptions'");
  CHECK(why(R"({"op":"unsubscribe","subscriptionIds":3})") ==
        "unsubscribe without its list 'subscriptionIds'");
  CHECK(why(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":0},{"channelId":1}]})") ==
        "subscribe: each of its subscriptions is an id and a channelId, both whole numbers");
  CHECK(why(R"({"op":"subscribe","subscriptions":[{"id":1}]})") ==
        "subscribe: each of its subscriptions is an id and a channelId, both whole numbers");
  const char* const advertise =
      "advertise: each of its channels is an id, a topic of 256 bytes at most, and an encoding";
  CHECK(why(R"({"op":"advertise","channels":[{"topic":"/motors","encoding":"json"}]})") == advertise);
  CHECK(why(R"({"op":"advertise","channels":[{"id":1,"encoding":"json"}]})") == advertise);
  CHECK(why(R"({"op":"advertise","channels":[{"id":1,"topic":"/motors"}]})") == advertise);
  CHECK(why(R"({"op":"unadvertise","channelIds":[-1]})") ==
        "unadvertise: each of its channelIds is a whole number");
  const char* const set = "setParameters: each of its parameters is a name and a number as its value";
  CHECK(why(R"({"op":"setParameters","parameters":[{"value":1}]})") == set);
  CHECK(why(R"({"op":"setParameters","parameters":[{"name":"a"}]})") == set);
  CHECK(why(R"({"op":"setParameters","parameters":[{"name":"a","value":null}]})") == set);
  CHECK(why(R"({"op":"getParameters","parameterNames":["a",1]})") ==
        "getParameters: each of its parameterNames is a text");
  CHECK(parse(R"({"op":"subscribeParameterUpdates","parameterNames":["a","b"]})")->op ==
        Op::subscribe_parameters);
  CHECK(parse(R"({"op":"unsubscribeParameterUpdates","parameterNames":["a","b"]})")->names ==
        std::vector<std::string>{"a", "b"});
  CHECK(parse(R"({"op":"unadvertise","channelIds":[7,8]})")->ids == std::vector<std::uint32_t>{7, 8});
}

TEST_CASE("foxglove: what is kept of a client, or goes back to it, is bounded") {
  const auto topic = [](std::size_t size) {
    return R"({"op":"advertise","channels":[{"id":1,"topic":")" + std::string(size, 'a') +
           R"(","encoding":"json"}]})";
  };
  CHECK(parse(topic(longest_name)));
  CHECK(parse(topic(longest_name + 1)).error.find("a topic of 256 bytes at most") != std::string::npos);
  const auto request = [](std::size_t size) {
    return R"({"op":"getParameters","parameterNames":[],"id":")" + std::string(size, 'a') + R"("})";
  };
  CHECK(parse(request(longest_name)));
  CHECK_FALSE(parse(request(longest_name + 1)));
  const std::string words(longest_status, 'a');
  CHECK(status(Level::error, words) == R"({"op":"status","level":2,"message":")" + words + R"("})");
  CHECK(status(Level::error, words + "b") == R"({"op":"status","level":2,"message":")" + words + R"( ..."})");
  // No character is cut in two.
  const std::string almost(longest_status - 1, 'a');
  CHECK(status(Level::error, almost + "\u00B5") ==
        R"({"op":"status","level":2,"message":")" + almost + R"( ..."})");
}

TEST_CASE("foxglove: what a client publishes") {
  using namespace std::string_view_literals;
  const auto published = parse_binary("\x01\x02\x01\x00\x00{}"sv);
  REQUIRE(published);
  CHECK(published->channel == 258);
  CHECK(published->payload == "{}");
  const auto without = parse_binary("\x01\x02\x01\x00\x00"sv);
  REQUIRE(without);
  CHECK(without->channel == 258);
  CHECK(without->payload.empty());
  CHECK_FALSE(parse_binary("\x01\x02\x01\x00"sv));
  CHECK_FALSE(parse_binary("\x02\x02\x01\x00\x00{}"sv));
  CHECK_FALSE(parse_binary(""sv));
}

}  // namespace serve_foxglove_test
