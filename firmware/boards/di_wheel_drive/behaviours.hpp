/// What DiWheelDrive does by itself: it travels a way, or follows a line. One at a time; a set point of the
/// motors, whatever it is, ends it.
///
/// `Orders` is where commands arrive and where the task reads them, to be touched with the port's lock held;
/// `Behaviours` is the task's own: ticks and floor go in, wheel speeds come out. What was worked out for an
/// order that has ended meanwhile is thrown away (`Orders::take`), so no set point is overwritten by an older
/// behaviour.
///
/// Pure steps, no heap. Some hundred float operations a step, 150 bytes.
#pragma once

#include <chrono>
#include <cstdint>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/motion/line_follower.hpp"
#include "ocm/motion/travel.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/boards/di_wheel_drive/geometry.hpp"
#include "firmware/boards/samples.hpp"

namespace ocm::firmware::boards::di_wheel_drive {

/// How often a behaviour is stepped. [decided: at 0.3 m/s 6 mm; of what the wheels' lag takes, a third]
inline constexpr base::Duration behaviour_period = std::chrono::milliseconds{20};
static_assert(behaviour_period == amiro::Behaviour::shortest_period);

/// A behaviour that had no step for so long ends: wheels that nothing looks after do not go on turning. Steps
/// are at the low level, where what is published faster than it should be can take all the time; at a more
/// urgent one, reading the floor would delay every stream.
inline constexpr base::Duration longest_without_step = 5 * behaviour_period;

inline constexpr motion::TravelModel travel_model{.wheelbase_m = static_cast<float>(wheel_base_m)};

/// The fastest travel of the spec still brakes as its gain says, and so does not run over its end.
static_assert([] {
  amiro::Travel fastest;
  fastest.set_speed_m_per_s(1e6);
  return static_cast<float>(fastest.speed_m_per_s()) * travel_model.gain_per_s <=
         travel_model.acceleration_m_s2;
}());

/// Places of the floor sensors: amiro_robot, amiro.xacro. The spot is what a sensor 10 mm above the floor
/// sees, the line's width that of insulating tape. [both decided]
inline constexpr motion::LineFollowerModel line_model{.ahead_m = 0.0445F,
                                                      .apart_m = 0.007F,
                                                      .spot_radius_m = 0.004F,
                                                      .half_line_m = 0.01F,
                                                      .wheelbase_m = static_cast<float>(wheel_base_m)};

/// The tightest curve that a follow at this speed takes without losing the line. [measured in the simulated
/// world: tests/sim/behaviours.cpp]
[[nodiscard]] constexpr double least_radius_m(double speed_m_per_s) noexcept {
  return 0.08 + 0.4 * speed_m_per_s;
}

/// A travel that this board does not begin: without a speed, beyond the spec's ranges, or one that may take
/// longer than its watchdog allows.
[[nodiscard]] constexpr bool can_travel(const amiro::Travel& travel) noexcept {
  amiro::Travel bounded = travel;
  bounded.set_distance_m(travel.distance_m());
  bounded.set_angle_rad(travel.angle_rad());
  bounded.set_speed_m_per_s(travel.speed_m_per_s());
  if (bounded != travel || travel.speed == 0) return false;
  const motion::TravelTarget target{static_cast<float>(travel.distance_m()),
                                    static_cast<float>(travel.angle_rad()),
                                    static_cast<float>(travel.speed_m_per_s())};
  return motion::longest_s(target, travel_model) <=
         std::chrono::duration<float>{amiro::Travel::timeout}.count();
}

/// A follow beyond the spec's range.
[[nodiscard]] constexpr bool can_follow(const amiro::Follow& follow) noexcept {
  amiro::Follow bounded = follow;
  bounded.set_speed_m_per_s(follow.speed_m_per_s());
  return bounded == follow;
}

/// What is to be done, by the last command, and what has become of it.
class Orders {
 public:
  using Active = amiro::Behaviour::Active;
  using Ended = amiro::Behaviour::Ended;

  /// What the task works on.
  struct Order {
    Active active = Active::none;
    amiro::Travel travel{};
    amiro::Follow follow{};
    std::uint32_t number = 0;  ///< another one for each order
  };

  void travel(const amiro::Travel& travel) noexcept {
    begin(Active::travel);
    order_.travel = travel;
    report_.distance = travel.distance;
    report_.angle = travel.angle;
  }
  /// Again and again the same, or with another speed: it goes on.
  void follow(const amiro::Follow& follow) noexcept {
    if (order_.active != Active::follow) begin(Active::follow);
    order_.follow = follow;
  }
  /// Ends `which`, if it is that; true if it was.
  bool end(Active which, Ended how) noexcept {
    if (order_.active != which || which == Active::none) return false;
    order_.active = Active::none;
    ++order_.number;
    report_.active = Active::none;
    report_.ended = how;
    return true;
  }
  /// Ends any.
  void end(Ended how) noexcept { end(order_.active, how); }

  [[nodiscard]] const Order& order() const noexcept { return order_; }
  [[nodiscard]] const amiro::Behaviour& report() const noexcept { return report_; }

