/// Another program that commands the motors which this one is about to hold, or holds: a board follows the
/// set point that came last, so two of them take turns. A bus never hands a program its own frames, so every
/// set point that comes is another one's.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>

#include "ocm/can/bus.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/client/frame_index.hpp"
#include "ocm/host/failure.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/shared/clock.hpp"
#include "cli/shared/set_points.hpp"

namespace ocm::cli {

class OtherCommander {
 public:
  /// The catalogue must outlive it. `verb` is for messages.
  OtherCommander(const protocol::Catalogue& catalogue, std::string verb)
      : index_(catalogue), verb_(std::move(verb)) {}

  /// Whether the frame is a set point of motors.
  [[nodiscard]] bool is_set_point(const can::Frame& frame) const {
    return commanded_motors(index_, frame) != nullptr;
  }
  /// A frame from the bus. `holding`: this program commands the motors, too, and says so, once.
  void take(const can::Received& received, bool holding);
  /// A set point of rest came while this program commanded the motors.
  [[nodiscard]] bool has_stopped() const { return stopped_; }
  /// Leaves through cli::fail if a set point came within client::listen_before_hold.
  void refuse_if_heard();
  /// Whether one came within that time.
  [[nodiscard]] bool is_heard();
  /// The last set point that came.
  [[nodiscard]] const can::Frame& last() const { return last_; }
  [[nodiscard]] std::string_view motors() const { return motors_ == nullptr ? "" : motors_->name; }
  /// How many set points came while this program commanded the motors, if any did.
  void sum_up() const;

 private:
  client::FrameIndex index_;
  std::string verb_;
  const protocol::Topic* motors_ = nullptr;  // of `last_`
  can::Frame last_;
  std::deque<Clock::time_point> recent_;  // of set points within client::listen_before_hold
  bool stopped_ = false;                  // one of `meanwhile_` was zero
  std::uint64_t meanwhile_ = 0;           // set points while this program commanded the motors
};

}  // namespace ocm::cli
