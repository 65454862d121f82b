/// What the robot's boards do by themselves, for the verbs that ask for it: the topics that a spec has for
/// it, and what the sensor `behaviour` says has become of it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "ocm/can/bus.hpp"
#include "ocm/client/frame_index.hpp"
#include "ocm/protocol/topic.hpp"

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

  [[nodiscard]] const protocol::Topic& sensor() const { return *sensor_; }
  void take(const can::Received& received);

  /// A sample has come since `begin`, or at all.
  [[nodiscard]] bool heard() const { return last_.has_value(); }
  /// The behaviour has been commanded: what was before no longer counts.
  void begin();
  /// The behaviour was active since, and is no longer; or samples say again and again that it is not.
  [[nodiscard]] bool over() const { return !active_ && (was_active_ || inactive_ >= most_inactive); }
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
  const protocol::Topic* sensor_;
  const protocol::Field* active_field_ = nullptr;
  const protocol::Field* ended_field_ = nullptr;
  std::int64_t which_ = 0;  ///< raw number of the behaviour in `active`
  std::optional<Clock::time_point> last_;
  bool active_ = false;
  bool was_active_ = false;
  int inactive_ = 0;  ///< samples of before it was active
  std::string ended_;
  std::string left_;
};

}  // namespace ocm::cli
