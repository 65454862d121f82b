/// A bus that does not compile when a message on it would be late.
///
///     struct Pose {
///       static constexpr ocm::analysis::Message message{...};  // in ticks, with its key
///     };
///     static_assert(ocm::analysis::schedulable<ocm::analysis::Traffic<tau_bit, Pose, SetPoint>>);
///
/// Where that fails, GCC and Clang name the type that is late, the bound on its response time and its
/// deadline: misses_its_deadline<Pose, 5160000, 5000000>. A topic of a spec becomes such types by
/// TopicFrame<Topic, frame>, with the period, deadline, jitter and priority that the topic has by default;
/// all that the boards of a spec send is SentBy<bit_rate, Boards...>.
///
/// Cost: one exact analysis at compile time: 300 messages at a moderate load take GCC and Clang 0.3 s and
/// stay within Clang's million steps.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "ocm/analysis/can_response.hpp"
#include "ocm/analysis/message_set.hpp"
#include "ocm/base/time.hpp"
#include "ocm/protocol/message.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::analysis {

namespace detail {

template <std::size_t index, class... Types>
struct TypeAt;
template <std::size_t index, class First, class... Rest>
struct TypeAt<index, First, Rest...> {
  using type = typename TypeAt<index - 1, Rest...>::type;
};
template <class First, class... Rest>
struct TypeAt<0, First, Rest...> {
  using type = First;
};

}  // namespace detail

/// Messages as types, in any order, and how long a bit is in their ticks.
template <std::int64_t tau_bit, class... Messages>
struct Traffic {
  static constexpr std::size_t size = sizeof...(Messages);
  template <std::size_t index>
  using item = typename detail::TypeAt<index, Messages...>::type;

 private:
  static constexpr auto solve() noexcept {
    std::array<Message, size> set{Messages::message...};
    std::array<std::size_t, size> from{};
    for (std::size_t i = 0; i < size; ++i) from[i] = i;
    for (std::size_t i = 1; i < size; ++i)
      for (std::size_t k = i; k > 0 && set[k].key < set[k - 1].key; --k) {
        std::swap(set[k], set[k - 1]);
        std::swap(from[k], from[k - 1]);
      }
    const auto sorted = can_response_times(set, {.bit = tau_bit});
    std::array<Explained, size> found{};
    for (std::size_t i = 0; i < size; ++i) {
      found[from[i]] = sorted[i];
      for (std::size_t* other : {&found[from[i]].blocked_by, &found[from[i]].largest})
        if (*other < size) *other = from[*other];
    }
    // Two messages of one identifier cannot both be analysed: neither has a place.
    for (std::size_t i = 1; i < size; ++i)
      if (set[i].key == set[i - 1].key)
        for (const std::size_t k : {i - 1, i})
          found[from[k]] = {.deadline = set[k].due(), .reason = Reason::bad_input};
    return found;
  }

 public:
  /// In the order of `Messages`.
  static constexpr std::array<Explained, size> results = solve();
};

/// What a message is that has no bound within its deadline. `response` is `unbounded` where it has none.
template <class Message, std::int64_t response, std::int64_t deadline>
struct misses_its_deadline {
  using message = Message;
};
/// What a set has instead where there is no such message.
struct all_meet_their_deadlines {};

namespace detail {

template <class Set>
struct FirstLate {
  static constexpr std::size_t index = [] {
    std::size_t i = 0;
    while (i < Set::size && Set::results[i].ok()) ++i;
    return i;
  }();
  static constexpr auto find() noexcept {
    if constexpr (index == Set::size)
      return all_meet_their_deadlines{};
    else
      return misses_its_deadline<typename Set::template item<index>, Set::results[index].response,
                                 Set::results[index].deadline>{};
  }
  using type = decltype(find());
};

}  // namespace detail

/// The first of a set's messages (or tasks: task_list.hpp) that may be late, as misses_its_deadline; or
/// all_meet_their_deadlines.
template <class Set>
using first_late = typename detail::FirstLate<Set>::type;

/// For the message of the compiler: it says which type is not this one.
template <class Late>
concept nobody_is_late = std::is_same_v<Late, all_meet_their_deadlines>;

template <class Set>
concept schedulable = nobody_is_late<first_late<Set>>;

/// Frame `index` of a topic, or of one of its instances (1..Topic::instances), in nanoseconds: as the topic
/// is sent unless a request changes it. Set points have no period of their own: `period` gives it.
template <protocol::TopicType Topic, std::uint32_t bit_rate, std::size_t index = 0, std::uint8_t instance = 1,
          std::int64_t period_ns = 0>
struct TopicFrame {
  static constexpr Message message = [] {
    protocol::FrameHead head = Topic::frames[index];
    head.id = protocol::frame_id<Topic>(index, instance);
    base::Duration period{period_ns};
    if constexpr (Topic::kind == protocol::Kind::sensor)
      if (period_ns == 0) period = Topic::period.duration();
    const auto direction =
        Topic::kind == protocol::Kind::sensor ? protocol::Direction::sensor : protocol::Direction::command;
    return message_of(head, direction, Topic::priority, period, Topic::deadline, Topic::jitter, bit_rate);
  }();
};

/// A frame as TopicFrame, that must have been sent when the next sample comes: what still waits then is lost.
template <protocol::TopicType Topic, std::uint32_t bit_rate, std::size_t index = 0, std::uint8_t instance = 1,
          std::int64_t period_ns = 0>
struct FreshFrame {
  static constexpr Message message = [] {
    Message m = TopicFrame<Topic, bit_rate, index, instance, period_ns>::message;
    m.deadline = std::min(m.due(), m.period);
    return m;
  }();
};

template <std::int64_t tau_bit, class... Some, class... More>
[[nodiscard]] constexpr Traffic<tau_bit, Some..., More...> operator+(Traffic<tau_bit, Some...>,
                                                                     Traffic<tau_bit, More...>) noexcept {
  return {};
}

namespace detail {

template <std::uint32_t bit_rate, class Topic, std::size_t... i>
constexpr auto frames_of(std::index_sequence<i...>) noexcept {
  constexpr std::size_t frames = Topic::frames.size();
  return Traffic<bits_ns(1, bit_rate),
                 FreshFrame<Topic, bit_rate, i % frames, static_cast<std::uint8_t>(i / frames + 1)>...>{};
}
template <std::uint32_t bit_rate, class... Topics>
constexpr auto frames_of(protocol::TopicList<Topics...>) noexcept {
  return (Traffic<bits_ns(1, bit_rate)>{} + ... +
          frames_of<bit_rate, Topics>(
              std::make_index_sequence<Topics::frames.size() * std::size_t{Topics::instances}>{}));
}

}  // namespace detail

/// All frames that these boards of a generated header send unless a request changes it.
template <std::uint32_t bit_rate, class... Boards>
using SentBy = decltype((Traffic<bits_ns(1, bit_rate)>{} + ... +
                         detail::frames_of<bit_rate>(typename Boards::sensors{})));

}  // namespace ocm::analysis
