/// The one program that has a central's line serves it to others of the same user: robots, goto, pause, map
/// and a page work at the same time, and all that is said to a robot goes through one sender, so that
/// repetition stays right. [docs/decisions/0033]
///
/// - The last order counts, and each has a number: who sent a robot sees that another program has stopped it.
/// - A stop is always taken. A robot that one program drives is not sent by another.
/// - A robot is stopped when the program that drives it ends, dies, or says nothing for `lease`.
/// - A robot that was ordered about by hand is held until `unpause`: the owner's explorer leaves it alone.
///
/// Time is handed in; waits for nothing. What a caller sends, or does not read, holds up nothing.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/cognitive/server.hpp"

#include "cli/fleet/line_request.hpp"
#include "cli/fleet/robot_now.hpp"
#include "cli/shared/local_server.hpp"

namespace ocm::cli::fleet {

/// A program that has joined.
struct LineCaller : LocalCaller {
  base::Time asked{};               ///< last
  bool waits = false;               ///< for its scan, or its links
  bool views = false;               ///< a map: it ends with the owner
  std::vector<std::string> failed;  ///< what did not succeed of that
  std::string document;             ///< a map as it was when it asked
};

class Owner {
 public:
  /// A caller that drives a robot asks how it is some 20 times a second.
  static constexpr base::Duration lease = std::chrono::seconds{2};

  /// A map as the text of a file of this form: svg, png, pdf (for gnuplot), pgm or yaml; empty: there is
  /// none yet.
  using Draw = std::function<std::string(std::string_view form)>;

  /// `verb` is this program's. `server` must outlive it. Without a `service` no other program joins.
  Owner(std::string verb, cognitive::Server& server, std::unique_ptr<LocalServer> service);

  /// Answers what callers have asked, and stops what they have left. Each 50 ms.
  void serve(base::Time now);
  /// Each second: whether the socket was removed, and is there again. A failure: it cannot be, or its path is
  /// another program's by now; the next call tries again. One system call where all is as it was.
  [[nodiscard]] transport::Outcome<bool> renew() {
    if (!service_ || service_->is_found()) return false;
    if (auto back = service_->return_to_path(); !back) return std::move(back.error);
    return true;
  }
  /// No more programs join: they are asked to wait for the line.
  void close() { closing_ = true; }
  void on_draw(Draw draw) { draw_ = std::move(draw); }
  /// From now on there is no map for those who ask, and what drew it is asked no more.
  void end_drawing() {
    if (draw_) draw_ = [](std::string_view) { return std::string{}; };
  }
  /// This program sends robots by itself, so that it matters which ones are held.
  void explores() { explores_ = true; }
  /// A request of the central has failed; all who wait for one hear of it.
  void failed(const std::string& words);

  // --- this program's own orders, refused as those of others are ---

  [[nodiscard]] std::optional<transport::Failure> go(unsigned index, const mapper::link::SetPoint& to,
                                                     base::Time now) {
    return order(nullptr, index, to, now);
  }
  [[nodiscard]] std::optional<transport::Failure> calibrate(unsigned index, bool only_ask, base::Time now) {
    return calibrate(nullptr, index, only_ask, now);
  }
  /// It may drive on without the program that has sent it.
  void leave(unsigned index) { leave(nullptr, index); }

  // --- what is known ---

  [[nodiscard]] RobotNow robot(unsigned index) const;
  /// That are not over, of other programs.
  [[nodiscard]] std::vector<unsigned> driven_by_others() const;
  [[nodiscard]] bool driven_by_other(unsigned index) const;
  /// Programs that have joined, and would fail if the line was gone; views of a map would not.
  [[nodiscard]] std::vector<std::string> at_work(base::Time now) const;
  [[nodiscard]] bool held(unsigned index) const { return !holder(index).empty(); }
  /// "pause (process 1234)"; empty: it is not held.
  [[nodiscard]] std::string_view holder(unsigned index) const {
    return index < holders_.size() ? std::string_view{holders_[index]} : std::string_view{};
  }
  /// Programs that have joined since the beginning, and those that were disconnected.
  [[nodiscard]] std::uint64_t joined() const noexcept { return joined_; }
  [[nodiscard]] std::uint64_t turned_away() const { return service_ ? service_->turned_away() : 0; }
  /// A file descriptor that is readable when there is something to answer; -1: none.
  [[nodiscard]] int descriptor() const { return service_ ? service_->descriptor() : -1; }

 private:
  /// Of a robot.
  struct Order {
    std::uint64_t number = 0;
    std::string by;
    const LineCaller* caller = nullptr;  ///< who drives it, if it is another program
    bool own = false;                    ///< or this one
  };

  std::string answer(LineCaller& caller, std::string_view text);
  std::string answer(LineCaller& caller, const LineRequest& request);
  [[nodiscard]] std::string rows(LineCaller& caller, const LineRequest& request);
  [[nodiscard]] std::string page(const LineCaller& caller, std::uint64_t offset) const;
  [[nodiscard]] std::string ordered(const std::optional<transport::Failure>& failure, unsigned index) const;
  void gone(const LineCaller& caller);
  void stop_left(const std::string& why, unsigned index);
  void leave(const LineCaller* caller, unsigned index);
  [[nodiscard]] bool is_busy(unsigned index) const;
  /// Why this program may not send the robot now.
  [[nodiscard]] std::optional<transport::Failure> taken(const LineCaller* caller, unsigned index) const;
  [[nodiscard]] std::optional<transport::Failure> order(const LineCaller* caller, unsigned index,
                                                        const mapper::link::SetPoint& to, base::Time now);
  [[nodiscard]] std::optional<transport::Failure> calibrate(const LineCaller* caller, unsigned index,
                                                            bool only_ask, base::Time now);
  void note(const LineCaller* caller, unsigned index);

  std::string self_;
  std::string verb_;
  cognitive::Server* server_;
  std::unique_ptr<LocalServer> service_;
  std::array<Order, cognitive::Fleet::most_robots> orders_{};
  std::array<std::string, cognitive::Fleet::most_robots> holders_{};
  std::uint64_t number_ = 0;
  std::uint64_t joined_ = 0;
  base::Time now_{};
  Draw draw_;
  bool closing_ = false;
  bool explores_ = false;
};

}  // namespace ocm::cli::fleet
