#include "ocm/can/bus.hpp"

#include <catch2/catch.hpp>

namespace can_bus_test {

using ocm::base::Duration;
using ocm::base::Result;
using ocm::base::Time;
using ocm::can::Frame;
using ocm::can::Received;

struct Board {
  Result<bool> send(const Frame&) { return true; }
};
struct Host : Board {
  Result<Received> receive(Duration) { return ocm::base::Error::timed_out; }
};
struct ForgetsErrors {
  bool send(const Frame&) { return true; }
};
struct Takes {
  Result<bool> send(Frame&) { return true; }
};
struct WaitsForAsLongAsItLikes : Board {
  Result<Received> receive() { return ocm::base::Error::timed_out; }
};
struct ForgetsTheTime : Board {
  Result<Frame> receive(Duration) { return ocm::base::Error::timed_out; }
};

TEST_CASE("a bus sends, and says whether the frame was taken; a host's also receives, until a deadline") {
  STATIC_REQUIRE(ocm::can::Sender<Board>);
  STATIC_REQUIRE_FALSE(ocm::can::Bus<Board>);
  STATIC_REQUIRE(ocm::can::Sender<Host>);
  STATIC_REQUIRE(ocm::can::Bus<Host>);
}

TEST_CASE("what cannot report, keep a frame or end a wait is no bus") {
  STATIC_REQUIRE_FALSE(ocm::can::Sender<ForgetsErrors>);
  STATIC_REQUIRE_FALSE(ocm::can::Sender<Takes>);
  STATIC_REQUIRE_FALSE(ocm::can::Bus<WaitsForAsLongAsItLikes>);
  STATIC_REQUIRE_FALSE(ocm::can::Bus<ForgetsTheTime>);
}

TEST_CASE("receptions are equal when frame and time are") {
  const Frame frame{0x605, 1, {7}};
  const Time later{Duration{1}};
  CHECK(Received{Time{}, frame} == Received{Time{}, frame});
  CHECK_FALSE(Received{Time{}, frame} == Received{later, frame});
  CHECK_FALSE(Received{Time{}, frame} == Received{Time{}, Frame{}});
}

}  // namespace can_bus_test
