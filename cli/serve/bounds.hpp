/// Response times of a robot's messages, measured while they come, beside the bounds that are proved for the
/// periods that were asked for. Of plain messages there are none: `amiroctl analyse bus` has them.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "ocm/log/entry.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/analyse/meter.hpp"
#include "cli/analyse/study.hpp"
#include "cli/bus_model/model.hpp"

namespace ocm::cli::serve {

class Bounds {
 public:
  /// The catalogue must outlive it. Without a bit rate, 0, there are no bounds.
  Bounds(const protocol::Catalogue& catalogue, std::uint32_t bit_rate);

  /// What is published with which periods now: where that has changed, bounds are proved again, and what was
  /// measured begins again. A few milliseconds then.
  void assume(std::span<const bus_model::Row> rows);
  /// A frame from the bus. O(log messages).
  void take(const log::Entry& entry);
  /// One JSON object; without rows where there is nothing to prove.
  [[nodiscard]] std::string state() const;

 private:
  /// What one topic is sent with.
  struct Stream {
    const protocol::Topic* topic = nullptr;
    protocol::Priority priority{};
    std::int64_t period = 0;
    friend bool operator==(const Stream&, const Stream&) = default;
  };

  const protocol::Catalogue* catalogue_;
  std::uint32_t bit_rate_;
  std::vector<Stream> streams_;
  analyse::BusSet set_;
  analyse::Study study_;
  std::vector<analyse::Meter> meters_;         ///< by row of the study
  std::map<std::uint32_t, std::size_t> rows_;  ///< by identifier
};

}  // namespace ocm::cli::serve
