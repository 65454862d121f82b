/// A bus on which an operator runs: what commands an actuator goes through the operator, which holds it
/// within its limits; everything else goes to the bus itself.
#pragma once

#include <deque>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/client/frame_index.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/command/guarded.hpp"
#include "cli/shared/clock.hpp"
#include "cli/shared/operator_link.hpp"
#include "cli/shared/session.hpp"

namespace ocm::cli {

class OperatedBus final : public transport::Bus, public Guarded {
 public:
  /// The catalogue must outlive it. `verb` is for messages.
  OperatedBus(std::unique_ptr<transport::Bus> bus, std::unique_ptr<OperatorLink> link,
              const protocol::Catalogue& catalogue, std::string verb);

  [[nodiscard]] std::string_view name() const override { return bus_->name(); }
  base::Result<bool> send(const can::Frame& frame) override;
  base::Result<bool> send_any(const can::AnyFrame& frame) override;
  /// Without the frames that the operator has sent for this program.
  base::Result<can::Received> receive(base::Duration timeout) override;
  base::Result<transport::ReceivedAny> receive_any(base::Duration timeout) override;
  [[nodiscard]] transport::Failure fd_obstacle() const override { return bus_->fd_obstacle(); }
  transport::Outcome<void> subscribe(std::span<const can::Filter> filters) override {
    return bus_->subscribe(filters);
  }
  [[nodiscard]] int descriptor() const override { return bus_->descriptor(); }
  [[nodiscard]] const transport::BusCounters& counters() const override;
  [[nodiscard]] transport::BusState state() const override { return bus_->state(); }
  [[nodiscard]] transport::Delivery delivery() override;
  [[nodiscard]] bool is_simulated() const noexcept override { return bus_->is_simulated(); }
  [[nodiscard]] std::uint32_t bit_rate() const noexcept override { return bus_->bit_rate(); }
  [[nodiscard]] const transport::Failure& failure() const override { return bus_->failure(); }
  /// The operator has ended, or was silent: it takes nothing any more.
  [[nodiscard]] bool over() const noexcept { return link_->over(); }
  /// The bus itself, without the operator; nothing else may be done with this one then.
  [[nodiscard]] std::unique_ptr<transport::Bus> release() { return std::move(bus_); }
  [[nodiscard]] Own commands_itself(const can::Frame& frame) override;

 private:
  /// Whether the frame commands an actuator.
  [[nodiscard]] bool commands(const can::Frame& frame) const;
  [[nodiscard]] bool is_echo(const can::Frame& frame);
  void forget_old_echoes();
  /// Says what the operator holds within limits, one in a line, each once.
  void tell_limits(std::string_view lines);

  struct Echo {
    can::Frame frame;
    Clock::time_point until;
  };

  std::unique_ptr<transport::Bus> bus_;
  std::unique_ptr<OperatorLink> link_;
  client::FrameIndex index_;
  std::string verb_;
  std::set<std::string> told_limits_;
  std::deque<Echo> echoes_;      ///< frames that the bus will hand over as another program's
  transport::Failure obstacle_;  ///< why the operator took the last one not
  bool past_it_ = false;         ///< it was silent, and rest went to the bus itself
  bool refused_ = false;         ///< it has decided so
  std::uint64_t passed_on_ = 0;  ///< frames that the operator took
  mutable transport::BusCounters counters_;
};

/// The bus that the verb sends its commands to: that of `session`, or of that name; through its operator, if
/// one runs. Says so. From now on no message waits for who reads stderr: the robot would wait, too.
[[nodiscard]] std::unique_ptr<transport::Bus> open_to_command(Session& session, std::string_view verb);
[[nodiscard]] std::unique_ptr<transport::Bus> open_to_command(Session& session, std::string_view verb,
                                                              std::string_view bus);

}  // namespace ocm::cli
