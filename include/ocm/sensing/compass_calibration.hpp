/// Takes the robot's own magnetism out of its compass: while it turns around once, the field draws a circle,
/// and the middle of that is the robot's. [T2 §5.2, §8.1]
///
///   offset = (max + min) / 2, for each axis;  heading = atan2(y - offset_y, x - offset_x)
///
/// A minimum and a maximum for each axis; no samples are kept. A turn that was not all around, a field too
/// weak to have a direction, or a circle that is none gives no offset but an error. Readings that are not
/// finite are counted. Calibrate in several places: an offset that differs shows a disturbed one.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "ocm/base/result.hpp"
#include "ocm/motion/angle.hpp"
#include "ocm/motion/real.hpp"

namespace ocm::sensing {

/// Horizontal field in any unit, the same for all.
struct Field {
  float x = 0.0F;
  float y = 0.0F;
  friend bool operator==(const Field&, const Field&) = default;
};

/// Of the field in the robot's frame, (-pi, pi]; NaN where the field is no number or has no direction.
[[nodiscard]] inline float field_angle(Field field, Field offset) noexcept {
  const float x = field.x - offset.x;
  const float y = field.y - offset.y;
  if (!motion::all_finite(x, y) || (x == 0.0F && y == 0.0F)) return std::numeric_limits<float>::quiet_NaN();
  return motion::wrap(std::atan2(y, x));
}

class CompassCalibration {
 public:
  /// `turned_rad` is how far the robot turned since the last reading, by its wheels or its gyro. False if the
  /// reading was rejected.
  constexpr bool add(Field field, float turned_rad) noexcept {
    if (!motion::all_finite(field.x, field.y, turned_rad)) {
      ++rejected_;
      return false;
    }
    if (count_ == 0) {
      least_ = field;
      most_ = field;
    } else {
      turned_rad_ += turned_rad;
    }
    ++count_;
    least_ = {field.x < least_.x ? field.x : least_.x, field.y < least_.y ? field.y : least_.y};
    most_ = {field.x > most_.x ? field.x : most_.x, field.y > most_.y ? field.y : most_.y};
    return true;
  }

  /// Around once, within the 5 degrees that wheels may be off.
  [[nodiscard]] constexpr bool complete() const noexcept {
    return motion::magnitude(turned_rad_) >= motion::two_pi - motion::radians(5.0F);
  }

  /// Not around yet: Error::not_sampled. A span of an axis below `least_span`, or spans that differ by more
  /// than a third, so that it was no circle: Error::out_of_range.
  [[nodiscard]] constexpr base::Result<Field> offset(float least_span) const noexcept {
    if (!complete()) return base::Error::not_sampled;
    const float x = most_.x - least_.x;
    const float y = most_.y - least_.y;
    const float small = x < y ? x : y;
    const float large = x < y ? y : x;
    if (!(small > 0.0F) || small < least_span || large > small * 4.0F / 3.0F)
      return base::Error::out_of_range;
    return Field{least_.x + x / 2.0F, least_.y + y / 2.0F};
  }
  [[nodiscard]] constexpr std::uint32_t count() const noexcept { return count_; }
  [[nodiscard]] constexpr std::uint32_t rejected() const noexcept { return rejected_; }

 private:
  Field least_{};
  Field most_{};
  float turned_rad_ = 0.0F;
  std::uint32_t count_ = 0;
  std::uint32_t rejected_ = 0;
};

}  // namespace ocm::sensing
