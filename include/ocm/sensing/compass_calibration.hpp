/// Takes the robot's own magnetism out of its compass: while it turns around once, the field draws a circle,
/// and the middle of that is the robot's. [T2 §5.2, §8.1]
///
///   offset = (max + min) / 2, for each axis;  heading = atan2(y - offset_y, x - offset_x)
///
/// How good that is shows in the circle: `CompassFit::error_rad` is how far its worst part lies inside or
/// outside of it, as an angle. A field that is stretched, or changes while the robot turns, turns the compass
/// by so much. The circle is looked at in 16 parts, each the mean of its readings, so that noise counts for
/// little; no samples are kept. 220 bytes, no heap. Readings that are not finite are counted. Steel beside
/// the robot that turns the whole field shows nothing: calibrate in several places, an offset that differs
/// shows a disturbed one.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
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

/// What a turn around found.
struct CompassFit {
  Field offset{};          ///< the robot's own field
  float field = 0.0F;      ///< of the earth: the circle's radius
  float error_rad = 0.0F;  ///< what the compass is wrong by, at most: how far the circle is from one
  friend bool operator==(const CompassFit&, const CompassFit&) = default;
};

class CompassCalibration {
 public:
  /// Parts of the turn.
  static constexpr std::size_t parts = 16;

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
    Part& part = parts_[part_of(turned_rad_)];
    if (part.count == UINT16_MAX) return true;  // its mean is known well enough
    part.sum = {part.sum.x + field.x, part.sum.y + field.y};
    ++part.count;
    return true;
  }

  /// Around once, within the 5 degrees that wheels may be off.
  [[nodiscard]] constexpr bool complete() const noexcept {
    return motion::magnitude(turned_rad_) >= motion::two_pi - motion::radians(5.0F);
  }

  /// Error::not_sampled: not around yet. Error::no_answer: there was no reading in a part of the turn.
  /// Error::out_of_range: no circle at all.
  [[nodiscard]] base::Result<CompassFit> fit() const noexcept {
    if (!complete()) return base::Error::not_sampled;
    CompassFit found;
    found.offset = {least_.x + (most_.x - least_.x) / 2.0F, least_.y + (most_.y - least_.y) / 2.0F};
    std::array<float, parts> radius{};
    for (std::size_t i = 0; i < parts; ++i) {
      if (parts_[i].count == 0) return base::Error::no_answer;
      const auto count = static_cast<float>(parts_[i].count);
      const float x = parts_[i].sum.x / count - found.offset.x;
      const float y = parts_[i].sum.y / count - found.offset.y;
      radius[i] = std::sqrt(x * x + y * y);
      found.field += radius[i] / static_cast<float>(parts);
    }
    for (const float each : radius) {
      const float off_rad = motion::magnitude(each - found.field) / found.field;
      if (!(off_rad <= found.error_rad)) found.error_rad = off_rad;
    }
    if (!motion::all_finite(found.offset.x, found.offset.y, found.error_rad))
      return base::Error::out_of_range;
    return found;
  }
  [[nodiscard]] constexpr std::uint32_t count() const noexcept { return count_; }
  [[nodiscard]] constexpr std::uint32_t rejected() const noexcept { return rejected_; }

 private:
  struct Part {
    Field sum{};
    std::uint16_t count = 0;
  };
  /// What is beyond a whole turn belongs to the last part.
  [[nodiscard]] static constexpr std::size_t part_of(float turned_rad) noexcept {
    const float part = motion::magnitude(turned_rad) / motion::two_pi * static_cast<float>(parts);
    return part < static_cast<float>(parts - 1) ? static_cast<std::size_t>(part) : parts - 1;
  }

  std::array<Part, parts> parts_{};
  Field least_{};
  Field most_{};
  float turned_rad_ = 0.0F;
  std::uint32_t count_ = 0;
  std::uint32_t rejected_ = 0;
};

}  // namespace ocm::sensing
