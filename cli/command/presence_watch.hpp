/// Whether the boards that a verb has given set points are there: a board of which nothing was heard is asked
/// for its status, and has two seconds to answer.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/can/bus.hpp"
#include "ocm/client/command.hpp"
#include "ocm/client/frame_index.hpp"
#include "ocm/client/presence.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/command/refusal_watch.hpp"
#include "cli/shared/live.hpp"
#include "cli/shared/outgoing.hpp"

namespace ocm::cli {

class PresenceWatch {
 public:
  /// The catalogue must outlive it. `verb` is for messages.
  PresenceWatch(const protocol::Catalogue& catalogue, std::string verb, Confirm confirm)
      : catalogue_(&catalogue),
        index_(catalogue),
        presence_(catalogue),
        verb_(std::move(verb)),
        waived_(confirm == Confirm::no) {}

  /// What was sent, or is about to be. Of a stop the motors count: another board that is off is at rest.
  void sent(const client::Command& command);
  /// Any frame from the bus. True: it answers what `ask` has asked.
  bool take(const can::Received& received);
  /// The caller says itself which board is silent.
  void waive() { waived_ = true; }
  /// What shows that boards are there; of a bus that delivers only some topics these are needed.
  [[nodiscard]] std::vector<const protocol::Topic*> signs() const;

  /// Behind the commands, once they have left, and after a while of listening: the question ends a stream of
  /// the status, and what is published comes by itself. `bus` must outlive this.
  void ask(const transport::Bus& bus, Outgoing& outgoing);
  /// Until all have answered, or time is up. `take` gets each frame, and hands it on to take().
  Over listen(Live& live, const std::function<void(const can::Received&)>& take);
  /// Says which boards have not answered, and what that means for the robot, if it means something. True: at
  /// least one has not.
  bool tell(std::string_view otherwise = {});

 private:
  /// Those that were asked, or could not be, and have not answered.
  [[nodiscard]] std::vector<const protocol::Topic*> silent() const;
  [[nodiscard]] std::vector<const protocol::Topic*> questions() const;

  const protocol::Catalogue* catalogue_;
  client::FrameIndex index_;
  client::Presence presence_;
  std::string verb_;
  const transport::Bus* bus_ = nullptr;  ///< that of `ask`
  bool waived_;
  std::vector<const protocol::Topic*> asked_;
  bool takes_ = true;       ///< the bus has taken the questions
  bool cut_short_ = false;  ///< a signal came before all had answered
};

}  // namespace ocm::cli
