/// A log of a central's line on the page: its robots and the map that they draw, played and wound by a time
/// bar. For the thread that takes orders.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "ocm/base/time.hpp"

#include "cli/fleet/line_replay.hpp"
#include "cli/serve/fleet_state.hpp"
#include "cli/serve/orders.hpp"
#include "cli/serve/viewers.hpp"
#include "cli/shared/clock.hpp"

namespace ocm::cli::serve {

class FleetPlayer {
 public:
  /// `name`: of the log, for the page. The viewers must outlive it.
  FleetPlayer(fleet::LineReplay replay, std::string name, Viewers& viewers, FleetChannels channels,
              std::uint32_t playback)
      : replay_(std::move(replay)),
        name_(std::move(name)),
        viewers_(&viewers),
        channels_(channels),
        playback_(playback) {}

  /// The clock has gone on by so much.
  void pass(base::Duration time) {
    if (!paused_) replay_.play(time);
  }
  /// What a time bar asks; nothing else.
  void obey(const Order& order);
  /// What is due.
  void publish(Clock::time_point now);

 private:
  void publish_robots();
  void publish_map();

  fleet::LineReplay replay_;
  std::string name_;
  Viewers* viewers_;
  FleetChannels channels_;
  std::uint32_t playback_;
  bool paused_ = false;
  std::uint64_t jumps_ = 0;
  std::string map_;  ///< that was published last
  Clock::time_point next_bar_{}, next_robots_{}, next_map_{};
};

}  // namespace ocm::cli::serve
