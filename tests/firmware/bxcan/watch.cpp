// Error states, the lost bus, and what becomes of the frames that waited.
#include <catch2/catch.hpp>

#include "tests/firmware/bxcan/bench.hpp"

namespace ocm::bxcan_tests {
namespace {

using std::chrono::milliseconds;
constexpr base::Time at(int ms) {
  return base::Time{milliseconds{ms}};
}

void attempts(Model& model, int number, End how) {
  for (int i = 0; i < number && model.begin(); ++i) model.end(how);
}

}  // namespace

TEST_CASE("states and counters as the controller has them") {
  Bench bench;
  bench.can.watch(at(0));
  CHECK(bench.can.errors() == bxcan::BusErrors{});
  REQUIRE(bench.can.send(frame(0x600)).ok());
  attempts(bench.model, 12, End::no_acknowledge);
  bench.can.watch(at(1));
  CHECK(bench.can.errors() == bxcan::BusErrors{bxcan::BusState::warning, 96, 0, 3});
  CHECK_FALSE(bench.model.error_interrupt());
  attempts(bench.model, 4, End::no_acknowledge);
  CHECK(bench.model.error_interrupt());
  bench.can.watch(at(2));
  CHECK_FALSE(bench.model.error_interrupt());
  CHECK(bench.can.errors() == bxcan::BusErrors{bxcan::BusState::passive, 128, 0, 3});
  CHECK(bench.can.counters().passive == 1);
  for (int i = 0; i < 5; ++i) bench.model.disturb(6);
  bench.can.watch(at(3));
  CHECK(bench.can.errors().receive == 5);
  CHECK(bench.can.errors().last == 6);
  CHECK(bench.can.counters().passive == 1);
}

TEST_CASE("bus-off is a lost bus at once; it comes back by itself, and nothing old with it") {
  Bench bench;
  bench.can.watch(at(0));
  for (std::uint8_t i = 0; i < 6; ++i) REQUIRE(*bench.can.send(frame(0x600U + i, i)));
  attempts(bench.model, 40, End::bit_error);
  CHECK(bench.model.error_interrupt());
  CHECK(bench.can.watch(at(10)));
  CHECK(bench.can.lost());
  CHECK(bench.can.errors().state == bxcan::BusState::off);
  CHECK(bench.can.counters().bus_off == 1);
  CHECK_FALSE(bench.can.watch(at(11)));  // said once
  bench.interrupt();
  CHECK(bench.can.waiting() == 0);
  CHECK(bench.can.counters().dropped == 6);

  bench.model.recessive(128);
  CHECK_FALSE(bench.can.watch(at(20)));
  CHECK_FALSE(bench.can.lost());
  REQUIRE(*bench.can.send(frame(0x608, 77)));
  while (bench.transfer()) {
  }
  REQUIRE(bench.model.transmitted.size() == 1);
  CHECK(bench.model.transmitted[0].data[0] == 77);
  CHECK(bench.can.counters().sent == 1);
  CHECK(bench.model.violations.empty());
}

TEST_CASE("alone on the wire: passive, silent for 100 ms, lost; the first acknowledge brings it back") {
  Bench bench;
  bench.can.watch(at(0));
  REQUIRE(*bench.can.send(frame(0x600, 1)));
  int fell_at = -1;
  for (int ms = 1; ms <= 400; ++ms) {
    attempts(bench.model, 3, End::no_acknowledge);
    bench.interrupt();
    if (ms % 50 == 0) {
      REQUIRE(*bench.can.send(frame(0x600, static_cast<std::uint8_t>(ms / 10))));
    }
    if (bench.can.watch(at(ms))) {
      CHECK(fell_at == -1);
      fell_at = ms;
    }
  }
  // 16 attempts make it passive, in the sixth millisecond; the last time that it was seen well is the fifth.
  CHECK(fell_at == 105);
  CHECK(bench.can.lost());
  CHECK(bench.can.waiting() <= 2);  // what is older than 100 ms is given up again and again
  REQUIRE(*bench.can.send(frame(0x600, 99)));
  while (bench.transfer()) {
  }
  CHECK_FALSE(bench.can.watch(at(401)));
  CHECK_FALSE(bench.can.lost());
  REQUIRE_FALSE(bench.model.transmitted.empty());
  for (const can::Frame& sent : bench.model.transmitted) CHECK(sent.data[0] >= 30);
  CHECK(bench.can.counters().sent + bench.can.counters().dropped == 10);
  CHECK(bench.model.violations.empty());
}

TEST_CASE("a bus that is held dominant cannot be joined: lost after 100 ms, whenever it is first looked at") {
  Model model;
  model.dominant = true;
  bxcan::Bxcan<ModelRegisters> can{ModelRegisters{model}};
  REQUIRE(can.start(timing, {}).ok());
  REQUIRE(*can.send(frame(0x600, 1)));
  for (int ms = 5000; ms < 5100; ms += 10) REQUIRE_FALSE(can.watch(at(ms)));
  CHECK(can.watch(at(5100)));
  CHECK(can.errors().state == bxcan::BusState::active);
  REQUIRE(*can.send(frame(0x600, 2)));
  model.dominant = false;
  for (int ms = 5110; ms < 5150; ms += 10) CHECK_FALSE(can.watch(at(ms)));
  CHECK_FALSE(can.lost());
  REQUIRE(model.begin());
  CHECK(model.violations.empty());
}

TEST_CASE("passive but in use is not lost") {
  Bench bench;
  bench.can.watch(at(0));
  for (int i = 0; i < 200; ++i) bench.model.disturb();
  for (int ms = 1; ms < 500; ++ms) {
    bench.model.disturb();
    if (ms % 40 == 0) {
      REQUIRE(*bench.can.send(frame(0x600)));
      bench.transfer();
    }
    REQUIRE_FALSE(bench.can.watch(at(ms)));
  }
  CHECK(bench.can.errors().state == bxcan::BusState::passive);
}

}  // namespace ocm::bxcan_tests
