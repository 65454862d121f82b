/// Plain messages beside the user: every node of a spec sends what it has a period for, on a virtual bus or
/// on a CAN interface.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ocm/protocol/topic.hpp"
#include "ocm/simulation/arbiter.hpp"
#include "ocm/transport/bus.hpp"

#include "sim/messages/player.hpp"
#include "sim/serve/shell.hpp"

namespace ocm::sim {

struct MessagesOptions {
  PlayOptions play;
  std::uint32_t bit_rate = 500'000;
  std::uint32_t data_bit_rate = 0;  ///< of CAN FD frames with bit-rate switch; 0: `bit_rate`
  double bus_errors = 0;            ///< bits a second that nodes see wrong, on average
  double speed = 1;
};

/// The nodes of a catalogue on a simulated wire: one for each that sends, and one for messages of which no
/// sender is known. Catalogue and wire must outlive it.
class MessageNodes {
 public:
  MessageNodes(const protocol::Catalogue& catalogue, const PlayOptions& options, simulation::Arbiter& wire);
  [[nodiscard]] const MessagePlayer& player() const noexcept { return player_; }
  [[nodiscard]] base::Time next_event() const noexcept { return player_.next_event(); }
  /// Hands over what is due; the wire must have been advanced to `now`.
  void advance(base::Time now);
  /// What each node sent and what found no room, a line each.
  void summarise(const Shell& shell) const;

 private:
  struct Node {
    std::string_view name;
    simulation::NodeId id;
    std::uint64_t handed_over = 0;
    std::uint64_t refused = 0;
  };
  MessagePlayer player_;
  simulation::Arbiter* wire_;
  std::vector<Node> nodes_;  // by board; the last: unknown senders
};

/// Reports by name which messages are not played, and why; `no_fd`: what keeps those of CAN FD away.
void report_left_out(const MessagePlayer& player, const Shell& shell, const host::Failure& no_fd = {});
/// Why nothing can be played, when that is so.
[[nodiscard]] Ending nothing_to_play(const MessagePlayer& player, const protocol::Catalogue& catalogue,
                                     const host::Failure& no_fd = {});

/// On a virtual bus, whose socket is `path`; empty: that of the user.
[[nodiscard]] Ending serve_messages(const std::string& path, const protocol::Catalogue& catalogue,
                                    const MessagesOptions& options, const Shell& shell);

/// On a CAN interface: the kernel is the bus. In real time, without disturbances.
[[nodiscard]] Ending serve_messages(transport::Bus& bus, const protocol::Catalogue& catalogue,
                                    const MessagesOptions& options, const Shell& shell);

}  // namespace ocm::sim
