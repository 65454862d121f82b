/// A simulated world in characters: the room from above, and beside it how one of its robots is. Pure: it
/// knows no terminal and no clock.
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "cli/shared/terminal.hpp"
#include "cli/top/view.hpp"
#include "sim/serve/seen.hpp"

namespace ocm::cli::simulate {

/// Where robots were.
class Trails {
 public:
  using Trail = std::deque<sim::Vector>;
  /// Of each robot; older ones are dropped. They are at least `apart_m` from each other: 40 m of way.
  /// [decided]
  static constexpr std::size_t most = 2000;
  static constexpr double apart_m = 0.02;

  /// Where they are now.
  void take(const sim::SeenWorld& world);
  void forget() { trails_.clear(); }
  /// Empty where the robot is not known.
  [[nodiscard]] const Trail& of(const std::string& robot) const;

 private:
  std::map<std::string, Trail> trails_;
};

/// What is drawn beside the world itself.
struct RoomScene {
  double speed = 1;        ///< times real time
  std::string_view bus{};  ///< where to reach it: "sim", "vcan0", a line; empty: nothing is said
  std::size_t chosen = 0;  ///< robot that is described; beyond the last: the last
  bool beams = true;
  std::string_view message{};  ///< for the last line; empty: the keys
};

/// As many lines as the terminal has, none wider than it. With `unicode` the room is drawn in Braille's dots,
/// two by four a character, else one letter of ASCII a character. From 64 columns on the robot's state is
/// beside the room, else below it; a terminal that is too small for a room has the state only.
[[nodiscard]] top::Picture draw_room(const sim::SeenWorld& world, const Trails& trails,
                                     const RoomScene& scene, TerminalSize size, bool unicode);

}  // namespace ocm::cli::simulate
