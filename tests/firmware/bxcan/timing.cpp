// The register fields of the manuals at the boards' clocks, and what the driver writes.
#include <catch2/catch.hpp>

#include "ocm/can/bit_timing.hpp"
#include "ocm/topics/amiro.hpp"

#include "tests/firmware/bxcan/bench.hpp"

namespace ocm::bxcan_tests {

// The point at which both reference manuals' tables and AMiRo's boards sample: 13 + 2 and 15 + 3 quanta.
// [RM0008 24.7.7, RM0090 32.7.7]
constexpr auto at_36_mhz =
    can::find_bit_timing(amiro::DiWheelDrive::can_clock_hz, amiro::catalogue.bit_rate, 833);
constexpr auto at_42_mhz =
    can::find_bit_timing(amiro::PowerManagement::can_clock_hz, amiro::catalogue.bit_rate, 810);
static_assert(at_36_mhz.ok() && at_36_mhz->brp == 3 && at_36_mhz->ts1 == 13 && at_36_mhz->ts2 == 2);
static_assert(at_42_mhz.ok() && at_42_mhz->brp == 3 && at_42_mhz->ts1 == 15 && at_42_mhz->ts2 == 3);
static_assert(at_36_mhz->exact(36'000'000) && at_36_mhz->bit_rate(36'000'000) == 500'000);
static_assert(at_42_mhz->exact(42'000'000) && at_42_mhz->bit_rate(42'000'000) == 500'000);

TEST_CASE("start writes the bit timing, leaves initialisation, and joins by identifier") {
  Bench bench;
  REQUIRE(bench.started.ok());
  CHECK(bench.model.violations.empty());
  const std::uint32_t btr = bench.model.read(Register::btr);
  CHECK((btr & 0x3FF) == 3);
  CHECK((btr >> 16 & 0xF) == 13);
  CHECK((btr >> 20 & 0x7) == 2);
  CHECK((btr >> 24 & 0x3) == timing.sjw);
  CHECK((btr >> 30) == 0);  // neither silent nor looped back
  CHECK_FALSE(bench.model.initialising());
  const std::uint32_t control = bench.model.read(Register::mcr);
  CHECK((control & bxcan::mcr::txfp) == 0);
  CHECK((control & bxcan::mcr::nart) == 0);
  CHECK((control & bxcan::mcr::abom) != 0);
}

TEST_CASE("a controller without a clock is said, in bounded time") {
  Model model;
  model.handshake_delay = 1'000'000;
  unsigned accesses = 0;
  model.on_access = [&accesses] { ++accesses; };
  bxcan::Bxcan<ModelRegisters> can{ModelRegisters{model}};
  CHECK(can.start(timing, {}).error == base::Error::timed_out);
  CHECK(accesses < 2 * bxcan::patience);
}

}  // namespace ocm::bxcan_tests
