/// What viewers have asked of robots behind a central, carried out on its line: a robot that drives is
/// stopped first and sent from where it stands, a way that is longer than one set point in pieces; a pause is
/// said until it shows. One order a robot at a time, the newest. What becomes of it is said to the viewer
/// that asked; where that viewer goes away, the robot is stopped.
///
/// Time is handed in. For the thread that has the line.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/motion/pose.hpp"

#include "cli/fleet/line_end.hpp"
#include "cli/fleet/pausing.hpp"
#include "cli/serve/fleet_order.hpp"
#include "cli/serve/foxglove.hpp"
#include "cli/serve/viewers.hpp"

namespace ocm::cli::serve {

class Errands {
 public:
  /// For a viewer: how it ended.
  using Tell = std::function<void(ViewerId viewer, foxglove::Level level, const std::string& words)>;
  /// A robot, placed in the map as far as that is known.
  using Look = std::function<fleet::RobotNow(unsigned index)>;

  Errands(Tell tell, Look look) : tell_(std::move(tell)), look_(std::move(look)) {}

  /// `owner_explores`: a robot that drives and is not held drives by itself, and may be taken. All orders but
  /// `look`, which is no robot's.
  void take(fleet::LineEnd& line, ViewerId viewer, const FleetOrder& order, bool owner_explores,
            base::Time now);
  /// Does what is due; each 50 ms.
  void step(fleet::LineEnd& line, base::Time now);
  /// Robots that the viewer has sent are stopped.
  void gone(fleet::LineEnd& line, ViewerId viewer);
  /// Viewers for whom robots drive, or are about to.
  [[nodiscard]] std::vector<ViewerId> driving(const fleet::LineEnd& line) const;
  /// The line is gone, and what was asked of it, too.
  void forget() {
    errands_.clear();
    senders_.clear();
  }

  /// Where a robot is sent; none: nowhere.
  [[nodiscard]] std::optional<motion::Point> target(unsigned robot) const;
  [[nodiscard]] bool busy() const noexcept { return !errands_.empty(); }

 private:
  enum class Phase : std::uint8_t { stopping, sent, between };
  struct Errand {
    ViewerId viewer = 0;
    std::optional<motion::Point> target{};  ///< none: a pause, or its end
    std::optional<fleet::Pausing> pausing{};
    bool pauses = false;
    Phase phase = Phase::stopping;
    base::Time since{};  ///< of its phase, where that has an end: not of `sent`
    unsigned pieces = 0;
  };

  [[nodiscard]] std::optional<unsigned> find(const fleet::LineEnd& line, ViewerId viewer,
                                             const std::string& name) const;
  void go(fleet::LineEnd& line, const fleet::RobotNow& robot, Errand errand, bool owner_explores);
  /// True: it is over.
  [[nodiscard]] bool drive(fleet::LineEnd& line, Errand& errand, const fleet::RobotNow& robot,
                           base::Time now);
  [[nodiscard]] bool send(fleet::LineEnd& line, Errand& errand, const fleet::RobotNow& robot);
  [[nodiscard]] bool pause(fleet::LineEnd& line, Errand& errand, const fleet::RobotNow& robot,
                           base::Time now);
  bool end(const Errand& errand, foxglove::Level level, const std::string& words) const;

  Tell tell_;
  Look look_;
  std::map<unsigned, Errand> errands_;
  std::map<unsigned, ViewerId> senders_;  ///< who has sent a robot last
};

}  // namespace ocm::cli::serve
