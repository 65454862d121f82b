/// A recorded log held against the bounds: what was measured of each message, and which assumption of the
/// analysis the log contradicts.
///
/// A log has the ends of frames, not their releases. So a response time is measured from below: within each
/// run of 100 releases the earliest frame tells where the grid of the period lies at the latest, and the
/// latest one how far behind it a frame came. Clocks that drift apart by 100 ppm make that 1 % of a period
/// wrong at most.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ocm/protocol/topic.hpp"

#include "cli/analyse/meter.hpp"
#include "cli/analyse/set.hpp"
#include "cli/analyse/study.hpp"

namespace ocm::cli::analyse {

struct TraceStudy {
  Study study;
  std::vector<Measured> measured;   ///< one a row of the study
  std::vector<std::string> broken;  ///< assumptions that the log contradicts; empty: none
  std::int64_t span = 0;
  std::size_t frames = 0;
  double load = 0;  ///< measured, stuff bits as they were
  [[nodiscard]] bool passes() const;
};

/// `set`: a file with the messages, or empty for the robot's topics that are in the log, with the periods
/// that requests in it ask for, and all messages of the spec; `model`: that of the spec, nullptr without
/// messages.
[[nodiscard]] TraceStudy study_trace(const std::string& log, const std::string& set,
                                     const BusOptions& options, const protocol::Catalogue& catalogue,
                                     const spec::Model* model, std::vector<Rate> rates);

[[nodiscard]] std::string to_json(const TraceStudy& trace);
[[nodiscard]] std::string to_csv(const TraceStudy& trace);
[[nodiscard]] std::string to_table(const TraceStudy& trace);

}  // namespace ocm::cli::analyse
