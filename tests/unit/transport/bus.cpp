#include "ocm/transport/bus.hpp"

#include <catch2/catch.hpp>

#include "ocm/can/bus.hpp"

namespace transport_bus_test {

using namespace ocm;
using transport::BusState;
using transport::Failure;

static_assert(can::Bus<transport::Bus>);

/// The least that a bus must say of itself.
class Plain final : public transport::Bus {
 public:
  [[nodiscard]] std::string_view name() const override { return "plain"; }
  base::Result<bool> send(const can::Frame& frame) override {
    sent = frame;
    return true;
  }
  base::Result<can::Received> receive(base::Duration) override {
    if (sent.id == 0) return base::Error::timed_out;
    return can::Received{base::Time{base::Duration{7}}, sent};
  }
  transport::Outcome<void> subscribe(std::span<const can::Filter>) override { return {}; }
  [[nodiscard]] int descriptor() const override { return -1; }
  [[nodiscard]] const transport::BusCounters& counters() const override { return counters_; }
  [[nodiscard]] const Failure& failure() const override { return reason; }
  Failure reason;
  can::Frame sent;

 private:
  transport::BusCounters counters_;
};

TEST_CASE("a bus without a state of its own is up until it failed") {
  Plain bus;
  CHECK(bus.state() == BusState::up);
  bus.reason = {"pulled out", "put it in"};
  CHECK(bus.state() == BusState::closed);
}

TEST_CASE("a bus that knows classic frames alone takes those of either kind, and refuses CAN FD") {
  Plain bus;
  CHECK(bus.receive_any(base::Duration{0}).error == base::Error::timed_out);
  const can::Frame frame{0x123, 2, {1, 2}};
  CHECK(bus.send_any(frame).value);
  CHECK(bus.sent == frame);
  const auto back = bus.receive_any(base::Duration{0});
  REQUIRE(back);
  CHECK(back->frame == can::AnyFrame{frame});
  CHECK(back->time == base::Time{base::Duration{7}});
  can::AnyFrame fd{frame};
  fd.flags = can::frame_flag::fd;
  CHECK(bus.send_any(fd).error == base::Error::bad_length);
  CHECK(bus.fd_obstacle().what == "'plain' carries no CAN FD frames");
  CHECK_FALSE(bus.fd_obstacle().remedy.empty());
  CHECK(bus.bit_rate() == 0);
  CHECK_FALSE(bus.is_simulated());
  const transport::Delivery unknown = bus.delivery();
  CHECK_FALSE(unknown.known);
  CHECK(unknown.pending == 0);
  CHECK(unknown.obstruction == Failure{});
  CHECK_FALSE(unknown.refused);
  const transport::BusCounters none;
  CHECK(none.sent + none.received + none.lost + none.refused + none.error_frames + none.passed_over == 0);
}

}  // namespace transport_bus_test
