/// Heading from gyro and wheels: a complementary filter with the variance of what it says.
/// [T2 §7.2, eq. 7.3, 7.4, listing 7.1]
///
///   dth = a w dt + (1 - a) dth_wheels     while rotating
///   dth = dth_wheels                      else: so the gyro's noise does not bend a straight drive
///   P  += (gyro variance + wheel variance) dt
///
/// `a` came out at 0.75 on the thesis' floor. A gyro that is not finite, or slower than the threshold, is
/// left out: the wheels then count in full. Pure steps of a few operations; the variance only grows here, and
/// the compass takes it down (compass_filter.hpp).
#pragma once

#include <cstdint>

#include "ocm/motion/angle.hpp"
#include "ocm/motion/pose.hpp"
#include "ocm/motion/real.hpp"

namespace ocm::motion {

struct Heading {
  float angle_rad = 0.0F;      ///< in (-pi, pi]
  float variance_rad2 = 0.0F;  ///< >= 0
  friend bool operator==(const Heading&, const Heading&) = default;
};

/// Which robot's filter. [T2 §7.4, §14.3]
enum class HeadingSource : std::uint8_t {
  wheels_and_gyro,  ///< the AVR robot
  gyro,             ///< the Arduino robot, whose encoder was broken: gyro alone, always
};

struct HeadingModel {
  HeadingSource source = HeadingSource::wheels_and_gyro;
  float gyro_weight = 0.75F;               ///< a, in [0, 1] [T2 §7.3]
  float gyro_threshold_rad_s = 0.0F;       ///< slower readings are left out
  float gyro_variance_rad2_per_s = 0.0F;   ///< measured with the motors on [T2 figure 7.3]
  float wheel_variance_rad2_per_s = 0.0F;  ///< see wheel_variance_rad2
};

/// Two ticks wrong, one too many left and one too few right, as an angle: 2 m_per_tick / wheelbase. The
/// thesis calls that angle a variance (eq. 7.3); a variance is its square.
[[nodiscard]] constexpr float wheel_variance_rad2(const Drive& drive) noexcept {
  const float spread_rad = 2.0F * drive.m_per_tick() / drive.wheelbase_m;
  return spread_rad * spread_rad;
}

/// What a step of the heading knows.
struct TurnReadings {
  float gyro_rad_s = 0.0F;  ///< its bias taken off
  float wheels_rad = 0.0F;  ///< turn since the last step, by odometry
};

/// The turn of one step, and which readings were not finite and so left out.
struct Turn {
  float angle_rad = 0.0F;
  bool gyro_rejected = false;
  bool wheels_rejected = false;
};

/// [T2 eq. 7.4]
[[nodiscard]] constexpr Turn blend(TurnReadings readings, Movement movement, float dt_s,
                                   const HeadingModel& model) noexcept {
  const bool gyro_known = all_finite(readings.gyro_rad_s, dt_s);
  const float gyro_rad = gyro_known ? readings.gyro_rad_s * dt_s : 0.0F;
  Turn turn{0.0F, !gyro_known || !is_finite(gyro_rad), !is_finite(readings.wheels_rad)};
  const float wheels_rad = turn.wheels_rejected ? 0.0F : readings.wheels_rad;
  const bool slow = magnitude(readings.gyro_rad_s) < model.gyro_threshold_rad_s;
  if (model.source == HeadingSource::gyro) {
    turn.angle_rad = turn.gyro_rejected || slow ? 0.0F : gyro_rad;
    return turn;
  }
  if (movement != Movement::rotating || turn.gyro_rejected || slow) {
    turn.angle_rad = wheels_rad;
    return turn;
  }
  const float weight = turn.wheels_rejected ? 1.0F : clamp(model.gyro_weight, 0.0F, 1.0F);
  turn.angle_rad = weight * gyro_rad + (1.0F - weight) * wheels_rad;
  return turn;
}

/// The heading one step on. A turn or a time that is not finite changes nothing.
[[nodiscard]] constexpr Heading predict(Heading prior, float turn_rad, float dt_s,
                                        const HeadingModel& model) noexcept {
  if (!is_step(dt_s) || !is_finite(turn_rad)) return prior;
  const float growth = (model.gyro_variance_rad2_per_s + model.wheel_variance_rad2_per_s) * dt_s;
  if (!is_finite(growth)) return prior;
  constexpr float most = two_pi * two_pi;  // beyond this nothing is known of an angle, and P stays finite
  return {wrap(prior.angle_rad + turn_rad), clamp(prior.variance_rad2 + growth, 0.0F, most)};
}

/// Mean and variance of a gyro at rest, reading by reading, without keeping them [Welford 1962]. The mean is
/// the bias; the robot must be at rest meanwhile.
class GyroBias {
 public:
  /// `moving_rad_s`: what is faster cannot be bias, is counted as rejected and left out.
  constexpr explicit GyroBias(float moving_rad_s) noexcept : moving_rad_s_{moving_rad_s} {}

  /// False if the reading was rejected.
  constexpr bool add(float gyro_rad_s) noexcept {
    if (!is_finite(gyro_rad_s) || magnitude(gyro_rad_s) > moving_rad_s_) {
      ++rejected_;
      return false;
    }
    ++count_;
    const float off = gyro_rad_s - mean_;
    mean_ += off / static_cast<float>(count_);
    squares_ += off * (gyro_rad_s - mean_);
    return true;
  }
  [[nodiscard]] constexpr float bias_rad_s() const noexcept { return mean_; }
  /// Of one reading; 0 before the second.
  [[nodiscard]] constexpr float variance_rad2_s2() const noexcept {
    return count_ < 2 ? 0.0F : squares_ / static_cast<float>(count_ - 1);
  }
  [[nodiscard]] constexpr std::uint32_t count() const noexcept { return count_; }
  [[nodiscard]] constexpr std::uint32_t rejected() const noexcept { return rejected_; }

 private:
  float moving_rad_s_;
  float mean_ = 0.0F;
  float squares_ = 0.0F;
  std::uint32_t count_ = 0;
  std::uint32_t rejected_ = 0;
};

}  // namespace ocm::motion
