/// Why a board starts again, noted in RAM by the program that ends, for the one that starts: chips forget it
/// (the bootloader of the F103 boards clears the reset flags), or cannot know it. A note is believed only
/// with its magic number and its check word, since RAM holds anything after power-on, and only once.
#pragma once

#include <cstdint>

namespace ocm::firmware::chibios {

/// Why a board started, as its status says it. [spec/topics.json, field reset]
enum class ResetCause : std::uint8_t {
  unknown,
  power,
  pin,
  software,
  watchdog,
  low_power,
  fault,  ///< of the processor, of no kind below
  memory_fault,
  bus_fault,
  usage_fault,
  kernel_halt,
  clock_failure,
};

struct RestartNote {
  std::uint32_t magic = 0;
  std::uint32_t cause = 0;
  std::uint32_t where = 0;  ///< for a debugger: the instruction of a fault, the text of a kernel's halt
  std::uint32_t check = 0;
};

inline constexpr std::uint32_t note_magic = 0x4F43'4D21;  // "OCM!"

[[nodiscard]] constexpr std::uint32_t check_of(const RestartNote& note) noexcept {
  return ~(note.magic ^ note.cause ^ note.where);
}
[[nodiscard]] constexpr RestartNote make_note(ResetCause cause, std::uint32_t where) noexcept {
  RestartNote note{note_magic, static_cast<std::uint32_t>(cause), where, 0};
  note.check = check_of(note);
  return note;
}
/// ResetCause::unknown: it is no note.
[[nodiscard]] constexpr ResetCause cause_in_note(const RestartNote& note) noexcept {
  const bool valid = note.magic == note_magic && note.check == check_of(note) &&
                     note.cause <= static_cast<std::uint32_t>(ResetCause::clock_failure);
  return valid ? static_cast<ResetCause>(note.cause) : ResetCause::unknown;
}

/// From the number of the exception and the Configurable Fault Status Register. A fault whose own exception
/// is not enabled, or that came in another's handler, is a HardFault, and the register says what it was.
/// NMI has one source on both chips, the loss of the crystal's clock. [ARMv7-M B1.5.2, B3.2.15; RM0008
/// 7.2.7, RM0090 7.2.7]
[[nodiscard]] constexpr ResetCause cause_of_exception(std::uint32_t number, std::uint32_t cfsr) noexcept {
  switch (number) {
    case 2:
      return ResetCause::clock_failure;
    case 4:
      return ResetCause::memory_fault;
    case 5:
      return ResetCause::bus_fault;
    case 6:
      return ResetCause::usage_fault;
    default:
      break;
  }
  if ((cfsr & 0xFFU) != 0) return ResetCause::memory_fault;
  if ((cfsr & 0xFF00U) != 0) return ResetCause::bus_fault;
  if (cfsr >> 16 != 0) return ResetCause::usage_fault;
  return ResetCause::fault;
}

}  // namespace ocm::firmware::chibios
