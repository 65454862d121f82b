/// The one loop that receives from a live bus (`record` alone waits for several at once, in cli/record). It
/// sees signals, tells when the bus goes down and comes back, and knows when it is gone for good; what a verb
/// does with a frame is the verb's.
#pragma once

#include <cstdint>
#include <functional>

#include "ocm/can/bus.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/shared/clock.hpp"

namespace ocm::cli {

/// Why a wait for frames is over.
enum class Over : std::uint8_t {
  enough,  ///< the verb has what it needs
  time,
  signal,  ///< interrupted() says which
  gone,    ///< the bus is closed: its failure() says why
};

/// Tells once when a bus goes down, and once when it is back.
class StateWatch {
 public:
  void look(const transport::Bus& bus);

 private:
  transport::BusState state_ = transport::BusState::up;
};

/// Something else that is waited for, such as the socket of another program: when it is readable, it is
/// served once no frame is left, so that what is done there knows what had come. On a bus that always has one
/// it waits 20 ms at most, and a frame.
struct Beside {
  int descriptor = -1;
  std::function<void()> serve{};
};

class Live {
 public:
  using Clock = cli::Clock;
  /// Gets a frame; false: that was enough.
  using Take = std::function<bool(const can::Received&)>;

  /// `bus` must outlive it. `idle`, where there is one, is called before each wait, when no frame is left to
  /// take; the time is looked at then, so that nothing of what came in time is left. A bus
  /// that always has a frame is left behind a second of work more.
  explicit Live(transport::Bus& bus, std::function<void()> idle = {}, Beside beside = {})
      : bus_(&bus), idle_(std::move(idle)), beside_(std::move(beside)) {}

  /// Gets a frame of either kind.
  using TakeAny = std::function<bool(const transport::ReceivedAny&)>;

  /// Gives every classic frame to `take` until `until`.
  [[nodiscard]] Over receive(Clock::time_point until, const Take& take);
  /// Gives every frame to `take`, CAN FD ones too.
  [[nodiscard]] Over receive_any(Clock::time_point until, const TakeAny& take);
  /// The same for who cannot go on without the bus: leaves with its failure when it is gone, and after a
  /// signal.
  Over receive_or_leave(Clock::time_point until, const Take& take);

 private:
  template <class Ask, class GiveTo>
  [[nodiscard]] Over receive_next(Clock::time_point until, const Ask& ask, const GiveTo& take);

  /// Until a frame may be there, or time is up; serves what is beside, where no frame is.
  void wait_for_both(Clock::duration longest);
  /// Between two frames: serves what is beside where it has waited from one look to the next.
  void look_beside();
  [[nodiscard]] bool is_overdue(Clock::time_point until);

  transport::Bus* bus_;
  std::function<void()> idle_;
  Beside beside_;
  Clock::time_point looked_beside_{};
  Clock::time_point looked_{};  ///< among frames
  Clock::duration overrun_{};
  unsigned frames_ = 0;
  bool beside_waits_ = false;
  StateWatch state_;
};

}  // namespace ocm::cli
