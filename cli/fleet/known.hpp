/// What is known of a room before robots draw it: from a world's file, and from what was typed.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/cognitive/agreement.hpp"
#include "ocm/motion/pose.hpp"

namespace ocm::cli::fleet {

/// Where a robot was switched on.
struct Start {
  std::string name;
  motion::Pose pose;
};

/// `verb` is for messages. NAME=X,Y,DEG: metres and degrees. Leaves through cli::fail when it is nothing of
/// that kind.
[[nodiscard]] Start parse_start(std::string_view verb, const std::string& text);

/// What a world says of its walls, its central and where robots begin.
struct Known {
  std::vector<cognitive::Wall> walls;
  std::vector<motion::Point> inside;
  std::vector<Start> starts;
  std::optional<motion::Point> central;
  double range_m = 0;
};

/// Of the world of that file or name (empty: none), and of what was typed, which goes before it.
[[nodiscard]] Known known_of(std::string_view verb, const std::string& world,
                             const std::vector<std::string>& starts);

}  // namespace ocm::cli::fleet
