/// What an operator says of itself when it is asked: what it does now, and why.
#pragma once

#include <cstdint>
#include <deque>
#include <string>

#include "ocm/base/time.hpp"
#include "ocm/reflective/supervisor.hpp"

#include "cli/operate/operator_file.hpp"
#include "cli/shared/json.hpp"

namespace ocm::cli::operate {

/// A change of the configuration, as `why` remembers it.
struct Change {
  base::Time wall{};
  std::uint16_t from = reflective::none;  ///< none: at the start
  std::uint16_t to = reflective::none;
  std::string cause;
  std::vector<std::string> conditions;  ///< that were true
};

/// What programs have commanded through it.
struct CommandCounters {
  std::uint64_t passed = 0;
  std::uint64_t limited = 0;  ///< of those
  std::uint64_t refused = 0;
  std::uint64_t beyond = 0;  ///< of those that were passed on: more often, or more urgent, than is proved
};

struct Answers {
  const OperatorFile& file;
  const reflective::Supervisor<room>& supervisor;
  const std::deque<Change>& changes;  ///< the last ones, the oldest first
  const CommandCounters& commands;
  std::uint64_t lines_lost = 0;  ///< of events

  [[nodiscard]] std::string status(base::Time now) const;
  [[nodiscard]] Json status_json(base::Time now) const;
  [[nodiscard]] std::string why() const;
  [[nodiscard]] Json why_json() const;
  /// In lines where it is, and where a request leads from there.
  [[nodiscard]] std::string ways() const;
};

}  // namespace ocm::cli::operate
