/// What a robot's board does by itself, as its sensor `behaviour` says: a program that drives must know it,
/// for no set point of the motors shows it on the bus.
#pragma once

#include <optional>
#include <string_view>

#include "ocm/can/frame.hpp"
#include "ocm/client/frame_index.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::cli {

class BehaviourSensor {
 public:
  /// The catalogue must outlive it.
  explicit BehaviourSensor(const protocol::Catalogue& catalogue);

  /// The spec has a sensor `behaviour` of one frame, with fields `active` and `ended`.
  [[nodiscard]] bool exists() const { return active_ != nullptr; }
  [[nodiscard]] const protocol::Topic& topic() const { return *topic_; }
  [[nodiscard]] const protocol::Field& active() const { return *active_; }
  [[nodiscard]] const protocol::Field& ended() const { return *ended_; }
  /// What a sample says is active, by its name in the spec; empty: nothing. None: it is no sample of this.
  [[nodiscard]] std::optional<std::string_view> active_in(const client::FrameIndex& index,
                                                          const can::Frame& frame) const;
  /// The behaviour that a frame commands; nullptr if it is no set point of one that `active` names.
  [[nodiscard]] const protocol::Topic* commanded(const client::FrameIndex& index,
                                                 const can::Frame& frame) const;
  /// Asks for one sample.
  [[nodiscard]] can::Frame request() const;

 private:
  const protocol::Topic* topic_;
  const protocol::Field* active_ = nullptr;
  const protocol::Field* ended_ = nullptr;
};

}  // namespace ocm::cli
