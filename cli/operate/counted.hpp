/// Whether set points of other programs come as the proof counts them: no more often, and no more urgent.
#pragma once

#include <cstdint>
#include <map>

#include "ocm/base/time.hpp"
#include "ocm/protocol/identifier.hpp"

#include "cli/operate/operator_file.hpp"

namespace ocm::cli::operate {

class Counted {
 public:
  /// The file must outlive it.
  explicit Counted(const OperatorFile& file) : file_(&file) {}

  /// A set point that goes to the bus in a configuration; false: it is beyond what the proof counts. Two may
  /// come at once, as the jitter of a period permits. True for an actuator of which `--check` says NOT
  /// COUNTED. O(log topics).
  [[nodiscard]] bool take(std::uint16_t configuration, std::uint16_t topic, protocol::Priority priority,
                          base::Time now);

 private:
  [[nodiscard]] const reflective::Stream* find(std::uint16_t configuration, std::uint16_t topic) const;

  const OperatorFile* file_;
  std::map<std::uint16_t, base::Time> due_;  ///< the next one of each topic, if they come in their period
};

}  // namespace ocm::cli::operate
