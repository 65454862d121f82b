/// Where a mapper has been, so that it finds home without a link: the places between which it drove
/// straight, the newest first when it goes back. [T2 §17.1, back-tracking]
///
/// `N` places of 8 bytes. A place that lies between its neighbours is not kept, so that many short drives
/// along one line take one place. When there is no room the oldest is forgotten and counted: the way back
/// then ends there, on ground that the robot knows. O(N) where that happens, else O(1). No heap.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "ocm/base/fixed_vector.hpp"
#include "ocm/base/result.hpp"
#include "ocm/motion/angle.hpp"
#include "ocm/motion/pose.hpp"
#include "ocm/motion/pose_controller.hpp"

namespace ocm::mapper::app {

template <std::size_t N>
requires(N >= 2) class History {
 public:
  /// Nearer than this is the same place, or the same line. [decided: what the encoders resolve, a few times]
  static constexpr float same_m = 0.02F;

  /// The robot leaves this place. One that is not finite is not kept.
  void leave(motion::Point place) noexcept {
    if (!motion::all_finite(place.x_m, place.y_m)) return;
    if (!places_.empty() && distance2(last_place(), place) < same_m * same_m) return;
    const float off_m =
        places_.size() < 2 ? same_m : off_line(places_[places_.size() - 2], last_place(), place);
    if (bent_m_ + off_m < same_m) {
      bent_m_ += off_m;
      places_.erase(places_.size() - 1);
    } else {
      bent_m_ = 0.0F;
    }
    if (places_.full()) {
      places_.erase(0);
      ++forgotten_;
    }
    (void)places_.push_back(place);
  }
  /// The place to go back to next; Error::no_answer: there is none left.
  [[nodiscard]] constexpr base::Result<motion::Point> last() const noexcept {
    if (places_.empty()) return base::Error::no_answer;
    return last_place();
  }
  /// It was reached, or given up.
  constexpr void drop_last() noexcept {
    if (!places_.empty()) places_.erase(places_.size() - 1);
    bent_m_ = same_m;  // the stretch before may have bends of its own: it is not made longer
  }
  /// All of it; the count of what was forgotten stays.
  constexpr void clear() noexcept {
    places_.clear();
    bent_m_ = 0.0F;
  }

  [[nodiscard]] constexpr std::size_t size() const noexcept { return places_.size(); }
  /// Places that had no room. It wraps.
  [[nodiscard]] constexpr std::uint32_t forgotten() const noexcept { return forgotten_; }

 private:
  [[nodiscard]] static constexpr float distance2(motion::Point a, motion::Point b) noexcept {
    return (b.x_m - a.x_m) * (b.x_m - a.x_m) + (b.y_m - a.y_m) * (b.y_m - a.y_m);
  }
  /// How far `b` is from the straight way from `a` to `c`; beyond the ends of that: as far as matters.
  [[nodiscard]] static float off_line(motion::Point a, motion::Point b, motion::Point c) noexcept {
    const float dx = c.x_m - a.x_m;
    const float dy = c.y_m - a.y_m;
    const float length2 = dx * dx + dy * dy;
    const float along = (b.x_m - a.x_m) * dx + (b.y_m - a.y_m) * dy;
    const float across = (b.x_m - a.x_m) * dy - (b.y_m - a.y_m) * dx;
    if (!(along >= 0.0F && along <= length2 && length2 > 0.0F)) return same_m;
    return motion::magnitude(across) / std::sqrt(length2);
  }
  [[nodiscard]] constexpr const motion::Point& last_place() const noexcept {
    return places_[places_.size() - 1];
  }

  base::FixedVector<motion::Point, N> places_{};
  float bent_m_ = 0.0F;  ///< how far the places that were left out lie from the last stretch, at most
  std::uint32_t forgotten_ = 0;
};

/// The set point that takes a robot from `from` to `to`, forwards: where its sensors look.
[[nodiscard]] inline motion::SetPoint towards(const motion::Pose& from, motion::Point to) noexcept {
  const float x = to.x_m - from.x_m;
  const float y = to.y_m - from.y_m;
  const float distance_m = std::sqrt(x * x + y * y);
  if (distance_m == 0.0F) return {};
  return {motion::difference(std::atan2(y, x), from.heading_rad), distance_m};
}

}  // namespace ocm::mapper::app
