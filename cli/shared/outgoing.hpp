/// Frames on their way out. A command is done when its frames have left this machine, and not when a queue
/// has taken them: the queue of a controller that is bus-off takes everything.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "ocm/base/time.hpp"
#include "ocm/can/any_frame.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/shared/clock.hpp"

namespace ocm::cli {

/// What it means when a stop, or the end of a drive, did not leave.
inline constexpr const char* still_moving =
    "THE ROBOT MAY STILL MOVE until its watchdog stops it: be ready to cut its power";
/// The same of what a board does by itself, which no watchdog ends.
inline constexpr const char* still_travelling =
    "THE ROBOT MAY STILL MOVE, to the end of its way: be ready to cut its power";
/// What to check when the bus takes frames and none leaves.
[[nodiscard]] std::string why_none_leaves(const transport::Bus& bus);

class Outgoing {
 public:
  /// `verb` is for messages; `otherwise` says what it means for the robot that frames did not leave, if it
  /// means something. Leaves through cli::fail when nothing can leave, before anything is sent. `bus` must
  /// outlive it.
  Outgoing(transport::Bus& bus, std::string verb, std::string otherwise = {});

  /// From now on it means this that frames do not leave.
  void otherwise(std::string meaning);
  /// The same, once one of the frames that are sent from now on has left: nothing was commanded before.
  void otherwise_after_the_next(std::string meaning);
  /// Whether it means something for the robot if frames do not leave now.
  [[nodiscard]] bool matters() const;

  /// Waits for room in the queue, at most `patience`; then leaves with the bus's words. Leaves with them,
  /// too, if the bus carries no CAN FD frames and this is one.
  void send(const can::AnyFrame& frame, base::Duration patience = std::chrono::seconds{1});
  /// Behind a failure, for an end: whether the bus has taken it within `patience`. Says nothing.
  [[nodiscard]] bool is_taken(const can::Frame& frame, base::Duration patience);
  /// A simulated robot has gone with its bus: nothing moves.
  [[nodiscard]] bool robot_is_gone() const;
  /// The looks at the clock of `send`, each millisecond, go on from a look of the caller.
  void looks_from(Clock::time_point look) noexcept { looked_ = look; }
  [[nodiscard]] Clock::time_point looked() const noexcept { return looked_; }  ///< the last one
  /// The longest time between two of them: this program did not run. A bus that takes its time makes it no
  /// longer.
  [[nodiscard]] base::Duration stood_still() const noexcept { return stood_still_; }
  /// Waits until all that was sent has left; leaves and says how much has not, when none has left for
  /// `patience`.
  void expect_all_left(base::Duration patience = std::chrono::milliseconds{500});
  /// The same as an answer. A bus that cannot tell says yes; one that is gone, no.
  [[nodiscard]] bool all_left(base::Duration patience);
  /// Leaves with the words of the bus, which is gone, and with what that means for the robot.
  [[noreturn]] void leave_gone() const;

 private:
  /// The time.
  Clock::time_point look();
  [[noreturn]] void give_up(std::string what, std::string remedy) const;

  transport::Bus& bus_;
  std::string verb_;
  std::string otherwise_;
  Clock::time_point looked_ = Clock::now();
  base::Duration stood_still_{};
  std::uint64_t before_ = 0;  ///< frames that were sent before it meant something
  bool always_ = true;        ///< also if none has left since
};

}  // namespace ocm::cli
