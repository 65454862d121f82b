/// What an onlooker sees of a simulated world: the room, and each robot as it really is, which its
/// application does not know. Plain values: metres, x to the right, y up, radians counter-clockwise.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"

#include "firmware/boards/samples.hpp"
#include "sim/amiro/world.hpp"
#include "sim/mapper/world.hpp"
#include "sim/physics/geometry.hpp"

namespace ocm::sim {

/// Where a distance sensor looks: from its face to what is there, or to the end of its range.
struct Beam {
  Vector from{};
  Vector to{};
  bool meets = false;  ///< something is at `to`
};

struct SeenRobot {
  std::string name;
  Pose pose{};      ///< of the middle of its axle
  Vector centre{};  ///< of the disc that it fills
  double radius_m = 0;
  firmware::boards::WheelSpeeds wheels{};  ///< m/s of their rims, slip apart
  bool touching = false;                   ///< it pushes against something
  std::vector<Beam> beams{};
  std::vector<firmware::boards::Colour> lights{};
  std::optional<double> charge{};  ///< of its battery, 0..1; none: it is not simulated
};

struct SeenWorld {
  std::string name;
  base::Time time{};  ///< the simulation's
  std::vector<Segment> walls{};
  std::vector<Segment> line{};  ///< on the floor
  std::vector<SeenRobot> robots{};
};

/// O(walls) a beam, and O(the line's length).
[[nodiscard]] SeenWorld seen(const World& world, std::string_view name);
/// O(walls + robots) a beam.
[[nodiscard]] SeenWorld seen(const mapper::World& world);

}  // namespace ocm::sim
