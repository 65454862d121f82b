/// Watches how good a robot's link is, and calls the robot back when it gets bad: it is stopped, at once and
/// in the middle of a leg, and sent back towards where it began to drive, until its link is well again. A map
/// does the same with its robots.
///
/// One robot; to be asked often. What is bad, and well again, says cognitive::Fleet.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "cli/fleet/line_end.hpp"

namespace ocm::cli::fleet {

class LinkWatch {
 public:
  enum class Phase : std::uint8_t {
    well,
    bad,        ///< and it is not called back, or was at rest
    stopping,   ///< it is called back
    returning,  ///< it is on its way
    settling,   ///< its link is well again: it is stopped there
    back,       ///< it was called back, and stands
    failed,     ///< it is lost, or another program has sent it since
  };

  /// `call_back`: it is, if it drives. True: the link has just become bad.
  bool step(LineEnd& line, const RobotNow& robot, bool call_back);
  [[nodiscard]] Phase phase() const noexcept { return phase_; }
  /// It is being called back, or was.
  [[nodiscard]] bool called() const noexcept { return phase_ > Phase::bad; }
  /// Nothing more comes of that.
  [[nodiscard]] bool over() const noexcept { return phase_ == Phase::back || phase_ == Phase::failed; }

 private:
  void call(LineEnd& line, const RobotNow& robot);
  void send_back(LineEnd& line, const RobotNow& robot);

  Phase phase_ = Phase::well;
  std::optional<mapper::link::Update> home_;  ///< where it stood last, with a link that was well
};

/// "the link to AVR is bad: 62 % of its sentences come whole", or that it is far away.
[[nodiscard]] std::string words_of_link(const RobotNow& robot);
/// Remarks on it, where it is bad.
void warn_of_link(std::string_view verb, const RobotNow& robot);

}  // namespace ocm::cli::fleet
