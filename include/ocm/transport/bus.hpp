/// The buses of a host behind one interface, so that a tool can choose at run time. Host only.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/any_frame.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/can/filter.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/host/failure.hpp"

namespace ocm::transport {

using host::Failure;
using host::Outcome;

/// What happened to frames on their way. Nothing is lost without one of these going up.
struct BusCounters {
  std::uint64_t sent = 0;
  std::uint64_t received = 0;
  std::uint64_t lost = 0;          ///< frames that were on the bus and never reached this reader
  std::uint64_t refused = 0;       ///< sends that the queue had no room for (each retry counts)
  std::uint64_t error_frames = 0;  ///< reports of the CAN controller among the received
  std::uint64_t passed_over = 0;   ///< CAN FD frames that came while `receive` was asked, not `receive_any`
};

/// As can::Received, of either kind.
struct ReceivedAny {
  base::Time time{};
  can::AnyFrame frame{};
  friend constexpr bool operator==(const ReceivedAny&, const ReceivedAny&) = default;
};

/// Whether the bus can carry frames now.
enum class BusState : std::uint8_t {
  up,
  down,    ///< the interface was switched off; it may come back, and then the same object goes on
  closed,  ///< gone for good: `failure` says why
};

/// What is known of the frames that `send` took. A queue that takes a frame promises nothing: a controller
/// that is bus-off lets its queue be filled and emptied, and no frame leaves.
struct Delivery {
  bool known = false;         ///< whether the bus can tell; if not, `pending` says nothing
  std::uint64_t pending = 0;  ///< frames that were taken and have not left, as far as the bus knows
  Failure obstruction{};      ///< why nothing can leave now; empty: nothing is known to be in the way
  bool refused = false;       ///< the obstruction is a decision, which waiting does not change
};

/// A bus as a host program sees it. Satisfies can::Bus.
class Bus {
 public:
  Bus() = default;
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;
  virtual ~Bus() = default;

  /// "can0", "sim": what the user chose.
  [[nodiscard]] virtual std::string_view name() const = 0;
  /// true: taken; false: no room now (or the bus is down: see `state`), try again in a millisecond: a full
  /// queue does not always show in `descriptor`; Error::closed: the bus is gone; Error::bad_identifier,
  /// Error::bad_length: no such frame can exist.
  virtual base::Result<bool> send(const can::Frame& frame) = 0;
  /// Waits at most `timeout` (zero: not at all) for a frame. Frames are stamped by the bus (Unix time).
  /// Error::timed_out also comes early, when a signal was caught or `state` has changed.
  virtual base::Result<can::Received> receive(base::Duration timeout) = 0;
  /// `send`, of a frame of either kind. Error::bad_length, too, of a CAN FD frame that this bus cannot carry:
  /// `fd_obstacle` says why.
  virtual base::Result<bool> send_any(const can::AnyFrame& frame) {
    if (const auto classic = frame.classic()) return send(*classic);
    return base::Error::bad_length;
  }
  /// `receive`, of frames of either kind: that one passes over CAN FD frames, and counts them.
  virtual base::Result<ReceivedAny> receive_any(base::Duration timeout) {
    const auto received = receive(timeout);
    if (!received) return received.error;
    return ReceivedAny{received->time, received->frame};
  }
  /// Why this bus carries no CAN FD frame now; empty: it does.
  [[nodiscard]] virtual Failure fd_obstacle() const {
    return {"'" + std::string(name()) + "' carries no CAN FD frames",
            "use a CAN interface in FD mode, or the simulated bus"};
  }
  /// Only frames that pass one of the filters are received from now on (none: all). Error frames always are.
  virtual Outcome<void> subscribe(std::span<const can::Filter> filters) = 0;
  /// To poll for input once `receive(zero)` has answered Error::timed_out: until then frames may wait inside
  /// the bus. Owned by the bus.
  [[nodiscard]] virtual int descriptor() const = 0;
  [[nodiscard]] virtual const BusCounters& counters() const = 0;
  /// As the last `send` or `receive` left it.
  [[nodiscard]] virtual BusState state() const {
    return failure() == Failure{} ? BusState::up : BusState::closed;
  }
  /// What became of the frames that were sent. May ask the kernel: some 20 us.
  [[nodiscard]] virtual Delivery delivery() { return {}; }
  /// Whether a simulator is at its other end, and not a wire.
  [[nodiscard]] virtual bool is_simulated() const noexcept { return false; }
  /// bit/s, where the bus says it; 0: not known.
  [[nodiscard]] virtual std::uint32_t bit_rate() const noexcept { return 0; }
  /// Why `send` or `receive` answered Error::closed, in words; empty while the bus is open.
  [[nodiscard]] virtual const Failure& failure() const = 0;
};

}  // namespace ocm::transport
