/// What a program on Linux says when the system or a device does not do what it asked for. Host only.
///
/// The sentences hold for every program. One that has options of its own for the matter knows by the cause
/// when to name them instead.
#pragma once

#include <cstdint>
#include <string>

#include "ocm/base/result.hpp"

namespace ocm::host {

enum class Cause : std::uint8_t {
  other,
  can_missing,         ///< the kernel has no CAN, or no raw sockets of it
  interfaces_unknown,  ///< the kernel does not list its network interfaces
  simulator_missing,   ///< no simulator serves the virtual bus
  simulator_gone,      ///< it was there, and ended without a word
  simulator_private,   ///< the system does not let this user connect to it
  simulator_foreign,   ///< it belongs to another user
  no_simulator,        ///< something else has the socket
  simulator_running,   ///< another one serves this path; `process` is its number
};

/// What went wrong, said to a person: what and where, and what to do about it.
struct Failure {
  std::string what;
  std::string remedy;
  Cause cause = Cause::other;
  std::int64_t process = 0;  ///< of the other program, if there is one and it is known
  friend bool operator==(const Failure&, const Failure&) = default;
};

template <class T>
using Outcome = base::Result<T, Failure>;

}  // namespace ocm::host
