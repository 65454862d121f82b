/// Messages of J1939 that take several frames, sent beside what else a program does: which frame is due when.
/// No bus and no clock of its own.
///
/// A source has one broadcast at a time: others of it wait. Frames are never nearer to one another than
/// j1939::broadcast_distance, and when one is so late that listeners have given up, the message begins again.
/// A round that has begun is sent to its end, also when the same message is to be sent with other values.
/// What another node broadcasts from the same source meanwhile cannot be prevented, and is counted.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/can/frame.hpp"
#include "ocm/client/command.hpp"
#include "ocm/j1939/transport.hpp"

#include "cli/shared/clock.hpp"

namespace ocm::cli {

class Broadcasts {
 public:
  using Clock = cli::Clock;
  using Moment = Clock::time_point;
  /// A frame that the bus does not take is tried again after this long.
  static constexpr Clock::duration try_again = std::chrono::milliseconds{5};

  /// What was not sent, in messages.
  struct Counts {
    std::uint64_t late = 0;    ///< turns left out and messages begun again: program or bus was too late
    std::uint64_t waited = 0;  ///< turns left out, and messages replaced, while the source had another
    std::uint64_t met = 0;     ///< rounds during which another node broadcast from the same source
  };

  /// Sends it from `now` on: once, or again and again. It takes the place of what was sent of this message.
  void begin(client::Broadcast broadcast, const std::optional<client::Repeat>& repeat, Moment now);

  [[nodiscard]] bool empty() const noexcept { return all_.empty(); }
  [[nodiscard]] std::size_t size() const noexcept { return all_.size(); }
  /// When `advance` has something to do, at the latest; Moment::max() when empty.
  [[nodiscard]] Moment next_event() const noexcept;

  /// Calls `send(const can::AnyFrame&)` for what is due. It says when the bus took the frame: a look at the
  /// clock behind it, so that the next is not too near; nothing if the bus did not.
  template <class Send>
  void advance(Moment now, Send send) {
    for (std::size_t i = 0; i < all_.size();) {
      Each& each = all_[i];
      if (is_over(each, now)) {
        all_.erase(all_.begin() + static_cast<std::ptrdiff_t>(i));
        continue;
      }
      if (is_due(each, now)) {
        if (const std::optional<Moment> taken = send(std::as_const(each.broadcast).frame(each.at)))
          sent(each, *taken);
        else
          hold_up(each, now);
      }
      ++i;
    }
  }

  /// A frame from the bus, which never hands a program its own. The message under way from whose source it is
  /// broadcast, too: listeners take the packets of both for one message, and drop it. Nothing where it is of
  /// none, or not the first of the round.
  [[nodiscard]] const client::Broadcast* meet(const can::Frame& frame);

  /// Since when the bus has not taken what was due; nothing where it has.
  [[nodiscard]] std::optional<Moment> held_up_since() const noexcept;
  [[nodiscard]] const Counts& counts() const noexcept { return counts_; }
  /// The first message of which a part was sent, and not all.
  [[nodiscard]] const client::Broadcast* unfinished() const noexcept;
  /// Messages that were to be sent once, and of which nothing was.
  [[nodiscard]] std::vector<const client::Broadcast*> waiting() const;

 private:
  struct Each {
    client::Broadcast broadcast;
    Clock::duration period{};         ///< 0: it is sent once
    Moment end;                       ///< no round begins at it or later
    Moment begin;                     ///< when the round that comes next, or is under way, should begin
    Moment next;                      ///< when its next frame is due
    Moment left;                      ///< when its last frame was taken
    std::uint32_t at = 0;             ///< number of its next frame; 0: no round is under way
    bool met = false;                 ///< another node broadcasts from its source in this round
    std::optional<Moment> held_up{};  ///< since when the bus does not take it
  };

  [[nodiscard]] Moment due(const Each& each) const noexcept;
  /// Whether nothing of it will be sent any more.
  [[nodiscard]] bool is_over(const Each& each, Moment now) const noexcept;
  /// Whether its next frame goes now. What is too late for that is given up or skipped, and counted.
  [[nodiscard]] bool is_due(Each& each, Moment now);
  /// A round under way, of which listeners await no more.
  void give_up_round(Each& each, Moment now);
  /// A turn that the bus holds up is none of them.
  void skip_missed_turns(Each& each, Moment now);
  /// Of the turns that are over the last becomes the next round, unless it is at the end or later. How many
  /// are left out. It has a period.
  static std::uint64_t leave_out(Each& each, Moment now);
  void sent(Each& each, Moment taken);
  static void hold_up(Each& each, Moment now);

  std::vector<Each> all_;
  std::array<Moment, 256> free_{};  ///< of each source: when it may announce the next message
  Counts counts_;
};

}  // namespace ocm::cli
