/// Whether the boards that this program commands are there. A frame is acknowledged by any node that hears
/// it, so that it has left says nothing of the board that it is for; and a board confirms no set point. One
/// of which nothing is heard can be asked for its status.
///
///     client::Presence presence{amiro::catalogue};
///     presence.sent(frame); ... presence.take(received.frame);
///     for (const auto* status : presence.unheard()) bus.send(protocol::once(status->id, status->priority));
///
/// Only set points of actuators count: what asks a sensor is answered by its samples. Of a board without a
/// topic of the role `status` nothing can be known.
///
/// Pure: sends nothing, reads no clock. O(1) a frame.
#pragma once

#include <vector>

#include "ocm/can/frame.hpp"
#include "ocm/client/frame_index.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::client {

class Presence {
 public:
  /// The catalogue must outlive it.
  explicit Presence(const protocol::Catalogue& catalogue)
      : catalogue_(&catalogue), index_(catalogue), boards_(catalogue.boards.size()) {
    for (const protocol::Topic& topic : catalogue.topics)
      if (topic.role == protocol::Role::status && topic.board < boards_.size())
        boards_[topic.board].status = &topic;
  }

  /// A frame was sent, or is about to be: where it is a set point, its board should be there.
  void sent(const can::Frame& frame) {
    const Subject subject = index_.subject(frame.id, frame.format);
    if (!subject.frame || subject.topic->kind != protocol::Kind::actuator) return;
    if (subject.topic->board < boards_.size()) boards_[subject.topic->board].commanded = true;
  }
  /// Every frame from the bus: what a board sends shows that it is there, also before it is commanded.
  void take(const can::Frame& frame) {
    const Subject subject = index_.subject(frame.id, frame.format);
    if (!subject.frame || subject.topic->kind != protocol::Kind::sensor) return;
    if (subject.topic->board < boards_.size()) boards_[subject.topic->board].heard = true;
  }

  /// All that the boards that were commanded can send: each of it shows that its board is there.
  [[nodiscard]] std::vector<const protocol::Topic*> signs() const {
    std::vector<const protocol::Topic*> all;
    for (const protocol::Topic& topic : catalogue_->topics)
      if (topic.kind == protocol::Kind::sensor && topic.board < boards_.size() &&
          boards_[topic.board].commanded)
        all.push_back(&topic);
    return all;
  }
  /// The status of each board that was commanded and has sent nothing, in the order of the spec's boards.
  [[nodiscard]] std::vector<const protocol::Topic*> unheard() const {
    std::vector<const protocol::Topic*> all;
    for (const Board& board : boards_)
      if (board.commanded && !board.heard && board.status != nullptr) all.push_back(board.status);
    return all;
  }

 private:
  struct Board {
    const protocol::Topic* status = nullptr;
    bool commanded = false;
    bool heard = false;
  };

  const protocol::Catalogue* catalogue_;
  FrameIndex index_;
  std::vector<Board> boards_;  ///< as the catalogue numbers them
};

}  // namespace ocm::client
