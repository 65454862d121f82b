/// Whether an actuator has two commanders: a set point carries no sender, but a program that holds one
/// repeats it, so set points that take turns within a hold period come from two programs. Looks at actuators
/// with a timeout only: a light may blink.
///
/// A single program whose set points swing to and fro as fast looks the same.
///
/// Pure: sends nothing, reads no clock. O(1) a frame; allocates once for each actuator.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/can/text.hpp"
#include "ocm/client/command.hpp"
#include "ocm/client/diagnosis.hpp"
#include "ocm/client/sample.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::client {

class Commanders {
 public:
  /// A set point comes back within a hold period; it may be late by half of one.
  static constexpr base::Duration window = hold_period * 3 / 2;
  /// So many returns are no accident: a stop that another program sends into a drive makes one.
  static constexpr std::uint64_t fewest_returns = 3;

  struct Dispute {
    const protocol::Topic* topic = nullptr;
    std::uint64_t returns = 0;  ///< of a set point, after another one
    can::Frame last;            ///< the last that returned
    can::Frame between;         ///< the one that came between
  };

  void take(const can::Received& received, const Reception& reception) {
    if (reception.meaning != Meaning::set_point || reception.topic->timeout.count() == 0) return;
    auto heard = std::find_if(heard_.begin(), heard_.end(),
                              [&](const Heard& h) { return h.dispute.topic == reception.topic; });
    if (heard == heard_.end()) {
      heard_.push_back({});
      heard = heard_.end() - 1;
      heard->dispute.topic = reception.topic;
      heard->recent.reserve(most_recent + 1);
    }
    take(received, *heard);
  }

  /// What is in dispute, in the order in which it was first commanded.
  [[nodiscard]] std::vector<Dispute> disputes() const {
    std::vector<Dispute> all;
    for (const Heard& heard : heard_)
      if (heard.dispute.returns >= fewest_returns) all.push_back(heard.dispute);
    return all;
  }

  /// The same as findings of a diagnosis.
  [[nodiscard]] std::vector<Finding> findings(const protocol::Catalogue& catalogue) const {
    std::vector<Finding> all;
    for (const Dispute& dispute : disputes())
      all.push_back({Severity::warning,
                     dispute.topic->board < catalogue.boards.size()
                         ? catalogue.boards[dispute.topic->board].name
                         : std::string_view{},
                     "two programs command " + std::string{dispute.topic->name} +
                         " in turns: " + std::string{can::to_text(dispute.last).view()} + " and " +
                         std::string{can::to_text(dispute.between).view()},
                     "end one of them: the actuator follows the set point that came last",
                     Ailment::two_commanders, dispute.topic->name});
    return all;
  }

 private:
  /// As many programs can take turns and be noticed.
  static constexpr std::size_t most_recent = 4;
  struct Last {
    can::Frame frame;
    base::Time time;
  };
  struct Heard {
    Dispute dispute;
    std::vector<Last>
        recent;  // different set points, each with the time when it came last; the latest is last
  };

  static void take(const can::Received& received, Heard& heard) {
    auto& recent = heard.recent;
    const auto same = std::find_if(recent.begin(), recent.end(),
                                   [&](const Last& last) { return last.frame == received.frame; });
    if (same != recent.end()) {
      if (same + 1 != recent.end() && received.time - same->time <= window) {
        ++heard.dispute.returns;
        heard.dispute.last = received.frame;
        heard.dispute.between = recent.back().frame;
      }
      recent.erase(same);
    }
    recent.push_back({received.frame, received.time});
    if (recent.size() > most_recent) recent.erase(recent.begin());
  }

  std::vector<Heard> heard_;
};

}  // namespace ocm::client
