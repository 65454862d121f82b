/// The central's line of another program of this user, which is asked 20 times a second how the robots are.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/fleet/line_end.hpp"
#include "cli/shared/local_link.hpp"

namespace ocm::cli::fleet {

class JoinedLine final : public LineEnd {
 public:
  /// `verb` is for messages.
  JoinedLine(std::string_view verb, std::unique_ptr<LocalLink> owner);

  void exchange() override;
  void scan(base::Duration time) override;
  void connect(unsigned robot) override;
  [[nodiscard]] bool idle() const override { return idle_; }
  [[nodiscard]] std::vector<std::string> take_failed() override { return std::exchange(failed_, {}); }
  [[nodiscard]] Refused go(unsigned robot, const mapper::link::SetPoint& to) override;
  [[nodiscard]] Refused calibrate(unsigned robot, bool only_ask) override;
  void pause(unsigned robot) override;
  void unpause(unsigned robot) override;
  void ping(unsigned robot) override;
  void ask_who(unsigned robot) override;
  void leave(unsigned robot) override;
  [[nodiscard]] const std::vector<mapper::server::Peer>& peers() const override { return peers_; }
  [[nodiscard]] RobotNow robot(unsigned index) const override;
  [[nodiscard]] bool is_ours(unsigned robot) const override;
  [[nodiscard]] const std::string& path() const override { return owner_->who(); }

  /// The map that the owner draws, as the text of a file of this form. Nothing: it draws none; why is in
  /// `failure`.
  [[nodiscard]] std::optional<std::string> map(std::string_view form, transport::Failure& failure);
  /// The owner has ended, or does not answer.
  [[nodiscard]] bool over() const { return owner_->over(); }

 private:
  /// Ends the command when the owner does not answer, and names who may still drive: `ordered` is one that
  /// may have its order.
  [[nodiscard]] LocalAnswer ask(std::string_view request, std::optional<unsigned> ordered = {});
  void tell(std::string_view request);
  [[nodiscard]] Refused order(unsigned robot, std::string_view request);
  void refresh(std::optional<unsigned> ordered = {});

  std::string verb_;
  std::unique_ptr<LocalLink> owner_;
  std::vector<mapper::server::Peer> peers_;
  std::map<unsigned, RobotNow> robots_;
  std::map<unsigned, std::uint64_t> orders_;  ///< the last of this program
  std::vector<std::string> failed_;
  bool idle_ = true;
};

}  // namespace ocm::cli::fleet
