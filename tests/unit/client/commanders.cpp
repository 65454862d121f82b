#include "ocm/client/commanders.hpp"

#include <chrono>
#include <string>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

namespace client_commanders_test {

using namespace ocm;
using namespace ocm::client;
using namespace std::chrono_literals;

/// Frames on their way to the commanders.
struct Heard {
  Receiver receiver{amiro::catalogue};
  Commanders commanders;

  void send(base::Duration at, std::string_view topic, std::int64_t first,
            protocol::Priority priority = protocol::Priority::medium) {
    const can::Received received{base::Time{at},
                                 set_point(*amiro::catalogue.find(topic), std::array{first}, priority)};
    commanders.take(received, receiver.take(received));
  }
};

TEST_CASE("commanders: two drives in opposite directions are named") {
  Heard heard;
  for (int i = 0; i < 5; ++i) {
    heard.send(i * 100ms, "motors", 50'000);
    heard.send(i * 100ms + 30ms, "motors", -50'000);
  }
  const auto findings = heard.commanders.findings(amiro::catalogue);
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].severity == Severity::warning);
  CHECK(findings[0].ailment == Ailment::two_commanders);
  CHECK(findings[0].board == "di_wheel_drive");
  CHECK(findings[0].topic == "motors");
  CHECK(findings[0].what ==
        "two programs command motors in turns: 201#B03CFFFF00000000 and 201#50C3000000000000");
  CHECK(heard.commanders.disputes()[0].returns == 8);
}

TEST_CASE("commanders: one drive, one that changes its velocity, and a stop into it are none") {
  Heard heard;
  for (int i = 0; i < 20; ++i) heard.send(i * 100ms, "motors", i / 4 * 10'000);
  for (int i = 20; i < 40; ++i)
    heard.send(i * 100ms, "motors", i % 2 * 10'000);  // to and fro, at its own pace
  heard.send(4050ms, "motors", 0);
  for (int i = 41; i < 50; ++i) heard.send(i * 100ms, "motors", 10'000);
  CHECK(heard.commanders.disputes().empty());
}

TEST_CASE("commanders: three programs, and one at another priority") {
  Heard three;
  for (int i = 0; i < 4; ++i)
    for (int program = 1; program <= 3; ++program)
      three.send(i * 100ms + program * 20ms, "motors", program * 1000);
  CHECK(three.commanders.disputes().size() == 1);
  Heard urgent;
  for (int i = 0; i < 4; ++i) {
    urgent.send(i * 100ms, "motors", 1000);
    urgent.send(i * 100ms + 50ms, "motors", 1000, protocol::Priority::urgent);
  }
  CHECK(urgent.commanders.disputes().size() == 1);
}

TEST_CASE("commanders: two returns are an accident, three are none, within a hold period and a half each") {
  // To and fro: from the third set point on each is a return, so long after the same one before.
  const auto returns = [](int set_points, base::Duration apart) {
    Heard heard;
    for (int i = 0; i < set_points; ++i) heard.send(i * apart, "motors", i % 2 * 1000);
    const auto disputes = heard.commanders.disputes();
    return disputes.empty() ? 0U : disputes[0].returns;
  };
  CHECK(returns(4, 75ms) == 0);
  CHECK(returns(5, 75ms) == 3);
  CHECK(returns(20, 75ms) == 18);
  CHECK(returns(20, 75ms + 1ns) == 0);  // 150 ms after the same one, and a little
}

TEST_CASE("commanders: of up to four programs it is noticed, of five it is not") {
  for (const int programs : {2, 3, 4, 5}) {
    Heard heard;
    for (int i = 0; i < 5; ++i)
      for (int program = 0; program < programs; ++program)
        heard.send(i * 100ms + program * 20ms, "motors", 1000 + program);
    CHECK(heard.commanders.disputes().size() == (programs < 5 ? 1 : 0));
  }
}

TEST_CASE("commanders: each actuator has its own, in the order in which they were commanded first") {
  Heard heard;
  for (int i = 0; i < 6; ++i) {
    heard.send(i * 50ms, "travel", i % 2);
    heard.send(i * 50ms + 1ms, "motors", i % 2 * 1000);
    heard.send(i * 50ms + 2ms, "follow", 1);
  }
  const auto disputes = heard.commanders.disputes();
  REQUIRE(disputes.size() == 2);
  CHECK(disputes[0].topic->name == "travel");
  CHECK(disputes[1].topic->name == "motors");
  CHECK(disputes[1].returns == 4);
  // Of a board that a catalogue lacks the name is not known.
  protocol::Catalogue without = amiro::catalogue;
  without.boards = {};
  for (const Finding& finding : heard.commanders.findings(without)) CHECK(finding.board.empty());
}

TEST_CASE("commanders: a light may blink") {
  Heard heard;
  for (int i = 0; i < 40; ++i) heard.send(i * 20ms, "led_1", i % 2 * 255);
  CHECK(heard.commanders.disputes().empty());
}

}  // namespace client_commanders_test
