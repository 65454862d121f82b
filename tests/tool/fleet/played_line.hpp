/// A central's line of these tests: robots are as the test puts them, and what a program says to them is
/// written down.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "cli/fleet/line_end.hpp"

namespace ocm::test {

class PlayedLine final : public cli::fleet::LineEnd {
 public:
  std::map<unsigned, cli::fleet::RobotNow> robots;
  std::string told;                    ///< since the test last looked
  std::function<void()> next;          ///< what happens while it exchanges
  bool refuses = false;                ///< orders, for another program drives
  std::map<unsigned, bool> of_others;  ///< robots that another program has sent since

  cli::fleet::RobotNow& add(unsigned index, const std::string& name) {
    auto& robot = robots[index];
    robot.index = index;
    robot.name = name;
    peers_.push_back({index, fmt::format("C0000000000{}", index), name, true});
    return robot;
  }
  std::string take_told() { return std::exchange(told, {}); }

  void exchange() override {
    if (next) next();
  }
  void scan(base::Duration) override {}
  void connect(unsigned robot) override { tell("connect", robot); }
  bool idle() const override { return true; }
  std::vector<std::string> take_failed() override { return {}; }
  Refused go(unsigned robot, const mapper::link::SetPoint& to) override {
    told += fmt::format("go {} {} {}\n", robot, to.angle, to.distance);
    if (refuses) return transport::Failure{"it is driven", "wait"};
    return std::nullopt;
  }
  Refused calibrate(unsigned robot, bool) override {
    tell("calibrate", robot);
    return std::nullopt;
  }
  void pause(unsigned robot) override { tell("pause", robot); }
  void unpause(unsigned robot) override { tell("unpause", robot); }
  void ping(unsigned robot) override { tell("ping", robot); }
  void ask_who(unsigned robot) override { tell("who", robot); }
  void leave(unsigned robot) override { tell("leave", robot); }
  const std::vector<mapper::server::Peer>& peers() const override { return peers_; }
  cli::fleet::RobotNow robot(unsigned index) const override { return robots.at(index); }
  bool is_ours(unsigned robot) const override {
    const auto at = of_others.find(robot);
    return at == of_others.end() || !at->second;
  }
  const std::string& path() const override { return path_; }

 private:
  void tell(const char* what, unsigned robot) { told += fmt::format("{} {}\n", what, robot); }

  std::vector<mapper::server::Peer> peers_;
  std::string path_ = "line";
};

}  // namespace ocm::test
