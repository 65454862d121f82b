/// Listens for the refusal of the boards that a verb has spoken to, and says what they refused, why, and what
/// they would accept. Only what was sent is listened for, and only for client::refusal_patience after it.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ocm/can/bus.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/client/refusals.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/shared/live.hpp"

namespace ocm::cli {

/// Whether a verb listens: --no-confirm switches it off.
enum class Confirm : bool { no, yes };

class RefusalWatch {
 public:
  /// The catalogue must outlive it. `verb` is for messages.
  RefusalWatch(const protocol::Catalogue& catalogue, std::string verb, Confirm confirm)
      : refusals_(catalogue), verb_(std::move(verb)), confirm_(confirm == Confirm::yes) {}

  /// Before `frames` are sent, on a bus of which only `also` is needed besides: has it deliver the
  /// refusals of their boards, and takes those that came before.
  void prepare(transport::Bus& bus, std::span<const can::Frame> frames,
               std::vector<const protocol::Topic*> also = {});
  /// They have left.
  void sent(std::span<const can::Frame> frames);
  /// The same of one; `again`: of one that was not refused before.
  void sent(const can::Frame& frame, bool again = false);
  /// Any frame from the bus. True: a board refuses what was sent.
  bool take(const can::Received& received);
  /// Until when it is worth to listen.
  [[nodiscard]] Live::Clock::time_point until() const;
  /// Listens until then, or until the only board that was spoken to has refused. `beside` gets each frame,
  /// too.
  void listen(transport::Bus& bus, const std::function<void(const can::Received&)>& beside = {});

  /// What was refused since the last `tell`.
  [[nodiscard]] const std::vector<client::Refused>& refused() const { return refused_; }
  /// What could be asked for instead, if that is known: goes in place of a remedy.
  void offer(std::string instead) { offer_ = std::move(instead); }
  /// A sensor that the board does not serve is silent already, an actuator other than the motors at rest:
  /// which is what a stop is for.
  void forgive_unserved();
  /// Says what was refused, on stderr. True: something was, now or before.
  bool tell();
  /// The same, and leaves with exit_failure.
  void leave_if_refused();

 private:
  client::Refusals refusals_;
  std::string verb_;
  std::string offer_;
  bool confirm_ = true;
  std::size_t commanded_ = 0;  ///< frames that were sent
  bool told_ = false;
  std::vector<client::Refused> refused_;
};

}  // namespace ocm::cli
