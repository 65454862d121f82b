/// The actuators of one board: a set point that comes is applied; one that stays away for the actuator's
/// timeout is replaced by rest (all fields zero), and so are all of them that have a timeout when the bus is
/// lost.
///
/// A set point is applied by the context that brings it: the context that calls `handle`, or the one that
/// calls `settle` (the urgent level). If both come at once, who is applying goes on with what the other has
/// left: `apply` of a topic is never in two contexts, and the last decision is the last one applied. That is
/// why a rest cannot be overwritten by a set point that was decoded before and preempted.
///
/// No heap. RAM a topic: three pointers and 8 bytes; 16 and a set point for each instance.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "ocm/base/inline_function.hpp"
#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/controller/report.hpp"
#include "ocm/controller/watchdog.hpp"
#include "ocm/protocol/counters.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/scheduling/port.hpp"

namespace ocm::controller {

namespace detail {
template <class Topic>
struct ActuatorSlot {
  static_assert(Topic::instances <= 32);
  base::InlineFunction<void(std::uint8_t, const Topic&)> apply;
  std::uint32_t fresh = 0;  // bit i: wanted[i] is not applied yet
  bool applying = false;    // a context is, and will look at `fresh` again
  std::array<Topic, Topic::instances> wanted{};
  std::array<Watchdog, Topic::instances> watchdogs{};

  void want(std::size_t instance, const Topic& set_point) noexcept {
    wanted[instance] = set_point;
    fresh |= std::uint32_t{1} << instance;
  }
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

  /// A command frame.
  template <scheduling::Port P>
  Verdict handle(const can::Frame& frame, [[maybe_unused]] base::Time now, [[maybe_unused]] P& port,
                 [[maybe_unused]] protocol::Counters& counters) noexcept {
    Verdict verdict;
    static_cast<void>(((verdict = set<Topics>(frame, now, port, counters)).mine || ...));
    return verdict;
  }

  /// Brings to rest what is overdue, and applies what `lose_bus` has left.
  template <scheduling::Port P>
  void settle([[maybe_unused]] base::Time now, [[maybe_unused]] P& port,
              [[maybe_unused]] protocol::Counters& counters) noexcept {
    (expire<Topics>(now, port, counters), ...);
  }

  /// Every actuator with a timeout that is not at rest shall come to rest at the next `settle`. Any context.
  template <scheduling::Port P>
  void lose_bus(P& port, [[maybe_unused]] protocol::Counters& counters) noexcept {
    [[maybe_unused]] const auto guard = port.lock();
    [[maybe_unused]] const auto rest = [&counters](auto& slot) {
      for (std::size_t i = 0; i < slot.watchdogs.size(); ++i) {
        if (slot.watchdogs[i].expires_at() == base::never) continue;
        slot.watchdogs[i].rest();
        slot.want(i, {});
        ++counters.bus_lost;
      }
    };
    (rest(std::get<Slot<Topics>>(slots_)), ...);
  }

  /// When to call `settle` next; base::never when nothing is watched. To be called with the port's lock held.
  [[nodiscard]] base::Time next_settle([[maybe_unused]] base::Time now) const noexcept {
    base::Time next = base::never;
    [[maybe_unused]] const auto look = [&next, now](const auto& slot) {
      for (const Watchdog& watchdog : slot.watchdogs) next = std::min(next, watchdog.expires_at());
      if (slot.fresh != 0 && !slot.applying) next = std::min(next, now);
    };
    (look(std::get<Slot<Topics>>(slots_)), ...);
    return next;
  }

 private:
  template <class Topic>
  using Slot = detail::ActuatorSlot<Topic>;

  template <class Topic, class P>
  Verdict set(const can::Frame& frame, base::Time now, P& port, protocol::Counters& counters) noexcept {
    const unsigned index = frame.id % 256 - Topic::frames[0].id.value;  // wraps around below the first id
    if (index >= Topic::instances) return {};
    auto& slot = std::get<Slot<Topic>>(slots_);
    {
      [[maybe_unused]] const auto guard = port.lock();
      const auto refused = !slot.apply                         ? base::Error::unknown_topic
                           : frame.dlc != Topic::frames[0].dlc ? base::Error::bad_length
                                                               : base::Error::none;
      if (refused != base::Error::none) {
        counters.refuse(refused);
        return {true, refused};
      }
      ++counters.set_points;
      const Topic set_point = Topic::decode(frame.data);
      Watchdog& watchdog = slot.watchdogs[index];
      set_point == Topic{} ? watchdog.rest() : watchdog.feed(now);
      slot.want(index, set_point);
    }
    apply(slot, port);
    return {true, base::Error::none};
  }

  template <class Topic, class P>
  void expire(base::Time now, P& port, protocol::Counters& counters) noexcept {
    auto& slot = std::get<Slot<Topic>>(slots_);
    {
      [[maybe_unused]] const auto guard = port.lock();
      for (std::size_t i = 0; i < slot.watchdogs.size(); ++i) {
        if (!slot.watchdogs[i].expire(now)) continue;
        ++counters.timeouts;
        slot.want(i, Topic{});
      }
    }
    apply(slot, port);
  }

  /// Applies what is fresh, unless another context is doing so.
  template <class Topic, class P>
  static void apply(Slot<Topic>& slot, P& port) noexcept {
    for (bool mine = false;; mine = true) {
      std::size_t instance = 0;
      Topic set_point;
      {
        [[maybe_unused]] const auto guard = port.lock();
        if (!mine && slot.applying) return;
        slot.applying = slot.fresh != 0;
        if (!slot.applying) return;
        instance = static_cast<std::size_t>(std::countr_zero(slot.fresh));
        slot.fresh &= slot.fresh - 1;
        set_point = slot.wanted[instance];
      }
      slot.apply(static_cast<std::uint8_t>(instance + 1), set_point);
    }
  }

  std::tuple<Slot<Topics>...> slots_;
};

}  // namespace ocm::controller
