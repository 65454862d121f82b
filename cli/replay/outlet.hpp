/// A bus that recorded frames are sent to, as long as it takes: CAN FD frames too where it carries
/// them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "ocm/base/time.hpp"
#include "ocm/client/frame_index.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/shared/begun_behaviours.hpp"
#include "cli/shared/outgoing.hpp"
#include "cli/shared/set_points.hpp"

namespace ocm::cli::replay {

class Outlet {
 public:
  /// The catalogue says which frames are set points of motors.
  Outlet(std::unique_ptr<transport::Bus> bus, const protocol::Catalogue& catalogue);

  enum class Sent : std::uint8_t {
    yes,
    error_frame,  ///< a report of a controller: nothing for the wire
    fd_frame,     ///< this bus has none
    late,         ///< a set point of motion, or what begins a behaviour, that could not go before `latest`
  };
  /// Waits for room up to a second, then leaves through cli::fail. A set point of motion, and one by which a
  /// board moves by itself, waits until all that was sent before it has left, as long as motors wait for one;
  /// then zero is put behind what waits. It is not sent after `latest`.
  Sent send(const log::Entry& entry, base::Time latest);

  /// Leaves as `send` does, with zero behind what waits, where the frame of motion that came last has not
  /// left for so long. For the time up to the next frame; waits for nothing.
  void expect_motion_left();

  /// Whether motors run, or a board does something by itself, because of the frames.
  [[nodiscard]] bool commands() const { return !is_rest(set_point_) || !behaviours_.all().empty(); }

  /// Leaves through cli::fail when the bus is gone. Waits for nothing.
  void expect_open() const;
  /// Readable when `expect_open` may have something to say.
  [[nodiscard]] int descriptor() const { return bus_->descriptor(); }

  /// Sets motors to zero that the frames have left running. false: they have not.
  bool rest();

  /// Ends what boards do by themselves because of the frames: "travel was"; empty: nothing.
  std::string end_behaviours();

  /// Ends all of that behind a failure, as far as the bus takes each frame within 200 ms: what it means for
  /// the robot where it does not; empty: it does, or there was nothing to end.
  std::string end_after_all();

  /// Waits until all has left, or leaves through cli::fail and says how much has not.
  void expect_all_left();

  [[nodiscard]] std::string_view name() const { return bus_->name(); }

 private:
  /// Waits until all has left, or leaves at rest. false: it is later than `latest`.
  [[nodiscard]] bool may_move_now(base::Time latest);
  /// What was sent just now moves the robot.
  void motion_sent();
  /// Puts zero behind whatever waits (at most one set point of motion does) and leaves, unless all has left
  /// just now.
  void leave_at_rest();

  std::unique_ptr<transport::Bus> bus_;
  Outgoing outgoing_;
  bool takes_fd_;
  client::FrameIndex index_;
  BegunBehaviours behaviours_;
  can::Frame set_point_;      ///< of motors, the last that was sent
  std::uint64_t behind_ = 0;  ///< frames that were sent after it
  /// Of the last frame that moves the robot, a set point or what begins a behaviour.
  Clock::time_point sent_at_{};
  std::uint64_t behind_motion_ = 0;  ///< frames that were sent after it
  bool may_wait_ = false;            ///< it may wait still, and no rest has come behind it
};

}  // namespace ocm::cli::replay
