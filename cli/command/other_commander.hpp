/// Another program that commands the motors which this one is about to hold, or holds: a board follows the
/// set point that came last, so two of them take turns. A bus never hands a program its own frames, so every
/// set point that comes is another one's. What a board does by itself for another program shows in the
/// samples of its sensor alone.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "ocm/can/bus.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/client/frame_index.hpp"
#include "ocm/host/failure.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/shared/behaviour_sensor.hpp"
#include "cli/shared/clock.hpp"
#include "cli/shared/set_points.hpp"

namespace ocm::cli {

class OtherCommander {
 public:
  /// The catalogue must outlive it. `verb` is for messages.
  OtherCommander(const protocol::Catalogue& catalogue, std::string verb)
      : catalogue_(&catalogue), index_(catalogue), behaviour_(catalogue), verb_(std::move(verb)) {}

  /// Whether the frame is a set point of motors.
  [[nodiscard]] bool is_set_point(const can::Frame& frame) const {
    return commanded_motors(index_, frame) != nullptr;
  }
  /// A frame from the bus. `holding`: this program commands the motors, too, and says so, once.
  void take(const can::Received& received, bool holding);
  /// This program has begun to hold the motors, with its first set point just before `first`, and would not
  /// have done so beside another one.
  void hold_begins(Clock::time_point first) { hold_began_ = first; }
  /// Another program began within client::listen_before_hold of that: neither can have heard the other.
  [[nodiscard]] bool has_begun_too() const { return begun_too_; }
  /// A set point of rest came while this program commanded the motors.
  [[nodiscard]] bool has_stopped() const { return stopped_; }
  /// Leaves through cli::fail if a set point came within client::listen_before_hold, or a board does
  /// something by itself that this program has not commanded.
  void refuse_if_heard();
  /// Whether it is so.
  [[nodiscard]] bool is_heard();
  /// What is asked for on a bus on which the sensor was not heard; nullptr: nothing need be asked.
  [[nodiscard]] const BehaviourSensor* unheard_sensor() const {
    return behaviour_.exists() && !active_ ? &behaviour_ : nullptr;
  }
  /// Says that no board has said what it does by itself: that one may be off, or no robot there. For a
  /// program that has asked.
  void tell_unanswered() const;
  /// This program sends a frame: if it commands the wheels, what a board does from now on may be that.
  void send(const can::Frame& frame) {
    own_ = own_ || is_set_point(frame) || behaviour_.commanded(index_, frame) != nullptr;
  }
  /// Whether it has a board do something by itself.
  [[nodiscard]] bool is_behaviour(const can::Frame& frame) const {
    return behaviour_.commanded(index_, frame) != nullptr && !is_rest(frame);
  }
  /// The last set point that came.
  [[nodiscard]] const can::Frame& last() const { return last_; }
  [[nodiscard]] std::string_view motors() const { return motors_ == nullptr ? "" : motors_->name; }
  /// How many set points came while this program commanded the motors, if any did.
  void sum_up() const;

 private:
  [[nodiscard]] bool is_a_board_active() const { return !own_ && active_ && !active_->empty(); }

  const protocol::Catalogue* catalogue_;
  client::FrameIndex index_;
  BehaviourSensor behaviour_;
  std::string verb_;
  std::optional<std::string_view> active_;  // what the last sample said
  bool own_ = false;
  const protocol::Topic* motors_ = nullptr;  // of `last_`
  can::Frame last_;
  std::deque<Clock::time_point> recent_;  // of set points within client::listen_before_hold
  std::optional<Clock::time_point> hold_began_;
  bool begun_too_ = false;
  bool stopped_ = false;         // one of `meanwhile_` was zero
  std::uint64_t meanwhile_ = 0;  // set points while this program commanded the motors
};

}  // namespace ocm::cli
