/// Floats that are as good as equal. NaN is near nothing.
#pragma once

#include "ocm/motion/angle.hpp"
#include "ocm/motion/pose.hpp"

namespace ocm::test {

constexpr bool near(float a, float b, float most = 1e-5F) {
  return a - b <= most && b - a <= most;
}

/// As directions.
constexpr bool near_angle(float a, float b, float most = 1e-5F) {
  return near(motion::difference(a, b), 0.0F, most);
}

constexpr bool near(const motion::Pose& a, const motion::Pose& b, float most_m, float most_rad) {
  return near(a.x_m, b.x_m, most_m) && near(a.y_m, b.y_m, most_m) &&
         near_angle(a.heading_rad, b.heading_rad, most_rad);
}

}  // namespace ocm::test
