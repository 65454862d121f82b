#include "ocm/client/sample.hpp"

#include <algorithm>
#include <random>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/can/text.hpp"
#include "ocm/protocol/message.hpp"
#include "ocm/topics/amiro.hpp"

namespace client_sample_test {

using namespace ocm;
using namespace std::chrono_literals;
using client::Meaning;
using client::Receiver;

client::Reception take(Receiver& receiver, std::string_view text, base::Duration at = {}) {
  const auto frame = can::parse_frame(text);
  REQUIRE(frame.ok());
  return receiver.take({base::Time{at}, *frame});
}

TEST_CASE("a sample of one frame is complete at once") {
  Receiver receiver{amiro::catalogue};
  const auto reception = take(receiver, "608#3E001E00FCFF", 110'380ms);
  REQUIRE(reception.meaning == Meaning::sample);
  CHECK(reception.sample.priority == protocol::Priority::medium);
  CHECK(reception.sample.time == base::Time{110'380ms});
  const auto gyroscope = reception.sample.as<amiro::Gyroscope>();
  REQUIRE(gyroscope.ok());
  CHECK(*gyroscope == amiro::Gyroscope{62, 30, -4});  // thesis figure 6.3, which prints -4 as 65532
  CHECK(gyroscope->z_deg_per_s() == Approx(-0.07));
  CHECK(reception.sample.as<amiro::Accelerometer>().error == base::Error::unknown_topic);
}

TEST_CASE("a sample of several frames is complete with its last") {
  Receiver receiver{amiro::catalogue};
  CHECK(take(receiver, "605#00D20000").meaning == Meaning::part);
  CHECK(take(receiver, "606#00AAF1FF").meaning == Meaning::part);
  const auto last = take(receiver, "607#003E1700");
  REQUIRE(last.meaning == Meaning::sample);
  const auto magnetometer = last.sample.as<amiro::Magnetometer>();
  REQUIRE(magnetometer.ok());
  CHECK(magnetometer->encode(1) == can::parse_frame("606#00AAF1FF")->data);
  CHECK(receiver.counters().samples == 1);
}

TEST_CASE("a sample that lacks frames is no struct") {
  Receiver receiver{amiro::catalogue};
  static_cast<void>(take(receiver, "605#00D20000"));
  static_cast<void>(take(receiver, "606#00AAF1FF"));
  auto sample = take(receiver, "607#003E1700").sample;
  REQUIRE(sample.as<amiro::Magnetometer>().ok());
  sample.bytes = sample.bytes.first(16);
  CHECK(sample.as<amiro::Magnetometer>().error == base::Error::unknown_topic);
  CHECK(client::Sample{}.as<amiro::Magnetometer>().error == base::Error::unknown_topic);
}

TEST_CASE("a lost frame makes one incomplete sample") {
  for (const int lost : {0, 1, 2}) {
    CAPTURE(lost);
    Receiver receiver{amiro::catalogue};
    const char* frames[] = {"605#01000000", "606#01000000", "607#01000000"};
    for (int sample = 0; sample < 3; ++sample)
      for (int i = 0; i < 3; ++i)
        if (sample != 1 || i != lost) static_cast<void>(take(receiver, frames[i]));
    CHECK(receiver.counters().samples == 2);
    CHECK(receiver.counters().incomplete == 1);
  }
}

TEST_CASE("a listener that joins in the middle of a sample has lost nothing") {
  Receiver receiver{amiro::catalogue};
  static_cast<void>(take(receiver, "607#01000000"));
  for (const char* text : {"605#01000000", "606#01000000", "607#01000000"})
    static_cast<void>(take(receiver, text));
  CHECK(receiver.counters().samples == 1);
  CHECK(receiver.counters().incomplete == 0);
}

TEST_CASE("what a frame is") {
  Receiver receiver{amiro::catalogue};
  CHECK(take(receiver, "208#01F40100").meaning == Meaning::request);
  CHECK(take(receiver, "201#50C3000000000000").meaning == Meaning::set_point);
  CHECK(take(receiver, "23C#FFFFFF").topic->name == "led_1");
  CHECK(take(receiver, "608#3E001E").meaning == Meaning::wrong_dlc);
  CHECK(take(receiver, "6FF#").meaning == Meaning::unknown);
  CHECK(take(receiver, "606#R").meaning == Meaning::unknown);
  CHECK(take(receiver, "00000608#3E001E00FCFF").meaning == Meaning::unknown);
  CHECK(take(receiver, "20000040#0000000000000000").meaning == Meaning::error);
  const auto& counters = receiver.counters();
  CHECK(counters.frames == 8);
  CHECK(counters.commands == 3);
  CHECK(counters.unknown == 3);
  CHECK(counters.wrong_dlc == 1);
  CHECK(counters.errors == 1);
  CHECK(counters.faults() == 5);
}

TEST_CASE("random loss: every whole sample comes out") {
  std::mt19937 random{7};
  Receiver receiver{amiro::catalogue};
  constexpr std::size_t count = amiro::ProximityRing::frames.size();
  std::uint64_t whole = 0;
  for (std::uint16_t n = 0; n < 2000; ++n) {
    amiro::ProximityRing ring;
    for (std::size_t i = 0; i < count; ++i) ring.sensor[i] = {n};
    bool lost = false;
    for (std::size_t i = 0; i < count; ++i) {
      if (random() % 20 == 0) {
        lost = true;
        continue;
      }
      const auto reception =
          receiver.take({base::Time{}, protocol::sample_frame(ring, protocol::Priority::low, i)});
      if (reception.meaning != Meaning::sample) continue;
      const auto received = reception.sample.as<amiro::ProximityRing>();
      REQUIRE(received.ok());
      CHECK(*received == ring);
    }
    whole += lost ? 0U : 1U;
  }
  CHECK(receiver.counters().samples == whole);
  CHECK(receiver.counters().incomplete > 0);
}

}  // namespace client_sample_test
