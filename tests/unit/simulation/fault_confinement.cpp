#include "ocm/simulation/fault_confinement.hpp"

#include <catch2/catch.hpp>

namespace simulation_fault_confinement_test {

using namespace ocm;
using simulation::FaultConfinement;
using simulation::FaultState;

constexpr FaultConfinement after_failures(unsigned sending, unsigned receiving) {
  FaultConfinement faults;
  for (unsigned i = 0; i < receiving; ++i) faults.failed_to_receive();
  for (unsigned i = 0; i < sending; ++i) faults.failed_to_send();
  return faults;
}

// 8 for a failure of one's own, 1 for that of another; passive from 128, off from 256. [ISO 11898-1]
static_assert(FaultConfinement{}.clean());
static_assert(FaultConfinement{}.state() == FaultState::error_active);
static_assert(after_failures(3, 5).transmit_errors() == 24);
static_assert(after_failures(3, 5).receive_errors() == 5);
static_assert(!after_failures(1, 0).clean() && !after_failures(0, 1).clean());
static_assert(after_failures(15, 127).state() == FaultState::error_active);
static_assert(after_failures(16, 0).state() == FaultState::error_passive);
static_assert(after_failures(0, 128).state() == FaultState::error_passive);
static_assert(after_failures(31, 0).state() == FaultState::error_passive);
static_assert(after_failures(32, 0).state() == FaultState::bus_off);
static_assert(after_failures(0, 10'000).state() == FaultState::error_passive);  // who only hears stays
static_assert(after_failures(0, 10'000).receive_errors() == 255);

TEST_CASE("a success takes one back, never below zero") {
  FaultConfinement faults = after_failures(16, 3);
  faults.sent();
  CHECK(faults.transmit_errors() == 127);
  CHECK(faults.state() == FaultState::error_active);
  for (int i = 0; i < 200; ++i) faults.sent();
  CHECK(faults.transmit_errors() == 0);
  CHECK(faults.receive_errors() == 3);
  for (int i = 0; i < 2; ++i) faults.received();
  CHECK(faults.receive_errors() == 1);
  CHECK_FALSE(faults.clean());
  for (int i = 0; i < 2; ++i) faults.received();
  CHECK(faults.clean());
}

TEST_CASE("a passive receiver is active again after one frame") {
  FaultConfinement faults = after_failures(0, 200);
  faults.received();
  CHECK(faults.receive_errors() == 120);
  CHECK(faults.state() == FaultState::error_active);
  faults = after_failures(0, 127);
  faults.received();
  CHECK(faults.receive_errors() == 126);
}

TEST_CASE("bus-off lasts for 128 sequences and forgets everything; nothing else counts meanwhile") {
  FaultConfinement faults = after_failures(32, 7);
  CHECK(faults.sequences_left() == 128);
  faults.sent();
  faults.received();
  faults.failed_to_send();
  faults.failed_to_receive();
  CHECK(faults.transmit_errors() == 256);
  CHECK(faults.receive_errors() == 7);
  faults.saw_recessive(100);
  faults.saw_recessive(27);
  CHECK(faults.sequences_left() == 1);
  CHECK(faults.state() == FaultState::bus_off);
  faults.saw_recessive(1);
  CHECK(faults.clean());
  CHECK(faults.state() == FaultState::error_active);

  faults = after_failures(32, 0);
  faults.saw_recessive(UINT64_MAX);
  CHECK(faults.clean());
}

TEST_CASE("silence changes nothing for a node that is on the bus") {
  FaultConfinement faults = after_failures(20, 9);
  faults.saw_recessive(1'000);
  CHECK(faults.transmit_errors() == 160);
  CHECK(faults.receive_errors() == 9);
}

}  // namespace simulation_fault_confinement_test
