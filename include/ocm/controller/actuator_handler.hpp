/// The actuators of one board: a set point that comes is applied; one that stays away for the actuator's
/// timeout is replaced by rest (all fields zero).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "ocm/base/inline_function.hpp"
#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/controller/watchdog.hpp"
#include "ocm/protocol/counters.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::controller {

namespace detail {
template <class Topic>
struct ActuatorSlot {
  base::InlineFunction<void(std::uint8_t, const Topic&)> apply;
  std::array<Watchdog, Topic::instances> watchdogs{};
};
}  // namespace detail

template <class Actuators>
class ActuatorHandler;

template <class... Topics>
class ActuatorHandler<protocol::TopicList<Topics...>> {
 public:
  /// Applies a set point to instance 1..Topic::instances.
  template <class Topic>
  using Applier = base::InlineFunction<void(std::uint8_t, const Topic&)>;

  template <class Topic>
  void accept(Applier<Topic> apply, base::Duration timeout) noexcept {
    auto& slot = std::get<Slot<Topic>>(slots_);
    slot.apply = apply;
    for (Watchdog& watchdog : slot.watchdogs) watchdog = Watchdog{timeout};
  }

  /// A command frame. False: not one of this board's actuators.
  bool handle(const can::Frame& frame, [[maybe_unused]] base::Time now,
              protocol::Counters& counters) noexcept {
    return (set<Topics>(frame, now, counters) || ...);
  }

  void poll([[maybe_unused]] base::Time now, protocol::Counters& counters) noexcept {
    (expire<Topics>(now, counters), ...);
  }

  [[nodiscard]] base::Time next_timeout() const noexcept {
    base::Time next = base::never;
    [[maybe_unused]] const auto earliest = [&next](const auto& slot) {
      for (const Watchdog& watchdog : slot.watchdogs) next = std::min(next, watchdog.expires_at());
    };
    (earliest(std::get<Slot<Topics>>(slots_)), ...);
    return next;
  }

 private:
  template <class Topic>
  using Slot = detail::ActuatorSlot<Topic>;

  template <class Topic>
  bool set(const can::Frame& frame, base::Time now, protocol::Counters& counters) noexcept {
    const unsigned index = frame.id % 256 - Topic::frames[0].id.value;  // wraps around below the first id
    if (index >= Topic::instances) return false;
    auto& slot = std::get<Slot<Topic>>(slots_);
    if (!slot.apply) {
      counters.refuse(base::Error::unknown_topic);
    } else if (frame.dlc != Topic::frames[0].dlc) {
      counters.refuse(base::Error::bad_length);
    } else {
      ++counters.set_points;
      const Topic set_point = Topic::decode(frame.data);
      Watchdog& watchdog = slot.watchdogs[index];
      set_point == Topic{} ? watchdog.rest() : watchdog.feed(now);
      slot.apply(static_cast<std::uint8_t>(index + 1), set_point);
    }
    return true;
  }

  template <class Topic>
  void expire(base::Time now, protocol::Counters& counters) noexcept {
    auto& slot = std::get<Slot<Topic>>(slots_);
    for (std::size_t i = 0; i < slot.watchdogs.size(); ++i) {
      if (!slot.watchdogs[i].expire(now)) continue;
      ++counters.timeouts;
      slot.apply(static_cast<std::uint8_t>(i + 1), Topic{});
    }
  }

  std::tuple<Slot<Topics>...> slots_;
};

}  // namespace ocm::controller
