/// What the robot's boards do by themselves, for the verbs that ask for it: the topics that a spec has for
/// it, and what the sensor `behaviour` says has become of it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "ocm/can/bus.hpp"
#include "ocm/client/frame_index.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/shared/behaviour_sensor.hpp"
#include "cli/shared/clock.hpp"

namespace ocm::cli {

/// The actuator of this name; leaves through cli::fail if the robot has no such behaviour.
[[nodiscard]] const protocol::Topic& behaviour_topic(const protocol::Catalogue& catalogue,
                                                     const std::string& verb, std::string_view name);

class BehaviourWatch {
 public:
  /// Of the behaviour of this name. The catalogue must outlive it. Leaves through cli::fail if the spec has
  /// no sensor `behaviour` with fields `active` and `ended` that name it.
  BehaviourWatch(const protocol::Catalogue& catalogue, const std::string& verb, std::string_view which);

  [[nodiscard]] const protocol::Topic& sensor() const { return sensor_.topic(); }
  void take(const can::Received& received);

  /// A sample has come since `begin`, or at all.
  [[nodiscard]] bool heard() const { return last_.has_value(); }
  /// The behaviour has been commanded: what was before no longer counts.
  void begin();
  /// The behaviour was active since, and is no longer; or samples say again and again that it is not; or it
  /// is another program's now.
  [[nodiscard]] bool over() const {
    return is_replaced() || (!active_ && (was_active_ || inactive_ >= most_inactive));
  }
  /// Another program has commanded a behaviour since: the board does that instead.
  [[nodiscard]] bool is_replaced() const { return replaced_; }
  /// The first command of another program since that could end it: "travel 20B#A08601000000E803"; empty:
  /// there was none.
  [[nodiscard]] const std::string& commanded() const { return commanded_; }
  [[nodiscard]] bool was_active() const { return was_active_; }
  /// When a sample came last.
  [[nodiscard]] Clock::time_point last() const { return last_.value_or(Clock::time_point{}); }
  /// How it ended, as the spec names it; what took its place if that is another behaviour.
  [[nodiscard]] const std::string& ended() const { return ended_; }
  /// "0.12 m, 1.57 rad": what the sensor's other fields say.
  [[nodiscard]] const std::string& left() const { return left_; }

 private:
  /// One may have been on its way when the behaviour was commanded.
  static constexpr int most_inactive = 3;

  client::FrameIndex index_;
  BehaviourSensor sensor_;
  std::string which_name_;
  std::int64_t which_ = 0;  ///< raw number of the behaviour in `active`
  std::optional<Clock::time_point> last_;
  bool active_ = false;
  bool was_active_ = false;
  int inactive_ = 0;  ///< samples of before it was active
  bool replaced_ = false;
  std::string commanded_;
  std::string ended_;
  std::string left_;
};

}  // namespace ocm::cli
