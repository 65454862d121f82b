/// Repeats a pause, or its end, until the robot shows that it obeys: a paused robot sends no updates.
#pragma once

#include <cstdint>

#include "cli/fleet/line_end.hpp"

namespace ocm::cli::fleet {

/// One robot; to be asked often.
class Pausing {
 public:
  enum class Seen : std::uint8_t { not_yet, obeys, lost, never };
  /// `paused`: it is to pause, else to go on.
  Pausing(const RobotNow& robot, bool paused, base::Time now);

  /// Says it when it is time to; what the robot shows. `never` after ten seconds.
  [[nodiscard]] Seen step(LineEnd& line, base::Time now);

 private:
  unsigned index_;
  bool paused_;
  base::Time begin_;
  base::Time say_at_{};
  base::Time quiet_since_;
  base::Time updated_;
  base::Time heard_;
  std::uint32_t pieces_;
  int words_ = 0;
};

}  // namespace ocm::cli::fleet
