#include <catch2/catch.hpp>

#include "tests/firmware/bxcan/bench.hpp"

namespace ocm::bxcan_tests {

TEST_CASE("a received frame arrives as it was sent, whatever is above its length") {
  Bench bench;
  for (std::uint8_t dlc = 0; dlc <= 8; ++dlc) {
    can::Frame sent{0x205, dlc, {}};
    for (std::uint8_t i = 0; i < dlc; ++i) sent.data[i] = static_cast<std::uint8_t>(0xF8 + i);
    can::Frame on_bus = sent;
    for (std::size_t i = dlc; i < 8; ++i)
      on_bus.data[i] = 0xEE;  // what the registers hold there is undefined
    REQUIRE(bench.model.deliver(on_bus));
    CHECK(bench.model.receive_interrupt());
    const auto received = bench.can.receive();
    REQUIRE(received);
    CHECK(*received == sent);
    CHECK_FALSE(bench.can.receive());
  }
  CHECK(bench.can.counters().received == 9);
  CHECK(bench.model.violations.empty());
}

TEST_CASE("three frames wait; of more the newest stays, and the loss is counted") {
  Bench bench;
  for (std::uint8_t i = 0; i < 5; ++i) REQUIRE(bench.model.deliver(frame(0x208, i)));
  std::vector<std::uint8_t> serials;
  while (const auto received = bench.can.receive()) serials.push_back(received->data[0]);
  CHECK(serials == std::vector<std::uint8_t>{0, 1, 4});
  CHECK(bench.can.counters().overruns == 1);
  REQUIRE(bench.model.deliver(frame(0x208, 9)));
  CHECK(bench.can.receive()->data[0] == 9);
  CHECK(bench.can.counters().overruns == 1);
  CHECK(bench.model.violations.empty());
}

TEST_CASE("a frame that arrives between any two accesses is neither lost nor taken twice") {
  for (unsigned at = 0; at < 24; ++at) {
    Bench bench;
    REQUIRE(bench.model.deliver(frame(0x208, 1)));
    unsigned accesses = 0;
    bench.model.on_access = [&] {
      if (accesses++ == at) REQUIRE(bench.model.deliver(frame(0x208, 2)));
    };
    std::vector<std::uint8_t> serials;
    while (accesses <= at + 1)
      while (const auto received = bench.can.receive()) serials.push_back(received->data[0]);
    CAPTURE(at);
    CHECK(serials == std::vector<std::uint8_t>{1, 2});
    CHECK(bench.model.violations.empty());
  }
}

}  // namespace ocm::bxcan_tests
