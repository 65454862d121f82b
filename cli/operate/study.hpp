/// What can be said of an operator before it runs: whether each configuration and each change is in time, and
/// by when each transition acts.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/reflective/proof.hpp"

#include "cli/operate/operator_file.hpp"

namespace ocm::cli::operate {

struct StreamBound {
  std::uint16_t topic = reflective::none;
  base::Duration period{};
  protocol::Priority priority = protocol::default_priority;
  std::int64_t response = 0;  ///< on its board and on the bus, ns, or analysis::unbounded
  std::int64_t deadline = 0;
  /// Part of it on the processor of its board, from the release until the bus has the sample, ns, or
  /// analysis::unbounded; 0: the board's tasks are not known, and it is not counted.
  std::int64_t on_board = 0;
  reflective::Recovery recovery;  ///< once its board takes requests again after a reset
};
struct ConfigurationBound {
  std::int64_t load = 0;  ///< per mille
  std::vector<StreamBound> streams;
};
struct ChangeBound {
  std::uint16_t from = reflective::none;  ///< none: the start
  std::uint16_t to = reflective::none;
  std::int64_t over_after = 0;  ///< ns
  std::int64_t load = 0;        ///< per mille, old and new streams together
};
struct ReactionBound {
  std::uint16_t transition = reflective::none;
  std::uint16_t from = reflective::none;
  bool seen = true;                             ///< its configuration streams what the monitor looks at
  bool commands = false;                        ///< it ends with set points; else with the decision
  reflective::Latency latency;                  ///< of the latest condition
  std::vector<reflective::Latency> conditions;  ///< of each, if the monitor has several
};

struct Study {
  const OperatorFile* file = nullptr;
  std::uint32_t bit_rate = 0;
  std::vector<ConfigurationBound> configurations;
  std::vector<ChangeBound> changes;
  std::vector<ReactionBound> reactions;
  std::vector<std::uint16_t>
      unmeasured;                       ///< topics of streams of which the time on their board is not counted
  std::vector<spec::Problem> doubts;    ///< why it may be late; none: it is in time
  std::vector<spec::Problem> cautions;  ///< no reason to be late: see cautions.hpp

  [[nodiscard]] bool passes() const noexcept { return doubts.empty(); }
};

/// The file must outlive the study. Takes milliseconds to seconds.
[[nodiscard]] Study study(const OperatorFile& file, std::uint32_t bit_rate);

/// For people; for programs, one object; and as a state machine for Graphviz's dot.
[[nodiscard]] std::string to_table(const Study& study);
[[nodiscard]] std::string to_json(const Study& study);
[[nodiscard]] std::string to_dot(const Study& study);

/// "71.3 ms = 50 period + 1 jitter + ...": the parts that are not 0, exactly.
[[nodiscard]] std::string sum_of(const reflective::Latency& latency);
[[nodiscard]] std::string sum_of(const reflective::Recovery& recovery);
/// "71.3 ms", exactly; "no bound".
[[nodiscard]] std::string milliseconds(std::int64_t ns);

}  // namespace ocm::cli::operate
