/// A program's end of a central's line: its own (own_line.hpp), or that of the program which has it
/// (joined_line.hpp). What the verbs for mappers do, they do on either in the same way.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/mapper/server/central_client.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/fleet/robot_now.hpp"

namespace ocm::cli::fleet {

/// A robot is its index on the list. What cannot go on ends the command with words.
class LineEnd {
 public:
  using Refused = std::optional<transport::Failure>;

  LineEnd() = default;
  LineEnd(const LineEnd&) = delete;
  LineEnd& operator=(const LineEnd&) = delete;
  virtual ~LineEnd() = default;

  /// Listens, speaks and answers; waits for at most 50 ms.
  virtual void exchange() = 0;

  // --- requests of the central ---

  /// Looks for robots for so long, then lists them; zero: lists those that are known.
  virtual void scan(base::Duration time) = 0;
  virtual void connect(unsigned robot) = 0;
  /// They are done.
  [[nodiscard]] virtual bool idle() const = 0;
  /// Why those since the last call failed.
  [[nodiscard]] virtual std::vector<std::string> take_failed() = 0;

  // --- words to robots ---

  /// {0, 0} stops it.
  [[nodiscard]] virtual Refused go(unsigned robot, const mapper::link::SetPoint& to) = 0;
  [[nodiscard]] virtual Refused calibrate(unsigned robot, bool only_ask) = 0;
  virtual void pause(unsigned robot) = 0;
  virtual void unpause(unsigned robot) = 0;
  virtual void ping(unsigned robot) = 0;
  virtual void ask_who(unsigned robot) = 0;
  /// It drives on when this program ends.
  virtual void leave(unsigned robot) = 0;

  // --- what is known ---

  [[nodiscard]] virtual const std::vector<mapper::server::Peer>& peers() const = 0;
  [[nodiscard]] virtual RobotNow robot(unsigned index) const = 0;
  /// The last order is this program's: no other one has stopped it or sent it since.
  [[nodiscard]] virtual bool is_ours(unsigned robot) const = 0;
  /// Whether this program answers for what the robot does, and stops it at its end.
  [[nodiscard]] virtual bool is_charge(unsigned robot) const { return is_ours(robot); }
  /// The central's line, or what has it: for messages.
  [[nodiscard]] virtual const std::string& path() const = 0;
};

/// Stops those of these robots that may drive, and waits, signal or not, until each has said that it stands.
/// A second signal ends that, and so do 20 seconds, in which any leg has ended; then the robots of which it
/// is not known are named on stderr. Whether it is known of all.
bool halt(LineEnd& line, std::string_view verb, const std::vector<unsigned>& robots,
          const std::function<bool(unsigned)>& meant);

}  // namespace ocm::cli::fleet