  /// Time that passes, to be said by whatever is never late: ends what has had no step for longer than
  /// `longest_without_step`; true if it did.
  bool pass(base::Duration time) noexcept {
    if (order_.active == Active::none) return false;
    since_step_ += time;
    if (since_step_ <= longest_without_step) return false;
    end(Ended::late);
    return true;
  }

  /// What a step for order number `number` came to: whether it still is the order, and is recorded.
  bool take(std::uint32_t number, std::int32_t distance, std::int32_t angle, Ended ended) noexcept {
    if (number != order_.number || order_.active == Active::none) return false;
    report_.distance = distance;
    report_.angle = angle;
    since_step_ = {};
    if (ended != Ended::nothing) end(ended);
    return true;
  }

 private:
  void begin(Active active) noexcept {
    order_.active = active;
    ++order_.number;
    report_ = {};
    report_.active = active;
    since_step_ = {};
  }

  Order order_{};
  amiro::Behaviour report_{};
  base::Duration since_step_{};
};

class Behaviours {
 public:
  using Active = Orders::Active;
  using Ended = Orders::Ended;

  struct Step {
    WheelSpeeds wheels{};
    Ended ended = Ended::nothing;
    std::int32_t distance = 0;  ///< left, as it travels
    std::int32_t angle = 0;
  };

  /// One step of `order`, so many `behaviour_period`s after the last one. `encoders()` and `floor()` are
  /// asked when the behaviour needs them.
  template <class Encoders, class Floor>
  [[nodiscard]] Step step(const Orders::Order& order, std::uint32_t periods, Encoders encoders,
                          Floor floor) noexcept {
    const bool fresh = order.number != number_;
    number_ = order.number;
    const float dt_s =
        std::chrono::duration<float>{behaviour_period}.count() * static_cast<float>(fresh ? 1U : periods);
    switch (order.active) {
      case Active::travel:
        return travel(order.travel, fresh, dt_s, encoders());
      case Active::follow:
        return follow(order.follow, fresh, dt_s, floor());
      default:
        return {};
    }
  }

 private:
  [[nodiscard]] static WheelSpeeds wheels(const motion::Twist& twist) noexcept {
    return wheel_speeds(twist.speed_m_s, twist.turn_rad_s);
  }

  [[nodiscard]] Step travel(const amiro::Travel& wanted, bool fresh, float dt_s,
                            const base::Result<WheelTicks>& ticks) noexcept {
    if (!ticks) return {{}, Ended::no_sample, wanted.distance, wanted.angle};
    if (fresh) {
      travel_ =
          motion::started({static_cast<float>(wanted.distance_m()), static_cast<float>(wanted.angle_rad()),
                           static_cast<float>(wanted.speed_m_per_s())},
                          travel_model);
      ticks_ = *ticks;
    }
    const motion::TravelStep step = motion::control(travel_, moved(*ticks), dt_s, travel_model);
    ticks_ = *ticks;
    travel_ = step.state;
    amiro::Behaviour left;
    left.set_distance_m(static_cast<double>(travel_.distance_left_m));
    left.set_angle_rad(static_cast<double>(travel_.angle_left_rad));
    const Ended ended = step.end == motion::TravelEnd::arrived    ? Ended::arrived
                        : step.end == motion::TravelEnd::too_long ? Ended::too_long
                                                                  : Ended::nothing;
    return {wheels(step.command), ended, left.distance, left.angle};
  }

  [[nodiscard]] Step follow(const amiro::Follow& wanted, bool fresh, float dt_s,
                            const base::Result<FloorCounts>& counts) noexcept {
    if (!counts) return {{}, Ended::no_sample, 0, 0};
    if (fresh) follower_ = {};
    // [AMiRo-OS 1.0, Constants.h: front right, right wheel, left wheel, front left]
    const motion::FloorView view{(*counts)[3], (*counts)[0], (*counts)[2], (*counts)[1]};
    const motion::LineFollowerStep step =
        motion::control(follower_, view, static_cast<float>(wanted.speed_m_per_s()), dt_s, line_model);
    follower_ = step.state;
    return {wheels(step.command), step.lost ? Ended::line_lost : Ended::nothing, 0, 0};
  }

  /// Ticks are subtracted before they are scaled, right across their wrap.
  [[nodiscard]] motion::Moved moved(const WheelTicks& now) const noexcept {
    const auto since = [](std::int32_t later, std::int32_t earlier) {
      return static_cast<std::int32_t>(static_cast<std::uint32_t>(later) -
                                       static_cast<std::uint32_t>(earlier));
    };
    const std::int32_t left = since(now.left, ticks_.left);
    const std::int32_t right = since(now.right, ticks_.right);
    constexpr auto m_per_tick = static_cast<float>(metres_per_tick);
    constexpr auto base_m = static_cast<float>(wheel_base_m);
    return {(static_cast<float>(left) + static_cast<float>(right)) * (m_per_tick / 2.0F),
            static_cast<float>(right - left) * (m_per_tick / base_m)};
  }

  std::uint32_t number_ = 0;  // of the order that the states below are of
  WheelTicks ticks_{};
  motion::Travel travel_{};
  motion::LineFollower follower_{};
};

}  // namespace ocm::firmware::boards::di_wheel_drive
