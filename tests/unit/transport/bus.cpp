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
  base::Result<bool> send(const can::Frame&) override { return true; }
  base::Result<can::Received> receive(base::Duration) override { return base::Error::timed_out; }
  transport::Outcome<void> subscribe(std::span<const can::Filter>) override { return {}; }
  [[nodiscard]] int descriptor() const override { return -1; }
  [[nodiscard]] const transport::BusCounters& counters() const override { return counters_; }
  [[nodiscard]] const Failure& failure() const override { return reason; }
  Failure reason;

 private:
  transport::BusCounters counters_;
};

TEST_CASE("a bus without a state of its own is up until it failed") {
  Plain bus;
  CHECK(bus.state() == BusState::up);
  bus.reason = {"pulled out", "put it in"};
  CHECK(bus.state() == BusState::closed);
}

}  // namespace transport_bus_test
