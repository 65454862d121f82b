/// What frames that a program has sent have begun of what boards do by themselves, such as a travel: it goes
/// on without the program, which ends it where it is cut short.
#pragma once

#include <string>
#include <vector>

#include "ocm/can/frame.hpp"
#include "ocm/client/frame_index.hpp"

namespace ocm::cli {

class BegunBehaviours {
 public:
  struct Begun {
    const protocol::Topic* topic;
    can::Frame end;  ///< its set point with all fields zero, at the priority that it was begun with
  };

  /// The catalogue must outlive it.
  explicit BegunBehaviours(const protocol::Catalogue& catalogue) : index_(catalogue) {}

  /// Any frame, in the order in which they are sent.
  void sent(const can::Frame& frame);
  /// Whether a board goes on by itself once it has this frame.
  [[nodiscard]] bool is_begun_by(const can::Frame& frame) const;
  /// Those that no frame has ended.
  [[nodiscard]] const std::vector<Begun>& all() const noexcept { return all_; }
  /// Their names, with a verb: "travel was", "avoid, travel were"; empty: there is none.
  [[nodiscard]] std::string names() const;
  void clear() noexcept { all_.clear(); }

 private:
  /// What the frame is a set point of, if it is one of those; otherwise nullptr.
  [[nodiscard]] const protocol::Topic* topic_of(const can::Frame& frame) const;

  client::FrameIndex index_;
  std::vector<Begun> all_;
};

}  // namespace ocm::cli
