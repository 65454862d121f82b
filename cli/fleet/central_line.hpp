/// The central's line as the verbs for mappers use it, in real time: their own, or that of another program of
/// the same user, which they join. Links stay up when a verb ends.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"

#include "cli/fleet/dongle.hpp"
#include "cli/fleet/joined_line.hpp"
#include "cli/fleet/line_end.hpp"
#include "cli/fleet/own_line.hpp"
#include "cli/shared/arguments.hpp"

namespace ocm::cli::fleet {

struct LineOptions {
  std::string path;  ///< empty: that of a simulation or of `amiroctl central --pty`
  DongleOptions dongle{};
  std::optional<base::Duration> scan;
  std::string record{};  ///< a file for what the central says; empty: none. Where this program has the line
};

/// --central, --baud, --flow, --dongle and --scan.
void add_line_options(Verb verb, LineOptions& options);

/// --record, of verbs that have the line for long.
Option add_record_option(Verb verb, LineOptions& options);

/// What a verb needs of the line.
enum class Need : std::uint8_t {
  any,  ///< its own, or one to join
  own,  ///< its own; where another program has the line the verb is refused
};

/// The line of another program of this user; null where none has it. Ends the command where one has it and
/// does not answer.
[[nodiscard]] std::unique_ptr<JoinedLine> join_line(std::string_view verb, const LineOptions& options);

/// Ends the command with words that say what is wrong and what to do, wherever it cannot go on.
class CentralLine {
 public:
  /// `verb` is for messages.
  CentralLine(std::string_view verb, const LineOptions& options, Need need = Need::any,
              const cognitive::FleetOptions& fleet = {});

  /// Listens and speaks until `done`, or for `limit`, or until a signal comes. Whether it was done.
  bool run(std::optional<base::Duration> limit, const std::function<bool()>& done);
  /// As `run`; a signal ends the command.
  bool wait(base::Duration limit, const std::function<bool()>& done);
  /// Stops those of these robots that may drive because of what this program has said (line_end.hpp).
  bool halt(const std::vector<unsigned>& robots);

  /// All robots that the central finds: those that it has listed, and those that advertise.
  const std::vector<mapper::server::Peer>& scan();
  /// Links to the robots that are meant, by name, address or index; `all` or nothing: to all that there are.
  /// One that is not there ends the command; one of several that cannot be reached is reported.
  std::vector<unsigned> connect(const std::vector<std::string>& names);
  /// Of those: how many could not be reached.
  [[nodiscard]] std::size_t unreached() const noexcept { return unreached_; }
  /// Asks those of these robots that were connected before, by another program, for their handshakes, and
  /// waits for a moment. A robot that does not know the question stays without one.
  void introduce(const std::vector<unsigned>& robots);
  /// A link to one robot, confirmed and heard.
  unsigned connect_one(const std::string& name);
  /// Ends the command: the central finds none of this name. Lists those that it finds.
  [[noreturn]] void unknown(const std::string& name) const;

  [[nodiscard]] LineEnd& end() noexcept { return *end_; }
  [[nodiscard]] RobotNow robot(unsigned index) const { return end_->robot(index); }
  /// Null: it is another program's.
  [[nodiscard]] OwnLine* own() noexcept { return dynamic_cast<OwnLine*>(end_.get()); }
  [[nodiscard]] const OwnLine* own() const noexcept { return dynamic_cast<const OwnLine*>(end_.get()); }
  /// Null: it is this program's.
  [[nodiscard]] JoinedLine* joined() noexcept { return dynamic_cast<JoinedLine*>(end_.get()); }
  [[nodiscard]] std::string name(unsigned index) const { return end_->robot(index).name; }
  [[nodiscard]] static base::Time now();

 private:
  void list(base::Duration scan);
  [[nodiscard]] std::optional<unsigned> find(const std::string& name) const;

  std::string verb_;
  std::optional<base::Duration> scan_;
  std::size_t unreached_ = 0;
  std::unique_ptr<LineEnd> end_;
};

}  // namespace ocm::cli::fleet
