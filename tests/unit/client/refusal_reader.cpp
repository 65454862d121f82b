#include "ocm/client/refusal_reader.hpp"

#include <chrono>

#include <catch2/catch.hpp>

#include "ocm/protocol/message.hpp"
#include "ocm/topics/amiro.hpp"

namespace client_refusal_reader_test {

using namespace ocm;
using namespace ocm::client;
using namespace std::chrono_literals;

/// What a bus brings, and what a reader makes of it.
struct Bus {
  Receiver receiver{amiro::catalogue};
  RefusalReader reader{amiro::catalogue};

  template <class T>
  std::optional<Refused> hear(const T& sample) {
    return reader.take(receiver.take({{}, protocol::sample_frame(sample, protocol::Priority::low, 0)}));
  }
  std::optional<Refused> hear(std::uint8_t number, std::uint16_t count) {
    return hear(
        amiro::DiWheelDriveRefusal{number, amiro::DiWheelDriveRefusal::Reason::not_schedulable, count, 0});
  }
};

TEST_CASE("refusal reader: what was refused, and how many of it") {
  Bus bus;
  const auto first = bus.hear(0x05, 4);
  REQUIRE(first);
  CHECK(first->topic->name == "magnetometer");
  CHECK(first->board == "di_wheel_drive");
  CHECK(first->reason == "not_schedulable");
  CHECK(first->number == 0x05);
  CHECK(first->first);
  CHECK(first->count == 1);  // those before are not of now
  CHECK_FALSE(bus.hear(0x05, 4));
  const auto more = bus.hear(0x08, 6);
  REQUIRE(more);
  CHECK(more->topic->name == "gyroscope");
  CHECK_FALSE(more->first);
  CHECK(more->count == 2);
  // The board has restarted.
  CHECK(bus.hear(0x08, 3)->count == 3);
  CHECK(bus.hear(0x08, 0)->count == 1);
}

TEST_CASE("refusal reader: a refusal of which nothing is said is one, and not known to be the first") {
  const Refused refused{};
  CHECK(refused.number == 0);
  CHECK(refused.count == 1);
  CHECK_FALSE(refused.first);
}

TEST_CASE("refusal reader: other samples, and numbers that the board does not have, are none") {
  Bus bus;
  CHECK_FALSE(bus.hear(amiro::Gyroscope{}));
  CHECK_FALSE(bus.hear(0x3C, 1));  // a light of another board
  CHECK(bus.hear(0x05, 2)->count == 1);
  CHECK(bus.reader.refusal_topic(0) != nullptr);
  CHECK(bus.reader.refusal_topic(amiro::catalogue.boards.size()) == nullptr);
  CHECK(bus.reader.refusal_topic(99) == nullptr);
  CHECK(RefusalReader::longest_wait(*bus.reader.refusal_topic(0)) ==
        bus.reader.refusal_topic(0)->deadline + 100ms);
}

}  // namespace client_refusal_reader_test
