/// The robot's bootloader, AMiRo-BLT, as a program behind it sees it: a table of functions in its flash,
/// which the program calls to switch the robot off or to restart it, into the bootloader again.
///
/// The bootloader always runs first. It is reached from a running program in three ways, each of which ends
/// in one of these functions: another board pulls SYS_PD_N, the flashing tool says hello on the programming
/// UART, the board's own code asks for it. [AMiRo-BLT Target/Source/AMiRo/amiroblt.h; AMiRo-OS main.cpp of
/// each board, serial_can_mux.hpp] What that means for flashing: docs/boards/flash.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/chibios/restart_note.hpp"

namespace ocm::firmware::chibios::stm32 {

/// Where the table is on all three boards: offset 0x1C0 in the flash. [amiroblt.h, BL_CALLBACK_TABLE_OFFSET]
inline constexpr std::uintptr_t bootloader_table_address = 0x0800'01C0;

/// What a program can ask the bootloader for. All of them end in a reset or in standby, of all boards.
enum class Shutdown : std::uint8_t {
  hibernate,  ///< sleeps, can be charged at its pins
  deepsleep,
  transportation,  ///< only the reset button wakes it
  restart,
  handle_request,  ///< another board asked: do as it says with its pulses on SYS_SYNC_N
};

struct BootloaderVersion {
  std::uint8_t major = 0;
  std::uint8_t minor = 0;
  friend constexpr bool operator==(const BootloaderVersion&, const BootloaderVersion&) = default;
};

/// The table's words as they are in memory: magic, three versions (identifier, major, minor, patch), then the
/// functions. [amiroblt.h, struct blCallbackTable_t]
using BootloaderTable = std::array<std::uint32_t, 16>;

inline constexpr std::uint32_t bootloader_magic = 0x412D'424C;  ///< "A-BL"
inline constexpr std::size_t first_function = 4;

/// Versions 1.0 and 1.1, the only ones with this magic number, share this layout [AMiRo-OS main.cpp]. Older
/// ones had another, and 2.x is not for this robot: zeros for them, and for what is no table.
[[nodiscard]] constexpr BootloaderVersion bootloader_version(const BootloaderTable& table) noexcept {
  if (table[0] != bootloader_magic) return {};
  const auto major = static_cast<std::uint8_t>(table[1] >> 8);
  const auto minor = static_cast<std::uint8_t>(table[1] >> 16);
  if (major != 1 || minor > 1) return {};
  return {major, minor};
}

/// The function's address; 0: this bootloader does not have it. An address that is not in the bootloader's
/// own flash, or not Thumb code, is none.
[[nodiscard]] constexpr std::uint32_t bootloader_function(const BootloaderTable& table, Shutdown kind,
                                                          std::uint32_t application_address) noexcept {
  if (bootloader_version(table) == BootloaderVersion{}) return 0;
  const std::uint32_t address = table[first_function + static_cast<std::size_t>(kind)];
  const bool code = address >= 0x0800'0000 && address < application_address && (address & 1) != 0;
  return code ? address : 0;
}

/// From the reset flags as RCC_CSR has them in its upper byte, or the bootloader in the third byte of backup
/// register 0 (on PowerManagement; it clears RCC_CSR). A reset of any kind also pulls the pin, so the pin
/// comes last; after power-on all others mean nothing. [RM0008 7.3.10, RM0090 7.3.21; amiroblt.h,
/// blWakeupReason_t]
[[nodiscard]] constexpr ResetCause cause_in_csr(std::uint32_t csr) noexcept {
  if ((csr & (1U << 27 | 1U << 25)) != 0) return ResetCause::power;  // 25: brown-out, F405 only
  if ((csr & (1U << 30 | 1U << 29)) != 0) return ResetCause::watchdog;
  if ((csr & 1U << 28) != 0) return ResetCause::software;
  if ((csr & 1U << 31) != 0) return ResetCause::low_power;
  if ((csr & 1U << 26) != 0) return ResetCause::pin;
  return ResetCause::unknown;
}
[[nodiscard]] constexpr ResetCause cause_in_backup(std::uint32_t backup) noexcept {
  const std::uint32_t reason = backup >> 16;
  if ((reason & 0x50) != 0) return ResetCause::power;
  if ((reason & 0x06) != 0) return ResetCause::watchdog;
  if ((reason & 0x08) != 0) return ResetCause::software;
  if ((reason & 0x81) != 0) return ResetCause::low_power;
  if ((reason & 0x20) != 0) return ResetCause::pin;
  return ResetCause::unknown;
}

/// Finds the flashing tool's first words in what comes on the programming UART: an XCP packet of two bytes,
/// CONNECT in normal mode. AMiRo-OS restarts on the same three. [AMiRo-OS serial_can_mux.hpp, inputBLReset;
/// ASAM XCP part 2, 1.6.1.1.1]
class ConnectDetector {
 public:
  /// True: the three bytes are complete.
  constexpr bool feed(std::uint8_t byte) noexcept {
    constexpr std::array<std::uint8_t, 3> connect{0x02, 0xFF, 0x00};
    // No part of the sequence is its beginning again but the first byte.
    matched_ = byte == connect[matched_] ? matched_ + 1 : byte == connect[0] ? 1U : 0U;
    if (matched_ != connect.size()) return false;
    matched_ = 0;
    return true;
  }

 private:
  std::size_t matched_ = 0;
};

}  // namespace ocm::firmware::chibios::stm32
