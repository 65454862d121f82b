#include <array>
#include <chrono>
#include <cstdint>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

#include "firmware/chibios/restart_note.hpp"
#include "firmware/chibios/stm32/watchdog_turns.hpp"

namespace firmware_boot_restart_test {

using namespace ocm::firmware::chibios;
using namespace std::chrono_literals;
using stm32::WatchdogTurns;

// The numbers are the spec's.
using Reset = amiro::DiWheelDriveStatusIdentity::Reset;
constexpr bool same(ResetCause cause, Reset reset) {
  return static_cast<std::uint8_t>(cause) == static_cast<std::uint8_t>(reset);
}
static_assert(same(ResetCause::unknown, Reset::unknown) && same(ResetCause::power, Reset::power));
static_assert(same(ResetCause::pin, Reset::pin) && same(ResetCause::software, Reset::software));
static_assert(same(ResetCause::watchdog, Reset::watchdog) && same(ResetCause::low_power, Reset::low_power));
static_assert(same(ResetCause::fault, Reset::fault) && same(ResetCause::memory_fault, Reset::memory_fault));
static_assert(same(ResetCause::bus_fault, Reset::bus_fault) &&
              same(ResetCause::usage_fault, Reset::usage_fault));
static_assert(same(ResetCause::kernel_halt, Reset::kernel_halt) &&
              same(ResetCause::clock_failure, Reset::clock_failure));

// [ARMv7-M B1.5.2: 3 HardFault, 4 MemManage, 5 BusFault, 6 UsageFault; B3.2.15: their parts of the CFSR]
static_assert(cause_of_exception(2, 0) == ResetCause::clock_failure);
static_assert(cause_of_exception(3, 0) == ResetCause::fault);
static_assert(cause_of_exception(3, 0x0000'0001) == ResetCause::memory_fault);  // IACCVIOL
static_assert(cause_of_exception(3, 0x0000'8200) == ResetCause::bus_fault);     // BFARVALID, PRECISERR
static_assert(cause_of_exception(3, 0x0001'1000) == ResetCause::bus_fault);     // STKERR after UNDEFINSTR
static_assert(cause_of_exception(3, 0x0001'0000) == ResetCause::usage_fault);   // UNDEFINSTR
static_assert(cause_of_exception(3, 0x0200'0000) == ResetCause::usage_fault);   // DIVBYZERO
static_assert(cause_of_exception(4, 0) == ResetCause::memory_fault);
static_assert(cause_of_exception(5, 0) == ResetCause::bus_fault);
static_assert(cause_of_exception(6, 0) == ResetCause::usage_fault);

TEST_CASE("a note on the restart is believed as it was written, and not with any bit changed") {
  for (const auto cause : {ResetCause::software, ResetCause::watchdog, ResetCause::kernel_halt}) {
    const RestartNote note = make_note(cause, 0x0800'6123);
    CHECK(cause_in_note(note) == cause);
    for (unsigned bit = 0; bit < 128; ++bit) {
      std::array words{note.magic, note.cause, note.where, note.check};
      words[bit / 32] ^= 1U << bit % 32;
      CAPTURE(bit);
      CHECK(cause_in_note({words[0], words[1], words[2], words[3]}) == ResetCause::unknown);
    }
  }
}

TEST_CASE("what RAM holds after power-on is no note") {
  CHECK(cause_in_note({}) == ResetCause::unknown);
  CHECK(cause_in_note({~0U, ~0U, ~0U, ~0U}) == ResetCause::unknown);
  CHECK(cause_in_note({0x5555'5555, 0x5555'5555, 0x5555'5555, 0x5555'5555}) == ResetCause::unknown);
  CHECK(cause_in_note(make_note(static_cast<ResetCause>(12), 0)) == ResetCause::unknown);
}

// Turns of the two chips: PCLK1 36 and 42 MHz. [RM0008 20.4: (T - 0x40) counts of 4096 * 8 / PCLK1]
static_assert(WatchdogTurns::turn(36'000'000) > 57ms && WatchdogTurns::turn(36'000'000) < 58ms);
static_assert(WatchdogTurns::turn(42'000'000) > 49ms && WatchdogTurns::turn(42'000'000) < 50ms);
static_assert(WatchdogTurns::turns_in(410ms, 36'000'000) == 7);
static_assert(WatchdogTurns::turns_in(410ms, 42'000'000) == 8);
static_assert(WatchdogTurns::turns_in(1ms, 36'000'000) == 1);

TEST_CASE("the watchdog goes on for its turns without a sign, and no further") {
  WatchdogTurns watchdog;
  for (int round = 0; round < 3; ++round) {
    for (int turn = 1; turn < 7; ++turn) CHECK(watchdog.next(7));
    watchdog.fed();
  }
  for (int turn = 1; turn < 7; ++turn) CHECK(watchdog.next(7));
  CHECK_FALSE(watchdog.next(7));
  CHECK_FALSE(watchdog.next(7));
}

TEST_CASE("whatever a turn's phase, the levels have at least one turn less than the patience") {
  for (const std::uint32_t pclk1_hz : {36'000'000U, 42'000'000U}) {
    const auto turn = WatchdogTurns::turn(pclk1_hz);
    const auto turns = WatchdogTurns::turns_in(410ms, pclk1_hz);
    for (const auto phase : {0 * turn, turn / 2, turn - 1ns}) {  // from the last feed to the next turn's end
      WatchdogTurns watchdog;
      watchdog.fed();
      auto waited = turn - phase;
      for (; watchdog.next(turns); waited += turn)
        ;
      CHECK(waited > 340ms);
      CHECK(waited <= 402ms);
    }
  }
}

}  // namespace firmware_boot_restart_test
