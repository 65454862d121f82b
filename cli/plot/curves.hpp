/// Fields of a robot's topics as curves: over time, or one against another.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "ocm/client/sample.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/log/interfaces.hpp"
#include "ocm/measure/envelope.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/output/selection.hpp"

namespace ocm::cli::plot {

/// What is drawn: `y` over time, or against `x`.
struct Wanted {
  std::optional<ChosenField> x;
  ChosenField y;
};

/// What a word means: `gyroscope.z`, `gyro.*`, `odometry.x` (in each frame that has an x),
/// `odometry.x:odometry.y` (in the frame that has both, where there is one). The failure names the word and
/// the nearest that there is.
[[nodiscard]] transport::Outcome<std::vector<Wanted>> parse_fields(const protocol::Catalogue& catalogue,
                                                                   std::string_view word);

struct Curve {
  Wanted wanted;
  measure::Envelope envelope;
  std::optional<double> x;  ///< the newest
};

/// Takes frames; memory does not grow with their number.
class Curves {
 public:
  /// The catalogue must outlive it.
  Curves(const protocol::Catalogue& catalogue, const std::vector<Wanted>& wanted);

  void take(std::span<const log::Entry> entries, const log::Interfaces& interfaces);

  [[nodiscard]] const std::vector<Curve>& all() const noexcept { return curves_; }
  /// Of the first frame, whatever it was.
  [[nodiscard]] std::optional<base::Time> begin() const noexcept { return begin_; }
  [[nodiscard]] base::Time end() const noexcept { return end_; }
  [[nodiscard]] std::uint64_t points() const noexcept;
  /// Messages of J1939's transport protocol that were not put together, until `end`, or are not yet: they may
  /// have had values for a curve.
  [[nodiscard]] std::uint64_t lost_messages() noexcept {
    return receiver_.transport_counters(end_).lost() + receiver_.transports_open();
  }

 private:
  struct Use {
    std::size_t curve = 0;
    const protocol::Field* field = nullptr;
    bool is_x = false;
  };
  client::Receiver receiver_;  ///< puts messages of J1939's transport protocol together
  std::unordered_map<const protocol::FrameLayout*, std::vector<Use>> uses_;  // x before y
  std::vector<Curve> curves_;
  std::optional<base::Time> begin_;
  base::Time end_{};
};

}  // namespace ocm::cli::plot
