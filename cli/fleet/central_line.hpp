/// The central's serial line, a server behind it, and real time: what the verbs for mappers have in
/// common. One program at a time has the line; links stay up when it ends.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/cognitive/server.hpp"
#include "ocm/mapper/server/dialect.hpp"
#include "ocm/transport/serial_port.hpp"

#include "cli/fleet/dongle.hpp"
#include "cli/shared/arguments.hpp"

namespace ocm::cli::fleet {

struct LineOptions {
  std::string path;  ///< empty: that of a simulation or of `amiroctl central --pty`
  DongleOptions dongle{};
  base::Duration scan = std::chrono::seconds{3};
};

/// --central, --baud, --flow, --dongle and --scan.
void add_line_options(Verb verb, LineOptions& options);

/// Ends the command with words that say what is wrong and what to do, wherever it cannot go on.
class CentralLine {
 public:
  /// `verb` is for messages.
  CentralLine(std::string_view verb, const LineOptions& options, const cognitive::FleetOptions& fleet = {})
      : CentralLine(verb, options, fleet, open_line(verb, options)) {}
  CentralLine(const CentralLine&) = delete;
  CentralLine& operator=(const CentralLine&) = delete;
  /// Leaves the central in command mode.
  ~CentralLine();

  /// It is called with everything that the robots say.
  void on_heard(std::function<void(std::size_t robot, mapper::link::Kind kind)> heard) {
    heard_ = std::move(heard);
  }

  /// Listens and speaks until `done`, or for `limit`, or until a signal comes. Whether it was done.
  bool run(std::optional<base::Duration> limit, const std::function<bool()>& done);
  /// As `run`; a signal ends the command.
  bool wait(base::Duration limit, const std::function<bool()>& done);
  /// Stops those of these robots that may drive because of what this program has said, and waits, signal or
  /// not, until each has said that it stands. A second signal ends that, and so do 20 seconds, in which any
  /// leg has ended; then the robots of which it is not known are named on stderr. Whether it is known of all.
  bool halt(const std::vector<unsigned>& robots);
  /// Until everything that was requested is sent, signal or not.
  void flush(base::Duration limit);

  /// All robots that the central finds: those that it has listed, and those that advertise.
  const std::vector<mapper::server::Peer>& scan();
  /// Links to the robots that are meant, by name, address or index; `all` or nothing: to all that there are.
  /// One that is not there ends the command; one of several that cannot be reached is reported.
  std::vector<unsigned> connect(const std::vector<std::string>& names);
  /// Asks those of these robots that were connected before, by another program, for their handshakes, and
  /// waits for a moment. A robot that does not know the question stays without one.
  void introduce(const std::vector<unsigned>& robots);
  /// A link to one robot, confirmed and heard.
  unsigned connect_one(const std::string& name);
  /// Ends the command: the central finds none of this name. Lists those that it finds.
  [[noreturn]] void unknown(const std::string& name) const;

  [[nodiscard]] cognitive::Server& server() noexcept { return server_; }
  [[nodiscard]] const cognitive::Fleet& fleet() const noexcept { return server_.fleet(); }
  [[nodiscard]] std::string name(unsigned index) const;
  [[nodiscard]] static base::Time now();
  [[nodiscard]] const std::string& path() const noexcept { return port_.path(); }

 private:
  CentralLine(std::string_view verb, const LineOptions& options, const cognitive::FleetOptions& fleet,
              Dongle dongle);
  [[nodiscard]] static Dongle open_line(std::string_view verb, const LineOptions& options);
  /// What the central has not taken yet goes first.
  void exchange();
  void write();
  void take_events();
  void list(base::Duration scan);
  [[nodiscard]] std::optional<unsigned> find(const std::string& name) const;

  std::string verb_;
  base::Duration scan_{};
  transport::SerialPort port_;
  mapper::server::Translator dongle_;
  cognitive::Server server_;
  std::function<void(std::size_t, mapper::link::Kind)> heard_;
  std::string unsent_;
  std::vector<mapper::server::CentralEvent> failed_;
};

}  // namespace ocm::cli::fleet
