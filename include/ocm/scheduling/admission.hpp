/// Who decides whether a board takes one stream more. The sensor handler asks before it starts or changes a
/// stream, and says what ended; what runs is untouched until the answer is yes.
///
/// Streams are the board's sensors, numbered as in Board::sensors. All calls come from the one context that
/// receives, one after the other, so that an admission needs no lock; how long it thinks is how long the
/// next frame from the bus waits, and with a receiver above all levels, they. It says so of itself.
#pragma once

#include <concepts>
#include <cstddef>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/scheduling/port.hpp"

namespace ocm::scheduling {

/// - `admit(stream, period, level)`: none: the stream runs so from now on, whatever it did before; anything
///   else is the reason why not, and all goes on as it did. `period` is above zero.
/// - `ended(stream)`: it was stopped, or asked for one sample, after which it stands.
template <class A>
concept Admission = requires(A& admission, std::size_t stream, base::Duration period, Level level) {
  { admission.admit(stream, period, level) } -> std::same_as<base::Error>;
  admission.ended(stream);
};

/// Takes everything: no memory, no instruction.
struct AdmitAll {
  static constexpr base::Error admit(std::size_t, base::Duration, Level) noexcept {
    return base::Error::none;
  }
  static constexpr void ended(std::size_t) noexcept {}
};

}  // namespace ocm::scheduling
