/// The central's serial line, a server behind it, and the other programs that have joined it.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/cognitive/server.hpp"
#include "ocm/mapper/server/dialect.hpp"
#include "ocm/transport/serial_port.hpp"

#include "cli/fleet/dongle.hpp"
#include "cli/fleet/line_end.hpp"
#include "cli/fleet/line_log_file.hpp"
#include "cli/fleet/owner.hpp"
#include "cli/shared/unhurried_messages.hpp"

namespace ocm::cli::fleet {

class OwnLine final : public LineEnd {
 public:
  /// `verb` is for messages. Without a `service` no other program joins.
  OwnLine(std::string_view verb, Dongle dongle, const cognitive::FleetOptions& fleet,
          std::unique_ptr<LocalServer> service);
  /// First it serves the programs that have joined until they have ended, unless a signal has come; then
  /// their robots are stopped. Leaves the central in command mode. What it was given to call is called no
  /// more.
  ~OwnLine() override;

  /// It is called with everything that the robots say.
  void on_heard(std::function<void(std::size_t robot, mapper::link::Kind kind)> heard) {
    heard_ = std::move(heard);
  }
  /// What comes from now on is written there, too.
  void record(std::unique_ptr<LineLog> log) { log_ = std::move(log); }
  /// Nothing was to be recorded, or all of it is.
  [[nodiscard]] bool is_recorded() const noexcept { return log_ == nullptr || log_->is_whole(); }
  /// Until the programs that have joined have ended, or a signal has come: then their robots are stopped.
  void finish();

  void exchange() override;
  void scan(base::Duration time) override { (void)server_.client().scan(time); }
  void connect(unsigned robot) override { (void)server_.client().connect(robot); }
  [[nodiscard]] bool idle() const override { return server_.client().idle(); }
  [[nodiscard]] std::vector<std::string> take_failed() override { return std::exchange(failed_, {}); }
  [[nodiscard]] Refused go(unsigned robot, const mapper::link::SetPoint& to) override;
  [[nodiscard]] Refused calibrate(unsigned robot, bool only_ask) override;
  void pause(unsigned robot) override;
  void unpause(unsigned robot) override;
  void ping(unsigned robot) override { (void)server_.fleet().ping(robot); }
  void ask_who(unsigned robot) override;
  void leave(unsigned robot) override { owner_.leave(robot); }
  [[nodiscard]] const std::vector<mapper::server::Peer>& peers() const override {
    return server_.client().peers();
  }
  [[nodiscard]] RobotNow robot(unsigned index) const override { return owner_.robot(index); }
  [[nodiscard]] bool is_ours(unsigned robot) const override;
  /// A map's robots have no order.
  [[nodiscard]] bool is_charge(unsigned robot) const override { return !owner_.driven_by_other(robot); }
  [[nodiscard]] const std::string& path() const override { return port_.path(); }

  [[nodiscard]] cognitive::Server& server() noexcept { return server_; }
  [[nodiscard]] const cognitive::Server& server() const noexcept { return server_; }
  [[nodiscard]] Owner& owner() noexcept { return owner_; }
  [[nodiscard]] const Owner& owner() const noexcept { return owner_; }

 private:
  void write();
  /// What the dongle has said, as much as is read between two looks at the other programs.
  void hear();
  /// The socket, if it was removed.
  void renew_service();
  /// Until everything that was requested is sent, signal or not.
  void flush(base::Duration limit);

  UnhurriedMessages messages_;  // first: while a line is served no message holds it up
  std::string verb_;
  mapper::server::Translator dongle_;
  cognitive::Server server_;
  Owner owner_;
  transport::SerialPort port_;  // closed before the others, who wait, may open it
  std::function<void(std::size_t, mapper::link::Kind)> heard_;
  std::unique_ptr<LineLog> log_;
  std::string unsent_;
  std::vector<std::string> failed_;
  std::vector<std::uint64_t> orders_;  ///< of this program, a robot
  base::Time next_renewal_{};
  bool is_unreachable_ = false;  ///< for other programs, which was reported
};

}  // namespace ocm::cli::fleet
