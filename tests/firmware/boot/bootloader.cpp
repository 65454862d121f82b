#include "firmware/chibios/stm32/bootloader.hpp"

#include <string_view>

#include <catch2/catch.hpp>

namespace ocm::firmware::chibios::stm32 {
namespace {

constexpr std::uint32_t application = 0x0800'6000;

/// As amiroblt.h of version 1.1 lays it out.
constexpr BootloaderTable table_of_1_1 = {
    0x412D'424C,                                           // "A-BL"
    0x01'01'01'05,                                         // release (5), 1.1.1
    0x00'01'01'01,                                         // SSSP 1.1.0
    0x02'09'04'01,                                         // GCC 4.9.2
    0x0800'1001,   0x0800'1101, 0x0800'1201, 0x0800'1301,  // hibernate, deepsleep, transportation, restart
    0x0800'1401,                                           // handle the request of another board
};

}  // namespace

static_assert(bootloader_version(table_of_1_1) == BootloaderVersion{1, 1});
static_assert(bootloader_function(table_of_1_1, Shutdown::hibernate, application) == 0x0800'1001);
static_assert(bootloader_function(table_of_1_1, Shutdown::deepsleep, application) == 0x0800'1101);
static_assert(bootloader_function(table_of_1_1, Shutdown::transportation, application) == 0x0800'1201);
static_assert(bootloader_function(table_of_1_1, Shutdown::restart, application) == 0x0800'1301);
static_assert(bootloader_function(table_of_1_1, Shutdown::handle_request, application) == 0x0800'1401);

// [RM0008 7.3.10] upper byte, from bit 31: low power, window watchdog, independent watchdog, software, power,
// pin
static_assert(cause_in_csr(0x0C00'0000) == ResetCause::power);  // the value after power-on
static_assert(cause_in_csr(0x0E00'0000) == ResetCause::power);  // ... of the F405
static_assert(cause_in_csr(0x1400'0000) == ResetCause::software);
static_assert(cause_in_csr(0x2400'0000) == ResetCause::watchdog);
static_assert(cause_in_csr(0x4400'0000) == ResetCause::watchdog);
static_assert(cause_in_csr(0x8400'0000) == ResetCause::low_power);
static_assert(cause_in_csr(0x0400'0000) == ResetCause::pin);
static_assert(cause_in_csr(0x0000'0003) == ResetCause::unknown);  // LSI is on, the flags are cleared
// [amiroblt.h] the same facts in the bootloader's bits
static_assert(cause_in_backup(0x00'70'00'00) == ResetCause::power);
static_assert(cause_in_backup(0x00'28'00'04) == ResetCause::software);
static_assert(cause_in_backup(0x00'24'00'00) == ResetCause::watchdog);
static_assert(cause_in_backup(0x02'A0'00'02) == ResetCause::low_power);
static_assert(cause_in_backup(0x00'20'00'00) == ResetCause::pin);
static_assert(cause_in_backup(0x00'00'00'04) == ResetCause::unknown);

TEST_CASE("what is not a table of version 1.0 or 1.1 has no function") {
  auto table = table_of_1_1;
  const auto none = [&table] { return bootloader_function(table, Shutdown::restart, application) == 0; };
  SECTION("erased flash") {
    table.fill(0xFFFF'FFFF);
  }
  SECTION("another program's code") {
    table[0] = 0x4770'B510;
  }
  SECTION("the magic number of versions before 1.0") {
    table[0] = 0xFF66'9900;
  }
  SECTION("2.0") {
    table[1] = 0x00'00'02'05;
  }
  SECTION("1.2") {
    table[1] = 0x00'02'01'05;
  }
  CHECK(none());
  CHECK(bootloader_version(table) == BootloaderVersion{});
}

TEST_CASE("1.0 is known") {
  auto table = table_of_1_1;
  table[1] = 0x00'00'01'05;
  CHECK(bootloader_version(table) == BootloaderVersion{1, 0});
  CHECK(bootloader_function(table, Shutdown::restart, application) == 0x0800'1301);
}

TEST_CASE("an address that the bootloader cannot have is none") {
  auto table = table_of_1_1;
  for (const std::uint32_t address :
       {0U, 0xFFFF'FFFFU, 0x0800'1300U, 0x0800'6001U, 0x2000'0001U, 0x07FF'FFFFU}) {
    table[first_function + 3] = address;
    CAPTURE(address);
    CHECK(bootloader_function(table, Shutdown::restart, application) == 0);
  }
}

TEST_CASE("CONNECT of the flashing tool is found in any noise") {
  using namespace std::string_view_literals;
  const auto times = [](std::string_view bytes) {
    ConnectDetector detector;
    int found = 0;
    for (const char byte : bytes) found += detector.feed(static_cast<std::uint8_t>(byte));
    return found;
  };
  CHECK(times("\x02\xFF\x00"sv) == 1);
  CHECK(times("\x02\x02\xFF\x00"sv) == 1);
  CHECK(times("\x02\xFF\x02\xFF\x00"sv) == 1);
  CHECK(times("\x02\xFF\x00\x02\xFF\x00"sv) == 2);
  CHECK(times("shell\r\n\x02\xFF\x00more"sv) == 1);
  CHECK(times("\x02\xFF\x01"sv) == 0);
  CHECK(times("\xFF\x00\x02"sv) == 0);
  CHECK(times("\x02\xFF"sv) == 0);
  CHECK(times("\x02\x00\xFF\x00"sv) == 0);
}

}  // namespace ocm::firmware::chibios::stm32
