/// Robots behind a central as a log of its line has them, at any moment of it: who was there, where, and the
/// map that they drew.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/cognitive/drawing.hpp"
#include "ocm/cognitive/fleet.hpp"
#include "ocm/mapper/server/central_client.hpp"
#include "ocm/mapper/server/central_stream.hpp"

#include "cli/bus_model/playing.hpp"
#include "cli/fleet/known.hpp"
#include "cli/fleet/line_log.hpp"
#include "cli/fleet/robot_now.hpp"

namespace ocm::cli::fleet {

class LineReplay {
 public:
  /// `known`: where robots began. A robot alone began at 0, 0. A log without a piece is `ReadLineLog{}`, of
  /// which nothing is known at any moment.
  LineReplay(ReadLineLog log, Known known);

  /// The clock has gone on by so much.
  void play(base::Duration time);
  /// To this distance from the beginning. Backwards all is read again from there.
  void go_to(base::Duration at);
  void faster(double factor) noexcept { playing_.faster(factor); }

  [[nodiscard]] const bus_model::Playing& playing() const noexcept { return playing_; }
  /// By the clock of the log.
  [[nodiscard]] base::Time now() const noexcept { return first_ + playing_.at; }
  /// In the order of their indexes; those whose place is known have it in the map.
  [[nodiscard]] std::vector<RobotNow> robots() const;
  [[nodiscard]] const cognitive::Drawing& drawing() const noexcept { return state_.drawing; }

 private:
  /// A robot that says its handshake again was asked who it is, or has begun again at 0, 0: what it says next
  /// of its place shows which.
  struct Before {
    motion::Pose origin;
    mapper::link::Update update;
  };
  /// A robot that stands says so each second. When it did last, and where it was.
  struct Stood {
    base::Time at{};
    std::optional<mapper::link::Update> where{};
  };
  /// What is known at a moment.
  struct State {
    mapper::server::CentralStream stream{};
    mapper::link::PrefixFilter names{};
    std::string prefix{};
    cognitive::Fleet fleet{};
    cognitive::Drawing drawing{};
    std::map<unsigned, mapper::server::Peer> peers;
    std::map<unsigned, Before> before;
    std::map<unsigned, Stood> stood;
    std::map<unsigned, bool> placed;  ///< its place in the world is known
  };

  void begin_again();
  void expire(base::Time time);
  void take(const Said& said);
  void take_line(const mapper::server::CentralLine& line, base::Time now);
  void take_byte(char c, base::Time now);
  void draw(unsigned index);
  mapper::server::Peer& peer(unsigned index, std::string_view name);
  [[nodiscard]] RobotNow robot(const mapper::server::Peer& peer) const;
  [[nodiscard]] bool moves(const RobotNow& robot) const;

  ReadLineLog log_;
  Known known_;
  bool alone_ = false;  ///< in all of the log
  std::size_t next_ = 0;
  base::Time first_{};
  State state_;
  bus_model::Playing playing_;
};

}  // namespace ocm::cli::fleet
