/// What a board does that cannot go on: actuators to rest, a note of the cause, and from the beginning. The
/// way there needs no kernel, no variable and no stack that was good: the processor's fault exceptions, NMI
/// and the kernel's halt all lead into it, on the main stack from its top (fault.cpp).
///
/// The same code in the images of the real boards and of QEMU's; an image links fault.cpp and defines the
/// two functions that differ.
#pragma once

#include <cstdint>

#include "firmware/chibios/restart_note.hpp"

namespace ocm::firmware::chibios {

/// The image's: motors without torque, lights dark. By writes to registers alone, at once, whatever ran
/// before; interrupts are off.
void bring_to_rest() noexcept;

/// The image's: resets the chip. Why it is, is noted already.
[[noreturn]] void restart(ResetCause cause) noexcept;

/// All of it. `where`: RestartNote's.
[[noreturn]] void rest_and_restart(ResetCause cause, std::uint32_t where = 0) noexcept;

/// The cause that the program before this one noted; ResetCause::unknown: none. Only the first call tells
/// it; what else is in the note stays, for a debugger, in `ocm_restart_note`.
[[nodiscard]] ResetCause take_noted_cause() noexcept;

}  // namespace ocm::firmware::chibios
