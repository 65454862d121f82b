/// What is known about a robot's topics: which frames, which fields, which units, whose board. The generator
/// writes these as constexpr data; a tool loads the same types from a spec at run time. Views only: the
/// catalogue's maker owns the text.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>

#include "ocm/base/decimal.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/length.hpp"
#include "ocm/protocol/codec.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/request.hpp"

namespace ocm::protocol {

/// A name for a value, or for a bit when the field is a set of flags.
struct NamedValue {
  std::int64_t raw = 0;  ///< the value; for flags the number of the bit
  std::string_view name;
  friend constexpr bool operator==(const NamedValue&, const NamedValue&) = default;
};

/// One number in a frame. physical = raw * scale + offset, in `unit`.
struct Field {
  std::string_view name;
  Position position{};
  bool is_signed = false;
  base::Decimal scale{1, 0};
  base::Decimal offset{};
  std::string_view unit;     ///< as a person writes it: "deg/s"; empty for counts
  std::int64_t raw_min = 0;  ///< the range that the source gives, in raw units
  std::int64_t raw_max = 0;
  std::span<const NamedValue> values;  ///< names of values, or of flags
  bool flags = false;                  ///< `values` names bits, several of which may be set

  [[nodiscard]] constexpr std::int64_t raw(const can::Payload& data) const noexcept {
    return get(data, position, is_signed);
  }
  /// Exact; out_of_range only for scales that no sensor has.
  [[nodiscard]] constexpr base::Result<base::Decimal> physical(std::int64_t raw_value) const noexcept {
    const auto scaled = base::multiply({raw_value, 0}, scale);
    if (!scaled) return scaled.error;
    return base::add(*scaled, offset);
  }
  /// The raw number nearest to a physical value; out_of_range beyond the field's range.
  [[nodiscard]] constexpr base::Result<std::int64_t> raw_from(base::Decimal physical_value) const noexcept {
    const auto above_offset = base::subtract(physical_value, offset);
    if (!above_offset) return above_offset.error;
    const auto raw_value = base::divide_rounded(*above_offset, scale);
    if (!raw_value) return raw_value.error;
    if (*raw_value < raw_min || *raw_value > raw_max) return base::Error::out_of_range;
    return *raw_value;
  }
};

/// The most bits that a frame can take with any content, intermission included, by the priority at which it
/// is sent: the priority is in the identifier, and with it changes where stuff bits fall. 0: not known.
using BitsByPriority = std::array<std::uint8_t, priority_levels>;

/// One frame of a topic.
struct FrameLayout {
  std::string_view name;  ///< within the topic: "velocity", "x", "sensor_1"; empty for a topic's only frame
  TopicId id{};
  std::uint8_t dlc = 0;
  std::span<const Field> fields;
  BitsByPriority worst_bits{};
};

enum class Kind : std::uint8_t { sensor, actuator };

/// What a topic is for, so that a tool that does not know the robot can use it: `drive` takes velocities,
/// `light` a colour; `status` tells how its board is, `refusal` which request the board refused, and why.
enum class Role : std::uint8_t { none, drive, light, status, refusal };

struct Topic {
  std::string_view name;
  std::span<const std::string_view> aliases;
  TopicId id{};  ///< requests (sensor) or set points (actuator) carry it
  Kind kind = Kind::sensor;
  Role role = Role::none;
  std::uint8_t board = 0;               ///< index into Catalogue::boards
  std::span<const FrameLayout> frames;  ///< in the order in which they are sent
  Priority priority = default_priority;
  Period period = default_period;    ///< sensors: sent so often when a request names no period
  base::Duration shortest_period{};  ///< sensors: how often the part delivers something new
  base::Duration deadline{};         ///< from release to the end of the last frame; 0: none given
  base::Duration jitter{};           ///< of the release
  base::Duration timeout{};   ///< actuators: set point goes to zero when none came for so long; 0: never
  std::string_view group;     ///< "led" for led_1..led_8; empty otherwise
  std::uint8_t instance = 0;  ///< 1..8 within the group
  std::string_view source;    ///< where the facts come from
};

struct Board {
  std::string_view name;
  std::string_view mcu;
};

/// A frame's place in the catalogue.
struct FrameRef {
  const Topic* topic = nullptr;
  std::uint8_t frame = 0;  ///< index into topic->frames
  [[nodiscard]] constexpr const FrameLayout& layout() const noexcept { return topic->frames[frame]; }
  constexpr explicit operator bool() const noexcept { return topic != nullptr; }
};

struct Catalogue {
  std::string_view robot;
  std::uint32_t bit_rate = 0;
  std::span<const Board> boards;
  std::span<const Topic> topics;

