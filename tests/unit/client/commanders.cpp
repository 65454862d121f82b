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

TEST_CASE("commanders: a light may blink") {
  Heard heard;
  for (int i = 0; i < 40; ++i) heard.send(i * 20ms, "led_1", i % 2 * 255);
  CHECK(heard.commanders.disputes().empty());
}

}  // namespace client_commanders_test