  /// By name or alias; nullptr when there is none. O(topics).
  [[nodiscard]] constexpr const Topic* find(std::string_view name_or_alias) const noexcept {
    if (name_or_alias.empty()) return nullptr;  // unused aliases are empty
    for (const Topic& topic : topics) {
      if (topic.name == name_or_alias) return &topic;
      for (const auto alias : topic.aliases)
        if (alias == name_or_alias) return &topic;
    }
    return nullptr;
  }
  /// Whose request or set point has this number.
  [[nodiscard]] constexpr const Topic* find(TopicId id) const noexcept {
    for (const Topic& topic : topics)
      if (topic.id == id) return &topic;
    return nullptr;
  }
};

/// What a board needs of a topic's type; what the generator writes satisfies it.
template <class T>
concept TopicType = requires(const T& topic, std::size_t frame,
                             const std::array<can::Payload, T::frames.size()>& all) {
  { T::id } -> std::convertible_to<TopicId>;
  {
    T::instances
    } -> std::convertible_to<std::uint8_t>;  // 1, or how many of a kind follow each other: eight LEDs
  { T::frames[frame].id } -> std::convertible_to<TopicId>;
  { T::frames[frame].dlc } -> std::convertible_to<std::uint8_t>;
  { topic.encode(frame) } -> std::same_as<can::Payload>;
  { T::decode(all) } -> std::same_as<T>;
};

/// What a generated topic says of each of its frames.
struct FrameHead {
  TopicId id{};
  std::uint8_t dlc = 0;
  BitsByPriority worst_bits{};  ///< of several instances of a topic: the greatest
};

/// The most bits that a frame takes at a priority, intermission included: what the spec's generator found, or
/// the closed bound where none was computed.
template <class Frame>
requires std::same_as<Frame, FrameHead> || std::same_as<Frame, FrameLayout>
[[nodiscard]] constexpr unsigned worst_bits(const Frame& frame, Priority priority) noexcept {
  const unsigned exact = frame.worst_bits[static_cast<std::size_t>(priority)];
  return exact != 0 ? exact : can::worst_frame_bits(can::Format::base, frame.dlc);
}

/// The types of a board's sensors or actuators.
template <class... Topics>
struct TopicList {
  static constexpr std::size_t size = sizeof...(Topics);
  template <class T>
  static constexpr bool contains = (std::is_same_v<T, Topics> || ...);
  /// The number of T in the list; `size` when it is not there.
  template <class T>
  static constexpr std::size_t index = [] {
    std::size_t i = 0;
    static_cast<void>(((std::is_same_v<T, Topics> || (++i, false)) || ...));
    return i;
  }();
};

/// A generated topic as an entry of its catalogue. `instance` is 1..T::instances for one of several of a
/// kind, whose `entry_name` is then led_1 and whose group is T's name; 0 otherwise.
template <TopicType T>
[[nodiscard]] constexpr Topic catalogue_entry(std::uint8_t board, std::span<const std::string_view> aliases,
                                              std::span<const FrameLayout> frames, std::string_view source,
                                              std::uint8_t instance = 0,
                                              std::string_view entry_name = T::name) noexcept {
  Topic topic;
  topic.name = entry_name;
  topic.aliases = aliases;
  topic.id = TopicId{static_cast<std::uint8_t>(T::id.value + (instance == 0 ? 0 : instance - 1))};
  topic.kind = T::kind;
  topic.board = board;
  topic.frames = frames;
  topic.priority = T::priority;
  topic.deadline = T::deadline;
  topic.jitter = T::jitter;
  topic.source = source;
  if constexpr (T::kind == Kind::sensor) {
    topic.period = T::period;
    topic.shortest_period = T::shortest_period;
  } else {
    topic.timeout = T::timeout;
  }
  if constexpr (requires { T::role; }) topic.role = T::role;
  if (instance != 0) topic.group = T::name;
  topic.instance = instance;
  return topic;
}

}  // namespace ocm::protocol
